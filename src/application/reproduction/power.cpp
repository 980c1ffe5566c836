#include "application/reproduction/power.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <type_traits>
#include <utility>
#include <variant>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

// Tests by their names in CTest.
constexpr std::string_view from_reference = "reference: tables, figures and sums are what the program makes";

enum class Change { larger, smaller, added };

// Returns changes of two digits from 10^decade to `most`; scanned first are 1, 2, 5, 10 ... times the least.
Trials two_digit_trials(double value, Change change, int decade, double most) {
  Trials trials;
  for (;; ++decade) {
    for (int digits = 10; digits < 100; ++digits) {
      const double s = *parse_number(std::to_string(digits) + "e" + std::to_string(decade - 1));
      if (s > most) return trials;
      const bool is_first = digits == 10 || digits == 20 || digits == 50 || s == most;
      if (is_first) trials.first.push_back(trials.all.size());
      const double becomes = change == Change::larger    ? value * (1 + s)
                             : change == Change::smaller ? value / (1 + s)
                                                         : s;
      trials.all.push_back({s, becomes});
    }
  }
}

// The least change is 10^thousandths; the largest gives four times the value, or a quarter of it.
constexpr int thousandths = -3;
constexpr double to_four_times = 3;

Trials whole_number_trials(double value, double step, double last) {
  Trials trials;
  for (int i = 1;; ++i) {
    const double each = value + i * step;
    if (!(step > 0 ? each <= last : each >= last)) return trials;
    trials.first.push_back(trials.all.size());
    trials.all.push_back({std::abs(each - value) / value, each});
  }
}

// Returns them up to the last before one that is not valid; absent if there is none.
template <class IsValid>
std::optional<Trials> valid(Trials trials, IsValid is_valid) {
  const auto end = std::ranges::find_if(trials.all, [&](const Trial& each) { return !is_valid(each.value); });
  trials.all.erase(end, trials.all.end());
  if (trials.all.empty()) return std::nullopt;
  std::erase_if(trials.first, [&](std::size_t i) { return i >= trials.all.size(); });
  if (trials.first.empty() || trials.first.back() + 1 < trials.all.size())
    trials.first.push_back(trials.all.size() - 1);
  return trials;
}

// Returns the numbers of a scene; the two stops are numbers as well.
std::vector<PowerNumber> numbers_of(const std::string& of, const Scene& scene) {
  std::vector<PowerNumber> numbers;
  const auto add = [&](const std::string& name, double value, const PowerNumber::Set& set) {
    const auto is_valid = [&](double becomes) {
      PowerState changed{.scene = scene};
      set(changed, becomes);
      return problems_of(changed.scene).empty();
    };
    PowerNumber number{.of = of, .name = name, .value = value, .noticed_by = from_reference, .set = set};
    if (value == 0) {
      number.up = valid(two_digit_trials(0, Change::added, -5, 1), is_valid);
    } else {
      number.up = valid(two_digit_trials(value, Change::larger, thousandths, to_four_times), is_valid);
      number.down = valid(two_digit_trials(value, Change::smaller, thousandths, to_four_times), is_valid);
    }
    numbers.push_back(std::move(number));
  };
  for (const NamedSceneNumber& each : numbers_of(scene)) {
    if (each.name == "force_frequency" && scene.force_amplitude == 0) continue;  // without a force
    if (field_of(each.number).is_absent(each.number.in(scene))) continue;
    add(each.name, each.number.in(scene),
        [number = each.number](PowerState& state, double value) { number.in(state.scene) = value; });
  }
  if (scene.until_time)
    add("until_time", *scene.until_time,
        [](PowerState& state, double value) { state.scene.until_time = value; });
  if (scene.until_amplitude)
    add("until_amplitude", *scene.until_amplitude,
        [](PowerState& state, double value) { state.scene.until_amplitude = value; });
  return numbers;
}

using In = std::variant<int*, std::int64_t*, double*>;
struct AnalysisNumber {
  std::string_view name;
  In (*in)(PowerState&);
  double least, most,
      step;  // whole numbers in steps of this; 0: any number, by changes from 0.001 to 1000
  std::string_view noticed_by;
};
constexpr std::string_view falls_evenly =
    "measures_of_runs: measures of the loss factor are what they are for amplitudes that fall evenly";
