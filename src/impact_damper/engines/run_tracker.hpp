// What both closed-form engines share. A run is a chain of motions; this class reads off each of them the
// zero crossings and peaks of x, the samples, the work, and where the run ends.
//
// Observing never changes the motion: a motion is restarted at its own events only.
#pragma once

#include <optional>

#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/motion.hpp"

namespace impact_damper {

// Time since the release, summed over thousands of motions with what each sum rounded off carried along.
template <class Real>
class Clock {
 public:
  const Real& now() const { return now_; }
  Real after(const Real& duration) const { return now_ + (duration + rounded_off_); }
  void advance(const Real& duration) {
    const Real added = duration + rounded_off_, sum = now_ + added;
    const Real back = sum - now_;
    rounded_off_ = (now_ - (sum - back)) + (added - back);
    now_ = sum;
  }

 private:
  Real now_{0}, rounded_off_{0};
};

template <class Real, class Force, class Observer>
class RunTracker {
 public:
  RunTracker(const Scene& scene, const System<Real, Force>& system, const Budget& budget,
             std::int64_t max_steps, Observer& observer)
      : scene_(scene),
        system_(system),
        budget_(budget),
        observer_(observer),
        horizon_(horizon_of(scene, budget)),
        search_{bounded_span(system), max_steps},
        tracks_half_cycles_(observer.wants_half_cycles() || scene.until_amplitude.has_value()) {}

  const Real& now() const { return clock_.now(); }
  Real remaining() const { return Real(horizon_.end_time) - clock_.now(); }
  const std::optional<StopReason>& stopped() const { return stopped_; }
  // When the run ended: exactly the time asked for if that ended it.
  double end_time() const { return timed_out_ ? horizon_.end_time : double(clock_.now()); }
  Search<Real>& search() { return search_; }

  void begin(const State<Real>& start, const Real& depth) {
    row_best_ = absolute(start.x);
    if (observer_.wants_energy()) observer_.energy_balance().initial = energy_of(system_, start, depth);
  }

  // Lets `duration` of a motion pass, less if the scene ends in it, which `end` is then taken back to.
  // Returns the works in it.
  template <MotionOf<Real> Motion>
  [[gnu::always_inline]] Work<Real> pass(const Motion& motion, Real duration, State<Real>& end,
                                         const Real& wall_damping) {
    if (search_.exhausted()) {  // the end of the motion may not have been found
      stopped_ = StopReason::step_budget;
      duration = 0;
      end = motion.at(duration);
    } else if (!(duration < remaining())) {
      duration = remaining();
      stopped_ = horizon_.stop_reason;
      timed_out_ = true;
      end = motion.at(duration);
    }
    if (tracks_half_cycles_ && duration > 0) {
      const Real ends = follow(motion, duration, end);
      if (ends < duration) end = motion.at(ends);
      duration = ends;
    }
    // Compared in double precision, as times are recorded: a sample asked for at an event's time is given.
    const double until = timed_out_ ? horizon_.end_time : double(clock_.after(duration));
    while (observer_.next_sample() <= until) {
      Real t = Real(observer_.next_sample()) - now();
      if (t < 0) t = 0;
      const State<Real> s = motion.at(t < duration ? t : duration);
      observer_.sample(observer_.next_sample(), double(s.x), double(s.v), double(s.y), double(s.w));
    }
    Work<Real> works;
    if (observer_.wants_energy()) {
      works = work_of(system_, motion, now(), duration, wall_damping, search_);
      viscous_ += works.viscous;
      forcing_ += works.forcing;
      turnover_ += works.turnover;
    }
    clock_.advance(duration);
    passed_ = duration;
    return works;
  }
  // How much of the last motion has passed.
  const Real& passed() const { return passed_; }

  // An impact that is about to happen, in state `s`. False: it was one too many, and the scene ends before
  // it.
  bool impact(Wall wall, const State<Real>& s) {
    if (impacts_ >= budget_.max_impacts) {
      stopped_ = StopReason::impact_budget;
      return false;
    }
    ++impacts_;
    observer_.impact(double(now()), wall, double(s.w), double(s.x));
    return true;
  }

  void finish(const State<Real>& last, const Real& depth, const Real& losses) {
    if (!observer_.wants_energy()) return;
    EnergyBalance& balance = observer_.energy_balance();
    balance.final = energy_of(system_, last, depth);
    balance.viscous_work = double(viscous_);
    balance.forcing_work = double(forcing_);
    const Real handled = balance.initial.total() + turnover_;
    const Real open = (balance.initial.total() + forcing_) - (balance.final.total() + losses + viscous_);
    balance.residual = handled > 0 ? double(open / handled) : 0.0;
  }

