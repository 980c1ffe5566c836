// `response`: the steady states of a scene under its force, along one of its numbers or over two, its
// periodic motions, stable or not, and its Lyapunov exponents.
#include <algorithm>
#include <array>
#include <iostream>
#include <map>

#include "commands.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/orbits/variational_equations.hpp"
#include "impact_damper/responses/response_file.hpp"
#include "output.hpp"
#include "progress.hpp"
#include "scene_arguments.hpp"
#include "vary.hpp"

namespace impact_damper::cli {
namespace {

constexpr const char* this_command = "impact-damper response";

enum class Kind { sweep, basin, orbits, lyapunov };
// Options that only some kinds have, and these kinds.
const std::map<std::string, std::vector<Kind>>& kinds_of_options() {
  static const std::map<std::string, std::vector<Kind>> all{
      {"--vary", {Kind::sweep, Kind::basin, Kind::orbits}},
      {"--start", {Kind::sweep, Kind::orbits}},
      {"--nudge", {Kind::sweep}},
      {"--tolerance", {Kind::sweep, Kind::basin, Kind::orbits}},
      {"--longest-period", {Kind::sweep, Kind::basin, Kind::orbits}},
      {"--max-periods", {Kind::sweep, Kind::basin, Kind::orbits}},
      {"--mean-periods", {Kind::sweep}},
      {"--capture-radius", {Kind::basin}},
      {"--largest-step", {Kind::orbits}},
      {"--max-multiplier", {Kind::orbits}},
      {"--max-points", {Kind::orbits}},
      {"--max-branches", {Kind::orbits}},
      {"--periods", {Kind::lyapunov}},
      {"--discard", {Kind::lyapunov}},
      {"--threads", {Kind::sweep, Kind::basin, Kind::orbits}},
  };
  return all;
}
void reject_options_of_others(Arguments& arguments, Kind kind) {
  for (const auto& [option, having] : kinds_of_options()) {
    if (!arguments.given(option) || std::ranges::count(having, kind) > 0) continue;
    std::vector<std::string_view> words;
    for (const Kind each : having) words.push_back(name_of(each));
    arguments.reject(option,
                     "is an option of " + listed(words, "and") + ", not of " + std::string(name_of(kind)));
  }
}

// Engines that can continue a run from one period of the force to the next.
const std::vector<Engine>& offered_engines() {
  static const std::vector<Engine> offered{Exact{}, Restitution{}};
  return offered;
}

// A number that --vary can name, and the size of its dimensionless unit in the unit of the scene's file.
struct Variable {
  SceneNumber number;
  NumberRange range{};  // dimensionless
  double scale = 1;
};
using Variables = std::map<std::string, Variable, std::less<>>;

// Returns the numbers of a scene by name; those of a scene in units also by their names in its file.
Variables variables_of(const Scene& scene, const std::optional<Scales>& scales) {
  Variables variables;
  for (const auto& [name, number, least, most] : numbers_of(scene)) {
    const std::string_view its = field_of(number).name;
    variables[name] = {number, within(least, most)};
    for (const UnitField& field : unit_fields)
      if (scales && field.becomes == its && field.dimension != Dimension::ratio)
        variables[std::string(field.name) + name.substr(its.size())] = {number, within(least, most),
                                                                        scales->of(field.dimension)};
  }
  return variables;
}

// The number that --vary names, and the text of its values. number_of() rejects an unknown name.
struct VariedNumber {
  Variable variable;
  std::optional<std::string> values;
};
std::optional<VariedNumber> number_of(Arguments& arguments, const std::string& text,
                                      const Variables& variables) {
  std::vector<std::string_view> names;
  for (const auto& [name, ignored] : variables) names.push_back(name);
  const auto varied = varied_of(arguments, text, names);
  if (!varied) return std::nullopt;
  return VariedNumber{variables.find(names[varied->index])->second, varied->values};
}

std::optional<Axis> axis_of(Arguments& arguments, const std::string& text, const Variables& variables) {
  const auto varied = number_of(arguments, text, variables);
  if (!varied) return std::nullopt;
  const auto& [variable, values] = *varied;
  const auto range = values ? parse_triple(*values) : std::nullopt;
  if (!range || !(range->first < range->second) || !(range->count >= 2 && range->count <= most_values)) {
    arguments.reject("--vary", "must be NAME=FROM:TO:N with FROM < TO and 2 to " +
                                   std::to_string(most_values) + " values, got " + in_quotes(text));
    return std::nullopt;
  }
  const NumberRange& allowed = variable.range;
  for (const double end : {range->first, range->second}) {
    if (allowed.allows(end / variable.scale)) continue;
    arguments.reject(
        "--vary",
        "values of " + text.substr(0, text.find('=')) + " must be " +
            within(allowed.least * variable.scale, allowed.most * variable.scale).describe("numbers") +
            ", got " + number_text(end));
    return std::nullopt;
  }
  return Axis{variable.number, range->first / variable.scale, range->second / variable.scale, range->count};
}

std::vector<Axis> axes_of(Arguments& arguments, const Variables& variables, bool is_sweep) {
  std::vector<Axis> axes;
  const std::vector<std::string> given = arguments.texts("--vary");
  const std::size_t needed = is_sweep ? 1 : 2;
  if (given.size() != needed) {
    arguments.reject("--vary", "must be given " +
                                   std::string(is_sweep ? "once for a sweep" : "twice for a basin") +
                                   ", as NAME=FROM:TO:N, got " + std::to_string(given.size()));
    return axes;
  }
  for (const std::string& text : given)
    if (const auto axis = axis_of(arguments, text, variables)) axes.push_back(*axis);
  if (axes.size() != needed) return axes;
  if (is_sweep && is_initial_value(axes[0].number)) {
    arguments.reject("--vary",
                     "must not vary an initial condition: a sweep goes on from the motion before; got " +
                         in_quotes(given[0]));
  } else if (!is_sweep && axes[0].number == axes[1].number) {
    arguments.reject("--vary", "must be two different numbers, got " + in_quotes(given[0]) + " and " +
                                   in_quotes(given[1]));
  } else if (!is_sweep && axes[0].count * axes[1].count > most_rows) {
    arguments.reject("--vary", "must give at most " + std::to_string(most_rows) + " points, got " +
                                   std::to_string(axes[0].count * axes[1].count));
  }
  return axes;
}

// Reads NAME=FROM:TO, the range along which orbits are followed.
std::optional<ParameterRange> range_of(Arguments& arguments, const Variables& variables) {
  const std::vector<std::string> given = arguments.texts("--vary");
  if (given.size() != 1) {
    arguments.reject("--vary",
                     "must be given once for orbits, as NAME=FROM:TO, got " + std::to_string(given.size()));
    return std::nullopt;
  }
  const auto varied = number_of(arguments, given[0], variables);
  if (!varied) return std::nullopt;
  const auto& [variable, values] = *varied;
  ParameterRange range;
  if (variable.number.is(member_of(Parameter::force_amplitude))) {
    range.parameter = Parameter::force_amplitude;
  } else if (!variable.number.is(member_of(range.parameter))) {
    arguments.reject("--vary",
                     "must be frequency or amplitude of the force for orbits, got " + in_quotes(given[0]));
    return std::nullopt;
  }
  const std::size_t colon = values ? values->find(':') : std::string::npos;
  const auto from = colon == std::string::npos ? std::nullopt : parse_number(values->substr(0, colon)),
             to = colon == std::string::npos ? std::nullopt : parse_number(values->substr(colon + 1));
  if (!from || !to || !(*from > 0 && *to > 0) || *from == *to) {
    arguments.reject("--vary", "must be NAME=FROM:TO for orbits, with two different numbers > 0, got " +
                                   in_quotes(given[0]));
    return std::nullopt;
  }
  range.from = *from / variable.scale;
  range.to = *to / variable.scale;
  return range;
}

// Reads X:V:Y:W in the units of the scene's file; with a list of dampers X:V, the dampers starting as in the
// scene.
std::optional<SceneState> parse_state(std::string_view text, const SceneFile& file) {
  const std::size_t count = has_one_damper(file.scene) ? 4 : 2;
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t colon = text.find(':');
    if ((colon == std::string_view::npos) != (i + 1 == count)) return std::nullopt;
    const auto number = parse_number(text.substr(0, colon));
    if (!number) return std::nullopt;
    numbers[i] = *number / scale_of(i % 2 == 0 ? Dimension::length : Dimension::velocity, file.scales);
    text = colon == std::string_view::npos ? "" : text.substr(colon + 1);
  }
  SceneState state = State<double>{numbers[0], numbers[1], numbers[2], numbers[3]};
  if (count == 2) state.dampers = release_of(file.scene).dampers;
  return state;
}

// Returns the scene's own release, then the starts of --start.
std::vector<SceneState> starts_of(Arguments& arguments, const SceneFile& file) {
  std::vector<SceneState> starts{release_of(file.scene)};
  for (const std::string& text : arguments.texts("--start")) {
    const auto start = parse_state(text, file);
    if (start) {
      starts.push_back(*start);
      for (const Problem& problem : problems_of(released_from(file.scene, *start)))
        arguments.reject("--start", problem.field + " " + problem.message);
    } else {
      arguments.reject("--start", (has_one_damper(file.scene) ? "must be four numbers X0:V0:Y0:W0, got "
                                                              : "must be two numbers X0:V0, got ") +
                                      in_quotes(text));
    }
  }
  return starts;
}

// Returns the shift of x, dimensionless.
double nudge_of(Arguments& arguments, const SceneFile& file) {
  const auto nudge = arguments.number("--nudge", nudges);
  if (nudge && !arguments.given("--start"))
    arguments.reject("--nudge", "parts the sweeps of several starts: needs --start");
  return nudge.value_or(0) / scale_of(Dimension::length, file.scales);
}

SteadyRule rule_of(Arguments& arguments, SteadyRule rule) {
  rule.tolerance = arguments.number("--tolerance", {0, 1e-2, false}).value_or(rule.tolerance);
  rule.longest_period =
      arguments.whole_number("--longest-period", within(1, 64)).value_or(rule.longest_period);
  rule.max_periods = arguments.whole_number("--max-periods", within(1, 1e9)).value_or(rule.max_periods);
  rule.mean_periods = arguments.whole_number("--mean-periods", within(10, 1e6)).value_or(rule.mean_periods);
  return rule;
}

BranchRule branch_rule_of(Arguments& arguments, const SteadyRule& steady) {
  BranchRule rule;
  rule.steady = steady;
  rule.largest_step = arguments.number("--largest-step", within(1e-6, 1e6)).value_or(rule.largest_step);
  rule.max_multiplier = arguments.number("--max-multiplier", within(1, 1e12)).value_or(rule.max_multiplier);
  rule.max_points = arguments.whole_number("--max-points", within(1, 1e6)).value_or(rule.max_points);
  rule.max_branches = arguments.whole_number("--max-branches", within(1, 1000)).value_or(rule.max_branches);
  return rule;
}

// Periods of the force over which the exponents are averaged, and those before that are discarded.
struct Averaging {
  std::int64_t periods = 5000, discard = 500;
};
Averaging averaging_of(Arguments& arguments) {
  Averaging averaging;
  averaging.periods = arguments.whole_number("--periods", within(10, 1e9)).value_or(averaging.periods);
  averaging.discard = arguments.whole_number("--discard", within(0, 1e9)).value_or(averaging.discard);
  return averaging;
}

// Shows how many parts are done; called from several threads.
class Progress {
 public:
  // all: number of parts; absent if it is not known.
  Progress(const char* what, std::optional<std::int64_t> all) : what_(what), all_(all) {}
  void operator()(std::int64_t done) {
    told_(std::to_string(done) + (all_ ? " of " + std::to_string(*all_) : "") + " " + what_);
  }

