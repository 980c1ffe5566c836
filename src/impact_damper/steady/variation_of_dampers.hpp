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

// In how many pieces a motion is carried that contracts volumes by exp(-loss): each by e at most, so that
// orthogonalisation between them keeps the digits of all directions; but no more than most_pieces.
inline constexpr int most_pieces = 4096;
inline int pieces_of(double loss) { return loss < most_pieces ? 1 + int(loss) : most_pieces; }
// Whether a piece then contracts by more than exp(-36), a rounding error: the directions that it damps are
// lost.
inline bool is_lost(double loss) { return loss > 36.0 * most_pieces; }

struct Carried {
  // How many dimensions of the changes are lost: two for each mass that sticks, or whose wall damps a contact
  // so much that is_lost(), counted at the time when most masses do.
  std::size_t lost = 0;
  // Whether several masses met rigid walls at one instant. The derivative is then that of changes that keep
  // them together.
  bool one_sided = false;
};
// Replaces each change of a run's initial state by what it has become at the run's end. after_step() is
// called after each event and each motion, or piece of one: it may replace the changes by others that span
// the same directions. Required of the run: the engine exact or restitution, a scene with a list of dampers
// and a force, the end at its until_time, and impacts and contacts recorded.
Carried carry_changes(const Run& run, std::vector<ChangeOfState>& changes,
                      const std::function<void()>& after_step);

}  // namespace impact_damper
