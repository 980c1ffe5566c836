// Contact with a compliant wall: the full coupled system, in closed form.
//
// With q the overlap coordinate (y at the left wall, y - 1 at the right; q < 0 and q > 0 in contact),
// K = omega_m^2 = k/nu and c = 2 omega_m zeta_m, equations (5)-(8) read
//     x'' + 2 zeta x' + x = nu (c q' + K q) + f,      x'' + q'' + c q' + K q = 0.
// Their characteristic polynomial
//     P(s) = s^4 + [2 zeta + c(1+nu)] s^3 + [1 + 2 zeta c + K(1+nu)] s^2 + [c + 2 zeta K] s + K
// is factored once per scene into two real quadratics: one oscillator that is slow (both masses moving
// together) and one that is fast (the wall ringing). A state is split into the part that lives in either,
// and each part moves by its own oscillator's C and S (oscillator.hpp), critically damped or not.
//
// The split. Q1 = s^2 + p s + b slow, Q2 = s^2 + p2 s + b2 fast. Q2(d/dt) removes the fast part of a motion
// u and leaves r = (alpha d/dt + beta) u1 of the slow one, alpha = p2 - p, beta = b2 - b, and on slow motions
// (alpha s + beta)(gamma s + delta) = 1 with gamma = -alpha/R, delta = (beta - alpha p)/R,
// R = beta^2 - alpha beta p + alpha^2 b, so u1 = gamma r' + delta r.
#pragma once

#include "impact_damper/motion/contact_factors.hpp"
#include "impact_damper/motion/rebound.hpp"
#include "impact_damper/motion/swing.hpp"

namespace impact_damper {

template <class Real>
class ContactSystem {
 public:
  ContactSystem(const System<Real>& system, const Real& zeta_m)
      : nu(system.nu),
        zeta(system.zeta),
        stiffness(system.k / system.nu),
        damping(2 * zeta_m * square_root(stiffness)),
        forcing(system.forcing) {
    const ContactFactors<Real> factors = factor_contact(nu, zeta, stiffness, damping);
    p_ = factors.p;
    b_ = factors.b;
    p2_ = factors.p2;
    b2_ = factors.b2;
    slow = Oscillator<Real>(p_ / 2, b_);
    fast = Oscillator<Real>(p2_ / 2, b2_);
    const Real alpha = p2_ - p_, beta = b2_ - b_;
    const Real resultant = beta * beta - alpha * beta * p_ + alpha * alpha * b_;
    gamma_ = -alpha / resultant;
    delta_ = (beta - alpha * p_) / resultant;
    // On fast motions x = nu (c s + K) / (s^2 + 2 zeta s + 1) q: its inverse denominator, reduced by Q2.
    const Real free = 1 + 2 * zeta;
    stiff_ = b2_ > 16 * free * free;
    const Real a = 2 * zeta - p2_, o = 1 - b2_;
    const Real free_resultant = o * o + a * (2 * zeta * b2_ - p2_);  // a b2 - o p2, its large terms cancelled
    shape_s_ = -a / free_resultant;
    shape_1_ = (o - a * p2_) / free_resultant;
    // What one unit of forcing accelerates: x'' by 1, q'' by -1.
    split({0, 1, 0, -1}, drive_slow, drive_fast);
    if (fast.half_period() < std::numeric_limits<Real>::infinity())
      left_by_quarter = exponential(Real(-fast.a() * fast.half_period() / 2));
    std::array<ContactParts<Real>, 3> touch;
    split({1, 0, 0, 0}, touch[0].slow, touch[0].fast);
    split({0, 1, 0, 0}, touch[1].slow, touch[1].fast);
    split({0, 0, 0, 1}, touch[2].slow, touch[2].fast);
    if (!forcing)
      rebound = Rebound<Real>(slow, fast, touch, [&](const ContactState<Real>& state, auto& x, auto& q) {
        derive(state, x, q);
      });
  }

