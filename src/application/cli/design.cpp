// `design`: finds the lightest secondary mass, and its clearance, with which a decay is over in time within
// tolerances.
#include <algorithm>
#include <cmath>

#include "application/sweeps/damper_set_design.hpp"
#include "application/sweeps/lightest_design.hpp"
#include "scene_arguments.hpp"

namespace impact_damper::cli {
namespace {

// Reads NAME=W or NAME=W%.
std::optional<SampledNumber> tolerance_of(Arguments& arguments, const std::string& text,
                                          const std::vector<Variable>& variables) {
  const auto varied = varied_of(arguments, text, texts_of(variables, &Variable::name), "--tolerance");
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
  const auto ends = parse_numbers(*text);
  if (ends && ends->size() == 2 && (*ends)[0] > 0 && (*ends)[0] < (*ends)[1]) return {(*ends)[0], (*ends)[1]};
  arguments.reject(option, "must be LEAST:MOST with 0 < LEAST < MOST, got " + in_quotes(*text));
  return otherwise;
}

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
  require_one_damper(file.scene, scene_name_of(arguments));
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
  arguments.read("--share", question.share, within(0.5, 0.999));
  question.secondary_mass = range_of(arguments, "--secondary-mass", default_masses(*question.scene.mass));
  question.clearance = range_of(arguments, "--clearance",
                                default_clearances(question.amplitude, *question.scene.damper().restitution));
  std::vector<std::string> tolerances = arguments.texts("--tolerance");
  if (tolerances.empty()) tolerances = {"restitution=0.1", "clearance=10%"};
  for (const std::string& text : tolerances)
    if (const auto tolerance = tolerance_of(arguments, text, tolerable(asked.dimensionless)))
      question.tolerances.push_back(*tolerance);
  arguments.read("--neighbours", question.neighbours, within(100, 1e6));
  arguments.read("--seed", question.seed, within(0, 1e15));
  return asked;
}

std::string percent(double share, int digits) { return rounded_text(100 * share, digits) + " %"; }

std::string tolerances_text(const Asked& asked) {
  std::vector<std::string> texts;
  for (const SampledNumber& each : asked.question.tolerances) {
    const std::string_view unit = asked.dimensionless ? "" : each.variable.unit;
    texts.push_back(
        filled("{} +-{}", each.variable.name,
               each.relative ? percent(each.width, 3) : with_unit(rounded_text(each.width, 3), unit)));
  }
  return joined(texts, ", ");
}

std::string table_of(const Asked& asked, const DesignAnswer& answer) {
  const DesignQuestion& question = asked.question;
  const std::string time = asked.unit(Dimension::time);
  Rows rows{{"within", "secondary mass", "clearance", "nominal", percent(question.share, 3), "slowest",
             filled("in time, of {}", question.neighbours), "impact speed", "wall force"},
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
                    filled("{}, {} to {}", check.in_time, rounded_text(100 * check.share.low, 4),
                           percent(check.share.high, 4)),
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
  return filled(
      "The first is the lightest of the search. {} neighbours are too few to tell whether {} are in "
      "time:\n{}.\n",
      question.neighbours, percent(question.share, 3),
      question.neighbours < least ? filled("give at least --neighbours {}", least)
                                  : "the interval holds both, give more --neighbours");
}

// Returns a sentence on the walls that the forces of the table are for.
std::string walls_in_words(const Asked& asked, const DesignAnswer& answer) {
  if (!answer.designs.front().check.largest_wall_force) return "";
  const SceneInUnits& scene = asked.question.scene;
  const double ratio = SceneDamper{}.wall_stiffness;
  const double stiffness = *scene.damper().contact_stiffness;
  const std::string text = filled(
      "Wall forces are those of walls of {}",
      asked.text(asked.dimensionless ? stiffness / *scene.stiffness : stiffness, Dimension::stiffness));
  if (stiffness != ratio * *scene.stiffness) return text + ".\n";
  return filled(
      "{}, {} times the primary stiffness: an assumption, the program's\ndefault. They go as its square "
      "root: give {} of your own walls.\n",
      text, readable(ratio), asked.dimensionless ? "--wall-stiffness" : "contact_stiffness");
}

// Returns a sentence on viscous damping alone, if its decay takes at most 1.5 times the time asked for.
std::string viscous_in_words(const Asked& asked, const DesignAnswer& answer) {
  constexpr double nearly = 1.5;
  const auto& time = answer.time_of_viscous_damping;
  if (!time || *time > nearly * asked.question.time) return "";
  return filled("Viscous damping alone, without a secondary mass, takes {}.\n",
                asked.text(*time, Dimension::time));
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
    text += filled("The clearance is the widest of its range: a wider one may do better{}.\n",
                   failing ? filled("; with {} impacts fail at {}", asked.text(*failing, Dimension::length),
                                    asked.text(question.amplitude, Dimension::length))
                           : "");
  }
  return text;
}

std::string text_of(const Asked& asked, const DesignAnswer& answer) {
  const DesignQuestion& question = asked.question;
  const auto range = [&](const DesignRange& each, Dimension dimension) {
    return readable(each.least) + " to " + asked.text(each.most, dimension);
  };
  const std::string head =
      filled("{} to below {} within {} in {} of all cases with {}\n",
             asked.text(std::abs(*question.scene.initial_displacement), Dimension::length),
             asked.text(question.amplitude, Dimension::length), asked.text(question.time, Dimension::time),
             percent(question.share, 3), tolerances_text(asked)) +
      filled("searched: secondary mass {}, clearance {}\n\n", range(question.secondary_mass, Dimension::mass),
             range(question.clearance, Dimension::length));
  if (answer.designs.empty())
    return head +
           filled(
               "No design was found. The heaviest secondary mass takes longer than {} with each clearance.\n",
               asked.text(longest_followed * question.time, Dimension::time));
  const std::string table = table_of(asked, answer) + '\n';
  const std::string verdict = answer.met ? verdict_on(question, answer.designs.front().check)
                                         : filled(
                                               "No design was found. The heaviest secondary mass is soonest "
                                               "with this clearance, within {}.\n",
                                               asked.text(answer.designs.front().time, Dimension::time));
  return head + table + walls_in_words(asked, answer) + verdict + viscous_in_words(asked, answer) +
         advice_on(asked, answer);
}

int design(Arguments& arguments) {
  if (arguments.given("--dampers")) return design_dampers(arguments);
  if (arguments.given("--upper")) arguments.reject("--upper", "is for several dampers, --dampers");
  const Asked asked = asked_of(arguments);
  const Threads threads = threads_of(arguments);
  const std::string scene = scene_name_of(arguments);
  const auto output = output_of(arguments, "--output", {Format::json}, {scene}),
             plan = output_of(arguments, "--write-plan", {Format::json}, {scene});
  reject_same_output(arguments, "--write-plan", plan, "--output", output);
  arguments.finish();
  if (const auto problems = problems_of(asked.question); !problems.empty())
    reject_as_options(problems, {{"amplitude", "--to"},
                                 {"time", "--within"},
                                 {"share", "--share"},
                                 {"secondary_mass", "--secondary-mass"},
                                 {"clearance", "--clearance"},
                                 {"tolerance", "--tolerance"}});
  for (const auto& file : {plan, output}) prepare_output(file);

  DesignAnswer answer;
  {
    ProgressOnStderr progress("design");
    answer = saying_options([&] { return find_designs(asked.question, threads, std::ref(progress)); });
  }
  if (plan && !answer.designs.empty())
    write_output(plan, plan_text(check_plan(asked.question, answer.designs.front().design)));
  if (output) write_output(output, design_text(asked.question, answer, asked.dimensionless));
  if (!is_standard_output(output) && !is_standard_output(plan)) write_standard_output(text_of(asked, answer));
  return answer.met && answer.designs.front().check.confirmed ? 0 : 1;
}

Options own_options() {
  const DesignQuestion otherwise;
  Options options{
      {"--to", "A", "the amplitude to come below, in mm"},
      {"--within", "T", "the time for that, in s"},
      {"--from", "A", "the initial displacement, in mm; default the scene's"},
      repeated_option(
          "--tolerance", "NAME=W[%]",
          "how far a number of the scene may be off, either way, in its unit or\nin percent of it, all "
          "deviations being as likely; may be repeated.\nDefault restitution=0.1 and clearance=10%"),
      {"--share", "P",
       filled("of all such deviations this share must be in time; 0.5 to 0.999,\ndefault {}",
              otherwise.share)},
      {"--secondary-mass", "LEAST:MOST",
       filled("where the mass is looked for, in kg; default {} to {} of the\nprimary mass", least_mass_ratio,
              most_mass_ratio)},
      {"--clearance", "LEAST:MOST",
       "where the clearance is looked for, in mm; default from the amplitude\n--to up to the clearance with "
       "which impacts fail at that amplitude"},
      {"--neighbours", "N",
       filled("how many random deviations a design is checked with; 100 to 1e6,\ndefault {}",
              otherwise.neighbours)},
      {"--dampers", "N",
       filled("instead: clearances and masses of up to so many dampers, 1 to {}, with\nwhich the least loss "
              "factor from --upper to --to is largest, after a\nrelease from --from. Together they have the "
              "mass --secondary-mass M,\ndefault the scene's; --tolerance is of restitution and "
              "clearance;\n--output is the scene with them",
              most_set_dampers)},
      {"--upper", "A",
       "the amplitude that the range of --dampers begins with, in mm; default\nnine tenths of the release"},
      {"--seed", "N",
       filled("of the random deviations; 0 to 1e15, default {}. The check has others than\nthe search",
              otherwise.seed)},
      {"--write-plan", "FILE", "write the check of the first design as a plan for impact-damper sweep"},
      {"-o,--output", "FILE", "write the designs there as well, as JSON"},
      threads_option()};
  return in_group("Design", std::move(options));
}

}  // namespace

Command design_command() {
  return {
      .name = "design",
      .description =
          "Find the lightest secondary mass, and its clearance, with which a free decay is over in time, "
          "within tolerances; or several dampers for a range of amplitudes.",
      .options = together({own_options(), scene_options(Stops::ignored), engine_options()}),
      .footer =
          R"(The scene is that of impact-damper run, a free decay; its secondary mass and clearance are not looked at. Beside a
dimensionless scene lengths are in units of its clearance, masses of the primary mass, times of sqrt(M/K).
Time is counted to the peak of the first half cycle below the amplitude.

Each line is the lightest design for a time, the first for the time asked: "nominal" is its own time, the next
column the one within which the share of its neighbours is down, then that of the slowest, and how many are within
the time of the line. Speed and force are the largest of all. A line is missing where there is no such design. Exit
code 1: no design was found, or the check of the first did not confirm it: too few neighbours are in
time, or they are too few to decide.

Example:
  impact-damper design --scene data/examples/mast.json --to 6 --within 10 \
    --tolerance restitution=0.1 --tolerance clearance=10%
  impact-damper design --scene data/examples/mast.json --dampers 6 --to 2 -o boxes.json)",
      .act = design};
}

}  // namespace impact_damper::cli
