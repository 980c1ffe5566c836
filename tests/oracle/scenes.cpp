#include "scenes.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "impact_damper/base/number_text.hpp"
#include "reference.hpp"

namespace oracle {

using impact_damper::Scene, impact_damper::SceneDamper;
using reference::Random;

namespace {

double one_of(Random& random, std::initializer_list<double> values) {
  return values.begin()[random.bits() % values.size()];
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
  const auto pick = [&](std::initializer_list<double> values) {
    return values.begin()[std::min(std::size_t(random.uniform(0, double(values.size()))), values.size() - 1)];
  };
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
  for (SceneDamper& each : scene.dampers) {
    each.mass_ratio = std::clamp(each.mass_ratio, 1e-3, 100.0);
    const double nu = each.mass_ratio;
    each.wall_stiffness = std::min(each.wall_stiffness, 100 * 100 * nu / (1 + nu));
    each.clearance = std::max(each.clearance, 0.1);
    each.w0 = std::clamp(each.w0, -20.0, 20.0);
  }
  scene.damping_ratio = std::min(scene.damping_ratio, 3.0);
  scene.force_frequency = std::min(scene.force_frequency, 10.0);
  for (double* const each : {&scene.x0, &scene.v0, &scene.force_amplitude})
    *each = std::clamp(*each, -20.0, 20.0);
  scene.until_time = std::min(*scene.until_time, 15.0);
  return scene;
}

Scene random_list(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  scene.x0 = random.uniform(-5, 5);
  scene.v0 = random.chance(0.5) ? 0 : random.uniform(-5, 5);
  scene.damping_ratio = random.chance(0.4)   ? 0
                        : random.chance(0.8) ? random.log_uniform(1e-4, 0.5)
                                             : random.uniform(0.9, 4);
  if (random.chance(1 / 3.)) {
    scene.force_amplitude = random.log_uniform(0.01, 10);
    scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.2, 5);
  }
  scene.until_time = random.uniform(5, 40);
  const int count = 1 + int(random.bits() % 6);
  scene.dampers.clear();
  for (int i = 0; i < count; ++i) {
    SceneDamper damper;
    // Some begin as the one before.
    if (i > 0) damper = scene.dampers.back();
    if (i == 0 || random.chance(0.7)) {
      damper.clearance = random.log_uniform(0.1, 10);
      const int start = int(random.bits() % 4);
      damper.y0 = start == 0           ? random.uniform(0, damper.clearance)
                  : random.chance(0.5) ? damper.clearance
                                       : 0;
      damper.w0 = start == 1 || random.chance(0.3) ? 0 : random.uniform(-3, 3);
    }
    damper.mass_ratio = random.chance(0.1) ? random.log_uniform(0.5, 5) : random.log_uniform(1e-3, 0.5);
    damper.restitution = random.chance(0.25) ? double(random.chance(0.4)) : random.uniform(0, 1);
    scene.dampers.push_back(damper);
  }
  return scene;
}

Scene round_list(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  scene.x0 = one_of(random, {0, 0.25, 0.5, 1, 2, 6}) * random.sign();
  scene.v0 = one_of(random, {0, 0, 1}) * random.sign();
  scene.damping_ratio = one_of(random, {0, 0, 0, 0.5, std::sqrt(0.5), 1, 2});
  if (random.chance(1 / 3.)) {
    scene.force_amplitude = one_of(random, {0.25, 1, 4}) * random.sign();
    scene.force_frequency = one_of(random, {1, 0.5, 2});
  }
  scene.until_time = one_of(random, {3, 10, 20, 4 * std::acos(-1.0)});
  const int count = 1 + int(random.bits() % 6);
  scene.dampers.clear();
  const bool one_clearance = random.chance(0.5), one_start = random.chance(0.5);
  for (int i = 0; i < count; ++i) {
    SceneDamper damper;
    damper.mass_ratio = one_of(random, {0.02, 0.1, 0.25, 0.5, 1, 2});
    damper.restitution = one_of(random, {0, 0, 0.25, 0.5, 0.6, 1});
    damper.clearance =
        i > 0 && one_clearance ? scene.dampers[0].clearance : one_of(random, {0.25, 0.5, 1, 2});
    const bool right = random.chance(0.5);
    const double distance = one_of(random, {0, 0, 0, 0.125, 0.25});
    damper.y0 = right ? damper.clearance - distance : distance;
    damper.w0 = one_of(random, {0, 0, 1}) * random.sign();
    if (i > 0 && one_start && damper.clearance >= scene.dampers[0].y0)
      damper.y0 = scene.dampers[0].y0, damper.w0 = scene.dampers[0].w0;
    scene.dampers.push_back(damper);
  }
  return scene;
}

Scene random_compliant_list(std::uint64_t seed) {
  Scene scene = random_list(seed);
  Random random(seed ^ (std::uint64_t(1) << 40));
  scene.until_time = random.uniform(3, 20);
  if (random.chance(0.2)) {  // as many again
    const auto few = scene.dampers;
    scene.dampers.insert(scene.dampers.end(), few.begin(), few.begin() + std::ptrdiff_t(few.size() / 2));
  }
  const bool crowded = random.chance(0.2), pressed = random.chance(0.25), soft = random.chance(0.3);
  if (pressed) {
    scene.x0 = random.uniform(-0.5, 0.5), scene.v0 = random.chance(0.7) ? 0 : random.uniform(-0.2, 0.2);
    scene.force_amplitude *= random.log_uniform(0.01, 1);
  }
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    SceneDamper& each = scene.dampers[i];
    const SceneDamper& first = scene.dampers[0];
    if (random.chance(0.1)) each.mass_ratio = random.log_uniform(0.5, 5);
    each.wall_stiffness = i > 0 && random.chance(0.3) ? first.wall_stiffness
                                                      : random.log_uniform(10, soft || pressed ? 1e4 : 1e7);
    if (crowded) {
      const double before = each.clearance;
      each.clearance = i > 0 && random.chance(0.5) ? first.clearance : 1e-3 * random.log_uniform(1, 10);
      each.y0 *= each.clearance / before;
      if (random.chance(0.5)) each.w0 = 0;
    }
    if (pressed) {
      each.restitution = random.chance(0.3) ? 0 : random.uniform(0, 0.4);
      if (random.chance(0.7)) each.y0 = random.chance(0.5) ? 0 : each.clearance, each.w0 = 0;
    }
    if (random.chance(0.15)) {  // inside a wall
      const double overlap = random.log_uniform(1e-9, 3 / std::sqrt(each.wall_stiffness));
      each.y0 = random.chance(0.5) ? -overlap : each.clearance + overlap;
    }
  }
  return scene;
}