  // u = slow + fast.
  void split(const ContactState<Real>& u, ContactState<Real>& slow_part,
             ContactState<Real>& fast_part) const {
    const Real force = damping * u.w + stiffness * u.q;
    const Real x2 = nu * force - 2 * zeta * u.v - u.x, q2 = -force - x2;
    // r = Q2(d/dt) applied to q and x, and its derivative. For q the large terms cancel exactly:
    // p2 - c(1+nu) = 2 zeta - p and b2 - K(1+nu) = 1 + 2 zeta c - b - p p2, by the coefficients of P.
    const Real on_w = 2 * zeta - p_, on_q = 1 + 2 * zeta * damping - b_ - p_ * p2_;
    const Real r_q = on_w * u.w + on_q * u.q + 2 * zeta * u.v + u.x;
    const Real r_w = on_w * q2 + on_q * u.w + 2 * zeta * x2 + u.v;
    slow_part.q = gamma_ * r_w + delta_ * r_q;
    slow_part.w = gamma_ * (-p_ * r_w - b_ * r_q) + delta_ * r_w;
    fast_part.q = u.q - slow_part.q;
    fast_part.w = u.w - slow_part.w;
    if (stiff_) {
      // From the shape of the fast motion: a rounding error of x must not ring with the wall's frequency.
      const auto shape = [&](const Real& now, const Real& rate) {
        // (c s + K)(shape_s s + shape_1) q, with s^2 = -p2 s - b2
        const Real square = damping * shape_s_;
        return nu * ((stiffness * shape_1_ - square * b2_) * now +
                     (damping * shape_1_ + stiffness * shape_s_ - square * p2_) * rate);
      };
      fast_part.x = shape(fast_part.q, fast_part.w);
      fast_part.v = shape(fast_part.w, -p2_ * fast_part.w - b2_ * fast_part.q);
      slow_part.x = u.x - fast_part.x;
      slow_part.v = u.v - fast_part.v;
    } else {
      const Real x3 = nu * (damping * q2 + stiffness * u.w) - 2 * zeta * x2 - u.v;
      const Real r_x = x2 + p2_ * u.v + b2_ * u.x, r_v = x3 + p2_ * x2 + b2_ * u.v;
      slow_part.x = gamma_ * r_v + delta_ * r_x;
      slow_part.v = gamma_ * (-p_ * r_v - b_ * r_x) + delta_ * r_v;
      fast_part.x = u.x - slow_part.x;
      fast_part.v = u.v - slow_part.v;
    }
  }

  // Derivatives of x and q without forcing, from the equations themselves.
  template <std::size_t N>
  void derive(const ContactState<Real>& state, Derivatives<Real, N>& x, Derivatives<Real, N>& q) const {
    x[0] = state.x;
    x[1] = state.v;
    q[0] = state.q;
    q[1] = state.w;
    for (std::size_t n = 2; n < N; ++n) {
      const Real force = damping * q[n - 1] + stiffness * q[n - 2];
      x[n] = nu * force - 2 * zeta * x[n - 1] - x[n - 2];
      q[n] = -force - x[n];
    }
  }

  // The amplitude N of a fast motion that rings: q is the real part of N exp(lambda t + i phase).
  Real ringing(const ContactState<Real>& fast_part) const {
    const Real along = (fast_part.w + fast.a() * fast_part.q) * fast.half_period() / half_turn<Real>();
    return square_root(Real(fast_part.q * fast_part.q + along * along));
  }

  Real nu, zeta, stiffness, damping;  // nu, zeta, K, c
  Forcing<Real> forcing;
  Oscillator<Real> slow, fast;
  ContactState<Real> drive_slow, drive_fast;

  Rebound<Real> rebound;
  Real left_by_quarter{0};  // of the fast motion's ringing, by a quarter of its swing

 private:
  Real p_, b_, p2_, b2_, gamma_, delta_, shape_s_, shape_1_;
  bool stiff_;
};

template <class Real>
class Contact {
 public:
  Contact(const ContactSystem<Real>& system, const Real& begin, const State<Real>& start, Wall wall)
      : system_(system),
        begin_(begin),
        start_(start),
        wall_(wall == Wall::left ? 0 : 1),
        inward_(wall == Wall::left ? -1 : 1) {}

  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    const ContactState<Real> slow = slow_at(t), fast = fast_at(t);
    return {slow.x + fast.x, slow.v + fast.v, wall_ + (slow.q + fast.q), slow.w + fast.w};
  }

