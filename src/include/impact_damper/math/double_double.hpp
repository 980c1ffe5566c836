// Sums of two doubles, the second below half a unit in the last place of the first: about 31 digits, with the
// same bits everywhere (Dekker 1971, doi:10.1007/BF01397083). For tables that are made once in a scene.
#pragma once

#include <cmath>

namespace impact_damper {

class DoubleDouble {
 public:
  DoubleDouble() = default;
  explicit DoubleDouble(double value) : high_(value) {}
  explicit operator double() const { return high_; }

  friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble sum = exact_sum(a.high_, b.high_);
    return quick_sum(sum.high_, sum.low_ + (a.low_ + b.low_));
  }
  friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble product = exact_product(a.high_, b.high_);
    return quick_sum(product.high_, product.low_ + (a.high_ * b.low_ + a.low_ * b.high_));
  }
  friend DoubleDouble operator-(const DoubleDouble& a) { return {-a.high_, -a.low_}; }
  friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
  friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double quotient = a.high_ / b.high_;
    const DoubleDouble rest = a + DoubleDouble(-quotient) * b;
    return quick_sum(quotient, (rest.high_ + rest.low_) / b.high_);
  }
  friend DoubleDouble sqrt(const DoubleDouble& a) {  // a > 0
    const double root = std::sqrt(a.high_);
    const DoubleDouble rest = a - exact_product(root, root);
    return quick_sum(root, (rest.high_ + rest.low_) / (2 * root));
  }

 private:
  DoubleDouble(double high, double low) : high_(high), low_(low) {}
  static DoubleDouble quick_sum(double a, double b) {  // |a| >= |b|
    const double sum = a + b;
    return {sum, b - (sum - a)};
  }
  static DoubleDouble exact_sum(double a, double b) {
    const double sum = a + b, part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
  }
  static DoubleDouble exact_product(double a, double b) {
    const auto upper_half = [](double x) {
      const double scaled = 134217729 * x;  // 2^27 + 1
      return scaled - (scaled - x);
    };
    const double product = a * b, a1 = upper_half(a), b1 = upper_half(b), a2 = a - a1, b2 = b - b1;
    return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
  }

  double high_ = 0, low_ = 0;
};

// The type in which tables for results in Real are made.
template <class Real>
struct Extended {
  using Type = Real;
};
template <>
struct Extended<double> {
  using Type = DoubleDouble;
};

}  // namespace impact_damper
