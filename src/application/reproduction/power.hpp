// The discriminating power of the claims: the smallest change of one number, with all others unchanged, that
// turns at least one verdict, and the claims whose verdicts it turns.
//
// The numbers are those of each scene (simulation and analysis both use the changed number), those of the
// analysis (AnalysisOptions, EnsembleOptions), and the columns that runs record, each multiplied by a factor.
// A number becomes value (1 + change), value / (1 + change) or, where it is 0, the change itself. Response
// sweeps are made from their first start only.
//
// Medians of chaotic decays do not depend on a number monotonically. So changes of 0.001, 0.002, 0.005, 0.01
// ... are tried upwards until one turns a verdict. Bisection over changes of two digits then narrows the
// interval below it. The change found turns a verdict, and the next smaller one of two digits turns none, but
// a change below that interval may also turn one. Whole numbers are tried one by one.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "application/reproduction/claims.hpp"
#include "application/reproduction/measures.hpp"

namespace impact_damper {

// The trials of a number in one direction, in ascending order: each change and the value that it gives.
struct Trial {
  double change = 0, value = 0;
};
struct Trials {
  std::vector<Trial> all;
  std::vector<std::size_t> first;  // indices tried first, ascending; the last one ends the search
};

// The smallest change found and the claims whose verdicts it turns; absent if none does up to `searched_to`.
struct Turn {
  Trial trial;
  std::vector<std::string> claims;
};
struct Direction {
  Trial searched_to;
  std::optional<Turn> turn = std::nullopt;
};

// What the numbers are parts of: a scene, the options of ensembles and of the analysis, and a column that is
// multiplied by a factor.
struct PowerState {
  Scene scene{};
  EnsembleOptions ensemble{};
  AnalysisOptions analysis{};
  std::optional<WrongColumn> wrong{};
};

struct PowerNumber {
  using Set = std::function<void(PowerState&, double value)>;

  std::string of;    // a scene's name, "analysis" or "columns"
  std::string name;  // for example "mass_ratio"
  double value = 0;
  std::optional<Trials> up = {}, down = {};  // absent: there is no larger, or smaller, valid value
  std::string_view noticed_by;               // the test that notices a change which turns no verdict
  Set set;
};
struct PowerRow {
  PowerNumber number;
  std::optional<Direction> up = {}, down = {};
};

// The claims and what their verdicts rest on: runs by scene, further runs made from these, requests for
// steady motions and their results by name, the options of ensembles; and claims to be left out.
struct PowerInput {
  std::vector<Claim> claims;
  std::map<std::string, Run> runs;
  std::vector<CatalogueRun> further;
  std::vector<CatalogueResponse> asked;
  std::map<std::string, Response> responses;
  EnsembleOptions ensemble;  // its `threads` run the searches
  std::vector<std::string> left_out;
};

// Returns the claims that rest on scenes of the catalogue alone: numbers of other scenes are not changed.
std::vector<Claim> claims_on_scenes_of(const Catalogue& catalogue, std::vector<Claim> claims);

// Returns the ids, in the order of the claims, of those whose verdicts differ in any of `ensembles` ensembles
// with other seeds. Their verdicts turn by chance, so they do not show the effect of a changed number.
std::vector<std::string> unsettled_claims(const PowerInput& input, std::int64_t ensembles);

class Power {
 public:
  // Makes the ensembles and finds the verdicts without a change. Throws what measure() throws.
  explicit Power(PowerInput input);

  // Every number, in the order of the table.
  const std::vector<PowerNumber>& numbers() const { return numbers_; }
  // Returns the ids of the claims whose verdicts differ if the number has that value: all, or the first
  // found. A claim that can no longer be measured counts, too.
  std::vector<std::string> turned(const PowerNumber& number, double value, bool all = true) const;
  // Searches each number in both directions. The thread that ends a search calls `tell` with the number of
  // searches done and that of all.
  std::vector<PowerRow> table(const std::function<void(std::size_t, std::size_t)>& tell) const;

 private:
  Runs changed(const PowerNumber& number, double value) const;

  PowerInput input_;
  Threads threads_;
  Runs unchanged_;
  std::vector<Verdict> verdicts_;  // of the claims, with nothing changed
  std::vector<PowerNumber> numbers_;
};

// Returns the change found by the scan and bisection above; `turns(value)` says whether a verdict turns.
std::optional<Trial> smallest_turn(const Trials& trials, const std::function<bool(double)>& turns);

}  // namespace impact_damper
