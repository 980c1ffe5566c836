// Eigenvalues of matrices of four rows.
#pragma once

#include <array>
#include <complex>

namespace impact_damper {

using Matrix4 = std::array<std::array<double, 4>, 4>;  // row by row

// Conjugates are so exactly.
std::array<std::complex<double>, 4> eigenvalues_of(const Matrix4& matrix);
// The same of a matrix that is zero below the diagonal next to its own.
std::array<std::complex<double>, 4> eigenvalues_of_hessenberg(const Matrix4& matrix);

}  // namespace impact_damper
