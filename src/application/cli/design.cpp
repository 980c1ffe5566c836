// `design`: finds the lightest secondary mass, and its clearance, with which a decay is over in time, steady
// motions under a force stay small, or both, within tolerances; or, with --dampers, several dampers for a
// range of amplitudes.
#include <algorithm>
#include <cmath>

#include "application/sweeps/damper_set_design.hpp"
#include "application/sweeps/lightest_design.hpp"
#include "commands.hpp"
#include "impact_damper/io/json_parts.hpp"

namespace impact_damper::cli {
namespace {

// Of these the command has options of its own.
Keys searched() { return {"secondary_mass", "clearance"}; }

SceneFile scene_with_one_damper(Arguments& arguments) {
  SceneFile file = scene_of(arguments, Stops::ignored, searched());
  require_one_damper(file.scene, scene_name_of(arguments));
  using enum Dimension;
  arguments.may_have_units(file.scales, {{"--to", length},
                                         {"--from", length},
                                         {"--upper", length},
                                         {"--within", time},
                                         {"--secondary-mass", mass},
                                         {"--clearance", length},
                                         {"--at-most", length},
                                         {"--under-force", force},
                                         {"--frequencies", frequency}});
  return file;
}

// --- The lightest damper ----------------------------------------------------------------------------------

// Reads NAME=W or NAME=W%.
std::optional<SampledNumber> tolerance_of(Arguments& arguments, const std::string& text,
                                          const std::vector<Variable>& variables,
                                          const std::optional<Scales>& scales) {
  const auto varied = varied_of(arguments, text, texts_of(variables, &Variable::name), "--tolerance");
  if (!varied) return std::nullopt;
  SampledNumber number;
  number.law = SampledNumber::Law::uniform;
  number.variable = variables[varied->index];
  std::string width = varied->values.value_or("");
  number.relative = width.ends_with('%');
  if (number.relative) width.pop_back();
  QuantityReader read{.dimension = number.relative ? Dimension::ratio : number.variable.dimension,
                      .scales = scales};
  const auto value = read(width);
  if (!read.problem.empty()) {
    arguments.reject("--tolerance", number.variable.name + ": " + read.problem);
    return std::nullopt;
  }
  if (!value || !(*value > 0) || (number.relative && !(*value < 100))) {
    arguments.reject("--tolerance",
                     "must be NAME=W or NAME=W% with W > 0 and a percentage < 100, got " + in_quotes(text));
    return std::nullopt;
  }
  number.width = number.relative ? *value / 100 : *value;
  return number;
}

// Reads LEAST:MOST; or, where one number may be given, that one as both ends.
DesignRange range_of(Arguments& arguments, const std::string& option, DesignRange otherwise,
                     bool may_be_one = false) {
  const auto text = arguments.text(option);
  if (!text) return otherwise;
  const auto ends = arguments.numbers(option);
  if (may_be_one && ends && ends->size() == 1 && ends->front() > 0) return {ends->front(), ends->front()};
  if (ends && ends->size() == 2 && (*ends)[0] > 0 && (*ends)[0] < (*ends)[1]) return {(*ends)[0], (*ends)[1]};
  arguments.reject(option, filled("must be LEAST:MOST with 0 < LEAST < MOST{}, got {}",
                                  may_be_one ? ", or one number > 0" : "", in_quotes(*text)));
  return otherwise;
}

std::string text_in_unit(const DesignQuestion& question, double value, Dimension dimension) {
  return with_unit(readable(value), unit_of(dimension, question.in_units));
}

// Returns the numbers that may have a tolerance, by their names in a scene in units.
std::vector<Variable> tolerable(bool in_units) {
  SceneFile any;
  any.in_units.emplace();
  std::vector<Variable> variables = variables_of(any);
  std::erase_if(variables, [&](const Variable& each) {
    const bool only_in_units = each.name == "mass" || each.name == "stiffness" ||
                               each.name == "natural_frequency" || each.name == "damping" ||
                               each.name == "inclination" || each.name == "gravity" || each.name == "drag" ||
                               each.name.ends_with("friction_coefficient");
    return each.name.starts_with("exciting_") || each.name.starts_with("secondary_d") ||
           (!in_units && only_in_units);
  });
  return variables;
}

// Factors by which a check may be enlarged unless its size is given.
constexpr std::int64_t most_enlarged = 4, most_enlarged_under_force = 2;

// Returns the demand on steady motions; absent without --under-force.
std::optional<ForcedDemand> forced_demand_of(Arguments& arguments, const DesignQuestion& question) {
  if (!arguments.given("--under-force")) {
    for (const char* option : {"--frequencies", "--at-most"})
      if (arguments.given(option)) arguments.reject(option, "needs --under-force");
    return std::nullopt;
  }
  for (const char* option : {"--frequencies", "--at-most"})
    if (!arguments.given(option)) arguments.reject(option, "must be given with --under-force");
  // Of a dimensionless scene, whose numbers are made ones in units.
  std::optional<Scales> scales;
  if (!question.in_units) scales = scales_of(question.scene);
  ForcedDemand forced;
  arguments.read("--under-force", forced.force, above(0));
  const DesignRange frequencies = range_of(arguments, "--frequencies", {1, 2});
  arguments.read("--at-most", forced.amplitude, above(0));
  forced.force *= scale_of(Dimension::force, scales);
  forced.least = frequencies.least * scale_of(Dimension::frequency, scales);
  forced.most = frequencies.most * scale_of(Dimension::frequency, scales);
  return forced;
}

DesignQuestion question_of(Arguments& arguments) {
  DesignQuestion question;
  const SceneFile file = scene_with_one_damper(arguments);
  question.in_units = file.in_units.has_value();
  question.scene = with_defaults(file.in_units ? *file.in_units : with_unit_scales(file.scene));
  question.engine = engine_of(arguments);
  if (const auto from = arguments.number("--from", above(0))) question.scene.initial_displacement = *from;
  question.forced = forced_demand_of(arguments, question);
  question.has_decay = !question.forced || arguments.given("--to") || arguments.given("--within");
  if (question.has_decay)
    for (const auto& [option, number] :
         {std::pair("--to", &question.amplitude), std::pair("--within", &question.time)}) {
      if (!arguments.given(option)) arguments.reject(option, "must be given");
      if (const auto value = arguments.number(option, above(0))) *number = *value;
    }
  if (question.forced) question.share = forced_share;
  arguments.read("--share", question.share, within(0.5, 0.999));
  question.secondary_mass = range_of(arguments, "--secondary-mass", default_masses(question), true);
  question.clearance =
      range_of(arguments, "--clearance",
               default_clearances(least_amplitude_of(question), *question.scene.damper().restitution));
  std::vector<std::string> tolerances = arguments.texts("--tolerance");
  if (tolerances.empty()) tolerances = {"restitution=0.1", "clearance=10%"};
  for (const std::string& text : tolerances)
    if (const auto tolerance = tolerance_of(arguments, text, tolerable(question.in_units), file.scales))
      question.tolerances.push_back(*tolerance);
  if (question.forced) question.neighbours = forced_neighbours_of(question.share);
  if (!arguments.given("--neighbours"))
    question.most_enlarged = question.forced ? most_enlarged_under_force : most_enlarged;
  arguments.read("--neighbours", question.neighbours, within(100, 1e6));
  arguments.read("--seed", question.seed, within(0, 1e15));
  return question;
}

std::string percent(double share, int digits) { return rounded_text(100 * share, digits) + " %"; }

std::string tolerances_text(const DesignQuestion& question) {
  std::vector<std::string> texts;
  for (const SampledNumber& each : question.tolerances) {
    const std::string_view unit = question.in_units ? each.variable.unit : "";
    texts.push_back(
        filled("{} +-{}", each.variable.name,
               each.relative ? percent(each.width, 3) : with_unit(rounded_text(each.width, 3), unit)));
  }
  return joined(texts, ", ");
}

std::string peak_text(const DesignQuestion& question, const SteadyPeak& peak) {
  return filled("{} at {}", text_in_unit(question, peak.amplitude, Dimension::length),
                text_in_unit(question, frequency_in_unit(peak.frequency, question), Dimension::frequency));
}

// The worst of all cases comes first.
std::string table_of(const DesignQuestion& question, const DesignAnswer& answer) {
  using enum Dimension;
  using Number = std::optional<double>;
  Rows rows(2 + answer.designs.size());
  const auto add = [&](const std::string& head, std::string_view unit, const auto& text) {
    rows[0].push_back(head);
    rows[1].emplace_back(unit);
    for (std::size_t i = 0; i < answer.designs.size(); ++i) rows[2 + i].push_back(text(answer.designs[i]));
  };
  const auto unit = [&](Dimension each) { return unit_of(each, question.in_units); };
  // A number of a check, or what is printed where there is none.
  const auto add_number = [&](const std::string& head, Dimension dimension, const std::string& otherwise,
                              const auto& number) {
    add(head, unit(dimension), [&](const FoundDesign& each) {
      const Number value = number(each.check);
      return value ? readable(*value) : otherwise;
    });
  };
  const auto amplitude_of = [](const std::optional<SteadyPeak>& peak) {
    return peak ? Number(peak->amplitude) : std::nullopt;
  };
  const std::string share = percent(question.share, 3), never = "not steady",
                    later = "> " + readable(longest_followed * question.time);
  if (question.forced) {
    add_number("worst steady", length, never,
               [&](const auto& check) { return amplitude_of(check.worst_peak); });
    add_number("at", frequency, "-", [&](const auto& check) {
      const auto& worst = check.worst_peak;
      return worst ? Number(frequency_in_unit(worst->frequency, question)) : std::nullopt;
    });
    add_number(share + " below", length, never, [](const auto& check) { return check.amplitude_of_share; });
    add_number("nominal", length, never, [&](const auto& check) { return amplitude_of(check.nominal_peak); });
  } else {
    add("within", unit(time), [](const auto& each) { return readable(each.time); });
  }
  add("secondary mass", unit(mass), [](const auto& each) { return number_text(each.design.secondary_mass); });
  add("clearance", unit(length), [](const auto& each) { return number_text(each.design.clearance); });
  if (question.has_decay) {
    add_number("slowest", time, later, [](const auto& check) { return check.slowest; });
    add_number(share + " within", time, later, [](const auto& check) { return check.time_of_share; });
    add_number("nominal", time, later, [](const auto& check) { return check.nominal_time; });
  }
  add(question.forced ? "meet it" : "in time", "and 95 % interval", [](const auto& each) {
    const DesignCheck& check = each.check;
    return filled("{} of {}, {} to {}", check.in_time, check.neighbours,
                  rounded_text(100 * check.share.low, 4), percent(check.share.high, 4));
  });
  if (question.has_decay) {
    add_number("impact speed", velocity, "-",
               [](const auto& check) { return Number(check.largest_impact_speed); });
    add_number("wall force", force, "-", [&](const auto& check) {
      const Number& largest = check.largest_wall_force;
      return largest ? Number(force_in_unit(*largest, question)) : largest;
    });
  }
  return aligned(rows);
}

bool mass_is_given(const DesignQuestion& question) {
  return question.secondary_mass.least == question.secondary_mass.most;
}

std::string verdict_on(const DesignQuestion& question, const DesignCheck& check) {
  const std::string which =
      mass_is_given(question) ? "Of this mass the first has the best clearance" : "The first is the lightest";
  const std::string meets = question.forced ? "meet it" : "are in time";
  if (check.confirmed) return which + ", and is confirmed by its neighbours.\n";
  if (check.rejected)
    return filled("{} of the search, but is not confirmed: too few of its neighbours {}.\n", which, meets);
  const std::int64_t least = least_neighbours_of(question.share);
  return filled("{} of the search. {} neighbours are too few to tell whether {} {}:\n{}.\n", which,
                check.neighbours, percent(question.share, 3), meets,
                check.neighbours < least ? filled("give at least --neighbours {}", least)
                                         : "the interval holds both, give more --neighbours");
}

// Returns a sentence on what steady motions of a check are.
std::string motions_in_words(const DesignQuestion& question, const DesignAnswer& answer) {
  if (!question.forced) return "";
  const Plan plan = forced_check_plan(question, answer.designs.front().design);
  const FrequencyRange& looked_at = *plan.forced.frequencies;
  const auto frequency = [&](double f) { return readable(frequency_in_unit(f, question)); };
  const std::int64_t not_steady = answer.designs.front().check.not_steady;
  const std::string unknown =
      not_steady == 0
          ? ""
          : filled("Neighbours with a motion that is not steady, which do not meet the requirement: {}.\n",
                   not_steady);
  return unknown +
         filled(
             "For each neighbour the frequency rises, from rest, through {} values from {} to {}\nand falls "
             "again: the worst of these {} steady motions counts. At other frequencies no motion can\nhave a "
             "component at the force's frequency above {}. Motions that only another beginning\nleads to are "
             "not among them: see impact-damper response basin.\n",
             looked_at.count, frequency(looked_at.from),
             with_unit(frequency(looked_at.to), unit_of(Dimension::frequency, question.in_units)),
             2 * looked_at.count, text_in_unit(question, question.forced->amplitude, Dimension::length));
}

// Returns a sentence on the walls that the forces of the table are for.
std::string walls_in_words(const DesignQuestion& question, const DesignAnswer& answer) {
  if (!answer.designs.front().check.largest_wall_force) return "";
  const SceneInUnits& scene = question.scene;
  const double ratio = SceneDamper{}.wall_stiffness;
  const double stiffness = *scene.damper().contact_stiffness;
  const std::string text =
      filled("Wall forces are those of walls of {}",
             text_in_unit(question, question.in_units ? stiffness : stiffness / *stiffness_of(scene),
                          Dimension::stiffness));
  if (stiffness != ratio * *stiffness_of(scene)) return text + ".\n";
  return filled(
      "{}, {} times the primary stiffness: an assumption, the program's\ndefault. They go as its square "
      "root: give {} of your own walls.\n",
      text, readable(ratio), question.in_units ? "contact_stiffness" : "--wall-stiffness");
}

// Returns a sentence on viscous damping alone, for a decay if it takes at most 1.5 times the time asked for.
std::string viscous_in_words(const DesignQuestion& question, const DesignAnswer& answer) {
  constexpr double nearly = 1.5;
  std::string text;
  if (const auto& time = answer.time_of_viscous_damping; time && *time <= nearly * question.time)
    text += filled("Viscous damping alone, without a secondary mass, takes {}.\n",
                   text_in_unit(question, *time, Dimension::time));
  if (const auto& peak = answer.peak_of_viscous_damping)
    text += filled("Without a secondary mass the steady amplitude is {}.\n", peak_text(question, *peak));
  return text;
}

// Returns advice on the bounds that decided the result.
std::string advice_on(const DesignQuestion& question, const DesignAnswer& answer) {
  const Design& design = answer.designs.front().design;
  std::string text;
  if (const double held = locking_amplitude_of(question, design.secondary_mass); held > 0)
    text += filled("Up to {} that secondary mass is held at rest in a cavity of any clearance.\n",
                   text_in_unit(question, held, Dimension::length));
  constexpr double heavier = 1.1;
  const std::string more = question.forced ? "a larger amplitude" : "more time";
  if (!answer.met)
    text +=
        locking_amplitude_of(question, heavier * design.secondary_mass) < least_amplitude_of(question)
            ? filled("A heavier secondary mass, {} or narrower tolerances may do.\n", more)
            : filled("{}{} or narrower tolerances may do.\n", question.forced ? "A" : "M", more.substr(1));
  if (answer.met && !mass_is_given(question) && design.secondary_mass == question.secondary_mass.least)
    text += "The secondary mass is the least of its range: a lighter one may do.\n";
  if (design.clearance == question.clearance.least)
    text += "The clearance is the least of its range: a narrower one may do better.\n";
  if (design.clearance == question.clearance.most) {
    // The closed form is for a mass without friction and weight.
    const auto failing =
        locking_amplitude_of(question, design.secondary_mass) > 0
            ? std::nullopt
            : failing_clearance(least_amplitude_of(question), *question.scene.damper().restitution);
    text += filled(
        "The clearance is the widest of its range: a wider one may do better{}.\n",
        failing ? filled("; with {} impacts fail at {}", text_in_unit(question, *failing, Dimension::length),
                         text_in_unit(question, least_amplitude_of(question), Dimension::length))
                : "");
  }
  return text;
}

std::string text_of(const DesignQuestion& question, const DesignAnswer& answer) {
  const auto range = [&](const DesignRange& each, Dimension dimension) {
    const std::string most = text_in_unit(question, each.most, dimension);
    return each.least == each.most ? most : readable(each.least) + " to " + most;
  };
  std::vector<std::string> asked;
  if (const auto& forced = question.forced)
    asked.push_back(filled(
        "at most {} under {} from {} to {}", text_in_unit(question, forced->amplitude, Dimension::length),
        text_in_unit(question, force_in_unit(forced->force, question), Dimension::force),
        readable(frequency_in_unit(forced->least, question)),
        text_in_unit(question, frequency_in_unit(forced->most, question), Dimension::frequency)));
  if (question.has_decay)
    asked.push_back(
        filled("{} to below {} within {}",
               text_in_unit(question, std::abs(*question.scene.initial_displacement), Dimension::length),
               text_in_unit(question, question.amplitude, Dimension::length),
               text_in_unit(question, question.time, Dimension::time)));
  if (answer.none_needed)
    return joined(asked, ", and ") + "\nNo damper is needed.\n" + viscous_in_words(question, answer);
  const std::string head =
      filled("{} in {} of all cases with {}\n", joined(asked, ", and "), percent(question.share, 3),
             tolerances_text(question)) +
      filled("searched: secondary mass {}, clearance {}\n\n", range(question.secondary_mass, Dimension::mass),
             range(question.clearance, Dimension::length));
  if (answer.designs.empty())
    return head +
           (question.forced
                ? filled("No design was found. The heaviest secondary mass needs more than {} times as much "
                         "with "
                         "each clearance.\n",
                         readable(longest_followed))
                : filled("No design was found. The heaviest secondary mass takes longer than {} with each "
                         "clearance.\n",
                         text_in_unit(question, longest_followed * question.time, Dimension::time))) +
           viscous_in_words(question, answer);
  const std::string table = table_of(question, answer) + '\n';
  const std::string verdict =
      answer.met        ? verdict_on(question, answer.designs.front().check)
      : question.forced ? "No design was found. The heaviest secondary mass has the least with this "
                          "clearance.\n"
                        : filled(
                              "No design was found. The heaviest secondary mass is soonest "
                              "with this clearance, within {}.\n",
                              text_in_unit(question, answer.designs.front().time, Dimension::time));
  return head + table + motions_in_words(question, answer) + walls_in_words(question, answer) + verdict +
         viscous_in_words(question, answer) + advice_on(question, answer);
}

// --- Several dampers for a range of amplitudes ------------------------------------------------------------

struct Asked {
  SceneFile file;
  DamperSetQuestion question;
  double mass = 1;  // of the primary mass: kg, or 1
};

// Reads the only tolerances allowed, restitution=W and clearance=W%.
void read_tolerances(Arguments& arguments, DamperSetQuestion& question) {
  for (const std::string& text : arguments.texts("--tolerance")) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    std::string width = equals == std::string::npos ? "" : text.substr(equals + 1);
    const bool percent = width.ends_with('%');
    if (percent) width.pop_back();
    const auto value = parse_number(width);
    if (name == "restitution" && !percent && value && *value >= 0)
      question.restitution_off = *value;
    else if (name == "clearance" && percent && value && *value >= 0)
      question.clearance_off = *value / 100;
    else
      arguments.reject("--tolerance",
                       "must be restitution=W or clearance=W% with --dampers, got " + in_quotes(text));
  }
}

Asked asked_of(Arguments& arguments) {
  Asked asked;
  asked.file = scene_with_one_damper(arguments);
  require_one_linear_damper(asked.file.scene, scene_name_of(arguments));
  for (const char* option : {"--within", "--share", "--clearance", "--neighbours", "--seed", "--write-plan",
                             "--write-decay-plan", "--under-force", "--frequencies", "--at-most"})
    if (arguments.given(option)) arguments.reject(option, "is not for several dampers, --dampers");
  for (const Option& option : engine_options())
    if (arguments.given(option.name))
      arguments.reject(option.name, "is not for --dampers, whose runs are those of the restitution engine");
  const Scene& scene = asked.file.scene;
  if (scene.force_amplitude != 0) arguments.reject("--dampers", "needs a free decay: the scene has a force");
  DamperSetQuestion& question = asked.question;
  const double length = scale_of(Dimension::length, asked.file.scales);
  asked.mass = scale_of(Dimension::mass, asked.file.scales);
  question.count = arguments.whole_number("--dampers", within(1, double(most_set_dampers))).value_or(1);
  question.release = arguments.number("--from", above(0)).value_or(std::abs(scene.x0) * length);
  if (question.release == 0 && !arguments.given("--from"))
    arguments.reject("--from", "must be given: the scene has no initial displacement");
  if (!arguments.given("--to")) arguments.reject("--to", "must be given");
  question.to = arguments.number("--to", above(0)).value_or(question.release / 10);
  question.upper = arguments.number("--upper", above(0)).value_or(0.9 * question.release);
  question.mass_ratio =
      arguments.number("--secondary-mass", above(0)).value_or(scene.damper().mass_ratio * asked.mass) /
      asked.mass;
  question.restitution = scene.damper().restitution;
  question.damping_ratio = scene.damping_ratio;
  question.friction = scene.damper().friction * length;
  question.static_friction = scene.damper().static_friction * length;
  question.weight = scene.weight * length;
  question.drag = scene.damper().drag * scene.damper().mass_ratio;
  read_tolerances(arguments, question);
  return asked;
}

// Returns the scene with these dampers as the text of its file, in units if the question was.
std::string scene_file_text(const Asked& asked, const DamperSet& set) {
  const DamperSetQuestion& question = asked.question;
  JsonWriter out("scene");
  out.open_object(JsonWriter::Layout::lines);
  out.field("description", filled("{} dampers for amplitudes from {} to {}", set.dampers.size(),
                                  readable(question.release), readable(question.to)));
  if (asked.file.in_units) {
    SceneInUnits scene = *asked.file.in_units;
    const DamperInUnits given = scene.damper();
    scene.dampers.clear();
    scene.initial_displacement = question.release;
    scene.initial_velocity.reset();
    scene.until_seconds.reset();
    scene.until_millimetres = question.to;
    for (const SceneDamper& damper : set.dampers) {
      DamperInUnits& each = scene.dampers.emplace_back();
      each.secondary_mass = in_three_digits(damper.mass_ratio * asked.mass);
      each.clearance = damper.clearance;
      each.restitution = damper.restitution;
      each.friction_coefficient = given.friction_coefficient;
      each.static_friction_coefficient = given.static_friction_coefficient;
      each.drag = given.drag;
    }
    write_unit_fields(out, scene);
  } else {
    Scene scene;
    scene.damping_ratio = question.damping_ratio;
    scene.x0 = question.release;
    scene.until_amplitude = question.to;
    scene.dampers = set.dampers;
    for (SceneDamper& damper : scene.dampers) damper.mass_ratio = in_three_digits(damper.mass_ratio);
    set_components(scene, question, 1);
    write_scene_fields(out, scene);
  }
  out.close();
  return out.finish() + '\n';
}

std::string text_of(const Asked& asked, const DamperSet& set) {
  const DamperSetQuestion& question = asked.question;
  const bool in_units = asked.file.in_units.has_value();
  const std::string length = in_units ? " mm" : "", mass = in_units ? " kg" : "";
  const auto least = [](const std::vector<double>& values) { return *std::ranges::min_element(values); };
  std::string text = filled("released from {}{}, {}{} together, restitution {} +-{}, clearances +-{} %\n\n",
                            readable(question.release), length, readable(question.mass_ratio * asked.mass),
                            mass, readable(question.restitution), readable(question.restitution_off),
                            readable(100 * question.clearance_off));
  Rows rows{{"damper", "clearance", "mass"}, {"", in_units ? "mm" : "", in_units ? "kg" : ""}};
  for (std::size_t j = 0; j < set.dampers.size(); ++j)
    rows.push_back({std::to_string(j + 1), number_text(set.dampers[j].clearance),
                    readable(set.dampers[j].mass_ratio * asked.mass)});
  text += aligned(rows) + "\n";
  rows = {{"amplitude", "loss factor", "", "dampers that are off", "", ""},
          {in_units ? "mm" : "", "if they add", "run", "each at its worst, if they add", "mean",
           filled("least of {}", set_draws)}};
  for (std::size_t i = 0; i + 1 < set.edges.size(); ++i)
    rows.push_back({readable(std::sqrt(set.edges[i] * set.edges[i + 1])), readable(set.expected[i]),
                    readable(set.run.mean[i]), readable(set.worst[i]), readable(set.varied.mean[i]),
                    readable(set.varied.low[i])});
  text += aligned(rows) + "\n";
  text += filled(
      "From {} to {}{} the loss factor is {} or more, by the mean of {} releases; of {} sets whose "
      "dampers are off by their mean {} or more, in the worst of them {}.\n",
      readable(set.edges.front()), readable(set.edges.back()), length, readable(least(set.run.mean)),
      set_releases, set_draws, readable(least(set.varied.mean)), readable(least(set.varied.low)));
  if (set.one)
    text += filled(
        "One damper of that mass, designed in the same way, has a clearance of {}{} and a loss "
        "factor of {} or more.\n",
        readable(set.one->clearance), length, readable(set.one->least));
  if (const double held = locking_amplitude_of(question); held > 0)
    text += filled("Up to {}{} these masses are held at rest in cavities of any clearance.\n", readable(held),
                   length);
  const auto without_mass = question.count - std::int64_t(set.dampers.size());
  if (without_mass > 0) text += filled("Of {} clearances {} got no mass.\n", question.count, without_mass);
  return text;
}

int design_dampers(Arguments& arguments) {
  const Asked asked = asked_of(arguments);
  const Threads threads = threads_of(arguments);
  const auto output = output_of(arguments, "--output", {Format::json}, {scene_name_of(arguments)});
  arguments.finish();
  if (const auto problems = problems_of(asked.question); !problems.empty())
    reject_as_options(problems, {{"release", "--from"},
                                 {"upper", "--upper"},
                                 {"to", "--to"},
                                 {"mass_ratio", "--secondary-mass"},
                                 {"count", "--dampers"},
                                 {"clearance_off", "--tolerance"},
                                 {"restitution_off", "--tolerance"}});
  prepare_output(output);
  DamperSet set;
  {
    ProgressOnStderr progress("design");
    set = best_damper_set(asked.question, threads, std::ref(progress));
  }
  if (output) write_output(output, scene_file_text(asked, set));
  if (!is_standard_output(output)) write_standard_output(text_of(asked, set));
  return 0;
}

// --- The command ------------------------------------------------------------------------------------------

int design(Arguments& arguments) {
  if (arguments.given("--dampers")) return design_dampers(arguments);
  if (arguments.given("--upper")) arguments.reject("--upper", "is for several dampers, --dampers");
  const DesignQuestion question = question_of(arguments);
  const Threads threads = threads_of(arguments);
  const std::string scene = scene_name_of(arguments);
  const auto output = output_of(arguments, "--output", {Format::json}, {scene}),
             plan = output_of(arguments, "--write-plan", {Format::json}, {scene}),
             decay_plan = output_of(arguments, "--write-decay-plan", {Format::json}, {scene});
  reject_same_output(arguments, "--write-plan", plan, "--output", output);
  reject_same_output(arguments, "--write-decay-plan", decay_plan, "--output", output);
  reject_same_output(arguments, "--write-decay-plan", decay_plan, "--write-plan", plan);
  if (decay_plan && !(question.forced && question.has_decay))
    arguments.reject("--write-decay-plan",
                     "is for a decay beside a force; of a decay alone give --write-plan");
  arguments.finish();
  if (const auto problems = problems_of(question); !problems.empty())
    reject_as_options(problems, {{"amplitude", "--to"},
                                 {"time", "--within"},
                                 {"force", "--under-force"},
                                 {"frequencies", "--frequencies"},
                                 {"forced_amplitude", "--at-most"},
                                 {"share", "--share"},
                                 {"secondary_mass", "--secondary-mass"},
                                 {"clearance", "--clearance"},
                                 {"tolerance", "--tolerance"}});
  for (const auto& file : {plan, decay_plan, output}) prepare_output(file);

  DesignAnswer answer;
  {
    ProgressOnStderr progress("design");
    answer = saying_options([&] { return find_designs(question, threads, std::ref(progress)); });
  }
  if (!answer.designs.empty()) {
    DesignQuestion followed = question;
    followed.neighbours = answer.designs.front().check.neighbours;
    const Design& first = answer.designs.front().design;
    if (plan)
      write_output(plan, plan_text(question.forced ? forced_check_plan(followed, first)
                                                   : check_plan(followed, first)));
    if (decay_plan) write_output(decay_plan, plan_text(check_plan(followed, first)));
  }
  if (output) write_output(output, design_text(question, answer));
  if (!is_standard_output(output) && !is_standard_output(plan) && !is_standard_output(decay_plan))
    write_standard_output(text_of(question, answer));
  return answer.none_needed || (answer.met && answer.designs.front().check.confirmed) ? 0 : 1;
}

Options own_options() {
  const DesignQuestion otherwise;
  Options options{
      {"--to", "A", "the amplitude to come below, in mm"},
      {"--within", "T", "the time for that, in s"},
      {"--from", "A", "the initial displacement, in mm; default the scene's"},
      repeated_option(
          "--tolerance", "NAME=W[%]",
          "how far a number of the scene may be off, either way, with its unit or\nin percent of it, all "
          "deviations being as likely; may be repeated.\nDefault restitution=0.1 and clearance=10%"),
      {"--under-force", "F",
       "also, or instead of --to and --within: a harmonic force of this amplitude,\nin N, under which all "
       "steady motions shall be small"},
      {"--frequencies", "LEAST:MOST", "its frequencies, in Hz"},
      {"--at-most", "A", "the largest steady amplitude allowed at any of these, in mm"},
      {"--share", "P",
       filled("of all such deviations this share must be in time, or meet what is asked\nunder a force; 0.5 "
              "to 0.999, default {}, under a force {}",
              otherwise.share, forced_share)},
      {"--secondary-mass", "LEAST:MOST",
       filled("where the mass is looked for, in kg; or the mass itself, M, of which the\nclearance is found "
              "with "
              "which the requirement is met best; default {} to {}\nof the primary mass",
              least_mass_ratio, most_mass_ratio)},
      {"--clearance", "LEAST:MOST",
       "where the clearance is looked for, in mm; default from the amplitude\n--to (or --at-most, the "
       "smaller one) up to the clearance with "
       "which impacts fail at that amplitude"},
      {"--neighbours", "N",
       filled(
           "how many random deviations a design is checked with; 100 to 1e6,\ndefault {}, under a force {}. "
           "Only the default is raised where it does\nnot decide, up to {} times, under a force {} times",
           otherwise.neighbours, forced_neighbours_of(forced_share), most_enlarged,
           most_enlarged_under_force)},
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
      {"--write-plan", "FILE",
       "write the check of the first design as a plan for impact-damper sweep;\nwith --under-force that of "
       "steady motions"},
      {"--write-decay-plan", "FILE", "with --under-force and --to: that of the decay"},
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
      .options = together({own_options(), scene_options(Stops::ignored, searched()), engine_options()}),
      .footer =
          R"(The scene is that of impact-damper run, a free decay; its secondary mass and clearance are not looked at. Beside a
dimensionless scene lengths are in units of its clearance, masses of the primary mass, times of sqrt(M/K).
Its friction and weight hold secondary masses at small amplitudes, with any clearance: --to must lie above them.
With --dampers each cavity has the friction, the inclination and the drag of the scene's.
Time is counted to the peak of the first half cycle below the amplitude.
Under a force each neighbour has the worst of the steady motions that a sweep of the frequency from rest, rising and
then falling, leads to. Only frequencies are followed at which the component at the force's frequency can exceed
--at-most at all, 49 of them, 25 in the search. Of a motion that does not repeat |x| is the largest of 100 periods; a
longer look and more frequencies raise the worst by some percent. A motion that is not
steady in min(1000, max(200, 1 / damping ratio)) periods does not meet the requirement. A motion that only another beginning
leads to is not seen; impact-damper response basin shows them. Impact speed and wall force are those of the decay.

Each line is the lightest design for a time, the first for the time asked: of its neighbours the time of the slowest,
then the one within which the share of them is down, "nominal", its own time, and how many are within
the time of the line. Speed and force are the largest of all. A line is missing where there is no such design. Exit
code 1: no design was found, or the check of the first did not confirm it: too few neighbours are in
time, or they are too few to decide.

Examples:
  impact-damper design --scene data/examples/mast.json --to 6 --within 10 \
    --tolerance restitution=0.1 --tolerance clearance=10%
  impact-damper design --scene data/examples/machine.json --under-force 5 --frequencies 3.5:5 --at-most 2 \
    --from 20 --to 2 --within 15
  impact-damper design --scene data/examples/mast.json --dampers 6 --to 2 -o boxes.json)",
      .act = design};
}

}  // namespace impact_damper::cli
