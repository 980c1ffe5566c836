// Lyapunov exponents: at what rates small changes of the state grow or decay along a run.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "impact_damper/run.hpp"
#include "impact_damper/steady/poincare_map.hpp"

namespace impact_damper {

struct LyapunovExponents {
  StopReason stop_reason = StopReason::time;  // any other: of a period that could not be completed
  std::int64_t periods = 0;                   // of the force, over which the exponents are averaged
  // Per unit of time; their sum is the mean of ln|det A|, (M13.9) and (M13.26). In the order in which the
  // orthogonalisation finds them: descending, if there are enough periods. As many as the state has numbers:
  // four, of several dampers two and two for each. Two fewer for each mass that in these periods sticks while
  // most do, or that a sustained contact damps by more than exp(-36) 4096 times: these are minus infinity, or
  // too far below to be told. None unless all periods were completed.
  std::vector<double> exponents;
  // Of each: the standard deviation of the means of ten blocks of periods, divided by the root of ten. A
  // statistical uncertainty if the motion forgets within one block where it was. None for less than ten
  // periods.
  std::vector<double> standard_errors;
  // Whether several masses met walls at one instant in these periods. There is no derivative then: the
  // exponents are those of changes that keep them together. Not written to files.
  bool one_sided = false;
};

// From the scene's initial condition at phase 0, over `periods` >= 1 after the first `skipped` >= 0.
// `progress`, if given, is called with the number of periods, of all these, that are done. Throws
// InvalidArguments as PoincareMap does, of a scene with a list of dampers as ForcedScene does, and for more
// than most_dampers_with_changes.
LyapunovExponents lyapunov_exponents(const Scene& scene, const Engine& engine, std::int64_t periods,
                                     std::int64_t skipped = 0,
                                     const std::function<void(std::int64_t done)>& progress = {});

}  // namespace impact_damper
