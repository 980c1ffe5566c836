// Two rates (Cem::large_step): small steps h only while a wall may be met or left, steps of up to H in
// between.
//
// Changing the step. d_n / h_n is the velocity in the middle of a step; half a step on, v_n = d_n / h_n +
// h_n u''_n / 2, and from there half a step with another h,
//     d_{n+1} / h_{n+1} = v_n + h_{n+1} u''_n / 2 = d_n / h_n + (h_n + h_{n+1}) u''_n / 2:
// central differences on unequal steps, and just what the scheme's own start from u_n, v_n does
// (CemSteps::begin_segment). A change costs a local error of (h_{n+1}^2 - h_n^2) u'''/8 in the velocity; h
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
#include <cstdint>
#include <optional>
#include <utility>

#include "impact_damper/engines/cem_scheme.hpp"
#include "impact_damper/engines/cem_steps.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

// Converts the motion's own velocity V of x into the scheme's v_n, and back.
template <class Real>
struct OwnVelocity {
  Real zeta;
  Forcing<Real> force;
  Real stiffness;  // divided by the mass that moves

  Real to_scheme(const Real& x, const Real& own, const Real& time, const Real& h) const {
    return ratio(h) * own + lag(x, own, time, h);
  }
  Real from_scheme(const Real& x, const Real& v, const Real& time, const Real& h) const {
    return (v - lag(x, v, time, h)) / ratio(h);
  }

 private:
  // v_n / V without damping and force.
  Real ratio(const Real& h) const { return square_root(1 - stiffness * h * h / 4); }
  // v_n - ratio(h) V, due to damping and force.
  Real lag(const Real& x, const Real& v, const Real& time, const Real& h) const {
    if (!force && zeta == 0) return 0;
    const Real& b = stiffness;
    const Real second = b * (value_of(force, time) - 2 * zeta * v - x);  // x''
    return b * h * h / 6 * (rate_of(force, time) - 2 * zeta * second);
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
    const Real second = (square_root(1 + 4 * zeta * zeta) * swing + f0) / mass;  // B
    third_ = (swing + 2 * zeta * second + f0 * force.frequency) / mass;
    most_ = second + third_ * step / 3;
  }

  // Whether no wall is met for a time s, at most the horizon.
  bool free_for(const Real& s) const { return left(s).at(s) > 0 && right(s).at(s) > 0; }
  // Returns the part of s in which no wall is met.
  Real free_time(const Real& s) const { return std::min(left(s).fall(s), right(s).fall(s)); }

 private:
  // Lower bounds of the distances from the walls.
  Arc<Real> left(const Real& s) const { return {now_.y, now_.w, -second_towards(x2_, s)}; }
  Arc<Real> right(const Real& s) const { return {clearance_ - now_.y, -now_.w, -second_towards(-x2_, s)}; }
  // b of (M9.4), the bound on x'' towards a wall. now: x'' towards it now.
  Real second_towards(const Real& now, const Real& s) const {
    return std::clamp(Real(now + third_ * s / 3), Real(0), most_);
  }

  State<Real> now_;
  Real clearance_, x2_, third_, most_;  // most_: of |x''|; third_: J
};

// The choice of the step size, and the motion's own state, which a change of the step size hands on.
template <class Real, template <class> class ForEach>
class CemRates {
  using Masses = CemMasses<Real, ForEach>;
  using Steps = CemSteps<Real, ForEach>;
  using State = typename Masses::State;

 public:
  CemRates(const Masses& masses, const Steps& steps, const Scene& scene, const Cem& options)
      : masses_(masses), steps_(steps), small_(steps.pace_of(Real(*options.time_step))) {
    if (!options.large_step) return;
    const Real &h = small_.h, large = multiple_of(h, Real(*options.large_step));
    const Real pressed = stability_limit(scene, options.damper, options.calibration) / 2;
    larger_ = Larger{steps.pace_of(large), steps.pace_of(multiple_of(h, std::clamp(pressed, h, large)))};
  }

  // Whether there are larger steps than the time step.
  explicit operator bool() const { return larger_.has_value(); }
  // The time step.
  const CemPace<Real>& small() const { return small_; }

  // Chooses the pace of the next steps, and returns the number of steps for which it is right.
  // change(pace, s): changes it from the last step on, where the motion's own state is s.
  template <class Change>
  std::int64_t choose(const Change& change) const {
    if (masses_.coupled.empty()) {
      // A segment's first step shows what its motion is.
      return steps_.number() == 0 ? 1 : choose_without_contact(change);
    }
    // A contact begins in small steps.
    const bool small = steps_.h() == small_.h, first = steps_.number() == 0;
    std::int64_t begun = 0;
    for (const std::size_t i : masses_.coupled)
      if (first || steps_.end() - masses_[i].contact_begin < small_.h)
        begun = std::max(begun, masses_[i].steps_of_contact);
    if (first) return small ? begun : 1;
    return begun > 0 && small ? begun : choose_in_contact(change);
  }

