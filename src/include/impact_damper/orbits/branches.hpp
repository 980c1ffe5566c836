// The periodic orbits of a scene as functions of omega_f or f0, by continuation (docs/mathematics.md, 13.6
// and 13.9). The search starts from the steady motions that simulations end in, follows their branches past
// folds to unstable orbits, and then the branches that begin at the bifurcation points and beyond grazings.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/orbits/orbits.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {

// Both > 0 and different. Simulations begin at `from`, and branches go from there towards `to`.
struct ParameterRange {
  Parameter parameter = Parameter::force_frequency;
  double from = 0, to = 0;

  double least() const { return from < to ? from : to; }
  double most() const { return from < to ? to : from; }
};

struct BranchRule {
  // Decides when a simulation has become periodic. Branches of orbits longer than its longest_period are not
  // followed.
  SteadyRule steady;
  // Largest step of the continuation, in the space of the state and the parameter. In [1e-6, 1e6].
  double largest_step = 5e-2;
  double max_multiplier = 1e4;     // FollowOptions::max_multiplier; 1 to 1e12
  std::int64_t max_points = 1000;  // of each branch; 1 to 1e6
  std::int64_t max_branches = 20;  // 1 to 1000
};
// Valid ranges of max_points and max_branches.
inline constexpr NumberRange most_branch_points = within(1, 1e6), most_branches = within(1, 1000);
// The problems of a rule, one for each member that is not valid.
std::vector<Problem> problems_of(const BranchRule& rule);

// An initial state at ParameterRange::from, and what the simulation from it ends in.
struct BranchStart {
  SceneState state;
  SteadyState steady;                  // without the measured quantities
  std::optional<OrbitEnd> orbit;       // how Newton's iteration from there ended; absent: it is not periodic
  std::optional<std::int64_t> branch;  // index of the branch on which it lies
};
// Returns "periodic", "not_periodic", the budget that ended the simulation, or why no orbit was found near
// it.
std::string_view end_of(const BranchStart& start);

enum class BranchOrigin {
  start,   // a steady motion at ParameterRange::from
  event,   // a flip or a symmetry breaking, where it branches off, or where another one joins it
  beyond,  // a steady motion that simulation ends in beyond the end of another branch
};

struct FollowedBranch {
  BranchOrigin origin = BranchOrigin::start;
  // Index of the start, or of the branch from which it comes.
  std::int64_t from = 0;
  std::optional<std::int64_t> event;  // of that branch, at which this one begins
  Branch branch;
  // Largest |x| of each orbit, and of the orbit of each event. For an unstable orbit the error is up to about
  // 1e-6: the simulation, of two of its periods, drifts away from it.
  std::vector<double> amplitudes, event_amplitudes;
};

struct Branches {
  std::vector<BranchStart> starts;
  std::vector<FollowedBranch> branches;  // each after the one from which it comes
  bool complete = true;                  // false: BranchRule::max_branches ended the search
};

// The branches that are found from `starts`, states at phase 0 of the force. A motion on a known branch
// starts no other. A secondary mass without impacts is taken to rest where the motion is symmetric
// (OrbitOptions), or, if others have impacts and no orbit is found with it there, where the simulation left
// it. A list may have most_dampers_with_changes dampers. `progress` is called with the number of branches
// that are done. No result depends on the number of threads. Throws InvalidArguments if scene, range or rule
// are not valid.
Branches find_branches(const Scene& scene, const Engine& engine, const ParameterRange& range,
                       const BranchRule& rule, const std::vector<SceneState>& starts, const Threads& threads,
                       const std::function<void(std::int64_t done)>& progress);

}  // namespace impact_damper
