// `response`: the steady states of a scene under its force, along one of its numbers or over two, its
// periodic motions, stable or not, and its Lyapunov exponents.
#include <algorithm>
#include <array>
#include <iostream>
#include <map>
#include <tuple>

#include "commands.hpp"
#include "impact_damper/orbits/variational_equations.hpp"
#include "impact_damper/responses/response_file.hpp"

namespace impact_damper::cli {
namespace {

constexpr const char* this_command = "impact-damper response";

enum class Kind { sweep, basin, orbits, lyapunov };
constexpr std::initializer_list<Kind> not_lyapunov{Kind::sweep, Kind::basin, Kind::orbits};

// Periods of the force over which the exponents are averaged, and those before that are discarded.
struct Averaging {
  std::int64_t periods = 5000, discard = 500;
};

// The request of the command line, checked.
struct Request {
  Kind kind = Kind::sweep;
  SceneFile file;
  Engine engine;
  std::vector<Axis> axes;               // sweep: one, basin: two
  std::optional<ParameterRange> range;  // orbits
  std::vector<SceneState> starts;
  double nudge = 0;  // sweep
  std::tuple<SteadyRule, BasinRule, BranchRule, Averaging> rules;
  Threads threads;
  Format format = Format::json;
  bool in_si = false;  // the CSV
  bool quiet = false;
};

// An option that only some kinds have.
struct OptionOfKinds {
  Option option;
  std::vector<Kind> kinds;
  std::function<void(Arguments&, Request&)> read{};  // where its number stands in the request as given
};

// Returns the option for a number of a rule; the help has {} for its default.
template <class Rule, class Value>
OptionOfKinds number(const std::string& name, const std::string& type, const std::string& help,
                     std::vector<Kind> kinds, NumberRange range, Value Rule::*member) {
  return {{name, type, with_values(help, {value_text(Rule{}.*member)})},
          std::move(kinds),
          [=](Arguments& arguments, Request& asked) {
            arguments.read(name, std::get<Rule>(asked.rules).*member, range);
          }};
}

const std::vector<OptionOfKinds>& options_of_kinds() {
  static const std::vector<OptionOfKinds> all{
      {repeated_option(
           "--vary", "NAME=FROM:TO:N",
           "the number of the scene that takes N equally spaced values, both\nends included: mass_ratio, "
           "force_amplitude, force_frequency, ...,\nclearance, clearance_2 of the second of several dampers; "
           "beside a "
           "scene in units\nalso by its name there, with units: exciting_frequency=4Hz:6Hz:101.\nOnce for "
           "a sweep, twice for a basin. For orbits NAME=FROM:TO,\nfrequency or amplitude of the force; they "
           "begin at FROM, which may be\nthe larger one"),
       not_lyapunov},
      {repeated_option("--start", "X0:V0:Y0:W0",
                       "sweep, orbits: one more that begins there beside the scene's\nrelease, beside a "
                       "scene in units 1mm:0:5mm:20mm/s; may be repeated. Of several\ndampers X0:V0"),
       {Kind::sweep, Kind::orbits}},
      {{"--nudge", "X",
        "sweep: n times this is added to x of the sweep from the n-th --start\nat each value but its first; "
        "parts sweeps that a stable motion has\nbrought together. > 0 and <= 1, in mm beside a scene in "
        "units"},
       {Kind::sweep}},
      number("--tolerance", "X",
             "a motion is periodic when the estimated distance to what it repeats\nis below this; > 0 and <= "
             "0.01, default {}",
             not_lyapunov, {0, 1e-2, false}, &SteadyRule::tolerance),
      number("--longest-period", "M",
             "longest period that is looked for, in periods of the force; 1 to\n64, default {}", not_lyapunov,
             within(1, 64), &SteadyRule::longest_period),
      number("--max-periods", "N",
             "periods of the force after which a motion counts as not periodic;\ndefault {}, in a basin " +
                 std::to_string(BasinRule{}.steady.max_periods),
             not_lyapunov, within(1, 1e9), &SteadyRule::max_periods),
      number("--mean-periods", "N",
             "sweep: over so many periods a motion that is not periodic is\naveraged; 10 to 1e6, default {}",
             {Kind::sweep}, within(10, 1e6), &SteadyRule::mean_periods),
      number("--capture-radius", "R",
             "basin over two initial values: a point ends in a known motion when\nit is so near to it and "
             "comes nearer; > 0 and <= 0.5, default {}",
             {Kind::basin}, {0, 0.5, false}, &BasinRule::capture_radius),
      number(
          "--largest-step", "H",
          "orbits: largest distance of two points of a branch in the space of\nx, x', y, y' and the number "
          "that varies, dimensionless; a step also\nchanges that number by at most a hundredth of its "
          "range; default {}",
          {Kind::orbits}, within(1e-6, 1e6), &BranchRule::largest_step),
      number("--max-multiplier", "X",
             "orbits: a branch ends where a multiplier, times the least speed of an\nimpact if that is below "
             "1, is larger; 1 to 1e12, default {}",
             {Kind::orbits}, within(1, 1e12), &BranchRule::max_multiplier),
      number("--max-points", "N", "orbits: points of a branch; 1 to 1e6, default {}", {Kind::orbits},
             within(1, 1e6), &BranchRule::max_points),
      number("--max-branches", "N", "orbits: how many branches are followed; 1 to 1000, default {}",
             {Kind::orbits}, within(1, 1000), &BranchRule::max_branches),
      number("--periods", "N",
             "lyapunov: periods of the force over which the exponents are\naveraged; 10 to 1e9, default {}",
             {Kind::lyapunov}, within(10, 1e9), &Averaging::periods),
      number("--discard", "N", "lyapunov: periods of the force before these; 0 to 1e9, default {}",
             {Kind::lyapunov}, within(0, 1e9), &Averaging::discard)};
  return all;
}

// Reads the numbers of the options that only some kinds have.
void read_numbers(Arguments& arguments, Request& asked) {
  auto& [steady, basin, orbits, averaging] = asked.rules;
  if (asked.kind == Kind::basin) steady = basin.steady;
  for (const OptionOfKinds& each : options_of_kinds())
    if (each.read) each.read(arguments, asked);
  basin.steady = orbits.steady = steady;
}

void reject_options_of_others(Arguments& arguments, Kind kind) {
  const auto reject_of_others = [&](const std::string& option, const std::vector<Kind>& kinds) {
    if (!arguments.given(option) || std::ranges::count(kinds, kind) > 0) return;
    const auto words = texts_of(kinds, [](Kind each) { return name_of(each); });
    arguments.reject(option, filled("is an option of {}, not of {}", listed(words, "and"), name_of(kind)));
  };
  for (const OptionOfKinds& each : options_of_kinds()) reject_of_others(each.option.name, each.kinds);
  reject_of_others("--threads", not_lyapunov);
}

// Engines that can continue a run from one period of the force to the next.
const std::vector<Engine>& offered_engines() {
  static const std::vector<Engine> offered{Exact{}, Restitution{}};
  return offered;
}

// A number that --vary can name.
struct Variable {
  SceneNumber number;
  NumberRange range{};  // dimensionless
  Dimension dimension = Dimension::ratio;
  std::optional<Scales> scales{};

