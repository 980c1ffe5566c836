#include "scene_arguments.hpp"

#include <algorithm>
#include <iostream>
#include <sstream>

#include "impact_damper/analysis/cautions.hpp"
#include "impact_damper/base/number_text.hpp"

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
  return {field.least <= -1e12 ? -any : field.least, field.most >= 1e6 ? any : field.most};
}

Budget budget_of(Arguments& arguments) {
  Budget budget;
  if (const auto most = arguments.whole_number("--max-impacts", at_least(0))) budget.max_impacts = *most;
  if (const auto most = arguments.whole_number("--max-half-cycles", at_least(1)))
    budget.max_half_cycles = *most;
  if (const auto most = arguments.number("--max-time", NumberRange{0, 1e12, false})) budget.max_time = *most;
  return budget;
}

// Options that only some engines have; with another they would be ignored, so they are rejected.
void reject_foreign_options(Arguments& arguments, std::string_view engine) {
  struct Own {
    const char* option;
    std::vector<std::string_view> engines;
  };
  const std::vector<Own> owns{
      {"--time-step", {Cem::name}},
      {"--damper", {Cem::name}},
      {"--locate", {Cem::name}},
      {"--large-step", {Cem::name}},
      {"--stuck", {Cem::name}},
      {"--stuck-speed", {Cem::name}},
      {"--unstable", {Cem::name}},
      {"--calibration", {Exact::name, Cem::name}},
      {"--accumulation-tolerance", {Restitution::name}},
  };
  for (const Own& own : owns) {
    if (!arguments.given(own.option) || std::count(own.engines.begin(), own.engines.end(), engine) > 0)
      continue;
    std::string list;
    for (const std::string_view name : own.engines) list += (list.empty() ? "" : " or ") + std::string(name);
    arguments.reject(own.option,
                     "is an option of --engine " + list + ", got --engine " + std::string(engine));
  }
}

}  // namespace

SceneFile scene_of(Arguments& arguments) {
  const std::optional<std::string> name = arguments.file("--scene");
  SceneFile file = name ? read_scene_file(*name) : SceneFile{};
  Scene& scene = file.scene;
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
      arguments.reject("--until-time",
                       "it, --until-amplitude or both must be given: when is the run to stop?");
    return file;
  }
  for (const Problem& problem : problems_of(scene))
    arguments.reject(option_of(problem.field), problem.message);
  return file;
}

Engine engine_of(Arguments& arguments) {
  const std::vector<std::string_view> names{Exact::name, Restitution::name, Cem::name};
  const std::optional<std::size_t> chosen = arguments.word("--engine", names);
  if (!chosen && arguments.given("--engine")) return {};  // rejected; which options belong to it is unknown
  const std::string_view name = names[chosen.value_or(0)];
  reject_foreign_options(arguments, name);

  const Budget budget = budget_of(arguments);
  const Calibration calibration = arguments.choice(
      "--calibration", {Calibration::fixed_wall, Calibration::two_body}, Calibration::fixed_wall);
  const auto most_steps = arguments.whole_number("--max-steps", at_least(1));
  if (name == Exact::name) {
    Exact engine{calibration, budget};
    if (most_steps) engine.max_steps = *most_steps;
    return engine;
  }
  if (name == Restitution::name) {
    Restitution engine;
    engine.budget = budget;
    const auto tolerance = arguments.number("--accumulation-tolerance", NumberRange{0, 1e-3, false});
    if (tolerance) engine.accumulation_tolerance = *tolerance;
    if (most_steps) engine.max_steps = *most_steps;
    return engine;
  }
  Cem engine;
  engine.time_step = arguments.number("--time-step", above(0));
  engine.damper = arguments.choice("--damper", {Damper::centred, Damper::lagged}, Damper::centred);
  engine.locate = arguments.flag("--locate");
  engine.large_step = arguments.number("--large-step", above(0));
  const bool stuck_as_in_paper = arguments.word("--stuck", {"contact", "paper"}) == std::size_t{1};
  engine.stuck_speed = arguments.number("--stuck-speed", above(0));
  if (arguments.given("--stuck-speed") && !stuck_as_in_paper)
    arguments.reject("--stuck-speed", "is an option of --stuck paper");
  if (stuck_as_in_paper && !engine.stuck_speed) engine.stuck_speed = usual_stuck_speed;
  engine.unstable = arguments.flag("--unstable");
  engine.calibration = calibration;
  if (most_steps) engine.max_steps = *most_steps;
  engine.budget = budget;
  return engine;
}

