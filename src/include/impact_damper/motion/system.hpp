// A scene in the engine's scalar type, with its oscillators.
#pragma once

#include <limits>

#include "impact_damper/motion/driven_series.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

// An oscillator under a force of one frequency, with the table of its series; without a force there is none.
template <class Real, class Force>
struct Driven : Oscillator<Real> {
  Driven(const Real& a, const Real& b, const Force& forcing)
      : Oscillator<Real>(a, b), series(*this, forcing.frequency) {}
  DrivenSeriesTable<Real> series;
};
template <class Real>
struct Driven<Real, NoForcing<Real>> : Oscillator<Real> {
  Driven(const Real& a, const Real& b, const NoForcing<Real>&) : Oscillator<Real>(a, b) {}
};

// The scene's numbers, and those of one of its dampers, in the engine's scalar type.
template <class Real, ForceOf<Real> Force = Forcing<Real>>
struct System {
  explicit System(const Scene& scene) : System(scene, scene.damper()) {}
  System(const Scene& scene, const SceneDamper& damper)
      : nu(damper.mass_ratio),
        e(damper.restitution),
        zeta(scene.damping_ratio),
        k(damper.wall_stiffness),
        forcing{Real(scene.force_amplitude), Real(scene.force_frequency)},
        free(zeta, Real(1), forcing),
        // NOLINTNEXTLINE(clang-analyzer-optin.cplusplus.UninitializedObject): it takes a rate for unknown
        stuck(zeta / (1 + nu), 1 / (1 + nu), forcing) {}

  Real nu, e, zeta, k;
  Force forcing;
  Driven<Real, Force> free;   // (M2.1), the paper's (3)
  Driven<Real, Force> stuck;  // (M2.3), the paper's (9) with the factor 1/(1+nu) that its force lacks
};

// Calls `then` with the scene's numbers, in a type that has a force or none.
template <class Real, class Then>
auto with_system(const Scene& scene, Then&& then) {
  return scene.force_amplitude == 0 ? then(System<Real, NoForcing<Real>>(scene)) : then(System<Real>(scene));
}

// The time for which bounds on derivatives are made: without a force they hold for ever, under one they grow
// with it.
template <class Real, class Force>
Real bounded_span(const System<Real, Force>& system) {
  return system.forcing ? Real(2) : std::numeric_limits<Real>::infinity();
}

}  // namespace impact_damper
