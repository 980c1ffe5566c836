// The direction in which a mass at rest on a wall goes: the first derivative of x, from x'' on, that is not
// zero decides (docs/mathematics.md, M7.12).
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/forcing.hpp"

namespace impact_damper {

// A wall in contact: the mass ratio nu of the mass that pushes it, its K = k/nu and c, and q and q' now.
template <class Real>
struct PushedWall {
  Real nu, stiffness, damping;
  Real q, w;
};

// The first derivative of x, from x'' on, that is not zero to rounding. Order 0: all are zero, and so x'' for
// ever.
template <class Real>
struct Lead {
  std::size_t order = 0;
  Real value{0};
  // Returns the side on which masses at rest are pressed against their walls: 1 left, -1 right, 0 neither.
  Real side() const { return value > 0 ? Real(1) : value < 0 ? Real(-1) : Real(0); }
};

// Returns the lead of x, which obeys x'' + a2 x' + b x = f with the forces of the walls `pushed` added to f
// and has x and x' now. A derivative counts as zero if it does not exceed the rounding errors of the terms
// that make it up; those that follow are then made with zero in its place.
template <class Real, class Force>
Lead<Real> lead_of_x(const Real& a2, const Real& b, const Force& forcing, const SinCos<Real>& phase, Real x,
                     Real x1, std::span<const PushedWall<Real>> pushed = {}) {
  const Real rounding = 4 * std::numeric_limits<Real>::epsilon();
  auto [f, f1] = forcing.template derivatives<2>(phase);
  Real amplitude = absolute(forcing.amplitude);
  std::vector<PushedWall<Real>> walls(pushed.begin(), pushed.end());
  // x'' obeys a linear equation of this order: if so many derivatives vanish, all vanish for ever.
  const std::size_t order = 4 + 2 * walls.size();
  for (std::size_t n = 2; n < 2 + order; ++n) {
    Real sum = f - a2 * x1 - b * x, size = b * absolute(x) + a2 * absolute(x1) + amplitude;
    for (const auto& [nu, stiffness, damping, q, w] : walls) {
      const Real force = nu * (damping * w + stiffness * q);
      sum += force;
      size += absolute(force);
    }
    if (absolute(sum) > rounding * size) return {n, sum};
    for (auto& [nu, stiffness, damping, q, w] : walls) {
      const Real next = -(damping * w + stiffness * q);
      q = w;
      w = next;
    }
    x = x1;
    x1 = 0;
    amplitude *= forcing.frequency;
    const Real f2 = -forcing.frequency * forcing.frequency * f;
    f = f1;
    f1 = f2;
  }
  return {};
}

// Lower bound of the time for which a mass at rest on a compliant wall stays in it, if `lead` presses it into
// the wall (M7.13).
template <class Real, class Force>
Real pressed_at_least(const Lead<Real>& lead, const Real& zeta, const Force& forcing) {
  const Real size = absolute(lead.value), longest = forcing.frequency > 1 ? 1 / forcing.frequency : Real(1);
  Real power = absolute(forcing.amplitude);
  for (std::size_t n = 1; n < lead.order; ++n) power *= forcing.frequency;
  const Real keeps = size / (power + (1 + 2 * zeta) * (size + power * longest));
  return keeps < longest ? keeps : longest;
}

}  // namespace impact_damper
