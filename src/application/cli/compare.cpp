// `compare`: compares a measured free decay with the simulation of a scene, and fits the scene's numbers to
// it.
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "application/measured/comparison.hpp"
#include "commands.hpp"
#include "drawing.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"
#include "output.hpp"
#include "progress.hpp"
#include "scene_arguments.hpp"
#include "text_table.hpp"

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;

std::vector<FitParameter> fitted_of(Arguments& arguments) {
  FitOptions otherwise;
  const auto list = arguments.text("--fit");
  if (!list) return otherwise.parameters;
  std::vector<FitParameter> parameters;
  if (*list == "none") return parameters;
  const std::vector<std::string_view> names = words_of<FitParameter>();
  for (std::size_t begin = 0; begin <= list->size();) {
    const std::size_t end = std::min(list->find(',', begin), list->size());
    const std::string_view name = std::string_view(*list).substr(begin, end - begin);
    const auto* const found = std::ranges::find(all_of<FitParameter>, name, name_of<FitParameter>);
    if (found == all_of<FitParameter>.end()) {
      const auto meant = nearest(name, names);
      arguments.reject("--fit", "must be none or " + listed(names, "or") + ", with commas between, got " +
                                    in_quotes(name) +
                                    (meant ? ", did you mean " + std::string(*meant) + "?" : ""));
    } else if (std::ranges::find(parameters, *found) != parameters.end()) {
      arguments.reject("--fit", "names " + std::string(name) + " twice");
    } else {
      parameters.push_back(*found);
    }
    begin = end + 1;
  }
  std::ranges::sort(parameters);
  return parameters;
}

std::string text_of(double value, int digits = 3) { return rounded_text(value, digits); }

