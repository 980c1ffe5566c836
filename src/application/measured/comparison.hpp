// A measured decay compared with the simulation of a scene: the result of `impact-damper compare`, and its
// JSON.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "application/measured/decay_fit.hpp"
#include "application/measured/reduction.hpp"
#include "impact_damper/analysis/loss_factor.hpp"

namespace impact_damper {

// Decays of one scene that differ in the initial position of the secondary mass.
struct SimulatedDecays {
  SceneInUnits scene;
  std::vector<HalfCycles> decays;  // times in s, from the record's first peak on, amplitudes in mm
  std::vector<LossFactor> losses;  // (M12.1) of each, amplitudes in mm, per radian of its own frequency
  std::vector<double> bins;  // median loss factor of each bin, of those before the first that a decay lacks
};

struct Comparison {
  std::string record_name, scene_name;
  MeasuredRecord record;
  Engine engine;
  std::optional<WithoutImpacts> without_impacts;  // then `given` and `fitted` have one decay, in closed form
  Reduction reduction;
  LossFactor loss;  // (M12.1) of the record, amplitudes in mm, per radian of its own frequency
  std::vector<LossBin> bins;
  SimulatedDecays given;                  // of the scene
  std::optional<SimulatedDecays> fitted;  // of the scene with the best numbers
  std::optional<DecayFit> fit;
  // The frequency of the scene lies between these: with the secondary mass carried along, and without; both
  // are that of a record without impacts.
  double lowest_frequency = 0, highest_frequency = 0;  // Hz
  std::vector<std::string> remarks;  // a sentence each: what the record does not show, or contradicts
};

struct ComparisonOptions {
  FitOptions fit;             // no parameters: nothing is fitted
  std::int64_t releases = 8;  // >= 1
  // A record without impacts has the damping ratio alone; parameters other than that are not looked at.
  std::optional<WithoutImpacts> without_impacts{};
};

// Compares a record with simulations of a scene. `scene` must be valid, without a force and with one damper,
// not a list, `record` as it was read from `record_name`, and `tell` not empty. Throws InputError as
// reduced() does, InvalidArguments for a list of dampers and for options out of range.
Comparison compared(const std::string& record_name, const MeasuredRecord& record,
                    const std::string& scene_name, const SceneInUnits& scene, const Engine& engine,
                    const ComparisonOptions& options, const std::function<void(const std::string&)>& tell);

// The file: data/schema/comparison.schema.json.
std::string comparison_text(const Comparison& comparison);

}  // namespace impact_damper
