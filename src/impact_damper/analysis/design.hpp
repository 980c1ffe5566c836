// What somebody asks who builds an impact damper: which clearance, which forces, and what is left of the
// motion under an exciting force. Dimensionless throughout; the equations are in docs/mathematics.md,
// chapter 12.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// --- Clearance --------------------------------------------------------------------------------------------
// How far what is built may be from what was meant.
struct Tolerances {
  double restitution = 0.05;  // either way
  double clearance = 0.1;     // relative, either way
  double amplitude = 0.1;     // relative, either way
};

// The clearance for an amplitude that is to be damped (M12.3). Amplitudes in units of the clearance.
struct ClearanceRule {
  double fold = 0;  // fold_amplitude(e): below it one impact per half cycle cannot go on
  double margin =
      0;  // of the recommended amplitude to the fold: least_margin, more if the tolerances take more
  double amplitude = 0;  // margin * fold: what the amplitude to be damped should be
  double loss = 0;       // eta/nu there, of the impacts alone
  // Where all tolerances are used up to the worse side: a lower restitution, a wider clearance, a smaller
  // motion.
  double worst_restitution = 0, worst_fold = 0, worst_amplitude = 0;
  double worst_loss = 0;  // eta/nu there
};
inline constexpr double least_margin = 1.5;
// e in (0, 1).
ClearanceRule clearance_rule(double restitution, const Tolerances& tolerances = {});

// --- Contact ----------------------------------------------------------------------------------------------
// A short contact of both masses, otherwise free, that a relative speed w > 0 begins: (M12.4) and (M12.5).
struct ShortContact {
  double force = 0;                // largest force between them, divided by K epsilon
  std::optional<double> duration;  // until the overlap is gone; absent without a rebound (damping ratio >= 1)
};
ShortContact short_contact(const Scene& scene, Calibration calibration, double speed);

// The force of the wall in which the scene begins, divided by K epsilon; 0 if y0 is in the cavity.
double initial_wall_force(const Scene& scene, Calibration calibration);

// --- Forced motion ----------------------------------------------------------------------------------------
// Amplitude of mass * x'' + 2 zeta x' + x = f sin(omega t): the empty box for mass 1, the secondary mass
// locked to it for mass 1 + nu (M12.6). Infinite at the resonance of an undamped oscillator.
double linear_response(double force, double mass, double damping_ratio, double frequency);
struct WorstResponse {
  double frequency = 0, amplitude = 0;
};
// Where linear_response is largest (M12.7): at frequency 0 if the damping is so strong; of infinite
// amplitude without damping.
WorstResponse worst_linear_response(double force, double mass, double damping_ratio);

// Amplitudes of the last quarter of a run's half cycles.
struct SteadyAmplitude {
  double least = 0, mean = 0, greatest = 0;
  bool settled = false;  // the mean of the quarter before differs by less than 2 %
};
// Absent with fewer than 12 half cycles.
std::optional<SteadyAmplitude> steady_amplitude(const HalfCycles& half_cycles);

struct ResponsePoint {
  double frequency = 0;
  SteadyAmplitude amplitude;
};
// The scene under its force at other frequencies, each from the scene's own release, ascending: close
// together about the resonances of the empty box and of the locked mass and about the frequency given, and
// closer still where the mean amplitude is largest: about 70 runs. Each is followed for `time`, and by 20 000
// impacts and a million steps of the searches at most; one that a budget ends is judged by what it has.
// `progress` is told how many are done.
struct FrequencyResponse {
  std::vector<ResponsePoint> points;
  double time = 0;
  bool empty() const { return points.empty(); }
  const ResponsePoint& worst() const;  // of a response that is not empty: largest mean amplitude
};
FrequencyResponse frequency_response(const Scene& scene, const Engine& engine, const Threads& threads,
                                     const std::function<void(std::size_t done)>& progress);

}  // namespace impact_damper
