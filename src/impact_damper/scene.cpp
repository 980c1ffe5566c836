#include "impact_damper/scene.hpp"

#include <algorithm>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {
namespace {

// This, and the least mass ratio, stiffness and frequency, keep every square, product and quotient of a
// scene's numbers finite.
constexpr double largest_number = 1e12;

using enum Dimension;
constexpr bool component = true;
constexpr std::array<SceneField, 15> all_fields{{
    {"mass_ratio", &SceneDamper::mass_ratio, 1e-9, 1e6, ratio, "secondary to primary mass, nu"},
    {"restitution", &SceneDamper::restitution, 0.0, 1.0, ratio, "coefficient of restitution, e"},
    {"clearance", &SceneDamper::clearance, 1e-6, 1e6, length, "free travel of the secondary mass"},
    {"damping_ratio", &Scene::damping_ratio, 0.0, 1e6, ratio,
     "viscous damping ratio of the primary mass, zeta"},
    {"wall_stiffness", &SceneDamper::wall_stiffness, 1e-6, 1e15, ratio,
     "wall to primary spring stiffness, k"},
    {"x0", &Scene::x0, -largest_number, largest_number, length, "initial displacement of the primary mass"},
    {"v0", &Scene::v0, -largest_number, largest_number, velocity, "initial velocity of the primary mass"},
    {"y0", &SceneDamper::y0, -largest_number, largest_number, length,
     "initial distance of the secondary mass from the left wall"},
    {"w0", &SceneDamper::w0, -largest_number, largest_number, velocity,
     "initial velocity of the secondary mass in the cavity"},
    {"force_amplitude", &Scene::force_amplitude, -largest_number, largest_number, force,
     "forcing amplitude f0, 0 for none"},
    {"force_frequency", &Scene::force_frequency, 1e-12, 1e6, frequency, "forcing frequency omega_f"},
    {"friction", &SceneDamper::friction, 0.0, largest_number, ratio,
     "friction of the secondary mass in the cavity by its inertia, phi", component},
    {"static_friction", &SceneDamper::static_friction, 0.0, largest_number, ratio,
     "the same where it does not slide, phi_s; 0 for phi", component},
    {"weight", &Scene::weight, 0.0, largest_number, ratio,
     "weight of the secondary mass towards the left wall by its inertia, gamma", component},
    {"drag", &SceneDamper::drag, 0.0, largest_number, ratio,
     "drag of a fluid on the secondary mass in the cavity, d", component},
}};

constexpr bool is_clearance(const SceneField& field) { return field.number.is(&SceneDamper::clearance); }
constexpr bool is_of_damper(const SceneField& field) { return field.number.of_damper; }

template <std::size_t size>
constexpr std::array<SceneField, size> those(bool (*are_wanted)(const SceneField&)) {
  std::array<SceneField, size> fields;
  std::copy_if(all_fields.begin(), all_fields.end(), fields.begin(), are_wanted);
  return fields;
}

}  // namespace

constexpr std::array<SceneField, 14> scene_fields =
    those<14>([](const SceneField& field) { return !is_clearance(field); });
constexpr std::array<SceneField, 9> scene_damper_fields = those<9>(is_of_damper);

bool has_one_damper(const Scene& scene) {
  return scene.dampers.size() == 1 && scene.dampers.front().clearance == 1;
}

std::size_t listed_dampers(const Scene& scene) { return has_one_damper(scene) ? 0 : scene.dampers.size(); }

Problem problem_of_several() {
  return {"dampers", "a list is for run, sweep, report and response: give one damper without a list"};
}

bool has_components(const Scene& scene) {
  return scene.weight != 0 || std::ranges::any_of(scene.dampers, [](const SceneDamper& each) {
           return each.friction != 0 || each.static_friction != 0 || each.drag != 0;
         });
}

const SceneField& field_of(const SceneNumber& number) {
  const auto is_it = [&](const SceneField& field) {
    return field.number.own == number.own && field.number.of_damper == number.of_damper;
  };
  return *std::ranges::find_if(all_fields, is_it);
}
std::string name_of(const SceneNumber& number) {
  const std::string name(field_of(number).name);
  return number.damper ? name + "_" + std::to_string(*number.damper + 1) : name;
}

std::vector<NamedSceneNumber> numbers_of(const Scene& scene) {
  std::vector<NamedSceneNumber> all;
  const auto add = [&](const SceneNumber& number, const SceneField& field) {
    all.push_back({name_of(number), number, field.least, field.most});
  };
  for (const SceneField& field : scene_fields)
    if (field.number.own || has_one_damper(scene)) add(field.number, field);
  for (const SceneField& field : scene_damper_fields)
    for (std::size_t i = 0; i < listed_dampers(scene); ++i) add({field.number.of_damper, i}, field);
  return all;
}

std::string damper_field(std::size_t damper, std::string_view name) {
  return "dampers[" + std::to_string(damper) + "]." + std::string(name);
}

double secondary_mass(const Scene& scene) {
  double all = 0;
  for (const SceneDamper& damper : scene.dampers) all += damper.mass_ratio;
  return all;
}

std::vector<Problem> problems_of(const Scene& scene) {
  std::vector<Problem> problems;
  const auto check = [&](std::string_view name, double value, const NumberRange& range,
                         bool is_component = false) {
    const bool too_small = (range.least < 0 || is_component) && is_too_small(value);
    if (range.allows(value) && !too_small) return;
    const std::string allowed = too_small ? "must be 0 or of a magnitude >= " + number_text(least_magnitude)
                                          : range.describe("must be");
    problems.push_back({std::string(name), allowed + ", got " + number_text(value)});
  };
  if (scene.dampers.empty() || scene.dampers.size() > most_dampers) {
    problems.push_back(
        {"dampers", (scene.dampers.empty() ? std::string("must be at least one")
                                           : "must be at most " + std::to_string(most_dampers)) +
                        ", got " + std::to_string(scene.dampers.size())});
    return problems;
  }
  const bool one = has_one_damper(scene);
  for (std::size_t i = 0; !one && i < scene.dampers.size(); ++i) {
    for (const SceneField& field : scene_damper_fields)
      check(damper_field(i, field.name), scene.dampers[i].*field.number.of_damper, {field.least, field.most},
            field.component);
  }
  for (const SceneField& field : scene_fields)
    if (one || field.number.own)
      check(field.name, field.number.in(scene), {field.least, field.most}, field.component);
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    const SceneDamper& damper = scene.dampers[i];
    if (damper.static_friction > 0 && damper.static_friction < damper.friction)
      problems.push_back({one ? "static_friction" : damper_field(i, "static_friction"),
                          "must be 0 or at least the friction, " + number_text(damper.friction) + ", got " +
                              number_text(damper.static_friction)});
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
