#include "impact_damper/orbits/orbits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "impact_damper/engines/compatibility.hpp"
#include "impact_damper/math/complex.hpp"
#include "impact_damper/math/dense.hpp"
#include "impact_damper/orbits/across_phase_0.hpp"
#include "impact_damper/orbits/variational_equations.hpp"

namespace impact_damper {
namespace {

using Point = Vector;  // the components of a state, then the parameter

Point along(const Point& from, double step, const Point& direction) {
  Point p = from;
  for (std::size_t i = 0; i < p.size(); ++i) p[i] += step * direction[i];
  return p;
}
double distance(const Point& a, const Point& b) {
  const Point d = along(a, -1, b);
  return std::sqrt(dot_product(d, d));
}
double largest(const StateVector& s) {
  double most = 0;
  for (const double entry : s) most = std::max(most, std::fabs(entry));
  return most;
}
StateVector state_at(Point p) {
  p.pop_back();
  return p;
}
Point point_at(StateVector s, double parameter) {
  s.push_back(parameter);
  return s;
}

// The equation H^n(s; p) - s = 0, n = half_periods, for states s and values of one parameter p.
struct Equation {
  Scene scene;
  Engine engine;
  int half_periods;
  Parameter parameter;
  OrbitOptions options;

  Scene scene_at(double value) const {
    Scene changed = scene;
    changed.*member_of(parameter) = value;
    return changed;
  }
  // The idle dampers to which (M13.28) applies. For odd n there are none: the mirror determines their place.
  std::vector<std::size_t> free_to_rest(const PoincareImage& image) const {
    return half_periods % 2 == 0 ? image.idle : std::vector<std::size_t>{};
  }
  // Nearest misses are looked for on orbits only.
  Expected<PoincareImage, StopReason> image_of(const Point& p, PoincareMap::Derivatives wanted) const {
    const double misses_within = 2 * options.tolerance * std::max(1.0, largest(state_at(p)));
    return PoincareMap(scene_at(p.back()), engine, half_periods)(state_of(state_at(p)), wanted,
                                                                 misses_within);
  }
  // Whether a scene may have the iterate's parameter, and no component of its state exceeds 1e12.
  bool allows(const Point& p) const {
    for (const SceneField& field : scene_fields)
      if (field.number.is(member_of(parameter)) &&
          !(p.back() > 0 && p.back() >= field.least && p.back() <= field.most))
        return false;
    return largest(state_at(p)) <= 1e12;
  }
};

// The plane of points p with dot_product(normal, p - through) = 0, on which the corrector looks for a
// solution.
struct Plane {
  Point through, normal;
};

// Takes an iterate, reached by a linear step from `before`, and the plane across the events that passed phase
// 0 in that step (across_phase_0.hpp). False if it cannot.
bool carry_across(const Equation& equation, const Point& before, Point& p, Plane& plane) {
  const std::optional<Crossing> crossing =
      across_phase_0(equation.scene, equation.engine, state_at(before), state_at(p));
  if (!crossing) return false;
  Point apart = along(plane.through, -1, p);
  p = point_at(crossing->state, p.back());
  if (crossing->by_state.empty()) return true;
  for (const StateMatrix& by_state : crossing->by_state) {
    const auto carried = [&](const Point& direction) {
      return point_at(product(by_state, state_at(direction)), direction.back());
    };
    apart = carried(apart);
    plane.normal = normalized(carried(plane.normal));
  }
  plane.through = along(p, 1, apart);
  return true;
}

struct Solution {
  Point point;
  PoincareImage image;
  Multipliers multipliers;  // only of one that the corrector has found
  std::vector<double> residuals;
  Plane plane;
};
using Solved = Expected<Solution, NoOrbit>;

const StateVector& by_parameter(const PoincareImage& image, Parameter parameter) {
  return parameter == Parameter::force_frequency ? image.by_frequency : image.by_amplitude;
}
// The bordered matrix of (M13.11): the derivative of H^n(s) - s by s and the parameter, and a last row. In
// whole periods an idle damper keeps y + x and y' + x', and its row of w is redundant. (M13.28) takes the
// place of that row: y + x does not change.
Matrix bordered(const Equation& equation, const PoincareImage& image, const Point& last) {
  const std::size_t n = image.by_state.size();
  Matrix a = image.by_state;
  for (std::size_t i = 0; i < n; ++i) {
    a[i][i] -= 1;
    a[i].push_back(by_parameter(image, equation.parameter)[i]);
  }
  for (const std::size_t damper : equation.free_to_rest(image)) {
    std::vector<double>& row = a[index_of_w(damper)];
    std::fill(row.begin(), row.end(), 0.0);
    row[0] = row[index_of_y(damper)] = 1;
  }
  a.push_back(last);
  return a;
}

// Indices of the state's components without those of idle dampers, and A restricted to these. Idle dampers do
// not act on the others, and each adds two multipliers that are 1, or -1 for odd n.
std::vector<std::size_t> moving_in(const PoincareImage& image) {
  std::vector<bool> is_idle(image.by_state.size(), false);
  for (const std::size_t damper : image.idle)
    is_idle[index_of_y(damper)] = is_idle[index_of_w(damper)] = true;
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < is_idle.size(); ++i)
    if (!is_idle[i]) all.push_back(i);
  return all;
}
Matrix derivative_of_moving(const PoincareImage& image) {
  const std::vector<std::size_t> moving = moving_in(image);
  Matrix all;
  for (const std::size_t i : moving) {
    all.emplace_back();
    for (const std::size_t k : moving) all.back().push_back(image.by_state[i][k]);
  }
  return all;
}
Multipliers multipliers_of(const PoincareImage& image) {
  return impact_damper::multipliers_of(derivative_of_moving(image));
}

// The residual of an iterate.
struct Residual {
  StateVector state;     // H^n(s) - s
  double off_plane = 0;  // distance from the plane
  double size = 0;       // the larger of both, in the units of OrbitOptions::tolerance
};
Residual residual_of(const Solution& at) {
  Residual residual;
  residual.state = vector_of(at.image.state);
  for (std::size_t k = 0; k < residual.state.size(); ++k) residual.state[k] -= at.point[k];
  residual.off_plane = dot_product(at.plane.normal, along(at.point, -1, at.plane.through));
  residual.size = std::max(largest(residual.state), std::fabs(residual.off_plane)) /
                  std::max(1.0, largest(state_at(at.point)));
  return residual;
}

// The next iterate of Newton's method (M13.10); nothing if the bordered matrix is singular. Written as the
// image plus A times the change, so that y and w of masses that stick are those of the image, to the bit.
std::optional<Point> newton_step(const Equation& equation, const Solution& at, const Residual& residual) {
  std::vector<double> missing;
  for (const double r : residual.state) missing.push_back(-r);
  missing.push_back(-residual.off_plane);
  for (const std::size_t damper : equation.free_to_rest(at.image)) missing[index_of_w(damper)] = 0;
  const auto change = solution(bordered(equation, at.image, at.plane.normal), missing);
  if (!change) return {};
  Point next = point_at(vector_of(at.image.state), at.point.back() + change->back());
  for (std::size_t i = 0; i + 1 < next.size(); ++i) {
    next[i] += by_parameter(at.image, equation.parameter)[i] * change->back();
    for (std::size_t k = 0; k + 1 < next.size(); ++k) next[i] += at.image.by_state[i][k] * (*change)[k];
  }
  return next;
}

// The corrector: solves H^n(s) = s on a plane by Newton's method from `start`, which was predicted from
// `before`. A step after which the residual is at least twice the least so far is halved, at most six times.
Solved solve(const Equation& equation, const Point& before, const Point& start, const Plane& plane) {
  Solution best, now;
  now.point = start;
  now.plane = plane;
  double least = std::numeric_limits<double>::infinity(), fraction = 1;
  Point step, last = before;
  std::vector<double> residuals;
  for (int i = 0; i < equation.options.max_iterations; ++i) {
    if (!equation.allows(now.point)) break;
    if (!carry_across(equation, last, now.point, now.plane)) break;
    auto image = equation.image_of(now.point, PoincareMap::Derivatives::by_state_and_parameters);
    if (!image) return NoOrbit{OrbitEnd::run_stopped, std::move(residuals)};
    now.image = *std::move(image);
    const Residual residual = residual_of(now);
    residuals.push_back(residual.size);
    const bool tolerated = least <= equation.options.tolerance;
    if (tolerated && !(residual.size < least / 2)) break;  // only rounding errors are left
    if (i > 0 && !(residual.size < 2 * least) && fraction > 1.0 / 64) {
      fraction /= 2;
      now.point = along(best.point, fraction, step);
      now.plane = best.plane;
      continue;
    }
    fraction = 1;
    least = residual.size;
    std::swap(best, now);
    last = best.point;
    const auto next = least > 0 ? newton_step(equation, best, residual) : std::nullopt;
    if (!next) break;
    step = along(*next, -1, best.point);
    now.point = *next;
    now.plane = best.plane;
  }
  if (!(least <= equation.options.tolerance)) return NoOrbit{OrbitEnd::no_convergence, std::move(residuals)};
  if (best.image.one_sided) return NoOrbit{OrbitEnd::no_derivative, std::move(residuals)};
  best.multipliers = multipliers_of(best.image);
  best.residuals = std::move(residuals);
  return best;
}

// The plane on which the parameter has the value that it has in p.
Plane at_value(const Point& p) { return {p, point_at(StateVector(p.size() - 1), 1)}; }

// The residual H^m(s) - s, m = half_periods, in which idle dampers count as staying where they rest; nothing
// if a budget ends the run before.
std::optional<StateVector> residual_after(const Equation& equation, const Point& p, int half_periods) {
  Equation shorter = equation;
  shorter.half_periods = half_periods;
  const auto image = shorter.image_of(p, PoincareMap::Derivatives::none);
  if (!image) return {};
  StateVector residual = vector_of(image->state);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= p[i];
  for (const std::size_t damper : image->idle) {
    residual[index_of_y(damper)] = -residual[0];
    residual[index_of_w(damper)] = -residual[1];
  }
  return residual;
}
// Whether that residual is at most `gap`, in units of the larger of 1 and |s|.
bool closes_after(const Equation& equation, const Point& p, int half_periods, double gap) {
  const auto residual = residual_after(equation, p, half_periods);
  return residual && largest(*residual) <= gap * std::max(1.0, largest(state_at(p)));
}

// The orbit of a solution. Of a symmetric one the solution is half, and its mirror image the other half.
Orbit orbit_of(const Equation& equation, const Solution& found, int periods, bool symmetric) {
  Orbit orbit;
  orbit.residuals = found.residuals;
  orbit.engine = equation.engine;
  orbit.periods = periods;
  orbit.symmetric = symmetric;
  const Scene scene = scene_of_map(equation.scene_at(found.point.back()), equation.half_periods);
  const double duration = *scene.until_time;
  orbit.scene = released_from(scene, state_of(state_at(found.point)));
  orbit.impacts = found.image.impacts;
  orbit.sticking = found.image.sticking;
  orbit.idle = found.image.idle;
  orbit.multipliers = found.multipliers;
  orbit.slowest_impact = found.image.slowest_impact;
  orbit.nearest_miss = found.image.nearest_miss;
  orbit.least_interval = found.image.least_interval;
  if (!symmetric) return orbit;

  orbit.scene.until_time = 2 * duration;
  for (const OrbitImpact& impact : found.image.impacts)
    orbit.impacts.push_back({impact.time + duration, impact.wall == Wall::left ? Wall::right : Wall::left,
                             impact.speed, impact.damper});
  orbit.sticking *= 2;
  orbit.half_multipliers = orbit.multipliers;
  for (Multiplier& m : orbit.multipliers) m = {(m.re - m.im) * (m.re + m.im), 2 * m.re * m.im + 0.0};
  // Squaring can move the first of a conjugate pair below the real axis: then the two are swapped. The + 0.0
  // turns -0 into 0.
  for (std::size_t i = 0; i + 1 < orbit.multipliers.size(); ++i)
    if (orbit.multipliers[i].im < 0 && orbit.multipliers[i + 1].im == -orbit.multipliers[i].im)
      std::swap(orbit.multipliers[i], orbit.multipliers[i + 1]);
  return orbit;
}

// The unit eigenvector of A for its eigenvalue next to -1, by inverse iteration; nothing if that fails. Idle
// dampers stay where they rest.
std::optional<StateVector> eigenvector_of_minus_1(const PoincareImage& image) {
  StateMatrix a = derivative_of_moving(image);
  constexpr double shift = 1e-9;  // so that the matrix is not singular
  for (std::size_t i = 0; i < a.size(); ++i) a[i][i] += 1 + shift;
  StateVector v(a.size(), 1.0);
  for (int pass = 0; pass < 4; ++pass) {
    const auto next = solution(a, v);
    if (!next) return {};
    v = normalized(*next);
  }
  if (image.idle.empty()) return v;
  StateVector whole(image.by_state.size());
  const std::vector<std::size_t> moving = moving_in(image);
  for (std::size_t i = 0; i < moving.size(); ++i) whole[moving[i]] = v[i];
  for (const std::size_t damper : image.idle) {
    whole[index_of_y(damper)] = -whole[0];
    whole[index_of_w(damper)] = -whole[1];
  }
  return normalized(whole);
}

std::vector<Problem> problems_of(const OrbitOptions& options) {
  std::vector<Problem> problems;
  if (!(options.tolerance > 0 && options.tolerance <= 1e-3))
    problems.push_back({"tolerance", "must be > 0 and <= 0.001"});
  if (!(options.max_iterations >= 1)) problems.push_back({"max_iterations", "must be >= 1"});
  return problems;
}

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

// The continuation of one branch, with control of the step length and the search for events.
class Follower {
 public:
  Follower(const Orbit& orbit, Parameter parameter, const FollowOptions& options)
      : options_(options),
        first_(orbit),
        equation_{orbit.scene, orbit.engine, orbit.symmetric ? orbit.periods : 2 * orbit.periods, parameter,
                  options.orbit} {}

