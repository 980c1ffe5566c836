#include "impact_damper/scene.hpp"

#include <limits>
#include <sstream>

namespace impact_damper {
namespace {

constexpr double largest = 1e12;  // keeps every square and product of a scene's numbers finite

std::string number(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(std::numeric_limits<double>::max_digits10);
  text << value;
  std::ostringstream brief;
  brief.imbue(std::locale::classic());
  brief << value;
  return std::stod(brief.str()) == value ? brief.str() : text.str();
}

}  // namespace

const std::array<SceneField, 10> scene_fields{{
    {"mass_ratio", &Scene::mass_ratio, 0.0, false, 1e6, "secondary to primary mass, nu"},
    {"restitution", &Scene::restitution, 0.0, true, 1.0, "coefficient of restitution, e"},
    {"damping_ratio", &Scene::damping_ratio, 0.0, true, 1e6, "viscous damping ratio of the primary mass, zeta"},
    {"wall_stiffness", &Scene::wall_stiffness, 0.0, false, 1e15, "wall to primary spring stiffness, k"},
    {"x0", &Scene::x0, -largest, true, largest, "initial displacement of the primary mass"},
    {"v0", &Scene::v0, -largest, true, largest, "initial velocity of the primary mass"},
    {"y0", &Scene::y0, -largest, true, largest, "initial distance of the secondary mass from the left wall"},
    {"w0", &Scene::w0, -largest, true, largest, "initial velocity of the secondary mass in the cavity"},
    {"force_amplitude", &Scene::force_amplitude, -largest, true, largest, "forcing amplitude f0, 0 for none"},
    {"force_frequency", &Scene::force_frequency, 0.0, false, 1e6, "forcing frequency omega_f"},
}};

std::vector<Problem> problems_of(const Scene& scene) {
  std::vector<Problem> problems;
  for (const SceneField& field : scene_fields) {
    const double value = scene.*field.member;
    const bool above = field.least_is_admitted ? value >= field.least : value > field.least;
    if (above && value <= field.most) continue;
    problems.push_back({std::string(field.name),
                        "must be " + std::string(field.least_is_admitted ? ">= " : "> ") + number(field.least) +
                            " and <= " + number(field.most) + ", got " + number(value)});
  }
  const auto positive = [&](const std::optional<double>& value, const char* name) {
    if (value && !(*value > 0 && *value <= largest)) {
      problems.push_back({name, "must be > 0 and <= " + number(largest) + ", got " + number(*value)});
    }
  };
  positive(scene.until_time, "until_time");
  positive(scene.until_amplitude, "until_amplitude");
  if (!scene.until_time && !scene.until_amplitude) {
    problems.push_back({"until_time", "until_time, until_amplitude or both must be given"});
  }
  return problems;
}

}  // namespace impact_damper
