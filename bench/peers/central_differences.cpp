// The paper's way without any library: equations (3)-(8) by central differences with a fixed step, the sign
// of the overlap at each step deciding which of them make the next one. A plain loop; peaks are read off the
// parabola through three steps.
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
  const double determinant = (1 + viscous) * (1 + half_damping) + nu * half_damping;

  // The first step by Taylor, in flight.
  const double a = -scene.x0 - 2 * zeta * scene.v0;
  double x0 = scene.x0, y0 = scene.y0;
  double x1 = x0 + h * scene.v0 + h2 / 2 * a, y1 = y0 + h * scene.w0 - h2 / 2 * a;
  const double end = scene.until_time ? *scene.until_time : 1e6;

  RowBook rows(scene.x0, scene.until_amplitude);
  bool in_contact = y1 < 0 || y1 > 1;
  for (long step = 1; double(step) * h < end; ++step) {
    const double f = f0 == 0 ? 0 : h2 * f0 * std::sin(omega * (double(step) * h));
    const double free_x = 2 * x1 - x0 + viscous * x0 - h2 * x1 + f, z = 2 * (x1 + y1) - (x0 + y0);
    double x2, y2;
    if (y1 >= 0 && y1 <= 1) {
      x2 = free_x / (1 + viscous);
      y2 = z - x2;
      in_contact = false;
    } else {
      const double wall = y1 < 0 ? 0 : 1;
      const double push = spring * (y1 - wall) - half_damping * y0;
      const double r = free_x + nu * push, s = z - push;
      x2 = (r * (1 + half_damping) + nu * half_damping * s) / determinant;
      y2 = ((1 + viscous) * s - r) / determinant;
      if (!in_contact) rows.impact();
      in_contact = true;
    }
    if ((x1 - x0) * (x2 - x1) <= 0) {
      const double slope = (x2 - x0) / 2, bend = x2 - 2 * x1 + x0;
      const double offset = bend != 0 ? -slope / bend : 0;
      rows.peak((double(step) + offset) * h, x1 + offset * slope / 2);
    }
    if ((x1 > 0) != (x2 > 0) && rows.zero_crossing((double(step) + x1 / (x1 - x2)) * h)) break;
    x0 = x1;
    x1 = x2;
    y0 = y1;
    y1 = y2;
  }
  return rows.finish();
}

}  // namespace

std::vector<Contender> central_differences_peers() {
  return {{"central differences", Walls::compliant, "time step",
           [](const Scene& scene) {
             const double nu = scene.mass_ratio;
             const double contact_time =
                 std::numbers::pi / std::sqrt(scene.wall_stiffness / nu * (1 + nu));
             return geometric(contact_time / 2, 0.5, 14);
           },
           run}};
}

}  // namespace impact_damper::bench
