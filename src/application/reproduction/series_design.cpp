// Tables of what a damper is chosen by: the design charts, from a sweep over restitution and mass ratio that
// keeps the loss factor at many amplitudes, of several releases each; several dampers, their loss together
// beside the sum of the losses of each alone; and one with friction, weight, drag or a law of the walls.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "application/reproduction/series.hpp"
#include "impact_damper/analysis/damper_sets.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/math/elementary.hpp"

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

// Returns the run and the others of its ensemble.
std::vector<Run> releases_of(const FigureRun& source) {
  std::vector<Run> runs{source.run};
  runs.insert(runs.end(), source.others.begin(), source.others.end());
  return runs;
}

const char* const of_middle = "peak amplitude, divided by epsilon; the middle of a twelfth of a decade";

// Edges of the bins of Figure::range, descending, and the middles between them.
struct Bins {
  std::vector<double> edges, middles;

  explicit Bins(const Figure& figure)
      : edges(descending_amplitudes(figure.range[1], figure.range[0], set_bins_in_decade)) {
    for (std::size_t k = 0; k + 1 < edges.size(); ++k) middles.push_back(std::sqrt(edges[k] * edges[k + 1]));
  }
};

// Adds a line for each run that the figure draws, and its engine, to the header.
void add_runs(const Figure& figure, const FigureRuns& runs, Table& table) {
  for (const std::string& name : runs_of(figure)) {
    const FigureRun& source = runs.at(name);
    table.header.push_back("Run " + name + ", " + std::to_string(source.others.size() + 1) +
                           " releases: " + scene_text(source.run.scene));
    table.header.push_back("  engine: " + options_text(source.run.engine));
  }
}

// The components of a scene, one to a panel.
struct Component {
  const char *symbol, *without;  // `without`: the legend where there is none
  double (*of)(const Scene&);    // 0 where there is none

  std::string legend(const Scene& scene) const {
    const double value = of(scene);
    if (value == 0) return without;
    return std::isfinite(value) ? std::string(symbol) + " = " + number_text(value) : "table";
  }
};
// Returns the exponent of the walls' force; infinity for a table.
double exponent_of_walls(const Scene& scene) {
  switch (scene.damper().wall.law) {
    case WallForm::linear:
      return 0;
    case WallForm::power:
      return scene.damper().wall.exponent;
    case WallForm::table:
      break;
  }
  return std::numeric_limits<double>::infinity();
}
constexpr std::array components{
    Component{"φ", "φ = 0", [](const Scene& scene) { return scene.damper().friction; }},
    Component{"γ", "γ = 0", [](const Scene& scene) { return scene.weight; }},
    Component{"d", "d = 0", [](const Scene& scene) { return scene.damper().drag; }},
    Component{"p", "rigid", exponent_of_walls}};

// Throws unusable() unless the run is of a single damper with one component at most, without other laws, and
// has the ratios of the first.
void check_component(const Figure& figure, const FigureRun& source, const FigureRun& first) {
  const Scene &scene = source.run.scene, &wanted = first.run.scene;
  if (!has_one_damper(scene)) throw unusable(figure, source.file, "must be of a single damper");
  if (std::ranges::count_if(components, [&](const Component& each) { return each.of(scene) != 0; }) !=
      (is_ideal(scene) ? 0 : 1))
    throw unusable(figure, source.file, "must have one of friction, weight, drag and a law of the walls");
  if (scene.damper().mass_ratio != wanted.damper().mass_ratio ||
      scene.damper().restitution != wanted.damper().restitution ||
      scene.damping_ratio != wanted.damping_ratio)
    throw unusable(figure, source.file, "must have the ratios of " + first.file.string());
}

void check_sources(const Figure& figure, const FigureRun& set, const FigureRun& alone) {
  if (has_one_damper(set.run.scene))
    throw unusable(figure, set.file, "must be of a scene with a list of dampers");
  if (!has_one_damper(alone.run.scene)) throw unusable(figure, alone.file, "must be of a single damper");
  if (!alone.run.scene.until_amplitude) throw unusable(figure, alone.file, "must stop at an amplitude");
  for (const SceneDamper& damper : set.run.scene.dampers)
    if (damper.restitution != alone.run.scene.damper().restitution)
      throw unusable(figure, alone.file, "must have the restitution of the dampers of " + set.file.string());
}

}  // namespace

