// When the amplitude of a run has come below a bound.
#pragma once

#include <optional>

#include "impact_damper/run.hpp"

namespace impact_damper {

// In units of 1/Omega_n; absent if the run does not get there. Of a motion that swings it is the time of the
// peak of the first half cycle below `amplitude` > 0. Where a half cycle leaves less than a tenth of the
// amplitude before it, or the motion creeps back to zero, peaks say little: then it is the last time at which
// |x| is as large as `amplitude`, found in the same motion, simulated again. (M15.13) says that it is the
// last if no half cycle below it is complete. Needs half_cycles; throws what simulate() throws.
std::optional<double> time_below(const Run& run, double amplitude);

}  // namespace impact_damper
