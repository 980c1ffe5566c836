// What tests of steady states share: the scene that most of them vary, its orbits of two impacts in closed
// form, and by how much volumes of states shrink.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "impact_damper/motion/wall.hpp"
#include "impact_damper/orbits/branches.hpp"
#include "impact_damper/orbits/two_impact_orbit.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

inline const std::array<Engine, 2> rigid_and_compliant{Restitution{}, Exact{}};

constexpr auto no_progress = [](std::int64_t) {};

// Released at rest from 1, which makes the mass strike at once.
inline Scene active_scene(double frequency) {
  return {.damping_ratio = 0.01,
          .x0 = 1,
          .force_amplitude = 0.05,
          .force_frequency = frequency,
          .dampers = {{.mass_ratio = 0.1, .y0 = 0.5}}};
}

// mass_ratio, damping_ratio, force_frequency, force_amplitude.
inline Scene forced_scene(double nu, double zeta, double frequency, double amplitude) {
  return {.damping_ratio = zeta,
          .force_amplitude = amplitude,
          .force_frequency = frequency,
          .dampers = {{.mass_ratio = nu}}};
}

// What the force moves the primary mass by where it is alone.
inline double linear_amplitude(const Scene& scene) {
  const double w = scene.force_frequency;
  return std::fabs(scene.force_amplitude) / std::hypot(1 - w * w, 2 * scene.damping_ratio * w);
}

// The state at phase 0 of the first of the scene's orbits of two impacts; the orbit that is found from there.
inline SceneState two_impact_state(const Scene& scene) { return two_impact_orbits(scene).at(0).state; }
inline Orbit first_orbit(const Scene& scene) {
  return *find_orbit(scene, Restitution{}, 1, two_impact_state(scene));
}
// How far the orbit is from the nearest of those of its scene in closed form.
inline double off_closed_form(const Orbit& orbit) {
  double nearest = 1;
  for (const TwoImpactOrbit& expected : two_impact_orbits(orbit.scene))
    nearest = std::min(nearest, distance(release_of(orbit.scene), expected.state));
  return nearest;
}
// Where a plain simulation is after many periods, each begun at phase 0.
inline SceneState state_after(const Scene& scene, const Engine& engine, SceneState s, int periods) {
  const PoincareMap map(scene, engine, 2);
  for (int i = 0; i < periods; ++i) s = map(s)->state;
  return s;
}

inline const BranchEvent* first_of(const Branch& branch, BranchEventKind kind) {
  const auto at = std::ranges::find(branch.events, kind, &BranchEvent::kind);
  return at == branch.events.end() ? nullptr : &*at;
}

// Minus the logarithm of what is left of a volume of states after a run that lasts so long: by the
// divergence, and by the impacts. Not where masses stick.
inline double shrinkage(const Scene& scene, const Engine& engine, const Run& run, double duration) {
  const SceneDamper& damper = scene.damper();
  double loss = 2 * scene.damping_ratio * duration;
  if (has_rigid_walls(engine))
    return loss - 2 * double(run.impacts->time.size()) * std::log(damper.restitution);
  const double nu = damper.mass_ratio, damping = 2 * std::sqrt(damper.wall_stiffness / nu) *
                                                 zeta_m<double>(damper, Calibration::fixed_wall);
  for (std::size_t n = 0; n < run.contacts->begin.size(); ++n)
    loss += (1 + nu) * damping * (run.contacts->end[n] - run.contacts->begin[n]);
  return loss;
}

}  // namespace impact_damper
