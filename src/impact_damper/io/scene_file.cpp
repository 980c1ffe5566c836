#include "impact_damper/io/scene_file.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/json_writer.hpp"
#include "impact_damper/io/run_file.hpp"

namespace impact_damper {
namespace {

// The given keys that only a scene in units has, and those that only a dimensionless one has.
struct GivenKeys {
  std::string in_units, dimensionless;
};

GivenKeys given_keys(const ObjectReader& object) {
  GivenKeys given;
  const auto add = [&](std::string& list, std::string_view key) {
    if (object.holds(key)) list += (list.empty() ? "" : ", ") + std::string(key);
  };
  const auto is_in_both = [](std::string_view name) {
    const auto* const field = std::ranges::find(unit_fields, name, &UnitField::name);
    return field != unit_fields.end() && field->also_dimensionless;
  };
  for (const UnitField& field : unit_fields)
    if (!field.also_dimensionless) add(given.in_units, field.name);
  for (const SceneField& field : scene_fields)
    if (!is_in_both(field.name)) add(given.dimensionless, field.name);
  for (const std::string_view stop : {"until_time", "until_amplitude"}) add(given.dimensionless, stop);
  return given;
}

// Whether a list of dampers is rejected because one damper is required; it is then the only problem reported.
bool rejects_dampers(ObjectReader& object, DamperList dampers) {
  if (dampers == DamperList::allowed || !object.holds("dampers")) return false;
  object.keys();
  Scene scene;
  scene.dampers.resize(1);
  for (const Problem& problem : problems_of(scene)) object.reject(problem);
  return true;
}

SceneInUnits read_unit_fields(ObjectReader& object) {
  SceneInUnits scene;
  std::vector<std::string> unreadable;
  const auto read = [&](ObjectReader& from, std::string_view key, const std::string& field,
                        std::optional<double>& target) {
    if (!from.has(key)) return;
    // A field that cannot be read is neither missing nor usable.
    double value = std::numeric_limits<double>::quiet_NaN();
    if (!from.optional(key, value)) unreadable.push_back(field);
    target = value;
  };
  for (const UnitField& field : unit_fields)
    read(object, field.name, std::string(field.name), scene.*field.member);
  for (ObjectReader& damper : object.optional_objects("dampers", most_dampers, 1)) {
    const std::size_t i = scene.dampers.size();
    scene.dampers.emplace_back();
    for (const DamperUnitField& field : damper_unit_fields) {
      read(damper, field.name, damper_field(i, field.name), scene.dampers[i].*field.member);
      if (!damper.is_object()) unreadable.push_back(damper_field(i, field.name));
    }
  }
  if (object.holds("dampers") && scene.dampers.empty()) {  // its problems have been reported
    scene.dampers.emplace_back();
    for (const DamperUnitField& field : damper_unit_fields) unreadable.push_back(damper_field(0, field.name));
  }
  for (const Problem& problem : problems_of(scene, DamperList::allowed))
    if (std::ranges::find(unreadable, problem.field) == unreadable.end()) object.reject(problem);
  return scene;
}

SceneFile read_whole(JsonDocument document, DamperList dampers) {
  ObjectReader object = document.root();
  SceneFile file = read_scene_object(object, dampers);
  document.finish();
  return file;
}

// Rejects a run given for a scene, which would be a list of problems, or too long.
void reject_run(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) return;  // a pipe is read once
  constexpr std::size_t enough = 100;                            // the schema is the first key of a run
  std::string head(enough, ' ');
  std::ifstream(file, std::ios::binary).read(head.data(), static_cast<std::streamsize>(enough));
  if (head.find('"' + std::string(run_schema) + '"') == std::string::npos) return;
  throw InputError(
      file.string(),
      {{"", "this is a run, must be a scene; the scene of a run is the object \"scene\" in it"}});
}

}  // namespace

