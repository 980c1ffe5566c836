// Maps of what points end in, against each point followed by itself.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "impact_damper/responses/response_file.hpp"
#include "impact_damper/simulate.hpp"
#include "impact_damper/steady/sweep.hpp"
#include "steady_helpers.hpp"

namespace {

using namespace impact_damper;

const Engine &rigid = rigid_and_compliant[0], &compliant = rigid_and_compliant[1];

Scene scene_at(double frequency) {
  Scene scene = active_scene(frequency);
  scene.x0 = 0;
  return scene;
}
const Attractor* attractor_at(const Basin& map, std::int64_t n) {
  const std::int32_t index = map.attractor[std::size_t(n)];
  return index == undecided ? nullptr : &map.attractors[std::size_t(index)];
}

// Four motions coexist here: two of two periods and two of four, mirror images of each other.
TEST_CASE("each point ends in the motion to which it settles by itself") {
  const Scene scene = scene_at(0.9);
  const Axis x0{&Scene::x0, -1, 1, 24}, v0{&Scene::v0, -1, 1, 24};
  const Basin map = basin(scene, rigid, x0, v0, {}, 2, no_progress);
  CHECK(map.attractors.size() == 4);
  const ForcedScene forced(scene, rigid);
  std::vector<std::int64_t> points(map.attractors.size());
  for (std::int64_t n = 0; n < 24 * 24; ++n) {
    const Scene there = v0.at(x0.at(scene, n % 24), n / 24);
    const SteadyState steady = forced.settle(release_of(there), {});
    REQUIRE(attractor_at(map, n));
    const Attractor& attractor = *attractor_at(map, n);
    ++points[std::size_t(map.attractor[std::size_t(n)])];
    CHECK(attractor.period == steady.period);
    CHECK(attractor.impacts == steady.impacts);
    double nearest = 1;
    for (const SceneState& state : attractor.states)
      nearest = std::min(nearest, distance(state, steady.state));
    CHECK(nearest < 1e-5);
  }
  for (std::size_t i = 0; i < points.size(); ++i) CHECK(points[i] == map.attractors[i].points);
  for (std::size_t i = 1; i < points.size(); ++i) CHECK(points[i - 1] >= points[i]);
}

// Some points end where one mass is struck and the other rests somewhere: wherever, it is one motion.
TEST_CASE("of several dampers each point ends in the motion to which it settles by itself") {
  Scene scene = scene_at(0.9);
  scene.damping_ratio = 0.05;
  scene.dampers = {{.mass_ratio = 0.06, .y0 = 0.5}, {.mass_ratio = 0.04, .clearance = 1.5, .y0 = 0.7}};
  const Axis x0{&Scene::x0, -1, 1, 6}, second{{&SceneDamper::y0, 1}, 0, 1.5, 5};
  for (const Engine& engine : {rigid, compliant}) {
    const Basin map = basin(scene, engine, x0, second, {}, 2, no_progress);
    const ForcedScene forced(scene, engine);
    bool some_rests = false;
    for (std::int64_t n = 0; n < 6 * 5; ++n) {
      SteadyState steady = forced.settle(release_of(second.at(x0.at(scene, n % 6), n / 6)), {});
      REQUIRE(attractor_at(map, n));
      const Attractor& attractor = *attractor_at(map, n);
      CHECK(attractor.impacts == steady.impacts);
      if (attractor.idle) continue;
      CHECK(attractor.period == steady.period);
      CHECK(attractor.impacts_by_damper == steady.impacts_by_damper);
      double nearest = 1;
      for (SceneState state : attractor.states) {
        REQUIRE(state.dampers.size() == 2);
        for (const std::size_t i : {0, 1}) {
          if (steady.impacts_by_damper[i] != ImpactCounts{}) continue;
          state.dampers[i] = steady.state.dampers[i] = {};
          some_rests = true;
        }
        nearest = std::min(nearest, distance(state, steady.state));
      }
      CHECK(nearest < 1e-5);
    }
    CHECK(some_rests);
    for (std::size_t i = 0; i < map.attractors.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Attractor &one = map.attractors[i], &other = map.attractors[j];
        const bool rests = std::ranges::count(one.impacts_by_damper, ImpactCounts{}) > 0;
        CHECK_FALSE((rests && one.period == 1 && other.period == 1 &&
                     one.impacts_by_damper == other.impacts_by_damper &&
                     std::abs(one.states[0].x - other.states[0].x) < 1e-5));
      }
    }
  }
}

