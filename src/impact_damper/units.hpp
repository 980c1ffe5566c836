// Scenes in engineers' units, and the one place where they are made dimensionless.
//
// Masses are in kg, lengths in mm (travels of an impact damper are), times in s, stiffnesses in N/m, forces
// in N, frequencies in Hz. Three numbers of the primary system carry all scales: its mass M, its stiffness K
// and the clearance epsilon, the free travel of the secondary mass. Lengths are made dimensionless by
// epsilon, times by sqrt(M/K) = 1/Omega_n, forces by K epsilon, energies by K epsilon^2; masses by M and
// stiffnesses by K.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "impact_damper/scene.hpp"

namespace impact_damper {

// What one dimensionless unit is in engineers' units: a dimensionless number times the scale is the quantity.
struct Scales {
  double mass = 1;       // M, kg
  double stiffness = 1;  // K, N/m
  double length = 1;     // epsilon, mm

  double time() const;       // 1/Omega_n, s
  double frequency() const;  // Omega_n / (2 pi), Hz: of omega = 1
  double velocity() const;   // epsilon Omega_n, mm/s
  double force() const;      // K epsilon, N
  double energy() const;     // K epsilon^2, J
  double damping() const;    // 2 sqrt(K M), critical damping, N s/m: of zeta = 1

  bool operator==(const Scales&) const = default;
};

// The same in SI: what a run of a scene in units says of its columns.
struct SiUnits {
  double length;    // epsilon, m
  double time;      // 1/Omega_n, s
  double velocity;  // epsilon Omega_n, m/s
  double mass;      // M, kg
  double force;     // K epsilon, N
  double energy;    // K epsilon^2, J
};
SiUnits si_units_of(const Scales& scales);

// Each of them under its key in a run file.
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

// Every number that may be given; absent ones have the default that its comment names.
struct SceneInUnits {
  std::optional<double> mass, stiffness, secondary_mass, clearance;  // kg, N/m, kg, mm: all needed
  std::optional<double> restitution;                                 // as in Scene, with its default
  std::optional<double> damping, damping_ratio;  // N s/m, or as in Scene; one of them at most; none: undamped
  std::optional<double> contact_stiffness;       // of the walls, N/m; none: as many times K as in Scene
  // All four are 0 if not given: whoever thinks in units says what is displaced.
  std::optional<double> initial_displacement, initial_velocity;      // of the primary mass; mm, mm/s
  std::optional<double> secondary_displacement, secondary_velocity;  // from the left wall; in the cavity
  std::optional<double> exciting_force,
      exciting_frequency;                                  // amplitude, N; Hz, that of sqrt(K/M) if not given
  std::optional<double> until_seconds, until_millimetres;  // stops; one of them at least
};

// One number of it: its name, which is its JSON key, where it is kept, which values it allows and what it is.
// Limits are such that no scale over- or underflows.
struct UnitField {
  std::string_view name;
  std::optional<double> SceneInUnits::*member;
  double least;              // smallest allowed value
  bool least_is_allowed;     // false: strictly above
  double most;               // largest allowed value, allowed
  std::string_view unit;     // "" for a ratio
  std::string_view becomes;  // the field of Scene that is made of it; "" where it only scales
  bool also_dimensionless;   // has the same name and meaning in a dimensionless scene
  std::string_view meaning;
};
extern const std::array<UnitField, 16> unit_fields;

// What is wrong with it, as problems_of(Scene): what is missing, out of range, given twice, or makes a Scene
// that is not valid. Empty means that the two functions below may be called.
std::vector<Problem> problems_of(const SceneInUnits& scene);

Scales scales_of(const SceneInUnits& scene);
Scene dimensionless(const SceneInUnits& scene);

}  // namespace impact_damper
