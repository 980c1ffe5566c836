// The motion during a contact with a compliant wall (M2.2) in closed form.
//
// x and the overlap q (y at the left wall, y - 1 at the right) are each the sum of a slow mode, in which both
// masses move together, and a fast mode, in which the wall gives way (M5.3). A state is split into the two
// (contact_modes.hpp), and each moves by its own oscillator's C and S (oscillator.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <type_traits>

#include "impact_damper/motion/contact_modes.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

template <class Real, class Force>
class ContactMotion {
 public:
  static constexpr bool forced = !std::is_same_v<Force, NoForcing<Real>>;
  // A part of x or q at one time, with its derivatives and bounds on them from then on.
  using Part = Instant<Real, 6, Force>;
  struct Instants {
    Part slow, fast;
  };

  // system: must outlive this object. begin: the time of the run from which all times below are counted.
  // phase: of the force then. origin: the position of the wall on the axis of start.y, 0 for the left wall
  // and 1 for the right one, or 0 for either if start.y is counted from the wall, with all digits of q.
  ContactMotion(const ContactModes<Real, Force>& system, const Real& begin, const SinCos<Real>& phase,
                const State<Real>& start, Wall wall, const Real& origin)
      : system_(system),
        begin_(begin),
        phase_(phase),
        start_(copied(start)),
        wall_(origin),
        inward_(wall == Wall::left ? -1 : 1) {}

  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    const ContactState<Real> s = sum_at(t);
    return {s.x, s.v, wall_ + s.q, s.w};
  }

  // Returns |q| at t, at the right wall with the digits that y - 1 does not have.
  Real overlap(const Real& t) const { return absolute(sum_at(t).q); }
  // x, x', q and q' at t. For a short time the parts of a small q are large and cancel, so the changes since
  // the beginning are summed instead.
  ContactState<Real> sum_at(const Real& t) const {
    return by_changes(t) ? sum_of_changes(t) : sum_of(slow_at(t), fast_at(t));
  }
  // x - (x0 + x'0 t) and x' - x'0, summed from the changes of the two parts, not as differences of x and x'.
  std::optional<ChangeOfX<Real>> change_of_x(const Real& t) const {
    const ContactModes<Real, Force>& c = system_;
    const bool is_short = is_short_time(t);
    const ContactState<Real> by_slow = change(c.slow, parts().slow, c.drive_slow, t, is_short),
                             by_fast = change(c.fast, parts().fast, c.drive_fast, t, is_short);
    return ChangeOfX<Real>{by_slow.x + by_fast.x, by_slow.v + by_fast.v};
  }
  // The two parts of x, x', q and q' at t.
  ContactState<Real> slow_at(const Real& t) const {
    return move(system_.slow, parts().slow, system_.drive_slow, t);
  }
  ContactState<Real> fast_at(const Real& t) const {
    return move(system_.fast, parts().fast, system_.drive_fast, t);
  }
  const ContactModes<Real, Force>& system() const { return system_; }

  // Encloses inward() q, the depth of the secondary mass in the wall, from t until t + span. It falls through
  // zero at the contact's end.
  LocalEnclosure<Real> depth(const Real& t, const Real& span) const {
    return derivative_of_q(0, inward_, t, span);
  }
  // Encloses sign, 1 or -1, times the `order`-th derivative of q, 0 or 1, from t until t + span.
  LocalEnclosure<Real> derivative_of_q(std::size_t order, const Real& sign, const Real& t,
                                       const Real& span) const {
    const ContactState<Real> slow = slow_at(t), fast = fast_at(t),
                             both = by_changes(t) ? sum_of_changes(t) : sum_of(slow, fast);
    LocalEnclosure<Real> ahead = look(instants_of_q(slow, fast, t), order, sign, span);
    if (order == 0) ahead.whole.g = sign * both.q;
    (order == 0 ? ahead.whole.g1 : ahead.whole.g) = sign * both.w;
    return ahead;
  }
  // Encloses sign, 1 or -1, times the `order`-th derivative of x, 0 or 1, from t until t + span.
  LocalEnclosure<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t,
                                       const Real& span) const {
    const ContactState<Real> slow = slow_at(t), fast = fast_at(t),
                             both = by_changes(t) ? sum_of_changes(t) : sum_of(slow, fast);
    LocalEnclosure<Real> ahead = look(instants_of_x(slow, fast, t), order, sign, span);
    // Early in a contact the two parts of a small x or x' are large and cancel.
    if (order == 0) ahead.whole.g = sign * both.x;
    if (order == 1) ahead.whole.g = sign * both.v;
    return ahead;
  }

  // x and its first three derivatives at the beginning: from the equations, not from the parts, whose
  // rounding errors would decide where a derivative is zero.
  std::array<Real, 4> leads_of_x() const {
    const ContactModes<Real, Force>& c = system_;
    const auto f = c.forcing.template derivatives<2>(phase_);
    const Real force = c.damping * start_.w + c.stiffness * (start_.y - wall_);
    const Real x2 = c.nu * force - 2 * c.zeta * start_.v - start_.x + f[0], w1 = -force - x2;
    const Real x3 = c.nu * (c.damping * w1 + c.stiffness * start_.w) - 2 * c.zeta * x2 - start_.v + f[1];
    return {start_.x, start_.v, x2, x3};
  }

  // Returns q''' at the beginning of a contact with q = q' = 0 there.
  Real third_of_q_at_rest() const {
    const auto x = leads_of_x();
    return system_.damping * x[2] - x[3];
  }
  // Bounds on the `order`-th derivative of x and q for a time t from the beginning on.
  Real bound_of_x(std::size_t order, const Real& t) const {
    const auto [slow, fast] = instants_of_x(Real(0));
    return slow.bound(order, t) + fast.bound(order, t);
  }
  Real bound_of_q(std::size_t order, const Real& t) const {
    const auto [slow, fast] = instants_of_q(Real(0));
    return slow.bound(order, t) + fast.bound(order, t);
  }

  // bound_of_q() for an order up to 5, which takes one more derivative than others need.
  Real high_bound_of_q(std::size_t order, const Real& t) const {
    const auto bound = [&](const ContactState<Real>& now, const Oscillator<Real>& oscillator,
                           const ContactState<Real>& drive) {
      return Instant<Real, 7, Force>(oscillator, now.q, now.w, on_f(oscillator, drive.q, drive.w), drive.q,
                                     system_.forcing, phase_)
          .bound(order, t);
    };
    return bound(slow_at(Real(0)), system_.slow, system_.drive_slow) +
           bound(fast_at(Real(0)), system_.fast, system_.drive_fast);
  }

  // The modal split of the start, made at the first call: the short-contact map does not need it.
  const ContactParts<Real>& parts() const {
    if (!parts_) {
      parts_.emplace();
      system_.split({start_.x, start_.v, start_.y - wall_, start_.w}, parts_->slow, parts_->fast);
    }
    return *parts_;
  }
  // Whether x and q at t are summed from their changes since the beginning.
  bool by_changes(const Real& t) const { return t == 0 || is_short_time(t); }

  // The two parts of q, and of x, at t.
  Instants instants_of_q(const Real& t) const { return instants_of_q(slow_at(t), fast_at(t), t); }
  Instants instants_of_x(const Real& t) const { return instants_of_x(slow_at(t), fast_at(t), t); }
  SinCos<Real> phase_at(const Real& t) const {
    if (t == 0) return phase_;
    if constexpr (!forced) {
      return system_.forcing.phase(begin_ + t);
    } else {
      if (last_.at_time(t).phase) return *last_.phase;
      return last_.phase.emplace(system_.forcing.phase(begin_ + t));
    }
  }
  // Returns the length of a quadrature panel that begins at t.
  Real panel(const Real& t) const {
    const Real slow = system_.slow.panel(t), fast = system_.fast.panel(t);
    return panel_under(system_.forcing, fast < slow ? fast : slow);
  }
  // Returns the shortest time in which x changes.
  Real resolution() const { return system_.fast.rate() > 1 ? 1 / system_.fast.rate() : Real(1); }
  const State<Real>& start() const { return start_; }
  const Real& inward() const { return inward_; }  // -1 at the left wall, 1 at the right one
  Wall wall() const { return inward_ < 0 ? Wall::left : Wall::right; }

 private:
  // The propagator of a part over a time t, and its response to the force.
  struct Carrier {
    Propagator<Real> propagator;
    DrivenResponse<Real> driven{};
  };
  [[gnu::always_inline]] Carrier carrier(const Oscillator<Real>& oscillator, const Real& t) const {
    if constexpr (!forced) {
      return {oscillator.propagate(t)};
    } else {
      Last& last = last_.at_time(t);
      std::optional<Carrier>& known = &oscillator == &system_.slow ? last.slow : last.fast;
      if (!known) {
        known.emplace(Carrier{oscillator.propagate(t)});
        known->driven = oscillator.respond(system_.forcing, phase_, t, known->propagator);
      }
      return *known;
    }
  }

  // A displacement that is driven by `drive` and its velocity by `drive1` obeys the oscillator's equation
  // under (drive1 + 2 a drive) f + drive f'.
  static Real on_f(const Oscillator<Real>& oscillator, const Real& drive, const Real& drive1) {
    return drive1 + 2 * oscillator.a() * drive;
  }
  Part instant_of_q(const ContactState<Real>& now, const Oscillator<Real>& oscillator,
                    const ContactState<Real>& drive, const Real& t) const {
    return {oscillator, now.q,           now.w,      on_f(oscillator, drive.q, drive.w),
            drive.q,    system_.forcing, phase_at(t)};
  }
  Part instant_of_x(const ContactState<Real>& now, const Oscillator<Real>& oscillator,
                    const ContactState<Real>& drive, const Real& t) const {
    return {oscillator, now.x,           now.v,      on_f(oscillator, drive.x, drive.v),
            drive.x,    system_.forcing, phase_at(t)};
  }
  Instants instants_of_q(const ContactState<Real>& slow, const ContactState<Real>& fast,
                         const Real& t) const {
    return {instant_of_q(slow, system_.slow, system_.drive_slow, t),
            instant_of_q(fast, system_.fast, system_.drive_fast, t)};
  }
  Instants instants_of_x(const ContactState<Real>& slow, const ContactState<Real>& fast,
                         const Real& t) const {
    return {instant_of_x(slow, system_.slow, system_.drive_slow, t),
            instant_of_x(fast, system_.fast, system_.drive_fast, t)};
  }
  ContactState<Real> move(const Oscillator<Real>& oscillator, const ContactState<Real>& from,
                          const ContactState<Real>& drive, const Real& t) const {
    // Under a force the x' and q' of a part include drive.x f and drive.q f, which `from` lacks at t = 0,
    // too.
    if (t == 0 && !system_.forcing) return from;
    const auto [p, driven] = carrier(oscillator, t);
    const Real s1 = -oscillator.b() * p.s;
    ContactState<Real> to{p.c * from.x + p.s * from.v, s1 * from.x + p.v * from.v,
                          p.c * from.q + p.s * from.w, s1 * from.q + p.v * from.w};
    if (system_.forcing) add_driven(to, oscillator, drive, driven, t);
    return to;
  }

  static ContactState<Real> sum_of(const ContactState<Real>& slow, const ContactState<Real>& fast) {
    return {slow.x + fast.x, slow.v + fast.v, slow.q + fast.q, slow.w + fast.w};
  }
  ContactState<Real> sum_of_changes(const Real& t) const {
    const Real q0 = start_.y - wall_;
    if (t == 0) return {start_.x, start_.v, q0, start_.w};
    const ContactModes<Real, Force>& c = system_;
    const ContactState<Real> by_slow = change(c.slow, parts().slow, c.drive_slow, t),
                             by_fast = change(c.fast, parts().fast, c.drive_fast, t);
    return {start_.x + (start_.v * t + (by_slow.x + by_fast.x)), start_.v + (by_slow.v + by_fast.v),
            q0 + (start_.w * t + (by_slow.q + by_fast.q)), start_.w + (by_slow.w + by_fast.w)};
  }

  // Whether t is so short that the changes of the parts are summed, not the parts.
  bool is_short_time(const Real& t) const {
    return t * system_.fast.rate() < Real(0.5) && t * system_.slow.rate() < Real(0.5);
  }
  // Returns the departure of a part from its straight line, in x and q, and the change of its x' and q'. For
  // a short time the terms that both parts have in common, with opposite signs, are left out.
  ContactState<Real> change(const Oscillator<Real>& oscillator, const ContactState<Real>& from,
                            const ContactState<Real>& drive, const Real& t, bool is_short = true) const {
    const auto [p, driven] = carrier(oscillator, t);
    const Real s1 = -oscillator.b() * p.s, v1 = p.c1 - 2 * oscillator.a() * p.s;
    ContactState<Real> by{p.c1 * from.x + p.s1 * from.v, s1 * from.x + v1 * from.v,
                          p.c1 * from.q + p.s1 * from.w, s1 * from.q + v1 * from.w};
    if (system_.forcing) {
      // (M5.10): the terms common to both parts, which would cancel, are left out: the integral of f of x and
      // q, and f of x' and q'.
      if (is_short && driven.integral) {
        add_driven(by, drive, driven, -oscillator.b() * *driven.integral, -oscillator.b() * driven.d);
      } else {
        add_driven(by, oscillator, drive, driven, t);
      }
    }
    return by;
  }
  void add_driven(ContactState<Real>& to, const Oscillator<Real>& oscillator, const ContactState<Real>& drive,
                  const DrivenResponse<Real>& driven, const Real& t) const {
    const Real f = system_.forcing.template derivatives<2>(phase_at(t))[0];
    const Real on_displacement = driven.d1 + 2 * oscillator.a() * driven.d;  // response to C instead of S
    const Real on_velocity = f - oscillator.b() * driven.d;                  // its derivative
    add_driven(to, drive, driven, on_displacement, on_velocity);
  }
  static void add_driven(ContactState<Real>& to, const ContactState<Real>& drive,
                         const DrivenResponse<Real>& driven, const Real& on_displacement,
                         const Real& on_velocity) {
    to.x += drive.v * driven.d + drive.x * on_displacement;
    to.v += drive.v * driven.d1 + drive.x * on_velocity;
    to.q += drive.w * driven.d + drive.q * on_displacement;
    to.w += drive.w * driven.d1 + drive.q * on_velocity;
  }

  static LocalEnclosure<Real> look(const Instants& now, std::size_t n, const Real& sign, const Real& span) {
    const auto& [slow, fast] = now;
    const Real slow_third = slow.bound(n + 3, span), fast_third = fast.bound(n + 3, span);
    return {{sign * (slow[n] + fast[n]), sign * (slow[n + 1] + fast[n + 1]),
             sign * (slow[n + 2] + fast[n + 2]), slow_third + fast_third},
            {sign * (slow[n] + fast.steady(n)), sign * (slow[n + 1] + fast.steady(n + 1)),
             sign * (slow[n + 2] + fast.steady(n + 2)), slow_third + fast.steady_bound(n + 3)},
            fast.transient(n)};
  }

 protected:
  const ContactModes<Real, Force>& system_;
  Real begin_;
  SinCos<Real> phase_;  // of the force then
  State<Real> start_;
  Real wall_, inward_;
  mutable std::optional<ContactParts<Real>> parts_;

 private:
  // Under a force, what was computed for the latest time: a search evaluates one time several times in turn.
  struct Nothing {};
  struct Last {
    Real time{-1};
    std::optional<SinCos<Real>> phase{};
    std::optional<Carrier> slow{}, fast{};
    Last& at_time(const Real& t) {
      if (t != time) *this = {t};
      return *this;
    }
  };
  [[no_unique_address]] mutable std::conditional_t<forced, Last, Nothing> last_;
};

}  // namespace impact_damper
