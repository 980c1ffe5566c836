// The limits of every search for an event, and the counter of what it does.
#pragma once

#include <cstdint>
#include <limits>

namespace impact_damper {

// The limits of the searches of one run. Where a motion is so stiff, or so long, that its bounds hold for a
// very short time only, the search for its next event would not end without a step budget.
template <class Real>
struct Search {
  Real span;  // > 0: the bounds on derivatives that a step uses hold for this long
  // The remaining steps of searches (root_isolation.hpp) and panels of quadratures (energy.hpp), at about a
  // microsecond each.
  std::int64_t steps_left = std::numeric_limits<std::int64_t>::max();

  // Returns false if no step is left. The search then finds nothing, and the run ends by
  // StopReason::step_budget (run_tracker.hpp).
  bool take_step() { return steps_left-- > 0; }
  bool exhausted() const { return steps_left < 0; }
};

// How the end of a motion was found (docs/mathematics.md, 7.8).
enum class FoundBy {
  series,      // a flight, by the series at its beginning
  correction,  // a flight, by the closed form evaluated near its end
  search,      // a flight, step by step
  short_contact_map,
  slow_mode,       // a sustained contact
  contact_search,  // a contact, step by step
};
inline constexpr int ways_to_find = 6;

// Called at each step of a search. A scalar that counts specializes it; for any other it does nothing.
template <class Real>
struct SearchCounter {
  static void prediction() {}  // of a flight's end, impact_prediction.hpp
  static void correction() {}  // of a predicted time, by one evaluation of the motion
  static void search() {}      // by Lemma L1, root_isolation.hpp
  static void evaluation() {}  // of the functions that a search watches
  static void step() {}        // of a search, for each function
  static void found(FoundBy) {}
};

}  // namespace impact_damper
