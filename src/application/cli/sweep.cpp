// `sweep`: makes many runs of one scene with other numbers, and one table of what is kept of each; `merge`:
// joins parts that were made separately into the same table.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "application/sweeps/plan.hpp"
#include "application/sweeps/sweep_table.hpp"
#include "commands.hpp"
#include "impact_damper/base/sha256.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/provenance.hpp"

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Reads FROM:TO:N, FROM:TO:N:log or V,V,...
std::optional<GridAxis> axis_of(Arguments& arguments, const std::string& text, const SceneFile& scene) {
  const std::vector<Variable> variables = variables_of(scene);
  const auto varied = varied_of(arguments, text, texts_of(variables, &Variable::name));
  if (!varied) return std::nullopt;
  GridAxis axis;
  axis.variable = variables[varied->index];
  std::string values = varied->values.value_or("");
  constexpr std::string_view logarithmic = ":log";
  const bool is_range = values.find(':') != std::string::npos;
  if (values.ends_with(logarithmic)) {
    axis.spacing = Spacing::logarithmic;
    values.resize(values.size() - logarithmic.size());
  }
  QuantityReader read{.dimension = axis.variable.dimension, .scales = scene.scales};
  bool is_valid = true;
  if (is_range) {
    const auto range = parse_triple(values, read);
    is_valid = range && range->first < range->second && range->count >= 2 &&
               range->count <= most_axis_values &&
               !(axis.spacing == Spacing::logarithmic && !(range->first > 0));
    if (is_valid) axis.from = range->first, axis.to = range->second, axis.count = range->count;
  } else {
    const auto listed = numbers_of(values, ',', read);
    is_valid = listed.has_value();
    axis.values = listed.value_or(std::vector<double>{});
  }
  if (!read.problem.empty()) {
    arguments.reject("--vary", axis.variable.name + ": " + read.problem);
    return std::nullopt;
  }
  if (!is_valid) {
    arguments.reject("--vary", filled("must be NAME=FROM:TO:N, NAME=FROM:TO:N:log or NAME=V,V,... with FROM "
                                      "< TO, for log both > 0, and N from 2 to {}, got {}",
                                      most_axis_values, in_quotes(text)));
    return std::nullopt;
  }
  // The ends of a range, or all values of a list.
  const std::vector<double> ends = axis.values.empty() ? std::vector{axis.from, axis.to} : axis.values;
  for (const double value : ends) {
    if (axis.variable.range.allows(value)) continue;
    arguments.reject("--vary", filled("values of {} must be {}, got {}", axis.variable.name,
                                      axis.variable.range.describe("numbers"), value));
    break;
  }
  return axis;
}

void read_kept(Arguments& arguments, Plan& plan) {
  const std::string list = arguments.text("--keep").value_or("");
  if (!arguments.given("--keep")) {
    arguments.reject("--keep", "must be given: which quantities, --list-quantities lists them");
    return;
  }
  for (const std::string_view each : parts_of(list)) {
    // The amplitude or loss factor behind the =, which read_quantity() takes in the unit of the scene's file.
    const std::size_t equals = std::min(each.find('='), each.size());
    const std::string name(each.substr(0, equals));
    QuantityReader read{.scales = plan.scene.scales};
    for (const Quantity& quantity : all_quantities())
      if (quantity.name == name) read.dimension = quantity.at.value_or(Dimension::ratio);
    const auto at = equals < each.size() ? read(each.substr(equals + 1)) : std::nullopt;
    const QuantityReading reading = read_quantity(at ? name + '=' + number_text(*at) : std::string(each));
    if (!read.problem.empty()) {
      arguments.reject("--keep", name + ": " + read.problem);
    } else if (reading.kept) {
      plan.quantities.push_back(*reading.kept);
    } else {
      arguments.reject("--keep", reading.problem);
    }
  }
}

