#include "impact_damper/orbits/multipliers.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

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

}  // namespace impact_damper
