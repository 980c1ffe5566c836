#include "impact_damper/paper/measures.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <stdexcept>

#include "impact_damper/files/run_file.hpp"

namespace impact_damper {

const Run& Runs::file(const std::string& scene) {
  auto found = ensembles_.find(scene);
  if (found == ensembles_.end()) {
    found = ensembles_.emplace(scene, std::vector<Run>{}).first;
    found->second.push_back(read_run(folder_ / (scene + ".json")));
  }
  return found->second.front();
}

const std::vector<Run>& Runs::ensemble(const std::string& scene) {
  const Run& first = file(scene);
  std::vector<Run>& runs = ensembles_.at(scene);
  if (runs.size() == 1 && options_.members > 1) {
    Record record;
    record.impacts = record.contacts = true;
    std::vector<Scene> members = ensemble_of(first.scene, options_);
    members.erase(members.begin());
    std::vector<Run> others = simulate_scenes(members, first.engine, record, options_.threads);
    runs.insert(runs.end(), std::move_iterator(others.begin()), std::move_iterator(others.end()));
  }
  return runs;
}

std::string Runs::engine() const {
  std::set<std::string> names;
  for (const auto& [scene, runs] : ensembles_) {
    if (runs.empty()) continue;
    const Cem* const cem = std::get_if<Cem>(&runs.front().engine);
    names.insert(std::string(name_of(runs.front().engine)) + (cem && cem->locate ? " --locate" : ""));
  }
  return names.size() == 1 ? *names.begin() : std::string();
}

const std::vector<Measure>& measures() {
  static const std::vector<Measure> table = [] {
    std::vector<Measure> all;
    for (auto part :
         {loss_measures(), regime_measures(), model_measures(), audit_measures(), stuck_measures()})
      all.insert(all.end(), part.begin(), part.end());
    std::sort(all.begin(), all.end(), [](const Measure& a, const Measure& b) { return a.name < b.name; });
    return all;
  }();
  return table;
}

Spread measure(Runs& runs, const MeasureCall& call) {
  for (const Measure& each : measures())
    if (each.name == call.name) return each.find(runs, call);
  throw std::invalid_argument("measure: unknown name " + call.name);
}

}  // namespace impact_damper
