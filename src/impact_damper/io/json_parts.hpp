// Objects that files of more than one kind have, as fields of an object that is being written.
#pragma once

#include "impact_damper/engine.hpp"
#include "impact_damper/io/json_writer.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// "engine", with every option that can change a result.
void write_engine(JsonWriter& out, const Engine& engine);
// "units", what one unit of each quantity is in SI.
void write_units(JsonWriter& out, const SiUnits& units);
// "provenance", the last field, left open: sealed() ends it.
void write_provenance(JsonWriter& out);

}  // namespace impact_damper
