#include "impact_damper/math/eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

namespace impact_damper {

// Eigen's EigenSolver knows eigenvectors, too, and brings a matrix into Hessenberg form first: the same
// eigenvalues, bit for bit, but ten times as long to compile.
std::array<std::complex<double>, 4> eigenvalues_of_hessenberg(const Matrix4& matrix) {
  Eigen::Matrix4d hessenberg;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) hessenberg(i, j) = matrix[i][j];
  const double largest = hessenberg.cwiseAbs().maxCoeff();
  if (largest == 0) return {};
  Eigen::RealSchur<Eigen::Matrix4d> schur(4);
  schur.computeFromHessenberg(hessenberg / largest, Eigen::Matrix4d(), false);
  const Eigen::Matrix4d triangular = schur.matrixT() * largest;

  // On the diagonal stand real eigenvalues, and blocks of two rows for two conjugate ones.
  std::array<std::complex<double>, 4> values;
  for (int i = 0; i < 4; ++i) {
    if (i == 3 || triangular(i + 1, i) == 0) {
      values[i] = triangular(i, i);
      continue;
    }
    const double below = triangular(i + 1, i), above = triangular(i, i + 1), last = triangular(i + 1, i + 1);
    const double half = 0.5 * (triangular(i, i) - last);
    const double most = std::max({std::fabs(half), std::fabs(below), std::fabs(above)});
    const double p = half / most;
    values[i] = {last + half, most * std::sqrt(std::fabs(p * p + (below / most) * (above / most)))};
    values[i + 1] = std::conj(values[i]);
    ++i;
  }
  return values;
}

std::array<std::complex<double>, 4> eigenvalues_of(const Matrix4& matrix) {
  // By elimination with pivots: what is taken from a row with a factor is given back to a column.
  Matrix4 a = matrix;
  for (std::size_t k = 1; k < 3; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < 4; ++i)
      if (std::fabs(a[i][k - 1]) > std::fabs(a[pivot][k - 1])) pivot = i;
    if (a[pivot][k - 1] == 0) continue;
    std::swap(a[k], a[pivot]);
    for (auto& row : a) std::swap(row[k], row[pivot]);
    for (std::size_t i = k + 1; i < 4; ++i) {
      const double factor = a[i][k - 1] / a[k][k - 1];
      for (std::size_t j = 0; j < 4; ++j) a[i][j] -= factor * a[k][j];
      for (auto& row : a) row[k] += factor * row[i];
      a[i][k - 1] = 0;
    }
  }
  return eigenvalues_of_hessenberg(a);
}

}  // namespace impact_damper
