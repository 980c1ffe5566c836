// The elementary functions of the result path, all in one place: besides + - * / and sqrt the numbers of a
// run go through no others. In double precision they are the project's own, with the same bits everywhere
// (elementary_kernels.hpp); other number types bring theirs.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>

#include "impact_damper/math/elementary_kernels.hpp"

namespace impact_damper {

template <class Real>
SinCos<Real> sin_cos(const Real& angle) {
  using std::cos, std::sin;
  if constexpr (std::is_same_v<Real, double>)
    return elementary::sin_cos(angle);
  else
    return {sin(angle), cos(angle)};
}

template <class Real>
Real exponential(const Real& x) {
  using std::exp;
  if constexpr (std::is_same_v<Real, double>)
    return elementary::exponential(x);
  else
    return exp(x);
}

template <class Real>
Real exponential_minus_1(const Real& x) {
  using std::expm1;
  if constexpr (std::is_same_v<Real, double>)
    return elementary::exponential_minus_1(x);
  else
    return expm1(x);
}

template <class Real>
Real logarithm(const Real& x) {
  using std::log;
  if constexpr (std::is_same_v<Real, double>)
    return elementary::logarithm(x);
  else
    return log(x);
}

// The angle in [-pi, pi] of the point (x, y).
template <class Real>
Real angle_of(const Real& y, const Real& x) {
  using std::atan2;
  if constexpr (std::is_same_v<Real, double>)
    return elementary::angle_of(y, x);
  else
    return atan2(y, x);
}

template <class Real>
Real half_turn() {
  using std::acos;
  if constexpr (std::is_same_v<Real, double>)
    return 2 * elementary::quarter_turn;
  else
    return acos(Real(-1));
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

// The requirements of the closed-form engines on their number type. The program uses double; tests and the
// bench use wider numbers as a reference, and one that counts its operations.
//
// A real number with rounding errors of at most `epsilon` and an order, made from double and convertible to
// it. Its elementary functions are found by argument-dependent lookup.
template <class T>
concept Scalar = std::numeric_limits<T>::is_specialized && std::constructible_from<T, double> &&
    requires(const T& a, const T& b) {
  {T(a + b)};
  {T(a - b)};
  {T(a * b)};
  {T(a / b)};
  {T(-a)};
  { a < b } -> std::convertible_to<bool>;
  { a == b } -> std::convertible_to<bool>;
  {double(a)};
  { square_root(a) } -> std::convertible_to<T>;
  { exponential(a) } -> std::convertible_to<T>;
  { exponential_minus_1(a) } -> std::convertible_to<T>;
  { logarithm(a) } -> std::convertible_to<T>;
  { angle_of(a, b) } -> std::convertible_to<T>;
  { sin_cos(a) } -> std::convertible_to<SinCos<T>>;
};

}  // namespace impact_damper
