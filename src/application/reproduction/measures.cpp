#include "application/reproduction/measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "application/reproduction/measures_parts.hpp"
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
Record measured() { return {.impacts = true, .contacts = true}; }

constexpr NumberRange above_up_to(double least, double most) { return {least, most, false}; }
constexpr NumberRange amplitudes = above_up_to(0, 1e12);

constexpr std::array<MeasureNumber, 19> measure_numbers{{
    {"amplitude", amplitudes, 0, "amplitude of a half cycle, in units of the clearance"},
    {"averaged_over", within(10, 18), 2, "half cycles that the loss factor is averaged over"},
    {"damping_ratio", above_up_to(0, 0.5), 0, "viscous damping ratio zeta of a decay with enough peaks"},
    {"eta", above_up_to(0, 1e3), 0, "averaged loss factor per radian"},
    {"factor", above_up_to(1, 1e3), 0, "by how much a value or a time step is divided"},
    {"from", amplitudes, 0, "least amplitude looked at, in units of the clearance; below \"to\""},
    {"half_cycles", within(1, 1000), 1, "half cycles looked at"},
    {"impacts", within(0, 1000), 1, "impacts in a half cycle"},
    {"last", within(1, 10000), 1, "how many of the last rows of a curve"},
    {"mass_ratio", above_up_to(0, 1e6), 0, "mass ratio nu of a scene of the measure's own"},
    {"most", within(1, 1000), 1, "impacts per half cycle in the highest regular window"},
    {"power", within(-10, 10), 0, "power of the amplitude that the impacts' speed is divided by"},
    {"restitution", within(0, 1), 0, "coefficient of restitution e"},
    {"steps_per_contact", within(1, 1000), 0, "time steps in a nominal contact"},
    {"stuck_speed", above_up_to(0, 1e6), 0, "relative speed of impact below which the masses join"},
    {"to", amplitudes, 0, "largest amplitude looked at, in units of the clearance"},
    {"until_time", above_up_to(0, 1e3), 0, "end of a scene of the measure's own, in units of 1/Omega_n"},
    {"within", within(0, 0.9), 0, "share by which a constant may be missed either way"},
    {"x0", above_up_to(0, 1e6), 0, "release of a scene of the measure's own, in units of the clearance"},
}};

std::vector<Run> simulated_members(const Run& first, const EnsembleOptions& options) {
  std::vector<Scene> members = ensemble_of(first.scene, options);
  members.erase(members.begin());
  return simulate_scenes(members, first.engine, measured(), options.threads);
}

// Applies a measure to what its runs are.
struct Finder {
  Asked asked;

  Spread operator()(FindInRun find) const {
    std::vector<double> values;
    for (const Run& run : asked.ensemble()) values.push_back(find(asked, run));
    return spread_of(values);
  }
  Spread operator()(FindInPair find) const {
    return in_groups([&](const RunGroup& pair) { return find(asked, *pair[0], *pair[1]); });
  }
  Spread operator()(FindInGroup find) const {
    return in_groups([&](const RunGroup& group) { return find(asked, group); });
  }
  Spread operator()(FindOnce find) const {
    const double value = find(asked);
    return {value, value, value};
  }
  Spread operator()(FindSpread find) const { return find(asked); }

 private:
  // Looks at the members of all ensembles side by side, as far as every ensemble has them.
  template <class Look>
  Spread in_groups(Look look) const {
    std::vector<double> values;
    for (std::size_t member = 0;; ++member) {
      RunGroup group;
      for (const std::string& scene : asked.call.scenes) {
        const std::vector<Run>& runs_of_scene = asked.runs.ensemble(scene);
        if (member < runs_of_scene.size()) group.push_back(&runs_of_scene[member]);
      }
      if (group.size() < asked.call.scenes.size()) return spread_of(values);
      values.push_back(look(group));
    }
  }
};

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

double Asked::number(const std::string& name) const {
  const auto found = call.numbers.find(name);
  if (found == call.numbers.end())
    throw std::invalid_argument("measure " + call.name + ": " + name + " is missing");
  return found->second;
}

const std::vector<Measure>& measures() {
  static const std::vector<Measure> table = [] {
    std::vector<Measure> all;
    for (auto part : {loss_measures(), regime_measures(), model_measures(), steady_measures(),
                      damper_measures(), component_measures()})
      all.insert(all.end(), part.begin(), part.end());
    std::ranges::sort(all, {}, &Measure::name);
    return all;
  }();
  return table;
}

Spread measure(Runs& runs, const MeasureCall& call) {
  const auto each = std::ranges::find(measures(), call.name, &Measure::name);
  if (each == measures().end()) throw std::invalid_argument("measure: unknown name " + call.name);
  for (const std::string& scene : call.scenes)
    if (!each->takes_dampers && !has_one_damper(runs.file(scene).scene))
      throw std::invalid_argument("measure " + call.name + ": is of one damper, run " + scene +
                                  " of a list of dampers");
  return std::visit(Finder{{runs, call}}, each->find);
}

bool MeasureNumber::allows(double value) const {
  return range.allows(value) && (multiple_of == 0 || std::fmod(value, multiple_of) == 0);
}

const MeasureNumber& measure_number(std::string_view name) {
  const auto* const found = std::ranges::find(measure_numbers, name, &MeasureNumber::name);
  if (found == measure_numbers.end())
    throw std::logic_error("no measure has a number called " + std::string(name));
  return *found;
}

}  // namespace impact_damper
