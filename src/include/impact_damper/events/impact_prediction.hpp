// Predicts when a motion meets a wall, and validates afterwards that it met none before.
//
// root_isolation.hpp proves each step before it takes it, and needs many. Most impact times need none of
// that: the series at the beginning predicts the time; an evaluation there and the series about it (M7.7)
// give it to rounding; and the two ends exclude an earlier impact (Lemma L2, M7.5, M7.6). See
// docs/mathematics.md, 7.4 and 7.5. Where the validation fails, root_isolation.hpp searches.
#pragma once

#include <limits>

#include "impact_damper/events/halley.hpp"
#include "impact_damper/events/search.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/math/power_series.hpp"

namespace impact_damper {

// The time until y is at a level nearby, by reversion of its series to third order (M7.7). close: the terms
// left out, of the reversion and of the series, are below rounding of the time h that has led here.
template <class Real>
struct TimeToLevel {
  Real shift, newton;  // the time until then; the same to first order
  bool close;
};
template <class Real>
[[gnu::always_inline]] inline TimeToLevel<Real> time_to_level(const Real& level,
                                                              const Derivatives<Real, 6>& y, const Real& h,
                                                              const Real& fourth) {
  SearchCounter<Real>::correction();
  const Real over = 1 / y[1], t = (level - y[0]) * over;
  const Real a = t * (y[2] * over / 2), b = t * t * (y[3] * over * reciprocals<Real>[6]);
  const Real shift = t * (1 - a + (2 * a * a - b)), shift_2 = shift * shift, a_2 = a * a;
  const Real enough = std::numeric_limits<Real>::epsilon() / 64 * h;
  // The next terms of the reversion, 5 a^3 t and 5 a b t, without their 5, and of the series.
  return {shift, t,
          absolute(a_2 * a * shift) <= enough && absolute(a * b * shift) <= enough &&
              fourth * (shift_2 * shift_2) <= enough * absolute(y[1])};
}

// u and u' a time t later, to third order, for a correction t that is `close`. d: the derivatives of u, of
// which the first two are not read.
template <class Real>
struct Shifted {
  Real u, u1;
};
template <class Real>
[[gnu::always_inline]] inline Shifted<Real> shifted(const Real& u, const Real& u1,
                                                    const Derivatives<Real, 6>& d, const Real& t) {
  const Real half = t / 2, third = t * reciprocals<Real>[3];
  return {u + t * (u1 + half * (d[2] + third * d[3])), u1 + t * (d[2] + half * (d[3] + third * d[4]))};
}

// The starting point of the prediction, from the parabola through the beginning of u. Where u' = u'' = 0
// there the sign of u''' decides which wall is predicted.
template <class Real>
struct FirstGuess {
  Real time;
  bool across;  // at the wall opposite to the one that u is measured from
};
template <class Real, std::size_t N>
[[gnu::always_inline]] inline FirstGuess<Real> guess_by_parabola(const Derivatives<Real, N>& u,
                                                                 const Real& most,
                                                                 const Real& gap = Real(1)) {
  const bool from_rest = u[1] == 0 && u[2] == 0;
  const bool rising = u[1] > 0 || (u[1] == 0 && u[2] > 0) || (from_rest && u[3] > 0);
  const Real ahead = rising ? Real(gap - u[0]) : u[0];
  const Real speed = absolute(u[1]), push = rising ? u[2] : Real(-u[2]);
  const Real reach = speed * speed + 2 * push * ahead;
  const bool arrives = reach >= 0;
  const Real t = arrives     ? Real(2 * ahead / (speed + square_root(reach)))
                 : u[0] == 0 ? Real(2 * speed / -push)
                             : Real((speed + square_root(Real(reach - 2 * push * gap))) / -push);
  return {t < most ? t : from_rest ? Real(most * Real(0.75)) : most, arrives == rising};
}

// Whether the terms left out of a series up to t^9 are below rounding at t, where u' is u1: in the time, for
// which |u^(10)| t^9/9! is compared with u', and in the departure, for which it is compared with the motion
// of x, which may be far smaller. fourth: a bound on |u''''|; each further derivative is estimated as `rate`
// times the one before. Near critical damping u^(10) may be a few times that, and is still below rounding.
template <class Real>
[[gnu::always_inline]] inline bool omits_nothing(const Real& u1, const Real& fourth, const Real& rate,
                                                 const Real& t) {
  constexpr double nine_factorial = 362880;
  const Real rt = rate * t, rt_2 = rt * rt, rt_4 = rt_2 * rt_2, omitted = rt_4 * rt_4 * rt;
  const Real tiny = nine_factorial * std::numeric_limits<Real>::epsilon() / 16;
  return omitted <= 4 * tiny && fourth * omitted <= tiny * absolute(u1) * (rate * rate * rate);
}

// Predicts when a mass in a gap meets a wall, at `most` at the latest: by the parabola, then by Halley's
// method on the series (docs/mathematics.md, 7.5). u: the distance from the wall that the flight is measured
// from, and its derivatives; departure: the series of u without u[0] + u[1] t. enough(u', t): whether that
// series has enough terms at t. If so the prediction is `exact`, and `gained` is the departure of u and u'
// from the straight line, with digits that u and u' of a fast mass do not have themselves. go_on(t, step):
// whether to go on after a step that is still too long.
template <class Real>
struct Prediction {
  Real time;
  bool across;  // at the wall opposite to the one that u is measured from
  bool exact;
  Shifted<Real> gained;
};
// Predicts by Halley's method alone, from `start` on. near: use all terms of the series from the first step
// on.
template <class Real, std::size_t N, class Departure, class Enough, class GoOn>
[[gnu::always_inline]] inline Prediction<Real> predict_from(const FirstGuess<Real>& start, bool near,
                                                            const Derivatives<Real, N>& u,
                                                            const Departure& departure, const Real& most,
                                                            Enough&& enough, GoOn&& go_on,
                                                            const Real& gap = Real(1)) {
  constexpr std::size_t first_pairs = Departure::all < 6 ? Departure::all : 6;
  const bool across = start.across;
  Real t = start.time;
  const Real ahead = (across ? gap : Real(0)) - u[0];  // distance to go, with sign
  for (int i = 0;; ++i) {
    // NOLINTNEXTLINE(bugprone-branch-clone): the same where the series has no more pairs than these
    const SeriesAt<Real> at = near ? departure.at(t) : departure.template at<first_pairs>(t);
    const Real u1 = u[1] + at.u1, over = 1 / u1;
    const auto [step, curvature, is_small] = halley_step(Real(ahead - u[1] * t - at.u), over, at.u2);
    const Real size = absolute(step);
    if (near && is_small && size * two_to_the_25 < t && t < most) {
      if (!enough(u1, t)) return {t, across, false, {}};
      // The step is below 2^-25 t. In the departure of u, ~ u'' t^2/2, the term with its second power, u''
      // step^2/2, may be above rounding. In that of u', ~ u'' t, the term u''' step^2/2 is left out: it is
      // less than 2 epsilon u''' t^2.
      return {t + step, across, true, {at.u + step * (at.u1 + step * at.u2 / 2), at.u1 + step * at.u2}};
    }
    if (i == 4 || !(size < t / 2)) break;
    t += step;
    near = near || size * 256 < t;
    if (!go_on(t, size)) break;
  }
  return {t < most ? t : most, across, false, {}};
}
template <class Real, std::size_t N, class Departure, class Enough, class GoOn>
[[gnu::always_inline]] inline Prediction<Real> predict_impact(const Derivatives<Real, N>& u,
                                                              const Departure& departure, const Real& most,
                                                              Enough&& enough, GoOn&& go_on,
                                                              const Real& gap = Real(1)) {
  SearchCounter<Real>::prediction();
  FirstGuess<Real> start = guess_by_parabola(u, most, gap);
  Real& t = start.time;
  const Real ahead = (start.across ? gap : Real(0)) - u[0];
  // The first step uses few terms: a parabola may be far off.
  const SeriesAt<Real> rough = departure.template at<3>(t);
  const Real slope = u[1] + rough.u1, off = ahead - u[1] * t - rough.u;
  const Real nearer = off * slope / (slope * slope + off * rough.u2 / 2);
  if (absolute(nearer) < t / 2) t += nearer;
  return predict_from(start, Departure::all <= 6, u, departure, most, enough, go_on, gap);
}

}  // namespace impact_damper
