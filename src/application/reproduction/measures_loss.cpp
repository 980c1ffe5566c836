// Measures on the curves of the averaged loss factor, on the losses of several dampers, and on what friction
// and drag take of the energy.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "application/reproduction/measures_parts.hpp"
#include "impact_damper/analysis/damper_sets.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

Curve loss_curve(const Run& run, LossOrdinate which, const LossFactorOptions& fit, double from, double to,
                 FirstPoint first) {
  const LossFactor loss = averaged_loss_factor(half_cycles_of(run), fit);
  const std::vector<double> y = ordinate(loss, run.scene, which);
  Curve curve;
  for (std::size_t i = first == FirstPoint::counted ? 0 : 1; i < y.size(); ++i)
    if (loss.amplitude[i] >= from && loss.amplitude[i] <= to) curve.add(loss.amplitude[i], y[i]);
  return curve;
}

Curve loss_curve(const Asked& asked, const Run& run, LossOrdinate which, FirstPoint first) {
  return loss_curve(run, which, asked.analysis().loss, asked.number("from"), asked.number("to"), first);
}

double slope(const Curve& curve) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double x = curve.x[i], y = curve.y[i];
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double log_slope(Curve curve) {
  for (auto* column : {&curve.x, &curve.y})
    for (double& value : *column) value = logarithm(value);
  return slope(curve);
}

std::vector<std::vector<double>> bin_means(const std::vector<Curve>& curves, double from, double to,
                                           int bins) {
  const double width = logarithm(to / from) / bins;
  std::vector<std::vector<double>> all;
  for (int bin = 0; bin < bins; ++bin) {
    const double low = from * exponential(width * bin), high = from * exponential(width * (bin + 1));
    std::vector<double> means;
    for (const Curve& curve : curves) {
      std::vector<double> within;
      for (std::size_t i = 0; i < curve.x.size(); ++i)
        if (curve.x[i] >= low && curve.x[i] < high) within.push_back(curve.y[i]);
      if (!within.empty()) means.push_back(mean(within));
    }
    if (means.size() == curves.size()) all.push_back(means);
  }
  return all;
}

std::vector<double> spreads_percent(const std::vector<Curve>& curves, double from, double to, int bins) {
  std::vector<double> spreads;
  for (const std::vector<double>& means : bin_means(curves, from, to, bins)) {
    const auto [least, most] = std::ranges::minmax(means);
    spreads.push_back(100 * (most - least) / mean(means));
  }
  return spreads;
}

