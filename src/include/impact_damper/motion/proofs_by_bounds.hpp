// Proofs about x in a motion, from both its ends and bounds on derivatives of x.
#pragma once

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

// The proofs that `MotionOf` (motion.hpp) asks for, of a Motion that has its x and x' at the beginning,
// start_x() and start_v(), and bounds on |x''| and |x'''| from there until t, second_of_x(t) and
// third_of_x(t).
template <class Motion, class Real>
class ProofsByBounds {
 public:
  bool keeps_side(const Real& side, const State<Real>& end, const Real& t) const {
    const Real x = motion().start_x();
    return side * x > 0 && side * end.x > 0 && keeps_sign(x, end.x, motion().second_of_x(t), t);
  }
  bool keeps_course(const Real& best, const State<Real>& end, const Real& t) const {
    const Real v = motion().start_v();
    if (v * end.v > 0 && keeps_sign(v, end.v, motion().third_of_x(t), t)) return true;
    const Real off = motion().second_of_x(t) * t * t / 8;
    return absolute(Real(motion().start_x())) + off <= best && absolute(end.x) + off <= best;
  }
  bool leaves_zero(const Real& from, const State<Real>& end, const Real& t) const {
    return t < from + motion().one_turn_within(from) ||
           absolute(end.v) > motion().second_of_x(t) * (t - from);
  }
  Real one_turn_within(const Real&) const { return 0; }  // no time is known

 private:
  const Motion& motion() const { return static_cast<const Motion&>(*this); }
};

}  // namespace impact_damper
