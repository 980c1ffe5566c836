#include "impact_damper/orbits/corrector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "impact_damper/orbits/variational_equations.hpp"

namespace impact_damper::corrector {

std::vector<Problem> problems_of(const OrbitOptions& options) {
  std::vector<Problem> problems;
  if (!(options.tolerance > 0 && options.tolerance <= 1e-3))
    problems.push_back({"tolerance", "must be > 0 and <= 0.001"});
  if (!(options.max_iterations >= 1)) problems.push_back({"max_iterations", "must be >= 1"});
  return problems;
}

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

namespace {

// Takes an iterate, reached by a linear step from `before`, and the plane across the events that passed phase
// 0 in that step (across_phase_0). False if it cannot.
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

const StateVector& by_parameter(const PoincareImage& image, Parameter parameter) {
  return parameter == Parameter::force_frequency ? image.by_frequency : image.by_amplitude;
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

// Sets y and y' of idle dampers in a change of the state so that they stay where they rest: in space or,
// where friction holds them, in their cavities.
void keep_at_rest(const PoincareImage& image, const Scene& scene, StateVector& change) {
  const bool held = has_components(scene);
  for (const std::size_t damper : image.idle) {
    change[index_of_y(damper)] = held ? 0 : -change[0];
    change[index_of_w(damper)] = held ? 0 : -change[1];
  }
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
  for (const std::size_t damper : equation.free_to_rest(at.image)) missing[equation.row_of_rest(damper)] = 0;
  const auto change = solution(bordered(equation, at.image, at.plane.normal), missing);
  if (!change) return {};
  Point next = point_at(vector_of(at.image.state), at.point.back() + change->back());
  for (std::size_t i = 0; i + 1 < next.size(); ++i) {
    next[i] += by_parameter(at.image, equation.parameter)[i] * change->back();
    for (std::size_t k = 0; k + 1 < next.size(); ++k) next[i] += at.image.by_state[i][k] * (*change)[k];
  }
  return next;
}

}  // namespace

// In whole periods an idle damper keeps y + x and y' + x', and its row of w is redundant. (M13.28) takes the
// place of that row: y + x does not change. Where friction holds it, it keeps y, and its row of y is zero: in
// its place y does not change.
Matrix bordered(const Equation& equation, const PoincareImage& image, const Point& last) {
  const std::size_t n = image.by_state.size();
  Matrix a = image.by_state;
  for (std::size_t i = 0; i < n; ++i) {
    a[i][i] -= 1;
    a[i].push_back(by_parameter(image, equation.parameter)[i]);
  }
  for (const std::size_t damper : equation.free_to_rest(image)) {
    std::vector<double>& row = a[equation.row_of_rest(damper)];
    std::fill(row.begin(), row.end(), 0.0);
    row[0] = has_components(equation.scene) ? 0 : 1;
    row[index_of_y(damper)] = 1;
  }
  a.push_back(last);
  return a;
}

Multipliers multipliers_of(const PoincareImage& image) {
  return impact_damper::multipliers_of(derivative_of_moving(image));
}

// A step after which the residual is at least twice the least so far is halved, at most six times.
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
  // At a stop or a release so near to none, or to the edge of its band, the orbit is known to be on neither
  // side.
  const bool on_edge = best.image.stop_margin && *best.image.stop_margin <= equation.options.tolerance;
  if (best.image.one_sided || on_edge) return NoOrbit{OrbitEnd::no_derivative, std::move(residuals)};
  best.multipliers = multipliers_of(best.image);
  best.residuals = std::move(residuals);
  return best;
}

Plane at_value(const Point& p) { return {p, point_at(StateVector(p.size() - 1), 1)}; }

std::optional<StateVector> residual_after(const Equation& equation, const Point& p, int half_periods) {
  if (half_periods % 2 != 0 && !has_mirror(equation.scene)) return {};
  Equation shorter = equation;
  shorter.half_periods = half_periods;
  const auto image = shorter.image_of(p, PoincareMap::Derivatives::none);
  if (!image) return {};
  StateVector residual = vector_of(image->state);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= p[i];
  keep_at_rest(*image, equation.scene, residual);
  return residual;
}
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
  orbit.stop_margin = found.image.stop_margin;
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

std::optional<StateVector> eigenvector_of_minus_1(const PoincareImage& image, const Scene& scene) {
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
  keep_at_rest(image, scene, whole);
  return normalized(whole);
}

}  // namespace impact_damper::corrector
