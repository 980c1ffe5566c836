#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "impact_damper/math/complex.hpp"
#include "impact_damper/math/dense.hpp"
#include "impact_damper/orbits/corrector.hpp"
#include "impact_damper/orbits/orbits.hpp"

namespace impact_damper {
namespace {

using namespace corrector;

// Test functions whose zeros are bifurcation points: the products of (1 - m), (1 + m) and (1 - m m') over all
// multipliers m and all pairs of them (M13.12). They are real, as conjugates come in pairs.
struct Products {
  double fold, flip, pairs;
};
Products products_of(const Multipliers& all) {
  const auto complex = [](const Multiplier& m) { return Complex<double>(m.re, m.im); };
  const Complex<double> one(1);
  Complex<double> fold = one, flip = one, pairs = one;
  for (std::size_t i = 0; i < all.size(); ++i) {
    fold = fold * (one - complex(all[i]));
    flip = flip * (one + complex(all[i]));
    for (std::size_t j = i + 1; j < all.size(); ++j)
      pairs = pairs * (one - complex(all[i]) * complex(all[j]));
  }
  return {fold.real(), flip.real(), pairs.real()};
}

// Whether two orbits have equally many impacts; if not, a grazing lies between them. Orbits with sticking
// always count as equal: complete chattering has no number of impacts.
bool of_one_kind(const PoincareImage& a, const PoincareImage& b) {
  return a.sticking > 0 || b.sticking > 0 || a.impacts.size() == b.impacts.size();
}

// The orbits on and near one branch.
class BranchOfOrbits {
 public:
  BranchOfOrbits(const Orbit& orbit, Parameter parameter, const FollowOptions& follow_options)
      : options(follow_options),
        first(orbit),
        equation{orbit.scene, orbit.engine, orbit.symmetric ? orbit.periods : 2 * orbit.periods, parameter,
                 follow_options.orbit} {}

  bool in_range(const Point& p) const { return p.back() >= options.least && p.back() <= options.most; }
  Orbit orbit_at(const Solution& at) const { return orbit_of(equation, at, first.periods, first.symmetric); }
  // The unit tangent of the branch (M13.11) on the side to which `like` points.
  std::optional<Point> tangent_at(const Solution& at, const Point& like) const {
    const auto direction =
        solution(bordered(equation, at.image, like), point_at(StateVector(like.size() - 1), 1));
    return direction ? std::optional(normalized(*direction)) : std::nullopt;
  }

  // Predictor and corrector: the solution at a distance s from `now`, along the tangent there.
  Solved between(const Solution& now, const Point& tangent, double s) const {
    const Point from = along(now.point, s, tangent);
    return solve(equation, now.point, from, {from, normal_at(now, tangent)});
  }
  // Whether H^n(s) - s reverses between two orbits of H^(2n): its scalar product is negative.
  bool crosses(const Solution& now, const Solution& next) const {
    if (first.symmetric) return false;
    const auto before = residual_after(equation, now.point, equation.half_periods / 2),
               after = residual_after(equation, next.point, equation.half_periods / 2);
    if (!before || !after) return false;
    return dot_product(*before, *after) < 0;
  }

  const FollowOptions options;
  const Orbit first;
  const Equation equation;

 private:
  // The normal of the corrector's plane. It is the tangent, except where an asymmetric orbit is about to meet
  // the branch of symmetric ones, or an orbit that of half its period. There it is the residual H^(n/2)(s) -
  // s, which vanishes on the other branch, so that no orbit of that branch lies in the plane.
  Point normal_at(const Solution& now, const Point& tangent) const {
    if (first.symmetric) return tangent;
    const auto residual = residual_after(equation, now.point, equation.half_periods / 2);
    if (!residual || !(largest(*residual) > 0) || !(largest(*residual) < 0.1)) return tangent;
    const Point across = normalized(point_at(*residual, 0));
    const double along_tangent = dot_product(across, tangent);
    if (!(std::fabs(along_tangent) > 0.95)) return tangent;
    return along_tangent > 0 ? across : along(Point(across.size()), -1, across);
  }
};

// A step of the continuation: from a solution a distance `length` along the tangent there.
struct ContinuationStep {
  const Solution& from;
  const Point& tangent;
  double length;
};

// The events of a branch within one step.
class EventsOfStep {
 public:
  EventsOfStep(const BranchOfOrbits& orbits, const ContinuationStep& step, Branch& branch)
      : orbits_(orbits), step_(step), branch_(branch) {}