// Returns the options for what a plan contains.
Options options_of_plan() {
  const Options options{
      repeated_option(
          "--vary", "NAME=FROM:TO:N[:log]",
          "without a plan: the number of the scene that takes N values, both ends\nincluded, equally spaced "
          "or, with :log, by equal ratios; or\nNAME=V,V,... takes those listed. mass_ratio, restitution, "
          "...; beside a\nscene in units the names of its file, with units: "
          "clearance=5mm:20mm:4;\nclearance_2 is that "
          "of the second of several dampers. Given\nseveral times: all combinations"),
      {"--keep", "LIST",
       "without a plan: the quantities that are kept, with commas between;\n--list-quantities lists them"}};
  return together({in_group("Sweep", options), scene_options(), engine_options()});
}

Plan plan_of_options(Arguments& arguments) {
  Plan plan;
  plan.scene = scene_of(arguments, Stops::needed);
  plan.engine = engine_of(arguments);
  for (const std::string& text : arguments.texts("--vary"))
    if (auto axis = axis_of(arguments, text, plan.scene)) plan.grid.push_back(std::move(*axis));
  if (!arguments.given("--vary")) arguments.reject("--vary", "it or a plan must be given: what is to vary?");
  read_kept(arguments, plan);
  arguments.finish();
  for (const Problem& problem : problems_of(plan)) {
    const std::string option = problem.field == "grid"     ? "--vary"
                               : problem.field == "engine" ? "--engine"
                                                           : "--keep";
    arguments.reject(
        option, problem.field == "frequencies" ? "the worst over frequencies needs a plan" : problem.message);
  }
  return plan;
}

Plan plan_of(Arguments& arguments) {
  const auto file = arguments.file("PLAN");
  if (!file) return plan_of_options(arguments);
  for (const Option& option : options_of_plan())
    if (arguments.given(option.name))
      arguments.reject(option.name, "cannot be given beside a plan, which says it");
  arguments.finish();
  return read_plan(*file, find_named_file);
}

void read_part(Arguments& arguments, ShareHead& head) {
  const auto text = arguments.text("--part");
  if (!text) return;
  const auto numbers = parts_of(*text, '/');
  const auto part = parse_integer(numbers.front()), parts = parse_integer(numbers.back());
  if (numbers.size() == 2 && part && parts && *part >= 1 && *part <= *parts && *parts <= most_parts)
    head.part = *part, head.parts = *parts;
  else
    arguments.reject("--part",
                     filled("must be K/N with 1 <= K <= N <= {}, got {}", most_parts, in_quotes(*text)));
}

// Returns version and commit; if the commit does not identify the source, the program's own digest as well.
std::string program_identity() {
  const Provenance& made = provenance();
  std::string identity = std::string(made.version) + ' ' + std::string(made.commit);
  if (made.tree.empty()) {
    const std::string digest = sha256(read_text("/proc/self/exe"));
    constexpr std::size_t some = 16;
    identity += ' ' + digest.substr(0, some);
  }
  return identity;
}

void require_known_format(Arguments& arguments, const std::optional<std::string>& output) {
  reject_other_endings(arguments, "--output", output, {Format::csv, Format::hdf5});
  if (is_standard_output(output))
    arguments.reject("--output", "must be a file, beside which a description of it is written, got \"-\"");
  if (output && is_hdf5(*output) && !has_hdf5())
    arguments.reject("--output",
                     "asks for HDF5, but the program was built without the HDF5 library (Debian: "
                     "libhdf5-dev); named *.csv the table is CSV");
}

// Returns a duration for reading: "42 s", "17 min", "3.5 h".
std::string duration_text(double seconds) {
  constexpr double minute = 60, hour = 3600;
  if (seconds < 2 * minute) return rounded_text(seconds, 2) + " s";
  if (seconds < 2 * hour) return rounded_text(seconds / minute, 2) + " min";
  return rounded_text(seconds / hour, 3) + " h";
}

