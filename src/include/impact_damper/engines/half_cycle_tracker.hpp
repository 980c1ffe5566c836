// The half cycles of x. HalfCycleTracker takes peaks and zero crossings and knows no motion; follow_x() finds
// these in a motion, in their order.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/motion/motion.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// The half cycle that is under way: on which side of zero x is, since when, and its largest |x| so far.
template <class Real>
class HalfCycleTracker {
 public:
  explicit HalfCycleTracker(const Real& x0) : amplitude_(absolute(x0)) {}

  // Returns 1 or -1; 0 while x has not moved since the release.
  const Real& side() const { return side_; }
  const Real& amplitude() const { return amplitude_; }

  void take_side(const Real& side) { side_ = side; }
  // Takes |x| = `height` at a turning point of x or an end of a motion: the largest of the half cycle is
  // kept.
  void peak(const Real& height, const Real& time) {
    if (!(height > amplitude_)) return;
    amplitude_ = height;
    peak_time_ = time;
  }
  // Takes a zero crossing of x: one half cycle is complete, and is reported if the observer wants it; the
  // next begins.
  template <class Observer>
  void crossing(const Real& time, Observer& observer) {
    if (observer.wants_half_cycles())
      observer.half_cycle(double(begin_), double(time), double(peak_time_), double(amplitude_));
    last_amplitude_ = amplitude_;
    ++complete_;
    side_ = -side_;
    begin_ = peak_time_ = time;
    amplitude_ = 0;
  }
  // Returns why a run ends with the half cycle completed last, if it does.
  std::optional<StopReason> stops(const std::optional<double>& until_amplitude, const Budget& budget) const {
    if (until_amplitude && last_amplitude_ < Real(*until_amplitude)) return StopReason::amplitude;
    if (complete_ >= budget.max_half_cycles) return StopReason::half_cycle_budget;
    return {};
  }

 private:
  Real side_{0}, begin_{0}, amplitude_, peak_time_{0}, last_amplitude_{0};
  std::int64_t complete_ = 0;
};

// Sets the side of zero on which x is from a release on: the sign of the first of x, x', x'' and x''' that is
// not zero. In flight and in sticking no later one is needed, as a release is at phase 0 of the force: x'''
// is f0 omega_f. Returns the time from which on events of x are looked for. Returns nothing where x does not
// move, or in a contact moves by a derivative later than x''': then the next motion decides.
template <class Real, MotionOf<Real> Motion>
std::optional<Real> leave_zero(const Motion& motion, const Real& duration,
                               HalfCycleTracker<Real>& half_cycles, const Search<Real>& search) {
  const auto leads = motion.leads_of_x();
  std::size_t order = 0;
  while (order < 4 && leads[order] == 0) ++order;
  if (order == 4) return {};
  half_cycles.take_side(leads[order] > 0 ? 1 : -1);
  if (order < 3) return Real(0);
  const Real fourth = motion.derivative_of_x(1, half_cycles.side(), Real(0), search.span).whole.third;
  const Real begin = begin_by_lead<Real>(3, leads[order], fourth, search.span);
  return begin < duration ? begin : duration;
}

// Finds the peaks of the half cycle under way in [from, until): where x' changes its sign. Sets
// `no_turn_before`, the time before which no further turning point of x is possible.
template <class Real, MotionOf<Real> Motion>
void find_peaks(const Motion& motion, Real from, const Real& until, bool rising, const Real& now,
                HalfCycleTracker<Real>& half_cycles, Search<Real>& search, Real& no_turn_before) {
  for (;;) {
    const Real& side = half_cycles.side();
    const auto turn = motion.falls(1, rising ? side : Real(-side), from, until, search);
    if (!turn) return;
    if (rising) half_cycles.peak(motion.height(*turn), now + *turn);
    no_turn_before = *turn + motion.one_turn_within(*turn);
    if (until < no_turn_before) return;
    rising = !rising;
    from = *turn;
  }
}

// Feeds the tracker with the events of x, in their order, in [0, duration] of a motion that begins at the
// time `now` and is in the state `end` at last. At each zero crossing goes_on(t) is called, which completes
// the tracker's half cycle at t and says whether the scene goes on. Returns how much of the motion has been
// followed: less than `duration` where the scene ends, or where the search has no steps left.
template <class Real, MotionOf<Real> Motion, class GoesOn>
[[gnu::always_inline]] inline Real follow_x(const Motion& motion, const Real& duration,
                                            const State<Real>& end, const Real& now,
                                            HalfCycleTracker<Real>& half_cycles, Search<Real>& search,
                                            GoesOn&& goes_on) {
  Real from{0};
  if (half_cycles.side() == 0) {
    const auto begins = leave_zero(motion, duration, half_cycles, search);
    if (!begins) return duration;
    from = *begins;
  }
  // |x| may be largest where two motions meet.
  half_cycles.peak(half_cycles.side() * motion.at(from).x, now + from);
  const Real v = half_cycles.side() * motion.at(from).v;
  bool rising =
      v > 0 || (v == 0 && motion.derivative_of_x(1, half_cycles.side(), from, search.span).whole.g1 > 0);
  // Events that the ends already exclude are not searched for.
  bool may_turn = !motion.keeps_course(half_cycles.amplitude(), end, duration);
  bool may_cross = !motion.keeps_side(half_cycles.side(), end, duration);
  if (!may_turn && !may_cross) return duration;
  Real no_turn_before = from;
  // A zero of x within (M7.1) of a motion's end is the next motion's: an impact there may throw x back, and
  // then the signs of x and x' decide whether it crosses.
  const Real at_speed = absolute(motion.at(Real(0)).x / end.v), scale = at_speed < 1 ? at_speed : Real(1);
  const Real last = duration - 16 * std::numeric_limits<Real>::epsilon() * (duration + scale);
  for (;;) {
    std::optional<Real> crossing;
    if (may_cross) crossing = motion.falls(0, half_cycles.side(), from, last, search);
    const Real until = crossing ? *crossing : duration;
    if (may_turn && no_turn_before <= until)
      find_peaks(motion, from, until, rising, now, half_cycles, search, no_turn_before);
    if (search.exhausted()) return from;
    if (!crossing) return duration;
    from = *crossing;
    if (!goes_on(from)) return from;
    rising = true;
    // A proof that |x| stays below the largest of its half cycle held only for the one that has ended.
    may_turn = may_turn || !motion.keeps_course(half_cycles.amplitude(), end, duration);
    may_cross = !motion.leaves_zero(from, end, duration);
  }
}

}  // namespace impact_damper
