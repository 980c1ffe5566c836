// The variational equations along a run with a list of dampers: what small changes of the state become, to
// first order (docs/mathematics.md, 13.10). They need the run's record alone: between events motions are
// linear, and events are recorded.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "impact_damper/run.hpp"

namespace impact_damper {

// Changes of x, x', then y and y' of each damper by number in the scene; divided as in run.hpp.
using ChangeOfState = std::vector<double>;
constexpr std::size_t index_of_y(std::size_t damper) { return 2 + 2 * damper; }
constexpr std::size_t index_of_w(std::size_t damper) { return 3 + 2 * damper; }
inline std::size_t dimensions_of(const Scene& scene) { return 2 + 2 * scene.dampers.size(); }

// The number of pieces for a motion that contracts volumes by exp(-loss): each contracts by e at most, so
// that orthogonalisation between them keeps the digits of all directions, unless there would be more than
// most_pieces.
inline constexpr int most_pieces = 4096;
inline int pieces_of(double loss) { return loss < most_pieces ? 1 + int(loss) : most_pieces; }
// Whether even most_pieces pieces contract by more than exp(-36) each, a rounding error: directions are lost.
inline bool is_lost(double loss) { return loss > 36.0 * most_pieces; }

struct Carried {
  // Largest number of dimensions lost at one time: two for each mass that sticks, or whose contact is_lost().
  std::size_t lost = 0;
  // Whether several masses met rigid walls at one instant. The derivative is then that of changes that keep
  // them together.
  bool one_sided = false;
};
// The derivatives of the final state by omega_f and by f0, its rates, and the nearest miss of the run's
// flights.
struct AlongRun {
  ChangeOfState by_frequency, by_amplitude;
  ChangeOfState rates_at_end;  // x', x'', then y' and y'' of each damper, before what happens at that instant
  // Rigid walls: the least distance from a wall at which a mass turns back in flight.
  std::optional<double> nearest_miss;
};
// Solves the variational equations: replaces each change of a run's initial state by what it has become at
// the run's end. after_step() is called after each event and each motion, or piece of one: it may replace the
// changes by others that span the same directions. `along` is filled in if it is not null. Required of the
// run: the engine exact or restitution, a scene with a list of dampers and a force, the end at its
// until_time, impacts and contacts recorded, and with `along` a sample at the end as the last of its history.
Carried carry_changes(const Run& run, std::vector<ChangeOfState>& changes,
                      const std::function<void()>& after_step, AlongRun* along = nullptr);

}  // namespace impact_damper