  double scale() const { return scale_of(dimension, scales); }
  QuantityReader reader() const { return {.dimension = dimension, .scales = scales}; }
};
using Variables = std::map<std::string, Variable, std::less<>>;

// Returns the numbers of a scene by name; those of a scene in units also by their names in its file, and
// those of the only damper of a list without its number, too.
Variables variables_of(const Scene& scene, const std::optional<Scales>& scales) {
  Variables variables;
  for (const NamedSceneNumber& each : numbers_of(scene)) {
    const SceneField& its = field_of(each.number);
    const std::string of_damper = each.name.substr(its.name.size());  // "_1"
    const auto add = [&](std::string_view key, Dimension dimension) {
      const Variable variable{each.number, within(each.least, each.most), dimension, scales};
      variables[std::string(key) + of_damper] = variable;
      if (scene.dampers.size() == 1) variables[std::string(key)] = variable;
    };
    add(its.name, its.dimension);
    for (const UnitField& field : unit_fields)
      if (scales && field.becomes == its.name && field.dimension != Dimension::ratio && !its.component)
        add(field.name, field.dimension);
  }
  return variables;
}

// Returns the number that --vary names, and the text of its values. Rejects an unknown name.
std::optional<std::pair<Variable, std::optional<std::string>>> number_of(Arguments& arguments,
                                                                         const std::string& text,
                                                                         const Variables& variables) {
  const auto names = texts_of(variables, &Variables::value_type::first);
  const auto varied = varied_of(arguments, text, names);
  if (!varied) return std::nullopt;
  return std::pair(variables.find(names[varied->index])->second, varied->values);
}

std::optional<Axis> axis_of(Arguments& arguments, const std::string& text, const Variables& variables) {
  const auto varied = number_of(arguments, text, variables);
  if (!varied) return std::nullopt;
  const auto& [variable, values] = *varied;
  QuantityReader read = variable.reader();
  const auto range = values ? parse_triple(*values, read) : std::nullopt;
  if (!read.problem.empty()) {
    arguments.reject("--vary", text.substr(0, text.find('=')) + ": " + read.problem);
    return std::nullopt;
  }
  if (!range || !(range->first < range->second) || !(range->count >= 2 && range->count <= most_values)) {
    arguments.reject("--vary", filled("must be NAME=FROM:TO:N with FROM < TO and 2 to {} values, got {}",
                                      most_values, in_quotes(text)));
    return std::nullopt;
  }
  const NumberRange& allowed = variable.range;
  for (const double end : {range->first, range->second}) {
    if (allowed.allows(end / variable.scale())) continue;
    const NumberRange in_its_unit = within(allowed.least * variable.scale(), allowed.most * variable.scale());
    arguments.reject("--vary", filled("values of {} must be {}, got {}", text.substr(0, text.find('=')),
                                      in_its_unit.describe("numbers"), end));
    return std::nullopt;
  }
  return Axis{variable.number, range->first / variable.scale(), range->second / variable.scale(),
              range->count};
}

std::vector<Axis> axes_of(Arguments& arguments, const Variables& variables, bool is_sweep) {
  std::vector<Axis> axes;
  const std::vector<std::string> given = arguments.texts("--vary");
  const std::size_t needed = is_sweep ? 1 : 2;
  if (given.size() != needed) {
    arguments.reject("--vary", filled("must be given {}, as NAME=FROM:TO:N, got {}",
                                      is_sweep ? "once for a sweep" : "twice for a basin", given.size()));
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
    arguments.reject("--vary", filled("must be two different numbers, got {} and {}", in_quotes(given[0]),
                                      in_quotes(given[1])));
  } else if (!is_sweep && axes[0].count * axes[1].count > most_rows) {
    arguments.reject("--vary",
                     filled("must give at most {} points, got {}", most_rows, axes[0].count * axes[1].count));
  }
  return axes;
}

// Reads NAME=FROM:TO, the range along which orbits are followed.
std::optional<ParameterRange> range_of(Arguments& arguments, const Variables& variables) {
  const std::vector<std::string> given = arguments.texts("--vary");
  if (given.size() != 1) {
    arguments.reject("--vary",
                     filled("must be given once for orbits, as NAME=FROM:TO, got {}", given.size()));
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
  QuantityReader read = variable.reader();
  const auto ends = numbers_of(values.value_or(""), ':', read);
  if (!read.problem.empty()) {
    arguments.reject("--vary", given[0].substr(0, given[0].find('=')) + ": " + read.problem);
    return std::nullopt;
  }
  if (!ends || ends->size() != 2 || !((*ends)[0] > 0 && (*ends)[1] > 0) || (*ends)[0] == (*ends)[1]) {
    arguments.reject("--vary", "must be NAME=FROM:TO for orbits, with two different numbers > 0, got " +
                                   in_quotes(given[0]));
    return std::nullopt;
  }
  range.from = (*ends)[0] / variable.scale();
  range.to = (*ends)[1] / variable.scale();
  return range;
}

// Reads X:V:Y:W, with a list of dampers X:V, the dampers starting as in the scene. Sets `problem` where a
// number lacks its unit.
std::optional<SceneState> parse_state(std::string_view text, const SceneFile& file, std::string& problem) {
  const std::size_t count = has_one_damper(file.scene) ? 4 : 2;
  const auto parts = parts_of(text, ':');
  if (parts.size() != count) return std::nullopt;
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < count; ++i) {
    QuantityReader read{.dimension = i % 2 == 0 ? Dimension::length : Dimension::velocity,
                        .scales = file.scales};
    const auto number = read(parts[i]);
    if (!number) {
      problem = read.problem;
      return std::nullopt;
    }
    numbers[i] = *number / scale_of(read.dimension, file.scales);
  }
  SceneState state = State<double>{numbers[0], numbers[1], numbers[2], numbers[3]};
  if (count == 2) state.dampers = release_of(file.scene).dampers;
  return state;
}

// Returns the scene's own release, then the starts of --start.
std::vector<SceneState> starts_of(Arguments& arguments, const SceneFile& file) {
  std::vector<SceneState> starts{release_of(file.scene)};
  for (const std::string& text : arguments.texts("--start")) {
    std::string problem;
    const auto start = parse_state(text, file, problem);
    if (start) {
      starts.push_back(*start);
      for (const Problem& each : problems_of(released_from(file.scene, *start)))
        arguments.reject("--start", each.field + " " + each.message);
    } else {
      arguments.reject("--start", !problem.empty()
                                      ? problem
                                      : filled("must be {}, got {}",
                                               has_one_damper(file.scene) ? "four numbers X0:V0:Y0:W0"
                                                                          : "two numbers X0:V0",
                                               in_quotes(text)));
    }
  }
  return starts;
}

// Returns the shift of x, dimensionless.
double nudge_of(Arguments& arguments, const SceneFile& file) {
  const auto nudge = arguments.quantity(
      "--nudge", {.dimension = Dimension::length, .scales = file.scales, .may_be_bare = true}, nudges);
  if (nudge && !arguments.given("--start"))
    arguments.reject("--nudge", "parts the sweeps of several starts: needs --start");
  return nudge.value_or(0) / scale_of(Dimension::length, file.scales);
}

// Shows how many parts are done; called from several threads.
class Progress {
 public:
  // all: number of parts; absent if it is not known.
  Progress(const char* what, std::optional<std::int64_t> all) : what_(what), all_(all) {}
  void operator()(std::int64_t done) {
    shown_(filled("{}{} {}", done, all_ ? filled(" of {}", *all_) : "", what_));
  }

