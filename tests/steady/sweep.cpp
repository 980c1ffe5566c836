// Steady states under force, against closed forms, against runs of simulate() that know nothing of them, and
// against made-up sequences.
#include "impact_damper/steady/sweep.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "impact_damper/responses/response_file.hpp"
#include "impact_damper/simulate.hpp"
#include "shared_scenes.hpp"
#include "steady_helpers.hpp"

namespace {

using namespace impact_damper;
using std::numbers::pi;

const Engine &rigid = rigid_and_compliant[0], &compliant = rigid_and_compliant[1];

SteadyState settled(const Scene& scene, const Engine& engine, const SteadyRule& rule = {}) {
  return ForcedScene(scene, engine).settle(release_of(scene), rule);
}

double period_of(const Scene& scene) { return 2 * pi / scene.force_frequency; }

// The run from `state` at phase 0 on, over so many periods of the force.
Run run_from(const Scene& scene, const Engine& engine, const SceneState& state, double periods,
             const Record& record) {
  Scene from = released_from(scene, state);
  from.until_time = periods * period_of(scene);
  return simulate(from, engine, record);
}

// Its motion, at `count` instants of `periods` periods of the force, both ends included.
History followed(const Scene& scene, const Engine& engine, const SceneState& state, double periods,
                 std::int64_t count) {
  const double end = periods * period_of(scene);
  return *run_from(scene, engine, state, periods, {.half_cycles = false, .history = {{0, end, count}}})
              .history;
}

TEST_CASE("a mass that is never struck leaves the closed form of the empty box") {
  for (const Engine& engine : rigid_and_compliant) {
    for (const double frequency : {0.3, 0.9, 1.0, 1.7}) {
      for (const auto& [f0, y0] : {std::pair{0.01, 0.5}, {-0.01, 0.5}, {0.01, 0.4}}) {
        const Scene scene{.damping_ratio = 0.05,
                          .x0 = 0,
                          .force_amplitude = f0,
                          .force_frequency = frequency,
                          .dampers = {{.y0 = y0}}};
        const std::complex<double> h(1 - frequency * frequency, 2 * scene.damping_ratio * frequency);
        const SteadyState steady = settled(scene, engine);
        REQUIRE(steady.means);
        CHECK(steady.period == 1);
        CHECK(steady.impacts == ImpactCounts{0, 0});
        CHECK(steady.symmetric == (y0 == 0.5));  // the secondary mass lies in the middle of the box's ways
        const double amplitude = std::abs(f0) / std::abs(h);
        CHECK(steady.means->amplitude == doctest::Approx(amplitude).epsilon(1e-8));
        CHECK(steady.means->fundamental == doctest::Approx(amplitude).epsilon(1e-8));
        CHECK(steady.means->lag_deg == doctest::Approx(std::arg(h) * 180 / pi).epsilon(1e-8));
        const double power = scene.damping_ratio * frequency * frequency * amplitude * amplitude;
        CHECK(steady.means->power == doctest::Approx(power).epsilon(1e-8));
        CHECK(steady.means->viscous_power == doctest::Approx(power).epsilon(1e-8));
        CHECK(steady.means->impact_power == 0);
      }
    }
  }
}

// With a clearance far below the amplitude a plastic impact leaves the mass on its wall but for the short
// time in which it crosses the cavity. By (1 + nu) x'' + nu y'' + 2 zeta x' + x = f, which holds throughout,
// y, of size 1, changes x by the order of nu, relative to an amplitude of 1e6.
TEST_CASE("a mass that sticks nearly all the time is as if locked in") {
  for (const double frequency : {0.6, 1.1}) {
    const Scene scene{.damping_ratio = 0.05,
                      .x0 = 0,
                      .force_amplitude = 1e6,
                      .force_frequency = frequency,
                      .dampers = {{.mass_ratio = 0.2, .restitution = 0}}};
    const std::complex<double> h(1 - 1.2 * frequency * frequency, 2 * scene.damping_ratio * frequency);
    const SteadyState steady = settled(scene, rigid);
    REQUIRE(steady.means);
    CHECK(steady.period == 1);
    CHECK(steady.impacts == ImpactCounts{1, 1});
    CHECK(steady.symmetric);
    CHECK(steady.means->fundamental == doctest::Approx(1e6 / std::abs(h)).epsilon(1e-6));
    CHECK(steady.means->lag_deg == doctest::Approx(std::arg(h) * 180 / pi).epsilon(1e-6));
  }
}

// x and the speed V of the secondary mass where it strikes each wall once in a period, at equal intervals,
// without damping: the mass leaves the left wall at t = 0, the force is f0 sin(omega t + tau).
struct SymmetricPair {
  double nu, omega, c, v, tau;
  SymmetricPair(const Scene& scene) : nu(scene.damper().mass_ratio), omega(scene.force_frequency) {
    const double e = scene.damper().restitution, a = pi / omega + 2 * nu * std::tan(pi / (2 * omega)),
                 q = (1 - e) / (1 + e) * (1 + nu) / omega;
    c = scene.force_amplitude / (1 - omega * omega);
    v = (a + std::sqrt(a * a - (a * a + 4 * q * q) * (1 - 4 * c * c))) / (a * a + 4 * q * q);
    tau = std::atan2((1 - a * v) / (2 * c), q * v / c);
  }
  double interval() const { return pi / omega; }
  std::array<double, 2> x_and_velocity(double t) const {  // 0 <= t <= interval
    const double half = interval() / 2, over = nu * v / std::cos(half);
    return {c * std::sin(omega * t + tau) - over * std::sin(t - half),
            c * omega * std::cos(omega * t + tau) - over * std::cos(t - half)};
  }
  // At phase 0 of the force; the second interval mirrors the first.
  std::array<double, 2> at_phase_0() const {
    double t = -tau / omega;
    while (t < 0) t += 2 * interval();
    const bool second = t > interval();
    auto [x, velocity] = x_and_velocity(second ? t - interval() : t);
    return second ? std::array{-x, -velocity} : std::array{x, velocity};
  }
  double amplitude() const {
    double largest = 0;
    constexpr int steps = 2000;
    for (int i = 0; i <= steps; ++i) {
      double from = interval() * std::max(i - 1, 0) / steps, to = interval() * i / steps;
      largest = std::max(largest, std::abs(x_and_velocity(to)[0]));
      if (!(x_and_velocity(from)[1] * x_and_velocity(to)[1] < 0)) continue;
      for (int n = 0; n < 60; ++n) {
        const double middle = (from + to) / 2;
        (x_and_velocity(from)[1] * x_and_velocity(middle)[1] <= 0 ? to : from) = middle;
      }
      largest = std::max(largest, std::abs(x_and_velocity(to)[0]));
    }
    return largest;
  }
};

TEST_CASE("two symmetric impacts in a period are those of the closed form") {
  // Where it is stable, and no irregular motion is met before.
  for (const auto& point :
       {std::pair{0.99, 0.05}, {1.01, 0.05}, {1.02, 0.05}, {1.01, 0.06}, {1.02, 0.06}, {1.03, 0.06}}) {
    const double frequency = point.first, f0 = point.second;
    Scene scene = active_scene(frequency);
    scene.damping_ratio = 0;
    scene.force_amplitude = f0;
    const SteadyState steady = settled(scene, rigid, {.tolerance = 1e-12});
    const SymmetricPair pair(scene);
    INFO(frequency, " ", f0);
    CHECK(steady.period == 1);
    CHECK(steady.impacts == ImpactCounts{1, 1});
    CHECK(steady.symmetric);
    const auto [x, v] = pair.at_phase_0();
    CHECK(std::abs(steady.state.x - x) < 1e-11);
    CHECK(std::abs(steady.state.v - v) < 1e-11);
    CHECK(std::abs(steady.means->amplitude - pair.amplitude()) < 1e-10);
    CHECK(steady.means->viscous_power == 0);
    // At an impact the relative speed w is V less that of the wall, -e w the one after it.
    const double w = (pair.v - pair.x_and_velocity(0)[1]) / scene.damper().restitution;
    const double nu = scene.damper().mass_ratio, e = scene.damper().restitution;
    CHECK(steady.means->impact_power ==
          doctest::Approx(2 * nu * (1 - e * e) * w * w / (2 * (1 + nu)) / period_of(scene)).epsilon(1e-9));
  }
}

TEST_CASE("means and phase are those of sums over a finely sampled motion") {
  for (const Engine& engine : rigid_and_compliant) {
    for (const double f0 : {0.05, -0.05, 8.0}) {  // in the last the mass sticks for a while
      Scene scene = active_scene(0.9);
      scene.force_amplitude = f0;
      scene.damping_ratio = f0 == 8 ? 0.3 : 0.01;
      const SteadyState steady = settled(scene, engine);
      INFO(f0, " ", std::string(name_of(engine)));
      REQUIRE(steady.period);
      const std::int64_t count = 40000 * *steady.period;
      const History history = followed(scene, engine, steady.state, double(*steady.period), count + 1);
      std::complex<double> sum = 0;
      double power = 0, viscous = 0, amplitude = 0;
      for (std::size_t i = 0; i < std::size_t(count); ++i) {
        const double phase = scene.force_frequency * history.time[i], v = history.v[i];
        sum += history.x[i] * std::polar(2.0, -phase) / double(count);
        power += f0 * std::sin(phase) * v / double(count);
        viscous += 2 * scene.damping_ratio * v * v / double(count);
        amplitude = std::max(amplitude, std::abs(history.x[i]));
      }
      // x = C sin(phase - lag): 2 <x exp(-i phase)> = -i C exp(-i lag), turned by half a turn where f0 < 0.
      const std::complex<double> c = sum * std::complex<double>(0, f0 < 0 ? -1 : 1);
      // The sums' errors: of the order of the step for v, which jumps; of its square for x.
      CHECK(steady.means->fundamental == doctest::Approx(std::abs(c)).epsilon(1e-7));
      CHECK(steady.means->lag_deg == doctest::Approx(-std::arg(c) * 180 / pi).epsilon(1e-7));
      CHECK(steady.means->power == doctest::Approx(power).epsilon(1e-3));
      CHECK(steady.means->viscous_power == doctest::Approx(viscous).epsilon(1e-3));
      CHECK(steady.means->amplitude == doctest::Approx(amplitude).epsilon(1e-7));
      // What the force puts in is lost.
      CHECK(steady.means->power ==
            doctest::Approx(steady.means->viscous_power + steady.means->impact_power).epsilon(1e-8));
    }
  }
}

TEST_CASE("a motion of two periods is found to be one, and a direct run repeats so") {
  for (const Engine& engine : rigid_and_compliant) {
    const Scene scene = active_scene(0.9);
    const SteadyState steady = settled(scene, engine);
    REQUIRE(steady.period == 2);
    CHECK(!steady.symmetric);
    const History history = followed(scene, engine, steady.state, 40, 41);
    for (std::size_t i = 0; i + 2 < history.time.size(); ++i) {
      CHECK(distance(state_in(history, i), state_in(history, i + 2)) < 1e-8);
      CHECK(distance(state_in(history, i), state_in(history, i + 1)) > 1e-2);
    }
    const Run run = run_from(scene, engine, steady.state, 20, {.impacts = true});
    CHECK(std::int64_t(run.impacts->time.size()) == 10 * (steady.impacts[0] + steady.impacts[1]));
    CHECK(std::ranges::count(run.impacts->wall, Wall::right) == 10 * steady.impacts[1]);
  }
}

TEST_CASE("a chaotic motion is not taken for a periodic one, and its means are those of a longer run") {
  const Scene scene = active_scene(0.94);
  const SteadyState steady = settled(scene, rigid, {.mean_periods = 2000});
  CHECK(!steady.period);
  CHECK(!steady.symmetric);
  CHECK(steady.transient_periods == 5000);
  CHECK(steady.measured_periods == 2000);
  // Chaos: what begins 1e-10 apart is far apart 100 periods later, and no nearer to any earlier state.
  SceneState near = steady.state;
  near.x += 1e-10;
  const History one = followed(scene, rigid, steady.state, 400, 401),
                other = followed(scene, rigid, near, 400, 401);
  CHECK(distance(state_in(one, 1), state_in(other, 1)) < 1e-8);
  CHECK(distance(state_in(one, 400), state_in(other, 400)) > 1e-3);
  for (std::size_t m = 1; m <= 16; ++m) CHECK(distance(state_in(one, 400), state_in(one, 400 - m)) > 1e-6);
  // Means over 20 000 further periods, which scatter far less, by the energy that one long run records.
  const Run run = run_from(scene, rigid, steady.state, 20000, {.energy = true});
  const double power = run.energy->forcing_work / (20000 * period_of(scene));
  // Of a mean of blocks the scatter is that of one, divided by the square root of their number. Four of them,
  // as ten blocks tell the scatter of one to a quarter only.
  CHECK(std::abs(power - steady.means->power) < 4 * steady.power_scatter / std::sqrt(10.0));
  CHECK(steady.power_scatter > 0);
  CHECK(steady.power_scatter < 0.1 * steady.means->power);
  CHECK(steady.amplitude_scatter > 0);
}

TEST_CASE("means of a motion that is not periodic are those of one run over the same periods") {
  for (const Engine& engine : rigid_and_compliant) {
    const Scene scene = active_scene(0.94);
    const ForcedScene forced(scene, engine);
    const SteadyState steady = forced.settle(release_of(scene), {.max_periods = 16, .mean_periods = 14});
    REQUIRE(!steady.period);
    CHECK(steady.measured_periods == 14);  // in blocks of one and of two
    const SceneState begin =
        forced.pass_periods(forced.pass_periods(release_of(scene))->states.back())->states.back();
    constexpr std::int64_t count = 14 * 2000;
    const History history = followed(scene, engine, begin, 14, count + 1);
    std::complex<double> sum = 0;
    double largest = 0;
    for (std::size_t i = 0; i <= std::size_t(count); ++i) {
      const double weight = i == 0 || i == std::size_t(count) ? 0.5 : 1;
      sum +=
          weight * history.x[i] * std::polar(2.0, -scene.force_frequency * history.time[i]) / double(count);
      largest = std::max(largest, std::abs(history.x[i]));
    }
    const Run run = run_from(scene, engine, begin, 14, {.impacts = true, .energy = true});
    const std::complex<double> c = sum * std::complex<double>(0, 1);
    // Each block begins anew, and chaos amplifies its rounding; the sums' own error is of the second order.
    CHECK(steady.means->fundamental == doctest::Approx(std::abs(c)).epsilon(1e-5));
    CHECK(steady.means->lag_deg == doctest::Approx(-std::arg(c) * 180 / pi).epsilon(1e-5));
    CHECK(steady.means->amplitude <= largest + 1e-5);  // a half cycle that a block cuts may hold the largest
    CHECK(steady.means->amplitude > 0.9 * largest);
    CHECK(steady.means->power ==
          doctest::Approx(run.energy->forcing_work / (14 * period_of(scene))).epsilon(1e-6));
    CHECK(steady.impacts[0] == std::ranges::count(run.impacts->wall, Wall::left));
    CHECK(steady.impacts[1] == std::ranges::count(run.impacts->wall, Wall::right));
  }
}

TEST_CASE("a list of one damper, and the halves of one, have the steady states of that damper") {
  for (const Engine& engine : rigid_and_compliant) {
    const Scene scene = active_scene(1.01);
    Scene halves = scene;
    halves.dampers.assign(
        2, {.mass_ratio = scene.damper().mass_ratio / 2, .wall_stiffness = 5e3, .y0 = scene.damper().y0});
    const SteadyState one = settled(scene, engine);
    REQUIRE(one.period == 1);
    for (const Scene& several : {list_of_one(scene), halves}) {
      const SteadyState same = settled(several, engine);
      const double unit = several.damper().clearance;
      CHECK(same.period == one.period);
      CHECK(std::abs(same.means->amplitude / unit - one.means->amplitude) < 1e-9);
      CHECK(std::abs(same.means->power / (unit * unit) - one.means->power) < 1e-9);
      CHECK(std::abs(same.means->impact_power / (unit * unit) - one.means->impact_power) < 1e-9);
      CHECK(same.symmetric == one.symmetric);
      REQUIRE(same.state.dampers.size() == several.dampers.size());
      for (const PlaceInCavity& each : same.state.dampers) {
        CHECK(std::abs(each.y / unit - one.state.dampers[0].y) < 1e-8);
        CHECK(std::abs(each.w / unit - one.state.dampers[0].w) < 1e-8);
      }
      for (const ImpactCounts& each : same.impacts_by_damper) CHECK(each == one.impacts);
      CHECK(same.impacts[0] == one.impacts[0] * std::int64_t(several.dampers.size()));
    }
  }
}

TEST_CASE("a steady motion of several dampers is that of one run, and carries its state along a sweep") {
  Scene scene = active_scene(1);
  scene.x0 = 0;
  scene.dampers = {{.mass_ratio = 0.03, .y0 = 0.5}, {.mass_ratio = 0.02, .clearance = 2.5, .y0 = 1}};
  for (const Engine& engine : rigid_and_compliant) {
    const ForcedScene forced(scene, engine);
    const auto passed = *forced.pass_periods(release_of(scene));
    const History history = followed(scene, engine, release_of(scene), 4, 5);
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(std::abs(history.x[i + 1] - passed.states[i].x) < 1e-9);
      for (std::size_t n = 0; n < 2; ++n)
        CHECK(std::abs(history.dampers[n].y[i + 1] - passed.states[i].dampers[n].y) < 1e-9);
    }
    const SteadyRule few{.tolerance = 1e-8, .max_periods = 300, .mean_periods = 20};
    const Sweep both = sweep(scene, engine, {&Scene::force_frequency, 0.98, 1, 3}, few, {release_of(scene)},
                             1, no_progress)[0];
    CHECK(both.up.back().state.dampers.size() == 2);
    const ForcedScene last(scene, engine);  // whose frequency is the last one
    const SteadyState again = last.settle(both.up[1].state, few);
    CHECK(again.state.x == both.up[2].state.x);
    CHECK(again.state.dampers[1].y == both.up[2].state.dampers[1].y);
  }
  CHECK_THROWS_AS(
      sweep(scene, rigid, {&SceneDamper::mass_ratio, 0.1, 0.2, 2}, {}, {release_of(scene)}, 1, no_progress),
      InvalidArguments);
}

