#include "impact_damper/analysis/regimes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

const HalfCycles& half_cycles_of(const Run& run) {
  if (!run.half_cycles) throw std::invalid_argument("half_cycles: the run did not record them");
  return *run.half_cycles;
}

// Calls visit(row, begin, end) for the parts of each stuck interval in rows 1, 2, ..., in the order of time.
template <class Visit>
void for_each_stuck_part(const Run& run, const RegimeOptions& options, Visit visit) {
  const std::vector<double>& crossing = half_cycles_of(run).zero_crossing;
  const Contacts stuck = stuck_contacts(run, options);
  std::size_t row = 1;
  for (std::size_t i = 0; i < stuck.begin.size(); ++i) {
    while (row < crossing.size() && crossing[row] <= stuck.begin[i]) ++row;
    for (std::size_t r = row; r < crossing.size() && crossing[r - 1] < stuck.end[i]; ++r)
      visit(r, std::max(stuck.begin[i], crossing[r - 1]), std::min(stuck.end[i], crossing[r]));
  }
}

}  // namespace

Contacts stuck_contacts(const Run& run, const RegimeOptions& options) {
  if (!run.contacts) throw std::invalid_argument("contacts: the run did not record them");
  if (has_rigid_walls(run.engine)) return *run.contacts;
  const double least = options.stuck_contact_times * nominal_contact_time(run.scene.damper());
  const Contacts& all = *run.contacts;
  Contacts stuck;
  for (std::size_t i = 0; i < all.begin.size(); ++i) {
    if (!(all.end[i] - all.begin[i] > least)) continue;
    stuck.begin.push_back(all.begin[i]);
    stuck.end.push_back(all.end[i]);
    stuck.wall.push_back(all.wall[i]);
  }
  return stuck;
}

StuckPhases stuck_phases(const Run& run, const RegimeOptions& options) {
  const HalfCycles& rows = half_cycles_of(run);
  StuckPhases phases;
  for_each_stuck_part(run, options, [&](std::size_t row, double begin, double end) {
    const double start = rows.zero_crossing[row - 1];
    const double degrees = 180 / (rows.zero_crossing[row] - start);
    phases.amplitude.push_back(rows.amplitude[row]);
    phases.begin_deg.push_back((begin - start) * degrees);
    phases.end_deg.push_back((end - start) * degrees);
  });
  return phases;
}

std::optional<HalfCycleRow> end_of_bounce_down(const Run& run, const RegimeOptions& options) {
  const HalfCycles& rows = half_cycles_of(run);
  std::vector<bool> sticks(rows.amplitude.size(), false);
  for_each_stuck_part(run, options, [&](std::size_t row, double, double) { sticks[row] = true; });
  std::int64_t series = 0;
  for (std::size_t row = 1; row < sticks.size(); ++row) {
    if (sticks[row]) {
      ++series;
    } else {
      if (series >= options.bounce_down_half_cycles) return HalfCycleRow{row - 1, rows.amplitude[row - 1]};
      series = 0;
    }
  }
  return std::nullopt;
}

ImpactFailure impact_failure(const Run& run, const RegimeOptions& options) {
  const HalfCycles& rows = half_cycles_of(run);
  const std::size_t count = rows.impacts.size();
  const std::size_t span = static_cast<std::size_t>(std::max<std::int64_t>(1, options.failure_half_cycles));
  ImpactFailure failure;
  const auto some_missed = [&](std::size_t first) {
    std::int64_t impacts = 0;
    for (std::size_t row = first; row < first + span; ++row) impacts += rows.impacts[row];
    return impacts < static_cast<std::int64_t>(span);
  };

  const std::vector<RegularWindow> windows = regular_windows(run, options);
  const std::size_t regular = windows.empty() ? 0 : windows.back().last;
  for (std::size_t row = std::max(regular, span / 2) + 1;
       row - span / 2 + span <= count && !failure.first_missed; ++row)
    if (rows.impacts[row] == 0 && some_missed(row - span / 2))
      failure.first_missed = {row, rows.amplitude[row]};

  for (std::size_t row = count < span ? 0 : count - span + 1; row-- > 1 && some_missed(row);)
    if (rows.impacts[row] == 0) failure.for_good = {row, rows.amplitude[row]};
  return failure;
}

std::size_t failure_row(const Run& run) {
  const auto [missed, for_good] = impact_failure(run);
  return missed ? missed->row : for_good ? for_good->row : run.half_cycles->amplitude.size();
}

