// What small changes of the state become along a run of several dampers, in linear approximation
// (docs/mathematics.md, 13.10). It takes the run's record alone: motions are linear, and events are told.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "impact_damper/run.hpp"

namespace impact_damper {

// Of x, x', then y and y' of each damper by number in the scene; divided as in run.hpp.
using ChangeOfState = std::vector<double>;
inline std::size_t dimensions_of(const Scene& scene) { return 2 + 2 * scene.dampers.size(); }

// Carries each of the changes of a run's initial state to its end. after_step() is called after each event
// and each motion, or piece of one that contracts volumes by e at most: there the changes may be replaced by
// others that span the same. The run, by the engine exact or restitution, of a scene with a list of dampers
// and a force, has got to its until_time and has impacts and contacts recorded.
struct Carried {
  // How many dimensions the changes lose to masses that stick, or that a wall damps by more than exp(-36)
  // 4096 times while it is pushed: two for each that does so at the same time.
  std::size_t lost = 0;
  // Whether several masses met rigid walls at one instant. The derivative is then that of changes that keep
  // them together.
  bool one_sided = false;
};
Carried carry_changes(const Run& run, std::vector<ChangeOfState>& changes,
                      const std::function<void()>& after_step);

}  // namespace impact_damper
