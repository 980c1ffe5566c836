#include "impact_damper/engines/cem.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "engines/observed.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/engines/cem_rates.hpp"
#include "impact_damper/motion/system.hpp"
#include "impact_damper/simulate.hpp"
#include "rejection.hpp"
#include "same_run.hpp"

using namespace impact_damper;
using reference::columns_of, reference::everything, reference::farthest, reference::order;

namespace {

using std::numbers::pi;

template <class Real = double>
Run simulated(const Scene& scene, const Cem& options, const Record& record) {
  TestObserver<Real> recorder(record);
  const Outcome end = observed(scene, options, recorder);
  Run run{.stop_reason = end.stop_reason,
          .end_time = end.end_time,
          .scene = scene,
          .engine = resolved(scene, options)};
  recorder.finish(run);
  return run;
}

// Of errors at a step, its half and its quarter.
void check_order(const std::array<double, 3>& error, double expected, double tolerance = 0.1) {
  CHECK(order(error[0], error[1]) == doctest::Approx(expected).epsilon(tolerance));
  CHECK(order(error[1], error[2]) == doctest::Approx(expected).epsilon(tolerance));
}

// x at `time` with step h in a scene whose secondary mass touches no wall.
double x_at(Scene scene, double time, double h) {
  scene.until_time = time;
  const Run run =
      simulated(scene, {.time_step = h, .unstable = true}, {.impacts = true, .history = {{time, time, 1}}});
  REQUIRE(run.impacts->time.empty());
  REQUIRE(run.history->time.size() == 1);
  return run.history->x[0];
}

void check_second_order(const Scene& scene, double time, double exact) {
  std::array<double, 4> error;
  for (int i = 0; i < 4; ++i) error[i] = std::abs(x_at(scene, time, 0.1 / (1 << i)) - exact);
  for (int i = 0; i < 3; ++i) CHECK(order(error[i], error[i + 1]) == doctest::Approx(2).epsilon(0.05));
}

// One impact of the left wall and nothing else: a wall so stiff that the primary mass's spring counts for
// 1e-9 during the contact. `phase`: where in a step the touch comes.
struct OneImpact {
  Scene scene;
  double step = 0;
};
OneImpact one_impact(Scene scene, double steps_per_contact, double phase) {
  scene.damper().wall_stiffness = 1e10;
  scene.x0 = 0;
  scene.damper().w0 = -1;
  const double contact = nominal_contact_time(scene.damper()), h = contact / steps_per_contact;
  scene.damper().y0 = 0.3 * contact + phase * h;
  scene.until_time = 3.5 * contact;
  return {scene, h};
}

double delivered_restitution(const Scene& start, Cem options, double steps_per_contact, double phase) {
  const auto [scene, h] = one_impact(start, steps_per_contact, phase);
  options.time_step = h;
  const Run run =
      simulated(scene, options, {.impacts = true, .history = {{*scene.until_time, *scene.until_time, 1}}});
  REQUIRE(run.impacts->time.size() == 1);
  const double v = run.history->v[0], w = run.history->dampers[0].w[0];
  // Momentum is conserved by the scheme itself: the spring's impulse, 1e-12, and rounding are left.
  CHECK((1 + scene.damper().mass_ratio) * v + scene.damper().mass_ratio * w ==
        doctest::Approx(-scene.damper().mass_ratio).epsilon(1e-8));
  return w;
}

// Over touches and releases at all phases of a step: the error is erratic in both if they are not located.
double mean_over_phases(int steps_per_contact, const std::function<double(double, double)>& error) {
  double sum = 0;
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 8; ++j) sum += std::abs(error(steps_per_contact + j / 8.0, (i + 0.5) / 16));
  return sum / (16 * 8);
}

double mean_restitution_error(const Scene& scene, const Cem& options, int steps_per_contact, double exact) {
  return mean_over_phases(steps_per_contact, [&](double steps, double phase) {
    return delivered_restitution(scene, options, steps, phase) - exact;
  });
}

// log of the growth per step of a regime's fastest growing mode: power iteration on the step as it is.
double growth(const Scene& scene, Damper damper, Regime regime, double h) {
  const auto equations = regime_equations<double>(scene, scene.damper(), Calibration::fixed_wall, regime);
  const CemStep<double> a = cem_step(equations, damper, h);
  Eigen::Vector4d u(0.3, 0.1, 0.2, -0.4);         // x, q, dx, dq
  if (regime == Regime::flight) u[1] = u[3] = 0;  // q only drifts along
  double log_norm = 0;
  constexpr int settle = 20000, steps = 20000;
  for (int n = 0; n < settle + steps; ++n) {
    const double dx = a.dx_dx * u[2] + a.dx_dq * u[3] + a.dx_x * u[0] + a.dx_q * u[1];
    const double dq = a.dq_dx * u[2] + a.dq_dq * u[3] + a.dq_x * u[0] + a.dq_q * u[1];
    u = {u[0] + dx, regime == Regime::flight ? 0 : u[1] + dq, dx, regime == Regime::flight ? 0 : dq};
    const double norm = u.norm();
    if (n >= settle) log_norm += std::log(norm);
    u /= norm;
  }
  return log_norm / steps;
}

constexpr double always = 1e6;  // a stuck speed faster than any impact here

// Equation (9) with the force divided by 1 + nu, by the classical Runge-Kutta method.
struct Joined {
  long double nu, zeta, f0, omega_f;
  long double t = 0, x = 0, v = 0;

  long double acceleration(long double at, long double its_x, long double its_v) const {
    return (f0 * std::sin(omega_f * at) - 2 * zeta * its_v - its_x) / (1 + nu);
  }
  void step(long double h) {
    const long double a1 = acceleration(t, x, v), v2 = v + h / 2 * a1;
    const long double a2 = acceleration(t + h / 2, x + h / 2 * v, v2), v3 = v + h / 2 * a2;
    const long double a3 = acceleration(t + h / 2, x + h / 2 * v2, v3), v4 = v + h * a3;
    const long double a4 = acceleration(t + h, x + h * v3, v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    t += h;
  }
  // On to where x'' changes its sign.
  void part() {
    const long double sign = acceleration(t, x, v) > 0 ? 1 : -1;
    for (long double h = 1e-3L; h > 1e-17L;) {
      Joined next = *this;
      next.step(h);
      if (sign * next.acceleration(next.t, next.x, next.v) < 0) {
        h /= 2;
      } else {
        *this = next;
      }
    }
  }
};

// Pressed to the left wall at rest from the beginning, with damping and a force.
const Scene pressed{.damping_ratio = 0.2,
                    .x0 = -2,
                    .force_amplitude = 0.3,
                    .force_frequency = 1.7,
                    .until_time = 2,
                    .dampers = {{.mass_ratio = 0.5, .wall_stiffness = 100}}};

}  // namespace

TEST_CASE("the fastest contact frequency is the largest eigenvalue of the undamped contact system") {
  for (double nu : {1e-4, 0.02, 1.0, 30.0})
    for (double k : {1e-3, 1.0, 1e4, 1e9}) {
      Eigen::Matrix2d mass{{1, 0}, {0, nu}}, stiffness{{1 + k, -k}, {-k, k}};
      const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> solver(stiffness, mass);
      CHECK(fastest_contact_frequency({.dampers = {{.mass_ratio = nu, .wall_stiffness = k}}}) ==
            doctest::Approx(std::sqrt(solver.eigenvalues()[1])).epsilon(1e-12));
    }
}

TEST_CASE("the lagged limit is that of the contact between free masses when the wall is stiff") {
  for (double e : {1.0, 0.8, 0.6, 0.2, 0.0})
    for (double nu : {0.02, 1.0}) {
      const Scene scene{.dampers = {{.mass_ratio = nu, .restitution = e, .wall_stiffness = 1e10}}};
      const double omega = omega_m(scene.damper()) * std::sqrt(1 + nu),
                   z = zeta_m_closed_form(e) * std::sqrt(1 + nu);
      CHECK(stability_limit(scene, Damper::lagged, Calibration::fixed_wall) ==
            doctest::Approx(2 * (std::sqrt(1 + z * z) - z) / omega).epsilon(1e-9));  // of order nu/k
    }
}

