// Random scenes over all that a scene allows in earnest, by their seed: equal seeds give equal scenes
// everywhere, but for the last bits of the C library's exp and log.
#pragma once

#include <cstdint>
#include <sstream>
#include <string>

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

// As it stands in a scene file.
inline std::string text_of(const impact_damper::Scene& scene) {
  std::ostringstream text;
  text.precision(17);
  for (const impact_damper::SceneField& field : impact_damper::scene_fields)
    text << '"' << field.name << "\": " << field.number.in(scene) << ", ";
  text << "\"until_time\": " << scene.until_time.value_or(0);
  return text.str();
}

}  // namespace random_scenes