TEST_CASE("a state that rounding has put beyond a rigid wall is on it") {
  const ForcedScene forced(active_scene(0.9), rigid);
  for (const auto& [beyond, on] : {std::pair{-1e-15, 0.0}, {1 + 1e-15, 1.0}}) {
    const double w = on == 0 ? 0.3 : -0.3;
    const auto one = *forced.pass_periods({0.2, 0.1, beyond, w}),
               other = *forced.pass_periods({0.2, 0.1, on, w});
    for (std::size_t i = 0; i < one.states.size(); ++i) CHECK(distance(one.states[i], other.states[i]) == 0);
  }
}

TEST_CASE("what a contact loses at the beginning of the measured periods counts") {
  int in_contact = 0;
  for (const double frequency : {0.4, 0.7, 0.9, 1.3}) {
    Scene scene = active_scene(frequency);
    scene.force_amplitude = 30;
    scene.damping_ratio = 0.3;
    const SteadyState steady = settled(scene, compliant);
    INFO(frequency);
    REQUIRE(steady.period);
    in_contact += steady.state.dampers[0].y < 0 || steady.state.dampers[0].y > 1;
    // The work of a contact that is cut at phase 0 counts in both its parts.
    CHECK(steady.means->power ==
          doctest::Approx(steady.means->viscous_power + steady.means->impact_power).epsilon(1e-10));
  }
  CHECK(in_contact > 0);
}

