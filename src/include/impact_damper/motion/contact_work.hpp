// The work done in a contact, however long it lasts (docs/mathematics.md, chapter 8).
//
// A wall of little damping rings thousands of times in a sustained contact, too often for a quadrature. The
// rates x' and q' are split into the ringing (the fast mode without its steady state under the force) and a
// smooth part (all else). The square of the smooth part is left to the quadrature. The square of the ringing
// is a sum of exponentials, integrated from its beginning alone, so that it tests where the motion ends. The
// product of both is integrated by parts (M8.2, M8.3), exactly; digits are lost only where both oscillate
// about equally fast, and there the quadrature is taken of the whole motion.
#pragma once

#include "impact_damper/motion/contact.hpp"
#include "impact_damper/motion/energy.hpp"

namespace impact_damper {

// A function and its derivative at one instant.
template <class Real>
struct Wave {
  Real u, u1;
};

// Returns the integral of h^2 over [0, duration] of an underdamped free motion that begins with the value and
// slope h.
template <class Real>
Real square_of_ringing(const Oscillator<Real>& ringing, const Wave<Real>& h, const Real& duration) {
  // h = exp(-a t) (h0 cos(omega t) + m sin(omega t))
  const Real a = ringing.a(), b = ringing.b(), omega = square_root(Real(b - a * a));
  const Real m = (h.u1 + a * h.u) / omega;
  const Real loss = exponential_minus_1(Real(-2 * a * duration));
  const auto [sin, cos] = sin_cos(Real(2 * omega * duration));
  // Integrals of exp(-2 a t), and of that times exp(2 i omega t): [exp(2 lambda t)]/(2 lambda).
  const Real mean = a == 0 ? duration : Real(loss / (-2 * a));
  const Real re = (1 + loss) * cos - 1, im = (1 + loss) * sin;
  const Real in_phase = (omega * im - a * re) / (2 * b), behind = -(a * im + omega * re) / (2 * b);
  return (h.u * h.u + m * m) / 2 * mean + (h.u * h.u - m * m) / 2 * in_phase + h.u * m * behind;
}

// Returns R of (M8.3) for the ringing h.
template <class Real>
Wave<Real> by_parts(const Oscillator<Real>& ringing, const Wave<Real>& h, const Real& p, const Real& b) {
  const Real p2 = 2 * ringing.a(), b2 = ringing.b(), a = p2 + p, o = b2 - b;
  const Real r = o * (o - a * p2) + a * a * b2;
  return {(a * h.u1 + (a * p2 - o) * h.u) / r, -(o * h.u1 + a * b2 * h.u) / r};
}

// x' or q' at one instant of a contact, in parts.
template <class Real>
struct RateParts {
  Wave<Real> slow, steady, ringing;  // steady, ringing: of the fast motion
  Wave<Real> force;                  // F of slow
};

template <class Real, class Force>
RateParts<Real> rate_parts(const ContactModes<Real, Force>& walls, const ContactState<Real>& slow,
                           const ContactState<Real>& fast, Real ContactState<Real>::*u,
                           Real ContactState<Real>::*u1, const Real& time) {
  // A part obeys u'' + 2 a u' + b u = on_f f + on_f1 f'.
  const auto f = walls.forcing.template derivatives<4>(walls.forcing.phase(time));
  const auto force = [&](const Oscillator<Real>& o, const ContactState<Real>& drive, int order) {
    const Real on_f = drive.*u1 + 2 * o.a() * drive.*u, on_f1 = drive.*u;
    return on_f * f[order] + on_f1 * f[order + 1];
  };
  const auto wave = [&](const Oscillator<Real>& o, const ContactState<Real>& now,
                        const ContactState<Real>& drive) {
    return Wave<Real>{now.*u1, force(o, drive, 0) - 2 * o.a() * now.*u1 - o.b() * now.*u};
  };
  RateParts<Real> parts{wave(walls.slow, slow, walls.drive_slow), {0, 0}, {0, 0}, {0, 0}};
  parts.ringing = wave(walls.fast, fast, walls.drive_fast);
  if (!walls.forcing) return parts;
  parts.force = {force(walls.slow, walls.drive_slow, 1), force(walls.slow, walls.drive_slow, 2)};
  const Real square = walls.forcing.frequency * walls.forcing.frequency;
  const Real re = walls.fast.b() - square, im = 2 * walls.fast.a(), h2 = re * re + im * im * square;
  const Wave<Real> on{force(walls.fast, walls.drive_fast, 1), force(walls.fast, walls.drive_fast, 2)};
  parts.steady = {(re * on.u - im * on.u1) / h2, (re * on.u1 + im * square * on.u) / h2};
  parts.ringing.u -= parts.steady.u;
  parts.ringing.u1 -= parts.steady.u1;
  return parts;
}

// Returns the same as work_of() for any motion (energy.hpp), at a cost that does not grow with how long the
// wall rings.
template <class Real, class Force>
Work<Real> work_of(const System<Real, Force>& system, const Contact<Real, Force>& contact, const Real& begin,
                   const Real& duration, const Real& wall_damping, Search<Real>& search) {
  const ContactModes<Real, Force>& walls = contact.system();
  const Oscillator<Real>&slow = walls.slow, &fast = walls.fast;
  const Real square = walls.forcing ? walls.forcing.frequency * walls.forcing.frequency : Real(0);
  const bool apart = fast.b() > 64 * square && (!slow.rings() || fast.rate() > 8 * slow.rate());
  const bool lasts = fast.rate() * duration > 200;
  if (!(fast.rings() && apart && lasts)) {
    return work_of<Contact<Real, Force>>(system, contact, begin, duration, wall_damping, search);
  }
  using State = ContactState<Real>;
  const auto x_rate = [&](const State& slow_part, const State& fast_part, const Real& t) {
    return rate_parts(walls, slow_part, fast_part, &State::x, &State::v, Real(begin + t));
  };
  const auto q_rate = [&](const State& slow_part, const State& fast_part, const Real& t) {
    return rate_parts(walls, slow_part, fast_part, &State::q, &State::w, Real(begin + t));
  };
  const auto smooth = [&](const Real& t) {
    const State now = contact.slow_at(t);
    const auto x = x_rate(now, {}, t), q = q_rate(now, {}, t);
    return std::array<Real, 2>{x.slow.u + x.steady.u, q.slow.u + q.steady.u};
  };
  const auto panel = [&](const Real& t) { return panel_under(walls.forcing, slow.panel(t)); };
  Work<Real> works = integrated_work(system, smooth, panel, begin, duration, wall_damping, search);

  const auto antiderivative = [](const Wave<Real>& g, const Wave<Real>& h, const Real& p) {
    return g.u * h.u1 - g.u1 * h.u - p * g.u * h.u;
  };
  const auto smooth_times_ringing = [&](const RateParts<Real>& rate) {
    const Wave<Real> h = by_parts(fast, rate.ringing, Real(2 * slow.a()), slow.b());
    Real sum = antiderivative(rate.slow, h, Real(2 * slow.a()));
    if (walls.forcing) {
      sum += antiderivative(rate.force, by_parts(fast, h, Real(0), square), Real(0));
      sum += antiderivative(rate.steady, by_parts(fast, rate.ringing, Real(0), square), Real(0));
    }
    return sum;
  };
  // Antiderivatives of f times the ringing of x', and of f a quarter of a period ahead times that ringing.
  const auto force_times_ringing = [&](const RateParts<Real>& rate, const Real& t) {
    const auto f = walls.forcing.template derivatives<3>(walls.forcing.phase(begin + t));
    const Real& frequency = walls.forcing.frequency;
    const Wave<Real> r = by_parts(fast, rate.ringing, Real(0), square);
    return std::array<Real, 2>{antiderivative({f[0], f[1]}, r, Real(0)),
                               antiderivative({f[1] / frequency, f[2] / frequency}, r, Real(0))};
  };
  const Real start{0};
  const State slow_start = contact.slow_at(start), fast_start = contact.fast_at(start);
  const State slow_end = contact.slow_at(duration), fast_end = contact.fast_at(duration);
  const auto x_start = x_rate(slow_start, fast_start, start), x_end = x_rate(slow_end, fast_end, duration);
  const auto q_start = q_rate(slow_start, fast_start, start), q_end = q_rate(slow_end, fast_end, duration);
  works.viscous += 2 * system.zeta *
                   (square_of_ringing(fast, x_start.ringing, duration) +
                    2 * (smooth_times_ringing(x_end) - smooth_times_ringing(x_start)));
  works.wall += wall_damping * (square_of_ringing(fast, q_start.ringing, duration) +
                                2 * (smooth_times_ringing(q_end) - smooth_times_ringing(q_start)));
  if (walls.forcing) {
    const auto at_end = force_times_ringing(x_end, duration), at_start = force_times_ringing(x_start, start);
    const Real work = at_end[0] - at_start[0];
    works.forcing += work;
    works.reactive += at_end[1] - at_start[1];
    works.turnover += absolute(work);
  }
  return works;
}

}  // namespace impact_damper
