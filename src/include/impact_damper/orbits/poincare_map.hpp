// The Poincare map of a scene under a force, with its exact derivative, which at a periodic orbit is the
// monodromy matrix (docs/mathematics.md, chapter 13).
//
// A force f0 sin(omega_f t) changes its sign after half a period, and the equations are the same in the
// mirror x -> -x, y -> 1 - y (clearance - y for each damper of a list); velocities change their sign. H is
// half a period of motion followed by that mirror (M13.1); H applied twice is one period. A motion of m
// periods that repeats itself is a fixed point of H^(2m); one that is its own mirror image half a period
// later, of H^m with m odd.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/math/dense.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/run.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {

// x, v = x', then y and w = y' of each damper, by number in the scene.
using StateVector = Vector;
using StateMatrix = Matrix;
StateVector vector_of(const SceneState& s);
// The inverse: s has as many components as a state of the scene, with its one damper or all of its list.
SceneState state_of(const StateVector& s);

// A Floquet multiplier of an orbit, an eigenvalue of its monodromy matrix: the factor by which a small
// departure from the orbit along the eigenvector grows in each period.
struct Multiplier {
  double re = 0, im = 0;
  double modulus() const;  // |re + i im|
};
using Multipliers = std::vector<Multiplier>;
// The eigenvalues of a matrix, the largest modulus first; of a conjugate pair the one with im > 0 first.
Multipliers multipliers_of(const Matrix& matrix);

// An impact of a periodic motion.
struct OrbitImpact {
  double time = 0;  // since the beginning of the run, where the force's phase is 0
  Wall wall = Wall::left;
  double speed = 0;         // |y'| just before
  std::int32_t damper = 0;  // its number in the scene
};

struct PoincareImage {
  SceneState state{};    // H^n(s)
  StateMatrix by_state;  // its derivative by s
  // Its derivatives by omega_f and by f0; meaningless unless Derivatives::by_state_and_parameters was asked
  // for.
  StateVector by_frequency, by_amplitude;
  std::vector<OrbitImpact> impacts;  // in these n half periods, not mirrored
  // Rigid walls: how often a secondary mass comes to stick. One that sticks when the run begins does not
  // count.
  std::int64_t sticking = 0;
  // Numbers of the dampers with neither impact nor contact while others have impacts. With friction, of those
  // that are held all the time while others have impacts, or where left and right differ by weight.
  std::vector<std::size_t> idle;
  // Whether several masses met rigid walls at one instant, or with friction other events coincide (13.11).
  // The derivative is then that of changes that keep them together.
  bool one_sided = false;
  // How near the motion is to grazing, where the derivative by s has no bound (rigid walls) or jumps
  // (compliant walls), and to a coincidence of impacts. Each is absent where the motion has no such event.
  std::optional<double> slowest_impact;  // least speed; complete chattering counts with its first impact
  std::optional<double> nearest_miss;    // least distance from a wall at which a mass turns back in flight
  // With friction: how near a mass that stops or is let go comes to where there is no derivative by s. The
  // least of |y''| just before a stop and, where phi_s > phi, of the distance of |x'' + gamma + K q| from
  // phi_s just after, for other masses that are held also just after touches and ends of contacts with
  // compliant walls, and of |(1 + sigma) x'''| at a release (M13.31).
  std::optional<double> stop_margin;
  // Rigid walls, several dampers: the least time between two successive impacts of different dampers; the
  // first follows the last, as on an orbit. Where they change their order the map jumps.
  std::optional<double> least_interval;
};

struct VariationalCoefficients;

// Largest number of dampers for which exponents and branches are computed: the time for a period grows with
// the fourth power of their number, and takes seconds at this one.
inline constexpr std::size_t most_dampers_with_changes = 100;

// Returns the scene that H^n simulates, n = half_periods: with its end at n pi / omega_f. Its initial
// condition, which is not used, is at rest. Throws InvalidArguments if n < 1.
Scene scene_of_map(Scene scene, int half_periods);

// The map H^n of a scene, n = half_periods, and its derivatives.
class PoincareMap {
 public:
  // half_periods: n >= 1, even with weight, for which (M13.1) has no mirror. Throws InvalidArguments if it is
  // not, or problems_of(scene, engine) finds any. The scene's initial condition and its end are not used.
  PoincareMap(const Scene& scene, const Engine& engine, int half_periods);

  // Which derivatives an image has. With none, it has its state and its idle dampers only.
  enum class Derivatives { none, by_state, by_state_and_parameters };
  // The image of s, or the budget that ended the run before. s: the state at phase 0 of the force, with as
  // many dampers as the scene has, which is not checked. With rigid walls a mass lies between them: y from 0
  // to its clearance. misses_within: the nearest miss is looked for only where no component of H^n(s) - s
  // exceeds it.
  Expected<PoincareImage, StopReason> operator()(
      const SceneState& s, Derivatives wanted = Derivatives::by_state,
      double misses_within = std::numeric_limits<double>::infinity()) const;

  const Scene& scene() const { return scene_; }  // with duration() as its end
  const Engine& engine() const { return engine_; }
  int half_periods() const { return half_periods_; }
  double duration() const { return *scene_.until_time; }  // n pi / omega_f

 private:
  Scene scene_;
  Engine engine_;
  int half_periods_;
  ForcedScene forced_;
  std::shared_ptr<const VariationalCoefficients> coefficients_;
};

}  // namespace impact_damper
