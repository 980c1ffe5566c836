// Ensembles: the same scene with perturbed initial conditions, many times.
//
// Between amplitudes of about 3 and 0.4 the motion is chaotic: a last bit of the initial value decides the
// third digit of an amplitude. A number that such a range enters is therefore the median over an ensemble,
// and the ensemble's extremes are its error bar.
#pragma once

#include <cstdint>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

struct EnsembleOptions {
  std::int64_t members = 16;       // >= 1, the undisturbed scene among them
  double step = 1e-9;              // relative to what sets the scene moving
  std::int64_t most_steps = 1000;  // a member is shifted by a whole number of steps up to this, either way
  std::uint64_t seed = 1;
  Threads threads;  // that simulate the members; no result depends on it
};

// The scene itself, then members - 1 shifted ones: x0, v0, w0, the forcing's amplitude and how deep y0 is in
// a wall, all times 1 + step n, n drawn from the seed, never 0. Only where nothing sets the scene moving they
// are all equal. Equal options give equal scenes on every machine.
std::vector<Scene> ensemble_of(const Scene& scene, const EnsembleOptions& options = {});

// One run for each scene, in their order. Throws what simulate() throws for the first scene that fails.
std::vector<Run> simulate_scenes(const std::vector<Scene>& scenes, const Engine& engine, const Record& record,
                                 const Threads& threads = {});

// One run for each member of the ensemble.
std::vector<Run> simulate_ensemble(const Scene& scene, const Engine& engine, const Record& record,
                                   const EnsembleOptions& options = {});

// What an ensemble says about a number: median (mean of the two middle values), smallest, largest.
struct Spread {
  double median = 0, low = 0, high = 0;
};
// `values` must not be empty: throws std::invalid_argument. One NaN among them makes all three NaN.
Spread spread_of(std::vector<double> values);

}  // namespace impact_damper
