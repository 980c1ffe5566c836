#include "application/reproduction/series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <variant>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

constexpr std::array ratios{Varied::mass_ratio, Varied::restitution, Varied::damping_ratio};

double of(const Scene& scene, Varied varied) {
  switch (varied) {
    case Varied::mass_ratio:
      return scene.damper().mass_ratio;
    case Varied::damping_ratio:
      return scene.damping_ratio;
    case Varied::restitution:
      return scene.damper().restitution;
  }
  return 0;
}

// Returns a ratio in percent, without the rounding error of the product by 100.
std::string percent(double ratio) {
  return number_text(std::round(ratio * 1e12) / 1e10) + (ratio == 0 ? "" : " %");
}

// Returns "ν = 2 %", as legends and subtitles show it.
std::string equation(const Scene& scene, Varied varied) {
  if (varied == Varied::restitution) return "e = " + number_text(scene.damper().restitution);
  return (varied == Varied::mass_ratio ? "ν = " : "ζ = ") + percent(of(scene, varied));
}

// The engine in words, for the line under the title; each run has a step of its own.
struct EngineWords {
  const std::vector<const FigureRun*>& runs;

  std::string operator()(const Exact&) const { return "exact engine"; }
  std::string operator()(const Restitution&) const { return "restitution model"; }
  std::string operator()(const Cem&) const {
    std::vector<double> steps;
    for (const FigureRun* source : runs) {
      const auto& step = std::get<Cem>(source->run.engine).time_step;
      if (step) steps.push_back(*step);
    }
    if (steps.empty()) return "component element method";
    const auto [least, most] = std::ranges::minmax(steps);
    return "component element method, step " + rounded_text(least, 3) +
           (least < most ? " to " + rounded_text(most, 3) : "");
  }
};

// Returns the line under the title: what all curves have in common, and what distinguishes one.
std::string subtitle(const Figure& figure, const std::vector<const FigureRun*>& runs, const Scene& scene) {
  std::string text;
  for (const Varied varied : ratios) {
    if (figure.varied == varied) continue;
    text += (text.empty() ? "" : ", ") + equation(scene, varied);
  }
  for (std::size_t i = 0; i < figure.curves.size(); ++i) {
    const int span = figure.curves[i].loss_factor.half_cycles;
    if (!figure.varied || span == LossFactorOptions{}.half_cycles) continue;
    text += "; " + equation(runs[i]->run.scene, *figure.varied) + " averaged over " + std::to_string(span) +
            " half cycles";
  }
  // The exact engine is the default; a figure made with another one says so.
  if (!runs.empty() && !std::holds_alternative<Exact>(runs[0]->run.engine)) {
    text += std::string(figure.responses.empty() ? "; " : "; free decay: ") +
            std::visit(EngineWords{runs}, runs[0]->run.engine);
  }
  return text;
}

// Throws unusable() unless the scene has the ratios of `wanted`, but for the one that the figure varies, and
// its walls, if they are not rigid.
void require_same_ratios(const Figure& figure, const std::filesystem::path& file, const Scene& scene,
                         const Scene& wanted, const Engine& engine, const std::string& whose) {
  const auto reject = [&](std::string_view number) {
    throw unusable(figure, file, "must have the same " + std::string(number) + " as " + whose);
  };
  for (const Varied same : ratios)
    if (figure.varied != same && of(scene, same) != of(wanted, same)) reject(name_of(same));
  if (!has_rigid_walls(engine) && scene.damper().wall_stiffness != wanted.damper().wall_stiffness)
    reject("wall_stiffness");
}

void check_comparable(const Figure& figure, const std::vector<const FigureRun*>& runs) {
  for (const FigureRun* other : runs) {
    const std::string first = runs[0]->file.string();
    if (name_of(other->run.engine) != name_of(runs[0]->run.engine))
      throw unusable(figure, other->file, "comes from another engine than " + first);
    require_same_ratios(figure, other->file, other->run.scene, runs[0]->run.scene, runs[0]->run.engine,
                        first);
  }
}

// Returns the request of a response without its scene, as text.
std::string question_of(const Response& response) {
  std::string text;
  for (const auto& [pointer, part] : asked_of(response))
    if (!pointer.starts_with("/scene/"))
      text.append(text.empty() ? "" : ", ").append(pointer).append(" ").append(part);
  return text;
}

