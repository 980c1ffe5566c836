#include <doctest/doctest.h>

#include <cmath>

#include "impact_damper/motion/contact_work.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/wall.hpp"
#include "reference.hpp"

using namespace impact_damper;

TEST_CASE("a flight that dies away loses all its energy to its damper, in however long a time") {
  for (double zeta : {1e-3, 0.5, 0.9, 1.0, 1.1, 30.0, 1e6}) {
    Scene scene;
    scene.damping_ratio = zeta;
    const System<double> system(scene);
    for (double v : {0.0, -3.0}) {
      const Flight<double> flight(system, 0, {2, v, 0.5, 0});
      // The slower rate is never below 1/(2 zeta): exp(-80) is left.
      const double duration = 40 * (2 * zeta + 1 / zeta);
      Search<double> search{1};
      const Work<double> works = work_of(system, flight, 0.0, duration, 0.0, search);
      CAPTURE(zeta);
      CAPTURE(v);
      CHECK(std::abs(works.viscous / ((4 + v * v) / 2) - 1) < 2e-13);  // a sum of up to 2e5 terms
    }
  }
}

namespace {

struct LongContact {
  Scene scene;
  double duration;
};

// Contacts that ring through hundreds to thousands of swings, however pressed the masses are.
LongContact random_contact(reference::Random& random) {
  LongContact contact;
  Scene& scene = contact.scene;
  scene.damper().mass_ratio = random.log_uniform(1e-3, 10);
  scene.damper().restitution = random.chance(0.3) ? 1 : random.uniform(0.1, 1);
  scene.damper().wall_stiffness = random.log_uniform(1e3, 1e5);
  scene.damping_ratio = random.chance(0.3) ? 0 : random.log_uniform(1e-3, 3);
  if (random.chance(0.6)) {
    scene.force_amplitude = random.log_uniform(1e-2, 10);
    scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.1, 4);
  }
  contact.duration = random.uniform(5, 20);
  return contact;
}

}  // namespace

TEST_CASE("a long contact's works are those of a quadrature that follows all its ringing") {
  reference::Random random(31);
  for (int n = 0; n < 200; ++n) {
    const LongContact drawn = random_contact(random);
    const Scene& scene = drawn.scene;
    const double duration = drawn.duration;
    const System<double> system(scene);
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const double begin = random.uniform(0, 10), root_k = std::sqrt(walls.stiffness);
    const Contact<double> contact(
        walls, begin, {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2) / root_k, -1.5},
        Wall::left);
    const double wall_damping = system.nu * walls.damping;
    Search<double> search{1};
    const Work<double> found = work_of(system, contact, begin, duration, wall_damping, search);
    const Work<double> expected =
        work_of<Contact<double>>(system, contact, begin, duration, wall_damping, search);
    CAPTURE(n);
    CAPTURE(scene.damper().mass_ratio);
    CAPTURE(scene.damper().restitution);
    CAPTURE(scene.damper().wall_stiffness);
    CAPTURE(scene.damping_ratio);
    CAPTURE(scene.force_amplitude);
    CAPTURE(scene.force_frequency);
    // Energies are of order one; a swing's phase is rounded by epsilon times its number of radians.
    const double radians = walls.fast.rate() * duration;
    const double allowed = 1e-15 * (16 + radians) * (1 + expected.turnover);
    CHECK(std::abs(found.viscous - expected.viscous) < allowed);
    CHECK(std::abs(found.wall - expected.wall) < allowed);
    CHECK(std::abs(found.forcing - expected.forcing) < allowed);
  }
}
