// A measure of the paper's stuck regime: the number of steps that it saves the component element method.
#include <cstdint>
#include <optional>

#include "application/reproduction/measures.hpp"
#include "application/reproduction/measures_parts.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

// Returns the component element method with small steps only near contact, and touch and release located. Its
// own error, 1e-5 of the time of a decay, is below what the regime changes. The catalogue's further runs by
// this method have the same options.
Cem method(std::optional<double> stuck_speed) {
  Cem engine;
  engine.locate = true;
  engine.large_step = 0.02;
  engine.stuck_speed = stuck_speed;
  return engine;
}

// Returns the call's scene, which decays down to `amplitude`.
Scene decay_of(Runs& runs, const MeasureCall& call, double amplitude) {
  Scene scene = runs.file(call.scenes.front()).scene;
  scene.until_time.reset();
  scene.until_amplitude = amplitude;
  return scene;
}

// Returns the least budget of steps that a run does not exhaust.
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
  return once(saved);
}

}  // namespace

std::vector<Measure> stuck_measures() {
  return {
      {"stuck_regime_steps_percent", steps_percent,
       "steps of the component element method that the paper's stuck regime saves, down to an amplitude, in "
       "percent",
       numbers("stuck_speed", "amplitude")},
  };
}

}  // namespace impact_damper