TEST_CASE(
    "modes keep still just below the stability limit and grow just above it, in flight and in contact") {
  for (const Scene& scene :
       {Scene{}, Scene{.dampers = {{.restitution = 1}}}, Scene{.dampers = {{.restitution = 0}}},
        Scene{.damping_ratio = 0.3, .dampers = {{.mass_ratio = 1.5, .wall_stiffness = 3}}},
        Scene{.damping_ratio = 2, .dampers = {{.restitution = 0.2, .wall_stiffness = 50}}}}) {
    for (Damper damper : {Damper::centred, Damper::lagged}) {
      INFO("damper ", name_of(damper), ", wall_stiffness ", scene.damper().wall_stiffness);
      CAPTURE(scene.damper().restitution);
      const double limit = stability_limit(scene, damper, Calibration::fixed_wall);
      // What is left below is the beat of a bounded mode over the 2e4 steps; growth above is 1e-3 or, damped,
      // nearly.
      CHECK(growth(scene, damper, Regime::contact, limit * (1 - 1e-3)) < 1e-4);
      CHECK(growth(scene, damper, Regime::contact, limit * (1 + 1e-3)) > 5e-4);
      CHECK(growth(scene, damper, Regime::flight, 2 * (1 - 1e-3)) < 1e-4);
      CHECK(growth(scene, damper, Regime::flight, 2 * (1 + 1e-3)) > 5e-4);
      CHECK(limit < 2);
    }
  }
}

TEST_CASE("beyond the limit an undamped mode grows as fast as the difference equation says") {
  // lambda + 1/lambda = 2 - (omega h)^2
  const Scene scene{.dampers = {{.restitution = 1}}};
  const double omega = fastest_contact_frequency(scene);
  for (double excess : {1e-3, 1e-2, 0.3}) {
    const double by_theory = std::acosh(2 * (1 + excess) * (1 + excess) - 1);
    for (Damper damper : {Damper::centred, Damper::lagged}) {
      CHECK(growth(scene, damper, Regime::flight, 2 * (1 + excess)) ==
            doctest::Approx(by_theory).epsilon(1e-4));
      CHECK(growth(scene, damper, Regime::contact, 2 * (1 + excess) / omega) ==
            doctest::Approx(by_theory).epsilon(1e-4));
    }
  }
}

TEST_CASE("a pressed contact rings up just above the limit and dies away just below it") {
  for (double e : {0.6, 0.95})
    for (Damper damper : {Damper::centred, Damper::lagged}) {
      // x < 0 presses the mass to the left wall by about nu x / (k (1 + nu)); begun 2 % off that.
      Scene scene{.x0 = -1000, .until_time = 0.8, .dampers = {{.restitution = e}}};
      const double compliance =
          scene.damper().mass_ratio / (scene.damper().wall_stiffness * (1 + scene.damper().mass_ratio));
      scene.damper().y0 = 1.02 * compliance * scene.x0;
      const double limit = stability_limit(scene, damper, Calibration::fixed_wall);
      const auto ringing = [&](double h) {
        const Run run = simulated(scene, {.time_step = h, .damper = damper, .unstable = true},
                                  {.history = {{0.3, 0.8, 200}}});
        double largest = 0;
        for (std::size_t i = 0; i < run.history->x.size(); ++i) {
          const double pressed_to = compliance * run.history->x[i];
          largest = std::max(largest, std::abs(run.history->dampers[0].y[i] / pressed_to - 1));
        }
        return largest;
      };
      CHECK(ringing(0.97 * limit) < 0.021);
      CHECK(ringing(1.03 * limit) > 1);
    }
}

TEST_CASE("a step beyond the stability limit is rejected with the step, the limit and the way out") {
  const Scene scene{.until_time = 1};
  for (Damper damper : {Damper::centred, Damper::lagged}) {
    const double limit = stability_limit(scene, damper, Calibration::fixed_wall);
    CHECK_NOTHROW(simulated(scene, {.time_step = limit, .damper = damper}, {}));
    CHECK_NOTHROW(simulated(scene, {.time_step = 1.01 * limit, .damper = damper, .unstable = true}, {}));
    CHECK_THROWS_AS(simulated(scene, {.time_step = 1.000001 * limit, .damper = damper}, {}),
                    std::invalid_argument);
  }
  const std::string message =
      rejection_of<std::invalid_argument>([&] { simulated(scene, {.time_step = 0.003}, {}); });
  CAPTURE(message);
  for (const char* part : {"time_step", "0.003", "0.00280055", "714.143", "centred", "contact", "--unstable"})
    CHECK(contains(message, part));
  for (double h : {0.0, -1e-3, double(NAN), double(INFINITY)})
    CHECK_THROWS_AS(simulated(scene, {.time_step = h, .unstable = true}, {}), std::invalid_argument);
}

TEST_CASE("an unstable run that overflows ends in a numerical failure") {
  const Scene scene{.until_time = 1e5};
  CHECK_THROWS_AS(simulated(scene, {.time_step = 2.1, .unstable = true}, everything()), NumericalError);
}

TEST_CASE("the default step is a hundredth of the fastest of contact, primary mass and forcing") {
  CHECK(*resolved({}, {}).time_step == nominal_contact_time(SceneDamper{}) / 100);
  CHECK(*resolved({.dampers = {{.wall_stiffness = 1e-6}}}, {}).time_step == pi / 100);
  CHECK(*resolved({.force_amplitude = 1, .force_frequency = 5000}, {}).time_step == pi / 5000 / 100);
  CHECK(*resolved({}, {.time_step = 1e-3}).time_step == 1e-3);
}

TEST_CASE("without contact x converges to the closed forms with second order") {
  Scene scene{.x0 = 0.2, .v0 = 0.1, .dampers = {{.y0 = 0.5, .w0 = -0.1}}};
  check_second_order(scene, 9.7, 0.2 * std::cos(9.7) + 0.1 * std::sin(9.7));

  scene.damping_ratio = 0.1;
  const double omega = std::sqrt(0.99);
  check_second_order(scene, 9.7,
                     std::exp(-0.97) * (0.2 * std::cos(omega * 9.7) + 0.12 / omega * std::sin(omega * 9.7)));

  scene.damping_ratio = 2;  // x'' + 4 x' + x = 0
  const double fast = -2 - std::sqrt(3), slow = -2 + std::sqrt(3);
  const double a = (0.1 - fast * 0.2) / (slow - fast);
  check_second_order(scene, 2.3, a * std::exp(slow * 2.3) + (0.2 - a) * std::exp(fast * 2.3));
}

TEST_CASE("forced response and resonance converge to the closed forms with second order") {
  Scene scene{.x0 = 0, .force_amplitude = 0.02, .force_frequency = 1.7, .dampers = {{.y0 = 0.5}}};
  scene.damper().w0 = 0;
  check_second_order(scene, 19.3, 0.02 / (1 - 1.7 * 1.7) * (std::sin(1.7 * 19.3) - 1.7 * std::sin(19.3)));
  scene.force_frequency = 1;
  check_second_order(scene, 19.3, 0.01 * (std::sin(19.3) - 19.3 * std::cos(19.3)));
}

TEST_CASE("forcing is as good after many steps as at the first") {
  // At resonance the envelope grows as f0 t / 2; 2e6 steps reseed the forcing's recurrence 2e3 times.
  Scene scene{.x0 = 0, .force_amplitude = 4e-4, .dampers = {{.y0 = 0.5}}};
  const double time = 2000.1, h = 1e-3;
  CHECK(x_at(scene, time, h) ==
        doctest::Approx(2e-4 * (std::sin(time) - time * std::cos(time))).epsilon(2e-4));
}

TEST_CASE("half cycles have the closed form's crossings and amplitudes, to second order") {
  // Undamped, x = A cos(t - phase): crossings at phase + pi/2 + n pi, every amplitude A.
  Scene scene{.x0 = 0.2, .v0 = 0.1, .until_time = 20, .dampers = {{.y0 = 0.5, .w0 = -0.1}}};
  const double amplitude = std::hypot(0.2, 0.1), phase = std::atan2(0.1, 0.2);
  for (double h : {0.02, 0.01}) {
    const Run run = simulated(scene, {.time_step = h, .unstable = true}, {});
    const HalfCycles& rows = *run.half_cycles;
    REQUIRE(rows.amplitude.size() == 6);
    for (std::size_t i = 0; i < 6; ++i) {
      // The scheme's own period is short by h^2/24, its amplitude large by h^2/8 at most.
      const double time = phase + double(i) * pi, slip = time * h * h / 20 + h * h;
      CHECK(std::abs(rows.zero_crossing[i] - (time + pi / 2)) < slip + h * h);
      CHECK(std::abs(rows.peak_time[i] - time) < slip);
      CHECK(std::abs(rows.amplitude[i] - amplitude) < amplitude * h * h / 8);
      CHECK(rows.impacts[i] == 0);
    }
  }
}

TEST_CASE("released from rest the first amplitude is the release, at time 0") {
  const Scene scene{.until_time = 10};
  const Run run = simulated(scene, {}, {});
  CHECK(run.half_cycles->amplitude[0] == 6);
  CHECK(run.half_cycles->peak_time[0] == 0);
}

