#include "impact_damper/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

// What sizes are made of: M, K, 1/Omega_n, and epsilon in m and in the unit of lengths.
struct Basis {
  double mass, stiffness, time, metres, length;
};
struct UnitRow {
  Dimension dimension;
  std::string_view dimensionless, in_units, suffix;  // names of the unit, the last one in SI
  double (*size)(const Basis&);
};
using enum Dimension;
constexpr std::array<UnitRow, 15> unit_table{{
    {ratio, "", "", "", [](const Basis&) { return 1.0; }},
    {count, "", "", "", [](const Basis&) { return 1.0; }},
    {length, "epsilon", "mm", "_m", [](const Basis& b) { return b.length; }},
    {time, "1/Omega_n", "s", "_s", [](const Basis& b) { return b.time; }},
    {velocity, "epsilon Omega_n", "mm/s", "_m_per_s", [](const Basis& b) { return b.length / b.time; }},
    {mass, "M", "kg", "_kg", [](const Basis& b) { return b.mass; }},
    {force, "K epsilon", "N", "_N", [](const Basis& b) { return b.stiffness * b.metres; }},
    {energy, "K epsilon^2", "J", "_J", [](const Basis& b) { return b.stiffness * b.metres * b.metres; }},
    {power, "K epsilon^2 Omega_n", "W", "_W",
     [](const Basis& b) { return b.stiffness * b.metres * b.metres / b.time; }},
    {frequency, "Omega_n", "Hz", "_Hz", [](const Basis& b) { return 1 / (2 * std::numbers::pi * b.time); }},
    {rate, "Omega_n", "1/s", "_per_s", [](const Basis& b) { return 1 / b.time; }},
    {stiffness, "K", "N/m", "_N_per_m", [](const Basis& b) { return b.stiffness; }},
    {damping, "2 sqrt(K M)", "N s/m", "_N_s_per_m",
     [](const Basis& b) { return 2 * std::sqrt(b.stiffness * b.mass); }},
    {acceleration, "epsilon Omega_n^2", "m/s^2", "_m_per_s2",
     [](const Basis& b) { return b.metres / (b.time * b.time); }},
    {inclination, "deg", "deg", "_deg", [](const Basis&) { return 1.0; }},
}};
const UnitRow& row_of(Dimension dimension) {
  return *std::ranges::find(unit_table, dimension, &UnitRow::dimension);
}

// A unit that a number may be written with: so many times, divided by so much, unit_of(dimension, true).
struct WrittenUnit {
  std::string_view name;  // without blanks
  Dimension dimension;
  double times = 1, divided_by = 1;
};
constexpr auto written_unit_table = std::to_array<WrittenUnit>({
    {"mm", length},
    {"um", length, 1, 1000},
    {"cm", length, 10},
    {"m", length, 1000},
    {"in", length, 25.4},
    {"s", time},
    {"ms", time, 1, 1000},
    {"min", time, 60},
    {"mm/s", velocity},
    {"cm/s", velocity, 10},
    {"m/s", velocity, 1000},
    {"kg", mass},
    {"g", mass, 1, 1000},
    {"t", mass, 1000},
    {"N", force},
    {"kN", force, 1000},
    {"Hz", frequency},
    {"N/m", stiffness},
    {"N/mm", stiffness, 1000},
    {"kN/m", stiffness, 1000},
    {"Ns/m", damping},
    {"Ns/mm", damping, 1000},
    {"m/s^2", acceleration},
    {"mm/s^2", acceleration, 1, 1000},
    {"deg", inclination},
});

constexpr double metres_per_millimetre = 1e-3;
Basis basis_of(const Scales& scales, double length_unit) {
  return {scales.mass, scales.stiffness, std::sqrt(scales.mass / scales.stiffness),
          scales.length * metres_per_millimetre, scales.length * length_unit};
}

// The field of the scene in units that `field` of the dimensionless scene was made from.
std::string maker_of(const SceneInUnits& scene, std::string_view field) {
  const std::size_t point = field.find('.') + 1;  // "dampers[2].clearance"
  std::string maker(field);                       // of "dampers" itself
  for (const UnitField& each : unit_fields)
    if (each.becomes == field.substr(point) && (maker == field || each.number.in(scene)))
      maker = std::string(field.substr(0, point)) + std::string(each.name);
  return maker;
}

constexpr NumberRange some{1e-15, 1e15}, any{-1e15, 1e15}, not_negative{0, 1e15}, positive{0, 1e15, false};

