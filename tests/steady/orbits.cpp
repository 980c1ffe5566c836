#include "impact_damper/orbits/orbits.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "steady_helpers.hpp"

using namespace impact_damper;

namespace {

double bisected(double low, double high, const std::function<bool(double)>& is_low) {
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (is_low(middle) ? low : high) = middle;
  }
  return low;
}
// An event at which nothing branches off.
BranchEvent fold_at(const Scene& scene) {
  return {BranchEventKind::fold, scene.force_amplitude, first_orbit(scene)};
}
}  // namespace

TEST_CASE("orbits of two symmetric impacts are those of the closed form, with their multipliers") {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    reference::Random random(seed);
    const double amplitude = random.log_uniform(0.05, 1), frequency = random.uniform(0.5, 1.6),
                 damping = random.log_uniform(5e-3, 0.5), mass = random.log_uniform(1e-4, 1);
    Scene scene = forced_scene(mass, damping, frequency, amplitude);
    scene.damper().restitution = random.uniform(0.2, 0.9);
    for (const TwoImpactOrbit& expected : two_impact_orbits(scene)) {
      SceneState guess = expected.state;
      if (!(guess.dampers[0].y > 0.01 && guess.dampers[0].y < 0.99) || expected.impact_speed < 0.05) continue;
      guess.x += 1e-5;
      guess.dampers[0].w -= 1e-5;
      const auto found = find_orbit(scene, Restitution{}, 1, guess);
      if (!found || found->impacts.size() != 2) continue;  // a wall was in the way of the closed form
      const Orbit& orbit = *found;
      ++compared;
      CHECK(orbit.symmetric);
      CHECK(orbit.periods == 1);
      const double scale = 1 + linear_amplitude(scene) + 1 / expected.impact_speed;
      CHECK(distance(release_of(orbit.scene), expected.state) < 1e-12 * scale);
      CHECK(std::fabs(orbit.impacts[0].speed - expected.impact_speed) < 1e-12 * scale);
      REQUIRE(orbit.half_multipliers);
      for (std::size_t i = 0; i < 4; ++i)  // of a pair the one above the real axis is first
        if (orbit.multipliers[i].im < 0) CHECK(orbit.multipliers[i - 1].im == -orbit.multipliers[i].im);
      // Of the whole period, by its own derivative.
      const Multipliers whole =
          multipliers_of(PoincareMap(scene, Restitution{}, 2)(release_of(orbit.scene))->by_state);
      double of_whole = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        const Multiplier &a = orbit.multipliers[i], &b = whole[i];
        of_whole += a.re * a.re - a.im * a.im - (b.re * b.re - b.im * b.im);
      }
      CHECK(std::fabs(of_whole) < 1e-11 * scale * (1 + std::pow(whole[0].modulus(), 2)));
      // The coefficients of the characteristic polynomial, which keep their digits where two roots are near.
      double sum = 0, sum_of_squares = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        const Multiplier &a = (*orbit.half_multipliers)[i], &b = expected.half_multipliers[i];
        sum += a.re - b.re;
        sum_of_squares += a.re * a.re - a.im * a.im - (b.re * b.re - b.im * b.im);
      }
      const double size = 1 + orbit.multipliers[0].modulus();
      CHECK(std::fabs(sum) < 1e-12 * scale * size);
      CHECK(std::fabs(sum_of_squares) < 1e-12 * scale * size * size);
    }
  }
  CHECK(compared >= 100);
}

TEST_CASE("Newton's iteration converges quadratically") {
  const Scene scene = forced_scene(0.02, 0.05, 0.9, 0.1);
  const TwoImpactOrbit exact = two_impact_orbits(scene).at(0);
  for (const Engine& engine : {Engine(Restitution{}), Engine(Exact{.calibration = Calibration::two_body})}) {
    SceneState guess = exact.state;
    guess.x += 0.02;
    guess.v -= 0.02;
    const Orbit orbit = *find_orbit(scene, engine, 1, guess);
    int quadratic = 0;
    for (std::size_t i = 0; i + 1 < orbit.residuals.size(); ++i) {
      const double now = orbit.residuals[i], next = orbit.residuals[i + 1];
      if (!(now < 2e-2 && now > 1e-7)) continue;
      CHECK(std::log(next) / std::log(now) > 1.6);
      ++quadratic;
    }
    CHECK(quadratic >= 2);
    CHECK(orbit.residual() < 1e-12);
  }
}