TEST_CASE("located, one impact delivers the contact's restitution to second order") {
  for (double e : {0.6, 0.9, 0.2}) {
    const Scene scene{.dampers = {{.restitution = e}}};
    const double z = zeta_m_closed_form(e) * std::sqrt(1 + scene.damper().mass_ratio);
    const double exact = std::exp(-pi * z / std::sqrt(1 - z * z));
    std::array<double, 3> error;
    for (int i = 0; i < 3; ++i) error[i] = mean_restitution_error(scene, {.locate = true}, 40 << i, exact);
    CHECK(error[0] < 2e-3);
    check_order(error, 2);
    CHECK(order(error[1], error[2]) == doctest::Approx(2).epsilon(0.05));
  }
  const double delivered =
      delivered_restitution({}, {.locate = true, .calibration = Calibration::two_body}, 1600, 0.3);
  CHECK(delivered == doctest::Approx(0.6).epsilon(1e-5));
}

TEST_CASE("not located, or with the damper lagged, one impact is accurate to first order only") {
  const Scene scene;
  const double z = zeta_m_closed_form(0.6) * std::sqrt(1.02),
               exact = std::exp(-pi * z / std::sqrt(1 - z * z));
  for (const Cem& options :
       {Cem{}, Cem{.damper = Damper::lagged}, Cem{.damper = Damper::lagged, .locate = true}}) {
    std::array<double, 3> error;
    for (int i = 0; i < 3; ++i) error[i] = mean_restitution_error(scene, options, 100 << i, exact);
    check_order(error, 1, 0.15);
  }
}

TEST_CASE("an impact, its wall, time and speed are where a mass in uniform flight meets the wall") {
  // x stays at rest until the first impact: y = y0 + w0 t.
  for (bool locate : {false, true}) {
    Scene scene{.x0 = 0, .until_time = 2, .dampers = {{.y0 = 0.25, .w0 = 0.5}}};
    const Run run = simulated(scene, {.locate = locate}, everything());
    REQUIRE(run.impacts->time.size() == 1);
    CHECK(run.impacts->time[0] == doctest::Approx(1.5).epsilon(1e-9));
    CHECK(run.impacts->wall[0] == Wall::right);
    CHECK(run.impacts->relative_velocity[0] == doctest::Approx(0.5).epsilon(1e-9));
    REQUIRE(run.contacts->begin.size() == 1);
    CHECK(run.contacts->begin[0] == run.impacts->time[0]);
    CHECK(run.contacts->wall[0] == Wall::right);
    const double z = zeta_m_closed_form(0.6) * std::sqrt(1.02);
    const double contact = nominal_contact_time(scene.damper()) / std::sqrt(1 - z * z);
    CHECK(run.contacts->end[0] - run.contacts->begin[0] == doctest::Approx(contact).epsilon(0.02));
  }
}

TEST_CASE("not located, a step from one wall through to beyond the other is an impact of the other") {
  // A lossless wall with omega_m h = 1, and a mass so light that nothing else moves: beside the wall, as far
  // as it is overlapped, u_{n+1} = u_n - u_{n-1}. What comes with steps of s = 4 and overlaps by d, goes on
  // to s, s - d and -d: three steps on it stands as deep in the gap as it was in the wall, and as fast. The
  // gap is 1, so the other wall is overlapped by d - 1 at once, until the fourth contact (d = 0.5) ends
  // inside the gap.
  constexpr double h = 0x1p-20;
  constexpr int period = 13, periods = 10;
  const Scene scene{
      .x0 = 0,
      .until_time = periods * period * h,
      .dampers = {{.mass_ratio = h * h, .restitution = 1, .wall_stiffness = 1, .y0 = 0.5, .w0 = -4 / h}}};
  const Run run = simulated(
      scene, {.time_step = h},
      {.impacts = true, .contacts = true, .history = {{0, *scene.until_time, periods * period + 1}}});
  const std::array<double, period> y{0.5, -3.5, -4, -0.5, 3.5, 5, 2.5, -1.5, -4, -2.5, 1.5, 5, 4.5};
  // An impact gives the primary mass 2 nu w = 8 h, which in 130 steps could take it 1e-9 away.
  REQUIRE(run.history->dampers[0].y.size() == periods * period + 1);
  for (int n = 0; n <= periods * period; ++n)
    CHECK(run.history->dampers[0].y[n] == doctest::Approx(y[n % period]).epsilon(1e-9));
  REQUIRE(run.impacts->time.size() == 4 * periods);
  REQUIRE(run.contacts->begin.size() == 4 * periods);
  for (int i = 0; i < 4 * periods; ++i) {
    CHECK(run.impacts->wall[i] == (i % 2 ? Wall::right : Wall::left));
    // In the step that ends beyond the wall: numbers 1, 4, 7 and 10 of a period.
    CHECK(std::ceil(run.impacts->time[i] / h) == period * (i / 4) + 1 + 3 * (i % 4));
    // From the last contact of a period a step in the gap leads to the next.
    if (i % 4) CHECK(run.impacts->time[i] == run.contacts->end[i - 1]);
  }
}

TEST_CASE("a mass pressed to the wall at the start is in contact but makes no impact") {
  for (bool locate : {false, true}) {
    Scene scene{.x0 = -3, .until_time = 1};  // y'' = x < 0
    const Run run = simulated(scene, {.locate = locate}, everything());
    CHECK(run.impacts->time.empty());
    REQUIRE(run.contacts->begin.size() >= 1);
    CHECK(run.contacts->begin[0] == 0);
    CHECK(run.contacts->wall[0] == Wall::left);
    CHECK(run.energy->impact_loss.empty());
    CHECK(run.energy->contact_loss > 0);
  }
}

TEST_CASE("over one impact the energy balance's residual is of second order, located or not") {
  for (const Cem& options : {Cem{}, Cem{.locate = true}, Cem{.damper = Damper::lagged}}) {
    const auto residual = [&](double steps, double phase) {
      const auto [scene, h] = one_impact({}, steps, phase);
      Cem with_step = options;
      with_step.time_step = h;
      return simulated(scene, with_step, everything()).energy->residual;
    };
    std::array<double, 3> error;
    for (int i = 0; i < 3; ++i) error[i] = mean_over_phases(100 << i, residual);
    check_order(error, 2);
  }
}

TEST_CASE(
    "over a decay with located events the energy balance closes with second order, with the stuck regime, "
    "too") {
  for (const std::optional<double> stuck_speed : {std::optional<double>(), std::optional(0.3)})
    for (double zeta : {0.0, 0.008})
      for (double force : {0.0, 0.3}) {
        const Scene scene{
            .damping_ratio = zeta, .force_amplitude = force, .force_frequency = 0.8, .until_time = 12};
        INFO("stuck ", stuck_speed.has_value(), ", zeta ", zeta, ", force ", force);
        std::array<double, 3> residual;
        for (int i = 0; i < 3; ++i) {
          const Run run =
              simulated(scene, {.time_step = 1e-4 / (1 << i), .locate = true, .stuck_speed = stuck_speed},
                        everything());
          const EnergyBalance& balance = *run.energy;
          residual[i] = std::abs(balance.residual);
          CHECK(balance.impact_loss.size() == run.impacts->time.size());
          for (double loss : balance.impact_loss) CHECK(loss >= 0);
          CHECK((balance.viscous_work > 0) == (zeta > 0));
          CHECK((balance.forcing_work != 0) == (force != 0));
          double longest = 0;
          for (std::size_t n = 0; n < run.contacts->end.size(); ++n)
            longest = std::max(longest, run.contacts->end[n] - run.contacts->begin[n]);
          if (stuck_speed) CHECK(longest > 0.3);
        }
        CHECK(residual[0] < 1e-5);
        check_order(residual, 2);
      }
}

TEST_CASE("energy never rises unforced, from sample to sample, beyond the scheme's own error") {
  for (const Cem& options : {Cem{}, Cem{.locate = true}, Cem{.damper = Damper::lagged}}) {
    Scene scene{.until_time = 100};
    const Run run = simulated(scene, options, {.history = {{0, 100, 4001}}});
    const History& h = *run.history;
    double before = INFINITY, largest_rise = 0;
    for (std::size_t i = 0; i < h.time.size(); ++i) {
      const double nu = scene.damper().mass_ratio, y = h.dampers[0].y[i],
                   q = std::min(y, std::max(y - 1, 0.0));
      const double energy = (h.v[i] * h.v[i] + nu * std::pow(h.v[i] + h.dampers[0].w[i], 2) +
                             h.x[i] * h.x[i] + scene.damper().wall_stiffness * q * q) /
                            2;
      largest_rise = std::max(largest_rise, energy - before);
      before = energy;
    }
    // In contact the scheme's energy swings about the true one by (omega_c h)^2 / 8 of what the impact
    // stores, at most 0.02 * 6^2 / 2; omega_c h = pi / 100.
    CHECK(largest_rise < 4.4e-5);
  }
}