Scene round_compliant_list(std::uint64_t seed) {
  Scene scene = round_list(seed);
  Random random(seed ^ (std::uint64_t(1) << 40));
  const bool equal_walls = random.chance(0.5), equal = random.chance(0.2);
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    SceneDamper& each = scene.dampers[i];
    const double nu = each.mass_ratio;
    if (equal) each = scene.dampers[0];
    each.wall_stiffness = i > 0 && (equal || equal_walls)
                              ? scene.dampers[0].wall_stiffness
                              : one_of(random, {nu, nu / ((1 + nu) * (1 + nu)), 1, 16, 100, 1e4, 1e4, 1e6});
    const double overlap = !random.chance(0.15)        ? 0
                           : each.wall_stiffness > 100 ? 1e-3
                                                       : one_of(random, {0.125, 0.5});
    if (overlap > 0) each.y0 = random.chance(0.5) ? -overlap : each.clearance + overlap;
  }
  if (scene.force_amplitude != 0 && random.chance(0.3)) {
    const SceneDamper& first = scene.dampers[0];
    scene.force_frequency = random.chance(0.5) ? std::sqrt(first.wall_stiffness / first.mass_ratio)
                                               : std::sqrt(1 / (1 + first.mass_ratio));
  }
  return scene;
}

namespace {

// Of both walls: no impact for long, so that amplitudes are equal; or a release with x'' = 0, at times with
// x''' = 0, too, for those at rest on a wall.
Scene quiet_scene(Random& random) {
  Scene scene;
  scene.until_time = random.uniform(3, 20);
  const bool vanishes = random.chance(0.5);
  if (vanishes) {
    scene.damping_ratio = 0.125 * double(random.bits() % 5);
    scene.v0 = random.sign() * double(1 + random.bits() % 3);
    scene.x0 = -2 * scene.damping_ratio * scene.v0;
    if (random.chance(0.5)) scene.force_amplitude = random.uniform(-2, 2), scene.force_frequency = 0.75;
    if (random.chance(0.3)) scene.force_amplitude = 2 * scene.v0, scene.force_frequency = 0.5;  // x''' = 0
  } else {
    scene.damping_ratio = 0;
    scene.x0 = random.uniform(-0.5, 0.5), scene.v0 = random.chance(0.5) ? 0 : random.uniform(-0.5, 0.5);
  }
  scene.dampers.clear();
  for (int i = 1 + int(random.bits() % 4); i > 0; --i) {
    SceneDamper damper;
    damper.mass_ratio = random.log_uniform(1e-4, 0.5);
    damper.restitution = random.uniform(0, 0.9);
    damper.clearance = random.uniform(3, 5);
    damper.y0 = !vanishes ? random.uniform(1, 2) : random.chance(0.5) ? damper.clearance : 0;
    if (!vanishes && random.chance(0.3)) damper.w0 = random.uniform(-0.1, 0.1);
    damper.wall_stiffness = random.log_uniform(100, 1e5);
    scene.dampers.push_back(damper);
  }
  return scene;
}

// At the wall to which x'' presses, from rest or nearly so.
Scene pressing_scene(Random& random) {
  Scene scene;
  const bool right = random.chance(0.5);
  scene.x0 = (right ? 1 : -1) * random.log_uniform(0.1, 10);
  if (random.chance(0.3)) scene.v0 = random.log_uniform(1e-6, 0.1) * random.sign();
  scene.damping_ratio = random.chance(0.4) ? 0 : random.log_uniform(1e-3, 2);
  const int count = 2 + int(random.bits() % 3);
  scene.dampers.clear();
  for (int i = 0; i < count; ++i) {
    SceneDamper damper;
    damper.clearance = random.log_uniform(0.3, 3);
    damper.y0 = right ? damper.clearance : 0;
    scene.dampers.push_back(damper);
  }
  return scene;
}

}  // namespace

