// Halley's method, and a root of a power series by it. Another proof must show that it is the first
// (exclusion.hpp).
#pragma once

#include <cstddef>
#include <optional>

#include "impact_damper/math/elementary.hpp"
#include "impact_damper/math/power_series.hpp"

namespace impact_damper {

inline constexpr double two_to_the_18 = 262144, two_to_the_25 = 33554432, two_to_the_26 = 2 * two_to_the_25;

// A step of Halley's method to the root of a function. curvature: u'' times half of Newton's step, divided by
// u'; where it is not small the step alone may vanish at a turning point, too, where u is not zero.
template <class Real>
struct HalleyStep {
  Real step, curvature;
  bool is_small;  // the curvature
};
// minus_u: the function's value with the opposite sign; over_u1: 1/u'.
template <class Real>
[[gnu::always_inline]] inline HalleyStep<Real> halley_step(const Real& minus_u, const Real& over_u1,
                                                           const Real& u2) {
  const Real newton = minus_u * over_u1, curvature = newton * (u2 * over_u1) / 2;
  const bool is_small = absolute(curvature) < Real(0.0625);
  return {is_small ? Real(newton * (1 - curvature)) : Real(newton / (1 + curvature)), curvature, is_small};
}

// Returns a root of the series g after `from`, and the slope there. Halley's method starts at the root of the
// parabola through `begin`, first with few terms. Returns nothing where it does not converge.
template <class Real>
struct SeriesRoot {
  Real time, slope;
};
template <class Real, std::size_t pairs>
std::optional<SeriesRoot<Real>> root_of_series(const PairedSeries<Real, pairs>& g,
                                               const SeriesAt<Real>& begin, const Real& from,
                                               const Real& reach) {
  const Real slope_2 = begin.u1 * begin.u1 - 2 * begin.u2 * begin.u;
  if (!(slope_2 > 0) || (begin.u2 >= 0 && begin.u1 >= 0)) return {};
  const Real available = reach - from, root = square_root(slope_2);
  Real t = begin.u1 > 0 ? Real((begin.u1 + root) / -begin.u2) : Real(2 * begin.u / (root - begin.u1));
  if (!(t < available)) t = available;
  if (from == 0) {  // on to the root of the cubic, by Newton's method
    const Real third = g[1][1] * t * t * t, slope = begin.u1 + t * (begin.u2 + 3 * g[1][1] * t);
    if (slope < 0 && absolute(third) < -slope * t / 4) t -= third / slope;
  }
  bool near = false;
  for (int i = 0; i < 8; ++i) {
    const SeriesAt<Real> at = near ? sum<Real>(g, Real(from + t)) : sum_of_first<Real, 5>(g, Real(from + t));
    const auto [step, curvature, is_small] = halley_step(Real(-at.u), Real(1 / at.u1), at.u2);
    t += step;
    if (!(t > 0 && t < available)) return {};
    // Halley's method is of third order: the next step would be below rounding.
    if (near && absolute(step) * two_to_the_18 < t && absolute(curvature) * two_to_the_26 < 1)
      return SeriesRoot<Real>{from + t, at.u1 + step * at.u2};
    near = near || absolute(step) * 32 < t;
  }
  return {};
}

}  // namespace impact_damper
