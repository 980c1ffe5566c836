// Scenes in engineers' units, and how they are made dimensionless.
//
// Masses are in kg, lengths in mm, velocities in mm/s, times in s, stiffnesses in N/m, forces in N,
// frequencies in Hz, energies in J, powers in W, dampings in N s/m, rates, which count no cycles, in 1/s,
// accelerations in m/s^2, inclinations in degrees.
// Three numbers fix all scales: the primary mass M, the stiffness K of its spring and the clearance epsilon,
// the free travel of the secondary mass, with several dampers that of the first. Lengths are made
// dimensionless by epsilon, times by sqrt(M/K) = 1/Omega_n, forces by K epsilon, energies by K epsilon^2;
// masses by M and stiffnesses by K.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

// What a number measures. Counts and ratios have no unit; angles but an inclination are listed as ratios.
enum class Dimension {
  ratio,
  count,
  length,
  time,
  velocity,
  mass,
  force,
  energy,
  power,
  frequency,
  rate,
  stiffness,
  damping,
  acceleration,
  inclination
};
// Returns the name of its unit, "" without one: "mm/s" in a scene in units, else "epsilon Omega_n".
std::string_view unit_of(Dimension dimension, bool in_units);
// Reads a number with one of the units that engineers write behind it, "12mm", "1.2 cm", as a number in
// unit_of(dimension, true). Absent if it is none.
std::optional<double> parse_quantity(std::string_view text, Dimension dimension);
// Returns the names of these units, first unit_of(dimension, true): "mm, um, cm, m or in"; "" without any.
std::string written_units(Dimension dimension);
std::string with_unit(const std::string& number, std::string_view unit);  // "12 mm", or "12" if unit is ""
// Returns the name of its SI unit as the end of another name, "" without one: "_m_per_s".
std::string_view suffix_of(Dimension dimension);

// What fixes the size of each dimensionless unit: a dimensionless number times that size is the quantity.
struct Scales {
  double mass = 1;       // M, kg
  double stiffness = 1;  // K, N/m
  double length = 1;     // epsilon, mm

  // of() returns the size of one dimensionless unit in engineers' units, in_si() in SI; both return 1 for
  // ratios, counts and inclinations. Of frequencies it is Omega_n / (2 pi), that of omega_f = 1; of damping 2
  // sqrt(K M), critical damping.
  double of(Dimension dimension) const;
  double in_si(Dimension dimension) const;

  bool operator==(const Scales&) const = default;
};
// Returns scales->of(dimension); 1 for a dimensionless scene, which has no scales.
double scale_of(Dimension dimension, const std::optional<Scales>& scales);

// The object "units" in the run file of a scene in units has the size in SI of these, by key_of().
inline constexpr std::array<Dimension, 6> dimensions_in_files{Dimension::length,   Dimension::time,
                                                              Dimension::velocity, Dimension::mass,
                                                              Dimension::force,    Dimension::energy};
std::string key_of(Dimension dimension);  // "velocity_m_per_s"

// A damper in units; an absent number has the default that its comment names.
struct DamperInUnits {
  std::optional<double> secondary_mass, clearance;  // kg, mm: both required
  std::optional<double> restitution;                // as in SceneDamper, with its default
  std::optional<double> contact_stiffness;          // of a wall, N/m; absent: SceneDamper's default k times K
  // Each is 0 if absent: distance from the left wall, mm; velocity relative to the cavity, mm/s.
  std::optional<double> secondary_displacement, secondary_velocity;
  // Coefficients of friction in the cavity, 0 if absent, the static one if absent the other; drag on the
  // velocity relative to the cavity, N s/m, 0 if absent.
  std::optional<double> friction_coefficient, static_friction_coefficient, drag;
  WallLaw wall{};                // lengths in mm, forces in N, the speed in mm/s
  Pairs restitution_by_speed{};  // speeds in mm/s
};
inline constexpr double standard_gravity = 9.80665;  // m/s^2

