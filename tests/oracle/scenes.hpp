// Scenes for the oracle, by their seed: random ones over the whole range, and round ones, where things
// coincide.
#pragma once

#include <cstdint>
#include <string>

#include "impact_damper/scene.hpp"

namespace oracle {

// Of one damper. `rigid`: no start inside a wall.
impact_damper::Scene random_scene(std::uint64_t seed, bool rigid);
impact_damper::Scene round_scene(std::uint64_t seed, bool rigid);

// The same scene, or one near it, in which central differences of a hundred steps for each contact take some
// 1e5.
impact_damper::Scene within_steps(impact_damper::Scene scene);

// Of up to six dampers.
impact_damper::Scene random_list(std::uint64_t seed);
impact_damper::Scene round_list(std::uint64_t seed);
// Between compliant walls. Of the random ones some have small clearances, so that many are in contact at
// once, and some little motion, so that masses are pressed to their walls for long.
impact_damper::Scene random_compliant_list(std::uint64_t seed);
impact_damper::Scene round_compliant_list(std::uint64_t seed);

// Where the engines have been wrong: chattering beside masses that stick, walls of very different frequencies
// pressed at once, slow bounces beside a pressed wall, no impact for long, and x'' = 0 at the release.
impact_damper::Scene aimed_list(std::uint64_t seed);
impact_damper::Scene aimed_compliant_list(std::uint64_t seed);

// The scene, of up to four dampers, with friction phi and phi_s, drag and weight, each absent in two of five.
impact_damper::Scene with_components(impact_damper::Scene scene, std::uint64_t seed, bool round);

// The options of the run command that give this scene.
std::string options_of(const impact_damper::Scene& scene);

}  // namespace oracle
