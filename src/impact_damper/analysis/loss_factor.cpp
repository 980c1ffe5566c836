#include "impact_damper/analysis/loss_factor.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

void check(const std::vector<double>& time, const std::vector<double>& amplitude, int half_cycles) {
  if (half_cycles < 10 || half_cycles > 18 || half_cycles % 2 != 0)
    throw std::invalid_argument("half_cycles: must be even, 10 to 18, got " + std::to_string(half_cycles));
  if (time.size() != amplitude.size())
    throw std::invalid_argument("peak_time and amplitude: must be of equal length");
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!(amplitude[i] > 0)) throw std::invalid_argument("amplitude: must be > 0 everywhere");
    if (i > 0 && !(time[i] > time[i - 1])) throw std::invalid_argument("peak_time: must ascend strictly");
  }
}

// Value and slope at the middle of a parabola fitted by least squares. Its terms 1, p and p^2 - alpha p -
// beta, p counted from the mean time, are orthogonal over the given times: each coefficient is a quotient of
// two sums, and nothing is lost in a system of equations. Amplitudes are counted from the middle one.
struct Parabola {
  double value, slope;
};
Parabola fitted_parabola(std::span<const double> time, std::span<const double> amplitude) {
  const std::size_t points = time.size();
  const double count = static_cast<double>(points);
  const double middle_time = time[points / 2], middle_amplitude = amplitude[points / 2];
  double mean = 0;
  for (const double t : time) mean += t - middle_time;
  mean /= count;
  double p2 = 0, p3 = 0, p4 = 0, a = 0, ap = 0,
         ap2 = 0;  // sums of the powers of p, and of amplitude times them
  for (std::size_t i = 0; i < points; ++i) {
    const double p = time[i] - middle_time - mean, square = p * p;
    const double above = amplitude[i] - middle_amplitude;
    p2 += square;
    p3 += square * p;
    p4 += square * square;
    a += above;
    ap += above * p;
    ap2 += above * square;
  }
  const double alpha = p3 / p2, beta = p2 / count;
  const double linear = ap / p2;
  const double quadratic = (ap2 - alpha * ap - beta * a) / (p4 - alpha * p3 - beta * p2);
  return {middle_amplitude + a / count - linear * mean + quadratic * (mean * mean + alpha * mean - beta),
          linear - quadratic * (2 * mean + alpha)};
}

struct Peaks {
  std::vector<double> time, amplitude;
};
Peaks peaks_of(const HalfCycles& rows, std::size_t first, std::size_t last) {
  Peaks peaks;
  for (auto* column : {&peaks.time, &peaks.amplitude}) column->reserve(last - std::min(first, last));
  for (std::size_t i = first; i < last; ++i) {
    if (!(rows.amplitude[i] > 0)) continue;
    if (!peaks.time.empty() && !(rows.peak_time[i] > peaks.time.back())) continue;
    peaks.time.push_back(rows.peak_time[i]);
    peaks.amplitude.push_back(rows.amplitude[i]);
  }
  return peaks;
}

}  // namespace

LossFactor averaged_loss_factor(const std::vector<double>& peak_time, const std::vector<double>& amplitude,
                                const LossFactorOptions& options) {
  check(peak_time, amplitude, options.half_cycles);
  const std::size_t points = static_cast<std::size_t>(options.half_cycles) + 1;
  LossFactor loss;
  if (peak_time.size() < points) return loss;
  const std::size_t rows = peak_time.size() - points + 1;
  for (auto* column : {&loss.amplitude, &loss.time, &loss.eta}) column->reserve(rows);
  for (std::size_t first = 0; first < rows; ++first) {
    const Parabola parabola = fitted_parabola(std::span(peak_time).subspan(first, points),
                                              std::span(amplitude).subspan(first, points));
    loss.amplitude.push_back(parabola.value);
    loss.time.push_back(peak_time[first + points / 2]);
    loss.eta.push_back(-2 * parabola.slope / parabola.value);
  }
  return loss;
}