void add_decay_block(const Figure& figure, const FigureRun& source, const std::string& number,
                     const std::string& legend, Table& table) {
  const HalfCycles& rows = half_cycles_of(figure, source);
  table.add(
      {.name = "curve-" + number,
       .columns = {{"time", "time of the peak, in units of 1/Omega_n", rows.peak_time},
                   {legend, "peak amplitude of the half cycle, divided by the clearance", rows.amplitude}}});
}

// With A eta / nu constant the amplitude falls on a straight line, dA/dt = -rate nu. The rate of each curve
// is its chord's, from the first peak to the first that is not above Figure::down_to; the line has the mean
// of the rates and begins at the mean of the first peaks.
void add_law_blocks(const Figure& figure, const std::vector<const FigureRun*>& sources, Table& table) {
  TableBlock law{.name = "law",
                 .notes = {"one row for each curve, from its first peak to the first that is not above " +
                           number_text(*figure.down_to)},
                 .columns = {{"mass ratio", "nu = m/M"}, {"rate", "average of -dA/dt / nu"}}};
  double begin = 0, amplitude = 0, rate = 0;  // sums, then means
  for (const FigureRun* source : sources) {
    const HalfCycles& rows = half_cycles_of(figure, *source);
    const auto end = static_cast<std::size_t>(
        std::ranges::find_if(rows.amplitude, [&](double a) { return a <= *figure.down_to; }) -
        rows.amplitude.begin());
    if (end == 0) return;  // it begins there: no chord
    const double nu = source->run.scene.damper().mass_ratio;
    law.add_row(
        {nu, (rows.amplitude[0] - rows.amplitude[end]) / (nu * (rows.peak_time[end] - rows.peak_time[0]))});
    begin += nu * rows.peak_time[0];
    amplitude += rows.amplitude[0];
    rate += law.columns[1].values.back();
  }
  for (double* sum : {&begin, &amplitude, &rate}) *sum /= static_cast<double>(sources.size());
  table.add(std::move(law));
  table.add({.name = "line",
             .notes = {"dA/dt = -rate nu with the mean of the rates"},
             .columns = {{"scaled time", "nu t", {begin, begin + amplitude / rate}},
                         {"dA/dt = −" + rounded_text(rate, 2) + " ν",
                          "amplitude, divided by the clearance",
                          {amplitude, 0}}}});
}

// Returns the table of the scenes' runs, one for each curve, and of the responses.
Table table_of(const Figure& figure, const std::vector<const FigureRun*>& sources,
               const std::vector<const FigureResponse*>& found) {
  const Scene& scene = sources.empty() ? scene_of(found.at(0)->response) : sources[0]->run.scene;
  check_comparable(figure, sources);
  for (const FigureResponse* source : found) {  // forces may differ
    const Engine& engine =
        std::visit([](const auto& each) -> const Engine& { return each.engine; }, source->response);
    require_same_ratios(figure, source->file, scene_of(source->response), scene, engine,
                        "the figure's others");
  }

  Table table{header_of(figure, subtitle(figure, sources, scene)), {}};
  for (const std::string& name : scenes_of(figure)) {
    const auto drawn = std::ranges::find(figure.curves, name, &FigureCurve::scene) - figure.curves.begin();
    const Run& run = sources[static_cast<std::size_t>(drawn)]->run;
    table.header.push_back("Scene " + name + ": " + scene_text(run.scene));
    table.header.push_back("  engine: " + options_text(run.engine));
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Response& response = found[i]->response;
    table.header.push_back("Response " + figure.responses[i] + ": " + scene_text(scene_of(response)));
    table.header.push_back("  " + question_of(response));
  }
  switch (figure.table) {
    case TableKind::motion:
      add_motion_blocks(figure, *sources[0], table);
      break;
    case TableKind::decay:
    case TableKind::loss_factor:
      for (std::size_t i = 0; i < sources.size(); ++i) {
        const std::string number = std::to_string(i + 1);
        const std::string legend =
            figure.varied ? equation(sources[i]->run.scene, *figure.varied) : figure.curves[i].scene;
        if (figure.table == TableKind::decay)
          add_decay_block(figure, *sources[i], number, legend, table);
        else
          add_loss_block(figure, figure.curves[i], *sources[i], number, legend, table);
      }
      if (figure.table == TableKind::decay && figure.down_to) add_law_blocks(figure, sources, table);
      if (!figure.range.empty()) add_spread_block(figure, table);
      if (figure.table == TableKind::loss_factor) add_loss_theory_blocks(figure, sources, table);
      break;
    case TableKind::phase:
      add_phase_blocks(figure, *sources[0], table);
      break;
    case TableKind::response:
      add_response_blocks(figure, found, table);
      break;
    case TableKind::largest_response:
      add_largest_blocks(figure, *sources[0], found, table);
      break;
    case TableKind::response_map:
      add_map_blocks(figure, *found[0], table);
      break;
    case TableKind::design_charts:
    case TableKind::damper_sets:
    case TableKind::components:
    case TableKind::drawing:
      break;
  }
  return table;
}

}  // namespace

