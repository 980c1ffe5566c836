// `design`: finds the lightest secondary mass, and its clearance, with which a decay is over in time within
// tolerances.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "application/sweeps/damper_set_design.hpp"
#include "application/sweeps/lightest_design.hpp"
#include "commands.hpp"
#include "design_dampers.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"
#include "output.hpp"
#include "progress.hpp"
#include "scene_arguments.hpp"
#include "text_table.hpp"
#include "vary.hpp"

namespace impact_damper::cli {
namespace {

// Reads NAME=W or NAME=W%.
std::optional<SampledNumber> tolerance_of(Arguments& arguments, const std::string& text,
                                          const std::vector<Variable>& variables) {
  std::vector<std::string_view> names(variables.size());
  std::ranges::transform(variables, names.begin(), &Variable::name);
  const auto varied = varied_of(arguments, text, names, "--tolerance");
  if (!varied) return std::nullopt;
  SampledNumber number;
  number.law = SampledNumber::Law::uniform;
  number.variable = variables[varied->index];
  std::string width = varied->values.value_or("");
  number.relative = width.ends_with('%');
  if (number.relative) width.pop_back();
  const auto value = parse_number(width);
  if (!value || !(*value > 0) || (number.relative && !(*value < 100))) {
    arguments.reject("--tolerance",
                     "must be NAME=W or NAME=W% with W > 0 and a percentage < 100, got " + in_quotes(text));
    return std::nullopt;
  }
  number.width = number.relative ? *value / 100 : *value;
  return number;
}

DesignRange range_of(Arguments& arguments, const std::string& option, DesignRange otherwise) {
  const auto text = arguments.text(option);
  if (!text) return otherwise;
  const std::size_t colon = text->find(':');
  const auto least = parse_number(text->substr(0, colon)),
             most = colon == std::string::npos ? std::nullopt : parse_number(text->substr(colon + 1));
  if (least && most && *least > 0 && *least < *most) return {*least, *most};
  arguments.reject(option, "must be LEAST:MOST with 0 < LEAST < MOST, got " + in_quotes(*text));
  return otherwise;
}

// Returns a number for reading: "0.0532", "1980".
std::string readable(double value) { return number_text(rounded_to(value, 3)); }

struct Asked {
  DesignQuestion question;
  bool dimensionless = false;

