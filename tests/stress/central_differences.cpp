// Central differences: growth per step on both sides of the stability limit, and the restitution that a step
// delivers.
//
// Growth. For one mode u'' + 2 z omega u' + omega^2 u = 0, stepped with h, g = h omega:
//     centred  (1 + g z) s^2 - (2 - g^2) s + (1 - g z) = 0            stable up to g = 2
//     lagged   s^2 - (2 - g^2 - 2 g z) s + (1 - 2 g z) = 0            stable up to g = 2 (sqrt(1 + z^2) - z)
// and the growth is the larger |s|. In flight omega = 1 and z = zeta, always centred. In contact, between
// masses that nothing else holds, omega = sqrt(k (1 + nu) / nu) and z = zeta_m sqrt(1 + nu); a primary spring
// of 1 against k = 1e8 and more moves that by nu/k.
//
// It is measured on the motion that the engine gives, sample by sample, without looking at the scheme: the
// mode is what obeys u_{n+1} = a u_n + b u_{n-1}, a and b by least squares with every row scaled to one. In
// contact the mode rides on the slow motion that presses the masses together; fourth differences remove that.
//
// Restitution. One impact on a primary mass at rest, two-body calibration, exactly e between free masses; the
// largest error over 16 places of touch within a step, and the order fitted to it.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "impact_damper/engines/cem.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"
#include "stress.hpp"

