// Scenes with several dampers, by their seed: random ones, and ones of round numbers, where events coincide.
#pragma once

#include <cstdint>
#include <string>

#include "impact_damper/scene.hpp"

namespace oracle {

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

// As it stands in a scene file.
std::string text_of(const impact_damper::Scene& scene);

}  // namespace oracle
