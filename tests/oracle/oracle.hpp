// The oracle: what happens in a scene, by quadruple precision and Taylor series of the equations of motion.
//
// It shares nothing with the engines. In each regime (flight, contact, stuck) the differential equations are
// linear, so that Taylor's coefficients follow from each other by them; a step is so long that 50 terms leave
// less than a rounding, and events are the roots of the step's polynomials, isolated with proof
// (polynomial.hpp). The cavity is looked at from the wall that was touched last: a motion at the right wall
// is the mirrored one.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "impact_damper/run.hpp"
#include "polynomial.hpp"

namespace oracle {

enum class Walls { compliant, rigid };

struct Question {
  impact_damper::Scene scene;  // both stops are obeyed; one must be given
  Walls walls = Walls::compliant;
  impact_damper::Calibration calibration = impact_damper::Calibration::fixed_wall;
  std::vector<double> samples;  // times, ascending
  // Every number of the scene, and the state and the time at each event and step, are changed by up to this
  // part of themselves, by random numbers of `seed`.
  double noise = 0;
  std::uint64_t seed = 0;
  std::int64_t most_steps = 400;
  std::int64_t most_impacts = 4000;
};

struct Impact {
  Quad time;
  impact_damper::Wall wall;
  Quad relative_velocity;  // y' just before
  Quad loss;
  Quad displacement;                 // x
  std::optional<Quad> accumulation;  // rigid walls: when the chattering that it belongs to is complete
};

struct Contact {  // as in impact_damper::Contacts
  Quad begin, end;
  impact_damper::Wall wall;
  Quad end_speed = 0;  // at its end |y'| or, released from a rigid wall, (1 + nu) |x'''|
};

struct HalfCycle {
  Quad zero_crossing, peak_time, amplitude;
  Quad speed = 0;  // |x'| at the crossing
};

struct Sample {
  Quad x, v, y, w;
  bool in_contact;  // compliant walls
};

struct Energy {
  Quad kinetic, spring, wall, paper;
  Quad total() const { return kinetic + spring + wall; }
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
  Quad contact_loss = 0;  // compliant walls: in contacts that no impact began
  Quad chatter_loss = 0;  // rigid walls: in the impacts beyond the last one listed of a complete chattering
  Quad viscous_work = 0, forcing_work = 0;
  Quad forcing_turnover =
      0;  // the sum of |work| over steps: what rounding errors of the work are measured by
  std::int64_t steps = 0;
};

Answer answer_to(const Question& question);

}  // namespace oracle
