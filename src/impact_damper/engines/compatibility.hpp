// Conflicts between a scene and an engine's options, each of which is allowed by itself.
#pragma once

#include <vector>

#include "impact_damper/engine.hpp"

namespace impact_damper {

// One entry per offending field, of the scene or of the engine, as problems_of(Scene). Both must be free of
// problems by themselves, and the engine complete: without a time step cem is not compared.
std::vector<Problem> incompatibilities_of(const Scene& scene, const Engine& engine);

}  // namespace impact_damper
