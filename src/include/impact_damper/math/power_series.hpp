// Power series in time, which follow a motion for a short time without a sine, and series with fewer terms
// for the same accuracy.
#pragma once

#include <array>
#include <cstddef>

namespace impact_damper {

// Two numbers that undergo the same operations: one instruction for both, where the processor has it.
template <class Real>
struct SimdPairOf {
  class Type {
   public:
    Type() = default;
    Type(const Real& first, const Real& second) : both_{first, second} {}
    const Real& operator[](std::size_t i) const { return both_[i]; }
    friend Type operator+(const Type& a, const Type& b) { return {a[0] + b[0], a[1] + b[1]}; }
    friend Type operator-(const Type& a, const Type& b) { return {a[0] - b[0], a[1] - b[1]}; }
    friend Type operator*(const Type& a, const Type& b) { return {a[0] * b[0], a[1] * b[1]}; }
    friend Type operator*(const Type& a, const Real& b) { return {a[0] * b, a[1] * b}; }
    friend Type operator/(const Type& a, const Real& b) { return {a[0] / b, a[1] / b}; }

   private:
    std::array<Real, 2> both_{};
  };
};
template <>
struct SimdPairOf<double> {
  using Type [[gnu::vector_size(16)]] = double;
};
template <class Real>
using SimdPair = typename SimdPairOf<Real>::Type;

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

// --- Shortened series -------------------------------------------------------------------------------------
// A power series on [0, 1] is shortened: the contributions of its higher terms are moved to the lower ones,
// so that far fewer terms reach the same accuracy (docs/mathematics.md, M4.5).
//
// From the highest down, the term of the power n is replaced by the lower powers of T*_n, Chebyshev's
// polynomial of [0, 1]. The error is at most the term times 2^(1-2n), everywhere in [0, 1]; leaving the term
// out would cost the whole term at 1.

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