  Branch follow() {
    Branch branch;
    const Scene& scene = first_.scene;
    const double begin = scene.*member_of(equation_.parameter);
    if (!(begin >= options_.least && begin <= options_.most)) return branch;
    const Point start = point_at(vector_of(release_of(scene)), begin);
    const Solved first = solve(equation_, start, start, at_value(start));
    if (!first) return branch;
    Solution now = *first;
    const Point origin = now.point;
    add(branch, now);
    auto tangent = tangent_at(now, point_at(StateVector(start.size() - 1), options_.upwards ? 1.0 : -1.0));
    double step = options_.first_step;
    branch.end = BranchEnd::points;
    while (tangent && int(branch.orbits.size()) < options_.max_points) {
      // `largest_change` limits the step, but does not by itself make it too small to go on.
      const double share = std::fabs((*tangent).back());
      if (step * share > options_.largest_change)
        step = std::max(options_.largest_change / share, options_.smallest_step);
      if (far_from_grazing(now.image)) {
        anchor_ = now;
        anchor_tangent_ = *tangent;
      }
      const Solved found = between(now, *tangent, step);
      const auto next_tangent =
          found && follows(now, *found, step) ? tangent_at(*found, found->plane.normal) : std::nullopt;
      if (!next_tangent || !(dot_product(*next_tangent, found->plane.normal) > 0.9) ||
          jumped(now, (*tangent).back(), *found, (*next_tangent).back())) {
        step /= 2;
        if (step >= options_.smallest_step) continue;
        branch.end = BranchEnd::step_too_small;
        add_grazing_at_end(branch, now);
        return branch;
      }
      const Solution& next = *found;
      add_events(branch, now, *tangent, step, next);
      if (branch.end == BranchEnd::joined) {
        branch.orbits.push_back(branch.events.back().orbit);
        return branch;
      }
      if (!in_range(next.point)) {
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
  void add(Branch& branch, const Solution& at) { branch.orbits.push_back(orbit_at(at)); }
  Orbit orbit_at(const Solution& at) const {
    return orbit_of(equation_, at, first_.periods, first_.symmetric);
  }
  // The number that FollowOptions::max_multiplier limits.
  static double instability(const Orbit& orbit) {
    const double speed = std::min(1.0, orbit.slowest_impact.value_or(1));
    return orbit.multipliers[0].modulus() * (orbit.symmetric ? speed * speed : speed);
  }
  static bool far_from_grazing(const PoincareImage& image) {
    constexpr double far = 1e-5;
    return !(image.slowest_impact && *image.slowest_impact < far) &&
           !(image.nearest_miss && *image.nearest_miss < far);
  }
  bool in_range(const Point& p) const { return p.back() >= options_.least && p.back() <= options_.most; }
  // Whether the corrector ended within step / 2 of the prediction and, with rigid walls, where a grazing ends
  // the branch, with as many impacts as before.
  bool follows(const Solution& now, const Solution& next, double step) const {
    return distance(next.point, next.plane.through) < step / 2 &&
           (!has_rigid_walls(equation_.engine) || of_one_kind(now.image, next.image));
  }
  // Whether the step led to another branch. The determinant of the bordered matrix keeps its sign along a
  // branch, and is the product of (1 - m) divided by the parameter's component of the tangent (M13.11): both
  // change their signs together. Across a junction they do not, but there the branch ends.
  bool jumped(const Solution& now, double share, const Solution& next, double next_share) const {
    if (now.image.impacts.empty() || crosses(now, next)) return false;
    return products_of(now.multipliers).fold * share * products_of(next.multipliers).fold * next_share < 0;
  }
  // The unit tangent of the branch (M13.11) on the side to which `like` points.
  std::optional<Point> tangent_at(const Solution& at, const Point& like) const {
    const auto direction =
        solution(bordered(equation_, at.image, like), point_at(StateVector(like.size() - 1), 1));
    return direction ? std::optional(normalized(*direction)) : std::nullopt;
  }

  // Predictor and corrector: the solution at a distance s from `now`, along the tangent there.
  Solved between(const Solution& now, const Point& tangent, double s) const {
    const Point from = along(now.point, s, tangent);
    return solve(equation_, now.point, from, {from, normal_at(now, tangent)});
  }
  // The normal of the corrector's plane. It is the tangent, except where an asymmetric orbit is about to meet
  // the branch of symmetric ones, or an orbit that of half its period. There it is the residual H^(n/2)(s) -
  // s, which vanishes on the other branch, so that no orbit of that branch lies in the plane.
  Point normal_at(const Solution& now, const Point& tangent) const {
    if (first_.symmetric) return tangent;
    const auto residual = residual_after(equation_, now.point, equation_.half_periods / 2);
    if (!residual || !(largest(*residual) > 0) || !(largest(*residual) < 0.1)) return tangent;
    const Point across = normalized(point_at(*residual, 0));
    const double along_tangent = dot_product(across, tangent);
    if (!(std::fabs(along_tangent) > 0.95)) return tangent;
    return along_tangent > 0 ? across : along(Point(across.size()), -1, across);
  }

  // Adds the events in the range between two successive orbits, of which the second may lie beyond it.
  void add_events(Branch& branch, const Solution& now, const Point& tangent, double step,
                  const Solution& next) const {
    if (!of_one_kind(now.image, next.image)) add_grazing(branch, now, tangent, step);
    if (now.image.impacts.empty() || next.image.impacts.empty()) return;  // linear: no bifurcation
    if (const auto at = junction_between(now, next, step)) {
      if (!in_range(at->point)) return;
      branch.events.push_back(
          {first_.periods % 2 == 0 ? BranchEventKind::flip : BranchEventKind::symmetry_breaking,
           at->point.back(), orbit_at(*at), std::ssize(branch.orbits)});
      branch.end = BranchEnd::joined;
      return;
    }
    const auto slope = [&](const Solution& at) {
      const auto direction = tangent_at(at, at.plane.normal);
      return direction ? (*direction).back() : 0;
    };
    add_event(branch, now, tangent, step, BranchEventKind::fold, tangent.back(), slope(next), slope);
    const auto flip = [](const Solution& at) { return products_of(at.multipliers).flip; };
    add_event(branch, now, tangent, step,
              first_.symmetric ? BranchEventKind::symmetry_breaking : BranchEventKind::flip, flip(now),
              flip(next), flip);
    const auto pairs = [](const Solution& at) { return products_of(at.multipliers).pairs; };
    add_event(branch, now, tangent, step, BranchEventKind::neimark_sacker, pairs(now), pairs(next), pairs);
  }
  // The bifurcation point at which this branch, of H^(2n), joins that of H^n from which it branches off.
  // There H^n(s) - s reverses, and a multiplier of H^n is -1 (M13.21). The bordered matrix of H^(2n) is
  // singular there, that of H^n is not. So the point is found along the other branch, as a root in the
  // parameter by the secant method.
  std::optional<Solution> junction_between(const Solution& now, const Solution& next, double step) const {
    if (!crosses(now, next)) return {};
    Equation half = equation_;
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
    if (!at || !(distance(at->point, middle) < step) || !is_flip(at->multipliers)) return {};
    auto image = equation_.image_of(at->point, PoincareMap::Derivatives::by_state_and_parameters);
    if (!image) return {};
    at->image = *std::move(image);
    at->multipliers = multipliers_of(at->image);
    return *std::move(at);
  }
  // Whether H^n(s) - s reverses between two orbits of H^(2n): its scalar product is negative.
  bool crosses(const Solution& now, const Solution& next) const {
    if (first_.symmetric) return false;
    const auto before = residual_after(equation_, now.point, equation_.half_periods / 2),
               after = residual_after(equation_, next.point, equation_.half_periods / 2);
    if (!before || !after) return false;
    return dot_product(*before, *after) < 0;
  }
  static bool is_flip(const Multipliers& all) {
    return std::any_of(all.begin(), all.end(), [](const Multiplier& m) {
      return std::fabs(m.re + 1) < 1e-6 && std::fabs(m.im) < 1e-6;
    });
  }

  // Adds the event between two orbits if its test function changes sign from `before` to `after`.
  template <class Test>
  void add_event(Branch& branch, const Solution& now, const Point& tangent, double step, BranchEventKind kind,
                 double before, double after, Test&& test) const {
    if (!(before * after < 0)) return;
    const auto at = root_between(now, tangent, step, before, after, test);
    if (!at || !in_range(at->point)) return;
    if (kind == BranchEventKind::neimark_sacker && !on_unit_circle(at->multipliers)) return;
    branch.events.push_back({kind, at->point.back(), orbit_at(*at), std::ssize(branch.orbits)});
  }
  // Whether two conjugate multipliers have modulus 1. The product of two real ones can be 1 as well.
  static bool on_unit_circle(const Multipliers& all) {
    return std::any_of(all.begin(), all.end(),
                       [](const Multiplier& m) { return m.im > 1e-6 && std::fabs(m.modulus() - 1) < 1e-6; });
  }
  // The solution within the step at which value_of() is zero, by the Illinois variant of regula falsi.
  template <class Value>
  std::optional<Solution> root_between(const Solution& now, const Point& tangent, double step, double at_low,
                                       double at_high, Value&& value_of) const {
    double low = 0, high = step;
    std::optional<Solution> found;
    int side = 0;
    for (int i = 0; i < 80 && high - low > 1e-14; ++i) {
      const double s = low + (high - low) * (at_low / (at_low - at_high));
      Solved at = between(now, tangent, s);
      if (!at) return {};
      const double value = value_of(*at);
      found = *std::move(at);
      if (value == 0) break;
      if (value * at_low > 0) {
        const double moved = s - low;
        low = s;
        at_low = value;
        if (side == 1) at_high /= 2;
        side = 1;
        if (!(moved > 1e-14)) break;
      } else {
        const double moved = high - s;
        high = s;
        at_high = value;
        if (side == -1) at_low /= 2;
        side = -1;
        if (!(moved > 1e-14)) break;
      }
    }
    return found;
  }
  // Compliant walls: adds the grazing at which the number of impacts changes, by bisection of the step.
  void add_grazing(Branch& branch, const Solution& now, const Point& tangent, double step) const {
    double low = 0, high = step;
    Solution last = now;
    while (high - low > 1e-13) {
      const double middle = low + (high - low) / 2;
      Solved at = between(now, tangent, middle);
      if (!at) return;
      if (of_one_kind(now.image, at->image)) {
        low = middle;
        last = *std::move(at);
      } else {
        high = middle;
      }
    }
    if (!in_range(last.point)) return;
    branch.events.push_back(
        {BranchEventKind::grazing, last.point.back(), orbit_at(last), std::ssize(branch.orbits)});
  }

  // Finds out whether a branch that no step continues ends at a coincidence or a grazing. Rigid walls: it
  // ends where the speed of an impact, or a distance from a wall, vanishes. The parameter is a smooth
  // function of it (M13.14), and is extrapolated by a polynomial through orbits before.
  void add_grazing_at_end(Branch& branch, const Solution& last) const {
    // Beyond it the two impacts are in the other order, and the state jumps.
    if (last.image.least_interval && *last.image.least_interval < 1e-6) branch.end = BranchEnd::coincidence;
    if (!has_rigid_walls(equation_.engine)) {
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
  // The parameter at which a speed or a distance vanishes, by Neville's scheme for five orbits before the
  // grazing, and by how much the last order changed it.
  struct Extrapolated {
    double parameter = 0, error = 0;
  };
  std::optional<Extrapolated> at_size_0(std::optional<double> PoincareImage::*size_of, double spacing) const {
    std::array<double, 5> size, value;
    for (std::size_t i = 0; i < size.size(); ++i) {
      const Solved at = between(anchor_, anchor_tangent_, -spacing * double(i));
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

  // Ends the branch with the orbit at the end of the parameter's range, which the step to `next` has passed.
  void finish_at_end_of_range(Branch& branch, const Solution& now, const Solution& next) {
    const double end = next.point.back() > options_.most ? options_.most : options_.least;
    const double share = (end - now.point.back()) / (next.point.back() - now.point.back());
    Point p = along(now.point, share, along(next.point, -1, now.point));
    p.back() = end;
    const Solved last = solve(equation_, now.point, p, at_value(p));
    branch.end = last ? BranchEnd::range : BranchEnd::step_too_small;
    if (last) add(branch, *last);
  }

  FollowOptions options_;
  Orbit first_;
  Equation equation_;
  Solution anchor_;  // the last solution so far from grazing that rounding errors, which grow as 1/speed, do
                     // not matter
  Point anchor_tangent_{};
};

}  // namespace

double Scene::*member_of(Parameter parameter) {
  switch (parameter) {
    case Parameter::force_frequency:
      return &Scene::force_frequency;
    case Parameter::force_amplitude:
      return &Scene::force_amplitude;
  }
  return {};
}

Expected<Orbit, NoOrbit> find_orbit(const Scene& scene, const Engine& engine, int periods,
                                    const SceneState& guess, const OrbitOptions& options) {
  if (guess.dampers.size() != scene.dampers.size())
    require_none(
        {{"guess", "must be of as many dampers as the scene's list, " + std::to_string(scene.dampers.size()) +
                       ", got " + std::to_string(guess.dampers.size())}});
  Scene guessed = released_from(scene, guess);
  guessed.until_time = 1;
  std::vector<Problem> problems = impact_damper::problems_of(guessed);
  if (problems.empty()) problems = incompatibilities_of(guessed, engine);
  for (const Problem& problem : problems_of(options)) problems.push_back(problem);
  if (!(periods >= 1)) problems.push_back({"periods", "must be >= 1"});
  if (options.symmetric && periods % 2 == 0)
    problems.push_back({"periods", "must be odd for a symmetric orbit"});
  require_none(problems);

  Equation equation{scene, engine, options.symmetric ? periods : 2 * periods, Parameter::force_frequency,
                    options};
  const Point start = point_at(vector_of(guess), scene.force_frequency);
  Solved found = solve(equation, start, start, at_value(start));
  if (!found) return found.failure();

  // The least number of half periods after which the orbit closes.
  for (int n = 1; n < equation.half_periods; ++n) {
    const bool divides = equation.half_periods % n == 0;
    if (!divides || !closes_after(equation, found->point, n, 100 * options.tolerance)) continue;
    Equation less = equation;
    less.half_periods = n;
    Solved shorter = solve(less, found->point, found->point, at_value(found->point));
    if (!shorter) continue;
    shorter->residuals = std::move(found->residuals);
    found = std::move(shorter);
    equation = less;
    break;
  }
  const bool symmetric = equation.half_periods % 2 != 0;
  periods = symmetric ? equation.half_periods : equation.half_periods / 2;
  return orbit_of(equation, *found, periods, symmetric);
}

Branch follow(const Orbit& orbit, Parameter parameter, const FollowOptions& options) {
  std::vector<Problem> problems = problems_of(options.orbit);
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

Expected<Orbit, NoOrbit> branching_off(const BranchEvent& event, Parameter parameter,
                                       const OrbitOptions& options) {
  require_none(problems_of(options));
  const Orbit& from = event.orbit;
  const bool doubles =
      event.kind == BranchEventKind::flip || event.kind == BranchEventKind::symmetry_breaking;
  if (!doubles) return NoOrbit{};
  const int half_periods = from.symmetric ? from.periods : 2 * from.periods;
  const Equation equation{from.scene, from.engine, 2 * half_periods, parameter, options};
  const Point origin = point_at(vector_of(release_of(from.scene)), event.parameter);
  const auto image =
      PoincareMap(equation.scene_at(event.parameter), from.engine, half_periods)(release_of(from.scene));
  if (!image) return NoOrbit{OrbitEnd::run_stopped};
  const std::optional<StateVector> direction = eigenvector_of_minus_1(*image);
  if (!direction) return NoOrbit{};
  const Point normal = point_at(*direction, 0);
  for (const double gap : {0.01, -0.01, 0.001, -0.001}) {
    const Point start = along(origin, gap, normal);
    const Solved found = solve(equation, origin, start, {start, normal});
    if (!found) continue;
    // H^n(s) - s is zero on the branch of H^n. On the new one it leads to the other side, by about 2 gap.
    const auto residual = residual_after(equation, found->point, half_periods);
    if (residual && largest(*residual) > std::fabs(gap) / 2)
      return orbit_of(equation, *found, half_periods, false);
  }
  return NoOrbit{};
}

}  // namespace impact_damper
