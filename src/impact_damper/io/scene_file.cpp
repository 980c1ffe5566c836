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

// The object of each damper of a list.
std::vector<ObjectReader> damper_objects(ObjectReader& object) {
  return object.optional_objects("dampers", most_dampers, 1);
}

// The field of a damper, which problems_of() names, where it stands in a file: one damper may be a list, too.
Problem in_file(Problem problem, const ObjectReader& object) {
  const auto* const field = std::ranges::find(scene_damper_fields, problem.field, &SceneField::name);
  const auto* const in_units = std::ranges::find(unit_fields, problem.field, &UnitField::name);
  const bool of_damper =
      field != scene_damper_fields.end() || (in_units != unit_fields.end() && in_units->number.of_damper);
  if (of_damper && object.holds("dampers")) problem.field = damper_field(0, problem.field);
  return problem;
}

SceneInUnits read_unit_fields(ObjectReader& object) {
  SceneInUnits scene;
  std::vector<std::string> unreadable;
  const auto read = [&](ObjectReader& from, const UnitField& field, const std::string& name,
                        std::optional<double>& target) {
    if (!from.has(field.name)) return;
    // A field that cannot be read is neither missing nor usable.
    double value = std::numeric_limits<double>::quiet_NaN();
    if (!from.optional(field.name, value)) unreadable.push_back(name);
    target = value;
  };
  const bool list = object.holds("dampers");
  for (const UnitField& field : unit_fields) {
    if (field.number.own || !list)
      read(object, field, std::string(field.name), field.number.in(scene));
    else if (object.has(field.name))
      object.reject(field.name, beside_dampers);
  }
  std::vector<ObjectReader> dampers = damper_objects(object);
  if (!dampers.empty()) scene.dampers.resize(dampers.size());
  for (std::size_t i = 0; list && i < scene.dampers.size(); ++i) {
    for (const UnitField& field : unit_fields) {
      if (!field.number.of_damper) continue;
      const std::string name = damper_field(i, field.name);
      if (i < dampers.size() && dampers[i].is_object())
        read(dampers[i], field, name, scene.dampers[i].*field.number.of_damper);
      else
        unreadable.push_back(name);  // as has been reported
    }
  }
  for (const Problem& each : problems_of(scene)) {
    const Problem problem = in_file(each, object);
    if (std::ranges::find(unreadable, problem.field) == unreadable.end()) object.reject(problem);
  }
  return scene;
}

SceneFile read_whole(JsonDocument document) {
  ObjectReader object = document.root();
  SceneFile file = read_scene_object(object);
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

Scene read_scene_fields(ObjectReader& object, MissingFields missing) {
  Scene scene;
  const bool list = object.has("dampers"), all = missing == MissingFields::are_problems;
  const auto read = [&](ObjectReader& from, const SceneField& field, double& target) {
    if (all) from.require(field.name);
    from.optional(field.name, target);
  };
  for (const SceneField& field : scene_fields) {
    if (field.number.own || !list)
      read(object, field, field.number.in(scene));
    else if (object.has(field.name))
      object.reject(field.name, beside_dampers);
  }
  std::vector<ObjectReader> dampers = damper_objects(object);
  if (list) scene.dampers.resize(dampers.size());
  for (std::size_t i = 0; i < dampers.size(); ++i)
    for (const SceneField& field : scene_damper_fields)
      read(dampers[i], field, scene.dampers[i].*field.number.of_damper);
  for (const std::string_view stop : {"until_time", "until_amplitude"})
    if (all) object.require(stop);
  const bool time_is_read = object.optional("until_time", scene.until_time);
  const bool amplitude_is_read = object.optional("until_amplitude", scene.until_amplitude);
  for (const Problem& problem : problems_of(scene)) {
    // A stop that was given but could not be read is not missing as well.
    const bool given = problem.field == "until_time" && !(time_is_read && amplitude_is_read);
    const bool no_dampers = list && dampers.empty();  // as has been reported
    if (!given && !no_dampers) object.reject(in_file(problem, object));
  }
  return scene;
}

SceneFile read_scene_object(ObjectReader& object) {
  SceneFile file;
  object.optional("description", file.description);
  for (const UnitField& field : unit_fields) object.suggest(field.name);
  for (const SceneField& field : scene_fields) object.suggest(field.name);
  const auto [in_units, without_units] = given_keys(object);
  if (in_units.empty()) {
    file.scene = read_scene_fields(object);
    return file;
  }
  file.in_units = read_unit_fields(object);
  if (!without_units.empty()) {
    for (const SceneField& field : scene_fields) object.has(field.name);
    object.has("until_time"), object.has("until_amplitude");
    object.reject("",
                  "must be either in units or dimensionless, got " + in_units + " beside " + without_units);
  }
  if (problems_of(*file.in_units).empty()) {
    file.scene = dimensionless(*file.in_units);
    file.scales = scales_of(*file.in_units);
  }
  return file;
}

SceneFile read_scene_file(const std::filesystem::path& file) {
  reject_run(file);
  return read_whole(JsonDocument::read(file, scene_kind));
}

Scene read_scene(const std::filesystem::path& file) { return read_scene_file(file).scene; }

SceneFile parse_scene_file(const std::string& name, const std::string& text) {
  return read_whole(JsonDocument::parse(name, text));
}

Scene parse_scene(const std::string& name, const std::string& text) {
  return parse_scene_file(name, text).scene;
}

void write_scene_numbers(JsonWriter& out, const Scene& scene) {
  const bool one = has_one_damper(scene);
  for (const SceneField& each : scene_fields)
    if (one || each.number.own) out.field(each.name, each.number.in(scene));
  if (one) return;
  out.open_array("dampers", JsonWriter::Layout::one_line);
  for (const SceneDamper& damper : scene.dampers) {
    out.open_object(JsonWriter::Layout::one_line);
    for (const SceneField& each : scene_damper_fields) out.field(each.name, damper.*each.number.of_damper);
    out.close();
  }
  out.close();
}

void write_scene_fields(JsonWriter& out, const Scene& scene) {
  write_scene_numbers(out, scene);
  out.field("until_time", scene.until_time);
  out.field("until_amplitude", scene.until_amplitude);
}

void write_unit_fields(JsonWriter& out, const SceneInUnits& scene) {
  const auto write = [&](const UnitField& field, const std::optional<double>& value) {
    if (value) out.field(field.name, value);
  };
  const bool one = scene.dampers.size() == 1;
  for (const UnitField& each : unit_fields)
    if (one || each.number.own) write(each, each.number.in(scene));
  if (one) return;
  out.open_array("dampers", out.layout());
  for (const DamperInUnits& damper : scene.dampers) {
    out.open_object(JsonWriter::Layout::one_line);
    for (const UnitField& each : unit_fields)
      if (each.number.of_damper) write(each, damper.*each.number.of_damper);
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