LossFactor averaged_loss_factor(const HalfCycles& half_cycles, const LossFactorOptions& options) {
  const Peaks peaks = peaks_of(half_cycles, 0, half_cycles.amplitude.size());
  return averaged_loss_factor(peaks.time, peaks.amplitude, options);
}

LossFactor local_loss_factor(const HalfCycles& half_cycles, std::size_t first, std::size_t last,
                             const LogarithmicFit& fit) {
  const auto [time, amplitude] = peaks_of(half_cycles, first, last);
  LossFactor loss;
  if (time.size() < 3) return loss;
  std::vector<double> logarithms(time.size());
  for (std::size_t i = 0; i < time.size(); ++i) logarithms[i] = logarithm(amplitude[i]);
  const double widest = logarithm(fit.factor);
  const auto most = static_cast<std::size_t>(fit.most_half_cycles) / 2;
  for (auto* column : {&loss.amplitude, &loss.time, &loss.eta}) column->resize(time.size() - 2);
  for (std::size_t i = 1; i + 1 < time.size(); ++i) {
    const std::size_t farthest = std::min({most, i, time.size() - 1 - i});
    // Times and logarithms are counted from the middle peak's, so that the sums lose no digits.
    double sum_t = 0, sum_l = 0, sum_tt = 0, sum_tl = 0;
    std::size_t reach = 0;
    do {
      ++reach;
      const double t = time[i + reach] - time[i], l = logarithms[i + reach] - logarithms[i];
      const double t_before = time[i - reach] - time[i], l_before = logarithms[i - reach] - logarithms[i];
      sum_t += t + t_before;
      sum_l += l + l_before;
      sum_tt += t * t + t_before * t_before;
      sum_tl += t * l + t_before * l_before;
    } while (reach < farthest && std::abs(logarithms[i - reach - 1] - logarithms[i + reach + 1]) <= widest);
    const double points = static_cast<double>(2 * reach + 1), mean_time = sum_t / points;
    loss.amplitude[i - 1] = amplitude[i] * exponential(sum_l / points);
    loss.time[i - 1] = time[i];
    loss.eta[i - 1] = -2 * (sum_tl - mean_time * sum_l) / (sum_tt - mean_time * sum_t);
  }
  return loss;
}

LossFactor loss_before_failure(const Run& run) {
  const std::size_t failure = failure_row(run);
  const std::vector<double>& rows = run.half_cycles->amplitude;
  LossFactor loss = local_loss_factor(*run.half_cycles, 1, failure);
  if (failure == rows.size()) return loss;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < loss.eta.size(); ++i) {
    if (!(loss.amplitude[i] > rows[failure])) continue;
    for (auto* column : {&loss.amplitude, &loss.time, &loss.eta}) (*column)[kept] = (*column)[i];
    ++kept;
  }
  for (auto* column : {&loss.amplitude, &loss.time, &loss.eta}) column->resize(kept);
  return loss;
}

std::vector<double> ordinate(const LossFactor& loss, const Scene& scene, LossOrdinate which) {
  const double nu = scene.damper().mass_ratio, e = scene.damper().restitution, zeta = scene.damping_ratio;
  const auto value = [&](double amplitude, double eta) {
    const double specific = (eta - 2 * zeta) / nu;
    switch (which) {
      case LossOrdinate::eta:
        return eta;
      case LossOrdinate::specific:
        return eta / nu;
      case LossOrdinate::specific_secondary:
        return specific;
      case LossOrdinate::amplitude_times:
        return amplitude * specific;
      case LossOrdinate::by_restitution:
        return amplitude * specific / (1 - e);
      case LossOrdinate::carried:
        return amplitude * ((eta - 2 * zeta / (1 + nu)) / nu);
    }
    return 0.0;
  };
  std::vector<double> column(loss.eta.size());
  for (std::size_t i = 0; i < column.size(); ++i) column[i] = value(loss.amplitude[i], loss.eta[i]);
  return column;
}

}  // namespace impact_damper
