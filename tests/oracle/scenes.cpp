#include "scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "impact_damper/base/number_text.hpp"
#include "reference.hpp"

namespace oracle {

using impact_damper::Scene;
using reference::Random;

namespace {

double one_of(Random& random, const std::vector<double>& values) {
  return values[std::min(std::size_t(random.uniform(0, double(values.size()))), values.size() - 1)];
}

// Long enough for tens of events, short enough for the oracle: steps are 4 by the fastest rate.
double length(Random& random, const Scene& scene, double least, double most) {
  double rate = 2 + 2 * scene.damping_ratio;
  if (scene.force_amplitude != 0) rate = std::max(rate, scene.force_frequency);
  return std::min(random.uniform(least, most), 400 / rate);
}

}  // namespace

Scene random_scene(std::uint64_t seed, bool rigid) {
  Random random(seed);
  Scene scene;
  scene.damper().mass_ratio = random.log_uniform(1e-6, 1e4);
  scene.damper().restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 1);
  const double damping = random.uniform(0, 1);
  scene.damping_ratio = damping < 0.3    ? 0
                        : damping < 0.5  ? 1 + random.sign() * random.log_uniform(1e-12, 0.1)
                        : damping < 0.95 ? random.log_uniform(1e-4, 10)
                                         : random.log_uniform(1, 1e3);
  scene.damper().wall_stiffness = random.log_uniform(0.3, 1e12);
  const auto motion = [&] { return random.chance(0.3) ? 0 : random.log_uniform(1e-8, 1e6) * random.sign(); };
  scene.x0 = random.chance(0.7) ? random.uniform(-8, 8) : motion();
  scene.v0 = random.chance(0.6) ? 0 : random.chance(0.5) ? random.uniform(-3, 3) : motion();
  scene.damper().y0 = random.chance(0.4) ? double(random.chance(0.5)) : random.uniform(0, 1);
  scene.damper().w0 = random.chance(0.6) ? 0 : random.chance(0.5) ? random.uniform(-3, 3) : motion();
  if (random.chance(0.4)) {
    scene.force_amplitude = random.log_uniform(1e-3, 100) * random.sign();
    scene.force_frequency = random.chance(0.2) ? 1 : random.log_uniform(1e-3, random.chance(0.3) ? 1e3 : 10);
  }
  if (!rigid && random.chance(0.15))
    scene.damper().y0 = random.chance(0.5) ? -random.log_uniform(1e-9, 1) : 1 + random.log_uniform(1e-9, 1);
  scene.until_time = length(random, scene, 3, 40);
  return scene;
}

