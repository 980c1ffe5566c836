// The elementary functions of the result path, all in one place: besides + - * / and sqrt the numbers of a
// run go through no others. In double precision they are the project's own, with the same bits everywhere
// (elementary_kernels.hpp); other number types bring theirs.
#pragma once

#include <cmath>
#include <type_traits>

#include "impact_damper/math/elementary_kernels.hpp"

namespace impact_damper {

template <class Real>
SinCos<Real> sin_cos(const Real& angle) {
  if constexpr (std::is_same_v<Real, double>) {
    return elementary::sin_cos(angle);
  } else {
    using std::cos, std::sin;
    return {sin(angle), cos(angle)};
  }
}

template <class Real>
Real exponential(const Real& x) {
  if constexpr (std::is_same_v<Real, double>) {
    return elementary::exponential(x);
  } else {
    using std::exp;
    return exp(x);
  }
}

template <class Real>
Real exponential_minus_1(const Real& x) {
  if constexpr (std::is_same_v<Real, double>) {
    return elementary::exponential_minus_1(x);
  } else {
    using std::expm1;
    return expm1(x);
  }
}

template <class Real>
Real logarithm(const Real& x) {
  if constexpr (std::is_same_v<Real, double>) {
    return elementary::logarithm(x);
  } else {
    using std::log;
    return log(x);
  }
}

// The angle in [-pi, pi] of the point (x, y).
template <class Real>
Real angle_of(const Real& y, const Real& x) {
  if constexpr (std::is_same_v<Real, double>) {
    return elementary::angle_of(y, x);
  } else {
    using std::atan2;
    return atan2(y, x);
  }
}

template <class Real>
Real half_turn() {
  if constexpr (std::is_same_v<Real, double>) {
    return 2 * elementary::quarter_turn;
  } else {
    using std::acos;
    return acos(Real(-1));
  }
}

template <class Real>
Real square_root(const Real& x) {
  using std::sqrt;
  return sqrt(x);
}

template <class Real>
Real absolute(const Real& x) {
  if constexpr (std::is_floating_point_v<Real>) {
    return std::fabs(x);  // one instruction, where the other is a branch that no processor predicts
  } else {
    return x < 0 ? -x : x;
  }
}

// 1 where x > 0, 0 where x < 0, and one of them where x is zero or not a number.
template <class Real>
Real one_if_positive(const Real& x) {
  if constexpr (std::is_floating_point_v<Real>) {
    return (1 + std::copysign(Real(1), x)) / 2;  // without a branch, as above
  } else {
    return x > 0 ? Real(1) : Real(0);
  }
}

// The least whole number not below x, without a call.
inline double whole_above(double x) {
  if (!(absolute(x) < 0x1p52)) return x;
  const double whole = double(static_cast<long long>(x));
  return whole < x ? whole + 1 : whole;
}

}  // namespace impact_damper