Table design_table(const Figure& figure, const SweepTable& sweep) {
  check_plan(figure, sweep);
  const Plan& plan = sweep.plan;
  const auto draws = std::size_t(plan.samples ? plan.samples->count : 1);
  Table table{header_of(figure, "ζ = " + number_text(plan.scene.scene.damping_ratio) + "; mean of " +
                                    std::to_string(draws) + (draws == 1 ? " release" : " releases")),
              {}};
  table.header.insert(table.header.end(), {"Plan " + figure.plan, "  " + plan.description});
  const GridAxis &restitutions = plan.grid[0], &mass_ratios = plan.grid[1];
  const double least = *plan.quantities.front().at, most = *plan.quantities.back().at;
  TableBlock reading{.name = "reading", .notes = {"the example of the report"}};
  for (std::int64_t i = 0; i < restitutions.size(); ++i) {
    const double e = restitutions.value(i);
    const std::string panel = std::to_string(i + 1);
    table.add({.name = "panel-" + panel,
               .columns = {{"restitution", "e", {e}}, {"e = " + number_text(e), "e", {e}}}});
    for (std::int64_t j = 0; j < mass_ratios.size(); ++j) {
      const double nu = mass_ratios.value(j);
      TableBlock curve{.name = "curve-" + panel + "-" + std::to_string(j + 1),
                       .notes = {"down to where one of the releases has no loss factor any more"},
                       .columns = {{"amplitude", of_peak},
                                   {"ν = " + rounded_text(100 * nu, 3) + " %", of_mean_loss},
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
          if (curve.rows() == 0) continue;  // above the release
          break;
        }
        const double amplitude = *plan.quantities[n].at, mean = sum / double(draws);
        const Spread spread = spread_of(values);
        curve.add_row({amplitude, mean, spread.low, spread.high});
        if (e == example.restitution && nu == example.mass_ratio && amplitude == example.amplitude)
          reading.columns = {{"amplitude", of_peak, {amplitude}},
                             {"example", of_mean_loss, {mean}},
                             {"restitution", "e", {e}},
                             {"mass ratio", "nu", {nu}}};
      }
      table.add_if_any(std::move(curve));
    }
    for (const auto& [name, amplitude] :
         {std::pair("failure-" + panel, fold_amplitude(e)), {"bounce-down-" + panel, bounce_down_end(e)}})
      if (amplitude > least && amplitude < most)
        table.add({.name = name,
                   .notes = {"closed form for nu -> 0"},
                   .columns = {{"amplitude", of_peak, {amplitude}}, {name, "restitution e", {e}}}});
  }
  table.add_if_any(std::move(reading));
  return table;
}