TEST_CASE(
    "a branch through both folds closes, and is the closed form throughout, also where impacts pass phase "
    "0") {
  const Scene scene = forced_scene(0.02, 0.1, 0.9, 0.0655307);
  const Branch branch = follow(first_orbit(scene), Parameter::force_frequency, {.least = 0.3, .most = 2.5});
  CHECK(branch.end == BranchEnd::closed);
  bool left_before = false, left_after = false;
  for (const Orbit& orbit : branch.orbits) {
    CHECK(off_closed_form(orbit) < 1e-9);  // near a fold both orbits are known to half of the digits
    REQUIRE(orbit.impacts.size() == 2);
    (orbit.impacts[0].wall == Wall::left ? left_before : left_after) = true;
  }
  CHECK(left_before);
  CHECK(left_after);
  REQUIRE(branch.events.size() == 2);
  const auto fold_between = [&](double low, double high, bool exists_low) {
    return bisected(low, high, [&](double frequency) {
      Scene changed = scene;
      changed.force_frequency = frequency;
      return (linear_amplitude(changed) > least_linear_amplitude(changed)) == exists_low;
    });
  };
  for (const BranchEvent& event : branch.events) {
    CHECK(event.kind == BranchEventKind::fold);
    const double expected = event.parameter > 1 ? fold_between(1, 2, true) : fold_between(0.3, 0.9, false);
    CHECK(std::fabs(event.parameter - expected) < 1e-10);
  }
}

TEST_CASE("a heavy secondary mass, too, is followed both ways through its impacts at phase 0") {
  const Scene scene = forced_scene(0.5, 0.1, 1.2, 0.224362);
  const Orbit first = first_orbit(scene);
  for (const bool upwards : {true, false}) {
    const Branch branch = follow(first, Parameter::force_frequency,
                                 {.least = 0.3, .most = 2.5, .upwards = upwards, .max_points = 400});
    int crossings = 0;
    for (std::size_t i = 0; i < branch.orbits.size(); ++i) {
      const Orbit& orbit = branch.orbits[i];
      if (orbit.slowest_impact.value_or(0) > 1e-3) CHECK(off_closed_form(orbit) < 1e-8);
      if (i > 0) crossings += orbit.impacts[0].wall != branch.orbits[i - 1].impacts[0].wall;
    }
    CHECK(crossings >= 1);
    CHECK(branch.orbits.size() < 150);
  }
}

TEST_CASE("near a fold no step leads from one side of the branch to the other") {
  const Scene scene = forced_scene(0.5, 0.1, 1.4, 0.309605);
  const Branch branch =
      follow(first_orbit(scene), Parameter::force_frequency, {.least = 0.3, .most = 2.5, .upwards = false});
  REQUIRE(branch.end == BranchEnd::grazing);
  CHECK(first_of(branch, BranchEventKind::fold) != nullptr);
  const double expected = bisected(0.3, 0.9, [&](double frequency) {
    Scene changed = scene;
    changed.force_frequency = frequency;
    return linear_amplitude(changed) < 0.5;
  });
  CHECK(std::fabs(first_of(branch, BranchEventKind::grazing)->parameter - expected) < 1e-10);
}

