// Readers and writers of objects that several kinds of files have as fields.
#pragma once

#include <optional>
#include <string_view>

#include "impact_damper/engine.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/json_writer.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// Writes "engine", with every option that can change a result.
void write_engine(JsonWriter& out, const Engine& engine);
// Writes "units", the SI value of one unit of each quantity.
void write_units(JsonWriter& out, const SiUnits& units);
// Writes "provenance", the last field, without its end, which sealed() adds.
void write_provenance(JsonWriter& out);

// Reads the engine of a response: every option must be there, null where it follows from each of the runs of
// the response. Absent if there are problems.
std::optional<Engine> read_engine_of_response(ObjectReader& engine);
// Reads the engine of a plan: only its name must be there, and null counts as a missing option. Absent if
// there are problems.
std::optional<Engine> read_engine_of_plan(ObjectReader& engine);
// Checks "units", if there: six numbers of three scales, which must agree.
void check_units(ObjectReader& root);
// Whether a text ends with the digest of what precedes it (run_file.hpp).
bool is_sealed(std::string_view text);
// Reads "provenance", then throws InputError if anything of the document was wrong, or if it is not `sealed`:
// its digest is then a problem, too.
void finish_sealed(JsonDocument& document, ObjectReader& root, bool sealed);

}  // namespace impact_damper
