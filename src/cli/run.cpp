// `run`: one scene through one engine into one run file.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>
#include <sstream>

#include "arguments.hpp"
#include "commands.hpp"
#include "impact_damper/files/file_output.hpp"
#include "impact_damper/files/number_text.hpp"
#include "impact_damper/files/run_file.hpp"
#include "impact_damper/files/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "interruption.hpp"

namespace impact_damper::cli {
namespace {

std::string option_of(std::string_view field) {
  std::string name(field);
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

NumberRange range_of(const SceneField& field) {
  const double any = std::numeric_limits<double>::max();
  // The limits that only keep squares finite are no news to anybody until they are passed.
  return {field.least <= -1e12 ? -any : field.least, field.most >= 1e6 ? any : field.most,
          field.least_is_admitted};
}

Scene scene_of(Arguments& arguments) {
  const std::optional<std::string> file = arguments.file("--scene");
  Scene scene = file ? read_scene(*file) : Scene{};
  bool all_read = true;
  const auto override_with = [&](std::string_view field, auto& target) {
    const std::optional<double> value = arguments.number(option_of(field));
    if (value) target = *value;
    if (!value && arguments.given(option_of(field))) all_read = false;
  };
  for (const SceneField& field : scene_fields) override_with(field.name, scene.*field.member);
  override_with("until_time", scene.until_time);
  override_with("until_amplitude", scene.until_amplitude);
  if (!scene.until_time && !scene.until_amplitude) {
    if (all_read)
      arguments.refuse("--until-time",
                       "it, --until-amplitude or both must be given: when is the run to stop?");
    return scene;
  }
  for (const Problem& problem : problems_of(scene))
    arguments.refuse(option_of(problem.field), problem.message);
  return scene;
}

Budget budget_of(Arguments& arguments) {
  Budget budget;
  if (const auto most = arguments.whole_number("--max-impacts", at_least(0))) budget.max_impacts = *most;
  if (const auto most = arguments.whole_number("--max-half-cycles", at_least(1)))
    budget.max_half_cycles = *most;
  if (const auto most = arguments.number("--max-time", NumberRange{0, 1e12, false})) budget.max_time = *most;
  return budget;
}

// Options that only some engines have; with another they would be ignored, so they are refused.
void refuse_foreign_options(Arguments& arguments, std::string_view engine) {
  struct Own {
    const char* option;
    std::vector<std::string_view> engines;
  };
  const std::vector<Own> owns{
      {"--time-step", {Cem::name}},
      {"--damper", {Cem::name}},
      {"--locate", {Cem::name}},
      {"--large-step", {Cem::name}},
      {"--unstable", {Cem::name}},
      {"--max-steps", {Cem::name}},
      {"--calibration", {Exact::name, Cem::name}},
      {"--accumulation-tolerance", {Restitution::name}},
  };
  for (const Own& own : owns) {
    if (!arguments.given(own.option) || std::count(own.engines.begin(), own.engines.end(), engine) > 0)
      continue;
    std::string list;
    for (const std::string_view name : own.engines) list += (list.empty() ? "" : " or ") + std::string(name);
    arguments.refuse(own.option,
                     "is an option of --engine " + list + ", got --engine " + std::string(engine));
  }
}

Engine engine_of(Arguments& arguments) {
  const std::vector<std::string_view> names{Exact::name, Restitution::name, Cem::name};
  const std::optional<std::size_t> chosen = arguments.word("--engine", names);
  if (!chosen && arguments.given("--engine")) return {};  // refused; which options belong to it is unknown
  const std::string_view name = names[chosen.value_or(0)];
  refuse_foreign_options(arguments, name);

  const Budget budget = budget_of(arguments);
  const Calibration calibration = arguments.choice(
      "--calibration", {Calibration::fixed_wall, Calibration::two_body}, Calibration::fixed_wall);
  if (name == Exact::name) return Exact{calibration, budget};
  if (name == Restitution::name) {
    Restitution engine;
    engine.budget = budget;
    const auto tolerance = arguments.number("--accumulation-tolerance", NumberRange{0, 1e-3, false});
    if (tolerance) engine.accumulation_tolerance = *tolerance;
    return engine;
  }
  Cem engine;
  engine.time_step = arguments.number("--time-step", above(0));
  engine.damper = arguments.choice("--damper", {Damper::centred, Damper::lagged}, Damper::centred);
  engine.locate = arguments.flag("--locate");
  engine.large_step = arguments.number("--large-step", above(0));
  engine.unstable = arguments.flag("--unstable");
  engine.calibration = calibration;
  if (const auto most = arguments.whole_number("--max-steps", at_least(1))) engine.max_steps = *most;
  engine.budget = budget;
  return engine;
}

void read_sections(Arguments& arguments, Record& record) {
  const std::optional<std::string> list = arguments.text("--record");
  if (!list) return;
  record.half_cycles = false;
  std::istringstream words(*list + ',');
  std::set<std::string> listed;
  for (std::string word; std::getline(words, word, ',');) {
    if (!listed.insert(word).second)
      arguments.refuse("--record", "must list each once, got " + in_quotes(*list));
    if (word == "half_cycles")
      record.half_cycles = true;
    else if (word == "impacts")
      record.impacts = true;
    else if (word == "contacts")
      record.contacts = true;
    else if (word == "energy")
      record.energy = true;
    else if (word != "history") {
      arguments.refuse("--record",
                       "must be a list of half_cycles, impacts, contacts, energy, history with commas "
                       "between, got " +
                           in_quotes(word));
    } else if (!arguments.given("--history") && !arguments.given("--history-below")) {
      arguments.refuse("--record", "history needs samples to be asked for, by --history or --history-below");
    }
  }
}

Record record_of(Arguments& arguments, const Scene& scene) {
  Record record;
  read_sections(arguments, record);
  if (arguments.given("--history") && arguments.given("--history-below")) {
    arguments.refuse("--history", "either it or --history-below must be given, got both");
  }
  double last = 0;
  for (const std::string& text : arguments.texts("--history")) {
    const std::optional<Triple> window = parse_triple(text);
    if (!window || !(window->first >= last && window->second > window->first && window->second <= 1e12) ||
        !(window->count >= 2 && window->count <= most_samples)) {
      arguments.refuse("--history", "must be T0:T1:N with " + number_text(last) +
                                        " <= T0 < T1 <= 1e12 and 2 to " + std::to_string(most_samples) +
                                        " samples, got " + in_quotes(text));
      continue;
    }
    if (scene.until_time && !(window->first <= *scene.until_time)) {
      arguments.refuse("--history", "must begin before the end of the run, --until-time " +
                                        number_text(*scene.until_time) + ", got " + in_quotes(text));
    }
    record.history.push_back({window->first, window->second, window->count});
    last = window->second;
  }
  double above_it = 1e12;
  for (const std::string& text : arguments.texts("--history-below")) {
    const std::optional<Triple> window = parse_triple(text);
    if (!window ||
        !(window->first > 0 && window->first < above_it && window->second > 0 && window->second <= 1e12) ||
        !(window->count >= 2 && window->count <= most_samples)) {
      arguments.refuse("--history-below", "must be A:LENGTH:N with 0 < A < " + number_text(above_it) +
                                              ", 0 < LENGTH <= 1e12 and 2 to " +
                                              std::to_string(most_samples) + " samples, got " +
                                              in_quotes(text));
      continue;
    }
    record.history_below.push_back({window->first, window->second, window->count});
    above_it = window->first;
  }
  return record;
}

// What the engine itself refuses names fields; here they are options.
Run simulate_as_asked(const Scene& scene, const Engine& engine, const Record& record) {
  try {
    return simulate(scene, engine, record);
  } catch (const std::invalid_argument& error) {
    std::istringstream lines(error.what());
    std::string problems;
    for (std::string line; std::getline(lines, line);) {
      const std::size_t colon = std::min(line.find(':'), line.size());
      problems += (problems.empty() ? "" : "\n") + option_of(line.substr(0, colon)) + line.substr(colon);
    }
    throw UsageError(problems);
  }
}

// The end of a run may not be known before it: what was asked for behind it is not there.
void warn_of_missing_samples(const Run& run, const Record& record) {
  if (!run.history) return;
  std::int64_t asked = 0;
  for (const HistoryWindow& window : record.history) asked += window.count;
  for (const AmplitudeWindow& window : record.history_below) asked += window.count;
  const auto given = static_cast<std::int64_t>(run.history->time.size());
  if (given == asked) return;
  std::cerr << "impact-damper run: warning: the run ended at " << number_text(run.end_time) << " ("
            << name_of(run.stop_reason) << "): history has " << given << " of the " << asked
            << " samples asked for\n";
}

int run(const CLI::App& app) {
  Arguments arguments(app);
  const Scene scene = scene_of(arguments);
  const Engine engine = engine_of(arguments);
  const Record record = record_of(arguments, scene);
  const std::optional<std::string> file = arguments.file("--output");
  arguments.refuse_overwriting("--output", file, {arguments.text("--scene").value_or("")});
  arguments.finish();
  if (file) {
    require_writable(*file);
    if_interrupted_say(left_as_it_was(*file));
  }
  const Run result = simulate_as_asked(scene, engine, record);
  warn_of_missing_samples(result, record);
  const std::string text = run_text(result);
  if (file) {
    write_file(*file, text);
  } else {
    write_standard_output(text);
  }
  return 0;
}

void add_scene_options(CLI::App& app) {
  const auto add = [&](const std::string& name, const std::string& type, const std::string& help) {
    app.add_option(name, help)->type_name(type)->group("Scene");
  };
  add("--scene", "FILE", "read the scene from a JSON file; options given beside it win");
  const Scene defaults;
  for (const SceneField& field : scene_fields) {
    add(option_of(field.name), "X",
        std::string(field.meaning) + ";\n" + range_of(field).describe("a number") + ", default " +
            number_text(defaults.*field.member));
  }
  add("--until-time", "T", "stop at this time; a number > 0");
  add("--until-amplitude", "A",
      "stop at the end of the first half cycle below this amplitude;\n"
      "a number > 0. One of the two stops, or both, must be given");
}

void add_engine_options(CLI::App& app) {
  const auto add = [&](const std::string& name, const std::string& type, const std::string& help) {
    return app.add_option(name, help)->type_name(type)->group("Engine");
  };
  const auto add_flag = [&](const std::string& name, const std::string& help) {
    app.add_flag(name, help)->group("Engine");
  };
  add("--engine", "NAME",
      "exact (default): compliant walls in closed form, no time step;\n"
      "restitution: rigid walls, instantaneous impacts;\n"
      "cem: the component element method, central differences");
  add("--calibration", "HOW",
      "exact, cem: fixed-wall (default), the paper's, delivers the\n"
      "restitution to a primary mass held still; two-body to a free one");
  add("--time-step", "H",
      "cem: the fixed step, a number > 0 below the stability limit;\n"
      "default a hundredth of an impact's duration, or of half the\n"
      "primary mass's or the forcing's period where that is shorter");
  add("--damper", "WHICH",
      "cem: the velocity the wall's damper sees, centred (default)\n"
      "or lagged (one step behind)");
  add_flag("--locate", "cem: locate touch and release inside the step");
  add("--large-step", "H",
      "cem: steps of up to H, for instance 0.05, while no wall can be\n"
      "met, the time step near contact only; a number > the time step\n"
      "and < 2, with forcing at most half its period. Best with --locate");
  add_flag("--unstable", "cem: run even with a step beyond the stability limit");
  add("--accumulation-tolerance", "X",
      "restitution: bounce-down jumps to its end once the relative\n"
      "acceleration changes by less than this fraction in the rest of\n"
      "it; a number > 0 and <= 0.001, default 1e-8");
  add("--max-impacts", "N", "stop after so many impacts; a whole number >= 0,\ndefault 200000");
  add("--max-half-cycles", "N", "stop after so many half cycles; a whole number >= 1,\ndefault 200000");
  add("--max-time", "T",
      "stop at this time at the latest; a number > 0 and <= 1e12,\ndefault 500000, with a forcing faster "
      "than "
      "1 divided by its\nfrequency");
  add("--max-steps", "N", "cem: stop after so many steps; a whole number >= 1,\ndefault 300000000");
}

void add_output_options(CLI::App& app) {
  const auto add = [&](const std::string& name, const std::string& type, const std::string& help) {
    return app.add_option(name, help)->type_name(type)->group("Output");
  };
  add("--record", "LIST",
      "what to record, with commas between: half_cycles (default),\n"
      "impacts, contacts, energy, history");
  add("--history", "T0:T1:N",
      "record the motion at N equally spaced times from T0 to T1, both\nincluded; may be repeated, in order "
      "of time")
      ->expected(1)
      ->take_all();
  add("--history-below", "A:LENGTH:N",
      "the same over LENGTH, from the end of the first half cycle below\n"
      "amplitude A on; may be repeated, with descending A")
      ->expected(1)
      ->take_all();
  add("-o,--output", "FILE", "write the run there instead of to stdout");
}

}  // namespace

Command run_command(CLI::App& program) {
  CLI::App* const app =
      program.add_subcommand("run", "Simulate a scene and write what happens as a run file.");
  add_scene_options(*app);
  add_engine_options(*app);
  add_output_options(*app);
  app->footer(
      "A scene is a primary mass on a spring, and a secondary mass that travels between the walls\n"
      "of a cavity in it. Everything is dimensionless: lengths by the free travel between the\n"
      "walls, times by 1/Omega_n = sqrt(M/K), velocities by their quotient, forces by the force\n"
      "that moves the primary spring by the free travel.\n\n"
      "Examples:\n"
      "  impact-damper run --until-amplitude 0.1 -o run.json\n"
      "  impact-damper run --scene data/scenes/my.json --engine cem --time-step 1e-4 -o cem.json\n"
      "  impact-damper run --until-time 50 --record impacts,energy --history 0:50:2001\n\n"
      "A run that uses up --max-impacts, --max-half-cycles, --max-time or --max-steps ends there and\n"
      "says so in its stop_reason. Exit codes: 0 done, 2 the command line is not admitted, 3 the scene\n"
      "file's content is not admitted, 4 numerical failure, 5 the scene file cannot be read or\n"
      "the run cannot be written.");
  return {app, [app] { return run(*app); }};
}

}  // namespace impact_damper::cli
