// Figures 1-6: the secondary mass between its walls, in one window of the history. Figure 15: phases of the
// impacts in the half cycle, the stuck regime, and the closed forms for both.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "application/reproduction/series.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
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
  if (!row)
    throw unusable(figure, source.file,
                   "is too short: no half cycle has an amplitude below " + number_text(*figure.window));
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

constexpr double degrees = 180 / std::numbers::pi;
constexpr int theory_points = 120;

TableColumn amplitude_column() {
  return {"amplitude", "peak amplitude of the half cycle, divided by the clearance"};
}

TableBlock impacts_block(const Impacts& impacts) {
  TableBlock block{.name = "impacts",
                   .columns = {amplitude_column(),
                               {"impact", "phase in degrees from the last zero crossing, 180 to the next"}}};
  for (std::size_t i = 0; i < impacts.time.size(); ++i) {
    if (impacts.phase_deg[i] && impacts.amplitude[i])
      block.add_row({*impacts.amplitude[i], *impacts.phase_deg[i]});
  }
  return block;
}

// Returns a row for each half cycle in which the mass sticks; a gap where half cycles without sticking lie
// between.
TableBlock stuck_block(const HalfCycles& rows, const StuckPhases& stuck) {
  TableBlock block{.name = "stuck",
                   .notes = {"an interval that runs on past the zero crossing is listed where it begins"},
                   .columns = {amplitude_column(),
                               {"begin", "phase in degrees at which the mass sticks", {}, Ordinate::low},
                               {"stuck", "phase at which it is released, 180 at most", {}, Ordinate::high}}};
  std::optional<std::size_t> last_row;
  std::size_t row = 0;
  for (std::size_t i = 0; i < stuck.amplitude.size(); ++i) {
    if (!(stuck.begin_deg[i] > 0)) continue;
    while (row + 1 < rows.amplitude.size() && rows.amplitude[row] != stuck.amplitude[i]) ++row;
    if (last_row && row > *last_row + 1) block.gaps.push_back(block.rows());
    last_row = row;
    block.add_row({stuck.amplitude[i], stuck.begin_deg[i], stuck.end_deg[i]});
  }
  return block;
}

// Returns the longest regular window of each number of impacts.
TableBlock windows_block(const Run& run) {
  const std::vector<RegularWindow> windows = regular_windows(run);
  TableBlock block{.name = "windows",
                   .columns = {{"impacts", "per half cycle, throughout the window"},
                               {"upper", "amplitude at which the window begins, divided by the clearance"},
                               {"lower", "amplitude at which it ends"}}};
  for (std::int64_t impacts = 6; impacts >= 1; --impacts)
    if (const auto window = longest_window(windows, impacts))
      block.add_row({static_cast<double>(impacts), window->upper, window->lower});
  return block;
}

TableBlock theory_block(const std::string& name, const std::string& legend) {
  return {.name = name,
          .notes = {"closed form for nu -> 0, zeta = 0"},
          .columns = {amplitude_column(), {legend, "phase in degrees"}}};
}

void add_theory(const Run& run, Table& table) {
  const Scene& scene = run.scene;
  const double e = scene.damper().restitution;
  if (scene.damping_ratio != 0 || scene.force_amplitude != 0 || !(e > 0) || e > 0.95) return;
  TableBlock one = theory_block("one-impact", "one impact, equally spaced");
  const double fold = fold_amplitude(e), unequal = equal_spacing_amplitude(e);
  for (int k = 0; k <= theory_points; ++k) {
    const double amplitude = fold + (unequal - fold) * k / theory_points;
    if (const auto motion = single_impact(e, amplitude)) one.add_row({amplitude, motion->phase_deg});
  }
  table.add(std::move(one));

  const double end = bounce_down_end(e), largest = std::ranges::max(run.half_cycles->amplitude);
  if (!(end < largest)) return;
  constexpr std::size_t bounces = 4;  // further ones crowd before the accumulation
  std::vector<TableBlock> blocks;
  for (std::size_t n = 0; n < bounces; ++n)
    blocks.push_back(theory_block("bounce-" + std::to_string(n + 1), "bounces"));
  blocks.push_back(theory_block("accumulation", "bounces accumulate"));
  for (int k = 0; k <= theory_points; ++k) {
    const double amplitude = end + (largest - end) * k / theory_points;
    const BounceDown motion = bounce_down(e, amplitude);
    for (std::size_t n = 0; n < std::min(bounces, motion.time.size()); ++n)
      blocks[n].add_row({amplitude, motion.time[n] * degrees});
    if (motion.sticks) blocks[bounces].add_row({amplitude, motion.accumulation * degrees});
  }
  std::ranges::move(blocks, std::back_inserter(table.blocks));
}

}  // namespace

