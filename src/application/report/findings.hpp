// The numbers of a report about one scene: its decay, its loss factor, its regimes, and how far all that can
// be predicted. Dimensionless throughout; the page shows them in units as well.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "application/report/forced_response.hpp"
#include "impact_damper/analysis/design.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/run.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

struct Subject {
  std::string name;         // for example "mast"
  std::string description;  // may be empty
  Scene scene;
  std::optional<Scales> scales;  // if it was given in units
  Engine engine;
  double gravity = standard_gravity;  // m/s^2, of a scene in units
};

// The time at which the amplitude first was below a fraction of the first one (time_below() in regimes.hpp).
struct Fall {
  double part = 0;
  double amplitude = 0;         // part times the first amplitude
  double time = 0;              // in units of 1/Omega_n
  std::optional<Spread> times;  // over the ensemble; absent if a member does not get there
};

struct BestDamping {
  std::size_t row = 0;                     // of Findings::loss
  double eta = 0;                          // largest local loss factor before impact failure, per radian
  double amplitude = 0;                    // at which eta is so large, divided by epsilon
  double time = 0;                         // of that amplitude, in units of 1/Omega_n
  std::optional<Spread> etas, amplitudes;  // over the ensemble
};

// The loads on the box and the secondary mass.
struct Loads {
  double speed = 0;                     // largest relative speed of an impact, divided by epsilon Omega_n
  double impacts = 0, time = 0;         // number of impacts in `time`; of a forced motion in its last quarter
  std::optional<ShortContact> contact;  // of the fastest impact; absent for rigid walls and for soft ones
  double initial_force = 0;             // of the wall in which the scene begins, divided by K epsilon
};

// One of several dampers. Lengths and velocities are those of the scene.
struct DamperFindings {
  double energy = 0;  // dissipated by its impacts, divided by K epsilon^2
  std::int64_t impacts = 0;
  std::optional<HalfCycleRow> sticking_ends;  // as in Findings
  ImpactFailure failure;
  std::optional<Loads> loads;  // if it strikes a wall
};

// Returns the last half cycle that has an impact, if any has one.
std::optional<HalfCycleRow> last_with_impact(const HalfCycles& half_cycles);

// What friction in the cavities makes of a run, or its absence.
struct FrictionFindings {
  double coefficient = 0;                // mu
  std::optional<double> to_tenth;        // of the amplitude, as in Fall, counted from the first peak
  std::optional<double> best, best_eta;  // amplitude of the best damping and its loss factor, if any
  std::optional<HalfCycleRow> last_impact;
  double last_impact_time = 0;  // of its peak
  double last_amplitude = 0;
  std::optional<SteadyAmplitude> steady;  // forced motion with enough half cycles
  bool is_whole = false;                  // as long as Findings::run
};

// An interval of the recorded history: its samples, both included.
struct MotionWindow {
  std::size_t first = 0, last = 0;
};

struct Findings {
  Subject subject;
  Run run;                  // half cycles, impacts, contacts, energy; history in the windows below
  std::vector<Run> others;  // perturbed initial conditions: half cycles

  // Amplitude of row 0, or of row 1 if that is larger. If it is absent, the next three have no meaning.
  std::optional<double> first_amplitude;
  double last_amplitude = 0;
  double first_peak = 0, last_peak = 0;   // their times
  std::vector<Fall> falls;                // free motion: to a half, a tenth, a hundredth, as far as it got
  std::optional<SteadyAmplitude> steady;  // forced motion with enough half cycles
  ForcedResponse response;                // forced motion; empty if no half cycle has a peak
  std::optional<Loads> loads;             // if there is an impact

  LossFactor loss;                // free motion, before impact failure; empty where it is too short
  LossFactor loss_after_failure;  // the same from there on
  std::vector<LossFactor> losses_of_others;  // as `loss`
  std::optional<BestDamping> best;

  std::optional<HalfCycleRow> sticking_ends;  // end of bounce-down
  double stuck_time = 0;                      // in all, in units of 1/Omega_n
  std::vector<RegularWindow> windows;         // the longest of each number of impacts, most impacts first
  ImpactFailure failure;
  std::int64_t most_impacts = 0;  // in one half cycle
  // Of several dampers, by number. For all together there are no sticking_ends and no windows, and no contact
  // in `loads`. The damper whose motion is drawn dissipated most of the energy; in the window `chosen` it is
  // the one with the most impacts there.
  std::vector<DamperFindings> dampers;
  std::size_t shown = 0, shown_when_chosen = 0;

  // The run without friction, then with the coefficients friction_coefficients, for as long. Empty where
  // friction is known or has no scale: of a dimensionless scene, of one with components, and
  // where the engine has no friction beside what the scene has.
  std::vector<FrictionFindings> frictions;

  // Half cycle by half cycle, as far as every release has them: (greatest - least) / median of the amplitude.
  std::vector<double> spread;
  std::optional<std::size_t> lost_row;  // the first whose spread exceeds lost_spread

  std::optional<MotionWindow> begin;   // from the release on; absent if the run ends where it begins
  std::optional<MotionWindow> chosen;  // about the best damping; of a forced motion, its end

  bool forced() const { return subject.scene.force_amplitude != 0; }
  bool several() const { return !has_one_damper(subject.scene); }
  Run run_of(std::size_t damper) const;  // of one of several, as it sees it (run_of_damper); else `run`
  // What impacts took, contacts without an impact and bounce-downs included, and what was lost in all;
  // divided by K epsilon^2.
  double energy_to_impacts() const;
  double energy_lost() const;
};
inline constexpr double lost_spread = 0.01;
inline constexpr std::array friction_coefficients{0.1, 0.2, 0.3};

// Is called from time to time, from any thread, with what is being done.
using Progress = std::function<void(const std::string& doing)>;

// Simulates the subject, and ensemble.members - 1 perturbed initial conditions. Throws what simulate()
// throws.
Findings examine(const Subject& subject, const EnsembleOptions& ensemble, const Progress& progress);

}  // namespace impact_damper
