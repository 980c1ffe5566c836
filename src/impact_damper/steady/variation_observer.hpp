// A run with its variation (variation.hpp) as what an engine reports to.
#pragma once

#include <limits>
#include <variant>

#include "impact_damper/engines/exact.hpp"
#include "impact_damper/engines/restitution.hpp"
#include "impact_damper/steady/variation.hpp"

namespace impact_damper {

template <class Receiver>
class VariationObserver {
 public:
  VariationObserver(const Scene& scene, const Engine& engine, Receiver& receiver)
      : variation(scene, damping_of_walls(scene, engine), receiver) {}

  bool wants_half_cycles() const { return false; }
  bool wants_contacts() const { return false; }
  bool wants_energy() const { return false; }
  double next_sample() const { return std::numeric_limits<double>::infinity(); }
  void half_cycle(double, double, double, double) {}
  void impact(double, Wall, double, double) {}
  void contact(double, double, Wall) {}
  void sample(double, double, double, double, double) {}
  EnergyBalance& energy_balance() { return unused_; }

  template <class Motion>
  void passed(const Motion& motion, double begin, double duration, const State<double>& end) {
    variation.passed(motion, begin, duration, end);
  }

  Variation<double, Receiver> variation;

 private:
  static std::optional<double> damping_of_walls(const Scene& scene, const Engine& engine) {
    if (const auto* exact = std::get_if<Exact>(&engine)) return zeta_m<double>(scene, exact->calibration);
    return {};
  }
  EnergyBalance unused_;
};

// Runs a valid scene by one of the closed-form engines.
template <class Observer>
Outcome run_observed(const Scene& scene, const Engine& engine, Observer& observer) {
  const System<double> system(scene);  // not with_system(): a steady state has a force
  require_arithmetic();
  if (const auto* exact = std::get_if<Exact>(&engine)) return run_exact(system, scene, *exact, observer);
  return run_restitution(system, scene, std::get<Restitution>(engine), observer);
}

}  // namespace impact_damper
