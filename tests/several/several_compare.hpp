// What the restitution engine, or between compliant walls the exact one, records of a scene with several
// dampers, held against the oracle.
//
// How large an error may be is measured by the oracle itself, from runs in which all numbers are changed by
// 1e-16 of themselves: up to an event nothing may differ by more than Tolerances::growth times the largest
// difference of these runs so far. A scene is compared until that difference is Tolerances::predictable, or
// until one of these runs has other events.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "impact_damper/run.hpp"
#include "several_oracle.hpp"

namespace several {

struct Tolerances {
  Walls walls = Walls::rigid;
  std::int64_t most_steps = 5000;  // of the oracle; compliant walls
  double growth = 1000;
  double predictable = 1e-10;
  // Rigid walls: contacts as near to each other, times 1 + t, are one. The begin of sticking may be off by
  // three times that, in a chattering within another one by thirty times.
  double begin = 1e-7;
  // Impacts so shortly before sticking, times 1 + t, and so slow, need not be listed.
  double chattering_time = 1e-3, chattering_speed = 1e-5;
};

struct Comparison {
  std::vector<std::string> differences;  // empty: all agrees
  double asked = 0, until = 0;           // the scene's end, and that of the comparison
  std::string ended_by;
  std::int64_t numbers = 0, impacts = 0, joint_impacts = 0, contacts = 0, joint_contacts = 0;
  double worst = 0;  // largest error, in units of the predicted one
  std::string worst_what;
  double largest = 0;  // the largest error itself, of all but begins of contacts, divided by 1 + |value|
};

impact_damper::Run simulated(const impact_damper::Scene& scene, Walls walls = Walls::rigid);
// `program`: a run from elsewhere; without one that of simulated().
using Program = std::function<impact_damper::Run(const impact_damper::Scene&)>;
Comparison compare(const impact_damper::Scene& scene, const Tolerances& tolerances,
                   const Program& program = {});

// At how many times, equally spaced from 0 to the scene's end, the motion is recorded.
inline constexpr int sample_count = 33;

// The oracle's answer in the form of a run, for a program with a planted fault.
impact_damper::Run run_of_oracle(const impact_damper::Scene& scene, Fault fault, Walls walls = Walls::rigid);

}  // namespace several
