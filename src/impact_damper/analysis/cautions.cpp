#include "impact_damper/analysis/cautions.hpp"

#include <algorithm>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

// unit_of_depth: in a scene without units.
std::string begins_outside(const std::string& mass, double y0, double clearance, double wall_stiffness,
                           double x0, const std::optional<Scales>& scales, std::string_view unit_of_depth) {
  const double depth = std::max(-y0, y0 - clearance), energy = wall_stiffness * depth * depth / 2;
  const auto text_of = [&](double value, Dimension dimension) {
    return with_unit(rounded_text(value * scale_of(dimension, scales), 5),
                     scales ? unit_of(dimension, true) : "");
  };
  return mass + " begins " + text_of(depth, Dimension::length) + (scales ? "" : std::string(unit_of_depth)) +
         " outside its cavity, which reaches from 0 to " + text_of(clearance, Dimension::length) + " (" +
         (scales ? "secondary_displacement" : "y0") + " is " + text_of(y0, Dimension::length) +
         "): a compliant wall there holds an energy of " + text_of(energy, Dimension::energy) + ", beside " +
         text_of(x0 * x0 / 2, Dimension::energy) + " in the primary spring";
}

}  // namespace

std::vector<std::string> cautions_of(const Scene& scene, const std::optional<Scales>& scales) {
  std::vector<std::string> cautions;
  const auto heavy = [&](const std::string& mass, double mass_ratio) {
    if (mass_ratio > 1)
      cautions.push_back(mass + " is " + rounded_text(mass_ratio, 4) + " times as heavy as the primary mass" +
                         (scales ? ": are both given in kilograms?" : ""));
  };
  const auto outside = [&](const std::string& mass, double y0, double clearance, double wall_stiffness,
                           std::string_view unit_of_depth) {
    if (y0 < 0 || y0 > clearance)
      cautions.push_back(
          begins_outside(mass, y0, clearance, wall_stiffness, scene.x0, scales, unit_of_depth));
  };
  const bool one = has_one_damper(scene);
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    const SceneDamper& damper = scene.dampers[i];
    const std::string mass = "the secondary mass" + (one ? "" : " of damper " + std::to_string(i + 1));
    outside(mass, damper.y0, damper.clearance, damper.wall_stiffness, one ? " times the clearance" : "");
    heavy(mass, damper.mass_ratio);
  }
  return cautions;
}

}  // namespace impact_damper
