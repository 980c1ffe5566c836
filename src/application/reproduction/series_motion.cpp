// Figures 1-6: the secondary mass between its walls, in one window of the history.
#include <algorithm>
#include <cmath>

#include "application/reproduction/series_blocks.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

// The samples [first, last] of the history that belong to the window opened by `amplitude`. A window ends
// where the samples are no longer evenly spaced.
struct Samples {
  std::size_t first = 0, last = 0;
};

Samples find_window(const Figure& figure, const FigureRun& source) {
  const HalfCycles& rows = half_cycles_of(figure, source);
  const std::optional<std::size_t> row = first_row_below(rows, *figure.window);
  if (!row) {
    throw unusable(figure, source.file,
                   "is too short: no half cycle has an amplitude below " + number_text(*figure.window));
  }
  if (!source.run.history) throw unusable(figure, source.file, "holds no history");
  const std::vector<double>& time = source.run.history->time;
  // Half a spacing of tolerance: the window's first sample is the crossing itself, up to rounding.
  const double begin = rows.zero_crossing[*row];
  std::size_t first = static_cast<std::size_t>(std::ranges::lower_bound(time, begin) - time.begin());
  if (first > 0 && begin - time[first - 1] < 1e-6) --first;
  if (!(first + 1 < time.size()) || !(time[first] - begin < 1e-6)) {
    throw unusable(figure, source.file,
                   "is too short: its history has no window beginning at " + number_text(begin) +
                       ", where the amplitude falls below " + number_text(*figure.window));
  }
  const double step = time[first + 1] - time[first];
  std::size_t last = first + 1;
  while (last + 1 < time.size() && std::abs(time[last + 1] - time[last] - step) < 1e-6 * step) ++last;
  return {first, last};
}

}  // namespace

void add_motion_parts(const Run& run, std::size_t first, std::size_t last, Table& table) {
  const History& history = *run.history;
  const double begin = history.time[first], end = history.time[last];

  TableBlock motion{
      .name = "motion",
      .columns = {
          {"time", "in units of 1/Omega_n", {}},
          {"left wall", "x, absolute displacement of the left cavity wall, divided by the clearance", {}},
          {"right wall", "x + 1, that of the right wall less the width of the mass", {}},
          {"secondary mass", "z = x + y, absolute, divided by the clearance", {}},
          {"relative", "y, secondary mass from the left wall, divided by the clearance", {}}}};
  TableBlock impacts{
      .name = "impacts",
      .columns = {{"time", "in units of 1/Omega_n", {}},
                  {"wall", "0 left, 1 right: y at the impact", {}},
                  {"impacts", "absolute displacement of that wall, divided by the clearance", {}}}};
  const auto add_motion = [&](double time, double x, double y) {
    const double row[] = {time, x, x + 1, x + y, y};
    for (std::size_t c = 0; c < 5; ++c) motion.columns[c].values.push_back(row[c]);
  };
  const Impacts& all = *run.impacts;
  std::size_t next = static_cast<std::size_t>(std::ranges::lower_bound(all.time, begin) - all.time.begin());
  for (std::size_t i = first; i <= last; ++i) {
    for (; next < all.time.size() && all.time[next] <= history.time[i]; ++next) {
      const double time = all.time[next], x = all.displacement[next];
      const double wall = static_cast<double>(all.wall[next]);
      const double row[] = {time, wall, x + wall};
      for (std::size_t c = 0; c < 3; ++c) impacts.columns[c].values.push_back(row[c]);
      if (time < history.time[i]) add_motion(time, x, wall);
    }
    add_motion(history.time[i], history.x[i], history.dampers[0].y[i]);
  }
  table.blocks.push_back(std::move(motion));
  if (!impacts.columns[0].values.empty()) table.blocks.push_back(std::move(impacts));

  const Contacts contacts = stuck_contacts(run);
  TableBlock stuck{.name = "stuck",
                   .columns = {{"begin", "of a stuck interval, in units of 1/Omega_n", {}},
                               {"end", "of it", {}},
                               {"wall", "0 left, 1 right", {}}}};
  for (std::size_t i = 0; i < contacts.begin.size(); ++i) {
    if (contacts.end[i] < begin || contacts.begin[i] > end) continue;
    stuck.columns[0].values.push_back(std::max(begin, contacts.begin[i]));
    stuck.columns[1].values.push_back(std::min(end, contacts.end[i]));
    stuck.columns[2].values.push_back(static_cast<double>(contacts.wall[i]));
  }
  if (!stuck.columns[0].values.empty()) table.blocks.push_back(std::move(stuck));
}

void add_motion_blocks(const Figure& figure, const FigureRun& source, Table& table) {
  const auto [first, last] = find_window(figure, source);
  if (!source.run.impacts) throw unusable(figure, source.file, "holds no impacts");
  if (!source.run.contacts) throw unusable(figure, source.file, "holds no contacts");
  add_motion_parts(source.run, first, last, table);
  if (std::ranges::find(table.blocks, "impacts", &TableBlock::name) == table.blocks.end())
    throw unusable(figure, source.file, "has no impact in the window");
}

}  // namespace impact_damper