  // Adds those in the range of the parameter. next: the solution at the end of the step, which may lie beyond
  // that range.
  void add(const Solution& next) {
    const Solution& now = step_.from;
    if (!of_one_kind(now.image, next.image)) add_grazing();
    if (now.image.impacts.empty() || next.image.impacts.empty()) return;  // linear: no bifurcation
    if (const auto at = junction_before(next)) {
      if (!orbits_.in_range(at->point)) return;
      add(orbits_.first.periods % 2 == 0 ? BranchEventKind::flip : BranchEventKind::symmetry_breaking, *at);
      branch_.end = BranchEnd::joined;
      return;
    }
    const auto slope = [&](const Solution& at) {
      const auto direction = orbits_.tangent_at(at, at.plane.normal);
      return direction ? (*direction).back() : 0;
    };
    add_zero(BranchEventKind::fold, step_.tangent.back(), slope(next), slope);
    const auto flip = [](const Solution& at) { return products_of(at.multipliers).flip; };
    add_zero(orbits_.first.symmetric ? BranchEventKind::symmetry_breaking : BranchEventKind::flip, flip(now),
             flip(next), flip);
    const auto pairs = [](const Solution& at) { return products_of(at.multipliers).pairs; };
    add_zero(BranchEventKind::neimark_sacker, pairs(now), pairs(next), pairs);
  }

 private:
  void add(BranchEventKind kind, const Solution& at) {
    branch_.events.push_back({kind, at.point.back(), orbits_.orbit_at(at), std::ssize(branch_.orbits)});
  }
  // The bifurcation point at which this branch, of H^(2n), joins that of H^n from which it branches off.
  // There H^n(s) - s reverses, and a multiplier of H^n is -1 (M13.21). The bordered matrix of H^(2n) is
  // singular there, that of H^n is not. So the point is found along the other branch, as a root in the
  // parameter by the secant method.
  std::optional<Solution> junction_before(const Solution& next) const {
    const Solution& now = step_.from;
    if (!orbits_.crosses(now, next)) return {};
    Equation half = orbits_.equation;
    half.half_periods /= 2;

    const Point middle = along(now.point, 0.5, along(next.point, -1, now.point));
    const auto at_parameter_value = [&](const Point& from, double value) {
      Point p = from;
      p.back() = value;
      return solve(half, middle, p, at_value(p));
    };
    Solved other = at_parameter_value(middle, middle.back() * (1 + 1e-6)),
           at = at_parameter_value(middle, middle.back());
    for (int i = 0; i < 20; ++i) {
      if (!at || !other) return {};
      const double value = products_of(at->multipliers).flip,
                   change = value - products_of(other->multipliers).flip;
      const double by = value * (at->point.back() - other->point.back()) / change;
      if (!std::isfinite(by)) break;
      other = std::exchange(at, at_parameter_value(at->point, at->point.back() - by));
      if (at && std::fabs(by) <= 1e-14 * at->point.back()) break;
    }
    if (!at || !(distance(at->point, middle) < step_.length) || !is_flip(at->multipliers)) return {};
    auto image = orbits_.equation.image_of(at->point, PoincareMap::Derivatives::by_state_and_parameters);
    if (!image) return {};
    at->image = *std::move(image);
    at->multipliers = multipliers_of(at->image);
    return *std::move(at);
  }
  static bool is_flip(const Multipliers& all) {
    return std::any_of(all.begin(), all.end(), [](const Multiplier& m) {
      return std::fabs(m.re + 1) < 1e-6 && std::fabs(m.im) < 1e-6;
    });
  }

