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
  for (int i = 0; i < 3; ++i) {
    Real g = y[7] * over[7], g1 = y[7];
    for (std::size_t n = 6; n > 1; --n) {
      g = (y[n] + t * g) * over[n];
      g1 = y[n] + t * over[n] * g1;
    }
    g1 = y[1] + t * g1;
    g = gap + t * (y[1] + t * g);
    const Real step = -g / g1;
    if (!(absolute(step) < t / 2)) break;
    t += step;
    if (absolute(step) < t / 65536) break;
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

}  // namespace impact_damper
