// A run: what an engine made of a scene, as columns. Written to and read from JSON by run_file.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "impact_damper/engine.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

enum class Wall { left = 0, right = 1 };

enum class StopReason {
  time,               // until_time was reached
  amplitude,          // a half cycle ended below until_amplitude
  impact_budget,      // Budget::max_impacts
  half_cycle_budget,  // Budget::max_half_cycles
  time_budget,        // Budget::max_time
  step_budget,        // max_steps of the engine
};
std::string_view name_of(StopReason reason);  // the enumerator's own name

// Row 0 runs from the release to the first zero crossing of x, each further row from one crossing to
// the next; an unfinished one at the end is no row.
struct HalfCycles {
  std::vector<double> zero_crossing;  // time of the crossing that ends the row
  std::vector<double> peak_time;      // when the amplitude is reached
  std::vector<double> amplitude;      // largest |x| in the row, divided by epsilon
  std::vector<std::int64_t> impacts;  // impacts in the row; a contact that lasts is one
};

struct Impacts {
  std::vector<double> time;
  std::vector<Wall> wall;
  std::vector<double> relative_velocity;  // y' just before, divided by epsilon Omega_n: < 0 at the left wall
  // 180 degrees times (time since the last zero crossing) / (time between the zero crossings), and the
  // amplitude of that half cycle. Absent in row 0, which no zero crossing began, and in the unfinished
  // half cycle at the end.
  std::vector<std::optional<double>> phase_deg;
  std::vector<std::optional<double>> amplitude;  // absent only in the unfinished half cycle
  std::vector<double> displacement;              // x at the impact, divided by epsilon
};

// Compliant walls: every contact, from the wall position to the return to it. Restitution: the
// intervals in which the secondary mass is stuck to a wall. A contact that the end of the run cuts
// ends there.
struct Contacts {
  std::vector<double> begin, end;
  std::vector<Wall> wall;
};

struct History {
  std::vector<double> time, x, v, y, w;
};

// Energies divided by K epsilon^2, at one instant.
struct Energy {
  double kinetic = 0;  // (v^2 + nu (v + w)^2) / 2
  double spring = 0;   // x^2 / 2
  double wall = 0;     // k q^2 / 2 while in contact with a compliant wall
  double paper = 0;    // the paper's own total: (v^2 + nu (v^2 + w^2) + x^2) / 2
  double total() const { return kinetic + spring + wall; }
};

// initial.total() + forcing_work
//     = final.total() + sum of impact_loss + contact_loss + bounce_down_loss + viscous_work
struct EnergyBalance {
  Energy initial, final;
  std::vector<double> impact_loss;  // per impact, in the order of Impacts
  double contact_loss = 0;          // compliant walls: loss in contacts that no impact began
  std::int64_t bounce_downs = 0;    // restitution: accumulation points jumped to
  double bounce_down_loss = 0;      // restitution: loss in the impacts jumped over
  double viscous_work = 0;          // taken out by the primary mass's damper, integral of 2 zeta v^2
  double forcing_work = 0;          // put in by the forcing, integral of f0 sin(omega_f t) v
  double residual = 0;              // left minus right of the equation above, by what went through it: the
                                    // initial energy plus the integral of the forcing's |power|
};

// Rows that a section of a run may be asked to have at most; samples that a history may be: with everything
// that the default budgets allow beside them they take less than 200 MB, and their file can be read
// (run_file.hpp).
inline constexpr std::int64_t most_rows = 10'000'000, most_samples = 500'000;

// What a run is asked to record. Nothing else is computed.
struct HistoryWindow {  // `count` equally spaced samples, both ends included
  double begin = 0, end = 0;
  std::int64_t count = 0;
};
struct AmplitudeWindow {  // the same, beginning where the first half cycle below `amplitude` ends
  double amplitude = 0, length = 0;
  std::int64_t count = 0;
};
struct Record {
  bool half_cycles = true;
  bool impacts = false;
  bool contacts = false;
  bool energy = false;
  // History by times or by amplitudes, not both in one run.
  std::vector<HistoryWindow> history;          // ascending, not overlapping; at most most_samples
  std::vector<AmplitudeWindow> history_below;  // descending amplitudes; the same
};

// Why and when a scene ended: what an engine returns; all else it tells its observer (recorder.hpp).
struct Outcome {
  StopReason stop_reason = StopReason::time;
  double end_time = 0;
};

// When a scene ends that nothing else ends before: by until_time or, if earlier, by Budget::max_time.
Outcome horizon_of(const Scene& scene, const Budget& budget);
// The budget with max_time filled in if absent.
Budget budget_for(const Scene& scene, Budget budget);

struct Run {
  StopReason stop_reason = StopReason::time;
  double end_time = 0;
  Scene scene;
  Engine engine;
  std::optional<HalfCycles> half_cycles;
  std::optional<Impacts> impacts;
  std::optional<Contacts> contacts;
  std::optional<EnergyBalance> energy;
  std::optional<History> history;
};

}  // namespace impact_damper
