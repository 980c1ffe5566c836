// Figures 8-14: the averaged loss factor over amplitude, and the closed forms it is held against.
#include <algorithm>
#include <cmath>
#include <limits>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/files/number_text.hpp"
#include "impact_damper/paper/series_blocks.hpp"

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
      return "A (eta - 2 zeta) / nu, A by epsilon";
    case LossOrdinate::by_restitution:
      return "A (eta - 2 zeta) / (nu (1 - e)), A by epsilon";
  }
  return "";
}

// The ordinate that a specific loss eta/nu of the impacts alone amounts to at zeta = 0.
double theory_ordinate(LossOrdinate which, double amplitude, double specific, const Scene& scene) {
  return ordinate({.amplitude = {amplitude}, .time = {0}, .eta = {specific * scene.mass_ratio}}, scene,
                  which)[0];
}

constexpr int theory_points = 120;

// Equally spaced in the logarithm, both ends included.
double amplitude_at(int i, double from, double to, int last = theory_points) {
  if (i == 0) return from;
  if (i == last) return to;
  return from * std::pow(to / from, static_cast<double>(i) / last);
}

TableBlock theory_block(const std::string& name, const std::string& legend, LossOrdinate which) {
  return {.name = name,
          .notes = {"closed form for nu -> 0, zeta = 0"},
          .columns = {{"amplitude", "peak amplitude A, by epsilon", {}}, {legend, meaning(which), {}}}};
}

// How many rows of `loss` have a peak before impact failure among those they average; all, if none is found.
std::size_t before_failure(const Run& run, const LossFactor& loss, int span) {
  const std::optional<double> amplitude = impact_failure(run).first_missed;
  if (!amplitude) return loss.eta.size();
  const std::vector<double>& rows = run.half_cycles->amplitude;
  const auto failure = static_cast<std::size_t>(std::ranges::find(rows, *amplitude) - rows.begin());
  const double last =
      run.half_cycles->peak_time[std::min(failure + static_cast<std::size_t>(span) / 2, rows.size() - 1)];
  const auto behind = std::ranges::lower_bound(loss.time, last);
  return std::max<std::size_t>(2, static_cast<std::size_t>(behind - loss.time.begin()));
}

// The ordinate where the amplitude first falls below `amplitude`, between the two rows beside it; absent
// outside the first `kept` rows.
std::optional<double> value_at(double amplitude, const LossFactor& loss, const std::vector<double>& values,
                               std::size_t kept) {
  for (std::size_t i = 1; i < kept; ++i) {
    if (!(loss.amplitude[i] < amplitude)) continue;
    if (!(loss.amplitude[i - 1] >= amplitude)) return std::nullopt;
    const double part = (loss.amplitude[i - 1] - amplitude) / (loss.amplitude[i - 1] - loss.amplitude[i]);
    return values[i - 1] + part * (values[i] - values[i - 1]);
  }
  return std::nullopt;
}

// The extremes over an ensemble of the run's scene, where all members have a value.
TableBlock band_block(const Figure& figure, const FigureCurve& curve, const Run& run,
                      const std::string& number, const Threads& threads) {
  struct Member {
    LossFactor loss;
    std::vector<double> values;
    std::size_t kept;
  };
  std::vector<Member> members;
  const EnsembleOptions options{.members = curve.ensemble, .threads = threads};
  for (const Run& each : simulate_ensemble(run.scene, run.engine, Record{}, options)) {
    Member member{averaged_loss_factor(*each.half_cycles, curve.loss_factor), {}, 0};
    member.values = ordinate(member.loss, each.scene, *figure.ordinate);
    member.kept = before_failure(each, member.loss, curve.loss_factor.half_cycles);
    members.push_back(std::move(member));
  }
  const auto own = members[0].loss.amplitude.begin();
  const double least = *std::min_element(own, own + static_cast<std::ptrdiff_t>(members[0].kept));
  TableBlock block{.name = "band-" + number,
                   .notes = {std::to_string(curve.ensemble) + " releases of scene " + curve.scene +
                             ", x0 shifted by up to " + std::to_string(options.most_steps) + " times " +
                             number_text(options.step) + " of it"},
                   .columns = {{"amplitude", "peak amplitude A, by epsilon", {}},
                               {"least", "ordinate of the ensemble", {}},
                               {std::to_string(curve.ensemble) + " releases", "greatest ordinate", {}}}};
  for (int k = 0; k <= 2 * theory_points; ++k) {
    const double amplitude = amplitude_at(k, least, run.scene.x0, 2 * theory_points);
    std::vector<double> values;
    for (const Member& member : members) {
      if (const auto value = value_at(amplitude, member.loss, member.values, member.kept))
        values.push_back(*value);
    }
    if (values.size() < members.size()) continue;
    const Spread spread = spread_of(values);
    block.columns[0].values.push_back(amplitude);
    block.columns[1].values.push_back(spread.low);
    block.columns[2].values.push_back(spread.high);
  }
  return block;
}

}  // namespace