TEST_CASE("up and down differ where the mass may lie idle") {
  Scene scene = active_scene(1);
  scene.x0 = 0;
  scene.damping_ratio = 0.02;
  scene.force_amplitude = 0.03;  // beyond 1/2 at resonance, where the mass is struck at last
  const auto sweeps =
      sweep(scene, rigid, {&Scene::force_frequency, 0.9, 1.1, 11}, {}, {release_of(scene)}, 1, no_progress);
  REQUIRE(sweeps.size() == 1);
  const SteadyState &up = sweeps[0].up.front(), &down = sweeps[0].down.front();
  CHECK(up.impacts == ImpactCounts{0, 0});
  CHECK(up.means->amplitude ==
        doctest::Approx(0.03 / std::abs(std::complex<double>(1 - 0.81, 2 * 0.02 * 0.9))).epsilon(1e-8));
  CHECK(down.impacts[0] > 0);
  CHECK(down.impacts[1] > 0);
  CHECK(std::abs(down.means->fundamental - up.means->fundamental) > 0.01);
}

TEST_CASE("a sweep of the clearance of one damper passes over 1, where the scene has no list") {
  Scene scene = active_scene(0.9);
  scene.damper().clearance = 1.5;
  const Axis axis{{&SceneDamper::clearance, 0}, 0.5, 1.5, 3};
  for (const Engine& engine : rigid_and_compliant) {
    const SteadyRule rule{.max_periods = 500};
    const SweepResponse found{scene, engine, rule, axis,
                              sweep(scene, engine, axis, rule, {release_of(scene)}, 1, no_progress)};
    const Sweep& both = found.sweeps[0];
    for (const std::vector<SteadyState>& way : {both.up, both.down}) {
      CHECK(has_one_damper(axis.at(scene, 1)));
      for (const SteadyState& each : way) {
        REQUIRE(each.impacts_by_damper.size() == 1);
        CHECK(each.impacts_by_damper[0] == each.impacts);
        CHECK(each.state.dampers.size() == 1);
      }
    }
    CHECK(both.up[1].impacts != ImpactCounts{});
    const std::string text = response_text(found, std::nullopt);
    const Response read = parse_response("sweep.json", text);
    CHECK(response_text(read, std::nullopt) == text);
    CHECK(inconsistencies_of(read).empty());
  }
}

