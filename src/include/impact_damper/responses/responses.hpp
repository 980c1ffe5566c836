// Responses of a scene to its force: the parameters of a computation (a sweep, a map of basins, branches of
// orbits, Lyapunov exponents), and its results. Each is the contents of a file of one kind
// (response_file.hpp). The stops of a scene are not used, and no file has them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "impact_damper/orbits/branches.hpp"
#include "impact_damper/orbits/lyapunov.hpp"
#include "impact_damper/steady/sweep.hpp"

namespace impact_damper {

struct SweepResponse {
  static constexpr std::string_view kind = "sweep";
  Scene scene;
  Engine engine;
  SteadyRule rule;
  Axis axis;
  std::vector<Sweep> sweeps;
};

struct BasinResponse {
  static constexpr std::string_view kind = "basin";
  Scene scene;
  Engine engine;
  BasinRule rule;
  Axis first, second;
  Basin basin;  // only the first of an attractor's states; no `stopped`
};

// A point of a branch.
struct OrbitPoint {
  double value = 0;         // of the number that varies
  std::int64_t period = 1;  // in periods of the force
  bool symmetric = false, stable = false;
  ImpactCounts impacts{};                    // in one period of the orbit
  std::int64_t sticking = 0;                 // in one period of the orbit
  double amplitude = 0;                      // largest |x|
  Multipliers multipliers = Multipliers(4);  // with a list the four largest
  std::optional<double> slowest_impact, nearest_miss, least_interval;
  std::optional<double> stop_margin;            // with friction
  SceneState state;                             // at phase 0 of the force
  std::vector<ImpactCounts> impacts_by_damper;  // the same for each damper
};
// An event, and the orbit at it, of which JSON files have only value and state.
struct OrbitEvent : OrbitPoint {
  BranchEventKind kind = BranchEventKind::fold;
  std::int64_t points_before = 0;
};
struct OrbitBranch {
  BranchOrigin origin = BranchOrigin::start;
  std::int64_t from = 0;              // as in FollowedBranch
  std::optional<std::int64_t> event;  // as there
  BranchEnd end = BranchEnd::not_an_orbit;
  std::vector<OrbitPoint> points;
  std::vector<OrbitEvent> events;
};
struct OrbitStart {
  std::string end;  // end_of(BranchStart)
  std::int64_t transient_periods = 0;
  std::optional<std::int64_t> branch;
  SceneState state;
};
struct OrbitsResponse {
  static constexpr std::string_view kind = "orbits";
  Scene scene;
  Engine engine;
  BranchRule rule;
  ParameterRange range;
  std::vector<OrbitStart> starts;
  bool complete = true;
  std::vector<OrbitBranch> branches;
};
OrbitsResponse orbits_response(const Scene& scene, const Engine& engine, const BranchRule& rule,
                               const ParameterRange& range, const Branches& branches);

struct LyapunovResponse {
  static constexpr std::string_view kind = "lyapunov";
  Scene scene;
  Engine engine;
  // Periods of the force over which is averaged, 10 to 1e9, and which are skipped before, 0 to 1e9. The
  // reader rejects other numbers.
  std::int64_t periods = 0, discard = 0;
  LyapunovExponents found;
};

using Response = std::variant<SweepResponse, BasinResponse, OrbitsResponse, LyapunovResponse>;
std::string_view kind_of(const Response& response);

// Does the computation that `asked` describes, and returns it with these results in place of its own. Throws
// InvalidArguments as sweep(), basin(), find_branches() and lyapunov_exponents() do.
Response found_for(Response asked, const Threads& threads);

// How the simulation at a value of a sweep ended: "periodic", "not_periodic" or the budget that ended it.
std::string_view end_of(const SteadyState& steady);

}  // namespace impact_damper
