#include "impact_damper/analysis/ensemble.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

// Steele, Lea and Flood's splitmix64: the standard library's distributions differ between libraries.
std::uint64_t draw(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15U;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

// The scene with all that sets it moving multiplied by `factor`: a change of a small part alone may be lost
// in the rounding of others.
Scene scaled(Scene scene, double factor) {
  for (double Scene::*const part : {&Scene::x0, &Scene::v0, &Scene::force_amplitude}) scene.*part *= factor;
  for (SceneDamper& damper : scene.dampers) damper.w0 *= factor;
  if (!has_one_damper(scene)) return scene;
  double& y0 = scene.damper().y0;
  if (y0 < 0) y0 *= factor;
  if (y0 > 1) y0 = 1 + (y0 - 1) * factor;
  return scene;
}

}  // namespace

std::vector<Scene> ensemble_of(const Scene& scene, const EnsembleOptions& options) {
  if (options.members < 1) throw std::invalid_argument("members: must be >= 1");
  if (options.most_steps < 1) throw std::invalid_argument("most_steps: must be >= 1");
  std::vector<Scene> scenes{scene};
  std::uint64_t state = options.seed;
  while (static_cast<std::int64_t>(scenes.size()) < options.members) {
    const std::uint64_t drawn = draw(state);
    const double steps =
        1 + static_cast<double>((drawn >> 1) % static_cast<std::uint64_t>(options.most_steps));
    const double shift = options.step * (drawn & 1 ? steps : -steps);
    const Scene shifted = scaled(scene, 1 + shift);
    // Where a number would exceed the largest that a scene allows, the other sign is taken.
    const bool is_beyond = problems_of(shifted).size() > problems_of(scene).size();
    scenes.push_back(is_beyond ? scaled(scene, 1 - shift) : shifted);
  }
  return scenes;
}

std::vector<Run> simulate_scenes(const std::vector<Scene>& scenes, const Engine& engine, const Record& record,
                                 const Threads& threads) {
  std::vector<Run> runs(scenes.size());
  for_each_index(static_cast<std::int64_t>(scenes.size()), threads, [&](std::int64_t i) {
    const auto n = static_cast<std::size_t>(i);
    runs[n] = simulate(scenes[n], engine, record);
  });
  return runs;
}

std::vector<Run> simulate_ensemble(const Scene& scene, const Engine& engine, const Record& record,
                                   const EnsembleOptions& options) {
  return simulate_scenes(ensemble_of(scene, options), engine, record, options.threads);
}

Spread spread_of(std::vector<double> values) {
  if (values.empty()) throw std::invalid_argument("spread: of no values");
  for (const double value : values)
    if (std::isnan(value)) return {value, value, value};
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {(values[(n - 1) / 2] + values[n / 2]) / 2, values.front(), values.back()};
}

}  // namespace impact_damper
