// The measures behind our side of the claims: a table of named functions, each of which finds one number,
// from runs or, where a claim is about a short experiment of its own, from simulations (Runs::simulated).
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/claims.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Options of the analysis, the same for all claims.
struct AnalysisOptions {
  LossFactorOptions loss;               // the averaged loss factor
  LossFactorOptions smoother_loss{18};  // the smoother one that measures of the smoothing compare it with
  // Bins of the amplitude, equal in its logarithm, in which curves are compared: wide enough to hold several
  // half cycles of every run, narrow enough to see the structure of the curve.
  int bins = 12;
  RegimeOptions regimes;
};

// A column of numbers that runs record.
struct RecordedColumn {
  std::string_view name;                  // its key in a run file, "half_cycles.amplitude"
  void (*multiply)(Run&, double factor);  // every entry; nothing where the run did not record it
};
const std::vector<RecordedColumn>& recorded_columns();

// A column that is multiplied by a factor in every run before a measure uses it; power.hpp finds which
// verdicts that turns.
struct WrongColumn {
  RecordedColumn column;
  double factor = 1;
};

// The runs that measures use, of scenes and the catalogue's further runs, each by its name. With a folder of
// run files, NAME.json each with the other members of its ensemble beside it (scene_runs.hpp), each is read
// once, when it is first needed. Without a folder, which power.hpp uses to try other scenes and other
// ensembles, the scenes' runs are those that were put; further runs of these and all ensembles are simulated.
class Runs {
 public:
  explicit Runs(std::optional<std::filesystem::path> folder, EnsembleOptions options = {},
                std::vector<CatalogueRun> further = {}, AnalysisOptions analysis = {},
                std::optional<WrongColumn> wrong = std::nullopt,
                std::vector<CatalogueResponse> responses = {})
      : folder_(std::move(folder)),
        options_(options),
        further_(std::move(further)),
        analysis_(analysis),
        wrong_(wrong),
        responses_(std::move(responses)) {}

  // Returns the run of that name. Throws IoError or InputError, std::invalid_argument without a folder if
  // none was put. The reference is valid until ensemble() of the same name or put() is called.
  const Run& file(const std::string& name);
  // Puts this run in place of the scene's file; further runs of the scene then start from its scene.
  void put(const std::string& scene, Run run);
  // Puts this response in place of the one of that name. Once another run is put for its scene, it is made
  // anew for that run's scene.
  void put(const std::string& name, Response response) { found_.insert_or_assign(name, std::move(response)); }
  // Returns the run of that name, then the other members of its ensemble. Throws what read_members() throws.
  // Valid until put() is called.
  const std::vector<Run>& ensemble(const std::string& name);
  // Returns the catalogue's response of that name: read, put, or made for the scene whose run was put. Throws
  // what file() throws.
  const Response& response(const std::string& name);
  // Returns the name of the engine of the scenes' runs read so far ("cem --locate" if it locates touch and
  // release); empty if none was or if they are of several.
  std::string engine() const;
  const AnalysisOptions& analysis() const { return analysis_; }

  // Simulates a run for a measure.
  Run simulated(const Scene& scene, const Engine& engine, const Record& record) const;

 private:
  Run as_recorded(Run run) const;

  std::optional<std::filesystem::path> folder_;
  EnsembleOptions options_;
  std::vector<CatalogueRun> further_;
  AnalysisOptions analysis_;
  std::optional<WrongColumn> wrong_;
  std::vector<CatalogueResponse> responses_;
  std::map<std::string, std::vector<Run>> ensembles_;  // of one member while only the file was asked for
  std::map<std::string, Response> found_;              // of responses_
};

// How many scenes, or responses, a claim may name for a measure.
struct Count {
  std::size_t least = 0, most = 0;
};

// A measure finds its number in each member of an ensemble, or once if chaos does not affect it. It is NaN
// where there is nothing to find, which agrees with no claim.
struct Measure {
  std::string_view name;
  Spread (*find)(Runs& runs, const MeasureCall& call);
  std::string_view meaning;
  std::vector<std::string_view> numbers = {};  // its parameters, all required
  Count scenes = {1, 1};
  Count responses = {};
  bool takes_dampers = false;  // takes runs with a list of dampers, too
};
const std::vector<Measure>& measures();  // in the order of names
inline Spread once(double value) { return {value, value, value}; }

// Returns the number of `call`. Throws what reading runs and simulating throw; std::invalid_argument if a run
// lacks a column.
Spread measure(Runs& runs, const MeasureCall& call);

// The parts of the table, by subject: measures_*.cpp.
std::vector<Measure> loss_measures();    // loss factor curves
std::vector<Measure> regime_measures();  // bounce-down, windows, impact failure, phases
std::vector<Measure> model_measures();   // engine against engine, wall and time step
std::vector<Measure> audit_measures();   // the paper's slips
std::vector<Measure> stuck_measures();   // the paper's stuck regime
std::vector<Measure> steady_measures();  // steady motions under a force
std::vector<Measure> damper_measures();  // several dampers

// For each member of the one scene of `call`, or for the members of all of them side by side.
template <class Find>
Spread over_members(Runs& runs, const MeasureCall& call, Find find) {
  std::vector<double> values;
  for (const Run& run : runs.ensemble(call.scenes.front())) values.push_back(find(run));
  return spread_of(values);
}
template <class Find>
Spread over_groups(Runs& runs, const MeasureCall& call, Find find) {
  std::vector<double> values;
  for (std::size_t member = 0;; ++member) {
    std::vector<const Run*> group;
    for (const std::string& scene : call.scenes) {
      const std::vector<Run>& runs_of_scene = runs.ensemble(scene);
      if (member < runs_of_scene.size()) group.push_back(&runs_of_scene[member]);
    }
    if (group.size() < call.scenes.size()) return spread_of(values);
    values.push_back(find(group));
  }
}

}  // namespace impact_damper