namespace stress {

using namespace impact_damper;

namespace {

Watch every_step(double h) {
  Watch watch;
  watch.sample_at = 0;
  watch.every = h;
  return watch;
}

std::vector<double> column(const Watch& watch, double Sample::*member) {
  std::vector<double> values;
  for (const Sample& sample : watch.samples) values.push_back(sample.*member);
  return values;
}

std::vector<double> differences(std::vector<double> u, int times) {
  for (; times > 0; --times) {
    for (std::size_t i = 0; i + 1 < u.size(); ++i) u[i] = u[i + 1] - u[i];
    u.pop_back();
  }
  return u;
}

double larger_root(double a, double b) {  // of s^2 = a s + b
  const std::complex<double> root = std::sqrt(std::complex<double>(a * a / 4 + b));
  return std::max(std::abs(a / 2 + root), std::abs(a / 2 - root));
}

double measured_growth(const std::vector<double>& u) {
  long double aa = 0, ab = 0, bb = 0, ca = 0, cb = 0;
  for (std::size_t n = 1; n + 1 < u.size(); ++n) {
    const long double size = std::hypot(u[n - 1], u[n], u[n + 1]);
    if (!(size > 0)) continue;
    const long double before = u[n - 1] / size, now = u[n] / size, next = u[n + 1] / size;
    aa += now * now;
    ab += now * before;
    bb += before * before;
    ca += next * now;
    cb += next * before;
  }
  const long double determinant = aa * bb - ab * ab;
  // A single real mode: any a and b with s^2 = a s + b would do.
  if (!(determinant > 1e-9L * aa * bb)) return double(std::abs(ca / aa));
  return larger_root(double((ca * bb - cb * ab) / determinant), double((cb * aa - ca * ab) / determinant));
}

double closed_form_limit(Damper damper, double z) {
  return damper == Damper::centred ? 2 : 2 * (std::sqrt(1 + z * z) - z);
}

double closed_form_growth(Damper damper, double z, double g) {
  if (damper == Damper::centred) return larger_root((2 - g * g) / (1 + g * z), -(1 - g * z) / (1 + g * z));
  return larger_root(2 - g * g - 2 * g * z, -(1 - 2 * g * z));
}

// Few enough steps for the mode to stay above rounding, and below what it rides on.
int steps_for(double growth) {
  const double nepers = std::abs(std::log(growth));
  return std::clamp(nepers > 0 ? int(16 / nepers) : 2000, 12, 2000);
}

struct Growth {
  double measured = 0, closed_form = 0;
};

Growth growth_in_flight(Damper damper, double zeta, double by_limit) {
  Scene scene{.damping_ratio = zeta, .x0 = 1e-9, .dampers = {{.y0 = 0.5}}};
  Cem cem{.damper = damper, .unstable = true};
  cem.time_step = 2 * by_limit;
  const double closed_form = closed_form_growth(Damper::centred, zeta, 2 * by_limit);
  scene.until_time = *cem.time_step * (steps_for(closed_form) + 0.5);
  Watch watch = every_step(*cem.time_step);
  observed(scene, cem, watch);
  return {watch.impacts == 0 ? measured_growth(column(watch, &Sample::x)) : std::nan(""), closed_form};
}

Growth growth_in_contact(Damper damper, double e, double by_limit, double& limit_error) {
  Scene scene{.dampers = {{.restitution = e, .wall_stiffness = 1e10}}};
  const double nu = scene.damper().mass_ratio, k = scene.damper().wall_stiffness;
  const double omega = std::sqrt(k * (1 + nu) / nu), z = zeta_m_closed_form(e) * std::sqrt(1 + nu);
  const double limit = closed_form_limit(damper, z);
  limit_error = stability_limit(scene, damper, Calibration::fixed_wall) * omega / limit - 1;
  // The stuck pair at its turning point, x'' = -x / (1 + nu), pressed nu x / ((1 + nu) k) into the left wall;
  // and a little less than that.
  scene.x0 = -6;
  const double pressed = nu * scene.x0 / ((1 + nu) * k);
  Cem cem{.damper = damper, .unstable = true};
  cem.time_step = by_limit * limit / omega;
  const double closed_form = closed_form_growth(damper, z, by_limit * limit);
  scene.damper().y0 = pressed * (1 + (closed_form > 1 ? 1e-9 : 1e-2));
  scene.until_time = *cem.time_step * (steps_for(closed_form) + 0.5);
  Watch watch = every_step(*cem.time_step);
  observed(scene, cem, watch);
  const std::vector<double> y = column(watch, &Sample::y);
  if (!(*std::max_element(y.begin(), y.end()) < 0)) return {std::nan(""), closed_form};
  return {measured_growth(differences(y, 4)), closed_form};
}

std::vector<Check> growth_checks(const Options& options) {
  const std::array<double, 6> by_limit{0.5, 0.9, 0.99, 1.001, 1.01, 1.1};
  std::string table = "# Growth per step of central differences, by step over its limit.\n";
  std::vector<Check> checks;
  const auto block = [&](const std::string& name, const std::string& what, const auto& closed_form,
                         const auto& growth_at) {
    Check check{.subject = "central-differences", .what = what, .measured = {}, .allowed = {}};
    table += "\n\n# " + name + "\nstep measured closed_form\n";
    Worst worst;
    for (const double f : by_limit) {
      const Growth growth = growth_at(f);
      // Three digits of what a step adds or takes, where that is not nothing.
      const double ours = std::log(growth.measured), theirs = std::log(growth.closed_form);
      const double error = std::abs(ours - theirs) / std::max(std::abs(theirs), 1e-3);
      worst.take(error);
      ++check.cases;
      if (!(error < 1e-3) || (growth.measured > 1 + 1e-6) != (f > 1))
        check.miss("step " + rounded(f, 4) + " of the limit: growth " + full(growth.measured) +
                   ", closed form " + full(growth.closed_form));
      table += rounded(f, 6) + " " + full(growth.measured) + " " + full(growth.closed_form) + "\n";
    }
    table += "\n\n# " + name + "-closed\nstep closed_form\n";
    for (int i = 0; i <= 260; ++i) {
      const double f = 0.46 + 0.0025 * i;
      table += rounded(f, 6) + " " + rounded(closed_form(f), 6) + "\n";
    }
    check.measured = rounded(worst);
    check.allowed = "1e-3";
    checks.push_back(check);
  };
  for (const Damper damper : {Damper::centred, Damper::lagged}) {
    const std::string name(name_of(damper));
    for (const double zeta : {0.0, 0.05})
      block(
          name + "-flight-" + rounded(zeta),
          name + ", in flight, zeta = " + rounded(zeta) +
              ": growth per step, relative error of its logarithm",
          [&](double f) { return closed_form_growth(Damper::centred, zeta, 2 * f); },
          [&](double f) { return growth_in_flight(damper, zeta, f); });
    for (const double e : {1.0, 0.6, 0.1}) {
      Worst limit_error;
      const double z = zeta_m_closed_form(e) * std::sqrt(1 + SceneDamper{}.mass_ratio);
      block(
          name + "-contact-" + rounded(e),
          name + ", in contact, e = " + rounded(e) + ": growth per step, relative error of its logarithm",
          [&](double f) { return closed_form_growth(damper, z, f * closed_form_limit(damper, z)); },
          [&](double f) {
            double error = 0;
            const Growth growth = growth_in_contact(damper, e, f, error);
            limit_error.take(std::abs(error));
            return growth;
          });
      Check check{.subject = "central-differences",
                  .what = name + ", in contact, e = " + rounded(e) + ": the stated limit, relative error",
                  .measured = rounded(limit_error),
                  .allowed = "1e-9",  // the primary spring beside k
                  .cases = 1};
      if (!(limit_error < 1e-9)) check.miss("stability_limit is off by " + rounded(limit_error));
      checks.push_back(check);
    }
  }
  write_file(options.folder / "growth.dat", table);
  return checks;
}

struct Scheme {
  const char* name;
  Damper damper;
  bool locate;
  double order, tolerance;  // of the fitted order
};
constexpr std::array<Scheme, 4> schemes{{{"centred", Damper::centred, false, 1, 0.1},
                                         {"lagged", Damper::lagged, false, 1, 0.1},
                                         {"centred, located", Damper::centred, true, 2, 0.1},
                                         {"lagged, located", Damper::lagged, true, 1, 0.1}}};

double delivered_restitution(Scene scene, Cem cem, double part_of_step) {
  const double tau = nominal_contact_time(scene.damper());
  scene.x0 = 0;
  scene.damper().w0 = -1;
  // Touch after 3 steps and a part of one.
  scene.damper().y0 = (3 + part_of_step) * *cem.time_step;
  scene.until_time = scene.damper().y0 + 3 * tau;
  const Run run = simulate(scene, cem, {.half_cycles = false, .history = {{0, *scene.until_time, 2}}});
  return run.history->dampers[0].w.back();
}

std::vector<Check> restitution_checks(const Options& options) {
  const Scene scene{.dampers = {{.wall_stiffness = 1e10}}};
  std::string table = "# Error of the delivered restitution, e = 0.6, by steps per contact.\n";
  std::vector<Check> checks;
  for (const Scheme& scheme : schemes) {
    std::string name = scheme.name;
    std::erase(name, ',');
    std::replace(name.begin(), name.end(), ' ', '-');
    table += "\n\n# " + name + "\nsteps error\n";
    double sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0, last = 0;
    int points = 0;
    for (int steps = 16; steps <= 4096; steps *= 2) {
      Cem cem{.damper = scheme.damper, .locate = scheme.locate, .calibration = Calibration::two_body};
      cem.time_step = nominal_contact_time(scene.damper()) / steps;
      Worst error;
      for (int part = 0; part < 16; ++part)
        error.take(
            std::abs(delivered_restitution(scene, cem, (part + 0.37) / 16) - scene.damper().restitution));
      table += std::to_string(steps) + " " + rounded(error, 6) + "\n";
      last = error;
      if (steps < 64) continue;  // where the order is not yet the leading one's
      const double x = std::log(double(steps)), y = std::log(error.value());
      sum_x += x, sum_y += y, sum_xx += x * x, sum_xy += x * y, ++points;
    }
    const double order = -(points * sum_xy - sum_x * sum_y) / (points * sum_xx - sum_x * sum_x);
    Check check{.subject = "central-differences",
                .what = std::string(scheme.name) + ": order of the delivered restitution's error in the step",
                .measured = rounded(order, 3),
                .allowed = rounded(scheme.order) + " +- " + rounded(scheme.tolerance),
                .cases = points};
    if (!(std::abs(order - scheme.order) <= scheme.tolerance))
      check.miss("order " + rounded(order, 4) + ", error " + rounded(last) + " with the smallest step");
    checks.push_back(check);
  }
  write_file(options.folder / "delivered.dat", table);
  return checks;
}

}  // namespace

std::vector<Check> central_differences(const Options& options) {
  std::vector<Check> checks = growth_checks(options);
  for (const Check& check : restitution_checks(options)) checks.push_back(check);
  return checks;
}

}  // namespace stress
