// Eigenvalues of real matrices.
#pragma once

#include <complex>
#include <vector>

namespace impact_damper {

using Matrix = std::vector<std::vector<double>>;  // row by row

// Of a square matrix. Conjugates are so exactly.
std::vector<std::complex<double>> eigenvalues_of(const Matrix& matrix);
// The same of a matrix that is zero below the diagonal next to its own.
std::vector<std::complex<double>> eigenvalues_of_hessenberg(const Matrix& matrix);

}  // namespace impact_damper
