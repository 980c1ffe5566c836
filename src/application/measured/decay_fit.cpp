#include "application/measured/decay_fit.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "application/sweeps/sampling.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/math/dense.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

// Straight line fitted by least squares; the variance of its slope follows from `squares`, the sum of (x -
// mean_x)^2.
struct Line {
  double slope = 0, mean_x = 0, mean_y = 0, squares = 0;
};

Line line_through(const Vector& all_x, const Vector& all_y, const IndexRange& rows) {
  const auto x = std::span(all_x).subspan(rows.first, rows.size()),
             y = std::span(all_y).subspan(rows.first, rows.size());
  Line line;
  const double count = double(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    line.mean_x += (x[i] - x[0]) / count, line.mean_y += (y[i] - y[0]) / count;
  line.mean_x += x[0], line.mean_y += y[0];
  double products = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    line.squares += (x[i] - line.mean_x) * (x[i] - line.mean_x);
    products += (x[i] - line.mean_x) * (y[i] - line.mean_y);
  }
  line.slope = products / line.squares;
  return line;
}

// Returns the rows of each bin: from the first at or below its upper end to the last before the first below
// its lower end.
std::vector<IndexRange> rows_of_bins(const Vector& logarithms, const std::vector<LossBin>& bins) {
  std::vector<IndexRange> ranges;
  std::size_t at = 0;
  for (const LossBin& bin : bins) {
    const double upper = logarithm(bin.upper), lower = logarithm(bin.lower);
    while (at < logarithms.size() && logarithms[at] > upper) ++at;
    std::size_t end = at;
    while (end < logarithms.size() && logarithms[end] >= lower) ++end;
    ranges.push_back({at, end});
    at = end;
  }
  return ranges;
}

Vector logarithms_of(const Vector& amplitude, double length) {
  Vector logarithms;
  logarithms.reserve(amplitude.size());
  for (const double each : amplitude)
    logarithms.push_back(logarithm(std::max(each * length, std::numeric_limits<double>::min())));
  return logarithms;
}

double log_loss_error(const Reduction& reduction, const Line& line, const IndexRange& rows) {
  double variance = 0;
  for (std::size_t i = rows.first; i < rows.end; ++i) {
    const double part = (reduction.time[i] - line.mean_x) * reduction.error[i] / reduction.amplitude[i];
    variance += part * part / (line.squares * line.squares);
  }
  return std::sqrt(variance) / std::abs(line.slope);
}

// Returns the largest coefficient of friction with which the secondary mass is not held at this amplitude, mm
// (M15.14); 0 if there is none.
double most_friction(SceneInUnits scene, double amplitude) {
  scene.damper().friction_coefficient = 1;
  const Scene made = dimensionless(scene);
  const double most = amplitude / *scene.damper().clearance / (1 + made.damper().mass_ratio);
  return std::max(0.0, (most - made.weight) / made.damper().friction);
}

double normal_deviate_of(double chi_square, double degrees) {  // (M16.9)
  const double ninth = 2 / (9 * degrees);
  const double ratio = std::max(chi_square, std::numeric_limits<double>::min()) / degrees;
  return (exponential(logarithm(ratio) / 3) - (1 - ninth)) / std::sqrt(ninth);
}

// A parameter has the name of its field.
const UnitField& field_of(FitParameter parameter) {
  return *std::ranges::find(unit_fields, name_of(parameter), &UnitField::name);
}

}  // namespace

// --- Bins -------------------------------------------------------------------------------------------------

