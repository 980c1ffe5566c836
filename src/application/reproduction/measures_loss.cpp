// Measures on the curves of the averaged loss factor.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "application/reproduction/measures.hpp"
#include "application/reproduction/measures_parts.hpp"
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
  for (std::size_t i = first == FirstPoint::counted ? 0 : 1; i < y.size(); ++i) {
    if (!(loss.amplitude[i] >= from && loss.amplitude[i] <= to)) continue;
    curve.x.push_back(loss.amplitude[i]);
    curve.y.push_back(y[i]);
  }
  return curve;
}

double log_slope(const Curve& curve) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double x = logarithm(curve.x[i]), y = logarithm(curve.y[i]);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

std::vector<std::vector<double>> bin_means(const std::vector<Curve>& curves, double from, double to,
                                           int bins) {
  const double width = logarithm(to / from) / bins;
  std::vector<std::vector<double>> all;
  for (int bin = 0; bin < bins; ++bin) {
    const double low = from * exponential(width * bin), high = from * exponential(width * (bin + 1));
    std::vector<double> means;
    for (const Curve& curve : curves) {
      double mean = 0;
      int points = 0;
      for (std::size_t i = 0; i < curve.x.size(); ++i)
        if (curve.x[i] >= low && curve.x[i] < high) mean += curve.y[i], ++points;
      if (points > 0) means.push_back(mean / points);
    }
    if (means.size() == curves.size()) all.push_back(means);
  }
  return all;
}

std::vector<double> bin_spreads_percent(const std::vector<Curve>& curves, double from, double to, int bins) {
  std::vector<double> spreads;
  for (const std::vector<double>& means : bin_means(curves, from, to, bins)) {
    double total = 0;
    for (const double mean : means) total += mean;
    const auto [least, most] = std::ranges::minmax(means);
    spreads.push_back(100 * (most - least) / (total / static_cast<double>(curves.size())));
  }
  return spreads;
}

double spread_percent(const std::vector<Curve>& curves, double from, double to, int bins) {
  double sum = 0;
  const std::vector<double> spreads = bin_spreads_percent(curves, from, to, bins);
  for (const double spread : spreads) sum += spread;
  return sum / static_cast<double>(spreads.size());
}

double worst_spread_percent(const std::vector<Curve>& curves, double from, double to, int bins) {
  const std::vector<double> spreads = bin_spreads_percent(curves, from, to, bins);
  return spreads.empty() ? std::nan("") : *std::ranges::max_element(spreads);
}

namespace {

// Applies `find` to the ordinates A eta_s / nu of all runs together, A in [from, to].
template <class Find>
Spread of_products(Runs& runs, const MeasureCall& call, FirstPoint first, Find find) {
  return over_groups(runs, call, [&](const std::vector<const Run*>& group) {
    std::vector<double> all;
    for (const Run* run : group) {
      const Curve curve = loss_curve(*run, LossOrdinate::amplitude_times, runs.analysis().loss,
                                     number(call, "from"), number(call, "to"), first);
      all.insert(all.end(), curve.y.begin(), curve.y.end());
    }
    return all.empty() ? std::nan("") : find(all);
  });
}

using SpreadOfCurves = double (*)(const std::vector<Curve>&, double, double, int);
template <LossOrdinate which, SpreadOfCurves spread = spread_percent>
Spread collapse(Runs& runs, const MeasureCall& call) {
  const double from = number(call, "from"), to = number(call, "to");
  return over_groups(runs, call, [&](const std::vector<const Run*>& group) {
    std::vector<Curve> curves;
    curves.reserve(group.size());
    for (const Run* run : group) curves.push_back(loss_curve(*run, which, runs.analysis().loss, from, to));
    return spread(curves, from, to, runs.analysis().bins);
  });
}

// Returns the point of the highest ordinate.
std::pair<double, double> highest(const Curve& curve) {
  const auto top = std::max_element(curve.y.begin(), curve.y.end());
  if (top == curve.y.end()) return {std::nan(""), std::nan("")};
  return {curve.x[static_cast<std::size_t>(top - curve.y.begin())], *top};
}

template <FirstPoint first>
Spread product_mid_range(Runs& runs, const MeasureCall& call) {
  return of_products(runs, call, first, [](const std::vector<double>& products) {
    const auto [least, most] = std::ranges::minmax(products);
    return (least + most) / 2;
  });
}

template <FirstPoint first>
Spread product_half_range(Runs& runs, const MeasureCall& call) {
  return of_products(runs, call, first, [](const std::vector<double>& products) {
    const auto [least, most] = std::ranges::minmax(products);
    return 100 * (most - least) / (most + least);
  });
}

Spread product_mean(Runs& runs, const MeasureCall& call) {
  return of_products(runs, call, FirstPoint::left_out, mean);
}

Spread loss_slope(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    return log_slope(loss_curve(run, LossOrdinate::specific_secondary, runs.analysis().loss,
                                number(call, "from"), number(call, "to")));
  });
}

