// Floquet multipliers, and the linear solver that Newton's method for orbits uses.
#pragma once

#include <optional>
#include <vector>

#include "impact_damper/math/eigenvalues.hpp"

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

// The solution of a x = b; nothing if it is not finite. By Gaussian elimination with row pivots.
std::optional<std::vector<double>> solution(Matrix a, std::vector<double> b);

}  // namespace impact_damper
