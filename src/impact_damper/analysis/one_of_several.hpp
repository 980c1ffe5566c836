// One damper's part of a run with several, as a run of one damper: functions for scenes with one damper then
// apply to each by itself.
#pragma once

#include <cstddef>

#include "impact_damper/run.hpp"

namespace impact_damper {

// The run's half cycles, impacts, contacts and history, as far as they were recorded, with the impacts of the
// damper `number` (from 0, of those of the scene) alone, and lengths and velocities divided by its clearance
// instead of epsilon. Its scene is that damper alone on the primary mass, with the same initial condition. It
// has no energies, as it lacks the losses of the other dampers.
Run run_of_damper(const Run& run, std::size_t number);

}  // namespace impact_damper
