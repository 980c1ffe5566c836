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
#include "impact_damper/run.hpp"
#include "impact_damper/steady/response_file.hpp"

namespace impact_damper {

// The kinds of table that a figure can draw.
enum class TableKind {
  motion,            // both walls and the secondary mass over time, in one window of the history
  decay,             // peak amplitude over time
  loss_factor,       // one of the ordinates of the averaged loss factor over amplitude
  phase,             // impact phase and stuck intervals over amplitude
  response,          // amplitude over the frequency of a force, with the branches of periodic motions
  largest_response,  // largest steady amplitude over the force, beside what a free decay predicts
  response_map,      // which steady motion there is, over frequency and amplitude of a force
  design_charts,     // loss factor over amplitude for many restitutions and mass ratios, of a sweep
  damper_sets,       // loss factor of several dampers over amplitude, beside the sum of theirs
  drawing,           // none: a schematic that no run stands behind
};

// What the curves of a figure differ in, and so what their legend says.
enum class Varied { mass_ratio, damping_ratio, restitution };

struct CatalogueScene {
  std::string name;  // of the scene's file, without .json
  Record record;
};

// A further run that measures compare with: of a scene with some of its numbers changed, by an engine of its
// own, or both. Its file lies beside the runs of the scenes, and it is an ensemble as these are
// (scene_runs.hpp).
struct CatalogueRun {
  std::string name;   // of its file, without .json; no scene's of the catalogue
  std::string scene;  // one of the catalogue's, or with an engine of its own any of the project's
  std::map<std::string, double, std::less<>> set;  // the changed numbers: fields of Scene
  std::optional<Engine> engine;                    // absent: that of the scenes' runs
  Record record;
};
// `scene` with the numbers of `run` in place of its own.
Scene changed_scene(const CatalogueRun& run, Scene scene);

// Steady motions of a scene, some numbers of which are changed, under a force: NAME.json beside the runs. The
// component element method cannot find them, so they are the same whatever engine the runs are by.
struct CatalogueResponse {
  std::string name;                                // of its file, without .json; no scene's and no run's
  std::string scene;                               // one of the catalogue's
  std::map<std::string, double, std::less<>> set;  // the changed numbers: fields of Scene
  // All that is asked for but the scene, and nothing that is found. A sweep and orbits begin with the scene's
  // own release, which stands not here, then with those given.
  Response asked;
};
// The same for that scene, whole.
Response asked_for(const CatalogueResponse& response, const Scene& scene);

struct FigureCurve {
  std::string scene;  // but for damper_sets tables
  // damper_sets tables only: a run of several dampers and one of a single damper, of the catalogue's runs.
  std::string run, alone;
  // loss_factor and largest_response tables only:
  LossFactorOptions loss_factor;  // its window of averaging
  std::int64_t ensemble = 0;      // members of the ensemble whose spread is shown; 0 for none
};

struct Figure {
  std::string number;  // "1" ... "15", "A" ... "H"
  std::string title;
  TableKind table = TableKind::drawing;
  // One for motion, phase and largest_response, none for a drawing, response, response_map and design_charts.
  std::vector<FigureCurve> curves;
  std::vector<std::string> responses;           // of the catalogue, for the tables of responses
  std::string plan;                             // design_charts: of its sweep, a file beside the catalogue
  std::optional<LossOrdinate> ordinate;         // loss_factor tables, and only they
  std::optional<LossOrdinate> second_ordinate;  // of a second panel with the same curves, if there is one
  std::optional<Varied> varied;                 // if there is more than one curve
  std::optional<double> window;   // motion tables: the amplitude of one of the scene's history windows
  std::optional<double> down_to;  // amplitude that every curve must reach, or its run is short
  // Two amplitudes. loss_factor: over which the spread is shown, or empty; damper_sets: which are drawn.
  std::vector<double> range;
  std::string script;               // beside the catalogue; each once, without its ending too
  std::vector<std::string> claims;  // ids in data/claims.json
};

struct Catalogue {
  std::int64_t members = 1;  // of each scene's ensemble that are run, the scene itself among them; 1 to 100
  std::vector<CatalogueScene> scenes;
  std::vector<CatalogueRun> runs;
  std::vector<CatalogueResponse> responses;
  std::vector<Figure> figures;
};

// Reads a catalogue and holds it together: every scene known and recording what its
// figures draw, every number given once. Throws IoError or InputError.
inline constexpr FileKind catalogue_kind{"catalogue", 1 << 20};
Catalogue read_catalogue(const std::filesystem::path& file);
Catalogue parse_catalogue(const std::string& name, const std::string& text);

// The scene, run, response or figure of that name; a null pointer if there is none.
const CatalogueScene* find_scene(const Catalogue& catalogue, std::string_view name);
const CatalogueRun* find_run(const std::vector<CatalogueRun>& runs, std::string_view name);
const CatalogueResponse* find_response(const std::vector<CatalogueResponse>& responses,
                                       std::string_view name);
const Figure* find_figure(const Catalogue& catalogue, std::string_view number);

// The name of its table and pictures without their endings: its script's, "fig08" for fig08.gp.
std::string file_stem(const Figure& figure);

// The name of its sweep's files without their endings: its plan's.
std::string sweep_stem(const Figure& figure);

// The scenes of a figure, each once, in the order of its curves.
std::vector<std::string> scenes_of(const Figure& figure);
// The further runs of a figure, likewise.
std::vector<std::string> runs_of(const Figure& figure);

}  // namespace impact_damper