  std::string unit(Dimension each) const { return std::string(unit_of(each, !dimensionless)); }
  std::string text(double value, Dimension each) const { return with_unit(readable(value), unit(each)); }
};

// Returns the numbers that may have a tolerance, by their names in a scene in units.
std::vector<Variable> tolerable(bool dimensionless) {
  SceneFile any;
  any.in_units.emplace();
  std::vector<Variable> variables = variables_of(any);
  std::erase_if(variables, [&](const Variable& each) {
    return each.name.starts_with("exciting_") || each.name.starts_with("secondary_d") ||
           (dimensionless && (each.name == "mass" || each.name == "stiffness" || each.name == "damping"));
  });
  return variables;
}

Asked asked_of(Arguments& arguments) {
  Asked asked;
  const SceneFile file = scene_of(arguments, Stops::ignored);
  require_one_damper(file.scene, arguments.file("--scene").value_or(""));
  reject_options_beside_units(arguments, file, "");
  DesignQuestion& question = asked.question;
  asked.dimensionless = !file.in_units;
  question.scene = with_defaults(file.in_units ? *file.in_units : with_unit_scales(file.scene));
  question.engine = engine_of(arguments);
  if (const auto from = arguments.number("--from", above(0))) question.scene.initial_displacement = *from;
  for (const auto& [option, number] :
       {std::pair("--to", &question.amplitude), std::pair("--within", &question.time)}) {
    if (!arguments.given(option)) arguments.reject(option, "must be given");
    if (const auto value = arguments.number(option, above(0))) *number = *value;
  }
  question.share = arguments.number("--share", within(0.5, 0.999)).value_or(question.share);
  question.secondary_mass = range_of(arguments, "--secondary-mass", default_masses(*question.scene.mass));
  question.clearance = range_of(arguments, "--clearance",
                                default_clearances(question.amplitude, *question.scene.damper().restitution));
  std::vector<std::string> tolerances = arguments.texts("--tolerance");
  if (tolerances.empty()) tolerances = {"restitution=0.1", "clearance=10%"};
  for (const std::string& text : tolerances)
    if (const auto tolerance = tolerance_of(arguments, text, tolerable(asked.dimensionless)))
      question.tolerances.push_back(*tolerance);
  question.neighbours =
      arguments.whole_number("--neighbours", within(100, 1e6)).value_or(question.neighbours);
  question.seed = arguments.whole_number("--seed", within(0, 1e15)).value_or(question.seed);
  return asked;
}

std::string percent(double share, int digits) { return rounded_text(100 * share, digits) + " %"; }

std::string tolerances_text(const Asked& asked) {
  std::string text;
  for (const SampledNumber& each : asked.question.tolerances) {
    if (!text.empty()) text += ", ";
    text += std::string(each.variable.name) + " +-" +
            (each.relative
                 ? percent(each.width, 3)
                 : with_unit(rounded_text(each.width, 3), asked.dimensionless ? "" : each.variable.unit));
  }
  return text;
}

std::string table_of(const Asked& asked, const DesignAnswer& answer) {
  const DesignQuestion& question = asked.question;
  const std::string time = asked.unit(Dimension::time);
  std::vector<std::vector<std::string>> rows{
      {"within", "secondary mass", "clearance", "nominal", percent(question.share, 3), "slowest",
       "in time, of " + std::to_string(question.neighbours), "impact speed", "wall force"},
      {time, asked.unit(Dimension::mass), asked.unit(Dimension::length), time, time, time,
       "and 95 % interval", asked.unit(Dimension::velocity), asked.unit(Dimension::force)}};
  for (const FoundDesign& each : answer.designs) {
    const DesignCheck& check = each.check;
    const auto known = [&](const std::optional<double>& number) {
      return number ? readable(*number) : "> " + readable(longest_followed * question.time);
    };
    rows.push_back({readable(each.time), number_text(each.design.secondary_mass),
                    number_text(each.design.clearance), known(check.nominal_time), known(check.time_of_share),
                    known(check.slowest),
                    std::to_string(check.in_time) + ", " + rounded_text(100 * check.share.low, 4) + " to " +
                        percent(check.share.high, 4),
                    readable(check.largest_impact_speed),
                    check.largest_wall_force
                        ? readable(force_in_unit(*check.largest_wall_force, question, asked.dimensionless))
                        : "-"});
  }
  return aligned(rows);
}

std::string verdict_on(const DesignQuestion& question, const DesignCheck& check) {
  if (check.confirmed) return "The first is the lightest, and is confirmed by its neighbours.\n";
  if (check.rejected)
    return "The first is the lightest of the search, but is not confirmed: too few of its neighbours are in "
           "time.\n";
  const std::int64_t least = least_neighbours_of(question.share);
  return "The first is the lightest of the search. " + std::to_string(question.neighbours) +
         " neighbours are too few to tell whether " + percent(question.share, 3) + " are in time:\n" +
         (question.neighbours < least ? "give at least --neighbours " + std::to_string(least)
                                      : "the interval holds both, give more --neighbours") +
         ".\n";
}

// Returns a sentence on the walls that the forces of the table are for.
std::string walls_in_words(const Asked& asked, const DesignAnswer& answer) {
  if (!answer.designs.front().check.largest_wall_force) return "";
  const SceneInUnits& scene = asked.question.scene;
  const double ratio = SceneDamper{}.wall_stiffness;
  const double stiffness = *scene.damper().contact_stiffness;
  const std::string text =
      "Wall forces are those of walls of " +
      asked.text(asked.dimensionless ? stiffness / *scene.stiffness : stiffness, Dimension::stiffness);
  if (stiffness != ratio * *scene.stiffness) return text + ".\n";
  return text + ", " + readable(ratio) +
         " times the primary stiffness: an assumption, the program's\ndefault. They go as its square root: "
         "give " +
         (asked.dimensionless ? "--wall-stiffness" : "contact_stiffness") + " of your own walls.\n";
}

// Returns a sentence on viscous damping alone, if its decay takes at most 1.5 times the time asked for.
std::string viscous_in_words(const Asked& asked, const DesignAnswer& answer) {
  constexpr double nearly = 1.5;
  const auto& time = answer.time_of_viscous_damping;
  if (!time || *time > nearly * asked.question.time) return "";
  return "Viscous damping alone, without a secondary mass, takes " + asked.text(*time, Dimension::time) +
         ".\n";
}

// Returns advice on the bounds that decided the result.
std::string advice_on(const Asked& asked, const DesignAnswer& answer) {
  const DesignQuestion& question = asked.question;
  const Design& design = answer.designs.front().design;
  std::string text;
  if (!answer.met) text += "A heavier secondary mass, more time or narrower tolerances may do.\n";
  if (answer.met && design.secondary_mass == question.secondary_mass.least)
    text += "The secondary mass is the least of its range: a lighter one may do.\n";
  if (design.clearance == question.clearance.least)
    text += "The clearance is the least of its range: a narrower one may do better.\n";
  if (design.clearance == question.clearance.most) {
    const auto failing = failing_clearance(question.amplitude, *question.scene.damper().restitution);
    text += "The clearance is the widest of its range: a wider one may do better" +
            (failing ? "; with " + asked.text(*failing, Dimension::length) + " impacts fail at " +
                           asked.text(question.amplitude, Dimension::length)
                     : std::string()) +
            ".\n";
  }
  return text;
}

std::string text_of(const Asked& asked, const DesignAnswer& answer) {
  const DesignQuestion& question = asked.question;
  const auto range = [&](const DesignRange& each, Dimension dimension) {
    return readable(each.least) + " to " + asked.text(each.most, dimension);
  };
  const std::string head = asked.text(std::abs(*question.scene.initial_displacement), Dimension::length) +
                           " to below " + asked.text(question.amplitude, Dimension::length) + " within " +
                           asked.text(question.time, Dimension::time) + " in " + percent(question.share, 3) +
                           " of all cases with " + tolerances_text(asked) + "\nsearched: secondary mass " +
                           range(question.secondary_mass, Dimension::mass) + ", clearance " +
                           range(question.clearance, Dimension::length) + "\n\n";
  if (answer.designs.empty())
    return head + "No design was found. The heaviest secondary mass takes longer than " +
           asked.text(longest_followed * question.time, Dimension::time) + " with each clearance.\n";
  const std::string table = table_of(asked, answer) + '\n';
  const std::string verdict =
      answer.met
          ? verdict_on(question, answer.designs.front().check)
          : "No design was found. The heaviest secondary mass is soonest with this clearance, within " +
                asked.text(answer.designs.front().time, Dimension::time) + ".\n";
  return head + table + walls_in_words(asked, answer) + verdict + viscous_in_words(asked, answer) +
         advice_on(asked, answer);
}

// Reports problems of the question as those of options.
[[noreturn]] void reject_question(const std::vector<Problem>& problems) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> options{
      {{"amplitude", "--to"},
       {"time", "--within"},
       {"share", "--share"},
       {"secondary_mass", "--secondary-mass"},
       {"clearance", "--clearance"},
       {"tolerance", "--tolerance"}}};
  std::vector<Problem> named;
  for (const Problem& problem : problems) {
    const auto* const option = std::ranges::find(options, std::string_view(problem.field),
                                                 [](const auto& each) { return each.first; });
    if (option != options.end()) {
      named.push_back({std::string(option->second), problem.message});
    } else {
      named.push_back(
          {"--scene", problem.field == "scene" ? problem.message : problem.field + ' ' + problem.message});
    }
  }
  throw UsageError(std::move(named));
}

int design(Arguments& arguments) {
  if (arguments.given("--dampers")) return design_dampers(arguments);
  if (arguments.given("--upper")) arguments.reject("--upper", "is for several dampers, --dampers");
  const Asked asked = asked_of(arguments);
  const Threads threads = threads_of(arguments);
  const auto output = arguments.file("--output"), plan = arguments.file("--write-plan");
  for (const auto& [option, file] : {std::pair("--output", output), std::pair("--write-plan", plan)})
    arguments.reject_overwriting(option, file, {arguments.text("--scene").value_or("")});
  for (const auto& [option, file] : {std::pair("--output", output), std::pair("--write-plan", plan)})
    reject_other_endings(arguments, option, file, {Format::json});
  reject_same_output(arguments, "--write-plan", plan, "--output", output);
  arguments.finish();
  if (const auto problems = problems_of(asked.question); !problems.empty()) reject_question(problems);
  for (const auto& file : {plan, output}) prepare_output(file);

  DesignAnswer answer;
  {
    ProgressOnStderr progress("design");
    answer = saying_options([&] {
      return find_designs(asked.question, threads, [&](const std::string& doing) { progress(doing); });
    });
  }
  if (plan && !answer.designs.empty())
    write_output(plan, plan_text(check_plan(asked.question, answer.designs.front().design)));
  if (output) write_output(output, design_text(asked.question, answer, asked.dimensionless));
  if (!is_standard_output(output) && !is_standard_output(plan)) write_standard_output(text_of(asked, answer));
  return answer.met && answer.designs.front().check.confirmed ? 0 : 1;
}

}  // namespace

