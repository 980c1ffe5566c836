#include "impact_damper/motion/wall.hpp"

#include <cmath>
#include <numbers>

#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/force_law.hpp"

namespace impact_damper {
namespace {

// Returns the velocity with which a unit velocity comes back from the wall, in time units of 1/omega_m: q'' +
// 2 zeta q' + q = 0, q(0) = 0, q'(0) = -1, until q = 0 again at t = pi/omega, omega^2 = 1 - zeta^2. It is
// reached in `steps` equal closed-form steps, as in the paper's subroutine.
double rebound_velocity(double zeta, int steps) {
  const double omega = std::sqrt((1 - zeta) * (1 + zeta));
  const double h = std::numbers::pi / omega / steps;
  const double decay = exponential(-zeta * h);
  const auto [sin, cos] = sin_cos(omega * h);
  const double s = decay * sin / omega;
  const double c = decay * cos + zeta * s;
  double q = 0, w = -1;
  for (int i = 0; i < steps; ++i) {
    const double next = c * q + s * w;
    w = (c - 2 * zeta * s) * w - s * q;
    q = next;
  }
  return w;
}

}  // namespace

IterativeZeta zeta_m_iterative(double restitution, double tolerance) {
  constexpr int steps = 100;
  // The rebound velocity falls from 1 to 0 as zeta goes from 0 to 1, so bisection cannot fail. It starts,
  // as the paper's subroutine, from a small assumed damping ratio and corrects it until the error is met.
  IterativeZeta found;
  found.steps = steps;
  double low = 0, high = 1;
  found.zeta_m = 0;
  found.velocity_error = std::abs(rebound_velocity(found.zeta_m, steps) - restitution);
  while (found.velocity_error > tolerance) {
    const double middle = low + (high - low) / 2;
    if (middle == low || middle == high) break;
    const double error = rebound_velocity(middle, steps) - restitution;
    (error > 0 ? low : high) = middle;
    found.zeta_m = middle;
    found.velocity_error = std::abs(error);
  }
  return found;
}

double omega_m(const SceneDamper& damper) { return std::sqrt(damper.wall_stiffness / damper.mass_ratio); }

double nominal_contact_time(const SceneDamper& damper) {
  double omega = omega_m(damper);
  if (damper.wall.law !=
      WallForm::linear) {  // of a linear wall as stiff as this one where it is pressed in most
    const double speed = damper.wall.speed.value_or(1), nu = damper.mass_ratio;
    const ForceLaw wall = ForceLaw::of_wall(damper);
    const double overlap = wall.farthest(nu / (1 + nu) * speed * speed / 2);
    omega = std::sqrt(wall.force(overlap) / overlap / nu);
  }
  return std::numbers::pi / (omega * std::sqrt(1 + damper.mass_ratio));
}

}  // namespace impact_damper
