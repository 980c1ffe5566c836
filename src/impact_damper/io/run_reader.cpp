#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <optional>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/sha256.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/engines/compatibility.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

// Reads the columns of one section, and compares the length of each with that of the first.
class Columns {
 public:
  explicit Columns(ObjectReader& object) : object_(object) {}
  // For an object in the section, whose columns are as long as those of `section`.
  Columns(ObjectReader& object, const Columns& section) : object_(object), length_(section.length_) {}

  template <typename Element>
  bool read(std::string_view name, std::vector<Element>& column, NumberRange range = {}) {
    if (!object_.required(name, column, range)) return false;
    if (!length_) length_ = column.size();
    if (column.size() == *length_) return true;
    object_.reject(name, "must be as long as the section's first column, " + std::to_string(*length_) +
                             ", got a length of " + std::to_string(column.size()));
    return false;
  }

  bool read(std::string_view name, std::vector<Wall>& column) {
    std::vector<std::int64_t> numbers;
    const bool is_read = read(name, numbers, within(0, 1));
    for (const std::int64_t number : numbers) column.push_back(number == 0 ? Wall::left : Wall::right);
    return is_read;
  }

  // Reads the numbers of dampers, from 1 to `dampers`.
  bool read_damper(std::vector<std::int32_t>& column, std::size_t dampers) {
    if (dampers == 0) return true;
    std::vector<std::int64_t> numbers;
    const bool is_read = read("damper", numbers, within(1, static_cast<double>(dampers)));
    for (const std::int64_t number : numbers) column.push_back(static_cast<std::int32_t>(number - 1));
    return is_read;
  }

  bool read_times(std::string_view name, std::vector<double>& column, bool ascending = true) {
    if (!read(name, column, at_least(0))) return false;
    if (!ascending) return true;
    const auto drop = std::is_sorted_until(column.begin(), column.end());
    if (drop == column.end()) return true;
    object_.reject(
        name, static_cast<std::size_t>(drop - column.begin()),
        "must not be below the one before it, " + number_text(*(drop - 1)) + ", got " + number_text(*drop));
    return false;
  }

 private:
  ObjectReader& object_;
  std::optional<std::size_t> length_;
};

// Whether an engine may lack an option, which then keeps its default. A run file must have all of them. A
// response file has null for what follows from each of its runs. Elsewhere any may be missing. In a plan any
// that follows from the scene may also be null, as in the file beside a sweep's table.
enum class Lacking { nothing, null, any, any_or_null };

// Reads an option. False, after reporting it, unless the value is allowed, or none is there and none is
// needed.
template <class Value>
bool read_option(ObjectReader& object, const OptionInfo& option, Lacking lacking, Value& value) {
  const bool may_be_missing =
      lacking == Lacking::any || lacking == Lacking::any_or_null || !option.in_every_file;
  if (may_be_missing && !object.has(option.name)) return true;
  if constexpr (std::is_enum_v<Value>) {
    if (!object.require(option.name)) return false;
    const std::optional<std::size_t> index = object.word(option.name, words_of<Value>());
    if (index) value = all_of<Value>.begin()[*index];
    return index.has_value();
  } else if constexpr (std::is_same_v<Value, bool>) {
    return object.required(option.name, value);
  } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
    if (lacking == Lacking::any_or_null) return object.optional(option.name, value, option.range);
    if (lacking == Lacking::null && option.in_every_file)
      return object.required(option.name, value, option.range);
    double number = 0;  // null is no number
    if (!object.required(option.name, number, option.range)) return false;
    value = number;
    return true;
  } else {
    return object.required(option.name, value, option.range);
  }
}

// Reads an engine; absent if any of it is not valid.
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

// Returns the objects of a section for each damper of a scene with several.
std::vector<ObjectReader> read_dampers(ObjectReader& object, std::size_t dampers) {
  if (dampers == 0) return {};
  std::vector<ObjectReader> objects = object.required_objects("dampers", most_dampers);
  if (object.has("dampers") && objects.size() != dampers)
    object.reject("dampers", "must be as many as in the scene, " + std::to_string(dampers) + ", got " +
                                 std::to_string(objects.size()));
  return objects;
}

HalfCycles read_half_cycles(ObjectReader object, std::size_t dampers) {
  HalfCycles half_cycles;
  Columns columns(object);
  columns.read_times("zero_crossing", half_cycles.zero_crossing);
  columns.read_times("peak_time", half_cycles.peak_time);
  columns.read("amplitude", half_cycles.amplitude, at_least(0));
  columns.read("impacts", half_cycles.impacts, at_least(0));
  for (ObjectReader& damper : read_dampers(object, dampers))
    Columns(damper, columns).read("impacts", half_cycles.impacts_by_damper.emplace_back(), at_least(0));
  return half_cycles;
}

