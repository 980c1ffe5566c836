#include "impact_damper/math/dense.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "impact_damper/base/errors.hpp"

namespace impact_damper {

Vector normalized(Vector a) {
  const double size = std::sqrt(dot_product(a, a));
  for (double& entry : a) entry /= size;
  return a;
}

Matrix identity_of(std::size_t n) {
  Matrix one(n, Vector(n));
  for (std::size_t i = 0; i < n; ++i) one[i][i] = 1;
  return one;
}

Vector product(const Matrix& a, const Vector& b) {
  Vector c(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) c[i] = dot_product(a[i], b);
  return c;
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c(a.size(), Vector(a.size()));
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < a.size(); ++j)
      for (std::size_t k = 0; k < a.size(); ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

std::optional<Vector> solution(Matrix a, Vector b) {
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

std::optional<Cholesky> Cholesky::of(Matrix m) {
  for (std::size_t j = 0; j < m.size(); ++j) {
    for (std::size_t k = 0; k < j; ++k) m[j][j] -= m[j][k] * m[j][k];
    if (!(m[j][j] > 0)) return {};
    m[j][j] = std::sqrt(m[j][j]);
    for (std::size_t i = j + 1; i < m.size(); ++i) {
      for (std::size_t k = 0; k < j; ++k) m[i][j] -= m[i][k] * m[j][k];
      m[i][j] /= m[j][j];
    }
  }
  return Cholesky(std::move(m));
}

Vector Cholesky::forward(Vector b) const {
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= factor_[i][k] * b[k];
    b[i] /= factor_[i][i];
  }
  return b;
}

Vector Cholesky::solution(Vector b) const {
  b = forward(std::move(b));
  for (std::size_t i = b.size(); i-- > 0;) {
    for (std::size_t k = i + 1; k < b.size(); ++k) b[i] -= factor_[k][i] * b[k];
    b[i] /= factor_[i][i];
  }
  return b;
}

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

std::vector<std::complex<double>> eigenvalues_of(Matrix a) {
  // Reduction to Hessenberg form by elimination with pivots: each row operation is followed by the inverse
  // operation on a column.
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
