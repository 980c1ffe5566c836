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

// When y meets a level nearby: its fifth-order series turned round. `close` tells whether what that leaves,
// and what moved() leaves, is no more than a rounding error of the time h that has led here and of a motion
// of which each derivative is bounded by `rate` times the one before.
template <class Real>
struct Nearby {
  Real shift, newton;  // and by the first order alone
  bool close;
};
template <class Real>
Nearby<Real> nearby(const Real& level, const Derivatives<Real, 8>& y, const Real& h, const Real& rate) {
  const auto& by = reciprocals<Real>;
  const Real over = 1 / y[1], t = (level - y[0]) * over, t_2 = t * t, p = t * over;
  // The orders' parts, y^(n) t^(n-1) / (n! y'), n from 2 on.
  const Real a = p * y[2] / 2, b = (p * t) * (y[3] * by[6]), c = (p * t_2) * (y[4] * by[24]);
  const Real d = (p * t_2) * (t * y[5] * (by[24] * by[5])), e = (p * t_2) * (t_2 * y[6] * (by[24] * by[30]));
  const Real a_2 = a * a;
  const Real fourth = 5 * a * (b - a_2) - c,
             fifth = 7 * a_2 * (2 * a_2 - 3 * b) + (3 * (2 * a * c + b * b) - d);
  const Real shift = t * ((1 - a) + ((2 * a_2 - b) + (fourth + fifth)));

  const Real A = absolute(a), B = absolute(b), C = absolute(c), D = absolute(d), E = absolute(e);
  const Real sixth = 14 * A * (3 * a_2 * (a_2 + 2 * B) + 2 * (A * C + B * B)) + 7 * (A * D + B * C) + E;
  const Real enough = std::numeric_limits<Real>::epsilon() / 64;
  const Real angle = shift * rate, angle_2 = angle * angle, angle_6 = angle_2 * angle_2 * angle_2;
  return {shift, t, absolute(t) * sixth <= enough * h && absolute(angle * angle_6) <= 5040 * enough};
}

// u and u' a short time later.
template <class Real>
struct Moved {
  Real u, u1;
};
template <class Real>
Moved<Real> moved(const Derivatives<Real, 8>& d, const Real& t) {
  const auto& by = reciprocals<Real>;
  const Real half = t / 2, third = t * by[3], quarter = t / 4, fifth = t * by[5], sixth = t * by[6];
  const auto sum = [&](std::size_t n) {
    return d[n] +
           t * (d[n + 1] +
                half * (d[n + 2] +
                        third * (d[n + 3] + quarter * (d[n + 4] + fifth * (d[n + 5] + sixth * d[n + 6])))));
  };
  return {sum(0), sum(1)};
}

// How many terms of a flight's series a guess is made by.
inline constexpr std::size_t flight_terms = 12;

// When a mass that has left one wall of a gap of 1 meets either, and after `most` at the latest: by the
// parabola through its beginning, then by Halley's method on the series. Where that is as good as the motion
// itself, `whole`, u and its derivatives at that time are given too, u as the distance from the wall it
// meets.
template <class Real>
struct Guess {
  Real time;
  bool across = false;  // at the other wall
  bool whole = false;
  Derivatives<Real, 8> u{};
};
// u is the distance from the wall it left, |u''''| <= fourth, and |each derivative| <= rate |the one before|.
template <class Real>
Guess<Real> guess(const Derivatives<Real, flight_terms>& u, const Real& fourth, const Real& rate,
                  const Real& most) {
  const bool rising = u[1] > 0 || (u[1] == 0 && u[2] > 0);
  const Real ahead = rising ? Real(1 - u[0]) : u[0];
  const Real speed = absolute(u[1]), push = rising ? u[2] : Real(-u[2]);
  const Real reach = speed * speed + 2 * push * ahead;
  const bool arrives = reach >= 0, across = arrives == rising;
  Real t = arrives     ? Real(2 * ahead / (speed + square_root(reach)))
           : u[0] == 0 ? Real(2 * speed / -push)
                       : Real((speed + square_root(Real(reach - 2 * push))) / -push);
  if (!(t < most)) t = most;
  std::array<Real, flight_terms> c{across ? Real(u[0] - 1) : u[0], u[1]};
  for (std::size_t n = 2; n < c.size(); ++n) c[n] = u[n] * inverse_factorials<Real>[n];
  const auto c1 = slopes<flight_terms - 1>(c);
  const auto c2 = slopes<8>(c1);
  for (int i = 0; i < 5; ++i) {
    const Real g = sum(c, t), g1 = sum(c1, t), g2 = sum(c2, t);
    const Real step = g * g1 / (g * g2 / 2 - g1 * g1), size = absolute(step);
    const Real tr = t * rate, tr_2 = tr * tr, tr_4 = tr_2 * tr_2;
    const bool brief = tr < Real(0.125);
    if (brief && size * 8192 < t) {
      const auto c3 = slopes<6>(c2);
      const auto c4 = slopes<4>(c3);
      // What is left out: of u' |u^(12)| t^11/11!.
      const Real tiny = std::numeric_limits<Real>::epsilon() / 16;
      const bool whole =
          fourth * (tr_4 * tr_4 * tr_2 * tr) <= 39916800 * tiny * absolute(g1) * (rate * rate * rate);
      return {t, across, whole, {g, g1, g2, sum(c3, t), sum(c4, t), u[5]}};
    }
    if (!(size < t)) break;
    t += step;
    if (!(t < most)) return {most};
    if (!brief && size * 16 < t) break;
  }
  return {t};
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
