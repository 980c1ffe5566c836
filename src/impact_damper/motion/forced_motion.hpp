// x of one oscillator under the force, in closed form from its beginning (M3.2): in flight (flight.hpp), and
// where both masses move as one (sticking.hpp).
//
// Every motion answers, for a time t since its beginning: the state, which wall it meets and when, and where
// a derivative of x falls through zero.
#pragma once

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/motion/oscillator.hpp"
#include "impact_damper/motion/system.hpp"

namespace impact_damper {

// A quadrature panel (Oscillator::panel), no longer than the forcing allows.
template <class Real, class Force>
Real panel_under(const Force& forcing, const Real& panel) {
  return forcing && panel * forcing.frequency > 6 ? Real(6 / forcing.frequency) : panel;
}

// x of a single oscillator under the forcing, with what bounds it.
template <class Real, class Force = Forcing<Real>>
class ForcedMotion {
 public:
  ForcedMotion(const Oscillator<Real>& oscillator, const Force& forcing, const Real& begin, const Real& x0,
               const Real& v0)
      : oscillator_(oscillator),
        forcing_(forcing),
        begin_(begin),
        phase_(forcing.phase(begin)),
        x0_(x0),
        v0_(v0) {}

  struct Change {
    Real x, v;    // displacement and velocity at t
    Real dx, dv;  // x - x0 - v0 t and v - v0, without cancellation
  };
  Change at(const Real& t) const {
    const Propagator<Real> p = oscillator_.propagate(t);
    Change now;
    now.x = x0_ * p.c + v0_ * p.s;
    now.dx = x0_ * p.c1 + v0_ * p.s1;
    const Real from_x = -x0_ * oscillator_.b() * p.s;
    now.dv = v0_ * (p.c1 - 2 * oscillator_.a() * p.s) + from_x;
    now.v = v0_ * p.v + from_x;
    if (forcing_) {
      const DrivenResponse<Real> driven = oscillator_.respond(forcing_, phase_, t, p);
      now.x += driven.d;
      now.dx += driven.d;
      now.dv += driven.d1;
      now.v += driven.d1;
    }
    return now;
  }

  template <std::size_t N>
  Instant<Real, N, Force> instant(const Real& x, const Real& v, const Real& t) const {
    return {oscillator_, x, v, Real(1), Real(0), forcing_, phase_at(t)};
  }
  // The same of `times` x; x and v are already that many times what they are.
  template <std::size_t N>
  Derivatives<Real, N> derivatives(const Real& x, const Real& v, const Real& t, const Real& times) const {
    if (!forcing_) return impact_damper::derivatives<N>(oscillator_, x, v);
    return impact_damper::derivatives<N>(oscillator_, x, v, times, Real(0),
                                         forcing_.template derivatives<N + 1>(phase_at(t)));
  }
  // A bound on the fourth of these, d, for a time `span` from t on.
  template <std::size_t N>
  Real fourth(const Derivatives<Real, N>& d, const Real& x, const Real& v, const Real& t, const Real& times,
              const Real& span) const {
    if (!forcing_) return oscillator_.bound(d[4], d[5]);
    return Instant<Real, 6, Force>{oscillator_, x, v, times, Real(0), forcing_, phase_at(t)}.bound(4, span);
  }
  using Beginning = Instant<Real, 6, Force>;
  Beginning beginning() const { return instant<6>(x0_, v0_, Real(0)); }

  // What rounding may leave of x'' at the beginning where its terms cancel: below it x'' is taken for zero
  // (before M7.4).
  Real rounding_of_acceleration() const {
    return 4 * std::numeric_limits<Real>::epsilon() *
           (oscillator_.b() * absolute(x0_) + 2 * oscillator_.a() * absolute(v0_) +
            absolute(forcing_.amplitude));
  }

