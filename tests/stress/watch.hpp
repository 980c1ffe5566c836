// An observer (recorder.hpp) that asks an engine for nothing but impacts, and for samples when it is told to.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "impact_damper/run.hpp"

namespace stress {

struct Sample {
  double time = 0, x = 0, v = 0, y = 0, w = 0;
};

class Watch {
 public:
  bool wants_half_cycles() const { return false; }
  bool wants_contacts() const { return false; }
  bool wants_energy() const { return false; }
  void half_cycle(double, double, double, double) {}
  void impact(double time, impact_damper::Wall, double, double) {
    ++impacts;
    last_impact = time;
  }
  void contact(double, double, impact_damper::Wall) {}
  double next_sample() const { return sample_at; }
  // Keeps it; the next is `every` later, counted from the first.
  void sample(double time, double x, double v, double y, double w) {
    if (samples.empty()) first_ = time;
    samples.push_back({time, x, v, y, w});
    sample_at = every > 0 ? first_ + every * double(samples.size()) : std::numeric_limits<double>::infinity();
  }
  impact_damper::EnergyBalance& energy_balance() { return energy_balance_; }

  double sample_at = std::numeric_limits<double>::infinity();
  double every = 0;  // 0: no more than one sample
  std::vector<Sample> samples;
  std::int64_t impacts = 0;
  double last_impact = 0;

 private:
  double first_ = 0;
  impact_damper::EnergyBalance energy_balance_;
};

}  // namespace stress
