// The steady motion that a scene ends in, as a function of two of its numbers: a map of basins of attraction
// over two initial values, or of the motions over two parameters.
#pragma once

#include <functional>
#include <vector>

#include "impact_damper/steady/sweep.hpp"

namespace impact_damper {

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
// No result depends on the number of threads. Throws InvalidArguments if the rule is not valid, or the scene
// at any point of the map: before anything is simulated if the point is on the first row or column.
Basin basin(const Scene& scene, const Engine& engine, const Axis& first, const Axis& second,
            const BasinRule& rule, const Threads& threads,
            const std::function<void(std::int64_t done)>& progress);

// Whether the number is an initial value of the motion.
bool is_initial_value(const SceneNumber& number);

}  // namespace impact_damper