std::vector<LossBin> loss_bins(const Reduction& reduction) {
  constexpr std::size_t least_rows = 8;
  constexpr std::int64_t longest_gap = 3;                             // half cycles
  constexpr double usual_ratio = 0.25, most_bins = 16, few_bins = 8;  // usual_ratio: of ln A
  constexpr double good_error = 0.1, worst_error = 0.3;
  const Vector logarithms = logarithms_of(reduction.amplitude, 1);
  const double whole = logarithms.front() - logarithms.back();
  const double ratio = std::max(std::min(usual_ratio, whole / few_bins), whole / most_bins);
  const double widest = std::max(4 * usual_ratio, ratio);
  const auto line_of = [&](const IndexRange& rows) { return line_through(reduction.time, logarithms, rows); };
  // Bins end halfway between rows, so that the same decay has the same rows in each bin.
  const auto end_before = [&](std::size_t row) {
    if (row == 0) return reduction.amplitude[0];
    if (row == logarithms.size()) return reduction.amplitude.back();
    return exponential((logarithms[row - 1] + logarithms[row]) / 2);
  };
  std::vector<LossBin> bins;
  for (std::size_t first = 0, next = 1; next <= logarithms.size(); ++next) {
    const bool ends = next == logarithms.size() ||
                      reduction.half_cycle[next] - reduction.half_cycle[next - 1] > longest_gap;
    const IndexRange rows{first, next};
    if (next - first >= least_rows) {
      const Line line = line_of(rows);
      const double error = log_loss_error(reduction, line, rows);
      LossBin bin{end_before(first), end_before(next)};
      // No bin contains a gap.
      if (first > 0 && reduction.half_cycle[first] - reduction.half_cycle[first - 1] > longest_gap)
        bin.upper = reduction.amplitude[first];
      if (ends) bin.lower = reduction.amplitude[next - 1];
      const double covered = logarithm(bin.upper / bin.lower);
      const bool is_full = covered >= ratio && (error <= good_error || covered >= widest);
      const bool is_rest = ends && covered >= ratio / 2;
      if ((is_full || is_rest) && line.slope < 0 && error < worst_error) {
        bins.push_back(bin);
        first = next;
      }
    }
    if (ends) first = next;
  }
  // The loss factor of a bin follows by the same rule as that of a simulated decay.
  const std::vector<IndexRange> ranges = rows_of_bins(logarithms, bins);
  std::vector<LossBin> valid;
  IndexRange all;  // of the valid bins
  double largest = 0;
  for (std::size_t k = 0; k < bins.size(); ++k) {
    if (ranges[k].end < ranges[k].first + least_rows) continue;
    const Line line = line_of(ranges[k]);
    LossBin bin = bins[k];
    bin.loss = -2 * line.slope;  // divided by omega below
    bin.error = log_loss_error(reduction, line, ranges[k]);
    bin.half_cycles = std::int64_t(ranges[k].end - ranges[k].first);
    if (!(bin.loss > 0 && bin.error < worst_error)) continue;
    // After impact failure single impacts decide the loss. Scatter about a mean does not describe that.
    constexpr double failed = 0.5;  // of the largest loss factor
    if (bin.loss < failed * largest) break;
    largest = std::max(largest, bin.loss);
    if (valid.empty()) all.first = ranges[k].first;
    all.end = ranges[k].end;
    valid.push_back(bin);
  }
  if (valid.empty()) return valid;
  // The mean frequency is that of the bins, not of the record, because it rises where impacts fail (M16.5).
  const double omega = half_turn<double>() *
                       double(reduction.half_cycle[all.end - 1] - reduction.half_cycle[all.first]) /
                       (reduction.time[all.end - 1] - reduction.time[all.first]);
  for (LossBin& each : valid) each.loss /= omega;
  return valid;
}

std::vector<double> log_losses(const HalfCycles& rows, double length, const std::vector<LossBin>& bins) {
  constexpr std::size_t least_rows = 4;
  const Vector logarithms = logarithms_of(rows.amplitude, length);
  Vector losses;
  const std::vector<IndexRange> ranges = rows_of_bins(logarithms, bins);
  for (auto [first, end] : ranges) {
    if (end < first + least_rows) {  // after strong damping: neighbouring rows are used, too
      first = first > 0 ? first - 1 : first;
      end = first + least_rows;
      if (end > logarithms.size()) break;
    }
    const Line line = line_through(rows.peak_time, logarithms, {first, end});
    if (!(line.slope < 0)) break;
    losses.push_back(-2 * line.slope);
  }
  if (losses.empty()) return losses;
  // A bin above all of the decay has no rows: its end may be 0.
  const std::size_t first = ranges.front().first,
                    end = std::min(ranges[losses.size() - 1].end, logarithms.size());
  if (end < first + 2) return {};
  const double omega =
      half_turn<double>() * double(end - 1 - first) / (rows.peak_time[end - 1] - rows.peak_time[first]);
  for (double& each : losses) each = logarithm(each / omega);
  return losses;
}

// --- Parameters -------------------------------------------------------------------------------------------

