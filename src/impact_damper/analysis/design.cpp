#include "impact_damper/analysis/design.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {
namespace {

double loss_at(double restitution, double amplitude) {
  // At the fold itself rounding decides whether there is a motion; a little above it there is one.
  const auto motion = single_impact(restitution, amplitude * (1 + 1e-12));
  return motion ? motion->loss : 0;
}

}  // namespace

ClearanceRule clearance_rule(double restitution, const Tolerances& tolerances) {
  ClearanceRule rule;
  rule.fold = fold_amplitude(restitution);
  rule.worst_restitution = std::max(0.0, restitution - tolerances.restitution);
  rule.worst_fold = fold_amplitude(rule.worst_restitution);
  const double smaller = (1 - tolerances.amplitude) / (1 + tolerances.clearance);
  rule.margin = std::max(least_margin, rule.worst_fold / (rule.fold * smaller));
  rule.amplitude = rule.margin * rule.fold;
  rule.loss = loss_at(restitution, rule.amplitude);
  rule.worst_amplitude = rule.amplitude * smaller;
  rule.worst_loss = loss_at(rule.worst_restitution, rule.worst_amplitude);
  return rule;
}

ShortContact short_contact(const SceneDamper& damper, Calibration calibration, double speed) {
  const double nu = damper.mass_ratio;
  const double z = zeta_m(damper, calibration) * std::sqrt(1 + nu);
  const double rate = omega_m(damper) * std::sqrt(1 + nu);
  double largest = 2 * z;  // the damper's, at touch
  if (z < 0.5) {
    const double omega = std::sqrt((1 - z) * (1 + z));
    const double angle = angle_of((1 - 4 * z * z) * omega, z * (3 - 4 * z * z));
    const auto [sin, cos] = sin_cos(angle);
    largest = exponential(-z * angle / omega) * (2 * z * cos + (1 - 2 * z * z) / omega * sin);
  }
  ShortContact contact;
  contact.force = nu / (1 + nu) * rate * speed * largest;
  if (z < 1) contact.duration = std::numbers::pi / (rate * std::sqrt((1 - z) * (1 + z)));
  return contact;
}

double initial_wall_force(const SceneDamper& damper, Calibration calibration) {
  const double q = damper.y0 < 0 ? damper.y0 : std::max(0.0, damper.y0 - damper.clearance);
  if (q == 0) return 0;
  const double damping = 2 * damper.mass_ratio * omega_m(damper) * zeta_m(damper, calibration);
  return std::abs(damper.wall_stiffness * q + damping * damper.w0);
}

double linear_response(double force, double mass, double damping_ratio, double frequency) {
  const double real = 1 - mass * frequency * frequency, imaginary = 2 * damping_ratio * frequency;
  return std::abs(force) / std::sqrt(real * real + imaginary * imaginary);
}

WorstResponse worst_linear_response(double force, double mass, double damping_ratio) {
  const double twice_square = 2 * damping_ratio * damping_ratio;
  if (!(twice_square < mass)) return {0, std::abs(force)};
  const double frequency = std::sqrt(mass - twice_square) / mass;
  if (damping_ratio == 0) return {frequency, std::numeric_limits<double>::infinity()};
  return {frequency,
          std::abs(force) * mass / (2 * damping_ratio * std::sqrt(mass - damping_ratio * damping_ratio))};
}

std::optional<SteadyAmplitude> steady_amplitude(const HalfCycles& half_cycles) {
  constexpr std::size_t least_half_cycles = 12;
  constexpr double much = 0.02;
  const std::vector<double>& all = half_cycles.amplitude;
  if (all.size() < least_half_cycles) return std::nullopt;
  const auto quarter = static_cast<std::ptrdiff_t>(all.size() / 4);
  const auto mean_from = [&](std::ptrdiff_t from_end) {
    const auto begin = all.end() - from_end;
    return std::accumulate(begin, begin + quarter, 0.0) / static_cast<double>(quarter);
  };
  const auto [least, greatest] = std::minmax_element(all.end() - quarter, all.end());
  const double mean = mean_from(quarter), before = mean_from(2 * quarter);
  return SteadyAmplitude{*least, mean, *greatest, std::abs(mean - before) <= much * std::max(mean, before)};
}

}  // namespace impact_damper