void add_motion_parts(const Run& run, std::size_t first, std::size_t last, Table& table) {
  const History& history = *run.history;
  const double begin = history.time[first], end = history.time[last];

  TableBlock motion{
      .name = "motion",
      .columns = {{"time", "in units of 1/Omega_n"},
                  {"left wall", "x, absolute displacement of the left cavity wall, divided by the clearance"},
                  {"right wall", "x + 1, that of the right wall less the width of the mass"},
                  {"secondary mass", "z = x + y, absolute, divided by the clearance"},
                  {"relative", "y, secondary mass from the left wall, divided by the clearance"}}};
  TableBlock impacts{
      .name = "impacts",
      .columns = {{"time", "in units of 1/Omega_n"},
                  {"wall", "0 left, 1 right: y at the impact"},
                  {"impacts", "absolute displacement of that wall, divided by the clearance"}}};
  const auto add_motion = [&](double time, double x, double y) {
    motion.add_row({time, x, x + 1, x + y, y});
  };
  const Impacts& all = *run.impacts;
  std::size_t next = static_cast<std::size_t>(std::ranges::lower_bound(all.time, begin) - all.time.begin());
  for (std::size_t i = first; i <= last; ++i) {
    for (; next < all.time.size() && all.time[next] <= history.time[i]; ++next) {
      const double time = all.time[next], x = all.displacement[next];
      const double wall = static_cast<double>(all.wall[next]);
      impacts.add_row({time, wall, x + wall});
      if (time < history.time[i]) add_motion(time, x, wall);
    }
    add_motion(history.time[i], history.x[i], history.dampers[0].y[i]);
  }
  table.add(std::move(motion));
  table.add_if_any(std::move(impacts));

  const Contacts contacts = stuck_contacts(run);
  TableBlock stuck{.name = "stuck",
                   .columns = {{"begin", "of a stuck interval, in units of 1/Omega_n"},
                               {"end", "of it"},
                               {"wall", "0 left, 1 right"}}};
  for (std::size_t i = 0; i < contacts.begin.size(); ++i) {
    if (contacts.end[i] < begin || contacts.begin[i] > end) continue;
    stuck.add_row({std::max(begin, contacts.begin[i]), std::min(end, contacts.end[i]),
                   static_cast<double>(contacts.wall[i])});
  }
  table.add_if_any(std::move(stuck));
}

void add_motion_blocks(const Figure& figure, const FigureRun& source, Table& table) {
  const auto [first, last] = find_window(figure, source);
  require_impacts(figure, source);
  add_motion_parts(source.run, first, last, table);
  if (!table.has("impacts")) throw unusable(figure, source.file, "has no impact in the window");
}

void add_phase_parts(const Run& run, Table& table) {
  table.add_if_any(impacts_block(*run.impacts));
  table.add_if_any(stuck_block(*run.half_cycles, stuck_phases(run)));
  table.add_if_any(windows_block(run));
  if (is_ideal(run.scene)) add_theory(run, table);
}

void add_phase_blocks(const Figure& figure, const FigureRun& source, Table& table) {
  half_cycles_of(figure, source);
  require_impacts(figure, source);
  add_phase_parts(source.run, table);
  for (const auto& [block, what] : {std::pair("impacts", "impact with a phase"),
                                    {"stuck", "stuck interval"},
                                    {"windows", "regular window"}})
    if (!table.has(block)) throw unusable(figure, source.file, std::string("has no ") + what);
}

}  // namespace impact_damper
