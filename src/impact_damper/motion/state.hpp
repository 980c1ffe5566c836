// The state of both masses, and what ends a motion.
#pragma once

#include <optional>

#include "impact_damper/run.hpp"

namespace impact_damper {

// x, x', y, y'.
template <class Real>
struct State {
  Real x, v, y, w;
};
// A copy, number by number. As a block it would be loaded in pairs, and each pair wait until its two numbers,
// stored one by one just before, have reached the cache: each motion, a few nanoseconds for the one before.
template <class Real>
State<Real> copied(const State<Real>& s) {
  return {s.x, s.v, s.y, s.w};
}

// x - (x0 + x'0 t) and x' - x'0, since the beginning of a motion.
template <class Real>
struct ChangeOfX {
  Real dx, dv;
};

// Where and when the secondary mass meets a wall, or leaves it.
template <class Real>
struct WallEvent {
  Real time;
  Wall wall;
  State<Real> state;
  std::optional<ChangeOfX<Real>> change{};  // of a flight
};

}  // namespace impact_damper
