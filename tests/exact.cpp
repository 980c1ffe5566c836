// The exact engine.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "engines/observed.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/system.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "rejection.hpp"
#include "same_run.hpp"

using namespace impact_damper;
using reference::everything, reference::farthest;

namespace {

constexpr double pi_d = std::numbers::pi;

// The secondary mass stays clear of the walls while |x| < 1/2: it rests at z = x + y = 1/2.
Scene without_contact(double x0, double v0, double until, double zeta = 0) {
  return {.damping_ratio = zeta,
          .x0 = x0,
          .v0 = v0,
          .until_time = until,
          .dampers = {{.y0 = 0.5 - x0, .w0 = -v0}}};
}

template <class Real>
Run exact_in(const Scene& scene, const Record& record, const Exact& options = {}) {
  TestObserver<Real> recorder(record);
  const Outcome outcome = observed(scene, options, recorder);
  Run run{
      .stop_reason = outcome.stop_reason, .end_time = outcome.end_time, .scene = scene, .engine = options};
  recorder.finish(run);
  return run;
}

const std::vector<Scene> many_scenes{
    {.until_time = 60},
    {.until_time = 60, .dampers = {{.mass_ratio = 0.5}}},
    {.damping_ratio = 0.08, .until_time = 60},
    {.damping_ratio = 5, .v0 = 40, .until_time = 60},
    {.until_time = 60, .dampers = {{.restitution = 0}}},
    {.until_time = 20, .dampers = {{.restitution = 1}}},
    {.until_time = 60, .dampers = {{.restitution = 0.95, .wall_stiffness = 1e9}}},
    {.x0 = 0, .force_amplitude = 0.4, .force_frequency = 0.9, .until_time = 60},
    {.damping_ratio = 0.02, .x0 = 0.3, .force_amplitude = 0.2, .until_time = 60},
    {.damping_ratio = 5, .force_amplitude = 3, .force_frequency = 2.5, .until_time = 60},
    {.until_time = 60, .dampers = {{.y0 = -0.01}}},
    {.until_time = 60, .dampers = {{.mass_ratio = 0.1, .y0 = 1.02, .w0 = 3}}},
    {.x0 = -4, .until_time = 60},
    {.x0 = 4, .until_time = 60, .dampers = {{.y0 = 1}}},
    {.until_time = 60, .dampers = {{.mass_ratio = 2, .wall_stiffness = 20}}}};

}  // namespace

TEST_CASE("without contact the primary mass is the damped oscillator of the textbooks") {
  for (double zeta : {0.0, 0.05, 0.5}) {
    const Scene scene = without_contact(0.4, 0, 30, zeta);
    const Run run = simulate(scene, Exact{}, everything({{0, 30, 61}}));
    const double omega = std::sqrt(1 - zeta * zeta);
    REQUIRE(run.history->time.size() == 61);
    for (std::size_t i = 0; i < 61; ++i) {
      const double t = run.history->time[i], decay = 0.4 * std::exp(-zeta * t);
      const double x = decay * (std::cos(omega * t) + zeta / omega * std::sin(omega * t));
      CHECK(t == doctest::Approx(0.5 * double(i)).epsilon(1e-15));
      CHECK(std::abs(run.history->x[i] - x) < 1e-14);
      CHECK(std::abs(run.history->v[i] + decay / omega * std::sin(omega * t)) < 1e-14);
      CHECK(std::abs(run.history->dampers[0].y[i] + run.history->x[i] - 0.5) < 1e-14);
    }
    // Row n ends at the n-th zero of cos(omega t) + (zeta/omega) sin(omega t); peaks are where sin vanishes.
    const double first = (pi_d - std::atan2(omega, zeta)) / omega;
    for (std::size_t n = 0; n < run.half_cycles->amplitude.size(); ++n) {
      CHECK(run.half_cycles->zero_crossing[n] ==
            doctest::Approx(first + pi_d * double(n) / omega).epsilon(1e-14));
      CHECK(run.half_cycles->peak_time[n] == doctest::Approx(pi_d * double(n) / omega).epsilon(1e-14));
      CHECK(run.half_cycles->amplitude[n] ==
            doctest::Approx(0.4 * std::exp(-zeta * pi_d * double(n) / omega)).epsilon(1e-14));
      CHECK(run.half_cycles->impacts[n] == 0);
    }
    CHECK(run.half_cycles->amplitude.size() == std::size_t(std::floor((30 - first) * omega / pi_d)) + 1);
  }
}