  // Adds the event of the step if its test function changes sign from `before` to `after`.
  template <class Test>
  void add_zero(BranchEventKind kind, double before, double after, Test&& test) {
    if (!(before * after < 0)) return;
    const auto at = zero_of(test, before, after);
    if (!at || !orbits_.in_range(at->point)) return;
    if (kind == BranchEventKind::neimark_sacker && !on_unit_circle(at->multipliers)) return;
    add(kind, *at);
  }
  // Whether two conjugate multipliers have modulus 1. The product of two real ones can be 1 as well.
  static bool on_unit_circle(const Multipliers& all) {
    return std::any_of(all.begin(), all.end(),
                       [](const Multiplier& m) { return m.im > 1e-6 && std::fabs(m.modulus() - 1) < 1e-6; });
  }
  // The solution within the step at which value_of() is zero, by the Illinois variant of regula falsi.
  template <class Value>
  std::optional<Solution> zero_of(Value&& value_of, double at_low, double at_high) const {
    struct End {
      double at, value;
    };
    End low{0, at_low}, high{step_.length, at_high};
    const End* last = nullptr;  // the end that moved last
    std::optional<Solution> found;
    for (int i = 0; i < 80 && high.at - low.at > 1e-14; ++i) {
      const double s = low.at + (high.at - low.at) * (low.value / (low.value - high.value));
      Solved at = orbits_.between(step_.from, step_.tangent, s);
      if (!at) return {};
      const double value = value_of(*at);
      found = *std::move(at);
      if (value == 0) break;
      const bool is_low = value * low.value > 0;
      End &moves = is_low ? low : high, &stays = is_low ? high : low;
      const double way = std::fabs(s - moves.at);
      moves = {s, value};
      if (last == &moves) stays.value /= 2;
      last = &moves;
      if (!(way > 1e-14)) break;
    }
    return found;
  }
  // Compliant walls: adds the grazing at which the number of impacts changes, by bisection of the step.
  void add_grazing() {
    double low = 0, high = step_.length;
    Solution last = step_.from;
    while (high - low > 1e-13) {
      const double middle = low + (high - low) / 2;
      Solved at = orbits_.between(step_.from, step_.tangent, middle);
      if (!at) return;
      if (of_one_kind(step_.from.image, at->image)) {
        low = middle;
        last = *std::move(at);
      } else {
        high = middle;
      }
    }
    if (orbits_.in_range(last.point)) add(BranchEventKind::grazing, last);
  }

  const BranchOfOrbits& orbits_;
  const ContinuationStep step_;
  Branch& branch_;
};

// Whether a branch ends at a grazing or a coincidence.
class EndOfBranch {
 public:
  explicit EndOfBranch(const BranchOfOrbits& orbits) : orbits_(orbits) {}

  // To be called for each solution.
  void passes(const Solution& at, const Point& tangent) {
    if (!is_far(at.image)) return;
    anchor_ = at;
    tangent_ = tangent;
  }
  // Finds out whether a branch that no step continues ends at a coincidence or a grazing. Rigid walls: it
  // ends where the speed of an impact, or a distance from a wall, vanishes. The parameter is a smooth
  // function of it (M13.14), and is extrapolated by a polynomial through orbits before.
  void find(Branch& branch, const Solution& last) const {
    // Beyond it the two impacts are in the other order, and the state jumps.
    if (last.image.least_interval && *last.image.least_interval < 1e-6) branch.end = BranchEnd::coincidence;
    if (!has_rigid_walls(orbits_.equation.engine)) {
      // The branch has a kink at a grazing. If that is what stopped it, the distance or speed left is below
      // these limits, which are of the order of smallest_step and of its square root.
      if (!(last.image.nearest_miss && *last.image.nearest_miss < 1e-8) &&
          !(last.image.slowest_impact && *last.image.slowest_impact < 1e-4))
        return;
      branch.end = BranchEnd::grazing;
      branch.events.push_back(
          {BranchEventKind::grazing, last.point.back(), branch.orbits.back(), std::ssize(branch.orbits)});
      return;
    }
    if (anchor_.point.empty()) return;  // the whole branch is that near to grazing
    for (const auto member : {&PoincareImage::slowest_impact, &PoincareImage::nearest_miss}) {
      if (!(last.image.*member && *(last.image.*member) < 1e-4)) continue;
      std::optional<Extrapolated> best;
      for (const double spacing : {1e-4, 2e-5, 4e-6}) {
        const auto at = at_size_0(member, spacing);
        if (at && !(best && best->error <= at->error)) best = at;
      }
      if (!best) continue;
      // Where orbits enough to extrapolate lie only far away, the last one is nearer: by the slope since
      // then.
      const double size = *(last.image.*member), before = (anchor_.image.*member).value_or(0);
      const double gap = std::fabs((last.point.back() - anchor_.point.back()) * (size / (before - size)));
      if (before > size && gap < best->error) best = Extrapolated{last.point.back(), gap};
      branch.end = BranchEnd::grazing;
      branch.events.push_back(
          {BranchEventKind::grazing, best->parameter, branch.orbits.back(), std::ssize(branch.orbits)});
      return;
    }
  }

