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

// A table of two numbers in each row, the first ascending; linear between.
using Pairs = std::vector<std::array<double, 2>>;
inline constexpr std::size_t most_pairs = 1000;
// The least restitution of a wall that is not linear: its chi grows beyond bounds towards 0.
inline constexpr double least_restitution_of_law = 1e-3;

// Laws of force other than k q (docs/mathematics.md, 18.6). A table is of lengths and forces, divided by
// epsilon and K epsilon; it rises, holds the pair 0, 0, and goes on beyond its ends as in its last piece. One
// that begins with 0, 0 is of both directions.
enum class WallForm { linear, power, table };
// P(q), the force of a wall over its overlap, which 1 + chi w multiplies while the overlap grows with the
// speed w. For the linear law it is k q + c w instead.
struct WallLaw {
  WallForm law = WallForm::linear;
  double exponent = 1;          // of a power: k q^p, k being the damper's wall_stiffness; 1 to 10
  Pairs pairs{};                // of a table, which begins with 0, 0; wall_stiffness then has no effect
  std::optional<double> speed;  // at which chi is calibrated, 1e-6 to 1e6; absent: 1

  bool operator==(const WallLaw&) const = default;
};
enum class SpringForm { cubic, table };
// Of the primary mass: x + cubic x^3, or a table in place of both.
struct SpringLaw {
  SpringForm law = SpringForm::cubic;
  double cubic = 0;  // c_3, 0 to 1e12
  Pairs pairs{};

  bool is_linear() const { return law == SpringForm::cubic && cubic == 0; }
  bool operator==(const SpringLaw&) const = default;
};

// An impact damper on the primary mass: a cavity with a secondary mass.
struct SceneDamper {
  double mass_ratio = 0.02;     // nu = m/M, 1e-9 to 1e6
  double restitution = 0.6;     // e, 0 (plastic) to 1 (lossless)
  double clearance = 1.0;       // free travel, divided by the scene's epsilon, 1e-6 to 1e6
  double wall_stiffness = 1e4;  // k = K_M/K, 1e-6 to 1e15; the restitution engine's walls are rigid
  // Initial distance of the secondary mass from the left wall, divided by epsilon: 0 at the left wall,
  // `clearance` at the right one. A mass with y0 < 0 or y0 > clearance begins pressed into a wall, which the
  // restitution engine, whose walls are rigid, rejects.
  double y0 = 0.0;
  double w0 = 0.0;  // its initial velocity y' relative to the cavity, divided by epsilon Omega_n
  // Forces between the secondary mass and its cavity, divided by m epsilon Omega_n^2, 0 to 1e12 (chapter 18
  // of docs/mathematics.md).
  double friction = 0.0;         // phi, Coulomb friction where it slides
  double static_friction = 0.0;  // phi_s, the most that holds it where it does not; 0: phi, else at least phi
  double drag = 0.0;  // d, of the force d y', linear in the relative velocity; divided by m Omega_n
  WallLaw wall{};
  // Impact speed and restitution, constant beyond the ends; empty: `restitution` at every speed.
  Pairs restitution_by_speed{};

  // phi_s, with its default filled in.
  double holding() const { return static_friction > 0 ? static_friction : friction; }

  bool operator==(const SceneDamper&) const = default;
};
inline constexpr std::size_t most_dampers = 1000;
// x0, v0, y0, w0 and force_amplitude are 0 or have at least this magnitude: a smaller one would do no more
// than the rounding errors of the others, and its square may underflow.
inline constexpr double least_magnitude = 1e-30;
constexpr bool is_too_small(double value) {
  return value != 0 && value < least_magnitude && value > -least_magnitude;
}

struct Scene {
  double damping_ratio = 0.0;    // zeta = C/C_c of the primary mass, 0 to 1e6; above 1 overdamped
  double x0 = 6.0;               // initial displacement of the primary mass, divided by epsilon
  double v0 = 0.0;               // its initial velocity x', divided by epsilon Omega_n
  double force_amplitude = 0.0;  // f0 = F0/(K epsilon) of the force f0 sin(omega_f t) on M, 0 = unforced
  double force_frequency = 1.0;  // omega_f = Omega_f/Omega_n, 1e-12 to 1e6
  // gamma, the part of gravity along the cavities, towards the left walls, divided by epsilon Omega_n^2, 0 to
  // 1e12. It acts on the secondary masses; x is counted from where the primary mass rests without them.
  double weight = 0.0;
  // When to stop, at whichever comes first; at least one must be given. Both > 0 and <= 1e12.
  std::optional<double> until_time;       // stop at this time
  std::optional<double> until_amplitude;  // stop at the end of the first half cycle of a lower amplitude
  // 1 to most_dampers. Another order numbers the dampers of a run anew, and changes no computed number.
  std::vector<SceneDamper> dampers = std::vector<SceneDamper>(1);
  SpringLaw spring{};