std::string_view unit_of(FitParameter parameter) { return unit_of(field_of(parameter).dimension, true); }
double value_of(const SceneInUnits& scene, FitParameter parameter) {
  if (const auto& given = field_of(parameter).number.in(scene)) return *given;
  if (parameter == FitParameter::friction_coefficient) return 0;
  const Scene made = dimensionless(scene);
  return parameter == FitParameter::restitution ? made.damper().restitution : made.damping_ratio;
}
void set_value(SceneInUnits& scene, FitParameter parameter, double value) {
  if (parameter == FitParameter::damping_ratio) scene.damping.reset();
  field_of(parameter).number.in(scene) = value;
}

Scene decay_scene(const SceneInUnits& scene, const Reduction& reduction, double until, std::uint64_t seed,
                  std::int64_t draw) {
  constexpr double above = 1.1, below = 0.97, longer = 3;
  constexpr std::uint32_t place_in_cavity = 100;  // a number that no axis has in a draw
  SceneInUnits released = scene;
  released.initial_displacement = above * reduction.amplitude.front();
  released.initial_velocity.reset();
  released.damper().secondary_velocity.reset();
  released.damper().secondary_displacement.reset();
  released.until_millimetres = below * until;
  released.until_seconds = longer * (reduction.time.back() - reduction.time.front());
  Scene made = dimensionless(released);
  made.damper().y0 = uniform_draw({seed, place_in_cavity, draw});
  return made;
}

namespace {

// --- The searched range -----------------------------------------------------------------------------------

// Searched range of a parameter in a coordinate of which the loss factor is nearly a polynomial: ln(1 - e),
// zeta, ln epsilon, ln m or mu. value() returns the parameter at a fraction of the range, from 0 to 1.
struct SearchedRange {
  FitParameter parameter = FitParameter::restitution;
  double from = 0, to = 1;  // coordinates of the ends
  double value(double part) const {
    const double coordinate = from + (to - from) * part;
    if (is_bounded_by_0(parameter)) return coordinate;
    const double number = exponential(coordinate);
    return parameter == FitParameter::restitution ? 1 - number : number;
  }
};

SearchedRange searched_range(FitParameter parameter, const SceneInUnits& scene,
                             const std::vector<LossBin>& bins) {
  constexpr double least_restitution = 0.02, most_restitution = 0.95, clearance_factor = 3, mass_factor = 2;
  constexpr double beyond = 1.5;  // margin above the zeta whose viscous loss 2 zeta is the whole loss
  const auto about = [&](double factor) -> SearchedRange {
    const double given = std::max(value_of(scene, parameter), std::numeric_limits<double>::min());
    return {parameter, logarithm(given) - logarithm(factor), logarithm(given) + logarithm(factor)};
  };
  switch (parameter) {
    case FitParameter::restitution:
      return {parameter, logarithm(1 - least_restitution), logarithm(1 - most_restitution)};
    case FitParameter::damping_ratio:
      return {parameter, 0, beyond * std::ranges::min_element(bins, {}, &LossBin::loss)->loss / 2};
    case FitParameter::clearance:
      return about(clearance_factor);
    case FitParameter::friction_coefficient:
      return {parameter, 0, most_friction(scene, bins.back().lower)};
    case FitParameter::secondary_mass:
      break;
  }
  return about(mass_factor);
}

// A box in the searched range, in fractions of it.
struct Box {
  Vector low, high;
  double width(std::size_t axis) const { return high[axis] - low[axis]; }
  double at(std::size_t axis, double part) const { return low[axis] + width(axis) * part; }
};

// --- The loss factor as a polynomial ----------------------------------------------------------------------

struct Points {
  Matrix place;  // a row for each run with a loss factor in every bin, in fractions of the ranges
  Matrix loss;   // ln eta of each bin
};

Matrix transposed(const Matrix& a) {
  Matrix columns(a.front().size(), Vector(a.size()));
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < a[i].size(); ++j) columns[j][i] = a[i][j];
  return columns;
}

// Returns the dot products of each two rows: a a^T.
Matrix products_of_rows(const Matrix& a) {
  Matrix products;
  for (const Vector& row : a) products.push_back(product(a, row));
  return products;
}

// Quadratic polynomial of ln eta of each bin over a box, and the covariance of the runs about it (M16.6).
struct Emulator {
  Vector scatter;  // standard deviations of ln eta
  Box box;
  Matrix coefficients;
  Cholesky covariance;
  Vector observed;  // ln eta of the record

