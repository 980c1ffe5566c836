// Sticking: both masses move as one, the secondary at rest on a wall (M2.3); y'' = 0 in place of the paper's
// (10). The secondary masses of several dampers may stick at once (M17.1).
#pragma once

#include "impact_damper/motion/forced_motion.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

// The motion of the primary mass and the masses that stick to it. push: the direction in which the walls push
// these, 1 on left walls, -1 on right ones; 0 if none sticks.
template <class Real, class Force = Forcing<Real>>
class JoinedMasses : public WithoutContact<JoinedMasses<Real, Force>, Real> {
 public:
  // oscillator, force: those of all these masses together.
  JoinedMasses(const Driven<Real, Force>& oscillator, const Force& force, const Real& begin, const Real& x,
               const Real& v, const Real& push)
      : primary_(oscillator, force, begin, x, v), push_(push) {}

  const ForcedMotion<Real, Force>& primary() const { return primary_; }
  // y and y' are 0: with several dampers each mass has its own.
  State<Real> at(const Real& t) const {
    const auto now = primary_.at(t);
    return {now.x, now.v, Real(0), Real(0)};
  }
  // Returns the first time in [from, horizon) at which x'', and with it the wall's push, falls through zero.
  std::optional<Real> release(const Real& from, const Real& horizon, Search<Real>& search) {
    // The push that the mass sticks by was that of the flight before; rounding may leave none of it. A search
    // from `from` > 0 would then find its next zero, a period later.
    const auto start = primary_.beginning();
    const Real push = push_ * start[2], change_of_push = push_ * start[3];
    const Lead<Real> lead = primary_.lead();
    const bool by_lead = lead.order > 3;  // x'' and x''' are rounding errors
    if (by_lead ? push_ * lead.value < 0 : push <= 0 && change_of_push < 0)
      return from < horizon ? std::optional(from) : std::nullopt;
    const Real begin = by_lead ? begin_by_lead<Real>(lead.order - 2, lead.value,
                                                     start.bound(lead.order + 1, search.span), search.span)
                               : Real(0);
    const auto released = primary_.falls(2, push_, from < begin ? begin : from, horizon, search);
    if (released) turning_point_ = primary_.turning_point_before(*released);
    return released;
  }
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            Search<Real>& search) const {
    // Until the release x'' has the sign of push_, so sign x' falls through zero only for sign = -push_, and
    // once at most.
    if (order == 1 && turning_point_)
      return sign != push_ && *turning_point_ >= from && *turning_point_ < until ? turning_point_
                                                                                 : std::nullopt;
    return primary_.falls(order, sign, from, until, search);
  }

 protected:
  ForcedMotion<Real, Force> primary_;
  Real push_;

 private:
  std::optional<Real> turning_point_;  // of x, before the release, once that is known
};

template <class Real, class Force = Forcing<Real>>
class Stuck : public JoinedMasses<Real, Force> {
 public:
  Stuck(const System<Real, Force>& system, const Real& begin, const Real& x, const Real& v, Wall wall)
      : JoinedMasses<Real, Force>(system.stuck,
                                  {system.forcing.amplitude / (1 + system.nu), system.forcing.frequency},
                                  begin, x, v, wall == Wall::left ? Real(1) : Real(-1)),
        start_{x, v, wall == Wall::left ? Real(0) : Real(1), Real(0)} {}

  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    const auto now = primary_.at(t);
    return {now.x, now.v, start_.y, Real(0)};
  }
  // The state at the time t of release(). x'' = 0, so |x'| has a closed form, and x follows from x' to the
  // last bit.
  State<Real> released(const Real& t) const {
    if (t == 0) return start_;
    const auto v = primary_.speed_at_inflection(t);
    return v ? State<Real>{-push_ * *v * primary_.per_speed(), push_ * *v, start_.y, Real(0)} : at(t);
  }

 private:
  using JoinedMasses<Real, Force>::primary_;
  using JoinedMasses<Real, Force>::push_;
  State<Real> start_;
};

}  // namespace impact_damper
