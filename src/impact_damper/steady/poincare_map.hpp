// The Poincare map of a scene under a force, with its exact derivative (docs/mathematics.md, chapter 13).
//
// A force f0 sin(omega_f t) changes its sign after half a period, and the system looks the same in a mirror:
// x -> -x, y -> 1 - y. H is half a period of motion followed by that mirror (M13.1); H applied twice is one
// period. A motion of m periods that repeats itself is a fixed point of H^(2m); one that is its own mirror
// image half a period later, of H^m with m odd.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "impact_damper/math/eigenvalues.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/run.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {

using StateVector = std::vector<double>;  // x, v, then y and w of each damper, by number in the scene
using StateMatrix = Matrix;
StateVector vector_of(const SceneState& s);
// Of a scene with one damper, or with as many of a list as the numbers are for.
SceneState state_of(const StateVector& s, const Scene& scene);
StateVector product(const StateMatrix& a, const StateVector& s);

struct OrbitImpact {
  double time = 0;  // since the force's phase was 0
  Wall wall = Wall::left;
  double speed = 0;         // |y'| just before
  std::int32_t damper = 0;  // its number in the scene
};

struct PoincareImage {
  StopReason stop_reason = StopReason::time;  // any other: the run did not get there, and nothing else is set
  SceneState state{};                         // H^n(s)
  StateMatrix by_state;                       // its derivative by s
  // By omega_f and by f0; meaningless unless Derivatives::by_state_and_parameters was asked for.
  StateVector by_frequency, by_amplitude;
  std::vector<OrbitImpact> impacts;  // in these n half periods, not mirrored
  // Rigid walls: how often a secondary mass comes to stick; not again where one sticks from the beginning.
  std::int64_t sticking = 0;
  // Of several dampers, by number, those that meet no wall while others do, and are held by none.
  std::vector<std::size_t> idle;
  // Of several dampers: whether some met rigid walls at one instant. The derivative is then that of changes
  // that keep them together.
  bool one_sided = false;
  // What tells how near the motion is to grazing, where the derivative by s has no bound (rigid walls) or a
  // kink. Absent where there is no such event.
  std::optional<double> slowest_impact;  // least speed; complete chattering counts with its first impact
  // Least distance from a wall at which y turns back in flight; not of several dampers with compliant walls,
  // nor without Derivatives::by_state_and_parameters of several.
  std::optional<double> nearest_miss;
  // Of several dampers with rigid walls: the least time between impacts of two different ones, which the map
  // would jump by if they changed their order. As if the motion went on as it began.
  std::optional<double> least_interval;
};

// What small changes become in a period takes a time that grows with the fourth power of the number of
// dampers: with so many, seconds.
inline constexpr std::size_t most_dampers_with_changes = 100;

class PoincareMap {
 public:
  // half_periods: n >= 1. Throws InvalidArguments: scene or options are not valid, there is no force, or the
  // engine is cem. Of the scene its initial condition and its end are not used.
  PoincareMap(const Scene& scene, const Engine& engine, int half_periods);

  enum class Derivatives { by_state, by_state_and_parameters };
  // s: at phase 0 of the force; with rigid walls 0 <= y <= 1, or of several dampers their clearances.
  PoincareImage operator()(const SceneState& s, Derivatives wanted = Derivatives::by_state) const;

  const Scene& scene() const { return scene_; }
  const Engine& engine() const { return engine_; }
  int half_periods() const { return half_periods_; }
  double duration() const { return *scene_.until_time; }  // n pi / omega_f

 private:
  // Before the mirror, and while the end of the time stays.
  struct End {
    PoincareImage image;
    StateVector rates;  // x', x'', then y' and y'' of each damper
  };
  End of_one_damper(const SceneState& s, Derivatives wanted) const;
  End of_several(const SceneState& s, Derivatives wanted) const;

  Scene scene_;
  Engine engine_;
  int half_periods_;
  std::optional<ForcedScene> several_;  // dampers
};

}  // namespace impact_damper
