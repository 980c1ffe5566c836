// Figures 8-14: the averaged loss factor over amplitude, and the closed forms it is held against.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "application/reproduction/series_blocks.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

std::string meaning(LossOrdinate which) {
  switch (which) {
    case LossOrdinate::eta:
      return "eta = -2 A'/A, per radian";
    case LossOrdinate::specific:
      return "eta / nu";
    case LossOrdinate::specific_secondary:
      return "(eta - 2 zeta) / nu";
    case LossOrdinate::amplitude_times:
      return "A (eta - 2 zeta) / nu, A divided by the clearance";
    case LossOrdinate::by_restitution:
      return "A (eta - 2 zeta) / (nu (1 - e)), A divided by the clearance";
    case LossOrdinate::carried:
      return "A (eta - 2 zeta / (1 + nu)) / nu, A divided by the clearance";
  }
  return "";
}

// Returns amplitude i of last + 1, equally spaced in the logarithm, both ends included.
double amplitude_at(int i, int last, double from, double to) {
  if (i == 0) return from;
  if (i == last) return to;
  return from * exponential(logarithm(to / from) * i / last);
}

// Returns amplitudes along a closed form, no further apart than a factor of exp(spacing).
std::vector<double> theory_amplitudes(double from, double to, double spacing) {
  const int last = static_cast<int>(std::ceil(logarithm(to / from) / spacing));
  std::vector<double> amplitudes;
  for (int i = 0; i <= last; ++i) amplitudes.push_back(amplitude_at(i, last, from, to));
  return amplitudes;
}

// Returns how many rows of `loss` average at least one peak before impact failure; all, if none is found.
std::size_t before_failure(const Run& run, const LossFactor& loss, int span) {
  const auto missed = impact_failure(run).first_missed;
  if (!missed) return loss.eta.size();
  const std::vector<double>& peak_time = run.half_cycles->peak_time;
  const double last =
      peak_time[std::min(missed->row + static_cast<std::size_t>(span) / 2, peak_time.size() - 1)];
  const auto behind = std::ranges::lower_bound(loss.time, last);
  return std::min(loss.eta.size(),
                  std::max<std::size_t>(2, static_cast<std::size_t>(behind - loss.time.begin())));
}

// The averaged loss factor of one run and what is drawn of it.
struct LossCurve {
  LossFactor loss;
  std::vector<double> values;  // the figure's ordinate
  std::size_t kept;            // rows before impact failure

  LossCurve(const Figure& figure, const FigureCurve& curve, const Run& run)
      : loss(averaged_loss_factor(*run.half_cycles, curve.loss_factor)),
        values(ordinate(loss, run.scene, *figure.ordinate)),
        kept(before_failure(run, loss, curve.loss_factor.half_cycles)) {}
};

// The closed forms for zeta = 0, with eta / nu for eta. They depend only on the restitution and on the
// largest amplitude drawn, so curves that differ in something else share them.
struct ClosedForms {
  double restitution, largest;
  LossFactor one_impact, bounce_down;

  ClosedForms(double e, double most) : restitution(e), largest(most) {
    // The curve is steep at the fold; that of bounce-down is so straight that its chords are within 1e-4 of
    // it.
    for (const double amplitude : theory_amplitudes(fold_amplitude(e), equal_spacing_amplitude(e), 0.01)) {
      const auto motion = single_impact(e, amplitude);
      if (!motion) continue;  // the fold itself, by rounding
      one_impact.amplitude.push_back(amplitude);
      one_impact.eta.push_back(motion->loss);
    }
    // Below 1/pi the opposite wall is not met before x returns to 0.
    if (e > 0.95 || !(largest > 1 / std::numbers::pi) || !impact_damper::bounce_down(e, largest).sticks)
      return;
    bounce_down.amplitude = theory_amplitudes(bounce_down_end(e), largest, 0.04);
    for (const double amplitude : bounce_down.amplitude)
      bounce_down.eta.push_back(impact_damper::bounce_down(e, amplitude).loss);
  }
};

