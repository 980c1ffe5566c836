// Several dampers for a range of amplitudes: clearances and masses with which the least loss factor in it is
// as large as can be (docs/mathematics.md, 17.7, (M17.14)). Lengths in any one unit, masses divided by the
// primary mass.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "impact_damper/analysis/damper_sets.hpp"
#include "impact_damper/analysis/parallel.hpp"

namespace impact_damper {

struct DamperSetQuestion {
  double release = 0;  // initial displacement of the primary mass, > 0
  // The range of amplitudes: upper <= 0.9 release, as the first cycles set the masses going; upper / 1000 <=
  // to <= upper / 2.
  double upper = 0, to = 0;
  double mass_ratio = 0;     // of all secondary masses together, 1e-4 to 0.2
  std::int64_t count = 0;    // of dampers, 1 to most_set_dampers
  double restitution = 0.6;  // 0.1 to 0.9, with restitution_off to either side too
  double damping_ratio = 0;
  // How far dampers may be off, either way: each clearance by itself, the restitution of all alike.
  double clearance_off = 0.1;    // relative, 0 to 0.5
  double restitution_off = 0.1;  // absolute
};
inline constexpr std::int64_t most_set_dampers = 40;
// Fields: those of DamperSetQuestion.
std::vector<Problem> problems_of(const DamperSetQuestion& question);

struct DamperSet {
  // From the widest clearance to the narrowest, at rest at their left walls; those that get no mass are left
  // out. Clearances and shares of the mass to three digits.
  std::vector<SceneDamper> dampers;
  std::vector<double> edges;            // of the bins, descending from `upper` to `to`
  std::vector<double> expected, worst;  // eta if they add; with each damper off to its worst
  LossSpread run;                       // of releases of the set itself, by the restitution engine
  LossSpread varied;                    // of sets that are off at random, uniformly
  double least_of_one = 0;  // of one damper of that mass, with the clearance best for it: expected
};
// How many of each are run.
inline constexpr std::int64_t set_releases = 8, set_draws = 32;

// Throws InvalidArguments if the question is not valid. The same with any number of threads.
DamperSet best_damper_set(const DamperSetQuestion& question, const Threads& threads,
                          const std::function<void(const std::string& doing)>& tell);
// Parts of it. The scene that is run, in units of the release.
Scene scene_of_set(const DamperSetQuestion& question, const std::vector<SceneDamper>& dampers);
// Shares x >= 0 whose sum is 1 that make the least of the sums over j of x_j columns[j][i] largest, and that
// least: (M17.14). Columns not empty, of equal length and of numbers >= 0.
struct Shares {
  std::vector<double> share;
  double least = 0;
};
Shares best_shares(const std::vector<std::vector<double>>& columns);

}  // namespace impact_damper
