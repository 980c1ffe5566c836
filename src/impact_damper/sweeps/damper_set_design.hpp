// Several dampers for a range of amplitudes: clearances and masses with which the least loss factor in it is
// as large as can be (docs/mathematics.md, 17.7). Amplitudes, peaks |x|, and clearances are in any one unit,
// masses are divided by the primary mass.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "impact_damper/analysis/damper_sets.hpp"
#include "impact_damper/analysis/parallel.hpp"

namespace impact_damper {

struct DamperSetQuestion {
  double release = 0;  // initial displacement of the primary mass, 1e-6 to 1e6
  // The range of amplitudes: upper <= 0.9 release, as the first cycles set the masses going; upper / 1000 <=
  // to <= upper / 2.
  double upper = 0, to = 0;
  double mass_ratio = 0;     // of all secondary masses together, 1e-4 to 0.2
  std::int64_t count = 0;    // of dampers, 1 to most_set_dampers
  double restitution = 0.6;  // restitution - restitution_off >= 0.1, restitution + restitution_off <= 0.9
  double damping_ratio = 0;  // zeta of the primary mass, 0 to 0.1
  // How far dampers may be off, either way: each clearance by itself, the restitution of all alike.
  double clearance_off = 0.1;    // relative, 0 to 0.5
  double restitution_off = 0.1;  // absolute, 0 to 0.4
};
inline constexpr std::int64_t most_set_dampers = 40;
// Empty if it is valid. Fields: those of DamperSetQuestion.
std::vector<Problem> problems_of(const DamperSetQuestion& question);

// How often a set is released as it is designed, and how many sets that are off are released, once each.
inline constexpr std::int64_t set_releases = 8, set_draws = 32;
struct DamperSet {
  // From the widest clearance to the narrowest, at rest at their left walls. Clearances, and shares of the
  // mass, are rounded to three digits. Who gets no mass is left out, so there may be fewer than asked for.
  std::vector<SceneDamper> dampers;
  std::vector<double> edges;  // of the intervals below, descending from `upper` to `to`
  // eta, with that of the viscous damping, one entry for each interval. If the dampers add: as designed; and
  // each damper, in each interval by itself, with the clearance and the restitution in tolerance that lose
  // least.
  std::vector<double> expected, worst;
  LossSpread run;     // of the releases, by the restitution engine
  LossSpread varied;  // of the sets that are off at random, uniformly
  // If more than one was asked for: one damper of all the mass, designed in the same way; `least` is the
  // smallest entry of its run.mean.
  struct One {
    double clearance = 0, least = 0;
  };
  std::optional<One> one;
};
// `tell` is called by this thread with what begins. Throws InvalidArguments if the question is not valid. The
// same bits with any number of threads, and each time.
DamperSet best_damper_set(const DamperSetQuestion& question, const Threads& threads,
                          const std::function<void(const std::string& doing)>& tell);
// Parts of it. The scene that is run: lengths divided by the release, clearances among them.
Scene scene_of_set(const DamperSetQuestion& question, const std::vector<SceneDamper>& dampers);
// Shares x >= 0 whose sum is 1 that make the least of the sums over j of x_j columns[j][i] largest, and that
// least: (M17.14). Columns not empty, of equal length and of numbers >= 0.
struct Shares {
  std::vector<double> share;
  double least = 0;
};
Shares best_shares(const std::vector<std::vector<double>>& columns);

}  // namespace impact_damper
