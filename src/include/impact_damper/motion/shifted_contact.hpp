// Contact with a compliant wall under friction and weight (docs/mathematics.md, M18.21): what is constant in
// it only shifts the place of rest, about which x and q move as in contact.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "impact_damper/motion/contact.hpp"
#include "impact_damper/motion/contact_work.hpp"

namespace impact_damper {

template <class Real, class Force>
class ShiftedContact : public ProofsByBounds<ShiftedContact<Real, Force>, Real> {
 public:
  // modes: of the wall, with its damper and the drag. rest: x and q where all forces would hold both masses
  // at rest; start: x, x', q in the place of y, and q'.
  ShiftedContact(const ContactModes<Real, Force>& modes, const Real& begin, const State<Real>& start,
                 Wall wall, const std::array<Real, 2>& rest)
      : modes_(modes),
        contact_(modes, begin, modes.forcing.phase(begin),
                 {start.x - rest[0], start.v, start.y - rest[1], start.w}, wall, Real(0)),
        rest_(rest),
        start_(start) {}

  // The motion about the place of rest.
  const Contact<Real, Force>& contact() const { return contact_; }
  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    State<Real> now = shifted(contact_.at(t));
    // By its change, as x must not take the rounding errors of its place of rest, which may be much larger.
    if (rest_[0] != 0) now.x = x_at(t);
    return now;
  }
  // Returns q and its first three derivatives at t, by (M2.2).
  std::array<Real, 4> leads_of_q(const Real& t) const {
    const ContactModes<Real, Force>& c = modes_;
    const State<Real> now = t == 0 ? start_ : shifted(contact_.at(t));
    const auto f = c.forcing.template derivatives<2>(contact_.phase_at(t));
    const auto wall = [&](const Real& q, const Real& q1) { return c.damping * q1 + c.stiffness * q; };
    const Real push = wall(Real(now.y - rest_[1]), now.w),
               x2 = f[0] - 2 * c.zeta * now.v - (now.x - rest_[0]) + c.nu * push, q2 = -(x2 + push);
    const Real push1 = wall(now.w, q2), x3 = f[1] - 2 * c.zeta * x2 - now.v + c.nu * push1;
    return {now.y, now.w, q2, -(x3 + push1)};
  }
  // A bound on the `order`-th derivative of q, 4 or 5, for a time `span`.
  Real bound_of_q(std::size_t order, const Real& span) const { return contact_.high_bound_of_q(order, span); }
  // Encloses sign times the `order`-th derivative of q, 0 or 1, from t until t + span.
  LocalEnclosure<Real> derivative_of_q(std::size_t order, const Real& sign, const Real& t,
                                       const Real& span) const {
    return shifted(contact_.derivative_of_q(order, sign, t, span), order, Real(sign * rest_[1]));
  }
  LocalEnclosure<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t,
                                       const Real& span) const {
    auto all = shifted(contact_.derivative_of_x(order, sign, t, span), order, Real(sign * rest_[0]));
    if (order == 0) all.whole.g = sign * x_at(t);
    return all;
  }
  std::array<Real, 4> leads_of_x() const {
    auto leads = contact_.leads_of_x();
    leads[0] = start_.x;
    return leads;
  }
  const Real& start_x() const { return start_.x; }
  const Real& start_v() const { return start_.v; }
  Real second_of_x(const Real& t) const { return contact_.bound_of_x(2, t); }
  Real third_of_x(const Real& t) const { return contact_.bound_of_x(3, t); }
  Real panel(const Real& t) const { return contact_.panel(t); }
  Real resolution() const { return contact_.resolution(); }

 private:
  State<Real> shifted(const State<Real>& by) const { return {rest_[0] + by.x, by.v, rest_[1] + by.y, by.w}; }
  Real x_at(const Real& t) const {
    return t == 0 ? start_.x : Real(start_.x + (start_.v * t + contact_.change_of_x(t)->dx));
  }
  static LocalEnclosure<Real> shifted(LocalEnclosure<Real> all, std::size_t order, const Real& by) {
    if (order > 0) return all;
    all.whole.g += by;
    all.main.g += by;
    return all;
  }

  const ContactModes<Real, Force>& modes_;
  Contact<Real, Force> contact_;
  std::array<Real, 2> rest_;
  State<Real> start_;
};

template <class Real, class Force>
Work<Real> work_of(const System<Real, Force>& system, const ShiftedContact<Real, Force>& shifted,
                   const Real& begin, const Real& duration, const Real& wall_damping, Search<Real>& search) {
  return work_of(system, shifted.contact(), begin, duration, wall_damping, search);
}

}  // namespace impact_damper
