// How near the motion of a run comes to a wall without meeting it.
#pragma once

#include <optional>

#include "impact_damper/orbits/variational_equations.hpp"

namespace impact_damper {

// Returns the least distance from a wall, divided as in run.hpp, at which a mass turns back in flight: y'
// changes its sign there without an impact (docs/mathematics.md, 13.10). Nothing if no mass does.
std::optional<double> nearest_miss(const VariationalCoefficients& of, const RecordedRun& run);

}  // namespace impact_damper
