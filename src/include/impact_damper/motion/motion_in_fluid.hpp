// The masses of a scene with drag, by power series in pieces (docs/mathematics.md, 18.5): x, and the -q of
// each mass that slides in a fluid, which takes the place of x in (M18.8), with k = 0. The members are those
// of ShiftedMotion.
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
  using Piece = JointContact<Real, Force, true>;

 public:
  // Begins a piece. fluid: the masses that slide in a fluid, with K = q = 0; its_number[i]: that of the i-th
  // secondary mass among these, from 1 on, or 0. forces must outlive the piece.
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

  const Piece& of_x() const { return piece_; }
  const Real& length() const { return piece_.length(); }
  Real rate() const { return piece_.rate(); }
  // How long bounds hold.
  const Real& span(const Real&) const { return piece_.length(); }
  Displacement<Real> displacement(const Real& t) const { return piece_.change(t); }
  // The displacement that moves the i-th mass; x_now: that of x.
  Displacement<Real> of_mass(std::size_t i, const Real& t, const Displacement<Real>& x_now) const {
    return number_[i] == 0 ? x_now : piece_.change(all_[number_[i]].function, t);
  }
  // The integral of w^2 over [0, t] for a mass in a fluid; 0 for others.
  Real integral_of_ww(std::size_t i, const Real& t) const {
    return number_[i] == 0 ? Real(0) : piece_.integral_of_ww(number_[i] - 1, t);
  }
  Real third() { return piece_.begins(all_[0].second, 1); }
  Real bound(std::size_t order, const Real&) { return bound(all_[0], order); }
  Real bound_of_mass(std::size_t i, std::size_t order, const Real&) { return bound(all_[number_[i]], order); }

  // All at one instant: see ShiftedMotion::Now.
  class Now;

 private:
  struct Part {
    typename Piece::Function function, second;  // second: its second derivative
    std::array<Real, 6> bounds{Real(-1), Real(-1), Real(-1), Real(-1), Real(-1), Real(-1)};
    Real time{-1};  // for which these hold:
    Displacement<Real> displacement{};
    Jet<Real> jet{};  // of `second`
  };
  Real bound(Part& part, std::size_t order) {
    if (part.bounds[order] < 0)
      part.bounds[order] =
          order < 2 ? piece_.bound(part.function, order) : piece_.bound(part.second, order - 2);
    return part.bounds[order];
  }

  Piece piece_;
  std::vector<std::size_t> number_;
  std::vector<Part> all_;  // x, then the masses in a fluid
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
    // order: 2, 3 or 4
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
