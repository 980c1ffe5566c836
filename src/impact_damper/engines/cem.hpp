// The component element method: the paper's way of running a scene, equations (3)-(8) by central
// differences with a fixed step h (cem_scheme.hpp), after a second-order start from the initial state. With
// `stuck_speed` the paper's (9) as well, corrected (M9.5): an impact slower
// than that, with the wall pushing, joins both masses with their momentum kept, until x'' changes its sign.
//
// Contact. As then, the sign of the overlap at a step decides which equations make the next one, so touch
// and release come up to h late. With a damper in the wall, whose force jumps at touch, this makes the
// delivered restitution, and all that follows from it, accurate to first order in h only. With `locate`
// touch and release are put where the parabola through the three steps around them meets the wall: the
// method steps exactly onto the event and starts anew from there, and is of second order (first with the
// lagged damper). Two crossings of a wall within one step are not seen. Where the masses join or part the
// motion begins anew, so these two events are located in any case, the second by a straight line through x''.
//
// With `large_step` the steps are small only near contact (cem_rates.hpp).
//
// Observations (zero crossing, peak, history, and touch and release without `locate`) are read off the
// parabola through three steps, errors O(h^3) in position and O(h^2) in velocity. Times are counted, n h
// from the start, the last located event or the last change of step, not accumulated.
//
// Observing changes nothing. A segment is the sequence of equal steps since the start, the last located event
// or the last change of step. Within it, whatever steps carry on from one to the next (the recurrence of the
// force, the sums of the works, the number of steps until a step size is chosen) is renewed at fixed step
// numbers or where the regime changes, never where the loop over steps was left in order to look. Crossings
// and peaks are followed whether or not they are recorded, because they count against the limit on looks;
// which step a time lies in follows from the segment alone. So the motion, the energy balance and the stop
// are functions of scene and options, and a run that ends earlier is the beginning of a longer one.
//
// Energy. The scheme conserves |d/h|^2_M / 2 + u_n.K u_{n+1} / 2 within a regime but for the sums
// of damping and forcing power at the steps, so those sums are the energy balance's losses. The residual
// holds what this form of the energy differs from the true one by, O(h^2); it is no measure of the
// first-order error.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/cem_scheme.hpp"
#include "impact_damper/engines/observer.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/math/scalar.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/forced_motion.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// The options with the step filled in if absent: a hundredth of the nominal contact time, or of half a
// period of the primary mass or of the forcing where that is shorter; of a list, of the stiffest wall.
Cem resolved(const Scene& scene, Cem options);

// What is wrong with the (resolved) options: each by itself (engine.hpp), then, if nothing, a stuck speed
// beside a list of dampers; a step beyond the stability limit without `unstable`; a large step that is no
// larger, beyond the limit in flight, or longer than half a period of the forcing. Empty if nothing.
std::vector<Problem> problems_of(const Scene& scene, const Cem& options);

[[noreturn]] void fail_of_overflow(double time, double step);
// Rounded up, 1 at least and 1e15 at most.
std::int64_t whole_steps(double steps);
// The largest whole multiple of h that is at most `step`, where that is told.
template <class Real>
Real multiple_of(const Real& h, const Real& step) {
  const Real steps = step / h;
  return steps < 1e15 ? Real(std::int64_t(steps)) * h : step;
}

// The parabola through three successive steps of one coordinate, about the middle one.
template <class Real>
struct Arc {
  Real g, slope, bend;

  Real at(const Real& t) const { return g + t * (slope + t * bend / 2); }
  Real slope_at(const Real& t) const { return slope + t * bend; }
  Arc times(const Real& factor) const { return {factor * g, factor * slope, factor * bend}; }

  // Where in [0, h] an arc that begins at or above zero falls through it.
  Real fall(const Real& h) const {
    const Real square = slope * slope - 2 * bend * g;
    const Real root = square > 0 ? square_root(square) : Real(0);
    if (slope > 0) return bend < 0 ? std::clamp((slope + root) / -bend, Real(0), h) : h;
    return root > slope ? std::clamp(2 * g / (root - slope), Real(0), h) : Real(0);
  }
  // Where in [from, to] its extremum lies, or the end nearest to it; `from` where rounding has `to` before
  // it.
  Real extremum(const Real& from, const Real& to) const {
    return bend == 0 || !(from < to) ? from : std::clamp(-slope / bend, from, to);
  }
};

// The scheme's v_n from the motion's own velocity V of x, and back (cem_rates.hpp).
template <class Real>
struct OwnVelocity {
  Real zeta;
  Forcing<Real> force;
  Real stiffness;  // divided by the mass that moves

