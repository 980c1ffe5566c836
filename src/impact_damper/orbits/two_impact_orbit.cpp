#include "impact_damper/orbits/two_impact_orbit.hpp"

#include <array>
#include <cmath>

#include "impact_damper/motion/system.hpp"

namespace impact_damper {
namespace {

// The coefficients of (M13.16) and (M13.17).
struct Coefficients {
  double nu, e, b, omega, half_period;
  Propagator<double> p;  // of the primary mass, over half a period
  double delta;          // 1 + C + S' + CS' + S^2
  double a, q;
  double h, angle_of_h;  // H = 1 - omega^2 + 2 i zeta omega

  explicit Coefficients(const System<double>& system)
      : nu(system.nu),
        e(system.e),
        b((1 - e) / (1 + e)),
        omega(system.forcing.frequency),
        half_period(half_turn<double>() / omega),
        p(system.free.propagate(half_period)),
        delta(1 + p.c + p.v + (p.c * p.v + p.s * p.s)),
        a(half_period + 4 * nu * p.s / delta),
        q((b - nu * (1 - b) + 2 * nu * (1 + p.c) / delta) / omega) {
    const double re = (1 - omega) * (1 + omega), im = 2 * system.zeta * omega;
    h = std::sqrt(re * re + im * im);
    angle_of_h = angle_of(im, re);
  }
};

// One of the two motions; its time counts from the departure from the left wall.
struct Motion {
  const Coefficients& c;
  double zeta, amplitude, speed;  // the linear response's, signed as f0 is; V
  double sin, cos;                // amplitude times those of its phase at the left wall
  double x0, v0;                  // just after the impact

  Motion(const Coefficients& all, double damping, double linear, double v)
      : c(all),
        zeta(damping),
        amplitude(linear),
        speed(v),
        sin((1 - c.a * v) / 2),
        cos(c.q * v),
        x0((1 - c.half_period * v) / 2),
        v0(v * (c.b - c.nu * (1 - c.b))) {}

  State<double> at(double t, const Oscillator<double>& free) const {
    const Propagator<double> p = free.propagate(t);
    const auto rotated = sin_cos(c.omega * t);
    const double u0 = x0 - sin, u1 = v0 - c.omega * cos;
    const double x = sin * rotated.cos + cos * rotated.sin + u0 * p.c + u1 * p.s;
    const double v = c.omega * (cos * rotated.cos - sin * rotated.sin) - u0 * p.s + u1 * p.v;
    return {x, v, x0 + speed * t - x, speed - v};
  }

  // The derivative of the map from one departure to the next, mirrored: of its time, x, x' and the absolute
  // velocity z' (M13.20).
  Matrix from_wall_to_wall() const {
    const double omega = c.omega, steady_v = omega * cos, steady_a = -omega * omega * sin;
    const double v = v0 + 2 * c.nu * speed;  // -x' just before the impact at the right wall
    const double force = steady_a + 2 * zeta * steady_v + sin;  // at the left wall, at the right minus that
    const double acceleration = 2 * zeta * v + x0 - force, w = speed + v;
    constexpr std::array<std::array<double, 4>, 4> units{
        {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    Matrix m(4, std::vector<double>(4));
    for (std::size_t j = 0; j < 4; ++j) {
      const auto& [dt, dx0, dv0, dz1] = units[j];
      const double du = dx0 - steady_v * dt, du1 = dv0 - steady_a * dt;
      const double x_then = c.p.c * du + c.p.s * du1 - steady_v * dt;
      const double v_then = -c.p.s * du + c.p.v * du1 - steady_a * dt;
      const double later = (x_then - dx0 - c.half_period * dz1) / w;
      const double dx = x_then - v * later, dv = v_then + acceleration * later, dw = dz1 - dv;
      const double after = dv + c.nu * (1 + c.e) / (1 + c.nu) * dw;
      m[0][j] = dt + later;
      m[1][j] = -dx;
      m[2][j] = -after;
      m[3][j] = -(after - c.e * dw);
    }
    return m;
  }
};

State<double> mirrored(const State<double>& s) { return {-s.x, -s.v, 1 - s.y, -s.w}; }

System<double> checked(const Scene& scene) {
  Scene forced = scene;
  if (!forced.until_time && !forced.until_amplitude) forced.until_time = 1;
  std::vector<Problem> problems = problems_of(forced);
  if (scene.force_amplitude == 0) problems.push_back({"force_amplitude", "must not be 0"});
  if (scene.force_frequency == 1 && scene.damping_ratio == 0)
    problems.push_back({"force_frequency", "must not be 1 without damping"});
  require_none(problems);
  return System<double>(scene);
}

}  // namespace

double least_linear_amplitude(const Scene& scene) {
  const Coefficients c(checked(scene));
  return c.q / std::sqrt(c.a * c.a + 4 * c.q * c.q);
}

std::vector<TwoImpactOrbit> two_impact_orbits(const Scene& scene) {
  const System<double> system = checked(scene);
  const Coefficients c(system);
  const double linear = system.forcing.amplitude / c.h;
  const double square = c.a * c.a + 4 * c.q * c.q;
  const double root = c.a * c.a - square * (1 - 4 * linear * linear);
  std::vector<TwoImpactOrbit> all;
  if (!(root >= 0)) return all;
  for (const double sign : {1.0, -1.0}) {
    const double speed = (c.a + sign * std::sqrt(root)) / square;
    if (!(speed > 0)) continue;
    const Motion motion(c, system.zeta, linear, speed);
    const double circle = 2 * half_turn<double>();
    double phase = angle_of(motion.sin / linear, motion.cos / linear) + c.angle_of_h;
    if (phase < 0) phase += circle;
    if (phase >= circle) phase -= circle;
    const double until_phase_0 = (circle - phase) / c.omega;
    TwoImpactOrbit orbit;
    orbit.speed = speed;
    orbit.phase = phase;
    orbit.impact_speed = speed * (1 + c.b) * (1 + c.nu);
    orbit.state = until_phase_0 < c.half_period
                      ? motion.at(until_phase_0, system.free)
                      : mirrored(motion.at(until_phase_0 - c.half_period, system.free));
    orbit.half_multipliers = multipliers_of(motion.from_wall_to_wall());
    all.push_back(orbit);
  }
  return all;
}

}  // namespace impact_damper