TEST_CASE("an overdamped primary mass creeps back and crosses zero at most once") {
  for (double zeta : {1.0, 1.5, 20.0}) {
    Scene scene = without_contact(0.3, 0, 40, zeta);
    const double fast = zeta + std::sqrt(zeta * zeta - 1), slow = 1 / fast;
    const auto x = [&](double t, double v0) {
      if (zeta == 1) return std::exp(-t) * (0.3 + (v0 + 0.3) * t);
      return ((v0 + 0.3 * fast) * std::exp(-slow * t) - (v0 + 0.3 * slow) * std::exp(-fast * t)) /
             (fast - slow);
    };
    Run run = simulate(scene, Exact{}, everything({{0, 40, 41}}));
    CHECK(run.half_cycles->amplitude.empty());
    for (std::size_t i = 0; i < 41; ++i) CHECK(std::abs(run.history->x[i] - x(double(i), 0)) < 2e-15);
    // Thrown back faster than the fast rate it crosses once.
    scene = without_contact(0.3, -0.3 * (fast + 0.5), 40, zeta);
    run = simulate(scene, Exact{}, everything());
    CHECK(run.half_cycles->amplitude.size() == 1);
    CHECK(std::abs(x(run.half_cycles->zero_crossing.at(0), scene.v0)) < 1e-14);
  }
}

TEST_CASE("a forced primary mass follows the textbook solution, at resonance too") {
  for (double zeta : {0.0, 0.1})
    for (double omega : {0.5, 1.0, 1.7}) {
      Scene scene = without_contact(0, 0, 40, zeta);
      scene.force_amplitude = 0.02, scene.force_frequency = omega;
      const Run run = simulate(scene, Exact{}, everything({{0, 40, 81}}));
      const double wd = std::sqrt(1 - zeta * zeta),
                   h = std::pow(1 - omega * omega, 2) + std::pow(2 * zeta * omega, 2);
      for (std::size_t i = 0; i < 81; ++i) {
        const double t = run.history->time[i];
        double x = 0.01 * (std::sin(t) - t * std::cos(t));
        if (h != 0) {
          const double in_phase = 0.02 * (1 - omega * omega) / h, behind = -0.04 * zeta * omega / h;
          // The transient cancels x and x' of the steady state at t = 0.
          const double c = -behind, s = (-in_phase * omega + zeta * c) / wd;
          x = in_phase * std::sin(omega * t) + behind * std::cos(omega * t) +
              std::exp(-zeta * t) * (c * std::cos(wd * t) + s * std::sin(wd * t));
        }
        CHECK(std::abs(run.history->x[i] - x) < 1e-14);
      }
      CHECK(std::abs(run.energy->residual) < 1e-13);
    }
}

TEST_CASE("row 0 runs from the release to the first zero crossing, an unfinished half cycle is no row") {
  const Run run = simulate(without_contact(0.2, 0.3, pi_d * 3), Exact{}, everything());
  const double amplitude = std::hypot(0.2, 0.3), peak = std::atan2(0.3, 0.2);
  REQUIRE(run.half_cycles->amplitude.size() == 3);
  for (int n = 0; n < 3; ++n) {
    CHECK(run.half_cycles->peak_time[std::size_t(n)] == doctest::Approx(peak + n * pi_d).epsilon(1e-15));
    CHECK(run.half_cycles->zero_crossing[std::size_t(n)] ==
          doctest::Approx(peak + (n + 0.5) * pi_d).epsilon(1e-15));
    CHECK(run.half_cycles->amplitude[std::size_t(n)] == doctest::Approx(amplitude).epsilon(1e-15));
  }
  // Released from rest: the peak of row 0 is the release.
  const Run from_rest = simulate(without_contact(-0.4, 0, 2), Exact{}, everything());
  CHECK(from_rest.half_cycles->peak_time.at(0) == 0);
  CHECK(from_rest.half_cycles->amplitude.at(0) == 0.4);
}