  // The first damper, which in a scene of one is the only one.
  SceneDamper& damper() { return dampers.front(); }
  const SceneDamper& damper() const { return dampers.front(); }

  bool operator==(const Scene&) const = default;
};

// Whether the scene has exactly one damper, and its clearance is 1, as in the paper. The numbers of that
// damper then stand among the scene's own in files and options, and the engines for one damper run it. One
// damper of another clearance counts as a list of one.
bool has_one_damper(const Scene& scene);
// The length of the list of dampers in files of the scene: 0 if has_one_damper(scene), else dampers.size().
std::size_t listed_dampers(const Scene& scene);
// The problem to report where has_one_damper() is required and false.
Problem problem_of_several();

// Whether the scene has a component that the paper's model lacks: friction, drag or weight.
bool has_components(const Scene& scene);
// Whether a wall or the primary spring has a law other than the linear one, or a restitution depends on the
// speed.
bool has_laws(const Scene& scene);
// Neither: the scene is of the paper's model.
bool is_ideal(const Scene& scene);

// Whether a law of a damper, dimensionless or in units, stands in place of this number of it.
template <class AnyDamper>
bool is_replaced(const AnyDamper& damper, std::string_view number) {
  return (number == "restitution" && !damper.restitution_by_speed.empty()) ||
         (number.ends_with("_stiffness") && damper.wall.law == WallForm::table);
}

// Where a number of a scene is kept: in itself or, if of_damper is not null, in one of its dampers.
template <class Whole, class Damper, class Value>
struct NumberOf {
  Value Whole::*own = nullptr;
  Value Damper::*of_damper = nullptr;
  std::optional<std::size_t> damper;  // index in a list, from 0; absent: the damper of a scene of one

  constexpr NumberOf() = default;
  // NOLINTBEGIN(google-explicit-constructor)
  // cppcheck-suppress noExplicitConstructor
  constexpr NumberOf(Value Whole::*its) : own(its) {}
  // cppcheck-suppress noExplicitConstructor
  constexpr NumberOf(Value Damper::*its) : of_damper(its) {}
  // NOLINTEND(google-explicit-constructor)
  constexpr NumberOf(const NumberOf& its, std::size_t which)
      : own(its.own), of_damper(its.of_damper), damper(which) {}
  // cppcheck-suppress constParameter
  Value& in(Whole& scene) const {
    return of_damper ? scene.dampers[damper.value_or(0)].*of_damper : scene.*own;
  }
  const Value& in(const Whole& scene) const {
    return of_damper ? scene.dampers[damper.value_or(0)].*of_damper : scene.*own;
  }
  // Whether it is this field, of whichever damper.
  constexpr bool is(const Value Whole::*number) const { return !of_damper && own == number; }
  constexpr bool is(const Value Damper::*number) const { return of_damper == number; }
  bool operator==(const NumberOf&) const = default;
};
using SceneNumber = NumberOf<Scene, SceneDamper, double>;

enum class Dimension;  // units.hpp

// One number of a scene: its name (as JSON key; as option of the command line, with '-' for '_'), where it
// is kept (of a damper, in the first), and which values it allows. Readers, writers and checks all go through
// these tables; only until_time and until_amplitude are in neither.
struct SceneField {
  std::string_view name;
  SceneNumber number;
  double least, most;  // smallest and largest allowed value
  Dimension dimension;
  std::string_view meaning;
  bool component = false;

  bool is_absent(double value) const { return component && value == 0; }
};
// The numbers of a scene of one damper, its own and that damper's without the clearance, which is 1; and the
// numbers of each damper of a list.
extern const std::array<SceneField, 14> scene_fields;
extern const std::array<SceneField, 9> scene_damper_fields;
const SceneField& field_of(const SceneNumber& number);
// Returns the name of its field; in a list with the damper's number behind it, from 1: clearance_2 is that of
// dampers[1].
std::string name_of(const SceneNumber& number);

struct NamedSceneNumber {
  std::string name;
  SceneNumber number;
  double least, most;  // smallest and largest allowed value
};
// All numbers of a scene in place of which no law stands. With one damper: scene_fields. With a list: the
// scene's own among them, then each number of scene_damper_fields for all dampers.
std::vector<NamedSceneNumber> numbers_of(const Scene& scene);

// The name of a damper's field in a Problem: "dampers[2].clearance", counted from 0.
std::string damper_field(std::size_t damper, std::string_view name);

// All secondary masses together, divided by the primary one.
double secondary_mass(const Scene& scene);

// The problems of a scene: one entry per invalid field ("mass_ratio", "must be ..., got ..."). A NaN is
// always invalid. Empty means that the exact engine may run the scene. simulate() checks what the others
// require besides: the restitution engine 0 <= y0 <= clearance, the component element method a time step
// within its stability limit.
std::vector<Problem> problems_of(const Scene& scene);

}  // namespace impact_damper
