// The contact's characteristic polynomial P(s) (contact.hpp) as a product of two real quadratics.
#pragma once

#include <limits>

#include "impact_damper/motion/elementary.hpp"

namespace impact_damper {

// (s^2 + p s + b)(s^2 + p2 s + b2), b <= b2.
template <class Real>
struct ContactFactors {
  Real p, b, p2, b2;
};

struct QuadraticFactor {
  double p, b;
};
// The slower factor of s^4 + c3 s^3 + c2 s^2 + c1 s + c0 from its roots (Eigen), to a few digits: the faster
// follows from it without cancellation, but not the other way round. Of the possible pairings of real roots
// the one whose two factors have roots farthest apart.
QuadraticFactor quadratic_factor(double c3, double c2, double c1, double c0);

template <class Real>
ContactFactors<Real> factor_contact(const Real& nu, const Real& zeta, const Real& stiffness,
                                    const Real& damping) {
  const Real c3 = 2 * zeta + damping * (1 + nu), c2 = 1 + 2 * zeta * damping + stiffness * (1 + nu);
  const Real c1 = damping + 2 * zeta * stiffness, c0 = stiffness;
  ContactFactors<Real> factors;
  // With a wall that is much stiffer than the spring the slow motion is nearly the stuck one.
  Real p = 2 * zeta / (1 + nu), b = 1 / (1 + nu);
  const Real far = 100 * (1 + 2 * zeta);
  if (!(stiffness > far * far)) {
    const QuadraticFactor factor = quadratic_factor(double(c3), double(c2), double(c1), double(c0));
    p = factor.p;
    b = factor.b;
  }
  // Bairstow's iteration: Newton on the remainder r1 s + r0 of P by s^2 + p s + b.
  for (int i = 0; i < 50; ++i) {
    const Real p2 = c3 - p, b2 = c2 - b - p * p2;
    const Real r1 = c1 - p * b2 - b * p2, r0 = c0 - b * b2;
    const Real r1_p = -b2 + p * (p2 - p) + b, r1_b = p - p2;
    const Real r0_p = -b * (p - p2), r0_b = b - b2;
    const Real determinant = r1_p * r0_b - r1_b * r0_p;
    const Real dp = (r1_b * r0 - r0_b * r1) / determinant, db = (r0_p * r1 - r1_p * r0) / determinant;
    if (!(determinant != 0)) break;
    p += dp;
    b += db;
    const Real tiny = 4 * std::numeric_limits<Real>::epsilon();
    if (absolute(db) <= tiny * absolute(b) && absolute(dp) <= tiny * (absolute(p) + square_root(absolute(b))))
      break;
  }
  factors.p = p;
  factors.b = b;
  factors.p2 = c3 - p;
  factors.b2 = c2 - b - p * factors.p2;
  if (factors.b2 < factors.b) {
    const ContactFactors<Real> other = factors;
    factors.p = other.p2;
    factors.b = other.b2;
    factors.p2 = other.p;
    factors.b2 = other.b;
  }
  // The energy bounds need damping that is not negative; a rounding error may make it so where it is zero.
  if (factors.p < 0) factors.p = 0;
  if (factors.p2 < 0) factors.p2 = 0;
  return factors;
}

}  // namespace impact_damper