Impacts read_impacts(ObjectReader object, std::size_t dampers) {
  Impacts impacts;
  Columns columns(object);
  columns.read_times("time", impacts.time);
  columns.read("wall", impacts.wall);
  columns.read("relative_velocity", impacts.relative_velocity);
  columns.read("phase_deg", impacts.phase_deg, within(0, 180));
  columns.read("amplitude", impacts.amplitude, at_least(0));
  columns.read("displacement", impacts.displacement);
  columns.read_damper(impacts.damper, dampers);
  return impacts;
}

Contacts read_contacts(ObjectReader object, std::size_t dampers) {
  Contacts contacts;
  Columns columns(object);
  const bool ascending = dampers == 0;  // of several only those of each, which analysis/consistency checks
  const bool begun = columns.read_times("begin", contacts.begin, ascending);
  const bool ended = columns.read_times("end", contacts.end, ascending);
  columns.read("wall", contacts.wall);
  columns.read_damper(contacts.damper, dampers);
  for (std::size_t i = 0; begun && ended && i < contacts.begin.size(); ++i) {
    if (contacts.begin[i] <= contacts.end[i]) continue;
    object.reject("end", i,
                  "must not be before its begin, " + number_text(contacts.begin[i]) + ", got " +
                      number_text(contacts.end[i]));
    break;
  }
  return contacts;
}

// Checks a sum that the file states beside its parts.
void check_sum(ObjectReader& object, std::string_view name, double sum) {
  double given = 0;
  if (object.required(name, given) && given != sum) {
    object.reject(name, "must be the sum of its parts, " + number_text(sum) + ", got " + number_text(given));
  }
}

Energy read_energy(ObjectReader object) {
  Energy energy;
  bool all_read = object.required("kinetic", energy.kinetic);
  all_read = object.required("spring", energy.spring) && all_read;
  all_read = object.required("wall", energy.wall) && all_read;
  object.required("paper", energy.paper);
  if (all_read || !object.has("total")) check_sum(object, "total", energy.total());
  return energy;
}

EnergyBalance read_energy_balance(ObjectReader object, std::size_t dampers) {
  EnergyBalance balance;
  balance.initial = read_energy(object.required_object("initial"));
  balance.final = read_energy(object.required_object("final"));
  if (object.required("impact_loss", balance.impact_loss) || !object.has("impact_loss_total")) {
    check_sum(object, "impact_loss_total",
              std::accumulate(balance.impact_loss.begin(), balance.impact_loss.end(), 0.0));
  }
  object.required("contact_loss", balance.contact_loss);
  object.required("bounce_downs", balance.bounce_downs, at_least(0));
  object.required("bounce_down_loss", balance.bounce_down_loss);
  object.required("viscous_work", balance.viscous_work);
  object.required("forcing_work", balance.forcing_work);
  object.required("residual", balance.residual);
  for (ObjectReader& damper : read_dampers(object, dampers)) {
    DamperEnergy& its = balance.dampers.emplace_back();
    for (const DamperEnergyField& field : damper_energy_fields)
      damper.required(field.name, its.*field.member);
    damper.required("bounce_downs", its.bounce_downs, at_least(0));
  }
  return balance;
}

History read_history(ObjectReader object, std::size_t dampers) {
  History history;
  Columns columns(object);
  columns.read_times("time", history.time);
  columns.read("x", history.x);
  columns.read("v", history.v);
  const auto read_motion = [](Columns of, std::vector<double>& y, std::vector<double>& w) {
    of.read("y", y);
    of.read("w", w);
  };
  if (dampers == 0) read_motion(columns, history.y, history.w);
  for (ObjectReader& damper : read_dampers(object, dampers)) {
    History::Damper& its = history.dampers.emplace_back();
    read_motion({damper, columns}, its.y, its.w);
  }
  return history;
}

// Reports what the engine would reject of the scene: no run of it can exist.
void check_together(ObjectReader& scene, ObjectReader& engine, const Run& run) {
  if (!problems_of(run.scene, DamperList::allowed).empty()) return;
  for (const Problem& problem : incompatibilities_of(run.scene, run.engine)) {
    const bool of_scene =
        problem.field.starts_with("dampers") ||
        std::ranges::find(scene_fields, problem.field, &SceneField::name) != scene_fields.end();
    (of_scene ? scene : engine).reject(problem);
  }
}