TEST_CASE("the way down begins where the way up ended") {
  const Scene scene = active_scene(1);
  const Axis axis{&Scene::force_frequency, 0.95, 0.97, 2};
  const SceneState from = release_of(scene);
  const auto sweeps = sweep(scene, rigid, axis, {.max_periods = 50}, {from, {from, 1e-3}}, 1, no_progress);
  const auto again = [&](std::int64_t i, SceneState state, double nudge) {
    state.x += nudge;
    return ForcedScene(axis.at(scene, i), rigid).settle(state, {.max_periods = 50}).state;
  };
  for (const auto& [start, up, down] : sweeps) {
    CHECK(distance(again(0, start, 0), up[0].state) == 0);
    CHECK(distance(again(1, up[0].state, start.nudge), up[1].state) == 0);
    CHECK(distance(again(1, up[1].state, 0), down[1].state) == 0);
    CHECK(distance(again(0, down[1].state, start.nudge), down[0].state) == 0);
  }
}

TEST_CASE("the n-th start has n nudges") {
  const auto starts = nudged({{1, 2, 0.5, 4}, {3, 0, 0, 0}, {5, 0, 0, 0}}, 0.25);
  REQUIRE(starts.size() == 3);
  for (std::size_t n = 0; n < 3; ++n) {
    CHECK(starts[n].x == 2 * double(n) + 1);
    CHECK(starts[n].nudge == 0.25 * double(n));
  }
}