template <LossFactorOptions AnalysisOptions::*fit>
Spread largest_loss(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    return highest(loss_curve(run, LossOrdinate::eta, runs.analysis().*fit)).second;
  });
}

template <LossFactorOptions AnalysisOptions::*fit>
Spread largest_loss_amplitude(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    return highest(loss_curve(run, LossOrdinate::eta, runs.analysis().*fit)).first;
  });
}

// Closed forms of single impacts, nu -> 0.
Spread single_impact_fold(Runs&, const MeasureCall& call) {
  return once(fold_amplitude(number(call, "restitution")));
}
Spread single_impact_peak_loss(Runs&, const MeasureCall& call) {
  return once(number(call, "mass_ratio") * peak_loss(number(call, "restitution")));
}
Spread single_impact_peak_product(Runs&, const MeasureCall& call) {
  return once(peak_product_amplitude(number(call, "restitution")));
}

Spread product_peak_amplitude(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const LossFactorOptions fit{static_cast<int>(number(call, "averaged_over"))};
    return highest(
               loss_curve(run, LossOrdinate::amplitude_times, fit, number(call, "from"), number(call, "to")))
        .first;
  });
}

Spread loss_near_span(Runs& runs, const MeasureCall& call) {
  const double eta = number(call, "eta"), factor = number(call, "factor");
  return over_members(runs, call, [&](const Run& run) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    const Curve curve =
        loss_curve(run, LossOrdinate::eta, runs.analysis().loss, number(call, "from"), number(call, "to"));
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (!(curve.y[i] >= eta / factor && curve.y[i] <= eta * factor)) continue;
      least = std::min(least, curve.x[i]);
      most = std::max(most, curve.x[i]);
    }
    return most / least;
  });
}

Spread mass_ratio_exponent(Runs& runs, const MeasureCall& call) {
  return over_groups(runs, call, [&](const std::vector<const Run*>& group) {
    Curve points;
    for (const Run* run : group) {
      const Curve curve = loss_curve(*run, LossOrdinate::amplitude_times, runs.analysis().loss,
                                     number(call, "from"), number(call, "to"));
      points.x.push_back(run->scene.damper().mass_ratio);
      points.y.push_back(run->scene.damper().mass_ratio * mean(curve.y));
    }
    return log_slope(points);
  });
}

Spread product_ratio(Runs& runs, const MeasureCall& call) {
  return over_groups(runs, call, [&](const std::vector<const Run*>& group) {
    const auto average = [&](const Run& run) {
      return mean(loss_curve(run, LossOrdinate::amplitude_times, runs.analysis().loss, number(call, "from"),
                             number(call, "to"))
                      .y);
    };
    return average(*group[0]) / average(*group[1]);
  });
}

// Returns the curve of A eta over A.
Curve product_of_total_loss(const Runs& runs, const Run& run, const MeasureCall& call) {
  Curve curve =
      loss_curve(run, LossOrdinate::eta, runs.analysis().loss, number(call, "from"), number(call, "to"));
  for (std::size_t i = 0; i < curve.x.size(); ++i) curve.y[i] *= curve.x[i];
  return curve;
}

// The mass ratio and the restitution of the scenes do not enter: their motion alone is compared with the
// factor.
Spread loss_ratio_exponent(Runs& runs, const MeasureCall& call) {
  return over_groups(runs, call, [&](const std::vector<const Run*>& group) {
    const double ratio = mean(product_of_total_loss(runs, *group[0], call).y) /
                         mean(product_of_total_loss(runs, *group[1], call).y);
    return logarithm(ratio) / logarithm(number(call, "factor"));
  });
}