Command design_command() {
  Command command{
      .name = "design",
      .description =
          "Find the lightest secondary mass, and its clearance, with which a free decay is over in time, "
          "within tolerances; or several dampers for a range of amplitudes."};
  const auto add = [&](const std::string& name, const std::string& type, const std::string& help,
                       Option::Takes takes = Option::Takes::value) {
    command.options.push_back({name, type, help, "Design", takes});
  };
  add("--to", "A", "the amplitude to come below, in mm");
  add("--within", "T", "the time for that, in s");
  add("--from", "A", "the initial displacement, in mm; default the scene's");
  add("--tolerance", "NAME=W[%]",
      "how far a number of the scene may be off, either way, in its unit or\nin percent of it, all "
      "deviations being "
      "as likely; may be repeated.\nDefault restitution=0.1 and clearance=10%",
      Option::Takes::repeated_value);
  add("--share", "P",
      "of all such deviations this share must be in time; 0.5 to 0.999,\ndefault " +
          number_text(DesignQuestion{}.share));
  add("--secondary-mass", "LEAST:MOST",
      "where the mass is looked for, in kg; default " + number_text(least_mass_ratio) + " to " +
          number_text(most_mass_ratio) + " of the\nprimary mass");
  add("--clearance", "LEAST:MOST",
      "where the clearance is looked for, in mm; default from the amplitude\n--to up to the clearance with "
      "which "
      "impacts fail at that amplitude");
  add("--neighbours", "N",
      "how many random deviations a design is checked with; 100 to 1e6,\ndefault " +
          std::to_string(DesignQuestion{}.neighbours));
  add("--dampers", "N",
      "instead: clearances and masses of up to so many dampers, 1 to " + std::to_string(most_set_dampers) +
          ", with\nwhich the least loss factor from --upper to --to is largest, after a\nrelease from "
          "--from. "
          "Together they have the mass --secondary-mass M,\ndefault the scene's; --tolerance is of "
          "restitution "
          "and clearance;\n--output is the scene with them");
  add("--upper", "A",
      "the amplitude that the range of --dampers begins with, in mm; default\nnine tenths of the release");
  add("--seed", "N",
      "of the random deviations; 0 to 1e15, default " + std::to_string(DesignQuestion{}.seed) +
          ". The check has others than\nthe search");
  add("--write-plan", "FILE", "write the check of the first design as a plan for impact-damper sweep");
  add("-o,--output", "FILE", "write the designs there as well, as JSON");
  command.options.push_back(threads_option());
  command.options.back().group = "Design";
  for (const Options& more : {scene_options(Stops::ignored), engine_options()})
    command.options.insert(command.options.end(), more.begin(), more.end());
  command.footer =
      "The scene is that of impact-damper run, a free decay; its secondary mass and clearance are not looked "
      "at. "
      "Beside a\ndimensionless scene lengths are in units of its clearance, masses of the primary mass, "
      "times of "
      "sqrt(M/K).\n"
      "Time is counted to the peak of the first half cycle below the amplitude.\n\n"
      "Each line is the lightest design for a time, the first for the time asked: \"nominal\" is its own "
      "time, the "
      "next\ncolumn the one within which the share of its neighbours is down, then that of the slowest, and "
      "how many "
      "are within\nthe time of the line. Speed and force are the largest of all. A line is missing where "
      "there "
      "is no such design. Exit\ncode 1: no design was found, or the check of the first did not confirm "
      "it: too few neighbours are in\ntime, or they are too few to decide.\n\n"
      "Example:\n"
      "  impact-damper design --scene data/examples/mast.json --to 6 --within 10 \\\n"
      "    --tolerance restitution=0.1 --tolerance clearance=10%\n"
      "  impact-damper design --scene data/examples/mast.json --dampers 6 --to 2 -o boxes.json";
  command.act = design;
  return command;
}

}  // namespace impact_damper::cli