TEST_CASE(
    "symmetry breaking and Neimark-Sacker are where the closed form's multipliers are on the unit circle") {
  const auto faster = [](const Scene& scene, double amplitude) {
    Scene changed = scene;
    changed.force_amplitude = amplitude;
    return two_impact_orbits(changed).at(0);
  };
  {
    const Scene scene = forced_scene(0.02, 0.02, 0.9, 0.04);
    const Branch branch =
        follow(first_orbit(scene), Parameter::force_amplitude, {.least = 0.03, .most = 0.07});
    const BranchEvent* event = first_of(branch, BranchEventKind::symmetry_breaking);
    REQUIRE(event);
    const double expected = bisected(0.04, 0.07, [&](double amplitude) {
      double least = 0;
      for (const Multiplier& m : faster(scene, amplitude).half_multipliers) least = std::min(least, m.re);
      return least > -1;
    });
    CHECK(std::fabs(event->parameter - expected) < 1e-10);
    CHECK(branch.end == BranchEnd::range);
    CHECK(branch.orbits.back().scene.force_amplitude == 0.07);
  }
  {
    const Scene scene = forced_scene(0.02, 0.02, 1.2, 0.06);
    const Branch branch = follow(first_orbit(scene), Parameter::force_amplitude,
                                 {.least = 0.0385, .most = 0.07, .upwards = false});
    const BranchEvent* event = first_of(branch, BranchEventKind::neimark_sacker);
    REQUIRE(event);
    const double expected = bisected(0.0385, 0.06, [&](double amplitude) {
      double most = 0;
      for (const Multiplier& m : faster(scene, amplitude).half_multipliers)
        if (m.im != 0) most = std::max(most, m.modulus());
      return most > 1;
    });
    CHECK(std::fabs(event->parameter - expected) < 1e-10);
  }
}

TEST_CASE("a secondary mass that is not struck grazes both walls where the linear amplitude is 1/2") {
  for (const double nu : {1e-6, 0.02, 1e6}) {
    for (const double frequency : {0.8, 1.0, 1.7}) {
      const Scene scene = forced_scene(nu, 0.05, frequency, 0.02);
      const Orbit idle = *find_orbit(scene, Restitution{}, 1, {0, 0, 0.5, 0}, {.symmetric = true});
      CHECK(idle.impacts.empty());
      CHECK(!idle.stable());
      CHECK(*idle.nearest_miss == doctest::Approx(0.5 - linear_amplitude(scene)).epsilon(1e-12));
      const Branch branch = follow(idle, Parameter::force_amplitude, {.least = 0.01, .most = 2});
      CHECK(branch.end == BranchEnd::grazing);
      REQUIRE(branch.events.size() == 1);
      CHECK(branch.events[0].kind == BranchEventKind::grazing);
      const double expected = 0.02 * 0.5 / linear_amplitude(scene);
      CHECK(std::fabs(branch.events[0].parameter - expected) < 1e-10);
      if (nu != 0.02) continue;
      // Compliant walls are met at the same amplitude.
      const Orbit between = *find_orbit(scene, Exact{}, 1, {0, 0, 0.5, 0}, {.symmetric = true});
      const Branch soft = follow(between, Parameter::force_amplitude, {.least = 0.01, .most = 2});
      REQUIRE(!soft.events.empty());
      CHECK(soft.end == BranchEnd::grazing);
      CHECK(soft.events[0].kind == BranchEventKind::grazing);
      CHECK(std::fabs(soft.events[0].parameter - expected) < 2e-9);
    }
  }
}

TEST_CASE("orbits of two impacts end in the same grazing, from the other side") {
  for (const double nu : {0.02, 0.1}) {
    const Scene scene = forced_scene(nu, 0.1, 0.9, 0.08);
    const Branch branch = follow(first_orbit(scene), Parameter::force_amplitude,
                                 {.least = 0.005, .most = 0.3, .upwards = false});
    CHECK(branch.end == BranchEnd::grazing);
    const BranchEvent* event = first_of(branch, BranchEventKind::grazing);
    REQUIRE(event);
    CHECK(std::fabs(event->parameter - 0.08 * 0.5 / linear_amplitude(scene)) < 1e-10);
  }
}