 private:
  static bool is_far(const PoincareImage& image) {
    constexpr double far = 1e-5;
    return !(image.slowest_impact && *image.slowest_impact < far) &&
           !(image.nearest_miss && *image.nearest_miss < far);
  }
  // The parameter at which a speed or a distance vanishes, by Neville's scheme for five orbits before the
  // grazing, and by how much the last order changed it.
  struct Extrapolated {
    double parameter = 0, error = 0;
  };
  std::optional<Extrapolated> at_size_0(std::optional<double> PoincareImage::*size_of, double spacing) const {
    std::array<double, 5> size, value;
    for (std::size_t i = 0; i < size.size(); ++i) {
      const Solved at = orbits_.between(anchor_, tangent_, -spacing * double(i));
      if (!at || !(at->image.*size_of)) return {};
      size[i] = *(at->image.*size_of);
      value[i] = at->point.back();
    }
    // It must tend to zero: the first impact of a chattering may be slow all along a branch.
    const auto [least, most] = std::ranges::minmax(size);
    if (!(4 * (most - least) > least)) return {};
    double before = 0;
    for (std::size_t order = 1; order < size.size(); ++order) {
      before = value.back();
      for (std::size_t i = size.size() - 1; i >= order; --i)
        value[i] += (value[i] - value[i - 1]) * size[i] / (size[i - order] - size[i]);
    }
    Extrapolated all;
    all.parameter = value.back();
    all.error = std::fabs(value.back() - before);
    return all;
  }

  const BranchOfOrbits& orbits_;
  // The last solution so far from grazing that rounding errors, which grow as 1/speed, do not matter.
  Solution anchor_;
  Point tangent_;
};

// The continuation of one branch, with control of the step length.
class Follower {
 public:
  Follower(const Orbit& orbit, Parameter parameter, const FollowOptions& options)
      : options_(options), orbits_(orbit, parameter, options), end_(orbits_) {}

  Branch follow() {
    Branch branch;
    const Scene& scene = orbits_.first.scene;
    const double begin = scene.*member_of(orbits_.equation.parameter);
    if (!(begin >= options_.least && begin <= options_.most)) return branch;
    const Point start = point_at(vector_of(release_of(scene)), begin);
    const Solved first = solve(orbits_.equation, start, start, at_value(start));
    if (!first) return branch;
    Solution now = *first;
    const Point origin = now.point;
    add(branch, now);
    auto tangent =
        orbits_.tangent_at(now, point_at(StateVector(start.size() - 1), options_.upwards ? 1.0 : -1.0));
    double step = options_.first_step;
    branch.end = BranchEnd::points;
    while (tangent && int(branch.orbits.size()) < options_.max_points) {
      // `largest_change` limits the step, but does not by itself make it too small to go on.
      const double share = std::fabs((*tangent).back());
      if (step * share > options_.largest_change)
        step = std::max(options_.largest_change / share, options_.smallest_step);
      end_.passes(now, *tangent);
      const Solved found = orbits_.between(now, *tangent, step);
      const auto next_tangent = found && follows(now, *found, step)
                                    ? orbits_.tangent_at(*found, found->plane.normal)
                                    : std::nullopt;
      if (!next_tangent || !(dot_product(*next_tangent, found->plane.normal) > 0.9) ||
          jumped(now, (*tangent).back(), *found, (*next_tangent).back())) {
        step /= 2;
        if (step >= options_.smallest_step) continue;
        branch.end = BranchEnd::step_too_small;
        end_.find(branch, now);
        return branch;
      }
      const Solution& next = *found;
      EventsOfStep(orbits_, {now, *tangent, step}, branch).add(next);
      if (branch.end == BranchEnd::joined) {
        branch.orbits.push_back(branch.events.back().orbit);
        return branch;
      }
      if (!orbits_.in_range(next.point)) {
        finish_at_end_of_range(branch, now, next);
        return branch;
      }
      add(branch, next);
      const bool is_back = branch.orbits.size() > 3 && distance(next.point, origin) < step &&
                           dot_product(along(origin, -1, now.point), *tangent) > 0;
      now = next;
      tangent = next_tangent;
      if (is_back) {
        branch.end = BranchEnd::closed;
        return branch;
      }
      if (instability(branch.orbits.back()) > options_.max_multiplier) {
        branch.end = BranchEnd::unstable;
        return branch;
      }
      if (next.residuals.size() <= 5) step = std::min(1.5 * step, options_.largest_step);
    }
    if (!tangent) branch.end = BranchEnd::step_too_small;
    return branch;
  }

