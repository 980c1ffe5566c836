// Events that pass phase 0 of the force along a branch of orbits, where the states of the branch are taken:
// an impact, or with compliant walls a touch or the end of a contact (docs/mathematics.md, 13.6). The
// predictor does not know of them; this takes a predicted state across.
#pragma once

#include <optional>
#include <vector>

#include "impact_damper/orbits/poincare_map.hpp"

namespace impact_damper {

// A state that has been taken across events.
struct Crossing {
  StateVector state;
  // For each event that has passed, in their order, the derivative of the state after it by the state before,
  // a saltation matrix or its inverse. Their product, the last one leftmost, is the derivative of all. Empty
  // if none has passed.
  std::vector<StateMatrix> by_state;
};
// Takes s across the events that passed phase 0 between `before` and s. s is predicted to first order from
// `before`, a state of the branch; both have as many numbers as the scene's state. The engine is exact or
// restitution.
//   Rigid walls: each mass of s that lies beyond a wall is taken across its impact, forwards if it moves into
//   the wall, else backwards. y and y' of a mass that rests on a wall to within rounding become exact.
//   Returns nothing where an impact with e = 0 would have to be undone, and where an impact has to be crossed
//   while a mass of s rests on a wall.
//   Compliant walls: each mass that is in contact in one of s and `before` and not in the other is taken
//   across the touch, or the end of the contact.
std::optional<Crossing> across_phase_0(const Scene& scene, const Engine& engine, const StateVector& before,
                                       const StateVector& s);

}  // namespace impact_damper
