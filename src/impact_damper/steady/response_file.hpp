// Sweeps, maps of basins, branches of orbits and Lyapunov exponents as JSON files, schema
// "impact-damper/response/1" (data/schema/response.schema.json), and as CSV. Equal results make equal bytes,
// except in "provenance", the last line, which ends with the digest of all bytes before it as in a run file
// (io/run_file.hpp). All numbers are dimensionless, with "units" for a scene in units.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "impact_damper/steady/basin.hpp"
#include "impact_damper/steady/branches.hpp"
#include "impact_damper/steady/lyapunov.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

inline constexpr std::string_view response_schema = "impact-damper/response/1";

// Throw NumericalError, with the name of the column, if a number is not finite.
std::string sweep_text(const Scene& scene, const Engine& engine, const SteadyRule& rule, const Axis& axis,
                       const std::vector<Sweep>& sweeps, const std::optional<Scales>& scales = {});
std::string basin_text(const Scene& scene, const Engine& engine, const BasinRule& rule, const Axis& first,
                       const Axis& second, const Basin& basin, const std::optional<Scales>& scales = {});
std::string orbits_text(const Scene& scene, const Engine& engine, const BranchRule& rule,
                        const ParameterRange& range, const Branches& branches,
                        const std::optional<Scales>& scales = {});
// periods, skipped: what lyapunov_exponents() was asked for.
std::string lyapunov_text(const Scene& scene, const Engine& engine, std::int64_t periods,
                          std::int64_t skipped, const LyapunovExponents& found,
                          const std::optional<Scales>& scales = {});

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
std::string orbits_csv(const ParameterRange& range, const Branches& branches,
                       const std::optional<SiUnits>& units = {});
// A row for each exponent.
std::string lyapunov_csv(const LyapunovExponents& found, const std::optional<SiUnits>& units = {});

// The name of an axis's number, that of the scene's field.
std::string_view name_of(const Axis& axis);

}  // namespace impact_damper
