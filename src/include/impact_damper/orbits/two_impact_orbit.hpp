// Masri and Caughey's orbit with two symmetric impacts in each period of the force, rigid walls, in closed
// form for any mass ratio and damping (docs/mathematics.md, 13.8). It uses neither an engine nor a saltation
// matrix, so that orbits found with these can be compared with it.
#pragma once

#include <vector>

#include "impact_damper/motion/state.hpp"
#include "impact_damper/orbits/poincare_map.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

struct TwoImpactOrbit {
  double speed = 0;                // V > 0: the absolute velocity between the walls, the same on both ways
  double phase = 0;                // of the force, in [0, 2 pi), when the mass leaves the left wall
  double impact_speed = 0;         // |y'| just before each impact
  State<double> state{};           // at phase 0 of the force
  Multipliers half_multipliers{};  // of half a period and the mirror; their squares are those of a period
};

// The amplitude of the linear response, |f0|/|H(omega_f)|, at which these orbits begin, a fold (M13.19); if a
// is not positive there, they begin elsewhere, or not at all. Throws as two_impact_orbits does.
double least_linear_amplitude(const Scene& scene);

// All orbits that satisfy the conditions at the impacts (M13.18), the faster first: none, one or two. Whether
// the secondary mass stays between the walls meanwhile is for the caller to check. The scene's initial
// condition, end and wall stiffness are not used. Throws InvalidArguments for a scene that is not valid,
// without a force, or undamped at resonance.
std::vector<TwoImpactOrbit> two_impact_orbits(const Scene& scene);

}  // namespace impact_damper
