// The scenes that are run by all: each with the walls that it is about.
#pragma once

#include <string>
#include <vector>

#include "contender.hpp"

namespace impact_damper::bench {

struct BenchScene {
  std::string name;
  std::string what;  // for a heading
  Scene scene;
  Walls walls = Walls::compliant;  // that peers run it with; engines of this project with `others` too
  bool with_others = false;  // the engine for the other kind of walls as well, against its own reference
  bool chaotic = false;      // no amplitude can be compared: the error is that of the loss-factor curve
};

//   S1  regular motion just above the first chaotic range, x0 = 4.5 to t = 100
//   S2  the same with rigid walls
//   S3  bounce-down and stuck, x0 = 6 to t = 400
//   S4  forced at resonance, f0 = 0.05, and damped, zeta = 0.01: x0 = 6 to t = 100, from bounce-down to two
//       impacts in a half cycle; a shift of x0 does not grow on the way
//   S5  the whole decay from 6 to 0.03: chaotic in its middle
// nu = 0.02, e = 0.6, k = 1e4; zeta = 0 and no force but in S4. (S6, the figures, is no scene:
// figure_set.hpp.)
std::vector<BenchScene> bench_scenes();

// Whether a contender, of this project or not, runs a scene.
bool takes_part(const Contender& contender, bool ours, const BenchScene& scene);

}  // namespace impact_damper::bench
