// Two rates (Cem::large_step): small steps h only while a wall may be met or left, steps of up to H in
// between. The members of CemEngine (cem.hpp) that choose the step and change it.
//
// Changing the step. d_n / h_n is the velocity in the middle of a step; half a step on, v_n = d_n / h_n +
// h_n u''_n / 2, and from there half a step with another h,
//     d_{n+1} / h_{n+1} = v_n + h_{n+1} u''_n / 2 = d_n / h_n + (h_n + h_{n+1}) u''_n / 2:
// central differences on unequal steps, and just what the scheme's own start from u_n, v_n does
// (begin_segment). A change costs a local error of (h_{n+1}^2 - h_n^2) u'''/8 in the velocity; h ends where
// it began, so these are differences, and the order remains 2.
//
// But they do not cancel. Central differences lead x'' + x = 0 round the ellipse x^2 + v_n^2 / (1 - h^2/4),
// so a change at v adds (h_{n+1}^2 - h_n^2) v^2 / 8 to the energy, in every half cycle with the same sign:
// with H = 0.05, up to a tenth of what the impacts take out at x0 = 6. What is handed on is therefore V = v_n
// / sqrt(1 - h^2/4), with which the ellipse is the true circle for any h, run through too fast by h^2/24.
// Damping and force add, by Taylor's theorem, v_n = ... + h^2 (f' - 2 zeta x'') / 6. Pressed to a wall both
// masses move as one, (1 + nu) x'' + ..., and each h^2 here is divided by 1 + nu. x' + y', which nothing
// changes in flight, is handed on as it is.
//
// The way to a wall. Where the next H is not certified free (Certificate, below) one step leads as far as the
// certificate goes. Nearing the wall these steps shorten quadratically; below a few h small ones take over.
// All steps, H as well, are rounded down to whole multiples of h: so without `locate` a touch falls anywhere
// in a small step, as with one rate. At the same place each time, release would come late by the same
// fraction of h each time too, since a contact lasts as long at any speed, and errors that now cancel would
// add up.
//
// Pressed to a wall for long, the mass rings until it follows the primary mass,
//     q_p = -(x'' + c w_p) / omega_m^2,   w_p = -x''' / omega_m^2,   x'', x''' of both masses as one.
// When the ringing is (omega_m h)^2 of q_p, the scheme's own relative error, steps of half the stability
// limit are as good: what is left of it dies away in these too. Small steps return before the mass is free.
// Joined to the primary mass (Cem::stuck_speed) it takes steps of H until they part.
#pragma once

#include <algorithm>

#include "impact_damper/engines/cem.hpp"

namespace impact_damper {

// What is sure about a flight that begins now: times in which no wall is met, neither by the motion nor by
// central differences.
//
// y'' = -x''. Only the force can feed x^2 + x'^2, so sqrt(x^2 + x'^2) <= S = (its value now) + |f0| s for s
// from now on, and
//     |x''| <= B = sqrt(1 + 4 zeta^2) S + |f0|,     |x'''| <= J = S + 2 zeta B + |f0| omega_f.
// With b = min(x'' + J s/3, B), but not below 0, y + y' t - b t^2/2 is below y(t) for all t in [0, s] and is
// concave (M9.4): if it is positive at s, the left wall is not met before. Likewise 1 - y and the right wall.
//
// The differences keep to the same bounds. With n steps h = s/n they have, J s^3/6 being the sum's limit,
//     y_n >= y + s (y' - |v_n - V|) - x'' s^2/2 - J s (s^2 - h^2)/6,   |v_n - V| <= J h^2/6,
// as |d_n / h| <= S for all n; only to B must be added what v_n and V differ by: b = min(., B + J h/3). That
// is exact for h <= 1.7 without damping and force, and with them but for terms of order h^4.
template <class Real>
class Certificate {
 public:
  // `now`, with the acceleration x2 of the primary mass, in flight; `step` > 0, the longest, <= `horizon`.
  Certificate(const Real& zeta, const Forcing<Real>& force, const State<Real>& now, const Real& x2,
              const Real& step, const Real& horizon, const Real& clearance = Real(1))
      : now_(now), clearance_(clearance), x2_(x2) {
    const Real f0 = absolute(force.amplitude);
    const Real swing = square_root(now.x * now.x + now.v * now.v) + f0 * horizon;
    const Real bend = square_root(1 + 4 * zeta * zeta) * swing + f0;
    jerk_ = swing + 2 * zeta * bend + f0 * force.frequency;
    most_ = bend + jerk_ * step / 3;
  }

  // No wall is met for s, at most the horizon.
  bool free_for(const Real& s) const { return left(s).at(s) > 0 && right(s).at(s) > 0; }
  // For how much of s none is met.
  Real free_time(const Real& s) const { return std::min(left(s).fall(s), right(s).fall(s)); }

 private:
  // Below the distances from the walls.
  Arc<Real> left(const Real& s) const { return {now_.y, now_.w, -bend(x2_, s)}; }
  Arc<Real> right(const Real& s) const { return {clearance_ - now_.y, -now_.w, -bend(-x2_, s)}; }
  Real bend(const Real& towards, const Real& s) const {
    return std::clamp(Real(towards + jerk_ * s / 3), Real(0), most_);
  }

