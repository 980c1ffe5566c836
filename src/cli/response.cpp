// `response`: the steady states of a scene under its force, along one of its numbers or over two.
#include <algorithm>
#include <atomic>
#include <iostream>
#include <map>

#include "commands.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/steady/response_file.hpp"
#include "interruption.hpp"
#include "progress.hpp"
#include "scene_arguments.hpp"

namespace impact_damper::cli {
namespace {

constexpr const char* this_command = "impact-damper response";
constexpr std::int64_t most_values = 100'000;  // of an axis

// The engines that can go on from one period of the force to the next.
const std::vector<Engine>& offered_engines() {
  static const std::vector<Engine> offered{Exact{}, Restitution{}};
  return offered;
}

// A number that may be varied: what it is called on the command line, and what one dimensionless unit of it
// is in the units of the scene's file.
struct Variable {
  double Scene::*number;
  double scale = 1;
};
using Variables = std::map<std::string, Variable, std::less<>>;

double scale_of(std::string_view unit, const Scales& scales) {
  if (unit == "kg") return scales.mass;
  if (unit == "N/m") return scales.stiffness;
  if (unit == "mm") return scales.length;
  if (unit == "mm/s") return scales.velocity();
  if (unit == "N") return scales.force();
  if (unit == "Hz") return scales.frequency();
  if (unit == "N s/m") return scales.damping();
  return 1;
}

// The numbers of a scene by their names, beside a scene in units also by those of its file.
Variables variables_of(const std::optional<Scales>& scales) {
  Variables variables;
  for (const SceneField& field : scene_fields) variables[std::string(field.name)] = {field.member};
  if (!scales) return variables;
  for (const UnitField& field : unit_fields) {
    const auto made = variables.find(field.becomes);
    if (made != variables.end() && !field.also_dimensionless)
      variables[std::string(field.name)] = {made->second.number, scale_of(field.unit, *scales)};
  }
  return variables;
}

std::optional<Axis> axis_of(Arguments& arguments, const std::string& text, const Variables& variables) {
  const std::size_t equals = text.find('=');
  std::string name = text.substr(0, equals);
  std::ranges::replace(name, '-', '_');
  const auto variable = variables.find(name);
  if (variable == variables.end()) {
    std::vector<std::string_view> names;
    for (const auto& [known, ignored] : variables) names.push_back(known);
    const auto meant = nearest(name, names);
    arguments.reject("--vary", "must name a number of the scene before the =, got " + in_quotes(text) +
                                   (meant ? ", did you mean " + std::string(*meant) + "?" : ""));
    return std::nullopt;
  }
  const auto range = equals == std::string::npos ? std::nullopt : parse_triple(text.substr(equals + 1));
  if (!range || !(range->first < range->second) || !(range->count >= 2 && range->count <= most_values)) {
    arguments.reject("--vary", "must be NAME=FROM:TO:N with FROM < TO and 2 to " +
                                   std::to_string(most_values) + " values, got " + in_quotes(text));
    return std::nullopt;
  }
  const auto& [number, scale] = variable->second;
  return Axis{number, range->first / scale, range->second / scale, range->count};
}

std::vector<Axis> axes_of(Arguments& arguments, const Variables& variables, bool is_sweep) {
  std::vector<Axis> axes;
  const std::vector<std::string> given = arguments.texts("--vary");
  const std::size_t needed = is_sweep ? 1 : 2;
  if (given.size() != needed) {
    arguments.reject("--vary", "must be given " +
                                   std::string(is_sweep ? "once for a sweep" : "twice for a basin") +
                                   ", got " + std::to_string(given.size()));
    return axes;
  }
  for (const std::string& text : given)
    if (const auto axis = axis_of(arguments, text, variables)) axes.push_back(*axis);
  if (axes.size() != needed) return axes;
  if (is_sweep && is_initial_value(axes[0].number)) {
    arguments.reject("--vary", "must be no initial value in a sweep, which carries the motion along; got " +
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

// X:V:Y:W in the units of the scene's file.
std::optional<State<double>> parse_state(std::string_view text, const std::optional<Scales>& scales) {
  std::array<double, 4> numbers{};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t colon = text.find(':');
    if ((colon == std::string_view::npos) != (i == 3)) return std::nullopt;
    const auto number = parse_number(text.substr(0, colon));
    if (!number) return std::nullopt;
    const double length = scales ? scales->length : 1, velocity = scales ? scales->velocity() : 1;
    numbers[i] = *number / (i % 2 == 0 ? length : velocity);
    text = colon == std::string_view::npos ? "" : text.substr(colon + 1);
  }
  return State<double>{numbers[0], numbers[1], numbers[2], numbers[3]};
}

// The scene's own release, then those of --start.
std::vector<State<double>> starts_of(Arguments& arguments, const SceneFile& file) {
  std::vector<State<double>> starts{release_of(file.scene)};
  for (const std::string& text : arguments.texts("--start")) {
    const auto start = parse_state(text, file.scales);
    if (start) {
      starts.push_back(*start);
      for (const Problem& problem : problems_of(released_from(file.scene, *start)))
        arguments.reject("--start", problem.field + " " + problem.message);
    } else {
      arguments.reject("--start", "must be four numbers X0:V0:Y0:W0, got " + in_quotes(text));
    }
  }
  return starts;
}

SteadyRule rule_of(Arguments& arguments, SteadyRule rule) {
  rule.tolerance = arguments.number("--tolerance", {0, 1e-2, false}).value_or(rule.tolerance);
  rule.longest_period =
      arguments.whole_number("--longest-period", within(1, 64)).value_or(rule.longest_period);
  rule.max_periods = arguments.whole_number("--max-periods", within(1, 1e9)).value_or(rule.max_periods);
  rule.mean_periods = arguments.whole_number("--mean-periods", within(10, 1e6)).value_or(rule.mean_periods);
  return rule;
}

// How far it is; called from several threads.
class Progress {
 public:
  Progress(const char* what, std::int64_t all) : what_(what), all_(all) {}
  void operator()(std::int64_t done) {
    told_(std::to_string(done) + " of " + std::to_string(all_) + " " + what_);
  }

 private:
  const char* what_;
  std::int64_t all_;
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
         " periods of the force; their numbers are means; --max-periods raises that");
  if (ended > 0)
    warn(of_all(ended, all, "motions") +
         " ended early, by a budget of the engine that \"end\" names; its option raises that");
}

void warn_of(const Basin& basin, const SteadyRule& rule) {
  const auto open = std::ranges::count(basin.attractor, undecided) - basin.stopped;
  if (open > 0)
    warn(of_all(open, basin.attractor.size(), "points") + " are undecided within " +
         std::to_string(rule.max_periods) + " periods of the force; --max-periods raises that");
  if (basin.stopped > 0)
    warn(of_all(basin.stopped, basin.attractor.size(), "points") +
         " are undecided because a budget of the engine ended them; its option raises that");
}

int respond(Arguments& arguments) {
  const std::optional<std::size_t> kind = arguments.word("WHAT", {"sweep", "basin"});
  if (!arguments.given("WHAT")) arguments.reject("WHAT", "must be given: sweep or basin");
  const bool is_sweep = kind.value_or(0) == 0;
  const SceneFile file = scene_of(arguments, Stops::ignored);
  const Engine engine = engine_of(arguments, offered_engines());
  const std::vector<Axis> axes =
      kind ? axes_of(arguments, variables_of(file.scales), is_sweep) : std::vector<Axis>{};
  const std::vector<State<double>> starts = starts_of(arguments, file);
  BasinRule basin_rule;
  const SteadyRule rule = rule_of(arguments, is_sweep ? SteadyRule{} : basin_rule.steady);
  basin_rule.steady = rule;
  basin_rule.capture_radius =
      arguments.number("--capture-radius", {0, 0.5, false}).value_or(basin_rule.capture_radius);
  for (const char* option : {"--start", "--mean-periods"})
    if (kind && !is_sweep && arguments.given(option)) arguments.reject(option, "is an option of a sweep");
  if (kind && is_sweep && arguments.given("--capture-radius"))
    arguments.reject("--capture-radius", "is an option of a basin");
  const auto output = arguments.file("--output");
  arguments.reject_overwriting("--output", output, {arguments.text("--scene").value_or("")});
  const Format format = format_of(arguments, output, {Format::json, Format::csv});
  const bool in_si = arguments.flag("--si");
  if (in_si && format != Format::csv)
    arguments.reject(
        "--si", "is for --format csv; the JSON file is dimensionless, its units say what a unit is in SI");
  if (in_si && !file.scales) arguments.reject("--si", "needs a scene in units, by --scene");
  const Threads threads = threads_of(arguments);
  arguments.finish();
  if (output) {
    require_writable(*output);
    if_interrupted_say(left_as_it_was(*output));
  }
  warn_of_cautions(this_command, file.scene, file.scales);
  std::optional<SiUnits> units;
  if (in_si) units = si_units_of(*file.scales);

  const std::string text = saying_options([&] {
    if (is_sweep) {
      Progress progress("motions", 2 * axes[0].count * std::int64_t(starts.size()));
      const auto sweeps = sweep(file.scene, engine, axes[0], rule, starts, threads,
                                [&](std::int64_t done) { progress(done); });
      warn_of(sweeps, rule);
      return format == Format::csv ? sweep_csv(file.scene, axes[0], sweeps, units)
                                   : sweep_text(file.scene, engine, rule, axes[0], sweeps, file.scales);
    }
    Progress progress("points", axes[0].count * axes[1].count);
    const Basin map = basin(file.scene, engine, axes[0], axes[1], basin_rule, threads,
                            [&](std::int64_t done) { progress(done); });
    warn_of(map, rule);
    return format == Format::csv
               ? basin_csv(axes[0], axes[1], map, units)
               : basin_text(file.scene, engine, basin_rule, axes[0], axes[1], map, file.scales);
  });
  if (output) {
    write_file(*output, text);
  } else {
    write_standard_output(text);
  }
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
  add("--vary", "NAME=FROM:TO:N",
      "the number of the scene that takes N equally spaced values, both\nends included: mass_ratio, "
      "force_amplitude, force_frequency, ...;\nbeside a scene in units also by its name there, in its unit:\n"
      "exciting_frequency=4:6:101 in Hz. Once for a sweep, twice for a\nbasin",
      "Response", Option::Takes::repeated_value);
  add("--start", "X0:V0:Y0:W0",
      "sweep: one more sweep that begins there instead of at the scene's\nrelease, in mm and mm/s beside a "
      "scene in units; may be repeated",
      "Response", Option::Takes::repeated_value);
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
  add("--format", "NAME", "json (default) or csv, one table", "Output");
  add("--si", "",
      "csv of a scene in units: columns in SI, as their names say\n(amplitude_m, force_frequency_Hz)",
      "Output", Option::Takes::nothing);
  add("-o,--output", "FILE", "write there instead of to stdout", "Output");
  options.push_back(threads_option());
  options.back().group = "Output";
  return options;
}

}  // namespace

Command response_command() {
  Command command{.name = "response",
                  .description =
                      "Find the steady motions of a scene under its force: along one number, or "
                      "as a map over two."};
  command.options = {{"WHAT", "sweep|basin", "the steady motions along a number, or a map over two"}};
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
      "motions are possible\nthe two ways differ. Beside them stand the amplitudes without the loose mass "
      "and "
      "with it locked to its box.\n\n"
      "basin: in which steady motion each point of a map ends, the points being initial values (x0, v0, y0, "
      "w0) "
      "or other\nnumbers of the scene.\n\n"
      "Examples:\n"
      "  impact-damper response sweep --mass-ratio 0.05 --damping-ratio 0.005 --force-amplitude 0.02 \\\n"
      "    --x0 0 --vary force_frequency=0.9:1.1:201 --format csv -o sweep.csv\n"
      "  impact-damper response sweep --scene data/examples/machine.json \\\n"
      "    --vary exciting_frequency=2.9:3.5:61 --format csv --si -o machine.csv\n"
      "  impact-damper response basin --mass-ratio 0.1 --damping-ratio 0.01 --force-amplitude 0.05 \\\n"
      "    --force-frequency 0.9 --y0 0.5 --engine restitution --vary x0=-1:1:200 --vary v0=-1:1:200 -o "
      "map.json";
  command.act = respond;
  return command;
}

}  // namespace impact_damper::cli
