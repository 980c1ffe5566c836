// The scene that most tests of steady states vary.
#pragma once

#include "impact_damper/scene.hpp"

namespace impact_damper {

// mass_ratio, damping_ratio, force_frequency, force_amplitude.
inline Scene forced_scene(double nu, double zeta, double frequency, double amplitude) {
  Scene scene;
  scene.damper().mass_ratio = nu;
  scene.damping_ratio = zeta;
  scene.force_frequency = frequency;
  scene.force_amplitude = amplitude;
  return scene;
}

}  // namespace impact_damper