// The number of a dimensionless scene with this name.
SceneNumber number_named(std::string_view name) {
  const auto* its = std::ranges::find(scene_damper_fields, name, &SceneField::name);
  if (its == scene_damper_fields.end()) its = std::ranges::find(scene_fields, name, &SceneField::name);
  return its->number;
}

// Sets the components (M18.2). Gravity acts along the cavities with the sine of their inclination, and across
// them with its cosine.
void set_components(Scene& made, const SceneInUnits& scene, const Scales& scales) {
  const double gravity = scene.gravity.value_or(standard_gravity) / scales.of(acceleration);
  const double along = scene.inclination.value_or(0), steep = 90 - along;  // 0 and 90 exactly
  const auto radians = [](double degrees) { return degrees * (std::numbers::pi / 180); };
  const bool is_flat = along <= 45;
  const SinCos<double> smaller = sin_cos(radians(is_flat ? along : steep));
  made.weight = gravity * (is_flat ? smaller.sin : smaller.cos);
  const double across = gravity * (is_flat ? smaller.cos : smaller.sin);
  for (std::size_t i = 0; i < made.dampers.size(); ++i) {
    const DamperInUnits& given = scene.dampers[i];
    SceneDamper& damper = made.dampers[i];
    damper.friction = given.friction_coefficient.value_or(0) * across;
    damper.static_friction = given.static_friction_coefficient.value_or(0) * across;
    damper.drag = 2 * (given.drag.value_or(0) / scales.of(damping)) / damper.mass_ratio;
  }
}

Pairs scaled(Pairs pairs, double first, double second) {
  for (auto& each : pairs) each = {each[0] / first, each[1] / second};
  return pairs;
}
// Sets the laws of the walls and of the primary spring, and a restitution that depends on the speed.
void set_laws(Scene& made, const SceneInUnits& scene, const Scales& scales) {
  const double mm = scales.of(length), newton = scales.of(force), per_second = scales.of(velocity);
  made.spring = scene.spring;
  made.spring.cubic *= mm * mm * mm / newton;
  made.spring.pairs = scaled(scene.spring.pairs, mm, newton);
  for (std::size_t i = 0; i < made.dampers.size(); ++i) {
    const DamperInUnits& given = scene.dampers[i];
    WallLaw& wall = made.dampers[i].wall = given.wall;
    wall.pairs = scaled(given.wall.pairs, mm, newton);
    if (wall.speed) *wall.speed /= per_second;
    made.dampers[i].restitution_by_speed = scaled(given.restitution_by_speed, per_second, 1);
  }
}

bool is_needed(const SceneInUnits& scene, std::string_view name) {
  return name == "mass" || (name == "stiffness" && !scene.natural_frequency) || name == "secondary_mass" ||
         name == "clearance";
}

// Numbers of which one stands for the other.
constexpr std::array<std::array<std::optional<double> SceneInUnits::*, 2>, 2> alternatives{
    {{&SceneInUnits::damping, &SceneInUnits::damping_ratio},
     {&SceneInUnits::stiffness, &SceneInUnits::natural_frequency}}};
std::string_view field_name(std::optional<double> SceneInUnits::*number) {
  return std::ranges::find_if(unit_fields, [&](const UnitField& field) { return field.number.is(number); })
      ->name;
}

}  // namespace

