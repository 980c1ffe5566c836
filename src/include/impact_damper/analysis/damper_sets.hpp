// The loss of several dampers: the loss factor between two amplitudes, and the sum of the losses that each
// damper would have alone (docs/mathematics.md, 17.6). Amplitudes are peaks |x|, divided by the scene's
// epsilon, as the clearances of its dampers are; any other length for both gives the same numbers. nu is a
// damper's mass divided by the primary mass, eta the loss factor per radian, of viscous damping 2 zeta.
#pragma once

#include <vector>

#include "impact_damper/run.hpp"

namespace impact_damper {

// Amplitudes from `from` down to `to`, both included, equally spaced in the logarithm, at least `in_decade`
// intervals to a decade. Nothing is checked: from > to > 0, in_decade >= 1.
std::vector<double> descending_amplitudes(double from, double to, int in_decade);
// The intervals that figures and claims average over: at the loss factors there, up to a tenth, each takes
// some half cycles.
inline constexpr int set_bins_in_decade = 12;

// eta between each two neighbours of `edges` (M17.12), one entry less than edges, which descend and are > 0:
// that of the viscous damping with which the peaks would take the same time from the one to the other. All
// that takes energy counts, viscous damping, too. Between peaks the logarithm of the amplitude is linear in
// time. 0 where the peaks have not come down to the lower edge when the run ends, whether it is short or
// nothing is lost; NaN where the first peak is below the upper edge.
std::vector<double> losses_between(const HalfCycles& half_cycles, const std::vector<double>& edges);
// The same for several runs, entry by entry: `mean` from the mean of their times, `low` and `high` the least
// and greatest of single runs. One 0 makes the mean 0, one NaN makes all three NaN. Throws
// std::invalid_argument if there is no run or one did not record half_cycles.
struct LossSpread {
  std::vector<double> mean, low, high;
};
LossSpread losses_between(const std::vector<Run>& runs, const std::vector<double>& edges);

// The loss of one damper alone: eta/nu as a function of the amplitude divided by its clearance, constant
// between two edges.
struct LossAlone {
  std::vector<double> edges;     // descending
  std::vector<double> specific;  // eta/nu, one entry less; an edge belongs to the interval above it

  // eta/nu at an amplitude: 0 below the last edge, where nothing was measured; NaN above the first.
  double at(double amplitude) const;
};
// Measures eta/nu from runs of one scene with one damper and slightly different releases, which is not
// checked, by the mean of their times. The edges are at most a forty-eighth of a decade apart, from the least
// of the first peaks down to the until_amplitude of the first run's scene. Throws std::invalid_argument if
// `runs` is empty, if the first is of several dampers or its scene has no until_amplitude, or if one lacks
// half_cycles.
LossAlone loss_alone(const std::vector<Run>& runs);

// eta between each two neighbours of `edges`, which descend, if these dampers do not disturb each other:
// (M17.13), without viscous damping. NaN where any amplitude divided by a clearance is above the first edge
// of `alone`, else 0 where none of them loses anything at an amplitude between the two edges.
std::vector<double> sum_of_losses(const std::vector<SceneDamper>& dampers, const LossAlone& alone,
                                  const std::vector<double>& edges);

}  // namespace impact_damper
