// What an impact costs, everything included, against the number of impacts, the wall's stiffness and the
// restitution; the residual of the energy balance beside it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "timing.hpp"

namespace impact_damper::bench {

struct SweepPoint {
  double at = 0;  // number of impacts asked for, k or e
  std::int64_t impacts = 0, half_cycles = 0;
  Timing timing;        // of the whole run, half cycles observed and not kept
  double residual = 0;  // of the energy balance of the same run once more, relative

  double cost() const { return timing.reference_operations.median / double(impacts); }
};

struct Sweep {
  std::string engine;
  std::string against;  // "impacts", "stiffness", "restitution"
  std::string what;     // in words
  std::vector<SweepPoint> points;
};

//   impacts      e = 1, released at x0 = 6, stopped after 1e2, 1e3, ... 1e7 impacts
//   stiffness    the decay from 6 to 0.5 with e = 0.6, k = 1e2, 1e3, ... 1e10 (exact only)
//   restitution  the same with e = 0, 0.1, ... 0.9, 0.99, 20000 impacts at most
// At 0.5 no e has its impact failure yet: half cycles without an impact cost time too.
// `told` hears what is measured next.
std::vector<Sweep> measure_sweeps(double most_impacts, const std::function<void(const std::string&)>& told);

}  // namespace impact_damper::bench
