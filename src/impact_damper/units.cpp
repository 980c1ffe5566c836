#include "impact_damper/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"

namespace impact_damper {
namespace {

constexpr double small = 1e-15, large = 1e15;
constexpr double metres = 1e-3;  // per millimetre

// The field of the scene in units that `field` of the dimensionless scene was made from.
std::string maker_of(const SceneInUnits& scene, std::string_view field) {
  const std::size_t point = field.find('.') + 1;  // "dampers[2].clearance"
  std::string maker(field);                       // of "dampers" itself
  for (const UnitField& each : unit_fields)
    if (each.becomes == field.substr(point) && (maker == field || each.number.in(scene)))
      maker = std::string(field.substr(0, point)) + std::string(each.name);
  return maker;
}

bool is_needed(std::string_view name) {
  return name == "mass" || name == "stiffness" || name == "secondary_mass" || name == "clearance";
}

}  // namespace

constexpr std::array<UnitField, 16> unit_fields{{
    {"mass", &SceneInUnits::mass, small, true, large, "kg", "", false, "mass M of the primary system"},
    {"stiffness", &SceneInUnits::stiffness, small, true, large, "N/m", "", false,
     "stiffness K of its spring"},
    {"secondary_mass", &DamperInUnits::secondary_mass, small, true, large, "kg", "mass_ratio", false,
     "secondary mass"},
    {"clearance", &DamperInUnits::clearance, small, true, large, "mm", "clearance", false,
     "clearance of the secondary mass, epsilon"},
    {"restitution", &DamperInUnits::restitution, 0, true, 1, "", "restitution", true,
     "coefficient of restitution, e"},
    {"damping", &SceneInUnits::damping, 0, true, large, "N s/m", "damping_ratio", false,
     "viscous damping of the primary system"},
    {"damping_ratio", &SceneInUnits::damping_ratio, 0, true, 1e6, "", "damping_ratio", true,
     "the same by critical damping, zeta"},
    {"contact_stiffness", &DamperInUnits::contact_stiffness, small, true, large, "N/m", "wall_stiffness",
     false, "stiffness of the walls"},
    {"initial_displacement", &SceneInUnits::initial_displacement, -large, true, large, "mm", "x0", false,
     "initial displacement of the primary mass"},
    {"initial_velocity", &SceneInUnits::initial_velocity, -large, true, large, "mm/s", "v0", false,
     "initial velocity of the primary mass"},
    {"secondary_displacement", &DamperInUnits::secondary_displacement, -large, true, large, "mm", "y0", false,
     "initial distance of the secondary mass from the left wall"},
    {"secondary_velocity", &DamperInUnits::secondary_velocity, -large, true, large, "mm/s", "w0", false,
     "initial velocity of the secondary mass in the cavity"},
    {"exciting_force", &SceneInUnits::exciting_force, -large, true, large, "N", "force_amplitude", false,
     "amplitude of the exciting force"},
    {"exciting_frequency", &SceneInUnits::exciting_frequency, 0, false, large, "Hz", "force_frequency", false,
     "frequency of the exciting force"},
    {"until_seconds", &SceneInUnits::until_seconds, 0, false, large, "s", "until_time", false,
     "the run ends at this time"},
    {"until_millimetres", &SceneInUnits::until_millimetres, 0, false, large, "mm", "until_amplitude", false,
     "the run ends with the first half cycle of a lower amplitude"},
}};

double Scales::time() const { return std::sqrt(mass / stiffness); }
double Scales::frequency() const { return 1 / (2 * std::numbers::pi * time()); }
double Scales::velocity() const { return length / time(); }
double Scales::force() const { return stiffness * (length * metres); }
double Scales::energy() const { return force() * (length * metres); }
double Scales::damping() const { return 2 * std::sqrt(stiffness * mass); }

SiUnits si_units_of(const Scales& scales) {
  const double length = scales.length * metres;
  return {length, scales.time(), length / scales.time(), scales.mass, scales.force(), scales.energy()};
}

std::vector<Problem> problems_of(const SceneInUnits& scene) {
  std::vector<Problem> problems;
  const auto check = [&](const std::string& name, const UnitField& field,
                         const std::optional<double>& value) {
    const NumberRange range{field.least, field.most, field.least_is_allowed};
    if (!value && is_needed(field.name))
      problems.push_back({name, "missing, a value must be given in " + std::string(field.unit)});
    if (value && !range.allows(*value))
      problems.push_back({name, range.describe("must be") + ", got " + number_text(*value)});
  };
  const bool one = scene.dampers.size() == 1;
  for (const UnitField& field : unit_fields)
    if (one || field.number.own) check(std::string(field.name), field, field.number.in(scene));
  for (std::size_t i = 0; !one && i < scene.dampers.size() && i < most_dampers; ++i)
    for (const UnitField& field : unit_fields)
      if (field.number.of_damper)
        check(damper_field(i, field.name), field, scene.dampers[i].*field.number.of_damper);
  if (scene.dampers.empty()) problems.push_back({"dampers", "must be at least one, got 0"});
  if (scene.damping && scene.damping_ratio)
    problems.push_back({"damping", "either it or damping_ratio must be given, got both"});
  if (!scene.until_seconds && !scene.until_millimetres)
    problems.push_back({"until_seconds", "until_seconds, until_millimetres or both must be given"});
  if (!problems.empty()) return problems;

  for (const Problem& problem : problems_of(dimensionless(scene))) {
    const bool of_the_list = problem.field == "dampers";
    problems.push_back(
        {maker_of(scene, problem.field),
         (of_the_list ? "" : "made dimensionless, as " + problem.field + ", ") + problem.message});
  }
  return problems;
}

Scales scales_of(const SceneInUnits& scene) {
  return {*scene.mass, *scene.stiffness, *scene.damper().clearance};
}

Scene dimensionless(const SceneInUnits& scene) {
  const Scales scales = scales_of(scene);
  Scene made;
  made.dampers.clear();
  for (const DamperInUnits& damper : scene.dampers) {
    SceneDamper& its = made.dampers.emplace_back();
    its.mass_ratio = *damper.secondary_mass / scales.mass;
    its.restitution = damper.restitution.value_or(its.restitution);
    its.clearance = *damper.clearance / scales.length;
    if (damper.contact_stiffness) its.wall_stiffness = *damper.contact_stiffness / scales.stiffness;
    its.y0 = damper.secondary_displacement.value_or(0) / scales.length;
    its.w0 = damper.secondary_velocity.value_or(0) / scales.velocity();
  }
  if (scene.damping) made.damping_ratio = *scene.damping / scales.damping();
  if (scene.damping_ratio) made.damping_ratio = *scene.damping_ratio;
  made.x0 = scene.initial_displacement.value_or(0) / scales.length;
  made.v0 = scene.initial_velocity.value_or(0) / scales.velocity();
  made.force_amplitude = scene.exciting_force.value_or(0) / scales.force();
  if (scene.exciting_frequency) made.force_frequency = *scene.exciting_frequency / scales.frequency();
  if (scene.until_seconds) made.until_time = *scene.until_seconds / scales.time();
  if (scene.until_millimetres) made.until_amplitude = *scene.until_millimetres / scales.length;
  return made;
}

}  // namespace impact_damper