constexpr std::array<AnalysisNumber, 9> analysis_numbers{
    {{"averaged_over", [](PowerState& s) -> In { return &s.analysis.loss.half_cycles; }, 10, 18, 2,
      falls_evenly},
     {"smoothed_over", [](PowerState& s) -> In { return &s.analysis.smoother_loss.half_cycles; }, 10, 18, 2,
      falls_evenly},
     {"bins", [](PowerState& s) -> In { return &s.analysis.bins; }, 1, 48, 1,
      "measures: the spread is averaged over twelve bins, equal in the logarithm"},
     {"stuck_contact_times", [](PowerState& s) -> In { return &s.analysis.regimes.stuck_contact_times; }, 0,
      0, 0, "regimes: a compliant contact is stuck once it outlasts a full period, a rigid one always"},
     {"bounce_down_half_cycles",
      [](PowerState& s) -> In { return &s.analysis.regimes.bounce_down_half_cycles; }, 1, 16, 1,
      "regimes: bounce-down ends with the first unbroken series of stuck half cycles"},
     {"window_half_cycles", [](PowerState& s) -> In { return &s.analysis.regimes.window_half_cycles; }, 1, 32,
      1, "regimes: regular windows are maximal series of equal counts"},
     {"failure_half_cycles", [](PowerState& s) -> In { return &s.analysis.regimes.failure_half_cycles; }, 1,
      12, 1, "regimes: impact failure is for good where no three half cycles bring three impacts any more"},
     {"members", [](PowerState& s) -> In { return &s.ensemble.members; }, 1, 64, 1, from_reference},
     {"ensemble_step", [](PowerState& s) -> In { return &s.ensemble.step; }, 0, 0, 0, from_reference}}};

// Returns the numbers of the analysis and of the columns; `state` has nothing changed.
std::vector<PowerNumber> numbers_of(PowerState state) {
  std::vector<PowerNumber> numbers;
  const auto any = [](double) { return true; };
  for (const AnalysisNumber& each : analysis_numbers) {
    const double value = std::visit([](const auto* number) { return double(*number); }, each.in(state));
    const bool whole = each.step != 0;
    numbers.push_back(
        {.of = "analysis",
         .name = std::string(each.name),
         .value = value,
         .up = valid(whole ? whole_number_trials(value, each.step, each.most)
                           : two_digit_trials(value, Change::larger, thousandths, 1000),
                     any),
         .down = valid(whole ? whole_number_trials(value, -each.step, each.least)
                             : two_digit_trials(value, Change::smaller, thousandths, 1000),
                       any),
         .noticed_by = each.noticed_by,
         .set = [in = each.in](PowerState& changed, double becomes) {
           std::visit([&](auto* number) { *number = static_cast<std::decay_t<decltype(*number)>>(becomes); },
                      in(changed));
         }});
  }
  for (const RecordedColumn& column : recorded_columns())
    numbers.push_back(
        {.of = "columns",
         .name = std::string(column.name),
         .value = 1,
         .up = two_digit_trials(1, Change::larger, thousandths, to_four_times),
         .down = two_digit_trials(1, Change::smaller, thousandths, to_four_times),
         .noticed_by = "recorded: all that the exact engine records is what a plain integration finds",
         .set = [column](PowerState& changed, double factor) {
           changed.wrong = {column, factor};
         }});
  return numbers;
}

Runs runs_with(const PowerInput& input, const PowerState& state) {
  Runs runs(std::nullopt, state.ensemble, input.further, state.analysis, state.wrong, input.asked);
  for (const auto& [scene, run] : input.runs) runs.put(scene, run);
  for (const auto& [name, response] : input.responses) runs.put(name, response);
  for (const auto& [scene, run] : input.runs) runs.ensemble(scene);
  return runs;
}

std::vector<Verdict> verdicts_of(const std::vector<Claim>& claims, Runs& runs) {
  std::vector<Verdict> verdicts;
  verdicts.reserve(claims.size());
  for (const Claim& claim : claims) verdicts.push_back(judge(claim, measure(runs, claim.measure).median));
  return verdicts;
}

bool looks_at(const Claim& claim, const PowerNumber& number, const PowerInput& input) {
  if (!input.runs.contains(number.of)) return true;
  return std::ranges::any_of(claim.measure.scenes,
                             [&](const std::string& name) {
                               const CatalogueRun* const run = find_run(input.further, name);
                               return (run ? run->scene : name) == number.of;
                             }) ||
         std::ranges::any_of(claim.measure.responses, [&](const std::string& name) {
           const CatalogueResponse* const asked = find_response(input.asked, name);
           return asked && asked->scene == number.of;
         });
}

// Leaves each sweep its first start: others would be repeated for each change and take most of the time.
void keep_first_starts(PowerInput& input) {
  for (CatalogueResponse& each : input.asked)
    if (auto* const sweeps = std::get_if<SweepResponse>(&each.asked)) sweeps->sweeps.resize(1);
  for (auto& [name, response] : input.responses)
    if (auto* const sweeps = std::get_if<SweepResponse>(&response)) sweeps->sweeps.resize(1);
}

}  // namespace

std::optional<Trial> smallest_turn(const Trials& trials, const std::function<bool(double)>& turns) {
  std::size_t low = 0;  // the trials before it count as turning no verdict
  for (const std::size_t next : trials.first) {
    if (!turns(trials.all[next].value)) {
      low = next + 1;
      continue;
    }
    std::size_t high = next;
    while (low < high) {
      const std::size_t middle = low + (high - low) / 2;
      if (turns(trials.all[middle].value))
        high = middle;
      else
        low = middle + 1;
    }
    return trials.all[high];
  }
  return std::nullopt;
}

