// Along a branch of orbits an impact, or with compliant walls a touch or the end of a contact, may pass phase
// 0 of the force, the instant at which a branch has its states (docs/mathematics.md, 13.6).
#pragma once

#include <optional>
#include <vector>

#include "impact_damper/steady/poincare_map.hpp"

namespace impact_damper {

// What becomes of a state where events pass phase 0.
struct Crossing {
  StateVector state;
  // For each event that has passed, in their order, the derivative of the state behind it by the state
  // before: the last times the others is that of all. Empty if none has passed.
  std::vector<StateMatrix> by_state;
};
// s is predicted to first order from `before`, a state of the branch; both have as many numbers as the
// scene's state. The engine is exact or restitution.
//   Rigid walls: each mass of s that lies beyond a wall is taken across its impact, forwards if it moves into
//   the wall, else backwards. y and y' of a mass that rests on a wall but for rounding become exact. Nothing
//   is returned where an impact would have to be undone that leaves no speed (e = 0), and where any has to be
//   crossed while a mass of s rests on a wall.
//   Compliant walls: each mass that is in contact in one of s and `before` and not in the other is taken
//   across the touch, or the end of the contact.
std::optional<Crossing> across_phase_0(const Scene& scene, const Engine& engine, const StateVector& before,
                                       const StateVector& s);

}  // namespace impact_damper
