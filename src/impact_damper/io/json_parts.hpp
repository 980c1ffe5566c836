// Objects that files of more than one kind have, as fields of an object that is being written or read.
#pragma once

#include <optional>
#include <string_view>

#include "impact_damper/engine.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/json_writer.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// "engine", with every option that can change a result.
void write_engine(JsonWriter& out, const Engine& engine);
// "units", what one unit of each quantity is in SI.
void write_units(JsonWriter& out, const SiUnits& units);
// "provenance", the last field, left open: sealed() ends it.
void write_provenance(JsonWriter& out);

// The engine of a response: every option of it must be there, null where it follows from each of the runs
// that the response was made with. Absent if there are problems.
std::optional<Engine> read_engine_of_response(ObjectReader& engine);
// The engine of a plan: only its name must be there; null is as if an option were missing. Absent if there
// are problems.
std::optional<Engine> read_engine_of_plan(ObjectReader& engine);
// "units", if there: six numbers of three scales, which must go together.
void check_units(ObjectReader& root);
// Whether a text ends with the digest of what stands before it (run_file.hpp).
bool is_sealed(std::string_view text);
// Reads "provenance", then throws InputError if anything of the document was wrong, or if it is not `sealed`:
// its digest is then a problem, too.
void finish_sealed(JsonDocument& document, ObjectReader& root, bool sealed);

}  // namespace impact_damper
