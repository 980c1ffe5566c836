#include "impact_damper/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

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

std::string pair_text(const std::array<double, 2>& pair) {
  return "[" + number_text(pair[0]) + ", " + number_text(pair[1]) + "]";
}
// Returns what is wrong with the pairs of a table of forces, or "". begins_at_zero: as a wall's does.
std::string wrong_of_force(const Pairs& pairs, bool begins_at_zero) {
  constexpr double least_slope = 1e-6, most_slope = 1e15;
  if (pairs.size() < 2 || pairs.size() > most_pairs)
    return "must be 2 to " + std::to_string(most_pairs) + " pairs, got " + std::to_string(pairs.size());
  bool has_zero = false;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [at, force] = pairs[i];
    if (!(std::abs(at) <= largest_number && std::abs(force) <= most_slope))
      return "must have lengths up to " + number_text(largest_number) + " and forces up to " +
             number_text(most_slope) + ", got " + pair_text(pairs[i]);
    has_zero = has_zero || (at == 0 && force == 0);
    if (i == 0) continue;
    const double step = at - pairs[i - 1][0], slope = (force - pairs[i - 1][1]) / step;
    if (!(step > 0 && slope >= least_slope && slope <= most_slope))
      return "must rise from pair to pair, by a stiffness of " + number_text(least_slope) + " to " +
             number_text(most_slope) + ", got " + pair_text(pairs[i]) + " after " + pair_text(pairs[i - 1]);
  }
  if (begins_at_zero && !(pairs[0][0] == 0 && pairs[0][1] == 0))
    return "must begin with the pair [0, 0], got " + pair_text(pairs[0]);
  return has_zero ? "" : "must have the pair [0, 0]";
}
// The same for pairs of speed and restitution.
std::string wrong_of_restitution(const Pairs& pairs) {
  if (pairs.size() > most_pairs)
    return "must be at most " + std::to_string(most_pairs) + " pairs, got " + std::to_string(pairs.size());
  double last = -1;
  for (const auto& pair : pairs) {
    const auto& [speed, e] = pair;
    if (!(speed >= 0 && speed > last && speed <= largest_number))
      return "must have speeds that rise, from 0 to " + number_text(largest_number) + ", got " +
             pair_text(pair);
    if (!within(0, 1).allows(e)) return "must have an e of 0 to 1 at each speed, got " + pair_text(pair);
    last = speed;
  }
  return "";
}

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

bool has_laws(const Scene& scene) {
  return !scene.spring.is_linear() || std::ranges::any_of(scene.dampers, [](const SceneDamper& each) {
    return each.wall.law != WallForm::linear || !each.restitution_by_speed.empty();
  });
}
bool is_ideal(const Scene& scene) { return !has_components(scene) && !has_laws(scene); }

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
    if (field.number.own || (has_one_damper(scene) && !is_replaced(scene.damper(), field.name)))
      add(field.number, field);
  for (const SceneField& field : scene_damper_fields)
    for (std::size_t i = 0; i < listed_dampers(scene); ++i)
      if (!is_replaced(scene.dampers[i], field.name)) add({field.number.of_damper, i}, field);
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
  const auto check_table = [&](const std::string& name, const std::string& wrong) {
    if (!wrong.empty()) problems.push_back({name, wrong});
  };
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    const SceneDamper& damper = scene.dampers[i];
    const WallLaw& wall = damper.wall;
    const auto name = [&](const char* own) { return one ? std::string(own) : damper_field(i, own); };
    if (wall.law == WallForm::table) check_table(name("wall.pairs"), wrong_of_force(wall.pairs, true));
    if (wall.law == WallForm::power) check(name("wall.exponent"), wall.exponent, within(1, 10));
    if (wall.speed) check(name("wall.speed"), *wall.speed, within(1e-6, 1e6));
    if (wall.law != WallForm::linear && damper.restitution < least_restitution_of_law)
      problems.push_back({name("restitution"), "must be >= " + number_text(least_restitution_of_law) +
                                                   " beside a wall with a law of its own, got " +
                                                   number_text(damper.restitution)});
    check_table(name("restitution"), wrong_of_restitution(damper.restitution_by_speed));
  }
  if (scene.spring.law == SpringForm::table)
    check_table("spring.pairs", wrong_of_force(scene.spring.pairs, false));
  else
    check("spring.cubic", scene.spring.cubic, {0, largest_number}, true);
  const NumberRange stops{0, largest_number, false};
  if (scene.until_time) check("until_time", *scene.until_time, stops);
  if (scene.until_amplitude) check("until_amplitude", *scene.until_amplitude, stops);
  if (!scene.until_time && !scene.until_amplitude) {
    problems.push_back({"until_time", "until_time, until_amplitude or both must be given"});
  }
  return problems;
}

}  // namespace impact_damper
