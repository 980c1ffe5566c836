// Floquet multipliers.
#pragma once

#include <vector>

#include "impact_damper/math/dense.hpp"

namespace impact_damper {

// A Floquet multiplier of an orbit, an eigenvalue of its monodromy matrix: the factor by which a small
// departure from the orbit along the eigenvector grows in each period.
struct Multiplier {
  double re = 0, im = 0;
  double modulus() const;  // |re + i im|
};
using Multipliers = std::vector<Multiplier>;

// The eigenvalues of a matrix, the largest modulus first; of a conjugate pair the one with im > 0 first.
Multipliers multipliers_of(const Matrix& matrix);

}  // namespace impact_damper