TEST_CASE("a nudge parts sweeps that a stable motion has brought to one state") {
  Scene scene = active_scene(1);
  scene.damper().mass_ratio = 0.02;
  scene.damping_ratio = 0;
  scene.force_amplitude = 0.008;
  // Periodic and strongly stable down to the last, where the motion is irregular.
  const std::vector<double> frequencies{1.002, 1.001, 1.0005, 1, 0.9995, 0.999, 0.998, 0.99};
  const SteadyRule rule{.tolerance = 1e-12, .max_periods = 800, .mean_periods = 200};
  const auto along = [&](double x, double nudge) {
    return steady_states_along(scene, rigid, &Scene::force_frequency, frequencies, rule,
                               {{x, 0, 0.5, 0}, nudge}, [] {});
  };
  const auto one = along(1, 0), other = along(1.001, 0), nudged = along(1, 1e-6);
  for (std::size_t i = 0; i + 1 < frequencies.size(); ++i) {
    CAPTURE(frequencies[i]);
    CHECK(one[i].period);
    CHECK(distance(one[i].state, nudged[i].state) < 1e-10);
  }
  CHECK_FALSE(one.back().period);
  CHECK(distance(one[0].state, other[0].state) > 0);
  CHECK(distance(one.back().state, other.back().state) == 0);
  CHECK(distance(one.back().state, nudged.back().state) > 1e-3);
}