std::string options_text(const Engine& engine) {
  std::string text(name_of(engine));
  for_each_option(engine, [&](const OptionInfo& option, const auto& value) {
    const std::string given = option_text(value);
    if (option.decides_motion && !given.empty()) text += " " + std::string(option.name) + "=" + given;
  });
  return text;
}

std::vector<std::string> header_of(const Figure& figure, const std::string& parameters) {
  return {"Figure " + figure.number + ": " + figure.title, "Parameters: " + parameters,
          "Script: " + figure.script};
}

InputError unusable(const Figure& figure, const std::filesystem::path& file, const std::string& why) {
  return InputError({"figure " + figure.number + ": " + file.string() + ": " + why});
}

const HalfCycles& half_cycles_of(const Figure& figure, const FigureRun& source) {
  if (!source.run.half_cycles) throw unusable(figure, source.file, "holds no half_cycles");
  const HalfCycles& rows = *source.run.half_cycles;
  if (rows.amplitude.empty()) throw unusable(figure, source.file, "holds not one half cycle");
  for (const auto* column : {&rows.zero_crossing, &rows.peak_time, &rows.amplitude}) {
    for (const double value : *column) {
      if (!std::isfinite(value)) throw unusable(figure, source.file, "holds a half cycle that is not finite");
    }
  }
  const double least = *std::ranges::min_element(rows.amplitude);
  if (figure.down_to && !(least <= *figure.down_to)) {
    throw unusable(figure, source.file,
                   "is too short: must reach an amplitude of " + number_text(*figure.down_to) +
                       ", ends after " + std::to_string(rows.amplitude.size()) + " half cycles at " +
                       number_text(rows.amplitude.back()) + " (stopped by " +
                       std::string(name_of(source.run.stop_reason)) + ")");
  }
  return rows;
}

void require_impacts(const Figure& figure, const FigureRun& source) {
  if (!source.run.impacts) throw unusable(figure, source.file, "holds no impacts");
  if (!source.run.contacts) throw unusable(figure, source.file, "holds no contacts");
}

std::int64_t members_shown(const Figure& figure, const std::string& scene) {
  std::int64_t members = 0;
  for (const FigureCurve& curve : figure.curves)
    if (curve.scene == scene) members = std::max(members, curve.ensemble);
  return members;
}

Table figure_table(const Figure& figure, const FigureRuns& runs, const FigureResponses& responses,
                   const FigureSweeps& sweeps) {
  std::filesystem::path first_file;
  Table table;
  if (figure.table == TableKind::design_charts) {
    first_file = sweeps.at(figure.plan).file;
    table = design_table(figure, sweeps.at(figure.plan));
  } else if (figure.table == TableKind::damper_sets) {
    first_file = runs.at(figure.curves.front().run).file;
    table = damper_sets_table(figure, runs);
  } else if (figure.table == TableKind::components) {
    first_file = runs.at(figure.curves.front().run).file;
    table = components_table(figure, runs);
  } else {
    std::vector<const FigureRun*> sources;
    for (const FigureCurve& curve : figure.curves) sources.push_back(&runs.at(curve.scene));
    std::vector<const FigureResponse*> found;
    for (const std::string& name : figure.responses) found.push_back(&responses.at(name));
    first_file = sources.empty() ? found.at(0)->file : sources[0]->file;
    table = table_of(figure, sources, found);
  }
  try {
    check(table);
  } catch (const std::domain_error& error) {
    throw unusable(figure, first_file, error.what());
  }
  return table;
}

}  // namespace impact_damper
