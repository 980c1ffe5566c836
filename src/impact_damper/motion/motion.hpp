// The two motions in which no wall gives, each a closed form from its beginning: free flight and stuck.
// (The third, contact with a compliant wall, has a file of its own: contact.hpp.)
//
// A motion answers, for a time t since its beginning: the state, and the outlooks that first_root needs.
#pragma once

#include "impact_damper/motion/arrival.hpp"
#include "impact_damper/motion/first_root.hpp"
#include "impact_damper/motion/oscillator.hpp"
#include "impact_damper/run.hpp"

#include <cmath>
namespace impact_damper {

// The scene's numbers in the engine's scalar type.
template <class Real>
struct System {
  explicit System(const Scene& scene)
      : nu(scene.mass_ratio),
        e(scene.restitution),
        zeta(scene.damping_ratio),
        k(scene.wall_stiffness),
        forcing{Real(scene.force_amplitude), Real(scene.force_frequency)},
        free(zeta, Real(1)),
        stuck(zeta / (1 + nu), 1 / (1 + nu)) {}

  Real nu, e, zeta, k;
  Forcing<Real> forcing;
  Oscillator<Real> free;   // equation (3)
  Oscillator<Real> stuck;  // equation (9), whose printed forcing lacks the factor 1/(1+nu)
};

// The first time in [from, until) at which a function falls through zero, by its outlooks.
template <class Real, class OutlookAt>
std::optional<Real> search_fall(OutlookAt&& outlook_at, const Real& from, const Real& until, const Real& span,
                                const Real& resolution) {
  const auto root = first_root<Real>([&](const Real& t) { return std::array{outlook_at(t)}; }, from, until,
                                     span, resolution);
  return root ? std::optional(root->time) : std::nullopt;
}

// Whether a function with the ends u0, u1 of one sign has no zero between them: |its second derivative| is at
// most `second`, so it keeps within second t^2/8 of its chord.
template <class Real>
bool keeps_sign(const Real& u0, const Real& u1, const Real& second, const Real& t) {
  const Real off = second * t * t / 8;
  return absolute(u0) > off && absolute(u1) > off;
}

// x of a single oscillator under the forcing, with what bounds it.
template <class Real>
class Swing {
 public:
  Swing(const Oscillator<Real>& oscillator, const Forcing<Real>& forcing, const Real& begin, const Real& x0,
        const Real& v0)
      : oscillator_(oscillator), forcing_(forcing), begin_(begin), x0_(x0), v0_(v0) {}

  struct Change {
    Real x, v;    // displacement and velocity at t
    Real dx, dv;  // x - x0 - v0 t and v - v0, without cancellation
  };
  Change at(const Real& t) const {
    const Propagator<Real> p = oscillator_.propagate(t);
    Change now;
    now.x = x0_ * p.c + v0_ * p.s;
    now.dx = x0_ * p.c1 + v0_ * p.s1;
    const Real from_x = -x0_ * oscillator_.b() * p.s;
    now.dv = v0_ * (p.c1 - 2 * oscillator_.a() * p.s) + from_x;
    now.v = v0_ * p.v + from_x;
    if (forcing_) {
      const DrivenResponse<Real> driven = oscillator_.respond(forcing_, begin_, t, p);
      now.x += driven.d;
      now.dx += driven.d;
      now.dv += driven.d1;
      now.v += driven.d1;
    }
    return now;
  }

  template <std::size_t N>
  Instant<Real, N> instant(const Real& x, const Real& v, const Real& t) const {
    return {oscillator_, x, v, Real(1), Real(0), forcing_, begin_ + t};
  }
  template <std::size_t N>
  Derivatives<Real, N> derivatives(const Real& x, const Real& v, const Real& t) const {
    if (!forcing_) return impact_damper::derivatives<N>(oscillator_, x, v);
    return impact_damper::derivatives<N>(oscillator_, x, v, Real(1), Real(0),
                                         forcing_.template derivatives<N + 1>(begin_ + t));
  }
  using Beginning = Instant<Real, 6>;
  Beginning beginning() const { return instant<6>(x0_, v0_, Real(0)); }

