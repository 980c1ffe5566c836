#include "impact_damper/engines/checked.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/engines/cem.hpp"

namespace impact_damper {
namespace {

Budget& budget_of(Engine& engine) {
  return std::visit([](auto& options) -> Budget& { return options.budget; }, engine);
}

// Fills in what depends on the scene.
void complete(Engine& engine, const Scene& scene, const Record& record) {
  Budget& budget = budget_of(engine);
  budget = budget_for(scene, budget);
  if (record.half_cycles)
    budget.max_half_cycles = std::min(budget.max_half_cycles, most_half_cycles(scene.dampers.size()));
  if (Cem* const cem = std::get_if<Cem>(&engine)) *cem = resolved(scene, *cem);
}

// Returns what is wrong with the record, and with an engine's budget where it is recorded.
std::vector<Problem> problems_of(const Record& record, const Scene& scene, const Budget& budget) {
  std::vector<Problem> problems;

  // Rejects budgets whose records would not fit into memory.
  const auto dampers = std::int64_t(std::max<std::size_t>(1, scene.dampers.size()));
  const auto bounded = [&](const std::string& field, std::int64_t rows, const std::string& what,
                           std::int64_t most = most_rows) {
    if (rows <= most) return;
    problems.push_back({field, "must be <= " + std::to_string(most) + " where " + what + " recorded, got " +
                                   std::to_string(rows)});
  };
  if (record.impacts || record.contacts || record.energy) {
    bounded("max_impacts", budget.max_impacts, "impacts, contacts or energy are");
  }
  if (record.half_cycles) bounded("max_half_cycles", budget.max_half_cycles, "half cycles are");
  std::int64_t samples = 0;
  const auto add = [&](const auto& windows) {
    for (const auto& window : windows) {
      samples = window.count > most_samples - samples ? most_samples + 1 : samples + window.count;
    }
  };
  add(record.history);
  add(record.history_below);
  if (samples > most_samples / dampers) {
    problems.push_back(
        {record.history.empty() ? "history_below" : "history",
         "must ask for at most " + std::to_string(most_samples / dampers) + " samples in all"});
  }

  if (!record.history.empty() && !record.history_below.empty()) {
    problems.push_back({"history", "either by times or by amplitudes, not both in one run"});
  }
  double last = 0;
  for (const HistoryWindow& window : record.history) {
    if (!(window.begin >= last && window.end > window.begin && window.end <= 1e12 && window.count >= 2)) {
      problems.push_back(
          {"history",
           "each window must begin at or after the end of the one before, end after it begins, "
           "and have at least 2 samples"});
      break;
    }
    last = window.end;
  }
  double above = std::numeric_limits<double>::infinity();
  for (const AmplitudeWindow& window : record.history_below) {
    if (!(window.amplitude > 0 && window.amplitude < above && window.length > 0 && window.count >= 2)) {
      problems.push_back(
          {"history_below", "amplitudes must be > 0 and descend, lengths be > 0, samples be at least 2"});
      break;
    }
    above = window.amplitude;
  }
  return problems;
}

}  // namespace

std::vector<Problem> incompatibilities_of(const Scene& scene, const Engine& engine) {
  std::vector<Problem> problems;
  const bool one = has_one_damper(scene);
  for (std::size_t i = 0; !one && has_rigid_walls(engine) && i < scene.dampers.size(); ++i) {
    const SceneDamper& damper = scene.dampers[i];
    if (within(0, damper.clearance).allows(damper.y0)) continue;
    problems.push_back({damper_field(i, "y0"), within(0, damper.clearance).describe("must be") +
                                                   ", its clearance, as walls are rigid, got " +
                                                   number_text(damper.y0)});
  }
  const Cem* const cem = std::get_if<Cem>(&engine);
  if (cem && cem->time_step) problems = problems_of(scene, *cem);
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    const SceneDamper& damper = scene.dampers[i];
    const auto reject = [&](const char* name, const std::string& allowed, const std::string& who) {
      std::string message = "must be " + allowed;
      message.append(" with the ").append(name_of(engine)).append(" engine: only the ").append(who);
      problems.push_back({one ? std::string(name) : damper_field(i, name), message});
    };
    if (damper.wall.law != WallForm::linear && !cem)
      reject("wall", "linear", "cem engine has walls with laws of their own");
    if (!damper.restitution_by_speed.empty() && !std::holds_alternative<Restitution>(engine))
      reject("restitution", "one number", "restitution engine has one that depends on the speed");
  }
  if (!scene.spring.is_linear() && !cem)
    problems.push_back({"spring", "must be linear with the " + std::string(name_of(engine)) +
                                      " engine: only the cem engine has springs with laws of their own"});
  if (one && has_rigid_walls(engine) && !within(0, 1).allows(scene.damper().y0)) {
    problems.push_back({"y0", within(0, 1).describe("must be") + " with the " + std::string(name_of(engine)) +
                                  " engine, whose walls are rigid, got " + number_text(scene.damper().y0)});
  }
  return problems;
}

void require_no_components(const Scene& scene) {
  if (has_components(scene))
    throw InvalidArguments(
        std::vector<Problem>{{"scene", "must have no friction, drag and weight for this function"}});
}

void require_ideal(const Scene& scene) {
  require_no_components(scene);
  if (has_laws(scene))
    throw InvalidArguments(std::vector<Problem>{
        {"scene", "must have no wall and spring with laws of their own for this function"}});
}

Checked checked(const Scene& scene, const Engine& engine, const Record& record) {
  std::vector<Problem> problems = problems_of(scene);
  const auto add_all = [&](const std::vector<Problem>& more) {
    problems.insert(problems.end(), more.begin(), more.end());
  };
  add_all(problems_of(engine));
  Checked valid(scene, engine);
  const Budget asked = budget_of(valid.engine_);
  if (problems.empty()) {
    complete(valid.engine_, scene, record);
    add_all(incompatibilities_of(scene, valid.engine_));
  }
  add_all(problems_of(record, scene, asked));
  require_none(problems);
  return valid;
}

}  // namespace impact_damper
