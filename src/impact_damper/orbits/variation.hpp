// The variational equations along a run: what a small change of the state, of omega_f or of f0 becomes, to
// first order (docs/mathematics.md, 13.2 to 13.4). An observer of the closed-form engines computes it.
//
// Each motion is linear, so its derivative is the propagator of the motion itself; each event adds a
// saltation matrix (M13.4). Nothing is approximated by differences.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "impact_damper/engine.hpp"
#include "impact_damper/motion/contact.hpp"
#include "impact_damper/motion/contact_without_modes.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/sticking.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/orbits/saltation.hpp"

namespace impact_damper {

// `receiver` is called in the order of time:
//   receiver.step(a, by_parameters)  a change s of the state becomes a s; by_parameters(), if called, returns
//                                    what changes of omega_f and f0, 4 x 2, add to it in this step
//   receiver.joined()                from now on y and w do not vary: two dimensions are lost
//   receiver.pieces(loss)            number of steps for a motion that contracts volumes by exp(-loss)
template <class Real, class Receiver>
class Variation {
 public:
  using Force = Forcing<Real>;
  using UnforcedModes = ContactModes<Real, NoForcing<Real>>;

  // zeta_m: damping ratio of compliant walls; absent for rigid ones.
  Variation(const Scene& scene, const std::optional<Real>& zeta_m, Receiver& receiver)
      : system_(scene),
        unforced_(scene),
        contact_(zeta_m ? std::optional<UnforcedModes>(std::in_place, unforced_, *zeta_m) : std::nullopt),
        receiver_(receiver) {}

  // The observer's functions: a motion that has ended, with its beginning, its duration and its last state.
  void passed(const Flight<Real, Force>& flight, const Real& begin, const Real& duration,
              const State<Real>& end) {
    const State<Real> start = flight.at(Real(0));
    if (last_ == Kind::flight && !flight.goes_on()) step(impact(start, begin));
    if (last_ == Kind::contact) step(contact_edge(system_.nu, contact_->damping, -1));
    last_ = Kind::flight;
    end_ = end;
    const auto propagator = [&](const Real& t) {  // (M13.2)
      const Propagator<Real> p = system_.free.propagate(t);
      const Real a = system_.free.a(), slowed = p.c1 - 2 * a * p.s;  // S' - 1
      return RowsOfState<Real, 4>{
          {{p.c, p.s, 0, 0}, {-p.s, p.v, 0, 0}, {-p.c1, -p.s1, 1, t}, {p.s, -slowed, 0, 1}}};
    };
    const auto kick = [&](const Real& t) {  // impulse response, as in move()
      const Propagator<Real> p = system_.free.propagate(t);
      return Rates<Real>{p.s, p.v, -p.s, -p.v};
    };
    move(flight, begin, duration, 2 * system_.zeta, propagator, kick);
  }

