// The door to the engines: a scene, an engine and a wish in, a run out. A pure function.
#pragma once

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Runs `scene` with `engine`, recording what `record` asks for.
// Throws std::invalid_argument naming every problem if the scene, the engine's options or the record
// are not valid (an unstable time step of the component element method among them), and NumericalError
// (base/errors.hpp) where that method overflows, where a closed form's next event is too long to search for
// (no call takes more than a few seconds with the default budget), and where this process's arithmetic cannot
// give the promised bits (base/floating_point.hpp).
Run simulate(const Scene& scene, const Engine& engine, const Record& record);

}  // namespace impact_damper