  // Whether x, at both ends of [0, t] on the same `side` of zero, is proved not to change sign in between, nor
  // to turn. Without forcing neither x nor x' has two zeros within half a period.
  bool runs_on(const Real& side, const Real& x, const Real& v, const Real& t) const {
    if (!(side * x0_ > 0 && side * x > 0 && v0_ * v > 0)) return false;
    if (!forcing_) return t < oscillator_.half_period();
    const auto x_ = beginning();
    return keeps_sign(x0_, x, x_.bound(2, t), t) && keeps_sign(v0_, v, x_.bound(3, t), t);
  }
  // The first time in [from, until) at which sign times the `order`-th derivative of x falls through zero.
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            const Real& span) const {
    if (forcing_ || !(oscillator_.half_period() < std::numeric_limits<Real>::infinity()))
      return search_fall<Real>([&](const Real& t) { return outlook_at(order, sign, t, span); }, from, until,
                               span, Real(1));
    const auto x = beginning();
    const Real u = sign * x[order], u1 = sign * x[order + 1];
    if (u == 0 && u1 == 0) return {};
    if (!(from > 0) && u <= 0 && u1 < 0) return from < until ? std::optional(from) : std::nullopt;
    Real time = oscillator_.fall(u > 0 ? u : Real(0), u1);
    const Real period = 2 * oscillator_.half_period();
    if (time < from) time += Real(std::ceil(double((from - time) / period))) * period;
    return time < until ? std::optional(time) : std::nullopt;
  }
  // The `order`-th derivative of x, looked ahead from t.
  Outlook<Real> outlook_at(std::size_t order, const Real& sign, const Real& t, const Real& span) const {
    const Change now = at(t);
    const auto x = instant<7>(now.x, now.v, t);
    return {{sign * x[order], sign * x[order + 1], sign * x[order + 2], x.bound(order + 3, span)},
            {},
            std::numeric_limits<Real>::infinity()};
  }

  // The fastest that anything happens in it.
  Real rate() const {
    return forcing_ && forcing_.frequency > oscillator_.rate() ? forcing_.frequency : oscillator_.rate();
  }
  // How far a smooth quadrature panel may reach.
  Real panel() const { return Real(6) / rate(); }

 private:
  const Oscillator<Real>& oscillator_;
  Forcing<Real> forcing_;
  Real begin_, x0_, v0_;
};

// How far ahead a bound is asked for: without forcing it holds for ever, with forcing it grows with the span.
template <class Real>
Real bounded_span(const Forcing<Real>& forcing) {
  return forcing ? Real(1) : std::numeric_limits<Real>::infinity();
}

