// `compare`: compares a measured free decay with the simulation of a scene, and fits the scene's numbers to
// it.
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "application/measured/comparison.hpp"
#include "commands.hpp"
#include "drawing.hpp"

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;

std::vector<FitParameter> fitted_of(Arguments& arguments, bool has_impacts) {
  const auto list = arguments.text("--fit");
  if (!has_impacts && list && list != "none" && list != "damping_ratio")
    arguments.reject("--fit",
                     "must be none or damping_ratio with --without-impacts, got " + in_quotes(*list));
  if (!has_impacts && list != "none") return {FitParameter::damping_ratio};
  if (!list) return FitOptions{}.parameters;
  std::vector<FitParameter> parameters;
  if (*list == "none") return parameters;
  const std::vector<std::string_view> names = words_of<FitParameter>();
  for (const std::string_view name : parts_of(*list)) {
    const auto* const found = std::ranges::find(all_of<FitParameter>, name, name_of<FitParameter>);
    if (found == all_of<FitParameter>.end()) {
      arguments.reject("--fit", "must be none or " + listed(names, "or") + ", with commas between, got " +
                                    in_quotes(name) + did_you_mean(name, names));
    } else if (std::ranges::find(parameters, *found) != parameters.end()) {
      arguments.reject("--fit", "names " + std::string(name) + " twice");
    } else {
      parameters.push_back(*found);
    }
  }
  std::ranges::sort(parameters);
  return parameters;
}

std::string text_of(double value, int digits = 3) { return rounded_text(value, digits); }
std::string percent_of(double share) { return text_of(100 * share, 2) + " %"; }

std::string summary_of(const Comparison& c) {
  const Reduction& r = c.reduction;
  std::string text =
      filled("{}: {}, {} samples in {} s, {} Hz\n", fs::path(c.record_name).filename().string(),
             name_of(c.record.quantity), r.samples, text_of(r.duration), text_of(r.sampling_rate, 4)) +
      filled("  {}\n", c.record.read_as) +
      filled("  {} half cycles at {} Hz, {} to {} s, from {} to {} mm{}\n", r.time.size(),
             text_of(r.frequency, 4), text_of(r.time.front()), text_of(r.time.back()),
             text_of(r.amplitude.front()), text_of(r.amplitude.back()),
             r.ends_in_noise ? ", below which noise is too strong" : "") +
      filled("  noise {} mm, offset {} mm, drift {} mm; left out: ", text_of(r.noise), text_of(r.offset),
             text_of(r.drift)) +
      filled("{} half cycles clipped or flat, {} at its ends or with samples missing, {} unclear\n",
             r.clipped, r.in_gaps, r.unclear) +
      filled("  the scene: {} to {} Hz\n", text_of(c.lowest_frequency, 4), text_of(c.highest_frequency, 4));
  if (!c.bins.empty()) {
    Rows rows{{"amplitude, mm", "loss factor", "simulated"}};
    if (c.fit) rows[0].insert(rows[0].end(), {"fitted", "scatter"});
    for (std::size_t k = 0; k < c.bins.size(); ++k) {
      const LossBin& bin = c.bins[k];
      rows.push_back({text_of(bin.upper) + " to " + text_of(bin.lower),
                      text_of(bin.loss) + " +- " + percent_of(bin.error),
                      k < c.given.bins.size() ? text_of(c.given.bins[k]) : "-"});
      if (c.fit)
        rows.back().insert(rows.back().end(), {text_of(c.fit->loss[k]), percent_of(c.fit->scatter[k])});
    }
    text += "\n" + aligned(rows);
  }
  if (c.fit) {
    Rows rows{{"number", "scene", "best", "90 % interval", "searched"}};
    for (const FittedParameter& each : c.fit->parameters) {
      const auto range = [&](double low, double high) {
        return with_unit(text_of(low) + " to " + text_of(high), unit_of(each.parameter));
      };
      const auto [from, to] = std::minmax(each.searched_from, each.searched_to);
      rows.push_back({std::string(name_of(each.parameter)), text_of(value_of(c.given.scene, each.parameter)),
                      text_of(each.best), range(each.low, each.high), range(from, to)});
    }
    text += "\n" + aligned(rows) +
            filled("chi square {} with {} degrees of freedom, {} runs\n", text_of(c.fit->chi_square),
                   c.fit->degrees, c.fit->runs);
  }
  if (!c.remarks.empty()) text += "\n";
  for (const std::string& each : c.remarks) text += each + "\n";
  return text;
}

// --- Figures ----------------------------------------------------------------------------------------------

struct Columns {
  std::vector<double> x, y;
  std::vector<std::size_t> gaps;
};
void add_curve(Columns& all, const std::vector<double>& x, const std::vector<double>& y) {
  if (x.empty()) return;
  if (!all.x.empty()) all.gaps.push_back(all.x.size());
  all.x.insert(all.x.end(), x.begin(), x.end());
  all.y.insert(all.y.end(), y.begin(), y.end());
}