TEST_CASE("a lossless wall keeps the energy") {
  for (bool locate : {false, true}) {
    Scene scene{.until_time = 30, .dampers = {{.restitution = 1}}};
    const Run run = simulated(scene, {.locate = locate}, everything());
    CHECK(run.impacts->time.size() > 10);
    // Unlocated, touch and release find overlaps of up to a step's way: (omega_c h)^2 of what an impact
    // stores, with either sign. Located, what is left is the third order of the arcs.
    CHECK(std::abs(run.energy->final.total() / 18 - 1) < (locate ? 1e-7 : 2e-5));
    CHECK(std::abs(run.energy->residual) < (locate ? 1e-7 : 2e-5));
    for (double loss : run.energy->impact_loss) CHECK(loss == 0);
  }
}

TEST_CASE("history samples come at the times asked for and change nothing else") {
  Scene scene{.until_time = 20};
  const Record plain = everything(), sampled = everything({{0, 1, 11}, {5.05, 5.15, 5}, {19, 25, 7}});
  for (bool locate : {false, true}) {
    const Run a = simulated(scene, {.locate = locate}, plain),
              b = simulated(scene, {.locate = locate}, sampled);
    const std::vector<double>& time = b.history->time;
    REQUIRE(time.size() == 11 + 5 + 2);  // 19 and 20; the run ends before the others
    CHECK(time[0] == 0);
    CHECK(b.history->x[0] == 6);
    CHECK(b.history->dampers[0].y[0] == 0);
    CHECK(time[10] == 1);
    CHECK(time[11] == 5.05);
    CHECK(time[15] == 5.15);
    CHECK(time[17] == 20);
    CHECK(a.impacts->time == b.impacts->time);
    CHECK(a.half_cycles->amplitude == b.half_cycles->amplitude);
    for (std::size_t i = 0; i < 5; ++i) {  // the first flight: x = 6 cos t, y = 6 - x
      if (time[i] > 0.5) continue;
      CHECK(b.history->x[i] == doctest::Approx(6 * std::cos(time[i])).epsilon(1e-8));
      CHECK(b.history->v[i] == doctest::Approx(-6 * std::sin(time[i])).epsilon(1e-8));
      CHECK(b.history->dampers[0].y[i] == doctest::Approx(6 - b.history->x[i]).epsilon(1e-9));
    }
  }
}

TEST_CASE("a window below an amplitude begins at the zero crossing that ends its half cycle") {
  Scene scene{.until_amplitude = 5.5};
  const Run run = simulated(scene, {}, {.history_below = {{5.9, 2, 3}}});
  const HalfCycles& rows = *run.half_cycles;
  std::size_t i = 0;
  while (rows.amplitude[i] >= 5.9) ++i;
  REQUIRE(run.history->time.size() == 3);
  CHECK(run.history->time[0] == rows.zero_crossing[i]);
  CHECK(std::abs(run.history->x[0]) < 1e-7);  // the parabola's zero, to rounding in the step's own position
  CHECK(run.history->time[2] == doctest::Approx(rows.zero_crossing[i] + 2).epsilon(1e-15));
}

TEST_CASE("a run ends at its time, its amplitude or its budget, and says which") {
  Scene scene{.until_time = 5.25};
  CHECK(simulated(scene, {}, {}).end_time == 5.25);
  CHECK(simulated(scene, {}, {}).stop_reason == StopReason::time);

  scene = {.until_amplitude = 5.9};
  Run run = simulated(scene, {}, {});
  CHECK(run.stop_reason == StopReason::amplitude);
  CHECK(run.end_time == run.half_cycles->zero_crossing.back());
  CHECK(run.half_cycles->amplitude.back() < 5.9);
  CHECK(run.half_cycles->amplitude.rbegin()[1] >= 5.9);

  Cem options{.budget = {.max_impacts = 7}};
  run = simulated(scene, options, everything());
  CHECK(run.stop_reason == StopReason::impact_budget);
  CHECK(run.impacts->time.size() == 7);
  CHECK(run.end_time > run.impacts->time.back());  // just before the one too many
  CHECK(run.energy->impact_loss.size() == 7);

  options.budget = {.max_half_cycles = 3};
  run = simulated(scene, options, {});
  CHECK(run.stop_reason == StopReason::half_cycle_budget);
  CHECK(run.half_cycles->amplitude.size() == 3);

  scene.damping_ratio = 1.5;  // never crosses zero
  options.budget = {.max_time = 40};
  run = simulated(scene, options, {});
  CHECK(run.stop_reason == StopReason::time_budget);
  CHECK(run.end_time == 40);
}

TEST_CASE("a run ends when its steps are used up, wherever the last of them leads") {
  const double h = 1e-3;
  const auto after = [&](std::int64_t steps, bool locate, const Scene& scene) {
    return simulated(scene, {.time_step = h, .locate = locate, .max_steps = steps}, everything());
  };
  // Without located events the steps are counted from the start; the books close as at a time given.
  for (const double force_amplitude : {0.0, 1.0}) {
    const Scene scene{.force_amplitude = force_amplitude, .until_time = 1e6};
    for (const std::int64_t steps : {1, 2, 1024, 1025, 5000}) {
      CAPTURE(steps);
      const Run run = after(steps, false, scene);
      CHECK(run.stop_reason == StopReason::step_budget);
      CHECK(run.end_time == doctest::Approx(double(steps) * h).epsilon(1e-13));
      Scene timed = scene;
      timed.until_time = run.end_time;
      const Run same = simulated(timed, {.time_step = h}, everything());
      CHECK(run.impacts->time == same.impacts->time);
      CHECK(run.energy->final.total() == doctest::Approx(same.energy->final.total()).epsilon(1e-12));
      CHECK(std::abs(run.energy->residual - same.energy->residual) < 1e-12);
    }
  }
  // A located event shortens a step, so one step more leads farther by h at most, through contacts as well.
  const Scene scene{.until_time = 1e6};
  double last = 0;
  for (std::int64_t steps = 1; steps < 3000; ++steps) {
    const Run run = after(steps, true, scene);
    CHECK(run.stop_reason == StopReason::step_budget);
    CHECK(run.end_time > last);
    CHECK(run.end_time <= last + h * (1 + 1e-12));
    last = run.end_time;
  }
  CHECK(last > 2);
  CHECK(after(3000, true, scene).impacts->time.size() == 3);

  // What ends a run in its last step goes before.
  CHECK(after(100, false, {.until_time = 99.5 * h}).stop_reason == StopReason::time);
  CHECK_THROWS_WITH_AS(after(0, false, scene), "max_steps: must be >= 1, got 0", std::invalid_argument);
}

