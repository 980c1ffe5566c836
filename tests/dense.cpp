#include "impact_damper/math/dense.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "reference.hpp"

using namespace impact_damper;

namespace {

Matrix random_matrix(std::size_t n, reference::Random& random) {
  Matrix a(n, Vector(n));
  for (Vector& row : a)
    for (double& entry : row) entry = random.uniform(-1, 1);
  return a;
}
double farthest(const Vector& a, const Vector& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace

TEST_CASE("a system of equations is solved though its first pivot is zero, and a singular one is not") {
  const Vector x{3, -1, 2};
  Matrix a{{0, 2, 1}, {4, 1, -3}, {-2, 5, 7}};
  CHECK(farthest(*solution(a, product(a, x)), x) < 1e-14);
  a[2] = {4, 3, -2};  // the sum of the others
  CHECK_FALSE(solution(a, {1, 2, 4}));
  // Without row exchanges the rounding error of the first step alone would be 1.
  CHECK(farthest(*solution({{1e-17, 1}, {1, 1}}, {1, 2}), {1, 1}) < 1e-15);
}

TEST_CASE("a positive definite matrix is solved and inverted, and no other is") {
  // L L^T for L = {{2, 0, 0}, {-1, 3, 0}, {4, 1, 0.5}}: all that follows is exact.
  const Matrix m{{4, -2, 8}, {-2, 10, -1}, {8, -1, 17.25}};
  const Vector x{5, -2, 3}, b = product(m, x);
  const auto factor = Cholesky::of(m);
  REQUIRE(factor);
  CHECK(factor->forward({2, 5, 6}) == Vector{1, 2, 0});
  CHECK(factor->solution(b) == x);
  const std::array<std::array<double, 3>, 3> rows{{{4, -2, 8}, {-2, 10, -1}, {8, -1, 17.25}}};
  const auto both = solution_and_inverse<3>(rows, {b[0], b[1], b[2]}, 1e-12);
  REQUIRE(both);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(both->x[i] == doctest::Approx(x[i]).epsilon(1e-14));
    Vector unit(3);
    unit[i] = 1;
    CHECK(farthest(factor->solution(unit), {both->inverse[0][i], both->inverse[1][i], both->inverse[2][i]}) <
          1e-14);
  }
  CHECK_FALSE(solution_and_inverse<3>(rows, {b[0], b[1], b[2]}, 0.26));  // the last pivot is 0.25
  CHECK_FALSE(Cholesky::of({{1, 2}, {2, 4}}));
  CHECK_FALSE(Cholesky::of({{1, 2}, {2, 3}}));
}

TEST_CASE("nearly parallel columns become orthonormal, and lost directions are replaced") {
  constexpr std::size_t n = 6;
  Matrix columns(n, Vector(n));  // Hilbert's matrix
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k) columns[i][k] = 1 / double(i + k + 1);
  double determinant = 1;
  for (std::size_t j = 0; j < n; ++j) determinant *= *orthonormalise(columns, j);
  CHECK(determinant == doctest::Approx(1 / 186313420339200000.0).epsilon(1e-8));
  const auto check_orthonormal = [&] {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < n; ++k)
        CHECK(std::abs(dot_product(columns[i], columns[k]) - (i == k ? 1 : 0)) < 1e-14);
  };
  check_orthonormal();
  columns[4] = Vector(n);
  CHECK_FALSE(orthonormalise(columns, 4));
  complete_basis(columns, 4);
  check_orthonormal();
}

TEST_CASE("the exponential is that of quadruple precision, for short times and long ones") {
  reference::Random random(5);
  for (const double t : {0.01, 1.0, 8.0}) {
    const Matrix a = random_matrix(4, random);
    reference::Matrix<4> quad{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 4; ++k) quad[i][k] = a[i][k];
    const auto expected = reference::exponential(quad, t);
    const Matrix found =
        matrix_exponential(4, t, 4, [&](const Vector& s, Vector& rates) { rates = product(a, s); });
    double largest = 0, error = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 4; ++k) {
        largest = std::max(largest, std::abs(double(expected[i][k])));
        error = std::max(error, std::abs(found[i][k] - double(expected[i][k])));
      }
    CHECK(error < 64 * std::numeric_limits<double>::epsilon() * largest);
  }
}

TEST_CASE("eigenvalues are those of the block matrix from which a similarity was made") {
  const Matrix blocks{{0.5, -2, 0, 0}, {2, 0.5, 0, 0}, {0, 0, -3, 0}, {0, 0, 0, 0.25}};
  reference::Random random(7);
  const Matrix s = random_matrix(4, random);
  Matrix inverse(4, Vector(4));
  for (std::size_t j = 0; j < 4; ++j) {
    const Vector column = *solution(s, identity_of(4)[j]);
    for (std::size_t i = 0; i < 4; ++i) inverse[i][j] = column[i];
  }
  const auto found = eigenvalues_of(product(product(s, blocks), inverse));
  const std::vector<std::complex<double>> expected{-3.0, 0.25, {0.5, -2}, {0.5, 2}};
  REQUIRE(found.size() == 4);
  for (const std::complex<double>& each : expected) {
    double nearest = 1;
    for (const std::complex<double>& z : found) nearest = std::min(nearest, std::abs(z - each));
    CHECK(nearest < 1e-13);
  }
}
