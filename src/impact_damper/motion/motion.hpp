// The two motions in which no wall gives, each a closed form from its beginning: free flight and stuck.
// (The third, contact with a compliant wall, has a file of its own: contact.hpp.)
//
// A motion answers, for a time t since its beginning: the state, and the outlooks that first_root needs.
#pragma once

#include "impact_damper/motion/first_root.hpp"
#include "impact_damper/motion/oscillator.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

template <class Real>
struct State {
  Real x, v, y, w;
};

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

// A quadrature panel (Oscillator::panel), no longer than the forcing allows.
template <class Real>
Real panel_under(const Forcing<Real>& forcing, const Real& panel) {
  return forcing && panel * forcing.frequency > 6 ? Real(6 / forcing.frequency) : panel;
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

  Instant<Real, 7> instant(const Real& x, const Real& v, const Real& t) const {
    return {oscillator_, x, v, Real(1), Real(0), forcing_, begin_ + t};
  }
  Real panel(const Real& t) const { return panel_under(forcing_, oscillator_.panel(t)); }

 private:
  const Oscillator<Real>& oscillator_;
  Forcing<Real> forcing_;
  Real begin_, x0_, v0_;
};

// The `order`-th derivative of x, looked ahead from an instant.
template <class Real>
Outlook<Real> outlook(const Instant<Real, 7>& x, std::size_t order, const Real& sign, const Real& span) {
  return {{sign * x[order], sign * x[order + 1], sign * x[order + 2], x.bound(order + 3, span)},
          {},
          std::numeric_limits<Real>::infinity()};
}

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
      : swing_(system.free, system.forcing, begin, start.x, start.v), start_(start) {}

  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    const auto now = swing_.at(t);
    return {now.x, now.v, start_.y + start_.w * t - now.dx, start_.w - now.dv};
  }
  // Towards zero: the gap to the left wall, y, and the gap to the right one, 1 - y.
  std::array<Outlook<Real>, 2> gaps(const Real& t, const Real& span) const {
    const State<Real> now = at(t);
    const auto x = swing_.instant(now.x, now.v, t);
    const Real third = x.bound(3, span), swing = x.bound(0, span);
    const Real z = now.y + now.x, z1 = now.w + now.v;
    return {Outlook<Real>{{now.y, now.w, -x[2], third}, {z, z1, Real(0), Real(0)}, swing},
            Outlook<Real>{{1 - now.y, -now.w, x[2], third}, {1 - z, -z1, Real(0), Real(0)}, swing}};
  }
  // y'' and y''' at the beginning, and a bound on |y''''|.
  struct Departure {
    Real acceleration, jerk, fourth;
  };
  Departure departure(const Real& span) const {
    const auto x = swing_.instant(start_.x, start_.v, Real(0));
    return {-x[2], -x[3], x.bound(4, span)};
  }
  Outlook<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t, const Real& span) const {
    const State<Real> now = at(t);
    return outlook(swing_.instant(now.x, now.v, t), order, sign, span);
  }
  // x and its first three derivatives at the beginning.
  std::array<Real, 4> leads_of_x() const {
    const auto x = swing_.instant(start_.x, start_.v, Real(0));
    return {x[0], x[1], x[2], x[3]};
  }
  Real panel(const Real& t) const { return swing_.panel(t); }
  Real resolution() const { return 1; }

 private:
  Swing<Real> swing_;
  State<Real> start_;
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
  // Towards zero: the force with which the wall pushes the secondary mass, by nu.
  std::array<Outlook<Real>, 1> push(const Real& t, const Real& span) const {
    return {derivative_of_x(2, push_, t, span)};
  }
  Outlook<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t, const Real& span) const {
    const State<Real> now = at(t);
    return outlook(swing_.instant(now.x, now.v, t), order, sign, span);
  }
  // x and its first three derivatives at the beginning.
  std::array<Real, 4> leads_of_x() const {
    const auto x = swing_.instant(start_.x, start_.v, Real(0));
    return {x[0], x[1], x[2], x[3]};
  }
  Real panel(const Real& t) const { return swing_.panel(t); }
  Real resolution() const { return 1; }

 private:
  Swing<Real> swing_;
  State<Real> start_;
  Real push_;
};

}  // namespace impact_damper
