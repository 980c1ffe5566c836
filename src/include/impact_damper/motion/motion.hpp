// A motion is one part of a run, between two of its events, in closed form: Flight, Stuck, JoinedMasses,
// ShiftedMotion, Contact, ContactWithoutModes, ShiftedContact or JointContact. All times are since the
// motion's beginning.
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/events/search.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

template <class T, class Real>
concept MotionOf = requires(const T motion, const Real& t, const State<Real>& end, std::size_t order,
                            Search<Real>& search) {
  { motion.at(t) } -> std::same_as<State<Real>>;
  // The first time in [from, until) at which sign times the `order`-th derivative of x, 0 or 1, falls through
  // zero: falls(order, sign, from, until, search).
  { motion.falls(order, t, t, t, search) } -> std::same_as<std::optional<Real>>;
  // Proofs from the ends alone. keeps_side(side, end, t): x keeps its sign in [0, t]; keeps_course(best, end,
  // t): x' keeps its sign, or |x| does not exceed `best` or the ends; leaves_zero(from, end, t): x, zero at
  // `from`, has no other zero until t.
  { motion.keeps_side(t, end, t) } -> std::same_as<bool>;
  { motion.keeps_course(t, end, t) } -> std::same_as<bool>;
  { motion.leaves_zero(t, end, t) } -> std::same_as<bool>;
  // A time after t within which x' has at most one zero; 0 where none is known.
  { motion.one_turn_within(t) } -> std::convertible_to<Real>;
  // |x| at a peak at t.
  { motion.height(t) } -> std::convertible_to<Real>;
  // x and its first three derivatives at the beginning; derivative_of_x(order, sign, t, span) encloses one
  // from t on.
  { motion.leads_of_x()[order] } -> std::convertible_to<Real>;
  { motion.derivative_of_x(order, t, t, t).whole.g } -> std::convertible_to<Real>;
  // The length of a quadrature panel that begins at t, and the shortest time in which x changes.
  { motion.panel(t) } -> std::convertible_to<Real>;
  { motion.resolution() } -> std::convertible_to<Real>;
};

// Base class of a Motion without closed forms for its events: it searches for them, and proves by bounds
// where there are none. Each proof is true if what it says is proved for all times from 0, the beginning, to
// t, when the state is `end`, and false if it is not known. Motion has x and x' at the beginning, start_x()
// and start_v(), and bounds on |x''| and |x'''| over [0, t], second_of_x(t) and third_of_x(t).
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
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            Search<Real>& search) const {
    const auto enclose = [&](const Real& t) { return motion().derivative_of_x(order, sign, t, search.span); };
    return isolate_fall<Real>(enclose, from, until, search, motion().resolution());
  }
  Real height(const Real& t) const { return absolute(motion().at(t).x); }

 private:
  const Motion& motion() const { return static_cast<const Motion&>(*this); }
};

}  // namespace impact_damper