TEST_CASE("a scene at rest, whose amplitude never comes to an end, stops when its steps are used up") {
  const Run run =
      simulated({.x0 = 0, .until_amplitude = 0.1, .dampers = {{.y0 = 0.5}}}, {.max_steps = 100'000}, {});
  CHECK(run.stop_reason == StopReason::step_budget);
}

TEST_CASE("extended precision gives the same run to the last digits but a few") {
  for (bool locate : {false, true}) {
    Scene scene{.until_time = 30};
    const Run a = simulated<double>(scene, {.locate = locate}, everything());
    const Run b = simulated<long double>(scene, {.locate = locate}, everything());
    CHECK(farthest(a.impacts->time, b.impacts->time) < 1e-8);
    CHECK(farthest(a.half_cycles->amplitude, b.half_cycles->amplitude) < 1e-9);
  }
}

TEST_CASE("an arc falls through zero at the first root of its parabola at which it goes down") {
  CHECK(Arc<double>{2.5, -3, 1}.fall(5) == doctest::Approx(1));  // the other root, 5, goes up
  CHECK(Arc<double>{0, 1, -2}.fall(5) == doctest::Approx(1));    // not at its beginning, where it rises
  CHECK(Arc<double>{1, 0, -2}.fall(5) == doctest::Approx(1));
  CHECK(Arc<double>{0, -1, 0}.fall(5) == 0);
  CHECK(Arc<double>{0, 0, 0}.fall(5) == 0);
  CHECK(Arc<double>{6, -1, 0}.fall(5) == 5);
}

TEST_CASE("samples are continuous through the step in which a wall is met") {
  for (bool locate : {false, true}) {
    Scene scene{
        .x0 = 0, .until_time = 1.5001, .dampers = {{.y0 = 0.25, .w0 = 0.5}}};  // meets the right wall at 1.5
    const Run run = simulated(scene, {.locate = locate}, {.history = {{1.4999, 1.5001, 401}}});
    const History& h = *run.history;
    REQUIRE(h.time.size() == 401);
    // Within 1e-4 of contact the damper, c = 2 omega_m zeta_m = 227, bends y by less than 227 w (1e-4)^2 / 2.
    for (std::size_t i = 0; i < h.time.size(); ++i)
      CHECK(std::abs(h.dampers[0].y[i] - (0.25 + 0.5 * h.time[i])) < 3e-6);
  }
}

TEST_CASE("the phase of an impact counts from the zero crossing before it") {
  Scene scene{.until_time = 30};
  const Run run = simulated(scene, {}, everything());
  const std::vector<double>& zero = run.half_cycles->zero_crossing;
  std::size_t row = 0, checked = 0;
  for (std::size_t i = 0; i < run.impacts->time.size(); ++i) {
    while (row < zero.size() && run.impacts->time[i] > zero[row]) ++row;
    if (row == 0 || row == zero.size()) continue;
    const double phase = 180 * (run.impacts->time[i] - zero[row - 1]) / (zero[row] - zero[row - 1]);
    CHECK(run.impacts->phase_deg[i].value() == doctest::Approx(phase).epsilon(1e-12));
    ++checked;
  }
  CHECK(checked > 50);
}

// --- The paper's stuck regime (Cem::stuck_speed) ----------------------------------------------------------

// Against the restitution engine with e = 0, whose impacts all join the masses where the wall pushes, and
// against integrations of its own.

TEST_CASE("both masses move by equation (9) and part where x'' changes its sign, with second order") {
  Joined joined{pressed.damper().mass_ratio,
                pressed.damping_ratio,
                pressed.force_amplitude,
                pressed.force_frequency,
                0,
                pressed.x0};
  for (int i = 0; i < 100; ++i) joined.step(0.005L);
  const double x_at_half = double(joined.x), v_at_half = double(joined.v);
  joined.part();
  REQUIRE(joined.t > 1);
  REQUIRE(joined.t < 2);
  const Record record = everything({{0.5, 0.6, 2}});
  // Where in a step x'' changes its sign decides on the time's error: the mean over neighbouring steps.
  constexpr int neighbours = 16;
  for (const bool two_rates : {false, true}) {
    std::array<double, 3> x{}, v{}, time{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < neighbours; ++j) {
        const double h = (0.02 + 0.002 * j / neighbours) / (1 << i);
        Cem options{.time_step = h, .stuck_speed = always};
        if (two_rates) options = {.time_step = 1e-5, .large_step = h, .stuck_speed = always};
        const Run run = simulate(pressed, options, record);
        REQUIRE(run.contacts->begin.at(0) == 0);
        x[i] += std::abs(run.history->x[0] - x_at_half);
        v[i] += std::abs(run.history->v[0] - v_at_half);
        const double late = std::abs(run.contacts->end[0] - double(joined.t));
        CHECK(late < h * h);
        time[i] += late;
        CHECK(run.history->dampers[0].y[0] == 0);
        CHECK(run.history->dampers[0].w[0] == 0);
        CHECK(run.impacts->time.empty());
      }
    CAPTURE(two_rates);
    check_order(x, 2);
    check_order(v, 2);
    check_order(time, 2);
  }
}

TEST_CASE("from rest in the middle a force moves both masses, from the first step on") {
  // x = f0 omega_f t^3/6 divided by 1 + nu, as long as t is small.
  const double h = 1e-3, f0 = 0.5;
  const Scene scene{.x0 = 0,
                    .force_amplitude = f0,
                    .until_time = 0.1,
                    .dampers = {{.mass_ratio = 0.5, .wall_stiffness = 100}}};
  const Run run =
      simulate(scene, Cem{.time_step = h, .stuck_speed = always}, {.contacts = true, .history = {{0, h, 2}}});
  CHECK(run.history->x[1] == doctest::Approx(f0 * h * h * h / 6 / 1.5).epsilon(1e-3));
  CHECK(run.contacts->end.at(0) == 0.1);
}

TEST_CASE("a slow impact joins the masses with their momentum, at what that costs, until x returns to zero") {
  // x = -cos t; the secondary mass goes straight on, from -0.9 with the speed -0.3.
  const Scene scene{.x0 = -1, .until_time = 3, .dampers = {{.mass_ratio = 0.2, .y0 = 0.1, .w0 = -0.3}}};
  const auto gap = [](double t) { return -0.9 - 0.3 * t + std::cos(t); };
  double before = 0, after = 1;
  while (after - before > 1e-15) {
    const double middle = (before + after) / 2;
    (gap(middle) > 0 ? before : after) = middle;
  }
  const double touch = before, x = -std::cos(touch), v = std::sin(touch), w = -0.3 - v;
  const double nu = scene.damper().mass_ratio, joined_v = v + nu * w / (1 + nu), root = std::sqrt(1 + nu);
  const double end = touch + root * std::atan2(-x / root, joined_v);
  const double loss = nu * w * w / (2 * (1 + nu));
  const Record record = everything({{touch + 0.1, touch + 0.2, 2}});
  const double v_then = joined_v * std::cos(0.1 / root) - x / root * std::sin(0.1 / root);
  for (const bool locate : {false, true}) {
    std::array<double, 3> time, speed;
    for (int i = 0; i < 3; ++i) {
      const Cem options{.time_step = 1e-3 / (1 << i), .locate = locate, .stuck_speed = 0.6};
      const Run run = simulate(scene, options, record);
      REQUIRE(run.impacts->time.size() == 1);
      CHECK(run.impacts->relative_velocity[0] == doctest::Approx(w).epsilon(1e-6));
      CHECK(run.energy->impact_loss.at(0) == doctest::Approx(loss).epsilon(1e-6));
      CHECK(run.energy->contact_loss == 0);
      time[i] = std::abs(run.contacts->end.at(0) - end);
      speed[i] = std::abs(run.history->v[0] - v_then);
    }
    CHECK(time[0] < 1e-6);
    CHECK(speed[0] < 1e-6);
  }
  // The same impact bounces where it is not slow.
  CHECK(std::abs(w) > 0.5);
  const Run bounces = simulate(scene, Cem{.stuck_speed = 0.5}, record);
  CHECK(bounces.impacts->time.size() > 1);
}

TEST_CASE("with every impact slow it converges to the restitution engine at e = 0 with second order") {
  // Three scenes in which the wall pushes at every impact: only then do both join the masses.
  const Scene free{.until_time = 60, .dampers = {{.restitution = 0}}};
  const Scene damped{
      .damping_ratio = 0.02, .x0 = 9, .until_time = 12, .dampers = {{.mass_ratio = 0.5, .restitution = 0}}};
  const Scene forced{.damping_ratio = 0.01,
                     .x0 = 3,
                     .force_amplitude = 0.4,
                     .force_frequency = 0.8,
                     .until_time = 20,
                     .dampers = {{.mass_ratio = 0.1, .restitution = 0}}};
  for (const Scene& scene : {free, damped, forced}) {
    CAPTURE(scene.damper().mass_ratio);
    const Run rigid = simulate(scene, Restitution{}, everything());
    REQUIRE(rigid.contacts->begin.size() > 3);
    for (const bool locate : {false, true}) {
      std::array<double, 3> amplitude{}, part{}, loss{};
      for (int i = 0; i < 3; ++i) {
        const Cem options{.time_step = 2e-3 / (1 << i), .locate = locate, .stuck_speed = always};
        const Run run = simulate(scene, options, everything());
        amplitude[i] = farthest(run.half_cycles->amplitude, rigid.half_cycles->amplitude);
        part[i] = farthest(run.contacts->end, rigid.contacts->end);
        loss[i] = farthest(run.energy->impact_loss, rigid.energy->impact_loss);
      }
      CHECK(amplitude[2] < 1e-5);
      check_order(amplitude, 2);
      check_order(part, 2);
      check_order(loss, 2);
    }
  }
}

TEST_CASE("with a speed that no impact falls below, the run is the one without the regime, bit by bit") {
  const Scene scene{.until_time = 40};
  const Record record = everything({{0, 40, 501}});
  for (const bool locate : {false, true}) {
    const Run without = simulate(scene, Cem{.locate = locate}, record);
    const Run with =
        simulate(scene, Cem{.locate = locate, .stuck_speed = std::numeric_limits<double>::min()}, record);
    CHECK(columns_of(with) == columns_of(without));
    // One speed farther up and it is another one.
    const Run other = simulate(scene, Cem{.locate = locate, .stuck_speed = 0.01}, record);
    CHECK(other.history->x != without.history->x);
  }
}

TEST_CASE("an impact from which the wall withdraws does not join the masses, however slow") {
  // x'' < 0 at the left wall: the wall falls behind a mass that would stay.
  const Scene scene{.x0 = 1, .v0 = 0.5, .until_time = 0.2, .dampers = {{.y0 = 0.01, .w0 = -0.3}}};
  const Run run = simulate(scene, Cem{.stuck_speed = always}, everything());
  REQUIRE(run.impacts->time.size() == 1);
  CHECK(run.contacts->end.at(0) - run.contacts->begin.at(0) < 2 * nominal_contact_time(scene.damper()));
}

TEST_CASE("with two rates the joined masses take large steps, to the same motion") {
  const Scene scene{.x0 = -6, .until_time = 1};
  const Cem options{.time_step = 1e-5, .large_step = 0.05, .stuck_speed = 0.01, .max_steps = 200};
  CHECK(simulate(scene, options, everything()).stop_reason == StopReason::time);
  const Scene decay{.until_time = 60};
  const Run one = simulate(decay, Cem{.locate = true, .stuck_speed = 0.1}, everything());
  const Run two = simulate(decay, Cem{.locate = true, .large_step = 0.02, .stuck_speed = 0.1}, everything());
  // 2e-4 is twice H^2/4, the error of a large step's own.
  CHECK(farthest(one.half_cycles->amplitude, two.half_cycles->amplitude) < 2e-4);
  CHECK(std::abs(two.energy->residual) < 1e-4);
}

TEST_CASE(
    "a contact under a push lasts from W a / omega_c down, W = 2.21 at e = 0.6, in which the default lies") {
  // x'' = 1 to 1e-9 while a contact of a stiff wall lasts: an impact at once, in closed form.
  Scene scene{.x0 = -1, .until_time = 0.01, .dampers = {{.wall_stiffness = 1e10}}};
  const double contact = nominal_contact_time(scene.damper()), per_push = contact / std::numbers::pi;
  const auto lasts = [&](double speed) {
    scene.damper().w0 = -speed * per_push;
    const Run run = simulate(scene, Exact{}, everything());
    return run.contacts->end.at(0) - run.contacts->begin.at(0) > 2 * contact;
  };
  CHECK(lasts(2.20));
  CHECK(!lasts(2.22));
  const double at_paper = 2.21 * nominal_contact_time({}) / std::numbers::pi;
  CHECK(usual_stuck_speed > 1 * at_paper);
  CHECK(usual_stuck_speed < 6 * at_paper);
}

TEST_CASE("a speed that impacts have at small amplitudes too keeps the decay from reaching A = 0.1") {
  const Scene scene{.until_time = 4000, .until_amplitude = 0.1};
  const auto stop = [&](double speed) {
    return simulate(scene, Cem{.locate = true, .large_step = 0.02, .stuck_speed = speed}, {}).stop_reason;
  };
  CHECK(stop(0.4) == StopReason::amplitude);
  CHECK(stop(0.5) == StopReason::time);
}

TEST_CASE("a speed that is no positive number is rejected") {
  const Scene scene;
  for (const double speed : {0.0, -1.0, double(INFINITY), std::nan("")}) {
    const auto problems = problems_of(scene, resolved(scene, Cem{.stuck_speed = speed}));
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].field == "stuck_speed");
    CHECK(problems[0].message.starts_with("must be > 0 and finite, got "));
  }
  CHECK(problems_of(scene, resolved(scene, Cem{.stuck_speed = 1e-300})).empty());
}

