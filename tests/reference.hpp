// What tests compare with: constant linear systems by their matrix exponential in quadruple precision, which
// shares nothing with the library's closed forms; and seeded random numbers that are the same everywhere.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace reference {

#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 Quad;
#else
using Quad = long double;
#endif

template <std::size_t N>
using Vector = std::array<Quad, N>;
template <std::size_t N>
using Matrix = std::array<Vector<N>, N>;

inline Quad absolute(Quad x) { return x < 0 ? -x : x; }

template <std::size_t N>
Matrix<N> product(const Matrix<N>& a, const Matrix<N>& b) {
  Matrix<N> c{};
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t k = 0; k < N; ++k) {
      if (a[i][k] == 0) continue;
      for (std::size_t j = 0; j < N; ++j) c[i][j] += a[i][k] * b[k][j];
    }
  return c;
}

template <std::size_t N>
Vector<N> applied(const Matrix<N>& a, const Vector<N>& u) {
  Vector<N> v{};
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) v[i] += a[i][j] * u[j];
  return v;
}

// exp(a t): Taylor's series where |a| t <= 1/16, then squared again and again. The error is about 1e-34 |a| t
// of the largest entry met.
template <std::size_t N>
Matrix<N> exponential(Matrix<N> a, Quad t) {
  Quad norm = 0;
  for (auto& row : a) {
    Quad sum = 0;
    for (auto& entry : row) sum += absolute(entry *= t);
    if (sum > norm) norm = sum;
  }
  int squarings = 0;
  Quad scale = 1;
  while (norm * scale * 16 > 1) {
    scale /= 2;
    ++squarings;
  }
  Matrix<N> sum{}, term{};
  for (std::size_t i = 0; i < N; ++i) {
    for (auto& entry : a[i]) entry *= scale;
    sum[i][i] = term[i][i] = 1;
  }
  for (int n = 1; n <= 20; ++n) {
    term = product(a, term);
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j) sum[i][j] += (term[i][j] /= n);
  }
  for (int n = 0; n < squarings; ++n) sum = product(sum, sum);
  return sum;
}

// Seeded numbers, the same with every library (splitmix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double uniform(double least, double most) {
    return least + (most - least) * (double(bits() >> 11) * 0x1p-53);
  }
  double log_uniform(double least, double most) { return std::exp(uniform(std::log(least), std::log(most))); }
  bool chance(double probability) { return uniform(0, 1) < probability; }
  double sign() { return chance(0.5) ? 1 : -1; }

 private:
  std::uint64_t state_;
};

}  // namespace reference