 private:
  // Follows x through [0, duration]: returns where the scene ends in it, or duration.
  template <MotionOf<Real> Motion>
  [[gnu::always_inline]] Real follow(const Motion& motion, const Real& duration, const State<Real>& end) {
    Real from{0};
    if (side_ == 0 && !find_side(motion, duration, from)) return duration;
    return follow_rows(motion, duration, end, from);
  }
  // Which way x goes that has not moved until now: its first derivative that is not zero tells. False: none.
  template <MotionOf<Real> Motion>
  bool find_side(const Motion& motion, const Real& duration, Real& from) {
    const auto leads = motion.leads_of_x();
    std::size_t order = 0;
    while (order < 4 && leads[order] == 0) ++order;
    if (order == 4) return false;
    side_ = leads[order] > 0 ? 1 : -1;
    if (order == 3) {
      const Real fourth = motion.derivative_of_x(1, side_, from, search_.span).whole.third;
      const Real leap = begin_by_third<Real>(leads[order], fourth, search_.span);
      from = leap < duration ? leap : duration;
    }
    return true;
  }
  // From a time on, up to which the row under way has been followed.
  template <MotionOf<Real> Motion>
  [[gnu::always_inline]] Real follow_rows(const Motion& motion, const Real& duration, const State<Real>& end,
                                          Real from) {
    notice_peak(side_ * motion.at(from).x, from);
    const Real v = side_ * motion.at(from).v;
    bool rising = v > 0 || (v == 0 && motion.derivative_of_x(1, side_, from, search_.span).whole.g1 > 0);
    // What the ends already exclude is not searched for.
    bool may_turn = !motion.keeps_course(row_best_, end, duration);
    bool may_cross = !motion.keeps_side(side_, end, duration);
    Real no_turn_before = from;
    if (!may_turn && !may_cross) return duration;
    // A zero of x within (M7.1) of a motion's end is the next motion's: an impact there may throw x back, and
    // then the signs of x and x' tell whether it crosses.
    const Real at_speed = absolute(motion.at(Real(0)).x / end.v), scale = at_speed < 1 ? at_speed : Real(1);
    const Real last = duration - 16 * std::numeric_limits<Real>::epsilon() * (duration + scale);
    for (;;) {
      std::optional<Real> crossing;
      if (may_cross) crossing = motion.falls(0, side_, from, last, search_);
      const Real until = crossing ? *crossing : duration;
      if (may_turn && no_turn_before <= until) find_peaks(motion, from, until, rising, no_turn_before);
      if (search_.exhausted()) {
        stopped_ = StopReason::step_budget;
        timed_out_ = false;
        return from;
      }
      if (!crossing) return duration;
      from = *crossing;
      const Real zero = clock_.after(from);
      observer_.half_cycle(double(row_begin_), double(zero), double(row_peak_time_), double(row_best_));
      ++rows_;
      const bool low = scene_.until_amplitude && row_best_ < *scene_.until_amplitude;
      if (low || rows_ >= budget_.max_half_cycles) {
        stopped_ = low ? StopReason::amplitude : StopReason::half_cycle_budget;
        timed_out_ = false;
        return from;
      }
      side_ = -side_;
      row_begin_ = zero;
      row_best_ = 0;
      row_peak_time_ = zero;
      rising = true;
      // That x stays below the best of the row holds for the row that has ended, not for this one.
      may_turn = may_turn || !motion.keeps_course(row_best_, end, duration);
      may_cross = !motion.leaves_zero(from, end, duration);
    }
  }
  // The largest |x| of a row is where x' changes sign inside a motion, or where two motions meet.
  template <MotionOf<Real> Motion>
  void find_peaks(const Motion& motion, Real from, const Real& until, bool rising, Real& no_turn_before) {
    for (;;) {
      const Real sign = rising ? side_ : -side_;
      const auto turn = motion.falls(1, sign, from, until, search_);
      if (!turn) return;
      if (rising) notice_peak(motion.height(*turn), *turn);
      no_turn_before = *turn + motion.one_zero_within(*turn);
      if (until < no_turn_before) return;
      rising = !rising;
      from = *turn;
    }
  }
  void notice_peak(const Real& height, const Real& t) {
    if (!(height > row_best_)) return;
    row_best_ = height;
    row_peak_time_ = now() + t;
  }

  const Scene& scene_;
  const System<Real, Force>& system_;
  const Budget& budget_;
  Observer& observer_;
  Clock<Real> clock_;
  Outcome horizon_;  // if nothing else ends the scene before
  Search<Real> search_;
  bool tracks_half_cycles_;
  std::optional<StopReason> stopped_;
  bool timed_out_ = false;  // by the horizon
  Real passed_{0};
  std::int64_t impacts_ = 0, rows_ = 0;
  // The half cycle that is under way: on which side of zero x is (0: x has not moved yet), since when, and
  // its largest |x| so far.
  Real side_{0}, row_begin_{0}, row_best_{0}, row_peak_time_{0};
  Real viscous_{0}, forcing_{0}, turnover_{0};
};

}  // namespace impact_damper