// --- Against the exact engine, and with two rates (Cem::large_step) ----------------------------------------

// The component element method against the exact engine, which has no step and shares nothing with it but the
// names of a scene's numbers; and with two rates: no impact missed, nothing of its accuracy lost.

namespace {

// Bounce-down and stuck: no chaos, each stuck phase forgets the one before. Until 160 the amplitude falls
// from 6 to 5.3.
Scene bounce_down(double until) { return {.until_time = until}; }

const Scene forced{.damping_ratio = 0.02,
                   .x0 = 3,
                   .force_amplitude = 0.5,
                   .force_frequency = 0.9,
                   .until_time = 15,
                   .dampers = {{.mass_ratio = 0.1, .restitution = 0.3, .y0 = 0.4}}};
const Scene shaken{.damping_ratio = 0.3,
                   .x0 = 0.5,
                   .v0 = -1,
                   .force_amplitude = 3,
                   .force_frequency = 4,
                   .until_time = 8,
                   .dampers = {{.mass_ratio = 0.5, .restitution = 0.7, .y0 = 0.5}}};
const Scene overlapping{.damping_ratio = 1.2,
                        .x0 = -4,
                        .until_time = 4,
                        .dampers = {{.restitution = 0.2, .y0 = -0.01, .w0 = 0.5}}};
const Scene soft{
    .x0 = 2, .until_time = 8, .dampers = {{.mass_ratio = 0.05, .restitution = 0.5, .wall_stiffness = 50}}};

// x and y at 1001 times, the amplitudes, and the energy at the end.
struct Distance {
  double x, y, amplitude, energy;
};
Record looked_at(const Scene& scene) { return {.energy = true, .history = {{0, *scene.until_time, 1001}}}; }
Distance distance(const Scene& scene, const Cem& options, const Run& exact) {
  const Run run = simulate(scene, options, looked_at(scene));
  return {farthest(run.history->x, exact.history->x),
          farthest(run.history->dampers[0].y, exact.history->dampers[0].y),
          farthest(run.half_cycles->amplitude, exact.half_cycles->amplitude),
          std::abs(run.energy->final.total() - exact.energy->final.total())};
}

// A flight by itself, in closed form.
State<double> flown(const System<double>& system, const State<double>& s, double begin, double t) {
  const auto p = system.free.propagate(t);
  const auto driven = system.free.respond(system.forcing, system.forcing.phase(begin), t, p);
  const double x = s.x * p.c + s.v * p.s + driven.d, v = s.v * p.v - s.x * p.s + driven.d1;
  return {x, v, s.y + (s.v + s.w) * t - (x - s.x), s.v + s.w - v};
}

bool inside(double y) { return y > 0 && y < 1; }

}  // namespace

TEST_CASE(
    "with located events it converges to the exact engine with second order, with the damper lagged with "
    "first") {
  for (const Scene& scene : {bounce_down(160), forced, overlapping}) {
    const Run exact = simulate(scene, Exact{}, looked_at(scene));
    for (const Damper damper : {Damper::centred, Damper::lagged}) {
      CAPTURE(name_of(damper));
      const auto far = [&](double h) {
        return distance(scene, {.time_step = h, .damper = damper, .locate = true}, exact);
      };
      const Distance coarse = far(2e-5), fine = far(1e-5);
      const double expected = damper == Damper::centred ? 2 : 1;
      CHECK(std::abs(order(coarse.x, fine.x) - expected) < 0.15);
      if (fine.amplitude > 0) CHECK(std::abs(order(coarse.amplitude, fine.amplitude) - expected) < 0.15);
      CHECK(std::abs(order(coarse.energy, fine.energy) - expected) < 0.15);
    }
  }
}

TEST_CASE("unlocated it converges with first order, in the mean over neighbouring steps") {
  // The error with a single step depends on where in the step each touch and release happen to fall.
  const Scene scene = bounce_down(160);
  const Run exact = simulate(scene, Exact{}, looked_at(scene));
  for (Damper damper : {Damper::centred, Damper::lagged}) {
    const auto mean = [&](double h) {
      Distance sum{};
      for (int i = 0; i < 16; ++i) {
        const Distance far = distance(scene, {.time_step = h * (1 + i / 32.0), .damper = damper}, exact);
        sum.x += far.x / 16;
        sum.amplitude += far.amplitude / 16;
      }
      return sum;
    };
    const Distance coarse = mean(8e-5), fine = mean(1e-5);
    CHECK(std::abs(order(coarse.x, fine.x) / 3 - 1) < 0.25);
    CHECK(std::abs(order(coarse.amplitude, fine.amplitude) / 3 - 1) < 0.25);
  }
}

TEST_CASE(
    "with the default step a decay to 5.3 has the exact engine's amplitudes, with one rate and with two") {
  const Scene scene = bounce_down(160);
  const Run exact = simulate(scene, Exact{}, looked_at(scene));
  CHECK(distance(scene, {}, exact).amplitude < 2e-3);
  CHECK(distance(scene, {.locate = true}, exact).amplitude < 5e-6);
  CHECK(distance(scene, {.locate = true, .large_step = 0.05}, exact).amplitude < 1e-3);
  CHECK(distance(scene, {.locate = true, .large_step = 0.01}, exact).amplitude < 5e-5);
  CHECK(distance(scene, {.large_step = 0.05}, exact).amplitude < 4e-3);
  CHECK(distance(scene, {.damper = Damper::lagged, .large_step = 0.05}, exact).amplitude < 4e-2);
}

