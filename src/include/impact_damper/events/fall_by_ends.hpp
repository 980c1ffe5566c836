// The first fall of a function through zero between two ends of a motion, where the function is cheap to
// evaluate. A zero is found from the values and slopes at both ends. Lemma L2, in few parts, proves that it
// is the first, or that there is none (Lemma L6, docs/mathematics.md, 7.6).
#pragma once

#include <optional>

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/events/halley.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

template <class Real>
struct SlopeAt {
  Real time, u, u1;
};

// With an empty `time` there is none.
template <class Real>
struct FirstFall {
  std::optional<Real> time;
  Real slope{0};
};

// Returns a zero of u between `begin`, where u > 0 or rises from zero, and `end`, where u < 0, found by
// Halley's method, which starts at a zero of the cubic through both. at(t): u, u' and u''; rate: of the
// motion. Returns nothing where the method does not converge.
template <class Real, class At>
std::optional<SlopeAt<Real>> zero_between(const At& at, const SlopeAt<Real>& begin, const SlopeAt<Real>& end,
                                          const Real& rate) {
  const Real h = end.time - begin.time, rise = end.u - begin.u, by_begin = h * begin.u1;
  const Real second = 3 * rise - 2 * by_begin - h * end.u1, third = by_begin + h * end.u1 - 2 * rise;
  Real low{0}, high{1}, s = begin.u > 0 ? Real(begin.u / -rise) : Real(0.5);
  for (int i = 0; i < 3; ++i) {
    const Real u = begin.u + s * (by_begin + s * (second + s * third)),
               u1 = by_begin + s * (2 * second + 3 * s * third);
    (u > 0 ? low : high) = s;
    s -= u / u1;
    if (!(low < s && s < high)) s = (low + high) / 2;
  }
  Real t = begin.time + s * h;
  for (int i = 0; i < 6; ++i) {
    const SeriesAt<Real> now = at(t);
    const auto [step, curvature, is_small] = halley_step(Real(-now.u), Real(1 / now.u1), now.u2);
    t += step;
    if (!(begin.time < t && t < end.time)) return {};
    // The next step would be below rounding.
    if (absolute(step) * rate * two_to_the_18 < 1 && absolute(curvature) * two_to_the_26 < 1)
      return SlopeAt<Real>{t, Real(0), now.u1 + step * now.u2};
  }
  return {};
}

// Whether u is proved to be positive between two times (open), or a point where it is not (closed).
template <class Real>
struct Openness {
  bool open;
  std::optional<SlopeAt<Real>> closed{};  // neither: undecided
};
template <class Real, class At>
Openness<Real> openness(const At& at, const SlopeAt<Real>& from, const SlopeAt<Real>& to, const Real& fourth,
                        int halvings) {
  if (stays_open(from.u, from.u1, to.u, to.u1, Real(to.time - from.time), fourth)) return {true};
  if (halvings == 0) return {false};
  const Real halfway = from.time + (to.time - from.time) / 2;
  const SeriesAt<Real> now = at(halfway);
  const SlopeAt<Real> middle{halfway, now.u, now.u1};
  if (!(middle.u > 0)) return {false, middle};
  const Openness<Real> before = openness(at, from, middle, fourth, halvings - 1);
  return before.open ? openness(at, middle, to, fourth, halvings - 1) : before;
}

// Returns the first fall of u through zero between `begin`, where u > 0 or rises from zero, and `end`.
// fourth: a bound on |u''''| between them. Returns nothing where it is not decided.
template <class Real, class At>
std::optional<FirstFall<Real>> fall_by_ends(const At& at, const SlopeAt<Real>& begin, SlopeAt<Real> end,
                                            const Real& fourth, const Real& rate) {
  if (!(begin.u > 0 || (begin.u == 0 && begin.u1 > 0))) return {};
  for (int i = 0; i < 4; ++i) {
    const bool falls = !(end.u > 0);
    if (falls) {
      const auto zero = zero_between(at, begin, end, rate);
      if (!zero || !(zero->u1 < 0)) return {};
      end = *zero;
    }
    const Openness<Real> before = openness(at, begin, end, fourth, 3);
    if (before.open) return falls ? FirstFall<Real>{end.time, end.u1} : FirstFall<Real>{};
    if (!before.closed) return {};
    end = *before.closed;
  }
  return {};
}

}  // namespace impact_damper
