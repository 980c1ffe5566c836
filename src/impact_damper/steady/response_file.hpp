// Sweeps, maps of basins, branches of orbits and Lyapunov exponents as JSON files, schema
// "impact-damper/response/1" (data/schema/response.schema.json), and as CSV. Equal results make equal bytes,
// except in "provenance", the last line, which ends with the digest of all bytes before it as in a run file
// (io/run_file.hpp). All numbers are dimensionless, with "units" for a scene in units.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "impact_damper/io/file_kind.hpp"
#include "impact_damper/steady/basin.hpp"
#include "impact_damper/steady/branches.hpp"
#include "impact_damper/steady/lyapunov.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

inline constexpr std::string_view response_schema = "impact-damper/response/1";
inline constexpr FileKind response_kind{"response", std::size_t{1} << 27};

// The contents of a file by kind: the parameters of a computation, and its results. The stops of a scene are
// not used, and no file has them.
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
  SceneState state;                             // at phase 0 of the force
  std::vector<ImpactCounts> impacts_by_damper;  // the same for each damper of a list
};
struct OrbitEvent {
  BranchEventKind kind = BranchEventKind::fold;
  double value = 0;
  std::int64_t points_before = 0;
  SceneState state;
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

// The text of a response's file. Throws NumericalError, with the name of the column, if a number is not
// finite.
std::string response_text(const Response& response, const std::optional<Scales>& scales = {});

// The parameters of the computation: each part as JSON, under its pointer. Responses with the same parts are
// results of the same computation, so they are equal.
std::vector<std::pair<std::string, std::string>> asked_of(const Response& response);

// The response in a file or a text. The check is strict: every key is known and none missing, columns are
// equally long, whatever follows from the parameters (the axis's values, the linear amplitudes) has that
// value, and the digest is that of the content. Throws IoError if `file` cannot be read, InputError, with a
// line for each of the first 50 problems; these lines begin with the name of the file, or with `name`.
Response read_response(const std::filesystem::path& file);
Response parse_response(const std::string& name, const std::string& text);

// The contradictions between the numbers of a response that are found without simulating, Problem::field
// being the JSON pointer into its file. The rules:
//   sweep: the force's power is that of the fundamental and, of a periodic motion, equals what damper and
//     impacts take out; a symmetric motion strikes both walls equally often; as many periods are measured as
//     the rule says; only a motion that is not periodic scatters; |x| does not exceed the amplitude;
//   basin: no motion without impacts but the idle one; a symmetric one strikes both walls equally often;
//     those that most points end in come first;
//   orbits: the multipliers descend and agree with the stability; a symmetric orbit strikes both
//     walls equally often; |x| does not exceed the amplitude; branches and events refer to existing ones;
//   lyapunov: as many exponents as errors, none unless the run was completed.
std::vector<Problem> inconsistencies_of(const Response& response);

// One table (RFC 4180, lines end with LF). A row for each steady state: the number of its sweep, counted from
// 0, "up" or "down", the axis's value, and the columns of the JSON file. With `units` in SI, frequencies in
// Hz, as the names say.
std::string sweep_csv(const Scene& scene, const Axis& axis, const std::vector<Sweep>& sweeps,
                      const std::optional<SiUnits>& units = {});
// A row for each point of the map: both values and the index of its attractor, empty where undecided.
std::string basin_csv(const Axis& first, const Axis& second, const Basin& basin,
                      const std::optional<SiUnits>& units = {});
// A row for each point of each branch and, in its place among these, for each event, which "event" names: the
// index of the branch, the parameter's value, and the columns of the JSON file.
std::string orbits_csv(const Scene& scene, const ParameterRange& range, const Branches& branches,
                       const std::optional<SiUnits>& units = {});
// A row for each exponent.
std::string lyapunov_csv(const LyapunovExponents& found, const std::optional<SiUnits>& units = {});

}  // namespace impact_damper