TEST_CASE("a flight that is certified free meets no wall, in closed form or in central differences") {
  std::mt19937 random(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int certain = 0, tight = 0;
  constexpr int trials = 20000;
  for (int i = 0; i < trials; ++i) {
    Scene scene;
    if (i % 2) scene.damping_ratio = std::pow(10, uniform(-3, 0.5));
    if (i % 3) {
      scene.force_amplitude = std::pow(10, uniform(-1, 1));
      scene.force_frequency = std::pow(10, uniform(-1, 1));
    }
    const double large = std::pow(10, uniform(-2.5, -0.4)), begin = uniform(0, 20);
    if (scene.force_amplitude != 0 && scene.force_frequency * large > 1)
      continue;  // too coarse for the force
    if (scene.damping_ratio * large > 0.5) continue;
    const System<double> system(scene);
    const double size = std::pow(10, uniform(-1, 1));
    const State<double> s{uniform(-size, size), uniform(-size, size), uniform(0, 1), uniform(-2, 2)};
    const double f = system.forcing.derivatives<2>(system.forcing.phase(begin))[0];
    const double x2 = f - 2 * system.zeta * s.v - s.x;
    const Certificate<double> sure(system.zeta, system.forcing, s, x2, large, 16 * large, 1, 1);

    // Either so many large steps, or one that is as long as is free.
    int steps = 16;
    while (steps > 0 && !sure.free_for(steps * large)) steps /= 2;
    const double h = steps > 0 ? large : sure.free_time(large) * (1 - 1e-9);
    if (!(h > 1e-6)) continue;
    ++certain;
    steps = std::max(steps, 1);

    const double duration = steps * h;
    for (int j = 1; j <= 64; ++j) CHECK(inside(flown(system, s, begin, duration * j / 64).y));

    // As the engine steps: own velocities are turned into the scheme's.
    const double f1 = system.forcing.derivatives<2>(system.forcing.phase(begin))[1];
    const double v = s.v * std::sqrt(1 - h * h / 4) + h * h / 6 * (f1 - 2 * system.zeta * x2);
    const auto a =
        cem_step(RegimeEquations<double>{.nu = system.nu, .zeta = system.zeta}, Damper::centred, h);
    double x = s.x, y = s.y, dx = h * (v - h * (f - 2 * system.zeta * v - s.x) / 2),
           dq = h * (s.v + s.w) - dx;
    for (int n = 0; n < steps; ++n) {
      const double next = a.dx_dx * dx + a.dx_x * x +
                          a.dx_f * system.forcing.derivatives<2>(system.forcing.phase(begin + n * h))[0];
      dq -= next - dx;
      dx = next;
      x += dx, y += dq;
      CHECK(inside(y));
      if (!inside(y)) MESSAGE("h " << h << " steps " << steps << " y " << y);
    }
    // Not by being too cautious: the wall is near, or the time well used.
    tight += steps == 16 || !inside(flown(system, s, begin, 2.5 * duration).y) ||
             !inside(flown(system, s, begin, 1.5 * duration).y);
  }
  CHECK(certain > trials / 2);
  CHECK(tight > certain / 2);
}

TEST_CASE("two rates find the very impacts that small steps alone find") {
  std::vector<Scene> scenes{bounce_down(60), overlapping, forced, shaken, soft};
  for (double beyond : {1e-2, 1e-4, 1e-6, -1e-6, -1e-4}) {
    scenes.push_back(
        {.x0 = 0.3, .until_time = 4, .dampers = {{.y0 = 0.4 + beyond}}});  // y = y0 + 0.3 (1 - cos t)
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Scene& scene = scenes[i];
    CAPTURE(i);
    for (bool locate : {false, true}) {
      // Unlocated, errors of first order in h decide on bounces so small that the next zero crossing ends
      // them.
      if (!locate && i < 2) continue;
      const Run one = simulate(scene, Cem{.locate = locate}, everything());
      for (double large : {0.02, 0.005}) {
        const Run two = simulate(scene, Cem{.locate = locate, .large_step = large}, everything());
        REQUIRE(one.impacts->wall == two.impacts->wall);
        // The large steps' clock is wrong by H^2/24 of the time, and bounces magnify that.
        const double late = locate ? 5 * large * large : 0.1;
        CHECK(farthest(one.impacts->time, two.impacts->time) < late);
        CHECK(farthest(one.half_cycles->amplitude, two.half_cycles->amplitude) < late);
      }
    }
  }
  CHECK(simulate(scenes[5 + 2], Cem{}, everything()).impacts->time.size() == 1);
  CHECK(simulate(scenes[5 + 3], Cem{}, everything()).impacts->time.empty());
}

TEST_CASE("located, the method is of second order in S3's bounce-down, with one rate and with two") {
  const Scene scene = bounce_down(400);
  const double contact = nominal_contact_time(scene.damper());
  const Run exact = simulate(scene, Exact{}, {});
  const auto error = [&](double steps_in_contact, double large) {
    Cem options{.time_step = contact / steps_in_contact, .locate = true};
    if (large > 0) options.large_step = large;
    return farthest(simulate(scene, options, {}).half_cycles->amplitude, exact.half_cycles->amplitude);
  };
  CHECK(order(error(100, 0), error(800, 0), 8) == doctest::Approx(2).epsilon(0.1));
  CHECK(order(error(160, 0.016), error(1280, 0.002), 8) == doctest::Approx(2).epsilon(0.1));
  CHECK(error(1280, 0.002) < 5e-6);
}

TEST_CASE("located, with both steps halved two rates converge to the exact engine with second order") {
  for (const Scene& scene : {bounce_down(160), forced, shaken, overlapping, soft}) {
    const Run exact = simulate(scene, Exact{}, looked_at(scene));
    const double unit = nominal_contact_time(scene.damper()) / 0.0044;
    const auto far = [&](double scale) {
      return distance(scene, {.time_step = 2e-5 * unit * scale, .locate = true, .large_step = 0.008 * scale},
                      exact);
    };
    const Distance coarse = far(1), fine = far(0.125);
    INFO("mass_ratio ", scene.damper().mass_ratio, ", fine.x ", fine.x);
    CHECK(order(coarse.x, fine.x, 8) == doctest::Approx(2).epsilon(0.1));
    if (fine.amplitude > 0)
      CHECK(order(coarse.amplitude, fine.amplitude, 8) == doctest::Approx(2).epsilon(0.1));
    CHECK(order(coarse.energy, fine.energy, 8) == doctest::Approx(2).epsilon(0.15));
  }
}

TEST_CASE("changing the step does not change the energy") {
  // Without losses; some thousand changes of step.
  Scene scene{.until_time = 300, .dampers = {{.restitution = 1}}};
  for (double large : {0.2, 0.05}) {
    const Run run = simulate(scene, Cem{.locate = true, .large_step = large}, everything());
    CHECK(run.impacts->time.size() > 100);
    CHECK(std::abs(run.energy->final.total() / 18 - 1) < 2e-6);
    CHECK(std::abs(run.energy->residual) < 2e-6);
  }
}

TEST_CASE("damped and forced too, a change of step during rest is wrong by no more than a step's own error") {
  // One small step from rest, then some large ones H. By Taylor's theorem their own error, of order H^2 in
  // the acceleration, has in so many steps come to H^3 in the velocity and H^4 in the position. If H^2/6 (f'
  // - 2 zeta x'') were left out of the velocity handed on, or went in twice, the position would be an order
  // worse.
  constexpr int steps = 4;
  for (double zeta : {0.0, 0.4})
    for (double force : {0.0, 0.3}) {
      if (zeta == 0 && force == 0) continue;
      const auto errors = [&](double large) -> std::array<double, 2> {  // of x, of v
        const double small = 1e-5 * large;
        const Scene scene{.damping_ratio = zeta,
                          .x0 = 0.6,
                          .force_amplitude = force,
                          .force_frequency = 1.5,
                          .until_time = small + steps * large,
                          .dampers = {{.y0 = 0.5}}};
        const Record record{.history = {{0, *scene.until_time, 2}}};
        const Run exact = simulate(scene, Exact{}, record);
        // One step more than that: should the last one end a rounding error short of the time.
        const Run run =
            simulate(scene, Cem{.time_step = small, .large_step = large, .max_steps = 2 + steps}, record);
        REQUIRE(run.stop_reason == StopReason::time);
        return {std::abs(run.history->x[1] - exact.history->x[1]),
                std::abs(run.history->v[1] - exact.history->v[1])};
      };
      const std::array coarse = errors(0.02), fine = errors(0.0025);
      INFO("zeta ", zeta, ", force ", force);
      for (std::size_t i = 0; i < 2; ++i)
        CHECK(order(coarse[i], fine[i], 8) == doctest::Approx(i == 0 ? 4 : 3).epsilon(0.1));
    }
}

TEST_CASE("with two rates the energy balance closes with second order") {
  for (double zeta : {0.0, 0.008})
    for (double force : {0.0, 0.3}) {
      const Scene scene{
          .damping_ratio = zeta, .force_amplitude = force, .force_frequency = 0.8, .until_time = 12};
      const auto residual = [&](double scale) {
        const Run run = simulate(
            scene, Cem{.time_step = 1e-4 * scale, .locate = true, .large_step = 0.08 * scale}, everything());
        const EnergyBalance& balance = *run.energy;
        CHECK(balance.impact_loss.size() == run.impacts->time.size());
        CHECK((balance.viscous_work > 0) == (zeta > 0));
        CHECK((balance.forcing_work != 0) == (force != 0));
        return std::abs(balance.residual);
      };
      const double coarse = residual(1), fine = residual(0.125);
      INFO("zeta ", zeta, ", force ", force);
      CHECK(coarse < 5e-4);
      CHECK(order(coarse, fine, 8) == doctest::Approx(2).epsilon(0.2));
    }
}

TEST_CASE("long steps in a long contact, of a heavy mass too, leave the energy as small ones do") {
  for (double mass_ratio : {0.02, 1.0}) {
    const Scene scene{
        .x0 = 20,
        .until_time = 60,
        .dampers = {{.mass_ratio = mass_ratio, .restitution = 0.3, .wall_stiffness = 1e4 * mass_ratio}}};
    const Run one = simulate(scene, Cem{.locate = true}, everything());
    const Run two = simulate(scene, Cem{.locate = true, .large_step = 0.02}, everything());
    double longest = 0;
    for (std::size_t i = 0; i < two.contacts->end.size(); ++i)
      longest = std::max(longest, two.contacts->end[i] - two.contacts->begin[i]);
    CHECK(longest > 1);
    CAPTURE(mass_ratio);
    CHECK(std::abs(two.energy->residual - one.energy->residual) < 2e-6);
  }
}

TEST_CASE("in long flights times are counted and the motion keeps to the scheme's closed form") {
  // The first step is small; each of the others takes x by 2 asin(H/2) round the circle, the last a shorter
  // one.
  const double small = 1e-4, large = 2999 * small, time = 1e6;
  const Scene scene{.x0 = 0.2, .v0 = 0.1, .until_time = time, .dampers = {{.y0 = 0.5, .w0 = -0.1}}};
  const Run run = simulate(scene,
                           Cem{.time_step = small,
                               .large_step = 0.29999,
                               .budget = {.max_half_cycles = 1'000'000, .max_time = time}},
                           {.history = {{time - 0.25, time, 2}}});
  const double steps = std::floor((time - small) / large), rest = std::fma(-steps, large, time - small);
  const double angle = steps * 2 * std::asin(large / 2) + 2 * std::asin(rest / 2) + small;
  CHECK(run.history->time.back() == time);
  // Rounding: 1e-16 of the time, and an increment's last bit, which the steps that follow turn into phase.
  CHECK(std::abs(run.history->x.back() - (0.2 * std::cos(angle) + 0.1 * std::sin(angle))) < 1e-9);
  CHECK(std::abs(run.history->v.back() - (0.1 * std::cos(angle) - 0.2 * std::sin(angle))) < 1e-9);
}

TEST_CASE("amplitudes, zero crossings and samples in large steps are those of the closed form") {
  const double amplitude = std::hypot(0.2, 0.1), phase = std::atan2(0.1, 0.2);
  for (double large : {0.2, 0.05}) {
    const Scene scene{.x0 = 0.2, .v0 = 0.1, .until_time = 40, .dampers = {{.y0 = 0.5, .w0 = -0.1}}};
    const Run run = simulate(scene, Cem{.large_step = large}, {.history = {{0, 40, 999}}});
    const HalfCycles& rows = *run.half_cycles;
    REQUIRE(rows.amplitude.size() == 13);
    const double h_2 = large * large;
    for (std::size_t i = 0; i < rows.amplitude.size(); ++i) {
      const double time = phase + double(i) * pi, slip = (time + pi) * h_2 / 23;
      CHECK(std::abs(rows.amplitude[i] / amplitude - 1) < h_2 * h_2 / 16);
      CHECK(std::abs(rows.peak_time[i] - time) < slip + h_2 * large / 6);
      CHECK(std::abs(rows.zero_crossing[i] - (time + pi / 2)) < slip + h_2 * large / 6);
    }
    for (std::size_t i = 0; i < run.history->x.size(); ++i) {
      const double t = run.history->time[i], clock = (t + 1) * h_2 / 23 + h_2 * large / 6;
      CHECK(std::abs(run.history->x[i] - amplitude * std::cos(t - phase)) < amplitude * clock);
      CHECK(std::abs(run.history->v[i] + amplitude * std::sin(t - phase)) <
            amplitude * (clock + h_2 * large / 3));
      CHECK(std::abs(run.history->dampers[0].y[i] - (0.5 + 0.2 - run.history->x[i])) < 1e-9);
    }
  }
}

TEST_CASE("a peak that falls between two steps of unequal length is not lost") {
  // Impacts, and with them changes of step, at all phases of x: bounds follow from the energy, which the
  // impacts leave as it is, and y' = 0 at no peak in particular.
  Scene scene{.until_time = 400, .dampers = {{.mass_ratio = 1e-9, .restitution = 1}}};
  scene.x0 = 3;
  const Run run = simulate(scene, Cem{.locate = true, .large_step = 0.3}, {.impacts = true});
  CHECK(run.impacts->time.size() > 500);
  // A parabola's height within H^4/16; and what so light a mass takes, of order 1e-9.
  for (double amplitude : run.half_cycles->amplitude) CHECK(std::abs(amplitude / 3 - 1) < 5.1e-4);
}

TEST_CASE("a whole decay takes an eightieth of the steps") {
  const Scene scene{.until_amplitude = 0.03};  // to t = 1700 or so: 39 million steps of the default length
  const auto end = [&](Cem options) {
    options.max_steps = 480'000;
    return simulate(scene, options, {}).stop_reason;
  };
  CHECK(end({}) == StopReason::step_budget);
  CHECK(end({.large_step = 0.05}) == StopReason::amplitude);
  CHECK(end({.locate = true, .large_step = 0.05}) == StopReason::amplitude);
}

TEST_CASE("with two rates a run ends at its time, and when its steps are used up, in whichever step") {
  for (bool locate : {false, true}) {
    double last = 0;
    for (std::int64_t steps = 1; steps < 1500; ++steps) {
      const Run run = simulate({.until_time = 50},
                               Cem{.locate = locate, .large_step = 0.1, .max_steps = steps}, everything());
      CHECK(run.stop_reason == StopReason::step_budget);
      CHECK(run.end_time > last);
      CHECK(run.end_time <= last + 0.1 * (1 + 1e-12));
      last = run.end_time;
    }
    CHECK(last > 3);
    for (double time : {0.01, 0.333, 2.5, 17.77}) {
      const Run run = simulate({.until_time = time}, Cem{.locate = locate, .large_step = 0.1}, everything());
      CHECK(run.stop_reason == StopReason::time);
      CHECK(run.end_time == time);
      CHECK(std::abs(run.energy->residual) < 1e-3);
    }
  }
}

TEST_CASE("a scene at rest stays there in steps of any length") {
  const Run run =
      simulate({.x0 = 0, .until_time = 1000, .dampers = {{.y0 = 0.5}}}, Cem{.large_step = 1.9}, everything());
  CHECK(run.impacts->time.empty());
  CHECK(run.energy->final.total() == 0);
}

TEST_CASE(
    "a large step is rejected if it is not larger, beyond the limit in flight, or too coarse for the force") {
  const Scene scene{.until_time = 1}, driven{.force_amplitude = 1, .force_frequency = 10, .until_time = 1};
  const auto message = [](const Scene& of, const Cem& options) {
    return rejection_of<std::invalid_argument>([&] { simulate(of, options, {}); });
  };
  CHECK(message(scene, {.large_step = 1.9999}) == not_rejected);
  CHECK(message(driven, {.large_step = 0.314}) == not_rejected);
  for (double large : {5e-5, 1e-4, 2.0})
    CHECK(
        message(scene, {.time_step = 1e-4, .large_step = large}).starts_with("large_step: must be > 0.0001"));
  for (double large : {0.0, -1.0, double(NAN), double(INFINITY)})
    CHECK(message(scene, {.time_step = 1e-4, .large_step = large})
              .starts_with("large_step: must be > 0 and finite, got "));
  CHECK(message(driven, {.large_step = 0.315}) ==
        "large_step: must be <= 0.314158, half a period of the forcing, got 0.315");
  // Less than two small ones, and more than can be counted.
  CHECK(message(scene, {.time_step = 1e-4, .large_step = 1.5e-4}) == not_rejected);
  CHECK(message(scene, {.time_step = 1e-300, .large_step = 0.1, .max_steps = 1000}) == not_rejected);
  // Every problem at once.
  const std::string both = message(scene, {.time_step = 1, .large_step = 0.5});
  CHECK(both.starts_with("time_step: "));
  CHECK(contains(both, "\nlarge_step: "));
}