// The second mass drifts past the place where it would rest in a known motion, and into a wall much later.
TEST_CASE("a mass that drifts is not taken for one that rests") {
  Scene scene = scene_at(0.9);
  scene.damping_ratio = 0.05;
  scene.x0 = 0.2;
  scene.dampers = {{.mass_ratio = 0.06}, {.mass_ratio = 0.04, .clearance = 1.5}};
  const Axis place{{&SceneDamper::y0, 1}, 0.5491, 0.55, 2}, drift{{&SceneDamper::w0, 1}, -1e-6, 0, 2};
  const Basin map = basin(scene, rigid, place, drift, {}, 1, no_progress);
  CHECK(map.attractor == std::vector<std::int32_t>{undecided, undecided, 0, 0});
  REQUIRE(map.attractors.size() == 1);
  CHECK(map.attractors[0].impacts_by_damper[0] != ImpactCounts{});
  CHECK(map.attractors[0].impacts_by_damper[1] == ImpactCounts{});
}

// Each mass is at rest in the middle of a cavity whose walls hardly move.
TEST_CASE("several dampers are idle where none is struck again, and only there") {
  Scene scene = scene_at(0.5);
  scene.force_amplitude = 0.03;
  scene.dampers = {{.mass_ratio = 0.06, .y0 = 0.5}, {.mass_ratio = 0.04, .clearance = 0.6, .y0 = 0.3}};
  const auto motion_of = [&](const Scene& of) {
    const double h = of.force_amplitude / (1 - 0.25);  // hardly damped: in phase with the force
    Scene from = of;
    from.v0 = 0.5 * h;
    for (SceneDamper& damper : from.dampers) damper.w0 = -from.v0;
    const Basin map = basin(from, rigid, {&Scene::x0, -1e-6, 1e-6, 2}, {&Scene::damping_ratio, 1e-9, 2e-9, 2},
                            {}, 1, no_progress);
    return map.attractors.empty() ? Attractor{} : map.attractors[0];
  };
  CHECK(motion_of(scene).idle);
  scene.dampers[1].y0 = 0.03;  // within reach of the left wall
  CHECK_FALSE(motion_of(scene).idle);
}

// With a wide radius a point is near a motion long before it stays there.
TEST_CASE("to be near a motion once is not enough") {
  const Scene scene = scene_at(0.9);
  const Axis x0{&Scene::x0, -1, 1, 24}, v0{&Scene::v0, -1, 1, 24};
  const Basin narrow = basin(scene, rigid, x0, v0, {}, 2, no_progress),
              wide = basin(scene, rigid, x0, v0, {.capture_radius = 0.05}, 2, no_progress);
  REQUIRE(narrow.attractors.size() == wide.attractors.size());
  int equal = 0;
  for (std::int64_t n = 0; n < std::ssize(narrow.attractor); ++n) {
    const Attractor *one = attractor_at(narrow, n), *other = attractor_at(wide, n);
    equal += one && other && one->period == other->period && one->impacts == other->impacts;
  }
  CHECK(equal == 24 * 24);
}

TEST_CASE("the mirror image of a map is the map of mirror images") {
  const Scene scene = scene_at(0.9);
  Scene mirror = scene;
  mirror.force_amplitude = -scene.force_amplitude;
  const Axis x0{&Scene::x0, -1, 1, 21}, v0{&Scene::v0, -1, 1, 21};
  const Basin map = basin(scene, compliant, x0, v0, {}, 2, no_progress);
  const Basin other = basin(mirror, compliant, x0, v0, {}, 2, no_progress);
  REQUIRE(map.attractors.size() == other.attractors.size());
  int equal = 0;
  for (std::int64_t n = 0; n < 21 * 21; ++n) {
    const Attractor *one = attractor_at(map, n), *two = attractor_at(other, 21 * 21 - 1 - n);
    equal += one && two && one->period == two->period &&
             one->impacts == ImpactCounts{two->impacts[1], two->impacts[0]};
  }
  // Rounding may decide about a point on the border of two basins.
  CHECK(equal >= 21 * 21 - 4);
}

