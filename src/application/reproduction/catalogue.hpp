// The catalogue of figures: which scenes are run and what each must record, and for every figure its
// title, its curves, its table, its script and the claims that rest on it. Kept in
// figures/catalogue.json; the build makes its rules and the figure stage its tables from this one file.
//
//   {"schema": "impact-damper/catalogue/1",
//    "members": 16,
//    "scenes":  [{"scene": "nu2-e06", "record": ["half_cycles", "impacts"],
//                 "history_below": [{"amplitude": 5.6, "length": 12.6, "count": 2001}]}],
//    "runs":    [{"name": "nu2-e06.soft", "scene": "nu2-e06", "set": {"wall_stiffness": 1000},
//                 "record": ["half_cycles"]},
//                {"name": "nu2-e06.restitution", "scene": "nu2-e06", "engine": {"name": "restitution"},
//                 "record": ["half_cycles"]}],
//    "responses": [{"name": "nu2-e06.sweep-30", "scene": "nu2-e06", "set": {"force_amplitude": 0.006},
//                   "kind": "sweep", "rule": {"max_periods": 1000},
//                   "vary": [{"number": "force_frequency", "from": 0.95, "to": 1.05, "count": 101}]}],
//    "figures": [{"figure": "8", "title": "...", "table": "loss_factor", "ordinate": "eta",
//                 "varied": "mass_ratio", "curves": [{"scene": "nu2-e06", "half_cycles": 10}],
//                 "down_to": 0.1, "script": "fig08.gp", "claims": ["..."]}]}
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/responses/response_file.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// The kinds of table that a figure can draw.
enum class TableKind {
  motion,            // both walls and the secondary mass over time, in one window of the history
  decay,             // peak amplitude over time
  loss_factor,       // one of the ordinates of the averaged loss factor over amplitude
  phase,             // impact phase and stuck intervals over amplitude
  response,          // amplitude over the frequency of a force, with the branches of periodic motions
  largest_response,  // largest steady amplitude over the force, with the prediction from a free decay
  response_map,      // which steady motion there is, over frequency and amplitude of a force
  design_charts,     // loss factor over amplitude for many restitutions and mass ratios, of a sweep
  damper_sets,       // loss factor of several dampers over amplitude, and the sum of theirs
  components,        // the same of one damper with friction, weight or drag
  drawing,           // none: a schematic without runs
};

// The number in which the curves of a figure differ; the legend shows it.
enum class Varied { mass_ratio, damping_ratio, restitution };

struct CatalogueScene {
  std::string name;  // of the scene's file, without .json
  Record record;
};

// A further run that measures compare with: a scene with some numbers changed, another engine, or both. Its
// file lies beside the runs of the scenes, and it has an ensemble as they have (scene_runs.hpp).
struct CatalogueRun {
  std::string name;                                // of its file, without .json; unique in the catalogue
  std::string scene;                               // of the catalogue; with an `engine`, of the project
  std::map<std::string, double, std::less<>> set;  // the changed numbers: fields of Scene
  std::optional<Engine> engine;                    // absent: that of the scenes' runs
  Record record;
};
// Returns `scene` with the changed numbers of `run` in place of its own.
Scene changed_scene(const CatalogueRun& run, Scene scene);

// Steady motions under a force, of a scene with some numbers changed; NAME.json beside the runs. The
// component element method cannot find them, so they do not depend on the engine of the runs.
struct CatalogueResponse {
  std::string name;                                // of its file, without .json; unique in the catalogue
  std::string scene;                               // of the catalogue
  std::map<std::string, double, std::less<>> set;  // the changed numbers: fields of Scene
  // The request without the scene and without results. A sweep and orbits begin with the scene's own release,
  // which asked_for() fills in, then with the starts given here.
  Response asked;
};
// Returns the complete request: for `scene` with the changed numbers, its release being the first start.
Response asked_for(const CatalogueResponse& response, const Scene& scene);

struct FigureCurve {
  std::string scene;  // empty where runs are drawn
  // damper_sets tables: a run of several dampers and one of a single damper, of the catalogue's runs;
  // components tables: a run, `alone` is empty.
  std::string run, alone;
  // loss_factor and largest_response tables only:
  LossFactorOptions loss_factor;  // its window of averaging
  std::int64_t ensemble = 0;      // members of the ensemble whose spread is shown; 0 for none
};

struct Figure {
  std::string number;  // "1" ... "15", "A" ... "J"
  std::string title;
  TableKind table = TableKind::drawing;
  // One for motion, phase and largest_response; none for a drawing, response, response_map, design_charts.
  std::vector<FigureCurve> curves;
  std::vector<std::string> responses;           // names in the catalogue, for tables of responses
  std::string plan;                             // design_charts: plan of its sweep, beside the catalogue
  std::optional<LossOrdinate> ordinate;         // of loss_factor tables only
  std::optional<LossOrdinate> second_ordinate;  // of a second panel with the same curves, if there is one
  std::optional<Varied> varied;                 // if there is more than one curve
  std::optional<double> window;   // motion tables: the amplitude of one of the scene's history windows
  std::optional<double> down_to;  // amplitude that every curve must reach; otherwise its run is too short
  // Two amplitudes: the range of the spread in a loss_factor table, empty for none, or of a damper_sets or
  // components table.
  std::vector<double> range;
  std::string script;               // beside the catalogue; unique even without its ending
  std::vector<std::string> claims;  // ids in data/claims.json
};

struct Catalogue {
  std::int64_t members = 1;  // of each scene's ensemble, the scene itself included; 1 to 100
  std::vector<CatalogueScene> scenes;
  std::vector<CatalogueRun> runs;
  std::vector<CatalogueResponse> responses;
  std::vector<Figure> figures;
};

// Reads a catalogue and checks it: every scene must be known and record what its figures draw, every number
// be given once. Throws IoError or InputError.
inline constexpr FileKind catalogue_kind{"catalogue", 1 << 20};
Catalogue read_catalogue(const std::filesystem::path& file);
Catalogue parse_catalogue(const std::string& name, const std::string& text);

// Returns the scene, run, response or figure of that name; a null pointer if there is none.
const CatalogueScene* find_scene(const Catalogue& catalogue, std::string_view name);
const CatalogueRun* find_run(const std::vector<CatalogueRun>& runs, std::string_view name);
const CatalogueResponse* find_response(const std::vector<CatalogueResponse>& responses,
                                       std::string_view name);
const Figure* find_figure(const Catalogue& catalogue, std::string_view number);

// Returns the name of the figure's table and pictures without endings, that of its script: "fig08" for
// fig08.gp.
std::string file_stem(const Figure& figure);

// Returns the name of the files of the figure's sweep without their endings, that of its plan.
std::string sweep_stem(const Figure& figure);

// Returns the scenes of a figure, each once, in the order of its curves.
std::vector<std::string> scenes_of(const Figure& figure);
// Returns the further runs of a figure, likewise.
std::vector<std::string> runs_of(const Figure& figure);

}  // namespace impact_damper
