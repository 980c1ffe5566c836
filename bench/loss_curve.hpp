// The error of a chaotic decay. No amplitude of it can be compared, but what comes of it: the averaged loss
// factor as a curve over the amplitude, held against the mean curve of an ensemble.
#pragma once

#include <optional>
#include <vector>

#include "contender.hpp"
#include "impact_damper/engine.hpp"

namespace impact_damper::bench {

// The loss factor (averaged over 10 half cycles) at 60 amplitudes from 5 down to 0.1, equally spaced in their
// logarithm: where the decay first falls through each, between the two rows beside it. Absent if one of them
// is not passed or the rows are not valid.
std::optional<std::vector<double>> loss_curve(const std::vector<double>& peak_time,
                                              const std::vector<double>& amplitude);

// How many releases make one curve of a contender. One decay's own scatter, 0.011, hides what its method does
// to it; that of their mean is 0.001. (Of their median it is half as large again: where the motion has two
// ways to go on, the median jumps from one to the other.)
inline constexpr int releases = 128;

// At each of the amplitudes the mean of the curves, of which there must be one.
std::vector<double> mean_curve(const std::vector<std::vector<double>>& curves);

struct EnsembleCurve {
  std::vector<double> mean;  // eta, at each of the amplitudes
  // Errors of its own groups of so many releases: quartiles, median.
  double lower = 0, scatter = 0, upper = 0;

  // An error up to this may be sampling scatter.
  double scatter_limit() const { return 2 * upper; }
};
// Of seven groups. Throws std::logic_error if a decay does not pass all the amplitudes.
EnsembleCurve ensemble_curve(const Scene& scene, const Engine& engine);

// Root mean square over the amplitudes of eta / mean - 1.
double curve_error(const EnsembleCurve& ensemble, const std::vector<double>& curve);

}  // namespace impact_damper::bench