std::vector<Claim> claims_on_scenes_of(const Catalogue& catalogue, std::vector<Claim> claims) {
  std::erase_if(claims, [&](const Claim& claim) {
    return std::ranges::any_of(claim.measure.scenes, [&](const std::string& name) {
      const CatalogueRun* const run = find_run(catalogue.runs, name);
      return run && !find_scene(catalogue, run->scene);
    });
  });
  return claims;
}

std::vector<std::string> unsettled_claims(const PowerInput& input, std::int64_t ensembles) {
  std::vector<std::vector<Verdict>> verdicts(static_cast<std::size_t>(ensembles) + 1);
  for_each_index(ensembles + 1, input.ensemble.threads, [&](std::int64_t i) {
    PowerState state{.ensemble = input.ensemble};
    state.ensemble.threads = 1;
    state.ensemble.seed += static_cast<std::uint64_t>(i);
    Runs runs = runs_with(input, state);
    verdicts[static_cast<std::size_t>(i)] = verdicts_of(input.claims, runs);
  });
  std::vector<std::string> ids;
  for (std::size_t claim = 0; claim < input.claims.size(); ++claim)
    if (std::ranges::any_of(verdicts, [&](const auto& each) { return each[claim] != verdicts[0][claim]; }))
      ids.push_back(input.claims[claim].id);
  return ids;
}

Power::Power(PowerInput input)
    : input_(std::move(input)), threads_(input_.ensemble.threads), unchanged_(std::nullopt) {
  // The threads are for the searches; each ensemble uses one.
  input_.ensemble.threads = 1;
  keep_first_starts(input_);
  const PowerState state{.ensemble = input_.ensemble};
  unchanged_ = runs_with(input_, state);
  std::erase_if(input_.claims, [&](const Claim& claim) {
    return std::ranges::find(input_.left_out, claim.id) != input_.left_out.end();
  });
  verdicts_ = verdicts_of(input_.claims, unchanged_);
  for (const auto& [name, run] : input_.runs)
    for (PowerNumber& number : numbers_of(name, run.scene)) numbers_.push_back(std::move(number));
  for (PowerNumber& number : numbers_of(state)) numbers_.push_back(std::move(number));
}

Runs Power::changed(const PowerNumber& number, double value) const {
  PowerState state{.ensemble = input_.ensemble};
  const auto of_scene = input_.runs.find(number.of);
  if (of_scene != input_.runs.end()) state.scene = of_scene->second.scene;
  number.set(state, value);
  if (of_scene == input_.runs.end()) return runs_with(input_, state);
  Runs runs = unchanged_;
  runs.put(number.of, simulate(state.scene, of_scene->second.engine, {.impacts = true, .contacts = true}));
  return runs;
}

std::vector<std::string> Power::turned(const PowerNumber& number, double value, bool all) const {
  std::vector<std::string> claims;
  std::optional<Runs> runs;
  for (std::size_t i = 0; i < input_.claims.size(); ++i) {
    const Claim& claim = input_.claims[i];
    if (!looks_at(claim, number, input_)) continue;
    try {
      if (!runs) runs = changed(number, value);
      if (judge(claim, measure(*runs, claim.measure).median) == verdicts_[i]) continue;
    } catch (const std::exception&) {
      // `verify` ends with an error there, which counts as a turned verdict.
    }
    claims.push_back(claim.id);
    if (!all) break;
  }
  return claims;
}

std::vector<PowerRow> Power::table(const std::function<void(std::size_t, std::size_t)>& tell) const {
  std::vector<PowerRow> rows;
  rows.reserve(numbers_.size());
  for (const PowerNumber& number : numbers_) rows.push_back({.number = number});
  struct Search {
    const PowerNumber* number;
    const Trials* trials;
    std::optional<Direction>* found;
  };
  std::vector<Search> searches;
  for (PowerRow& row : rows) {
    if (row.number.up) searches.push_back({&row.number, &*row.number.up, &row.up});
    if (row.number.down) searches.push_back({&row.number, &*row.number.down, &row.down});
  }
  std::atomic<std::size_t> done{0};
  for_each_index(std::int64_t(searches.size()), threads_, [&](std::int64_t i) {
    const Search& search = searches[std::size_t(i)];
    *search.found = Direction{.searched_to = search.trials->all.back()};
    const auto turns = [&](double value) { return !turned(*search.number, value, false).empty(); };
    if (const auto trial = smallest_turn(*search.trials, turns))
      (*search.found)->turn = Turn{*trial, turned(*search.number, trial->value)};
    tell(++done, searches.size());
  });
  return rows;
}

}  // namespace impact_damper
