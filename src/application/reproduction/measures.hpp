// The measures behind our side of the claims: a table of named functions, each of which finds one number,
// from runs or, where a claim is about a short experiment of its own, from simulations (Runs::simulated).
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/claims.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/base/text.hpp"
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

// A call of a measure, and the runs that it may use.
struct Asked {
  Runs& runs;
  const MeasureCall& call;

  // Returns a number of the call. Throws std::invalid_argument if it is missing.
  double number(const std::string& name) const;
  bool is_between(double amplitude) const { return amplitude >= number("from") && amplitude <= number("to"); }
  const AnalysisOptions& analysis() const { return runs.analysis(); }
  // Return the run, and the ensemble, of the first scene.
  const Run& file() const { return runs.file(call.scenes.front()); }
  const std::vector<Run>& ensemble() const { return runs.ensemble(call.scenes.front()); }
};

// How a measure finds its number: in each member of the ensemble of its scene, in each pair of members of two
// scenes, in each group of members, one of each scene, or once, where chaos does not affect it; or it finds a
// spread of its own. The number is NaN where there is nothing to find, which agrees with no claim.
using FindInRun = double (*)(const Asked&, const Run&);
using FindInPair = double (*)(const Asked&, const Run&, const Run&);
using RunGroup = std::vector<const Run*>;
using FindInGroup = double (*)(const Asked&, const RunGroup&);
using FindOnce = double (*)(const Asked&);
using FindSpread = Spread (*)(const Asked&);
using Find = std::variant<FindInRun, FindInPair, FindInGroup, FindOnce, FindSpread>;

struct Measure {
  std::string_view name, meaning;
  Find find;
  std::vector<std::string_view> numbers = {};  // its parameters, all required
  Count scenes = usual_scenes(find);
  Count responses = {};
  bool takes_dampers = false;  // takes runs with a list of dampers, too

  // Returns one or two, by what it looks at; none for what is found once.
  static constexpr Count usual_scenes(const Find& find) {
    if (std::holds_alternative<FindOnce>(find)) return {0, 0};
    return std::holds_alternative<FindInPair>(find) ? Count{2, 2} : Count{1, 1};
  }
};
const std::vector<Measure>& measures();  // in the order of names

// Returns the number of `call`. Throws what reading runs and simulating throw; std::invalid_argument if a run
// lacks a column.
Spread measure(Runs& runs, const MeasureCall& call);

// A number that measures take: one name means the same in every measure.
struct MeasureNumber {
  std::string_view name;
  NumberRange range;
  int multiple_of;  // 1: a whole number, 3 and 3.0 alike; 2: an even one; 0: any
  std::string_view meaning;

  bool allows(double value) const;
};
// Throws std::logic_error if no number is called that.
const MeasureNumber& measure_number(std::string_view name);

}  // namespace impact_damper
