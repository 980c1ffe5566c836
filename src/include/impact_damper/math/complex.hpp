// Complex numbers whose products and quotients are computed as written here. Those of std::complex come from
// the compiler's own library, and differ between versions.
#pragma once

#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

template <class Real>
class Complex {
 public:
  Complex() = default;
  explicit Complex(const Real& real, const Real& imag = Real(0)) : real_(real), imag_(imag) {}
  const Real& real() const { return real_; }
  const Real& imag() const { return imag_; }

  friend Complex conjugate(const Complex& z) { return Complex(z.real_, -z.imag_); }
  friend Complex operator+(const Complex& a, const Complex& b) {
    return Complex(a.real_ + b.real_, a.imag_ + b.imag_);
  }
  friend Complex operator-(const Complex& a, const Complex& b) {
    return Complex(a.real_ - b.real_, a.imag_ - b.imag_);
  }
  friend Complex operator*(const Complex& a, const Complex& b) {
    return Complex(a.real_ * b.real_ - a.imag_ * b.imag_, a.real_ * b.imag_ + a.imag_ * b.real_);
  }
  // Smith's method: no square that could leave the range.
  friend Complex operator/(const Complex& a, const Complex& b) {
    if (absolute(b.real_) < absolute(b.imag_)) {
      const Real ratio = b.real_ / b.imag_, divisor = b.real_ * ratio + b.imag_;
      return Complex((a.real_ * ratio + a.imag_) / divisor, (a.imag_ * ratio - a.real_) / divisor);
    }
    const Real ratio = b.imag_ / b.real_, divisor = b.real_ + b.imag_ * ratio;
    return Complex((a.real_ + a.imag_ * ratio) / divisor, (a.imag_ - a.real_ * ratio) / divisor);
  }
  friend bool operator==(const Complex& a, const Complex& b) {
    return a.real_ == b.real_ && a.imag_ == b.imag_;
  }

 private:
  Real real_{0}, imag_{0};
};

}  // namespace impact_damper
