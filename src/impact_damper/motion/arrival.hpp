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

template <class Real>
struct Series {
  Derivatives<Real, 6> x, y;
};

// c_0 + c_1 s + c_2 s^2 + ..., an even number of terms: even and odd powers apart, half as long a chain of
// operations that wait for each other.
template <class Real, std::size_t N>
Real sum(const std::array<Real, N>& c, const Real& s) {
  static_assert(N % 2 == 0);
  const Real s_2 = s * s;
  Real even = c[N - 2], odd = c[N - 1];
  for (std::size_t n = N - 2; n > 0; n -= 2) {
    even = c[n - 2] + s_2 * even;
    odd = c[n - 1] + s_2 * odd;
  }
  return even + s * odd;
}
// The terms of its derivative.
template <class Real, std::size_t N>
std::array<Real, N> slopes(const std::array<Real, N>& c) {
  std::array<Real, N> d;
  for (std::size_t n = 1; n < N; ++n) d[n - 1] = Real(double(n)) * c[n];
  d[N - 1] = 0;
  return d;
}

// When y meets a level nearby: its third-order series turned round. `close` tells whether that leaves no more
// than a rounding error of the time h that has led here, nor does the fourth order of y or the motion.
template <class Real>
struct Nearby {
  Real shift;
  bool close;
};
template <class Real>
Nearby<Real> nearby(const Real& level, const Derivatives<Real, 6>& y, const Real& h, const Real& fourth) {
  const Real over = 1 / y[1], t = (level - y[0]) * over;
  const Real a = t * y[2] * over / 2, b = t * t * y[3] * over * reciprocals<Real>[6];
  const Real shift = t * (1 - a + (2 * a * a - b)), shift_2 = shift * shift, a_2 = a * a, h_2 = h * h;
  const Real tiny = std::numeric_limits<Real>::epsilon();
  return {shift, a_2 * a_2 <= tiny && shift_2 * shift_2 <= tiny * (h_2 * h_2) &&
                     fourth * (shift_2 * shift_2) <= 4 * tiny * absolute(y[1]) * h};
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

// When a motion between walls at `below` and `above` meets one of them, roughly, and after `most` at the
// latest: by the parabola through its beginning, then by Newton's method on the series.
template <class Real>
Real guess(const Derivatives<Real, 8>& y, const Real& below, const Real& above, const Real& most) {
  const auto& over = reciprocals<Real>;
  const bool up = y[1] > 0 || (y[1] == 0 && y[2] > 0);
  const Real ahead = up ? Real(above - y[0]) : Real(y[0] - below);
  const Real speed = absolute(y[1]), push = up ? y[2] : Real(-y[2]);
  const Real reach = speed * speed + 2 * push * ahead;
  const bool arrives = reach >= 0;
  const Real gap = y[0] - (arrives == up ? above : below);
  Real t = arrives ? Real(2 * ahead / (speed + square_root(reach)))
                   : Real((speed + square_root(Real(reach - 2 * push * (above - below)))) / -push);
  if (!(t < most)) t = most;
  Derivatives<Real, 8> c{gap, y[1]}, c1{y[1]};
  Real factor = over[2];
  for (std::size_t n = 2; n < 8; ++n) {
    c[n] = factor * y[n];
    factor = factor * over[n + 1];
  }
  c1 = slopes(c);
  for (int i = 0; i < 3; ++i) {
    const Real step = -sum(c, t) / sum(c1, t);
    if (!(absolute(step) < t / 2)) break;
    t += step;
    if (absolute(step) < t / 1024) break;
  }
  return t < most ? t : most;
}

// Whether a gap that is g0 at one end and g1 at the other, a time h apart, is proved to be open in between.
// slope0, slope1: its derivatives there; |its fourth| <= fourth.
template <class Real>
bool stays_open(const Real& g0, const Real& slope0, const Real& g1, const Real& slope1, const Real& h,
                const Real& fourth) {
  const Real quarter = h / 4, off = fourth * (h * h) * (h * h) / 144;
  return g0 >= 0 && g1 >= 0 && g0 + quarter * slope0 >= 0 && g1 - quarter * slope1 >= 0 &&
         (g0 + g1) / 2 + h * (slope0 - slope1) / 6 > off;
}

// The same of a gap that opens with its second and third derivative, 0 at the end that is meant by h = 0:
// third t^3/6 outweighs |fourth| t^4/24.
template <class Real>
bool opens(const Real& g0, const Real& slope, const Real& second, const Real& third, const Real& h,
           const Real& fourth) {
  return g0 >= 0 && slope >= 0 && second >= 0 && 4 * third > fourth * h;
}

}  // namespace impact_damper
