// Runs as JSON files, schema "impact-damper/run/1": the scene, the engine with every option that can
// change the result, why and when the run ended, the recorded sections as columns, and provenance.
//
// Equal runs make equal bytes, but for "provenance", the last line. That ends with "sha256", the digest of
// all bytes before it: a run that was altered, cut or put under another scene is told from one as it was
// written. Numbers are written so that they read back with the same bits; each column stands on a line of its
// own; a section that was not recorded is not there. Columns are dimensionless; a run of a scene in units has
// an object "units" before them, which says what one unit of each is in SI (si_units).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/io/file_kind.hpp"
#include "impact_damper/run.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

inline constexpr std::string_view run_schema = "impact-damper/run/1";

// Read, a file takes a few times its length in memory, so that has a limit: all that the default budgets
// allow and the longest history, however long their numbers are.
inline constexpr FileKind run_kind{"run", std::size_t{1} << 27};

// A file ends with these, and the digest between them.
inline constexpr std::string_view seal_begin = R"(, "sha256": ")", seal_end = "\"}\n}\n";
// `text`, the beginning of a file up to the last field of "provenance" but the digest, with these.
std::string sealed(std::string text);

// The run as the text of its file, with "units" if its scene was given in units of these `scales`. Throws
// NumericalError naming the column that holds a number which is not finite: JSON has none, and no result has
// one.
std::string run_text(const Run& run, const std::optional<Scales>& scales = {});

// One recorded section of a run as CSV (RFC 4180, lines end with LF), its columns under their names in the
// run file: half_cycles, impacts, contacts or history, whichever is there; the first of them, if several are.
// With `units` they are in SI, and the names say so: "time_s", "amplitude_m", "v_m_per_s". An absent number
// is an empty cell. Throws as run_text() does; std::invalid_argument if the run has none of these sections.
std::string run_csv(const Run& run, const std::optional<SiUnits>& units = {});

// The run out of a file or a text, strictly: every key known and given, columns of a section equally
// long, times ascending, sums equal to their parts, units that go together, and the digest that of the
// content. The units are for other programs: what is read stays dimensionless. Throws IoError if `file`
// cannot be read, InputError naming everything that is not valid.
Run read_run(const std::filesystem::path& file);
Run parse_run(const std::string& name, const std::string& text);

// An engine out of the object "engine" of a run file alone, in which all but its name may be missing and then
// has its default. Throws InputError as above.
Engine parse_engine(const std::string& name, const std::string& text);

}  // namespace impact_damper