 private:
  void add(Branch& branch, const Solution& at) { branch.orbits.push_back(orbits_.orbit_at(at)); }
  // The number that FollowOptions::max_multiplier limits.
  static double instability(const Orbit& orbit) {
    const double speed = std::min(1.0, orbit.slowest_impact.value_or(1));
    return orbit.multipliers[0].modulus() * (orbit.symmetric ? speed * speed : speed);
  }
  // Whether the corrector ended within step / 2 of the prediction and, with rigid walls, where a grazing ends
  // the branch, with as many impacts as before.
  bool follows(const Solution& now, const Solution& next, double step) const {
    return distance(next.point, next.plane.through) < step / 2 &&
           (!has_rigid_walls(orbits_.equation.engine) || of_one_kind(now.image, next.image));
  }
  // Whether the step led to another branch. The determinant of the bordered matrix keeps its sign along a
  // branch, and is the product of (1 - m) divided by the parameter's component of the tangent (M13.11): both
  // change their signs together. Across a junction they do not, but there the branch ends.
  bool jumped(const Solution& now, double share, const Solution& next, double next_share) const {
    if (now.image.impacts.empty() || orbits_.crosses(now, next)) return false;
    return products_of(now.multipliers).fold * share * products_of(next.multipliers).fold * next_share < 0;
  }
  // Ends the branch with the orbit at the end of the parameter's range, which the step to `next` has passed.
  void finish_at_end_of_range(Branch& branch, const Solution& now, const Solution& next) {
    const double end = next.point.back() > options_.most ? options_.most : options_.least;
    const double share = (end - now.point.back()) / (next.point.back() - now.point.back());
    Point p = along(now.point, share, along(next.point, -1, now.point));
    p.back() = end;
    const Solved last = solve(orbits_.equation, now.point, p, at_value(p));
    branch.end = last ? BranchEnd::range : BranchEnd::step_too_small;
    if (last) add(branch, *last);
  }

  FollowOptions options_;
  BranchOfOrbits orbits_;
  EndOfBranch end_;
};

}  // namespace

Branch follow(const Orbit& orbit, Parameter parameter, const FollowOptions& options) {
  std::vector<Problem> problems = corrector::problems_of(options.orbit);
  if (!(options.least > 0 && options.most > options.least))
    problems.push_back({"least", "must be > 0 and below most"});
  if (!(options.smallest_step > 0 && options.smallest_step <= options.first_step))
    problems.push_back({"smallest_step", "must be > 0 and <= first_step"});
  if (!(options.largest_step >= options.first_step))
    problems.push_back({"largest_step", "must be >= first_step"});
  if (!(options.largest_change > 0)) problems.push_back({"largest_change", "must be > 0"});
  if (!(options.max_multiplier >= 1)) problems.push_back({"max_multiplier", "must be >= 1"});
  if (!(options.max_points >= 1)) problems.push_back({"max_points", "must be >= 1"});
  require_none(problems);
  return Follower(orbit, parameter, options).follow();
}

}  // namespace impact_damper
