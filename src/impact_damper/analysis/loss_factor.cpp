#include "impact_damper/analysis/loss_factor.hpp"

#include <Eigen/QR>
#include <stdexcept>
#include <string>

namespace impact_damper {
namespace {

constexpr int most_points = 19;
using Design = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, most_points, 3>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_points, 1>;

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

}  // namespace

LossFactor averaged_loss_factor(const std::vector<double>& peak_time, const std::vector<double>& amplitude,
                                const LossFactorOptions& options) {
  check(peak_time, amplitude, options.half_cycles);
  const std::size_t arm = static_cast<std::size_t>(options.half_cycles) / 2;
  const Eigen::Index points = options.half_cycles + 1;
  LossFactor loss;
  Design design(points, 3);
  Column value(points);
  for (std::size_t middle = arm; middle + arm < peak_time.size(); ++middle) {
    // Time is counted from the middle peak in half spans: the columns are then of order one, and value and
    // slope at the middle are the first two coefficients.
    const double origin = peak_time[middle];
    const double scale = (peak_time[middle + arm] - peak_time[middle - arm]) / 2;
    for (Eigen::Index i = 0; i < points; ++i) {
      const std::size_t at = middle - arm + static_cast<std::size_t>(i);
      const double s = (peak_time[at] - origin) / scale;
      design.row(i) << 1, s, s * s;
      value[i] = amplitude[at];
    }
    const Eigen::Vector3d parabola = design.householderQr().solve(value);
    loss.amplitude.push_back(parabola[0]);
    loss.time.push_back(origin);
    loss.eta.push_back(-2 * parabola[1] / (scale * parabola[0]));
  }
  return loss;
}

LossFactor averaged_loss_factor(const HalfCycles& half_cycles, const LossFactorOptions& options) {
  std::vector<double> time, amplitude;
  for (std::size_t i = 0; i < half_cycles.amplitude.size(); ++i) {
    if (!(half_cycles.amplitude[i] > 0)) continue;
    if (!time.empty() && !(half_cycles.peak_time[i] > time.back())) continue;
    time.push_back(half_cycles.peak_time[i]);
    amplitude.push_back(half_cycles.amplitude[i]);
  }
  return averaged_loss_factor(time, amplitude, options);
}

std::vector<double> ordinate(const LossFactor& loss, const Scene& scene, LossOrdinate which) {
  std::vector<double> column;
  column.reserve(loss.eta.size());
  for (std::size_t i = 0; i < loss.eta.size(); ++i) {
    const double specific = specific_secondary_loss(loss.eta[i], scene.damping_ratio, scene.mass_ratio);
    const double product = amplitude_times_loss(loss.amplitude[i], specific);
    double y = 0;
    switch (which) {
      case LossOrdinate::eta:
        y = loss.eta[i];
        break;
      case LossOrdinate::specific:
        y = specific_loss(loss.eta[i], scene.mass_ratio);
        break;
      case LossOrdinate::specific_secondary:
        y = specific;
        break;
      case LossOrdinate::amplitude_times:
        y = product;
        break;
      case LossOrdinate::by_restitution:
        y = loss_by_restitution(product, scene.restitution);
        break;
    }
    column.push_back(y);
  }
  return column;
}

}  // namespace impact_damper
