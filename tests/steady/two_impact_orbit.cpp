#include "impact_damper/orbits/two_impact_orbit.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/orbits/poincare_map.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "steady_helpers.hpp"

using namespace impact_damper;

namespace {

Scene random_scene(std::uint64_t seed) {
  reference::Random random(seed);
  Scene scene;
  scene.damper().mass_ratio = random.log_uniform(1e-4, 2);
  scene.damper().restitution = random.uniform(0, 1);
  scene.damping_ratio = random.chance(0.3) ? 0 : random.log_uniform(1e-3, 1.5);
  scene.force_amplitude = random.log_uniform(0.02, 2) * random.sign();
  scene.force_frequency = random.uniform(0.4, 1.8);
  return scene;
}

}  // namespace

TEST_CASE("the restitution engine repeats the motion after half a period, mirrored") {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const Scene scene = random_scene(seed);
    for (const TwoImpactOrbit& orbit : two_impact_orbits(scene)) {
      if (!(orbit.state.y > 1e-3 && orbit.state.y < 1 - 1e-3)) continue;
      const PoincareImage image = *PoincareMap(scene, Restitution{}, 1)(orbit.state);
      if (image.impacts.size() != 1) continue;  // a wall was in the way
      ++compared;
      // The closed form is a difference of the linear response and a transient, each as large as that.
      const double scale = 1 + linear_amplitude(scene), sensitivity = 1 + 1 / orbit.impact_speed;
      CHECK(std::fabs(image.state.x - orbit.state.x) < 1e-12 * scale * sensitivity);
      CHECK(std::fabs(image.state.v - orbit.state.v) < 1e-12 * scale * sensitivity);
      CHECK(std::fabs(image.state.dampers[0].y - orbit.state.y) < 1e-12 * scale * sensitivity);
      CHECK(std::fabs(image.state.dampers[0].w - orbit.state.w) < 1e-12 * scale * sensitivity);
      CHECK(image.impacts[0].speed == doctest::Approx(orbit.impact_speed).epsilon(1e-11));
      // The left wall is left at `phase`, the right one half a period before or after.
      const double left = image.impacts[0].wall == Wall::left
                              ? image.impacts[0].time
                              : image.impacts[0].time + std::numbers::pi / scene.force_frequency;
      CHECK(left * scene.force_frequency == doctest::Approx(orbit.phase).epsilon(1e-10));
      // By the engine and the saltation matrix; the closed form knows neither.
      const Multipliers found = multipliers_of(image.by_state);
      for (std::size_t i = 0; i < 4; ++i) {
        const double gap = std::hypot(found[i].re - orbit.half_multipliers[i].re,
                                      found[i].im - orbit.half_multipliers[i].im);
        // Two that nearly coincide are known to half of the digits.
        CHECK(gap < 1e-6 * found[0].modulus());
      }
      double sum = 0;
      for (std::size_t i = 0; i < 4; ++i) sum += found[i].re - orbit.half_multipliers[i].re;
      CHECK(std::fabs(sum) < 1e-12 * scale * (1 + found[0].modulus()) * sensitivity);
    }
  }
  CHECK(compared >= 80);
}

TEST_CASE("a light secondary mass at resonance impacts as in the theory without a force") {
  for (const double e : {0.3, 0.6, 0.9}) {
    for (const double amplitude : {0.2, 0.35, 0.5}) {
      Scene scene = forced_scene(1e-9, 0.02, 1, amplitude * 2 * 0.02);
      scene.damper().restitution = e;
      const auto expected = single_impact(e, amplitude);
      const auto found = two_impact_orbits(scene);
      REQUIRE(expected.has_value() == !found.empty());
      if (!expected) continue;
      CHECK(found[0].speed == doctest::Approx(expected->speed).epsilon(1e-5));
      CHECK(least_linear_amplitude(scene) == doctest::Approx(fold_amplitude(e)).epsilon(1e-5));
    }
  }
}

TEST_CASE("against a heavy secondary mass the box is stopped at 1/2 on either side") {
  const Scene scene = forced_scene(1e6, 0.05, 1.5, 1);
  const auto all = two_impact_orbits(scene);
  REQUIRE(!all.empty());
  Scene from = released_from(scene, all[0].state);
  from.until_time = 20;
  const Run run = simulate(from, Restitution{}, {.half_cycles = false, .impacts = true});
  REQUIRE(run.impacts->time.size() >= 4);
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(std::fabs(run.impacts->displacement[i]) == doctest::Approx(0.5).epsilon(1e-5));
}

TEST_CASE("both orbits begin where the linear amplitude reaches its least") {
  int begun = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Scene scene = random_scene(seed);
    scene.force_amplitude *= least_linear_amplitude(scene) / linear_amplitude(scene) * (1 - 1e-9);
    CHECK(two_impact_orbits(scene).empty());
    scene.force_amplitude *= 1 + 2e-9;
    const auto all = two_impact_orbits(scene);
    if (all.empty()) continue;  // the secondary mass would have to fly backwards
    REQUIRE(all.size() == 2);
    CHECK(all[0].speed == doctest::Approx(all[1].speed).epsilon(1e-3));
    ++begun;
  }
  CHECK(begun >= 40);
}

TEST_CASE("scenes without such orbits are rejected") {
  Scene scene;
  CHECK_THROWS_AS(two_impact_orbits(scene), InvalidArguments);
  scene.force_amplitude = 1;
  CHECK_THROWS_AS(two_impact_orbits(scene), InvalidArguments);  // undamped at resonance
  scene.damping_ratio = 0.01;
  CHECK_NOTHROW(two_impact_orbits(scene));
}
