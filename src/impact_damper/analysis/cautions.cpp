#include "impact_damper/analysis/cautions.hpp"

#include <algorithm>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

std::string begins_outside(const Scene& scene, const std::optional<Scales>& scales) {
  const double depth = std::max(-scene.y0, scene.y0 - 1), energy = scene.wall_stiffness * depth * depth / 2;
  const auto text = [](double value) { return rounded_text(value, 5); };
  const auto with_unit = [&](double value, double scale, std::string_view unit) {
    return scales ? text(value * scale) + ' ' + std::string(unit) : text(value);
  };
  const double length = scales ? scales->length : 1;
  return "the secondary mass begins " + with_unit(depth, length, "mm") +
         (scales ? "" : " times the clearance") + " outside its cavity, which reaches from 0 to " +
         with_unit(1, length, "mm") + " (" + (scales ? "secondary_displacement" : "y0") + " is " +
         with_unit(scene.y0, length, "mm") + "): a compliant wall there holds an energy of " +
         with_unit(energy, scales ? scales->energy() : 1, "J") + ", beside " +
         with_unit(scene.x0 * scene.x0 / 2, scales ? scales->energy() : 1, "J") + " in the primary spring";
}

}  // namespace

std::vector<std::string> cautions_of(const Scene& scene, const std::optional<Scales>& scales) {
  std::vector<std::string> cautions;
  const auto heavy = [&](const std::string& mass, double mass_ratio) {
    if (mass_ratio > 1)
      cautions.push_back(mass + " is " + rounded_text(mass_ratio, 4) + " times as heavy as the primary mass" +
                         (scales ? ": are both given in kilograms?" : ""));
  };
  for (std::size_t i = 0; i < scene.dampers.size(); ++i)
    heavy("the secondary mass of damper " + std::to_string(i + 1), scene.dampers[i].mass_ratio);
  if (!scene.dampers.empty()) return cautions;
  if (scene.y0 < 0 || scene.y0 > 1) cautions.push_back(begins_outside(scene, scales));
  heavy("the secondary mass", scene.mass_ratio);
  return cautions;
}

}  // namespace impact_damper