  // Returns the motion's own state at a time in the last step. In flight, where the step may be long, it is
  // that of a step that ends there.
  State motion_at(const Real& at) const {
    if (!larger_) return steps_.state_at(at);
    const Real begin = steps_.begin(), time = begin + at;
    if (masses_.joined > 1 || !masses_.coupled.empty()) {
      State s = steps_.refined_state_at(at);
      set_velocity(s, own_velocity().from_scheme(s.x, s.v, time, steps_.h()));
      return s;
    }
    State s = steps_.state_at(Real(0));
    set_velocity(s, own_velocity().from_scheme(s.x, s.v, begin, steps_.h()));
    s = of_scheme(std::move(s), begin, at);
    const Real second = masses_.second_of_x(begin, s);
    s.v += at * second / 2;
    s.x += at * s.v;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      s.w[i] -= at * second / 2;
      s.q[i] += at * s.w[i];
    }
    return flown(std::move(s), time, at);
  }
  // Returns the scheme's state, with v_n, for the motion's own, with V.
  State of_scheme(State s, const Real& time, const Real& h) const {
    set_velocity(s, own_velocity().to_scheme(s.x, s.v, time, h));
    return s;
  }

 private:
  struct Larger {
    CemPace<Real> large, pressed;
  };

  template <class Change>
  std::int64_t choose_without_contact(const Change& change) const {
    constexpr int many = 16, few = 4;
    const Real h = steps_.h(), time = steps_.end(), large = larger_->large.h;
    const State s = masses_.joined > 1
                        ? motion_at(h)
                        : flown({steps_.x().x, steps_.x().dx / h,
                                 masses_.of_each([&](std::size_t i) { return masses_[i].now.x; }),
                                 masses_.of_each([&](std::size_t i) { return masses_[i].now.dx / h; })},
                                time, h);
    int steps = many;
    const Real free = free_time(s, large, steps);
    const Real step = steps > 0 ? large : multiple_of(small_.h, free);
    if (!(steps > 0 || step >= few * small_.h)) {
      change(small_, s);
      return few;
    }
    if (steps > 0) {
      change(larger_->large, s);
      return steps;
    }
    change(steps_.pace_of(step), s);
    return 1;
  }
  // Takes long steps once the masses in contact follow (M17.23), q_pressed and w_pressed, and none is about
  // to leave its wall.
  template <class Change>
  std::int64_t choose_in_contact(const Change& change) const {
    const Real time = steps_.end(), mass = masses_.with_walls();
    const State s = motion_at(steps_.h());
    const Real second = masses_.second_as_one(time, s, mass);
    const Real third = (rate_of(masses_.force, time) - 2 * masses_.zeta * second - s.v) / mass;
    const Real many = 64;
    Real least = many;
    std::int64_t longest = 0;
    bool settled = true;
    for (const std::size_t i : masses_.coupled) {
      const auto& m = masses_[i];
      const Real w_pressed = -third / m.omega_2, q_pressed = -(second + m.c * w_pressed) / m.omega_2;
      const Real q = s.q[i], dq = q - q_pressed, dw = s.w[i] - w_pressed;
      const Real tolerance = m.omega_2 * small_.h * small_.h * q_pressed;
      settled = settled && dw * dw + m.omega_2 * dq * dq <= m.omega_2 * tolerance * tolerance;
      // Half of the steps that lead out of the wall at this speed.
      const Real overlap = -m.push() * q, per_step = 2 * m.push() * s.w[i] * larger_->pressed.h;
      const Real steps = overlap > many * per_step ? many : overlap / per_step;
      settled = settled && steps >= 1;
      least = std::min(least, steps);
      longest = std::max(longest, m.steps_of_contact);
    }
    int steps = settled ? int(double(least)) : 0;
    free_time(s, larger_->pressed.h, steps);
    if (steps > 0) {
      change(larger_->pressed, s);
      return steps;
    }
    change(small_, s);
    return longest;
  }
  // Halves `steps` of h until no mass in flight can meet a wall in them. Returns the part of h in which none
  // does, which is of use where not even one step is free.
  Real free_time(const State& s, const Real& h, int& steps) const {
    const Real second = masses_.second_as_one(steps_.end(), s, masses_.joined), horizon = steps * h;
    Real free = h;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (masses_[i].wall) continue;
      const Certificate<Real> sure(masses_.zeta, masses_.force, {s.x, s.v, s.q[i], s.w[i]}, second, h,
                                   horizon, masses_[i].clearance, masses_.joined);
      while (steps > 0 && !sure.free_for(steps * h)) steps /= 2;
      if (steps == 0) free = std::min(free, sure.free_time(h));
    }
    return free;
  }
  OwnVelocity<Real> own_velocity() const { return {masses_.zeta, masses_.force, 1 / masses_.with_walls()}; }
  // Sets x' to v, and keeps x' + y' of masses in flight.
  void set_velocity(State& s, const Real& v) const {
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (!masses_[i].wall) s.w[i] += s.v - v;
    s.v = v;
  }
  // Returns the motion's own state where all fly, at the end of a step h, from the velocities in the middle
  // of it.
  State flown(State s, const Real& time, const Real& h) const {
    const Real v = (s.v + h / 2 * (masses_.force_at(time) - s.x)) / (1 + h * masses_.zeta);
    const Real own = own_velocity().from_scheme(s.x, v, time, h);
    for (Real& w : s.w) w = s.v + w - own;
    s.v = own;
    return s;
  }

  const Masses& masses_;
  const Steps& steps_;
  CemPace<Real> small_;
  std::optional<Larger> larger_;
};

}  // namespace impact_damper
