#include "impact_damper/motion/contact_factors.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace impact_damper {
namespace {

using Complex = std::complex<double>;

// The roots are about 1. Not std::abs, whose last bit is the C library's.
double size(const Complex& z) { return std::sqrt(z.real() * z.real() + z.imag() * z.imag()); }

double separation(const std::array<Complex, 4>& roots, int first, int second) {
  double least = INFINITY;
  for (int i : {first, second}) {
    for (int j = 0; j < 4; ++j) {
      if (j == first || j == second) continue;
      least = std::min(least, size(roots[i] - roots[j]) / (size(roots[i]) + size(roots[j])));
    }
  }
  return least;
}

// Of a matrix in Hessenberg form. Eigen's EigenSolver would bring it into that form first and knows
// eigenvectors: the same eigenvalues, bit for bit, but ten times as long to compile.
std::array<Complex, 4> eigenvalues_of(const Eigen::Matrix4d& hessenberg) {
  const double largest = hessenberg.cwiseAbs().maxCoeff();
  Eigen::RealSchur<Eigen::Matrix4d> schur(4);
  schur.computeFromHessenberg(hessenberg / largest, Eigen::Matrix4d(), false);
  const Eigen::Matrix4d triangular = schur.matrixT() * largest;

  // On the diagonal stand real eigenvalues, and blocks of two rows for two conjugate ones.
  std::array<Complex, 4> values;
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

}  // namespace

QuadraticFactor quadratic_factor(double c3, double c2, double c1, double c0) {
  // In s = scale t the roots lie about 1.
  const double scale = std::sqrt(std::sqrt(c0));
  Eigen::Matrix4d companion = Eigen::Matrix4d::Zero();
  companion(0, 0) = -c3 / scale;
  companion(0, 1) = -c2 / (scale * scale);
  companion(0, 2) = -c1 / (scale * scale * scale);
  companion(0, 3) = -1;
  companion(1, 0) = companion(2, 1) = companion(3, 2) = 1;
  std::array<Complex, 4> roots = eigenvalues_of(companion);
  for (Complex& root : roots) root *= scale;

  // Conjugates are so exactly, so two roots make a real factor if they are conjugate or both real.
  double best = -1;
  QuadraticFactor factor{};
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      const Complex sum = roots[i] + roots[j], product = roots[i] * roots[j];
      if (sum.imag() != 0 || (roots[i].imag() == 0) != (roots[j].imag() == 0)) continue;
      if (product.real() > scale * scale * (1 + 1e-6)) continue;  // the faster of two factors
      int others_imaginary = 0;
      for (int m = 0; m < 4; ++m) others_imaginary += m != i && m != j && roots[m].imag() != 0;
      if (others_imaginary == 1) continue;
      const double apart = separation(roots, i, j);
      if (apart > best || (apart == best && product.real() < factor.b)) {
        best = apart;
        factor = {-sum.real(), product.real()};
      }
    }
  }
  return factor;
}

}  // namespace impact_damper