TableBlock theory_block(const std::string& name, const std::string& legend, LossFactor form,
                        const Scene& scene, LossOrdinate which) {
  for (double& eta : form.eta) eta *= scene.damper().mass_ratio;
  return {.name = name,
          .notes = {"closed form for nu -> 0, zeta = 0"},
          .columns = {{"amplitude", "peak amplitude A, divided by the clearance", form.amplitude},
                      {legend, meaning(which), ordinate(form, scene, which)}}};
}

double largest_amplitude(const Run& run) { return std::ranges::max(run.half_cycles->amplitude); }

}  // namespace

void add_band_block(const Figure& figure, const FigureCurve& curve, const Run& run,
                    std::span<const Run> others, const std::string& number, Table& table) {
  std::vector<LossCurve> members{LossCurve(figure, curve, run)};
  for (const Run& other : others) members.emplace_back(figure, curve, other);
  const LossCurve& own = members.front();
  const std::string count = std::to_string(members.size());
  const EnsembleOptions options;
  TableBlock block{
      .name = "band-" + number,
      .notes = {count + " releases of scene " + curve.scene + ", x0 shifted by up to " +
                std::to_string(options.most_steps) + " times " + number_text(options.step) + " of it"},
      .columns = {{"amplitude", "peak amplitude A, divided by the clearance", {}},
                  {"least", "ordinate of the ensemble", {}, Ordinate::low},
                  {count + " releases", "greatest ordinate", {}, Ordinate::high}}};
  const auto own_end = own.loss.amplitude.begin() + static_cast<std::ptrdiff_t>(own.kept);
  const double least = *std::min_element(own.loss.amplitude.begin(), own_end);
  // The amplitudes descend, so that each member is traversed once: its row is the first below the amplitude.
  constexpr int last = 240;
  std::vector<std::size_t> row(members.size(), 0);
  std::vector<double> values(members.size());
  for (int k = last; k >= 0; --k) {
    const double amplitude = amplitude_at(k, last, least, largest_amplitude(run));
    bool all = true;
    for (std::size_t n = 0; n < members.size(); ++n) {
      const auto& [loss, ordinates, kept] = members[n];
      std::size_t& i = row[n];
      while (i < kept && !(loss.amplitude[i] < amplitude)) ++i;
      if (i == 0 || i == kept) {
        all = false;
        continue;
      }
      const double part = (loss.amplitude[i - 1] - amplitude) / (loss.amplitude[i - 1] - loss.amplitude[i]);
      values[n] = ordinates[i - 1] + part * (ordinates[i] - ordinates[i - 1]);
    }
    if (!all) continue;
    const Spread spread = spread_of(values);
    block.columns[0].values.push_back(amplitude);
    block.columns[1].values.push_back(spread.low);
    block.columns[2].values.push_back(spread.high);
  }
  for (TableColumn& column : block.columns) std::ranges::reverse(column.values);
  table.blocks.push_back(std::move(block));
}

