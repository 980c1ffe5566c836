// Curves that figures and measures share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "impact_damper/responses/response_file.hpp"

namespace impact_damper {

struct Curve {
  std::vector<double> x, y;

  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
};

using SweepWay = std::vector<SteadyState> Sweep::*;

// Returns for each start the curve that represents several steady motions under the same force: the largest
// amplitude of the motions of one way at each value of the axis. All responses have the same values and
// equally many starts. NaN where one of them has no amplitude, which may be the largest.
inline std::vector<Curve> largest_amplitudes(const std::vector<const SweepResponse*>& responses,
                                             SweepWay way) {
  const std::vector<double> values = responses.front()->axis.values();
  std::vector<Curve> curves(responses.front()->sweeps.size());
  for (std::size_t n = 0; n < curves.size(); ++n) {
    const auto largest_at = [&](std::size_t i) {
      double largest = 0;
      for (const SweepResponse* response : responses) {
        const SteadyState& steady = (response->sweeps.at(n).*way).at(i);
        if (!steady.means) return std::numeric_limits<double>::quiet_NaN();
        largest = std::max(largest, steady.means->amplitude);
      }
      return largest;
    };
    for (std::size_t i = 0; i < values.size(); ++i) curves[n].add(values[i], largest_at(i));
  }
  return curves;
}

}  // namespace impact_damper
