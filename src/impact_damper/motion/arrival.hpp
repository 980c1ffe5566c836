// Where a motion meets a wall, the short way: a guess, a series that lands on the wall, and a proof, after
// the fact, that no wall was met before.
//
// first_root.hpp certifies each step before it takes it, and so takes many. Most arrivals need none of that:
// the series at the beginning says nearly when, one evaluation there and the series about it say exactly
// when. What remains is to exclude an earlier arrival, and for that the two ends suffice. Between t = 0 and h
// the cubic P that shares position and velocity with u at both ends is off by at most
//     |u - P| <= m s^2 (1-s)^2 h^4 / 24,      s = t/h,      |u''''| <= m
// (Hermite interpolation). In Bernstein form, of degree 4, P has the coefficients
//     u0,   u0 + h u0'/4,   (u0 + u1)/2 + h (u0' - u1')/6,   u1 - h u1'/4,   u1
// and the error's bound only the middle one, m h^4 / 144. A polynomial lies within the hull of its
// coefficients: if these lie on one side of a wall, so does u, however near its ends are to it.
//
// Whatever cannot be proved so is left to first_root.hpp, and nothing is ever assumed.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

#include "impact_damper/motion/elementary.hpp"
#include "impact_damper/motion/oscillator.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

template <class Real>
struct State {
  Real x, v, y, w;
};

template <class Real>
struct Arrival {
  Real time;
  Wall wall;
  State<Real> state;
};

// Derivatives u, u', ... at one instant.
template <class Real, std::size_t N>
using Derivatives = std::array<Real, N>;

// c_0 + c_1 s + c_2 s^2 + ...: terms two by two, then those two by two, as few operations as can be waiting
// for each other.
template <class Real, std::size_t N>
Real sum(const std::array<Real, N>& c, const Real& s) {
  if constexpr (N == 1) {
    return c[0];
  } else {
    std::array<Real, (N + 1) / 2> pairs;
    for (std::size_t n = 0; n < N / 2; ++n) pairs[n] = c[2 * n] + s * c[2 * n + 1];
    if constexpr (N % 2 == 1) pairs[N / 2] = c[N - 1];
    return sum(pairs, Real(s * s));
  }
}
// The first M terms of its derivative.
template <std::size_t M, class Real, std::size_t N>
std::array<Real, M> slopes(const std::array<Real, N>& c) {
  static_assert(M < N);
  std::array<Real, M> d;
  for (std::size_t n = 0; n < M; ++n) d[n] = Real(double(n + 1)) * c[n + 1];
  return d;
}

// When y meets a level nearby: its third-order series turned round. `close` tells whether that leaves no more
// than a rounding error of the time h that has led here, nor does the fourth order of y or the motion.
template <class Real>
struct Nearby {
  Real shift, newton;  // and by the first order alone
  bool close;
};
template <class Real>
Nearby<Real> nearby(const Real& level, const Derivatives<Real, 6>& y, const Real& h, const Real& fourth) {
  const Real over = 1 / y[1], t = (level - y[0]) * over;
  const Real a = t * y[2] * over / 2, b = t * t * y[3] * over * reciprocals<Real>[6];
  const Real shift = t * (1 - a + (2 * a * a - b)), shift_2 = shift * shift, a_2 = a * a;
  const Real enough = std::numeric_limits<Real>::epsilon() / 64 * h;
  // The next term of the reversion, 5 a^3 t and what goes with it, and of the series.
  return {shift, t,
          absolute(a_2 * a * shift) <= enough && absolute(a * b * shift) <= enough &&
              fourth * (shift_2 * shift_2) <= enough * absolute(y[1])};
}

// u and u' a short time later.
template <class Real>
struct Moved {
  Real u, u1;
};
template <class Real>
Moved<Real> moved(const Derivatives<Real, 6>& d, const Real& t) {
  const Real half = t / 2, third = t * reciprocals<Real>[3], quarter = t / 4;
  return {d[0] + t * (d[1] + half * (d[2] + third * (d[3] + quarter * d[4]))),
          d[1] + t * (d[2] + half * (d[3] + third * (d[4] + quarter * d[5])))};
}

// How many terms the series of a flight has.
inline constexpr std::size_t flight_terms = 12;

