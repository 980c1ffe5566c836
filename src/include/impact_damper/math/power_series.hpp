// Power series in time, which follow a motion for a short time without a sine.
#pragma once

#include <array>
#include <cstddef>

#include "impact_damper/math/simd_pair.hpp"

namespace impact_damper {

// Derivatives u, u', ... at one instant.
template <class Real, std::size_t N>
using Derivatives = std::array<Real, N>;

// u and its first derivatives at one time, as a series has them.
template <class Real>
struct SeriesAt {
  Real u, u1, u2;
};

// c_0 + c_1 s + c_2 s^2 + ...: coefficients in pairs of an even power and the next odd one. Summed as
// E(z) + s O(z), z = s^2, together with the derivatives of E and O:
//     u' = O + 2s (E' + s O'),      u'' = 2 (E' + 3s O') + 4z (E'' + s O'').
template <class Real, std::size_t pairs>
using PairedSeries = std::array<SimdPair<Real>, pairs>;
template <class Real, std::size_t summed, bool without_line = false, std::size_t pairs>
[[gnu::always_inline]] inline SeriesAt<Real> sum_of_first(const PairedSeries<Real, pairs>& c, const Real& s) {
  static_assert(summed >= 3 && summed <= pairs);
  const Real z = s * s;
  SimdPair<Real> second = c[summed - 1], before = c[summed - 2] + second * z;  // E''/2 and O''/2
  SimdPair<Real> value = before * z, first = before + second * z;
  if (!(without_line && summed == 3)) value = c[summed - 3] + value;
  for (std::size_t n = summed - 3; n > 0; --n) {
    second = first + second * z;
    first = value + first * z;
    value = value * z;
    if (!(without_line && n == 1)) value = c[n - 1] + value;
  }
  return {value[0] + s * value[1], value[1] + 2 * s * (first[0] + s * first[1]),
          2 * (first[0] + 3 * s * first[1]) + 8 * z * (second[0] + s * second[1])};
}
template <class Real, std::size_t pairs>
[[gnu::always_inline]] inline SeriesAt<Real> sum(const PairedSeries<Real, pairs>& c, const Real& s) {
  return sum_of_first<Real, pairs>(c, s);
}

// The departure of a series from its straight line c_0 + c_1 s, that is the series without these two terms,
// and its first two derivatives, multiplied by `times`.
template <class Real, std::size_t pairs>
struct Departure {
  const PairedSeries<Real, pairs>& series;
  Real times{1};
  static constexpr std::size_t all = pairs;

  // Sums the first `summed` pairs.
  template <std::size_t summed = pairs>
  [[gnu::always_inline]] SeriesAt<Real> at(const Real& s) const {
    const SeriesAt<Real> by = sum_of_first<Real, summed, true>(series, s);
    return {times * by.u, times * by.u1, times * by.u2};
  }
};

// 1/n, by which the series are summed: a division is worth four products.
template <class Real>
inline const std::array<Real, 64> reciprocals = [] {
  std::array<Real, 64> all{};
  for (int n = 1; n < 64; ++n) all[n] = Real(1) / n;
  return all;
}();

// (1/0!, 1/1!), (1/2!, 1/3!), ...
template <class Real>
inline const PairedSeries<Real, 5> reciprocal_factorials = [] {
  PairedSeries<Real, 5> all;
  Real even{1};
  double power = 0;
  for (SimdPair<Real>& both : all) {
    const Real odd = even / Real(power + 1);
    both = SimdPair<Real>{even, odd};
    even = odd / Real(power + 2);
    power += 2;
  }
  return all;
}();

// Returns the series of the departure of a motion from a straight line, about one instant: it begins with the
// second derivative. (The first pair is zero.)
template <class Real>
[[gnu::always_inline]] inline PairedSeries<Real, 5> departure_of(const Derivatives<Real, 10>& u) {
  const PairedSeries<Real, 5>& over = reciprocal_factorials<Real>;
  PairedSeries<Real, 5> c;
  c[0] = SimdPair<Real>{Real(0), Real(0)};
  for (std::size_t n = 1; n < c.size(); ++n) {
    const SimdPair<Real> both{u[2 * n], u[2 * n + 1]};
    c[n] = over[n] * both;
  }
  return c;
}

}  // namespace impact_damper
