// Periodic orbits as the solutions of H^n(s; p) - s = 0, and the corrector that finds them
// (docs/mathematics.md, 13.6).
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/math/dense.hpp"
#include "impact_damper/orbits/orbits.hpp"
#include "impact_damper/orbits/poincare_map.hpp"
#include "impact_damper/orbits/variational_equations.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper::corrector {

// Returns what is wrong with the options; empty if nothing.
std::vector<Problem> problems_of(const OrbitOptions& options);

using Point = Vector;  // the components of a state, then the parameter

Point along(const Point& from, double step, const Point& direction);  // from + step direction
double distance(const Point& a, const Point& b);                      // the Euclidean one
double largest(const StateVector& s);                                 // the largest modulus of a component
StateVector state_at(Point p);                                        // p without the parameter
Point point_at(StateVector s, double parameter);

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
  // The row of the bordered matrix in which that stands.
  std::size_t row_of_rest(std::size_t damper) const {
    return has_components(scene) ? index_of_y(damper) : index_of_w(damper);
  }
  // Returns H^n(s; p), or the budget that ended the run before. The nearest miss is looked for only where the
  // residual is at most twice the tolerance, as on an orbit.
  Expected<PoincareImage, StopReason> image_of(const Point& p, PoincareMap::Derivatives wanted) const {
    const double misses_within = 2 * options.tolerance * std::max(1.0, largest(state_at(p)));
    return PoincareMap(scene_at(p.back()), engine, half_periods)(state_of(state_at(p)), wanted,
                                                                 misses_within);
  }
  // Whether a scene may have the parameter of p, and no component of its state exceeds 1e12.
  bool allows(const Point& p) const {
    for (const SceneField& field : scene_fields)
      if (field.number.is(member_of(parameter)) &&
          !(p.back() > 0 && p.back() >= field.least && p.back() <= field.most))
        return false;
    return largest(state_at(p)) <= 1e12;
  }
};

// A state that has been taken across events that pass phase 0 of the force along a branch of orbits, where
// the states of the branch are taken: an impact, or with compliant walls a touch or the end of a contact
// (docs/mathematics.md, 13.6). The predictor does not know of them.
struct Crossing {
  StateVector state;
  // For each event that has passed, in their order, the derivative of the state after it by the state before,
  // a saltation matrix or its inverse. Their product, the last one leftmost, is the derivative of all. Empty
  // if none has passed.
  std::vector<StateMatrix> by_state;
};
// Takes s across the events that passed phase 0 between `before` and s. s is predicted to first order from
// `before`, a state of the branch; both have as many numbers as the scene's state. The engine is exact or
// restitution.
//   Rigid walls: each mass of s that lies beyond a wall is taken across its impact, forwards if it moves into
//   the wall, else backwards. y and y' of a mass that rests on a wall, or where friction holds it, to within
//   rounding become exact. Returns nothing where an impact with e = 0 would have to be undone, and where an
//   impact has to be crossed while a mass of s rests.
//   Compliant walls: each mass that is in contact in one of s and `before` and not in the other is taken
//   across the touch, or the end of the contact.
std::optional<Crossing> across_phase_0(const Scene& scene, const Engine& engine, const StateVector& before,
                                       const StateVector& s);

// The plane of points p with dot_product(normal, p - through) = 0, on which the corrector looks for a
// solution.
struct Plane {
  Point through, normal;
};

// The plane on which the parameter has the value that it has in p.
Plane at_value(const Point& p);

// A point, its image, and the plane on which it was looked for.
struct Solution {
  Point point;
  PoincareImage image;
  // Only of one that the corrector has found. residuals: those of all iterates, in units of
  // OrbitOptions::tolerance.
  Multipliers multipliers;
  std::vector<double> residuals;
  Plane plane;
};
using Solved = Expected<Solution, NoOrbit>;

// Solves H^n(s; p) = s on a plane by Newton's method (M13.10) from `start`, which was predicted from
// `before`. Where an impact passes phase 0 between these, or between two iterates, iterate and plane are
// carried across it (M13.13). Returns why there is no solution otherwise.
Solved solve(const Equation& equation, const Point& before, const Point& start, const Plane& plane);

// The bordered matrix of (M13.11): the derivative of H^n(s; p) - s by s and the parameter, and `last` as the
// last row. In row_of_rest() of each damper of free_to_rest() stands (M13.28).
Matrix bordered(const Equation& equation, const PoincareImage& image, const Point& last);

// The residual H^m(s) - s, m = half_periods, in which idle dampers count as staying where they rest; nothing
// if a budget ends the run before, or H^m does not exist as m is odd and the scene has weight.
std::optional<StateVector> residual_after(const Equation& equation, const Point& p, int half_periods);

Multipliers multipliers_of(const PoincareImage& image);  // without those of idle dampers
// The unit eigenvector of A for its eigenvalue next to -1, by inverse iteration; nothing if that fails. Idle
// dampers stay where they rest: their y + x and y' + x' in it are 0, or y and y' where friction holds them.
std::optional<StateVector> eigenvector_of_minus_1(const PoincareImage& image, const Scene& scene);

// The orbit of a solution. Of a symmetric one the solution is half, and its mirror image the other half.
Orbit orbit_of(const Equation& equation, const Solution& found, int periods, bool symmetric);

}  // namespace impact_damper::corrector
