// The characteristic polynomial of a contact, P = J H - g D^2 (M5.1, M5.2), as a product of two real
// quadratics (M5.3).
//
// J = s^2 + j1 s + j0 belongs to the two masses joined, H = s^2 + h1 s + h0 to the wall between them. Their
// coupling g D^2 is weak if the wall is stiff or viscous, or if one mass is light. The unknowns are the
// differences of the factors from J and H, which thus have a relative accuracy of their own.
#pragma once

#include <limits>

#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

// (s^2 + p s + b)(s^2 + p2 s + b2), b <= b2, with p = j1 + dp, b = j0 + db, p2 = h1 - dp, b2 = h0 + db2.
template <class Real>
struct ContactFactors {
  Real p, b, p2, b2;
  Real dp, db, db2;
};

struct QuadraticFactor {
  double p, b;
};
// Returns the slower factor of s^4 + c3 s^3 + c2 s^2 + c1 s + c0 from its roots (Eigen), to a few digits: the
// faster follows from it without cancellation, but not the other way round. Real roots can be paired in
// several ways; the pairing is taken whose two factors have roots farthest apart.
QuadraticFactor quadratic_factor(double c3, double c2, double c1, double c0);

// A wall with K = k/nu above this is much stiffer than all else that holds the primary mass.
template <class Real>
Real stiff_above(const Real& zeta) {
  const Real far = 100 * (1 + 2 * zeta);
  return far * far;
}

template <class Real>
ContactFactors<Real> factor_contact(const Real& nu, const Real& zeta, const Real& stiffness,
                                    const Real& damping) {
  const Real both = 1 + nu, share = nu / both;
  const Real j1 = 2 * zeta / both, j0 = 1 / both;
  const Real h1 = damping * both + 2 * zeta * share, h0 = stiffness * both + share;
  const Real g = share / both;
  ContactFactors<Real> f{};
  const auto differ_by = [&](const Real& dp, const Real& db) {
    f.dp = dp;
    f.db = db;
    f.p = j1 + dp;
    f.b = j0 + db;
    f.p2 = h1 - dp;
    f.db2 = -4 * g * zeta * zeta - db - dp * (f.p2 - j1);
    f.b2 = h0 + f.db2;
  };
  differ_by(0, 0);
  // With a wall that is much stiffer than the spring, the joined motion is near enough to start from.
  if (!(stiffness > stiff_above(zeta))) {
    const Real c3 = 2 * zeta + damping * both, c2 = 1 + 2 * zeta * damping + stiffness * both;
    const Real c1 = damping + 2 * zeta * stiffness;
    const QuadraticFactor start = quadratic_factor(double(c3), double(c2), double(c1), double(stiffness));
    differ_by(start.p - j1, start.b - j0);
  }
  // Bairstow's iteration, Newton's method on the remainder r1 s + r0, until rounding errors stop it.
  Real before = std::numeric_limits<Real>::infinity();
  for (int i = 0; i < 50; ++i) {
    const Real alpha = f.p2 - f.p, beta = f.b2 - f.b;
    const Real r1 = 4 * g * zeta + f.dp * beta + f.db * h1 + f.db2 * j1;
    const Real r0 = g + f.db * h0 + f.db2 * f.b;
    const Real determinant = beta * (beta - f.p * alpha) + f.b * alpha * alpha;
    if (!(determinant != 0)) break;
    const Real dp = (alpha * r0 - beta * r1) / determinant;
    const Real db = -(f.b * alpha * r1 + (beta - f.p * alpha) * r0) / determinant;
    const Real step =
        absolute(db) / absolute(f.b) + absolute(dp) / (absolute(f.p) + square_root(absolute(f.b)));
    if (!(step > 0) || (step < Real(1e-3) && !(step < before / 2))) break;
    before = step;
    differ_by(f.dp + dp, f.db + db);
  }
  if (f.b2 < f.b) {
    const ContactFactors<Real> other = f;
    f.p = other.p2;
    f.b = other.b2;
    f.p2 = other.p;
    f.b2 = other.b;
    f.dp = f.p - j1;
    f.db = f.b - j0;
    f.db2 = f.b2 - h0;
  }
  // The energy bounds need damping >= 0, which a rounding error may violate where it is zero.
  if (f.p < 0) f.p = 0;
  if (f.p2 < 0) f.p2 = 0;
  return f;
}

}  // namespace impact_damper
