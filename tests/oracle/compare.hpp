// Everything that an engine records, held against the oracle.
//
// How large an error may be: rounding errors of double precision grow with the motion, at worst
// exponentially. By how much is measured, by the oracle itself: runs in which all that is rounded is changed
// by 1e-24 of itself, and one by a few times 2^-53, which notices where growth is not linear (a wall that is
// nearly grazed). The largest difference so far, for changes of 2^-53, is what a perfect program in double
// precision may show. An engine may show `operations` times that.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "impact_damper/run.hpp"
#include "oracle.hpp"

namespace oracle {

// An engine's motion between two events is some 30 to 100 operations one after the other, in each of which
// the oracle's noise has one rounding.
inline constexpr double operations = 100;

struct Comparison {
  std::vector<std::string> differences;  // empty: all agrees
  double asked = 0, until = 0;           // the scene's end, and that of the comparison
  std::string ended_by;                  // why the comparison ends earlier, if it does
  std::int64_t numbers = 0, impacts = 0;
  double worst = 0;  // largest error, in units of the predicted one
  std::string worst_what;
};

// The scene must have until_time; engine: exact or restitution.
Comparison compare(const impact_damper::Scene& scene, const impact_damper::Engine& engine);

}  // namespace oracle
