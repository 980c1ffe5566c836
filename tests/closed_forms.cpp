#include "closed_forms.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {
namespace {

constexpr double pi = std::numbers::pi;

struct Parameters {
  double nu, e, omega, c;  // c = f0 / (1 - omega^2)
};

// A departure from the left wall: primary displacement and velocity, phase of the force, absolute speed.
using Departure = Eigen::Vector4d;

// From one departure to the next, which is from the right wall and mirrored back to the left.
// `flight_time` is a guess close enough for Newton.
Departure next_departure(const Parameters& p, const Departure& from, double flight_time) {
  const double x0 = from[0], v0 = from[1], phase = from[2], u = from[3];
  const auto departing = sin_cos(phase);
  const double p0 = x0 - p.c * departing.sin, q0 = v0 - p.c * p.omega * departing.cos;
  double t = flight_time, x = 0, v = 0;
  for (int i = 0; i < 8; ++i) {
    const auto forced = sin_cos(p.omega * t + phase), free = sin_cos(t);
    x = p.c * forced.sin + p0 * free.cos + q0 * free.sin;
    v = p.c * p.omega * forced.cos - p0 * free.sin + q0 * free.cos;
    t -= (x0 + u * t - x - 1) / (u - v);
  }
  const ImpactOutcome after = impact(p.nu, p.e, v, u - v);
  return {-x, -after.v, phase + p.omega * t - pi, -(after.v + after.w)};
}

double largest_multiplier(const Parameters& p, const Departure& fixed, double flight_time) {
  constexpr double step = 1e-5;  // central differences: error 1e-10 from truncation, 1e-11 from rounding
  Eigen::Matrix4d jacobian;
  for (int i = 0; i < 4; ++i) {
    const Departure d = step * Departure::Unit(i);
    jacobian.col(i) =
        (next_departure(p, fixed + d, flight_time) - next_departure(p, fixed - d, flight_time)) / (2 * step);
  }
  return std::sqrt(jacobian.eigenvalues().cwiseAbs2().maxCoeff());
}

}  // namespace

ImpactOutcome impact(double mass_ratio, double restitution, double v, double w) {
  const double nu = mass_ratio, e = restitution;
  return {v + nu * (1 + e) * w / (1 + nu), -e * w, nu * (1 - e * e) * w * w / (2 * (1 + nu))};
}

double restitution_by_displacement(double z) { return exponential(-pi * z / std::sqrt((1 - z) * (1 + z))); }

double restitution_by_force(double z) {
  const double omega = std::sqrt((1 - z) * (1 + z));
  return exponential(-2 * z * angle_of(omega, z) / omega);
}

double delivered_restitution(double restitution, double mass_ratio) {
  return restitution_by_displacement(zeta_m_closed_form(restitution) * std::sqrt(1 + mass_ratio));
}

double delivered_restitution_without_pull(double restitution, double mass_ratio) {
  return restitution_by_force(zeta_m_closed_form(restitution) * std::sqrt(1 + mass_ratio));
}

double stable_step_centred() { return 2; }

double stable_step_lagged(double z) { return 2 * (std::sqrt(1 + z * z) - z); }

std::vector<ForcedTwoImpact> forced_two_impact(double mass_ratio, double restitution, double force_amplitude,
                                               double force_frequency) {
  const double nu = mass_ratio, omega = force_frequency;
  const double period_half = pi / omega;
  const auto [sine, cosine] = sin_cos(period_half / 2);
  const double c = force_amplitude / ((1 - omega) * (1 + omega));
  if (!std::isfinite(c) || c == 0 || std::abs(cosine) < 1e-12) return {};
  const double a = period_half + 2 * nu * sine / cosine;
  const double q = asymmetry(restitution) * (1 + nu) / omega;
  const double denominator = a * a + 4 * q * q;
  const double discriminant = a * a - denominator * (1 - 4 * c * c);
  if (!(discriminant >= 0)) return {};

  std::vector<ForcedTwoImpact> found;
  for (double sign : {1.0, -1.0}) {
    ForcedTwoImpact motion;
    const double speed = (a + sign * std::sqrt(discriminant)) / denominator;
    if (!(speed > 0)) continue;
    motion.speed = speed;
    motion.tau = angle_of((1 - a * speed) / (2 * c), q * speed / c);

    const double free = -nu * speed / cosine;
    const auto x = [&](double t) {
      return c * sin_cos(omega * t + motion.tau).sin + free * sin_cos(t - period_half / 2).sin;
    };
    const auto v = [&](double t) {
      return c * omega * sin_cos(omega * t + motion.tau).cos + free * sin_cos(t - period_half / 2).cos;
    };
    const auto y = [&](double t) { return x(0) + speed * t - x(t); };

    const int samples = static_cast<int>(4096 * (1 + 1 / omega));
    motion.within_walls = speed - v(0) > 0;
    for (int i = 1; i < samples && motion.within_walls; ++i) {
      const double at = y(period_half * i / samples);
      motion.within_walls = at > 0 && at < 1;
    }
    motion.largest_multiplier =
        largest_multiplier({nu, restitution, omega, c}, {x(0), v(0), motion.tau, speed}, period_half);

    // The scene's time 0 has force phase 0: -tau/omega after the departure, in the flight to the right wall
    // or, half a period later, in its mirror image.
    double t = -motion.tau / omega;
    if (t < 0) t += 2 * period_half;
    const bool mirrored = t >= period_half;
    if (mirrored) t -= period_half;
    motion.x0 = mirrored ? -x(t) : x(t);
    motion.v0 = mirrored ? -v(t) : v(t);
    motion.y0 = mirrored ? 1 - y(t) : y(t);
    motion.w0 = mirrored ? v(t) - speed : speed - v(t);
    found.push_back(motion);
  }
  return found;
}

}  // namespace impact_damper
