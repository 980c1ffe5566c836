// Several dampers by the component element method: against the engine of one damper, the restitution engine,
// and a Taylor series in long double that shares nothing with either.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "impact_damper/engines/cem_scheme.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"

using namespace impact_damper;

namespace {

// The compliant equations of several dampers by their Taylor series, the steps a quarter of a radian of the
// stiffest wall; a wall that is met or left within one is bisected, where 16 points of the step show it.
class Reference {
 public:
  using Real = long double;
  struct Impact {
    double time;
    int damper;
    double w;
  };

  Reference(const Scene& scene, const std::vector<double>& times)
      : scene_(scene), now_(scene.dampers.size()) {
    x_ = scene.x0, v_ = scene.v0;
    losses.resize(now_.size());
    Real fastest = 1;
    for (std::size_t i = 0; i < now_.size(); ++i) {
      const SceneDamper& d = scene.dampers[i];
      const Real l = -std::log(Real(d.restitution)), pi = std::numbers::pi_v<Real>;
      now_[i] = {d.y0, d.w0, d.mass_ratio, d.clearance, Real(d.wall_stiffness) / d.mass_ratio};
      now_[i].damping = 2 * std::sqrt(now_[i].stiffness) * l / std::sqrt(pi * pi + l * l);
      if (d.restitution == 0) now_[i].damping = 2 * std::sqrt(now_[i].stiffness);
      now_[i].wall = d.y0 < 0 ? -1 : d.y0 > d.clearance ? 1 : 0;
      fastest = std::max(fastest, std::sqrt(now_[i].stiffness * (1 + now_[i].nu)));
    }
    for (const double time : times) {
      while (time_ < time) advance(std::min(Real(0.25) / fastest, Real(time) - time_), time);
      x.push_back(double(x_));
      for (std::size_t i = 0; i < now_.size(); ++i) y.push_back(double(now_[i].y));
    }
  }

  std::vector<double> x, y;  // at the times; of all dampers
  std::vector<Impact> impacts;
  std::vector<double> losses;  // of each damper's wall
  double viscous = 0;
  int most_in_contact = 0;

 private:
  static constexpr int order = 16;
  using Series = std::array<Real, order + 1>;
  struct Mass {
    Real y, w, nu, clearance, stiffness, damping = 0;
    int wall = 0;  // -1: in contact with the left one
    Series series{};
    Real place() const { return wall > 0 ? clearance : 0; }
  };

  static Real at(const Series& s, Real t) {
    Real sum = 0;
    for (int k = order; k >= 0; --k) sum = sum * t + s[k];
    return sum;
  }
  static Real slope_at(const Series& s, Real t) {
    Real sum = 0;
    for (int k = order; k >= 1; --k) sum = sum * t + k * s[k];
    return sum;
  }
  static Real square_of_slope(const Series& s, Real t) {  // its integral
    Real sum = 0;
    for (int j = 1; j <= order; ++j)
      for (int k = 1; k <= order; ++k) sum += j * k * s[j] * s[k] * std::pow(t, j + k - 1) / (j + k - 1);
    return sum;
  }
  void expand() {
    series_[0] = x_, series_[1] = v_;
    for (Mass& m : now_) m.series[0] = m.y - m.place(), m.series[1] = m.w;
    Real f = scene_.force_amplitude;
    const Real omega = scene_.force_frequency;
    for (int k = 0; k + 2 <= order; ++k) {
      const Real phase = omega * time_ + k * std::numbers::pi_v<Real> / 2;
      Real x2 = f * std::sin(phase) - 2 * Real(scene_.damping_ratio) * (k + 1) * series_[k + 1] - series_[k];
      const auto force = [&](const Mass& m) {
        return m.wall == 0 ? 0 : m.damping * (k + 1) * m.series[k + 1] + m.stiffness * m.series[k];
      };
      for (const Mass& m : now_) x2 += m.nu * force(m);
      series_[k + 2] = x2 / ((k + 1) * (k + 2));
      for (Mass& m : now_) m.series[k + 2] = (-force(m) - x2) / ((k + 1) * (k + 2));
      f *= omega / (k + 1);
    }
  }
  static bool stays(const Mass& m, Real t) {
    const Real q = at(m.series, t);
    return m.wall == 0 ? q >= 0 && q <= m.clearance : m.wall * q > 0;
  }
  void advance(Real h, double until) {
    expand();
    Mass* changes = nullptr;
    constexpr int points = 16;
    for (int n = 1; n <= points && !changes; ++n) {
      Real first = h * n / points;
      for (Mass& m : now_) {
        // A mass that has just come to a wall or left it is on it.
        if (stays(m, first)) continue;
        Real low = h * (n - 1) / points, high = first;
        for (int k = 0; k < 80; ++k) {
          const Real middle = (low + high) / 2;
          (stays(m, middle) ? low : high) = middle;
        }
        first = high;
        changes = &m;
      }
      if (changes) h = first;
    }
    viscous += double(2 * Real(scene_.damping_ratio) * square_of_slope(series_, h));
    int in_contact = 0;
    for (std::size_t i = 0; i < now_.size(); ++i) {
      if (now_[i].wall == 0) continue;
      ++in_contact;
      losses[i] += double(now_[i].nu * now_[i].damping * square_of_slope(now_[i].series, h));
    }
    most_in_contact = std::max(most_in_contact, in_contact);
    x_ = at(series_, h), v_ = slope_at(series_, h);
    for (Mass& m : now_) {
      m.w = slope_at(m.series, h);
      m.y = m.place() + at(m.series, h);
    }
    time_ = !changes && until - time_ <= h ? Real(until) : time_ + h;
    if (!changes) return;
    Mass& m = *changes;
    if (m.wall == 0) {
      m.wall = m.w < 0 ? -1 : 1;
      impacts.push_back({double(time_), int(&m - now_.data()), double(m.w)});
      m.y = m.place();
    } else {
      m.y = m.place();
      m.wall = 0;
    }
  }

