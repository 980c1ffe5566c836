// Polynomials on [0, 1] in quadruple precision, and their roots, isolated with proof.
#pragma once

#include <array>
#include <vector>

namespace oracle {

__extension__ typedef __float128 Quad;

inline Quad magnitude(Quad x) { return x < 0 ? -x : x; }
inline int sign_of(Quad x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

struct Polynomial {
  static constexpr int most = 56;
  int degree = 0;
  std::array<Quad, most + 1> at{};  // at[n] s^n

  Quad operator()(Quad s) const {
    Quad sum = at[degree];
    for (int n = degree; n-- > 0;) sum = sum * s + at[n];
    return sum;
  }
  Quad sum_of_magnitudes() const {
    Quad sum = 0;
    for (int n = 0; n <= degree; ++n) sum += magnitude(at[n]);
    return sum;
  }
};

Polynomial derivative(const Polynomial& p);
// p(s) / s^power; the terms below must vanish.
Polynomial divided_by_power(const Polynomial& p, int power);
// The integral of p q over [0, s].
Quad integral_of_product(const Polynomial& p, const Polynomial& q, Quad s);

struct Root {
  Quad s;
  int direction;  // of the change of sign: +1 upwards, -1 downwards
};
// Every root in (0, 1] at which p changes its sign, in order. Each interval is either proved free of roots by
// the Bernstein coefficients, or proved monotone by their differences and then decided by the signs at its
// ends; else it is halved, until it is decided or p is zero in all of it within rounding of quadruple
// precision: then the signs at its ends decide, and a touch is none.
std::vector<Root> changes_of_sign(const Polynomial& p);

}  // namespace oracle