  Real to_scheme(const Real& x, const Real& own, const Real& time, const Real& h) const {
    return turn(h) * own + lag(x, own, time, h);
  }
  Real from_scheme(const Real& x, const Real& v, const Real& time, const Real& h) const {
    return (v - lag(x, v, time, h)) / turn(h);
  }

 private:
  Real turn(const Real& h) const { return square_root(1 - stiffness * h * h / 4); }
  Real lag(const Real& x, const Real& v, const Real& time, const Real& h) const {
    if (!force && zeta == 0) return 0;
    const Real& b = stiffness;
    const Real bend = b * (value_of(force, time) - 2 * zeta * v - x);
    return b * h * h / 6 * (rate_of(force, time) - 2 * zeta * bend);
  }
};

template <class Real, class Observer>
class CemEngine {
 public:
  // `options` resolved and free of problems.
  CemEngine(const Scene& scene, const Cem& options, Observer& observer);
  Outcome run();

 private:
  struct Moment {  // positions at a step, and the increments that led there
    Real x, q, dx, dq;
  };

  void begin_segment(const Real& time, const State<Real>& state);
  void lead_from_rest(const Real& bend, const Real& jerk);
  // The number of the step of this segment in which `time` lies; the first for earlier times.
  std::int64_t step_of(const Real& time) const { return whole_steps(double((time - origin_) / pace_.h)); }
  bool side_or_trend_unknown() const;
  std::int64_t steps_until_look() const;  // at least one
  void take_steps(std::int64_t most);     // at least one
  template <Regime regime, bool forced, bool balance>
  void take_steps(std::int64_t most);
  void look_at_last_step();
  void spend_look();
  std::optional<Real> wall_crossing() const;
  std::optional<Real> parting() const;
  bool joins(const Real& at) const;
  // `restart` at that time, with both masses one where they join.
  void change_regime(const Real& at, bool restart, bool joining);
  void enter(Wall wall, const Real& time, const State<Real>& s);
  State<Real> join(const State<Real>& s);
  void leave(const Real& time);
  // `span`: up to where the last step counts.
  void cross_zero(const Real& at, const Real& span);
  void consider_peak(const Real& from, const Real& to);
  void give_samples(const Real& until);  // those in the last step
  void finish(StopReason reason, const Real& at, bool by_horizon = false);

  // The last step spans [0, h] on the arcs' axis, from number step_ - 1 on.
  Real last_step_begin() const { return origin_ + Real(step_ - 1) * pace_.h; }
  Real last_step_end() const { return origin_ + Real(step_) * pace_.h; }
  Arc<Real> arc(Real Moment::*position, Real Moment::*increment) const {
    const Real &before = before_.*increment, &after = now_.*increment;
    return {before_.*position, (before + after) / (2 * pace_.h), (after - before) / (pace_.h * pace_.h)};
  }
  Arc<Real> x_arc() const { return arc(&Moment::x, &Moment::dx); }
  Arc<Real> q_arc() const { return arc(&Moment::q, &Moment::dq); }
  State<Real> state_at(const Real& at) const {
    const Arc<Real> x = x_arc(), q = q_arc();
    return {x.at(at), x.slope_at(at), origin_of_q() + q.at(at), q.slope_at(at)};
  }

  // The same with the velocities by the trapezoid of the accelerations, one order better than the slopes.
  State<Real> refined(State<Real> s, const Real& at) const {
    const auto a = acceleration(last_step_begin() + at, s);
    const Arc<Real> x = x_arc(), q = q_arc();
    s.v = x.slope + at * (x.bend + a.x) / 2;
    s.w = q.slope + at * (q.bend + a.q) / 2;
    return s;
  }

  // Two rates (cem_rates.hpp).
  struct Rates {
    Pace<Real> large, pressed;
    std::int64_t steps_of_contact;  // small ones
  };
  std::int64_t choose_pace();
  std::int64_t choose_pace_in_flight();
  std::int64_t choose_pace_in_contact();
  void change_pace(const Pace<Real>& pace, const State<Real>& s);
  State<Real> of_scheme(State<Real> s, const Real& time, const Real& h) const;
  State<Real> flown(const Real& x, const Real& y, const Real& middle_v, const Real& middle_w,
                    const Real& time, const Real& h) const;
  OwnVelocity<Real> own_velocity() const {
    return {flight_.zeta, force_, wall_ ? 1 / (1 + flight_.nu) : Real(1)};
  }
  State<Real> motion_at(const Real& at) const;