constexpr std::array<UnitField, 22> unit_fields{{
    {"mass", &SceneInUnits::mass, some, mass, "", "mass M of the primary system"},
    {"stiffness", &SceneInUnits::stiffness, some, stiffness, "", "stiffness K of its spring"},
    {"natural_frequency", &SceneInUnits::natural_frequency, some, frequency, "",
     "its natural frequency, in place of the stiffness"},
    {"secondary_mass", &DamperInUnits::secondary_mass, some, mass, "mass_ratio", "secondary mass"},
    {"clearance", &DamperInUnits::clearance, some, length, "clearance",
     "clearance of the secondary mass, epsilon"},
    {"restitution", &DamperInUnits::restitution, within(0, 1), ratio, "restitution",
     "coefficient of restitution, e"},
    {"damping", &SceneInUnits::damping, not_negative, damping, "damping_ratio",
     "viscous damping of the primary system"},
    {"damping_ratio", &SceneInUnits::damping_ratio, within(0, 1e6), ratio, "damping_ratio",
     "the same by critical damping, zeta"},
    {"contact_stiffness", &DamperInUnits::contact_stiffness, some, stiffness, "wall_stiffness",
     "stiffness of the walls"},
    {"initial_displacement", &SceneInUnits::initial_displacement, any, length, "x0",
     "initial displacement of the primary mass"},
    {"initial_velocity", &SceneInUnits::initial_velocity, any, velocity, "v0",
     "initial velocity of the primary mass"},
    {"secondary_displacement", &DamperInUnits::secondary_displacement, any, length, "y0",
     "initial distance of the secondary mass from the left wall"},
    {"secondary_velocity", &DamperInUnits::secondary_velocity, any, velocity, "w0",
     "initial velocity of the secondary mass in the cavity"},
    {"exciting_force", &SceneInUnits::exciting_force, any, force, "force_amplitude",
     "amplitude of the exciting force"},
    {"exciting_frequency", &SceneInUnits::exciting_frequency, positive, frequency, "force_frequency",
     "frequency of the exciting force"},
    {"friction_coefficient", &DamperInUnits::friction_coefficient, within(0, 1e6), ratio, "friction",
     "coefficient of friction of the secondary mass in the cavity, mu"},
    {"static_friction_coefficient", &DamperInUnits::static_friction_coefficient, within(0, 1e6), ratio,
     "static_friction", "the same where it does not slide"},
    {"inclination", &SceneInUnits::inclination, within(0, 90), inclination, "weight",
     "inclination of the cavity from the horizontal, its left wall below"},
    {"gravity", &SceneInUnits::gravity, not_negative, acceleration, "", "acceleration of gravity"},
    {"drag", &DamperInUnits::drag, within(0, 1e12), damping, "drag",
     "drag of a fluid on the secondary mass in the cavity"},
    {"until_seconds", &SceneInUnits::until_seconds, positive, time, "until_time",
     "the run ends at this time"},
    {"until_millimetres", &SceneInUnits::until_millimetres, positive, length, "until_amplitude",
     "the run ends with the first half cycle of a lower amplitude"},
}};

std::string_view unit_of(Dimension dimension, bool in_units) {
  return in_units ? row_of(dimension).in_units : row_of(dimension).dimensionless;
}
std::optional<double> parse_quantity(std::string_view text, Dimension dimension) {
  const std::size_t end = std::min(text.find_first_not_of("+-.0123456789eE"), text.size());
  const auto number = parse_number(text.substr(0, end));
  if (!number) return std::nullopt;
  std::string unit(text.substr(end));
  std::erase(unit, ' ');
  for (const WrittenUnit& each : written_unit_table)
    if (each.dimension == dimension && each.name == unit) return *number * each.times / each.divided_by;
  return std::nullopt;
}
std::string written_units(Dimension dimension) {
  std::vector<std::string_view> names;
  for (const WrittenUnit& each : written_unit_table)
    if (each.dimension == dimension) names.push_back(each.name);
  return listed(names, "or");
}
std::string with_unit(const std::string& number, std::string_view unit) {
  return unit.empty() ? number : number + ' ' + std::string(unit);
}
std::string_view suffix_of(Dimension dimension) { return row_of(dimension).suffix; }
std::string key_of(Dimension dimension) { return std::string(name_of(dimension)) += suffix_of(dimension); }

double Scales::of(Dimension dimension) const { return row_of(dimension).size(basis_of(*this, 1)); }
double Scales::in_si(Dimension dimension) const {
  return row_of(dimension).size(basis_of(*this, metres_per_millimetre));
}
double scale_of(Dimension dimension, const std::optional<Scales>& scales) {
  return scales ? scales->of(dimension) : 1;
}

