// Linear algebra of small dense matrices. Every sum is written out in one order, so that every compiler that
// contracts no product and sum gives the same bits.
//
// Eigen does all this, too, but is used for one thing only, the QR iteration of Hessenberg matrices, compiled
// without vectors and in dense.cpp alone. It promises no order of its sums: the last bits of a solution of 30
// equations depend on the vector width for which it is compiled. Its LU and Cholesky factorisations take
// seconds to compile.
//
// A function that fails for a singular matrix returns a std::optional; the eigenvalues throw.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace impact_damper {

using Vector = std::vector<double>;
using Matrix = std::vector<Vector>;  // row by row

template <class Column>
double dot_product(const Column& a, const Column& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
Vector normalized(Vector a);  // a/|a|

Matrix identity_of(std::size_t n);
Vector product(const Matrix& a, const Vector& b);
Matrix product(const Matrix& a, const Matrix& b);

// Returns the solution of a x = b by Gaussian elimination with partial pivoting; nothing if it is not finite.
std::optional<Vector> solution(Matrix a, Vector b);

// The Cholesky factor L of a symmetric matrix, m = L L^T.
class Cholesky {
 public:
  // Returns the factor; nothing if m is not positive definite. Only the lower triangle of m is read.
  static std::optional<Cholesky> of(Matrix m);
  Vector forward(Vector b) const;   // L^-1 b
  Vector solution(Vector b) const;  // m^-1 b

 private:
  explicit Cholesky(Matrix factor) : factor_(std::move(factor)) {}
  Matrix factor_;
};

// The solution x of m x = b and the inverse of the n x n matrix m.
template <std::size_t n>
struct SolutionAndInverse {
  std::array<double, n> x{};
  std::array<std::array<double, n>, n> inverse{};
};
// Returns both for a symmetric positive definite m by Gauss-Jordan elimination without pivoting; nothing if a
// pivot is not above `least_pivot`.
template <std::size_t n>
std::optional<SolutionAndInverse<n>> solution_and_inverse(std::array<std::array<double, n>, n> m,
                                                          const std::array<double, n>& b,
                                                          double least_pivot) {
  SolutionAndInverse<n> found{b, {}};
  auto& [x, inverse] = found;
  for (std::size_t k = 0; k < n; ++k) inverse[k][k] = 1;
  for (std::size_t k = 0; k < n; ++k) {
    const double pivot = m[k][k];
    if (!(pivot > least_pivot)) return {};
    for (std::size_t j = 0; j < n; ++j) m[k][j] /= pivot, inverse[k][j] /= pivot;
    x[k] /= pivot;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double factor = m[i][k];
      for (std::size_t j = 0; j < n; ++j)
        m[i][j] -= factor * m[k][j], inverse[i][j] -= factor * inverse[k][j];
      x[i] -= factor * x[k];
    }
  }
  return found;
}

// Makes column j orthogonal to those before it, which are orthonormal, by modified Gram-Schmidt, and scales
// it to length 1. Returns its length before it was scaled; nothing if that is 0. Of a dependent column that
// length is a rounding error, and the direction means nothing. One pass would be inaccurate for a column that
// is nearly dependent.
template <class Columns>
std::optional<double> orthonormalise(Columns& columns, std::size_t j) {
  auto& column = columns[j];
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t k = 0; k < j; ++k) {
      const double along = dot_product(columns[k], column);
      for (std::size_t i = 0; i < column.size(); ++i) column[i] -= along * columns[k][i];
    }
  }
  const double size = std::sqrt(dot_product(column, column));
  if (!(size > 0)) return {};
  for (double& entry : column) entry /= size;
  return size;
}

// Replaces the columns from `first` on by vectors orthonormal to the others and to each other. The columns
// before are orthonormal; there are at most as many columns as rows.
template <class Columns>
void complete_basis(Columns& columns, std::size_t first) {
  for (std::size_t j = first; j < columns.size(); ++j) {
    auto& column = columns[j];
    double largest = 0;
    // The unit vector with the largest part outside their span.
    for (std::size_t k = 0; k < column.size(); ++k) {
      double outside = 1;
      for (std::size_t i = 0; i < j; ++i) outside -= columns[i][k] * columns[i][k];
      if (!(outside > largest)) continue;
      largest = outside;
      for (double& entry : column) entry = 0;
      column[k] = 1;
    }
    orthonormalise(columns, j);
  }
}

// Returns exp(A t), of n rows, by scaling and squaring: t >= 0 is halved until t `rate` <= 1, Taylor's series
// is summed, and the sum is squared as often as t was halved. derive(s, rates) sets `rates` to A s; `rate` is
// an upper bound of the modulus of every eigenvalue of A.
template <class Derive>
Matrix matrix_exponential(std::size_t n, double t, double rate, Derive&& derive) {
  constexpr int terms = 24;
  int halvings = 0;
  while (t * rate > 1) {
    t /= 2;
    ++halvings;
  }
  Matrix sum(n, Vector(n));
  Vector rates(n);
  for (std::size_t j = 0; j < n; ++j) {
    Vector term(n);
    term[j] = 1;
    for (int order = 0; order < terms; ++order) {
      for (std::size_t i = 0; i < n; ++i) sum[i][j] += term[i];
      derive(term, rates);
      for (std::size_t i = 0; i < n; ++i) term[i] = rates[i] * (t / (order + 1));
    }
  }
  for (; halvings > 0; --halvings) sum = product(sum, sum);
  return sum;
}

// Returns the eigenvalues of a square matrix. Complex ones come in exactly conjugate pairs. Throws
// NumericalError if they are not found.
std::vector<std::complex<double>> eigenvalues_of(Matrix a);
// Returns the eigenvalues of a Hessenberg matrix: all entries below the first subdiagonal are zero.
std::vector<std::complex<double>> eigenvalues_of_hessenberg(const Matrix& matrix);

}  // namespace impact_damper
