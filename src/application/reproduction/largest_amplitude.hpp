// The amplitude that represents several steady motions under the same force: Figure D and its claims.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "impact_damper/responses/response_file.hpp"

namespace impact_damper {

using SweepWay = std::vector<SteadyState> Sweep::*;

// Returns the largest amplitude of the motions of one way at the axis's value of index `i`, in the `n`-th
// sweep of each response; all have the same values. NaN if one of them has no amplitude, which may be the
// largest.
inline double largest_amplitude(const std::vector<const SweepResponse*>& responses, std::size_t n,
                                SweepWay way, std::size_t i) {
  double largest = 0;
  for (const SweepResponse* response : responses) {
    const SteadyState& steady = (response->sweeps.at(n).*way).at(i);
    if (!steady.means) return std::numeric_limits<double>::quiet_NaN();
    largest = std::max(largest, steady.means->amplitude);
  }
  return largest;
}

}  // namespace impact_damper