Scene read_scene_fields(ObjectReader& object, DamperList dampers, MissingFields missing) {
  Scene scene;
  if (rejects_dampers(object, dampers)) return scene;
  const bool several = object.has("dampers"), all = missing == MissingFields::are_problems;
  const auto read = [&](ObjectReader& from, const auto& field, auto& target) {
    if (all) from.require(field.name);
    from.optional(field.name, target.*field.member);
  };
  for (const SceneField& field : scene_fields) {
    if (!several || !is_of_one_damper(field))
      read(object, field, scene);
    else if (object.has(field.name))
      object.reject(field.name, beside_dampers);
  }
  for (ObjectReader& damper : object.optional_objects("dampers", most_dampers, 1)) {
    SceneDamper& its = scene.dampers.emplace_back();
    for (const SceneDamperField& field : scene_damper_fields) read(damper, field, its);
  }
  for (const std::string_view stop : {"until_time", "until_amplitude"})
    if (all) object.require(stop);
  const bool time_is_read = object.optional("until_time", scene.until_time);
  const bool amplitude_is_read = object.optional("until_amplitude", scene.until_amplitude);
  for (const Problem& problem : problems_of(scene, dampers)) {
    // A stop that was given but could not be read is not missing as well.
    const bool given = problem.field == "until_time" && !(time_is_read && amplitude_is_read);
    if (!given) object.reject(problem);
  }
  return scene;
}

SceneFile read_scene_object(ObjectReader& object, DamperList dampers) {
  SceneFile file;
  if (rejects_dampers(object, dampers)) return file;
  object.optional("description", file.description);
  for (const UnitField& field : unit_fields) object.suggest(field.name);
  for (const SceneField& field : scene_fields) object.suggest(field.name);
  const auto [in_units, without_units] = given_keys(object);
  if (in_units.empty()) {
    file.scene = read_scene_fields(object, dampers);
    return file;
  }
  file.in_units = read_unit_fields(object);
  if (!without_units.empty()) {
    for (const SceneField& field : scene_fields) object.has(field.name);
    object.has("until_time"), object.has("until_amplitude");
    object.reject("",
                  "must be either in units or dimensionless, got " + in_units + " beside " + without_units);
  }
  if (problems_of(*file.in_units, dampers).empty()) {
    file.scene = dimensionless(*file.in_units);
    file.scales = scales_of(*file.in_units);
  }
  return file;
}

SceneFile read_scene_file(const std::filesystem::path& file, DamperList dampers) {
  reject_run(file);
  return read_whole(JsonDocument::read(file, scene_kind), dampers);
}

Scene read_scene(const std::filesystem::path& file, DamperList dampers) {
  return read_scene_file(file, dampers).scene;
}

SceneFile parse_scene_file(const std::string& name, const std::string& text, DamperList dampers) {
  return read_whole(JsonDocument::parse(name, text), dampers);
}

Scene parse_scene(const std::string& name, const std::string& text, DamperList dampers) {
  return parse_scene_file(name, text, dampers).scene;
}

void write_scene_numbers(JsonWriter& out, const Scene& scene) {
  const bool several = !scene.dampers.empty();
  for (const SceneField& each : scene_fields)
    if (!several || !is_of_one_damper(each)) out.field(each.name, scene.*each.member);
  if (several) out.open_array("dampers", JsonWriter::Layout::one_line);
  for (const SceneDamper& damper : scene.dampers) {
    out.open_object(JsonWriter::Layout::one_line);
    for (const SceneDamperField& each : scene_damper_fields) out.field(each.name, damper.*each.member);
    out.close();
  }
  if (several) out.close();
}

void write_scene_fields(JsonWriter& out, const Scene& scene) {
  write_scene_numbers(out, scene);
  out.field("until_time", scene.until_time);
  out.field("until_amplitude", scene.until_amplitude);
}

void write_unit_fields(JsonWriter& out, const SceneInUnits& scene) {
  for (const UnitField& each : unit_fields)
    if (scene.*each.member) out.field(each.name, scene.*each.member);
  if (scene.dampers.empty()) return;
  out.open_array("dampers", out.layout());
  for (const DamperInUnits& damper : scene.dampers) {
    out.open_object(JsonWriter::Layout::one_line);
    for (const DamperUnitField& each : damper_unit_fields)
      if (damper.*each.member) out.field(each.name, damper.*each.member);
    out.close();
  }
  out.close();
}

std::string scene_text(const Scene& scene) {
  JsonWriter out("scene");
  out.open_object(JsonWriter::Layout::one_line);
  write_scene_fields(out, scene);
  out.close();
  return out.finish();
}

}  // namespace impact_damper
