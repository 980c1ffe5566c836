// Tables of several dampers: their loss together, and the sum of the losses of each alone.
#include <cmath>
#include <numeric>

#include "application/reproduction/series_blocks.hpp"
#include "impact_damper/analysis/damper_sets.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

// Returns the run and the others of its ensemble.
std::vector<Run> releases_of(const FigureRun& source) {
  std::vector<Run> runs{source.run};
  runs.insert(runs.end(), source.others.begin(), source.others.end());
  return runs;
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

Table damper_sets_table(const Figure& figure, const FigureRuns& runs) {
  for (const FigureCurve& curve : figure.curves)
    check_sources(figure, runs.at(curve.run), runs.at(curve.alone));
  const Scene& first = runs.at(figure.curves.front().run).run.scene;
  Table table;
  table.header = {"Figure " + figure.number + ": " + figure.title,
                  "Parameters: e = " + number_text(first.dampers.front().restitution) +
                      ", ζ = " + number_text(first.damping_ratio) + "; restitution model",
                  "Script: " + figure.script};
  for (const std::string& name : runs_of(figure)) {
    const FigureRun& source = runs.at(name);
    table.header.push_back("Run " + name + ", " + std::to_string(source.others.size() + 1) +
                           " releases: " + scene_text(source.run.scene));
    table.header.push_back("  engine: " + options_text(source.run.engine));
  }
  const std::vector<double> edges =
      descending_amplitudes(figure.range[1], figure.range[0], set_bins_in_decade);
  std::vector<double> middles;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) middles.push_back(std::sqrt(edges[k] * edges[k + 1]));
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
    const std::string of_peak = "peak amplitude, divided by epsilon; the middle of a twelfth of a decade";
    table.blocks.push_back(
        {.name = "set-" + number,
         .notes = {"run " + figure.curves[i].run},
         .columns = {{"amplitude", of_peak, middles},
                     {count + (dampers.size() == 1 ? " damper" : " dampers"),
                      "loss factor eta / (sum of nu) by the mean of the releases' times", losses.mean},
                     {"least", "of the releases", losses.low, Ordinate::low},
                     {"greatest", "of the releases", losses.high, Ordinate::high}}});
    table.blocks.push_back({.name = "sum-" + number,
                            .notes = {"run " + figure.curves[i].alone + " for each damper"},
                            .columns = {{"amplitude", of_peak, middles},
                                        {"sum of " + count + " alone", "the same if they add", sum}}});
    TableBlock list{.name = "dampers-" + number,
                    .columns = {{"clearance", "divided by epsilon", {}}, {"mass", "nu_i / (sum of nu)", {}}}};
    for (const SceneDamper& damper : dampers) {
      list.columns[0].values.push_back(damper.clearance);
      list.columns[1].values.push_back(damper.mass_ratio / mass);
    }
    table.blocks.push_back(std::move(list));
  }
  try {
    check(table);
  } catch (const std::domain_error& error) {
    throw unusable(figure, runs.at(figure.curves.front().run).file, error.what());
  }
  return table;
}

}  // namespace impact_damper
