// Ensembles: the same scene with perturbed initial conditions, many times.
//
// Between the regular windows of a decay the motion is chaotic: a change of the last bit of an initial value
// changes the third digit of later amplitudes. A number that depends on such a range is therefore the median
// over an ensemble, and the ensemble's extremes are its error bar.
#pragma once

#include <cstdint>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

struct EnsembleOptions {
  std::int64_t members = 16;       // >= 1, the unperturbed scene among them
  double step = 1e-9;              // relative change of one step
  std::int64_t most_steps = 1000;  // >= 1: a member is changed by up to so many steps, up or down
  std::uint64_t seed = 1;
  Threads threads;  // for simulating the members; no result depends on their number
};

// The scene itself, then members - 1 perturbed ones: x0, v0, each w0, the force's amplitude and, unless the
// scene has a list of dampers, the depth of y0 in a wall (0 inside the cavity) are all multiplied by 1 + n
// step, n a whole number != 0 with |n| <= most_steps, drawn from the seed for each member; the other sign of
// n is taken where a number would leave its allowed range. If all these are 0, the members are equal. Equal
// options give equal scenes on every machine. Throws std::invalid_argument if members or most_steps is
// below 1.
std::vector<Scene> ensemble_of(const Scene& scene, const EnsembleOptions& options = {});

// One run for each scene, in their order. If some fail, throws what simulate() throws for the first of these.
std::vector<Run> simulate_scenes(const std::vector<Scene>& scenes, const Engine& engine, const Record& record,
                                 const Threads& threads = {});

// One run for each member of ensemble_of(scene, options). Throws as the two functions above.
std::vector<Run> simulate_ensemble(const Scene& scene, const Engine& engine, const Record& record,
                                   const EnsembleOptions& options = {});

// The summary of a number over an ensemble: median (mean of the two middle values), smallest, largest.
struct Spread {
  double median = 0, low = 0, high = 0;
};
// `values` must not be empty: throws std::invalid_argument. One NaN among them makes all three NaN.
Spread spread_of(std::vector<double> values);

}  // namespace impact_damper
