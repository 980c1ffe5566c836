#include "impact_damper/engines/cem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/motion/force_law.hpp"

namespace impact_damper {
namespace {

std::string rounded(double value) { return rounded_text(value, 6); }
// Rounded to at most `value`, so that whoever types it in is not rejected.
std::string rounded_down(double value) { return rounded(value * (1 - 5e-6)); }

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

// Returns a bound on the energy of the scene's motion if it is free (M18.17), which a force may exceed.
double energy_bound(const Scene& scene) {
  double energy = scene.v0 * scene.v0 / 2 + ForceLaw::of_spring(scene.spring).energy(scene.x0), masses = 0;
  for (const SceneDamper& each : scene.dampers) {
    const double z1 = scene.v0 + each.w0, overlap = each.y0 - std::clamp(each.y0, 0.0, each.clearance);
    energy += each.mass_ratio * (z1 * z1 / 2 + scene.weight * std::max(0.0, scene.x0 + each.y0)) +
              ForceLaw::of_wall(each).energy(overlap);
    masses += each.mass_ratio * scene.weight;
  }
  return energy + masses * masses / 2;
}

// (M17.11), where walls and the primary spring have other laws for the steepest slopes that they can have
// (M18.18).
double stability_limit_of_list(const Scene& scene, Damper damper, Calibration calibration) {
  const bool laws = has_laws(scene);
  const double energy = laws ? energy_bound(scene) : 0;
  std::vector<RegimeEquations<double>> walls;
  for (const SceneDamper& each : scene.dampers) {
    walls.push_back(regime_equations<double>(scene, each, calibration, Regime::contact));
    if (each.wall.law == WallForm::linear) continue;
    const ForceLaw wall = ForceLaw::of_wall(each);
    const double nu = each.mass_ratio, speed = each.wall.speed.value_or(1);
    const double most = std::max(energy, nu * speed * speed / 2);
    walls.back().omega_2 = wall.steepest(most) / nu;
    walls.back().c = loss_factor_of(each) * wall.force(wall.farthest(most)) / nu;
  }
  const double spring = laws ? ForceLaw::of_spring(scene.spring).steepest(energy) : 1;
  return last_of(2 / std::sqrt(spring), [&](double h) {
    double all = 0;
    for (const auto& [nu, zeta, c, omega_2] : walls) {
      const double b = h * ((damper == Damper::lagged ? 2 * c : 0) + h * omega_2);
      if (!(b < 4)) return false;
      all += 4 * nu * b / (4 - b);
    }
    return all <= 4 - h * h * spring;
  });
}

}  // namespace

double fastest_contact_frequency(const Scene& scene) {
  if (scene.dampers.size() > 1 || has_laws(scene))
    return 2 / stability_limit_of_list(scene, Damper::centred, {});
  const double nu = scene.damper().mass_ratio, k_by_nu = scene.damper().wall_stiffness / nu;
  // (1 + K (1 + nu))^2 - 4 K as a sum of squares: no cancellation for heavy or light secondary masses.
  const double difference = hypotenuse(1 - k_by_nu * (1 - nu), 2 * k_by_nu * std::sqrt(nu));
  return std::sqrt((1 + k_by_nu * (1 + nu) + difference) / 2);
}

double stability_limit(const Scene& scene, Damper damper, Calibration calibration) {
  if (scene.dampers.size() > 1 || has_laws(scene)) return stability_limit_of_list(scene, damper, calibration);
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

void fail_of_slope(double time, double step) {
  throw NumericalError("the component element method met a force at time " + rounded_text(time, 6) +
                       " that rises so steeply that time_step " + number_text(step) +
                       " is beyond the stability limit: take a smaller step, or run it all the same with "
                       "--unstable");
}

void fail_of_overflow(double time, double step) {
  throw NumericalError("the component element method overflowed near time " + rounded_text(time, 6) +
                       " with time_step " + number_text(step));
}

Cem resolved(const Scene& scene, Cem options) {
  if (!options.time_step) {
    double half_period = std::numbers::pi;
    if (!scene.spring.is_linear())
      half_period /= std::sqrt(ForceLaw::of_spring(scene.spring).steepest(energy_bound(scene)));
    for (const SceneDamper& damper : scene.dampers)
      half_period = std::min(half_period, nominal_contact_time(damper));
    if (scene.force_amplitude != 0)
      half_period = std::min(half_period, std::numbers::pi / scene.force_frequency);
    options.time_step = half_period / 100;
  }
  return options;
}

std::vector<Problem> problems_of(const Scene& scene, const Cem& options) {
  std::vector<Problem> problems = problems_of(options);
  if (!problems.empty()) return problems;
  const double h = options.time_step.value();
  const double limit = stability_limit(scene, options.damper, options.calibration);
  if (!(h <= limit || options.unstable)) {
    problems.push_back(
        {"time_step",
         "must be <= " + rounded_down(limit) + ", got " + number_text(h) +
             ": beyond this stability limit the fastest mode in contact grows (angular frequency " +
             rounded(fastest_contact_frequency(scene)) + ", " + std::string(name_of(options.damper)) +
             " damper); take a smaller step, or run it all the same with --unstable"});
  }
  if (options.large_step) {
    const double large = *options.large_step;
    const double half_period = scene.force_amplitude != 0 ? std::numbers::pi / scene.force_frequency : 2;
    if (!(large > h && large < 2)) {
      problems.push_back({"large_step", "must be > " + rounded(h) +
                                            ", the time step, and < 2, the stability limit in flight, got " +
                                            number_text(large)});
    } else if (!(large <= half_period)) {
      problems.push_back({"large_step", "must be <= " + rounded_down(half_period) +
                                            ", half a period of the forcing, got " + number_text(large)});
    }
  }
  for (const auto& [name, option] :
       {std::pair("large_step", &Cem::large_step), {"stuck_speed", &Cem::stuck_speed}})
    if (!is_ideal(scene) && options.*option)
      problems.push_back({name, has_components(scene)
                                    ? "must be absent beside friction, weight and drag"
                                    : "must be absent beside walls and springs with laws of their own"});
  return problems;
}

}  // namespace impact_damper
