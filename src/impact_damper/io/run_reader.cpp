#include <algorithm>
#include <cmath>
#include <concepts>
#include <initializer_list>
#include <optional>
#include <utility>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/sha256.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/run_columns.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

// Reads what the table of columns has of one section: one overload for each kind of value. Each returns
// whether the value is valid; the problems have been reported.
class SectionReader {
 public:
  // length: of the columns, if it is known.
  SectionReader(ObjectReader object, const RunShape& shape, std::optional<std::size_t> length = {})
      : object_(std::move(object)), shape_(shape), length_(length) {}

  template <class Section>
  void read(Section& section) {
    for_each_column(section, shape_, [&](const RunColumnInfo& info, auto&& value) {
      if (!read_value(info, std::forward<decltype(value)>(value))) invalid_.push_back(info.name);
    });
  }
  // Checks that no contact ends before it begins.
  void check_ends(const Contacts& contacts) {
    const auto is_invalid = [&](std::string_view name) { return std::ranges::count(invalid_, name) > 0; };
    if (is_invalid("begin") || is_invalid("end")) return;
    for (std::size_t i = 0; i < contacts.begin.size(); ++i) {
      if (contacts.begin[i] <= contacts.end[i]) continue;
      object_.reject("end", i,
                     "must not be before its begin, " + number_text(contacts.begin[i]) + ", got " +
                         number_text(contacts.end[i]));
      break;
    }
  }

 private:
  template <class Number>
  bool read_value(const RunColumnInfo& info, Number& number) {
    return object_.required(info.name, number, info.range);
  }
  // Compares a sum of what was read with the one in the file.
  bool read_value(const RunColumnInfo& info, double&& sum) {
    double given = 0;
    if (!invalid_.empty() && object_.has(info.name)) return false;
    if (!object_.required(info.name, given)) return false;
    if (given == sum) return true;
    object_.reject(info.name,
                   "must be the sum of its parts, " + number_text(sum) + ", got " + number_text(given));
    return false;
  }
  template <HasRunColumns Part>
  bool read_value(const RunColumnInfo& info, Part& part) {
    SectionReader(object_.required_object(info.name), shape_).read(part);
    return true;
  }
  template <HasRunColumns Part>
  bool read_value(const RunColumnInfo& info, std::vector<Part>& parts) {
    std::vector<ObjectReader> objects = object_.required_objects(info.name, most_dampers);
    if (object_.has(info.name) && objects.size() != shape_.listed)
      object_.reject(info.name, "must be as many as in the scene, " + std::to_string(shape_.listed) +
                                    ", got " + std::to_string(objects.size()));
    parts.resize(objects.size());
    for (std::size_t i = 0; i < parts.size(); ++i) SectionReader(objects[i], shape_, length_).read(parts[i]);
    return true;
  }
  template <class Element>
  bool read_value(const RunColumnInfo& info, std::vector<Element>& column) {
    if (!object_.required(info.name, column, info.range)) return false;
    if (!length_) length_ = column.size();
    if (column.size() != *length_) {
      object_.reject(info.name, "must be as long as the section's first column, " + std::to_string(*length_) +
                                    ", got a length of " + std::to_string(column.size()));
      return false;
    }
    if constexpr (std::same_as<Element, double>) {
      const bool ascends = info.order == Order::ascending ||
                           (info.order == Order::ascending_for_each_damper && shape_.listed == 0);
      if (!ascends) return true;
      const auto drop = std::is_sorted_until(column.begin(), column.end());
      if (drop == column.end()) return true;
      object_.reject(
          info.name, static_cast<std::size_t>(drop - column.begin()),
          "must not be below the one before it, " + number_text(*(drop - 1)) + ", got " + number_text(*drop));
      return false;
    }
    return true;
  }
  template <NumberedInFiles Element>
  bool read_value(const RunColumnInfo& info, std::vector<Element>& column) {
    RunColumnInfo of_scene = info;
    if (std::same_as<Element, std::int32_t>) of_scene.range.most = static_cast<double>(shape_.listed);
    std::vector<std::int64_t> numbers;
    const bool is_valid = read_value(of_scene, numbers);
    for (const std::int64_t number : numbers)
      column.push_back(static_cast<Element>(number - in_file(Element{})));
    return is_valid;
  }

