// `run`: simulates one scene with one engine and writes a run file, or several of an ensemble.
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "application/reproduction/scene_runs.hpp"
#include "commands.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper::cli {
namespace {

constexpr const char* program = "impact-damper run";

void read_sections(Arguments& arguments, Record& record) {
  const std::optional<std::string> list = arguments.text("--record");
  if (!list) return;
  static const std::map<std::string_view, bool Record::*> sections{{"half_cycles", &Record::half_cycles},
                                                                   {"impacts", &Record::impacts},
                                                                   {"contacts", &Record::contacts},
                                                                   {"energy", &Record::energy}};
  record.half_cycles = false;
  std::set<std::string_view> listed;
  for (const std::string_view word : parts_of(*list)) {
    if (!listed.insert(word).second)
      arguments.reject("--record", "must list each once, got " + in_quotes(*list));
    if (const auto found = sections.find(word); found != sections.end()) {
      record.*found->second = true;
    } else if (word != "history") {
      arguments.reject(
          "--record",
          "must be a list of half_cycles, impacts, contacts, energy, history with commas between, got " +
              in_quotes(word));
    } else if (!arguments.given("--history") && !arguments.given("--history-below")) {
      arguments.reject("--record", "history needs samples to be asked for, by --history or --history-below");
    }
  }
}

// Reads a window of samples, in the units of the scene's file. Absent, and noted, unless allows(window).
template <class Allows>
std::optional<Triple> window_of(Arguments& arguments, const std::string& option, const std::string& text,
                                QuantityReader first, QuantityReader second, const std::string& allowed,
                                Allows allows) {
  const std::optional<Triple> window = parse_triple(text, first, second);
  if (window && window->count >= 2 && window->count <= most_samples && allows(*window)) return window;
  const std::string problem = first.problem.empty() ? second.problem : first.problem;
  arguments.reject(option, !problem.empty() ? problem
                                            : filled("must be {} and 2 to {} samples, got {}", allowed,
                                                     most_samples, in_quotes(text)));
  return std::nullopt;
}

Record record_of(Arguments& arguments, const SceneFile& file) {
  Record record;
  read_sections(arguments, record);
  if (arguments.given("--history") && arguments.given("--history-below"))
    arguments.reject("--history", "either it or --history-below must be given, got both");
  // The size of a dimensionless unit in the unit of the given numbers: s and mm for a scene in units, else 1.
  const double time_unit = scale_of(Dimension::time, file.scales),
               length_unit = scale_of(Dimension::length, file.scales);
  const std::string seconds = file.scales ? " s" : "", millimetres = file.scales ? " mm" : "";
  const QuantityReader a_time{.dimension = Dimension::time, .scales = file.scales, .may_be_bare = true},
      a_length{.dimension = Dimension::length, .scales = file.scales, .may_be_bare = true};
  const double longest = 1e12 * time_unit;
  double last = 0;
  for (const std::string& text : arguments.texts("--history")) {
    const auto window = window_of(
        arguments, "--history", text, a_time, a_time,
        filled("T0:T1:N with {} <= T0 < T1 <= {}{}", last, longest, seconds), [&](const Triple& each) {
          return each.first >= last && each.second > each.first && each.second <= longest;
        });
    if (!window) continue;
    const std::optional<double> end = file.scene.until_time;
    if (end && !(window->first / time_unit <= *end))
      arguments.reject("--history", filled("must begin before the end of the run, {}, got {}",
                                           file.scales ? "at " + rounded_text(*end * time_unit, 6) + seconds
                                                       : "--until-time " + number_text(*end),
                                           in_quotes(text)));
    record.history.push_back({window->first / time_unit, window->second / time_unit, window->count});
    last = window->second;
  }
  double above_it = 1e12 * length_unit;
  for (const std::string& text : arguments.texts("--history-below")) {
    const auto window = window_of(
        arguments, "--history-below", text, a_length, a_time,
        filled("A:LENGTH:N with 0 < A < {}{}, 0 < LENGTH <= {}{}", above_it, millimetres, longest, seconds),
        [&](const Triple& each) {
          return each.first > 0 && each.first < above_it && each.second > 0 && each.second <= longest;
        });
    if (!window) continue;
    record.history_below.push_back({window->first / length_unit, window->second / time_unit, window->count});
    above_it = window->first;
  }
  return record;
}

// Whether CSV, which is one table, can hold a run with this record: one section, and no energy balance.
bool holds_one_table(const Record& record) {
  const bool history = !record.history.empty() || !record.history_below.empty();
  return !record.energy && int{record.half_cycles} + record.impacts + record.contacts + history == 1;
}

// Warns of samples after the end of a run, which may not be known before it.
void warn_of_missing_samples(const Run& run, const Record& record) {
  if (!run.history) return;
  std::int64_t asked = 0;
  for (const HistoryWindow& window : record.history) asked += window.count;
  for (const AmplitudeWindow& window : record.history_below) asked += window.count;
  const auto given = static_cast<std::int64_t>(run.history->time.size());
  if (given == asked) return;
  warn(program, filled("the run ended at {} ({}): history has {} of the {} samples asked for", run.end_time,
                       name_of(run.stop_reason), given, asked));
}

// Simulates and writes the other members of the ensemble of `first`, as many at once as there are threads: no
// more are kept in memory. They are written before `file`, so that if `file` is new, all are.
void run_members(const std::string& file, const Run& first, const Record& record,
                 const std::optional<Scales>& scales, const EnsembleOptions& ensemble) {
  const std::filesystem::path folder = member_file(file, 2).parent_path();
  std::error_code error;
  std::filesystem::create_directory(folder, error);
  if (error) throw IoError(folder.string() + ": cannot be written: " + error.message());
  const std::vector<Scene> scenes = ensemble_of(first.scene, ensemble);
  const std::ptrdiff_t at_once = number_of(ensemble.threads);
  std::int64_t member = 1;
  for (auto next = scenes.begin() + 1; next != scenes.end();) {
    const auto end = next + std::min(at_once, scenes.end() - next);
    for (const Run& run :
         simulate_scenes({next, end}, first.engine, record_of_member(record), ensemble.threads)) {
      if_interrupted_say(filled("{} of {} runs are left; {}", ensemble.members - member, ensemble.members,
                                left_as_it_was(file)));
      ++member;
      warn_of_early_end(filled("{}: member {}", program, member), run, scales);
      write_file(member_file(file, member), run_text(run, scales));
    }
    next = end;
  }
}

int run_scene(Arguments& arguments) {
  const SceneFile scene_file = scene_of(arguments, Stops::needed);
  const Scene& scene = scene_file.scene;
  const std::optional<Scales>& scales = scene_file.scales;
  const Engine engine = engine_of(arguments);
  const Record record = record_of(arguments, scene_file);
  const std::optional<std::string> file = arguments.file("--output");
  const std::string scene_name = scene_name_of(arguments);
  arguments.reject_overwriting("--output", file, {scene_name});
  const Format format = format_of(arguments, file, {Format::json, Format::csv});
  if (format == Format::csv && !holds_one_table(record)) {
    arguments.reject("--format",
                     "csv is one table: record one of half_cycles, impacts, contacts and history, for "
                     "instance by --record impacts");
  }
  const bool si = in_si(arguments, format, scene_file, "a run file");
  EnsembleOptions ensemble;
  ensemble.members = arguments.whole_number("--members", within(1, double(most_members))).value_or(1);
  ensemble.threads = threads_of(arguments);
  if (ensemble.members > 1 && (!file || is_standard_output(file)))
    arguments.reject("--members", "needs --output FILE: the members are files beside it");
  if (ensemble.members > 1 && format == Format::csv)
    arguments.reject("--members", "is for run files, --format json");
  for (std::int64_t member = 2; file && member <= ensemble.members; ++member)
    arguments.reject_overwriting("--output", member_file(*file, member).string(), {scene_name});
  arguments.finish();
  prepare_output(file);
  warn_of_cautions(program, scene, scales);
  const Run result = saying_options([&] { return simulate(scene, engine, record); }, scene_name, scales);
  warn_of_early_end(program, result, scales);
  warn_of_missing_samples(result, record);
  if (ensemble.members > 1) run_members(*file, result, record, scales, ensemble);
  write_output(
      file, format == Format::csv ? run_csv(result, si ? scales : std::nullopt) : run_text(result, scales));
  return 0;
}

Options output_options() {
  Options options{
      {"--record", "LIST",
       "what to record, with commas between: half_cycles (default),\nimpacts, contacts, energy, history"},
      repeated_option("--history", "T0:T1:N",
                      "record the motion at N equally spaced times from T0 to T1, both\nincluded, in seconds "
                      "for a scene in units; may be repeated, in\norder of time"),
      repeated_option("--history-below", "A:LENGTH:N",
                      "the same over LENGTH, from the end of the first half cycle below\namplitude A on, in "
                      "seconds and mm for a scene in units; may be\nrepeated, with descending A"),
      {"--format", "NAME",
       "json (default), a run file; or csv, the one section that is\nrecorded (half_cycles, impacts, "
       "contacts or history) as a table"},
      flag_option("--si",
                  "csv of a scene in units: columns in SI, as their names say (time_s,\namplitude_m)"),
      {"-o,--output", "FILE", "write the run there instead of to stdout"},
      {"--members", "N",
       "run an ensemble of N members, 1 (default) to 100: the scene itself\nand the same with perturbed "
       "initial conditions. With -o NAME.json\nthese are NAME.members/02.json and so on, each a run file "
       "with\nwhat is recorded, except history and energy"},
      threads_option()};
  return in_group("Output", std::move(options));
}

}  // namespace

