// Everything that an engine records, held against the oracle.
//
// How large an error may be: rounding errors of double precision grow with the motion, at worst
// exponentially. By how much is measured, by the oracle itself: runs in which all that is rounded is changed
// by 1e-24 of itself, and one by a few times 2^-53, which notices where growth is not linear (a wall that is
// nearly grazed). The largest difference so far, for changes of 2^-53, is what a perfect program in double
// precision may show. An engine may show `operations` times that. A scene is compared until that error is no
// longer small, or until one of these runs has other events.
#pragma once

#include <cstdint>
#include <functional>
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
  std::int64_t joint_impacts = 0, joint_contacts = 0;  // at one instant, or together, with another damper's
  double worst = 0;                                    // largest error, in units of the predicted one
  std::string worst_what;
};

using Program = std::function<impact_damper::Run(const impact_damper::Scene&)>;
struct Comparing {
  bool as_list = false;         // a scene of one damper is run as a list
  std::int64_t most_steps = 0;  // of the oracle; 0: as many as are usual
  double allowed = operations;  // of exact and restitution
};

// The scene must have until_time.
Comparison compare(const impact_damper::Scene& scene, const impact_damper::Engine& engine,
                   const Comparing& how = {});

// The same of runs of exact's or restitution's that programs have made in place of the engine.
std::vector<Comparison> compare(const impact_damper::Scene& scene, const impact_damper::Engine& engine,
                                const Comparing& how, const std::vector<Program>& programs);

// At how many times, equally spaced from 0 to the scene's end, the motion is recorded.
inline constexpr int sample_count = 65;
// With all that is compared recorded.
impact_damper::Run simulated(const impact_damper::Scene& scene, const impact_damper::Engine& engine,
                             bool as_list = false);

// The oracle's answer in the form of a run, for a program with a planted fault.
impact_damper::Run run_of_oracle(const impact_damper::Scene& scene, Walls walls, Fault fault = Fault::none,
                                 int samples = sample_count);

}  // namespace oracle
