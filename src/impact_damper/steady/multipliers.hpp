// Eigenvalues and linear equations of the size that orbits need.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "impact_damper/math/eigenvalues.hpp"

namespace impact_damper {

// A Floquet multiplier: by what a small departure from an orbit is multiplied each time it is completed.
struct Multiplier {
  double re = 0, im = 0;
  double modulus() const;  // |re + i im|
};
using Multipliers = std::array<Multiplier, 4>;

// The eigenvalues of a matrix, the largest modulus first; of a conjugate pair the one with
// im > 0 first.
Multipliers multipliers_of(const Matrix4& matrix);

// The solution of a x = b; nothing if it is not finite. By Gaussian elimination with row pivots.
template <std::size_t n>
std::optional<std::array<double, n>> solution(std::array<std::array<double, n>, n> a,
                                              std::array<double, n> b) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (a[i][k] * a[i][k] > a[pivot][k] * a[pivot][k]) pivot = i;
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
    if (!std::isfinite(b[k])) return {};
  }
  return b;
}

}  // namespace impact_damper
