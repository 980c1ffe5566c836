// What a sweep (docs/sweeps.md) needs for a run, beside what the engine alone needs for it, on one thread and
// on two. Rows only, which are what takes time: a share's digests and the disk are not in it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "timing.hpp"

namespace impact_damper::bench {

struct ManyRuns {
  std::string kept;       // "times and counts"
  double bound = 0;       // minutes that a million decays may take on two threads
  std::int64_t runs = 0;  // of a repeat
  int repeats = 0;
  // Seconds by the clock on the wall: the engine alone and the rows, on one thread; the rows on two.
  Spread engine, one, two;
  // Of repeats taken in turn, as parts of the engine's time: the analysis of the runs that the quantities ask
  // for, by itself; and what one thread's rows take beside engine and analysis.
  Spread analysis, overhead;
  Spread ratio;  // one thread's by two threads'

  double million_minutes() const { return two.median / double(runs) * 1e6 / 60; }
};
std::vector<ManyRuns> measure_many_runs(int repeats);

}  // namespace impact_damper::bench