void add_loss_block(const Figure& figure, const FigureCurve& curve, const FigureRun& source,
                    const std::string& number, const std::string& legend, const Threads& threads,
                    Table& table) {
  const HalfCycles& rows = half_cycles_of(figure, source);
  const int span = curve.loss_factor.half_cycles;
  const LossFactor loss = averaged_loss_factor(rows, curve.loss_factor);
  if (loss.eta.size() < 2) {
    throw unusable(figure, source.file,
                   "is too short: " + std::to_string(rows.amplitude.size()) +
                       " half cycles, the averaging needs at least " + std::to_string(span + 2));
  }
  const std::vector<double> values = ordinate(loss, source.run.scene, *figure.ordinate);
  const std::size_t kept = before_failure(source.run, loss, span);
  const auto part = [&](const std::vector<double>& column, std::size_t from, std::size_t to) {
    return std::vector<double>(column.begin() + static_cast<std::ptrdiff_t>(from),
                               column.begin() + static_cast<std::ptrdiff_t>(to));
  };
  const auto block = [&](const std::string& block_name, const std::string& note, std::size_t from,
                         std::size_t to) {
    table.blocks.push_back(
        {.name = block_name,
         .notes = {"scene " + curve.scene + ", averaged over " + std::to_string(span) + " half cycles" +
                   note},
         .columns = {{"amplitude", "peak amplitude A, averaged, by epsilon", part(loss.amplitude, from, to)},
                     {legend, meaning(*figure.ordinate), part(values, from, to)}}});
  };
  block("curve-" + number, "", 0, kept);
  if (kept < values.size())
    block("failed-" + number, ", no peak of which precedes impact failure", kept, values.size());
  if (curve.ensemble > 0) table.blocks.push_back(band_block(figure, curve, source.run, number, threads));
}

void add_spread_block(const Figure& figure, Table& table) {
  double least = std::numeric_limits<double>::max(), most = std::numeric_limits<double>::lowest();
  for (const TableBlock& block : table.blocks) {
    if (!block.name.starts_with("curve-")) continue;
    for (std::size_t i = 0; i < block.columns[0].values.size(); ++i) {
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
  table.blocks.push_back(
      {.name = "spread",
       .notes = {"middle, least and greatest ordinate of all curves over the amplitudes of its two rows"},
       .columns = {{"amplitude", "by epsilon", figure.range},
                   {"least", "of all curves", {least, least}},
                   {"most", "of all curves", {most, most}},
                   {legend, "half way between least and most", {middle, middle}}}});
}

void add_loss_theory_blocks(const Figure& figure, const std::vector<const FigureRun*>& sources,
                            Table& table) {
  const LossOrdinate which = *figure.ordinate;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Scene& scene = sources[i]->run.scene;
    // The closed forms are for zeta = 0 and for a rebound; below e = 1 only.
    if (scene.damping_ratio != 0 || !(scene.restitution > 0) || !(scene.restitution < 1)) continue;
    const std::string number = std::to_string(i + 1);
    const double e = scene.restitution;

    TableBlock one = theory_block("one-impact-" + number, "one impact per half cycle", which);
    const double fold = fold_amplitude(e), unequal = equal_spacing_amplitude(e);
    for (int k = 0; k <= theory_points; ++k) {
      const double amplitude = amplitude_at(k, fold, unequal);
      const auto motion = single_impact(e, amplitude);
      if (!motion) continue;  // the fold itself, by rounding
      one.columns[0].values.push_back(amplitude);
      one.columns[1].values.push_back(theory_ordinate(which, amplitude, motion->loss, scene));
    }
    table.blocks.push_back(std::move(one));

    const double largest = scene.x0;
    if (e > 0.95) continue;
    const double end = bounce_down_end(e);
    if (!(end < largest)) continue;
    TableBlock stuck = theory_block("bounce-down-" + number, "bounce-down", which);
    for (int k = 0; k <= theory_points; ++k) {
      const double amplitude = amplitude_at(k, end, largest);
      stuck.columns[0].values.push_back(amplitude);
      stuck.columns[1].values.push_back(
          theory_ordinate(which, amplitude, bounce_down(e, amplitude).loss, scene));
    }
    table.blocks.push_back(std::move(stuck));
  }
}

}  // namespace impact_damper
