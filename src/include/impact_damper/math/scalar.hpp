// The requirements of the closed-form engines on their number type. The program uses double; tests and the
// bench use wider numbers as a reference, and one that counts its operations.
#pragma once

#include <concepts>
#include <limits>

#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

// A real number with rounding errors of at most `epsilon` and an order, made from double and convertible to
// it. Its elementary functions are found by argument-dependent lookup (elementary.hpp).
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
