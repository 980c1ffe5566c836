// Design of several dampers for a range of amplitudes: clearances and masses with which the least loss factor
// in the range is largest (docs/mathematics.md, 17.7). Amplitudes (peaks |x|) and clearances have any one
// unit, masses are in units of the primary mass.
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
  // The range of amplitudes: upper <= 0.9 release, as the first cycles set the masses in motion; upper / 1000
  // <= to <= upper / 2.
  double upper = 0, to = 0;
  double mass_ratio = 0;     // of all secondary masses together, 1e-4 to 0.2
  std::int64_t count = 0;    // of dampers, 1 to most_set_dampers
  double restitution = 0.6;  // restitution - restitution_off >= 0.1, restitution + restitution_off <= 0.9
  double damping_ratio = 0;  // zeta of the primary mass, 0 to 0.1
  // Tolerances, in either direction: of each clearance independently, of the restitution of all alike.
  double clearance_off = 0.1;    // relative, 0 to 0.5
  double restitution_off = 0.1;  // absolute, 0 to 0.4
  // What all cavities have (M18.2): mu g cos(alpha) and g sin(alpha), divided by Omega_n^2, in the unit of
  // the amplitudes, >= 0; static_friction is 0 or at least friction. Their drag, each cavity's, divided by M
  // Omega_n, 0 to 1e6 mass_ratio.
  double friction = 0, static_friction = 0, weight = 0, drag = 0;
};
// Returns the amplitude up to which friction and weight hold all secondary masses (M15.14), 0 without them.
// `to` must be larger.
double locking_amplitude_of(const DamperSetQuestion& question);
// Sets friction, weight and drag of a scene whose lengths are in units of `length`.
void set_components(Scene& scene, const DamperSetQuestion& question, double length);
inline constexpr std::int64_t most_set_dampers = 40;
// Empty if it is valid. Fields: those of DamperSetQuestion.
std::vector<Problem> problems_of(const DamperSetQuestion& question);

// Number of releases of a set as designed, and number of sets within the tolerances, each released once.
inline constexpr std::int64_t set_releases = 8, set_draws = 32;
struct DamperSet {
  // From the widest clearance to the narrowest, at rest at their left walls. Clearances, and shares of the
  // mass, are rounded to three digits. Dampers without mass are left out, so there may be fewer than
  // requested.
  std::vector<SceneDamper> dampers;
  std::vector<double> edges;  // of the intervals below, descending from `upper` to `to`
  // eta of each interval, viscous damping included, if the dampers add. expected: as designed. worst: each
  // damper has, in each interval by itself, the clearance and restitution within the tolerances that lose
  // least.
  std::vector<double> expected, worst;
  LossSpread run;     // of the releases, by the restitution engine
  LossSpread varied;  // of the sets drawn uniformly within the tolerances
  // If more than one was requested: one damper with all the mass, designed in the same way; `least` is the
  // smallest entry of its run.mean.
  struct One {
    double clearance = 0, least = 0;
  };
  std::optional<One> one;
};
// Designs a set and simulates it. This thread calls `tell` with the name of each stage that begins. Throws
// InvalidArguments if the question is not valid. The result has the same bits with any number of threads.
DamperSet best_damper_set(const DamperSetQuestion& question, const Threads& threads,
                          const std::function<void(const std::string& doing)>& tell);
// Returns the scene that is simulated: all lengths, clearances included, in units of the release.
Scene scene_of_set(const DamperSetQuestion& question, const std::vector<SceneDamper>& dampers);
// Solves (M17.14): shares x_j >= 0, of sum 1, for which the least over i of sum_j x_j columns[j][i] is
// largest, and that least sum. There must be columns, of equal length and of numbers >= 0.
struct Shares {
  std::vector<double> share;
  double least = 0;
};
Shares best_shares(const std::vector<std::vector<double>>& columns);

}  // namespace impact_damper
