#include "impact_damper/analysis/design.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {
namespace {

constexpr double natural_period = 2 * std::numbers::pi;
constexpr std::int64_t impacts_of_one_frequency = 20'000, steps_of_one_frequency = 1'000'000;

double loss_at(double restitution, double amplitude) {
  // At the fold itself rounding decides; a little above there is a motion.
  const auto motion = single_impact(restitution, amplitude * (1 + 1e-12));
  return motion ? motion->loss : 0;
}

// Long enough for the viscous transient to fall to a hundredth before the last half, within bounds.
double settling_time(const Scene& scene) {
  constexpr double least = 200 * natural_period, most = 1000 * natural_period;
  const double viscous = scene.damping_ratio > 0 ? 10 * (1 + scene.mass_ratio) / scene.damping_ratio : most;
  return std::max(std::clamp(viscous, least, most), 50 * natural_period / scene.force_frequency);
}

void sort_frequencies(std::vector<double>& frequencies) {
  constexpr double distinct = 1e-4;  // relative; closer ones are one
  std::ranges::sort(frequencies);
  const auto behind = std::unique(frequencies.begin(), frequencies.end(),
                                  [](double a, double b) { return b < a * (1 + distinct); });
  frequencies.erase(behind, frequencies.end());
}

std::vector<double> first_frequencies(const Scene& scene) {
  const double locked = 1 / std::sqrt(1 + scene.mass_ratio), given = scene.force_frequency;
  std::vector<double> frequencies{given, 0.97 * given, 1.03 * given};
  for (const double resonance : {locked, 1.0})
    for (const double away : {0.0, 0.001, 0.002, 0.004, 0.007, 0.012, 0.02, 0.035, 0.06, 0.1, 0.18})
      for (const double sign : {-1.0, 1.0}) frequencies.push_back(resonance * (1 + sign * away));
  for (int i = 1; i <= 5; ++i) frequencies.push_back(locked + (1 - locked) * i / 6);
  sort_frequencies(frequencies);
  return frequencies;
}

// Three more on either side of the worst one.
std::vector<double> closer_frequencies(const FrequencyResponse& response) {
  const auto worst = static_cast<std::size_t>(&response.worst() - response.points.data());
  std::vector<double> frequencies;
  const auto between = [&](std::size_t i) {
    const double from = response.points[i].frequency, to = response.points[i + 1].frequency;
    for (int k = 1; k <= 3; ++k) frequencies.push_back(from + (to - from) * k / 4);
  };
  if (worst > 0) between(worst - 1);
  if (worst + 1 < response.points.size()) between(worst);
  return frequencies;
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

ShortContact short_contact(const Scene& scene, Calibration calibration, double speed) {
  const double nu = scene.mass_ratio;
  const double z = zeta_m(scene, calibration) * std::sqrt(1 + nu);
  const double rate = omega_m(scene) * std::sqrt(1 + nu);
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

double initial_wall_force(const Scene& scene, Calibration calibration) {
  const double q = scene.y0 < 0 ? scene.y0 : scene.y0 > 1 ? scene.y0 - 1 : 0;
  if (q == 0) return 0;
  const double damping = 2 * scene.mass_ratio * omega_m(scene) * zeta_m(scene, calibration);
  return std::abs(scene.wall_stiffness * q + damping * scene.w0);
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

const ResponsePoint& FrequencyResponse::worst() const {
  return *std::ranges::max_element(points, {},
                                   [](const ResponsePoint& point) { return point.amplitude.mean; });
}

FrequencyResponse frequency_response(const Scene& scene, const Engine& engine, const Threads& threads,
                                     const std::function<void(std::size_t done)>& progress) {
  const Engine bounded = std::visit(
      [](auto each) -> Engine {
        each.budget.max_impacts = std::min(each.budget.max_impacts, impacts_of_one_frequency);
        each.max_steps = std::min(each.max_steps, steps_of_one_frequency);
        return each;
      },
      engine);
  FrequencyResponse response;
  response.time = settling_time(scene);
  std::size_t done = 0;
  const auto add = [&](const std::vector<double>& frequencies) {
    const auto batch = static_cast<std::size_t>(number_of(threads));
    for (std::size_t from = 0; from < frequencies.size(); from += batch) {
      std::vector<Scene> scenes;
      for (std::size_t i = from; i < std::min(from + batch, frequencies.size()); ++i) {
        scenes.push_back(scene);
        scenes.back().force_frequency = frequencies[i];
        scenes.back().until_time = response.time;
        scenes.back().until_amplitude.reset();
      }
      for (const Run& run : simulate_scenes(scenes, bounded, Record{}, threads))
        if (const auto amplitude = steady_amplitude(*run.half_cycles))
          response.points.push_back({run.scene.force_frequency, *amplitude});
      progress(done += scenes.size());
    }
    std::ranges::sort(response.points, {}, &ResponsePoint::frequency);
  };
  add(first_frequencies(scene));
  for (int round = 0; round < 2 && !response.empty(); ++round) add(closer_frequencies(response));
  return response;
}

}  // namespace impact_damper
