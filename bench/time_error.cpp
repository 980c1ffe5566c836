#include "time_error.hpp"

#include <cmath>
#include <stdexcept>

#include "impact_damper/analysis/ensemble.hpp"
#include "reference.hpp"

namespace impact_damper::bench {

std::optional<double> Reference::error_of(const Rows& rows) const {
  return loss_curve ? curve_error(*loss_curve, rows) : amplitude_error(rows.amplitude, amplitude);
}

Reference reference_of(const BenchScene& scene, Walls walls) {
  const Engine engine = walls == Walls::compliant ? Engine(Exact{}) : Engine(Restitution{});
  Reference reference{.scene = scene.name, .walls = walls};
  if (scene.chaotic) {
    reference.loss_curve = ensemble_curve(scene.scene, engine, 32);
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

// The error of a run whose rows are at hand. In a chaotic scene that is a matter of luck: the median over
// five releases, shifted as ensembles are, the scene's own among them.
std::optional<double> error_of_setting(const BenchScene& scene, const Contender& contender, double setting,
                                       const Rows& own, const Reference& reference) {
  if (!scene.chaotic) return reference.error_of(own);
  std::vector<double> errors;
  for (const Scene& release : ensemble_of(scene.scene, {.members = 5})) {
    const auto error = reference.error_of(release == scene.scene ? own : contender.run(release, setting));
    if (!error) return std::nullopt;
    errors.push_back(*error);
  }
  return spread_of(errors).median;
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