  // Returns the fitted polynomial; nothing if it has fewer than least_runs for each coefficient or a singular
  // matrix.
  static std::optional<Emulator> fitted(const Points& points, const Box& box,
                                        const std::vector<LossBin>& bins) {
    const std::size_t count = points.place.size(), terms = terms_of(Vector(box.low.size(), 0.0)).size();
    if (count < least_runs * terms) return {};
    Matrix design;
    for (const Vector& place : points.place) design.push_back(terms_of(within(box, place)));
    const Matrix columns = transposed(design);
    const auto normal = Cholesky::of(products_of_rows(columns));
    if (!normal) return {};
    Matrix residual = transposed(points.loss), coefficients;
    for (Vector& losses : residual) {
      coefficients.push_back(normal->solution(product(columns, losses)));
      const Vector polynomial = product(design, coefficients.back());
      for (std::size_t i = 0; i < count; ++i) losses[i] -= polynomial[i];
    }
    Matrix covariance = products_of_rows(residual);
    Vector scatter, observed;
    for (std::size_t a = 0; a < bins.size(); ++a) {
      for (double& entry : covariance[a]) entry /= double(count - terms);
      scatter.push_back(std::sqrt(covariance[a][a]));
      covariance[a][a] += bins[a].error * bins[a].error;
      observed.push_back(logarithm(bins[a].loss));
    }
    auto factor = Cholesky::of(std::move(covariance));
    if (!factor) return {};
    return Emulator{std::move(scatter), box, std::move(coefficients), *std::move(factor),
                    std::move(observed)};
  }

  Vector log_loss(const Vector& place) const { return product(coefficients, terms_of(within(box, place))); }
  double chi_square(const Vector& place) const {  // (M16.7)
    Vector deviation = log_loss(place);
    for (std::size_t k = 0; k < deviation.size(); ++k) deviation[k] -= observed[k];
    deviation = covariance.forward(std::move(deviation));
    return dot_product(deviation, deviation);
  }

 private:
  static constexpr std::size_t least_runs = 5;  // for each coefficient

  static Vector within(const Box& box, const Vector& place) {  // z: from -1 to 1
    Vector z(place.size());
    for (std::size_t j = 0; j < place.size(); ++j) z[j] = 2 * (place[j] - box.low[j]) / box.width(j) - 1;
    return z;
  }
  static Vector terms_of(const Vector& z) {
    Vector terms{1};
    for (std::size_t j = 0; j < z.size(); ++j) {
      terms.push_back(z[j]);
      for (std::size_t k = 0; k <= j; ++k) terms.push_back(z[j] * z[k]);
    }
    return terms;
  }
};

// Where decays are simulated: the points of a box at which chi square of the previous stage's polynomial, if
// there was one, is at most `limit`.
struct Region {
  Box box;
  std::optional<Emulator> before;
  std::optional<double> limit;
  bool is_near(const Vector& place) const { return !limit || before->chi_square(place) <= *limit; }
};

// --- Runs in a box ----------------------------------------------------------------------------------------

// Simulates decays of a scene with other numbers.
struct DecaySampler {
  const SceneInUnits& scene;
  const Engine& engine;
  const Reduction& reduction;
  const std::vector<LossBin>& bins;
  const FitOptions& options;
  const std::function<void(const std::string&)>& tell;
  std::vector<SearchedRange> ranges{};
  std::int64_t runs = 0;  // so far
  int stage = 0;          // the last

  // Simulates one decay at each of `wanted` points of a Latin hypercube in the region, or at fewer if its
  // points are rare in its box. Returns the runs that have a loss factor in every bin.
  Points points(const Region& region, std::int64_t wanted) {
    constexpr std::int64_t most_candidates = 64;  // for each wanted point
    const std::uint64_t seed = (options.seed << 8) + std::uint64_t(++stage);
    std::vector<Vector> places;
    const std::int64_t candidates = wanted * most_candidates;
    for (std::int64_t i = 0; i < candidates && std::int64_t(places.size()) < wanted; ++i) {
      Vector place(ranges.size());
      for (std::size_t j = 0; j < place.size(); ++j)
        place[j] = region.box.at(j, stratified_draw({seed, std::uint32_t(j), i}, candidates));
      if (region.is_near(place)) places.push_back(std::move(place));
    }
    const auto count = std::int64_t(places.size());
    Matrix losses(places.size());
    std::atomic<std::int64_t> done{0};
    for_each_index(count, options.threads, [&](std::int64_t i) {
      SceneInUnits varied = scene;
      for (std::size_t j = 0; j < ranges.size(); ++j)
        set_value(varied, ranges[j].parameter, ranges[j].value(places[std::size_t(i)][j]));
      const Scene decay = decay_scene(varied, reduction, bins.back().lower, seed, i);
      losses[std::size_t(i)] =
          log_losses(simulated_half_cycles(decay, engine), *varied.damper().clearance, bins);
      constexpr std::int64_t often = 50;
      if (const std::int64_t all = ++done; all % often == 0)
        tell(filled("fitting, stage {}, {} of {} runs", stage, all, count));
    });
    runs += count;
    Points points;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (losses[i].size() < bins.size()) continue;
      points.place.push_back(std::move(places[i]));
      points.loss.push_back(std::move(losses[i]));
    }
    return points;
  }
};

