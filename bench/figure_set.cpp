#include <map>

#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/series.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "measurements.hpp"

namespace impact_damper::bench {
namespace {

struct Work {
  Catalogue catalogue;
  std::map<std::string, Scene> scenes;
};

// Seconds by part, in the order in which the parts come up.
class Parts {
 public:
  template <class Do>
  void spend(const std::string& name, Do&& work) {
    const double seconds = cpu_seconds(work);
    for (FigureSet::Part& part : parts_) {
      if (part.name == name) {
        part.share += seconds;
        return;
      }
    }
    parts_.push_back({name, seconds});
  }
  std::vector<FigureSet::Part> shares() const {
    double sum = 0;
    for (const FigureSet::Part& part : parts_) sum += part.share;
    std::vector<FigureSet::Part> all = parts_;
    for (FigureSet::Part& part : all) part.share /= sum;
    return all;
  }

 private:
  std::vector<FigureSet::Part> parts_;
};

// Simulates the ensembles that a figure shows, on one thread.
void add_members(const Figure& figure, FigureRuns& runs) {
  for (const std::string& scene : scenes_of(figure)) {
    FigureRun& source = runs.at(scene);
    const std::int64_t members = members_shown(figure, scene);
    if (members <= std::int64_t(source.others.size()) + 1) continue;
    std::vector<Scene> scenes = ensemble_of(source.run.scene, {.members = members});
    scenes.erase(scenes.begin());
    source.others = simulate_scenes(scenes, source.run.engine, Record{}, 1);
  }
}

void make_all(const Work& work, Parts& parts, FigureSet& set) {
  FigureRuns runs;
  set.scenes = set.tables = set.bytes = 0;
  for (const CatalogueScene& scene : work.catalogue.scenes) {
    parts.spend("scenes", [&] {
      runs[scene.name] = {scene.name, simulate(work.scenes.at(scene.name), Exact{}, scene.record)};
    });
    ++set.scenes;
  }
  for (const Figure& figure : work.catalogue.figures) {
    // The paper's figures, of the scenes' runs alone.
    if (figure.table == TableKind::drawing || !figure.responses.empty() || !figure.plan.empty() ||
        !runs_of(figure).empty())
      continue;
    bool ensemble = false;
    for (const FigureCurve& curve : figure.curves) ensemble |= curve.ensemble > 0;
    const std::string kind =
        "tables: " + std::string(name_of(figure.table)) + (ensemble ? " with an ensemble" : "");
    Table table;
    parts.spend(kind, [&] {
      add_members(figure, runs);
      table = figure_table(figure, runs);
    });
    parts.spend("tables as text", [&] { set.bytes += std::int64_t(to_text(table).size()); });
    ++set.tables;
  }
}

}  // namespace

FigureSet measure_figure_set(const std::filesystem::path& source, int repeats) {
  Work work{read_catalogue(source / "figures/catalogue.json"), {}};
  for (const CatalogueScene& scene : work.catalogue.scenes) {
    work.scenes[scene.name] = read_scene(source / "data/scenes" / (scene.name + ".json"));
  }
  FigureSet set;
  Parts parts;
  set.timing = measure([&] { make_all(work, parts, set); }, repeats);
  set.parts = parts.shares();
  return set;
}

}  // namespace impact_damper::bench
