// How near the motion of a run comes to a wall without meeting it.
#pragma once

#include <optional>

#include "impact_damper/orbits/variational_equations.hpp"

namespace impact_damper {

// Returns the least distance from a wall at which a mass turns back in flight; nothing if none does.
std::optional<double> nearest_miss(const VariationalCoefficients& of, const RecordedRun& run);

}  // namespace impact_damper