std::string bytes_text(double bytes) {
  constexpr double kilo = 1e3, mega = 1e6, giga = 1e9;
  if (bytes < mega) return rounded_text(bytes / kilo, 2) + " kB";
  return bytes < giga ? rounded_text(bytes / mega, 2) + " MB" : rounded_text(bytes / giga, 3) + " GB";
}

// Makes a few of the runs and reports how long all take.
void print_size(const Plan& plan, const RowRange& range, const Threads& threads) {
  constexpr std::int64_t most_tried = 16;
  constexpr double long_enough = 2;  // seconds
  const std::int64_t tried = std::min(most_tried, range.size());
  const auto begin = Clock::now();
  std::int64_t made = 0;
  double bytes = 0;
  for (; made < tried && seconds_since(begin) < long_enough; ++made) {
    // Runs from the whole range, however few are made: fractional parts of multiples of the golden ratio.
    constexpr double golden = 0.6180339887498949;
    const double part = (double(made) + 0.5) * golden;
    const std::int64_t i =
        range.begin +
        (range.size() <= most_tried ? made : std::int64_t(double(range.size()) * (part - std::floor(part))));
    bytes += double(row_of(plan, i).size() + 1);
  }
  const double each = made == 0 ? 0 : seconds_since(begin) / double(made), runs = double(range.size());
  const std::int64_t at_once =
      std::min<std::int64_t>(number_of(threads), std::max<std::int64_t>(1, range.size()));
  write_standard_output(filled(
      "{} runs of {}, about {} with {} {}, a table of about {}, judged by {} of the runs\n", range.size(),
      runs_of(plan), duration_text(each * runs / double(at_once)), at_once,
      at_once == 1 ? "thread" : "threads", bytes_text(made == 0 ? 0 : bytes / double(made) * runs), made));
}

// Makes the missing rows of a share.
void make_share(ShareWriter& share, const ShareHead& head, const fs::path& file, const Threads& threads) {
  const RowRange range = rows_of_part(head.plan, head.part, head.parts);
  const auto say_what_is_kept = [&] {
    if_interrupted_say(filled("{} of {} runs are kept in {}; the same command goes on from there",
                              share.kept(), range.size(), file.string()));
  };
  say_what_is_kept();
  const std::int64_t before = share.rows();
  ProgressOnStderr progress("sweep");
  const auto begin = Clock::now();
  double reported = 0;
  for_each_in_order(
      range.size() - before, threads,
      [&](std::int64_t i) { return row_of(head.plan, range.begin + before + i); },
      [&](const std::string& row) {
        share.append(row);
        const double seconds = seconds_since(begin);
        if (seconds - reported < 0.5) return;
        reported = seconds;
        const double rate = double(share.rows() - before) / seconds;
        progress(filled("{} of {} runs, {} in a second, {} left", share.rows(), range.size(),
                        rounded_text(rate, 3), duration_text(double(range.size() - share.rows()) / rate)));
        say_what_is_kept();
      });
  share.finish();
}

std::string list_of_quantities() {
  Rows rows{{"quantity", "unit", "in units", "what"}};
  for (const Quantity& each : all_quantities()) {
    const auto unit = [&](bool in_units) {
      const std::string text(unit_of(each.dimension, in_units));
      return text.empty() ? std::string("-") : text;
    };
    const std::string at = !each.at ? "" : *each.at == Dimension::length ? "=A" : "=L";
    rows.push_back({std::string(each.name) + at, unit(false), unit(true), std::string(each.meaning)});
  }
  return aligned(rows);
}