// Every number that may be given; an absent one has the default that its comment names. Allowed values:
// unit_fields.
struct SceneInUnits {
  // kg, N/m, Hz: required are the mass and one of the two others; f stands for K = M (2 pi f)^2.
  std::optional<double> mass, stiffness, natural_frequency;
  std::optional<double> damping, damping_ratio;  // N s/m, or as in Scene; at most one; none: undamped
  // Each is 0 if absent (unlike Scene::x0, whose default is 6).
  std::optional<double> initial_displacement, initial_velocity;  // of the primary mass; mm, mm/s
  std::optional<double> exciting_force,
      exciting_frequency;  // amplitude, N, absent: 0; Hz, absent: Omega_n / (2 pi)
  // Of the cavities from the horizontal, their left walls below; degrees, absent: 0. Acceleration of gravity,
  // m/s^2, absent: standard_gravity. With them friction_coefficient becomes a force, and weight one.
  std::optional<double> inclination, gravity;
  std::optional<double> until_seconds, until_millimetres;              // as in Scene; s, mm; at least one
  std::vector<DamperInUnits> dampers = std::vector<DamperInUnits>(1);  // 1 to most_dampers
  SpringLaw spring{};  // lengths in mm, forces in N, cubic in N/mm^3

  // The first damper, in a scene of one the only one.
  DamperInUnits& damper() { return dampers.front(); }
  const DamperInUnits& damper() const { return dampers.front(); }
};

using NumberInUnits = NumberOf<SceneInUnits, DamperInUnits, std::optional<double>>;

// One number of a scene in units: its name, which is its JSON key, where it is kept (of a damper, in the
// first), which values it allows and what it is. The limits are such that no scale overflows or underflows.
struct UnitField {
  std::string_view name;
  NumberInUnits number;
  NumberRange range;
  Dimension dimension;       // a ratio has the same name and meaning in a dimensionless scene
  std::string_view becomes;  // the dimensionless field that is made of it; "" where it only scales
  std::string_view meaning;

  static bool is_absent(double) { return false; }  // as of a SceneField; what is given is written
};
extern const std::array<UnitField, 22> unit_fields;

// The problem of a number of a damper that is given beside a list.
inline constexpr std::string_view beside_dampers =
    "must not be given beside dampers, each of which has its own";

// The problems of a scene in units, one entry per invalid field, as by problems_of(Scene): required numbers
// that are missing, numbers out of range, two numbers of which one stands for the other, no stop, and numbers
// that make a Scene which is not valid. Empty means that the two functions below may be called; otherwise
// their behaviour is undefined.
std::vector<Problem> problems_of(const SceneInUnits& scene);

// Sets a number, and takes away the one that it stands in place of: damping and damping_ratio, stiffness and
// natural_frequency.
void set_number(SceneInUnits& scene, const NumberInUnits& number, double value);

// Returns K in N/m, given or by the natural frequency; absent if it is not known.
std::optional<double> stiffness_of(const SceneInUnits& scene);
Scales scales_of(const SceneInUnits& scene);
Scene dimensionless(const SceneInUnits& scene);

// Warnings about numbers of a scene that are valid but probably a mistake: one sentence of plain text for
// each of these cautions that the scene gives rise to; empty if there is none:
//
//   a secondary mass that begins outside its cavity, y0 < 0 or y0 > 1, for one in a list y0 > its clearance:
//   with compliant walls it begins by pressing a wall together, which then holds the energy k q^2 / 2, q
//   being the distance from the cavity;
//
//   a mass ratio above 1: the secondary mass may have been given in grams.
//
// Lengths and energies are in mm and J if `scales` are given, else in units of epsilon and K epsilon^2. The
// scene must be valid (problems_of).
std::vector<std::string> cautions_of(const Scene& scene, const std::optional<Scales>& scales);

}  // namespace impact_damper
