#include "impact_damper/motion/contact_factors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "impact_damper/math/dense.hpp"

namespace impact_damper {
namespace {

using Complex = std::complex<double>;

// The roots are about 1. std::abs is not used: its last bit depends on the C library.
double size(const Complex& z) { return std::sqrt(z.real() * z.real() + z.imag() * z.imag()); }

double separation(const std::vector<Complex>& roots, int first, int second) {
  double least = INFINITY;
  for (int i : {first, second}) {
    for (int j = 0; j < 4; ++j) {
      if (j == first || j == second) continue;
      least = std::min(least, size(roots[i] - roots[j]) / (size(roots[i]) + size(roots[j])));
    }
  }
  return least;
}

}  // namespace

QuadraticFactor quadratic_factor(double c3, double c2, double c1, double c0) {
  // In s = scale t the roots lie about 1.
  const double scale = std::sqrt(std::sqrt(c0));
  Matrix companion(4, std::vector<double>(4, 0.0));
  companion[0] = {-c3 / scale, -c2 / (scale * scale), -c1 / (scale * scale * scale), -1};
  companion[1][0] = companion[2][1] = companion[3][2] = 1;
  std::vector<Complex> roots = eigenvalues_of_hessenberg(companion);
  for (Complex& root : roots) root *= scale;

  // The roots come in exact conjugates, so two roots make a real factor if they are conjugate or both real.
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