 private:
  const char* what_;
  std::optional<std::int64_t> all_;
  ProgressOnStderr shown_{"response"};
};

// Warns of `count` of `all` motions, points, starts or branches, if there are any.
void warn_of_some(std::int64_t count, std::size_t all, const std::string& what) {
  if (count > 0) warn(this_command, filled("{} of {} {}", count, all, what));
}
constexpr const char* which_budget = "--max-impacts, --max-steps or --max-time raises it";

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
  warn_of_some(open, all,
               filled("motions are not periodic within {} periods of the force, which --max-periods raises; "
                      "theirs are the largest amplitude, the mean powers and all impacts of {} periods",
                      rule.max_periods, rule.mean_periods));
  warn_of_some(ended, all,
               filled("motions ended early, by a budget of the engine that \"end\" names; {}", which_budget));
}

void warn_of(const Basin& basin, const SteadyRule& rule) {
  const auto open = std::ranges::count(basin.attractor, undecided) - basin.stopped;
  const std::size_t all = basin.attractor.size();
  warn_of_some(open, all,
               filled("points are undecided within {} periods of the force; --max-periods raises that",
                      rule.max_periods));
  warn_of_some(basin.stopped, all,
               filled("points are undecided because a budget of the engine ended them; {}", which_budget));
}

void warn_of(const Branches& found, const BranchRule& rule, const Scene& scene) {
  std::int64_t open = 0, ended = 0;
  for (const BranchStart& start : found.starts) {
    const bool is_ended = start.steady.stop_reason != StopReason::time;
    ended += is_ended;
    open += !is_ended && !start.orbit;
    if (start.orbit == OrbitEnd::no_derivative)
      warn(this_command,
           has_components(scene)
               ? "two events happen at one instant, or a mass stops or is let go where friction just holds "
                 "it, "
                 "so the motion has no multipliers: release the masses apart, or change friction or weight a "
                 "little"
               : "several masses meet walls at one instant, so their motion has no multipliers: give those "
                 "that "
                 "move alike as one with the sum of their masses, or release them apart");
    else if (start.orbit && *start.orbit != OrbitEnd::converged)
      warn(this_command, filled("no periodic orbit is found near a motion that repeats: {}", end_of(start)));
  }
  const std::size_t all = found.starts.size();
  warn_of_some(open, all,
               filled("starts are not periodic within {} periods of the force, so no branch begins there; "
                      "--max-periods raises that, --start adds others",
                      rule.steady.max_periods));
  warn_of_some(ended, all,
               filled("starts ended early, by a budget of the engine that \"end\" names; {}", which_budget));
  const auto warn_of_end = [&](BranchEnd end, const std::string& what) {
    warn_of_some(
        std::ranges::count(found.branches, end, [](const FollowedBranch& each) { return each.branch.end; }),
        found.branches.size(), what);
  };
  warn_of_end(
      BranchEnd::points,
      filled("branches end after {} points; --max-points or --largest-step raises that", rule.max_points));
  warn_of_end(BranchEnd::step_too_small, "branches end where no orbit is found near enough to the last");
  warn_of_end(BranchEnd::coincidence,
              "branches end where two masses meet walls at one instant: who is first decides what follows");
  if (!found.complete)
    warn(this_command,
         filled("there are more than {} branches; --max-branches raises that", rule.max_branches));
}

// numbers: dimension of the state.
void warn_of(const LyapunovExponents& found, std::size_t numbers) {
  if (found.stop_reason != StopReason::time)
    warn(this_command, filled("there are no exponents: the run ended early, by {}; {}",
                              name_of(found.stop_reason), which_budget));
  if (const std::size_t given = found.exponents.size(); 0 < given && given < numbers)
    warn_of_some(std::int64_t(given), numbers,
                 "exponents are given: the others are minus infinity, because masses stick, or too far below "
                 "to be found");
  if (found.one_sided)
    warn(this_command,
         "several masses meet walls at one instant: the exponents are of changes that keep them together");
}

Response swept(const Request& asked) {
  const auto& rule = std::get<SteadyRule>(asked.rules);
  const Scene& scene = asked.file.scene;
  const Axis& axis = asked.axes[0];
  Progress progress("motions", 2 * axis.count * std::int64_t(asked.starts.size()));
  const auto sweeps = sweep(scene, asked.engine, axis, rule, nudged(asked.starts, asked.nudge), asked.threads,
                            std::ref(progress));
  if (!asked.quiet) warn_of(sweeps, rule);
  return SweepResponse{scene, asked.engine, rule, axis, sweeps};
}

Response mapped(const Request& asked) {
  const auto& rule = std::get<BasinRule>(asked.rules);
  const Scene& scene = asked.file.scene;
  const Axis &first = asked.axes[0], &second = asked.axes[1];
  Progress progress("points", first.count * second.count);
  const Basin map = basin(scene, asked.engine, first, second, rule, asked.threads, std::ref(progress));
  if (!asked.quiet) warn_of(map, rule.steady);
  return BasinResponse{scene, asked.engine, rule, first, second, map};
}

Response followed(const Request& asked) {
  const auto& rule = std::get<BranchRule>(asked.rules);
  const Scene& scene = asked.file.scene;
  Progress progress("branches are followed", std::nullopt);
  const Branches found =
      find_branches(scene, asked.engine, *asked.range, rule, asked.starts, asked.threads, std::ref(progress));
  if (!asked.quiet) warn_of(found, rule, scene);
  return orbits_response(scene, asked.engine, rule, *asked.range, found);
}

Response averaged(const Request& asked) {
  const Scene& scene = asked.file.scene;
  const auto [periods, discard] = std::get<Averaging>(asked.rules);
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
  const std::optional<std::size_t> word = arguments.required_word("WHAT", words_of<Kind>());
  Request asked;
  asked.kind = all_of<Kind>.begin()[word.value_or(0)];
  asked.file = scene_of(arguments, Stops::ignored);
  asked.engine = engine_of(arguments, offered_engines());
  asked.starts = starts_of(arguments, asked.file);
  asked.nudge = nudge_of(arguments, asked.file);
  read_numbers(arguments, asked);
  if (word) {
    reject_options_of_others(arguments, asked.kind);
    Scene& scene = asked.file.scene;
    const bool varies_its_clearance =
        has_one_damper(scene) && std::ranges::any_of(arguments.texts("--vary"), [](const std::string& text) {
          return text.starts_with("clearance=");
        });
    // With a clearance other than 1 it is a list of one, of which a clearance is a number as any.
    if (varies_its_clearance) scene.damper().clearance = 2;
    const Variables variables = variables_of(scene, asked.file.scales);
    if (asked.kind == Kind::orbits) {
      asked.range = range_of(arguments, variables);
    } else if (asked.kind != Kind::lyapunov) {
      asked.axes = axes_of(arguments, variables, asked.kind == Kind::sweep);
    }
    for (const Axis& axis : asked.axes)
      if (varies_its_clearance && axis.number.is(&SceneDamper::clearance))
        scene.damper().clearance = axis.from == 1 ? axis.to : axis.from;
  }
  const std::string scene_name = scene_name_of(arguments);
  const auto output = arguments.file("--output");
  arguments.reject_overwriting("--output", output, {scene_name});
  asked.format = format_of(arguments, output, {Format::json, Format::csv});
  asked.in_si = in_si(arguments, asked.format, asked.file, "the JSON file");
  asked.threads = threads_of(arguments);
  asked.quiet = arguments.flag("--quiet");
  arguments.finish();
  prepare_output(output);
  if (!asked.quiet) warn_of_cautions(this_command, asked.file.scene, asked.file.scales);
  write_output(output, saying_options([&] { return text_of_valid(asked); }, scene_name));
  return 0;
}

Options own_options() {
  Options options;
  for (const OptionOfKinds& each : options_of_kinds()) options.push_back(each.option);
  return in_group("Response", std::move(options));
}

Options output_options() {
  Option threads = threads_option();
  threads.help += ";\nnot for lyapunov";
  return in_group(
      "Output",
      {{"--format", "NAME", "json (default) or csv, one table"},
       flag_option(
           "--si",
           "csv of a scene in units: columns in SI, as their names say\n(amplitude_m, force_frequency_Hz)"),
       {"-o,--output", "FILE", "write there instead of to stdout"},
       flag_option("--quiet", "no warnings, such as of motions that are not periodic"),
       threads});
}

}  // namespace

