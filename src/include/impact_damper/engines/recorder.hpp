// The observer of the program: it keeps what a Record asks for, as columns.
//
// An engine is a template over its observer: anything that is a RunObserver (observer.hpp) may take its
// place.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "impact_damper/engines/observer.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// The motions of a run by a closed-form engine, and the events between them, in the order of time. Each event
// has the number of motions before it.
struct MotionChain {
  struct Motion {
    double begin, duration;
    double x, v;  // at its end, before the event there
  };
  struct Impact {
    std::size_t motions;
    double time;
    Wall wall;
    double w;  // y' just before
    std::int32_t damper;
  };
  struct Contact {        // as in Contacts
    std::size_t motions;  // before its end
    double begin, end;
    Wall wall;
    std::int32_t damper;
  };
  // With friction, weight or drag: of each damper, when the run begins and after each event (observer.hpp).
  struct Settled {
    std::size_t motions;
    std::int32_t damper;
    PlaceInCavity place;
    bool held;
    double slides;
    bool pushes;
  };
  std::vector<Motion> motions;
  std::vector<Impact> impacts;
  std::vector<Contact> contacts;
  std::vector<Settled> settled;
};

class Recorder {
 public:
  // dampers: how many the scene has. chain: filled in if not null; unlike the impacts of a Record it needs no
  // half cycles.
  explicit Recorder(Record record, std::size_t dampers = 1, MotionChain* chain = nullptr);

  bool wants_half_cycles() const { return wants_half_cycles_; }  // impact phases and windows need them too
  bool wants_contacts() const { return wants_.contacts || chain_; }
  bool wants_energy() const { return wants_.energy; }

  // Ends a row at `zero_crossing`. Impacts reported since the last row belong to this one.
  void half_cycle(double begin, double zero_crossing, double peak_time, double amplitude);
  // An impact on `wall` with y' = relative_velocity just before, while x = displacement.
  void impact(double time, Wall wall, double relative_velocity, double displacement, std::int32_t damper = 0);
  void contact(double begin, double end, Wall wall, std::int32_t damper = 0);
  void passed(double begin, double duration, const State<double>& end) {
    if (chain_) chain_->motions.push_back({begin, duration, end.x, end.v});
  }
  void settled(std::int32_t damper, const PlaceInCavity& place, bool held, double slides, bool pushes) {
    if (chain_) chain_->settled.push_back({chain_->motions.size(), damper, place, held, slides, pushes});
  }

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
  MotionChain* chain_;
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
