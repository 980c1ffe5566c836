// Contact with a compliant wall without modes (contact_exponential.hpp), where the split of a state into
// modes loses digits. Events are searched for (root_isolation.hpp) with the bounds (M5.9).
#pragma once

#include "impact_damper/motion/contact_modes.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/motion/motion.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

template <class Real, class Force = Forcing<Real>>
class ContactWithoutModes : public ProofsByBounds<ContactWithoutModes<Real, Force>, Real> {
 public:
  // system.coupled must not be empty.
  ContactWithoutModes(const ContactModes<Real, Force>& system, const Real& begin, const State<Real>& start,
                      Wall wall)
      : ContactWithoutModes(system, begin, system.forcing.phase(begin), start, wall,
                            Real(wall == Wall::left ? 0 : 1)) {}
  ContactWithoutModes(const ContactModes<Real, Force>& system, const Real&, const SinCos<Real>& phase,
                      const State<Real>& start, Wall wall, const Real& origin)  // as in contact.hpp
      : system_(system),
        exponential_(*system.coupled),
        start_(copied(start)),
        wall_(origin),
        inward_(wall == Wall::left ? -1 : 1),
        phase_(phase),
        size_of_force_(absolute(forcing().amplitude)) {
    s_ = {start.x,
          start.v,
          start.y - wall_,
          start.w,
          forcing().amplitude * phase.sin,
          forcing().amplitude * phase.cos};
  }

  [[gnu::noinline]] State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    const Vector s = exponential_(s_, t);
    return {s[0], s[1], wall_ + s[2], s[3]};
  }
  std::optional<ChangeOfX<Real>> change_of_x(const Real&) const { return {}; }  // not available without modes
  Real overlap(const Real& t) const { return absolute(exponential_(s_, t)[2]); }

  // Returns the end of the contact, q = 0 again, with the state then; nothing if it is not before `horizon`.
  [[gnu::noinline]] std::optional<WallEvent<Real>> leave(const Real& horizon, Search<Real>& search) const {
    Real from{0};
    if (start_.y == wall_ && start_.w == 0) {  // as in contact.hpp
      const Chain chain(*this, Real(0));
      const Real third = chain.s[3][2];
      const Real& zeta = exponential_.equations().zeta;
      const Lead<Real> lead = lead_of_x(Real(2 * zeta), Real(1), forcing(), phase_, start_.x, start_.v);
      if (lead.order > 3 && inward_ * lead.value < 0)
        from = pressed_at_least(lead, zeta, forcing());
      else if (inward_ * third > 0)
        from = begin_by_lead<Real>(3, third, chain.bound_of_q(4, search.span), search.span);
    }
    const auto fall = isolate_fall<Real>(
        [&](const Real& t) {
          const Chain chain(*this, t);
          return LocalEnclosure<Real>{{inward_ * chain.s[0][2], inward_ * chain.s[1][2],
                                       inward_ * chain.s[2][2], chain.bound_of_q(3, search.span)}};
        },
        from, horizon, search, resolution());
    if (!fall) return {};
    WallEvent<Real> end{*fall, inward_ < 0 ? Wall::left : Wall::right, at(*fall)};
    end.state.y = wall_;
    return end;
  }

  [[gnu::noinline]] LocalEnclosure<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t,
                                                         const Real& span) const {
    const Chain chain(*this, t);
    return {{sign * chain.s[order][0], sign * chain.s[order + 1][0], sign * chain.s[order + 2][0],
             chain.bound_of_x(order + 3, span)}};
  }
  std::array<Real, 4> leads_of_x() const {
    const Chain chain(*this, Real(0));
    return {chain.s[0][0], chain.s[1][0], chain.s[2][0], chain.s[3][0]};
  }
  Real panel(const Real& t) const {
    const Real slow = system_.slow.panel(t), fast = system_.fast.panel(t);
    return panel_under(system_.forcing, fast < slow ? fast : slow);
  }
  Real resolution() const { return 1 / exponential_.rate(); }
  const Real& start_x() const { return start_.x; }
  const Real& start_v() const { return start_.v; }
  Real second_of_x(const Real& t) const { return bound_of_x(2, t); }
  Real third_of_x(const Real& t) const { return bound_of_x(3, t); }

 private:
  using Vector = std::array<Real, 6>;
  // The state and its derivatives at one time.
  struct Chain {
    Chain(const ContactWithoutModes& contact, const Real& t) : motion(contact) {
      s[0] = t == 0 ? contact.s_ : contact.exponential_(contact.s_, t);
      for (std::size_t n = 1; n < s.size(); ++n)
        s[n] = contact.exponential_.template derivative<Real>(s[n - 1]);
    }
    Real size(std::size_t n) const {
      const auto& [x, v, q, w, f, g] = s[n];
      const ContactEquations<Real>& e = motion.exponential_.equations();
      return square_root(Real(x * x + v * v + e.nu * ((v + w) * (v + w) + e.stiffness * q * q)));
    }
    // Upper bound of N_n for a time `span` from here on.
    Real largest(std::size_t n, const Real& span) const {
      if (motion.size_of_force_ == 0) return size(n);
      Real power{1};
      for (std::size_t i = 0; i < n; ++i) power *= motion.forcing().frequency;
      return size(n) + motion.size_of_force_ * power * span;
    }
    Real bound_of_x(std::size_t n, const Real& span) const {
      const Real now = largest(n, span), before = largest(n - 1, span);
      return now < before ? now : before;
    }
    Real bound_of_q(std::size_t n, const Real& span) const {
      const ContactEquations<Real>& e = motion.exponential_.equations();
      const Real now = largest(n, span) / square_root(Real(e.nu * e.stiffness));
      const Real before = largest(n - 1, span) * (1 + 1 / square_root(e.nu));
      return now < before ? now : before;
    }
    const ContactWithoutModes& motion;
    std::array<Vector, 5> s;
  };

  const Forcing<Real>& forcing() const { return exponential_.equations().forcing; }
  Real bound_of_x(std::size_t n, const Real& t) const { return Chain(*this, Real(0)).bound_of_x(n, t); }

  const ContactModes<Real, Force>& system_;
  const ContactExponential<Real>& exponential_;
  State<Real> start_;
  Real wall_, inward_;
  SinCos<Real> phase_;  // of the force at the beginning
  Real size_of_force_;
  Vector s_;
};

}  // namespace impact_damper
