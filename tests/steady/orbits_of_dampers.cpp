// The Poincare map and the orbits of several dampers: against those of one, and against simulations.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "impact_damper/orbits/branches.hpp"
#include "impact_damper/orbits/corrector.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "same_run.hpp"
#include "shared_scenes.hpp"
#include "steady_helpers.hpp"

using namespace impact_damper;
using reference::farthest;

namespace {

constexpr auto with_parameters = PoincareMap::Derivatives::by_state_and_parameters;

// The same state in half the unit of length, for list_of_one(), and the list's image in the scene's own
// units.
SceneState in_half_units(const State<double>& s) { return {2 * s.x, 2 * s.v, 2 * s.y, 2 * s.w}; }
PoincareImage in_own_units(PoincareImage image) {
  SceneState& state = image.state;
  state.x /= 2, state.v /= 2, state.dampers[0].y /= 2, state.dampers[0].w /= 2;
  for (double& each : image.by_frequency) each /= 2;
  for (OrbitImpact& each : image.impacts) each.speed /= 2;
  if (image.slowest_impact) *image.slowest_impact /= 2;
  if (image.nearest_miss) *image.nearest_miss /= 2;
  return image;
}

// Two dampers that a force near resonance keeps striking.
Scene two_dampers(double amplitude, double frequency, double second_clearance, double second_y0) {
  Scene scene = forced_scene(0.02, 0.05, frequency, amplitude);
  scene.x0 = 0.5;
  scene.dampers = {{.mass_ratio = 0.06, .y0 = 0.4, .w0 = 0.2},
                   {.mass_ratio = 0.04, .clearance = second_clearance, .y0 = second_y0}};
  return scene;
}

Branches branches_of(const Scene& scene, const Engine& engine, double to) {
  return find_branches(scene, engine, {Parameter::force_frequency, scene.force_frequency, to}, {},
                       {release_of(scene)}, {}, [](std::int64_t) {});
}
Branch branch_to_end_of_range(const Scene& scene, double to) {
  const Branches found = branches_of(scene, Restitution{}, to);
  REQUIRE(found.starts[0].branch == 0);
  CHECK(found.branches[0].branch.end == BranchEnd::range);
  return found.branches[0].branch;
}
SteadyState settled(const Scene& scene, const Engine& engine) {
  return ForcedScene(scene, engine).settle(release_of(scene), {.max_periods = 20'000});
}
bool agree(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || std::fabs(*a - *b) < 1e-9);
}

}  // namespace

TEST_CASE("the Poincare map of a list of one damper is that of the scene without a list") {
  int compared = 0, sticking = 0;
  std::array<int, 2> misses{};  // with compliant and with rigid walls
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    reference::Random random(seed);
    const double amplitude = random.log_uniform(0.1, 3), frequency = random.uniform(0.4, 2),
                 damping = random.log_uniform(1e-3, 0.5), mass = random.log_uniform(1e-3, 1);
    Scene scene = forced_scene(mass, damping, frequency, amplitude);
    scene.damper().restitution = random.uniform(0.2, 0.9);
    const bool rigid = seed % 2 == 0;
    const Engine& engine = rigid_and_compliant[rigid ? 0 : 1];
    const int half_periods = 1 + int(seed % 3);
    State<double> start{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(0.1, 0.9),
                        random.uniform(-1, 1)};
    if (rigid && random.chance(0.2)) start.y = start.w = 0;
    const PoincareImage one = *PoincareMap(scene, engine, half_periods)(start, with_parameters),
                        list = in_own_units(*PoincareMap(list_of_one(scene), engine, half_periods)(
                            in_half_units(start), with_parameters));
    double scale = 1;
    for (const StateVector& row : one.by_state)
      for (const double entry : row) scale = std::max(scale, std::fabs(entry));
    if (scale > 1e4 || one.slowest_impact.value_or(1) < 0.01) continue;
    ++compared;
    CHECK(farthest(vector_of(list.state), vector_of(one.state)) < 1e-11 * scale);
    for (std::size_t i = 0; i < 4; ++i) CHECK(farthest(list.by_state[i], one.by_state[i]) < 1e-8 * scale);
    const double by_force =
        std::max({scale, farthest(one.by_frequency, {0, 0, 0, 0}), farthest(one.by_amplitude, {0, 0, 0, 0})});
    CHECK(farthest(list.by_frequency, one.by_frequency) < 1e-8 * by_force);
    CHECK(farthest(list.by_amplitude, one.by_amplitude) < 1e-8 * by_force);
    REQUIRE(list.impacts.size() == one.impacts.size());
    for (std::size_t i = 0; i < one.impacts.size(); ++i) {
      CHECK(list.impacts[i].wall == one.impacts[i].wall);
      CHECK(list.impacts[i].damper == 0);
      CHECK(std::fabs(list.impacts[i].speed - one.impacts[i].speed) < 1e-9 * scale);
    }
    CHECK(list.sticking == one.sticking);
    sticking += one.sticking > 0;
    CHECK(agree(list.slowest_impact, one.slowest_impact));
    CHECK(list.idle.empty());
    CHECK(agree(list.nearest_miss, one.nearest_miss));
    misses[rigid] += one.nearest_miss.has_value();
  }
  CHECK(compared > 100);
  CHECK(misses[0] > 10);
  CHECK(misses[1] > 10);
  CHECK(sticking > 10);
}

