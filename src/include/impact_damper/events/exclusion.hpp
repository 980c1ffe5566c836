// Proofs that a function has no zero between two ends, by its values and slopes there and a bound on a higher
// derivative: Lemma L2 (M7.5, M7.6) and Lemma L3.
#pragma once

#include "impact_damper/math/elementary.hpp"
#include "impact_damper/math/power_series.hpp"

namespace impact_damper {

// Whether a distance, u0 at one end and u1 at the other, a time h apart, is proved to stay between 0 and
// `gap` (Lemma L2). from: u0 and its first three derivatives; slope1: its derivative at the other end, where
// it is u1; fourth: a bound on its fourth derivative in between.
template <class Real>
[[gnu::always_inline]] inline bool stays_between(const Derivatives<Real, 4>& from, const Real& u1,
                                                 const Real& slope1, const Real& h, const Real& fourth,
                                                 const Real& gap = Real(1)) {
  const Real& u0 = from[0];
  const Real& slope0 = from[1];
  const Real quarter = h / 4, off = fourth * (h * h) * (h * h) * (Real(1) / 144);
  const Real after = u0 + quarter * slope0, before = u1 - quarter * slope1;
  const auto& over = reciprocals<Real>;
  const Real middle = (u0 + u1) / 2 + h * (slope0 - slope1) * over[6];
  if (!(u0 >= 0 && u1 >= 0 && u0 <= gap && u1 <= gap && after <= gap && before <= gap && middle < gap - off))
    return false;
  if (after >= 0 && before >= 0 && middle > off) return true;
  // Else it stays above 0 if neither slope nor second derivative pulls it back and its third derivative
  // outweighs the fourth: third t^3/6 > fourth t^4/24.
  return slope0 >= 0 && from[2] >= 0 && 4 * from[3] > fourth * h;
}

// Whether a distance is proved to stay above 0 between two ends (Lemma L2); arguments as above.
template <class Real>
[[gnu::always_inline]] inline bool stays_open(const Real& u0, const Real& slope0, const Real& u1,
                                              const Real& slope1, const Real& h, const Real& fourth) {
  const Real quarter = h / 4, off = fourth * (h * h) * (h * h) * (Real(1) / 144);
  return u0 >= 0 && u1 >= 0 && u0 + quarter * slope0 >= 0 && u1 - quarter * slope1 >= 0 &&
         (u0 + u1) / 2 + h * (slope0 - slope1) * reciprocals<Real>[6] > off;
}

// Returns the largest c for which Lemma L2 proves that a function that falls from u0 > 0 to zero, a time h
// later, is at least c (1 - t/h) in between (M7.11).
template <class Real>
Real chord_below(const Real& u0, const Real& slope0, const Real& slope1, const Real& h, const Real& fourth) {
  const Real& third = reciprocals<Real>[3];
  const Real off = fourth * (h * h) * (h * h) * (Real(1) / 72);
  Real chord = u0;
  for (const Real& other : {Real((4 * u0 + h * slope0) * third), Real(-h * slope1),
                            Real(u0 + h * (slope0 - slope1) * third - off)})
    if (other < chord) chord = other;
  return chord;
}

// Whether a function with the ends u0, u1 of one sign is proved to have no zero between them (Lemma L3).
// `second`: a bound on |its second derivative|.
template <class Real>
bool keeps_sign(const Real& u0, const Real& u1, const Real& second, const Real& t) {
  const Real off = second * t * t / 8;
  return absolute(u0) > off && absolute(u1) > off;
}

}  // namespace impact_damper
