// Responses as JSON files, schema "impact-damper/response/1" (data/schema/response.schema.json), and as CSV.
// Equal results make equal bytes, except in "provenance", the last line, which ends with the digest of all
// bytes before it as in a run file (io/run_file.hpp). All numbers are dimensionless, with "units" for a scene
// in units.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "impact_damper/responses/responses.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

inline constexpr std::string_view response_schema = "impact-damper/response/1";
inline constexpr FileKind response_kind{"response", std::size_t{1} << 27};

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

// The response as a table (RFC 4180, lines end with LF). With `units` in SI, frequencies in Hz, as the names
// say. The rows:
//   sweep: each steady state, with the number of its sweep, counted from 0, "up" or "down", the axis's value,
//     and the columns of the JSON file;
//   basin: each point of the map, with both values and the index of its attractor, -1 where undecided;
//   orbits: each point of each branch and, in its place among these, each event, which "event" names, with
//     the index of the branch, the parameter's value, and the columns of the JSON file;
//   lyapunov: each exponent.
std::string response_csv(const Response& response, const std::optional<Scales>& scales = {});

}  // namespace impact_damper