  // Whether x, or v, is proved to keep its sign in [0, t], by its ends.
  bool keeps_side(const Real& side, const Real& x, const Real& t) const {
    if (!(side * x0_ > 0 && side * x >= 0)) return false;  // a zero at the end is the next motion's
    return forcing_ ? keeps_sign(x0_, x, beginning().bound(2, t), t) : t < one_zero_within();
  }
  bool keeps_course(const Real& v, const Real& t) const {
    if (!(v0_ * v > 0)) return false;
    return forcing_ ? keeps_sign(v0_, v, beginning().bound(3, t), t) : t < one_zero_within();
  }
  // From any time on, a time in which x has one zero at most, and so has each of its derivatives.
  Real one_zero_within() const { return forcing_ ? Real(0) : oscillator_.half_period(); }
  // Whether x, zero at `from`, is proved to have no other zero until t.
  bool leaves_zero(const Real& from, const Real& t) const { return t < from + one_zero_within(); }
  // The first time in [from, until) at which sign times the `order`-th derivative of x falls through zero.
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            Search<Real>& search) const {
    if (forcing_ || !(oscillator_.half_period() < std::numeric_limits<Real>::infinity()))
      return isolate_fall<Real>([&](const Real& t) { return enclosure_at(order, sign, t, search.span); },
                                from, until, search, Real(1));
    const auto x = derivatives<4>(x0_, v0_, Real(0), Real(1));
    const Real u = sign * x[order], u1 = sign * x[order + 1];
    if (u == 0 && u1 == 0) return {};
    if (!(from > 0) && u <= 0 && u1 < 0) return from < until ? std::optional(from) : std::nullopt;
    const Real time = oscillator_.fall(u, u1, from);
    return time < until ? std::optional(time) : std::nullopt;
  }
  // |x| where it turns.
  Real height(const Real& t) const {
    if (forcing_ || !(oscillator_.half_period() < std::numeric_limits<Real>::infinity()))
      return absolute(at(t).x);
    return oscillator_.height(x0_, v0_, t);
  }
  // When x had its last turn before x'' vanished at t, for the first time; if in closed form.
  std::optional<Real> turn_before(const Real& t) const {
    const Real& half_period = oscillator_.half_period();
    if (forcing_ || !(half_period < std::numeric_limits<Real>::infinity()) || !(t < half_period)) return {};
    return t - oscillator_.turn_before();
  }
  // |x'| where that turns, if in closed form; x there is -2a/b times x'.
  std::optional<Real> speed_at_turn(const Real& t) const {
    if (forcing_ || !(oscillator_.half_period() < std::numeric_limits<Real>::infinity())) return {};
    const auto x = derivatives<4>(x0_, v0_, Real(0), Real(1));
    return oscillator_.height(x[1], x[2], t);
  }
  Real per_speed() const { return 2 * oscillator_.a() / oscillator_.b(); }
  // The `order`-th derivative of x, looked ahead from t.
  LocalEnclosure<Real> enclosure_at(std::size_t order, const Real& sign, const Real& t,
                                    const Real& span) const {
    const Change now = at(t);
    const auto x = instant<7>(now.x, now.v, t);
    return {{sign * x[order], sign * x[order + 1], sign * x[order + 2], x.bound(order + 3, span)},
            {},
            std::numeric_limits<Real>::infinity()};
  }

  // The fastest that anything happens in it.
  Real rate() const {
    return forcing_ && forcing_.frequency > oscillator_.rate() ? forcing_.frequency : oscillator_.rate();
  }
  Real panel(const Real& t) const { return panel_under(forcing_, oscillator_.panel(t)); }

 private:
  SinCos<Real> phase_at(const Real& t) const { return t == 0 ? phase_ : forcing_.phase(begin_ + t); }

  const Oscillator<Real>& oscillator_;
  Force forcing_;
  Real begin_;
  SinCos<Real> phase_;  // of the forcing at the beginning
  Real x0_, v0_;
};

}  // namespace impact_damper
