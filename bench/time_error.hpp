// Run time beside error: every scene, every contender, every setting.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "contender.hpp"
#include "loss_curve.hpp"
#include "scenes.hpp"
#include "timing.hpp"

namespace impact_damper::bench {

// What a scene's errors are measured from.
struct Reference {
  std::string scene;
  Walls walls = Walls::compliant;
  std::vector<double> amplitude;            // of the exact or restitution engine in higher precision
  std::optional<double> from_long_double;   // its distance from the same engine in long double
  std::optional<double> from_independent;   // and from another integrator's, which the caller has
  std::optional<EnsembleCurve> loss_curve;  // chaotic scenes: this instead of all those
};
Reference reference_of(const BenchScene& scene, Walls walls);

struct Point {
  double setting = 0;
  std::int64_t impacts = 0;
  std::optional<double> error;  // absent: amplitudes that cannot be compared
  Timing timing;
};

struct Curve {
  std::string scene, contender;
  Walls walls = Walls::compliant;
  bool ours = false;
  std::string setting;        // see Contender
  std::vector<Point> points;  // coarsest first
  std::vector<std::string> failures;
  std::string cut = {};  // why finer settings were left out; empty: they were not

  const Point& finest() const { return points.back(); }
};

struct Limits {
  double longest_run = 1.8;           // seconds; finer settings than that are left out
  double longest_chaotic_run = 0.14;  // the same where an error takes many runs
  double repeated_fully = 0.4;        // seconds; longer runs are repeated `few` times
  int repeats = 7, few = 3;
};

// `told` is shown every curve before it is measured and every point after.
struct Told {
  std::function<void(const std::string& what)> curve;
  std::function<void(const Curve&, const Point&)> point;
};
Curve measure_curve(const BenchScene& scene, const Contender& contender, bool ours,
                    const Reference& reference, const Limits& limits, const Told& told);

// Reference operations that a curve takes for an error: on the straight line, in logarithms of both, from the
// last setting that misses `error` to the first that meets it. Absent if none does.
std::optional<double> time_at(const Curve& curve, double error);
// The same from the last setting that misses it: from there on the error stays below. Later than time_at
// where a setting meets an error by chance.
std::optional<double> time_for_good(const Curve& curve, double error);
// The slope of log error over log setting, by least squares over the points with an error below `below`, and
// its standard deviation as their residuals have it. Absent with fewer than four: a line through two or three
// has its slope by chance.
struct Order {
  double slope = 0, uncertainty = 0;
  int points = 0;
};
std::optional<Order> observed_order(const Curve& curve, double below);

}  // namespace impact_damper::bench
