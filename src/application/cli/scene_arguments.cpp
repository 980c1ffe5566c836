#include <algorithm>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>

#include "commands.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper::cli {
namespace {

std::string option_of(std::string_view field) {
  std::string name(field);
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

std::string range_of(const SceneField& field) {
  if (field.least < 0) return "0, or a number of a magnitude >= " + number_text(least_magnitude);
  // Limits that only keep squares finite are not shown.
  const double any = std::numeric_limits<double>::max();
  return NumberRange{field.least, field.most >= 1e6 ? any : field.most}.describe("a number");
}

// An option of the command line, for all the engines that have it.
struct OfferedOption {
  OptionInfo info;
  std::string type;  // of its value; "" for a flag
  std::vector<std::string_view> engines;
  std::vector<std::string> defaults;  // of each of them
};

template <class Value>
std::string type_of(const OptionInfo& option) {
  if constexpr (std::is_enum_v<Value>)
    return joined(words_of<Value>(), "|");
  else
    return std::string(option.symbol);
}

std::vector<std::string_view> names_of(const std::vector<Engine>& engines) {
  return texts_of(engines, [](const Engine& engine) { return name_of(engine); });
}

// Returns the options of these engines, first those that only some of them have.
std::vector<OfferedOption> offered_options(const std::vector<Engine>& engines) {
  std::vector<OfferedOption> offered;
  for (const Engine& engine : engines) {
    for_each_option(engine, [&](const OptionInfo& option, const auto& value) {
      const auto is_it = [&](const OfferedOption& each) { return each.info.name == option.name; };
      auto found = std::ranges::find_if(offered, is_it);
      if (found == offered.end()) {
        using Value = std::remove_cvref_t<decltype(value)>;
        found = offered.insert(found, {option, type_of<Value>(option), {}, {}});
      }
      found->engines.push_back(name_of(engine));
      found->defaults.push_back(option.otherwise.empty() ? option_text(value)
                                                         : std::string(option.otherwise));
    });
  }
  const auto of_some = [&](const OfferedOption& each) { return each.engines.size() < engines.size(); };
  std::stable_partition(offered.begin(), offered.end(), of_some);
  // Adds "stuck", which chooses a speed without a number: the only option that is no member of an engine.
  const auto speed =
      std::ranges::find_if(offered, [](const auto& each) { return each.info.name == "stuck_speed"; });
  if (speed == offered.end()) return offered;
  speed->defaults = {number_text(usual_stuck_speed)};
  offered.insert(
      speed,
      {{.name = "stuck",
        .meaning = "a mass that sticks is in a sustained contact (contact), or both masses are one as in the "
                   "paper, by equation (9) with the force divided by 1 + nu, until x'' changes its sign"},
       "contact|paper",
       speed->engines,
       {"contact"}});
  return offered;
}

// Rejects the options that the engine does not have, because it would ignore them.
void reject_foreign_options(Arguments& arguments, const std::vector<Engine>& engines,
                            std::string_view engine) {
  for (const OfferedOption& offered : offered_options(engines)) {
    const std::string option = option_of(offered.info.name);
    if (arguments.given(option) && std::ranges::count(offered.engines, engine) == 0)
      arguments.reject(option, filled("is an option of --engine {}, got --engine {}",
                                      listed(offered.engines, "or"), engine));
  }
}

template <class Value>
void read_option(Arguments& arguments, const OptionInfo& info, Value& value) {
  const std::string option = option_of(info.name);
  if constexpr (std::is_enum_v<Value>) {
    value = arguments.choice(option, all_of<Value>, value);
  } else if constexpr (std::is_same_v<Value, bool>) {
    value = arguments.flag(option);
  } else {
    arguments.read(option, value, info.range);
  }
}

void read_sticking(Arguments& arguments, Cem& cem) {
  const bool as_in_paper = arguments.word("--stuck", {"contact", "paper"}) == std::size_t{1};
  if (arguments.given("--stuck-speed") && !as_in_paper)
    arguments.reject("--stuck-speed", "is an option of --stuck paper");
  if (as_in_paper && !cem.stuck_speed) cem.stuck_speed = usual_stuck_speed;
}

// Returns `text` in lines of at most `most` characters.
std::string in_lines(const std::string& text, std::size_t most) {
  std::istringstream words(text);
  std::string lines, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + 1 + word.size() > most) {
      lines += line + '\n';
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + line;
}

// Returns the help of an option: its meaning, what is allowed and the default.
std::string help_of(const OfferedOption& offered, std::size_t engines) {
  const OptionInfo& info = offered.info;
  std::string text = offered.engines.size() < engines ? listed(offered.engines, "and") + ": " : "";
  text += info.meaning;
  if (offered.type.empty()) return text;
  if (!info.symbol.empty())
    text += "; " + info.range.describe(info.symbol == "N" ? "a whole number" : "a number");
  if (!info.further.empty()) text += ", " + std::string(info.further);
  text += (info.symbol.empty() ? "; default " : ", default ") + offered.defaults[0];
  for (std::size_t i = 1; i < offered.engines.size(); ++i)
    if (offered.defaults[i] != offered.defaults[0])
      text += ", with " + std::string(offered.engines[i]) + " " + offered.defaults[i];
  return text;
}

constexpr std::array<std::string_view, 2> stops_of_scene{"until_time", "until_amplitude"};
bool is_stop(std::string_view key) { return key.starts_with("until_"); }

// A key of a scene as an option: of a scene in units, of a dimensionless one, or of both.
struct SceneKey {
  std::string_view name;
  const UnitField* in_units = nullptr;        // it, or what is made of it
  const SceneField* dimensionless = nullptr;  // absent: a stop, or only of a scene in units
};

// Returns the keys that are options, first those of scenes in units.
std::vector<SceneKey> scene_keys(Stops stops, const Keys& own) {
  std::vector<SceneKey> keys;
  const auto named = [](const auto& fields, std::string_view name) {
    const auto found = std::ranges::find_if(fields, [&](const auto& each) { return each.name == name; });
    return found == fields.end() ? nullptr : &*found;
  };
  const auto add = [&](std::string_view name) {
    if ((stops == Stops::ignored && is_stop(name)) || std::ranges::count(own, name) > 0) return;
    const UnitField* made = named(unit_fields, name);
    if (!made) made = &*std::ranges::find(unit_fields, name, &UnitField::becomes);
    keys.push_back({name, made, named(scene_fields, name)});
  };
  for (const UnitField& field : unit_fields) add(field.name);
  for (const SceneField& field : scene_fields)
    if (!named(unit_fields, field.name)) add(field.name);
  for (const std::string_view stop : stops_of_scene) add(stop);
  return keys;
}

// Returns the number of an option beside a scene in units, in the unit of `key.in_units`.
std::optional<double> number_in_units(Arguments& arguments, const SceneKey& key, const SceneInUnits& scene) {
  const std::string option = option_of(key.name);
  const UnitField& field = *key.in_units;
  const Scales scales = scales_of(scene);
  const bool is_its_own = key.name == field.name;
  if (key.dimensionless && key.dimensionless->component && !is_its_own) {
    const auto value = arguments.number(option);
    if (value && *value != 0)
      arguments.reject(
          option, filled("is of a dimensionless scene: beside one in units give {}", option_of(field.name)));
    return value;
  }
  const bool is_ratio = key.dimensionless && key.dimensionless->dimension == Dimension::ratio && !is_its_own;
  if (!is_ratio) return arguments.quantity(option, {.dimension = field.dimension, .scales = scales});
  const auto ratio = arguments.number(option);  // of the masses, or of a wall's and the spring's stiffness
  return ratio ? std::optional(*ratio * scales.of(field.dimension)) : std::nullopt;
}

// Changes the scene in units of `file` by the options beside it.
void override_in_units(Arguments& arguments, SceneFile& file, const std::string& name,
                       const std::vector<SceneKey>& keys) {
  SceneInUnits& scene = *file.in_units;
  std::map<std::string_view, std::string> given;  // the option that sets a number
  std::vector<std::pair<NumberInUnits, double>> numbers;
  bool all_read = true;
  for (const SceneKey& key : keys) {
    const std::string option = option_of(key.name);
    if (!arguments.given(option)) continue;
    const auto value = number_in_units(arguments, key, scene);
    const auto [before, is_first] = given.try_emplace(key.in_units->name, option);
    const NumberInUnits& number = key.in_units->number;
    all_read = all_read && value;
    if (!is_first)
      arguments.reject(option, filled("either it or {} must be given, got both", before->second));
    else if (number.of_damper && scene.dampers.size() > 1)
      arguments.reject(option, "is for one damper: " + name + " has a list, which sets their numbers");
    else if (number.of_damper && is_replaced(scene.damper(), key.in_units->name))
      arguments.reject(option, "has no effect: " + name + " has a table in place of it");
    else if (value) {
      numbers.emplace_back(number, *value);
      set_number(scene, number, *value);
    }
  }
  if (given.empty() || !all_read) return;
  for (const auto& [number, value] : numbers)
    number.in(scene) = value;  // where two stand for each other, both
  for (const Problem& problem : problems_of(scene)) {
    const auto its = given.find(problem.field);
    arguments.reject(its == given.end() ? "--scene" : its->second,
                     (its == given.end() ? problem.field + " " : "") + problem.message);
  }
  if (!problems_of(scene).empty()) return;
  file.scene = dimensionless(scene);
  file.scales = scales_of(scene);
}

}  // namespace

SceneFile scene_of(Arguments& arguments, Stops stops, const Keys& own) {
  const std::optional<std::string> name = arguments.file("--scene");
  SceneFile file = name ? read_scene_file(*name) : SceneFile{};
  const std::vector<SceneKey> keys = scene_keys(stops, own);
  Scene& scene = file.scene;
  if (file.in_units) {
    override_in_units(arguments, file, *name, keys);
    if (stops == Stops::ignored) scene.until_time = 1, scene.until_amplitude.reset();  // a scene needs one
    return file;
  }
  bool all_read = true;
  const auto override_with = [&](std::string_view field, auto& target) {
    const std::optional<double> value = arguments.number(option_of(field));
    if (value) target = *value;
    if (!value && arguments.given(option_of(field))) all_read = false;
  };
  for (const SceneKey& key : keys) {
    const std::string option = option_of(key.name);
    if (key.dimensionless) {
      const SceneNumber& number = key.dimensionless->number;
      override_with(key.name, number.in(scene));
      if (number.of_damper && !has_one_damper(scene) && arguments.given(option))
        arguments.reject(option, "is for one damper: " + *name + " has a list, which sets their numbers");
      else if (number.of_damper && is_replaced(scene.damper(), key.name) && arguments.given(option))
        arguments.reject(option, "has no effect: " + *name + " has a table in place of it");
    } else if (arguments.given(option) && std::ranges::count(stops_of_scene, key.name) == 0) {
      arguments.reject(option, filled("is of a scene in units: needs one, by --scene{}",
                                      key.in_units->becomes.empty() || key.name == "clearance"
                                          ? ""
                                          : "; dimensionless " + option_of(key.in_units->becomes)));
    }
  }
  if (stops == Stops::ignored) {
    scene.until_time = 1;  // a scene needs one
    scene.until_amplitude.reset();
  } else {
    override_with("until_time", scene.until_time);
    override_with("until_amplitude", scene.until_amplitude);
  }
  if (!scene.until_time && !scene.until_amplitude) {
    if (all_read)
      arguments.reject("--until-time",
                       "it, --until-amplitude or both must be given: when is the run to stop?");
    return file;
  }
  for (const Problem& problem : problems_of(scene))
    arguments.reject(option_of(problem.field), problem.message);
  return file;
}

std::string scene_name_of(const Arguments& arguments) { return arguments.text("--scene").value_or(""); }

void require_one_damper(const Scene& scene, const std::string& scene_file) {
  if (!has_one_damper(scene)) throw InputError(scene_file, {{"/dampers", problem_of_several().message}});
}

void require_one_linear_damper(const Scene& scene, const std::string& scene_file) {
  require_one_damper(scene, scene_file);
  if (has_laws(scene))
    throw InputError(
        scene_file,
        {{"",
          "walls, springs and restitutions with laws of their own are not for this command, which "
          "does not take them into account: leave them out, or use run with --engine cem or "
          "restitution"}});
}

Engine engine_of(Arguments& arguments, const std::vector<Engine>& engines) {
  const std::optional<std::size_t> chosen = arguments.word("--engine", names_of(engines));
  if (!chosen && arguments.given("--engine")) return {};  // rejected; which options belong to it is unknown
  Engine engine = engines[chosen.value_or(0)];
  reject_foreign_options(arguments, engines, name_of(engine));
  for_each_option(engine,
                  [&](const OptionInfo& option, auto& value) { read_option(arguments, option, value); });
  if (Cem* const cem = std::get_if<Cem>(&engine)) read_sticking(arguments, *cem);
  return engine;
}

bool in_si(Arguments& arguments, Format format, const SceneFile& scene, const std::string& what) {
  const bool asked = arguments.flag("--si");
  if (asked && format != Format::csv)
    arguments.reject(
        "--si", filled("is for --format csv; {} is dimensionless, its units say what a unit is in SI", what));
  if (asked && !scene.scales) arguments.reject("--si", "needs a scene in units, by --scene");
  return asked;
}

void warn(const std::string& command, const std::string& text) {
  std::cerr << command + ": warning: " + text + '\n';
}

void warn_of_cautions(const std::string& command, const Scene& scene, const std::optional<Scales>& scales) {
  for (const std::string& caution : cautions_of(scene, scales)) warn(command, caution);
}

void warn_of_early_end(const std::string& command, const Run& run, const std::optional<Scales>& scales) {
  const auto warn_of = [&](const std::string& budget, const std::string& option) {
    const std::string seconds =
        scales ? filled(" ({} s)", rounded_text(run.end_time * scales->of(Dimension::time), 6)) : "";
    warn(command, filled("the run ended early, at time {}{}: it had used up its {}; {} raises that",
                         rounded_text(run.end_time, 6), seconds, budget, option));
  };
  const Budget& budget =
      std::visit([](const auto& engine) -> const Budget& { return engine.budget; }, run.engine);
  switch (run.stop_reason) {
    case StopReason::time:
    case StopReason::amplitude:
      return;
    case StopReason::impact_budget:
      return warn_of(filled("budget of {} impacts", budget.max_impacts), "--max-impacts");
    case StopReason::half_cycle_budget:
      return warn_of(filled("budget of {} half cycles", budget.max_half_cycles), "--max-half-cycles");
    case StopReason::time_budget:
      return warn_of("budget of time, " + rounded_text(*budget.max_time, 6), "--max-time");
    case StopReason::step_budget:
      break;
  }
  const std::int64_t steps = std::visit([](const auto& engine) { return engine.max_steps; }, run.engine);
  warn_of(filled("budget of {} {}", steps,
                 std::holds_alternative<Cem>(run.engine)
                     ? "time steps"
                     : "steps of the searches for events and of the integrals of energy"),
          "--max-steps");
}

void reject_as_options(std::vector<Problem> problems, const std::string& scene_file,
                       const std::optional<Scales>& scales) {
  for (Problem& problem : problems)
    if (scales && problem.field.ends_with("y0"))
      problem.message += " (secondary_displacement, divided by " + rounded_text(scales->length, 6) + " mm)";
  const auto in_list = [](const Problem& problem) { return problem.field.starts_with("dampers"); };
  if (std::ranges::any_of(problems, in_list)) {
    std::erase_if(problems, std::not_fn(in_list));
    for (Problem& problem : problems) problem.field = pointer_of(problem.field);
    throw InputError(scene_file, problems);
  }
  for (Problem& problem : problems) {
    if (problem.field == "wall" || problem.field == "spring")  // of the scene's file alone
      problem = {"scene", problem.field + " " + problem.message};
    problem.field = option_of(problem.field);
  }
  throw UsageError(std::move(problems));
}

void reject_as_options(const std::vector<Problem>& problems,
                       std::initializer_list<std::pair<std::string_view, std::string_view>> options) {
  std::vector<Problem> named;
  for (const auto& [field, message] : problems) {
    const auto* const found = std::ranges::find(options, std::string_view(field),
                                                &std::pair<std::string_view, std::string_view>::first);
    if (found != options.end())
      named.push_back({std::string(found->second), message});
    else
      named.push_back({"--scene", field == "scene" ? message : filled("{} {}", field, message)});
  }
  throw UsageError(std::move(named));
}

Option threads_option() {
  return {"--threads", "N",
          "how many simulate at once; default one for each processor, same results with any"};
}

Option scenes_option() {
  return input_option("--scenes", "FOLDER",
                      "folder of the scenes that runs are named after; default data/scenes");
}

std::string scenes_folder(Arguments& arguments) {
  return arguments.file("--scenes").value_or(project_file("data/scenes"));
}

Options scene_options(Stops stops, const Keys& own) {
  Options options{input_option("--scene", "FILE",
                               "read the scene from a JSON file, dimensionless or in kg, N/m and\nmm; the "
                               "options below replace its numbers. Beside a scene in units its\nkeys are "
                               "options, too, and numbers have a unit: --clearance 12mm")};
  const Scene defaults;
  for (const SceneField& field : scene_fields)
    options.push_back(
        {option_of(field.name), "X",
         filled("{};\n{}, default {}", field.meaning, range_of(field), field.number.in(defaults))});
  if (stops == Stops::needed) {
    options.push_back({"--until-time", "T", "stop at this time; a number > 0"});
    options.push_back({"--until-amplitude", "A",
                       "stop at the end of the first half cycle below this amplitude;\na number > 0. One of "
                       "the two stops, or both, must be given"});
  }
  for (const SceneKey& key : scene_keys(stops, own)) {
    if (key.name != key.in_units->name || key.dimensionless) continue;
    std::string type = "X" + std::string(unit_of(key.in_units->dimension, true));
    std::erase(type, ' ');
    options.push_back({.name = option_of(key.name),
                       .type = type,
                       .help = filled("beside a scene in units: {}", key.in_units->meaning),
                       .in_help = false});
  }
  return in_group("Scene", std::move(options));
}

Options engine_options(const std::vector<Engine>& engines) {
  std::vector<std::string> meanings;
  meanings.reserve(engines.size());
  for (const Engine& each : engines)
    meanings.push_back(filled("{}{}: {}", name_of(each), meanings.empty() ? " (default)" : "",
                              std::visit([](const auto& chosen) { return chosen.meaning; }, each)));
  Options options{{"--engine", joined(names_of(engines), "|"), joined(meanings, ";\n")}};
  constexpr std::size_t width = 66;
  for (const OfferedOption& each : offered_options(engines))
    options.push_back({option_of(each.info.name), each.type, in_lines(help_of(each, engines.size()), width),
                       each.type.empty() ? Option::Takes::nothing : Option::Takes::value});
  return in_group("Engine", std::move(options));
}

}  // namespace impact_damper::cli
