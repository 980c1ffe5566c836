// What any scene promises, whatever the engine; each broken promise in words.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "impact_damper/run.hpp"

namespace stress {

enum class Promise {
  finite,          // every number of the run
  consistent,      // agrees with itself (consistency.hpp), impacts ascend, losses are not negative
  bounded,         // ends by time or by the impacts that were granted; no impacts heaped on one instant
  between_walls,   // 0 <= y <= 1 in flight, beyond the wall in contact
  end_on_the_dot,  // a contact that the end of the run cuts ends with it
  balance,         // closes
};
inline constexpr std::array<const char*, 6> promises{"finite",        "consistent",     "bounded",
                                                     "between walls", "end on the dot", "energy balance"};

struct Examined {
  std::array<std::string, promises.size()> broken;  // by Promise; empty: kept
  double outside = 0;   // farthest y beyond its side of a wall, by what rounding may do
  double residual = 0;  // of the energy balance
  bool all_kept() const;
};

// Runs the scene with everything recorded, sampled at times that crowd near the release.
Examined examine(const impact_damper::Scene& scene, const impact_damper::Engine& engine);

inline constexpr double closed_balance = 1e-10;
// A rounding is epsilon (1 + t) by the speeds and lengths that y is made of.
inline constexpr double roundings_beyond_a_wall = 64;

}  // namespace stress
