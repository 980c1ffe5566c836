#include "lists.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <sstream>

#include "reference.hpp"

namespace oracle {

using impact_damper::Scene, impact_damper::SceneDamper;

Scene random_list(std::uint64_t seed) {
  reference::Random random(seed);
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
  reference::Random random(seed);
  const auto one_of = [&](std::initializer_list<double> values) {
    return values.begin()[random.bits() % values.size()];
  };
  Scene scene;
  scene.x0 = one_of({0, 0.25, 0.5, 1, 2, 6}) * random.sign();
  scene.v0 = one_of({0, 0, 1}) * random.sign();
  scene.damping_ratio = one_of({0, 0, 0, 0.5, std::sqrt(0.5), 1, 2});
  if (random.chance(1 / 3.)) {
    scene.force_amplitude = one_of({0.25, 1, 4}) * random.sign();
    scene.force_frequency = one_of({1, 0.5, 2});
  }
  scene.until_time = one_of({3, 10, 20, 4 * std::acos(-1.0)});
  const int count = 1 + int(random.bits() % 6);
  scene.dampers.clear();
  const bool one_clearance = random.chance(0.5), one_start = random.chance(0.5);
  for (int i = 0; i < count; ++i) {
    SceneDamper damper;
    damper.mass_ratio = one_of({0.02, 0.1, 0.25, 0.5, 1, 2});
    damper.restitution = one_of({0, 0, 0.25, 0.5, 0.6, 1});
    damper.clearance = i > 0 && one_clearance ? scene.dampers[0].clearance : one_of({0.25, 0.5, 1, 2});
    const bool right = random.chance(0.5);
    const double distance = one_of({0, 0, 0, 0.125, 0.25});
    damper.y0 = right ? damper.clearance - distance : distance;
    damper.w0 = one_of({0, 0, 1}) * random.sign();
    if (i > 0 && one_start && damper.clearance >= scene.dampers[0].y0)
      damper.y0 = scene.dampers[0].y0, damper.w0 = scene.dampers[0].w0;
    scene.dampers.push_back(damper);
  }
  return scene;
}

Scene random_compliant_list(std::uint64_t seed) {
  Scene scene = random_list(seed);
  reference::Random random(seed ^ (std::uint64_t(1) << 40));
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
  reference::Random random(seed ^ (std::uint64_t(1) << 40));
  const auto one_of = [&](std::initializer_list<double> values) {
    return values.begin()[random.bits() % values.size()];
  };
  const bool equal_walls = random.chance(0.5), equal = random.chance(0.2);
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    SceneDamper& each = scene.dampers[i];
    const double nu = each.mass_ratio;
    if (equal) each = scene.dampers[0];
    each.wall_stiffness = i > 0 && (equal || equal_walls)
                              ? scene.dampers[0].wall_stiffness
                              : one_of({nu, nu / ((1 + nu) * (1 + nu)), 1, 16, 100, 1e4, 1e4, 1e6});
    const double overlap = !random.chance(0.15) ? 0 : each.wall_stiffness > 100 ? 1e-3 : one_of({0.125, 0.5});
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
Scene quiet_scene(reference::Random& random) {
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
Scene pressing_scene(reference::Random& random) {
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
  reference::Random random(seed);
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
  reference::Random random(seed);
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

std::string text_of(const Scene& scene) {
  std::ostringstream text;
  text.precision(17);
  text << "{\"x0\": " << scene.x0 << ", \"v0\": " << scene.v0
       << ", \"damping_ratio\": " << scene.damping_ratio << ", \"force_amplitude\": " << scene.force_amplitude
       << ", \"force_frequency\": " << scene.force_frequency << ",\n \"until_time\": " << *scene.until_time
       << ", \"dampers\": [";
  for (const SceneDamper& each : scene.dampers)
    text << (&each == scene.dampers.data() ? "\n" : ",\n") << "  {\"mass_ratio\": " << each.mass_ratio
         << ", \"restitution\": " << each.restitution << ", \"clearance\": " << each.clearance
         << ", \"wall_stiffness\": " << each.wall_stiffness << ", \"y0\": " << each.y0
         << ", \"w0\": " << each.w0 << "}";
  return text.str() + "]}\n";
}

}  // namespace oracle