TEST_CASE("compliant walls tend to rigid ones, with the root of the stiffness") {
  Scene scene = forced_scene(0.02, 0.05, 0.9, 0.1);
  const TwoImpactOrbit rigid = two_impact_orbits(scene).at(0);
  double before = 0;
  for (const double stiffness : {1e6, 1e8, 1e10}) {
    scene.damper().wall_stiffness = stiffness;
    const Orbit orbit = *find_orbit(scene, Exact{.calibration = Calibration::two_body}, 1, rigid.state);
    CHECK(orbit.symmetric);
    const double off = distance(release_of(orbit.scene), rigid.state);
    if (before > 0) CHECK(before / off == doctest::Approx(10).epsilon(0.05));
    before = off;
  }
  CHECK(before < 1e-4);
}

TEST_CASE("a stable orbit is where ten thousand periods of simulation stay") {
  const Scene light = forced_scene(0.02, 0.05, 0.9, 0.1);
  Scene strong = forced_scene(0.1, 0.02, 0.95, 0.3);
  strong.damper().wall_stiffness = 1e5;
  int stable = 0, sticking = 0;
  for (int i = 0; i < 4; ++i) {
    const Scene& of = i < 2 ? light : strong;
    const Engine& engine = rigid_and_compliant[std::size_t(i % 2)];
    const Orbit orbit = *find_orbit(of, engine, 1, state_after(of, engine, two_impact_state(of), 300));
    if (!orbit.stable()) continue;
    ++stable;
    sticking += orbit.sticking > 0;
    Scene scene = orbit.scene;
    const double period = *scene.until_time, end = 1e4 * period;
    scene.until_time = end;
    const Run run = std::visit(
        [&](auto options) {
          options.budget.max_impacts = 10'000'000;
          options.max_steps = 1'000'000'000;
          return simulate(scene, options, {.half_cycles = false, .history = {{end - 1, end, 2}}});
        },
        engine);
    REQUIRE(run.stop_reason == StopReason::time);
    const SceneState then = state_in(*run.history, run.history->time.size() - 1);
    // The force's phase is known to 2^-52 omega_f t, by which all else is late; 1/(1 - |multiplier|) periods
    // of such errors add up.
    const double rate =
        1 + std::fabs(scene.x0) + std::fabs(scene.damper().w0) + 10 * std::fabs(orbit.impacts[0].speed);
    CHECK(distance(then, release_of(orbit.scene)) <
          0x1p-52 * end * rate / (1 - orbit.multipliers[0].modulus()));
  }
  CHECK(stable >= 3);
  CHECK(sticking >= 1);
}

TEST_CASE("sticking takes two multipliers to 0, and Newton's iteration finds such an orbit as any other") {
  const Scene scene = forced_scene(0.1, 0.02, 0.95, 0.3);
  const SceneState near = state_after(scene, Restitution{}, two_impact_state(scene), 40);
  const Orbit orbit = *find_orbit(scene, Restitution{}, 1, near);
  REQUIRE(orbit.sticking > 0);
  CHECK(orbit.residual() < 1e-12);
  CHECK(orbit.multipliers[1].modulus() > 1e-3);
  CHECK(orbit.multipliers[2].modulus() < 1e-12);
  CHECK(orbit.multipliers[3].modulus() < 1e-12);
  // Followed, it sticks on, from a phase 0 in flight to one on a wall or the other way round.
  const Branch branch = follow(orbit, Parameter::force_amplitude, {.least = 0.25, .most = 0.5});
  CHECK(branch.orbits.size() > 5);
  for (const Orbit& at : branch.orbits) {
    const SceneState s = release_of(at.scene);
    CHECK(distance(state_after(at.scene, Restitution{}, s, 1), s) < 1e-8);
  }
}