Scene round_scene(std::uint64_t seed, bool rigid) {
  Random random(seed);
  Scene scene;
  const auto pick = [&](std::initializer_list<double> values) { return one_of(random, values); };
  scene.damper().mass_ratio = pick({1, 0.25, 4, 0.6, 0.02, 0.02, 0.1, 0.5, 2, 2e-6, 1.0 / 3});
  const double nu = scene.damper().mass_ratio, cos36 = std::numbers::phi / 2,
               cos72 = (std::numbers::phi - 1) / 2;
  scene.damper().restitution = pick({0, 0, 1, std::exp(-std::numbers::pi * std::sqrt(nu)), 0.6, 0.5});
  scene.damping_ratio = pick({0, 0, 0, 0.5, std::sqrt(0.5), std::sqrt(0.75), cos36, cos72, 1,
                              std::nextafter(1, 0), 1 - 1e-12, std::nextafter(1, 2), std::sqrt(1 + nu),
                              std::nextafter(std::sqrt(1 + nu), 0), std::sqrt(nu), 0.1});
  scene.damper().wall_stiffness = pick({nu, nu / ((1 + nu) * (1 + nu)), 1, 100, 1e4, 1e4, nu * (1 + nu)});
  scene.x0 = pick({0, 1, 0.5, 2, 6, 6, 0.1, -1, -0.5, -2, -6, 0.25, 3});
  scene.v0 = pick({0, 0, 0, 0, 1, -1, 0.5});
  scene.damper().y0 = pick({0, 0, 1, 1, 0.5, 0.25, 1 - scene.x0, scene.x0});
  if (scene.damper().y0 < 0 || scene.damper().y0 > 1) scene.damper().y0 = random.chance(0.5);
  scene.damper().w0 = pick({0, 0, 0, 0, -scene.v0, 1, -1});
  if (random.chance(0.25)) {
    // Released from rest the secondary mass stays where it is until a wall comes: as x crosses zero, or just
    // where it turns, without speed.
    scene.x0 = pick({0.1, 0.25, 0.5, 1, 0.75});
    scene.damper().y0 = pick({0, 1 - scene.x0, 1 - scene.x0, 1 - 2 * scene.x0});
    if (scene.damper().y0 < 0) scene.damper().y0 = 0;
    scene.v0 = scene.damper().w0 = 0;
  }
  if (random.chance(0.4)) {
    const double b = std::sqrt(1 / (1 + nu)),
                 contact = std::sqrt(scene.damper().wall_stiffness * (1 + nu) / nu);
    scene.force_amplitude = pick({1, 0.05, -1, 0.5, 10});
    scene.force_frequency =
        pick({1, 1, b, contact, std::sqrt(scene.damper().wall_stiffness / nu), 2, 0.5, 1 / (1 + nu)});
  }
  if (!rigid && random.chance(0.1)) scene.damper().y0 = pick({-0.5, -1, 1.5, 2, -0.1});
  // Something must move it.
  if (scene.x0 == 0 && scene.v0 == 0 && scene.damper().w0 == 0 && scene.force_amplitude == 0 &&
      scene.damper().y0 >= 0 && scene.damper().y0 <= 1)
    scene.v0 = 1;
  if (random.chance(0.3)) {
    scene.x0 = -scene.x0, scene.v0 = -scene.v0, scene.damper().w0 = -scene.damper().w0,
    scene.force_amplitude = -scene.force_amplitude;
    scene.damper().y0 = 1 - scene.damper().y0;
  }
  for (double* const each : {&scene.x0, &scene.v0, &scene.damper().w0, &scene.force_amplitude})
    if (*each == 0) *each = 0;  // no -0
  scene.until_time = std::min(length(random, scene, 5, 25), pick({8, 12, 20, 25}));
  // Drawn last, so that a seed's other numbers do not depend on it.
  if (random.chance(0.05)) {
    // No impact and no loss: all amplitudes are equal.
    scene.damping_ratio = scene.force_amplitude = scene.v0 = scene.damper().w0 = 0;
    scene.x0 = pick({0.1, -0.1, 0.2});
    scene.damper().y0 = 0.5;
  }
  return scene;
}

Scene within_steps(Scene scene) {
  scene.damper().mass_ratio = std::clamp(scene.damper().mass_ratio, 1e-3, 100.0);
  const double nu = scene.damper().mass_ratio;
  scene.damper().wall_stiffness = std::min(scene.damper().wall_stiffness, 100 * 100 * nu / (1 + nu));
  scene.damping_ratio = std::min(scene.damping_ratio, 3.0);
  scene.force_frequency = std::min(scene.force_frequency, 10.0);
  for (double* const each : {&scene.x0, &scene.v0, &scene.damper().w0, &scene.force_amplitude})
    *each = std::clamp(*each, -20.0, 20.0);
  scene.until_time = std::min(*scene.until_time, 15.0);
  return scene;
}

std::string options_of(const Scene& scene) {
  std::string options;
  const Scene defaults;
  const auto add = [&](std::string_view name, double value) {
    std::string option(name);
    std::replace(option.begin(), option.end(), '_', '-');
    options += " --" + option + " " + impact_damper::number_text(value);
  };
  for (const impact_damper::SceneField& field : impact_damper::scene_fields)
    if (field.number.in(scene) != field.number.in(defaults)) add(field.name, field.number.in(scene));
  if (scene.until_time) add("until_time", *scene.until_time);
  if (scene.until_amplitude) add("until_amplitude", *scene.until_amplitude);
  return options;
}

}  // namespace oracle
