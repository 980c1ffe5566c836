// The time at which the amplitude of a run has come below a bound.
#pragma once

#include <optional>

#include "impact_damper/run.hpp"

namespace impact_damper {

// The time, in units of 1/Omega_n; absent if the run does not get there. In an oscillation it is that of the
// peak of the first half cycle below `amplitude` > 0. Where a half cycle leaves less than a tenth of the
// amplitude before it, or the motion creeps back to zero, it is the last time at which |x| is as large as
// `amplitude`, found by simulating the same motion again. (M15.13) shows that it is the last if no half cycle
// below it is complete. Needs half_cycles; throws what simulate() throws.
std::optional<double> time_below(const Run& run, double amplitude);

}  // namespace impact_damper
