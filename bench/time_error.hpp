// Run time beside error: every scene, every contender, every setting.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "contender.hpp"
#include "impact_damper/engine.hpp"
#include "scenes.hpp"
#include "timing.hpp"

namespace impact_damper::bench {

// The error of a chaotic decay. No amplitude of it can be compared, but what comes of it: the averaged loss
// factor as a curve over the amplitude, held against the mean curve of an ensemble.
//
// The loss factor (averaged over 10 half cycles) at 60 amplitudes from 5 down to 0.1, equally spaced in their
// logarithm: where the decay first falls through each, between the two rows beside it. Absent if one of them
// is not passed or the rows are not valid.
std::optional<std::vector<double>> loss_curve(const std::vector<double>& peak_time,
                                              const std::vector<double>& amplitude);

// How many releases make one curve of a contender. One decay's own scatter, 0.011, hides what its method does
// to it; that of their mean is 0.001. (Of their median it is half as large again: where the motion has two
// ways to go on, the median jumps from one to the other.)
inline constexpr int releases = 128;

// At each of the amplitudes the mean of the curves, of which there must be one.
std::vector<double> mean_curve(const std::vector<std::vector<double>>& curves);

struct EnsembleCurve {
  std::vector<double> mean;  // eta, at each of the amplitudes
  Spread scatter;            // errors of its own groups of so many releases

  // An error up to this may be sampling scatter.
  double scatter_limit() const { return 2 * scatter.upper; }
};
// Of seven groups. Throws std::logic_error if a decay does not pass all the amplitudes.
EnsembleCurve ensemble_curve(const Scene& scene, const Engine& engine);

// Root mean square over the amplitudes of eta / mean - 1.
double curve_error(const EnsembleCurve& ensemble, const std::vector<double>& curve);

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
  const Point* best() const;  // of the smallest error, the first of them; null: no run can be compared
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