TEST_CASE("a sweep varies a number of one of several dampers, whose mass keeps its place in its cavity") {
  Scene scene = active_scene(1);
  scene.dampers = {{.mass_ratio = 0.03, .y0 = 0.5}, {.mass_ratio = 0.02, .clearance = 2.5, .y0 = 0.2}};
  const Axis clearance{{&SceneDamper::clearance, 1}, 0.4, 2, 3},
      restitution{{&SceneDamper::restitution, 0}, 0.3, 0.7, 3};
  CHECK(clearance.at(scene, 2).dampers[1].clearance == 2);
  CHECK(restitution.at(scene, 0).dampers[0].restitution == 0.3);
  const SteadyRule few{.max_periods = 40, .mean_periods = 20};
  for (const Engine& engine : rigid_and_compliant) {
    for (const Axis& axis : {clearance, restitution}) {
      const auto sweeps = sweep(scene, engine, axis, few, {release_of(scene)}, 1, no_progress);
      const std::vector<SteadyState>& up = sweeps[0].up;
      REQUIRE(up.size() == 3);
      for (const std::int64_t i : {1, 2}) {
        SceneState from = up[static_cast<std::size_t>(i) - 1].state;
        if (axis.number == clearance.number) from.dampers[1].y *= axis.value(i) / axis.value(i - 1);
        const SteadyState same = ForcedScene(axis.at(scene, i), engine).settle(from, few);
        CHECK(distance(same.state, up[static_cast<std::size_t>(i)].state) == 0);
      }
    }
  }
  CHECK_THROWS_AS(sweep(scene, rigid, {{&SceneDamper::clearance, 2}, 0.4, 2, 3}, few, {release_of(scene)}, 1,
                        no_progress),
                  InvalidArguments);
  scene.dampers.clear();
  CHECK_THROWS_AS(sweep(scene, rigid, clearance, few, {release_of(scene)}, 1, no_progress), InvalidArguments);
}

TEST_CASE("the mirror image of a scene has the mirror image of its response") {
  for (const Engine& engine : rigid_and_compliant) {
    Scene scene = active_scene(0.9);
    scene.x0 = 0.3;
    const SteadyState steady = settled(scene, engine);
    Scene mirror = released_from(scene, mirrored(release_of(scene), scene));
    mirror.force_amplitude = -scene.force_amplitude;
    const SteadyState reflected = settled(mirror, engine);
    REQUIRE(steady.period == 2);
    CHECK(reflected.period == steady.period);
    CHECK(steady.impacts[0] != steady.impacts[1]);
    CHECK(reflected.impacts == ImpactCounts{steady.impacts[1], steady.impacts[0]});
    CHECK(reflected.means->amplitude == doctest::Approx(steady.means->amplitude).epsilon(1e-9));
    CHECK(reflected.means->lag_deg == doctest::Approx(steady.means->lag_deg).epsilon(1e-9));
    CHECK(reflected.means->power == doctest::Approx(steady.means->power).epsilon(1e-9));
  }
}

