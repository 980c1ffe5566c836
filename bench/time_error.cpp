#include "time_error.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/parallel.hpp"
#include "reference.hpp"

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
  ensemble.scatter = spread_of(errors);
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

Reference reference_of(const BenchScene& scene, Walls walls) {
  const Engine engine = walls == Walls::compliant ? Engine(Exact{}) : Engine(Restitution{});
  Reference reference{.scene = scene.name, .walls = walls};
  if (scene.chaotic) {
    reference.loss_curve = ensemble_curve(scene.scene, engine);
    return reference;
  }
  const Scene compared = compared_part(scene);
  std::vector<double> in_long_double;
  if (walls == Walls::compliant) {
    reference.amplitude = reference_amplitudes(compared, Exact{});
    in_long_double = long_double_amplitudes(compared, Exact{});
  } else {
    reference.amplitude = reference_amplitudes(compared, Restitution{});
    in_long_double = long_double_amplitudes(compared, Restitution{});
  }
  // Where the reference is long double itself there is nothing to hold it against.
  if (reference_scalar() != "long double") {
    reference.from_long_double = amplitude_error(in_long_double, reference.amplitude);
  }
  return reference;
}

namespace {

// The error of a run whose rows are at hand; where the scene is chaotic, of many more releases instead.
std::optional<double> error_of_setting(const BenchScene& scene, const Contender& contender, double setting,
                                       const Rows& own, const Reference& reference) {
  if (!scene.chaotic) {
    std::vector<double> compared = own.amplitude;
    if (scene.compared_until) compared.resize(std::min(compared.size(), reference.amplitude.size()));
    return amplitude_error(compared, reference.amplitude);
  }
  // Not the releases that the reference is made of.
  const std::vector<Scene> ensemble = ensemble_of(scene.scene, {.members = releases, .seed = 2});
  std::vector<std::optional<std::vector<double>>> found(ensemble.size());
  for_each_index(std::int64_t(ensemble.size()), {}, [&](std::int64_t i) {
    const Rows rows = contender.run(ensemble[std::size_t(i)], setting);
    found[std::size_t(i)] = loss_curve(rows.peak_time, rows.amplitude);
  });
  std::vector<std::vector<double>> curves;
  for (auto& curve : found) {
    if (!curve) return std::nullopt;
    curves.push_back(std::move(*curve));
  }
  const double error = curve_error(*reference.loss_curve, mean_curve(curves));
  return std::isfinite(error) ? std::optional(error) : std::nullopt;
}

// On the straight line through the last two points, in both logarithms; never less than the last.
double seconds_expected(const std::vector<Point>& points, double setting) {
  const Point& last = points.back();
  const double seconds = last.timing.seconds.median;
  if (points.size() < 2) return seconds;
  const Point& before = points[points.size() - 2];
  const double growth =
      std::log(seconds / before.timing.seconds.median) / std::log(last.setting / before.setting);
  return std::max(seconds, seconds * std::pow(setting / last.setting, growth));
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
  int within_scatter = 0;
  for (const double setting : contender.settings(scene.scene)) {
    if (!curve.points.empty()) {
      const double longest = scene.chaotic ? limits.longest_chaotic_run : limits.longest_run;
      if (seconds_expected(curve.points, setting) > longest) {
        curve.cut = "a run would take too long";
        break;
      }
    }
    if (within_scatter == 2) {
      curve.cut = "two errors within the sampling scatter";
      break;
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
    curve.points.push_back(point);
    if (scene.chaotic && point.error && *point.error <= reference.loss_curve->scatter_limit())
      ++within_scatter;
    told.point(curve, point);
  }
  return curve;
}

namespace {

// On the straight line from one point to the next, in both logarithms.
double time_between(const Point* missing, const Point& meeting, double error) {
  const double time = meeting.timing.reference_operations.median;
  // An error of zero has no logarithm; nothing is coarser than the first.
  if (!missing || !(*meeting.error > 0)) return time;
  const double part = std::log(*missing->error / error) / std::log(*missing->error / *meeting.error);
  const double coarser = missing->timing.reference_operations.median;
  return coarser * std::pow(time / coarser, part);
}

}  // namespace

const Point* Curve::best() const {
  const Point* found = nullptr;
  for (const Point& point : points) {
    if (point.error && !(found && *found->error <= *point.error)) found = &point;
  }
  return found;
}

std::optional<double> time_at(const Curve& curve, double error) {
  const Point* missing = nullptr;
  for (const Point& point : curve.points) {
    if (!point.error) continue;
    if (*point.error <= error) return time_between(missing, point, error);
    missing = &point;
  }
  return std::nullopt;
}

std::optional<double> time_for_good(const Curve& curve, double error) {
  const Point* missing = nullptr;
  std::optional<double> time;
  for (const Point& point : curve.points) {
    if (!point.error) continue;
    if (!(*point.error <= error)) {
      missing = &point;
      time.reset();
    } else if (!time) {
      time = time_between(missing, point, error);
    }
  }
  return time;
}

std::optional<Order> observed_order(const Curve& curve, double below) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (const Point& point : curve.points) {
    if (!point.error || !(*point.error > 0 && *point.error < below)) continue;
    const double a = std::log(point.setting), b = std::log(*point.error);
    n += 1;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
    yy += b * b;
  }
  if (n < 4) return std::nullopt;
  const double spread_x = xx - x * x / n, spread_y = yy - y * y / n;
  const double slope = (xy - x * y / n) / spread_x;
  const double residual = std::max(0.0, spread_y - slope * slope * spread_x);
  return Order{slope, std::sqrt(residual / (n - 2) / spread_x), int(n)};
}

}  // namespace impact_damper::bench
