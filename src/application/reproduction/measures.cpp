#include "application/reproduction/measures.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "application/reproduction/scene_runs.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

void multiply_entry(double& entry, double factor) { entry *= factor; }
void multiply_entry(std::optional<double>& entry, double factor) {
  if (entry) *entry *= factor;
}

// Multiplies one column of one section.
template <auto section, auto column>
void multiply(Run& run, double factor) {
  if (!(run.*section)) return;
  for (auto& entry : (*(run.*section)).*column) multiply_entry(entry, factor);
}

// Returns a record of all that measures use.
Record measured() {
  Record record;
  record.impacts = record.contacts = true;
  return record;
}

std::vector<Run> simulated_members(const Run& first, const EnsembleOptions& options) {
  std::vector<Scene> members = ensemble_of(first.scene, options);
  members.erase(members.begin());
  return simulate_scenes(members, first.engine, measured(), options.threads);
}

}  // namespace

const Run& Runs::file(const std::string& name) {
  const auto found = ensembles_.find(name);
  if (found != ensembles_.end()) return found->second.front();
  Run run;
  if (folder_) {
    run = read_run(*folder_ / (name + ".json"));
  } else {
    const CatalogueRun* const further = find_run(further_, name);
    if (!further) throw std::invalid_argument("there is no run of scene " + name);
    const Run& of_scene = file(further->scene);
    run = simulate(changed_scene(*further, of_scene.scene), further->engine.value_or(of_scene.engine),
                   measured());
  }
  return ensembles_[name].emplace_back(as_recorded(std::move(run)));
}

const std::vector<Run>& Runs::ensemble(const std::string& name) {
  const Run& first = file(name);
  std::vector<Run>& runs = ensembles_.at(name);
  if (runs.size() == 1 && options_.members > 1) {
    std::vector<Run> others = folder_ ? read_members(first, *folder_ / (name + ".json"), options_)
                                      : simulated_members(first, options_);
    runs.reserve(others.size() + 1);
    for (Run& other : others) runs.push_back(as_recorded(std::move(other)));
  }
  return runs;
}

const Response& Runs::response(const std::string& name) {
  const auto found = found_.find(name);
  if (found != found_.end()) return found->second;
  if (folder_) return found_.emplace(name, read_response(*folder_ / (name + ".json"))).first->second;
  const CatalogueResponse* const wanted = find_response(responses_, name);
  if (!wanted) throw std::invalid_argument("there is no response " + name);
  return found_.emplace(name, found_for(asked_for(*wanted, file(wanted->scene).scene), options_.threads))
      .first->second;
}

void Runs::put(const std::string& scene, Run run) {
  for (const CatalogueResponse& response : responses_)
    if (response.scene == scene) found_.erase(response.name);
  for (const CatalogueRun& further : further_)
    if (further.scene == scene) ensembles_.erase(further.name);
  std::vector<Run>& runs = ensembles_[scene];
  runs.clear();
  runs.push_back(as_recorded(std::move(run)));
}

Run Runs::simulated(const Scene& scene, const Engine& engine, const Record& record) const {
  return as_recorded(simulate(scene, engine, record));
}

Run Runs::as_recorded(Run run) const {
  if (wrong_) wrong_->column.multiply(run, wrong_->factor);
  return run;
}

std::string Runs::engine() const {
  std::set<std::string> names;
  for (const auto& [name, runs] : ensembles_) {
    if (find_run(further_, name)) continue;
    const Cem* const cem = std::get_if<Cem>(&runs.front().engine);
    names.insert(std::string(name_of(runs.front().engine)) + (cem && cem->locate ? " --locate" : ""));
  }
  return names.size() == 1 ? *names.begin() : std::string();
}

const std::vector<RecordedColumn>& recorded_columns() {
  static const std::vector<RecordedColumn> table{
      {"half_cycles.zero_crossing", multiply<&Run::half_cycles, &HalfCycles::zero_crossing>},
      {"half_cycles.peak_time", multiply<&Run::half_cycles, &HalfCycles::peak_time>},
      {"half_cycles.amplitude", multiply<&Run::half_cycles, &HalfCycles::amplitude>},
      {"impacts.time", multiply<&Run::impacts, &Impacts::time>},
      {"impacts.relative_velocity", multiply<&Run::impacts, &Impacts::relative_velocity>},
      {"impacts.phase_deg", multiply<&Run::impacts, &Impacts::phase_deg>},
      {"impacts.amplitude", multiply<&Run::impacts, &Impacts::amplitude>},
      {"impacts.displacement", multiply<&Run::impacts, &Impacts::displacement>},
      {"contacts.begin", multiply<&Run::contacts, &Contacts::begin>},
      {"contacts.end", multiply<&Run::contacts, &Contacts::end>},
  };
  return table;
}

const std::vector<Measure>& measures() {
  static const std::vector<Measure> table = [] {
    std::vector<Measure> all;
    for (auto part : {loss_measures(), regime_measures(), model_measures(), audit_measures(),
                      stuck_measures(), steady_measures(), damper_measures()})
      all.insert(all.end(), part.begin(), part.end());
    std::sort(all.begin(), all.end(), [](const Measure& a, const Measure& b) { return a.name < b.name; });
    return all;
  }();
  return table;
}

Spread measure(Runs& runs, const MeasureCall& call) {
  for (const Measure& each : measures()) {
    if (each.name != call.name) continue;
    for (const std::string& scene : call.scenes)
      if (!each.takes_dampers && !has_one_damper(runs.file(scene).scene))
        throw std::invalid_argument("measure " + call.name + ": is of one damper, run " + scene +
                                    " of a list of dampers");
    return each.find(runs, call);
  }
  throw std::invalid_argument("measure: unknown name " + call.name);
}

}  // namespace impact_damper
