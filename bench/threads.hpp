// What a second processor brings: an ensemble of decays on two threads against one, by the clock on the wall.
#pragma once

#include <cstdint>

#include "timing.hpp"

namespace impact_damper::bench {

struct Speedup {
  std::int64_t members = 0;
  Spread one, two;  // seconds
  Spread ratio;     // of repeats taken in turn
  int repeats = 0;
};
Speedup measure_speedup(int repeats);

}  // namespace impact_damper::bench