// Returns the indices of the points, those nearest to the record first.
std::vector<std::size_t> by_nearness(const Points& points, const std::vector<LossBin>& bins) {
  constexpr double usual_scatter = 0.1;
  std::vector<std::pair<double, std::size_t>> distances;
  for (std::size_t i = 0; i < points.loss.size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < bins.size(); ++k) {
      const double d = points.loss[i][k] - logarithm(bins[k].loss);
      sum += d * d / (bins[k].error * bins[k].error + usual_scatter * usual_scatter);
    }
    distances.emplace_back(sum, i);
  }
  std::ranges::sort(distances);
  std::vector<std::size_t> order(distances.size());
  std::ranges::transform(distances, order.begin(), [](const auto& each) { return each.second; });
  return order;
}

// Returns the box about the fraction `kept` of the points that is nearest to the record, with a margin.
Box box_of_nearest(const Points& points, const std::vector<LossBin>& bins, const Box& box, double kept) {
  constexpr double margin = 0.15;
  std::vector<std::size_t> order = by_nearness(points, bins);
  order.resize(std::size_t(kept * double(order.size())));
  Box next = box;
  for (std::size_t j = 0; j < box.low.size(); ++j) {
    double low = 1, high = 0;
    for (const std::size_t i : order) {
      low = std::min(low, points.place[i][j]);
      high = std::max(high, points.place[i][j]);
    }
    const double more = margin * (high - low);
    next.low[j] = std::max(0.0, low - more), next.high[j] = std::min(1.0, high + more);
  }
  return next;
}

// --- chi square on a grid ---------------------------------------------------------------------------------

struct Profiles {
  double least = std::numeric_limits<double>::infinity();
  Vector best;
  Matrix of;  // for each axis: least chi square at each of its nodes
  Matrix correlation;
};

// Computes chi square on a grid over the region's box and returns its minimum, its profile along each axis
// and the correlations. Outside of the region, no run was simulated and chi square counts as infinite.
Profiles profiles_of(const Emulator& emulator, const Region& region, std::size_t nodes) {
  const std::size_t axes = region.box.low.size();
  Profiles profiles;
  profiles.of.assign(axes, Vector(nodes, std::numeric_limits<double>::infinity()));
  std::size_t all = 1;
  for (std::size_t j = 0; j < axes; ++j) all *= nodes;
  const auto index = [&](std::size_t i, std::size_t axis) {
    for (std::size_t j = 0; j < axis; ++j) i /= nodes;
    return i % nodes;
  };
  Vector place(axes), values(all);
  for (std::size_t i = 0; i < all; ++i) {
    for (std::size_t j = 0; j < axes; ++j)
      place[j] = region.box.low[j] + region.box.width(j) * double(index(i, j)) / double(nodes - 1);
    values[i] = region.is_near(place) ? emulator.chi_square(place) : std::numeric_limits<double>::infinity();
    if (values[i] < profiles.least) profiles.least = values[i], profiles.best = place;
    for (std::size_t j = 0; j < axes; ++j) {
      double& least = profiles.of[j][index(i, j)];
      least = std::min(least, values[i]);
    }
  }
  // Moments with the weights exp(-chi^2 / 2).
  Vector mean(axes, 0.0);
  Matrix moments(axes, Vector(axes, 0.0));
  double sum = 0;
  for (std::size_t i = 0; i < all; ++i) {
    if (!std::isfinite(values[i])) continue;
    const double weight = exponential(-(values[i] - profiles.least) / 2);
    for (std::size_t j = 0; j < axes; ++j) place[j] = double(index(i, j)) / double(nodes - 1);
    sum += weight;
    for (std::size_t j = 0; j < axes; ++j) {
      mean[j] += weight * place[j];
      for (std::size_t k = 0; k < axes; ++k) moments[j][k] += weight * place[j] * place[k];
    }
  }
  profiles.correlation.assign(axes, Vector(axes, 0.0));
  const auto covariance = [&](std::size_t j, std::size_t k) {
    return moments[j][k] / sum - mean[j] / sum * (mean[k] / sum);
  };
  for (std::size_t j = 0; j < axes; ++j) {
    for (std::size_t k = 0; k < axes; ++k) {
      const double scale = std::sqrt(covariance(j, j) * covariance(k, k));
      profiles.correlation[j][k] = j == k ? 1 : scale > 0 ? covariance(j, k) / scale : 0;
    }
  }
  return profiles;
}

