#include "impact_damper/analysis/time_below.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

// The square of (M15.13): an upper bound of x^2 from then on, without a force.
double bound_of_square(const Run& run, std::size_t row) {
  const Scene& scene = run.scene;
  const History& history = *run.history;
  const bool rigid = has_rigid_walls(run.engine);
  const double x = history.x[row], v = history.v[row];
  double twice_energy = x * x + v * v;
  const auto add = [&](double mass_ratio, double stiffness, double clearance, double y, double w) {
    const double depth = rigid ? 0 : std::max({0.0, -y, y - clearance});
    twice_energy += mass_ratio * (v + w) * (v + w) + stiffness * depth * depth;
  };
  for (std::size_t n = 0; n < scene.dampers.size(); ++n) {
    const SceneDamper& damper = scene.dampers[n];
    add(damper.mass_ratio, damper.wall_stiffness, damper.clearance, history.dampers[n].y[row],
        history.dampers[n].w[row]);
  }
  return twice_energy;
}

// The last time in [begin, end] at which |x| >= amplitude; `begin` if there is none. Where `end` is not the
// end of a half cycle: absent if |x| may be as large again later.
std::optional<double> last_time_at(const Run& run, double begin, double end, double amplitude, bool ends) {
  constexpr double close = 0.01;  // samples: |x| does not rise and fall again between two of them
  constexpr int coarse_passes = 4;
  const auto count = std::int64_t(run.scene.dampers.size());
  Record record;
  record.half_cycles = false;
  for (int pass = 0;; ++pass) {
    record.history = {{begin, end, std::min<std::int64_t>(1001, most_samples / count)}};
    const Run again = simulate(run.scene, run.engine, record);
    const std::vector<double>&x = again.history->x, &time = again.history->time;
    const auto stays_below = [&](std::size_t row) {
      return bound_of_square(again, row) < amplitude * amplitude;
    };
    const std::size_t last = time.size() - 1;
    if (pass == 0 && !ends && !stays_below(last)) return std::nullopt;
    std::size_t at = last;
    while (at > 0 && !(std::abs(x[at]) >= amplitude)) --at;
    if (at == last || !(std::abs(x[at]) >= amplitude)) return time[at];
    std::size_t below = at + 1;
    if (!ends && pass < coarse_passes && time[below] - time[at] > close)
      while (below < last && !stays_below(below)) ++below;
    begin = time[at];
    end = time[below];
    if (end - begin <= std::max(1e-7, 1e-13 * end))  // within which x is a straight line to rounding
      return begin + (end - begin) * (std::abs(x[at]) - amplitude) / std::abs(x[at] - x[below]);
  }
}

}  // namespace

std::optional<double> time_below(const Run& run, double amplitude) {
  constexpr double least_part_of_a_swing = 0.1;
  const HalfCycles& rows = *run.half_cycles;
  if (const auto found = first_row_below(rows, amplitude)) {
    const std::size_t row = *found;
    if (row == 0 || rows.amplitude[row] >= least_part_of_a_swing * rows.amplitude[row - 1])
      return rows.peak_time[row];
    return last_time_at(run, rows.peak_time[row - 1], rows.zero_crossing[row - 1], amplitude, true);
  }
  // The half cycle under way, or the one before, is no oscillation if it lasts more than 1.1 times as long as
  // an undamped one with all masses locked.
  const std::size_t count = rows.zero_crossing.size();
  const double since = count > 0 ? rows.zero_crossing[count - 1] : 0;
  const double before = count > 1 ? rows.zero_crossing[count - 2] : 0;
  const double swing = 1.1 * std::numbers::pi * std::sqrt(1 + secondary_mass(run.scene));
  if (run.scene.force_amplitude != 0 || !(std::max(run.end_time - since, since - before) > swing))
    return std::nullopt;
  return last_time_at(run, count > 0 ? rows.peak_time.back() : 0, run.end_time, amplitude, false);
}

}  // namespace impact_damper
