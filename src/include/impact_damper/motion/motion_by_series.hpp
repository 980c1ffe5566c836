// A piece of the motion of a scene with components in which masses push compliant walls or slide in a fluid,
// by the power series of (M18.20) (docs/mathematics.md, chapter 18). By (M18.8) a secondary mass moves in its
// cavity by the displacement of x and a constant pull k. For one of the series the same holds with k = 0 and
// -q in place of x: so each mass has something that drives it, x or -q. What the engines ask for they ask
// ShiftedMotion for as well.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/motion/joint_contact.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

template <class Real, class Force>
class MotionBySeries {
  using Piece = JointContact<Real, Force, true>;  // with components

 public:
  // Begins a piece. pushed: the masses of the series; one that slides in a fluid has K = 0, and q = 0 now.
  // forces must outlive the piece.
  void begin(const Real& zeta, const Force& forcing, const Real& time, const Real& x, const Real& v,
             const std::vector<PushedWall<Real>>& pushed, const ConstantForces<Real>& forces) {
    piece_.set_walls(zeta, forcing, pushed);
    piece_.set_forces(forces);
    piece_.begin(time, x, v, pushed);
    all_.assign(1, Part{piece_.of_x()});
    for (std::size_t n = 0; n < pushed.size(); ++n) all_.push_back({piece_.of_minus_q(n)});
  }

  // The motion (motion.hpp) of x alone.
  const Piece& of_x() const { return piece_; }
  const Real& length() const { return piece_.length(); }
  Real rate() const { return piece_.rate(); }  // (M17.17)
  // How long bounds hold, of a time that is asked for: for the whole piece, beyond which no search goes.
  const Real& span(const Real& /*asked*/) const { return piece_.length(); }
  Displacement<Real> displacement(const Real& t) const { return piece_.change(t); }
  Real resolution() const { return piece_.resolution(); }
  // The displacement of what drives a mass, by 1 + its index in `pushed`, or 0 if it is not there; x_now:
  // that of x.
  Displacement<Real> of_mass(std::size_t number, const Real& t, const Displacement<Real>& x_now) const {
    return number == 0 ? x_now : piece_.now(all_[number].terms, t).displacement;
  }
  // The integral of y'^2 over [0, t] of a mass, which must be in the series: what drag takes, by nu d.
  Real integral_of_ww(std::size_t number, const Real& t) const {
    return piece_.integral_of_ww(number - 1, t);
  }
  // x''' at the beginning, and bounds on the derivatives of x and of what drives a mass; order: 0 to 6.
  Real third() { return piece_.derivative(all_[0].terms, 3, Real(0)); }
  Real bound(std::size_t order, const Real& /*span*/) { return bound(all_[0], order); }
  Real bound_of_mass(std::size_t number, std::size_t order, const Real& /*span*/) {
    return bound(all_[number], order);
  }

  // What drives each mass at one instant, as ShiftedMotion::Now. One in use at a time, until begin().
  class Now;

 private:
  struct Part {
    typename Piece::Terms terms;
    std::array<Real, 7> bounds{Real(-1), Real(-1), Real(-1), Real(-1),
                               Real(-1), Real(-1), Real(-1)};  // -1: not made yet
    Real time{-1};                                             // of `now`
    typename Piece::Now now{};
  };
  Real bound(Part& part, std::size_t order) {
    if (part.bounds[order] < 0) part.bounds[order] = piece_.bound(part.terms, order);
    return part.bounds[order];
  }

  Piece piece_;
  std::vector<Part> all_;  // x, then -q of each mass of the series
};

template <class Real, class Force>
class MotionBySeries<Real, Force>::Now {
 public:
  class One {
   public:
    One(MotionBySeries& motion, Part& part, const Real& t) : motion_(motion), part_(part), t_(t) {}
    const Displacement<Real>& displacement() const { return now().displacement; }
    // The derivative of this order: 2, 3 or 4.
    Real operator[](std::size_t order) const {
      return order == 2 ? now().second : motion_.piece_.derivative(part_.terms, order, t_);
    }
    Real bound(std::size_t order) const { return motion_.bound(part_, order); }

   private:
    const typename Piece::Now& now() const {
      if (part_.time != t_) {
        part_.time = t_;
        part_.now = motion_.piece_.now(part_.terms, t_);
      }
      return part_.now;
    }
    MotionBySeries& motion_;
    Part& part_;
    Real t_;
  };

  Now(MotionBySeries& motion, const Real& t, const Real&) : motion_(motion), t_(t) {}
  One of_mass(std::size_t number) { return {motion_, motion_.all_[number], t_}; }

 private:
  MotionBySeries& motion_;
  Real t_;
};

}  // namespace impact_damper
