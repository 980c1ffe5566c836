// Design of an impact damper: its clearance, its contact forces, and the amplitude that is left under an
// exciting force. Dimensionless as in run.hpp, forces divided by K epsilon; the equations are in
// docs/mathematics.md, chapter 12. No function checks its arguments: scenes must be valid (problems_of) and
// have one damper, not a list, whose numbers are those of the scene.
#pragma once

#include <optional>

#include "impact_damper/run.hpp"

namespace impact_damper {

// --- Clearance --------------------------------------------------------------------------------------------
// How far a damper as built, and its motion, may deviate from the nominal numbers.
struct Tolerances {
  double restitution = 0.05;  // absolute, either way
  double clearance = 0.1;     // relative, either way
  double amplitude = 0.1;     // relative, either way
};

// The clearance for an amplitude that is to be damped (M12.3). Amplitudes in units of the clearance.
struct ClearanceRule {
  double fold = 0;  // fold_amplitude(e): below it there is no motion with one impact per half cycle
  // Recommended amplitude divided by the fold: least_margin, or more where the tolerances need more.
  double margin = 0;
  double amplitude = 0;  // margin * fold: what the amplitude to be damped should be
  double loss = 0;       // eta/nu there, of the impacts alone
  // With every deviation at its limit on the worse side: a lower restitution, a wider clearance, a smaller
  // amplitude.
  double worst_restitution = 0, worst_fold = 0, worst_amplitude = 0;
  double worst_loss = 0;  // eta/nu there
};
inline constexpr double least_margin = 1.5;
// Restitution in (0, 1), clearance tolerance > -1, amplitude tolerance < 1.
ClearanceRule clearance_rule(double restitution, const Tolerances& tolerances = {});

// --- Contact ----------------------------------------------------------------------------------------------
// A short contact of the two masses, otherwise free, begun with the relative speed w > 0 (`speed`, divided by
// epsilon Omega_n): (M12.4) and (M12.5).
struct ShortContact {
  double force = 0;  // largest force between them
  // Until the wall is back in its place; absent without a rebound (damping ratio of the contact >= 1).
  std::optional<double> duration;
};
ShortContact short_contact(const SceneDamper& damper, Calibration calibration, double speed);
// The longest contact, in units of 1/Omega_n, that is short compared with the primary mass's period.
inline constexpr double longest_short_contact = 0.15;

// Magnitude of the wall's force at the release; 0 if y0 is in the cavity.
double initial_wall_force(const SceneDamper& damper, Calibration calibration);

// --- Forced motion ----------------------------------------------------------------------------------------
// Amplitude of the steady motion of mass * x'' + 2 zeta x' + x = f sin(omega t), with `mass` = 1 for the
// empty box, 1 + nu for the secondary mass locked to it (M12.6). Infinite at the resonance of an undamped
// oscillator.
double linear_response(double force, double mass, double damping_ratio, double frequency);
struct WorstResponse {
  double frequency = 0, amplitude = 0;
};
// The frequency at which linear_response is largest, and that maximum (M12.7): frequency 0 if 2 zeta^2 >=
// mass. Without damping the amplitude is infinite.
WorstResponse worst_linear_response(double force, double mass, double damping_ratio);

// Smallest, mean and largest amplitude of the last quarter of a run's half cycles.
struct SteadyAmplitude {
  double least = 0, mean = 0, greatest = 0;
  bool settled = false;  // the mean of the quarter before differs by at most 2 %
};
// Of a run's half cycles; absent with fewer than 12.
std::optional<SteadyAmplitude> steady_amplitude(const HalfCycles& half_cycles);

}  // namespace impact_damper
