// What happens in a scene with several dampers, in quadruple precision.
//
// It shares nothing with the engines. Between two events the equations are linear, so that Taylor's
// coefficients follow from each other; events are roots of a step's polynomials (../oracle/polynomial.hpp).
// The masses that are at a wall at one instant take their impulses together. With s_i the velocity away from
// the wall, a_i = +1 at a left and -1 at a right wall, p_i >= 0 the impulse on damper i away from the wall
// and J the jump of x':
//
//   s_i+ = s_i- - a_i J + p_i / nu_i,   J = -sum a_i p_i,   s_i+ + e_i s_i- >= 0,   p_i (s_i+ + e_i s_i-) = 0
//
// A damper at rest on a wall sticks to it while the primary mass accelerates into it.
//
// Between compliant walls a damper is in contact from when it meets a wall until it is back there, and the
// wall then pushes it and the primary mass apart; those at rest on a wall are in contact if they move into it
// at once.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "impact_damper/run.hpp"
#include "oracle.hpp"

namespace several {

using oracle::Quad, oracle::Walls;

// Faults that the comparison has to find (several_itself.cpp).
enum class Fault {
  none,
  one_after_another,     // impacts of one instant are taken in turn
  not_released,          // an impact of another damper does not release those that stick
  released_apart,        // one damper is released where x'' is not yet zero
  chattering_cut_short,  // the rest of a chattering is left out at 1e-4
  restitution_of_first,  // all dampers have the first one's restitution at a right wall
  own_mass_only,         // of those that stick only one counts to the primary's mass
  clearance_ignored,     // the last damper has the first one's clearance
  // Compliant walls:
  wall_force_left_out,   // the last damper's wall does not push the primary mass
  wall_damper_of_first,  // all walls have the first one's damper
  stiffness_of_first,    // all walls have the first one's stiffness
  own_contact_only,      // of those in contact only the first pushes the primary mass
  let_go_by_force,       // a contact ends where its wall would begin to pull
};

struct Question {
  impact_damper::Scene scene;  // until_time is obeyed
  Walls walls = Walls::rigid;
  std::vector<double> samples;  // times, ascending
  // All numbers of the scene, and the state at each event, are changed by up to this part of themselves.
  // Equal numbers are changed equally: what coincides by them still does.
  double noise = 0;
  std::uint64_t seed = 0;
  std::int64_t most_impacts = 8000, most_steps = 32000;
  Fault fault = Fault::none;
};

struct Impact {
  Quad time;
  int damper;
  impact_damper::Wall wall;
  Quad relative_velocity, displacement, loss;  // loss: compliant walls: in the contact that it begins
  bool impulse = true;  // false: another damper's impulse of this instant has moved the wall away
};

struct Contact {
  Quad begin, end;
  int damper;
  impact_damper::Wall wall;
};

struct HalfCycle {
  Quad zero_crossing, peak_time, amplitude;
};

struct Sample {
  Quad x, v;
  std::vector<Quad> y, w;
};

struct Answer {
  bool complete = true;  // false: ends at end_time for want of effort
  Quad end_time = 0;
  std::vector<Impact> impacts;
  std::vector<Contact> contacts;
  std::vector<HalfCycle> half_cycles;
  std::vector<Sample> samples;
  oracle::Energy initial{}, final{};
  std::vector<Quad> damper_initial, damper_final, damper_loss;
  Quad contact_loss = 0;                                  // compliant walls: in contacts that no impact began
  Quad viscous_work = 0, forcing_work = 0, turnover = 0;  // turnover: of the force, sum of |work|
};

Answer answer_to(const Question& question);

}  // namespace several