// Outermost points at which a profile is at most `limit`, by linear interpolation between nodes.
struct Interval {
  double low = 0, high = 1;  // in fractions of the box
  bool reaches_low = false, reaches_high = false;
};
Interval interval_of(const Vector& profile, double limit) {
  const std::size_t nodes = profile.size();
  std::size_t first = 0, last = nodes - 1;
  while (first + 1 < nodes && profile[first] > limit) ++first;
  while (last > 0 && profile[last] > limit) --last;
  const auto crossing = [&](std::size_t inside, std::size_t outside) {
    return double(inside) + (double(outside) - double(inside)) * (limit - profile[inside]) /
                                (profile[outside] - profile[inside]);
  };
  Interval interval{.reaches_low = first == 0, .reaches_high = last == nodes - 1};
  interval.low = (first == 0 ? 0 : crossing(first, first - 1)) / double(nodes - 1);
  interval.high = (last == nodes - 1 ? double(last) : crossing(last, last + 1)) / double(nodes - 1);
  return interval;
}

// Box in which every profile is at most `limit`, wider by a margin. was_too_small: a profile is at most
// `limit` at an end of `box` inside the searched range; the new box then extends beyond that end.
struct Narrowed {
  Box box;
  bool was_too_small = false;
};
Narrowed narrowed(const Profiles& profiles, const Box& box, double limit) {
  Narrowed next{box};
  for (std::size_t j = 0; j < box.low.size(); ++j) {
    const Interval interval = interval_of(profiles.of[j], limit);
    const double width = box.width(j);
    constexpr double wider = 0.5, margin = 0.05;
    const bool below = interval.reaches_low && box.low[j] > 0,
               above = interval.reaches_high && box.high[j] < 1;
    next.box.low[j] = std::max(0.0, box.low[j] + width * (below ? -wider : interval.low - margin));
    next.box.high[j] = std::min(1.0, box.low[j] + width * (above ? 1 + wider : interval.high + margin));
    next.was_too_small = next.was_too_small || below || above;
  }
  return next;
}

Box half_about(const Vector& place, const Box& box) {
  Box half = box;
  for (std::size_t j = 0; j < place.size(); ++j) {
    const double quarter = box.width(j) / 4;
    half.low[j] = std::max(box.low[j], place[j] - quarter);
    half.high[j] = std::min(box.high[j], place[j] + quarter);
  }
  return half;
}

// Whether the scatter is less than `than` in most bins, by more than chance.
bool is_less(const Vector& scatter, const Vector& than) {
  constexpr double clearly = 0.8;  // the scatter estimated from some hundred runs errs by a few percent
  std::size_t less = 0;
  for (std::size_t k = 0; k < scatter.size(); ++k) less += scatter[k] < clearly * than[k] ? 1 : 0;
  return 2 * less > scatter.size();
}

std::size_t nodes_for(std::size_t axes) {
  constexpr std::array<std::size_t, 5> nodes{1, 401, 121, 41, 21};
  return nodes[axes];
}