namespace {

// Returns the ordinates A eta_s / nu of all runs together.
template <FirstPoint first = FirstPoint::left_out>
std::vector<double> products(const Asked& asked, const RunGroup& group) {
  std::vector<double> all;
  for (const Run* run : group) {
    const Curve curve = loss_curve(asked, *run, LossOrdinate::amplitude_times, first);
    all.insert(all.end(), curve.y.begin(), curve.y.end());
  }
  return all;
}

// Applies `of_range` to the least and the largest of them.
template <FirstPoint first, double (*of_range)(double least, double most)>
double product_range(const Asked& asked, const RunGroup& group) {
  const std::vector<double> all = products<first>(asked, group);
  if (all.empty()) return std::nan("");
  const auto [least, most] = std::ranges::minmax(all);
  return of_range(least, most);
}
double middle_of(double least, double most) { return (least + most) / 2; }
double half_percent_of(double least, double most) { return 100 * (most - least) / (most + least); }

template <LossOrdinate which, double (*of_all)(const std::vector<double>&)>
double collapse(const Asked& asked, const RunGroup& group) {
  std::vector<Curve> curves;
  curves.reserve(group.size());
  for (const Run* run : group) curves.push_back(loss_curve(asked, *run, which));
  return of_all(spreads_percent(curves, asked.number("from"), asked.number("to"), asked.analysis().bins));
}

struct Point {
  double x = std::nan(""), y = std::nan("");
};
// Returns the point of the highest ordinate.
Point highest(const Curve& curve) {
  const auto top = std::ranges::max_element(curve.y);
  if (top == curve.y.end()) return {};
  return {curve.x[static_cast<std::size_t>(top - curve.y.begin())], *top};
}

template <LossFactorOptions AnalysisOptions::*fit, double Point::*part>
double largest_loss(const Asked& asked, const Run& run) {
  return highest(loss_curve(run, LossOrdinate::eta, asked.analysis().*fit)).*part;
}

double mean_product(const Asked& asked, const Run& run) { return mean(products(asked, {&run})); }

// Returns the curve of A eta over A.
Curve product_of_total_loss(const Asked& asked, const Run& run) {
  Curve curve = loss_curve(asked, run, LossOrdinate::eta);
  for (std::size_t i = 0; i < curve.x.size(); ++i) curve.y[i] *= curve.x[i];
  return curve;
}

// Returns the width of the peak of eta: ln of the ratio of the amplitudes around it at half its height.
double width_of_peak(const Run& run, const LossFactorOptions& fit) {
  const Curve curve = loss_curve(run, LossOrdinate::eta, fit);
  const auto top = std::ranges::max_element(curve.y);
  if (top == curve.y.end()) return std::nan("");
  auto first = top, last = top;
  while (first != curve.y.begin() && *std::prev(first) >= *top / 2) --first;
  while (std::next(last) != curve.y.end() && *std::next(last) >= *top / 2) ++last;
  return logarithm(curve.x[static_cast<std::size_t>(first - curve.y.begin())] /
                   curve.x[static_cast<std::size_t>(last - curve.y.begin())]);
}

std::vector<double> edges_of(const Asked& asked) {
  return descending_amplitudes(asked.number("to"), asked.number("from"), set_bins_in_decade);
}

// Returns the greatest mean loss factor between the amplitudes divided by the least.
double loss_ratio(const Asked& asked) {
  const std::vector<double> losses = losses_between(asked.ensemble(), edges_of(asked)).mean;
  const auto [least, greatest] = std::ranges::minmax(losses);
  return greatest / least;
}

// The energy that a run has lost, and what friction and drag took of it, when its amplitude first is at most
// `amplitude`; NaN where it does not come down to it.
struct LostEnergy {
  double all = std::nan(""), by_components = std::nan("");
};
LostEnergy lost_down_to(const Asked& asked, const Run& run, double amplitude) {
  Scene scene = run.scene;
  scene.until_amplitude = amplitude;
  const Run shorter = asked.runs.simulated(scene, run.engine, {.half_cycles = false, .energy = true});
  if (shorter.stop_reason != StopReason::amplitude) return {};
  const EnergyBalance& balance = *shorter.energy;
  return {balance.initial.total() + balance.forcing_work - balance.final.total(),
          balance.friction_loss + balance.drag_loss};
}
double share_between(const LostEnergy& before, const LostEnergy& after) {
  return (after.by_components - before.by_components) / (after.all - before.all);
}

// What counts as insignificant beside the rest.
constexpr double insignificant = 0.05;

}  // namespace

std::vector<Measure> component_measures() {
  return {
      {"component_share",
       "share that friction and drag take of the energy that is lost between two amplitudes",
       [](const Asked& asked, const Run& run) {
         return share_between(lost_down_to(asked, run, asked.number("to")),
                              lost_down_to(asked, run, asked.number("from")));
       },
       numbers("from", "to")},
      {"component_share_insignificant",
       "lowest amplitude down to which friction and drag take less than a twentieth of the energy that is "
       "lost in each twelfth of a decade between two amplitudes",
       [](const Asked& asked, const Run& run) {
         double lowest = std::nan("");
         std::optional<LostEnergy> before;
         for (const double edge : edges_of(asked)) {
           const LostEnergy after = lost_down_to(asked, run, edge);
           if (before && !(share_between(*before, after) < insignificant)) break;
           if (before) lowest = edge;
           before = after;
         }
         return lowest;
       },
       numbers("from", "to")},
      {"locked_amplitude_ratio",
       "amplitude of the last half cycle divided by that below which friction or weight holds the mass "
       "(M18.4)",
       [](const Asked&, const Run& run) {
         const SceneDamper& damper = run.scene.damper();
         return half_cycles_of(run).amplitude.back() /
                locking_amplitude(1 / square_root(1 + damper.mass_ratio),
                                  damper.holding() + run.scene.weight);
       }},
  };
}

