// Measures of the paper's stuck regime: what it changes in the decays of the component element method.
#include <algorithm>
#include <cmath>

#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/reproduction/measures.hpp"
#include "impact_damper/reproduction/measures_parts.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

// Small steps only near contact, touch and release located: the way of the method whose own error, 1e-5 of
// the time of a decay, is below what the regime changes.
Cem method(std::optional<double> stuck_speed) {
  Cem engine;
  engine.locate = true;
  engine.large_step = 0.02;
  engine.stuck_speed = stuck_speed;
  return engine;
}

// The scene's own decays down to an amplitude.
Scene decay_of(Runs& runs, const MeasureCall& call, double amplitude) {
  Scene scene = runs.file(call.scenes.front()).scene;
  scene.until_time.reset();
  scene.until_amplitude = amplitude;
  return scene;
}
std::vector<Run> decays(const Runs& runs, const Scene& scene, std::optional<double> stuck_speed) {
  Record record;
  record.contacts = true;
  return runs.simulated_ensemble(scene, method(stuck_speed), record);
}

Spread time_percent(Runs& runs, const MeasureCall& call) {
  const double amplitude = number(call, "amplitude");
  const Scene scene = decay_of(runs, call, amplitude);
  const auto times = [&](std::optional<double> stuck_speed) {
    std::vector<double> values;
    for (const Run& run : decays(runs, scene, stuck_speed)) {
      const auto row = first_row_below(half_cycles_of(run), amplitude);
      values.push_back(row ? run.half_cycles->peak_time[*row] : std::nan(""));
    }
    return values;
  };
  const double reference = spread_of(times({})).median;
  std::vector<double> values = times(number(call, "stuck_speed"));
  for (double& value : values) value = 100 * (1 - value / reference);
  return spread_of(values);
}

Spread curve_percent(Runs& runs, const MeasureCall& call) {
  const AnalysisOptions& analysis = runs.analysis();
  const double from = number(call, "from"), to = number(call, "to");
  // The average over eleven peaks needs five below the last.
  const Scene scene = decay_of(runs, call, from / 2);
  const std::vector<Run> with = decays(runs, scene, number(call, "stuck_speed"));
  const std::vector<Run> without = decays(runs, scene, {});
  std::vector<double> values;
  values.reserve(with.size());
  for (std::size_t i = 0; i < with.size(); ++i)
    values.push_back(
        spread_percent({loss_curve(with[i], LossOrdinate::amplitude_times, analysis.loss, from, to),
                        loss_curve(without[i], LossOrdinate::amplitude_times, analysis.loss, from, to)},
                       from, to, analysis.bins));
  return spread_of(values);
}

Spread bounce_down_end(Runs& runs, const MeasureCall& call) {
  const Scene scene = decay_of(runs, call, number(call, "amplitude"));
  std::vector<double> values;
  for (const Run& run : decays(runs, scene, number(call, "stuck_speed")))
    values.push_back(end_of_bounce_down(run).value_or(std::nan("")));
  return spread_of(values);
}

// The least budget of steps that a run does not use up.
double steps_of(const Scene& scene, Cem engine) {
  std::int64_t least = 0, most = engine.max_steps;
  while (most - least > 1) {
    engine.max_steps = least + (most - least) / 2;
    const bool enough = simulate(scene, engine, Record{}).stop_reason != StopReason::step_budget;
    (enough ? most : least) = engine.max_steps;
  }
  return static_cast<double>(most);
}
Spread steps_percent(Runs& runs, const MeasureCall& call) {
  const Scene scene = decay_of(runs, call, number(call, "amplitude"));
  const double saved =
      100 * (1 - steps_of(scene, method(number(call, "stuck_speed"))) / steps_of(scene, method({})));
  return {saved, saved, saved};
}

}  // namespace

std::vector<Measure> stuck_measures() {
  return {
      {"stuck_regime_time_percent",
       1,
       1,
       {"stuck_speed", "amplitude"},
       time_percent,
       "by how much the component element method reaches an amplitude earlier with the paper's stuck regime, "
       "in percent of the time"},
      {"stuck_regime_curve_percent",
       1,
       1,
       {"stuck_speed", "from", "to"},
       curve_percent,
       "spread of A eta_s / nu between the component element method with and without that regime, in "
       "percent"},
      {"stuck_regime_bounce_down_end",
       1,
       1,
       {"stuck_speed", "amplitude"},
       bounce_down_end,
       "amplitude at the end of bounce-down with that regime, in a decay to a lower amplitude"},
      {"stuck_regime_steps_percent",
       1,
       1,
       {"stuck_speed", "amplitude"},
       steps_percent,
       "steps that it saves of those of two rates down to an amplitude, in percent"},
  };
}

}  // namespace impact_damper