TEST_CASE("beyond symmetry breaking there are two orbits, and beyond their flip one of twice the period") {
  Scene scene = forced_scene(0.02, 0.02, 0.9, 0.06);
  const Orbit symmetric = first_orbit(scene);
  CHECK(symmetric.symmetric);
  CHECK(!symmetric.stable());
  SceneState start = two_impact_state(scene);
  start.dampers[0].w += 1e-3;
  const Orbit one = *find_orbit(scene, Restitution{}, 1, state_after(scene, Restitution{}, start, 3000));
  CHECK(!one.symmetric);
  CHECK(!one.half_multipliers);
  CHECK(one.stable());
  CHECK(one.periods == 1);
  // Sought with two periods it is found as one of a single period.
  CHECK(find_orbit(scene, Restitution{}, 2, release_of(one.scene))->periods == 1);

  // Downwards it ends where it branched off: there the closed form loses its symmetry.
  const Branch down = follow(one, Parameter::force_amplitude,
                             {.least = 0.05, .most = 0.07, .upwards = false, .max_points = 200});
  const BranchEvent* joined = first_of(down, BranchEventKind::symmetry_breaking);
  REQUIRE(joined);
  CHECK(down.end == BranchEnd::joined);
  CHECK(down.orbits.back().scene.force_amplitude == joined->parameter);
  const Branch main = follow(first_orbit(forced_scene(0.02, 0.02, 0.9, 0.05)), Parameter::force_amplitude,
                             {.least = 0.04, .most = 0.07});
  const BranchEvent* left = first_of(main, BranchEventKind::symmetry_breaking);
  REQUIRE(left);
  CHECK(std::fabs(joined->parameter - left->parameter) < 1e-10);

  // The branch that is found there is that of simulation, or of its mirror image.
  const Orbit beside_it = *branching_off(*left, Parameter::force_amplitude);
  CHECK(!beside_it.symmetric);
  CHECK(beside_it.scene.force_amplitude > left->parameter);
  const Branch off = follow(beside_it, Parameter::force_amplitude, {.least = 0.04, .most = 0.06});
  REQUIRE(off.end == BranchEnd::range);
  const SceneState there = release_of(off.orbits.back().scene),
                   mirrored = PoincareMap(scene, Restitution{}, 1)(there)->state;
  CHECK(std::min(distance(there, release_of(one.scene)), distance(mirrored, release_of(one.scene))) < 1e-9);
  CHECK(branching_off(fold_at(scene), Parameter::force_amplitude).failure().end == OrbitEnd::no_convergence);

  const Branch up = follow(one, Parameter::force_amplitude, {.least = 0.05, .most = 0.2});
  const BranchEvent* flip = first_of(up, BranchEventKind::flip);
  REQUIRE(flip);
  double nearest = 1;
  for (const Multiplier& m : flip->orbit.multipliers) nearest = std::min(nearest, std::hypot(m.re + 1, m.im));
  CHECK(nearest < 1e-8);
  scene.force_amplitude = flip->parameter * (1 + 1e-3);
  SceneState beside = release_of(flip->orbit.scene);
  beside.dampers[0].w += 1e-3;
  const Orbit doubled = *find_orbit(scene, Restitution{}, 2, state_after(scene, Restitution{}, beside, 4000));
  CHECK(doubled.periods == 2);
  CHECK(doubled.stable());

  // From the flip to there, and back from there to the flip.
  const Orbit first = *branching_off(*flip, Parameter::force_amplitude);
  CHECK(first.periods == 2);
  const Branch off_flip = follow(first, Parameter::force_amplitude,
                                 {.least = 0.05, .most = scene.force_amplitude, .first_step = 1e-3});
  REQUIRE(off_flip.end == BranchEnd::range);
  const SceneState last = release_of(off_flip.orbits.back().scene),
                   later = state_after(scene, Restitution{}, last, 1);
  CHECK(std::min(distance(last, release_of(doubled.scene)), distance(later, release_of(doubled.scene))) <
        1e-9);
  const Branch back =
      follow(doubled, Parameter::force_amplitude, {.least = 0.05, .most = 0.2, .upwards = false});
  CHECK(back.end == BranchEnd::joined);
  CHECK(back.events.back().kind == BranchEventKind::flip);
  CHECK(std::fabs(back.events.back().parameter - flip->parameter) < 1e-10);
}