 private:
  const char* what_;
  std::optional<std::int64_t> all_;
  ProgressOnStderr told_{"response"};
};

void warn(const std::string& what) { std::cerr << this_command << ": warning: " << what << '\n'; }
std::string of_all(std::int64_t count, std::size_t all, const char* what) {
  return std::to_string(count) + " of " + std::to_string(all) + " " + what;
}

void warn_of(const std::vector<Sweep>& sweeps, const SteadyRule& rule) {
  std::int64_t open = 0, ended = 0;
  std::size_t all = 0;
  for (const Sweep& sweep : sweeps) {
    for (const auto* way : {&sweep.up, &sweep.down}) {
      all += way->size();
      for (const SteadyState& each : *way) {
        ended += each.stop_reason != StopReason::time;
        open += each.stop_reason == StopReason::time && !each.period;
      }
    }
  }
  if (open > 0)
    warn(of_all(open, all, "motions") + " are not periodic within " + std::to_string(rule.max_periods) +
         " periods of the force, which --max-periods raises; theirs are the largest amplitude, the mean "
         "powers and all impacts of " +
         std::to_string(rule.mean_periods) + " periods");
  if (ended > 0)
    warn(of_all(ended, all, "motions") +
         " ended early, by a budget of the engine that \"end\" names; --max-impacts, --max-steps or "
         "--max-time raises it");
}

void warn_of(const Basin& basin, const SteadyRule& rule) {
  const auto open = std::ranges::count(basin.attractor, undecided) - basin.stopped;
  if (open > 0)
    warn(of_all(open, basin.attractor.size(), "points") + " are undecided within " +
         std::to_string(rule.max_periods) + " periods of the force; --max-periods raises that");
  if (basin.stopped > 0)
    warn(of_all(basin.stopped, basin.attractor.size(), "points") +
         " are undecided because a budget of the engine ended them; --max-impacts, --max-steps or --max-time "
         "raises it");
}

void warn_of(const Branches& found, const BranchRule& rule) {
  std::int64_t open = 0, ended = 0;
  for (const BranchStart& start : found.starts) {
    const bool is_ended = start.steady.stop_reason != StopReason::time;
    ended += is_ended;
    open += !is_ended && !start.orbit;
    if (start.orbit == OrbitEnd::no_derivative)
      warn(
          "several masses meet walls at one instant, so their motion has no multipliers: give those that "
          "move "
          "alike as one with the sum of their masses, or release them apart");
    else if (start.orbit && *start.orbit != OrbitEnd::converged)
      warn("no periodic orbit is found near a motion that repeats: " + std::string(end_of(start)));
  }
  const std::size_t all = found.starts.size();
  if (open > 0)
    warn(of_all(open, all, "starts") + " are not periodic within " + std::to_string(rule.steady.max_periods) +
         " periods of the force, so no branch begins there; --max-periods raises that, --start adds others");
  if (ended > 0)
    warn(of_all(ended, all, "starts") +
         " ended early, by a budget of the engine that \"end\" names; --max-impacts, --max-steps or "
         "--max-time raises it");
  const auto ends = [&](BranchEnd end) {
    return std::ranges::count(found.branches, end,
                              [](const FollowedBranch& each) { return each.branch.end; });
  };
  const std::size_t branches = found.branches.size();
  if (const auto count = ends(BranchEnd::points); count > 0)
    warn(of_all(count, branches, "branches") + " end after " + std::to_string(rule.max_points) +
         " points; --max-points or --largest-step raises that");
  if (const auto count = ends(BranchEnd::step_too_small); count > 0)
    warn(of_all(count, branches, "branches") + " end where no orbit is found near enough to the last");
  if (const auto count = ends(BranchEnd::coincidence); count > 0)
    warn(of_all(count, branches, "branches") +
         " end where two masses meet walls at one instant: who is first decides what follows");
  if (!found.complete)
    warn("there are more than " + std::to_string(rule.max_branches) +
         " branches; --max-branches raises that");
}

// numbers: dimension of the state.
void warn_of(const LyapunovExponents& found, std::size_t numbers) {
  if (found.stop_reason != StopReason::time)
    warn("there are no exponents: the run ended early, by " + std::string(name_of(found.stop_reason)) +
         "; --max-impacts, --max-steps or --max-time raises it");
  if (const std::size_t given = found.exponents.size(); 0 < given && given < numbers)
    warn(std::to_string(given) + " of " + std::to_string(numbers) +
         " exponents are given: the others are minus infinity, because masses stick, or too far below to be "
         "found");
  if (found.one_sided)
    warn("several masses meet walls at one instant: the exponents are of changes that keep them together");
}

// The request of the command line, checked.
struct Request {
  Kind kind = Kind::sweep;
  SceneFile file;
  Engine engine;
  std::vector<Axis> axes;               // sweep: one, basin: two
  std::optional<ParameterRange> range;  // orbits
  std::vector<SceneState> starts;
  double nudge = 0;  // sweep
  SteadyRule sweep;
  BasinRule basin;
  BranchRule orbits;
  Averaging averaging;
  Threads threads;
  Format format = Format::json;
  bool in_si = false;  // the CSV
  bool quiet = false;
};

Response swept(const Request& asked) {
  const Scene& scene = asked.file.scene;
  const Axis& axis = asked.axes[0];
  Progress progress("motions", 2 * axis.count * std::int64_t(asked.starts.size()));
  const auto sweeps = sweep(scene, asked.engine, axis, asked.sweep, nudged(asked.starts, asked.nudge),
                            asked.threads, [&](std::int64_t done) { progress(done); });
  if (!asked.quiet) warn_of(sweeps, asked.sweep);
  return SweepResponse{scene, asked.engine, asked.sweep, axis, sweeps};
}

Response mapped(const Request& asked) {
  const Scene& scene = asked.file.scene;
  const Axis &first = asked.axes[0], &second = asked.axes[1];
  Progress progress("points", first.count * second.count);
  const Basin map = basin(scene, asked.engine, first, second, asked.basin, asked.threads,
                          [&](std::int64_t done) { progress(done); });
  if (!asked.quiet) warn_of(map, asked.basin.steady);
  return BasinResponse{scene, asked.engine, asked.basin, first, second, map};
}

Response followed(const Request& asked) {
  const Scene& scene = asked.file.scene;
  Progress progress("branches are followed", std::nullopt);
  const Branches found = find_branches(scene, asked.engine, *asked.range, asked.orbits, asked.starts,
                                       asked.threads, [&](std::int64_t done) { progress(done); });
  if (!asked.quiet) warn_of(found, asked.orbits);
  return orbits_response(scene, asked.engine, asked.orbits, *asked.range, found);
}

Response averaged(const Request& asked) {
  const Scene& scene = asked.file.scene;
  const auto [periods, discard] = asked.averaging;
  Progress progress("periods", periods + discard);
  const LyapunovExponents found =
      lyapunov_exponents(scene, asked.engine, periods, discard, [&](std::int64_t done) {
        if (done % 100 == 0 || !has_one_damper(scene)) progress(done);
      });
  if (!asked.quiet) warn_of(found, dimensions_of(scene));
  return LyapunovResponse{scene, asked.engine, periods, discard, found};
}

Response found_for(const Request& asked) {
  switch (asked.kind) {
    case Kind::sweep:
      return swept(asked);
    case Kind::basin:
      return mapped(asked);
    case Kind::orbits:
      return followed(asked);
    case Kind::lyapunov:
      return averaged(asked);
  }
  return {};
}

std::string text_of(const Request& asked) {
  const Response found = found_for(asked);
  return asked.format == Format::csv ? response_csv(found, asked.in_si ? asked.file.scales : std::nullopt)
                                     : response_text(found, asked.file.scales);
}

// Returns text_of(). A problem of a value of --vary names that option, not one that was not given.
std::string text_of_valid(const Request& asked) {
  try {
    return text_of(asked);
  } catch (const InvalidArguments& error) {
    std::vector<Problem> problems = error.problems();
    for (Problem& each : problems)
      for (const Axis& axis : asked.axes)
        if (each.field == name_of(axis.number)) each = {"vary", each.field + " " + each.message};
    throw InvalidArguments(std::move(problems));
  }
}

int respond(Arguments& arguments) {
  const std::vector<std::string_view> words = words_of<Kind>();
  const std::optional<std::size_t> word = arguments.word("WHAT", words);
  if (!arguments.given("WHAT")) arguments.reject("WHAT", "must be given: " + listed(words, "or"));
  Request asked;
  asked.kind = all_of<Kind>.begin()[word.value_or(0)];
  asked.file = scene_of(arguments, Stops::ignored);
  asked.engine = engine_of(arguments, offered_engines());
  asked.starts = starts_of(arguments, asked.file);
  asked.nudge = nudge_of(arguments, asked.file);
  if (asked.kind == Kind::basin) {
    asked.basin.steady = rule_of(arguments, asked.basin.steady);
  } else {
    asked.sweep = rule_of(arguments, asked.sweep);
  }
  asked.basin.capture_radius =
      arguments.number("--capture-radius", {0, 0.5, false}).value_or(asked.basin.capture_radius);
  asked.orbits = branch_rule_of(arguments, asked.sweep);
  asked.averaging = averaging_of(arguments);
  if (word) {
    reject_options_of_others(arguments, asked.kind);
    const Variables variables = variables_of(asked.file.scene, asked.file.scales);
    if (asked.kind == Kind::orbits) {
      asked.range = range_of(arguments, variables);
    } else if (asked.kind != Kind::lyapunov) {
      asked.axes = axes_of(arguments, variables, asked.kind == Kind::sweep);
    }
  }
  const auto output = arguments.file("--output");
  arguments.reject_overwriting("--output", output, {arguments.text("--scene").value_or("")});
  asked.format = format_of(arguments, output, {Format::json, Format::csv});
  asked.in_si = arguments.flag("--si");
  if (asked.in_si && asked.format != Format::csv)
    arguments.reject(
        "--si", "is for --format csv; the JSON file is dimensionless, its units say what a unit is in SI");
  if (asked.in_si && !asked.file.scales) arguments.reject("--si", "needs a scene in units, by --scene");
  asked.threads = threads_of(arguments);
  asked.quiet = arguments.flag("--quiet");
  arguments.finish();
  prepare_output(output);
  if (!asked.quiet) warn_of_cautions(this_command, asked.file.scene, asked.file.scales);
  write_output(output,
               saying_options([&] { return text_of_valid(asked); }, arguments.text("--scene").value_or("")));
  return 0;
}

Options own_options() {
  Options options;
  const auto add = [&](const std::string& name, const std::string& type, const std::string& help,
                       const std::string& group, Option::Takes takes = Option::Takes::value) {
    options.push_back({name, type, help, group, takes});
  };
  const SteadyRule steady;
  const BasinRule basin;
  const BranchRule orbits;
  const Averaging averaging;
  add("--vary", "NAME=FROM:TO:N",
      "the number of the scene that takes N equally spaced values, both\nends included: mass_ratio, "
      "force_amplitude, force_frequency, ...,\nclearance_2 of the second of several dampers; beside a scene "
      "in units\nalso by its name there, in its unit: exciting_frequency=4:6:101 in Hz.\nOnce for a sweep, "
      "twice for a basin. For orbits NAME=FROM:TO,\nfrequency or amplitude of the force; they begin at FROM, "
      "which may be\nthe larger one",
      "Response", Option::Takes::repeated_value);
  add("--start", "X0:V0:Y0:W0",
      "sweep, orbits: one more that begins there beside the scene's\nrelease, in mm and mm/s beside a "
      "scene in units; may be repeated. Of several\ndampers X0:V0",
      "Response", Option::Takes::repeated_value);
  add("--nudge", "X",
      "sweep: n times this is added to x of the sweep from the n-th --start\nat each value but its "
      "first; parts sweeps that a stable motion has\nbrought together. > 0 and <= 1, in mm beside a scene in "
      "units",
      "Response");
  add("--tolerance", "X",
      "a motion is periodic when the estimated distance to what it repeats\nis below this; > 0 and <= 0.01, "
      "default " +
          number_text(steady.tolerance),
      "Response");
  add("--longest-period", "M",
      "longest period that is looked for, in periods of the force; 1 to\n64, default " +
          std::to_string(steady.longest_period),
      "Response");
  add("--max-periods", "N",
      "periods of the force after which a motion counts as not periodic;\ndefault " +
          std::to_string(steady.max_periods) + ", in a basin " + std::to_string(basin.steady.max_periods),
      "Response");
  add("--mean-periods", "N",
      "sweep: over so many periods a motion that is not periodic is\naveraged; 10 to 1e6, default " +
          std::to_string(steady.mean_periods),
      "Response");
  add("--capture-radius", "R",
      "basin over two initial values: a point ends in a known motion when\nit is so near to it and comes "
      "nearer; > 0 and <= 0.5, default " +
          number_text(basin.capture_radius),
      "Response");
  add("--largest-step", "H",
      "orbits: largest distance of two points of a branch in the space of\nx, x', y, y' and the number that "
      "varies, dimensionless; a step also\nchanges that number by at most a hundredth of its range; "
      "default " +
          number_text(orbits.largest_step),
      "Response");
  add("--max-multiplier", "X",
      "orbits: a branch ends where a multiplier, times the least speed of an\nimpact if that is below 1, is "
      "larger; 1 to 1e12, default " +
          number_text(orbits.max_multiplier),
      "Response");
  add("--max-points", "N",
      "orbits: points of a branch; 1 to 1e6, default " + std::to_string(orbits.max_points), "Response");
  add("--max-branches", "N",
      "orbits: how many branches are followed; 1 to 1000, default " + std::to_string(orbits.max_branches),
      "Response");
  add("--periods", "N",
      "lyapunov: periods of the force over which the exponents are\naveraged; 10 to 1e9, default " +
          std::to_string(averaging.periods),
      "Response");
  add("--discard", "N",
      "lyapunov: periods of the force before these; 0 to 1e9, default " + std::to_string(averaging.discard),
      "Response");
  add("--format", "NAME", "json (default) or csv, one table", "Output");
  add("--si", "",
      "csv of a scene in units: columns in SI, as their names say\n(amplitude_m, force_frequency_Hz)",
      "Output", Option::Takes::nothing);
  add("-o,--output", "FILE", "write there instead of to stdout", "Output");
  add("--quiet", "", "no warnings, such as of motions that are not periodic", "Output",
      Option::Takes::nothing);
  options.push_back(threads_option());
  options.back().group = "Output";
  options.back().help += ";\nnot for lyapunov";
  return options;
}

}  // namespace

