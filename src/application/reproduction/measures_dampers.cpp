// Measures of several dampers on one primary mass: whether they add, and over how wide a range of amplitude
// they damp alike.
#include <algorithm>
#include <cmath>
#include <vector>

#include "application/reproduction/measures.hpp"
#include "application/reproduction/measures_parts.hpp"
#include "impact_damper/analysis/damper_sets.hpp"

namespace impact_damper {
namespace {

std::vector<double> edges_of(const MeasureCall& call) {
  return descending_amplitudes(number(call, "to"), number(call, "from"), set_bins_in_decade);
}

// Returns the greatest mean loss factor between the amplitudes divided by the least.
double loss_ratio_of(Runs& runs, const MeasureCall& call) {
  const std::vector<double> losses = losses_between(runs.ensemble(call.scenes.front()), edges_of(call)).mean;
  const auto [least, greatest] = std::ranges::minmax(losses);
  return greatest / least;
}
Spread loss_ratio(Runs& runs, const MeasureCall& call) {
  const double ratio = loss_ratio_of(runs, call);
  return once(ratio);
}
Spread loss_variation_percent(Runs& runs, const MeasureCall& call) {
  const double ratio = loss_ratio_of(runs, call), percent = 100 * (ratio - 1) / (ratio + 1);
  return once(percent);
}

// Returns the ratio of the ends of the widest range of amplitudes in which every loss factor lies within the
// share `within` of the middle between the greatest and the least.
Spread alike_range(Runs& runs, const MeasureCall& call) {
  const std::vector<double> edges = edges_of(call),
                            losses = losses_between(runs.ensemble(call.scenes.front()), edges).mean;
  const double share = number(call, "within"), most = (1 + share) / (1 - share);
  double widest = 1;
  for (std::size_t first = 0; first < losses.size(); ++first) {
    double least = losses[first], greatest = losses[first];
    for (std::size_t k = first; k < losses.size(); ++k) {
      least = std::min(least, losses[k]);
      greatest = std::max(greatest, losses[k]);
      if (!(greatest <= most * least)) break;
      widest = std::max(widest, edges[first] / edges[k + 1]);
    }
  }
  return once(widest);
}

// Returns the difference between the loss factor of several dampers and the sum of theirs, divided by the
// sum, in the bins between the amplitudes: median, least and greatest.
Spread from_sum(Runs& runs, const MeasureCall& call) {
  const std::vector<double> edges = edges_of(call);
  const std::vector<Run>& together = runs.ensemble(call.scenes[0]);
  if (has_one_damper(together.front().scene))
    throw std::invalid_argument("measure from_sum: run " + call.scenes[0] + " is of one damper");
  const std::vector<double> losses = losses_between(together, edges).mean,
                            sum = sum_of_losses(together.front().scene.dampers,
                                                loss_alone(runs.ensemble(call.scenes[1])), edges);
  std::vector<double> differences;
  for (std::size_t k = 0; k < sum.size(); ++k) differences.push_back(losses[k] / sum[k] - 1);
  return spread_of(differences);
}

}  // namespace

std::vector<Measure> damper_measures() {
  std::vector<Measure> all{
      {"loss_ratio", loss_ratio,
       "greatest loss factor between two amplitudes divided by the least, in bins of a twelfth of a decade",
       numbers("from", "to")},
      {"loss_variation_percent", loss_variation_percent,
       "half the difference of greatest and least loss factor between two amplitudes, in percent of their "
       "mean, in bins of a twelfth of a decade",
       numbers("from", "to")},
      {"alike_range", alike_range,
       "widest range of amplitudes in which the loss factor is constant to a share either way, in bins of a "
       "twelfth of a decade: its upper end divided by the lower",
       numbers("from", "to", "within")},
      {"from_sum", from_sum,
       "loss factor of the dampers of the first run less the sum of what each would lose alone, by the "
       "second run, divided by the sum: median, least and greatest of the bins between two amplitudes",
       numbers("from", "to"), scenes(2, 2)},
  };
  for (Measure& each : all) each.takes_dampers = true;
  return all;
}

}  // namespace impact_damper
