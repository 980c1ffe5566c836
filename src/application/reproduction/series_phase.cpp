// Figure 15: phases of the impacts in the half cycle, the stuck regime, and the closed forms for both.
#include <algorithm>
#include <iterator>
#include <numbers>

#include "application/reproduction/series_blocks.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"

namespace impact_damper {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr int theory_points = 120;

TableColumn amplitude_column() {
  return {"amplitude", "peak amplitude of the half cycle, divided by the clearance", {}};
}

TableBlock impacts_block(const Impacts& impacts) {
  TableBlock block{
      .name = "impacts",
      .columns = {amplitude_column(),
                  {"impact", "phase in degrees from the last zero crossing, 180 to the next", {}}}};
  for (std::size_t i = 0; i < impacts.time.size(); ++i) {
    if (!impacts.phase_deg[i] || !impacts.amplitude[i]) continue;
    block.columns[0].values.push_back(*impacts.amplitude[i]);
    block.columns[1].values.push_back(*impacts.phase_deg[i]);
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
    if (last_row && row > *last_row + 1) block.gaps.push_back(block.columns[0].values.size());
    last_row = row;
    block.columns[0].values.push_back(stuck.amplitude[i]);
    block.columns[1].values.push_back(stuck.begin_deg[i]);
    block.columns[2].values.push_back(stuck.end_deg[i]);
  }
  return block;
}

// Returns the longest regular window of each number of impacts.
TableBlock windows_block(const Run& run) {
  const std::vector<RegularWindow> windows = regular_windows(run);
  TableBlock block{
      .name = "windows",
      .columns = {{"impacts", "per half cycle, throughout the window", {}},
                  {"upper", "amplitude at which the window begins, divided by the clearance", {}},
                  {"lower", "amplitude at which it ends", {}}}};
  for (std::int64_t impacts = 6; impacts >= 1; --impacts) {
    const auto window = longest_window(windows, impacts);
    if (!window) continue;
    block.columns[0].values.push_back(static_cast<double>(impacts));
    block.columns[1].values.push_back(window->upper);
    block.columns[2].values.push_back(window->lower);
  }
  return block;
}

TableBlock theory_block(const std::string& name, const std::string& legend) {
  return {.name = name,
          .notes = {"closed form for nu -> 0, zeta = 0"},
          .columns = {amplitude_column(), {legend, "phase in degrees", {}}}};
}

void add_row(TableBlock& block, double amplitude, double phase) {
  block.columns[0].values.push_back(amplitude);
  block.columns[1].values.push_back(phase);
}

void add_theory(const Run& run, Table& table) {
  const Scene& scene = run.scene;
  const double e = scene.damper().restitution;
  if (scene.damping_ratio != 0 || scene.force_amplitude != 0 || !(e > 0) || e > 0.95) return;
  TableBlock one = theory_block("one-impact", "one impact, equally spaced");
  const double fold = fold_amplitude(e), unequal = equal_spacing_amplitude(e);
  for (int k = 0; k <= theory_points; ++k) {
    const double amplitude = fold + (unequal - fold) * k / theory_points;
    if (const auto motion = single_impact(e, amplitude)) add_row(one, amplitude, motion->phase_deg);
  }
  table.blocks.push_back(std::move(one));

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
      add_row(blocks[n], amplitude, motion.time[n] * degrees);
    if (motion.sticks) add_row(blocks[bounces], amplitude, motion.accumulation * degrees);
  }
  std::ranges::move(blocks, std::back_inserter(table.blocks));
}

}  // namespace

void add_phase_parts(const Run& run, Table& table) {
  const auto add = [&](TableBlock block) {
    if (!block.columns[0].values.empty()) table.blocks.push_back(std::move(block));
  };
  add(impacts_block(*run.impacts));
  add(stuck_block(*run.half_cycles, stuck_phases(run)));
  add(windows_block(run));
  add_theory(run, table);
}

void add_phase_blocks(const Figure& figure, const FigureRun& source, Table& table) {
  half_cycles_of(figure, source);
  if (!source.run.impacts) throw unusable(figure, source.file, "holds no impacts");
  if (!source.run.contacts) throw unusable(figure, source.file, "holds no contacts");
  add_phase_parts(source.run, table);
  const auto need = [&](std::string_view block, const std::string& what) {
    if (std::ranges::find(table.blocks, block, &TableBlock::name) == table.blocks.end())
      throw unusable(figure, source.file, "has no " + what);
  };
  need("impacts", "impact with a phase");
  need("stuck", "stuck interval");
  need("windows", "regular window");
}

}  // namespace impact_damper
