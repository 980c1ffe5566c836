// x of the primary mass, and of what is held by it, under a constant force beside f: the friction of masses
// that slide, and the weight of those that are held. x - rest is the motion of ForcedMotion, `rest` being
// where that force would hold x at rest (docs/mathematics.md, chapter 18).
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "impact_damper/motion/forced_motion.hpp"

namespace impact_damper {

template <class Real, class Force>
class ShiftedMotion : public WithoutContact<ShiftedMotion<Real, Force>, Real> {
  using Base = WithoutContact<ShiftedMotion<Real, Force>, Real>;

 public:
  // oscillator, force: as those of ForcedMotion.
  ShiftedMotion(const Driven<Real, Force>& oscillator, const Force& force, const Real& begin, const Real& x,
                const Real& v, const Real& rest)
      : primary_(oscillator, force, begin, Real(x - rest), v), rest_(rest), x0_(x), v0_(v) {}

  // The motion of x - rest.
  const ForcedMotion<Real, Force>& primary() const { return primary_; }
  const ShiftedMotion& of_x() const { return *this; }
  Real length() const { return primary_.length(); }
  Real rate() const { return primary_.rate(); }
  // How long bounds hold, of a time that is asked for.
  const Real& span(const Real& asked) const { return asked; }
  // x''' at the beginning, and bounds on derivatives of x - rest.
  Real third() const { return primary_.beginning()[3]; }
  Real bound(std::size_t order, const Real& span) const { return primary_.bound(order, span); }
  Real bound_of_mass(std::size_t, std::size_t order, const Real& span) const { return bound(order, span); }
  Displacement<Real> displacement(const Real& t) const {
    Displacement<Real> now = primary_.at(t);
    // For a short time x must not take the rounding errors of `rest`, which may be much larger.
    if (rest_ != 0) now.x = t * primary_.rate() < 2 ? Real(x0_ + (v0_ * t + now.dx)) : Real(rest_ + now.x);
    return now;
  }
  // The displacement of what drives the i-th mass by (M18.8): that of x.
  Displacement<Real> of_mass(std::size_t, const Real&, const Displacement<Real>& x_now) const {
    return x_now;
  }

  // x at one instant, what moves each mass, which is x as well, and bounds on its derivatives, each made when
  // it is first asked for.
  class Now {
   public:
    Now(const ShiftedMotion& motion, const Real& t, const Real& span)
        : displacement_(motion.primary_.at(t)),
          x_(motion.primary_.template instant<8>(displacement_.x, displacement_.v, t)),
          span_(span) {}
    Now& of_mass(std::size_t) { return *this; }
    const Displacement<Real>& displacement() const { return displacement_; }  // of x - rest
    const Real& operator[](std::size_t order) const { return x_[order]; }
    const Real& bound(std::size_t order) {
      if (bounds_[order] < 0) bounds_[order] = x_.bound(order, span_);
      return bounds_[order];
    }

   private:
    Displacement<Real> displacement_;
    Instant<Real, 8, Force> x_;
    Real span_;
    std::array<Real, 7> bounds_{Real(-1), Real(-1), Real(-1), Real(-1), Real(-1), Real(-1), Real(-1)};
  };

  // y and y' are 0: each secondary mass has its own.
  State<Real> at(const Real& t) const {
    const Displacement<Real> now = displacement(t);
    return {now.x, now.v, Real(0), Real(0)};
  }

  bool keeps_side(const Real& side, const State<Real>& end, const Real& t) const {
    if (rest_ == 0) return Base::keeps_side(side, end, t);
    return side * x0_ > 0 && side * end.x >= 0 &&
           stays_open(Real(side * x0_), Real(side * v0_), Real(side * end.x), Real(side * end.v), t,
                      primary_.bound(4, t));
  }
  bool leaves_zero(const Real& from, const State<Real>& end, const Real& t) const {
    if (rest_ == 0) return Base::leaves_zero(from, end, t);
    return absolute(end.v) > primary_.bound(2, t) * (t - from);
  }
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            Search<Real>& search) const {
    if (rest_ == 0 || order > 0) return primary_.falls(order, sign, from, until, search);
    return isolate_fall<Real>([&](const Real& t) { return derivative_of_x(0, sign, t, search.span); }, from,
                              until, search, Base::resolution());
  }
  Real height(const Real& t) const { return rest_ == 0 ? primary_.height(t) : absolute(at(t).x); }
  LocalEnclosure<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t,
                                       const Real& span) const {
    if (rest_ == 0 || order > 0) return primary_.enclosure_at(order, sign, t, span);
    const Displacement<Real> now = displacement(t);
    const auto x = primary_.template instant<5>(Real(now.x - rest_), now.v, t);
    return {{sign * now.x, sign * now.v, sign * x[2], x.bound(3, span)},
            {sign * rest_, Real(0), Real(0), Real(0)},
            x.bound(0, span)};
  }
  std::array<Real, 4> leads_of_x() const {
    const auto x = primary_.beginning();
    return {x0_, v0_, x[2], x[3]};
  }

 private:
  ForcedMotion<Real, Force> primary_;
  Real rest_, x0_, v0_;
};

}  // namespace impact_damper
