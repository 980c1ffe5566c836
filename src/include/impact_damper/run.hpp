// A run: the result of an engine for a scene, as columns. Written to and read from JSON by io/run_file.hpp.
// Dimensionless throughout: times in units of 1/Omega_n, lengths of epsilon, velocities of epsilon Omega_n,
// energies of K epsilon^2. x and v = x' belong to the primary mass; y is the distance of a secondary mass
// from its left wall, w = y' its velocity relative to the cavity.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

enum class Wall { left = 0, right = 1 };
constexpr Wall opposite(Wall wall) { return wall == Wall::left ? Wall::right : Wall::left; }

enum class StopReason {
  time,               // until_time was reached
  amplitude,          // a half cycle ended below until_amplitude
  impact_budget,      // Budget::max_impacts
  half_cycle_budget,  // Budget::max_half_cycles
  time_budget,        // Budget::max_time
  step_budget,        // Exact::max_steps, Restitution::max_steps or Cem::max_steps
};

// Row 0 runs from the release to the first zero crossing of x, each further row from one crossing to
// the next. The unfinished half cycle at the end of the run has no row.
struct HalfCycles {
  std::vector<double> zero_crossing;  // time of the crossing that ends the row
  std::vector<double> peak_time;      // when the amplitude is reached
  std::vector<double> amplitude;      // largest |x| in the row, divided by epsilon
  std::vector<std::int64_t> impacts;  // impacts in the row; a sustained contact counts as one
  struct Damper {
    std::vector<std::int64_t> impacts;  // its own
  };
  std::vector<Damper> dampers{Damper{}};  // by number in the scene
};

struct Impacts {
  std::vector<double> time;
  std::vector<Wall> wall;
  std::vector<double> relative_velocity;  // y' just before, divided by epsilon Omega_n: < 0 at the left wall
  // 180 degrees times (time since the last zero crossing) / (time between the zero crossings). Absent in
  // row 0 of the half cycles, which no zero crossing began, and in the unfinished half cycle at the end.
  std::vector<std::optional<double>> phase_deg;
  std::vector<std::optional<double>> amplitude;  // of that half cycle; absent only in the unfinished one
  std::vector<double> displacement;              // x at the impact, divided by epsilon
  // The damper, by its number in the scene, from 0. Impacts that coincide are in this order; those that
  // follow from them at the same time come after them.
  std::vector<std::int32_t> damper;
};

// Compliant walls: every contact, from the wall position to the return to it. Restitution: the
// intervals in which the secondary mass is stuck to a wall. A contact that is not over when the run ends
// has `end` at the end of the run.
struct Contacts {
  std::vector<double> begin, end;
  std::vector<Wall> wall;
  std::vector<std::int32_t> damper;  // as that of Impacts
};

// The motion at the sample times of a Record.
struct History {
  std::vector<double> time, x, v;
  struct Damper {
    std::vector<double> y, w;
  };
  std::vector<Damper> dampers{Damper{}};  // by number in the scene
};

// Energies divided by K epsilon^2, at one instant.
struct Energy {
  double kinetic = 0;  // (v^2 + nu (v + w)^2) / 2
  double spring = 0;   // x^2 / 2
  double wall = 0;     // k q^2 / 2 in contact with a compliant wall that is displaced by q
  double paper = 0;    // the paper's own total: (v^2 + nu (v^2 + w^2) + x^2) / 2
  double weight = 0;   // gamma nu (x + y), from x = y = 0
  double total() const { return kinetic + spring + wall + weight; }
};

// The share of one damper of a list in an EnergyBalance, divided by K epsilon^2.
struct DamperEnergy {
  double initial_kinetic = 0, final_kinetic = 0;  // nu (v + w)^2 / 2
  double impact_loss = 0;                         // of all its impacts
  double contact_loss = 0;                        // compliant walls: in contacts that no impact began
  std::int64_t bounce_downs = 0;                  // accumulation points jumped to
  double bounce_down_loss = 0;                    // in the impacts jumped over
  double friction_loss = 0, drag_loss = 0;        // integrals of nu phi |w| and of nu d w^2
};