// When a mass that has left one wall of a gap of 1 meets either, and after `most` at the latest: by the
// parabola through its beginning, put right for the next two orders, then by Halley's method on the series.
// Where that is as good as the motion itself, `whole`, u and its derivatives at that time are given, u as the
// distance from the wall it meets.
template <class Real>
struct Guess {
  Real time;
  bool across;  // at the other wall
  bool whole;
  Derivatives<Real, 6> u;
};
// |u''''| <= fourth, and |each higher derivative| <= rate |the one before|.
template <class Real>
Guess<Real> guess(const Derivatives<Real, flight_terms>& u, const Real& fourth, const Real& rate,
                  const Real& most) {
  constexpr std::size_t terms = flight_terms;
  const Real tiny = std::numeric_limits<Real>::epsilon() / 16;
  const bool rising = u[1] > 0 || (u[1] == 0 && u[2] > 0);
  const Real ahead = rising ? Real(1 - u[0]) : u[0];
  const Real speed = absolute(u[1]), push = rising ? u[2] : Real(-u[2]);
  const Real reach = speed * speed + 2 * push * ahead;
  const bool arrives = reach >= 0, across = arrives == rising;
  const Real end_speed = arrives     ? square_root(reach)
                         : u[0] == 0 ? speed
                                     : square_root(Real(reach - 2 * push));
  Real t = arrives ? Real(2 * ahead / (speed + end_speed)) : Real((speed + end_speed) / -push);

  std::array<Real, terms> c{across ? Real(u[0] - 1) : u[0], u[1]};
  for (std::size_t n = 2; n < terms; ++n) c[n] = u[n] * inverse_factorials<Real>[n];
  const Real right = t * t * t * (c[3] + t * c[4]) / (across ? Real(-end_speed) : end_speed);
  if (absolute(right) < t / 4) t += right;
  if (!(t < most)) t = most;
  const auto c1 = slopes<terms - 1>(c);
  const auto c2 = slopes<8>(c1);
  const auto c3 = slopes<6>(c2);
  const auto c4 = slopes<4>(c3);
  for (int i = 0;; ++i) {
    const Real g = sum(c, t), g1 = sum(c1, t), g2 = sum(c2, t);
    const Real step = -g * g1 / (g1 * g1 - g * g2 / 2), size = absolute(step);
    if (!(t < most)) return {most, across, false, {}};
    const Real tr = t * rate, tr_2 = tr * tr, tr_4 = tr_2 * tr_2;
    if (tr < Real(0.125)) {
      // What is left out: of u' |u^(12)| t^11/11!, of the inversion in nearby() the fourth power.
      const bool whole =
          fourth * (tr_4 * tr_4 * tr_2 * tr) <= 39916800 * tiny * absolute(g1) * (rate * rate * rate);
      if (whole && size * 8192 < t) return {t, across, true, {g, g1, g2, sum(c3, t), sum(c4, t), 0}};
    }
    if (i == 4 || !(size < t / 2)) return {t, across, false, {}};
    t += step;
    if (!(tr < Real(0.125)) && size * 64 < t) return {t, across, false, {}};
  }
}

// Whether a distance of at most 1, u0 at one end and u1 at the other, a time h apart, is proved to stay
// between 0 and 1. slope0, slope1: its derivatives there; |its fourth| <= fourth.
template <class Real>
bool stays_between(const Derivatives<Real, 4>& from, const Real& u1, const Real& slope1, const Real& h,
                   const Real& fourth) {
  const Real &u0 = from[0], &slope0 = from[1], quarter = h / 4, off = fourth * (h * h) * (h * h) / 144;
  const Real after = u0 + quarter * slope0, before = u1 - quarter * slope1;
  const Real middle = (u0 + u1) / 2 + h * (slope0 - slope1) / 6;
  if (!(u0 >= 0 && u1 >= 0 && u0 <= 1 && u1 <= 1 && after <= 1 && before <= 1 && middle < 1 - off))
    return false;
  if (after >= 0 && before >= 0 && middle > off) return true;
  // It leaves by its second and third derivative: third t^3/6 outweighs |fourth| t^4/24.
  return slope0 >= 0 && from[2] >= 0 && 4 * from[3] > fourth * h;
}

// The same of one that may be of any size, towards 0.
template <class Real>
bool stays_open(const Real& u0, const Real& slope0, const Real& u1, const Real& slope1, const Real& h,
                const Real& fourth) {
  const Real quarter = h / 4, off = fourth * (h * h) * (h * h) / 144;
  return u0 >= 0 && u1 >= 0 && u0 + quarter * slope0 >= 0 && u1 - quarter * slope1 >= 0 &&
         (u0 + u1) / 2 + h * (slope0 - slope1) / 6 > off;
}

}  // namespace impact_damper
