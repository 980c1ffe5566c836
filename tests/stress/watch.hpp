// An observer that asks an engine for nothing but impacts, and for samples when it is told to.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "engines/observed.hpp"

namespace stress {

struct Sample {
  double time = 0, x = 0, v = 0, y = 0, w = 0;
};

class Watch : public impact_damper::TestObserver<double> {
 public:
  void impact(double time, impact_damper::Wall, double, double) override {
    ++impacts;
    last_impact = time;
  }
  double next_sample() const override { return sample_at; }
  // Keeps it; the next is `every` later, counted from the first.
  void sample(double time, double x, double v, double y, double w) override {
    if (samples.empty()) first_ = time;
    samples.push_back({time, x, v, y, w});
    sample_at = every > 0 ? first_ + every * double(samples.size()) : std::numeric_limits<double>::infinity();
  }

  double sample_at = std::numeric_limits<double>::infinity();
  double every = 0;  // 0: no more than one sample
  std::vector<Sample> samples;
  std::int64_t impacts = 0;
  double last_impact = 0;

 private:
  double first_ = 0;
};

}  // namespace stress
