#include "impact_damper/steady/multipliers.hpp"

#include <algorithm>
#include <cmath>

namespace impact_damper {

double Multiplier::modulus() const { return std::sqrt(re * re + im * im); }

Multipliers multipliers_of(const Matrix4& matrix) {
  Multipliers all;
  const auto values = eigenvalues_of(matrix);
  for (std::size_t i = 0; i < 4; ++i) all[i] = {values[i].real(), values[i].imag()};
  std::stable_sort(all.begin(), all.end(), [](const Multiplier& first, const Multiplier& second) {
    return first.re * first.re + first.im * first.im > second.re * second.re + second.im * second.im;
  });
  return all;
}

}  // namespace impact_damper
