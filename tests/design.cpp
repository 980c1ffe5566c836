#include "impact_damper/analysis/design.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "application/report/findings.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/simulate.hpp"

using namespace impact_damper;
constexpr double pi = std::numbers::pi;

namespace {

// A mast: 40 kg on 16 kN/m, 1.6 kg in a box with a clearance of 10 mm.
Scene mast() {
  Scene scene{.damping_ratio = 0.002, .dampers = {{.mass_ratio = 0.04}}};
  return scene;
}

HalfCycles rows_of(const std::vector<double>& time, const std::vector<double>& amplitude) {
  return {time, time, amplitude, std::vector<std::int64_t>(time.size(), 1), {}};
}

// Amplitude of mass x'' + 2 zeta x' + x = f sin(omega t) after its transient, stepped through.
double stepped_response(double force, double mass, double zeta, double omega) {
  const double h = 0.002, end = 30 / zeta;
  double x = 0, v = 0, largest = 0;
  const auto acceleration = [&](double t, double at, double speed) {
    return (force * std::sin(omega * t) - 2 * zeta * speed - at) / mass;
  };
  for (std::int64_t i = 0; i * h < end; ++i) {
    const double t = static_cast<double>(i) * h;
    const double v1 = v, a1 = acceleration(t, x, v);
    const double v2 = v + h / 2 * a1, a2 = acceleration(t + h / 2, x + h / 2 * v1, v2);
    const double v3 = v + h / 2 * a2, a3 = acceleration(t + h / 2, x + h / 2 * v2, v3);
    const double v4 = v + h * a3, a4 = acceleration(t + h, x + h * v3, v4);
    x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if (t > end - 3 * 2 * pi / omega) largest = std::max(largest, std::abs(x));
  }
  return largest;
}

}  // namespace

TEST_CASE("the local loss factor is exact on an exponential envelope, however steep") {
  for (const double zeta : {1e-4, 0.01, 0.1, 0.3}) {
    std::vector<double> time, amplitude;
    for (int i = 0; i < 30; ++i) {
      time.push_back(3.1 * i + 0.2 * std::sin(5.0 * i));
      amplitude.push_back(6 * std::exp(-zeta * time.back()));
    }
    const LossFactor loss = local_loss_factor(rows_of(time, amplitude), 0, 30);
    REQUIRE(loss.eta.size() == 28);
    for (const double eta : loss.eta) CHECK(eta == doctest::Approx(2 * zeta).epsilon(1e-11));
  }
}

TEST_CASE("where the amplitude falls in a straight line the local loss factor errs as equation (7) says") {
  // Over a factor of 2 the window has m = 1, 2 or 5 peaks on either side of its middle.
  for (const double fall : {0.3, 0.15, 0.02}) {
    std::vector<double> time, amplitude;
    for (int i = 0; i < 9; ++i) {
      time.push_back(pi * i);
      amplitude.push_back(1 - fall * (i - 4));
    }
    const LossFactor loss = local_loss_factor(rows_of(time, amplitude), 0, 9);
    const double m = fall == 0.3 ? 1 : fall == 0.15 ? 2 : 4, h = m * fall;
    const double bias = h * h * (m - 1) * (m + 2) / (30 * m * m);
    CHECK(loss.time[3] == 4 * pi);
    CHECK(std::abs(loss.amplitude[3] * loss.eta[3] / (2 * fall / pi) - 1 - bias) < h * h * h * h);
  }
}

TEST_CASE("rows outside the asked ones, and rows without a height, do not enter the local loss factor") {
  const HalfCycles rows = rows_of({0, 1, 2, 3, 4, 5}, {9, 0, 4, 2, 1, 1e-9});
  const LossFactor loss = local_loss_factor(rows, 1, 5);
  REQUIRE(loss.eta.size() == 1);
  CHECK(loss.time[0] == 3);
  CHECK(loss.amplitude[0] == doctest::Approx(2));
  CHECK(loss.eta[0] == doctest::Approx(2 * std::log(2)));
}

TEST_CASE("a mast is damped best above impact failure, as its half cycles say") {
  Scene scene = mast();
  scene.until_amplitude = 0.02;
  EnsembleOptions alone;
  alone.members = 1;
  const Findings findings = examine({"mast", "", scene, {}, Exact{}}, alone, [](const std::string&) {});
  REQUIRE(findings.best);
  REQUIRE(findings.failure.first_missed);
  CHECK(findings.best->amplitude > findings.failure.first_missed->amplitude);
  CHECK(findings.best->amplitude > fold_amplitude(0.6));
  for (const double amplitude : findings.loss.amplitude)
    CHECK(amplitude > findings.failure.first_missed->amplitude);
  // The whole cycle about it, read off three peaks, which are equally spaced within a hundredth.
  const HalfCycles& rows = *findings.run.half_cycles;
  std::size_t i = 0;
  while (rows.peak_time[i] != findings.best->time) ++i;
  const double cycle = 2 * std::log(rows.amplitude[i - 1] / rows.amplitude[i + 1]) /
                       (rows.peak_time[i + 1] - rows.peak_time[i - 1]);
  CHECK(findings.best->eta == doctest::Approx(cycle).epsilon(1e-3));
}

