#include "impact_damper/scene.hpp"

#include <algorithm>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"

namespace impact_damper {
namespace {

// This, and the least mass ratio, stiffness and frequency, keep every square, product and quotient of a
// scene's numbers finite.
constexpr double largest_number = 1e12;

}  // namespace

const std::array<SceneField, 10> scene_fields{{
    {"mass_ratio", &Scene::mass_ratio, 1e-9, 1e6, "secondary to primary mass, nu"},
    {"restitution", &Scene::restitution, 0.0, 1.0, "coefficient of restitution, e"},
    {"damping_ratio", &Scene::damping_ratio, 0.0, 1e6, "viscous damping ratio of the primary mass, zeta"},
    {"wall_stiffness", &Scene::wall_stiffness, 1e-6, 1e15, "wall to primary spring stiffness, k"},
    {"x0", &Scene::x0, -largest_number, largest_number, "initial displacement of the primary mass"},
    {"v0", &Scene::v0, -largest_number, largest_number, "initial velocity of the primary mass"},
    {"y0", &Scene::y0, -largest_number, largest_number,
     "initial distance of the secondary mass from the left wall"},
    {"w0", &Scene::w0, -largest_number, largest_number,
     "initial velocity of the secondary mass in the cavity"},
    {"force_amplitude", &Scene::force_amplitude, -largest_number, largest_number,
     "forcing amplitude f0, 0 for none"},
    {"force_frequency", &Scene::force_frequency, 1e-12, 1e6, "forcing frequency omega_f"},
}};

const std::array<SceneDamperField, 6> scene_damper_fields{{
    {"mass_ratio", &SceneDamper::mass_ratio, 1e-9, 1e6, "secondary to primary mass, nu"},
    {"restitution", &SceneDamper::restitution, 0.0, 1.0, "coefficient of restitution, e"},
    {"clearance", &SceneDamper::clearance, 1e-6, 1e6, "free travel of the secondary mass"},
    {"wall_stiffness", &SceneDamper::wall_stiffness, 1e-6, 1e15, "wall to primary spring stiffness, k"},
    {"y0", &SceneDamper::y0, -largest_number, largest_number,
     "initial distance of the secondary mass from the left wall"},
    {"w0", &SceneDamper::w0, -largest_number, largest_number,
     "initial velocity of the secondary mass in the cavity"},
}};

std::string SceneNumber::name() const {
  if (!of_damper) return std::string(std::ranges::find(scene_fields, own, &SceneField::member)->name);
  const auto* const field = std::ranges::find(scene_damper_fields, of_damper, &SceneDamperField::member);
  return std::string(field->name) + "_" + std::to_string(damper + 1);
}

std::vector<NamedSceneNumber> numbers_of(const Scene& scene) {
  std::vector<NamedSceneNumber> all;
  const auto add = [&](const SceneNumber& number, double least, double most) {
    all.push_back({number.name(), number, least, most});
  };
  for (const SceneField& field : scene_fields)
    if (scene.dampers.empty() || !is_of_one_damper(field)) add({field.member}, field.least, field.most);
  for (const SceneDamperField& field : scene_damper_fields)
    for (std::size_t i = 0; i < scene.dampers.size(); ++i) add({field.member, i}, field.least, field.most);
  return all;
}

bool is_of_one_damper(const SceneField& field) {
  return std::ranges::find(scene_damper_fields, field.name, &SceneDamperField::name) !=
         scene_damper_fields.end();
}

std::string damper_field(std::size_t damper, std::string_view name) {
  return "dampers[" + std::to_string(damper) + "]." + std::string(name);
}

double secondary_mass(const Scene& scene) {
  if (scene.dampers.empty()) return scene.mass_ratio;
  double all = 0;
  for (const SceneDamper& damper : scene.dampers) all += damper.mass_ratio;
  return all;
}

Scene with_alone(const Scene& scene, const SceneDamper& damper) {
  Scene alone;
  alone.mass_ratio = damper.mass_ratio;
  alone.restitution = damper.restitution;
  alone.damping_ratio = scene.damping_ratio;
  alone.wall_stiffness = damper.wall_stiffness;
  alone.force_amplitude = scene.force_amplitude;
  alone.force_frequency = scene.force_frequency;
  return alone;
}

std::vector<Problem> problems_of(const Scene& scene, DamperList dampers) {
  std::vector<Problem> problems;
  const auto check = [&](std::string_view name, double value, const NumberRange& range) {
    const bool too_small = range.least < 0 && is_too_small(value);
    if (range.allows(value) && !too_small) return;
    const std::string allowed = too_small ? "must be 0 or of a magnitude >= " + number_text(least_magnitude)
                                          : range.describe("must be");
    problems.push_back({std::string(name), allowed + ", got " + number_text(value)});
  };
  if (dampers == DamperList::rejected && !scene.dampers.empty()) {
    problems.push_back(
        {"dampers", "a list is for run, sweep, report and response: give one damper without a list"});
    return problems;
  }
  if (scene.dampers.size() > most_dampers) {
    problems.push_back({"dampers", "must be at most " + std::to_string(most_dampers) + ", got " +
                                       std::to_string(scene.dampers.size())});
    return problems;
  }
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    for (const SceneDamperField& field : scene_damper_fields) {
      check(damper_field(i, field.name), scene.dampers[i].*field.member, {field.least, field.most});
    }
  }
  for (const SceneField& field : scene_fields) {
    check(field.name, scene.*field.member, {field.least, field.most});
  }
  const NumberRange stops{0, largest_number, false};
  if (scene.until_time) check("until_time", *scene.until_time, stops);
  if (scene.until_amplitude) check("until_amplitude", *scene.until_amplitude, stops);
  if (!scene.until_time && !scene.until_amplitude) {
    problems.push_back({"until_time", "until_time, until_amplitude or both must be given"});
  }
  return problems;
}

}  // namespace impact_damper
