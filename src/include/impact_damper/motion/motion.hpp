// A motion is one part of a run, between two of its events, in closed form: Flight, Stuck, JoinedMasses,
// Contact, ContactWithoutModes or JointContact. All times are since the motion's beginning.
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>

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

}  // namespace impact_damper