Scene aimed_list(std::uint64_t seed) {
  Random random(seed);
  if (random.chance(0.3)) return quiet_scene(random);
  // Chattering beside those that stick, masses of all sizes.
  Scene scene = pressing_scene(random);
  scene.until_time = random.log_uniform(0.01, 1);
  // Of several heavy ones each impact throws the others off: what is below rounding of x then grows.
  const bool heavy = random.chance(0.4);
  if (heavy) scene.dampers.resize(2);
  for (SceneDamper& each : scene.dampers) {
    each.mass_ratio = heavy ? random.log_uniform(0.1, 20) : random.log_uniform(1e-6, 0.3);
    each.restitution = random.chance(0.2) ? 0 : random.uniform(0, random.chance(0.2) ? 0.9 : 0.8);
    if (random.chance(0.6)) each.w0 = random.log_uniform(1e-7, 1e-3) * random.sign();
  }
  return scene;
}

Scene aimed_compliant_list(std::uint64_t seed) {
  Random random(seed);
  if (random.chance(0.3)) return quiet_scene(random);
  Scene scene = pressing_scene(random);
  // Pressing together with wall frequencies far apart, or beside one that bounces without loss.
  const bool bounces = random.chance(0.5), equal = random.chance(0.3);
  scene.until_time = bounces ? random.log_uniform(0.02, 0.1) : random.log_uniform(0.05, 2);
  for (SceneDamper& each : scene.dampers) {
    each.mass_ratio = random.log_uniform(1e-7, 0.1);
    const double frequency = !bounces                        ? random.log_uniform(30, 2e4)
                             : &each == scene.dampers.data() ? random.log_uniform(3e3, 2e4)
                                                             : random.log_uniform(300, 3e3);
    each.wall_stiffness = equal && &each != scene.dampers.data()
                              ? scene.dampers[0].wall_stiffness
                              : std::max(1e-3, frequency * frequency * each.mass_ratio);
    each.restitution = random.uniform(0, 0.8);
  }
  if (bounces) scene.dampers[0].restitution = 1;
  return scene;
}

