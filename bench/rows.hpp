// What a contender delivers: half cycles as HalfCycles (run.hpp) has them. (C++17 is enough, for peers whose
// headers know no more.)
#pragma once

#include <cstdint>
#include <vector>

namespace impact_damper::bench {

struct Rows {
  std::vector<double> zero_crossing, peak_time, amplitude;
  std::int64_t impacts = 0;  // met in all, those after the last row too where they are counted
};

}  // namespace impact_damper::bench