  ObjectReader object_;
  RunShape shape_;
  std::optional<std::size_t> length_;
  std::vector<std::string_view> invalid_;
};

// Reads an option. False, after reporting it, unless the value is allowed, or none is there and none is
// needed.
template <class Value>
bool read_option(ObjectReader& object, const OptionInfo& option, Lacking lacking, Value& value) {
  const bool may_be_missing =
      lacking == Lacking::any || lacking == Lacking::any_or_null || !option.in_every_file;
  if (may_be_missing && !object.has(option.name)) return true;
  if constexpr (std::is_enum_v<Value>) {
    return object.required(option.name, value, all_of<Value>);
  } else {
    if constexpr (std::is_same_v<Value, std::optional<double>>) {
      const bool may_be_null =
          lacking == Lacking::any_or_null || (lacking == Lacking::null && option.in_every_file);
      if (!may_be_null) {
        double number = 0;
        if (!object.required(option.name, number, option.range)) return false;
        value = number;
        return true;
      }
    }
    return object.required(option.name, value, option.range);
  }
}

// Reads a section, if it is there.
template <class Section>
void read_section(ObjectReader& object, std::string_view name, const RunShape& shape,
                  std::optional<Section>& section) {
  const std::optional<ObjectReader> part = object.optional_object(name);
  if (!part) return;
  SectionReader reader(*part, shape);
  Section& its = section.emplace();
  reader.read(its);
  if constexpr (std::same_as<Section, HalfCycles>)
    if (shape.listed == 0) its.dampers = {{its.impacts}};
  if constexpr (std::same_as<Section, Impacts>)
    if (shape.listed == 0) its.damper.assign(its.time.size(), 0);
  if constexpr (std::same_as<Section, Contacts>) {
    if (shape.listed == 0) its.damper.assign(its.begin.size(), 0);
    reader.check_ends(its);
  }
}

// Reports what the engine would reject of the scene: no run of it can exist.
void check_together(ObjectReader& scene, ObjectReader& engine, const Run& run) {
  if (!problems_of(run.scene).empty()) return;
  for (const Problem& problem : incompatibilities_of(run.scene, run.engine)) {
    const bool of_scene =
        problem.field.starts_with("dampers") || problem.field == "wall" || problem.field == "spring" ||
        std::ranges::find(scene_fields, problem.field, &SceneField::name) != scene_fields.end();
    (of_scene ? scene : engine).reject(problem);
  }
}

bool is_sealed(std::string_view text) {
  constexpr std::size_t digits = 64, length = seal_begin.size() + digits + seal_end.size();
  if (text.size() < length) return false;
  const std::string_view seal = text.substr(text.size() - length),
                         digest = seal.substr(seal_begin.size(), digits);
  return seal.starts_with(seal_begin) && seal.ends_with(seal_end) &&
         digest == sha256(text.substr(0, text.size() - length));
}

Run read_whole(SealedDocument file) {
  Run run;
  ObjectReader object = file.root();
  if (object.require("schema")) object.word("schema", {run_schema});
  ObjectReader scene = object.required_object("scene"), engine = object.required_object("engine");
  run.scene = read_scene_fields(scene, MissingFields::are_problems);
  if (run.scene.dampers.empty()) {
    for (ObjectReader* each : {&object, &engine}) each->keys();  // the columns would be of unknown dampers
    file.document.finish();
  }
  // Files of earlier versions list one damper as they list several.
  const RunShape shape{scene.holds("dampers") ? run.scene.dampers.size() : 0, has_components(run.scene)};
  if (const std::optional<Engine> whole = read_engine(engine, Lacking::nothing)) {
    run.engine = *whole;
    check_together(scene, engine, run);
  }
  object.required("stop_reason", run.stop_reason);
  object.required("end_time", run.end_time, at_least(0));
  check_units(object);
  for_each_column(run, shape, [&](const RunColumnInfo& info, auto& section) {
    read_section(object, info.name, shape, section);
  });
  if (run.impacts && run.energy && run.impacts->time.size() != run.energy->impact_loss.size()) {
    object.reject("energy", "must hold a loss for each of the " + std::to_string(run.impacts->time.size()) +
                                " impacts, got " + std::to_string(run.energy->impact_loss.size()));
  }
  file.finish(object);
  return run;
}

}  // namespace

