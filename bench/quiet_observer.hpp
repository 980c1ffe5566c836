// An observer that looks at everything a decay is made of and keeps nothing but counts.
#pragma once

#include <cstdint>
#include <limits>

#include "impact_damper/run.hpp"

namespace impact_damper::bench {

class QuietObserver {
 public:
  explicit QuietObserver(bool energy = false) : energy_(energy) {}

  bool wants_half_cycles() const { return true; }
  bool wants_contacts() const { return false; }
  bool wants_energy() const { return energy_; }

  void half_cycle(double, double, double, double) { ++rows; }
  void impact(double, Wall, double, double) { ++impacts; }
  void contact(double, double, Wall) {}
  double next_sample() const { return std::numeric_limits<double>::infinity(); }
  void sample(double, double, double, double, double) {}
  EnergyBalance& energy_balance() {
    energy_balance_.impact_loss.clear();  // the engine keeps the sum
    return energy_balance_;
  }

  std::int64_t rows = 0, impacts = 0;

 private:
  bool energy_;
  EnergyBalance energy_balance_;
};

}  // namespace impact_damper::bench
