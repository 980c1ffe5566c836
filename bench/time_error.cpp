#include "time_error.hpp"

#include <cmath>
#include <stdexcept>

#include "impact_damper/analysis/ensemble.hpp"
#include "reference.hpp"

namespace impact_damper::bench {

Reference reference_of(const BenchScene& scene, Walls walls) {
  const Engine engine = walls == Walls::compliant ? Engine(Exact{}) : Engine(Restitution{});
  Reference reference{.scene = scene.name, .walls = walls};
  if (scene.chaotic) {
    reference.loss_curve = ensemble_curve(scene.scene, engine);
    return reference;
  }
  std::vector<double> in_long_double;
  if (walls == Walls::compliant) {
    reference.amplitude = reference_amplitudes(scene.scene, Exact{});
    in_long_double = long_double_amplitudes(scene.scene, Exact{});
  } else {
    reference.amplitude = reference_amplitudes(scene.scene, Restitution{});
    in_long_double = long_double_amplitudes(scene.scene, Restitution{});
  }
  // Where the reference is long double itself there is nothing to hold it against.
  if (reference_scalar() != "long double") {
    reference.from_long_double = amplitude_error(in_long_double, reference.amplitude);
  }
  return reference;
}

namespace {

// The error of a run whose rows are at hand; where the scene is chaotic, of a few more releases instead.
std::optional<double> error_of_setting(const BenchScene& scene, const Contender& contender, double setting,
                                       const Rows& own, const Reference& reference) {
  if (!scene.chaotic) return amplitude_error(own.amplitude, reference.amplitude);
  std::vector<std::vector<double>> curves;
  // Not the releases that the reference is made of.
  for (const Scene& release : ensemble_of(scene.scene, {.members = releases, .seed = 2})) {
    const Rows rows = contender.run(release, setting);
    auto curve = loss_curve(rows.peak_time, rows.amplitude);
    if (!curve) return std::nullopt;
    curves.push_back(std::move(*curve));
  }
  const double error = curve_error(*reference.loss_curve, median_curve(curves));
  return std::isfinite(error) ? std::optional(error) : std::nullopt;
}

}  // namespace

Curve measure_curve(const BenchScene& scene, const Contender& contender, bool ours,
                    const Reference& reference, const Limits& limits, const Told& told) {
  Curve curve{.scene = scene.name,
              .contender = contender.name,
              .walls = contender.walls,
              .ours = ours,
              .setting = contender.setting};
  told.curve(scene.name + " " + contender.name);
  std::vector<double> seconds;
  for (const double setting : contender.settings(scene.scene)) {
    // As much longer than the last as that was than the one before.
    if (!seconds.empty()) {
      const double before = seconds.size() > 1 ? seconds[seconds.size() - 2] : seconds.back();
      const double longest = scene.chaotic ? limits.longest_chaotic_run : limits.longest_run;
      if (seconds.back() * std::max(1.0, seconds.back() / before) > longest) {
        curve.cut = true;
        break;
      }
    }
    Point point{.setting = setting};
    try {
      Rows rows;
      const double first = cpu_seconds([&] { rows = contender.run(scene.scene, setting); });
      point.impacts = rows.impacts;
      point.error = error_of_setting(scene, contender, setting, rows, reference);
      const int repeats = first > limits.repeated_fully ? limits.few : limits.repeats;
      point.timing = measure([&] { contender.run(scene.scene, setting); }, repeats, first);
    } catch (const std::exception& error) {
      curve.failures.push_back(contender.setting + " " + std::to_string(setting) + ": " + error.what());
      continue;
    }
    seconds.push_back(point.timing.seconds.median);
    curve.points.push_back(point);
    told.point(curve, point);
  }
  return curve;
}

std::optional<double> time_at(const Curve& curve, double error) {
  const Point* before = nullptr;
  for (const Point& point : curve.points) {
    if (!point.error) continue;
    const double time = point.timing.yardsticks.median;
    if (*point.error <= error) {
      // An error of zero has no logarithm; nothing is coarser than the first.
      if (!before || !(*point.error > 0)) return time;
      const double part = std::log(*before->error / error) / std::log(*before->error / *point.error);
      const double coarser = before->timing.yardsticks.median;
      return coarser * std::pow(time / coarser, part);
    }
    before = &point;
  }
  return std::nullopt;
}

std::optional<double> least_error(const Curve& curve) {
  std::optional<double> least;
  for (const Point& point : curve.points) {
    if (point.error && !(least && *least <= *point.error)) least = point.error;
  }
  return least;
}

std::optional<double> observed_order(const Curve& curve, double below) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Point& point : curve.points) {
    if (!point.error || !(*point.error > 0 && *point.error < below)) continue;
    const double a = std::log(point.setting), b = std::log(*point.error);
    n += 1;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  if (n < 2) return std::nullopt;
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace impact_damper::bench
