// Scenes that tests share: random ones over all that a scene allows in earnest, round ones, where things
// coincide, both by their seed; and a scene as it is seen from the other side. Equal seeds give equal scenes
// everywhere, but for the last bits of the C library's exp and log.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <numbers>

#include "impact_damper/scene.hpp"
#include "reference.hpp"

namespace random_scenes {

// e 0 to 1 (its ends often), nu 1e-8 to 1e3, zeta 0 to 10, k 1 to 1e12, x0, v0 and w0 up to 1e8, y0 anywhere
// in the cavity, on its walls and up to 1 inside them; forced in 2 of 5, and then in 2 of 5 at resonance.
inline impact_damper::Scene scene_of(std::uint64_t seed) {
  reference::Random random(seed);
  impact_damper::Scene scene;
  scene.damper().mass_ratio = random.log_uniform(1e-8, 1e3);
  scene.damper().restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 1);
  scene.damping_ratio = random.chance(0.3) ? 0 : random.log_uniform(1e-4, 10);
  scene.damper().wall_stiffness = random.log_uniform(1, 1e12);
  const auto motion = [&] { return random.chance(0.3) ? 0 : random.log_uniform(1e-8, 1e8) * random.sign(); };
  scene.x0 = random.chance(0.5) ? random.uniform(-10, 10) : motion();
  scene.v0 = random.chance(0.7) ? 0 : motion();
  scene.damper().y0 = random.chance(0.5) ? double(random.chance(0.5)) : random.uniform(0, 1);
  scene.damper().w0 = random.chance(0.6) ? 0 : motion();
  if (random.chance(0.4)) {
    scene.force_amplitude = random.log_uniform(1e-3, 100);
    scene.force_frequency = random.chance(0.4) ? 1 : random.log_uniform(0.05, 20);
  }
  if (random.chance(0.15))
    scene.damper().y0 = random.chance(0.5) ? -random.log_uniform(1e-9, 1) : 1 + random.log_uniform(1e-9, 1);
  scene.until_time = random.uniform(1, 50);
  return scene;
}

}  // namespace random_scenes

// Round numbers: events coincide, roots are equal and series have zero terms, which random numbers never
// meet.
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

// The scene as it is seen from the other side.
inline impact_damper::Scene mirrored(impact_damper::Scene scene) {
  using impact_damper::Scene;
  for (double Scene::*const each : {&Scene::x0, &Scene::v0, &Scene::force_amplitude})
    scene.*each = -(scene.*each);
  for (impact_damper::SceneDamper& its : scene.dampers) its.y0 = its.clearance - its.y0, its.w0 = -its.w0;
  return scene;
}
