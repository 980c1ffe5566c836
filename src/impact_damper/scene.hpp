// A scene: the one system that is simulated, and when to stop looking at it.
//
// A primary mass on a spring (and, if zeta > 0, a viscous damper) carries a cavity in which a
// secondary mass travels freely between two walls. Everything is dimensionless: lengths by the
// free travel epsilon = D - d, times by 1/Omega_n = sqrt(M/K), forces by K epsilon.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "impact_damper/base/errors.hpp"

namespace impact_damper {

struct Scene {
  double mass_ratio = 0.02;     // nu = m/M, >= 1e-9
  double restitution = 0.6;     // e, 0 (plastic) to 1 (lossless)
  double damping_ratio = 0.0;   // zeta = C/C_c of the primary mass, >= 0, overdamped too
  double wall_stiffness = 1e4;  // k = K_M/K, >= 1e-6; the restitution engine's walls are rigid
  double x0 = 6.0;              // initial displacement of the primary mass, divided by epsilon
  double v0 = 0.0;              // its initial velocity x', divided by epsilon Omega_n
  double y0 = 0.0;  // initial displacement of the secondary mass from the left wall, divided by epsilon
  double w0 = 0.0;  // its initial velocity y' relative to the cavity, divided by epsilon Omega_n
  double force_amplitude = 0.0;           // f0 = F0/(K epsilon), 0 = unforced
  double force_frequency = 1.0;           // omega_f = Omega_f/Omega_n, >= 1e-12
  std::optional<double> until_time;       // stop at this time, > 0
  std::optional<double> until_amplitude;  // stop at the end of the first half cycle below it, > 0

  bool operator==(const Scene&) const = default;
};

// One number of a scene: its name at every border (JSON key; option name with '-' for '_'), where it
// is kept, and which values it allows. Readers, writers and checks all go through this table,
// but for the two stops.
struct SceneField {
  std::string_view name;
  double Scene::*member;
  double least, most;  // both allowed
  std::string_view meaning;
};
extern const std::array<SceneField, 10> scene_fields;

// What is wrong with a scene: one entry per offending field ("mass_ratio", "must be ..., got ...").
// Empty means that any engine may run it. Written so that a NaN is always an offence.
std::vector<Problem> problems_of(const Scene& scene);

}  // namespace impact_damper
