// Warnings about numbers of a scene that are valid but probably a mistake.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "impact_damper/scene.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// One sentence of plain text for each of these cautions that the scene gives rise to; empty if there is none:
//
//   a secondary mass that begins outside its cavity, y0 < 0 or y0 > 1, for one in a list y0 > its clearance:
//   with compliant walls it begins by pressing a wall together, which then holds the energy k q^2 / 2, q
//   being the distance from the cavity;
//
//   a mass ratio above 1: the secondary mass may have been given in grams.
//
// Lengths and energies are in mm and J if `scales` are given, else in units of epsilon and K epsilon^2. The
// scene must be valid (problems_of).
std::vector<std::string> cautions_of(const Scene& scene, const std::optional<Scales>& scales);

}  // namespace impact_damper