Command response_command() {
  Command command{.name = "response",
                  .description =
                      "Find the steady motions of a scene under its force: along one number, or "
                      "as a map over two; its periodic motions, stable or not, and its Lyapunov exponents."};
  command.options = {{"WHAT", "sweep|basin|orbits|lyapunov",
                      "the steady motions along a number, or a map over two; branches of periodic motions; "
                      "Lyapunov exponents"}};
  for (const Options& options :
       {own_options(), scene_options(Stops::ignored), engine_options(offered_engines())})
    command.options.insert(command.options.end(), options.begin(), options.end());
  command.footer =
      "The scene is that of impact-damper run, with a force f0 sin(omega_f t). The budgets of the engine "
      "hold "
      "for each of\nits runs, of eight periods of the force while a motion settles.\n\n"
      "sweep: at each value the motion goes on until it repeats: amplitude, phase, power, impacts and period "
      "of "
      "the steady\nmotion. The next value begins where this one ended: first upwards, then back down. Where "
      "two "
      "motions are possible\nthe two ways differ. Beside them stand the amplitudes without the secondary "
      "mass "
      "and "
      "with it locked to its box.\n\n"
      "basin: in which steady motion each point of a map ends, the points being initial values (x0, v0, y0, "
      "w0) "
      "or other\nnumbers of the scene.\n\n"
      "orbits: the branch of periodic motions on which the steady motion at FROM lies, followed past folds "
      "through stable\nand unstable motions, with their multipliers, and the branches that begin at its "
      "flips "
      "and where it loses its symmetry.\nWhere it ends in a grazing, simulation leads on.\n\n"
      "lyapunov: at what rates small changes of the state grow or decay along a run from the scene's "
      "release, "
      "with their\nstandard errors, in units of 1/time.\n\n"
      "Examples:\n"
      "  impact-damper response sweep --mass-ratio 0.05 --damping-ratio 0.005 --force-amplitude 0.02 \\\n"
      "    --x0 0 --vary force_frequency=0.9:1.1:201 --format csv -o sweep.csv\n"
      "  impact-damper response sweep --scene data/examples/mast_in_wind.json \\\n"
      "    --vary exciting_frequency=2.9:3.5:61 --format csv --si -o wind.csv\n"
      "  impact-damper response basin --mass-ratio 0.1 --damping-ratio 0.01 --force-amplitude 0.05 \\\n"
      "    --force-frequency 0.9 --y0 0.5 --engine restitution --vary x0=-1:1:200 --vary v0=-1:1:200 -o "
      "map.json\n"
      "  impact-damper response orbits --scene data/examples/mast_in_wind.json \\\n"
      "    --vary exciting_frequency=3.08:3.3 --format csv --si -o orbits.csv\n"
      "  impact-damper response lyapunov --mass-ratio 0.05 --damping-ratio 0.01 --force-amplitude 0.3 \\\n"
      "    --force-frequency 0.9 --periods 20000";
  command.act = respond;
  return command;
}

}  // namespace impact_damper::cli