TEST_CASE(
    "with one impact per half cycle the local loss factor is the closed form's, to the order of the mass "
    "ratio") {
  // The closed form is for nu -> 0. The mass lags behind the falling amplitude, by relatively more near the
  // fold.
  for (const double nu : {0.002, 0.004}) {
    const Scene scene{.x0 = 0.35, .until_amplitude = 0.1, .dampers = {{.mass_ratio = nu, .w0 = 0.3}}};
    const Run run = simulate(scene, Exact{}, {});
    const HalfCycles& rows = *run.half_cycles;
    const LossFactor loss = local_loss_factor(rows, 1, rows.amplitude.size());
    int compared = 0;
    for (std::size_t i = 0; i < loss.eta.size(); ++i) {
      if (loss.amplitude[i] < 0.12 || loss.amplitude[i] > 0.25) continue;
      ++compared;
      const double form = single_impact(0.6, loss.amplitude[i])->loss * nu;
      CHECK(std::abs(loss.eta[i] / form - 1) < 10 * nu);
    }
    CHECK(compared > 10);
  }
}

TEST_CASE(
    "the recommended clearance keeps its distance to impact failure in every corner of the tolerances") {
  for (const double e : {0.02, 0.2, 0.4, 0.6, 0.8, 0.9, 0.98}) {
    const Tolerances tolerances;
    const ClearanceRule rule = clearance_rule(e, tolerances);
    CHECK(rule.margin >= least_margin);
    CHECK(rule.amplitude == doctest::Approx(rule.margin * rule.fold).epsilon(1e-15));
    for (const double de : {-1, 0, 1})
      for (const double dc : {-1, 1})
        for (const double da : {-1, 1}) {
          const double off = std::clamp(e + de * tolerances.restitution, 0.0, 0.999);
          const double amplitude =
              rule.amplitude * (1 + da * tolerances.amplitude) / (1 + dc * tolerances.clearance);
          // There is a motion with one impact in each half cycle, so no worse corner than the one told.
          CHECK(single_impact(off, amplitude * (1 + 1e-12)));
          CHECK(amplitude / fold_amplitude(off) >= (1 - 1e-12) * rule.worst_amplitude / rule.worst_fold);
        }
    CHECK(rule.loss == doctest::Approx(single_impact(e, rule.amplitude)->loss).epsilon(1e-9));
    CHECK(rule.loss < peak_loss(e));
    CHECK(rule.worst_loss ==
          doctest::Approx(single_impact(rule.worst_restitution, rule.worst_amplitude * (1 + 1e-12))->loss)
              .epsilon(1e-9));
  }
}

TEST_CASE("force and duration of a contact are those of a stepped contact") {
  for (const double e : {0.001, 0.05, 0.1, 0.3, 0.6, 0.95, 1.0})
    for (const double nu : {0.01, 0.3})
      for (const double k : {1e4, 1e6}) {
        const Scene scene{.dampers = {{.mass_ratio = nu, .restitution = e, .wall_stiffness = k}}};
        const double w = 0.7, decrement = -std::log(e);
        const double zeta_m = decrement / std::hypot(pi, decrement);
        const double c = 2 * std::sqrt(k / nu) * zeta_m;
        // The two masses with nothing but the wall between them: q'' = -(1 + nu) (c q' + k/nu q).
        double q = 0, v = w, t = 0, largest = 0;
        const double h = 1e-4 / std::sqrt(k / nu);
        const auto rate = [&](double at, double speed) { return -(1 + nu) * (c * speed + k / nu * at); };
        do {
          largest = std::max(largest, nu * (c * v + k / nu * q));
          const double v1 = v, a1 = rate(q, v), v2 = v + h / 2 * a1, a2 = rate(q + h / 2 * v1, v2);
          const double v3 = v + h / 2 * a2, a3 = rate(q + h / 2 * v2, v3), v4 = v + h * a3,
                       a4 = rate(q + h * v3, v4);
          q += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
          v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
          t += h;
        } while (q > 0 && t < 50 / std::sqrt(k / nu));
        const ShortContact contact = short_contact(scene.damper(), Calibration::fixed_wall, w);
        CHECK(contact.force == doctest::Approx(largest).epsilon(1e-6));
        const bool rebounds = zeta_m * std::sqrt(1 + nu) < 1;
        REQUIRE(contact.duration.has_value() == rebounds);
        if (rebounds && q <= 0) CHECK(*contact.duration == doctest::Approx(t).epsilon(1e-3));
      }
}

