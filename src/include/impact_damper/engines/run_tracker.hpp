// The common part of the closed-form engines. A run is a chain of motions; RunTracker finds in each of them
// the half cycles of x (half_cycle_tracker.hpp), the samples, the work, and where the run ends.
//
// Observing never changes the motion: a motion is restarted at its own events, and a flight under a force at
// the ends of its pieces, only.
#pragma once

#include <memory>
#include <optional>

#include "impact_damper/engines/half_cycle_tracker.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/motion.hpp"

namespace impact_damper {

// Time since the release, summed over thousands of motions with the rounding error of each sum carried along.
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
        tracks_half_cycles_(observer.wants_half_cycles() || scene.until_amplitude.has_value()),
        half_cycles_(Real(scene.x0)) {}

  const Real& now() const { return clock_.now(); }
  Real remaining() const { return Real(horizon_.end_time) - clock_.now(); }
  const std::optional<StopReason>& stopped() const { return stopped_; }
  // The time up to which the run has been followed: exactly the time asked for if that ended it.
  double time() const { return timed_out_ ? horizon_.end_time : double(clock_.now()); }
  // How the run ended, once it has stopped.
  Outcome outcome() const { return {*stopped_, time()}; }
  Search<Real>& search() { return search_; }

  // Begin and end the energy balance, if it is wanted. losses: of all impacts and contacts.
  void begin(const State<Real>& start, const Real& depth) {
    if (observer_.wants_energy()) begin(energy_of(system_, start, depth));
  }
  void begin(const Energy& energy) { observer_.energy_balance().initial = energy; }

  // Advances the run by `duration` of a motion, less if the scene ends in it; `end` is then the state at that
  // time. Returns the work done in it. report_sample(t) reports the next sample, at the time t of the motion.
  template <MotionOf<Real> Motion, class ReportSample>
  [[gnu::always_inline]] Work<Real> pass(const Motion& motion, Real duration, State<Real>& end,
                                         const Real& wall_damping, ReportSample&& report_sample) {
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
      const Real followed = follow_x(motion, duration, end, now(), half_cycles_, search_, [&](const Real& t) {
        half_cycles_.crossing(clock_.after(t), observer_);
        return !ended_by_half_cycle();
      });
      if (followed < duration) {
        if (search_.exhausted()) stop(StopReason::step_budget);
        end = motion.at(followed);
      }
      duration = followed;
    }
    report_samples(duration, report_sample);
    const Work<Real> works =
        observer_.wants_energy() ? add_work(motion, duration, wall_damping) : Work<Real>{};
    if constexpr (requires { observer_.passed(now(), duration, end); })
      observer_.passed(now(), duration, end);
    clock_.advance(duration);
    passed_ = duration;
    return works;
  }
  // The same for a single damper.
  template <MotionOf<Real> Motion>
  [[gnu::always_inline]] Work<Real> pass(const Motion& motion, const Real& duration, State<Real>& end,
                                         const Real& wall_damping) {
    return pass(motion, duration, end, wall_damping, [&](const Real& t) {
      const State<Real> s = motion.at(t);
      observer_.sample(observer_.next_sample(), double(s.x), double(s.v), double(s.y), double(s.w));
    });
  }
  // The time by which the last motion was followed.
  const Real& passed() const { return passed_; }

  // Reports an impact that is about to happen, in state `s`. Returns false if that is one too many: the scene
  // then ends before it.
  bool impact(Wall wall, const State<Real>& s) {
    if (!has_room_for(1)) return false;
    observer_.impact(double(now()), wall, double(s.w), double(s.x));
    return true;
  }
  // Counts several impacts at one instant and reports none. Returns false, and the scene ends, if they are
  // too many.
  bool has_room_for(std::int64_t impacts) {
    if (impacts > budget_.max_impacts - impacts_) {
      stopped_ = StopReason::impact_budget;
      return false;
    }
    impacts_ += impacts;
    return true;
  }

  void finish(const State<Real>& last, const Real& depth, const Real& losses) {
    if (observer_.wants_energy()) finish(energy_of(system_, last, depth), losses);
  }
  void finish(const Energy& energy, const Real& losses) {
    EnergyBalance& balance = observer_.energy_balance();
    balance.final = energy;
    balance.viscous_work = double(viscous_);
    balance.forcing_work = double(forcing_);
    balance.reactive_work = double(reactive_);
    // Counted from the least energy that there is: the weight draws x down to -gamma sigma at y = 0.
    const Real sunk = Real(scene_.weight) * Real(secondary_mass(scene_));
    const Real handled = balance.initial.total() + sunk * sunk / 2 + turnover_;
    const Real open = (balance.initial.total() + forcing_) - (balance.final.total() + losses + viscous_);
    balance.residual = handled > 0 ? double(open / handled) : 0.0;
  }

 private:
  template <class ReportSample>
  [[gnu::always_inline]] void report_samples(const Real& duration, ReportSample&& report_sample) {
    // Compared in double precision, as times are recorded: a sample asked for at an event's time is reported.
    const double until = timed_out_ ? horizon_.end_time : double(clock_.after(duration));
    while (observer_.next_sample() <= until) {
      Real t = Real(observer_.next_sample()) - now();
      if (t < 0) t = 0;
      if (!(t < duration)) t = duration;
      report_sample(t);
    }
  }
  template <MotionOf<Real> Motion>
  Work<Real> add_work(const Motion& motion, const Real& duration, const Real& wall_damping) {
    const Work<Real> works = work_of(system_, motion, now(), duration, wall_damping, search_);
    viscous_ += works.viscous;
    forcing_ += works.forcing;
    reactive_ += works.reactive;
    turnover_ += works.turnover;
    return works;
  }
  bool ended_by_half_cycle() {
    const auto reason = half_cycles_.stops(scene_.until_amplitude, budget_);
    if (reason) stop(*reason);
    return reason.has_value();
  }
  void stop(StopReason reason) {
    stopped_ = reason;
    timed_out_ = false;
  }

  const Scene& scene_;
  const System<Real, Force>& system_;
  const Budget& budget_;
  Observer& observer_;
  Clock<Real> clock_;
  Outcome horizon_;  // the end, if nothing else ends the scene before
  Search<Real> search_;
  bool tracks_half_cycles_;
  HalfCycleTracker<Real> half_cycles_;
  std::optional<StopReason> stopped_;
  bool timed_out_ = false;  // by the horizon
  Real passed_{0};
  std::int64_t impacts_ = 0;
  Real viscous_{0}, forcing_{0}, reactive_{0}, turnover_{0};
};