// Weighted with the amplitude, so that all bins count alike: the scatter of eta is proportional to 1/A.
Spread added_loss_error(Runs& runs, const MeasureCall& call) {
  const double from = number(call, "from"), to = number(call, "to");
  return over_groups(runs, call, [&](const std::vector<const Run*>& group) {
    const Curve damped = product_of_total_loss(runs, *group[0], call),
                undamped = product_of_total_loss(runs, *group[1], call);
    double added = 0, expected = 0;
    for (const auto& means :
         bin_means({damped, undamped, {damped.x, damped.x}}, from, to, runs.analysis().bins)) {
      added += means[0] - means[1];
      expected += 2 * number(call, "damping_ratio") * means[2];
    }
    return added / expected - 1;
  });
}

Spread tail_loss_ratio(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const Curve all = loss_curve(run, LossOrdinate::eta, runs.analysis().loss);
    const std::size_t count = std::min(all.y.size(), static_cast<std::size_t>(number(call, "last")));
    const std::vector<double> tail(all.y.end() - static_cast<std::ptrdiff_t>(count), all.y.end());
    return spread_of(tail).median / highest(all).second;
  });
}

Spread smoothing_ratio(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const auto top = [&](const LossFactorOptions& fit) {
      return highest(loss_curve(run, LossOrdinate::eta, fit)).second;
    };
    return top(runs.analysis().smoother_loss) / top(runs.analysis().loss);
  });
}

// Width of the peak of eta: ln of the ratio of the amplitudes around it at half its height.
Spread smoothing_width_ratio(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const auto width = [&](const LossFactorOptions& fit) {
      const Curve curve = loss_curve(run, LossOrdinate::eta, fit);
      const auto top = std::ranges::max_element(curve.y);
      if (top == curve.y.end()) return std::nan("");
      auto first = top, last = top;
      while (first != curve.y.begin() && *std::prev(first) >= *top / 2) --first;
      while (std::next(last) != curve.y.end() && *std::next(last) >= *top / 2) ++last;
      return logarithm(curve.x[static_cast<std::size_t>(first - curve.y.begin())] /
                       curve.x[static_cast<std::size_t>(last - curve.y.begin())]);
    };
    return width(runs.analysis().smoother_loss) / width(runs.analysis().loss);
  });
}

Spread single_impact_advantage(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const AnalysisOptions& analysis = runs.analysis();
    const auto window = longest_window(regular_windows(run, analysis.regimes), 1);
    if (!window) return std::nan("");
    return highest(loss_curve(run, LossOrdinate::eta, analysis.loss, 0, window->upper)).second /
           highest(loss_curve(run, LossOrdinate::eta, analysis.loss, window->upper)).second;
  });
}

}  // namespace