Run read_whole(JsonDocument document, bool sealed, DamperList list) {
  Run run;
  ObjectReader object = document.root();
  if (object.require("schema")) object.word("schema", {run_schema});
  ObjectReader scene = object.required_object("scene"), engine = object.required_object("engine");
  run.scene = read_scene_fields(scene, list, MissingFields::are_problems);
  if (scene.holds("dampers") && run.scene.dampers.empty()) {
    for (ObjectReader* each : {&object, &engine}) each->keys();  // the columns would be of unknown dampers
    document.finish();
  }
  const std::size_t dampers = run.scene.dampers.size();
  if (const std::optional<Engine> whole = read_engine(engine, Lacking::nothing)) {
    run.engine = *whole;
    check_together(scene, engine, run);
  }
  object.required("stop_reason", run.stop_reason);
  object.required("end_time", run.end_time, at_least(0));
  check_units(object);
  if (const auto section = object.optional_object("half_cycles"))
    run.half_cycles = read_half_cycles(*section, dampers);
  if (const auto section = object.optional_object("impacts")) run.impacts = read_impacts(*section, dampers);
  if (const auto section = object.optional_object("contacts"))
    run.contacts = read_contacts(*section, dampers);
  if (const auto section = object.optional_object("energy"))
    run.energy = read_energy_balance(*section, dampers);
  if (const auto section = object.optional_object("history")) run.history = read_history(*section, dampers);
  if (run.impacts && run.energy && run.impacts->time.size() != run.energy->impact_loss.size()) {
    object.reject("energy", "must hold a loss for each of the " + std::to_string(run.impacts->time.size()) +
                                " impacts, got " + std::to_string(run.energy->impact_loss.size()));
  }
  finish_sealed(document, object, sealed);
  return run;
}

}  // namespace

Run read_run(const std::filesystem::path& file, DamperList dampers) {
  std::string text = read_text(file, run_kind);
  const bool sealed = is_sealed(text);
  JsonDocument document = JsonDocument::parse(file.string(), text);
  std::string().swap(text);  // its memory is as large as that of the columns
  return read_whole(std::move(document), sealed, dampers);
}

Run parse_run(const std::string& name, const std::string& text, DamperList dampers) {
  return read_whole(JsonDocument::parse(name, text), is_sealed(text), dampers);
}

std::optional<Engine> read_engine_of_response(ObjectReader& engine) {
  return read_engine(engine, Lacking::null);
}
std::optional<Engine> read_engine_of_plan(ObjectReader& engine) {
  return read_engine(engine, Lacking::any_or_null);
}

void check_units(ObjectReader& root) {
  std::optional<ObjectReader> section = root.optional_object("units");
  if (!section) return;
  ObjectReader& object = *section;
  SiUnits units{};
  bool all_read = true;
  for (const SiUnit& unit : si_units)
    all_read = object.required(unit.name, units.*unit.member, above(0)) && all_read;
  if (!all_read) return;
  const auto must_be = [&](std::string_view name, double given, double wanted, std::string_view what) {
    constexpr double rounding = 1e-12;  // some thousand roundings of what a few operations make of the scales
    if (std::abs(given - wanted) <= rounding * std::abs(wanted)) return;
    object.reject(
        name, "must be " + std::string(what) + ", " + number_text(wanted) + ", got " + number_text(given));
  };
  must_be("velocity_m_per_s", units.velocity, units.length / units.time, "length_m divided by time_s");
  must_be("energy_J", units.energy, units.mass * units.velocity * units.velocity,
          "mass_kg times velocity_m_per_s squared");
  must_be("force_N", units.force, units.energy / units.length, "energy_J divided by length_m");
}

bool is_sealed(std::string_view text) {
  constexpr std::size_t digits = 64, length = seal_begin.size() + digits + seal_end.size();
  if (text.size() < length) return false;
  const std::string_view seal = text.substr(text.size() - length),
                         digest = seal.substr(seal_begin.size(), digits);
  return seal.starts_with(seal_begin) && seal.ends_with(seal_end) &&
         digest == sha256(text.substr(0, text.size() - length));
}

void finish_sealed(JsonDocument& document, ObjectReader& root, bool sealed) {
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

std::optional<Engine> read_engine(ObjectReader& object) { return read_engine(object, Lacking::any); }

Engine parse_engine(const std::string& name, const std::string& text) {
  JsonDocument document = JsonDocument::parse(name, text);
  ObjectReader object = document.root();
  const std::optional<Engine> engine = read_engine(object);
  document.finish();  // throws if anything is not valid
  return engine.value_or(Engine{});
}

}  // namespace impact_damper
