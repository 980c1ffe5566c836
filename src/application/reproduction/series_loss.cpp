// Figures 8-14: the averaged loss factor over amplitude, and the closed forms it is held against.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "application/reproduction/series.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

std::string meaning(LossOrdinate which) {
  constexpr std::array<const char*, 6> meanings{
      "eta = -2 A'/A, per radian",
      "eta / nu",
      "(eta - 2 zeta) / nu",
      "A (eta - 2 zeta) / nu, A divided by the clearance",
      "A (eta - 2 zeta) / (nu (1 - e)), A divided by the clearance",
      "A (eta - 2 zeta / (1 + nu)) / nu, A divided by the clearance"};
  return meanings.at(static_cast<std::size_t>(which));
}

// Returns last + 1 amplitudes, equally spaced in the logarithm, both ends included.
std::vector<double> amplitudes_between(double from, double to, int last) {
  std::vector<double> amplitudes{from};
  for (int i = 1; i < last; ++i) amplitudes.push_back(from * exponential(logarithm(to / from) * i / last));
  if (last > 0) amplitudes.push_back(to);
  return amplitudes;
}

// Returns amplitudes along a closed form, no further apart than a factor of exp(spacing).
std::vector<double> theory_amplitudes(double from, double to, double spacing) {
  return amplitudes_between(from, to, static_cast<int>(std::ceil(logarithm(to / from) / spacing)));
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

// Returns the extremes over the first members of the ensemble, where all of them have a value; no rows if
// they never do.
TableBlock band_block(const Figure& figure, const FigureCurve& curve, const FigureRun& source,
                      const std::string& number) {
  std::vector<LossCurve> members{LossCurve(figure, curve, source.run)};
  for (const Run& other : std::span(source.others).first(static_cast<std::size_t>(curve.ensemble - 1)))
    members.emplace_back(figure, curve, other);
  std::vector<BandCurve> curves;
  curves.reserve(members.size());
  for (const LossCurve& member : members)
    curves.push_back({std::span(member.loss.amplitude).first(member.kept), member.values});
  const std::string count = std::to_string(members.size());
  const EnsembleOptions options;
  TableBlock block{
      .name = "band-" + number,
      .notes = {count + " releases of scene " + curve.scene + ", x0 shifted by up to " +
                std::to_string(options.most_steps) + " times " + number_text(options.step) + " of it"},
      .columns = {{"amplitude", "peak amplitude A, divided by the clearance"},
                  {"least", "ordinate of the ensemble", {}, Ordinate::low},
                  {count + " releases", "greatest ordinate", {}, Ordinate::high}}};
  constexpr int last = 240;
  const double least = std::ranges::min(curves.front().amplitude);
  add_band_rows(curves, amplitudes_between(least, largest_amplitude(source.run), last), block);
  return block;
}

}  // namespace

void add_band_rows(const std::vector<BandCurve>& curves, const std::vector<double>& amplitudes,
                   TableBlock& block) {
  for (const double amplitude : amplitudes) {
    std::vector<double> values;
    for (const auto& [over, ordinate] : curves) {
      const auto below = std::ranges::find_if(over, [&](double a) { return a < amplitude; });
      const auto i = static_cast<std::size_t>(below - over.begin());
      if (i == 0 || i == over.size()) break;
      const double part = (over[i - 1] - amplitude) / (over[i - 1] - over[i]);
      values.push_back(ordinate[i - 1] + part * (ordinate[i] - ordinate[i - 1]));
    }
    if (values.size() < curves.size()) continue;
    const auto [least, greatest] = std::ranges::minmax(values);
    block.add_row({amplitude, least, greatest});
  }
}

void add_loss_block(const Figure& figure, const FigureCurve& curve, const FigureRun& source,
                    const std::string& number, const std::string& legend, Table& table) {
  const std::size_t half_cycles = half_cycles_of(figure, source).amplitude.size();
  const int span = curve.loss_factor.half_cycles;
  const LossCurve own(figure, curve, source.run);
  if (own.values.size() < 2)
    throw unusable(figure, source.file,
                   "is too short: " + std::to_string(half_cycles) +
                       " half cycles, the averaging needs at least " + std::to_string(span + 2));
  const auto add = [&](const std::string& name, const std::string& note, LossOrdinate which, std::size_t from,
                       std::size_t to) {
    const auto part = [&](const std::vector<double>& column) {
      return std::vector<double>(column.begin() + static_cast<std::ptrdiff_t>(from),
                                 column.begin() + static_cast<std::ptrdiff_t>(to));
    };
    table.add({.name = name + number,
               .notes = {"scene " + curve.scene + ", " + note},
               .columns = {{"amplitude", "peak amplitude A, averaged, divided by the clearance",
                            part(own.loss.amplitude)},
                           {legend, meaning(which), part(ordinate(own.loss, source.run.scene, which))}}});
  };
  const std::string averaged = "averaged over " + std::to_string(span) + " half cycles";
  const std::size_t rows = own.values.size();
  add("curve-", averaged, *figure.ordinate, 0, own.kept);
  if (own.kept < rows)
    add("failed-", averaged + ", no peak of which precedes impact failure", *figure.ordinate, own.kept, rows);
  if (figure.second_ordinate)
    add("second-", "the same curve in the second panel's ordinate", *figure.second_ordinate, 0, own.kept);
  if (curve.ensemble == 0) return;
  if (std::ssize(source.others) + 1 < curve.ensemble)
    throw unusable(figure, source.file,
                   "has " + std::to_string(source.others.size() + 1) + " of the " +
                       std::to_string(curve.ensemble) + " members of its ensemble");
  table.add(band_block(figure, curve, source, number));
}

void add_spread_block(const Figure& figure, Table& table) {
  double least = std::numeric_limits<double>::max(), most = std::numeric_limits<double>::lowest();
  for (const TableBlock& block : table.blocks) {
    if (!block.name.starts_with("curve-")) continue;
    // Without the first point: the release is among the peaks that it is fitted to.
    for (std::size_t i = 1; i < block.rows(); ++i) {
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
  table.add({.name = "spread",
             .notes = {"middle, least and greatest ordinate of all curves over the amplitudes of its two "
                       "rows, but for each curve's first point, which the release enters"},
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
      table.add(theory_block(name + "-" + std::to_string(i + 1), legend, form, scene, *figure.ordinate));
    };
    add("one-impact", "one impact per half cycle", forms->one_impact);
    if (!forms->bounce_down.eta.empty()) add("bounce-down", "bounce-down", forms->bounce_down);
  }
}

}  // namespace impact_damper
