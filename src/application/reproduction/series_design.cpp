// The table of the design charts, from a sweep over restitution and mass ratio that keeps the loss factor at
// many amplitudes, of several releases each.
#include <algorithm>
#include <array>

#include "application/reproduction/series_blocks.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

const char* const of_peak = "peak amplitude, divided by the clearance";
const char* const of_mean_loss = "loss factor eta per radian, mean of the releases";

// The example that the report reads off the charts.
struct {
  double restitution = 0.6, mass_ratio = 0.02, amplitude = 1;
} constexpr example;

void check_plan(const Figure& figure, const SweepTable& sweep) {
  const Plan& plan = sweep.plan;
  const bool is_grid = plan.grid.size() == 2 && plan.grid[0].variable.name == "restitution" &&
                       plan.grid[1].variable.name == "mass_ratio" && !plan.scene.in_units;
  const bool is_loss = std::ranges::all_of(
      plan.quantities, [](const KeptQuantity& each) { return each.quantity->name == "loss_factor_at"; });
  if (!is_grid || !is_loss)
    throw unusable(figure, sweep.file,
                   "must be dimensionless, over restitution and mass_ratio, in this order, and keep loss "
                   "factors at amplitudes");
}

}  // namespace

Table design_table(const Figure& figure, const SweepTable& sweep) {
  check_plan(figure, sweep);
  const Plan& plan = sweep.plan;
  const auto draws = std::size_t(plan.samples ? plan.samples->count : 1);
  Table table;
  table.header = {"Figure " + figure.number + ": " + figure.title,
                  "Parameters: ζ = " + number_text(plan.scene.scene.damping_ratio) + "; mean of " +
                      std::to_string(draws) + (draws == 1 ? " release" : " releases"),
                  "Script: " + figure.script, "Plan " + figure.plan, "  " + plan.description};
  const GridAxis &restitutions = plan.grid[0], &mass_ratios = plan.grid[1];
  const double least = *plan.quantities.front().at, most = *plan.quantities.back().at;
  TableBlock reading{.name = "reading", .notes = {"the example of the report"}, .columns = {}};
  for (std::int64_t i = 0; i < restitutions.size(); ++i) {
    const double e = restitutions.value(i);
    const std::string panel = std::to_string(i + 1);
    table.blocks.push_back({.name = "panel-" + panel,
                            .columns = {{"restitution", "e", {e}}, {"e = " + number_text(e), "e", {e}}}});
    for (std::int64_t j = 0; j < mass_ratios.size(); ++j) {
      const double nu = mass_ratios.value(j);
      TableBlock curve{.name = "curve-" + panel + "-" + std::to_string(j + 1),
                       .notes = {"down to where one of the releases has no loss factor any more"},
                       .columns = {{"amplitude", of_peak, {}},
                                   {"ν = " + rounded_text(100 * nu, 3) + " %", of_mean_loss, {}},
                                   {"least", "of the releases", {}, Ordinate::low},
                                   {"greatest", "of the releases", {}, Ordinate::high}}};
      const std::size_t first = std::size_t(i * mass_ratios.size() + j) * draws;
      for (std::size_t n = plan.quantities.size(); n-- > 0;) {
        const std::size_t column = 1 + varied_names(plan).size() + n;
        std::vector<double> values;
        double sum = 0;
        for (std::size_t k = 0; k < draws; ++k) {
          const auto value = parse_number(sweep.rows[first + k][column]);
          if (!value) break;
          values.push_back(*value);
          sum += *value;
        }
        if (values.size() < draws) {
          if (curve.columns[0].values.empty()) continue;  // above the release
          break;
        }
        const double amplitude = *plan.quantities[n].at, mean = sum / double(draws);
        const Spread spread = spread_of(values);
        const std::array row{amplitude, mean, spread.low, spread.high};
        for (std::size_t c = 0; c < row.size(); ++c) curve.columns[c].values.push_back(row[c]);
        if (e == example.restitution && nu == example.mass_ratio && amplitude == example.amplitude)
          reading.columns = {{"amplitude", of_peak, {amplitude}},
                             {"example", of_mean_loss, {mean}},
                             {"restitution", "e", {e}},
                             {"mass ratio", "nu", {nu}}};
      }
      if (!curve.columns[0].values.empty()) table.blocks.push_back(std::move(curve));
    }
    for (const auto& [name, amplitude] :
         {std::pair("failure-" + panel, fold_amplitude(e)), {"bounce-down-" + panel, bounce_down_end(e)}})
      if (amplitude > least && amplitude < most)
        table.blocks.push_back(
            {.name = name,
             .notes = {"closed form for nu -> 0"},
             .columns = {{"amplitude", of_peak, {amplitude}}, {name, "restitution e", {e}}}});
  }
  if (!reading.columns.empty()) table.blocks.push_back(std::move(reading));
  return table;
}

}  // namespace impact_damper
