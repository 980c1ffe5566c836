// Proofs about x in a motion, from both its ends and bounds on derivatives of x.
#pragma once

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

// Base class of a Motion, with the proofs that `MotionOf` (motion.hpp) asks for. Each is true if what it says
// is proved for all times from 0, the beginning, to t, when the state is `end`, and false if it is not known.
// Motion has x and x' at the beginning, start_x() and start_v(), and bounds on |x''| and |x'''| over [0, t],
// second_of_x(t) and third_of_x(t).
template <class Motion, class Real>
class ProofsByBounds {
 public:
  // x keeps the sign of `side`, 1 or -1.
  bool keeps_side(const Real& side, const State<Real>& end, const Real& t) const {
    const Real x = motion().start_x();
    return side * x > 0 && side * end.x > 0 && keeps_sign(x, end.x, motion().second_of_x(t), t);
  }
  // x' keeps its sign, or |x| does not exceed `best`, the largest |x| so far in the half cycle.
  bool keeps_course(const Real& best, const State<Real>& end, const Real& t) const {
    const Real v = motion().start_v();
    if (v * end.v > 0 && keeps_sign(v, end.v, motion().third_of_x(t), t)) return true;
    const Real off = motion().second_of_x(t) * t * t / 8;
    return absolute(Real(motion().start_x())) + off <= best && absolute(end.x) + off <= best;
  }
  // x, zero at `from`, 0 <= from <= t, has no other zero until t.
  bool leaves_zero(const Real& from, const State<Real>& end, const Real& t) const {
    return t < from + motion().one_turn_within(from) ||
           absolute(end.v) > motion().second_of_x(t) * (t - from);
  }
  // Returns a time after `from` within which x' has at most one zero; 0, as here, if none is known.
  Real one_turn_within(const Real&) const { return 0; }

 private:
  const Motion& motion() const { return static_cast<const Motion&>(*this); }
};

}  // namespace impact_damper
