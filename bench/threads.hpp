// What a second processor brings: an ensemble of decays on two threads against one, by the clock on the wall.
// How much it could bring differs from machine to machine and from minute to minute, where a processor is
// half a core or somebody else's, too: two ensembles side by side, each on a thread of its own, share nothing
// else. The repeats that count are those next to which these got 1.9 cores, if they are nine or more.
#pragma once

#include <cstdint>

#include "timing.hpp"

namespace impact_damper::bench {

struct Speedup {
  std::int64_t members = 0;
  Spread one, two;      // seconds
  Spread ratio;         // of repeats taken in turn
  Spread side_by_side;  // twice the work in the time of two ensembles at once, by that of one
  int repeats = 0, on_two_cores = 0;
};
Speedup measure_speedup(int repeats);

}  // namespace impact_damper::bench