std::vector<Measure> loss_measures() {
  return {
      {"product_mid_range", product_mid_range<FirstPoint::left_out>,
       "mean of the least and the largest A eta_s / nu of all scenes, A in [from, to]", numbers("from", "to"),
       scenes(1, 8)},
      {"product_half_range_percent", product_half_range<FirstPoint::left_out>,
       "half their difference, in percent of their mean", numbers("from", "to"), scenes(1, 8)},
      {"product_mid_range_with_first", product_mid_range<FirstPoint::counted>,
       "product_mid_range with each curve's first point, which the release enters", numbers("from", "to"),
       scenes(1, 8)},
      {"product_half_range_with_first_percent", product_half_range<FirstPoint::counted>,
       "product_half_range_percent with each curve's first point", numbers("from", "to"), scenes(1, 8)},
      {"product_mean", product_mean, "mean of all A eta_s / nu of all scenes, A in [from, to]",
       numbers("from", "to"), scenes(1, 8)},
      {"loss_slope", loss_slope, "d ln eta_s / d ln A by least squares, A in [from, to]",
       numbers("from", "to")},
      {"largest_loss", largest_loss<&AnalysisOptions::loss>, "largest averaged eta"},
      {"largest_loss_amplitude", largest_loss_amplitude<&AnalysisOptions::loss>,
       "amplitude at which it is met"},
      {"largest_smoother_loss", largest_loss<&AnalysisOptions::smoother_loss>,
       "largest eta averaged over 18 half cycles"},
      {"largest_smoother_loss_amplitude", largest_loss_amplitude<&AnalysisOptions::smoother_loss>,
       "amplitude at which it is met"},
      {"single_impact_fold", single_impact_fold,
       "amplitude below which single impacts do not exist, closed form for nu -> 0", numbers("restitution"),
       scenes(0, 0)},
      {"single_impact_peak_loss", single_impact_peak_loss,
       "largest eta of single impacts, closed form for nu -> 0, times nu",
       numbers("mass_ratio", "restitution"), scenes(0, 0)},
      {"single_impact_peak_product", single_impact_peak_product,
       "amplitude of the largest A eta / nu of single impacts, closed form for nu -> 0",
       numbers("restitution"), scenes(0, 0)},
      {"product_peak_amplitude", product_peak_amplitude,
       "amplitude of the largest A eta_s / nu, A in [from, to], averaged over so many half cycles",
       numbers("from", "to", "averaged_over")},
      {"loss_near_span", loss_near_span,
       "ratio of the largest to the least amplitude at which the averaged loss factor is within a factor of "
       "eta",
       numbers("eta", "factor", "from", "to")},
      {"collapse_eta_percent", collapse<LossOrdinate::eta>,
       "spread of eta between the scenes at equal amplitude, in percent", numbers("from", "to"),
       scenes(2, 8)},
      {"collapse_specific_percent", collapse<LossOrdinate::specific>, "the same of eta/nu",
       numbers("from", "to"), scenes(2, 8)},
      {"collapse_secondary_percent", collapse<LossOrdinate::specific_secondary>,
       "the same of (eta - 2 zeta)/nu", numbers("from", "to"), scenes(2, 8)},
      {"collapse_restitution_percent", collapse<LossOrdinate::by_restitution>,
       "the same of A (eta - 2 zeta)/nu/(1 - e)", numbers("from", "to"), scenes(2, 8)},
      {"collapse_product_percent", collapse<LossOrdinate::amplitude_times>, "the same of A (eta - 2 zeta)/nu",
       numbers("from", "to"), scenes(2, 8)},
      {"collapse_carried_percent", collapse<LossOrdinate::carried>,
       "the same of A (eta - 2 zeta/(1 + nu))/nu", numbers("from", "to"), scenes(2, 8)},
      {"collapse_specific_worst_percent", collapse<LossOrdinate::specific, worst_spread_percent>,
       "spread of eta/nu between the scenes in the bin of amplitudes where it is greatest, in percent",
       numbers("from", "to"), scenes(2, 8)},
      {"collapse_secondary_worst_percent", collapse<LossOrdinate::specific_secondary, worst_spread_percent>,
       "the same of (eta - 2 zeta)/nu", numbers("from", "to"), scenes(2, 8)},
      {"collapse_restitution_worst_percent", collapse<LossOrdinate::by_restitution, worst_spread_percent>,
       "the same of A (eta - 2 zeta)/nu/(1 - e)", numbers("from", "to"), scenes(2, 8)},
      {"collapse_product_worst_percent", collapse<LossOrdinate::amplitude_times, worst_spread_percent>,
       "the same of A (eta - 2 zeta)/nu", numbers("from", "to"), scenes(2, 8)},
      {"collapse_carried_worst_percent", collapse<LossOrdinate::carried, worst_spread_percent>,
       "the same of A (eta - 2 zeta/(1 + nu))/nu", numbers("from", "to"), scenes(2, 8)},
      {"mass_ratio_exponent", mass_ratio_exponent,
       "d ln (mean of A eta_s) / d ln nu by least squares over the scenes", numbers("from", "to"),
       scenes(2, 8)},
      {"product_ratio", product_ratio, "mean A eta_s / nu of the first scene, divided by the second's",
       numbers("from", "to"), scenes(2, 2)},
      {"loss_ratio_exponent", loss_ratio_exponent,
       "power of the factor that is the ratio of the mean A eta of the first scene to the second's",
       numbers("factor", "from", "to"), scenes(2, 2)},
      {"added_loss_error", added_loss_error,
       "what the averaged eta of the first scene has more than the second's, divided by 2 zeta, less 1",
       numbers("damping_ratio", "from", "to"), scenes(2, 2)},
      {"tail_loss_ratio", tail_loss_ratio, "median of the last so many values of eta, divided by the largest",
       numbers("last")},
      {"smoothing_ratio", smoothing_ratio,
       "largest eta averaged over 18 half cycles, divided by that over 10"},
      {"smoothing_width_ratio", smoothing_width_ratio,
       "width of the peak of eta in ln A, at half its height, averaged over 18 half cycles, divided by that "
       "over 10"},
      {"single_impact_advantage", single_impact_advantage,
       "largest eta in and below the window of single impacts, divided by the largest above it"},
  };
}

}  // namespace impact_damper