TEST_CASE(
    "contacts of a run last as long as the closed form says, and their overlap makes the force it says") {
  Scene scene = mast();
  scene.until_time = 6.5;
  Record record{.impacts = true, .contacts = true};
  Run run = simulate(scene, Exact{}, record);
  const double speed = std::abs(run.impacts->relative_velocity[0]);
  const ShortContact contact = short_contact(scene.damper(), Calibration::fixed_wall, speed);
  const double begin = run.contacts->begin[0], end = run.contacts->end[0];
  // The primary spring bends the relative motion by its acceleration, at most 6 here: of relative order 6 T /
  // w.
  const double tolerance = 6 * *contact.duration / speed;
  CHECK(end - begin == doctest::Approx(*contact.duration).epsilon(tolerance));
  record.history = {{begin, end, 2001}};
  run = simulate(scene, Exact{}, record);
  const double zeta_m = -std::log(0.6) / std::hypot(pi, std::log(0.6));
  double largest = 0;
  for (std::size_t i = 0; i < run.history->time.size(); ++i) {
    const double y = run.history->dampers[0].y[i], q = run.contacts->wall[0] == Wall::left ? y : y - 1;
    largest = std::max(largest, std::abs(1e4 * q + 0.04 * 2 * std::sqrt(1e4 / 0.04) * zeta_m *
                                                       run.history->dampers[0].w[i]));
  }
  CHECK(largest == doctest::Approx(contact.force).epsilon(tolerance));
}

TEST_CASE("a secondary mass that begins in a wall is pushed by it from the beginning") {
  Scene scene = mast();
  scene.damper().y0 = 1.002;
  scene.damper().w0 = 0.5;
  const double zeta_m = -std::log(0.6) / std::hypot(pi, std::log(0.6));
  CHECK(initial_wall_force(scene.damper(), Calibration::fixed_wall) ==
        doctest::Approx(1e4 * 0.002 + 0.04 * 2 * std::sqrt(1e4 / 0.04) * zeta_m * 0.5).epsilon(1e-6));
  scene.damper().y0 = 0.5;
  CHECK(initial_wall_force(scene.damper(), Calibration::fixed_wall) == 0);
}

TEST_CASE("the linear responses are those of a stepped oscillator, and none is larger than the worst") {
  for (const double mass : {1.0, 1.04, 1.5})
    for (const double zeta : {0.05, 0.3})
      for (const double omega : {0.5, 0.9, 1.0, 1.3})
        CHECK(linear_response(-0.3, mass, zeta, omega) ==
              doctest::Approx(stepped_response(0.3, mass, zeta, omega)).epsilon(1e-5));
  for (const double mass : {1.0, 1.04, 1.5})
    for (const double zeta : {0.002, 0.3, 0.7, 0.9, 2.0}) {
      const WorstResponse worst = worst_linear_response(0.0625, mass, zeta);
      double largest = 0.0625, at = 0;
      for (double omega = 1e-4; omega < 1.2; omega += 1e-5)
        if (const double a = 0.0625 / std::abs(std::complex(1 - mass * omega * omega, 2 * zeta * omega));
            a > largest)
          largest = a, at = omega;
      CHECK(worst.amplitude == doctest::Approx(largest).epsilon(1e-5));
      CHECK(std::abs(worst.frequency - at) < 2e-4);
    }
  CHECK(std::isinf(worst_linear_response(0.1, 1.04, 0).amplitude));
  CHECK(worst_linear_response(0.1, 1.04, 0).frequency == doctest::Approx(1 / std::sqrt(1.04)));
}

TEST_CASE("steady amplitudes are those of the last quarter, settled or not") {
  std::vector<double> amplitude(8, 5.0);
  amplitude.insert(amplitude.end(), {1.0, 1.0, 1.0, 1.0, 1.0, 1.01, 0.99, 1.0});
  const auto steady = steady_amplitude(rows_of(amplitude, amplitude));
  REQUIRE(steady);
  CHECK(steady->least == 0.99);
  CHECK(steady->greatest == 1.01);
  CHECK(steady->mean == doctest::Approx(1));
  CHECK(steady->settled);
  amplitude[15] = 1.2;
  CHECK_FALSE(steady_amplitude(rows_of(amplitude, amplitude))->settled);
  amplitude.resize(11);
  CHECK_FALSE(steady_amplitude(rows_of(amplitude, amplitude)));
}