std::vector<Problem> problems_of(const SceneInUnits& scene) {
  std::vector<Problem> problems;
  const auto check = [&](const std::string& name, const UnitField& field,
                         const std::optional<double>& value) {
    if (!value && is_needed(scene, field.name))
      problems.push_back({name, "missing, a value must be given in " +
                                    std::string(unit_of(field.dimension, true)) +
                                    (field.name == "stiffness" ? ", or natural_frequency in Hz" : "")});
    if (value && !field.range.allows(*value))
      problems.push_back({name, field.range.describe("must be") + ", got " + number_text(*value)});
  };
  const bool one = scene.dampers.size() == 1;
  for (const UnitField& field : unit_fields)
    if (one || field.number.own) check(std::string(field.name), field, field.number.in(scene));
  for (std::size_t i = 0; !one && i < scene.dampers.size() && i < most_dampers; ++i)
    for (const UnitField& field : unit_fields)
      if (field.number.of_damper)
        check(damper_field(i, field.name), field, scene.dampers[i].*field.number.of_damper);
  // Made dimensionless, a tiny negative speed may be 0.
  for (std::size_t i = 0; i < scene.dampers.size() && i < most_dampers; ++i) {
    const Pairs& pairs = scene.dampers[i].restitution_by_speed;
    if (!pairs.empty() && !(pairs.front()[0] >= 0))
      problems.push_back({one ? "restitution" : damper_field(i, "restitution"),
                          "must have speeds >= 0, got " + number_text(pairs.front()[0])});
  }
  if (scene.dampers.empty()) problems.push_back({"dampers", "must be at least one, got 0"});
  if (!(scene.spring.cubic >= 0))
    problems.push_back({"spring.cubic", "must be >= 0, got " + number_text(scene.spring.cubic)});
  for (const auto& [one_of_two, other] : alternatives)
    if (scene.*one_of_two && scene.*other)
      problems.push_back({std::string(field_name(one_of_two)),
                          filled("either it or {} must be given, got both", field_name(other))});
  if (!scene.until_seconds && !scene.until_millimetres)
    problems.push_back({"until_seconds", "until_seconds, until_millimetres or both must be given"});
  if (!problems.empty()) return problems;
  if (const double made = *stiffness_of(scene); !some.allows(made))
    return {{"natural_frequency",
             some.describe("with the mass must make a stiffness") + " N/m, got " + number_text(made)}};

  for (const Problem& problem : problems_of(dimensionless(scene))) {
    const bool of_the_list = problem.field == "dampers";
    problems.push_back(
        {maker_of(scene, problem.field),
         (of_the_list ? "" : "made dimensionless, as " + problem.field + ", ") + problem.message});
  }
  return problems;
}

void set_number(SceneInUnits& scene, const NumberInUnits& number, double value) {
  for (const auto& [one, other] : alternatives) {
    if (number.is(one)) (scene.*other).reset();
    if (number.is(other)) (scene.*one).reset();
  }
  number.in(scene) = value;
}

std::optional<double> stiffness_of(const SceneInUnits& scene) {
  if (!scene.natural_frequency || !scene.mass) return scene.stiffness;
  const double omega = 2 * std::numbers::pi * *scene.natural_frequency;
  return *scene.mass * (omega * omega);
}

Scales scales_of(const SceneInUnits& scene) {
  return {*scene.mass, *stiffness_of(scene), *scene.damper().clearance};
}

Scene dimensionless(const SceneInUnits& scene) {
  const Scales scales = scales_of(scene);
  Scene made;
  made.x0 = 0;
  made.dampers.resize(scene.dampers.size());
  for (const UnitField& field : unit_fields) {
    for (std::size_t i = 0; i < (field.number.of_damper ? made.dampers.size() : 1); ++i) {
      const auto& given = NumberInUnits{field.number, i}.in(scene);
      if (!given) continue;
      if (field.becomes.empty()) continue;
      const double number = *given / scales.of(field.dimension);
      if (field.becomes == "until_time")
        made.until_time = number;
      else if (field.becomes == "until_amplitude")
        made.until_amplitude = number;
      else if (const SceneNumber its = number_named(field.becomes); !field_of(its).component)
        SceneNumber{its, i}.in(made) = number;
    }
  }
  set_components(made, scene, scales);
  set_laws(made, scene, scales);
  return made;
}

std::vector<std::string> cautions_of(const Scene& scene, const std::optional<Scales>& scales) {
  std::vector<std::string> cautions;
  const auto text_of = [&](double value, Dimension dimension) {
    return with_unit(rounded_text(value * scale_of(dimension, scales), 5),
                     scales ? unit_of(dimension, true) : "");
  };
  const bool one = has_one_damper(scene);
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    const SceneDamper& damper = scene.dampers[i];
    const std::string mass = "the secondary mass" + (one ? "" : " of damper " + std::to_string(i + 1));
    const double depth = std::max(-damper.y0, damper.y0 - damper.clearance);
    if (depth > 0)
      cautions.push_back(
          mass + " begins " + text_of(depth, length) + (one && !scales ? " times the clearance" : "") +
          " outside its cavity, which reaches from 0 to " + text_of(damper.clearance, length) + " (" +
          (scales ? "secondary_displacement" : "y0") + " is " + text_of(damper.y0, length) + "): " +
          (damper.wall.law == WallForm::linear && scene.spring.is_linear()
               ? "a compliant wall there holds an energy of " +
                     text_of(damper.wall_stiffness * depth * depth / 2, energy) + ", beside " +
                     text_of(scene.x0 * scene.x0 / 2, energy) + " in the primary spring"
               : "a wall there is pressed together"));
    if (damper.mass_ratio > 1)
      cautions.push_back(mass + " is " + rounded_text(damper.mass_ratio, 4) +
                         " times as heavy as the primary mass" +
                         (scales ? ": are both given in kilograms?" : ""));
  }
  return cautions;
}

}  // namespace impact_damper
