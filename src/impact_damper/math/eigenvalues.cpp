#include "impact_damper/math/eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "impact_damper/base/errors.hpp"

namespace impact_damper {

// Eigen's EigenSolver also computes eigenvectors, and first reduces a matrix to Hessenberg form. It gives the
// same eigenvalues, bit for bit, but takes ten times as long to compile.
std::vector<std::complex<double>> eigenvalues_of_hessenberg(const Matrix& matrix) {
  const auto n = Eigen::Index(matrix.size());
  Eigen::MatrixXd hessenberg(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) hessenberg(i, j) = matrix[std::size_t(i)][std::size_t(j)];
  std::vector<std::complex<double>> values(matrix.size());
  const double largest = n == 0 ? 0 : hessenberg.cwiseAbs().maxCoeff();
  if (largest == 0) return values;
  Eigen::RealSchur<Eigen::MatrixXd> schur(n);
  schur.computeFromHessenberg(hessenberg / largest, Eigen::MatrixXd(), false);
  if (schur.info() != Eigen::Success) throw NumericalError("a matrix whose eigenvalues were not found");
  const Eigen::MatrixXd triangular = schur.matrixT() * largest;

  // The diagonal has real eigenvalues, and blocks of two rows for two conjugate ones.
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = std::size_t(i);
    if (i == n - 1 || triangular(i + 1, i) == 0) {
      values[at] = triangular(i, i);
      continue;
    }
    const double below = triangular(i + 1, i), above = triangular(i, i + 1), last = triangular(i + 1, i + 1);
    const double half = 0.5 * (triangular(i, i) - last);
    const double most = std::max({std::fabs(half), std::fabs(below), std::fabs(above)});
    const double p = half / most;
    values[at] = {last + half, most * std::sqrt(std::fabs(p * p + (below / most) * (above / most)))};
    values[at + 1] = std::conj(values[at]);
    ++i;
  }
  return values;
}

std::vector<std::complex<double>> eigenvalues_of(const Matrix& matrix) {
  // Reduction to Hessenberg form by elimination with pivots: each row operation is followed by the inverse
  // operation on a column.
  Matrix a = matrix;
  const std::size_t n = a.size();
  for (std::size_t k = 1; k + 1 < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::fabs(a[i][k - 1]) > std::fabs(a[pivot][k - 1])) pivot = i;
    if (a[pivot][k - 1] == 0) continue;
    std::swap(a[k], a[pivot]);
    for (auto& row : a) std::swap(row[k], row[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a[i][k - 1] / a[k][k - 1];
      for (std::size_t j = 0; j < n; ++j) a[i][j] -= factor * a[k][j];
      for (auto& row : a) row[k] += factor * row[i];
      a[i][k - 1] = 0;
    }
  }
  return eigenvalues_of_hessenberg(a);
}

}  // namespace impact_damper
