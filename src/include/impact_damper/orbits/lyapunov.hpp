// Lyapunov exponents: the mean exponential rates at which small changes of the state grow or decay along a
// run, from its variational equations (docs/mathematics.md, 13.7).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "impact_damper/orbits/poincare_map.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

struct LyapunovExponents {
  StopReason stop_reason = StopReason::time;  // any other: why a period could not be completed
  std::int64_t periods = 0;                   // of the force, over which the exponents are averaged
  // Per unit of time; their sum is the mean of ln|det A|, (M13.9), (M13.26) and (M13.34). In the order in
  // which the orthogonalisation finds them: descending, if there are enough periods. One for each component
  // of the state: four, with a list two and two for each damper. Two fewer for each mass that sticks at the
  // time at which most masses do, or that a sustained contact damps by more than exp(-36) 4096 times: these
  // are minus infinity, or too low to be determined. None unless all periods were completed.
  std::vector<double> exponents;
  // Standard error of each: the standard deviation of the means of ten blocks of periods, divided by the
  // square root of ten. It assumes that the motion forgets its state within one block. None for less than ten
  // periods.
  std::vector<double> standard_errors;
  // Whether several masses met rigid walls at one instant in these periods, or with friction other events
  // coincided. There is no derivative then: the exponents are those of changes that keep them together. Not
  // written to files.
  bool one_sided = false;
};

// The exponents of the motion from the scene's initial condition at phase 0, over `periods` >= 1 after the
// first `skipped` >= 0. `progress`, if given, is called with the number of periods, of all these, that are
// done. Throws InvalidArguments as PoincareMap does, for a scene with a list of dampers as ForcedScene does,
// and for more than most_dampers_with_changes.
LyapunovExponents lyapunov_exponents(const Scene& scene, const Engine& engine, std::int64_t periods,
                                     std::int64_t skipped = 0,
                                     const std::function<void(std::int64_t done)>& progress = {});

}  // namespace impact_damper