TEST_CASE(
    "a scene stops at its time, at its amplitude or at whichever comes first, or when a budget is used up") {
  Scene scene{.until_time = 33.3};
  CHECK(simulate(scene, Exact{}, {}).stop_reason == StopReason::time);
  CHECK(simulate(scene, Exact{}, {}).end_time == 33.3);

  scene.until_time.reset();
  scene.until_amplitude = 5;
  const Run low = simulate(scene, Exact{}, {});
  CHECK(low.stop_reason == StopReason::amplitude);
  const std::vector<double>& amplitude = low.half_cycles->amplitude;
  CHECK(amplitude.back() < 5);
  CHECK(*std::min_element(amplitude.begin(), amplitude.end() - 1) >= 5);
  CHECK(low.end_time == low.half_cycles->zero_crossing.back());

  scene.until_time = low.end_time + 1;
  CHECK(simulate(scene, Exact{}, {}).stop_reason == StopReason::amplitude);
  scene.until_time = low.end_time - 1;
  CHECK(simulate(scene, Exact{}, {}).stop_reason == StopReason::time);

  scene.until_time = 1e6;
  scene.until_amplitude.reset();
  Exact options{.budget = {.max_impacts = 7}};
  Run run = simulate(scene, options, everything());
  CHECK(run.stop_reason == StopReason::impact_budget);
  CHECK(run.impacts->time.size() == 7);
  options.budget = {};
  options.budget.max_half_cycles = 5;
  run = simulate(scene, options, everything());
  CHECK(run.stop_reason == StopReason::half_cycle_budget);
  CHECK(run.half_cycles->amplitude.size() == 5);
  scene.until_time.reset();
  scene.until_amplitude = 1e-9;
  options.budget = {};
  options.budget.max_time = 12.5;
  run = simulate(scene, options, {});
  CHECK(run.stop_reason == StopReason::time_budget);
  CHECK(run.end_time == doctest::Approx(12.5).epsilon(1e-15));
}

TEST_CASE("history is sampled where it is asked for, to its last sample, by times and below amplitudes") {
  Scene scene;
  for (int n = 0; n < 200; ++n) {
    scene.until_time = 7 + n * 0.173;
    const Run run = simulate(scene, Exact{}, everything({{1, 2, 5}, {3.5, *scene.until_time, 11}}));
    REQUIRE(run.history->time.size() == 16);
    CHECK(run.history->time.front() == 1);
    CHECK(run.history->time[4] == 2);
    CHECK(run.history->time.back() == *scene.until_time);
    CHECK(run.end_time == *scene.until_time);
  }
  scene.until_time = 300;
  const Record record{.history_below = {{5.5, 10, 21}, {4.9, 5, 11}}};
  const Run run = simulate(scene, Exact{}, record);
  REQUIRE(run.history->time.size() == 32);
  std::size_t row = 0;
  const HalfCycles& rows = *run.half_cycles;
  while (rows.amplitude.at(row) >= 5.5) ++row;
  CHECK(run.history->time[0] == rows.zero_crossing[row]);
  CHECK(std::abs(run.history->x[0]) < 1e-13);
  while (rows.amplitude.at(row) >= 4.9) ++row;
  CHECK(run.history->time[21] == rows.zero_crossing[row]);
}