// Follows a flight that begins now in `state`, in pieces (Flight::length()), until it meets a wall. Returns
// the wall, and sets `state` to that at the impact. Returns nothing where the run has stopped before.
// released: from rest on a wall. The flight becomes each of its pieces in turn.
template <class Real, class Force, class Observer>
[[gnu::always_inline]] inline std::optional<Wall> pass_flight(const System<Real, Force>& system,
                                                              RunTracker<Real, Force, Observer>& tracker,
                                                              Flight<Real, Force>& flight, State<Real>& state,
                                                              bool released) {
  if constexpr (!ForcedMotion<Real, Force>::forced) {  // one piece: without the loop a decay takes 2 % less
    const auto met = released ? flight.released_meets_wall(tracker.remaining(), tracker.search())
                              : flight.next_wall(tracker.remaining(), tracker.search());
    if (met) state = copied(met->state);
    tracker.pass(flight, met ? met->time : tracker.remaining(), state, Real(0));
    return tracker.stopped() ? std::nullopt : std::optional(met->wall);
  }
  FlightStart<Real> rest(state);
  while (true) {
    const Real remaining = tracker.remaining(), length = flight.length();
    const Real until = length < remaining ? length : remaining;
    const auto met = released ? flight.released_meets_wall(until, tracker.search())
                              : flight.next_wall(until, tracker.search());
    if (met) {
      state = copied(met->state);
    } else if (until < remaining) {
      rest = flight.start_of_rest(until);
      state = copied(rest.state);
    }
    tracker.pass(flight, met ? met->time : until, state, Real(0));
    if (tracker.stopped()) return {};
    if (met) return met->wall;
    // Constructed in its place: an optional flight beside it would be cleared, 600 bytes, before each flight.
    std::construct_at(&flight, system, tracker.now(), rest);
    released = false;
  }
}

}  // namespace impact_damper