TEST_CASE("idle is where a direct run has no impact") {
  const Scene scene = scene_at(0.8);  // 0.05 / (1 - 0.64): the empty box moves by 0.139
  for (const double zeta : {0.0, 0.01}) {
    Scene damped = scene;
    damped.damping_ratio = zeta;
    const Axis x0{&Scene::x0, -1, 1, 41}, y0{&SceneDamper::y0, 0, 1, 11};
    const Basin map =
        basin(damped, rigid, x0, y0, {.steady = {.tolerance = 1e-6, .max_periods = 30}}, 2, no_progress);
    int idle = 0, struck = 0;
    for (std::int64_t n = 0; n < 41 * 11; ++n) {
      Scene there = y0.at(x0.at(damped, n % 41), n / 41);
      there.until_time = 300 * 2 * std::numbers::pi / there.force_frequency;
      const bool strikes = !simulate(there, rigid, {.impacts = true}).impacts->time.empty();
      const bool is_idle = attractor_at(map, n) && attractor_at(map, n)->idle;
      idle += is_idle;
      struck += strikes;
      CHECK(!(is_idle && strikes));
      // Without damping what is never struck keeps its transient: M14.5 is no estimate then, but for the
      // times at which transient and steady state add up.
      if (!strikes && zeta > 0) CHECK(is_idle);
    }
    CHECK(idle > 20);
    CHECK(struck > 20);
  }
}

TEST_CASE("over parameters a point is classified by its period, impacts and symmetry") {
  const Scene scene = scene_at(1);
  const Axis frequency{&Scene::force_frequency, 0.85, 1.15, 7}, force{&Scene::force_amplitude, 0.02, 0.2, 5};
  const Basin map = basin(scene, rigid, frequency, force, {}, 2, no_progress);
  int decided = 0;
  for (std::int64_t n = 0; n < 35; ++n) {
    const Scene there = force.at(frequency.at(scene, n % 7), n / 7);
    const SteadyState steady = ForcedScene(there, rigid).settle(release_of(there), {.max_periods = 1000});
    if (!attractor_at(map, n)) {
      CHECK(!steady.period);
      continue;
    }
    ++decided;
    const Attractor& attractor = *attractor_at(map, n);
    if (attractor.idle) {
      CHECK(steady.impacts == ImpactCounts{0, 0});
    } else if (steady.period) {  // with the map's tolerance it is sooner
      CHECK(attractor.period == steady.period);
      CHECK(attractor.impacts == steady.impacts);
      CHECK(attractor.symmetric == steady.symmetric);
    }
  }
  CHECK(decided > 15);
}

TEST_CASE("no map depends on the number of threads") {
  const Scene scene = scene_at(0.9);
  const Axis x0{&Scene::x0, -1, 1, 19}, v0{&Scene::v0, -1, 1, 17}, f0{&Scene::force_amplitude, 0.02, 0.2, 17};
  std::string maps[2];
  for (const std::int64_t threads : {1, 2, 5}) {
    for (const std::size_t i : {0, 1}) {
      const BasinRule rule{.steady = {.tolerance = 1e-6, .max_periods = 100}};
      const Axis& second = i == 0 ? v0 : f0;
      const std::string text = response_text(BasinResponse{
          scene, rigid, rule, x0, second, basin(scene, rigid, x0, second, rule, threads, no_progress)});
      if (maps[i].empty()) maps[i] = text;
      CHECK(text == maps[i]);
    }
  }
}

TEST_CASE("points that a budget ends are undecided, and counted") {
  const Exact few{.budget = {.max_impacts = 2}};
  const Axis x0{&Scene::x0, 0.5, 1, 3}, v0{&Scene::v0, 0.5, 1, 3};
  const Basin map = basin(scene_at(0.9), few, x0, v0, {}, 1, no_progress);
  CHECK(map.stopped == 9);
  CHECK(std::ranges::count(map.attractor, undecided) == 9);
  CHECK(map.attractors.empty());
}

}  // namespace