std::string summary_of(const Comparison& c) {
  const Reduction& r = c.reduction;
  const std::string unit(unit_of(c.record.quantity));
  std::string text = fs::path(c.record_name).filename().string() + ": " +
                     std::string(name_of(c.record.quantity)) + ", " + std::to_string(r.samples) +
                     " samples in " + text_of(r.duration) + " s, " + text_of(r.sampling_rate, 4) + " Hz\n";
  text += "  " + std::to_string(r.time.size()) + " half cycles at " + text_of(r.frequency, 4) + " Hz, from " +
          text_of(r.amplitude.front()) + " to " + text_of(r.amplitude.back()) + " mm" +
          (r.ends_in_noise ? ", below which noise is too strong" : "") + "\n";
  text += "  noise " + text_of(r.noise) + " " + unit + ", offset " + text_of(r.offset) + " " + unit +
          ", drift " + text_of(r.drift) + " " + unit + "; left out: " + std::to_string(r.clipped) +
          " half cycles clipped or flat, " + std::to_string(r.in_gaps) +
          " at its ends or with samples missing, " + std::to_string(r.unclear) + " unclear\n";
  text +=
      "  the scene: " + text_of(c.lowest_frequency, 4) + " to " + text_of(c.highest_frequency, 4) + " Hz\n";
  if (!c.bins.empty()) {
    std::vector<std::vector<std::string>> rows{{"amplitude, mm", "loss factor", "simulated"}};
    if (c.fit) rows[0].insert(rows[0].end(), {"fitted", "scatter"});
    for (std::size_t k = 0; k < c.bins.size(); ++k) {
      const LossBin& bin = c.bins[k];
      rows.push_back({text_of(bin.upper) + " to " + text_of(bin.lower),
                      text_of(bin.loss) + " +- " + text_of(100 * bin.error, 2) + " %",
                      k < c.given.bins.size() ? text_of(c.given.bins[k]) : "-"});
      if (c.fit) {
        rows.back().push_back(text_of(c.fit->loss[k]));
        rows.back().push_back(text_of(100 * c.fit->scatter[k], 2) + " %");
      }
    }
    text += "\n" + aligned(rows);
  }
  if (c.fit) {
    std::vector<std::vector<std::string>> rows{{"number", "scene", "best", "90 % interval", "searched"}};
    for (const FittedParameter& each : c.fit->parameters) {
      const auto range = [&](double low, double high) {
        return with_unit(text_of(low) + " to " + text_of(high), unit_of(each.parameter));
      };
      rows.push_back({std::string(name_of(each.parameter)), text_of(value_of(c.given.scene, each.parameter)),
                      text_of(each.best), range(each.low, each.high),
                      range(std::min(each.searched_from, each.searched_to),
                            std::max(each.searched_from, each.searched_to))});
    }
    text += "\n" + aligned(rows) + "chi square " + text_of(c.fit->chi_square) + " with " +
            std::to_string(c.fit->degrees) + " degrees of freedom, " + std::to_string(c.fit->runs) +
            " runs\n";
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
  Columns measured;
  if (is_loss) {
    add_curve(measured, c.loss.amplitude, c.loss.eta);
  } else {
    add_curve(measured, c.reduction.time, c.reduction.amplitude);
  }
  add("measured", "measured", measured);
  add("given", "the scene, simulated", simulated(c.given));
  if (c.fitted) add("fitted", "fitted", simulated(*c.fitted));
  return drawing;
}

int compare(Arguments& arguments) {
  const auto measured = arguments.file("--measured");
  if (!measured)
    arguments.reject("--measured", "must be given: the record, a CSV file with the columns t_s and x_mm");
  const auto scene_name = arguments.text("--scene");
  if (!scene_name) arguments.reject("--scene", "must be given: the scene that the record is compared with");
  ComparisonOptions options;
  options.fit.parameters = fitted_of(arguments);
  options.fit.threads = threads_of(arguments);
  const Engine engine = engine_of(arguments);
  const auto output = arguments.file("--output"), figures = arguments.file("--figures");
  reject_other_endings(arguments, "--output", output, {Format::json});
  arguments.reject_overwriting("--output", output, {scene_name.value_or(""), measured.value_or("")});
  if (figures && !fs::is_directory(*figures))
    arguments.reject("--figures", "must be an existing folder, got " + in_quotes(*figures));
  arguments.finish();
  const SceneFile file = read_scene_file(*scene_name);
  require_one_damper(file.scene, *scene_name);
  if (!file.in_units)
    throw InputError(std::vector{
        *scene_name +
        ": must be a scene in units, which a record can be compared with, got a dimensionless one"});
  if (file.scene.force_amplitude != 0)
    throw InputError(
        std::vector{*scene_name + ": /exciting_force: must be 0 or left out, only free decays are compared"});
  prepare_output(output);
  if (figures) require_gnuplot();
  const MeasuredRecord record = read_measured_record(*measured);
  ProgressOnStderr progress("compare");
  const Comparison comparison = saying_options([&] {
    return compared(*measured, record, *scene_name, *file.in_units, engine, options,
                    [&](const std::string& doing) { progress(doing); });
  });
  if (figures) {
    DrawingBoard board;
    for (const bool is_loss : {false, true}) {
      const Drawing drawing =
          is_loss ? drawing_of(comparison, "measured_loss", "Loss factor, measured and simulated", true)
                  : drawing_of(comparison, "measured_decay", "Decay, measured and simulated", false);
      progress("drawing figure " + drawing.name);
      write_file(fs::path(*figures) / (drawing.name + ".svg"), board.draw(drawing));
    }
  }
  if (output) write_output(output, comparison_text(comparison));
  if (!is_standard_output(output)) write_standard_output(summary_of(comparison));
  return 0;
}

}  // namespace

Command compare_command() {
  Command command{
      .name = "compare",
      .description =
          "Compare a measured free decay with the simulation of a scene, and fit the scene's numbers to it."};
  command.options = {
      input_option("--measured", "FILE",
                   "the record, CSV: time t_s or t_ms; displacement x_mm, x_m or x_um, or\nacceleration "
                   "a_m_per_s2, a_mm_per_s2 or a_g"),
      input_option("--scene", "FILE", "the scene, in units and without a force"),
      {"--fit", "LIST",
       "what is fitted, with commas between: restitution, damping_ratio, clearance\n(these are the default), "
       "secondary_mass; or none"},
      {"--figures", "FOLDER",
       "draw amplitude over time and loss factor over amplitude there, as\nmeasured_decay.svg and "
       "measured_loss.svg"},
      {"-o,--output", "FILE", "write all numbers there, as JSON"},
      threads_option()};
  for (const Option& option : engine_options()) command.options.push_back(option);
  command.footer =
      "A decay is chaotic: runs that hardly differ scatter. The fit simulates some 10 000 decays with other "
      "numbers, and "
      "its\nintervals allow for the scatter as well as for the record's noise (docs/compare.md).\n\n"
      "Example:\n"
      "  impact-damper compare --measured decay.csv --scene data/examples/mast.json --figures . -o "
      "comparison.json";
  command.act = compare;
  return command;
}

}  // namespace impact_damper::cli
