// Scenes in engineers' units, and how they are made dimensionless.
//
// Masses are in kg, lengths in mm, velocities in mm/s, times in s, stiffnesses in N/m, forces in N,
// frequencies in Hz, energies in J. Three numbers fix all scales: the primary mass M, the stiffness K of its
// spring and the clearance epsilon, the free travel of the secondary mass, with several dampers that of the
// first. Lengths are made dimensionless by epsilon, times by sqrt(M/K) = 1/Omega_n, forces by K epsilon,
// energies by K epsilon^2; masses by M and stiffnesses by K.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "impact_damper/scene.hpp"

namespace impact_damper {

// The size of one dimensionless unit in engineers' units: a dimensionless number times the scale is the
// quantity.
struct Scales {
  double mass = 1;       // M, kg
  double stiffness = 1;  // K, N/m
  double length = 1;     // epsilon, mm

  double time() const;       // 1/Omega_n, s
  double frequency() const;  // Omega_n / (2 pi), Hz: that of omega_f = 1
  double velocity() const;   // epsilon Omega_n, mm/s
  double force() const;      // K epsilon, N
  double energy() const;     // K epsilon^2, J
  double damping() const;    // 2 sqrt(K M), critical damping, N s/m: that of zeta = 1

  bool operator==(const Scales&) const = default;
};

// The same in SI: the object "units" in the run file of a scene in units.
struct SiUnits {
  double length;    // epsilon, m
  double time;      // 1/Omega_n, s
  double velocity;  // epsilon Omega_n, m/s
  double mass;      // M, kg
  double force;     // K epsilon, N
  double energy;    // K epsilon^2, J
};
SiUnits si_units_of(const Scales& scales);

// One field of SiUnits, and its key in a run file.
struct SiUnit {
  std::string_view name;
  double SiUnits::*member;
};
inline constexpr std::array<SiUnit, 6> si_units{{{"length_m", &SiUnits::length},
                                                 {"time_s", &SiUnits::time},
                                                 {"velocity_m_per_s", &SiUnits::velocity},
                                                 {"mass_kg", &SiUnits::mass},
                                                 {"force_N", &SiUnits::force},
                                                 {"energy_J", &SiUnits::energy}}};

// A damper in units; an absent number has the default that its comment names.
struct DamperInUnits {
  std::optional<double> secondary_mass, clearance;  // kg, mm: both required
  std::optional<double> restitution;                // as in SceneDamper, with its default
  std::optional<double> contact_stiffness;          // of a wall, N/m; absent: SceneDamper's default k times K
  // Each is 0 if absent: distance from the left wall, mm; velocity relative to the cavity, mm/s.
  std::optional<double> secondary_displacement, secondary_velocity;
};

// Every number that may be given; an absent one has the default that its comment names. Allowed values:
// unit_fields.
struct SceneInUnits {
  std::optional<double> mass, stiffness;         // kg, N/m: both required
  std::optional<double> damping, damping_ratio;  // N s/m, or as in Scene; at most one; none: undamped
  // Each is 0 if absent (unlike Scene::x0, whose default is 6).
  std::optional<double> initial_displacement, initial_velocity;  // of the primary mass; mm, mm/s
  std::optional<double> exciting_force,
      exciting_frequency;  // amplitude, N, absent: 0; Hz, absent: Omega_n / (2 pi)
  std::optional<double> until_seconds, until_millimetres;              // stops, s and mm; at least one
  std::vector<DamperInUnits> dampers = std::vector<DamperInUnits>(1);  // 1 to most_dampers

  // The first damper, in a scene of one the only one.
  DamperInUnits& damper() { return dampers.front(); }
  const DamperInUnits& damper() const { return dampers.front(); }
};

// Where a number of a scene in units is kept: in itself or, if of_damper is not null, in one of its dampers.
struct NumberInUnits {
  std::optional<double> SceneInUnits::*own = nullptr;
  std::optional<double> DamperInUnits::*of_damper = nullptr;
  std::size_t damper = 0;  // which, from 0

  constexpr NumberInUnits() = default;
  // NOLINTBEGIN(google-explicit-constructor)
  // cppcheck-suppress noExplicitConstructor
  constexpr NumberInUnits(std::optional<double> SceneInUnits::*its) : own(its) {}
  // cppcheck-suppress noExplicitConstructor
  constexpr NumberInUnits(std::optional<double> DamperInUnits::*its) : of_damper(its) {}
  // NOLINTEND(google-explicit-constructor)
  // cppcheck-suppress constParameter
  std::optional<double>& in(SceneInUnits& scene) const {
    return of_damper ? scene.dampers[damper].*of_damper : scene.*own;
  }
  const std::optional<double>& in(const SceneInUnits& scene) const {
    return of_damper ? scene.dampers[damper].*of_damper : scene.*own;
  }
};

// One number of a scene in units: its name, which is its JSON key, where it is kept (of a damper, in the
// first), which values it allows and what it is. The limits are such that no scale overflows or underflows.
struct UnitField {
  std::string_view name;
  NumberInUnits number;
  double least;              // smallest allowed value
  bool least_is_allowed;     // false: strictly above
  double most;               // largest allowed value
  std::string_view unit;     // "" for a ratio
  std::string_view becomes;  // the dimensionless field that is made of it; "" where it only scales
  bool also_dimensionless;   // has the same name and meaning in a dimensionless scene
  std::string_view meaning;
};
extern const std::array<UnitField, 16> unit_fields;

// The problem of a number of a damper that is given beside a list.
inline constexpr std::string_view beside_dampers =
    "must not be given beside dampers, each of which has its own";

// The problems of a scene in units, one entry per invalid field, as by problems_of(Scene): required numbers
// that are missing, numbers out of range, both dampings given, no stop, and numbers that make a Scene which
// is not valid. Empty means that the two functions below may be called; otherwise their behaviour is
// undefined.
std::vector<Problem> problems_of(const SceneInUnits& scene);

Scales scales_of(const SceneInUnits& scene);
Scene dimensionless(const SceneInUnits& scene);

}  // namespace impact_damper
