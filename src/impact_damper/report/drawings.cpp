#include "impact_damper/report/drawings.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "impact_damper/files/number_text.hpp"
#include "impact_damper/files/scene_file.hpp"
#include "impact_damper/paper/series_blocks.hpp"

namespace impact_damper {
namespace {

constexpr std::size_t least_points = 3, most_rows_drawn = 4000;

bool is_there(const Table& table, std::string_view block) {
  return std::ranges::find(table.blocks, block, &TableBlock::name) != table.blocks.end();
}

// Rows that no picture tells apart only make it heavy.
void thin(Drawing& drawing) {
  std::size_t longest = 0;
  for (const TableBlock& block : drawing.table.blocks)
    longest = std::max(longest, block.columns[0].values.size());
  const std::size_t every = drawing.every = (longest + most_rows_drawn - 1) / most_rows_drawn;
  if (every <= 1) return;
  for (TableBlock& block : drawing.table.blocks) {
    if (block.columns[0].values.size() <= most_rows_drawn) continue;
    block.notes.push_back("one row of " + std::to_string(every));
    for (std::size_t& row : block.gaps) row = (row + every - 1) / every;
    block.gaps.erase(std::unique(block.gaps.begin(), block.gaps.end()), block.gaps.end());
    for (TableColumn& column : block.columns) {
      std::vector<double> kept;
      for (std::size_t i = 0; i < column.values.size(); i += every) kept.push_back(column.values[i]);
      column.values = std::move(kept);
    }
  }
}

Drawing drawing_of(const Findings& findings, const std::string& name, const std::string& title) {
  const Subject& subject = findings.subject;
  Drawing drawing{name, "own_" + name + ".gp", title, {}};
  drawing.table.header = {title, "Parameters: ", "Scene: " + scene_text(subject.scene),
                          "Engine: " + std::string(name_of(subject.engine))};
  const auto ratio = [](double value) { return rounded_text(value, 3); };
  std::string& parameters = drawing.table.header[1];
  parameters += "ν = " + ratio(subject.scene.mass_ratio) + ", e = " + ratio(subject.scene.restitution) +
                ", ζ = " + ratio(subject.scene.damping_ratio);
  if (!std::holds_alternative<Exact>(subject.engine))
    parameters += "; " + std::string(name_of(subject.engine)) + " engine";
  if (subject.scales) {
    drawing.table.blocks.push_back({.name = "scales",
                                    .columns = {{"time", "1/Omega_n in s", {subject.scales->time()}},
                                                {"length", "epsilon in mm", {subject.scales->length}}}});
  }
  return drawing;
}

std::optional<Drawing> decay(const Findings& findings) {
  const HalfCycles& rows = *findings.run.half_cycles;
  if (rows.amplitude.size() < least_points) return std::nullopt;
  Drawing drawing =
      drawing_of(findings, "decay", findings.forced() ? "Amplitude over time" : "Decay of the amplitude");
  drawing.table.blocks.push_back(
      {.name = "curve",
       .columns = {{"time", "time of the peak, by 1/Omega_n", rows.peak_time},
                   {"peak amplitude", "of the half cycle, by epsilon", rows.amplitude}}});
  if (findings.others.empty()) return drawing;
  TableBlock band{
      .name = "band",
      .columns = {{"time", "time of the peak, by 1/Omega_n", {}},
                  {"least", "amplitude of the ensemble, by epsilon", {}},
                  {std::to_string(findings.others.size() + 1) + " releases", "greatest amplitude", {}}}};
  for (std::size_t row = 0; row < findings.spread.size(); ++row) {
    double least = rows.amplitude[row], greatest = least;
    for (const Run& other : findings.others) {
      least = std::min(least, other.half_cycles->amplitude[row]);
      greatest = std::max(greatest, other.half_cycles->amplitude[row]);
    }
    band.columns[0].values.push_back(rows.peak_time[row]);
    band.columns[1].values.push_back(least);
    band.columns[2].values.push_back(greatest);
  }
  if (!findings.spread.empty()) drawing.table.blocks.push_back(std::move(band));
  return drawing;
}

std::optional<Drawing> loss(const Findings& findings) {
  constexpr std::size_t least = 10;
  if (findings.loss.eta.size() < least || !findings.best) return std::nullopt;
  Drawing drawing = drawing_of(findings, "loss", "Loss factor");
  Figure figure;
  figure.number = drawing.name;
  figure.table = TableKind::loss_factor;
  figure.curves = {{"given", {}}};  // a file may be called anything, a line break among it
  figure.ordinate = LossOrdinate::eta;
  FigureRun source{"given", findings.run};
  add_loss_block(figure, figure.curves[0], source, "1", "simulated", {}, drawing.table);
  const auto curve = std::ranges::find(drawing.table.blocks, "curve-1", &TableBlock::name);
  if (curve->columns[0].values.size() < least) return std::nullopt;
  if (!findings.others.empty()) {
    add_band_block(figure, figure.curves[0], findings.run, findings.others, "1", drawing.table);
    if (drawing.table.blocks.back().columns[0].values.empty()) drawing.table.blocks.pop_back();
  }
  // The closed forms are for zeta = 0. What the primary system's own damping takes comes on top of them.
  const double viscous = 2 * std::exchange(source.run.scene.damping_ratio, 0);
  const std::size_t before = drawing.table.blocks.size();
  add_loss_theory_blocks(figure, {&source}, drawing.table);
  for (std::size_t i = before; i < drawing.table.blocks.size(); ++i) {
    drawing.table.blocks[i].notes.emplace_back("2 zeta is put on it");
    for (double& eta : drawing.table.blocks[i].columns[1].values) eta += viscous;
  }
  return drawing;
}

std::optional<Drawing> phase(const Findings& findings) {
  if (findings.run.half_cycles->amplitude.empty()) return std::nullopt;
  Drawing drawing = drawing_of(findings, "phase", "Phase of the impacts");
  add_phase_parts(findings.run, drawing.table);
  if (!is_there(drawing.table, "impacts")) return std::nullopt;
  return drawing;
}

std::optional<Drawing> motion(const Findings& findings, const std::optional<MotionWindow>& window,
                              const std::string& name, const std::string& title) {
  if (!window) return std::nullopt;
  Drawing drawing = drawing_of(findings, name, title);
  drawing.script = "own_motion.gp";
  add_motion_parts(findings.run, window->first, window->last, drawing.table);
  return drawing;
}

std::optional<Drawing> prediction(const Findings& findings) {
  if (findings.others.empty() || findings.spread.size() < least_points) return std::nullopt;
  Drawing drawing = drawing_of(findings, "prediction", "How far releases part");
  TableBlock curve{.name = "curve",
                   .columns = {{"time", "time of the peak, by 1/Omega_n", {}},
                               {"spread", "of the releases' amplitudes, percent of their median", {}}}};
  for (std::size_t row = 0; row < findings.spread.size(); ++row) {
    // Equal to the last bit: below all that a logarithmic axis shows.
    if (!(findings.spread[row] > 0)) continue;
    curve.columns[0].values.push_back(findings.run.half_cycles->peak_time[row]);
    curve.columns[1].values.push_back(100 * findings.spread[row]);
  }
  if (curve.columns[0].values.size() < least_points) return std::nullopt;
  drawing.table.blocks.push_back(std::move(curve));
  return drawing;
}

}  // namespace

std::vector<Drawing> drawings_of(const Findings& findings) {
  std::vector<Drawing> drawings;
  const auto add = [&](std::optional<Drawing> drawing) {
    if (!drawing) return;
    thin(*drawing);
    drawings.push_back(std::move(*drawing));
  };
  add(decay(findings));
  if (!findings.forced()) add(loss(findings));
  add(phase(findings));
  add(motion(findings, findings.begin, "begin", "The motion, from the release on"));
  add(motion(findings, findings.chosen, "best",
             findings.forced() ? "The motion, at the end" : "The motion, where the damping is best"));
  add(prediction(findings));
  return drawings;
}

}  // namespace impact_damper