Command response_command() {
  return {
      .name = "response",
      .description =
          "Find the steady motions of a scene under its force: along one number, or as a map over two; its "
          "periodic motions, stable or not, and its Lyapunov exponents.",
      .options = together({{{"WHAT", joined(words_of<Kind>(), "|"),
                             "the steady motions along a number, or a map over two; branches of periodic "
                             "motions; Lyapunov exponents"}},
                           own_options(),
                           output_options(),
                           scene_options(Stops::ignored),
                           engine_options(offered_engines())}),
      .footer =
          R"(The scene is that of impact-damper run, with a force f0 sin(omega_f t). The budgets of the engine hold for each of
its runs, of eight periods of the force while a motion settles.

sweep: at each value the motion goes on until it repeats: amplitude, phase, power, impacts and period of the steady
motion. The next value begins where this one ended: first upwards, then back down. Where two motions are possible
the two ways differ. Beside them stand the amplitudes without the secondary mass and with it locked to its box.

basin: in which steady motion each point of a map ends, the points being initial values (x0, v0, y0, w0) or other
numbers of the scene.

orbits: the branch of periodic motions on which the steady motion at FROM lies, followed past folds through stable
and unstable motions, with their multipliers, and the branches that begin at its flips and where it loses its symmetry.
Where it ends in a grazing, simulation leads on.

lyapunov: at what rates small changes of the state grow or decay along a run from the scene's release, with their
standard errors, in units of 1/time.

Examples:
  impact-damper response sweep --mass-ratio 0.05 --damping-ratio 0.005 --force-amplitude 0.02 \
    --x0 0 --vary force_frequency=0.9:1.1:201 --format csv -o sweep.csv
  impact-damper response sweep --scene data/examples/mast_in_wind.json \
    --vary exciting_frequency=2.9Hz:3.5Hz:61 --format csv --si -o wind.csv
  impact-damper response basin --mass-ratio 0.1 --damping-ratio 0.01 --force-amplitude 0.05 \
    --force-frequency 0.9 --y0 0.5 --engine restitution --vary x0=-1:1:200 --vary v0=-1:1:200 -o map.json
  impact-damper response orbits --scene data/examples/mast_in_wind.json \
    --vary exciting_frequency=3.08Hz:3.3Hz --format csv --si -o orbits.csv
  impact-damper response lyapunov --mass-ratio 0.05 --damping-ratio 0.01 --force-amplitude 0.3 \
    --force-frequency 0.9 --periods 20000)",
      .act = respond};
}

}  // namespace impact_damper::cli
