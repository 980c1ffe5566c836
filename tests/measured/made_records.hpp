// Records as an instrument would make them, of decays by the plain integration, which shares nothing with the
// engines.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "application/measured/reduction.hpp"
#include "impact_damper/units.hpp"
#include "plain_integration.hpp"

namespace made {

using namespace impact_damper;

// The mast of data/examples, 60 s.
inline SceneInUnits mast() {
  SceneInUnits scene;
  scene.mass = 40, scene.stiffness = 16000, scene.damper().secondary_mass = 1.6,
  scene.damper().clearance = 10;
  scene.damper().restitution = 0.6, scene.damping_ratio = 0.002;
  scene.initial_displacement = 60;
  scene.until_seconds = 60;
  return scene;
}

struct Instrument {
  double samples_per_cycle = 50;
  double noise = 0;              // standard deviation, mm
  double offset = 0, drift = 0;  // mm, and mm over the record, half of it as a slow wave
  double time_factor = 1;        // of a wrong sampling rate
  unsigned seed = 1;
};

inline int samples_of(const Scene& scene, const Instrument& instrument) {
  return int(*scene.until_time / (2 * std::numbers::pi) * instrument.samples_per_cycle) + 1;
}
// The record of a run of this scene that has a history of so many samples.
inline MeasuredRecord measured(const SceneInUnits& in_units, const Run& run, const Instrument& instrument) {
  const Scales scales = scales_of(in_units);
  std::mt19937 random(instrument.seed);
  std::normal_distribution<double> normal;
  MeasuredRecord record;
  const History& history = *run.history;
  for (std::size_t i = 0; i < history.time.size(); ++i) {
    const double part = history.time[i] / history.time.back();
    const double value = history.x[i] * scales.length + instrument.offset +
                         instrument.drift / 2 * (part + std::sin(2 * std::numbers::pi * part) / 2) +
                         instrument.noise * normal(random);
    record.time.push_back(history.time[i] * scales.of(Dimension::time) * instrument.time_factor);
    record.value.push_back(value);
  }
  return record;
}
inline MeasuredRecord measured(const SceneInUnits& in_units, const Instrument& instrument) {
  const Scene scene = dimensionless(in_units);
  return measured(in_units, reference::PlainIntegration(scene, true, samples_of(scene, instrument)).run(),
                  instrument);
}

}  // namespace made