std::vector<Measure> loss_measures() {
  return {
      {"product_mid_range", "mean of the least and the largest A eta_s / nu of all scenes, A in [from, to]",
       product_range<FirstPoint::left_out, middle_of>, numbers("from", "to"), scenes(1, 8)},
      {"product_half_range_percent", "half their difference, in percent of their mean",
       product_range<FirstPoint::left_out, half_percent_of>, numbers("from", "to"), scenes(1, 8)},
      {"product_mid_range_with_first",
       "product_mid_range with each curve's first point, which the release enters",
       product_range<FirstPoint::counted, middle_of>, numbers("from", "to"), scenes(1, 8)},
      {"product_half_range_with_first_percent", "product_half_range_percent with each curve's first point",
       product_range<FirstPoint::counted, half_percent_of>, numbers("from", "to"), scenes(1, 8)},
      {"product_mean", "mean of all A eta_s / nu of all scenes, A in [from, to]",
       [](const Asked& asked, const RunGroup& group) { return mean(products(asked, group)); },
       numbers("from", "to"), scenes(1, 8)},
      {"loss_slope", "d ln eta_s / d ln A by least squares, A in [from, to]",
       [](const Asked& asked, const Run& run) {
         return log_slope(loss_curve(asked, run, LossOrdinate::specific_secondary));
       },
       numbers("from", "to")},
      {"largest_loss", "largest averaged eta", largest_loss<&AnalysisOptions::loss, &Point::y>},
      {"largest_loss_amplitude", "amplitude at which it is met",
       largest_loss<&AnalysisOptions::loss, &Point::x>},
      {"largest_smoother_loss", "largest eta averaged over 18 half cycles",
       largest_loss<&AnalysisOptions::smoother_loss, &Point::y>},
      {"largest_smoother_loss_amplitude", "amplitude at which it is met",
       largest_loss<&AnalysisOptions::smoother_loss, &Point::x>},
      {"single_impact_fold", "amplitude below which single impacts do not exist, closed form for nu -> 0",
       [](const Asked& asked) { return fold_amplitude(asked.number("restitution")); },
       numbers("restitution")},
      {"single_impact_peak_loss", "largest eta of single impacts, closed form for nu -> 0, times nu",
       [](const Asked& asked) { return asked.number("mass_ratio") * peak_loss(asked.number("restitution")); },
       numbers("mass_ratio", "restitution")},
      {"single_impact_peak_product",
       "amplitude of the largest A eta / nu of single impacts, closed form for nu -> 0",
       [](const Asked& asked) { return peak_product_amplitude(asked.number("restitution")); },
       numbers("restitution")},
      {"product_peak_amplitude",
       "amplitude of the largest A eta_s / nu, A in [from, to], averaged over so many half cycles",
       [](const Asked& asked, const Run& run) {
         const LossFactorOptions fit{static_cast<int>(asked.number("averaged_over"))};
         return highest(loss_curve(run, LossOrdinate::amplitude_times, fit, asked.number("from"),
                                   asked.number("to")))
             .x;
       },
       numbers("from", "to", "averaged_over")},
      {"loss_near_span",
       "ratio of the largest to the least amplitude at which the averaged loss factor is within a factor of "
       "eta",
       [](const Asked& asked, const Run& run) {
         const double eta = asked.number("eta"), factor = asked.number("factor");
         double least = std::numeric_limits<double>::infinity(), most = 0;
         const Curve curve = loss_curve(asked, run, LossOrdinate::eta);
         for (std::size_t i = 0; i < curve.x.size(); ++i) {
           if (!(curve.y[i] >= eta / factor && curve.y[i] <= eta * factor)) continue;
           least = std::min(least, curve.x[i]);
           most = std::max(most, curve.x[i]);
         }
         return most / least;
       },
       numbers("eta", "factor", "from", "to")},
      {"collapse_specific_percent", "spread of eta/nu between the scenes at equal amplitude, in percent",
       collapse<LossOrdinate::specific, mean>, numbers("from", "to"), scenes(2, 8)},
      {"collapse_secondary_percent", "the same of (eta - 2 zeta)/nu",
       collapse<LossOrdinate::specific_secondary, mean>, numbers("from", "to"), scenes(2, 8)},
      {"collapse_restitution_percent", "the same of A (eta - 2 zeta)/nu/(1 - e)",
       collapse<LossOrdinate::by_restitution, mean>, numbers("from", "to"), scenes(2, 8)},
      {"collapse_product_percent", "the same of A (eta - 2 zeta)/nu",
       collapse<LossOrdinate::amplitude_times, mean>, numbers("from", "to"), scenes(2, 8)},
      {"collapse_carried_percent", "the same of A (eta - 2 zeta/(1 + nu))/nu",
       collapse<LossOrdinate::carried, mean>, numbers("from", "to"), scenes(2, 8)},
      {"collapse_specific_worst_percent",
       "spread of eta/nu between the scenes in the bin of amplitudes where it is greatest, in percent",
       collapse<LossOrdinate::specific, most>, numbers("from", "to"), scenes(2, 8)},
      {"collapse_secondary_worst_percent", "the same of (eta - 2 zeta)/nu",
       collapse<LossOrdinate::specific_secondary, most>, numbers("from", "to"), scenes(2, 8)},
      {"collapse_restitution_worst_percent", "the same of A (eta - 2 zeta)/nu/(1 - e)",
       collapse<LossOrdinate::by_restitution, most>, numbers("from", "to"), scenes(2, 8)},
      {"collapse_product_worst_percent", "the same of A (eta - 2 zeta)/nu",
       collapse<LossOrdinate::amplitude_times, most>, numbers("from", "to"), scenes(2, 8)},
      {"collapse_carried_worst_percent", "the same of A (eta - 2 zeta/(1 + nu))/nu",
       collapse<LossOrdinate::carried, most>, numbers("from", "to"), scenes(2, 8)},
      {"mass_ratio_exponent", "d ln (mean of A eta_s) / d ln nu by least squares over the scenes",
       [](const Asked& asked, const RunGroup& group) {
         Curve points;
         for (const Run* run : group) {
           const double nu = run->scene.damper().mass_ratio;
           points.add(nu, nu * mean_product(asked, *run));
         }
         return log_slope(points);
       },
       numbers("from", "to"), scenes(2, 8)},
      {"product_ratio", "mean A eta_s / nu of the first scene, divided by the second's",
       [](const Asked& asked, const Run& first, const Run& second) {
         return mean_product(asked, first) / mean_product(asked, second);
       },
       numbers("from", "to")},
      // The mass ratio and the restitution of the scenes do not enter: their motion alone is compared with
      // the factor.
      {"loss_ratio_exponent",
       "power of the factor that is the ratio of the mean A eta of the first scene to the second's",
       [](const Asked& asked, const Run& first, const Run& second) {
         const double ratio =
             mean(product_of_total_loss(asked, first).y) / mean(product_of_total_loss(asked, second).y);
         return logarithm(ratio) / logarithm(asked.number("factor"));
       },
       numbers("factor", "from", "to")},
      // Weighted with the amplitude, so that all bins count alike: the scatter of eta is proportional to 1/A.
      {"added_loss_error",
       "what the averaged eta of the first scene has more than the second's, divided by 2 zeta, less 1",
       [](const Asked& asked, const Run& first, const Run& second) {
         const Curve damped = product_of_total_loss(asked, first),
                     undamped = product_of_total_loss(asked, second);
         double added = 0, expected = 0;
         for (const auto& means : bin_means({damped, undamped, {damped.x, damped.x}}, asked.number("from"),
                                            asked.number("to"), asked.analysis().bins)) {
           added += means[0] - means[1];
           expected += 2 * asked.number("damping_ratio") * means[2];
         }
         return added / expected - 1;
       },
       numbers("damping_ratio", "from", "to")},
      {"tail_loss_ratio", "median of the last so many values of eta, divided by the largest",
       [](const Asked& asked, const Run& run) {
         const Curve all = loss_curve(run, LossOrdinate::eta, asked.analysis().loss);
         const std::size_t count = std::min(all.y.size(), static_cast<std::size_t>(asked.number("last")));
         const std::vector<double> tail(all.y.end() - static_cast<std::ptrdiff_t>(count), all.y.end());
         return spread_of(tail).median / highest(all).y;
       },
       numbers("last")},
      {"smoothing_ratio", "largest eta averaged over 18 half cycles, divided by that over 10",
       [](const Asked& asked, const Run& run) {
         return largest_loss<&AnalysisOptions::smoother_loss, &Point::y>(asked, run) /
                largest_loss<&AnalysisOptions::loss, &Point::y>(asked, run);
       }},
      {"smoothing_width_ratio",
       "width of the peak of eta in ln A, at half its height, averaged over 18 half cycles, divided by that "
       "over 10",
       [](const Asked& asked, const Run& run) {
         return width_of_peak(run, asked.analysis().smoother_loss) /
                width_of_peak(run, asked.analysis().loss);
       }},
      {"single_impact_advantage",
       "largest eta in and below the window of single impacts, divided by the largest above it",
       [](const Asked& asked, const Run& run) {
         const AnalysisOptions& analysis = asked.analysis();
         const auto window = longest_window(regular_windows(run, analysis.regimes), 1);
         if (!window) return std::nan("");
         return highest(loss_curve(run, LossOrdinate::eta, analysis.loss, 0, window->upper)).y /
                highest(loss_curve(run, LossOrdinate::eta, analysis.loss, window->upper)).y;
       }},
  };
}