std::vector<RegularWindow> regular_windows(const Run& run, const RegimeOptions& options) {
  const HalfCycles& rows = half_cycles_of(run);
  std::vector<RegularWindow> windows;
  for (std::size_t first = 1, next; first < rows.impacts.size(); first = next) {
    next = first + 1;
    while (next < rows.impacts.size() && rows.impacts[next] == rows.impacts[first]) ++next;
    if (rows.impacts[first] < 1 || static_cast<std::int64_t>(next - first) < options.window_half_cycles)
      continue;
    windows.push_back(
        {rows.impacts[first], first, next - 1, rows.amplitude[first], rows.amplitude[next - 1]});
  }
  return windows;
}

std::optional<RegularWindow> longest_window(const std::vector<RegularWindow>& windows, std::int64_t impacts) {
  std::optional<RegularWindow> longest;
  for (const RegularWindow& window : windows) {
    if (window.impacts != impacts) continue;
    if (!longest || window.last - window.first > longest->last - longest->first) longest = window;
  }
  return longest;
}

std::optional<std::size_t> first_row_below(const HalfCycles& half_cycles, double amplitude) {
  const auto& a = half_cycles.amplitude;
  const auto found = std::find_if(a.begin(), a.end(), [&](double value) { return value < amplitude; });
  if (found == a.end()) return std::nullopt;
  return static_cast<std::size_t>(found - a.begin());
}

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
  const HalfCycles& rows = half_cycles_of(run);
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

namespace {

std::vector<double> divided(std::vector<double> values, double by) {
  for (double& each : values) each /= by;
  return values;
}

Scene scene_of_damper(const Scene& scene, const SceneDamper& damper) {
  const double c = damper.clearance;
  Scene alone = scene;
  for (double Scene::*const length : {&Scene::x0, &Scene::v0, &Scene::force_amplitude}) alone.*length /= c;
  if (alone.until_amplitude) *alone.until_amplitude /= c;
  alone.dampers = {damper};
  alone.damper().clearance = 1;
  alone.damper().y0 = damper.y0 > c ? 1 + (damper.y0 - c) / c : damper.y0 / c;
  alone.damper().w0 /= c;
  return alone;
}

}  // namespace

Run run_of_damper(const Run& run, std::size_t number) {
  const SceneDamper& damper = run.scene.dampers.at(number);
  const double c = damper.clearance;
  const auto its = static_cast<std::int32_t>(number);
  Run one;
  one.scene = scene_of_damper(run.scene, damper);
  one.engine = run.engine;
  one.stop_reason = run.stop_reason;
  one.end_time = run.end_time;
  if (run.half_cycles) {
    const HalfCycles& rows = *run.half_cycles;
    const HalfCycles::Damper& counted = rows.dampers[number];
    one.half_cycles = {
        rows.zero_crossing, rows.peak_time, divided(rows.amplitude, c), counted.impacts, {counted}};
  }
  if (run.impacts) {
    const Impacts& all = *run.impacts;
    Impacts& kept = one.impacts.emplace();
    for (std::size_t i = 0; i < all.time.size(); ++i) {
      if (all.damper[i] != its) continue;
      kept.time.push_back(all.time[i]);
      kept.wall.push_back(all.wall[i]);
      kept.relative_velocity.push_back(all.relative_velocity[i] / c);
      kept.phase_deg.push_back(all.phase_deg[i]);
      kept.amplitude.push_back(all.amplitude[i] ? std::optional(*all.amplitude[i] / c) : std::nullopt);
      kept.displacement.push_back(all.displacement[i] / c);
      kept.damper.push_back(0);
    }
  }
  if (run.contacts) {
    const Contacts& all = *run.contacts;
    Contacts& kept = one.contacts.emplace();
    for (std::size_t i = 0; i < all.begin.size(); ++i) {
      if (all.damper[i] != its) continue;
      kept.begin.push_back(all.begin[i]);
      kept.end.push_back(all.end[i]);
      kept.wall.push_back(all.wall[i]);
      kept.damper.push_back(0);
    }
  }
  if (run.history) {
    const History& all = *run.history;
    one.history = {all.time,
                   divided(all.x, c),
                   divided(all.v, c),
                   {{divided(all.dampers[number].y, c), divided(all.dampers[number].w, c)}}};
  }
  return one;
}

}  // namespace impact_damper