int make_sweep(Arguments& arguments) {
  if (arguments.flag("--list-quantities")) {
    arguments.finish();
    write_standard_output(list_of_quantities());
    return 0;
  }
  ShareHead head;
  read_part(arguments, head);
  const Threads threads = threads_of(arguments);
  const bool dry_run = arguments.flag("--dry-run");
  const auto output = arguments.file("--output");
  if (!output && !dry_run) arguments.reject("--output", "must be given: the table is written there");
  require_known_format(arguments, output);
  const std::string description = output.value_or("") + ".json";
  const std::vector<fs::path> inputs{arguments.text("PLAN").value_or(""), scene_name_of(arguments)};
  arguments.reject_overwriting("--output", output, inputs);
  if (output) arguments.reject_overwriting("--output", description, inputs);
  head.plan = plan_of(arguments);
  arguments.finish();
  if (dry_run) {
    print_size(head.plan, rows_of_part(head.plan, head.part, head.parts), threads);
    return 0;
  }
  require_writable(*output);
  require_writable(description);
  if (const std::string remark = remark_on_walls(head.plan); !remark.empty())
    warn("impact-damper sweep", remark);
  head.program = program_identity();
  const fs::path file = share_file(*output, head.part, head.parts);
  {
    ShareWriter share(file, head);
    make_share(share, head, file, threads);
  }
  if (arguments.given("--part")) return 0;
  join_shares({file}, *output);
  std::error_code kept;
  fs::remove(file, kept);
  return 0;
}

int merge(Arguments& arguments) {
  const std::vector<std::string> names = arguments.files("PART");
  const std::vector<fs::path> files(names.begin(), names.end());
  if (files.empty()) arguments.reject("PART", "must be given: the files that sweep --part has written");
  const auto output = arguments.required_file("--output", "the table is written there");
  arguments.reject_overwriting("--output", output, files);
  require_known_format(arguments, output);
  arguments.finish();
  if_interrupted_say(left_as_it_was(*output));
  join_shares(files, *output);
  return 0;
}

}  // namespace

Command sweep_command() {
  const Options own{
      input_option("PLAN", "FILE", "a JSON file that says what varies and what is kept (docs/sweeps.md)")};
  const Options options{
      flag_option("--list-quantities", "print what can be kept, with its units, and exit"),
      flag_option("--dry-run",
                  "only print how many runs there are, about how long they take and how\nlarge the table is"),
      {"--part", "K/N", "make only part K of N, in the file OUTPUT.part-K-of-N; merge joins the\nparts"},
      {"-o,--output", "FILE",
       "the table, CSV or, named *.h5, HDF5; beside it FILE.json says what it\nholds. Interrupted, the same "
       "command goes on"},
      threads_option()};
  return {
      .name = "sweep",
      .description =
          "Simulate a scene with many other numbers, and keep what is asked for of each run as one table.",
      .options = together({own, in_group("Sweep", options), options_of_plan()}),
      .footer =
          R"(Each run has a row: its number, the numbers that vary, the quantities, "end" and "problem". A run that
fails has the reason there, and the sweep goes on. The table has the same bytes with any number of threads
or parts, interrupted or not. Lengths given and kept are in units of the clearance, beside a scene in units
in mm, and given with their unit, time_to_amplitude=6mm; --list-quantities has the other units.

Examples:
  impact-damper sweep --until-amplitude 0.03 --vary mass_ratio=0.005:0.08:40:log \
    --vary restitution=0.4,0.6,0.8 --keep time_to_amplitude=0.6,impacts -o map.csv
  impact-damper sweep plan.json --part 3/8 -o map.csv)",
      .act = make_sweep};
}

Command merge_command() {
  return {.name = "merge",
          .description = "Join the parts that sweep --part has made into the table that one sweep makes.",
          .options = {input_option("PART", "FILE", "the parts, in any order"),
                      {"-o,--output", "FILE",
                       "the table, CSV or, named *.h5, HDF5; beside it FILE.json says what it\nholds"}},
          .footer =
              R"(Parts must be of one plan and one version of the program, whole, and none missing or doubled.

Example:
  impact-damper merge map.csv.part-* -o map.csv)",
          .act = merge,
          .takes_more = true};
}

}  // namespace impact_damper::cli