// Fits in a box, after some stages in each of which it shrinks to the fraction `kept` of the runs that is
// nearest: while it is wide, no polynomial follows the loss factor. Absent if too few runs pass through the
// record's amplitudes.
constexpr double kept = 0.1;
std::optional<DecayFit> fit_in(DecaySampler& sampler, Box box_to_begin, int coarse_stages) {
  const FitOptions& options = sampler.options;
  const std::vector<LossBin>& bins = sampler.bins;
  const std::size_t count = options.parameters.size(), nodes = nodes_for(count);
  Region region{.box = std::move(box_to_begin), .before = {}, .limit = {}};
  constexpr int most_stages = 9;
  constexpr double generous = 16;  // chi square above its least: four standard deviations
  for (int stage = 0; stage < coarse_stages; ++stage) {
    const Points points = sampler.points(region, options.runs);
    if (double(points.loss.size()) * kept < double(4 * count)) return std::nullopt;
    region.box = box_of_nearest(points, bins, region.box, kept);
  }
  std::optional<Emulator> emulator;
  Profiles profiles;
  const auto refine = [&](std::int64_t runs) {
    emulator = Emulator::fitted(sampler.points(region, runs), region.box, bins);
    if (!emulator) return false;
    profiles = profiles_of(*emulator, region, nodes);
    return !profiles.best.empty();
  };
  // The misfit of the polynomial counts as scatter and may keep the box from shrinking. The half of the box
  // about the best point is then tried, and the search goes on there if the scatter is less.
  std::optional<Region> stopped;
  for (int stage = 0; stage < most_stages; ++stage) {
    if (!refine(options.runs)) return std::nullopt;
    if (stopped && !is_less(emulator->scatter, stopped->before->scatter)) break;
    stopped.reset();
    const Box& box = region.box;
    const Narrowed next = narrowed(profiles, box, profiles.least + generous);
    double part = 0;
    for (std::size_t j = 0; j < count; ++j) part = std::max(part, 1 - next.box.width(j) / box.width(j));
    region = {next.box, emulator, profiles.least + generous};
    if (next.was_too_small) region.limit.reset();
    constexpr double little = 0.2;
    if (!next.was_too_small && part < little) {
      stopped = region;
      region.box = half_about(profiles.best, region.box);
    }
  }
  if (stopped) region = *stopped;
  if (!refine(2 * options.runs)) return std::nullopt;

  DecayFit fit;
  for (std::size_t j = 0; j < count; ++j) {
    const SearchedRange& range = sampler.ranges[j];
    const Interval interval = interval_of(profiles.of[j], profiles.least + options.level);
    fit.parameters.push_back({.parameter = range.parameter,
                              .best = range.value(profiles.best[j]),
                              .low = range.value(region.box.at(j, interval.low)),
                              .high = range.value(region.box.at(j, interval.high)),
                              .searched_from = range.value(0),
                              .searched_to = range.value(1),
                              .open_below = interval.reaches_low,
                              .open_above = interval.reaches_high});
  }
  fit.correlation = profiles.correlation;
  for (const double each : emulator->log_loss(profiles.best)) fit.loss.push_back(exponential(each));
  fit.scatter = emulator->scatter;
  fit.chi_square = profiles.least;
  fit.degrees = std::int64_t(bins.size() - count);
  fit.normal_deviate = normal_deviate_of(fit.chi_square, double(fit.degrees));
  return fit;
}

}  // namespace

// --- The fit ----------------------------------------------------------------------------------------------

std::vector<Problem> problems_of_fit(const SceneInUnits& scene, const FitOptions& options) {
  std::vector<Problem> problems;
  const auto& chosen = options.parameters;
  for (auto each = chosen.begin(); each != chosen.end(); ++each)
    if (std::find(chosen.begin(), each, *each) != each)
      problems.push_back(
          {"parameters", filled("must be different, got {} twice", in_quotes(name_of(*each)))});
  if (options.runs < 1) problems.push_back({"runs", filled("must be >= 1, got {}", options.runs)});
  if (!(options.level > 0))
    problems.push_back({"level", filled("must be a number > 0, got {}", options.level)});
  if (chosen.size() > 4)
    problems.push_back({"parameters", filled("must be at most 4, got {}", chosen.size())});
  if (scene.dampers.size() != 1) problems.push_back({"dampers", "must be one damper, without a list"});
  if (std::ranges::find(chosen, FitParameter::friction_coefficient) == chosen.end()) return problems;
  if (scene.damper().static_friction_coefficient.value_or(0) > 0)
    problems.push_back({"static_friction_coefficient", "must be 0 or left out where the other is fitted"});
  if (scene.gravity == 0.0) problems.push_back({"gravity", "must be > 0 where friction is fitted"});
  return problems;
}