  const Scene& scene_;
  std::vector<Mass> now_;
  Real x_, v_, time_ = 0;
  Series series_{};
};

Record everything(const Scene& scene, int samples = 201) {
  return {.impacts = true, .contacts = true, .energy = true, .history = {{0, *scene.until_time, samples}}};
}
Run run_of(const Scene& scene, const Cem& options) { return simulate(scene, options, everything(scene)); }

double order(double coarse, double fine, double ratio = 2) {
  return std::log(coarse / fine) / std::log(ratio);
}

const Scene four{
    .damping_ratio = 0.03,
    .x0 = 3,
    .until_time = 7,
    .dampers = {{.mass_ratio = 0.05, .restitution = 0.5, .wall_stiffness = 400},
                {.mass_ratio = 0.1, .restitution = 0.2, .clearance = 0.3, .wall_stiffness = 900},
                {.mass_ratio = 0.2, .restitution = 0.7, .clearance = 4, .wall_stiffness = 300, .y0 = 1},
                {.mass_ratio = 0.08,
                 .restitution = 0.4,
                 .clearance = 0.7,
                 .wall_stiffness = 2000,
                 .y0 = 0.7,
                 .w0 = -0.5}}};
const Scene two_shaken{
    .x0 = 0.2,
    .v0 = 1,
    .force_amplitude = 2,
    .force_frequency = 1.7,
    .until_time = 9,
    .dampers = {{.mass_ratio = 0.3, .restitution = 0.6, .clearance = 0.3, .wall_stiffness = 200, .y0 = 0.1},
                {.mass_ratio = 0.1, .restitution = 0.3, .clearance = 4, .wall_stiffness = 500, .y0 = -0.01}}};

// How far a run is from the reference, at 201 times and in all impacts.
struct Distance {
  double x = 0, y = 0, impacts = 0, losses = 0, viscous = 0, residual = 0;
};
Distance distance(const Run& run, const Reference& reference) {
  Distance far;
  const std::size_t count = run.scene.dampers.size();
  for (std::size_t i = 0; i < run.history->time.size(); ++i) {
    far.x = std::max(far.x, std::abs(run.history->x[i] - reference.x[i]));
    for (std::size_t j = 0; j < count; ++j)
      far.y = std::max(far.y, std::abs(run.history->dampers[j].y[i] - reference.y[i * count + j]));
  }
  // Impacts of each damper by itself: those of different ones may be closer together than the error.
  for (std::size_t j = 0; j < count; ++j) {
    std::vector<std::size_t> its;
    for (std::size_t i = 0; i < run.impacts->time.size(); ++i)
      if (run.impacts->damper[i] == int(j)) its.push_back(i);
    std::size_t n = 0;
    for (const auto& [time, damper, w] : reference.impacts) {
      if (damper != int(j)) continue;
      if (n == its.size()) far.impacts = 1;  // one is missing
      if (far.impacts >= 1) break;
      far.impacts = std::max({far.impacts, std::abs(run.impacts->time[its[n]] - time),
                              std::abs(run.impacts->relative_velocity[its[n]] - w)});
      ++n;
    }
    if (n < its.size()) far.impacts = 1;
  }
  double loss = run.energy->contact_loss, expected = 0;
  for (std::size_t j = 0; j < count; ++j) {
    loss += run.energy->dampers[j].impact_loss;
    expected += reference.losses[j];
    if (run.scene.dampers[j].y0 < 0) continue;  // a contact that no impact began is in no damper's losses
    far.losses = std::max(far.losses, std::abs(run.energy->dampers[j].impact_loss - reference.losses[j]));
  }
  far.losses = std::max(far.losses, std::abs(loss - expected));
  far.viscous = std::abs(run.energy->viscous_work - reference.viscous);
  far.residual = std::abs(run.energy->residual);
  return far;
}
Reference reference_of(const Scene& scene) {
  const Run run = run_of(scene, {});
  return {scene, run.history->time};
}
// The mean over neighbouring steps: where in a step touch and release fall differs.
Distance mean_distance(const Scene& scene, const Reference& reference, Cem options, double h, int runs) {
  Distance mean;
  for (int i = 0; i < runs; ++i) {
    options.time_step = h * (1 + i / (2.0 * runs));
    const Distance far = distance(run_of(scene, options), reference);
    for (const auto member : {&Distance::x, &Distance::y, &Distance::impacts, &Distance::losses,
                              &Distance::viscous, &Distance::residual})
      mean.*member += far.*member / runs;
  }
  return mean;
}

Scene list_of_one(const Scene& scene) {
  Scene list = scene;
  list.dampers = {{.mass_ratio = scene.mass_ratio,
                   .restitution = scene.restitution,
                   .wall_stiffness = scene.wall_stiffness,
                   .y0 = scene.y0,
                   .w0 = scene.w0}};
  return list;
}

const std::vector<Scene> single{
    {.until_time = 30},
    {.mass_ratio = 0.1,
     .restitution = 0.3,
     .damping_ratio = 0.02,
     .x0 = 3,
     .y0 = 0.4,
     .force_amplitude = 0.5,
     .force_frequency = 0.9,
     .until_time = 15},
    {.mass_ratio = 0.5,
     .restitution = 0.7,
     .damping_ratio = 0.3,
     .x0 = 0.5,
     .v0 = -1,
     .y0 = 0.5,
     .force_amplitude = 3,
     .force_frequency = 4,
     .until_time = 8},
    {.restitution = 0.2, .damping_ratio = 1.2, .x0 = -4, .y0 = -0.01, .w0 = 0.5, .until_time = 4},
    {.mass_ratio = 0.05, .restitution = 0.5, .wall_stiffness = 50, .x0 = 2, .y0 = 1.05, .until_time = 8},
    {.x0 = 0, .y0 = 1, .force_amplitude = 1, .force_frequency = 2, .until_time = 10}};
const std::vector<Cem> ways{{},
                            {.locate = true},
                            {.damper = Damper::lagged},
                            {.damper = Damper::lagged, .locate = true},
                            {.calibration = Calibration::two_body}};

// All columns of `some` are those of `all` to within `off`, and `unit` times as large.
void check_alike(const Run& some, const Run& all, double off) {
  const auto alike = [&](const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) CHECK(std::abs(a[i] - b[i]) <= off * (1 + std::abs(b[i])));
  };
  CHECK(some.stop_reason == all.stop_reason);
  CHECK(some.end_time == doctest::Approx(all.end_time).epsilon(off));
  alike(some.half_cycles->zero_crossing, all.half_cycles->zero_crossing);
  alike(some.half_cycles->peak_time, all.half_cycles->peak_time);
  alike(some.half_cycles->amplitude, all.half_cycles->amplitude);
  alike(some.history->x, all.history->x);
  alike(some.history->v, all.history->v);
  const auto energies = [](const Run& run) {
    const EnergyBalance& e = *run.energy;
    double losses = 0;
    for (const double loss : e.impact_loss) losses += loss;
    return std::vector{e.initial.total(), e.initial.paper, e.final.kinetic, e.final.spring,
                       e.final.wall,      e.final.paper,   losses,          e.contact_loss,
                       e.viscous_work,    e.forcing_work,  e.residual};
  };
  alike(energies(some), energies(all));
}

}  // namespace

