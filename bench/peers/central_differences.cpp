// The paper's way without any library: equations (3)-(8) by central differences with a fixed step, the sign
// of the overlap at each step deciding which of them make the next one. A plain loop over x and z = x + y,
// which is a straight line in flight; peaks are read off the parabola through three steps.
#include <cmath>
#include <numbers>

#include "peers/peers.hpp"
#include "peers/row_book.hpp"

namespace impact_damper::bench {
namespace {

Rows run(const Scene& scene, double h) {
  const double nu = scene.mass_ratio, zeta = scene.damping_ratio, stiffness = scene.wall_stiffness / nu;
  const double l = -std::log(scene.restitution);
  const double zeta_m = scene.restitution > 0 ? l / std::hypot(std::numbers::pi, l) : 1;
  const double half_damping = std::sqrt(stiffness) * zeta_m * h;  // c h / 2
  const double h2 = h * h, spring = h2 * stiffness, viscous = zeta * h;
  const double f0 = scene.force_amplitude, omega = scene.force_frequency;
  // In contact the new x and y follow from
  //   (1 + viscous) x - nu half_damping y = r,      x + (1 + half_damping) y = s.
  const double inverse_determinant = 1 / ((1 + viscous) * (1 + half_damping) + nu * half_damping);
  // In flight x follows from x alone.
  const double now = (2 - h2) / (1 + viscous), before = (1 - viscous) / (1 + viscous);
  const double force = h2 * f0 / (1 + viscous);

  // The first step by Taylor, in flight.
  const double a = -scene.x0 - 2 * zeta * scene.v0;
  double x0 = scene.x0, z0 = scene.x0 + scene.y0;
  double x1 = x0 + h * scene.v0 + h2 / 2 * a, z1 = z0 + h * (scene.v0 + scene.w0);
  const double end = scene.until_time ? *scene.until_time : 1e6;

  RowBook rows(scene.x0, scene.until_amplitude);
  bool in_contact = false;
  double d1 = x1 - x0;
  const long last = long(std::ceil(end / h));
  for (long step = 1; step < last; ++step) {
    double x2 = now * x1 - before * x0;
    if (f0 != 0) x2 += force * std::sin(omega * (double(step) * h));
    double z2 = 2 * z1 - z0;
    const double y1 = z1 - x1;
    if (y1 >= 0 && y1 <= 1) {
      in_contact = false;
    } else {
      const double wall = y1 < 0 ? 0 : 1;
      const double push = spring * (y1 - wall) - half_damping * (z0 - x0);
      const double r = (1 + viscous) * x2 + nu * push, s = z2 - push;
      x2 = (r * (1 + half_damping) + nu * half_damping * s) * inverse_determinant;
      z2 = x2 + ((1 + viscous) * s - r) * inverse_determinant;
      if (!in_contact) rows.impact();
      in_contact = true;
    }
    const double d2 = x2 - x1;
    if ((d1 > 0) != (d2 > 0)) {
      const double slope = (x2 - x0) / 2, bend = d2 - d1;
      const double offset = bend != 0 ? -slope / bend : 0;
      rows.peak((double(step) + offset) * h, x1 + offset * slope / 2);
    }
    if ((x1 > 0) != (x2 > 0) && rows.zero_crossing((double(step) + x1 / (x1 - x2)) * h)) break;
    x0 = x1;
    x1 = x2;
    z0 = z1;
    z1 = z2;
    d1 = d2;
  }
  return rows.finish();
}

}  // namespace

std::vector<Contender> central_differences_peers() {
  return {{"central differences", Walls::compliant, "time step",
           [](const Scene& scene) {
             const double nu = scene.mass_ratio;
             const double contact_time = std::numbers::pi / std::sqrt(scene.wall_stiffness / nu * (1 + nu));
             return geometric(contact_time / 2, 0.5, 14);
           },
           run, "the same scheme as cem, a plain loop without the library"}};
}

}  // namespace impact_damper::bench
