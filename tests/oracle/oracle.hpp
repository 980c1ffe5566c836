// The oracle: what happens in a scene, by quadruple precision and Taylor series of the equations of motion.
//
// It shares nothing with the engines. Between two events the equations are linear, so that Taylor's
// coefficients follow from each other; a step is so long that 50 terms leave less than a rounding, and events
// are the roots of the step's polynomials, isolated with proof (polynomial.hpp). Each secondary mass is
// looked at from the wall that it touched last.
//
// The masses that are at a rigid wall at one instant take their impulses together. With s_i the velocity away
// from the wall, a_i = +1 at a left and -1 at a right wall, p_i >= 0 the impulse on damper i away from the
// wall and J the jump of x':
//
//   s_i+ = s_i- - a_i J + p_i / nu_i,   J = -sum a_i p_i,   s_i+ + e_i s_i- >= 0,   p_i (s_i+ + e_i s_i-) = 0
//
// A damper at rest on a wall sticks to it while the primary mass accelerates into it.
//
// Between compliant walls a damper is in contact from when it meets a wall until it is back there, and the
// wall then pushes it and the primary mass apart; those at rest on a wall are in contact if they move into it
// at once.
//
// Friction, weight and drag: y'' = -x'' - gamma - R, and nu R acts on the primary mass, where R is the wall's
// force and phi sgn(y') + d y'. The sign of y' is that of the step: y' = 0 is an event, where there is
// friction. Then it holds the mass, which moves with the primary mass, while |x'' + gamma + wall force| <=
// phi_s. Of several at rest all hold at first; the one that exceeds this most slides, which changes x'', and
// so on. An impulse moves the cavity under a mass that is held away from its walls. Bounces end where they
// are slower than 1e-29 of what else moves: none is left out before.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "impact_damper/run.hpp"
#include "polynomial.hpp"

namespace oracle {

enum class Walls { compliant, rigid };

// Faults that the comparison has to find (comparison.cpp).
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
  impact_damper::Scene scene;  // both stops are obeyed; one must be given
  Walls walls = Walls::compliant;
  impact_damper::Calibration calibration = impact_damper::Calibration::fixed_wall;
  std::vector<double> samples;  // times, ascending
  // Every number of the scene, and the state at each event, are changed by up to this part of themselves, by
  // random numbers of `seed`. With several dampers equal numbers are changed equally: what coincides by them
  // still does. One damper's state is changed at each step, too, and the time with it.
  double noise = 0;
  std::uint64_t seed = 0;
  std::int64_t most_steps = 400;
  std::int64_t most_impacts = 4000;
  Fault fault = Fault::none;
};

struct Impact {
  Quad time;
  int damper;
  impact_damper::Wall wall;
  Quad relative_velocity;                 // y' just before
  Quad displacement;                      // x
  Quad loss;                              // compliant walls: in the contact that it begins
  std::optional<Quad> accumulation = {};  // rigid walls: when the chattering that it belongs to is complete
  bool impulse = true;    // false: another damper's impulse of this instant has moved the wall away
  Quad acceleration = 0;  // rigid walls: |x'' + gamma| + phi before, of what lies on walls together
};

struct Contact {  // as in impact_damper::Contacts
  Quad begin, end;
  int damper;
  impact_damper::Wall wall;
  // On a rigid wall; friction would hold the mass just above it as well.
  bool by_friction = false;
  Quad end_speed = 0;  // at its end |y'| or, released from a rigid wall, (1 + nu) |x'''|
};

struct HalfCycle {
  Quad zero_crossing, peak_time, amplitude;
  Quad speed = 0;  // |x'| at the crossing
};

struct Sample {
  Quad x, v;
  std::vector<Quad> y, w;   // of each damper
  bool in_contact = false;  // compliant walls: whether one is
};

struct Energy {
  Quad kinetic, spring, wall, paper, weight;
  Quad total() const { return kinetic + spring + wall + weight; }
};

struct DamperEnergy {
  Quad initial, final;    // kinetic
  Quad contact_loss = 0;  // compliant walls: in contacts that no impact began
  Quad chatter_loss = 0;  // rigid walls: in the impacts beyond the last one listed of a complete chattering
  Quad friction_loss = 0, drag_loss = 0;
};

enum class Stop { time, amplitude, effort };

struct Answer {
  Stop stop = Stop::time;
  Quad end_time = 0;
  std::vector<Impact> impacts;
  std::vector<Contact> contacts;
  std::vector<HalfCycle> half_cycles;
  std::vector<Sample> samples;  // up to the end
  Energy initial{}, final{};
  std::vector<DamperEnergy> dampers;
  Quad viscous_work = 0, forcing_work = 0;
  // The sum of |work| of the force over steps: what rounding errors of the work are measured by.
  Quad turnover = 0;
  std::int64_t steps = 0;

  bool complete() const { return stop != Stop::effort; }
  Quad impact_loss() const;                  // of all impacts
  Quad sum(Quad DamperEnergy::*term) const;  // of all dampers
  Quad losses() const;
  Quad residual() const;  // of the energy balance
};

Answer answer_to(const Question& question);

std::string text(Quad number, int digits = 25);
// One event a line, in order of time, then the energies.
std::string lines_of(const Answer& answer);

}  // namespace oracle