void warn_of_cautions(const std::string& command, const Scene& scene, const std::optional<Scales>& scales) {
  for (const std::string& caution : cautions_of(scene, scales))
    std::cerr << command << ": warning: " << caution << '\n';
}

void warn_of_early_end(const std::string& command, const Run& run, const std::optional<Scales>& scales) {
  const auto warn = [&](const std::string& budget, const std::string& option) {
    std::cerr << command + ": warning: the run ended early, at time " + rounded_text(run.end_time, 6) +
                     (scales ? " (" + rounded_text(run.end_time * scales->time(), 6) + " s)" : "") +
                     ": it had used up its " + budget + "; " + option + " raises that\n";
  };
  const Budget& budget =
      std::visit([](const auto& engine) -> const Budget& { return engine.budget; }, run.engine);
  switch (run.stop_reason) {
    case StopReason::time:
    case StopReason::amplitude:
      return;
    case StopReason::impact_budget:
      return warn("budget of " + std::to_string(budget.max_impacts) + " impacts", "--max-impacts");
    case StopReason::half_cycle_budget:
      return warn("budget of " + std::to_string(budget.max_half_cycles) + " half cycles",
                  "--max-half-cycles");
    case StopReason::time_budget:
      return warn("budget of time, " + rounded_text(*budget.max_time, 6), "--max-time");
    case StopReason::step_budget:
      break;
  }
  const std::int64_t steps = std::visit([](const auto& engine) { return engine.max_steps; }, run.engine);
  warn("budget of " + std::to_string(steps) +
           (std::holds_alternative<Cem>(run.engine)
                ? " time steps"
                : " steps of the searches for events and of the integrals of energy"),
       "--max-steps");
}

void reject_as_options(const std::invalid_argument& problems) {
  std::istringstream lines(problems.what());
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = std::min(line.find(':'), line.size());
    if (!text.empty()) text += '\n';
    text += option_of(line.substr(0, colon));
    text += line.substr(colon);
  }
  throw UsageError(text);
}

Option threads_option() {
  return {"--threads", "N",
          "how many simulate at once; default one for each processor, same results with any"};
}

Option scenes_option() {
  return {"--scenes", "FOLDER", "folder of the scenes that runs are named after; default data/scenes"};
}

Options scene_options() {
  Options options;
  const auto add = [&](const std::string& name, const std::string& type, const std::string& help) {
    options.push_back({name, type, help, "Scene"});
  };
  add("--scene", "FILE",
      "read the scene from a JSON file, dimensionless or in kg, N/m and\nmm; options given beside it win, "
      "and those of the scene are\ndimensionless");
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
  return options;
}

Options engine_options() {
  Options options;
  const auto add = [&](const std::string& name, const std::string& type, const std::string& help) {
    options.push_back({name, type, help, "Engine"});
  };
  const auto add_flag = [&](const std::string& name, const std::string& help) {
    options.push_back({name, "", help, "Engine", Option::Takes::nothing});
  };
  add("--engine", "exact|restitution|cem",
      "exact (default): compliant walls in closed form, no time step;\n"
      "restitution: rigid walls, instantaneous impacts;\n"
      "cem: the component element method, central differences");
  add("--calibration", "fixed-wall|two-body",
      "exact, cem: fixed-wall (default), the paper's, delivers the\n"
      "restitution to a primary mass held still; two-body to a free one");
  add("--time-step", "H",
      "cem: the fixed step, a number > 0 below the stability limit;\n"
      "default a hundredth of an impact's duration, or of half the\n"
      "primary mass's or the forcing's period where that is shorter");
  add("--damper", "centred|lagged",
      "cem: the velocity the wall's damper sees, centred (default)\n"
      "or lagged (one step behind)");
  add_flag("--locate", "cem: locate touch and release inside the step");
  add("--large-step", "H",
      "cem: steps of up to H, for instance 0.05, while no wall can be\n"
      "met, the time step near contact only; a number > the time step\n"
      "and < 2, with forcing at most half its period. Best with --locate");
  add("--stuck", "contact|paper",
      "cem: a mass that sticks is in a contact that lasts (contact,\n"
      "default), or both masses are one as in the paper, by equation (9)\n"
      "with the force divided by 1 + nu, until x'' changes its sign");
  add("--stuck-speed", "U",
      "cem with --stuck paper: an impact slower than this, with the\n"
      "wall pushing, joins the masses; a number > 0, default " +
          number_text(usual_stuck_speed));
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
  add("--max-steps", "N",
      "stop after so many steps, of the searches for events or, with\n"
      "cem, of time; a whole number >= 1, default 10000000,\nwith cem 300000000");
  return options;
}

}  // namespace impact_damper::cli