TEST_CASE("a list of one damper is the scene with that damper") {
  for (const Scene& scene : single) {
    for (const Cem& options : ways) {
      CAPTURE(&scene - single.data());
      CAPTURE(&options - ways.data());
      const Run list = run_of(list_of_one(scene), options), one = run_of(scene, options);
      check_alike(list, one, 1e-9);
      CHECK(list.half_cycles->impacts == one.half_cycles->impacts);
      CHECK(list.half_cycles->impacts_by_damper.front() == one.half_cycles->impacts);
      CHECK(list.impacts->wall == one.impacts->wall);
      CHECK(list.contacts->end.size() == one.contacts->end.size());
      for (std::size_t i = 0; i < one.history->time.size(); ++i) {
        CHECK(std::abs(list.history->dampers[0].y[i] - one.history->y[i]) <= 1e-9);
        CHECK(std::abs(list.history->dampers[0].w[i] - one.history->w[i]) <= 1e-7);
      }
      CHECK(std::get<Cem>(list.engine).time_step == std::get<Cem>(one.engine).time_step);
    }
  }
}

TEST_CASE("budgets end a list of one where they end the scene with that damper") {
  const Scene& scene = single.front();
  for (Cem options : {Cem{.budget = {.max_impacts = 7}}, Cem{.budget = {.max_half_cycles = 3}},
                      Cem{.budget = {.max_time = 5}}, Cem{.max_steps = 50'000}}) {
    for (const bool locate : {false, true}) {
      options.locate = locate;
      check_alike(run_of(list_of_one(scene), options), run_of(scene, options), 1e-9);
    }
  }
  Scene falls = scene;
  falls.until_amplitude = 5.95;
  check_alike(run_of(list_of_one(falls), {}), run_of(falls, {}), 1e-9);
  CHECK(run_of(list_of_one(falls), {}).stop_reason == StopReason::amplitude);
}

TEST_CASE("a clearance of a power of two is another unit of length, to the bit") {
  for (const double c : {0.25, 4.0}) {
    for (const Cem& options : ways) {
      Scene scene = list_of_one(single[1]), wide = scene;
      SceneDamper& damper = wide.dampers.front();
      damper.clearance = c;
      damper.y0 *= c;
      wide.x0 *= c;
      wide.force_amplitude *= c;
      const Run run = run_of(scene, options), its = run_of(wide, options);
      CHECK(run.half_cycles->zero_crossing == its.half_cycles->zero_crossing);
      CHECK(run.contacts->end == its.contacts->end);
      REQUIRE(run.half_cycles->amplitude.size() > 3);
      for (std::size_t i = 0; i < run.half_cycles->amplitude.size(); ++i)
        CHECK(c * run.half_cycles->amplitude[i] == its.half_cycles->amplitude[i]);
      CHECK(c * c * run.energy->final.total() == its.energy->final.total());
    }
  }
}

TEST_CASE("the parts of a damper, with their shares of its wall, are that damper") {
  // Always in contact together: what is summed over the walls is the one wall's. (Shares by which the
  // stiffness divided by the mass stays the same to the bit: otherwise the parts leave a wall a rounding
  // apart, and with `locate` and the damper lagged each new start is an error of first order.)
  constexpr std::array shares{0.5, 0.25, 0.25};
  for (Scene scene : single) {
    scene.until_time = std::min(8.0, *scene.until_time);
    for (Cem options : ways) {
      if (options.calibration == Calibration::two_body) continue;  // it depends on each mass
      const Run whole = run_of(scene, options);
      options.time_step = std::get<Cem>(whole.engine).time_step;
      Scene parts = list_of_one(scene);
      parts.dampers.assign(shares.size(), parts.dampers.front());
      for (std::size_t i = 0; i < shares.size(); ++i) {
        parts.dampers[i].mass_ratio *= shares[i];
        parts.dampers[i].wall_stiffness *= shares[i];
      }
      check_alike(run_of(parts, options), whole, 1e-8);
    }
  }
}

TEST_CASE("renumbering the dampers changes no bit but the numbers") {
  Scene scene = four;
  // Of equal numbers but for the wall, and one that is there twice.
  scene.dampers.push_back(scene.dampers[1]);
  scene.dampers.back().wall_stiffness = 1100;
  scene.dampers.push_back(scene.dampers[2]);
  scene.dampers.push_back(scene.dampers[0]);
  scene.dampers.back().mass_ratio = 0.02;
  const std::size_t count = scene.dampers.size();
  Scene turned = scene;
  std::rotate(turned.dampers.begin(), turned.dampers.begin() + 2, turned.dampers.end());
  for (const Cem& options :
       {Cem{}, Cem{.locate = true}, Cem{.large_step = 0.05}, Cem{.locate = true, .large_step = 0.05}}) {
    const Run one = run_of(scene, options), other = run_of(turned, options);
    CHECK(one.half_cycles->zero_crossing == other.half_cycles->zero_crossing);
    CHECK(one.half_cycles->amplitude == other.half_cycles->amplitude);
    CHECK(one.impacts->time == other.impacts->time);
    CHECK(one.history->x == other.history->x);
    CHECK(one.energy->final.total() == other.energy->final.total());
    CHECK(one.energy->residual == other.energy->residual);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = (i + count - 2) % count;
      CHECK(one.history->dampers[i].y == other.history->dampers[j].y);
      CHECK(one.energy->dampers[i].impact_loss == other.energy->dampers[j].impact_loss);
      CHECK(one.energy->dampers[i].final_kinetic == other.energy->dampers[j].final_kinetic);
      CHECK(one.half_cycles->impacts_by_damper[i] == other.half_cycles->impacts_by_damper[j]);
    }
  }
}

TEST_CASE("with located events several dampers converge to their Taylor series with second order") {
  for (const Scene& scene : {four, two_shaken}) {
    const Reference reference = reference_of(scene);
    CHECK(reference.most_in_contact == std::min(3, int(scene.dampers.size())));
    REQUIRE(reference.impacts.size() > 10);
    const Distance coarse = mean_distance(scene, reference, {.locate = true}, 4e-4, 4),
                   fine = mean_distance(scene, reference, {.locate = true}, 1e-4, 4);
    for (const auto member : {&Distance::x, &Distance::y, &Distance::impacts, &Distance::losses})
      CHECK(order(coarse.*member, fine.*member, 4) == doctest::Approx(2).epsilon(0.1));
    CHECK(fine.x < 1e-5);
    CHECK(fine.viscous < 2e-6);
  }
}

TEST_CASE("unlocated, or with the damper lagged, several dampers converge with first order") {
  for (Scene scene : {four, two_shaken}) {
    scene.until_time = 3;  // before the errors of first order decide who meets which wall next
    const Reference reference = reference_of(scene);
    for (const Cem& options :
         {Cem{}, Cem{.damper = Damper::lagged}, Cem{.damper = Damper::lagged, .locate = true}}) {
      const Distance coarse = mean_distance(scene, reference, options, 4e-4, 12),
                     fine = mean_distance(scene, reference, options, 5e-5, 12);
      for (const auto member : {&Distance::x, &Distance::y, &Distance::losses})
        CHECK(order(coarse.*member, fine.*member, 8) == doctest::Approx(1).epsilon(0.25));
    }
  }
}

TEST_CASE("the energy balance of several dampers closes with second order") {
  for (const Scene& scene : {four, two_shaken}) {
    const auto residual = [&](double h, bool locate) {
      double mean = 0;
      for (int i = 0; i < 8; ++i)
        mean +=
            std::abs(run_of(scene, {.time_step = h * (1 + i / 16.0), .locate = locate}).energy->residual) / 8;
      return mean;
    };
    CHECK(order(residual(4e-4, true), residual(1e-4, true), 4) > 1.7);
    CHECK(residual(1e-4, true) < 1e-5);
    CHECK(residual(1e-4, false) < 1e-4);
  }
}

TEST_CASE("two rates lose nothing of the accuracy of small steps, and spare most of them") {
  for (Scene scene : {four, two_shaken}) {
    scene.until_time = 3;
    const Reference reference = reference_of(scene);
    for (const bool locate : {false, true}) {
      Cem options{.locate = locate};
      const Distance small = mean_distance(scene, reference, options, 1e-4, 8);
      options.large_step = 0.01;
      const Distance mixed = mean_distance(scene, reference, options, 1e-4, 8);
      CHECK(mixed.x < 1.2 * small.x + 5e-5);
      CHECK(mixed.y < 1.2 * small.y + 1e-4);
      CHECK(mixed.impacts < 1.2 * small.impacts + 2e-4);
      CHECK(mixed.losses < 1.2 * small.losses + 5e-5);
      CHECK(mixed.residual < 1.2 * small.residual + 2e-5);
    }
    // The large steps' own error is of second order.
    const Distance coarse = mean_distance(scene, reference, {.locate = true, .large_step = 0.04}, 2e-5, 1),
                   fine = mean_distance(scene, reference, {.locate = true, .large_step = 0.01}, 2e-5, 1);
    CHECK(order(coarse.x, fine.x, 4) > 1.5);
  }
  // A flight in large steps: x and x' of the samples are on the circle, and both secondary masses stay where
  // they are.
  Scene flight{
      .x0 = 3, .until_time = 10, .dampers = {{.clearance = 50, .y0 = 20}, {.clearance = 90, .y0 = 50}}};
  const Run far = run_of(flight, {.large_step = 0.1, .max_steps = 200});
  REQUIRE(far.end_time == 10);
  for (std::size_t i = 0; i < far.history->x.size(); ++i) {
    const double x = far.history->x[i], v = far.history->v[i];
    CHECK(std::abs(x * x + v * v - 9) < 1e-5);
    CHECK(std::abs(x + far.history->dampers[1].y[i] - 53) < 1e-12);
    CHECK(std::abs(v + far.history->dampers[1].w[i]) < 1e-12);
  }
  // Stiff walls, so that contacts are short.
  Scene stiff = four;
  for (SceneDamper& damper : stiff.dampers) damper.wall_stiffness *= 1e6, damper.restitution = 0.9;
  stiff.until_time = 1;
  const Run run = run_of(stiff, {.large_step = 0.02, .max_steps = 300'000});
  CHECK(run.stop_reason == StopReason::time);
  CHECK(*stiff.until_time / *std::get<Cem>(run.engine).time_step > 1'500'000);
}

TEST_CASE("as the walls get stiff several dampers tend to rigid walls") {
  Scene scene = four;
  scene.until_time = 1.5;
  scene.dampers[1].restitution = 0.5;
  const Run rigid = simulate(scene, Restitution{}, everything(scene));
  const auto off = [&](double k) {
    for (SceneDamper& damper : scene.dampers) damper.wall_stiffness = k;
    const Run run = run_of(scene, {.locate = true, .large_step = 0.01, .calibration = Calibration::two_body});
    double largest = 0;
    for (std::size_t i = 0; i < rigid.history->x.size(); ++i)
      largest = std::max(largest, std::abs(run.history->x[i] - rigid.history->x[i]));
    return largest;
  };
  const double soft = off(1e6), stiff = off(1e8);
  CHECK(stiff < 1e-4);
  CHECK(order(soft, stiff, 10) == doctest::Approx(1).epsilon(0.3));
}

TEST_CASE("the stability limit of a list is that of all masses in contact") {
  Scene one = single[1];
  for (const Damper damper : {Damper::centred, Damper::lagged}) {
    const double limit = stability_limit(one, damper, {});
    Scene list = list_of_one(one);
    CHECK(stability_limit(list, damper, {}) == doctest::Approx(limit).epsilon(1e-12));
    list.dampers.assign(2, list.dampers.front());
    for (SceneDamper& half : list.dampers) half.mass_ratio /= 2, half.wall_stiffness /= 2;
    CHECK(stability_limit(list, damper, {}) == doctest::Approx(limit).epsilon(1e-12));
  }
  // The square of the highest frequency is a root of the secular equation of all masses and springs.
  const double square = std::pow(fastest_contact_frequency(four), 2);
  double sum = 1 / square - 1;
  for (const SceneDamper& damper : four.dampers)
    sum += damper.wall_stiffness / (square - damper.wall_stiffness / damper.mass_ratio);
  CHECK(std::abs(sum) < 1e-10);
  // The longest list of the heaviest masses runs with the default step.
  Scene many;
  many.until_time = 1e-3;
  many.dampers.assign(1000, {.mass_ratio = 1e6, .wall_stiffness = 1e4});
  CHECK(run_of(many, {}).stop_reason == StopReason::time);
}

TEST_CASE(
    "what is recorded of several dampers changes nothing of their motion, and a shorter run is its "
    "beginning") {
  for (const Cem& options : {Cem{}, Cem{.locate = true, .large_step = 0.05}}) {
    const Run all = run_of(two_shaken, options);
    const Run less = simulate(two_shaken, options, {.impacts = true});
    CHECK(all.impacts->time == less.impacts->time);
    CHECK(all.half_cycles->amplitude == less.half_cycles->amplitude);
    Scene shorter = two_shaken;
    shorter.until_time = 5;
    const Run begun = simulate(shorter, options, {.impacts = true});
    REQUIRE(begun.impacts->time.size() > 4);
    CHECK(std::equal(begun.impacts->time.begin(), begun.impacts->time.end(), all.impacts->time.begin()));
  }
}

TEST_CASE(
    "random lists, in every way, run, agree with themselves and are what they are looked at from the other "
    "side") {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    CAPTURE(seed);
    reference::Random random(seed);
    Scene scene;
    scene.damping_ratio = random.chance(0.5) ? 0 : random.log_uniform(1e-3, 2);
    scene.x0 = random.uniform(-10, 10);
    scene.v0 = random.chance(0.5) ? 0 : random.uniform(-10, 10);
    if (random.chance(0.33)) {
      scene.force_amplitude = random.log_uniform(0.1, 10);
      scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.1, 10);
    }
    const int count = 1 + int(random.uniform(0, 6));
    for (int i = 0; i < count; ++i) {
      SceneDamper damper;
      damper.mass_ratio = random.log_uniform(1e-3, random.chance(0.2) ? 10 : 0.5);
      damper.restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 1);
      damper.clearance = random.chance(0.2) ? 1 : random.log_uniform(0.1, 10);
      damper.wall_stiffness = damper.mass_ratio * random.log_uniform(10, 1e4);
      const bool flies = random.chance(0.4);
      damper.y0 = damper.clearance * (flies ? random.uniform(-0.1, 1.1) : double(random.chance(0.5)));
      damper.w0 = flies ? random.uniform(-3, 3) : 0;
      scene.dampers.push_back(damper);
    }
    scene.until_time = 10;
    Cem options{.damper = random.chance(0.5) ? Damper::centred : Damper::lagged,
                .locate = random.chance(0.5),
                .calibration = random.chance(0.5) ? Calibration::fixed_wall : Calibration::two_body};
    options.time_step =
        std::min(0.01, stability_limit(scene, options.damper, options.calibration) / random.uniform(20, 60));
    if (random.chance(0.5)) options.large_step = 0.1;
    if (random.chance(0.2)) options.budget.max_impacts = std::int64_t(random.uniform(0, 20));
    if (random.chance(0.2)) options.budget.max_half_cycles = 2;

    const Run run = run_of(scene, options);  // every_run.cpp holds it against itself
    CHECK(std::abs(run.energy->residual) < 0.3);
    const Run less = simulate(scene, options, {.impacts = true});
    CHECK(less.impacts->time == run.impacts->time);
    CHECK(less.half_cycles->amplitude == run.half_cycles->amplitude);
    CHECK(less.end_time == run.end_time);

    Scene mirrored = scene;
    mirrored.x0 = -scene.x0, mirrored.v0 = -scene.v0, mirrored.force_amplitude = -scene.force_amplitude;
    for (SceneDamper& damper : mirrored.dampers)
      damper.y0 = damper.clearance - damper.y0, damper.w0 = -damper.w0;
    const Run other = run_of(mirrored, options);
    for (std::size_t i = 0; i < std::min<std::size_t>(run.history->x.size(), 5); ++i)
      CHECK(std::abs(run.history->x[i] + other.history->x[i]) < 1e-6);
    for (std::size_t i = 0; i < std::min<std::size_t>(run.impacts->time.size(), 2); ++i)
      CHECK(std::abs(run.impacts->time[i] - other.impacts->time[i]) < 1e-6);
  }
}

TEST_CASE("what the component element method does not take of a list is said by its field") {
  const auto problem_of = [&](const Cem& options) -> std::string {
    try {
      simulate(four, options, Record{});
    } catch (const InvalidArguments& error) {
      const Problem& problem = error.problems().front();
      return problem.field + ": " + problem.message;
    }
    return {};
  };
  CHECK(problem_of({}).empty());
  CHECK(problem_of({.stuck_speed = 0.01}).starts_with("stuck_speed: is for one damper"));
  CHECK(problem_of({.time_step = 1}).starts_with("time_step: must be <= 0.0"));
  CHECK(problem_of({.large_step = 2}).starts_with("large_step: must be > "));
}
