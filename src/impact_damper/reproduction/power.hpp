// The discriminating power of the claims: the smallest change of one number, all others as they are, that
// turns at least one verdict, and the claims that it turns.
//
// Changed are the numbers of each scene (in its file: simulation and analysis both get the changed number),
// those of the analysis (AnalysisOptions, EnsembleOptions), and the columns that runs record, each multiplied
// by a factor. A number becomes value (1 + change), value / (1 + change) or, where it is 0, the change
// itself. Sweeps under a force are made from their first start only.
//
// Medians of chaotic decays do not depend on a number monotonically. So changes of 1, 2, 5, 10 ...
// thousandths are tried upwards until a verdict turns; then bisection, over changes of two digits, narrows
// the interval before it. What is found turns a verdict, and the next smaller change of two digits turns
// none; that no change smaller than the first interval turns one is not proved. Whole numbers are tried one
// by one.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/reproduction/claims.hpp"
#include "impact_damper/reproduction/measures.hpp"

namespace impact_damper {

// What is tried in one direction: changes in ascending order, and what the number then is.
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

struct PowerNumber {
  std::string of;    // a scene's name, "analysis" or "columns"
  std::string name;  // "mass_ratio"
  double value = 0;
  std::optional<Trials> up = {}, down = {};  // absent: it has no larger or no smaller value
  std::string_view noticed_by;               // the test that notices a change which turns no verdict
};
struct PowerRow {
  PowerNumber number;
  std::optional<Direction> up = {}, down = {};
};

// The runs that verdicts rest on, by scene, the further ones made of these, the steady motions by name and
// how they are asked for, how an ensemble of each run is made, and claims to be left out.
struct PowerInput {
  std::vector<Claim> claims;
  std::map<std::string, Run> runs;
  std::vector<CatalogueRun> further;
  std::vector<CatalogueResponse> asked;
  std::map<std::string, Response> responses;
  EnsembleOptions ensemble;  // `threads` are those that search
  std::vector<std::string> left_out;
};

// Those of the claims that rest on the catalogue's scenes alone: of no other scene a number is changed.
std::vector<Claim> claims_on_scenes_of(const Catalogue& catalogue, std::vector<Claim> claims);

// The claims whose verdicts some of so many ensembles, of other seeds, turn: ids, in the order of the claims.
// Such a verdict turns by chance with any change, so that the claim notices none.
std::vector<std::string> unsettled_claims(const PowerInput& input, std::int64_t ensembles);

class Power {
 public:
  // Makes the ensembles and finds the verdicts as they are. Throws what measure() throws.
  explicit Power(PowerInput input);

  // Every number, in the order of the table.
  const std::vector<PowerNumber>& numbers() const { return numbers_; }
  // The claims whose verdicts differ from what they are if the number has that value: all, or the first
  // found. A claim that cannot be measured any more is one of them.
  std::vector<std::string> turned(const PowerNumber& number, double value, bool all = true) const;
  // `tell` is called, with how many of how many searches are done, by whichever thread has ended one.
  std::vector<PowerRow> table(const std::function<void(std::size_t, std::size_t)>& tell) const;

 private:
  Runs changed(const PowerNumber& number, double value) const;

  PowerInput input_;
  Threads threads_;
  Runs unchanged_;
  std::vector<Verdict> verdicts_;  // of the claims, with nothing changed
  std::vector<PowerNumber> numbers_;
};

// Scans, then bisects, as said above; `turns(value)` says whether a verdict turns.
std::optional<Trial> smallest_turn(const Trials& trials, const std::function<bool(double)>& turns);

}  // namespace impact_damper
