#include "impact_damper/io/scene_file.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/csv.hpp"
#include "impact_damper/io/json_parts.hpp"
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
  const auto has = [](const auto& fields, std::string_view name) {
    return std::ranges::any_of(fields, [&](const auto& each) { return each.name == name; });
  };
  for (const UnitField& field : unit_fields)
    if (!has(scene_fields, field.name)) add(given.in_units, field.name);
  for (const SceneField& field : scene_fields)
    if (!has(unit_fields, field.name)) add(given.dimensionless, field.name);
  for (const std::string_view stop : {"until_time", "until_amplitude"}) add(given.dimensionless, stop);
  return given;
}

// The field of a damper, which problems_of() names, where it stands in a file: one damper may be a list, too.
Problem in_file(Problem problem, const ObjectReader& object) {
  const auto is_it = [&](const auto& field) { return field.number.of_damper && field.name == problem.field; };
  const bool of_damper = problem.field.starts_with("wall.") || std::ranges::any_of(scene_fields, is_it) ||
                         std::ranges::any_of(unit_fields, is_it);
  if (of_damper && object.holds("dampers")) problem.field = damper_field(0, problem.field);
  return problem;
}

// Reads the pairs of a table from "pairs" or from a CSV file of two columns, whose first row may name them.
// Returns false after a problem.
bool read_table(ObjectReader& object, Pairs& pairs, const std::filesystem::path* folder) {
  const auto reject = [&](std::string_view key, const std::string& what) {
    object.reject(key, what);
    return false;
  };
  const bool has_pairs = object.has("pairs"), has_file = object.has("file");
  if (has_pairs == has_file)
    return reject("", std::string("must have either pairs or a file, got ") + (has_file ? "both" : "none"));
  if (has_pairs) return object.optional("pairs", pairs, most_pairs);
  std::string name, text;
  if (!object.optional("file", name, some_text)) return false;
  if (!folder) return reject("file", "is for a scene in a file: give its pairs instead");
  try {
    text = read_text(*folder / name, table_kind);
  } catch (const std::exception& error) {
    return reject("file", error.what());
  }
  CsvRows rows(text);
  for (std::vector<std::string> cells; rows.next(cells);) {
    const bool two = cells.size() == 2;
    const auto first = two ? parse_number(cells[0]) : std::nullopt,
               second = two ? parse_number(cells[1]) : std::nullopt;
    if (first && second)
      pairs.push_back({*first, *second});
    else if (rows.line() > 1)
      return reject("file", name + ", line " + std::to_string(rows.line()) + ": must be two numbers");
  }
  return true;
}

SceneInUnits read_unit_fields(ObjectReader& object, const std::filesystem::path* folder) {
  SceneInUnits scene;
  std::vector<std::string> unreadable;
  const auto read = [&](ObjectReader& from, const UnitField& field, std::optional<double>& target,
                        const std::string& name) {
    if (!from.is_object()) unreadable.push_back(name);  // as has been reported
    if (!from.has(field.name)) return;
    // A field that cannot be read is neither missing nor usable.
    double value = std::numeric_limits<double>::quiet_NaN();
    if (!from.optional(field.name, value)) unreadable.push_back(name);
    target = value;
  };
  read_numbers(object, scene, unit_fields, unit_fields, read, folder);
  if (scene.dampers.empty()) unreadable.emplace_back("dampers");
  for (const Problem& each : problems_of(scene)) {
    const Problem problem = in_file(each, object);
    if (std::ranges::find(unreadable, problem.field) == unreadable.end()) object.reject(problem);
  }
  return scene;
}

SceneFile read_whole(JsonDocument document, const std::filesystem::path* folder) {
  ObjectReader object = document.root();
  SceneFile file = read_scene_object(object, folder);
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

// Write the laws that are not the linear ones.
void write_table(JsonWriter& out, const Pairs& pairs) {
  out.fields("law", SpringForm::table, "pairs", pairs);
}
void write_law(JsonWriter& out, const WallLaw& wall) {
  if (wall.law == WallForm::linear) return;
  out.open_object("wall", JsonWriter::Layout::one_line);
  if (wall.law == WallForm::table)
    write_table(out, wall.pairs);
  else
    out.fields("law", wall.law, "exponent", wall.exponent);
  if (wall.speed) out.field("speed", wall.speed);
  out.close();
}
void write_law(JsonWriter& out, const SpringLaw& spring) {
  if (spring.is_linear()) return;
  out.open_object("spring", JsonWriter::Layout::one_line);
  if (spring.law == SpringForm::table)
    write_table(out, spring.pairs);
  else
    out.field("cubic", spring.cubic);
  out.close();
}

// Writes the numbers that are there; those of the dampers in an array, unless one damper's are among the
// scene's.
template <class AnyScene, class Fields, class DamperFields>
void write_numbers(JsonWriter& out, const AnyScene& scene, bool one, const Fields& fields,
                   const DamperFields& damper_fields, JsonWriter::Layout layout) {
  const auto write = [&](const auto& field, const std::optional<double>& number) {
    if (number && !field.is_absent(*number)) out.field(field.name, number);
  };
  const auto write_of = [&](const auto& damper, const auto& field) {
    if (field.name == "restitution" && !damper.restitution_by_speed.empty())
      out.field(field.name, damper.restitution_by_speed);
    else
      write(field, damper.*field.number.of_damper);
  };
  for (const auto& each : fields)
    if (each.number.own)
      write(each, each.number.in(scene));
    else if (one)
      write_of(scene.damper(), each);
  write_law(out, scene.spring);
  if (one) return write_law(out, scene.damper().wall);
  out.objects("dampers", layout, scene.dampers, [&](const auto& damper) {
    for (const auto& each : damper_fields)
      if (each.number.of_damper) write_of(damper, each);
    write_law(out, damper.wall);
  });
}

}  // namespace