// initial.total() + forcing_work
//     = final.total() + sum of impact_loss + contact_loss + bounce_down_loss + viscous_work
//       + friction_loss + drag_loss
struct EnergyBalance {
  Energy initial, final;
  // Loss of each impact, in the order of Impacts: with compliant walls of the whole contact that it begins.
  std::vector<double> impact_loss;
  double contact_loss = 0;        // compliant walls: loss in contacts that no impact began
  std::int64_t bounce_downs = 0;  // restitution: accumulation points jumped to
  double bounce_down_loss = 0;    // restitution: loss in the impacts jumped over
  double viscous_work = 0;        // taken out by the primary mass's damper, integral of 2 zeta v^2
  double forcing_work = 0;        // put in by the forcing, integral of f0 sin(omega_f t) v
  // The residual of the balance: left minus right side of the equation above, divided by the sum of the
  // initial energy, counted with weight from the least there is, and the integral of the forcing's |power|; 0
  // if that sum is 0.
  double residual = 0;
  double friction_loss = 0, drag_loss = 0;  // of all dampers
  // Integral of f0 cos(omega_f t) v, by the exact and restitution engines. With forcing_work it determines
  // the fundamental component of x (steady/steady_state.hpp); no part of the balance, and not in a run file.
  double reactive_work = 0;
  std::vector<DamperEnergy> dampers;  // of a list, by number in the scene; empty where the scene has one
  double impact_loss_total() const;   // sum of impact_loss
};

// Largest allowed number of rows that budgets may give a recorded section, and of samples of a history in
// all: of a scene with a list of n dampers most_samples / n. A history of most_samples, with all that the
// default budgets allow beside it, takes less than 200 MB, and its file is short enough to be read
// (io/run_file.hpp).
inline constexpr std::int64_t most_rows = 10'000'000, most_samples = 500'000;
// Largest allowed number of half cycles: each damper has a column. dampers: at least 1.
constexpr std::int64_t most_half_cycles(std::size_t dampers) {
  return most_rows / static_cast<std::int64_t>(dampers);
}

// `count` >= 2 equally spaced samples of the motion, both ends included; 0 <= begin < end <= 1e12. Samples
// after the end of the run are left out.
struct HistoryWindow {
  double begin = 0, end = 0;
  std::int64_t count = 0;
};
// `count` samples in the same way over `length` > 0, from the zero crossing that ends the first half cycle
// below `amplitude` > 0; from the end of the window before, if that is later.
struct AmplitudeWindow {
  double amplitude = 0, length = 0;
  std::int64_t count = 0;
};
// What a run records. Nothing else is computed.
struct Record {
  bool half_cycles = true;
  bool impacts = false;
  bool contacts = false;
  bool energy = false;
  // History by times or by amplitudes, not both in one run; at most most_samples in all, with a list of n
  // dampers most_samples / n.
  std::vector<HistoryWindow> history{};          // ascending, not overlapping
  std::vector<AmplitudeWindow> history_below{};  // of descending amplitudes
};

// Why and when a run ended. An engine returns this; all else it passes to its observer
// (engines/observer.hpp).
struct Outcome {
  StopReason stop_reason = StopReason::time;
  double end_time = 0;
};

// The end of a run, and its reason, if nothing else ends it before: until_time or, if earlier,
// Budget::max_time.
Outcome horizon_of(const Scene& scene, const Budget& budget);
// The budget with max_time filled in if absent.
Budget budget_for(const Scene& scene, Budget budget);

struct Run {
  StopReason stop_reason = StopReason::time;
  double end_time = 0;
  Scene scene;
  // With the options that simulate() filled in, Budget::max_time and Cem::time_step; and where half cycles of
  // several dampers are recorded, Budget::max_half_cycles at most most_rows divided by their number.
  Engine engine;
  std::optional<HalfCycles> half_cycles;
  std::optional<Impacts> impacts;
  std::optional<Contacts> contacts;
  std::optional<EnergyBalance> energy;
  std::optional<History> history;
};

}  // namespace impact_damper
