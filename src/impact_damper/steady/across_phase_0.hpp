// Along a branch of orbits an impact, or with compliant walls a touch or the end of a contact, may pass phase
// 0 of the force, at which states are taken (docs/mathematics.md, 13.6).
#pragma once

#include <optional>
#include <vector>

#include "impact_damper/steady/poincare_map.hpp"

namespace impact_damper {

// A state on the other side of such events, and the derivative of each by the state before it; none if
// nothing has passed.
struct Crossing {
  StateVector state;
  std::vector<StateMatrix> by_state;
};
// s: predicted from `before`, a state of the branch, to first order. With rigid walls it may lie beyond a
// wall, and is taken across the impact; masses at rest on a wall are put there to the bit. With compliant
// walls it is taken across what lies between the two. Nothing where that is not possible: an impact that a
// plastic wall (e = 0) would have to undo, or while other masses rest on rigid walls.
std::optional<Crossing> across_phase_0(const Scene& scene, const Engine& engine, const StateVector& before,
                                       const StateVector& s);

}  // namespace impact_damper
