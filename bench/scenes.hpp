// The scenes that are run by all: each with the walls that it is about.
#pragma once

#include <optional>
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
  // Later amplitudes are not compared: a shift of x0 grows on the way to them. Absent: all are.
  std::optional<double> compared_until = {};
  int dampers = 0;  // of S9; 0: another scene
};

// The scene up to where it is compared.
Scene compared_part(const BenchScene& scene);

//   S1  regular motion just above the first chaotic range, x0 = 4.5 to t = 100
//   S2  the same with rigid walls
//   S3  bounce-down and stuck, x0 = 6 to t = 400
//   S4  forced at resonance, f0 = 0.05, and damped, zeta = 0.01: x0 = 6 to t = 100, from bounce-down to two
//       impacts in a half cycle; a shift of x0 does not grow on the way
//   S5  the whole decay from 6 to 0.03: chaotic in its middle
//   S7  forced near resonance, f0 = 0.3 nu, undamped, from x0 = 1 to t = 2000: irregular, with long flights
//   S8  a slow, a fast and a very fast force, from x0 = 0.1, the mass amid its travel, and the steady
//       velocity of the empty structure, so that x moves by about 1 and the walls are met again and again
// nu = 0.02, e = 0.6, k = 1e4; zeta = 0 but in S4 and S8, no force in S1, S2, S3, S5. (S6, the figures, is no
// scene: measurements.hpp.)
//   S9  one damper, and lists of 2, 5, 20 and 100: a free decay from x0 = 3 to t = 101. They share nu = 0.02
//       and k = 1e8 equally, so that a contact is short beside the time between two; e = 0.8, clearances from
//       1 up to below 1.7, and the masses begin in the left halves of their cavities. No mass comes to rest
//       on a wall, and few contacts overlap.
std::vector<BenchScene> bench_scenes();

// Whether a contender, of this project or not, runs a scene.
bool takes_part(const Contender& contender, bool ours, const BenchScene& scene);

}  // namespace impact_damper::bench
