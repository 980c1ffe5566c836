// How much several dampers lose together: the loss factor between two amplitudes, and the sum of what each
// damper would lose alone (docs/mathematics.md, 17.6). Amplitudes are divided by the scene's epsilon.
#pragma once

#include <vector>

#include "impact_damper/run.hpp"

namespace impact_damper {

// Amplitudes from `from` down to `to`, equally spaced in the logarithm, at least `in_decade` of them in each
// decade; from > to > 0.
std::vector<double> descending_amplitudes(double from, double to, int in_decade);

// In the bins of figures and claims several half cycles of each decay lie.
inline constexpr int set_bins_in_decade = 12;

// The loss factor eta between each two neighbours of `edges`, which descend and are > 0, one entry less than
// edges (M17.12): from the time that the peaks take from the one to the other. 0 where they do not come down
// to the lower one before the run ends, NaN where they begin below the upper one.
std::vector<double> losses_between(const HalfCycles& half_cycles, const std::vector<double>& edges);
// The same from the mean of the times that several runs take, entry by entry, and the least and greatest of
// single runs. Each needs half_cycles.
struct LossSpread {
  std::vector<double> mean, low, high;
};
LossSpread losses_between(const std::vector<Run>& runs, const std::vector<double>& edges);

// What one damper does alone: eta/nu over the amplitude divided by its clearance, constant between two edges.
struct LossAlone {
  std::vector<double> edges;     // descending
  std::vector<double> specific;  // eta/nu, one entry less

  // 0 below the last edge, NaN above the first.
  double at(double amplitude) const;
};
// From releases of one scene with one damper, by the mean of their times. Its edges are at most a
// forty-eighth of a decade apart, from the release down to the scene's until_amplitude. Throws
// std::invalid_argument if `runs` is empty, of several dampers or without that amplitude, or lacks
// half_cycles.
LossAlone loss_alone(const std::vector<Run>& runs);

// eta between each two neighbours of `edges` if these dampers add: (M17.13). NaN where an amplitude is above
// the first edge of `alone`, 0 where nothing is lost.
std::vector<double> sum_of_losses(const std::vector<SceneDamper>& dampers, const LossAlone& alone,
                                  const std::vector<double>& edges);

}  // namespace impact_damper
