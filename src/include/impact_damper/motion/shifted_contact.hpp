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
      : contact_(modes, begin, modes.forcing.phase(begin),
                 {start.x - rest[0], start.v, start.y - rest[1], start.w}, wall, Real(0)),
        rest_(rest),
        start_(start) {}

  // The motion about the place of rest.
  const Contact<Real, Force>& contact() const { return contact_; }
  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    const State<Real> now = contact_.at(t);
    return {x_at(t), now.v, rest_[1] + now.y, now.w};
  }
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
  // By its change, as x must not take the rounding errors of its place of rest, which may be much larger.
  Real x_at(const Real& t) const {
    return t == 0 ? start_.x : Real(start_.x + (start_.v * t + contact_.change_of_x(t)->dx));
  }
  static LocalEnclosure<Real> shifted(LocalEnclosure<Real> all, std::size_t order, const Real& by) {
    if (order > 0) return all;
    all.whole.g += by;
    all.main.g += by;
    return all;
  }

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