TEST_CASE("half a period of several dampers applied twice is a period") {
  for (const Engine& engine : rigid_and_compliant) {
    const Scene scene = two_dampers(0.05, 0.9, 1.5, 0.7);
    const SceneState start = settled(scene, engine).state;
    const PoincareImage whole = *PoincareMap(scene, engine, 2)(start);
    const PoincareMap half(scene, engine, 1);
    const PoincareImage first = *half(start), second = *half(first.state);
    CHECK(farthest(vector_of(second.state), vector_of(whole.state)) < 1e-10);
    CHECK(whole.impacts.size() == first.impacts.size() + second.impacts.size());
    for (std::size_t j = 0; j < 6; ++j) {
      StateVector unit(6);
      unit[j] = 1;
      CHECK(farthest(product(second.by_state, product(first.by_state, unit)), product(whole.by_state, unit)) <
            1e-7);
    }
  }
}

TEST_CASE("the nearest miss of several dampers is that of their samples") {
  std::array<int, 2> compared{};  // with compliant and with rigid walls
  int during_contact = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    reference::Random random(seed);
    const bool rigid = seed % 2 == 0;
    const Engine& engine = rigid_and_compliant[rigid ? 0 : 1];
    const double force = random.uniform(0.1, 0.6), frequency = random.uniform(0.6, 1.4),
                 second_clearance = random.uniform(0.5, 3);
    Scene scene = two_dampers(force, frequency, second_clearance, 0.2);
    // Walls so soft that one mass often turns back while the other pushes its wall.
    for (SceneDamper& each : scene.dampers)
      each.wall_stiffness = each.mass_ratio * random.log_uniform(1, 100);
    const SceneState start = release_of(scene);
    const PoincareMap map(scene, engine, 4);
    const PoincareImage image =
        *map(start, seed % 3 == 0 ? PoincareMap::Derivatives::by_state : with_parameters);
    scene.until_time = map.duration();
    const Run run = simulate(
        scene, engine,
        {.half_cycles = false, .impacts = true, .contacts = true, .history = {{0, map.duration(), 100'001}}});
    if (rigid && !run.contacts->begin.empty()) continue;
    const History& history = *run.history;
    double nearest = std::numeric_limits<double>::infinity();
    bool is_during_contact = false;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& [y, w] = history.dampers[i];
      const double clearance = scene.dampers[i].clearance;
      for (std::size_t n = 1; n < y.size(); ++n) {
        const bool is_impact = std::ranges::any_of(run.impacts->time, [&](double time) {
          return time > history.time[n - 1] && time <= history.time[n];
        });
        const bool flies = std::min(y[n], y[n - 1]) > 0 && std::max(y[n], y[n - 1]) < clearance;
        if (!(w[n] * w[n - 1] < 0) || (rigid ? is_impact : !flies)) continue;
        const double gap = w[n] < 0 ? clearance - y[n] : y[n];
        if (!(gap < nearest)) continue;
        nearest = gap;
        const double other = history.dampers[1 - i].y[n];
        is_during_contact = other < 0 || other > scene.dampers[1 - i].clearance;
      }
    }
    REQUIRE(image.nearest_miss.has_value() == std::isfinite(nearest));
    if (!image.nearest_miss) continue;
    ++compared[rigid];
    during_contact += is_during_contact;
    CHECK(*image.nearest_miss == doctest::Approx(nearest).epsilon(1e-6));
  }
  CHECK(compared[0] > 10);
  CHECK(compared[1] > 10);
  CHECK(during_contact > 2);
}

TEST_CASE("the nearest miss of masses at rest in space is that of the linear response") {
  // x is the steady response X to the force, z_i = x + y_i rests, and y_i turns back where |X| is largest.
  const double f0 = 0.1, frequency = 0.7, zeta = 0.05;
  Scene scene = forced_scene(0.05, zeta, frequency, f0);
  const double stiff = 1 - frequency * frequency, damped = 2 * zeta * frequency,
               square = stiff * stiff + damped * damped;
  scene.x0 = -f0 * damped / square;
  scene.v0 = f0 * frequency * stiff / square;
  scene.dampers = {{.mass_ratio = 0.06, .y0 = 0.45 - scene.x0, .w0 = -scene.v0},
                   {.mass_ratio = 0.04, .y0 = 1.1 - scene.x0, .w0 = -scene.v0}};
  const std::array<SceneDamper, 2> both{scene.dampers[0], scene.dampers[1]};
  const auto check = [&](double z_from_wall) {
    for (const Engine& engine : rigid_and_compliant) {
      const PoincareImage image = *PoincareMap(scene, engine, 2)(release_of(scene));
      CHECK(image.impacts.empty());
      CHECK(*image.nearest_miss == doctest::Approx(z_from_wall - f0 / std::sqrt(square)).epsilon(1e-12));
    }
  };
  scene.dampers[1].clearance = 1.5;
  check(0.4);  // the second mass, at its right wall
  scene.dampers[1].clearance = 1.7;
  check(0.45);  // the first, at its left wall
  scene.dampers = {both[0]};
  check(0.45);
}

TEST_CASE("a mass that sticks from the start is not newly stuck by another mass's impact at time 0") {
  Scene scene = forced_scene(0.05, 0.05, 3, 0.05);
  scene.x0 = -0.5;  // x'' > 0 presses masses at rest to their left walls
  scene.dampers = {{.mass_ratio = 0.05}, {.mass_ratio = 1e-3, .clearance = 3, .y0 = 3, .w0 = 0.01}};
  const PoincareMap map(scene, Restitution{}, 1);
  const MotionChain chain = ForcedScene(scene, Restitution{}).record(release_of(scene), map.duration()).chain;
  REQUIRE(chain.impacts.size() == 1);
  CHECK(chain.impacts[0].time == 0);
  CHECK(chain.impacts[0].damper == 1);
  REQUIRE(chain.contacts.size() == 1);
  CHECK(chain.contacts[0].damper == 0);
  CHECK(chain.contacts[0].begin == 0);
  CHECK((*map(release_of(scene))).sticking == 0);
}

TEST_CASE("a stable orbit of two dampers is what simulation comes to, as fast as its multiplier says") {
  for (const Engine& engine : rigid_and_compliant) {
    const Scene scene = two_dampers(0.05, 0.9, 1.5, 0.7);
    const SteadyState steady = settled(scene, engine);
    REQUIRE(steady.period == 1);
    const Orbit orbit = *find_orbit(scene, engine, 1, steady.state);
    CHECK(orbit.symmetric);
    CHECK(orbit.stable());
    CHECK(orbit.multipliers.size() == 6);
    CHECK(orbit.impacts.size() == 4);
    CHECK(distance(release_of(orbit.scene), steady.state) < 1e-9);
    CHECK(*steady.contraction == doctest::Approx(orbit.multipliers[0].modulus()).epsilon(1e-3));

    // Newton's method converges with second order.
    SceneState guess = steady.state;
    guess.x += 1e-3;
    guess.dampers[1].w -= 1e-3;
    const Orbit again = *find_orbit(scene, engine, 1, guess);
    REQUIRE(again.residuals.size() > 3);
    CHECK(distance(release_of(again.scene), release_of(orbit.scene)) < 1e-9);
    const auto& r = again.residuals;
    CHECK(r[2] < 100 * r[1] * r[1]);
  }
}

TEST_CASE("a Neimark-Sacker point of two dampers is where simulation leaves the orbit") {
  const Scene scene = two_dampers(0.05, 0.9, 1.5, 0.7);
  const Branch branch = branch_to_end_of_range(scene, 1.1);
  const BranchEvent* const at = first_of(branch, BranchEventKind::neimark_sacker);
  REQUIRE(at);
  double growth[2];
  for (const int side : {0, 1}) {
    Scene near = at->orbit.scene;
    near.force_frequency = at->parameter + (side == 0 ? -1e-3 : 1e-3);
    const Orbit orbit = *find_orbit(near, Restitution{}, 1, release_of(near), {.symmetric = true});
    CHECK(orbit.stable() == (side == 0));
    SceneState s = release_of(orbit.scene);
    s.x += 1e-5;
    const PoincareMap map(near, Restitution{}, 2);
    double before = 0, after = 0;  // the largest departures of 40 periods, early and late
    for (int n = 0; n < 640; ++n) {
      s = map(s)->state;
      const double off = distance(s, release_of(orbit.scene));
      if (n < 40) before = std::max(before, off);
      if (n >= 600) after = std::max(after, off);
    }
    growth[side] = after / before;
  }
  CHECK(growth[0] < 0.5);
  CHECK(growth[1] > 2);
}

TEST_CASE("a damper that is not struck leaves the branches of the other as they are") {
  for (const Engine& engine : rigid_and_compliant) {
    Scene alone = forced_scene(0.06, 0.05, 0.9, 0.05);
    alone.x0 = 0.5;
    alone.damper().y0 = 0.4;
    alone.damper().w0 = 0.2;
    Scene both = alone;
    both.dampers = {{.mass_ratio = 0.06, .y0 = 0.4, .w0 = 0.2},
                    {.mass_ratio = 0.04, .clearance = 5, .y0 = 2.2}};
    const Branches expected = branches_of(alone, engine, 1.1), found = branches_of(both, engine, 1.1);
    REQUIRE(found.branches.size() == expected.branches.size());
    CHECK(found.branches.size() > 1);
    for (std::size_t n = 0; n < found.branches.size(); ++n) {
      const Branch &a = found.branches[n].branch, &b = expected.branches[n].branch;
      CHECK(a.end == b.end);
      REQUIRE(a.events.size() == b.events.size());
      for (std::size_t i = 0; i < a.events.size(); ++i) {
        CHECK(a.events[i].kind == b.events[i].kind);
        CHECK(std::fabs(a.events[i].parameter - b.events[i].parameter) < 1e-8);
      }
      for (const Orbit& orbit : a.orbits) {
        CHECK(orbit.idle == std::vector<std::size_t>{1});
        CHECK(orbit.multipliers.size() == 4);
        const SceneDamper& idle = orbit.scene.dampers[1];
        CHECK(std::fabs(orbit.scene.x0 + idle.y0 - 2.5) < 1e-9);
        CHECK(std::fabs(orbit.scene.v0 + idle.w0) < 1e-9);
      }
    }
  }
}

TEST_CASE("a branch goes on where impacts of both dampers pass phase 0") {
  const Scene scene = two_dampers(0.06, 0.76, 0.71, 0.2);
  const Branch branch = branch_to_end_of_range(scene, 0.96);
  std::array<int, 2> passed{};
  for (std::size_t n = 1; n < branch.orbits.size(); ++n) {
    const Orbit &before = branch.orbits[n - 1], &after = branch.orbits[n];
    for (std::size_t i = 0; i < 2; ++i) {
      const SceneDamper &a = before.scene.dampers[i], &b = after.scene.dampers[i];
      const double gap = std::max(std::min(a.y0, a.clearance - a.y0), std::min(b.y0, b.clearance - b.y0));
      passed[i] += a.w0 * b.w0 < 0 && gap < 0.05;
    }
    CHECK(before.impacts.size() == after.impacts.size());
  }
  CHECK(passed == std::array<int, 2>{1, 1});
}

TEST_CASE("an impact that passes phase 0 is carried across it with friction and weight") {
  Scene scene{.damping_ratio = 0.3, .x0 = 0, .force_amplitude = 0.7, .force_frequency = 0.9, .weight = 0.4};
  scene.dampers = {{.mass_ratio = 0.2, .restitution = 0.5, .friction = 0.9},
                   {.mass_ratio = 0.3, .clearance = 2, .friction = 0.6}};
  const SceneDamper &first = scene.dampers[0], &second = scene.dampers[1];
  // By parabolas with the forces at phase 0: back to the wall, or on to it where the mass leaves it, through
  // the impact, and the same time the other way. w_of: of the first mass after the impact, by that before.
  const auto carried = [&](StateVector s, double wall, double factor) {
    const auto rates = [&](double sign) {
      const double on_first = first.friction * sign, on_second = second.friction * (s[5] > 0 ? 1 : -1);
      const double a = -2 * scene.damping_ratio * s[1] - s[0] + first.mass_ratio * on_first +
                       second.mass_ratio * on_second;
      return std::array{a, -a - on_first - scene.weight, -a - on_second - scene.weight};
    };
    const auto pass = [&](double time, double sign) {
      const auto by = rates(sign);
      for (std::size_t i = 0; i < 3; ++i) {
        s[2 * i] += s[2 * i + 1] * time + by[i] * time * time / 2;
        s[2 * i + 1] += by[i] * time;
      }
    };
    const double before = s[3] > 0 ? 1 : -1, pull = rates(before)[1], way = s[2] - wall;
    // The root of way + w t + pull t^2/2 next to 0.
    const double time = -2 * way / (s[3] + before * std::sqrt(s[3] * s[3] - 2 * pull * way));
    pass(time, before);
    const double gained = first.mass_ratio * (s[3] - factor * s[3]) / (1 + first.mass_ratio);
    s[1] += gained, s[5] -= gained, s[3] *= factor;
    pass(-time, -before);
    return s;
  };
  constexpr double beyond = 1e-7;
  for (const double wall : {0.0, 1.0}) {
    for (const bool approaches : {true, false}) {
      for (const double other : {0.3, -0.8}) {
        CAPTURE(wall);
        CAPTURE(approaches);
        CAPTURE(other);
        const double out = wall > 0 ? 1 : -1, factor = approaches ? -0.5 : -2;
        const StateVector s{0.4, -0.7, wall + out * beyond, (approaches ? 1.1 : -1.1) * out, 1.2, other};
        const auto found = corrector::across_phase_0(scene, Restitution{}, s, s);
        REQUIRE(found);
        REQUIRE(found->by_state.size() == 1);
        const StateVector expected = carried(s, wall, factor);
        for (std::size_t i = 0; i < s.size(); ++i)
          CHECK(found->state[i] == doctest::Approx(expected[i]).epsilon(1e-12));
        for (std::size_t j = 0; j < s.size(); ++j) {
          constexpr double h = 1e-4;
          StateVector up = s, down = s;
          up[j] += h, down[j] -= h;
          const StateVector a = carried(up, wall, factor), b = carried(down, wall, factor);
          for (std::size_t i = 0; i < s.size(); ++i)
            CHECK(found->by_state[0][i][j] ==
                  doctest::Approx((a[i] - b[i]) / (2 * h)).epsilon(1e-5).scale(1));
        }
      }
    }
  }
}

TEST_CASE(
    "equal dampers that move as one have no multipliers with rigid walls, and none stable with others") {
  Scene scene = two_dampers(0.05, 0.9, 1, 0.2);
  scene.dampers[1] = scene.dampers[0];
  const Branches rigid = branches_of(scene, Restitution{}, 0.95);
  REQUIRE(rigid.starts[0].orbit == OrbitEnd::no_derivative);
  CHECK(end_of(rigid.starts[0]) == "no_derivative");
  CHECK(rigid.branches.empty());
  const SteadyState steady = settled(scene, Exact{});
  REQUIRE(steady.period);
  const Orbit orbit = *find_orbit(scene, Exact{}, int(*steady.period), steady.state);
  CHECK_FALSE(orbit.stable());
}

TEST_CASE("a branch ends where impacts of two dampers come to be at one instant") {
  Scene scene = forced_scene(0.02, 0.2, 1.325, 0.2237);
  scene.x0 = -0.68;
  scene.dampers = {{.mass_ratio = 0.02, .restitution = 0.34, .clearance = 1.0, .y0 = 0.917},
                   {.mass_ratio = 0.012, .restitution = 0.25, .clearance = 0.55, .y0 = 0.164}};
  const Branches found = branches_of(scene, Restitution{}, 1.025);
  const auto ended = std::ranges::find(found.branches, BranchEnd::coincidence,
                                       [](const FollowedBranch& each) { return each.branch.end; });
  REQUIRE(ended != found.branches.end());
  const Orbit& last = ended->branch.orbits.back();
  CHECK(*last.least_interval < 1e-6);
  CHECK(*last.slowest_impact > 0.05);
  double least = std::numeric_limits<double>::infinity();
  for (const OrbitImpact& one : last.impacts)
    for (const OrbitImpact& other : last.impacts)
      if (one.damper < other.damper) least = std::min(least, std::fabs(one.time - other.time));
  CHECK(*last.least_interval == doctest::Approx(least));
}

TEST_CASE("no grazing is told where an impact is slow all along a branch") {
  // Its masses chatter, and the first impact of one chattering has a speed of 5e-5.
  Scene scene = forced_scene(0.02, 0.02, 0.767, 0.3562);
  scene.x0 = 0.53;
  scene.dampers = {{.mass_ratio = 0.057, .restitution = 0.26, .clearance = 1.0, .y0 = 0.664},
                   {.mass_ratio = 0.038, .restitution = 0.22, .clearance = 0.67, .y0 = 0.6}};
  BranchRule rule;
  rule.steady.max_periods = 1500;
  rule.max_points = 60;
  rule.max_branches = 8;
  const Branches found = find_branches(scene, Restitution{}, {Parameter::force_amplitude, 0.3562, 0.7125},
                                       rule, {release_of(scene)}, {}, [](std::int64_t) {});
  int grazing = 0, slow = 0;
  for (const FollowedBranch& each : found.branches) {
    const Orbit& last = each.branch.orbits.back();
    slow += last.slowest_impact.value_or(1) < 1e-4 && each.branch.end != BranchEnd::grazing;
    for (const BranchEvent& event : each.branch.events) {
      if (event.kind != BranchEventKind::grazing) continue;
      ++grazing;
      CHECK(std::fabs(event.parameter - last.scene.force_amplitude) < 1e-6);
    }
  }
  CHECK(grazing > 0);
  CHECK(slow > 0);
}

TEST_CASE("a mass that sticks while phase 0 passes comes to stick once") {
  Scene scene = forced_scene(0.06, 0.3, 0.3, 3);
  scene.damper().restitution = 0.2;
  scene.x0 = 0.5;
  scene.damper().y0 = 0.4;
  const SteadyState steady = settled(scene, Restitution{});
  REQUIRE(steady.period == 1);
  const Orbit orbit = *find_orbit(scene, Restitution{}, 1, steady.state);
  CHECK(orbit.scene.damper().y0 * (1 - orbit.scene.damper().y0) == 0);
  CHECK(orbit.sticking == 2);
}

TEST_CASE("orbits are for at most a hundred dampers, and states of as many as the scene has") {
  Scene scene = two_dampers(0.05, 0.9, 1, 0.2);
  scene.dampers.resize(101);
  CHECK_THROWS_WITH_AS(branches_of(scene, Restitution{}, 1),
                       "dampers: must be at most 100 for orbits, got 101", InvalidArguments);
  scene.dampers.resize(2);
  CHECK_THROWS_WITH_AS(find_orbit(scene, Restitution{}, 1, State<double>{0.1, 0, 0.5, 0}),
                       "guess: must be of as many dampers as the scene's list, 2, got 1", InvalidArguments);
  CHECK_THROWS_WITH_AS(find_branches(scene, Restitution{}, {Parameter::force_frequency, 0.9, 1}, {},
                                     {State<double>{0.1, 0, 0.5, 0}}, {}, [](std::int64_t) {}),
                       "starts: must be of as many dampers as the scene's list, 2, got 1", InvalidArguments);
}