TEST_CASE("steps of the parameter are as short as asked for, and events say between which orbits they are") {
  const Scene scene = forced_scene(0.02, 0.02, 0.9, 0.04);
  const Orbit first = first_orbit(scene);
  const Branch branch = follow(first, Parameter::force_amplitude,
                               {.least = 0.03, .most = 0.07, .largest_step = 1, .largest_change = 3e-4});
  REQUIRE(branch.end == BranchEnd::range);
  CHECK(branch.orbits.size() > 100);
  for (std::size_t i = 1; i < branch.orbits.size(); ++i)
    CHECK(branch.orbits[i].scene.force_amplitude - branch.orbits[i - 1].scene.force_amplitude < 3.3e-4);
  const BranchEvent* event = first_of(branch, BranchEventKind::symmetry_breaking);
  REQUIRE(event);
  const auto at = static_cast<std::size_t>(event->orbits_before);
  CHECK(branch.orbits[at - 1].scene.force_amplitude < event->parameter);
  CHECK(event->parameter < branch.orbits[at].scene.force_amplitude);
  // An event in the last step before the end of the range is not missed.
  const Branch shorter =
      follow(first, Parameter::force_amplitude, {.least = 0.03, .most = event->parameter + 1e-7});
  REQUIRE(shorter.end == BranchEnd::range);
  CHECK(first_of(shorter, BranchEventKind::symmetry_breaking) != nullptr);
  const Branch shortest =
      follow(first, Parameter::force_amplitude, {.least = 0.03, .most = event->parameter - 1e-7});
  CHECK(shortest.events.empty());
}

TEST_CASE("a branch ends where it is more unstable than asked for, unless grazing is the cause") {
  const Scene scene = forced_scene(0.02, 0.02, 0.9, 0.05);
  const Branch branch = follow(first_orbit(scene), Parameter::force_amplitude,
                               {.least = 0.05, .most = 0.2, .max_multiplier = 5});
  REQUIRE(branch.end == BranchEnd::unstable);
  const std::size_t last = branch.orbits.size() - 1;
  const auto instability = [&](std::size_t i) {
    return branch.orbits[i].multipliers[0].modulus() *
           std::pow(std::min(1.0, *branch.orbits[i].slowest_impact), 2);
  };
  CHECK(instability(last) > 5);
  CHECK(instability(last - 1) <= 5);

  const Scene grazing = forced_scene(0.5, 0.1, 1.4, 0.309605);
  CHECK(follow(first_orbit(grazing), Parameter::force_frequency,
               {.least = 0.3, .most = 2.5, .upwards = false, .max_multiplier = 100})
            .end == BranchEnd::grazing);
}

TEST_CASE("what cannot be followed or found says so") {
  const Scene scene = forced_scene(0.02, 0.05, 0.9, 0.1);
  const auto none = find_orbit(scene, Restitution{}, 1, {0, 0, 0.5, 0}, {.max_iterations = 1});
  CHECK(!none);
  CHECK(none.failure().end == OrbitEnd::no_convergence);
  CHECK_THROWS_AS(static_cast<void>(none->periods), std::bad_variant_access);
  const Orbit orbit = *find_orbit(scene, Restitution{}, 1, {0, 0, 0.5, 0}, {.symmetric = true});
  CHECK(follow(orbit, Parameter::force_amplitude, {.least = 0.2, .most = 1}).end == BranchEnd::not_an_orbit);
  CHECK(find_orbit(scene, Restitution{.budget = {.max_impacts = 0}}, 1, {3, 0, 0.5, 0}).failure().end ==
        OrbitEnd::run_stopped);
  CHECK_THROWS_AS(find_orbit(scene, Restitution{}, 0, {}), InvalidArguments);
  CHECK_THROWS_AS(find_orbit(scene, Restitution{}, 2, {}, {.symmetric = true}), InvalidArguments);
  CHECK_THROWS_AS(find_orbit(scene, Restitution{}, 1, {}, {.tolerance = 0}), InvalidArguments);
  for (const FollowOptions& options : {FollowOptions{.least = 0, .most = 1},
                                       {.least = 0.1, .most = 1, .largest_change = 0},
                                       {.least = 0.1, .most = 1, .max_multiplier = 0},
                                       {.least = 0.1, .most = std::nan("")}})
    CHECK_THROWS_AS(follow(orbit, Parameter::force_amplitude, options), InvalidArguments);
}
