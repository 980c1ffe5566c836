// Eigenvalues of real matrices.
#pragma once

#include <complex>
#include <vector>

namespace impact_damper {

using Matrix = std::vector<std::vector<double>>;  // row by row

// Returns the eigenvalues of a square matrix. Complex ones come in exactly conjugate pairs.
std::vector<std::complex<double>> eigenvalues_of(const Matrix& matrix);
// Returns those of a Hessenberg matrix: all entries below the first subdiagonal are zero.
std::vector<std::complex<double>> eigenvalues_of_hessenberg(const Matrix& matrix);

}  // namespace impact_damper