void add_loss_block(const Figure& figure, const FigureCurve& curve, const FigureRun& source,
                    const std::string& number, const std::string& legend, Table& table) {
  const HalfCycles& rows = half_cycles_of(figure, source);
  const int span = curve.loss_factor.half_cycles;
  const LossCurve own(figure, curve, source.run);
  const auto& [loss, values, kept] = own;
  if (loss.eta.size() < 2) {
    throw unusable(figure, source.file,
                   "is too short: " + std::to_string(rows.amplitude.size()) +
                       " half cycles, the averaging needs at least " + std::to_string(span + 2));
  }
  const auto part = [&](const std::vector<double>& column, std::size_t from, std::size_t to) {
    return std::vector<double>(column.begin() + static_cast<std::ptrdiff_t>(from),
                               column.begin() + static_cast<std::ptrdiff_t>(to));
  };
  const auto block = [&, &loss = loss, &values = values](const std::string& block_name,
                                                         const std::string& note, std::size_t from,
                                                         std::size_t to) {
    table.blocks.push_back({.name = block_name,
                            .notes = {"scene " + curve.scene + ", averaged over " + std::to_string(span) +
                                      " half cycles" + note},
                            .columns = {{"amplitude", "peak amplitude A, averaged, divided by the clearance",
                                         part(loss.amplitude, from, to)},
                                        {legend, meaning(*figure.ordinate), part(values, from, to)}}});
  };
  block("curve-" + number, "", 0, kept);
  if (kept < values.size())
    block("failed-" + number, ", no peak of which precedes impact failure", kept, values.size());
  if (figure.second_ordinate) {
    table.blocks.push_back(
        {.name = "second-" + number,
         .notes = {"scene " + curve.scene + ", the same curve in the second panel's ordinate"},
         .columns = {{"amplitude", "peak amplitude A, averaged, divided by the clearance",
                      part(loss.amplitude, 0, kept)},
                     {legend, meaning(*figure.second_ordinate),
                      part(ordinate(loss, source.run.scene, *figure.second_ordinate), 0, kept)}}});
  }
  if (curve.ensemble > 0) {
    const auto others = static_cast<std::size_t>(curve.ensemble - 1);
    if (source.others.size() < others)
      throw unusable(figure, source.file,
                     "has " + std::to_string(source.others.size() + 1) + " of the " +
                         std::to_string(curve.ensemble) + " members of its ensemble");
    add_band_block(figure, curve, source.run, std::span(source.others).first(others), number, table);
  }
}

void add_spread_block(const Figure& figure, Table& table) {
  double least = std::numeric_limits<double>::max(), most = std::numeric_limits<double>::lowest();
  for (const TableBlock& block : table.blocks) {
    if (!block.name.starts_with("curve-")) continue;
    // Without the first point: the release is among the peaks that it is fitted to.
    for (std::size_t i = 1; i < block.columns[0].values.size(); ++i) {
      const double amplitude = block.columns[0].values[i], value = block.columns[1].values[i];
      if (amplitude < figure.range[0] || amplitude > figure.range[1]) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  if (!(least <= most)) return;
  const double middle = (least + most) / 2;
  const double percent = 100 * (most - middle) / middle;
  const std::string legend =
      number_text(std::round(middle * 1e3) / 1e3) + " ± " + number_text(std::round(percent)) + " %";
  table.blocks.push_back({.name = "spread",
                          .notes = {"middle, least and greatest ordinate of all curves over the amplitudes "
                                    "of its two rows, but for each "
                                    "curve's first point, which the release enters"},
                          .columns = {{"amplitude", "divided by the clearance", figure.range},
                                      {"least", "of all curves", {least, least}, Ordinate::low},
                                      {"most", "of all curves", {most, most}, Ordinate::high},
                                      {legend, "half way between least and most", {middle, middle}}}});
}

void add_loss_theory_blocks(const Figure& figure, const std::vector<const FigureRun*>& sources,
                            Table& table) {
  std::optional<ClosedForms> forms;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Scene& scene = sources[i]->run.scene;
    // The closed forms are for zeta = 0 and for a rebound, 0 < e < 1.
    if (scene.damping_ratio != 0 || !(scene.damper().restitution > 0) || !(scene.damper().restitution < 1))
      continue;
    const double largest = largest_amplitude(sources[i]->run);
    if (!forms || forms->restitution != scene.damper().restitution || forms->largest != largest)
      forms.emplace(scene.damper().restitution, largest);
    const auto add = [&](const std::string& name, const std::string& legend, const LossFactor& form) {
      table.blocks.push_back(
          theory_block(name + "-" + std::to_string(i + 1), legend, form, scene, *figure.ordinate));
    };
    add("one-impact", "one impact per half cycle", forms->one_impact);
    if (!forms->bounce_down.eta.empty()) add("bounce-down", "bounce-down", forms->bounce_down);
  }
}

}  // namespace impact_damper
