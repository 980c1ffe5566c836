// Runs as JSON files, schema "impact-damper/run/1": the scene, the engine with every option that can
// change the result, why and when the run ended, the recorded sections as columns, and provenance.
//
// Equal runs make equal bytes, except in "provenance", the last line. That ends with "sha256", the digest of
// all bytes before that field, so a run that was altered, cut or put under another scene is recognised.
// Numbers read back with the same bits; each column stands on a line of its own; a section that was not
// recorded is not there. Columns are dimensionless; a run of a scene in units has an object "units" before
// them, the SI value of one unit of each quantity (si_units).
//
// Where the scene has a list of dampers, impacts and contacts have a column "damper", the number of the
// damper from 1, and half cycles, history and energy an array "dampers" with an object for each: its
// "impacts" in each half cycle, its "y" and "w", the fields of DamperEnergy.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/run.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

inline constexpr std::string_view run_schema = "impact-damper/run/1";

// A longer file is rejected, because reading takes a few times its length in memory. The limit is 128 MiB:
// room for all that the default budgets allow and the longest history, with all digits of their numbers.
inline constexpr FileKind run_kind{"run", std::size_t{1} << 27};

// A file ends with seal_begin, the digest in 64 hexadecimal digits, seal_end.
inline constexpr std::string_view seal_begin = R"(, "sha256": ")", seal_end = "\"}\n}\n";
// Returns `text`, a run file up to where the digest begins, with that end.
std::string sealed(std::string text);

// Returns the run as the text of its file, with "units" if `scales` are given, those of a scene in units.
// Throws NumericalError, with the name of the column, if a number is not finite: JSON cannot hold it, and no
// correct result has one.
std::string run_text(const Run& run, const std::optional<Scales>& scales = {});

// Returns one recorded section of a run as CSV (RFC 4180, lines end with LF), its columns under their names
// in the run file: the first of half_cycles, impacts, contacts and history that the run has. Names of columns
// of several dampers end in the damper's number: "impacts_1", "y_2_m". With `units` they are in SI, as the
// names show: "time_s", "amplitude_m", "v_m_per_s". An absent number is an empty cell. Throws what run_text()
// throws; std::invalid_argument if the run has none of these sections.
std::string run_csv(const Run& run, const std::optional<Scales>& scales = {});

// Reads a run from a file or a text. The check is strict: every key is known and none missing, the columns of
// a section are equally long, times ascend, sums are equal to their parts, units agree with each other, and
// the digest is that of the content. The result is dimensionless; "units" is for other programs. Throws
// IoError if `file` cannot be read, InputError, with a line for each of the first 50 problems; these lines
// begin with the name of the file, or with `name`.
Run read_run(const std::filesystem::path& file);
Run parse_run(const std::string& name, const std::string& text);

// Reads the engine in `text`, the object "engine" of a run file by itself. Only its "name" must be given;
// other options have their defaults. Throws InputError as above.
Engine parse_engine(const std::string& name, const std::string& text);

}  // namespace impact_damper