TEST_CASE("a lossless wall conserves energy") {
  for (double stiffness : {1e4, 1e8}) {
    const Scene scene{.until_time = 400, .dampers = {{.restitution = 1, .wall_stiffness = stiffness}}};
    const Run run = simulate(scene, Exact{}, everything());
    CHECK(run.impacts->time.size() > 500);
    const double before = run.energy->initial.total(), after = run.energy->final.total();
    CHECK(std::abs(after - before) < 1e-12 * before);
    CHECK(*std::max_element(run.energy->impact_loss.begin(), run.energy->impact_loss.end()) == 0);
  }
}

TEST_CASE("with e = 0 the mass stays at the wall that it meets until the primary mass turns back") {
  const Scene scene{.until_time = 60, .dampers = {{.restitution = 0, .wall_stiffness = 1e8}}};
  const Run run = simulate(scene, Exact{}, everything());
  const std::vector<std::int64_t>& impacts = run.half_cycles->impacts;
  for (std::size_t n = 2; n < impacts.size(); ++n) CHECK(impacts[n] == 1);
  for (std::size_t n = 1; n + 1 < run.contacts->end.size(); ++n) {
    // It leaves where the wall's push vanishes, x = 0, later by the time that the wall takes to unload.
    double nearest = 1e9;
    for (double zero : run.half_cycles->zero_crossing)
      nearest = std::min(nearest, std::abs(zero - run.contacts->end[n]));
    CHECK(nearest < 20 / std::sqrt(scene.damper().wall_stiffness / scene.damper().mass_ratio));
  }
}

TEST_CASE(
    "a primary mass that the first impact sets in motion starts its first half cycle there, either way") {
  Scene scene{.x0 = 0, .until_time = 20, .dampers = {{.y0 = 0.5, .w0 = 1}}};
  const Run right = simulate(scene, Exact{}, everything());
  scene.damper().w0 = -1;
  const Run left = simulate(scene, Exact{}, everything());
  REQUIRE(right.half_cycles->amplitude.size() == left.half_cycles->amplitude.size());
  for (std::size_t n = 0; n < left.half_cycles->amplitude.size(); ++n)
    CHECK(left.half_cycles->amplitude[n] == doctest::Approx(right.half_cycles->amplitude[n]).epsilon(1e-12));
}

TEST_CASE("energy never rises unforced and the energy balance closes, over many scenes") {
  for (const Scene& scene : many_scenes) {
    CAPTURE(scene_text(scene));
    const Run run = simulate(scene, Exact{}, everything({{0, *scene.until_time, 2001}}));
    CHECK(std::abs(run.energy->residual) < 1e-12);
    if (scene.force_amplitude != 0) continue;
    const System<double> system(scene);
    double before = run.energy->initial.total();
    for (std::size_t i = 0; i < run.history->time.size(); ++i) {
      const History& h = *run.history;
      const double y = h.dampers[0].y[i], w = h.dampers[0].w[i], depth = y < 0 ? -y : y > 1 ? y - 1 : 0;
      const double now = energy_of<double>(system, {h.x[i], h.v[i], y, w}, depth).total();
      CHECK(now <= before * (1 + 1e-13));
      before = now;
    }
  }
}

TEST_CASE("a mass pressed against a wall, or overlapping it, is in contact and not in an impact") {
  Scene pressed;
  pressed.x0 = -4;  // x'' = 4 presses the mass at rest on the left wall
  pressed.until_time = 1;
  Run run = simulate(pressed, Exact{}, everything());
  CHECK(run.impacts->time.empty());
  REQUIRE(run.contacts->begin.size() == 1);
  CHECK(run.contacts->begin[0] == 0);
  CHECK(run.contacts->end[0] == 1);
  CHECK(run.energy->contact_loss > 0);
  Scene mirrored = pressed;
  mirrored.x0 = 4;
  mirrored.damper().y0 = 1;
  const Run other = simulate(mirrored, Exact{}, everything());
  CHECK(other.impacts->time.empty());
  REQUIRE(other.contacts->begin.size() == 1);
  CHECK(other.contacts->wall[0] == Wall::right);
  CHECK(other.energy->contact_loss == doctest::Approx(run.energy->contact_loss).epsilon(1e-12));
  const Scene overlapping{.until_time = 0.2, .dampers = {{.y0 = 1.01}}};
  run = simulate(overlapping, Exact{}, everything());
  CHECK(run.contacts->wall.at(0) == Wall::right);
  CHECK(run.contacts->begin.at(0) == 0);
  CHECK(run.energy->initial.wall == doctest::Approx(0.5e4 * 0.01 * 0.01).epsilon(1e-13));
}

