#include "loss_curve.hpp"

#include <cmath>
#include <stdexcept>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "timing.hpp"

namespace impact_damper::bench {
namespace {

std::vector<double> amplitudes() {
  constexpr int count = 60;
  std::vector<double> all;
  for (int i = 0; i < count; ++i) all.push_back(5 * std::pow(0.02, double(i) / (count - 1)));
  return all;
}

}  // namespace

std::optional<std::vector<double>> loss_curve(const std::vector<double>& peak_time,
                                              const std::vector<double>& amplitude) {
  LossFactor loss;
  try {
    loss = averaged_loss_factor(peak_time, amplitude);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
  std::vector<double> curve;
  std::size_t i = 1;
  for (const double a : amplitudes()) {
    while (i < loss.amplitude.size() && !(loss.amplitude[i] < a)) ++i;
    if (i >= loss.amplitude.size() || !(loss.amplitude[i - 1] >= a)) return std::nullopt;
    const double part = (loss.amplitude[i - 1] - a) / (loss.amplitude[i - 1] - loss.amplitude[i]);
    curve.push_back(loss.eta[i - 1] + part * (loss.eta[i] - loss.eta[i - 1]));
  }
  return curve;
}

std::vector<double> mean_curve(const std::vector<std::vector<double>>& curves) {
  std::vector<double> mean(curves.at(0).size());
  for (const std::vector<double>& curve : curves) {
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += curve[i] / double(curves.size());
  }
  return mean;
}

EnsembleCurve ensemble_curve(const Scene& scene, const Engine& engine) {
  constexpr int groups = 7;
  std::vector<std::vector<double>> curves;
  for (const Run& run :
       simulate_ensemble(scene, engine, {.half_cycles = true}, {.members = groups * releases})) {
    auto curve = loss_curve(run.half_cycles->peak_time, run.half_cycles->amplitude);
    if (!curve) throw std::logic_error("the ensemble's decays must pass all amplitudes of the loss curve");
    curves.push_back(std::move(*curve));
  }
  EnsembleCurve ensemble{.mean = mean_curve(curves)};
  std::vector<double> errors;
  for (auto group = curves.begin(); group != curves.end(); group += releases) {
    errors.push_back(curve_error(ensemble, mean_curve({group, group + releases})));
  }
  const Spread spread = spread_of(errors);
  ensemble.lower = spread.lower;
  ensemble.scatter = spread.median;
  ensemble.upper = spread.upper;
  return ensemble;
}

double curve_error(const EnsembleCurve& ensemble, const std::vector<double>& curve) {
  double sum = 0;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double difference = curve[i] / ensemble.mean[i] - 1;
    sum += difference * difference;
  }
  return std::sqrt(sum / double(curve.size()));
}

}  // namespace impact_damper::bench
