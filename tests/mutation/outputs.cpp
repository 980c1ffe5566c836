// Lists what the program gives out, one output a line with the faults that planter.cpp can plant in it:
//
//   exact/impacts.time scaled negated shifted
//
// Run entries for each engine, of one damper ("exact", "restitution", "cem") and of several ("exact-dampers",
// ...), and once more as they are written ("file") and read ("read"), table columns, measures. The keys are
// those of the run files, the columns those of the catalogue's figures. Fails where a key has no planter.
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "application/reproduction/measures.hpp"
#include "application/reproduction/series.hpp"
#include "application/sweeps/plan.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "planter.hpp"

using namespace impact_damper;

namespace {

std::map<std::string, std::set<std::string_view>> outputs;  // and the kinds of their faults

// A decay with all that can be recorded in it: damped and forced, it begins stuck or in a wall, and ends so.
Run full_run(const Engine& engine, bool several) {
  const bool rigid = std::holds_alternative<Restitution>(engine);
  Scene scene{.damping_ratio = 0.02,
              .x0 = -2,
              .v0 = 0.3,
              .force_amplitude = 0.5,
              .force_frequency = 0.7,
              .until_time = 36.5,
              .until_amplitude = 1e-3,
              .dampers = {{.mass_ratio = 0.3,
                           .restitution = 0.3,
                           .wall_stiffness = 300,
                           .y0 = rigid ? 0 : -0.01,
                           .w0 = rigid ? 0 : 0.1}}};
  if (several) {
    scene.dampers.push_back({0.1, 0.4, 1.5, 200, 0.3, 0.2});
    scene.until_time = 38.75;
  }
  return simulate(scene, engine, {true, true, true, true, {{0, 40, 401}}, {}});
}

// Has the file's text no member of Run behind it, or one that everything else follows from?
bool in_file_only(const std::string& key) {
  return key == "schema" || key == "engine.name" || key.starts_with("provenance.") ||
         key.starts_with("units.") || key.ends_with("total");
}

bool list_run(const Run& run) {
  bool all_known = true;
  constexpr Scales scales{.mass = 40, .stiffness = 16000, .length = 10};
  const std::string text = run_text(run, scales);
  const std::string engine = std::string(name_of(run.engine)) + (has_one_damper(run.scene) ? "" : "-dampers");
  const auto visit = [&](auto& self, const nlohmann::json& value, const std::string& key) -> void {
    if (value.is_object()) {
      for (const auto& [name, part] : value.items()) self(self, part, key.empty() ? name : key + '.' + name);
      return;
    }
    if (value.is_array() && !value.empty() && value[0].is_object()) self(self, value[0], key + ".1");
    for (const std::string_view kind : planted::kinds) {
      Run altered = run;
      std::string altered_text = text;
      const bool in_run = planted::alter(altered, key, kind),
                 in_file = planted::alter(altered_text, key, kind);
      if (!in_file || in_run == in_file_only(key)) {
        std::cerr << engine << ": " << key << ": planter.cpp cannot alter it\n";
        all_known = false;
        return;
      }
      if (in_run && run_text(altered, scales) != text) {
        outputs[engine + '/' + key].insert(kind);
        outputs["read/" + key].insert(kind);
      }
      if (altered_text != text) outputs["file/" + key].insert(kind);
    }
  };
  visit(visit, nlohmann::json::parse(text), "");
  return all_known;
}

// The table of a plan, of two draws of each point.
SweepTable made_of(const std::filesystem::path& file) {
  SweepTable sweep{file, read_plan(file), {}};
  sweep.plan.samples->count = 2;
  for (std::int64_t i = 0; i < runs_of(sweep.plan); ++i) {
    std::istringstream row(row_of(sweep.plan, i));
    std::vector<std::string>& cells = sweep.rows.emplace_back();
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
  }
  return sweep;
}

void list_tables(const std::filesystem::path& source) {
  const Catalogue catalogue = read_catalogue(source / "figures/catalogue.json");
  FigureRuns runs;
  for (const CatalogueScene& each : catalogue.scenes) {
    const auto file = source / "data/scenes" / (each.name + ".json");
    runs[each.name] = {file, simulate(read_scene(file), Exact{}, each.record)};
  }
  for (Figure figure : catalogue.figures) {
    if (figure.table == TableKind::drawing) continue;
    for (const std::string& name : runs_of(figure)) {
      const CatalogueRun& drawn = *find_run(catalogue.runs, name);
      const auto file = source / "data/scenes" / (drawn.scene + ".json");
      const Scene scene = changed_scene(drawn, read_scene(file));
      const std::vector<Run> releases = simulate_ensemble(scene, *drawn.engine, drawn.record, {.members = 2});
      runs[name] = {file, releases[0], {releases[1]}};
    }
    for (FigureCurve& curve : figure.curves) {
      if (curve.scene.empty()) continue;
      curve.ensemble = std::min<std::int64_t>(curve.ensemble, 2);
      FigureRun& drawn = runs.at(curve.scene);
      if (curve.ensemble == 2 && drawn.others.empty())
        drawn.others.push_back(simulate(ensemble_of(drawn.run.scene)[1], Exact{}, {}));
    }
    FigureResponses responses;
    for (const std::string& name : figure.responses) {
      const CatalogueResponse& asked = *find_response(catalogue.responses, name);
      responses[name] = {name, found_for(asked_for(asked, runs.at(asked.scene).run.scene), {})};
    }
    FigureSweeps sweeps;
    if (!figure.plan.empty()) sweeps[figure.plan] = made_of(source / "figures" / figure.plan);
    const Table table = figure_table(figure, runs, responses, sweeps);
    for (const TableBlock& block : table.blocks)
      for (std::size_t c = 1; c <= block.columns.size(); ++c) {
        const std::string column = planted::family(block.name) + '.' + std::to_string(c);
        for (const std::string_view kind : planted::kinds) {
          Table altered = table;
          planted::alter(altered, column, kind);
          if (to_text(altered) != to_text(table))
            outputs["table/" + planted::kind_of_table(figure) + '.' + column].insert(kind);
        }
      }
  }
}

}  // namespace

int main(int, char** arguments) {
  bool all_known = true;
  for (const Engine& engine : {Engine(Exact{}), Engine(Restitution{}), Engine(Cem{.locate = true})})
    for (const bool several : {false, true}) all_known = list_run(full_run(engine, several)) && all_known;
  list_tables(arguments[1]);
  for (const Measure& measure : measures())
    for (const std::string_view value : {"median", "low", "high"})
      outputs["measure/" + std::string(measure.name) + '.' + std::string(value)] = {"scaled", "negated"};
  for (const auto& [output, faults] : outputs) {
    std::cout << output;
    for (const std::string_view kind : planted::kinds)
      if (faults.contains(kind)) std::cout << ' ' << kind;
    std::cout << '\n';
  }
  return all_known ? 0 : 1;
}
