// Two rates (Cem::large_step): small steps h only while a wall may be met or left, steps of up to H in
// between.
//
// Changing the step. d_n / h_n is the velocity in the middle of a step; half a step on, v_n = d_n / h_n +
// h_n u''_n / 2, and from there half a step with another h,
//     d_{n+1} / h_{n+1} = v_n + h_{n+1} u''_n / 2 = d_n / h_n + (h_n + h_{n+1}) u''_n / 2:
// central differences on unequal steps, and just what the scheme's own start from u_n, v_n does
// (CemEngine::begin_segment). A change costs a local error of (h_{n+1}^2 - h_n^2) u'''/8 in the velocity; h
// ends where it began, so these are differences, and the order remains 2.
//
// But they do not cancel. Central differences lead x'' + x = 0 round the ellipse x^2 + v_n^2 / (1 - h^2/4),
// so a change at v adds (h_{n+1}^2 - h_n^2) v^2 / 8 to the energy, in every half cycle with the same sign:
// with H = 0.05, up to a tenth of what the impacts take out at x0 = 6. The velocity that is handed on is
// therefore V = v_n / sqrt(1 - h^2/4), with which the ellipse is the true circle for any h, run through too
// fast by the fraction h^2/24. Damping and force add, by Taylor's theorem, v_n = ... + h^2 (f' - 2 zeta x'')
// / 6. Pressed to a wall both masses move as one, (1 + nu) x'' + ..., and each h^2 here is divided by 1 + nu.
// x' + y', which nothing changes in flight, is handed on as it is.
//
// The way to a wall. Where the next H is not certified free (Certificate, below) one step leads as far as the
// certificate goes. Nearing the wall these steps shorten quadratically; below a few h small ones take over.
// All steps, H as well, are rounded down to whole multiples of h: so without `locate` a touch falls anywhere
// in a small step, as with one rate. At the same place each time, release would come late by the same
// fraction of h each time too, since a contact lasts as long at any speed, and errors that now cancel would
// add up.
//
// Pressed to a wall for long, a mass rings until it follows the primary mass,
//     q_p = -(x'' + c w_p) / omega_m^2,   w_p = -x''' / omega_m^2,   x'', x''' of all that are at walls as
//     one.
// When the ringing is (omega_m h)^2 of q_p, the scheme's own relative error, steps of half the stability
// limit are as good: what is left of it dies away in these too. With a list this must hold for all masses in
// contact. Small steps return before one of them is free, or a mass in flight may meet a wall: for these
// (M9.4) is taken with mu of the joined masses, which leaves room for the ringing of the rest. Masses joined
// to the primary one (Cem::stuck_speed) change nothing of this: alone they take steps of H until they part.
#pragma once

#include <algorithm>

#include "impact_damper/engines/cem_scheme.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

// Converts the motion's own velocity V of x into the scheme's v_n, and back.
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
  // v_n / V without damping and force.
  Real turn(const Real& h) const { return square_root(1 - stiffness * h * h / 4); }
  // v_n - turn(h) V, due to damping and force.
  Real lag(const Real& x, const Real& v, const Real& time, const Real& h) const {
    if (!force && zeta == 0) return 0;
    const Real& b = stiffness;
    const Real bend = b * (value_of(force, time) - 2 * zeta * v - x);  // x''
    return b * h * h / 6 * (rate_of(force, time) - 2 * zeta * bend);
  }
};

// Proves times from now on in which a flight meets no wall, neither by the motion nor by central differences.
//
// y'' = -x''. With mu = 1, and as much more as the secondary masses that are joined to the primary one, only
// the force can feed x^2 + mu x'^2, so sqrt(x^2 + mu x'^2) <= S = (its value now) + |f0| s for s from now on,
// and
//     |x''| <= B = (sqrt(1 + 4 zeta^2) S + |f0|) / mu,     |x'''| <= J = (S + 2 zeta B + |f0| omega_f) / mu.
// With b = min(x'' + J s/3, B), but not below 0, y + y' t - b t^2/2 is below y(t) for all t in [0, s] and is
// concave (M9.4): if it is positive at s, the left wall is not met before. Likewise 1 - y and the right wall.
//
// The differences keep to the same bounds. With n steps h = s/n they have, J s^3/6 being the sum's limit,
//     y_n >= y + s (y' - |v_n - V|) - x'' s^2/2 - J s (s^2 - h^2)/6,   |v_n - V| <= J h^2/6,
// as |d_n / h| <= S for all n; only the difference of v_n and V must be added to B: b = min(., B + J h/3).
// That is exact for h <= 1.7 without damping and force; with them terms of order h^4 are left out.
template <class Real>
class Certificate {
 public:
  // now: a state in flight; x2: the acceleration of the primary mass; step: the longest step, > 0 and <=
  // `horizon`; mass: mu.
  Certificate(const Real& zeta, const Forcing<Real>& force, const State<Real>& now, const Real& x2,
              const Real& step, const Real& horizon, const Real& clearance, const Real& mass)
      : now_(now), clearance_(clearance), x2_(x2) {
    const Real f0 = absolute(force.amplitude);
    const Real swing = square_root(now.x * now.x + mass * now.v * now.v) + f0 * horizon;
    const Real bend = (square_root(1 + 4 * zeta * zeta) * swing + f0) / mass;  // B
    jerk_ = (swing + 2 * zeta * bend + f0 * force.frequency) / mass;
    most_ = bend + jerk_ * step / 3;
  }

  // Whether no wall is met for a time s, at most the horizon.
  bool free_for(const Real& s) const { return left(s).at(s) > 0 && right(s).at(s) > 0; }
  // Returns the part of s in which no wall is met.
  Real free_time(const Real& s) const { return std::min(left(s).fall(s), right(s).fall(s)); }

 private:
  // Lower bounds of the distances from the walls.
  Arc<Real> left(const Real& s) const { return {now_.y, now_.w, -bend(x2_, s)}; }
  Arc<Real> right(const Real& s) const { return {clearance_ - now_.y, -now_.w, -bend(-x2_, s)}; }
  // b of (M9.4), the bound on x'' towards a wall.
  Real bend(const Real& towards, const Real& s) const {
    return std::clamp(Real(towards + jerk_ * s / 3), Real(0), most_);
  }

  State<Real> now_;
  Real clearance_, x2_, jerk_, most_;
};

}  // namespace impact_damper