TEST_CASE("a peak that the wall's push brings about is as high as the motion there") {
  // From rest in a very stiff wall: the push moves x on by nu q / (1 + nu), and x turns where it has just
  // died away, 1e-8 later, before the slow mode by itself would.
  Scene scene{.damping_ratio = 0.47923816447962952,
              .x0 = 3.9183899940046203,
              .until_time = 5,
              .dampers = {{.mass_ratio = 7.8656316044176389e-08,
                           .restitution = 0,
                           .wall_stiffness = 376298906401.30078,
                           .y0 = 1.0321419220423089}}};
  const Run run = simulate(scene, Exact{}, everything({{0, 4e-8, 4001}}));
  const double highest = *std::max_element(run.history->x.begin(), run.history->x.end());
  CHECK(highest ==
        doctest::Approx(scene.x0 + scene.damper().mass_ratio * (scene.damper().y0 - 1)).epsilon(1e-14));
  CHECK(run.half_cycles->amplitude[0] == doctest::Approx(highest).epsilon(4e-16));
}

TEST_CASE("the same scene in extended precision agrees before the chaotic amplitudes") {
  struct Case {
    double x0, until;
  };
  for (const auto& [x0, until] : {Case{6, 400}, Case{4.5, 100}}) {
    const Scene scene{.x0 = x0, .until_time = until};
    const Run in_double = exact_in<double>(scene, {}), in_extended = exact_in<long double>(scene, {});
    // 1e-12 is a few thousand roundings, those of as many impacts.
    CHECK(farthest(in_double.half_cycles->amplitude, in_extended.half_cycles->amplitude) < 1e-12);
    CHECK(farthest(in_double.half_cycles->zero_crossing, in_extended.half_cycles->zero_crossing) < 1e-12);
    CHECK(in_double.half_cycles->impacts == in_extended.half_cycles->impacts);
  }
}

// Asks for the state at the end of each half cycle, when it is told of it.
struct AtCrossings : TestObserver<double> {
  bool wants_half_cycles() const override { return true; }
  void half_cycle(double, double end, double, double) override { ends.push_back(end); }
  double next_sample() const override {
    return x.size() < ends.size() ? ends[x.size()] : std::numeric_limits<double>::infinity();
  }
  void sample(double, double now, double, double, double) override { x.push_back(now); }

  std::vector<double> ends, x;
};

TEST_CASE("who asks for the state at a time that was told of gets it, that of the scene's end among them") {
  Scene scene;
  for (int cycles = 1; cycles <= 200; ++cycles) {
    AtCrossings asking;
    scene.until_time = 1000;
    observed(scene, Exact{.budget = {.max_half_cycles = cycles}}, asking);
    CAPTURE(cycles);
    CHECK(asking.ends.size() == std::size_t(cycles));
    REQUIRE(asking.x.size() == asking.ends.size());
    CHECK(std::abs(asking.x.back()) < 1e-12);  // |v| is at most 6, t at most 630: an ulp of it 1.1e-13
  }
}

