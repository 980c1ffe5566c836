#include "impact_damper/steady/multipliers.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>

namespace impact_damper {

double Multiplier::modulus() const { return std::sqrt(re * re + im * im); }

Multipliers multipliers_of(const Matrix& matrix) {
  Multipliers all;
  for (const std::complex<double>& value : eigenvalues_of(matrix))
    all.push_back({value.real(), value.imag()});
  std::stable_sort(all.begin(), all.end(), [](const Multiplier& first, const Multiplier& second) {
    return first.re * first.re + first.im * first.im > second.re * second.re + second.im * second.im;
  });
  return all;
}

std::optional<std::vector<double>> solution(Matrix a, std::vector<double> b) {
  const std::size_t n = b.size();
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
