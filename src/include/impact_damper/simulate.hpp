// The one entry point to the engines: a scene, an engine and what to record in, a run out. A pure function.
#pragma once

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Runs `scene` with `engine`, recording what `record` asks for.
// Throws
//   InvalidArguments, a std::invalid_argument that names every problem (base/errors.hpp), if the scene, the
//   engine's options or the record are not valid, or do not go together: y0 outside the cavity with rigid
//   walls, a time step beyond the stability limit, budgets that allow more than most_rows recorded rows;
//   NumericalError if the component element method overflows, or if the arithmetic of this process cannot
//   give the promised bits (base/floating_point.hpp).
// A run that reaches one of its budgets is no error: it ends there, and its stop_reason says so.
Run simulate(const Scene& scene, const Engine& engine, const Record& record);

}  // namespace impact_damper
