// The elementary functions of the result path, all in one place: whatever a run's numbers go through
// besides + - * / and sqrt is called from here and nowhere else (but for the start values in
// contact_factors.cpp, which are iterated away).
#pragma once

#include <cmath>
#include <type_traits>

namespace impact_damper {

template <class Real>
struct SinCos {
  Real sin, cos;
};

template <class Real>
SinCos<Real> sin_cos(const Real& angle) {
  using std::cos, std::sin;
  return {sin(angle), cos(angle)};
}

template <class Real>
Real exponential(const Real& x) {
  using std::exp;
  return exp(x);
}

template <class Real>
Real exponential_minus_1(const Real& x) {
  using std::expm1;
  return expm1(x);
}

template <class Real>
Real logarithm(const Real& x) {
  using std::log;
  return log(x);
}

// The angle in (-pi, pi] of the point (x, y).
template <class Real>
Real angle_of(const Real& y, const Real& x) {
  using std::atan2;
  return atan2(y, x);
}

template <class Real>
Real half_turn() {
  using std::acos;
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
    return std::fabs(x);  // one instruction, where the other is a branch that no processor foresees
  } else {
    return x < 0 ? -x : x;
  }
}

}  // namespace impact_damper
