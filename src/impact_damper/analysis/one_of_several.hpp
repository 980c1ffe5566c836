// A run of several dampers as one of them sees it: what is written for a scene with one damper then tells of
// each by itself.
#pragma once

#include <cstddef>

#include "impact_damper/run.hpp"

namespace impact_damper {

// The run's half cycles, impacts, contacts and history, as far as they were recorded, with the impacts of the
// damper `number` (from 0, of those of the scene) alone, and lengths and velocities divided by its clearance
// instead of epsilon. Its scene is that damper alone on the primary mass, released in the same way. No
// energies: what the others take is not known to it.
Run run_of_damper(const Run& run, std::size_t number);

}  // namespace impact_damper
