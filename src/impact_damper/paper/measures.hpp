// Our side of the claims: a table of names, each a function that finds one number, from runs and, where a
// claim compares what no run file holds, from simulations of its own.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/paper/claims.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// The runs that measures look at: a folder of run files, SCENE.json each. Every scene of it is read once,
// and run again as an ensemble, with the file's scene and engine, once somebody asks.
class Runs {
 public:
  explicit Runs(std::filesystem::path folder, EnsembleOptions options = {})
      : folder_(std::move(folder)), options_(options) {}

  // The run file; throws IoError or InputError.
  const Run& file(const std::string& scene);
  // The run file, then the other members, which record half cycles, impacts and contacts.
  const std::vector<Run>& ensemble(const std::string& scene);
  // The name of the engine of the runs read so far ("cem --locate" if it locates touch and release); empty if
  // none was or if they are of several.
  std::string engine() const;
  const EnsembleOptions& options() const { return options_; }

 private:
  std::filesystem::path folder_;
  EnsembleOptions options_;
  std::map<std::string, std::vector<Run>> ensembles_;  // of one member while only the file was asked for
};

// A measure finds its number in each member of an ensemble; one that no chaos enters finds it once.
// NaN where there is nothing to find: it agrees with no claim.
struct Measure {
  std::string_view name;
  std::size_t least_scenes, most_scenes;
  std::vector<std::string_view> numbers;  // its parameters, all to be given
  Spread (*find)(Runs& runs, const MeasureCall& call);
  std::string_view meaning;
};
const std::vector<Measure>& measures();  // in the order of names

// Throws what reading runs and simulating throw; std::invalid_argument if a run lacks a column.
Spread measure(Runs& runs, const MeasureCall& call);

// The parts of the table, by subject: measures_*.cpp.
std::vector<Measure> loss_measures();    // loss factor curves
std::vector<Measure> regime_measures();  // bounce-down, windows, impact failure, phases
std::vector<Measure> model_measures();   // engine against engine, wall and time step
std::vector<Measure> audit_measures();   // the paper's slips
std::vector<Measure> stuck_measures();   // the paper's stuck regime

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