void read_laws(ObjectReader& object, WallLaw& wall, Pairs& restitution, const std::filesystem::path* folder) {
  if (object.is_array("restitution") && object.optional("restitution", restitution, most_pairs) &&
      restitution.empty())
    object.reject("restitution", "must be a number or have at least 1 element, got 0");
  if (!object.has("wall")) return;
  ObjectReader its = object.required_object("wall");
  if (!its.require("law") || !its.optional("law", wall.law)) return;
  if (wall.law == WallForm::table && !read_table(its, wall.pairs, folder)) wall.law = WallForm::linear;
  if (wall.law == WallForm::power) its.required("exponent", wall.exponent);
  double speed = 1;
  if (wall.law != WallForm::linear && its.has("speed") && its.optional("speed", speed)) wall.speed = speed;
}

void read_laws(ObjectReader& object, SpringLaw& spring, const std::filesystem::path* folder) {
  if (!object.has("spring")) return;
  ObjectReader its = object.required_object("spring");
  if (!its.optional("law", spring.law)) return;
  if (spring.law == SpringForm::cubic)
    its.required("cubic", spring.cubic);
  else if (!read_table(its, spring.pairs, folder))
    spring.law = SpringForm::cubic;
}

Scene read_scene_fields(ObjectReader& object, MissingFields missing, const std::filesystem::path* folder) {
  Scene scene;
  const bool all = missing == MissingFields::are_problems;
  read_numbers(
      object, scene, scene_fields, scene_damper_fields,
      [&](ObjectReader& from, const SceneField& field, double& target, const std::string&) {
        if (all && !field.component) from.require(field.name);
        from.optional(field.name, target);
      },
      folder);
  for (const std::string_view stop : {"until_time", "until_amplitude"})
    if (all) object.require(stop);
  const bool time_is_read = object.optional("until_time", scene.until_time);
  const bool amplitude_is_read = object.optional("until_amplitude", scene.until_amplitude);
  for (const Problem& problem : problems_of(scene)) {
    // A stop that was given but could not be read is not missing as well.
    const bool given = problem.field == "until_time" && !(time_is_read && amplitude_is_read);
    if (!given && !scene.dampers.empty()) object.reject(in_file(problem, object));
  }
  return scene;
}

SceneFile read_scene_object(ObjectReader& object, const std::filesystem::path* folder) {
  SceneFile file;
  object.optional("description", file.description);
  for (const UnitField& field : unit_fields) object.suggest(field.name);
  for (const SceneField& field : scene_fields) object.suggest(field.name);
  const auto [in_units, without_units] = given_keys(object);
  if (in_units.empty()) {
    file.scene = read_scene_fields(object, MissingFields::have_defaults, folder);
    return file;
  }
  file.in_units = read_unit_fields(object, folder);
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
  const std::filesystem::path folder = file.parent_path();
  return read_whole(JsonDocument::read(file, scene_kind), &folder);
}

Scene read_scene(const std::filesystem::path& file) { return read_scene_file(file).scene; }

SceneFile parse_scene_file(const std::string& name, const std::string& text) {
  return read_whole(JsonDocument::parse(name, text), nullptr);
}

Scene parse_scene(const std::string& name, const std::string& text) {
  return parse_scene_file(name, text).scene;
}

void write_scene_numbers(JsonWriter& out, const Scene& scene) {
  write_numbers(out, scene, has_one_damper(scene), scene_fields, scene_damper_fields,
                JsonWriter::Layout::one_line);
}

void write_scene_fields(JsonWriter& out, const Scene& scene) {
  write_scene_numbers(out, scene);
  out.field("until_time", scene.until_time);
  out.field("until_amplitude", scene.until_amplitude);
}

void write_unit_fields(JsonWriter& out, const SceneInUnits& scene) {
  write_numbers(out, scene, scene.dampers.size() == 1, unit_fields, unit_fields, out.layout());
}

std::string scene_text(const Scene& scene) {
  JsonWriter out("scene");
  out.open_object(JsonWriter::Layout::one_line);
  write_scene_fields(out, scene);
  out.close();
  return out.finish();
}

}  // namespace impact_damper
