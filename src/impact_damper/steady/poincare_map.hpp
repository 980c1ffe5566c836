// The Poincare map of a scene under a force, with its exact derivative (docs/mathematics.md, chapter 13).
//
// A force f0 sin(omega_f t) changes its sign after half a period, and the system looks the same in a mirror:
// x -> -x, y -> 1 - y, or its clearance less y for each of several dampers; velocities change their sign. H
// is half a period of motion followed by that mirror (M13.1); H applied twice is one period. A motion of m
// periods that repeats itself is a fixed point of H^(2m); one that is its own mirror image half a period
// later, of H^m with m odd.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "impact_damper/base/expected.hpp"
#include "impact_damper/math/eigenvalues.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/run.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {

// x, v = x', then y and w = y' of each damper, by number in the scene.
using StateVector = std::vector<double>;
using StateMatrix = Matrix;
StateVector vector_of(const SceneState& s);
// s has as many numbers as a state of the scene, with its one damper or all of its list.
SceneState state_of(const StateVector& s, const Scene& scene);
StateVector product(const StateMatrix& a, const StateVector& s);

struct OrbitImpact {
  double time = 0;  // since the beginning of the run, where the force's phase is 0
  Wall wall = Wall::left;
  double speed = 0;         // |y'| just before
  std::int32_t damper = 0;  // its number in the scene
};

struct PoincareImage {
  SceneState state{};    // H^n(s)
  StateMatrix by_state;  // its derivative by s
  // By omega_f and by f0; meaningless unless Derivatives::by_state_and_parameters was asked for.
  StateVector by_frequency, by_amplitude;
  std::vector<OrbitImpact> impacts;  // in these n half periods, not mirrored
  // Rigid walls: how often a secondary mass comes to stick. One that sticks when the run begins does not
  // count.
  std::int64_t sticking = 0;
  // Of several dampers, by number, those that meet no wall while others do, and that no wall holds.
  std::vector<std::size_t> idle;
  // Of several dampers: whether some met rigid walls at one instant. The derivative is then that of changes
  // after which they still do.
  bool one_sided = false;
  // How near the motion is to grazing, where the derivative by s has no bound (rigid walls) or jumps
  // (compliant walls), and to a coincidence. Each is absent where the motion has no such event.
  std::optional<double> slowest_impact;  // least speed; complete chattering counts with its first impact
  // Least distance from a wall at which a mass turns back in flight. Of several dampers only with rigid
  // walls, and only with Derivatives::by_state_and_parameters.
  std::optional<double> nearest_miss;
  // Of several dampers with rigid walls: the least time between two impacts, one after the other, of
  // different ones; the last and the first count, as on an orbit. Where these change their order the map
  // jumps.
  std::optional<double> least_interval;
};

// Largest number of dampers for which exponents and branches are worked out: the time for a period grows with
// its fourth power, and takes seconds then.
inline constexpr std::size_t most_dampers_with_changes = 100;

class PoincareMap {
 public:
  // half_periods: n >= 1. Throws InvalidArguments if n, the scene or the engine's options are not valid,
  // there is no force, or the engine is cem. The scene's initial condition and its end are not used.
  PoincareMap(const Scene& scene, const Engine& engine, int half_periods);

  enum class Derivatives { by_state, by_state_and_parameters };
  // s: at phase 0 of the force, of as many dampers as the scene has, which is not checked. With rigid walls a
  // mass lies between them: y from 0 to 1, or to its clearance. Or which budget ended the run before.
  Expected<PoincareImage, StopReason> operator()(const SceneState& s,
                                                 Derivatives wanted = Derivatives::by_state) const;

  const Scene& scene() const { return scene_; }  // with duration() as its end
  const Engine& engine() const { return engine_; }
  int half_periods() const { return half_periods_; }
  double duration() const { return *scene_.until_time; }  // n pi / omega_f

 private:
  // An image before it is mirrored, with derivatives by the parameters for an end that does not move.
  struct End {
    PoincareImage image;
    StateVector rates;  // x', x'', then y' and y'' of each damper
  };
  Expected<End, StopReason> of_one_damper(const SceneState& s, Derivatives wanted) const;
  Expected<End, StopReason> of_several(const SceneState& s, Derivatives wanted) const;

  Scene scene_;
  Engine engine_;
  int half_periods_;
  std::optional<ForcedScene> several_;  // the scene, if it has a list of dampers
};

}  // namespace impact_damper
