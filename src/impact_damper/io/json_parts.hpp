// Readers and writers of objects that several kinds of files have as fields.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "impact_damper/engine.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/json_writer.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// Writes "engine", with every option that can change a result.
void write_engine(JsonWriter& out, const Engine& engine);
// Writes "units", the SI value of one unit of each quantity.
void write_units(JsonWriter& out, const Scales& scales);
// Writes "provenance", the last field, without its end, which sealed() adds.
void write_provenance(JsonWriter& out);

// Reads the engine of a response: every option must be there, null where it follows from each of the runs of
// the response. Absent if there are problems.
std::optional<Engine> read_engine_of_response(ObjectReader& engine);
// Reads the engine of a plan: only its name must be there, and null counts as a missing option. Absent if
// there are problems.
std::optional<Engine> read_engine_of_plan(ObjectReader& engine);
// Reads the numbers of a scene by calling read(object, field, number, name), by the name that the number has
// in a Problem, for each of `fields` or, if there is a list of dampers, for those of the scene itself and
// those of `damper_fields` for each damper. A list that cannot be read leaves a scene without dampers.
template <class AnyScene, class Fields, class DamperFields, class Read>
void read_numbers(ObjectReader& object, AnyScene& scene, const Fields& fields,
                  const DamperFields& damper_fields, const Read& read) {
  const bool list = object.has("dampers");
  for (const auto& field : fields) {
    if (field.number.own || !list)
      read(object, field, field.number.in(scene), std::string(field.name));
    else if (object.has(field.name))
      object.reject(field.name, beside_dampers);
  }
  if (!list) return;
  scene.dampers.clear();
  for (ObjectReader& damper : object.optional_objects("dampers", most_dampers, 1)) {
    auto& its = scene.dampers.emplace_back();
    for (const auto& field : damper_fields)
      if (field.number.of_damper)
        read(damper, field, its.*field.number.of_damper, damper_field(scene.dampers.size() - 1, field.name));
  }
}
// Checks "units", if there: six numbers of three scales, which must agree.
void check_units(ObjectReader& root);
// Whether a text ends with the digest of what precedes it (run_file.hpp).
bool is_sealed(std::string_view text);
// Reads "provenance", then throws InputError if anything of the document was wrong, or if it is not `sealed`:
// its digest is then a problem, too.
void finish_sealed(JsonDocument& document, ObjectReader& root, bool sealed);

}  // namespace impact_damper