std::vector<Measure> damper_measures() {
  std::vector<Measure> all{
      {"loss_ratio",
       "greatest loss factor between two amplitudes divided by the least, in bins of a twelfth of a decade",
       loss_ratio, numbers("from", "to"), scenes(1, 1)},
      {"loss_variation_percent",
       "half the difference of greatest and least loss factor between two amplitudes, in percent of their "
       "mean, in bins of a twelfth of a decade",
       [](const Asked& asked) {
         const double ratio = loss_ratio(asked);
         return 100 * (ratio - 1) / (ratio + 1);
       },
       numbers("from", "to"), scenes(1, 1)},
      {"alike_range",
       "widest range of amplitudes in which the loss factor is constant to a share either way, in bins of a "
       "twelfth of a decade: its upper end divided by the lower",
       [](const Asked& asked) {
         const std::vector<double> edges = edges_of(asked),
                                   losses = losses_between(asked.ensemble(), edges).mean;
         const double share = asked.number("within"), most = (1 + share) / (1 - share);
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
         return widest;
       },
       numbers("from", "to", "within"), scenes(1, 1)},
      {"from_sum",
       "loss factor of the dampers of the first run less the sum of what each would lose alone, by the "
       "second run, divided by the sum: median, least and greatest of the bins between two amplitudes",
       [](const Asked& asked) {
         const std::vector<double> edges = edges_of(asked);
         const std::vector<Run>& together = asked.ensemble();
         if (has_one_damper(together.front().scene))
           throw std::invalid_argument("measure from_sum: run " + asked.call.scenes[0] + " is of one damper");
         const std::vector<double> losses = losses_between(together, edges).mean,
                                   sum = sum_of_losses(together.front().scene.dampers,
                                                       loss_alone(asked.runs.ensemble(asked.call.scenes[1])),
                                                       edges);
         std::vector<double> differences;
         for (std::size_t k = 0; k < sum.size(); ++k) differences.push_back(losses[k] / sum[k] - 1);
         return spread_of(differences);
       },
       numbers("from", "to"), scenes(2, 2)},
  };
  for (Measure& each : all) each.takes_dampers = true;
  return all;
}

}  // namespace impact_damper
