// An impact of a periodic motion.
#pragma once

#include <cstdint>

#include "impact_damper/run.hpp"

namespace impact_damper {

struct OrbitImpact {
  double time = 0;  // since the beginning of the run, where the force's phase is 0
  Wall wall = Wall::left;
  double speed = 0;         // |y'| just before
  std::int32_t damper = 0;  // its number in the scene
};

}  // namespace impact_damper
