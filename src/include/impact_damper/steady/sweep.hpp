// Response sweeps: the steady states of a scene along one of its numbers, for instance the frequency of the
// force, up and down again, with the state carried along. Where two motions coexist the two ways differ: the
// response has hysteresis. And maps: the steady motion that a scene ends in, as a function of two of its
// numbers.
#pragma once

#include <functional>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {

// A number of a scene, and the values it takes: `count` >= 2, equally spaced, both ends included, from < to.
inline constexpr std::int64_t most_values = 100'000;  // largest count that command line and files allow
struct Axis {
  SceneNumber number = &Scene::force_frequency;
  double from = 0, to = 0;
  std::int64_t count = 2;

  double value(std::int64_t i) const;           // 0 <= i < count
  std::vector<double> values() const;           // all of them
  Scene at(Scene scene, std::int64_t i) const;  // with that value
};

// Throws InvalidArguments if the scene is not valid (problems_of) at one of the values, or has no such number
// (numbers_of).
void require_valid(const Scene& scene, const Engine& engine, const Axis& axis);

// The state in which a sweep begins, and its `nudge`, a displacement >= 0 and finite: at each value of a way,
// up or down, except the first it is added to x of the state that comes from the value before. Two sweeps
// through the same strongly stable motion leave it in the same state, to the last bit, and differ no more.
// With different nudges they differ again where the motion is irregular.
struct SweepStart : SceneState {
  // A state alone is a start without a nudge.
  // NOLINTNEXTLINE(google-explicit-constructor)
  SweepStart(const SceneState& state = {}, double of_nudge = 0)  // cppcheck-suppress noExplicitConstructor
      : SceneState(state), nudge(of_nudge) {}
  double nudge = 0;
};
inline constexpr NumberRange nudges{0, 1, false};  // allowed by command line and catalogue
// These states as starts, the first without a nudge, the n-th after it with n times `nudge`.
std::vector<SweepStart> nudged(const std::vector<SceneState>& starts, double nudge);

// The steady states at some values of a number of the scene, in the order given: the first is approached from
// `start`, each other one from the one before; if the number is a clearance, the secondary mass is then at
// the same fraction of it. `after_each` is called after each of them. Throws InvalidArguments if the rule is
// not valid, or the scene at a value.
std::vector<SteadyState> steady_states_along(const Scene& scene, const Engine& engine,
                                             const SceneNumber& number, const std::vector<double>& values,
                                             const SteadyRule& rule, const SweepStart& start,
                                             const std::function<void()>& after_each);

// The result of a sweep along an axis: up[i] and down[i] are the steady states at axis.value(i).
struct Sweep {
  SweepStart start;               // where the way up begins, at the axis's first value
  std::vector<SteadyState> up;    // made from the first value to the last
  std::vector<SteadyState> down;  // made from the last value, where `up` has ended, back to the first
};

// A sweep from each of `starts`, at the same time on several threads. `progress` is called with the number of
// steady states that are done, of 2 axis.count for each start: first 0, then from any of the threads, even
// from two at once. Throws InvalidArguments if the rule is not valid, or the scene at one of the values.
std::vector<Sweep> sweep(const Scene& scene, const Engine& engine, const Axis& axis, const SteadyRule& rule,
                         const std::vector<SweepStart>& starts, const Threads& threads,
                         const std::function<void(std::int64_t done)>& progress);

// --- Maps -------------------------------------------------------------------------------------------------
// A map of basins of attraction over two initial values, or of the steady motions over two parameters.

struct BasinRule {
  SteadyRule steady{.tolerance = 1e-6, .max_periods = 1000};
  // Distance from a state at phase 0 of a known motion within which a point may be captured by it. In (0,
  // 0.5].
  double capture_radius = 1e-3;
};
std::vector<Problem> problems_of(const BasinRule& rule);

// A steady motion that points of the map end in. All those without impacts are one, "idle".
struct Attractor {
  bool idle = false;
  std::int64_t period = 1;  // in periods of the force
  ImpactCounts impacts{};   // in one period of the motion, of all dampers together
  bool symmetric = false;
  std::int64_t points = 0;  // how many points of the map end in it
  // Its states at phase 0, `period` of them; none where the map varies the scene's parameters: motions with
  // equal periods, impacts and symmetry then count as one.
  std::vector<SceneState> states{};
  // Impacts of each damper. Motions that differ only in where an idle mass rests are one.
  std::vector<ImpactCounts> impacts_by_damper{};
};

inline constexpr std::int32_t undecided = -1;  // not within SteadyRule::max_periods
struct Basin {
  std::vector<Attractor> attractors;  // those that most points end in first
  std::vector<std::int32_t>
      attractor;             // of each point, an index or `undecided`; the first axis's value changes first
  std::int64_t stopped = 0;  // points that a budget of the engine ended; they are undecided
};

// The steady motion of each point of the map over two axes. A point is decided as soon as
// - each secondary mass is at rest in space where x cannot reach it any more (M14.5), which is idle, or
// - over initial values: it is within the capture radius of a known motion, and nearer to it a period of that
//   motion later. Known are those that a coarse grid of points ends in, each followed until it is steady by
//   `rule`; or
// - it is steady by `rule`.
// No result depends on the number of threads. Throws InvalidArguments if the rule is not valid, or the
// scene at any point of the map: before anything is simulated if the point is on the first row or column.
Basin basin(const Scene& scene, const Engine& engine, const Axis& first, const Axis& second,
            const BasinRule& rule, const Threads& threads,
            const std::function<void(std::int64_t done)>& progress);

// Whether the number is an initial value of the motion.
bool is_initial_value(const SceneNumber& number);

}  // namespace impact_damper
