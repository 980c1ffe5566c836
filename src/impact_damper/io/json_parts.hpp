// Readers and writers of objects that several kinds of files have as fields.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "impact_damper/engine.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/json_writer.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {

// Writes "engine", with every option that can change a result.
void write_engine(JsonWriter& out, const Engine& engine);
// Writes "units", the SI value of one unit of each quantity.
void write_units(JsonWriter& out, const Scales& scales);
// Writes "provenance", the last field, without its end, which sealed() adds.
void write_provenance(JsonWriter& out);

// Whether an engine may lack an option, which then keeps its default. A run file must have all of them. A
// response file has null for what follows from each of its runs. Elsewhere any may be missing. In a plan any
// that follows from the scene may also be null, as in the file beside a sweep's table.
enum class Lacking { nothing, null, any, any_or_null };
// Reads an engine; absent if any of it is not valid.
std::optional<Engine> read_engine(ObjectReader& object, Lacking lacking = Lacking::any);

// Read the law of a wall and a restitution that depends on the speed, and the law of the primary spring;
// those that are missing stay as they are. folder: in which the files of tables lie; null: none can be read.
void read_laws(ObjectReader& object, WallLaw& wall, Pairs& restitution, const std::filesystem::path* folder);
void read_laws(ObjectReader& object, SpringLaw& spring, const std::filesystem::path* folder);

// Reads the numbers of a scene by calling read(object, field, number, name), by the name that the number has
// in a Problem, for each of `fields` or, if there is a list of dampers, for those of the scene itself and
// those of `damper_fields` for each damper. A list that cannot be read leaves a scene without dampers.
// Reads its laws as well (read_laws). A restitution that depends on the speed is not one of the numbers.
template <class AnyScene, class Fields, class DamperFields, class Read>
void read_numbers(ObjectReader& object, AnyScene& scene, const Fields& fields,
                  const DamperFields& damper_fields, const Read& read,
                  const std::filesystem::path* folder = nullptr) {
  const bool list = object.has("dampers");
  read_laws(object, scene.spring, folder);
  for (const auto& field : fields) {
    const bool is_law = field.name == "restitution" && object.is_array(field.name);
    if (!(field.number.own || !list)) {
      if (object.has(field.name)) object.reject(field.name, beside_dampers);
    } else if (!is_law) {
      read(object, field, field.number.in(scene), std::string(field.name));
    }
  }
  if (!list) return read_laws(object, scene.damper().wall, scene.damper().restitution_by_speed, folder);
  if (object.has("wall")) object.reject("wall", beside_dampers);
  scene.dampers.clear();
  for (ObjectReader& damper : object.optional_objects("dampers", most_dampers, 1)) {
    auto& its = scene.dampers.emplace_back();
    for (const auto& field : damper_fields)
      if (field.number.of_damper && !(field.name == "restitution" && damper.is_array(field.name)))
        read(damper, field, its.*field.number.of_damper, damper_field(scene.dampers.size() - 1, field.name));
    read_laws(damper, its.wall, its.restitution_by_speed, folder);
  }
}

// Reads the fields of a scene from an object, which may hold others. Returns a scene without dampers if their
// list cannot be read. Where a run is read, every field must be there, absent stops as null.
enum class MissingFields { have_defaults, are_problems };
Scene read_scene_fields(ObjectReader& object, MissingFields missing = MissingFields::have_defaults,
                        const std::filesystem::path* folder = nullptr);
// Reads a whole scene, dimensionless or in units. If there are problems, the result must not be used. folder:
// as for read_laws().
SceneFile read_scene_object(ObjectReader& object, const std::filesystem::path* folder = nullptr);
// Write the fields of a scene: all, those without the stops, and those that are given of a scene in units.
void write_scene_fields(JsonWriter& out, const Scene& scene);
void write_scene_numbers(JsonWriter& out, const Scene& scene);
void write_unit_fields(JsonWriter& out, const SceneInUnits& scene);

// Checks "units", if there: six numbers of three scales, which must agree.
void check_units(ObjectReader& root);

// A document, and whether its text ends with the digest of what precedes it (run_file.hpp).
struct SealedDocument {
  JsonDocument document;
  bool sealed;

  static SealedDocument read(const std::filesystem::path& file, const FileKind& kind);
  static SealedDocument parse(const std::string& name, const std::string& text);
  ObjectReader root() { return document.root(); }
  // Reads "provenance", then throws InputError if anything of the document was wrong, or if it is not sealed:
  // its digest is then a problem, too.
  void finish(ObjectReader& root) const;
};

}  // namespace impact_damper
