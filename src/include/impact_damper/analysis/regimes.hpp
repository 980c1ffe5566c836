// The regimes that a decay passes through, found in a run's columns by stated rules: stuck, bounce-down and
// its end, regular impacting, impact failure. Rows are those of Run::half_cycles. Row 0, from the release to
// the first zero crossing, is less than a half cycle, so the regimes leave it out; only first_row_below()
// and time_below() include it. "Needs" names the sections that the run must have recorded; without one of
// them the function throws std::invalid_argument. The scene must have one damper, except for time_below(); of
// a run with a list run_of_damper() returns the part of each.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "impact_damper/run.hpp"

namespace impact_damper {

struct RegimeOptions {
  // A compliant contact counts as stuck if it lasts longer than this many nominal contact times (half periods
  // of the contact, motion/wall.hpp): after a whole period on the wall a mass no longer bounces.
  double stuck_contact_times = 2;
  // Bounce-down is this many successive half cycles or more with a stuck phase. In the chaotic ranges a mass
  // may stick in one half cycle, even in two in succession, but not regularly.
  std::int64_t bounce_down_half_cycles = 4;
  // Half cycles of equal impact count that make a regular window.
  std::int64_t window_half_cycles = 8;
  // Impacts are missed when this many successive half cycles bring fewer impacts than half cycles. One is
  // too few: an impact that slips across a zero crossing empties a half cycle and fills its neighbour.
  std::int64_t failure_half_cycles = 3;
};

// The contacts in which the secondary mass sticks to a wall: all that a restitution run recorded; with
// compliant walls those that last longer than stuck_contact_times. Needs contacts.
Contacts stuck_contacts(const Run& run, const RegimeOptions& options = {});

// A stuck interval, or the part of one that lies in a half cycle, in the coordinates of Figure 15.
struct StuckPhases {
  std::vector<double> amplitude;           // of the half cycle
  std::vector<double> begin_deg, end_deg;  // as Impacts::phase_deg, 0 <= begin < end <= 180
};
// The stuck phases of all half cycles but row 0, which no zero crossing began. Needs half_cycles and
// contacts.
StuckPhases stuck_phases(const Run& run, const RegimeOptions& options = {});

// A half cycle of a run.
struct HalfCycleRow {
  std::size_t row = 0;
  double amplitude = 0;  // divided by epsilon
};

// End of bounce-down: the last half cycle of the first unbroken series of half cycles, at
// least bounce_down_half_cycles long, in each of which the mass sticks. Absent if there is no such series,
// and if the run ends in it. Needs half_cycles and contacts.
std::optional<HalfCycleRow> end_of_bounce_down(const Run& run, const RegimeOptions& options = {});

// Impact failure: a half cycle without an impact; absent if there is none of the kind.
struct ImpactFailure {
  // The first one after the last regular window that its neighbours do not make up for: the
  // failure_half_cycles half cycles in whose middle it lies have fewer impacts than half cycles. (In the
  // chaotic ranges at higher amplitudes a single impact may be missed too, but impacting recovers.)
  std::optional<HalfCycleRow> first_missed;
  // The first one after which, to the end of the run, any failure_half_cycles successive half cycles have
  // fewer impacts than half cycles: impacting does not recover.
  std::optional<HalfCycleRow> for_good;
};
// Needs half_cycles.
ImpactFailure impact_failure(const Run& run, const RegimeOptions& options = {});
// The row of the first missed impact, else of failure for good; without either the number of rows. Needs
// half_cycles.
std::size_t failure_row(const Run& run);

// A maximal series of at least window_half_cycles half cycles with the same number of impacts, at least one.
struct RegularWindow {
  std::int64_t impacts = 0;         // per half cycle
  std::size_t first = 0, last = 0;  // rows, both included
  double upper = 0, lower = 0;      // amplitudes of these rows
};
// The regular windows of a run, in the order of time. Needs half_cycles.
std::vector<RegularWindow> regular_windows(const Run& run, const RegimeOptions& options = {});

// The longest regular window with `impacts` impacts per half cycle, the earlier of two equals.
std::optional<RegularWindow> longest_window(const std::vector<RegularWindow>& windows, std::int64_t impacts);

// The row whose amplitude first lies below `amplitude`. Absent if none does.
std::optional<std::size_t> first_row_below(const HalfCycles& half_cycles, double amplitude);

// The time at which the amplitude of a run has come below a bound, in units of 1/Omega_n; absent if the run
// does not get there. In an oscillation it is that of the peak of the first half cycle below `amplitude` > 0.
// Where a half cycle leaves less than a tenth of the amplitude before it, or the motion creeps back to zero,
// it is the last time at which |x| is as large as `amplitude`, found by simulating the same motion again.
// (M15.13) shows that it is the last if no half cycle below it is complete. Needs half_cycles; throws what
// simulate() throws.
std::optional<double> time_below(const Run& run, double amplitude);

// Returns one damper's part of a run with several, as a run of one damper: the run's half cycles, impacts,
// contacts and history, as far as they were recorded, with the impacts of the damper `number` (from 0, of
// those of the scene) alone, and lengths and velocities divided by its clearance instead of epsilon. Its
// scene is that damper alone on the primary mass, with the same initial condition. It has no energies, as it
// lacks the losses of the other dampers.
Run run_of_damper(const Run& run, std::size_t number);

}  // namespace impact_damper