Command run_command() {
  return {
      .name = "run",
      .description = "Simulate a scene and write what happens as a run file.",
      .options = together({scene_options(), engine_options(), output_options()}),
      .footer = R"(A scene is a primary mass on a spring, and a secondary mass that travels between the walls
of a cavity in it. Everything is dimensionless: lengths are in units of the clearance between the
walls, times of 1/Omega_n = sqrt(M/K), forces of the force that moves the primary spring by one
clearance. A scene file may be given in units instead:
mass and secondary_mass in kg, stiffness in N/m, clearance in mm, with initial_displacement,
until_millimetres and others; it is made dimensionless when it is read (all keys:
data/schema/scene.schema.json). A list, "dampers", gives a scene file several cavities on the
same primary mass. A run file is dimensionless as well, and says in
"units" what one unit of length, time, velocity, mass, force and energy is in SI; --format csv
--si writes the columns in SI.

Examples:
  impact-damper run --until-amplitude 0.1 -o run.json
  impact-damper run --scene data/scenes/my.json --engine cem --time-step 1e-4 -o cem.json
  impact-damper run --until-time 50 --record impacts,energy --history 0:50:2001
  impact-damper run --scene data/examples/mast.json --record history --history 0:2:401 \
    --format csv --si -o mast.csv
  impact-damper run --scene data/scenes/nu2-e06.json --members 16 -o nu2-e06.json

A run that uses up --max-impacts, --max-half-cycles, --max-time or --max-steps ends there, and
says so on stderr and in its stop_reason. Exit codes: 0 done, 2 the command line is not valid,
3 the scene file's content is not valid, 4 numerical failure, 5 the scene file cannot be read or
the run cannot be written.)",
      .act = run_scene};
}

}  // namespace impact_damper::cli
