// A piece of the motion of a scene with drag, between rigid walls, by the power series of (M18.20) with K = 0
// (docs/mathematics.md, 18.5). By (M18.8) a secondary mass moves in its cavity by the displacement of x and a
// constant pull k. In a fluid the same holds with k = 0 and -q in place of x, q being by how much y has grown
// since the piece began: so each mass has something that drives it, x or -q. What the engine asks for it asks
// ShiftedMotion for as well.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/motion/joint_contact.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/motion/system.hpp"

namespace impact_damper {

template <class Real, class Force>
class MotionInFluid {
  using Piece = JointContact<Real, Force, true>;  // with components

 public:
  // Begins a piece. fluid: the masses that slide in a fluid, as walls that do not push: K = 0, and q = 0 now.
  // its_number[i]: of the i-th secondary mass, 1 + its index in `fluid`, or 0 if it is not there. forces must
  // outlive the piece.
  void begin(const System<Real, Force>& system, const Real& time, const Real& x, const Real& v,
             const std::vector<PushedWall<Real>>& fluid, const std::vector<std::size_t>& its_number,
             const ConstantForces<Real>& forces) {
    piece_.set_walls(system.zeta, system.forcing, fluid);
    piece_.set_forces(forces);
    piece_.begin(time, x, v, fluid);
    number_ = its_number;
    all_.assign(1, Part{piece_.of_x(Real(1), 0), piece_.of_x(Real(1), 2)});
    for (std::size_t n = 0; n < fluid.size(); ++n)
      all_.push_back({piece_.of_mass(n, Real(-1), 0), piece_.of_mass(n, Real(-1), 2)});
  }

  // The motion (motion.hpp) of x alone.
  const Piece& of_x() const { return piece_; }
  const Real& length() const { return piece_.length(); }
  Real rate() const { return piece_.rate(); }  // (M17.17)
  // How long bounds hold, of a time that is asked for: for the whole piece, beyond which no search goes.
  const Real& span(const Real& /*asked*/) const { return piece_.length(); }
  Displacement<Real> displacement(const Real& t) const { return piece_.change(t); }
  // The displacement of what drives the i-th mass; x_now: that of x.
  Displacement<Real> of_mass(std::size_t i, const Real& t, const Displacement<Real>& x_now) const {
    return number_[i] == 0 ? x_now : piece_.change(all_[number_[i]].function, t);
  }
  // The integral of y'^2 over [0, t] of the i-th mass, which must be in a fluid: what drag takes, by nu d.
  Real integral_of_ww(std::size_t i, const Real& t) const { return piece_.integral_of_ww(number_[i] - 1, t); }
  // x''' at the beginning, and bounds on the derivatives of x and of what drives the i-th mass; order: 0
  // to 5.
  Real third() { return piece_.begins(all_[0].second, 1); }
  Real bound(std::size_t order, const Real& /*span*/) { return bound(all_[0], order); }
  Real bound_of_mass(std::size_t i, std::size_t order, const Real& /*span*/) {
    return bound(all_[number_[i]], order);
  }

  // What drives each mass at one instant, as ShiftedMotion::Now. One in use at a time, until begin().
  class Now;

 private:
  struct Part {
    typename Piece::Function function, second;  // second: its second derivative
    std::array<Real, 6> bounds{Real(-1), Real(-1), Real(-1),
                               Real(-1), Real(-1), Real(-1)};  // -1: not made yet
    Real time{-1};                                             // of displacement and jet
    Displacement<Real> displacement{};
    Jet<Real> jet{};  // of `second`: its g, g1 and g2 are derivatives of the orders 2, 3 and 4
  };
  Real bound(Part& part, std::size_t order) {
    if (part.bounds[order] < 0)
      part.bounds[order] =
          order < 2 ? piece_.bound(part.function, order) : piece_.bound(part.second, order - 2);
    return part.bounds[order];
  }

  Piece piece_;
  std::vector<std::size_t> number_;
  std::vector<Part> all_;  // x, then -q of each mass in a fluid: number_ is the index
};

template <class Real, class Force>
class MotionInFluid<Real, Force>::Now {
 public:
  class One {
   public:
    One(MotionInFluid& motion, Part& part, const Real& t) : motion_(motion), part_(part) {
      if (part.time == t) return;
      part.time = t;
      part.displacement = motion.piece_.change(part.function, t);
      part.jet = motion.piece_.enclosure(part.second, t).whole;
    }
    const Displacement<Real>& displacement() const { return part_.displacement; }
    // The derivative of this order: 2, 3 or 4.
    const Real& operator[](std::size_t order) const {
      return order == 2 ? part_.jet.g : order == 3 ? part_.jet.g1 : part_.jet.g2;
    }
    Real bound(std::size_t order) const { return motion_.bound(part_, order); }

   private:
    MotionInFluid& motion_;
    Part& part_;
  };

  Now(MotionInFluid& motion, const Real& t, const Real&) : motion_(motion), t_(t) {}
  One of_x() { return {motion_, motion_.all_[0], t_}; }
  One of_mass(std::size_t i) { return {motion_, motion_.all_[motion_.number_[i]], t_}; }

 private:
  MotionInFluid& motion_;
  Real t_;
};

}  // namespace impact_damper
