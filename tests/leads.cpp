// Which way a mass at rest on a wall goes where x'' and x''' vanish (docs/mathematics.md, 7.3).
#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "impact_damper/motion/lead.hpp"
#include "impact_damper/simulate.hpp"
#include "list_of_one.hpp"
#include "reference.hpp"

using namespace impact_damper;

namespace {

using Walls = std::vector<PushedWall<double>>;

Lead<double> lead_at(const Forcing<double>& force, const SinCos<double>& phase, double zeta, double x,
                     double v, const Walls& walls = {}) {
  return lead_of_x<double>(2 * zeta, 1.0, force, phase, x, v, walls);
}

Run run_of(const Scene& scene, const Engine& engine) {
  return simulate(scene, engine, {.half_cycles = true, .impacts = true, .contacts = true, .energy = true});
}

}  // namespace

TEST_CASE("the first derivative of x that is not zero to rounding leads") {
  reference::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Forcing<double> force{random.log_uniform(1e-6, 1e6) * random.sign(), random.log_uniform(1e-6, 1e3)};
    const double zeta = random.log_uniform(1e-3, 1e3), angle = random.uniform(0.1, 1.4);
    const SinCos<double> phase{std::sin(angle), std::cos(angle)};
    const double f = force.amplitude * phase.sin, f1 = force.amplitude * force.frequency * phase.cos;
    CAPTURE(i);

    const Lead<double> second = lead_at(force, phase, zeta, -f, 0);
    CHECK(second.order == 2);
    CHECK(second.value == f + f);
    const double v = 3 * f1;
    const Lead<double> third = lead_at(force, phase, zeta, f - 2 * zeta * v, v);
    CHECK(third.order == 3);
    CHECK(third.value == doctest::Approx(f1 - v));
    const Lead<double> fourth = lead_at(force, phase, zeta, f - 2 * zeta * f1, f1);
    CHECK(fourth.order == 4);
    CHECK(fourth.value == doctest::Approx(-force.frequency * force.frequency * f));
    const double across = force.amplitude * force.frequency;
    const Lead<double> fifth = lead_at(force, {0, 1}, zeta, -2 * zeta * across, across);
    CHECK(fifth.order == 5);
    CHECK(fifth.value == doctest::Approx(-force.frequency * force.frequency * across));
  }
  CHECK(lead_at({0, 1}, {0, 1}, 0.3, 0, 0).order == 0);
}

TEST_CASE("walls that others push lead x by later derivatives, or hold it for ever") {
  // A wall without damping that is met with the speed w: x''' = nu K w + f0 omega_f, x^(5) = K f0 omega_f -
  // f0 omega_f^3 if that is zero, and x stays at rest if omega_f^2 = K as well.
  const double stiffness = 64, nu = 0.25, f0 = 3;
  for (const double omega : {2.0, 8.0, 16.0}) {
    const Walls wall{{nu, stiffness, 0, 0, -f0 * omega / (nu * stiffness)}};
    const Lead<double> lead = lead_at({f0, omega}, {0, 1}, 0.125, 0, 0, wall);
    CAPTURE(omega);
    CHECK(lead.order == (omega == 8 ? 0u : 5u));
    CHECK(lead.value == f0 * omega * (stiffness - omega * omega));
  }
}

TEST_CASE(
    "a mass at rest on a wall where y'' and y''' vanish sticks or leaves as the fifth derivative tells") {
  reference::Random random(2);
  for (int i = 0; i < 60; ++i) {
    Scene scene;
    scene.damper().mass_ratio = random.log_uniform(1e-3, 10);
    scene.damper().restitution = i % 4 == 0 ? 0 : random.uniform(0.1, 0.9);
    scene.damping_ratio = i % 3 == 0 ? 0 : random.log_uniform(1e-3, 2);
    scene.damper().wall_stiffness = random.log_uniform(1e2, 1e8);
    scene.force_amplitude = random.log_uniform(0.1, 10) * random.sign();
    scene.force_frequency = random.log_uniform(0.2, 2);
    scene.v0 = scene.force_amplitude * scene.force_frequency;
    scene.x0 = -2 * scene.damping_ratio * scene.v0;
    scene.damper().y0 = i % 2;
    scene.until_time = 3 / scene.force_frequency;
    // y^(5) = f0 omega_f^3.
    const bool sticks = (scene.damper().y0 == 0) == (scene.force_amplitude < 0);
    std::array<double, 2> parts{};  // when the mass leaves the wall, with either kind
    for (const Engine& engine : {Engine(Restitution{}), Engine(Exact{})}) {
      CAPTURE(i);
      CAPTURE(name_of(engine));
      const Run one = run_of(scene, engine), list = run_of(list_of_one(scene), engine);
      for (const Run* run : {&one, &list}) {
        CHECK(run->stop_reason == StopReason::time);
        CHECK(run->impacts->time.size() < 200);
        CHECK(std::fabs(run->energy->residual) < 1e-13);
        if (sticks) {
          REQUIRE(!run->contacts->begin.empty());
          CHECK(run->contacts->begin[0] == 0);
          CHECK(run->contacts->end[0] > 0.1 / scene.force_frequency);
        }
        // Nothing is met soon.
        const double soon = sticks ? run->contacts->end[0] : 1e-2;
        CHECK((run->impacts->time.empty() || run->impacts->time[0] > soon));
      }
      if (sticks) {
        CHECK(std::fabs(one.contacts->end[0] - list.contacts->end[0]) < 1e-11);
        parts[std::holds_alternative<Exact>(engine)] = one.contacts->end[0];
      }
    }
    if (sticks && scene.damper().wall_stiffness > 1e4 * scene.damper().mass_ratio)
      CHECK(std::fabs(parts[0] - parts[1]) <
            20 * std::sqrt(scene.damper().mass_ratio / scene.damper().wall_stiffness));
  }
}

TEST_CASE("the paper's stuck regime begins with a mass that the fifth derivative presses to its wall") {
  const Scene scene{.x0 = 0,
                    .v0 = 1,
                    .force_amplitude = 1,
                    .force_frequency = 1,
                    .until_time = 1,
                    .dampers = {{.mass_ratio = 1, .y0 = 1}}};
  const Cem options{.stuck_speed = 0.01};
  const Run run = run_of(scene, options);
  CHECK(run.impacts->time.empty());
  REQUIRE(run.contacts->begin.size() == 1);
  CHECK(run.contacts->begin[0] == 0);
  CHECK(run.contacts->end[0] == 1);
}
