// The paper's way without any library: equations (3)-(8) by central differences with a fixed step, the sign
// of the overlap at each step deciding which of them make the next one. A plain loop over x, y and their
// increments: from one step to the next that waits for fewer operations than x2 = 2 x1 - x0 - ..., and in
// flight it runs on by itself until something happens, more than twice as fast as with every question asked
// at every step. Peaks are read off the parabola through three steps.
#include <cmath>
#include <numbers>

#include "contender.hpp"
#include "rows.hpp"

namespace impact_damper::bench {
namespace {

Rows run(const Scene& scene, double h) {
  const double nu = scene.damper().mass_ratio, zeta = scene.damping_ratio,
               stiffness = scene.damper().wall_stiffness / nu;
  const double l = -std::log(scene.damper().restitution);
  const double zeta_m = scene.damper().restitution > 0 ? l / std::hypot(std::numbers::pi, l) : 1;
  const double half_damping = std::sqrt(stiffness) * zeta_m * h;  // c h / 2
  const double h2 = h * h, spring = h2 * stiffness, viscous = zeta * h;
  const double f0 = scene.force_amplitude, omega = scene.force_frequency;
  // In contact the new increments follow from
  //   (1 + viscous) dx - nu half_damping dy = r,      dx + (1 + half_damping) dy = s.
  const double inverse_determinant = 1 / ((1 + viscous) * (1 + half_damping) + nu * half_damping);
  // In flight x follows from x alone, and x + y by itself.
  const double kept = (1 - viscous) / (1 + viscous), pull = h2 / (1 + viscous), push = pull * f0;

  // The increments of the first step, by Taylor and in flight.
  double dx = h * scene.v0 - h2 / 2 * (scene.x0 + 2 * zeta * scene.v0);
  double dy = h * (scene.v0 + scene.damper().w0) - dx;
  double x = scene.x0 + dx, y = scene.damper().y0 + dy;
  const double end = scene.until_time ? *scene.until_time : 1e6;

  RowBook rows(scene.x0, scene.until_amplitude);
  bool in_contact = false;
  const long last = long(std::ceil(end / h));
  for (long step = 1; step < last;) {
    double x_before, dx_before;
    if (y >= 0 && y <= 1) {
      const double side = x > 0 ? 1 : -1, trend = dx > 0 ? 1 : -1;
      do {
        x_before = x;
        dx_before = dx;
        dx = kept * dx - pull * x;
        if (f0 != 0) dx += push * std::sin(omega * (double(step) * h));
        dy += dx_before - dx;
        x += dx;
        y += dy;
        ++step;
      } while ((y >= 0) & (y <= 1) & (side * x > 0) & (trend * dx > 0) & (step < last));
      in_contact = false;
    } else {
      if (!in_contact) rows.impact();
      in_contact = true;
      x_before = x;
      dx_before = dx;
      const double wall = y < 0 ? 0 : 1, force = spring * (y - wall) + half_damping * dy;
      double r = (1 - viscous) * dx - h2 * x + nu * force;
      if (f0 != 0) r += h2 * f0 * std::sin(omega * (double(step) * h));
      const double s = dx + dy - force;
      dx = (r * (1 + half_damping) + nu * half_damping * s) * inverse_determinant;
      dy = ((1 + viscous) * s - r) * inverse_determinant;
      x += dx;
      y += dy;
      ++step;
    }
    if ((dx_before > 0) != (dx > 0)) {
      const double slope = (dx_before + dx) / 2, bend = dx - dx_before;
      const double offset = bend != 0 ? -slope / bend : 0;
      rows.peak((double(step - 1) + offset) * h, x_before + offset * slope / 2);
    }
    if ((x_before > 0) != (x > 0) && rows.zero_crossing((double(step - 1) + x_before / (x_before - x)) * h)) {
      break;
    }
  }
  return rows.finish();
}

}  // namespace

std::vector<Contender> central_differences_peers() {
  return {{"central differences", Walls::compliant, "time step",
           [](const Scene& scene) {
             const double nu = scene.damper().mass_ratio;
             const double contact_time =
                 std::numbers::pi / std::sqrt(scene.damper().wall_stiffness / nu * (1 + nu));
             return geometric(contact_time / 2, 0.5, 14);
           },
           run, "the same scheme as cem, a plain loop without the library"}};
}

}  // namespace impact_damper::bench