Drawing drawing_of(const Comparison& c, const std::string& name, const std::string& title, bool is_loss) {
  Drawing drawing{name, "own_" + name + ".gp", title, {}};
  drawing.table.header = {title, "Parameters: ", "Record: " + fs::path(c.record_name).filename().string(),
                          "Engine: " + std::string(name_of(c.engine))};
  const auto add = [&](const std::string& block, const std::string& legend, const Columns& columns) {
    if (columns.x.empty()) return;
    drawing.table.blocks.push_back(
        {.name = block,
         .columns = {{is_loss ? "amplitude" : "time",
                      is_loss ? "peak amplitude in mm" : "time of the peak in s", columns.x},
                     {legend, is_loss ? "loss factor per radian" : "peak amplitude in mm", columns.y}},
         .gaps = columns.gaps});
  };
  const auto simulated = [&](const SimulatedDecays& decays) {
    Columns all;
    for (std::size_t i = 0; i < decays.decays.size(); ++i) {
      if (is_loss) {
        add_curve(all, decays.losses[i].amplitude, decays.losses[i].eta);
      } else {
        add_curve(all, decays.decays[i].peak_time, decays.decays[i].amplitude);
      }
    }
    return all;
  };
  add("measured", "measured",
      is_loss ? Columns{c.loss.amplitude, c.loss.eta, {}}
              : Columns{c.reduction.time, c.reduction.amplitude, {}});
  if (!is_loss) add("others", "left out", {c.reduction.other_time, c.reduction.other_amplitude, {}});
  add("given", "the scene, simulated", simulated(c.given));
  if (c.fitted) add("fitted", "fitted", simulated(*c.fitted));
  return drawing;
}

int compare(Arguments& arguments) {
  const auto measured =
      arguments.required_file("--measured", "the record, as CSV with the columns t_s and x_mm");
  RecordOptions reading{arguments.text("--column"),           arguments.text("--time"),
                        arguments.number("--rate", above(0)), arguments.text("--sensitivity"),
                        arguments.number("--from"),           arguments.number("--to")};
  if (reading.from && reading.to && !(*reading.from < *reading.to))
    arguments.reject("--to", filled("must be > {} s of --from, got {}", *reading.from, *reading.to));
  if (reading.time && reading.rate) arguments.reject("--rate", "cannot be used with --time");
  const auto scene_name = arguments.text("--scene");
  if (!scene_name) arguments.reject("--scene", "must be given: the scene that the record is compared with");
  ComparisonOptions options;
  if (arguments.given("--without-impacts"))
    options.without_impacts =
        arguments.choice("--without-impacts", all_of<WithoutImpacts>, WithoutImpacts::locked);
  options.fit.parameters = fitted_of(arguments, !options.without_impacts);
  options.fit.threads = threads_of(arguments);
  const Engine engine = engine_of(arguments);
  const auto output = arguments.file("--output");
  reject_other_endings(arguments, "--output", output, {Format::json});
  arguments.reject_overwriting("--output", output, {scene_name.value_or(""), measured.value_or("")});
  const auto figures = figures_folder(arguments);
  arguments.finish();
  const SceneFile file = read_scene_file(*scene_name);
  require_one_linear_damper(file.scene, *scene_name);
  if (!file.in_units)
    throw InputError(std::vector{
        *scene_name +
        ": must be a scene in units, which a record can be compared with, got a dimensionless one"});
  if (file.scene.force_amplitude != 0)
    throw InputError(
        std::vector{*scene_name + ": /exciting_force: must be 0 or left out, only free decays are compared"});
  prepare_output(output);
  if (figures) require_gnuplot();
  const MeasuredRecord record = read_measured_record(*measured, reading);
  ProgressOnStderr progress("compare");
  const Comparison comparison = saying_options([&] {
    return compared(*measured, record, *scene_name, *file.in_units, engine, options, std::ref(progress));
  });
  if (figures)
    write_figures(
        *figures,
        drawn({drawing_of(comparison, "measured_decay", "Decay, measured and simulated", false),
               drawing_of(comparison, "measured_loss", "Loss factor, measured and simulated", true)},
              progress));
  if (output) write_output(output, comparison_text(comparison));
  if (!is_standard_output(output)) write_standard_output(summary_of(comparison));
  return 0;
}

}  // namespace

Command compare_command() {
  return {
      .name = "compare",
      .description =
          "Compare a measured free decay with the simulation of a scene, and fit the scene's numbers to it.",
      .options =
          together({{input_option("--measured", "FILE",
                                  "the record: rows of numbers below heads with units, as time (s) and "
                                  "x_mm, or as most\ninstruments write them; UFF 58; WAV (docs/compare.md)"),
                     {"--column", "N|NAME[:UNIT]",
                      "the column with the motion, where several could be it, and its unit where no "
                      "head\ntells it: 3:mm, or m, um, in, mm/s, m/s^2, g, V and so on"},
                     {"--time", "N|NAME[:UNIT]", "the column with the time: 1:ms, or s, us"},
                     {"--rate", "HZ", "samples in a second, in place of a column with the time"},
                     {"--sensitivity", "S", "of a record in volts, counts or full scale (FS): 100 mV/g"},
                     {"--from", "T", "leave out what is before, in s of the record"},
                     {"--to", "T", "leave out what is behind"},
                     input_option("--scene", "FILE", "the scene, in units and without a force"),
                     {"--fit", "LIST",
                      "what is fitted, with commas between: restitution, damping_ratio, "
                      "clearance\n(these are the default), secondary_mass, friction_coefficient, up "
                      "to\nfour; or none"},
                     {"--without-impacts", "locked|absent",
                      "the record is one without impacts, the secondary mass locked to the primary one\nor "
                      "taken out: fits the damping ratio alone"},
                     {"--figures", "FOLDER",
                      "draw amplitude over time and loss factor over amplitude there, "
                      "as\nmeasured_decay.svg and measured_loss.svg"},
                     {"-o,--output", "FILE", "write all numbers there, as JSON"},
                     threads_option()},
                    engine_options()}),
      .footer =
          R"(A decay is chaotic: runs that hardly differ scatter. The fit simulates some 10 000 decays with other numbers, and its
intervals allow for the scatter as well as for the record's noise (docs/compare.md). Friction, inclination and drag of the
scene count as known.

Example:
  impact-damper compare --measured decay.csv --scene data/examples/mast.json --figures . -o comparison.json)",
      .act = compare};
}

}  // namespace impact_damper::cli
