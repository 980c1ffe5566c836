// The observer of the program: it keeps what a Record asks for, as columns.
//
// An engine is a template over its observer: anything that is a RunObserver (observer.hpp) may take its
// place.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "impact_damper/engines/observer.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

class Recorder {
 public:
  // dampers: how many the scene has.
  explicit Recorder(Record record, std::size_t dampers = 1);

  bool wants_half_cycles() const { return wants_half_cycles_; }  // impact phases and windows need them too
  bool wants_contacts() const { return wants_.contacts; }
  bool wants_energy() const { return wants_.energy; }

  // Ends a row at `zero_crossing`. Impacts reported since the last row belong to this one.
  void half_cycle(double begin, double zero_crossing, double peak_time, double amplitude);
  // An impact on `wall` with y' = relative_velocity just before, while x = displacement.
  void impact(double time, Wall wall, double relative_velocity, double displacement, std::int32_t damper = 0);
  void contact(double begin, double end, Wall wall, std::int32_t damper = 0);

  // The time of the next history sample; infinity while none is known. A half cycle may open a window that
  // begins at its own zero crossing, so ask again after each.
  double next_sample() const { return next_sample_; }
  void sample(double time, double x, double v, double y, double w);
  void sample(double time, double x, double v, std::span<const PlaceInCavity> places);

  EnergyBalance& energy_balance() { return energy_balance_; }

  // Moves the columns into `run`.
  void finish(Run& run);

 private:
  void advance_window();

  Record wants_;
  bool wants_half_cycles_, wants_history_;
  HalfCycles half_cycles_;
  Impacts impacts_;
  Contacts contacts_;
  History history_;
  EnergyBalance energy_balance_;
  std::int64_t row_ = 0;
  std::vector<std::int64_t> impacts_in_row_;  // of each damper
  std::size_t first_impact_in_row_ = 0;
  std::vector<HistoryWindow> windows_;  // those known and not yet sampled to the end, ascending
  std::size_t window_ = 0;
  std::size_t next_below_ = 0;  // of wants_.history_below
  std::int64_t sample_in_window_ = 0;
  double next_sample_ = std::numeric_limits<double>::infinity();
};

}  // namespace impact_damper
