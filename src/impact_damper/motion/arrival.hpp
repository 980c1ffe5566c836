// Predicts when a motion meets a wall, and validates afterwards that it met none before.
//
// first_root.hpp proves each step before it takes it, and needs many. Most impact times need none of that:
// the series at the beginning predicts the time; one evaluation there and the series about it (M7.7) give it
// to rounding; and the two ends exclude an earlier impact (Lemma L2, M7.5, M7.6). docs/mathematics.md, 7.4
// and 7.5. Where the validation fails, first_root.hpp searches.
#pragma once

#include <limits>
#include <optional>

#include "impact_damper/motion/elementary.hpp"
#include "impact_damper/motion/oscillator.hpp"
#include "impact_damper/motion/series.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

template <class Real>
struct State {
  Real x, v, y, w;
};
// A copy, number by number. As a block it would be loaded in pairs, and each pair wait until its two numbers,
// stored one by one just before, have reached the cache: each motion, a few nanoseconds for the one before.
template <class Real>
State<Real> copied(const State<Real>& s) {
  return {s.x, s.v, s.y, s.w};
}

template <class Real>
struct Arrival {
  Real time;
  Wall wall;
  State<Real> state;
};

// When y meets a level nearby, by reversion of its series to third order (M7.7). `close`: the terms left out,
// of the reversion and of the series, are below rounding of the time h that has led here.
template <class Real>
struct Nearby {
  Real shift, newton;  // the time until then; the same to first order
  bool close;
};
template <class Real>
Nearby<Real> nearby(const Real& level, const Derivatives<Real, 6>& y, const Real& h, const Real& fourth) {
  const Real over = 1 / y[1], t = (level - y[0]) * over;
  const Real a = t * (y[2] * over / 2), b = t * t * (y[3] * over * reciprocals<Real>[6]);
  const Real shift = t * (1 - a + (2 * a * a - b)), shift_2 = shift * shift, a_2 = a * a;
  const Real enough = std::numeric_limits<Real>::epsilon() / 64 * h;
  // The next term of the reversion, 5 a^3 t and what goes with it, and of the series.
  return {shift, t,
          absolute(a_2 * a * shift) <= enough && absolute(a * b * shift) <= enough &&
              fourth * (shift_2 * shift_2) <= enough * absolute(y[1])};
}

// u and u' a time t later, to third order, for a correction t that is `close`. d: the derivatives of u from
// the second on.
template <class Real>
struct Moved {
  Real u, u1;
};
template <class Real>
Moved<Real> moved(const Real& u, const Real& u1, const Derivatives<Real, 6>& d, const Real& t) {
  const Real half = t / 2, third = t * reciprocals<Real>[3];
  return {u + t * (u1 + half * (d[2] + third * d[3])), u1 + t * (d[2] + half * (d[3] + third * d[4]))};
}

