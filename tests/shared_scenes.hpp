// Scenes that tests share: random ones over all that a scene allows in earnest, round ones, where things
// coincide, both by their seed; and a scene as it is seen from the other side, or as a list of one damper.
// Equal seeds give equal scenes everywhere, but for the last bits of the C library's exp and log.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "impact_damper/run.hpp"
#include "impact_damper/scene.hpp"
#include "reference.hpp"

#ifndef __has_feature
#define __has_feature(name) 0
#endif

// Returns `count`, but a quarter of it under the sanitizers: there a scene takes five to ten times as long,
// and random commands (stress/commands.py) run, too.
constexpr int many(int count) {
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
  return count / 4;
#else
  return count;
#endif
}

namespace random_scenes {

// e 0 to 1 (its ends often), nu 1e-8 to 1e3, zeta 0 to 10, k 1 to 1e12, x0, v0 and w0 up to 1e8, y0 anywhere
// in the cavity, on its walls and up to 1 inside them; forced in 2 of 5, and then in 2 of 5 at resonance.
inline impact_damper::Scene scene_of(std::uint64_t seed) {
  reference::Random random(seed);
  impact_damper::Scene scene;
  scene.damper().mass_ratio = random.log_uniform(1e-8, 1e3);
  scene.damper().restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 1);
  scene.damping_ratio = random.chance(0.3) ? 0 : random.log_uniform(1e-4, 10);
  scene.damper().wall_stiffness = random.log_uniform(1, 1e12);
  const auto motion = [&] { return random.chance(0.3) ? 0 : random.log_uniform(1e-8, 1e8) * random.sign(); };
  scene.x0 = random.chance(0.5) ? random.uniform(-10, 10) : motion();
  scene.v0 = random.chance(0.7) ? 0 : motion();
  scene.damper().y0 = random.chance(0.5) ? double(random.chance(0.5)) : random.uniform(0, 1);
  scene.damper().w0 = random.chance(0.6) ? 0 : motion();
  if (random.chance(0.4)) {
    scene.force_amplitude = random.log_uniform(1e-3, 100);
    scene.force_frequency = random.chance(0.4) ? 1 : random.log_uniform(0.05, 20);
  }
  if (random.chance(0.15))
    scene.damper().y0 = random.chance(0.5) ? -random.log_uniform(1e-9, 1) : 1 + random.log_uniform(1e-9, 1);
  scene.until_time = random.uniform(1, 50);
  return scene;
}

}  // namespace random_scenes

// Round numbers: events coincide, roots are equal and series have zero terms, which random numbers never
// meet.
namespace round_scenes {

// y0 in the cavity, on its walls, or 0.25 inside them; 1 - y0 is exact. Forced in 2 of 5.
inline impact_damper::Scene scene_of(std::uint64_t seed) {
  reference::Random random(seed);
  const auto one_of = [&](std::initializer_list<double> values) {
    return values.begin()[random.bits() % values.size()];
  };
  impact_damper::Scene scene;
  const double nu = scene.damper().mass_ratio = one_of({0.02, 0.1, 0.5, 1, 2, 4});
  scene.damper().restitution = one_of({0, 0, 0.5, 0.6, 1, 1, std::exp(-std::numbers::pi * std::sqrt(nu))});
  scene.damping_ratio =
      one_of({0, 0, 0, 0.5, std::sqrt(0.5), std::sqrt(3) / 2, 1, std::sqrt(1 + nu), std::sqrt(nu), 2});
  scene.damper().wall_stiffness = one_of({nu, 1, nu / ((1 + nu) * (1 + nu)), 100, 1e4});
  scene.x0 = one_of({0, 0.25, 0.5, 1, 2, 6}) * random.sign();
  scene.v0 = one_of({0, 0, 1}) * random.sign();
  scene.damper().y0 = one_of({0, 0, 0.5, 1, 0.25, -0.25, 1.25});
  if (random.chance(0.3) && std::fabs(scene.x0) <= 1)
    scene.damper().y0 = scene.x0 < 0 ? -scene.x0 : 1 - scene.x0;  // met where x comes to zero
  scene.damper().w0 = one_of({0, 0, 1}) * random.sign();
  if (random.chance(0.4)) {
    scene.force_amplitude = one_of({0.25, 1, 4}) * random.sign();
    scene.force_frequency = one_of({1, 0.5, 2, std::sqrt(1 / (1 + nu)), std::sqrt(nu)});
  }
  scene.until_time = one_of({3, 10, 20, 4 * std::numbers::pi});
  return scene;
}

}  // namespace round_scenes

// The scene as it is seen from the other side.
inline impact_damper::Scene mirrored(impact_damper::Scene scene) {
  using impact_damper::Scene;
  for (double Scene::*const each : {&Scene::x0, &Scene::v0, &Scene::force_amplitude})
    scene.*each = -(scene.*each);
  for (impact_damper::SceneDamper& its : scene.dampers) its.y0 = its.clearance - its.y0, its.w0 = -its.w0;
  return scene;
}

// A scene of one damper in half its unit of length, where the engines of lists run it. A factor of 2 changes
// no bit but the exponent.
inline impact_damper::Scene list_of_one(impact_damper::Scene scene) {
  using impact_damper::Scene;
  for (double Scene::*const length : {&Scene::x0, &Scene::v0, &Scene::force_amplitude, &Scene::weight})
    scene.*length *= 2;
  if (scene.until_amplitude) *scene.until_amplitude *= 2;
  impact_damper::SceneDamper& its = scene.damper();
  its.clearance *= 2, its.y0 *= 2, its.w0 *= 2, its.friction *= 2, its.static_friction *= 2;
  return scene;
}

// The run of such a list with lengths halved; with a history, energies and half cycles as far as it has them.
inline impact_damper::Run in_its_own_units(impact_damper::Run run) {
  const auto halve = [](std::vector<double>& lengths) {
    for (double& each : lengths) each /= 2;
  };
  if (run.half_cycles) halve(run.half_cycles->amplitude);
  if (run.impacts) {
    halve(run.impacts->relative_velocity);
    halve(run.impacts->displacement);
    for (auto& each : run.impacts->amplitude)
      if (each) *each /= 2;
  }
  if (run.history) {
    halve(run.history->x);
    halve(run.history->v);
    for (auto& its : run.history->dampers) halve(its.y), halve(its.w);
  }
  if (run.energy) {
    impact_damper::EnergyBalance& all = *run.energy;
    for (double* energy : {&all.initial.kinetic, &all.initial.spring, &all.initial.wall, &all.initial.paper,
                           &all.initial.weight, &all.final.kinetic, &all.final.spring, &all.final.wall,
                           &all.final.paper, &all.final.weight, &all.contact_loss, &all.bounce_down_loss,
                           &all.viscous_work, &all.forcing_work, &all.friction_loss, &all.drag_loss})
      *energy /= 4;
    for (double& loss : all.impact_loss) loss /= 4;
    for (impact_damper::DamperEnergy& its : all.dampers)
      for (double* energy : {&its.initial_kinetic, &its.final_kinetic, &its.impact_loss, &its.contact_loss,
                             &its.bounce_down_loss, &its.friction_loss, &its.drag_loss})
        *energy /= 4;
  }
  return run;
}
