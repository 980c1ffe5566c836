// `run`: simulates one scene with one engine and writes a run file, or several of an ensemble.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>
#include <sstream>
#include <vector>

#include "application/reproduction/scene_runs.hpp"
#include "commands.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/simulate.hpp"
#include "interruption.hpp"
#include "output.hpp"
#include "scene_arguments.hpp"

namespace impact_damper::cli {
namespace {

constexpr const char* program = "impact-damper run";

void read_sections(Arguments& arguments, Record& record) {
  const std::optional<std::string> list = arguments.text("--record");
  if (!list) return;
  record.half_cycles = false;
  std::istringstream words(*list + ',');
  std::set<std::string> listed;
  for (std::string word; std::getline(words, word, ',');) {
    if (!listed.insert(word).second)
      arguments.reject("--record", "must list each once, got " + in_quotes(*list));
    if (word == "half_cycles")
      record.half_cycles = true;
    else if (word == "impacts")
      record.impacts = true;
    else if (word == "contacts")
      record.contacts = true;
    else if (word == "energy")
      record.energy = true;
    else if (word != "history") {
      arguments.reject("--record",
                       "must be a list of half_cycles, impacts, contacts, energy, history with commas "
                       "between, got " +
                           in_quotes(word));
    } else if (!arguments.given("--history") && !arguments.given("--history-below")) {
      arguments.reject("--record", "history needs samples to be asked for, by --history or --history-below");
    }
  }
}

Record record_of(Arguments& arguments, const SceneFile& file) {
  Record record;
  read_sections(arguments, record);
  if (arguments.given("--history") && arguments.given("--history-below")) {
    arguments.reject("--history", "either it or --history-below must be given, got both");
  }
  // The size of a dimensionless unit in the unit of the given numbers: s and mm for a scene in units, else 1.
  const double time_unit = scale_of(Dimension::time, file.scales),
               length_unit = scale_of(Dimension::length, file.scales);
  const std::string seconds = file.scales ? " s" : "", millimetres = file.scales ? " mm" : "";
  double last = 0;
  for (const std::string& text : arguments.texts("--history")) {
    const std::optional<Triple> window = parse_triple(text);
    if (!window ||
        !(window->first >= last && window->second > window->first && window->second <= 1e12 * time_unit) ||
        !(window->count >= 2 && window->count <= most_samples)) {
      arguments.reject("--history", "must be T0:T1:N with " + number_text(last) + " <= T0 < T1 <= " +
                                        number_text(1e12 * time_unit) + seconds + " and 2 to " +
                                        std::to_string(most_samples) + " samples, got " + in_quotes(text));
      continue;
    }
    const std::optional<double> end = file.scene.until_time;
    if (end && !(window->first / time_unit <= *end)) {
      arguments.reject("--history", "must begin before the end of the run, " +
                                        (file.scales ? "at " + rounded_text(*end * time_unit, 6) + seconds
                                                     : "--until-time " + number_text(*end)) +
                                        ", got " + in_quotes(text));
    }
    record.history.push_back({window->first / time_unit, window->second / time_unit, window->count});
    last = window->second;
  }
  double above_it = 1e12 * length_unit;
  for (const std::string& text : arguments.texts("--history-below")) {
    const std::optional<Triple> window = parse_triple(text);
    if (!window ||
        !(window->first > 0 && window->first < above_it && window->second > 0 &&
          window->second <= 1e12 * time_unit) ||
        !(window->count >= 2 && window->count <= most_samples)) {
      std::string wanted = "must be A:LENGTH:N with 0 < A < " + number_text(above_it) + millimetres;
      wanted += ", 0 < LENGTH <= " + number_text(1e12 * time_unit) + seconds;
      wanted += " and 2 to " + std::to_string(most_samples) + " samples, got " + in_quotes(text);
      arguments.reject("--history-below", wanted);
      continue;
    }
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
  std::cerr << program << ": warning: the run ended at " << number_text(run.end_time) << " ("
            << name_of(run.stop_reason) << "): history has " << given << " of the " << asked
            << " samples asked for\n";
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
      if_interrupted_say(std::to_string(ensemble.members - member) + " of " +
                         std::to_string(ensemble.members) + " runs are left; " + left_as_it_was(file));
      ++member;
      warn_of_early_end(std::string(program) + ": member " + std::to_string(member), run, scales);
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
  arguments.reject_overwriting("--output", file, {arguments.text("--scene").value_or("")});
  const Format format = format_of(arguments, file, {Format::json, Format::csv});
  const bool in_si = arguments.flag("--si");
  if (format == Format::csv && !holds_one_table(record)) {
    arguments.reject(
        "--format",
        "csv is one table: record one of half_cycles, impacts, contacts and history, for instance by "
        "--record impacts");
  }
  if (in_si && format != Format::csv)
    arguments.reject("--si",
                     "is for --format csv; a run file is dimensionless, its units say what a unit is in SI");
  if (in_si && !scales) arguments.reject("--si", "needs a scene in units, by --scene");
  EnsembleOptions ensemble;
  ensemble.members = arguments.whole_number("--members", within(1, double(most_members))).value_or(1);
  ensemble.threads = threads_of(arguments);
  if (ensemble.members > 1 && (!file || is_standard_output(file)))
    arguments.reject("--members", "needs --output FILE: the members are files beside it");
  if (ensemble.members > 1 && format == Format::csv)
    arguments.reject("--members", "is for run files, --format json");
  for (std::int64_t member = 2; file && member <= ensemble.members; ++member)
    arguments.reject_overwriting("--output", member_file(*file, member).string(),
                                 {arguments.text("--scene").value_or("")});
  arguments.finish();
  prepare_output(file);
  warn_of_cautions(program, scene, scales);
  const Run result = saying_options([&] { return simulate(scene, engine, record); },
                                    arguments.text("--scene").value_or(""), scales);
  warn_of_early_end(program, result, scales);
  warn_of_missing_samples(result, record);
  if (ensemble.members > 1) run_members(*file, result, record, scales, ensemble);
  write_output(file, format == Format::csv ? run_csv(result, in_si ? scales : std::nullopt)
                                           : run_text(result, scales));
  return 0;
}

Options output_options() {
  Options options;
  const auto add = [&](const std::string& name, const std::string& type, const std::string& help,
                       Option::Takes takes = Option::Takes::value) {
    options.push_back({name, type, help, "Output", takes});
  };
  add("--record", "LIST",
      "what to record, with commas between: half_cycles (default),\n"
      "impacts, contacts, energy, history");
  add("--history", "T0:T1:N",
      "record the motion at N equally spaced times from T0 to T1, both\nincluded, in seconds for a scene "
      "in units; may be repeated, in\norder of time",
      Option::Takes::repeated_value);
  add("--history-below", "A:LENGTH:N",
      "the same over LENGTH, from the end of the first half cycle below\n"
      "amplitude A on, in seconds and mm for a scene in units; may be\nrepeated, with descending A",
      Option::Takes::repeated_value);
  add("--format", "NAME",
      "json (default), a run file; or csv, the one section that is\n"
      "recorded (half_cycles, impacts, contacts or history) as a table");
  add("--si", "", "csv of a scene in units: columns in SI, as their names say (time_s,\namplitude_m)",
      Option::Takes::nothing);
  add("-o,--output", "FILE", "write the run there instead of to stdout");
  add("--members", "N",
      "run an ensemble of N members, 1 (default) to 100: the scene itself\n"
      "and the same with perturbed initial conditions. With -o NAME.json\n"
      "these are NAME.members/02.json and so on, each a run file with\n"
      "what is recorded, except history and energy");
  options.push_back(threads_option());
  options.back().group = "Output";
  return options;
}

}  // namespace

Command run_command() {
  Command command{.name = "run", .description = "Simulate a scene and write what happens as a run file."};
  for (const Options& options : {scene_options(), engine_options(), output_options()})
    command.options.insert(command.options.end(), options.begin(), options.end());
  command.footer =
      "A scene is a primary mass on a spring, and a secondary mass that travels between the walls\n"
      "of a cavity in it. Everything is dimensionless: lengths are in units of the clearance between the\n"
      "walls, times of 1/Omega_n = sqrt(M/K), forces of the force that moves the primary spring by one\n"
      "clearance. A scene file may be given in units instead:\n"
      "mass and secondary_mass in kg, stiffness in N/m, clearance in mm, with initial_displacement,\n"
      "until_millimetres and others; it is made dimensionless when it is read (all keys:\n"
      "data/schema/scene.schema.json). A list, \"dampers\", gives a scene file several cavities on the\n"
      "same primary mass. A run file is dimensionless as well, and says in\n"
      "\"units\" what one unit of length, time, velocity, mass, force and energy is in SI; --format csv\n"
      "--si writes the columns in SI.\n\n"
      "Examples:\n"
      "  impact-damper run --until-amplitude 0.1 -o run.json\n"
      "  impact-damper run --scene data/scenes/my.json --engine cem --time-step 1e-4 -o cem.json\n"
      "  impact-damper run --until-time 50 --record impacts,energy --history 0:50:2001\n"
      "  impact-damper run --scene data/examples/mast.json --record history --history 0:2:401 \\\n"
      "    --format csv --si -o mast.csv\n"
      "  impact-damper run --scene data/scenes/nu2-e06.json --members 16 -o nu2-e06.json\n\n"
      "A run that uses up --max-impacts, --max-half-cycles, --max-time or --max-steps ends there, and\n"
      "says so on stderr and in its stop_reason. Exit codes: 0 done, 2 the command line is not valid,\n"
      "3 the scene file's content is not valid, 4 numerical failure, 5 the scene file cannot be read or\n"
      "the run cannot be written.";
  command.act = run_scene;
  return command;
}

}  // namespace impact_damper::cli
