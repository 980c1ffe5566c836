// Scenes of round numbers, by their seed: where events coincide, roots are equal and series have zero terms,
// which random numbers never meet.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <numbers>

#include "impact_damper/scene.hpp"
#include "reference.hpp"

namespace round_scenes {

// y0 in the cavity, on its walls, or 0.25 inside them; 1 - y0 is exact. Forced in 2 of 5.
inline impact_damper::Scene scene_of(std::uint64_t seed) {
  reference::Random random(seed);
  const auto one_of = [&](std::initializer_list<double> values) {
    return values.begin()[random.bits() % values.size()];
  };
  impact_damper::Scene scene;
  const double nu = scene.damper().mass_ratio = one_of({0.02, 0.1, 0.5, 1, 2, 4});
  scene.damper().restitution = one_of({0, 0, 0.5, 0.6, 1, 1, std::exp(-std::numbers::pi * std::sqrt(nu))});
  scene.damping_ratio =
      one_of({0, 0, 0, 0.5, std::sqrt(0.5), std::sqrt(3) / 2, 1, std::sqrt(1 + nu), std::sqrt(nu), 2});
  scene.damper().wall_stiffness = one_of({nu, 1, nu / ((1 + nu) * (1 + nu)), 100, 1e4});
  scene.x0 = one_of({0, 0.25, 0.5, 1, 2, 6}) * random.sign();
  scene.v0 = one_of({0, 0, 1}) * random.sign();
  scene.damper().y0 = one_of({0, 0, 0.5, 1, 0.25, -0.25, 1.25});
  if (random.chance(0.3) && std::fabs(scene.x0) <= 1)
    scene.damper().y0 = scene.x0 < 0 ? -scene.x0 : 1 - scene.x0;  // met where x comes to zero
  scene.damper().w0 = one_of({0, 0, 1}) * random.sign();
  if (random.chance(0.4)) {
    scene.force_amplitude = one_of({0.25, 1, 4}) * random.sign();
    scene.force_frequency = one_of({1, 0.5, 2, std::sqrt(1 / (1 + nu)), std::sqrt(nu)});
  }
  scene.until_time = one_of({3, 10, 20, 4 * std::numbers::pi});
  return scene;
}

}  // namespace round_scenes