FitResult fit_decay(const SceneInUnits& scene, const Engine& engine, const Reduction& reduction,
                    const std::vector<LossBin>& bins, const FitOptions& options,
                    const std::function<void(const std::string&)>& tell) {
  std::vector<Problem> problems = problems_of_fit(scene, options);
  if (options.parameters.empty()) problems.push_back({"parameters", "at least one must be given"});
  require_none(problems);
  const std::size_t count = options.parameters.size();
  if (bins.size() < count + 1)
    return {std::nullopt, filled("a fit of {} numbers needs {} ranges of amplitude with a known loss factor, "
                                 "the record has {}",
                                 count, count + 1, bins.size())};
  DecaySampler sampler{scene, engine, reduction, bins, options, tell};
  for (const FitParameter each : options.parameters)
    sampler.ranges.push_back(searched_range(each, scene, bins));
  Box box{Vector(count, 0.0), Vector(count, 1.0)};
  const Points points = sampler.points({box, {}, {}}, options.runs);
  std::optional<DecayFit> best;
  constexpr int coarse_stages = 2;
  if (double(points.loss.size()) * kept >= double(4 * count))
    best = fit_in(sampler, box_of_nearest(points, bins, box, kept), coarse_stages);
  // The runs nearest to the record need not lie where it is: where decays are chaotic each is as likely to be
  // far from it. If nothing there is like the record, the search begins anew about others.
  constexpr int most_starts = 3;
  constexpr double apart = 0.15;  // fraction of the searched range
  std::vector<Vector> starts;
  for (const std::size_t i : by_nearness(points, bins)) {
    if ((best && best->normal_deviate <= most_normal_deviate) || int(starts.size()) == most_starts) break;
    const Vector& place = points.place[i];
    const auto is_near = [&](const Vector& other) {
      return std::equal(place.begin(), place.end(), other.begin(),
                        [](double a, double b) { return std::abs(a - b) < apart; });
    };
    if (std::ranges::any_of(starts, is_near)) continue;
    starts.push_back(place);
    for (std::size_t j = 0; j < count; ++j)
      box.low[j] = std::max(0.0, place[j] - apart), box.high[j] = std::min(1.0, place[j] + apart);
    const std::optional<DecayFit> fit = fit_in(sampler, box, 0);
    if (fit && (!best || fit->normal_deviate < best->normal_deviate)) best = fit;
  }
  if (!best) return {std::nullopt, "no decay in the searched range passes through the record's amplitudes"};
  best->runs = sampler.runs;
  return {best, {}};
}

// --- Without impacts --------------------------------------------------------------------------------------

double locked_mass_ratio(const SceneInUnits& scene, WithoutImpacts without) {
  return without == WithoutImpacts::locked ? dimensionless(scene).damper().mass_ratio : 0;
}

FitResult fit_without_impacts(double locked_mass_ratio, const std::vector<LossBin>& bins) {
  if (bins.size() < 2)
    return {
        std::nullopt,
        filled("the record has {} of at least 2 ranges of amplitude with a known loss factor", bins.size())};
  double weights = 0, mean = 0;
  for (const LossBin& bin : bins) weights += 1 / (bin.error * bin.error);
  for (const LossBin& bin : bins) mean += logarithm(bin.loss) / (bin.error * bin.error) / weights;
  const auto damping_ratio = [&](double log_loss) {
    const double half = exponential(log_loss) / 2;
    return half * std::sqrt((1 + locked_mass_ratio) / (1 + half * half));
  };
  const double reach = std::sqrt(FitOptions{}.level / weights);
  DecayFit fit;
  fit.parameters.push_back({.parameter = FitParameter::damping_ratio,
                            .best = damping_ratio(mean),
                            .low = damping_ratio(mean - reach),
                            .high = damping_ratio(mean + reach),
                            .searched_from = 0,
                            .searched_to = 1});
  fit.correlation = {{1}};
  fit.loss.assign(bins.size(), exponential(mean));
  fit.scatter.assign(bins.size(), 0);
  for (const LossBin& bin : bins) {
    const double off = (logarithm(bin.loss) - mean) / bin.error;
    fit.chi_square += off * off;
  }
  fit.degrees = std::int64_t(bins.size()) - 1;
  fit.normal_deviate = normal_deviate_of(fit.chi_square, double(fit.degrees));
  return {fit, {}};
}

}  // namespace impact_damper
