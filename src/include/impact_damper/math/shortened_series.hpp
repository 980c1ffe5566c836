// A power series on [0, 1], shortened: the contributions of its higher terms are moved to the lower ones, so
// that far fewer terms reach the same accuracy (docs/mathematics.md, M4.5).
//
// From the highest down, the term of the power n is replaced by the lower powers of T*_n, Chebyshev's
// polynomial of [0, 1]. The error is at most the term times 2^(1-2n), everywhere in [0, 1]; leaving the term
// out would cost the whole term at 1.
#pragma once

#include <array>
#include <cstddef>

#include "impact_damper/math/power_series.hpp"

namespace impact_damper {

// The amounts that one unit of the coefficient of the power kept + i adds to the coefficients below `kept`.
template <class Real, std::size_t kept, std::size_t count>
inline const std::array<PairedSeries<Real, kept / 2>, count> shares_of_higher_terms = [] {
  static_assert(kept % 2 == 0);
  std::array<PairedSeries<Real, kept / 2>, count> shares;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<Real, kept + count> c{};
    c[kept + i] = 1;
    for (std::size_t n = kept + i; n >= kept; --n) {
      // The coefficients of T*_n, scaled so that the highest is c[n]: each follows from the one above it.
      Real coefficient = c[n];
      for (std::size_t k = n; k > 0; --k) {
        coefficient *= -Real(double(k * (2 * k - 1))) / Real(double(2 * (n + k - 1) * (n - k + 1)));
        c[k - 1] -= coefficient;
      }
    }
    for (std::size_t k = 0; k < kept / 2; ++k) shares[i][k] = SimdPair<Real>{c[2 * k], c[2 * k + 1]};
  }
  return shares;
}();

// Returns the amounts that the coefficients of the powers `kept`, kept + 1, ... add to those below.
template <std::size_t kept, class Real, std::size_t count>
PairedSeries<Real, kept / 2> share_of(const std::array<Real, count>& higher) {
  const auto& shares = shares_of_higher_terms<Real, kept, count>;
  PairedSeries<Real, kept / 2> sum;
  for (std::size_t k = 0; k < kept / 2; ++k) {
    sum[k] = shares[0][k] * higher[0];
    for (std::size_t i = 1; i < count; ++i) sum[k] = sum[k] + shares[i][k] * higher[i];
  }
  return sum;
}

}  // namespace impact_damper