namespace {

// Scenes in which an event of friction or weight coincides with another one, or with the release.
Scene at_an_edge(Scene scene, Random& random) {
  for (SceneDamper& each : scene.dampers) {
    // At rest, in the cavity or exactly at a wall.
    each.y0 = each.clearance * one_of(random, {0, 0.25, 0.5, 1});
    each.w0 = each.static_friction = 0;
  }
  const int which = int(random.bits() % 4);
  if (which == 0) {
    // Friction, or static friction, that is |x'' + gamma| at the release of all of them held, to the last
    // bit: they are as heavy together as the primary mass.
    const std::size_t count = scene.dampers.size();
    for (SceneDamper& each : scene.dampers) each.mass_ratio = count == 3 ? 0.25 : 1 / double(count);
    if (count == 3) scene.dampers[0].mass_ratio = 0.5;
    scene.v0 = 0;
    const double edge = std::fabs(scene.weight - scene.x0) / 2;
    const double part = one_of(random, {0.5, 1});
    for (SceneDamper& each : scene.dampers) each.friction = part * edge, each.static_friction = edge;
  } else if (which == 1) {
    // Held together, they part at one instant.
    const double friction = one_of(random, {0.25, 0.5}), ratio = one_of(random, {0, 1, 2});
    for (SceneDamper& each : scene.dampers) each.friction = friction, each.static_friction = ratio * friction;
  } else if (which == 2) {
    // On their floors x'' = -gamma at the release, gamma being 1.
    scene.weight = scene.x0 = 1, scene.v0 = 0;
    for (SceneDamper& each : scene.dampers) each.y0 = 0;
  } else {
    // nu phi holds x against its spring while the mass slides, and the friction stops that exactly at a wall.
    scene.dampers.resize(1);
    SceneDamper& its = scene.damper();
    const double side = one_of(random, {-1, 1}), speed = one_of(random, {0.25, 0.5}) * its.clearance;
    its.friction = one_of(random, {0.5, 1}) * its.clearance, its.drag = 0;
    scene.weight = one_of(random, {0, 0.25}) * its.clearance;
    scene.x0 = side * its.mass_ratio * its.friction, scene.v0 = scene.force_amplitude = 0;
    const double way = speed * speed / (2 * (its.friction + side * scene.weight));
    its.w0 = side * speed, its.y0 = side > 0 ? its.clearance - way : way;
  }
  return scene;
}

}  // namespace

Scene with_components(Scene scene, std::uint64_t seed, bool round) {
  Random random(seed ^ (std::uint64_t(1) << 41));
  const auto part = [&](double least, double most) {
    return round ? one_of(random, {0, 0.25, 0.5, 1}) : random.log_uniform(least, most);
  };
  const auto or_none = [&](double value) { return random.chance(0.4) ? 0 : value; };
  if (const std::size_t count = scene.dampers.size(); count > 1)
    scene.dampers.resize(std::min(count, std::size_t(4)));
  scene.weight = part(0.01, 2);
  scene.weight = or_none(scene.weight);
  for (SceneDamper& each : scene.dampers) {
    each.friction = part(0.003, 1);
    // As large as |x''| at the release, of this mass alone.
    if (round && random.chance(0.3)) each.friction = std::fabs(scene.x0) / (1 + each.mass_ratio);
    each.friction = or_none(each.friction);
    each.drag = part(0.01, 1);
    each.drag = or_none(each.drag);
    const double ratio = round ? one_of(random, {1, 1.5, 2}) : random.uniform(1, 2);
    each.static_friction = or_none(ratio * each.friction);
  }
  // Drawn last, so that a seed's other numbers do not depend on it.
  return round && random.chance(0.3) ? at_an_edge(scene, random) : scene;
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