TEST_CASE("states from period to period are those of one run") {
  for (const Engine& engine : rigid_and_compliant) {
    Scene scene = active_scene(0.97);
    scene.damping_ratio = 0.1;  // steady, so that rounding errors are not amplified
    scene.force_amplitude = 4;  // and in contact for long
    const auto passed = *ForcedScene(scene, engine).pass_periods(release_of(scene));
    const auto more = *ForcedScene(scene, engine).pass_periods(passed.states.back());
    const History history = followed(scene, engine, release_of(scene), 16, 17);
    for (std::size_t i = 0; i < 8; ++i) {
      CHECK(distance(passed.states[i], state_in(history, i + 1)) < 1e-9);
      CHECK(distance(more.states[i], state_in(history, i + 9)) < 1e-9);
    }
  }
}

// f0 = A eta(A): at resonance the force feeds f0 A/2 per radian, the impacts take eta A^2/2
// (docs/response.md). eta from a free decay that knows nothing of a force: the amplitudes of its half cycles,
// a straight line through those within 4 % of A. Where A falls regularly, with one or two or three impacts in
// each half cycle.
TEST_CASE("the largest steady amplitude is where the free decay loses what the force can feed") {
  Scene decay{.until_amplitude = 0.5, .dampers = {{.mass_ratio = 0.02}}};
  const HalfCycles half_cycles = *simulate(decay, rigid, Record{}).half_cycles;
  const auto lost_at = [&](double a) {  // A eta = -2 dA/dt
    double n = 0, t = 0, h = 0, tt = 0, th = 0;
    for (std::size_t i = 0; i < half_cycles.amplitude.size(); ++i) {
      if (std::abs(half_cycles.amplitude[i] / a - 1) > 0.04) continue;
      const double time = half_cycles.peak_time[i], height = half_cycles.amplitude[i];
      n += 1, t += time, h += height, tt += time * time, th += time * height;
    }
    REQUIRE(n > 5);
    return -2 * (n * th - t * h) / (n * tt - t * t);
  };
  for (const double ratio : {0.35, 0.40}) {
    Scene scene{.x0 = 0, .force_amplitude = ratio * 0.02, .dampers = {{.mass_ratio = 0.02}}};
    const Axis axis{&Scene::force_frequency, 0.98725, 0.98975, 11};
    double largest = 0;
    for (const Sweep& each : sweep(scene, rigid, axis, {.max_periods = 2000, .mean_periods = 100},
                                   {SceneState{3, 0, 0, 0}}, 1, no_progress)) {
      for (const SteadyState& steady : each.up) largest = std::max(largest, steady.means->fundamental);
      for (const SteadyState& steady : each.down) largest = std::max(largest, steady.means->fundamental);
    }
    INFO(ratio, " ", largest);
    CHECK(largest > 1);
    // Of order 1/A^2 of harmonics, the frequencies between those tried, and the fit of a bent curve.
    CHECK(lost_at(largest) == doctest::Approx(scene.force_amplitude).epsilon(0.03));
  }
}

// What a periodic motion is taken for, on sequences whose limit is known.
struct Found {
  std::int64_t after = 0;
  Recurrence::Repeats repeats{};
};
template <class Sequence>
std::optional<Found> found(const Sequence& sequence, std::int64_t most, const SteadyRule& rule = {}) {
  Recurrence recurrence(rule);
  for (std::int64_t n = 0; n < most; ++n)
    if (const auto repeats = recurrence.add(sequence(n))) return Found{n, *repeats};
  return std::nullopt;
}

TEST_CASE("a contraction counts as periodic no earlier than it is within the tolerance") {
  for (const double ratio : {0.3, 0.9, 0.99, 0.999}) {
    for (const double turn : {0.0, 0.7, 2.5, pi}) {  // the multiplier's argument
      const auto error = [&](std::int64_t n) { return 0.3 * std::pow(ratio, double(n)); };
      const auto sequence = [&](std::int64_t n) {
        return State<double>{0.5 + error(n) * std::cos(turn * double(n)),
                             -0.2 + error(n) * std::sin(turn * double(n)), 0.5, 0};
      };
      const auto repeats = found(sequence, 100000);
      INFO(ratio, " ", turn);
      REQUIRE(repeats);
      CHECK(repeats->repeats.period == 1);
      CHECK(error(repeats->after) < 1.5e-10);
      CHECK(error(repeats->after) > 1e-14);  // nor much later
      if (turn == 0) CHECK(*repeats->repeats.contraction == doctest::Approx(ratio).epsilon(1e-3));
    }
  }
}

