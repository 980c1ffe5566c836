// The propagator of a contact without modes (M5.7): exp(A t) as a product of powers exp(2^j A h), tabulated
// once for a scene and rounded once, and of a Taylor series for the rest of t, below h. It needs no
// eigenvalues. No factor increases the energy (M5.8), and so none increases the rounding errors of the
// factors before it.
#pragma once

#include <vector>

#include "impact_damper/math/double_double.hpp"
#include "impact_damper/motion/oscillator.hpp"

namespace impact_damper {

// The numbers in the equations of a contact with a force, named as in contact_modes.hpp.
template <class Real>
struct ContactEquations {
  Real nu, zeta, stiffness, damping;  // nu, zeta, K = k/nu, c
  Forcing<Real> forcing;
};

// exp(A t) for the six numbers (x, v, q, w, f, g), f = f0 sin(phase), g = f0 cos(phase).
template <class Real>
class ContactExponential {
 public:
  using Vector = std::array<Real, 6>;

  explicit ContactExponential(const ContactEquations<Real>& equations) : equations_(equations) {
    const auto& [nu, zeta, stiffness, damping, forcing] = equations;
    const Real both = 1 + nu;
    rate_ = square_root(Real(1 + stiffness * both)) + 2 * zeta + damping * both;
    if (forcing) rate_ += forcing.frequency;
    while (shortest_ * rate_ > Real(0.5)) shortest_ /= 2;
    Matrix power = short_exponential();
    // Longer than any run.
    Real step = shortest_;
    while (step < Real(1e13)) {
      powers_.push_back(rounded(power));
      power = product(power, power);
      step *= 2;
    }
  }

  Vector operator()(Vector s, Real t) const {
    Real step = shortest_;
    std::size_t above = 0;
    for (; above < powers_.size() && step <= t; ++above) step *= 2;
    for (std::size_t j = above; j > 0; --j) {
      step /= 2;
      if (t < step) continue;
      s = apply(powers_[j - 1], s);
      t -= step;  // without rounding: t is between one and two steps
    }
    const auto& over = reciprocals<Real>;
    Vector term = s, sum{};
    for (int n = 1; n <= terms; ++n) {
      term = derivative<Real>(term);
      for (std::size_t i = 0; i < 6; ++i) {
        term[i] *= t * over[n];
        sum[i] += term[i];
      }
    }
    for (std::size_t i = 0; i < 6; ++i) s[i] += sum[i];
    return s;
  }

  // Returns A s.
  template <class Number>
  std::array<Number, 6> derivative(const std::array<Number, 6>& s) const {
    const auto& [x, v, q, w, f, g] = s;
    const auto times = [](const Real& a, const Number& b) { return Number(a) * b; };
    const Number wall = times(equations_.damping, w) + times(equations_.stiffness, q);
    const Number v1 = times(equations_.nu, wall) + (times(-2 * equations_.zeta, v) + times(-1, x)) + f;
    const Real omega = equations_.forcing.frequency;
    return {v, v1, w, times(-1, wall) + times(-1, v1), times(omega, g), times(-omega, f)};
  }
  // Upper bound of the modulus of every eigenvalue, the force included.
  const Real& rate() const { return rate_; }
  const ContactEquations<Real>& equations() const { return equations_; }

 private:
  using Number = typename Extended<Real>::Type;
  using Matrix = std::array<std::array<Number, 6>, 6>;  // by columns
  using Rounded = std::array<Vector, 6>;
  // (1/2)^n/n! is far below a rounding error.
  static constexpr int terms = std::numeric_limits<Real>::digits10 < 20 ? 18 : 30;

  Matrix short_exponential() const {
    Matrix sum{};
    for (std::size_t j = 0; j < 6; ++j) {
      std::array<Number, 6> term{};
      term[j] = Number(1);
      sum[j] = term;
      for (int n = 1; n <= 30; ++n) {
        term = derivative<Number>(term);
        for (std::size_t i = 0; i < 6; ++i) {
          term[i] = term[i] * Number(shortest_) / Number(double(n));
          sum[j][i] = sum[j][i] + term[i];
        }
      }
    }
    return sum;
  }
  static Matrix product(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t j = 0; j < 6; ++j)
      for (std::size_t m = 0; m < 6; ++m)
        for (std::size_t i = 0; i < 6; ++i) c[j][i] = c[j][i] + a[m][i] * b[j][m];
    return c;
  }
  static Rounded rounded(const Matrix& a) {
    Rounded b{};
    for (std::size_t j = 0; j < 6; ++j)
      for (std::size_t i = 0; i < 6; ++i) b[j][i] = Real(a[j][i]);
    return b;
  }
  static Vector apply(const Rounded& a, const Vector& s) {
    Vector to{};
    for (std::size_t j = 0; j < 6; ++j)
      for (std::size_t i = 0; i < 6; ++i) to[i] += a[j][i] * s[j];
    return to;
  }

  ContactEquations<Real> equations_;
  Real rate_{1}, shortest_{1};
  std::vector<Rounded> powers_;
};

}  // namespace impact_damper
