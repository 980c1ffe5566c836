// A scene: the system that is simulated, its initial condition, and when the run stops.
//
// A primary mass on a spring (and, if zeta > 0, a viscous damper) carries a cavity in which a secondary mass
// travels freely between two walls; or several such cavities, each with a secondary mass of its own.
// Everything is dimensionless: lengths are divided by the free travel (clearance) epsilon = D - d, with
// several dampers by one reference length for all, times by 1/Omega_n = sqrt(M/K), velocities by epsilon
// Omega_n, forces by K epsilon. Small letters and capitals are the paper's: m secondary, M primary mass; K
// spring, C damper of the primary mass, C_c its critical damping; K_M stiffness of a wall.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/base/errors.hpp"

namespace impact_damper {

// One of several impact dampers on the same primary mass.
struct SceneDamper {
  double mass_ratio = 0.02;     // nu = m/M, 1e-9 to 1e6
  double restitution = 0.6;     // e, 0 (plastic) to 1 (lossless)
  double clearance = 1.0;       // free travel, divided by the scene's epsilon, 1e-6 to 1e6
  double wall_stiffness = 1e4;  // k = K_M/K, 1e-6 to 1e15; the restitution engine's walls are rigid
  double y0 =
      0.0;  // initial distance from the left wall, divided by epsilon; the right wall is at `clearance`
  double w0 = 0.0;  // initial velocity y' relative to the cavity, divided by epsilon Omega_n

  bool operator==(const SceneDamper&) const = default;
};
inline constexpr std::size_t most_dampers = 1000;
// Least magnitude, except 0, of a number that may be negative: a smaller one would do no more than the
// rounding errors of the others, and its square may underflow.
inline constexpr double least_magnitude = 1e-30;
constexpr bool is_too_small(double value) {
  return value != 0 && value < least_magnitude && value > -least_magnitude;
}

struct Scene {
  double mass_ratio = 0.02;     // nu = m/M, 1e-9 to 1e6
  double restitution = 0.6;     // e, 0 (plastic) to 1 (lossless)
  double damping_ratio = 0.0;   // zeta = C/C_c of the primary mass, 0 to 1e6; above 1 overdamped
  double wall_stiffness = 1e4;  // k = K_M/K, 1e-6 to 1e15; the restitution engine's walls are rigid
  double x0 = 6.0;              // initial displacement of the primary mass, divided by epsilon
  double v0 = 0.0;              // its initial velocity x', divided by epsilon Omega_n
  // Initial distance of the secondary mass from the left wall, divided by epsilon: 0 at the left, 1 at the
  // right wall. Outside them it begins by pressing a wall together, which needs compliant walls.
  double y0 = 0.0;
  double w0 = 0.0;               // its initial velocity y' relative to the cavity, divided by epsilon Omega_n
  double force_amplitude = 0.0;  // f0 = F0/(K epsilon) of the force f0 sin(omega_f t) on M, 0 = unforced
  double force_frequency = 1.0;  // omega_f = Omega_f/Omega_n, 1e-12 to 1e6
  // When to stop, at whichever comes first; one of the two must be given. Both > 0 and <= 1e12. (The
  // magnitudes of x0, v0, y0, w0 and force_amplitude are 0, or least_magnitude to 1e12.)
  std::optional<double> until_time;       // stop at this time
  std::optional<double> until_amplitude;  // stop at the end of the first half cycle of a lower amplitude
  // Several dampers in place of the one above. A run then does not use the numbers of that one (mass_ratio,
  // restitution, wall_stiffness, y0, w0), but they must be in their ranges, and == compares them: leave them
  // at their defaults. The order of the dampers changes no number of a run. At most most_dampers; empty: the
  // one above.
  std::vector<SceneDamper> dampers;

  bool operator==(const Scene&) const = default;
};

// One number of a scene: its name (as JSON key; as option of the command line, with '-' for '_'), where it
// is kept, and which values it allows. Readers, writers and checks all go through this table; only
// until_time and until_amplitude are not in it.
struct SceneField {
  std::string_view name;
  double Scene::*member;
  double least, most;  // smallest and largest allowed value
  std::string_view meaning;
};
extern const std::array<SceneField, 10> scene_fields;

// One number of a damper of a list, in the same way.
struct SceneDamperField {
  std::string_view name;
  double SceneDamper::*member;
  double least, most;
  std::string_view meaning;
};
extern const std::array<SceneDamperField, 6> scene_damper_fields;

// One number of a scene: its own or, if of_damper is not null, that of one of several dampers.
struct SceneNumber {
  double Scene::*own = nullptr;
  double SceneDamper::*of_damper = nullptr;
  std::size_t damper = 0;  // which, from 0

  SceneNumber() = default;
  // NOLINTNEXTLINE(google-explicit-constructor)
  SceneNumber(double Scene::*its) : own(its) {}  // cppcheck-suppress noExplicitConstructor
  SceneNumber(double SceneDamper::*its, std::size_t which) : of_damper(its), damper(which) {}
  // The name of its field; for a list with the damper's number behind it, from 1: clearance_2.
  std::string name() const;
  // cppcheck-suppress constParameter
  double& in(Scene& scene) const { return of_damper ? scene.dampers[damper].*of_damper : scene.*own; }
  double in(const Scene& scene) const { return of_damper ? scene.dampers[damper].*of_damper : scene.*own; }
  bool is(const double Scene::*number) const { return !of_damper && own == number; }
  bool operator==(const SceneNumber&) const = default;
};
struct NamedSceneNumber {
  std::string name;
  SceneNumber number;
  double least, most;  // smallest and largest allowed value
};
// All numbers of a scene in the order of the two tables; with a list, those of each damper in place of those
// of the one damper.
std::vector<NamedSceneNumber> numbers_of(const Scene& scene);

// Whether the scene's field belongs to its one damper, so that each damper of a list has its own.
bool is_of_one_damper(const SceneField& field);
// The name of a damper's field in a Problem: "dampers[2].clearance", counted from 0.
std::string damper_field(std::size_t damper, std::string_view name);

// All secondary masses together, divided by the primary one.
double secondary_mass(const Scene& scene);
// The scene's primary mass and force with one of its list of dampers alone. Only masses, damping, stiffness,
// restitution and force, which a wall's equations need, are set: clearance, initial condition and stops are
// Scene's defaults, so it must not be simulated as it is.
Scene with_alone(const Scene& scene, const SceneDamper& damper);

// Whether the caller can treat a scene with a list of dampers.
enum class DamperList { rejected, allowed };

// The problems of a scene: one entry per invalid field ("mass_ratio", "must be ..., got ..."). A NaN is
// always invalid. With DamperList::rejected a list of dampers is a problem itself. Empty means that the exact
// engine may run the scene. simulate() checks what the others require besides: the restitution engine 0 <= y0
// <= clearance, the component element method a time step within its stability limit.
std::vector<Problem> problems_of(const Scene& scene, DamperList dampers = DamperList::rejected);

}  // namespace impact_damper