Run read_run(const std::filesystem::path& file) { return read_whole(SealedDocument::read(file, run_kind)); }

Run parse_run(const std::string& name, const std::string& text) {
  return read_whole(SealedDocument::parse(name, text));
}

std::optional<Engine> read_engine(ObjectReader& object, Lacking lacking) {
  if (!object.require("name")) return std::nullopt;
  const std::optional<std::size_t> name = object.word("name", engine_names());
  if (!name) {
    object.keys();  // which of them are known depends on the name
    return std::nullopt;
  }
  Engine engine = default_engines()[*name];
  bool all_read = true;
  for_each_option(engine, [&](const OptionInfo& option, auto& value) {
    all_read = read_option(object, option, lacking, value) && all_read;
  });
  if (!all_read) return std::nullopt;
  return engine;
}

void check_units(ObjectReader& root) {
  std::optional<ObjectReader> section = root.optional_object("units");
  if (!section) return;
  ObjectReader& object = *section;
  std::array<double, dimensions_in_files.size()> units{};
  bool all_read = true;
  for (std::size_t i = 0; i < units.size(); ++i)
    all_read = object.required(key_of(dimensions_in_files[i]), units[i], above(0)) && all_read;
  if (!all_read) return;
  const auto must_be = [&](std::string_view name, double given, double wanted, std::string_view what) {
    constexpr double rounding = 1e-12;  // some thousand roundings of what a few operations make of the scales
    if (std::abs(given - wanted) <= rounding * std::abs(wanted)) return;
    object.reject(
        name, "must be " + std::string(what) + ", " + number_text(wanted) + ", got " + number_text(given));
  };
  const auto [length, time, velocity, mass, force, energy] = units;
  must_be("velocity_m_per_s", velocity, length / time, "length_m divided by time_s");
  must_be("energy_J", energy, mass * velocity * velocity, "mass_kg times velocity_m_per_s squared");
  must_be("force_N", force, energy / length, "energy_J divided by length_m");
}

SealedDocument SealedDocument::read(const std::filesystem::path& file, const FileKind& kind) {
  std::string text = read_text(file, kind);
  const bool sealed = is_sealed(text);
  JsonDocument document = JsonDocument::parse(file.string(), text);
  std::string().swap(text);  // its memory is as large as that of the columns
  return {std::move(document), sealed};
}

SealedDocument SealedDocument::parse(const std::string& name, const std::string& text) {
  return {JsonDocument::parse(name, text), is_sealed(text)};
}

void SealedDocument::finish(ObjectReader& root) const {
  ObjectReader made_by = root.required_object("provenance");  // about the maker of the file, not its content
  for (const std::string& key : made_by.keys()) {
    std::string any;
    made_by.optional(key, any);
  }
  made_by.require("sha256");
  document.finish();
  if (!sealed) {  // adds nothing to other problems
    made_by.reject(
        "sha256",
        "must be the digest of the content, got another one: the file was altered or laid out anew "
        "since it was written; make it again");
    document.finish();
  }
}

Engine parse_engine(const std::string& name, const std::string& text) {
  JsonDocument document = JsonDocument::parse(name, text);
  ObjectReader object = document.root();
  const std::optional<Engine> engine = read_engine(object);
  document.finish();  // throws if anything is not valid
  return engine.value_or(Engine{});
}

}  // namespace impact_damper
