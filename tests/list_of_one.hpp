// A scene of one damper in half its unit of length, where the engines of lists run it, and the run of that
// list in the scene's own units. A factor of 2 changes no bit but the exponent.
#pragma once

#include <vector>

#include "impact_damper/run.hpp"
#include "impact_damper/scene.hpp"

inline impact_damper::Scene list_of_one(impact_damper::Scene scene) {
  using impact_damper::Scene;
  for (double Scene::*const length : {&Scene::x0, &Scene::v0, &Scene::force_amplitude}) scene.*length *= 2;
  if (scene.until_amplitude) *scene.until_amplitude *= 2;
  impact_damper::SceneDamper& its = scene.damper();
  its.clearance *= 2, its.y0 *= 2, its.w0 *= 2;
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
                           &all.final.kinetic, &all.final.spring, &all.final.wall, &all.final.paper,
                           &all.contact_loss, &all.bounce_down_loss, &all.viscous_work, &all.forcing_work})
      *energy /= 4;
    for (double& loss : all.impact_loss) loss /= 4;
    for (impact_damper::DamperEnergy& its : all.dampers)
      for (double* energy : {&its.initial_kinetic, &its.final_kinetic, &its.impact_loss, &its.contact_loss,
                             &its.bounce_down_loss})
        *energy /= 4;
  }
  return run;
}
