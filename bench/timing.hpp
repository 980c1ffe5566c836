// Run times in process: repeated, with their spread, and beside a reference operation measured in between.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace impact_damper::bench {

// Median and quartiles (elements of the sample, not interpolated).
struct Spread {
  double lower = 0, median = 0, upper = 0;
};
Spread spread_of(std::vector<double> sample);

// CPU seconds of one call of the C library's sincos, in a chain in which each call waits for the one before.
double reference_operation();

struct Timing {
  Spread seconds;               // CPU time of one run
  Spread reference_operations;  // each repeat by the mean of the reference operations before and after it
  Spread reference_operation;   // seconds
  int repeats = 0, undisturbed = 0;  // in all, and those on a core of one's own (timing.cpp)
  int runs = 0;                      // in each repeat
};
// Each repeat lasts a fiftieth of a second at least. A first run, not counted, tells how many runs make one
// repeat; whoever has made it already says how many CPU seconds it took. Where a neighbour disturbs, repeats
// are added, for three seconds at most, until as many as asked for are undisturbed; these are then taken.
Timing measure(const std::function<void()>& run, int repeats, std::optional<double> first = {});
// How many seconds all measure() may add; until told, none.
void add_repeats_for(double seconds);

// CPU time of this thread, not wall time: what others do on the machine is not the contender's.
double cpu_seconds(const std::function<void()>& work);

}  // namespace impact_damper::bench
