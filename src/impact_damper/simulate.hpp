// The one entry point to the engines: a scene, an engine and what to record in, a run out. A pure function.
#pragma once

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Runs `scene` with `engine`, recording what `record` asks for.
// Throws InvalidArguments, a std::invalid_argument that names every problem (base/errors.hpp), if the scene,
// the engine's options or the record are not valid (an unstable time step of the component element method
// among them), and NumericalError where that method overflows, and where this process's arithmetic cannot
// give the promised bits (base/floating_point.hpp). A search that uses up its steps is no error: the run ends
// there, with StopReason::step_budget.
Run simulate(const Scene& scene, const Engine& engine, const Record& record);

}  // namespace impact_damper
