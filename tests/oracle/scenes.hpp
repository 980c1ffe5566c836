// Scenes for the oracle, by their seed: random ones over the whole range, and round ones, where things
// coincide.
#pragma once

#include <cstdint>
#include <string>

#include "impact_damper/engine.hpp"
#include "impact_damper/scene.hpp"

namespace oracle {

// `rigid`: no start inside a wall.
impact_damper::Scene random_scene(std::uint64_t seed, bool rigid);
impact_damper::Scene round_scene(std::uint64_t seed, bool rigid);

// The same scene, or one near it, in which central differences of a hundred steps for each contact take some
// 1e5.
impact_damper::Scene within_steps(impact_damper::Scene scene);

// The options of the run command that give this scene.
std::string options_of(const impact_damper::Scene& scene);

}  // namespace oracle
