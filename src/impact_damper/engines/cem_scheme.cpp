#include "impact_damper/engines/cem_scheme.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper {

namespace {
double hypotenuse(double a, double b) {
  const double larger = std::max(std::fabs(a), std::fabs(b)), smaller = std::min(std::fabs(a), std::fabs(b));
  if (!(larger > 0 && larger < INFINITY)) return larger;
  return larger * std::sqrt(1 + smaller / larger * (smaller / larger));
}

// Returns the largest h in (0, most) for which `semidefinite` holds; it must hold up to one limit and not
// beyond.
template <class Semidefinite>
double last_of(double most, Semidefinite&& semidefinite) {
  double stable = 0, unstable = most;
  if (semidefinite(unstable)) return unstable;
  for (;;) {
    const double middle = stable + (unstable - stable) / 2;
    if (!(middle > stable && middle < unstable)) return stable;
    (semidefinite(middle) ? stable : unstable) = middle;
  }
}

// (M17.11)
double stability_limit_of_list(const Scene& scene, Damper damper, Calibration calibration) {
  std::vector<RegimeEquations<double>> walls;
  for (const SceneDamper& each : scene.dampers)
    walls.push_back(regime_equations<double>(scene, each, calibration, Regime::contact));
  return last_of(2, [&](double h) {
    double all = 0;
    for (const auto& [nu, zeta, c, omega_2] : walls) {
      const double b = h * ((damper == Damper::lagged ? 2 * c : 0) + h * omega_2);
      if (!(b < 4)) return false;
      all += 4 * nu * b / (4 - b);
    }
    return all <= 4 - h * h;
  });
}
}  // namespace

double fastest_contact_frequency(const Scene& scene) {
  if (scene.dampers.size() > 1) return 2 / stability_limit_of_list(scene, Damper::centred, {});
  const double nu = scene.damper().mass_ratio, k_by_nu = scene.damper().wall_stiffness / nu;
  // (1 + K (1 + nu))^2 - 4 K as a sum of squares: no cancellation for heavy or light secondary masses.
  const double difference = hypotenuse(1 - k_by_nu * (1 - nu), 2 * k_by_nu * std::sqrt(nu));
  return std::sqrt((1 + k_by_nu * (1 + nu) + difference) / 2);
}

double stability_limit(const Scene& scene, Damper damper, Calibration calibration) {
  if (scene.dampers.size() > 1) return stability_limit_of_list(scene, damper, calibration);
  const double centred = 2 / fastest_contact_frequency(scene);
  if (damper == Damper::centred) return centred;

  // 4 M - 2 h C'' - h^2 K in absolute coordinates, the row and the column of z divided by sqrt(nu).
  const double nu = scene.damper().mass_ratio, k = scene.damper().wall_stiffness;
  const double c = 2 * omega_m(scene.damper()) * zeta_m(scene.damper(), calibration);
  const auto semidefinite = [&](double h) {
    const double wall = h * (2 * c + h * k / nu);  // damper and spring of the wall, by nu
    const double primary = 4 - h * h - nu * wall, secondary = 4 - wall;
    return primary >= 0 && secondary >= 0 && primary * secondary >= nu * wall * wall;
  };
  return last_of(centred, semidefinite);
}

std::int64_t whole_steps(double steps) {
  constexpr double many = 1e15;
  return steps < 1 ? 1 : steps < many ? std::int64_t(std::ceil(steps)) : std::int64_t(many);
}

void fail_of_overflow(double time, double step) {
  throw NumericalError("the component element method overflowed near time " + rounded_text(time, 6) +
                       " with time_step " + number_text(step));
}

}  // namespace impact_damper
