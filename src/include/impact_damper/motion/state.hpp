// The state of both masses, and the events that end a motion.
#pragma once

#include <optional>

#include "impact_damper/run.hpp"

namespace impact_damper {

// x, x', y, y'.
template <class Real>
struct State {
  Real x, v, y, w;
};
// Returns a copy made number by number. A block copy loads the numbers in pairs, and waits until both numbers
// of a pair, stored one by one just before, have reached the cache: a few nanoseconds in each motion.
template <class Real>
State<Real> copied(const State<Real>& s) {
  return {s.x, s.v, s.y, s.w};
}

// x - (x0 + x'0 t) and x' - x'0, since the beginning of a motion.
template <class Real>
struct ChangeOfX {
  Real dx, dv;
};

// x and x' with that.
template <class Real>
struct Displacement {
  Real x, v, dx, dv;
};

// An impact on a wall, or the end of a contact.
template <class Real>
struct WallEvent {
  Real time;
  Wall wall;
  State<Real> state;
  std::optional<ChangeOfX<Real>> change{};  // of a flight
};

}  // namespace impact_damper