Table damper_sets_table(const Figure& figure, const FigureRuns& runs) {
  for (const FigureCurve& curve : figure.curves)
    check_sources(figure, runs.at(curve.run), runs.at(curve.alone));
  const Scene& first = runs.at(figure.curves.front().run).run.scene;
  Table table{header_of(figure, "e = " + number_text(first.dampers.front().restitution) +
                                    ", ζ = " + number_text(first.damping_ratio) + "; restitution model"),
              {}};
  add_runs(figure, runs, table);
  const Bins bins(figure);
  const std::vector<double>&edges = bins.edges, &middles = bins.middles;
  for (std::size_t i = 0; i < figure.curves.size(); ++i) {
    const FigureRun &set = runs.at(figure.curves[i].run), &one = runs.at(figure.curves[i].alone);
    for (const FigureRun* source : {&set, &one}) half_cycles_of(figure, *source);
    const std::vector<SceneDamper>& dampers = set.run.scene.dampers;
    const double mass = std::accumulate(dampers.begin(), dampers.end(), 0.0,
                                        [](double sum, const auto& each) { return sum + each.mass_ratio; });
    LossSpread losses = losses_between(releases_of(set), edges);
    std::vector<double> sum = sum_of_losses(dampers, loss_alone(releases_of(one)), edges);
    for (std::vector<double>* values : {&losses.mean, &losses.low, &losses.high, &sum})
      for (double& value : *values) value /= mass;
    const std::string number = std::to_string(i + 1), count = std::to_string(dampers.size());
    table.add({.name = "set-" + number,
               .notes = {"run " + figure.curves[i].run},
               .columns = {{"amplitude", of_middle, middles},
                           {count + (dampers.size() == 1 ? " damper" : " dampers"),
                            "loss factor eta / (sum of nu) by the mean of the releases' times", losses.mean},
                           {"least", "of the releases", losses.low, Ordinate::low},
                           {"greatest", "of the releases", losses.high, Ordinate::high}}});
    table.add({.name = "sum-" + number,
               .notes = {"run " + figure.curves[i].alone + " for each damper"},
               .columns = {{"amplitude", of_middle, middles},
                           {"sum of " + count + " alone", "the same if they add", sum}}});
    TableBlock list{.name = "dampers-" + number,
                    .columns = {{"clearance", "divided by epsilon"}, {"mass", "nu_i / (sum of nu)"}}};
    for (const SceneDamper& damper : dampers) list.add_row({damper.clearance, damper.mass_ratio / mass});
    table.add(std::move(list));
  }
  return table;
}

Table components_table(const Figure& figure, const FigureRuns& runs) {
  const FigureRun& first = runs.at(figure.curves.front().run);
  for (const FigureCurve& curve : figure.curves) check_component(figure, runs.at(curve.run), first);
  const SceneDamper& damper = first.run.scene.damper();
  Table table{header_of(figure, "ν = " + rounded_text(100 * damper.mass_ratio, 3) +
                                    " %, e = " + number_text(damper.restitution) +
                                    ", ζ = " + number_text(first.run.scene.damping_ratio)),
              {}};
  add_runs(figure, runs, table);
  const Bins bins(figure);
  for (std::size_t p = 0; p < components.size(); ++p) {
    const Component& component = components[p];
    const auto is_drawn = [&](const FigureCurve& curve) {
      const Scene& scene = runs.at(curve.run).run.scene;
      return component.of(scene) != 0 || is_ideal(scene);
    };
    std::size_t count = 0;
    for (const FigureCurve& curve : figure.curves) {
      if (!is_drawn(curve)) continue;
      const FigureRun& source = runs.at(curve.run);
      half_cycles_of(figure, source);
      const Scene& scene = source.run.scene;
      const double nu = scene.damper().mass_ratio;
      LossSpread losses = losses_between(releases_of(source), bins.edges);
      for (std::vector<double>* values : {&losses.mean, &losses.low, &losses.high})
        for (std::size_t k = 0; k < values->size(); ++k) (*values)[k] *= bins.middles[k] / nu;
      const std::string number = std::to_string(p + 1) + "-" + std::to_string(++count);
      const std::string legend = component.legend(scene);
      table.add({.name = "curve-" + number,
                 .notes = {"run " + curve.run},
                 .columns = {{"amplitude", of_middle, bins.middles},
                             {legend, "A eta / nu by the mean of the releases' times", losses.mean},
                             {"least", "of the releases", losses.low, Ordinate::low},
                             {"greatest", "of the releases", losses.high, Ordinate::high}}});
      const double most = scene.damper().holding() + scene.weight;
      const double locking = locking_amplitude(1 / square_root(1 + nu), most);
      if (locking > figure.range[0] && locking < figure.range[1])
        table.add({.name = "locking-" + number,
                   .notes = {"closed form (M18.4): friction, or its weight on the floor, holds the mass"},
                   .columns = {{"amplitude", "peak amplitude, divided by epsilon", {locking}},
                               {legend, "of the component", {component.of(scene)}}}});
    }
  }
  return table;
}

}  // namespace impact_damper
