#include "application/report/drawings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "application/reproduction/series.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

constexpr std::size_t least_points = 3, most_rows_drawn = 4000;

// Leaves out rows that no picture distinguishes, but which make it large.
void thin(Drawing& drawing) {
  std::size_t longest = 0;
  for (const TableBlock& block : drawing.table.blocks) longest = std::max(longest, block.rows());
  const std::size_t every = drawing.every = (longest + most_rows_drawn - 1) / most_rows_drawn;
  if (every <= 1) return;
  for (TableBlock& block : drawing.table.blocks) {
    if (block.rows() <= most_rows_drawn) continue;
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

// of_one: the one of several dampers that is drawn, with lengths divided by its clearance.
Drawing drawing_of(const Findings& findings, const std::string& name, const std::string& what,
                   std::optional<std::size_t> of_one = std::nullopt) {
  const Subject& subject = findings.subject;
  const double unit = of_one ? subject.scene.dampers[*of_one].clearance : 1;
  const std::string title = of_one ? what + ", damper " + std::to_string(*of_one + 1) : what;
  Drawing drawing{name, "own_" + name + ".gp", title, {}};
  drawing.table.header = {title, "Parameters: ", "Scene: " + scene_text(subject.scene),
                          "Engine: " + std::string(name_of(subject.engine))};
  const auto ratio = [](double value) { return rounded_text(value, 3); };
  std::string& parameters = drawing.table.header[1];
  if (findings.several()) {
    parameters += std::to_string(subject.scene.dampers.size()) +
                  " dampers, together ν = " + ratio(secondary_mass(subject.scene));
  } else {
    parameters += "ν = " + ratio(subject.scene.damper().mass_ratio) +
                  ", e = " + ratio(subject.scene.damper().restitution);
  }
  parameters += ", ζ = " + ratio(subject.scene.damping_ratio);
  const auto component = [&](const char* symbol, double value) {
    if (value != 0) parameters += std::string(", ") + symbol + " = " + ratio(value);
  };
  if (!findings.several()) {
    component("φ", subject.scene.damper().friction);
    component("d", subject.scene.damper().drag);
  }
  component("γ", subject.scene.weight);
  if (findings.forced())
    parameters +=
        ", f = " + ratio(subject.scene.force_amplitude) + ", ω = " + ratio(subject.scene.force_frequency);
  if (!std::holds_alternative<Exact>(subject.engine))
    parameters += "; " + std::string(name_of(subject.engine)) + " engine";
  if (const auto& scales = subject.scales) {
    drawing.table.add(
        {.name = "scales",
         .columns = {{"time", "1/Omega_n in s", {scales->of(Dimension::time)}},
                     {"length", "unit of length in mm", {scales->length * unit}},
                     {"frequency", "Omega_n/(2 pi) in Hz", {scales->of(Dimension::frequency)}}}});
  }
  // For several dampers lengths are not divided by a clearance.
  if (findings.several() && !of_one)
    drawing.table.add(
        {.name = "dampers", .columns = {{"dampers", "how many", {double(subject.scene.dampers.size())}}}});
  return drawing;
}

std::optional<std::size_t> one_of_several(const Findings& findings, std::size_t number) {
  return findings.several() ? std::optional(number) : std::nullopt;
}

std::optional<Drawing> decay(const Findings& findings) {
  const HalfCycles& rows = *findings.run.half_cycles;
  if (rows.amplitude.size() < least_points) return std::nullopt;
  Drawing drawing =
      drawing_of(findings, "decay", findings.forced() ? "Amplitude over time" : "Decay of the amplitude");
  drawing.table.add(
      {.name = "curve",
       .columns = {{"time", "time of the peak, in units of 1/Omega_n", rows.peak_time},
                   {"peak amplitude", "of the half cycle, in units of epsilon", rows.amplitude}}});
  if (findings.others.empty()) return drawing;
  TableBlock band{
      .name = "band",
      .columns = {{"time", "time of the peak, in units of 1/Omega_n"},
                  {"least", "amplitude of the ensemble, in units of epsilon"},
                  {std::to_string(findings.others.size() + 1) + " releases", "greatest amplitude"}}};
  for (std::size_t row = 0; row < findings.spread.size(); ++row) {
    double least = rows.amplitude[row], greatest = least;
    for (const Run& other : findings.others) {
      least = std::min(least, other.half_cycles->amplitude[row]);
      greatest = std::max(greatest, other.half_cycles->amplitude[row]);
    }
    band.add_row({rows.peak_time[row], least, greatest});
  }
  drawing.table.add_if_any(std::move(band));
  return drawing;
}

// Returns the least and greatest loss factor of all releases over amplitudes that all of them have.
TableBlock loss_band(const Findings& findings) {
  TableBlock block{.name = "band-1",
                   .columns = {{"amplitude", "peak amplitude A, in units of epsilon"},
                               {"least", "eta of the ensemble"},
                               {std::to_string(findings.others.size() + 1) + " releases", "greatest eta"}}};
  if (findings.losses_of_others.empty()) return block;
  std::vector<BandCurve> members{{findings.loss.amplitude, findings.loss.eta}};
  for (const LossFactor& each : findings.losses_of_others) members.push_back({each.amplitude, each.eta});
  constexpr int last = 240;
  const auto [from, to] = std::ranges::minmax(findings.loss.amplitude);
  std::vector<double> amplitudes;
  for (int k = 0; k <= last; ++k) amplitudes.push_back(from * exponential(logarithm(to / from) * k / last));
  add_band_rows(members, amplitudes, block);
  return block;
}

// Returns the frequencies at which the closed forms are drawn: the runs' own and some between each two.
std::vector<double> drawn_frequencies(const ForcedResponse& response) {
  constexpr int between = 8;
  std::vector<double> frequencies;
  for (std::size_t i = 0; i + 1 < response.points.size(); ++i) {
    const double from = response.points[i].frequency, to = response.points[i + 1].frequency;
    for (int k = 0; k < between; ++k) frequencies.push_back(from + (to - from) * k / between);
  }
  frequencies.push_back(response.points.back().frequency);
  return frequencies;
}

std::optional<Drawing> response(const Findings& findings) {
  const ForcedResponse& all = findings.response;
  if (all.points.size() < least_points || !all.largest()) return std::nullopt;
  const Scene& scene = findings.subject.scene;
  Drawing drawing = drawing_of(findings, "response", "Amplitude over frequency");
  const auto block_of = [](const std::string& name, const std::string& legend, const char* what) {
    return TableBlock{.name = name,
                      .columns = {{"frequency", "of the force, in units of Omega_n"}, {legend, what}}};
  };
  const auto add = [&](ArrivedMotion ResponsePoint::*way, const std::string& name,
                       const std::string& legend) {
    TableBlock periodic = block_of(name, legend, "largest |x| of the periodic motion, in units of epsilon"),
               open = block_of(name + "-open", legend + ", not periodic",
                               "largest |x| of a motion that is not periodic, in units of epsilon");
    for (const ResponsePoint& point : all.points)
      if (const ArrivedMotion& motion = point.*way; motion.is_known())
        (motion.is_periodic() ? periodic : open).add_row({point.frequency, motion.amplitude()});
    drawing.table.add_if_any(std::move(periodic));
    drawing.table.add_if_any(std::move(open));
  };
  add(&ResponsePoint::rising, "rising", "frequency rising");
  add(&ResponsePoint::falling, "falling", "frequency falling");
  const auto linear = [&](const std::string& name, const std::string& legend, double mass) {
    TableBlock block = block_of(name, legend, "amplitude, in units of epsilon");
    for (const double frequency : drawn_frequencies(all)) {
      const double amplitude = linear_response(scene.force_amplitude, mass, scene.damping_ratio, frequency);
      if (std::isfinite(amplitude)) block.add_row({frequency, amplitude});
    }
    drawing.table.add(std::move(block));
  };
  linear("locked", findings.several() ? "secondary masses locked" : "secondary mass locked",
         1 + secondary_mass(scene));
  linear("empty", findings.several() ? "boxes empty" : "box empty", 1);
  drawing.table.add(
      {.name = "given",
       .columns = {{"frequency", "that the scene gives, in units of Omega_n", {scene.force_frequency}},
                   {"frequency given", "the largest amplitude drawn", {all.largest()->motion.amplitude()}}}});
  return drawing;
}

std::optional<Drawing> loss(const Findings& findings) {
  constexpr std::size_t least = 10;
  if (findings.loss.eta.size() < least || !findings.best) return std::nullopt;
  Drawing drawing = drawing_of(findings, "loss", "Loss factor");
  Figure figure;
  figure.number = drawing.name;
  figure.table = TableKind::loss_factor;
  figure.ordinate = LossOrdinate::eta;
  const auto block = [&](const std::string& block_name, const std::string& legend, const LossFactor& loss) {
    drawing.table.add({.name = block_name,
                       .columns = {{"amplitude", "peak amplitude A, in units of epsilon", loss.amplitude},
                                   {legend, "eta = -2 d ln A/dt, per radian", loss.eta}}});
  };
  block("curve-1", "simulated", findings.loss);
  if (!findings.loss_after_failure.eta.empty())
    block("failed-1", "after impact failure", findings.loss_after_failure);
  drawing.table.add_if_any(loss_band(findings));
  if (!is_ideal(findings.subject.scene)) return drawing;  // the closed forms are for none
  if (findings.several()) {
    TableBlock folds{.name = "folds",
                     .columns = {{"amplitude", "below it impacts of a damper fail, in units of epsilon"}}};
    for (const SceneDamper& each : findings.subject.scene.dampers)
      if (each.restitution > 0 && each.restitution < 1)
        folds.add_row({fold_amplitude(each.restitution) * each.clearance});
    drawing.table.add_if_any(std::move(folds));
    return drawing;
  }
  if (const double e = findings.subject.scene.damper().restitution; e > 0 && e < 1)
    drawing.table.add(
        {.name = "fold",
         .columns = {
             {"amplitude",
              "below it one impact per half cycle cannot go on, in units of epsilon",
              {fold_amplitude(e)}},
             {"impacts fail", "least loss factor drawn", {*std::ranges::min_element(findings.loss.eta)}}}});
  FigureRun source{"given", findings.run};
  // The closed forms are for zeta = 0. The loss by the primary system's own damping is added to them.
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
  Drawing drawing =
      drawing_of(findings, "phase", "Phase of the impacts", one_of_several(findings, findings.shown));
  add_phase_parts(findings.run_of(findings.shown), drawing.table);
  if (!drawing.table.has("impacts")) return std::nullopt;
  return drawing;
}

std::optional<Drawing> motion(const Findings& findings, const std::optional<MotionWindow>& window,
                              std::size_t shown, const std::string& name, const std::string& title) {
  if (!window) return std::nullopt;
  Drawing drawing = drawing_of(findings, name, title, one_of_several(findings, shown));
  drawing.script = "own_motion.gp";
  add_motion_parts(findings.run_of(shown), window->first, window->last, drawing.table);
  return drawing;
}

std::optional<Drawing> prediction(const Findings& findings) {
  if (findings.others.empty() || findings.spread.size() < least_points) return std::nullopt;
  Drawing drawing = drawing_of(findings, "prediction", "How far releases part");
  TableBlock curve{.name = "curve",
                   .columns = {{"time", "time of the peak, in units of 1/Omega_n"},
                               {"spread", "of the releases' amplitudes, percent of their median"}}};
  for (std::size_t row = 0; row < findings.spread.size(); ++row) {
    // Zero, with amplitudes equal to the last bit, has no place on a logarithmic axis.
    if (findings.spread[row] > 0)
      curve.add_row({findings.run.half_cycles->peak_time[row], 100 * findings.spread[row]});
  }
  if (curve.rows() < least_points) return std::nullopt;
  drawing.table.add(std::move(curve));
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
  add(findings.forced() ? response(findings) : loss(findings));
  add(phase(findings));
  add(motion(findings, findings.begin, findings.shown, "begin", "The motion, from the release on"));
  add(motion(findings, findings.chosen, findings.shown_when_chosen, "best",
             findings.forced() ? "The motion, at the end" : "The motion, where the damping is best"));
  add(prediction(findings));
  return drawings;
}

}  // namespace impact_damper
