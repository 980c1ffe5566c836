#include "impact_damper/analysis/regimes.hpp"

#include <algorithm>
#include <stdexcept>

#include "impact_damper/motion/wall.hpp"

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

}  // namespace impact_damper