// 0 < y < 1: equations (3) and (4). The secondary mass flies straight, z = x + y = z0 + z'0 t.
template <class Real>
class Flight {
 public:
  Flight(const System<Real>& system, const Real& begin, const State<Real>& start)
      : swing_(system.free, system.forcing, begin, start.x, start.v),
        start_(start),
        wall_(start.y > Real(0.5) ? 1 : 0) {}

  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    State<Real> state = from_wall(t);
    state.y += wall_;
    return state;
  }
  // Where and when a wall is met, if in [from, horizon).
  std::optional<Arrival<Real>> next_wall(const Real& from, const Real& horizon, const Real& span) const {
    if (const auto met = arrive(from, span)) return met->time < horizon ? met : std::nullopt;
    return search_wall(from, horizon, span);
  }
  // The same, certified step by step.
  std::optional<Arrival<Real>> search_wall(const Real& from, const Real& horizon, const Real& span) const {
    const auto met = first_root<Real>([&](const Real& t) { return gaps(t, span); }, from, horizon, span,
                                      resolution());
    if (!met) return {};
    const Wall wall = met->which == 0 ? Wall::left : Wall::right;
    State<Real> state = at(met->time);
    state.y = wall == Wall::left ? 0 : 1;
    return Arrival<Real>{met->time, wall, state};
  }
  // Towards zero: the gap to the left wall, y, and the gap to the right one, 1 - y.
  std::array<Outlook<Real>, 2> gaps(const Real& t, const Real& span) const {
    const State<Real> now = from_wall(t);
    const Real left = now.y + wall_, right = (1 - wall_) - now.y;
    const auto x = swing_.template instant<5>(now.x, now.v, t);
    const Real third = x.bound(3, span), swing = x.bound(0, span);
    const Real z1 = now.w + now.v;
    return {Outlook<Real>{{left, now.w, -x[2], third}, {left + now.x, z1, Real(0), Real(0)}, swing},
            Outlook<Real>{{right, -now.w, x[2], third}, {right - now.x, -z1, Real(0), Real(0)}, swing}};
  }
  // y'' and y''' at the beginning, and a bound on |y''''|.
  struct Departure {
    Real acceleration, jerk, fourth;
  };
  Departure departure(const Real& span) const {
    const auto x = swing_.beginning();
    return {-x[2], -x[3], x.bound(4, span)};
  }
  bool runs_on(const Real& side, const State<Real>& end, const Real& t) const {
    return swing_.runs_on(side, end.x, end.v, t);
  }
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            const Real& span) const {
    return swing_.falls(order, sign, from, until, span);
  }
  Outlook<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t, const Real& span) const {
    return swing_.outlook_at(order, sign, t, span);
  }
  typename Swing<Real>::Beginning leads_of_x() const { return swing_.beginning(); }
  Real panel(const Real&) const { return swing_.panel(); }
  Real resolution() const { return 1; }

 private:
  State<Real> from_wall(const Real& t) const {
    const auto now = swing_.at(t);
    return {now.x, now.v, (start_.y - wall_) + (start_.w * t - now.dx), start_.w - now.dv};
  }
  template <std::size_t N>
  static Derivatives<Real, N> derivatives_of_y(const State<Real>& s, const Derivatives<Real, N>& x) {
    Derivatives<Real, N> y{s.y, s.w};
    for (std::size_t n = 2; n < N; ++n) y[n] = -x[n];
    return y;
  }
  // By guess and proof (arrival.hpp); nothing where that does not come to an end soon.
  std::optional<Arrival<Real>> arrive(const Real& from, const Real& span) const {
    const Real below = -wall_, above = 1 - wall_, rate = swing_.rate();
    const Real most = span * rate < 2 ? span : Real(2 / rate);
    Real begin = from;
    State<Real> here = from > 0 ? from_wall(from) : State<Real>{start_.x, start_.v, start_.y - wall_, start_.w};
    for (int piece = 0; piece < 3; ++piece) {
      const auto lead = swing_.template instant<8>(here.x, here.v, begin);
      const Real fourth = lead.bound(4, span);
      const auto y_lead = derivatives_of_y(here, lead.derivatives());
      Real h = guess(y_lead, below, above, most);
      if (!(h > 0)) return {};
      State<Real> there;
      for (int correction = 0;; ++correction) {
        there = from_wall(begin + h);
        const auto x = swing_.template derivatives<6>(there.x, there.v, begin + h);
        const auto y = derivatives_of_y(there, x);
        const bool up = there.y > (below + above) / 2;
        const auto [shift, close] = nearby(up ? above : below, y, h, fourth);
        if (!(absolute(shift) < h / 4) || correction == 3) break;
        if (!close) {
          h += shift;
          continue;
        }
        const auto [at_x, at_v] = moved(x, shift);
        const State<Real> met{at_x, at_v, up ? above : below, moved(y, shift).u1};
        h += shift;
        if (!stays_inside(here, y_lead, met, h, fourth)) return {};
        return Arrival<Real>{begin + h, up ? Wall::right : Wall::left, {met.x, met.v, met.y + wall_, met.w}};
      }
      if (!stays_inside(here, y_lead, there, h, fourth)) return {};
      begin += h;
      here = there;
    }
    return {};
  }
  bool stays_inside(const State<Real>& from, const Derivatives<Real, 8>& y, const State<Real>& to,
                    const Real& h, const Real& fourth) const {
    const Real left = wall_, right = 1 - wall_;
    return (stays_open(Real(from.y + left), from.w, Real(to.y + left), to.w, h, fourth) ||
            opens(Real(from.y + left), from.w, y[2], y[3], h, fourth)) &&
           (stays_open(Real(right - from.y), Real(-from.w), Real(right - to.y), Real(-to.w), h, fourth) ||
            opens(Real(right - from.y), Real(-from.w), Real(-y[2]), Real(-y[3]), h, fourth));
  }

  Swing<Real> swing_;
  State<Real> start_;
  Real wall_;  // from which y is measured inside, for its relative accuracy there
};

// Both masses as one, the secondary at rest on a wall: equation (9), and y'' = 0 for equation (10).
template <class Real>
class Stuck {
 public:
  Stuck(const System<Real>& system, const Real& begin, const Real& x, const Real& v, Wall wall)
      : swing_(system.stuck, {system.forcing.amplitude / (1 + system.nu), system.forcing.frequency}, begin, x,
               v),
        start_{x, v, wall == Wall::left ? Real(0) : Real(1), Real(0)},
        push_(wall == Wall::left ? 1 : -1) {}

  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    const auto now = swing_.at(t);
    return {now.x, now.v, start_.y, Real(0)};
  }
  // When, in [from, horizon), the force with which the wall pushes the secondary mass vanishes: x'' does.
  std::optional<Real> release(const Real& from, const Real& horizon, const Real& span) const {
    return swing_.falls(2, push_, from, horizon, span);
  }
  bool runs_on(const Real& side, const State<Real>& end, const Real& t) const {
    return swing_.runs_on(side, end.x, end.v, t);
  }
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            const Real& span) const {
    return swing_.falls(order, sign, from, until, span);
  }
  Outlook<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t, const Real& span) const {
    return swing_.outlook_at(order, sign, t, span);
  }
  typename Swing<Real>::Beginning leads_of_x() const { return swing_.beginning(); }
  Real panel(const Real&) const { return swing_.panel(); }
  Real resolution() const { return 1; }

 private:
  Swing<Real> swing_;
  State<Real> start_;
  Real push_;
};

}  // namespace impact_damper