  State<Real> now_;
  Real clearance_, x2_, jerk_, most_;
};

// The pace for what comes next, and for how many steps it is the right one.
template <class Real, class Observer>
std::int64_t CemEngine<Real, Observer>::choose_pace() {
  // A segment's first step tells what its motion is, but a contact's begins in small steps.
  if (step_ == 0) return wall_ && !stuck_ && pace_.h == small_.h ? rates_->steps_of_contact : 1;
  if (stuck_) {  // no wall is met, and x'' is seen at every step
    constexpr std::int64_t many = 16;
    change_pace(rates_->large, motion_at(pace_.h));
    return many;
  }
  return wall_ ? choose_pace_in_contact() : choose_pace_in_flight();
}

template <class Real, class Observer>
std::int64_t CemEngine<Real, Observer>::choose_pace_in_flight() {
  constexpr int many = 16, few = 4;
  const Real h = pace_.h, time = last_step_end(), zeta = flight_.zeta;
  const State<Real> s = flown(now_.x, now_.q, now_.dx / h, now_.dq / h, time, h);
  const Real bend = forcing(time) - 2 * zeta * s.v - s.x;

  const Real large = rates_->large.h;
  const Certificate<Real> sure(zeta, force_, s, bend, large, many * large);
  for (int steps = many; steps >= 1; steps /= 2) {
    if (!sure.free_for(steps * large)) continue;
    change_pace(rates_->large, s);
    return steps;
  }
  if (const Real step = multiple_of_h(sure.free_time(large)); step >= few * small_.h) {
    change_pace(pace_of(step), s);
    return 1;
  }
  change_pace(small_, s);
  return few;
}

template <class Real, class Observer>
std::int64_t CemEngine<Real, Observer>::choose_pace_in_contact() {
  const Real time = last_step_end();
  const bool just_begun = time - contact_begin_ < small_.h;
  if (just_begun && pace_.h == small_.h) return rates_->steps_of_contact;

  const State<Real> s = motion_at(pace_.h);
  const auto& [nu, zeta, c, omega_2] = contact_;
  const Real bend = (forcing(time) - 2 * zeta * s.v - s.x) / (1 + nu);
  const Real jerk = (forcing_rate(time) - 2 * zeta * bend - s.v) / (1 + nu);
  const Real w_pressed = -jerk / omega_2, q_pressed = -(bend + c * w_pressed) / omega_2;

  const Real q = s.y - origin_of_q(), dq = q - q_pressed, dw = s.w - w_pressed;
  const Real tolerance = omega_2 * small_.h * small_.h * q_pressed;
  const bool settled = dw * dw + omega_2 * dq * dq <= omega_2 * tolerance * tolerance;

  // Half as many steps as at this speed lead out of the wall.
  constexpr Real many = 64;
  const Real overlap = *wall_ == Wall::left ? -q : q, out = *wall_ == Wall::left ? s.w : -s.w;
  const Real per_step = 2 * out * rates_->pressed.h;
  const Real steps = overlap > many * per_step ? many : overlap / per_step;
  if (settled && steps >= 1) {
    change_pace(rates_->pressed, s);
    return std::int64_t(steps);
  }
  change_pace(small_, s);
  return rates_->steps_of_contact;
}

// From the last step on, with the motion's own state there.
template <class Real, class Observer>
void CemEngine<Real, Observer>::change_pace(const Pace<Real>& pace, const State<Real>& s) {
  const Real h = pace_.h, time = last_step_end();
  if (pace.h == h) return;
  if (energy_balance_) close_powers(h);
  consider_peak(step_ == 1 ? Real(0) : -h / 2, h);
  trend_ = sign(s.v);
  pace_ = pace;
  begin_segment(time, of_scheme(s, time, pace.h));
}

// The scheme's state, with v_n, for the motion's own, with V.
template <class Real, class Observer>
State<Real> CemEngine<Real, Observer>::of_scheme(State<Real> s, const Real& time, const Real& h) const {
  const Real own = s.v;
  s.v = own_velocity().to_scheme(s.x, own, time, h);
  if (!wall_) s.w += own - s.v;
  return s;
}

// The motion's own state in flight at the end of a step h, from the velocities in the middle of it.
template <class Real, class Observer>
State<Real> CemEngine<Real, Observer>::flown(const Real& x, const Real& y, const Real& middle_v,
                                             const Real& middle_w, const Real& time, const Real& h) const {
  const Real v = (middle_v + h / 2 * (forcing(time) - x)) / (1 + h * flight_.zeta);
  const Real own = own_velocity().from_scheme(x, v, time, h);
  return {x, own, y, middle_v + middle_w - own};
}

// The motion's own state within the last step: in flight, where that may be long, by a step that ends there.
template <class Real, class Observer>
State<Real> CemEngine<Real, Observer>::motion_at(const Real& at) const {
  State<Real> s = state_at(at);
  if (!rates_) return s;
  const Real begin = last_step_begin(), time = begin + at;
  if (wall_) {
    s = refined(s, at);
    s.v = own_velocity().from_scheme(s.x, s.v, time, pace_.h);
    return s;
  }
  s = state_at(Real(0));
  const Real own = own_velocity().from_scheme(s.x, s.v, begin, pace_.h);
  s.w += s.v - own;
  s.v = own;
  s = of_scheme(s, begin, at);
  const Real bend = acceleration(begin, s).x, v = s.v + at * bend / 2, w = s.w - at * bend / 2;
  return flown(s.x + at * v, s.y + at * w, v, w, time, at);
}

}  // namespace impact_damper