  // When and in what state the secondary mass is back at the wall's position, if before `horizon`.
  std::optional<Arrival<Real>> leave(const Real& horizon, const Real& span) const {
    if (start_.y == wall_) {
      auto end = system_.rebound(start_.x, start_.v, start_.w);
      if (!end) end = settle();
      if (end && !(end->time < horizon)) return {};
      if (end) return Arrival<Real>{end->time, wall(), {end->x, end->v, wall_, end->w}};
    }
    return search_leave(horizon, span);
  }
  // The same, certified step by step.
  std::optional<Arrival<Real>> search_leave(const Real& horizon, const Real& span) const {
    const auto left = search_fall<Real>([&](const Real& t) { return depth(t, span); }, Real(0), horizon, span,
                                        resolution());
    if (!left) return {};
    Arrival<Real> end{*left, wall(), at(*left)};
    end.state.y = wall_;
    return end;
  }
  // Towards zero: how deep the secondary mass is in the wall.
  Outlook<Real> depth(const Real& t, const Real& span) const {
    return look(instant_of_q(slow_at(t), system_.slow, system_.drive_slow, t),
                instant_of_q(fast_at(t), system_.fast, system_.drive_fast, t), 0, inward_, span);
  }
  // Whether x is proved to keep its sign in [0, t], or never to exceed `best` or the ends, by its ends.
  bool keeps_side(const Real& side, const State<Real>& end, const Real& t) const {
    return side * start_.x > 0 && side * end.x > 0 && keeps_sign(start_.x, end.x, second_of_x(t), t);
  }
  bool keeps_course(const Real& best, const State<Real>& end, const Real& t) const {
    if (start_.v * end.v > 0 && keeps_sign(start_.v, end.v, third_of_x(t), t)) return true;
    const Real off = second_of_x(t) * t * t / 8;
    return absolute(start_.x) + off <= best && absolute(end.x) + off <= best;
  }
  Real one_zero_within() const { return 0; }
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            const Real& span) const {
    if (order == 0) {
      if (const auto fall = fall_of_slow_x(sign); fall && *fall > from)
        return *fall < until ? fall : std::nullopt;
    }
    return search_fall<Real>([&](const Real& t) { return derivative_of_x(order, sign, t, span); }, from,
                             until, span, resolution());
  }
  Outlook<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t, const Real& span) const {
    const ContactState<Real> slow = slow_at(t), fast = fast_at(t);
    return look(instant_of_x(slow, system_.slow, system_.drive_slow, t),
                instant_of_x(fast, system_.fast, system_.drive_fast, t), order, sign, span);
  }

  // x and its first three derivatives at the beginning: from the equations, not from the parts, whose
  // rounding errors would decide where one is zero.
  std::array<Real, 4> leads_of_x() const {
    const ContactSystem<Real>& c = system_;
    const auto f = c.forcing.template derivatives<2>(begin_);
    const Real force = c.damping * start_.w + c.stiffness * (start_.y - wall_);
    const Real x2 = c.nu * force - 2 * c.zeta * start_.v - start_.x + f[0], w1 = -force - x2;
    const Real x3 = c.nu * (c.damping * w1 + c.stiffness * start_.w) - 2 * c.zeta * x2 - start_.v + f[1];
    return {start_.x, start_.v, x2, x3};
  }

  // Panels as long as the fast motion allows while its ringing can still be felt in the energy, then as the
  // slow one and the forcing allow.
  Real panel(const Real& t) const {
    const ContactState<Real> slow = slow_at(t), fast = fast_at(t);
    Real rate = system_.slow.rate();
    if (system_.forcing && system_.forcing.frequency > rate) rate = system_.forcing.frequency;
    const Real ringing_w = instant_of_q(fast, system_.fast, system_.drive_fast, t).transient(1);
    const Real ringing_v = instant_of_x(fast, system_.fast, system_.drive_fast, t).transient(1);
    const Real power = system_.nu * system_.damping * ringing_w * (ringing_w + 2 * absolute(slow.w)) +
                       2 * system_.zeta * ringing_v * (ringing_v + 2 * absolute(slow.v)) +
                       absolute(system_.forcing.amplitude) * ringing_v;
    const Real noise = 64 * std::numeric_limits<Real>::epsilon() * system_.fast.rate() *
                       (absolute(slow.q) + absolute(fast.q) + absolute(fast.x));
    const Real forced =
        system_.forcing.amplitude / (1 + system_.forcing.frequency * system_.forcing.frequency);
    const Real energy = slow.x * slow.x + slow.v * slow.v + forced * forced;
    const bool quiet = (ringing_w <= noise && ringing_v <= noise) || power <= Real(1e-18) * rate * energy;
    if (!quiet && system_.fast.rate() > rate) rate = system_.fast.rate();
    return Real(6) / rate;
  }
  Real resolution() const { return system_.fast.rate() > 1 ? 1 / system_.fast.rate() : Real(1); }

 private:
  Wall wall() const { return wall_ == 0 ? Wall::left : Wall::right; }

  // Bounds for a time t.
  Real second_of_x(const Real& t) const { return bound_of_x(2, t, &Rebound<Real>::second_of_x); }
  Real third_of_x(const Real& t) const { return bound_of_x(3, t, &Rebound<Real>::third_of_x); }
  template <class OfRebound>
  Real bound_of_x(std::size_t order, const Real& t, OfRebound of_rebound) const {
    if (system_.rebound && start_.y == wall_)
      return (system_.rebound.*of_rebound)(start_.x, start_.v, start_.w);
    return instant_of_x(parts().slow, system_.slow, system_.drive_slow, Real(0)).bound(order, t) +
           instant_of_x(parts().fast, system_.fast, system_.drive_fast, Real(0)).bound(order, t);
  }

  // When x, on one side of zero, falls to it in a contact that lasts: when the slow part of x does, if by half
  // that time the ringing is below its rounding error, and was below the slow part all along.
  std::optional<Real> fall_of_slow_x(const Real& side) const {
    const ContactSystem<Real>& c = system_;
    const Real infinite = std::numeric_limits<Real>::infinity();
    if (c.forcing || !(c.fast.half_period() < infinite) || !(c.slow.half_period() < infinite)) return {};
    const auto& [slow, fast] = parts();
    const Real x = side * slow.x;
    if (!(x > 0)) return {};
    const Real fall = c.slow.fall(x, Real(side * slow.v)), half = fall / 2;
    const Real along = (fast.v + c.fast.a() * fast.x) * c.fast.half_period() / half_turn<Real>();
    const Real ringing = square_root(Real(fast.x * fast.x + along * along)), late_x = side * slow_at(half).x;
    const Real left = ringing * exponential(Real(-c.fast.a() * half));
    if (!(ringing < x && ringing < late_x && left < std::numeric_limits<Real>::epsilon() / 4 * late_x)) return {};
    return fall;
  }

  // The end of a contact that lasts: the ringing dies away, and the mass leaves when the slow motion lets go.
  //
  // The proof. The ringing is the real part of N exp(lambda t + i phase), so that its fourth derivative is at
  // most N b^2 exp(-a t). (1) For a full swing of it, quarter by quarter, by that bound (arrival.hpp). (2) From
  // there on the ringing stays below the slow motion's depth, which is nowhere lower than at the ends: where
  // it has a minimum it is outside the wall. (3) At last, where both go to zero, by the bound again.
  std::optional<typename Rebound<Real>::End> settle() const {
    const ContactSystem<Real>& c = system_;
    const Real infinite = std::numeric_limits<Real>::infinity(), quarter = c.fast.half_period() / 2;
    if (c.forcing || !(quarter < infinite) || !(c.slow.half_period() < infinite)) return {};
    const auto& [slow, fast] = parts();
    const Real depth = inward_ * slow.q;
    if (!(depth > 0)) return {};
    Real h = c.slow.fall(depth, Real(inward_ * slow.w));
    const Real late = h * Real(0.75);
    if (!(late > 4 * quarter)) return {};

    const Real b = c.fast.b(), a = c.fast.a();
    Real ringing = c.ringing(fast);
    const Real slow_fourth =
        square_root(Real(slow.q * slow.q + slow.w * slow.w / c.slow.b())) * c.slow.b() * c.slow.b();
    ContactState<Real> before{0, 0, 0, inward_ * start_.w}, slow_now;
    for (int n = 1; n <= 4; ++n) {
      slow_now = slow_at(Real(n) * quarter);
      const ContactState<Real> fast_now = fast_at(Real(n) * quarter);
      const ContactState<Real> now{0, 0, inward_ * (slow_now.q + fast_now.q), inward_ * (slow_now.w + fast_now.w)};
      if (!stays_open(before.q, before.w, now.q, now.w, quarter, Real(ringing * b * b + slow_fourth))) return {};
      ringing *= c.left_by_quarter;
      before = now;
    }
    const Real early = h / 4;
    const ContactState<Real> slow_late = slow_at(late), fast_late = fast_at(late);
    const Real early_depth = inward_ * slow_at(early).q, late_depth = inward_ * slow_late.q;
    const auto ringing_at = [&](const Real& t) {
      return t < 4 * quarter ? ringing : Real(ringing * exponential(Real(a * (4 * quarter - t))));
    };
    if (!(ringing < inward_ * slow_now.q && ringing < early_depth && ringing_at(early) < early_depth &&
          ringing_at(early) < late_depth))
      return {};
    const Real faint = ringing_at(late) * b * b + slow_fourth;
    for (int correction = 0; correction < 4; ++correction) {
      Derivatives<Real, 6> x, q;
      const State<Real> there = at(h);
      c.derive({there.x, there.v, there.y - wall_, there.w}, x, q);
      const auto [shift, close] = nearby(Real(0), q, h, faint);
      h += shift;
      if (!(absolute(h - late * 4 / 3) < late / 4)) return {};
      if (!close) continue;
      const auto [end_x, end_v] = moved(x, shift);
      const Real end_w = moved(q, shift).u1;
      if (!stays_open(Real(late_depth + inward_ * fast_late.q), Real(inward_ * (slow_late.w + fast_late.w)),
                      Real(0), Real(inward_ * end_w), Real(h - late), faint))
        return {};
      return typename Rebound<Real>::End{h, end_x, end_v, end_w};
    }
    return {};
  }

  ContactState<Real> move(const Oscillator<Real>& oscillator, const ContactState<Real>& from,
                          const ContactState<Real>& drive, const Real& t) const {
    // Under forcing x' and q' of a part differ from its v and w by drive.x f and drive.q f, from the start
    // on.
    if (t == 0 && !system_.forcing) return from;
    const Propagator<Real> p = oscillator.propagate(t);
    const Real s1 = -oscillator.b() * p.s;
    ContactState<Real> to{p.c * from.x + p.s * from.v, s1 * from.x + p.v * from.v,
                          p.c * from.q + p.s * from.w, s1 * from.q + p.v * from.w};
    if (system_.forcing) {
      const DrivenResponse<Real> driven = oscillator.respond(system_.forcing, begin_, t, p);
      const Real f = system_.forcing.template derivatives<2>(begin_ + t)[0];
      const Real on_displacement = driven.d1 + 2 * oscillator.a() * driven.d;  // response to C instead of S
      const Real on_velocity = f - oscillator.b() * driven.d;                  // its derivative
      to.x += drive.v * driven.d + drive.x * on_displacement;
      to.v += drive.v * driven.d1 + drive.x * on_velocity;
      to.q += drive.w * driven.d + drive.q * on_displacement;
      to.w += drive.w * driven.d1 + drive.q * on_velocity;
    }
    return to;
  }

  ContactState<Real> slow_at(const Real& t) const {
    return move(system_.slow, parts().slow, system_.drive_slow, t);
  }
  ContactState<Real> fast_at(const Real& t) const {
    return move(system_.fast, parts().fast, system_.drive_fast, t);
  }
  // Taken apart when first asked for: a brisk rebound never asks.
  const ContactParts<Real>& parts() const {
    if (!parts_) {
      parts_.emplace();
      system_.split({start_.x, start_.v, start_.y - wall_, start_.w}, parts_->slow, parts_->fast);
    }
    return *parts_;
  }

  // A displacement that is driven by `drive` and its velocity by `drive1` obeys the oscillator's equation
  // under (drive1 + 2 a drive) f + drive f'.
  using Part = Instant<Real, 6>;
  static Real on_f(const Oscillator<Real>& oscillator, const Real& drive, const Real& drive1) {
    return drive1 + 2 * oscillator.a() * drive;
  }
  Part instant_of_q(const ContactState<Real>& now, const Oscillator<Real>& oscillator,
                    const ContactState<Real>& drive, const Real& t) const {
    return {oscillator, now.q,           now.w,     on_f(oscillator, drive.q, drive.w),
            drive.q,    system_.forcing, begin_ + t};
  }
  Part instant_of_x(const ContactState<Real>& now, const Oscillator<Real>& oscillator,
                    const ContactState<Real>& drive, const Real& t) const {
    return {oscillator, now.x,           now.v,     on_f(oscillator, drive.x, drive.v),
            drive.x,    system_.forcing, begin_ + t};
  }
  static Outlook<Real> look(const Part& slow, const Part& fast, std::size_t n, const Real& sign,
                            const Real& span) {
    const Real slow_third = slow.bound(n + 3, span), fast_third = fast.bound(n + 3, span);
    return {{sign * (slow[n] + fast[n]), sign * (slow[n + 1] + fast[n + 1]),
             sign * (slow[n + 2] + fast[n + 2]), slow_third + fast_third},
            {sign * slow[n], sign * slow[n + 1], sign * slow[n + 2], slow_third},
            fast.bound(n, span)};
  }

  const ContactSystem<Real>& system_;
  Real begin_;
  State<Real> start_;
  Real wall_, inward_;
  mutable std::optional<ContactParts<Real>> parts_;
};

}  // namespace impact_damper