// Predicts when a mass that has left one wall of a gap of 1 meets either, and `most` at the latest: by the
// parabola through its beginning, then by Halley's method on the series (docs/mathematics.md, 7.5). u:
// distance from the wall it left; it may begin with its third derivative alone. `fourth`: bound on |u''''|;
// each further derivative is at most `rate` times the one before. `exact`: the terms left out of the series
// are below rounding, and `gained` is then by how much u and u' differ from the straight line u + u' t, with
// digits that a fast mass's own u and u' do not have.
template <class Real>
struct Guess {
  Real time;
  bool across;  // at the other wall
  bool exact;
  Moved<Real> gained;
};
template <class Real>
Guess<Real> guess(const Derivatives<Real, 10>& u, const Real& fourth, const Real& rate, const Real& most) {
  const bool from_rest = u[1] == 0 && u[2] == 0;
  const bool rising = u[1] > 0 || (u[1] == 0 && u[2] > 0) || (from_rest && u[3] > 0);
  const Real ahead = rising ? Real(1 - u[0]) : u[0];
  const Real speed = absolute(u[1]), push = rising ? u[2] : Real(-u[2]);
  const Real reach = speed * speed + 2 * push * ahead;
  const bool arrives = reach >= 0, across = arrives == rising;
  Real t = arrives     ? Real(2 * ahead / (speed + square_root(reach)))
           : u[0] == 0 ? Real(2 * speed / -push)
                       : Real((speed + square_root(Real(reach - 2 * push))) / -push);
  if (!(t < most)) t = from_rest ? Real(most * Real(0.75)) : most;
  const Real gap = (across ? Real(1) : Real(0)) - u[0];
  const auto departure = departure_of(u);
  // First by few terms, as a parabola may be far off.
  const SeriesAt<Real> rough = sum_of_first<Real, 3>(departure, t);
  const Real slope = u[1] + rough.u1, off = gap - u[1] * t - rough.u;
  const Real nearer = off * slope / (slope * slope + off * rough.u2 / 2);
  if (absolute(nearer) < t / 2) t += nearer;
  for (int i = 0;; ++i) {
    const SeriesAt<Real> at = sum<Real>(departure, t);
    const Real u1 = u[1] + at.u1, over = 1 / u1;
    const Real newton = (gap - u[1] * t - at.u) * over, bend = newton * (at.u2 * over) / 2;
    const Real step = absolute(bend) < Real(0.0625) ? Real(newton * (1 - bend)) : Real(newton / (1 + bend));
    const Real size = absolute(step);
    if (size * 33554432 < t && t < most) {
      // Of the step, its third power is nothing; and of the series what is left out, |u^(10)| t^9/9!: beside
      // u' for the time, and beside the motion of x, which may be far smaller, for what is gained.
      const Real rt = rate * t, rt_2 = rt * rt, rt_4 = rt_2 * rt_2, left_out = rt_4 * rt_4 * rt;
      const Real tiny = 362880 * std::numeric_limits<Real>::epsilon() / 16;
      if (left_out <= 4 * tiny && fourth * left_out <= tiny * absolute(u1) * (rate * rate * rate))
        return {t + step, across, true, {at.u + step * at.u1, at.u1 + step * at.u2}};
      return {t, across, false, {}};
    }
    if (i == 4 || !(size < t / 2)) break;
    t += step;
    if (rate * t > Real(0.05) && size * 32 < t) break;
  }
  return {t < most ? t : most, across, false, {}};
}

// Whether a distance, u0 at one end and u1 at the other, a time h apart, is proved to stay between 0 and 1
// (Lemma L2). slope0, slope1: its derivatives there; fourth: bound on its fourth derivative.
template <class Real>
bool stays_between(const Derivatives<Real, 4>& from, const Real& u1, const Real& slope1, const Real& h,
                   const Real& fourth) {
  const Real& u0 = from[0];
  const Real& slope0 = from[1];
  const Real quarter = h / 4, off = fourth * (h * h) * (h * h) * (Real(1) / 144);
  const Real after = u0 + quarter * slope0, before = u1 - quarter * slope1;
  const auto& over = reciprocals<Real>;
  const Real middle = (u0 + u1) / 2 + h * (slope0 - slope1) * over[6];
  if (!(u0 >= 0 && u1 >= 0 && u0 <= 1 && u1 <= 1 && after <= 1 && before <= 1 && middle < 1 - off))
    return false;
  if (after >= 0 && before >= 0 && middle > off) return true;
  // It leaves by its second and third derivative: third t^3/6 outweighs |fourth| t^4/24.
  return slope0 >= 0 && from[2] >= 0 && 4 * from[3] > fourth * h;
}

// The same of one that only has to stay above 0.
template <class Real>
bool stays_open(const Real& u0, const Real& slope0, const Real& u1, const Real& slope1, const Real& h,
                const Real& fourth) {
  const Real quarter = h / 4, off = fourth * (h * h) * (h * h) * (Real(1) / 144);
  return u0 >= 0 && u1 >= 0 && u0 + quarter * slope0 >= 0 && u1 - quarter * slope1 >= 0 &&
         (u0 + u1) / 2 + h * (slope0 - slope1) * reciprocals<Real>[6] > off;
}

}  // namespace impact_damper