  void passed(const Stuck<Real, Force>& stuck, const Real& begin, const Real& duration,
              const State<Real>& end) {
    if (last_ == Kind::flight) {
      step(impact(stuck.at(Real(0)), begin, true));
    } else {
      step(joining_jump(system_.nu));
    }
    receiver_.joined();
    last_ = Kind::stuck;
    end_ = end;
    const auto propagator = [&](const Real& t) {
      const Propagator<Real> p = system_.stuck.propagate(t);
      return RowsOfState<Real, 4>{
          {{p.c, p.s, 0, 0}, {-system_.stuck.b() * p.s, p.v, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    };
    const auto kick = [&](const Real& t) {  // impulse response, as in move()
      const Propagator<Real> p = system_.stuck.propagate(t);
      const Real joined = 1 + system_.nu;
      return Rates<Real>{p.s / joined, p.v / joined, 0, 0};
    };
    move(stuck, begin, duration, 2 * system_.stuck.a(), propagator, kick);
  }

  void passed(const Contact<Real, Force>& contact, const Real& begin, const Real& duration,
              const State<Real>& end) {
    pass_contact<Contact<Real, NoForcing<Real>>>(contact, begin, duration, end);
  }
  void passed(const ContactWithoutModes<Real, Force>& contact, const Real& begin, const Real& duration,
              const State<Real>& end) {
    pass_contact<ContactWithoutModes<Real, NoForcing<Real>>>(contact, begin, duration, end);
  }

  const System<Real, Force>& system() const { return system_; }
  // The state in which the last motion ended, and the rates there at the time `now`.
  const State<Real>& end() const { return end_; }
  Rates<Real> rates_at_end(const Real& now) const {
    const Real f = force_at(now);
    switch (last_) {
      case Kind::none:
      case Kind::flight:
        return rates_in_flight(system_.zeta, end_, f);
      case Kind::stuck:
        return rates_when_stuck(end_, f);
      case Kind::contact:
        return rates_in_contact(end_, f);
    }
    return {};
  }

 private:
  enum class Kind { none, flight, stuck, contact };

  void step(const RowsOfState<Real, 4>& a) {
    receiver_.step(a, [] { return RowsOfState<Real, 2>{}; });
  }

  // Passes a motion to the receiver. propagator(t): the derivative of the state after a time t by that at its
  // beginning. kick(t): the impulse response, the state at t that a unit impulse of the force at 0 leaves.
  // rate_of_loss: minus the divergence, the rate at which volumes contract.
  template <class Motion, class PropagatorOf, class Kick>
  void move(const Motion& motion, const Real& begin, const Real& duration, const Real& rate_of_loss,
            PropagatorOf&& propagator, Kick&& kick) {
    const auto by_parameters = [&] { return driven(motion, begin, duration, kick); };
    const int pieces = receiver_.pieces(double(rate_of_loss * duration));
    const RowsOfState<Real, 4> a = propagator(Real(duration / pieces));
    for (int i = 0; i < pieces; ++i) receiver_.step(a, by_parameters);
  }

  // The derivatives of the final state by omega_f and f0 (M13.3), by Gauss's 16 points in panels of the time
  // tau that is left until the end.
  template <class Motion, class Kick>
  RowsOfState<Real, 2> driven(const Motion& motion, const Real& begin, const Real& duration,
                              Kick&& kick) const {
    RowsOfState<Real, 2> all{};
    const Real least = duration / 65536;
    Real from{0};
    while (from < duration) {
      const Real panel = motion.panel(from);
      Real to = from + (panel < least ? least : panel);
      if (!(to < duration)) to = duration;
      const Real half = (to - from) / 2, middle = from + half;
      for (const auto& [abscissa, weight] : gauss_16) {
        for (const double side : {-abscissa, abscissa}) {
          const Real tau = middle + half * side, time = begin + (duration - tau);
          const auto [sin, cos] = system_.forcing.phase(time);
          const Rates<Real> response = kick(tau);
          for (std::size_t i = 0; i < 4; ++i) {
            all[i][0] += half * weight * response[i] * (system_.forcing.amplitude * time * cos);
            all[i][1] += half * weight * response[i] * sin;
          }
        }
      }
      from = to;
    }
    return all;
  }

  // The saltation matrix of an impact on a rigid wall, `after` the state just after it. joins: both masses
  // then stick, and the matrix includes all that is left of the chattering.
  RowsOfState<Real, 4> impact(const State<Real>& after, const Real& time, bool joins = false) const {
    const Real f = force_at(time);
    const Rates<Real> before = rates_in_flight(system_.zeta, end_, f);
    const RowsOfState<Real, 4> jump = impact_jump(system_.nu, system_.e);
    if (!joins) return saltation(jump, before, rates_in_flight(system_.zeta, after, f), end_.w);
    return saltation(product(joining_jump(system_.nu), jump), before, rates_when_stuck(after, f), end_.w);
  }
  template <class Unforced, class InContact>
  void pass_contact(const InContact& contact, const Real& begin, const Real& duration,
                    const State<Real>& end) {
    if (last_ == Kind::flight) step(contact_edge(system_.nu, contact_->damping, 1));
    last_ = Kind::contact;
    end_ = end;
    const auto from = [&](const State<Real>& start) {
      return Unforced(*contact_, Real(0), start, Wall::left);
    };
    const std::array columns{from({1, 0, 0, 0}), from({0, 1, 0, 0}), from({0, 0, 1, 0}), from({0, 0, 0, 1})};
    const auto propagator = [&](const Real& t) {
      RowsOfState<Real, 4> a;
      for (std::size_t j = 0; j < 4; ++j) {
        const State<Real> s = columns[j].at(t);
        a[0][j] = s.x, a[1][j] = s.v, a[2][j] = s.y, a[3][j] = s.w;
      }
      return a;
    };
    const Unforced impulse = from({0, 1, 0, -1});
    const auto kick = [&](const Real& t) {  // impulse response, as in move()
      const State<Real> s = impulse.at(t);
      return Rates<Real>{s.x, s.v, s.y, s.w};
    };
    const Real loss = 2 * system_.zeta + (1 + system_.nu) * contact_->damping;
    move(contact, begin, duration, loss, propagator, kick);
  }

  Real force_at(const Real& time) const {
    return system_.forcing.template derivatives<2>(system_.forcing.phase(time))[0];
  }
  Rates<Real> rates_when_stuck(const State<Real>& s, const Real& f) const {
    return {s.v, (f - 2 * system_.zeta * s.v - s.x) / (1 + system_.nu), 0, 0};
  }
  Rates<Real> rates_in_contact(const State<Real>& s, const Real& f) const {
    const Real q = s.y < Real(0.5) ? s.y : Real(s.y - 1);
    const Real push = contact_->damping * s.w + contact_->stiffness * q;
    const Real a = f - 2 * system_.zeta * s.v - s.x + system_.nu * push;
    return {s.v, a, s.w, -push - a};
  }

  System<Real, Force> system_;
  System<Real, NoForcing<Real>> unforced_;
  std::optional<UnforcedModes> contact_;
  Receiver& receiver_;
  Kind last_ = Kind::none;
  State<Real> end_{};
};

}  // namespace impact_damper
