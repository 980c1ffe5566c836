#include "impact_damper/analysis/damper_sets.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

const HalfCycles& recorded_half_cycles(const Run& run) {
  if (!run.half_cycles) throw std::invalid_argument("half_cycles: the run did not record them");
  return *run.half_cycles;
}

}  // namespace

std::vector<double> descending_amplitudes(double from, double to, int in_decade) {
  // A whole number of decades has no interval more by rounding.
  const double intervals = in_decade * logarithm(from / to) / logarithm(10.0);
  const int count = std::max(1, static_cast<int>(std::ceil(intervals - 1e-9)));
  std::vector<double> amplitudes{from};
  for (int i = 1; i < count; ++i) amplitudes.push_back(from * exponential(logarithm(to / from) * i / count));
  amplitudes.push_back(to);
  return amplitudes;
}

std::vector<double> losses_between(const HalfCycles& half_cycles, const std::vector<double>& edges) {
  const std::vector<double>&times = half_cycles.peak_time, &peaks = half_cycles.amplitude;
  std::vector<double> reached;  // when the peaks came down to each edge
  std::size_t i = 0;
  double least = std::numeric_limits<double>::infinity(), at = 0;  // of the peaks before i
  for (const double edge : edges) {
    for (; i < peaks.size() && !(peaks[i] < edge); ++i) {
      if (!(peaks[i] < least)) continue;
      least = peaks[i];
      at = times[i];
    }
    if (i == peaks.size()) {
      reached.push_back(std::numeric_limits<double>::infinity());
    } else if (i == 0) {
      reached.push_back(none);
    } else {
      const double part = logarithm(least / edge) / logarithm(least / peaks[i]);
      reached.push_back(at + part * (times[i] - at));
    }
  }
  std::vector<double> losses;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    const double duration = reached[k + 1] - reached[k];
    const double loss = 2 * logarithm(edges[k] / edges[k + 1]) / duration;
    losses.push_back(std::isinf(reached[k + 1]) ? 0 : loss);
  }
  return losses;
}

LossSpread losses_between(const std::vector<Run>& runs, const std::vector<double>& edges) {
  std::vector<std::vector<double>> all;
  all.reserve(runs.size());
  for (const Run& run : runs) all.push_back(losses_between(recorded_half_cycles(run), edges));
  LossSpread spread;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    std::vector<double> values;
    values.reserve(all.size());
    for (const std::vector<double>& losses : all) values.push_back(losses[k]);
    double times = 0;
    for (const double value : values) times += 1 / value;
    const Spread of_all = spread_of(values);
    spread.mean.push_back(double(values.size()) / times);
    spread.low.push_back(of_all.low);
    spread.high.push_back(of_all.high);
  }
  return spread;
}

double LossAlone::at(double amplitude) const {
  if (!(amplitude <= edges.front())) return none;
  const auto below = std::ranges::lower_bound(edges, amplitude, std::greater<>());
  if (below == edges.end()) return 0;
  return specific[static_cast<std::size_t>(std::max(below - edges.begin() - 1, std::ptrdiff_t(0)))];
}

LossAlone loss_alone(const std::vector<Run>& runs) {
  if (runs.empty()) throw std::invalid_argument("loss_alone: no run");
  const Scene& scene = runs.front().scene;
  if (!has_one_damper(scene)) throw std::invalid_argument("loss_alone: a run of several dampers");
  if (!scene.until_amplitude) throw std::invalid_argument("loss_alone: a run without until_amplitude");
  double from = std::numeric_limits<double>::infinity();
  for (const Run& run : runs)
    if (!recorded_half_cycles(run).amplitude.empty())
      from = std::min(from, run.half_cycles->amplitude.front());
  LossAlone alone{descending_amplitudes(from, *scene.until_amplitude, 48), {}};
  alone.specific = losses_between(runs, alone.edges).mean;
  for (double& loss : alone.specific) loss /= scene.damper().mass_ratio;
  return alone;
}

std::vector<double> sum_of_losses(const std::vector<SceneDamper>& dampers, const LossAlone& alone,
                                  const std::vector<double>& edges) {
  constexpr int parts = 16;
  std::vector<double> losses;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    double duration = 0;  // divided by 2 ln(A1/A2)
    for (int part = 0; part < parts; ++part) {
      const double amplitude =
          edges[k] * exponential(logarithm(edges[k + 1] / edges[k]) * (part + 0.5) / parts);
      double loss = 0;
      for (const SceneDamper& damper : dampers)
        loss += damper.mass_ratio * alone.at(amplitude / damper.clearance);
      duration += 1 / (parts * loss);
    }
    losses.push_back(1 / duration);
  }
  return losses;
}

}  // namespace impact_damper