TEST_CASE("the period is the shortest one") {
  for (const std::int64_t m : {1, 2, 3, 4, 6, 12, 16}) {
    for (const double ratio : {0.0, 0.5, 0.95}) {  // in each step
      const auto sequence = [&](std::int64_t n) {
        const double error = ratio == 0 ? 0 : 0.1 * std::pow(ratio, double(n));
        const double turn = 2 * pi * double(n % m) / double(m);
        return State<double>{std::cos(turn), std::sin(turn) + error, 0.5, -error};
      };
      const auto repeats = found(sequence, 10000);
      INFO(m, " ", ratio);
      REQUIRE(repeats);
      CHECK(repeats->repeats.period == m);
      CHECK(repeats->repeats.contraction.has_value() == (ratio > 0));
    }
  }
  const auto seventeen = [](std::int64_t n) { return State<double>{double(n % 17), 0, 0, 0}; };
  CHECK(!found(seventeen, 1000));
  CHECK(found(seventeen, 1000, {.longest_period = 17}));
}

TEST_CASE("what does not shrink is not periodic") {
  const auto drift = [](std::int64_t n) { return State<double>{0, 0, 0.5 + 1e-11 * double(n), 0}; };
  CHECK(!found(drift, 10000));
  const auto turning = [](std::int64_t n) { return State<double>{1e-11 * std::cos(double(n)), 0, 0.5, 0}; };
  CHECK(!found(turning, 10000));
  const auto growing = [](std::int64_t n) {
    return State<double>{1e-14 * std::pow(1.01, double(n)), 0, 0, 0};
  };
  CHECK(!found([&](std::int64_t n) { return growing(n + 1200); }, 1000));
}

TEST_CASE("a budget of the engine ends a point, which then has no means") {
  const Scene scene = active_scene(0.9);
  SteadyState steady = settled(scene, Exact{.budget = {.max_impacts = 3}});
  CHECK(steady.stop_reason == StopReason::impact_budget);
  CHECK(!steady.means);
  CHECK(!steady.period);
  steady = settled(scene, Exact{.max_steps = 5});
  CHECK(steady.stop_reason == StopReason::step_budget);
  CHECK(!steady.means);
}

TEST_CASE("no result depends on the number of threads") {
  const Scene scene = active_scene(1);
  const Axis axis{&Scene::force_frequency, 0.88, 1.12, 7};
  const SteadyRule rule{.max_periods = 400, .mean_periods = 50};
  std::vector<SceneState> starts;
  for (int i = 0; i < 12; ++i) starts.push_back({0.4 * i - 2, 0.1 * i, 0.08 * i, 0.2});
  std::string first;
  for (const std::int64_t threads : {1, 2, 5}) {
    const auto sweeps = sweep(scene, compliant, axis, rule, nudged(starts, 0), threads, no_progress);
    const std::string text = response_text(SweepResponse{scene, compliant, rule, axis, sweeps});
    if (first.empty()) first = text;
    CHECK(text == first);
  }
}

TEST_CASE("what is not valid is rejected") {
  const Scene scene = active_scene(1);
  const auto fields = [](const auto& call) {
    std::string names;
    try {
      call();
    } catch (const InvalidArguments& error) {
      for (const Problem& problem : error.problems()) names += problem.field + ' ';
    }
    return names;
  };
  Scene unforced = scene;
  unforced.force_amplitude = 0;
  CHECK(fields([&] { ForcedScene(unforced, rigid); }) == "force_amplitude ");
  CHECK(fields([&] { ForcedScene(scene, Cem{}); }) == "engine ");
  CHECK(fields([&] { ForcedScene(scene, rigid); }).empty());
  Scene outside = scene;
  outside.damper().y0 = -0.1;
  CHECK(fields([&] { ForcedScene(outside, rigid); }) == "y0 ");
  CHECK(fields([&] { ForcedScene(outside, compliant); }).empty());
  CHECK(fields([&] {
          sweep(scene, rigid, {&Scene::force_amplitude, -1, 1, 3}, {}, {release_of(scene)}, 1, no_progress);
        }) == "force_amplitude ");
  const double nan = std::nan("");
  for (const SteadyRule& rule :
       {SteadyRule{.tolerance = nan}, SteadyRule{.tolerance = 0}, SteadyRule{.tolerance = 0.1},
        SteadyRule{.longest_period = 0}, SteadyRule{.longest_period = 65}, SteadyRule{.max_periods = 0},
        SteadyRule{.mean_periods = 9}}) {
    const std::vector<Problem> problems = problems_of(rule);
    REQUIRE(problems.size() == 1);
    const std::string named = problems[0].field + ' ';
    CHECK(fields([&] {
            sweep(scene, rigid, {&Scene::force_amplitude, 0.1, 1, 3}, rule, {release_of(scene)}, 1,
                  no_progress);
          }) == named);
    CHECK(fields([&] {
            steady_states_along(scene, rigid, &Scene::force_amplitude, {0.1}, rule, release_of(scene), [] {});
          }) == named);
  }
  CHECK(problems_of(SteadyRule{}).empty());
}

}  // namespace