  Real multiple_of_h(const Real& step) const { return multiple_of(small_.h, step); }
  Pace<Real> pace_of(const Real& h) const {
    return {h, cem_step(flight_, damper_, h), cem_step(contact_, damper_, h),
            cem_step_stuck(flight_.nu, flight_.zeta, h)};
  }

  Real push() const { return wall_ == Wall::left ? Real(1) : Real(-1); }  // of the wall on the mass
  Real origin_of_q() const { return wall_ == Wall::right ? Real(1) : Real(0); }
  auto acceleration(const Real& time, const State<Real>& s) const {
    if (stuck_) return joined_acceleration(time, s);
    return equations().acceleration(s.x, s.v, s.y - origin_of_q(), s.w, forcing(time));
  }
  typename RegimeEquations<Real>::Acceleration joined_acceleration(const Real& time,
                                                                   const State<Real>& s) const {
    return {(forcing(time) - 2 * flight_.zeta * s.v - s.x) / (1 + flight_.nu), Real(0)};
  }
  State<Real> joined(State<Real> s) const {
    s.v += flight_.nu / (1 + flight_.nu) * s.w;
    s.w = 0;
    return s;
  }
  // h^2 x'' at a step of the stuck regime.
  Real bend_of_stuck(const CemStep<Real>& a, const Moment& at, const Real& f) const {
    return (a.dx_dx - 1) * at.dx + a.dx_x * at.x + a.dx_f * f;
  }
  static Real sign(const Real& value) { return Real((value > 0) - (value < 0)); }
  const RegimeEquations<Real>& equations() const { return wall_ ? contact_ : flight_; }
  Real forcing(const Real& time) const { return value_of(force_, time); }
  Real forcing_rate(const Real& time) const { return rate_of(force_, time); }

  Energy energy(const State<Real>& state);
  void add_powers(const Real& weight, const Real& time, const State<Real>& state);
  void add_sums();
  void close_powers(const Real& at);

  const Budget budget_;
  const std::optional<double> until_amplitude_;
  const Outcome horizon_;  // if nothing else ends the scene before
  const Real end_time_;    // its
  const Damper damper_;
  const bool locate_;
  const std::optional<double> stuck_speed_;
  Observer& observer_;

  const System<Real> system_;
  const Forcing<Real> force_;
  const RegimeEquations<Real> flight_, contact_;
  const Pace<Real> small_;  // the time step
  const bool forced_, energy_balance_;
  const State<Real> initial_;

  std::optional<Rates> rates_;  // small_ beside them

  Pace<Real> pace_;          // of the steps since origin_
  Moment before_{}, now_{};  // the last step went from the one to the other
  Real origin_ = 0;          // time of step 0
  std::int64_t step_ = 0;    // number of now_
  std::int64_t steps_left_;  // until max_steps are done
  std::int64_t looks_left_;
  std::int64_t steps_at_pace_ = 0;  // with two rates: until the pace is chosen anew
  std::optional<Wall> wall_;        // in contact with it; then q is counted from it, else from the left one
  Real contact_begin_ = 0;
  bool impact_began_contact_ = false;
  bool stuck_ = false;  // in contact, both masses one

  Real side_ = 0;   // sign of x in this half cycle, 0 before x has moved
  Real trend_ = 0;  // sign of x' since the last turn
  Real row_begin_ = 0, peak_ = 0, peak_time_ = 0;
  std::int64_t impacts_ = 0, rows_ = 0;

  ForceAtSteps<Real> force_at_steps_;
  // Over steps not yet in the works below, of (2 h v)^2, (2 h w)^2 and f (2 h v), v and w centred.
  struct Sums {
    Real vv = 0, ww = 0, fv = 0;
  } sums_;
  Real wall_work_ = 0;  // in the contact under way
  Real viscous_work_ = 0, forcing_work_ = 0, losses_ = 0;
  double largest_energy_ = 0;
  std::optional<Outcome> end_;
};

// Runs the scene for an observer with the members of Recorder. Checks the options first: throws
// InvalidArguments with the problems; throws NumericalError where the numbers overflow.
template <Scalar Real = double, RunObserver Observer>
Outcome run_cem(const Scene& scene, const Cem& options, Observer& observer) {
  require_arithmetic();
  const Cem complete = resolved(scene, options);
  require_none(problems_of(scene, complete));
  return CemEngine<Real, Observer>(scene, complete, observer).run();
}

}  // namespace impact_damper

#include "impact_damper/engines/cem_engine.hpp"
#include "impact_damper/engines/cem_rates.hpp"
