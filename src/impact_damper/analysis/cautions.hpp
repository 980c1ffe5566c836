// What is valid in a scene, but more often a slip than meant.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "impact_damper/scene.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// Sentences in plain text, one for each of:
//
//   a secondary mass that begins outside its cavity, y0 < 0 or y0 > 1: with compliant walls it begins by
//   pressing a wall together, which then holds the energy k q^2 / 2, q being the distance from the cavity; a
//   mass ratio above 1: the mass may have been typed in grams.
//
// Lengths and energies are in mm and J if `scales` are given, else in units of epsilon and K epsilon^2.
std::vector<std::string> cautions_of(const Scene& scene, const std::optional<Scales>& scales);

}  // namespace impact_damper
