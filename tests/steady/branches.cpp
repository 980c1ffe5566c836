#include "impact_damper/orbits/branches.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "steady_helpers.hpp"

using namespace impact_damper;

namespace {

Branches found_from(const Scene& scene, const ParameterRange& range, const std::vector<SceneState>& starts,
                    const BranchRule& rule = {}, const Engine& engine = Restitution{}) {
  return find_branches(scene, engine, range, rule, starts, {}, [](std::int64_t) {});
}
// What a simulation from the state of an orbit, at another value of the parameter, ends in.
SteadyState simulated(const Orbit& orbit, Parameter parameter, double value) {
  Scene scene = orbit.scene;
  scene.*member_of(parameter) = value;
  return ForcedScene(scene, orbit.engine).settle(release_of(orbit.scene), {.max_periods = 50'000});
}

}  // namespace

TEST_CASE("the branch of the steady motion of two impacts is the closed form, past its fold") {
  const Scene scene = forced_scene(0.02, 0.1, 0.9, 0.0655307);
  const Branches found =
      found_from(scene, {Parameter::force_frequency, 0.9, 2.5}, {two_impact_state(scene), {0, 0, 0.5, 0}});
  REQUIRE(found.starts.size() == 2);
  REQUIRE(found.starts[0].branch == 0);
  const FollowedBranch& followed = found.branches[0];
  CHECK(followed.origin == BranchOrigin::start);
  CHECK(followed.from == 0);
  CHECK(followed.branch.end == BranchEnd::range);
  int stable = 0, unstable = 0;
  for (std::size_t i = 0; i < followed.branch.orbits.size(); ++i) {
    const Orbit& orbit = followed.branch.orbits[i];
    (orbit.stable() ? stable : unstable) += 1;
    // Near a fold, where a multiplier is 1, both are known to half of the digits.
    double to_fold = 1;
    for (const Multiplier& m : *orbit.half_multipliers)
      to_fold = std::min(to_fold, std::hypot(1 - m.re, m.im));
    CHECK(off_closed_form(orbit) < (to_fold > 0.01 ? 1e-11 : 1e-9));
    // By the sweep's measure.
    if (orbit.stable())
      CHECK(followed.amplitudes[i] ==
            doctest::Approx(
                simulated(orbit, Parameter::force_frequency, orbit.scene.force_frequency).means->amplitude)
                .epsilon(1e-8));
  }
  CHECK(stable > 10);
  CHECK(unstable > 10);

  // A sweep sees the motion until the fold, and another one behind it.
  const BranchEvent* fold = first_of(followed.branch, BranchEventKind::fold);
  REQUIRE(fold);
  const auto before_fold = static_cast<std::size_t>(fold->orbits_before - 1);
  const Orbit& last = followed.branch.orbits[before_fold];
  const SteadyState before = simulated(last, Parameter::force_frequency, fold->parameter - 1e-4),
                    after = simulated(last, Parameter::force_frequency, fold->parameter + 1e-4);
  CHECK(before.period == 1);
  CHECK(before.impacts == ImpactCounts{1, 1});
  CHECK(after.impacts != ImpactCounts{1, 1});
}

TEST_CASE("branches of mirror images and of twice the period begin where simulations show them") {
  const Scene scene = forced_scene(0.02, 0.02, 0.9, 0.05);
  const Parameter parameter = Parameter::force_amplitude;
  const Branches found = found_from(scene, {parameter, 0.05, 0.12}, {two_impact_state(scene)});
  REQUIRE(found.starts[0].branch == 0);
  int compared = 0;
  for (const FollowedBranch& each : found.branches) {
    if (each.origin != BranchOrigin::event) continue;
    REQUIRE(each.event);
    const Branch& parent = found.branches[static_cast<std::size_t>(each.from)].branch;
    const BranchEvent& event = parent.events[static_cast<std::size_t>(*each.event)];
    const Orbit& orbit = each.branch.orbits.front();
    const bool breaks = event.kind == BranchEventKind::symmetry_breaking;
    CHECK((breaks || event.kind == BranchEventKind::flip));
    if (parent.end == BranchEnd::joined && &event == &parent.events.back()) {
      // The branch that the other has joined goes on on both sides.
      CHECK(2 * orbit.periods == event.orbit.periods);
      CHECK(orbit.scene.force_amplitude == event.parameter);
      continue;
    }
    CHECK(orbit.periods == (breaks ? 1 : 2) * event.orbit.periods);
    CHECK(!orbit.symmetric);
    if (!orbit.stable()) continue;
    // Both sides of the event, from the side of the new branch to the other.
    const double side = orbit.scene.force_amplitude > event.parameter ? 1 : -1;
    const SteadyState new_one = simulated(orbit, parameter, event.parameter * (1 + side * 1e-3)),
                      old_one = simulated(orbit, parameter, event.parameter * (1 - side * 1e-3));
    CHECK(new_one.period == orbit.periods);
    CHECK(!new_one.symmetric);
    CHECK(old_one.period == event.orbit.periods);
    CHECK(old_one.symmetric == event.orbit.symmetric);
    ++compared;
  }
  CHECK(compared >= 3);

  // Each once: that at 0.0920, which a branch joins from above, would begin at its other end, too.
  CHECK(found.branches.size() == 10);

  // Two branches end in one grazing, from both of its sides: a stable motion, and an unstable one.
  std::vector<double> grazings;
  for (const FollowedBranch& each : found.branches)
    if (each.branch.end == BranchEnd::grazing && each.branch.orbits.front().periods == 1)
      grazings.push_back(each.branch.events.back().parameter);
  REQUIRE(grazings.size() == 2);
  CHECK(std::fabs(grazings[0] - grazings[1]) < 1e-9);
}

TEST_CASE("a mass that is not struck is followed to where it grazes, and simulation leads on") {
  const Scene scene = forced_scene(0.02, 0.05, 0.8, 0.1);
  const Branches found =
      found_from(scene, {Parameter::force_amplitude, 0.1, 0.3}, {{0.1, 0, 0.4, 0}, {0.1, 0, 0.45, 0}});
  // Both rest elsewhere, which is one motion.
  CHECK(found.starts[0].branch == 0);
  CHECK(found.starts[1].branch == 0);
  const FollowedBranch& idle = found.branches.at(0);
  REQUIRE(idle.branch.end == BranchEnd::grazing);
  const double w = scene.force_frequency, graze = 0.5 * std::hypot(1 - w * w, 2 * scene.damping_ratio * w);
  CHECK(std::fabs(idle.branch.events.back().parameter - graze) < 1e-10);
  CHECK(idle.amplitudes.front() == doctest::Approx(0.1 * 0.5 / graze).epsilon(1e-9));
  REQUIRE(found.branches.size() >= 3);
  const Orbit& beyond = found.branches[1].branch.orbits.front();
  CHECK(found.branches[1].origin == BranchOrigin::beyond);
  CHECK(found.branches[1].from == 0);
  CHECK(beyond.scene.force_amplitude == doctest::Approx(graze + 2e-4).epsilon(1e-9));
  CHECK(beyond.stable());
  CHECK(!beyond.impacts.empty());
  // Both ways from there.
  CHECK(found.branches[2].branch.orbits.front().scene.x0 == beyond.scene.x0);
  CHECK(found.branches[1].branch.orbits[1].scene.force_amplitude > beyond.scene.force_amplitude);
  CHECK(found.branches[2].branch.orbits[1].scene.force_amplitude < beyond.scene.force_amplitude);
}

TEST_CASE("a start on a branch that is known begins no other, and starts without an orbit say why") {
  Scene scene = forced_scene(0.02, 0.02, 0.9, 0.06);
  State<double> start = two_impact_orbits(scene).at(0).state;
  start.w += 1e-3;
  const ParameterRange range{Parameter::force_amplitude, 0.06, 0.061};
  const SceneState mirror_image = PoincareMap(scene, Restitution{}, 1)(start)->state;
  const Branches found = found_from(scene, range, {start, mirror_image}, {.max_branches = 1});
  CHECK(end_of(found.starts[0]) == "periodic");
  CHECK(found.starts[0].branch == 0);
  CHECK(found.starts[1].branch == 0);
  CHECK(found.branches.size() == 1);

  const Branches open = found_from(scene, range, {start}, {.steady = {.max_periods = 5}});
  CHECK(end_of(open.starts[0]) == "not_periodic");
  CHECK(!open.starts[0].branch);
  CHECK(open.branches.empty());
  const Branches ended = found_from(scene, range, {start}, {}, Restitution{.budget = {.max_impacts = 1}});
  CHECK(end_of(ended.starts[0]) == "impact_budget");

  // The larger end may be the first.
  const Branches down =
      found_from(scene, {Parameter::force_amplitude, 0.061, 0.06}, {start}, {.max_branches = 1});
  const std::vector<Orbit>& orbits = down.branches.at(0).branch.orbits;
  CHECK(orbits.front().scene.force_amplitude == 0.061);
  CHECK(orbits.back().scene.force_amplitude == 0.06);
}

TEST_CASE("branches do not depend on the number of threads, and more than were asked for are told") {
  const Scene scene = forced_scene(0.02, 0.02, 0.9, 0.05);
  const State<double> start = two_impact_orbits(scene).at(0).state;
  const auto found = [&](std::int64_t threads) {
    std::int64_t last = 0;
    const Branches all =
        find_branches(scene, Exact{}, {Parameter::force_amplitude, 0.05, 0.06}, {.max_branches = 2},
                      {start, {0, 0, 0.5, 0}}, threads, [&](std::int64_t done) { last = done; });
    CHECK(last == std::ssize(all.branches));
    return all;
  };
  const Branches one = found(1), three = found(3);
  CHECK(!one.complete);
  REQUIRE(one.branches.size() == 2);
  REQUIRE(three.branches.size() == 2);
  for (std::size_t n = 0; n < 2; ++n) {
    CHECK(one.branches[n].amplitudes == three.branches[n].amplitudes);
    CHECK(one.branches[n].branch.orbits.back().scene.x0 == three.branches[n].branch.orbits.back().scene.x0);
  }
}

TEST_CASE("where the orbit that a branch joins is not found, the branch goes on") {
  // The secant method for a junction leads to where no orbit is found.
  const Scene scene{
      .damping_ratio = 0.0475,
      .x0 = 0,
      .force_amplitude = 0.1074,
      .until_time = 1,
      .dampers = {{.mass_ratio = 0.0375, .restitution = 0.469, .wall_stiffness = 216, .y0 = 0.577}}};
  const Branches found = found_from(scene, {Parameter::force_frequency, 1.09, 0.8176}, {{0, 0, 0.577, 0}},
                                    {.max_branches = 8}, Exact{});
  CHECK(found.branches.size() == 8);
  for (const FollowedBranch& each : found.branches)
    for (const Orbit& orbit : each.branch.orbits) {
      const SceneState begin = release_of(orbit.scene);
      const PoincareImage image = *PoincareMap(orbit.scene, orbit.engine, 2 * orbit.periods)(begin);
      CHECK(distance(image.state, begin) <= 1e-6 * size_of(begin));
    }
}

TEST_CASE("what is not valid is rejected, with its fields") {
  const Scene scene = forced_scene(0.02, 0.02, 0.9, 0.05);
  const auto fails = [&](const ParameterRange& range, const BranchRule& rule) {
    CHECK_THROWS_AS(found_from(scene, range, {{}}, rule), InvalidArguments);
  };
  fails({Parameter::force_amplitude, 0, 1}, {});
  fails({Parameter::force_amplitude, 1, 1}, {});
  fails({Parameter::force_amplitude, 0.5, std::nan("")}, {});
  fails({Parameter::force_frequency, 0.5, 1e300}, {});
  fails({Parameter::force_amplitude, 0.5, 1}, {.largest_step = 0});
  fails({Parameter::force_amplitude, 0.5, 1}, {.max_points = 0});
  fails({Parameter::force_amplitude, 0.5, 1}, {.max_branches = 0});
  fails({Parameter::force_amplitude, 0.5, 1}, {.steady = {.tolerance = 0}});
}