TEST_CASE("the budget's time ends every scene, sooner where a forcing is fast, unless it is given") {
  const Run late =
      simulate({.x0 = 0.01, .until_time = 1e12, .dampers = {{.y0 = 0.5}}}, Exact{}, {.half_cycles = false});
  CHECK(late.stop_reason == StopReason::time_budget);
  CHECK(late.end_time == 500'000);
  CHECK(std::get<Exact>(late.engine).budget.max_time == 500'000);
  Scene fast{
      .x0 = 0, .force_amplitude = 1e-3, .force_frequency = 50, .until_time = 1e12, .dampers = {{.y0 = 0.5}}};
  CHECK(simulate(fast, Exact{}, {.half_cycles = false}).end_time == 10'000);
  fast.until_time = 10'000;
  CHECK(simulate(fast, Exact{}, {.half_cycles = false}).stop_reason == StopReason::time);
  fast.until_time = 1e12;
  CHECK(simulate(fast, Exact{.budget = {.max_time = 20}}, {}).end_time == 20);
}

TEST_CASE("what could not be kept in memory is rejected before it is begun") {
  const Scene scene{.until_time = 1};
  const auto message = [&](const Budget& budget, const Record& record) {
    return rejection_of<std::invalid_argument>([&] { simulate(scene, Exact{.budget = budget}, record); });
  };
  const Record nothing{.half_cycles = false};
  CHECK(message({.max_impacts = most_rows + 1, .max_half_cycles = most_rows + 1}, nothing) == not_rejected);
  CHECK(message({.max_impacts = most_rows + 1}, {.impacts = true}) ==
        "max_impacts: must be <= 10000000 where impacts, contacts or energy are recorded, got 10000001");
  CHECK(message({.max_impacts = most_rows}, {.impacts = true}) == not_rejected);
  CHECK(message({.max_half_cycles = most_rows + 1}, {}) ==
        "max_half_cycles: must be <= 10000000 where half cycles are recorded, got 10000001");
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  CHECK(message({}, {.history = {{0, 0.5, most_samples}}}) == not_rejected);
  CHECK(message({}, {.history = {{0, 0.5, most_samples - 1}, {0.5, 1, 2}}}) ==
        "history: must ask for at most 500000 samples in all");
  CHECK(message({}, {.history_below = {{1, 1, most}, {0.5, 1, most}}}) ==
        "history_below: must ask for at most 500000 samples in all");
}

namespace {

template <class Value>
bool begins(const std::vector<Value>& whole, const std::vector<Value>& part) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}

template <class Options>
Run with_steps(const Scene& scene, std::int64_t steps) {
  Options options;
  options.max_steps = steps;
  return simulate(scene, options, {.impacts = true});
}

}  // namespace

TEST_CASE("motions too stiff for their length end by the budget of steps, and the next run has a whole one") {
  const Scene stiff{.damping_ratio = 1e6, .force_amplitude = 10, .until_time = 1e12};
  const Run fewer = with_steps<Exact>(stiff, 1'000), more = with_steps<Exact>(stiff, 1'000'000);
  CHECK(fewer.stop_reason == StopReason::step_budget);
  CHECK(more.stop_reason == StopReason::step_budget);
  CHECK(fewer.end_time < more.end_time);
  CHECK(more.end_time < 1e12);
  CHECK(begins(more.half_cycles->zero_crossing, fewer.half_cycles->zero_crossing));
  CHECK(begins(more.half_cycles->amplitude, fewer.half_cycles->amplitude));
  CHECK(begins(more.impacts->time, fewer.impacts->time));
  CHECK(simulate({.until_time = 50}, Exact{}, {}).stop_reason == StopReason::time);
}

// A hundredth of what nothing_lost/bounds.py lets the program run with the default budgets.
TEST_CASE_TEMPLATE("a long forced run ends by a budget or its time, never in an error", Options, Exact,
                   Restitution) {
  const Scene scene{.force_amplitude = 0.05, .until_time = 3e3};
  std::vector<double> before;
  for (const std::int64_t steps : {10, 100, 100'000}) {
    const Run run = with_steps<Options>(scene, steps);
    CHECK(run.stop_reason == (steps < 100'000 ? StopReason::step_budget : StopReason::time));
    CHECK(run.impacts->time.size() > before.size());
    CHECK(begins(run.impacts->time, before));
    before = run.impacts->time;
  }
}
