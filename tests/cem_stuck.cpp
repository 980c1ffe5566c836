// The paper's stuck regime in the component element method (Cem::stuck_speed): against the restitution engine
// with e = 0, whose impacts all join the masses where the wall pushes, and against integrations of its own.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "impact_damper/engines/cem.hpp"
#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

constexpr double always = 1e6;  // faster than any impact here

Record everything() { return {.impacts = true, .contacts = true, .energy = true}; }

double order(double coarse, double fine) { return std::log2(coarse / fine); }

void check_second_order(const std::array<double, 3>& error) {
  CHECK(order(error[0], error[1]) == doctest::Approx(2).epsilon(0.1));
  CHECK(order(error[1], error[2]) == doctest::Approx(2).epsilon(0.1));
}

// Equation (9) with the force divided by 1 + nu, by the classical Runge-Kutta method.
struct Joined {
  long double nu, zeta, f0, omega_f;
  long double t = 0, x = 0, v = 0;

  long double acceleration(long double at, long double its_x, long double its_v) const {
    return (f0 * std::sin(omega_f * at) - 2 * zeta * its_v - its_x) / (1 + nu);
  }
  void step(long double h) {
    const long double a1 = acceleration(t, x, v), v2 = v + h / 2 * a1;
    const long double a2 = acceleration(t + h / 2, x + h / 2 * v, v2), v3 = v + h / 2 * a2;
    const long double a3 = acceleration(t + h / 2, x + h / 2 * v2, v3), v4 = v + h * a3;
    const long double a4 = acceleration(t + h, x + h * v3, v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    t += h;
  }
  // On to where x'' changes its sign.
  void part() {
    const long double sign = acceleration(t, x, v) > 0 ? 1 : -1;
    for (long double h = 1e-3L; h > 1e-17L;) {
      Joined next = *this;
      next.step(h);
      if (sign * next.acceleration(next.t, next.x, next.v) < 0) {
        h /= 2;
      } else {
        *this = next;
      }
    }
  }
};

// Pressed to the left wall at rest from the beginning, with damping and a force.
const Scene pressed{.damping_ratio = 0.2,
                    .x0 = -2,
                    .force_amplitude = 0.3,
                    .force_frequency = 1.7,
                    .until_time = 2,
                    .dampers = {{.mass_ratio = 0.5, .wall_stiffness = 100}}};

}  // namespace

TEST_CASE("both masses move by equation (9) and part where x'' changes its sign, with second order") {
  Joined joined{pressed.damper().mass_ratio,
                pressed.damping_ratio,
                pressed.force_amplitude,
                pressed.force_frequency,
                0,
                pressed.x0};
  for (int i = 0; i < 100; ++i) joined.step(0.005L);
  const double x_at_half = double(joined.x), v_at_half = double(joined.v);
  joined.part();
  REQUIRE(joined.t > 1);
  REQUIRE(joined.t < 2);
  Record record = everything();
  record.history = {{0.5, 0.6, 2}};
  // Where in a step x'' changes its sign decides on the time's error: the mean over neighbouring steps.
  constexpr int neighbours = 16;
  for (const bool two_rates : {false, true}) {
    std::array<double, 3> x{}, v{}, time{};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < neighbours; ++j) {
        const double h = (0.02 + 0.002 * j / neighbours) / (1 << i);
        Cem options{.time_step = h, .stuck_speed = always};
        if (two_rates) options = {.time_step = 1e-5, .large_step = h, .stuck_speed = always};
        const Run run = simulate(pressed, options, record);
        REQUIRE(run.contacts->begin.at(0) == 0);
        x[i] += std::abs(run.history->x[0] - x_at_half);
        v[i] += std::abs(run.history->v[0] - v_at_half);
        const double late = std::abs(run.contacts->end[0] - double(joined.t));
        CHECK(late < h * h);
        time[i] += late;
        CHECK(run.history->dampers[0].y[0] == 0);
        CHECK(run.history->dampers[0].w[0] == 0);
        CHECK(run.impacts->time.empty());
      }
    }
    CAPTURE(two_rates);
    check_second_order(x);
    check_second_order(v);
    check_second_order(time);
  }
}

TEST_CASE("from rest in the middle a force moves both masses, from the first step on") {
  // x = f0 omega_f t^3/6 divided by 1 + nu, as long as t is small.
  const double h = 1e-3, f0 = 0.5;
  const Scene scene{.x0 = 0,
                    .force_amplitude = f0,
                    .until_time = 0.1,
                    .dampers = {{.mass_ratio = 0.5, .wall_stiffness = 100}}};
  const Run run =
      simulate(scene, Cem{.time_step = h, .stuck_speed = always}, {.contacts = true, .history = {{0, h, 2}}});
  CHECK(run.history->x[1] == doctest::Approx(f0 * h * h * h / 6 / 1.5).epsilon(1e-3));
  CHECK(run.contacts->end.at(0) == 0.1);
}

TEST_CASE("a slow impact joins the masses with their momentum, at what that costs, until x returns to zero") {
  // x = -cos t; the secondary mass goes straight on, from -0.9 with the speed -0.3.
  const Scene scene{.x0 = -1, .until_time = 3, .dampers = {{.mass_ratio = 0.2, .y0 = 0.1, .w0 = -0.3}}};
  const auto gap = [](double t) { return -0.9 - 0.3 * t + std::cos(t); };
  double before = 0, after = 1;
  while (after - before > 1e-15) {
    const double middle = (before + after) / 2;
    (gap(middle) > 0 ? before : after) = middle;
  }
  const double touch = before, x = -std::cos(touch), v = std::sin(touch), w = -0.3 - v;
  const double nu = scene.damper().mass_ratio, joined_v = v + nu * w / (1 + nu), root = std::sqrt(1 + nu);
  const double end = touch + root * std::atan2(-x / root, joined_v);
  const double loss = nu * w * w / (2 * (1 + nu));
  Record record = everything();
  record.history = {{touch + 0.1, touch + 0.2, 2}};
  const double v_then = joined_v * std::cos(0.1 / root) - x / root * std::sin(0.1 / root);
  for (const bool locate : {false, true}) {
    std::array<double, 3> time, speed;
    for (int i = 0; i < 3; ++i) {
      const Cem options{.time_step = 1e-3 / (1 << i), .locate = locate, .stuck_speed = 0.6};
      const Run run = simulate(scene, options, record);
      REQUIRE(run.impacts->time.size() == 1);
      CHECK(run.impacts->relative_velocity[0] == doctest::Approx(w).epsilon(1e-6));
      CHECK(run.energy->impact_loss.at(0) == doctest::Approx(loss).epsilon(1e-6));
      CHECK(run.energy->contact_loss == 0);
      time[i] = std::abs(run.contacts->end.at(0) - end);
      speed[i] = std::abs(run.history->v[0] - v_then);
    }
    CHECK(time[0] < 1e-6);
    CHECK(speed[0] < 1e-6);
  }
  // The same impact bounces where it is not slow.
  CHECK(std::abs(w) > 0.5);
  const Run bounces = simulate(scene, Cem{.stuck_speed = 0.5}, record);
  CHECK(bounces.impacts->time.size() > 1);
}

TEST_CASE("with every impact slow it converges to the restitution engine at e = 0 with second order") {
  // Three scenes in which the wall pushes at every impact: only then do both join the masses.
  const Scene free{.until_time = 60, .dampers = {{.restitution = 0}}};
  const Scene damped{
      .damping_ratio = 0.02, .x0 = 9, .until_time = 12, .dampers = {{.mass_ratio = 0.5, .restitution = 0}}};
  const Scene forced{.damping_ratio = 0.01,
                     .x0 = 3,
                     .force_amplitude = 0.4,
                     .force_frequency = 0.8,
                     .until_time = 20,
                     .dampers = {{.mass_ratio = 0.1, .restitution = 0}}};
  for (const Scene& scene : {free, damped, forced}) {
    CAPTURE(scene.damper().mass_ratio);
    const Run rigid = simulate(scene, Restitution{}, everything());
    REQUIRE(rigid.contacts->begin.size() > 3);
    for (const bool locate : {false, true}) {
      std::array<double, 3> amplitude{}, part{}, loss{};
      for (int i = 0; i < 3; ++i) {
        const Cem options{.time_step = 2e-3 / (1 << i), .locate = locate, .stuck_speed = always};
        const Run run = simulate(scene, options, everything());
        REQUIRE(run.half_cycles->amplitude.size() == rigid.half_cycles->amplitude.size());
        REQUIRE(run.contacts->end.size() == rigid.contacts->end.size());
        REQUIRE(run.impacts->time.size() == rigid.impacts->time.size());
        for (std::size_t n = 0; n < rigid.half_cycles->amplitude.size(); ++n)
          amplitude[i] = std::max(amplitude[i],
                                  std::abs(run.half_cycles->amplitude[n] - rigid.half_cycles->amplitude[n]));
        for (std::size_t n = 0; n < rigid.contacts->end.size(); ++n)
          part[i] = std::max(part[i], std::abs(run.contacts->end[n] - rigid.contacts->end[n]));
        for (std::size_t n = 0; n < rigid.impacts->time.size(); ++n)
          loss[i] = std::max(loss[i], std::abs(run.energy->impact_loss[n] - rigid.energy->impact_loss[n]));
      }
      CHECK(amplitude[2] < 1e-5);
      check_second_order(amplitude);
      check_second_order(part);
      check_second_order(loss);
    }
  }
}

TEST_CASE("with the stuck regime the energy balance closes with second order") {
  const Scene scene{.damping_ratio = 0.008, .force_amplitude = 0.3, .force_frequency = 0.8, .until_time = 12};
  for (const double force : {0.0, 0.3}) {
    Scene its = scene;
    its.force_amplitude = force;
    std::array<double, 3> residual;
    for (int i = 0; i < 3; ++i) {
      const Cem options{.time_step = 1e-4 / (1 << i), .locate = true, .stuck_speed = 0.3};
      const Run run = simulate(its, options, everything());
      residual[i] = std::abs(run.energy->residual);
      double longest = 0;
      for (std::size_t n = 0; n < run.contacts->end.size(); ++n)
        longest = std::max(longest, run.contacts->end[n] - run.contacts->begin[n]);
      CHECK(longest > 0.3);
    }
    CHECK(residual[0] < 1e-5);
    check_second_order(residual);
  }
}

TEST_CASE("with a speed that no impact falls below, the run is the one without the regime, bit by bit") {
  const Scene scene{.until_time = 40};
  Record record = everything();
  record.history = {{0, 40, 501}};
  for (const bool locate : {false, true}) {
    const Run without = simulate(scene, Cem{.locate = locate}, record);
    const Run with =
        simulate(scene, Cem{.locate = locate, .stuck_speed = std::numeric_limits<double>::min()}, record);
    CHECK(with.history->x == without.history->x);
    CHECK(with.history->dampers[0].w == without.history->dampers[0].w);
    CHECK(with.contacts->end == without.contacts->end);
    CHECK(with.energy->impact_loss == without.energy->impact_loss);
    // One speed farther up and it is another one.
    const Run other = simulate(scene, Cem{.locate = locate, .stuck_speed = 0.01}, record);
    CHECK(other.history->x != without.history->x);
  }
}

TEST_CASE("an impact from which the wall withdraws does not join the masses, however slow") {
  // x'' < 0 at the left wall: the wall falls behind a mass that would stay.
  const Scene scene{.x0 = 1, .v0 = 0.5, .until_time = 0.2, .dampers = {{.y0 = 0.01, .w0 = -0.3}}};
  const Run run = simulate(scene, Cem{.stuck_speed = always}, everything());
  REQUIRE(run.impacts->time.size() == 1);
  CHECK(run.contacts->end.at(0) - run.contacts->begin.at(0) < 2 * nominal_contact_time(scene.damper()));
}

TEST_CASE("with two rates the joined masses take large steps, to the same motion") {
  const Scene scene{.x0 = -6, .until_time = 1};
  const Cem options{.time_step = 1e-5, .large_step = 0.05, .stuck_speed = 0.01, .max_steps = 200};
  CHECK(simulate(scene, options, everything()).stop_reason == StopReason::time);
  const Scene decay{.until_time = 60};
  const Run one = simulate(decay, Cem{.locate = true, .stuck_speed = 0.1}, everything());
  const Run two = simulate(decay, Cem{.locate = true, .large_step = 0.02, .stuck_speed = 0.1}, everything());
  REQUIRE(one.half_cycles->amplitude.size() == two.half_cycles->amplitude.size());
  // 2e-4 is twice H^2/4, the error of a large step's own.
  for (std::size_t n = 0; n < one.half_cycles->amplitude.size(); ++n)
    CHECK(std::abs(one.half_cycles->amplitude[n] - two.half_cycles->amplitude[n]) < 2e-4);
  CHECK(std::abs(two.energy->residual) < 1e-4);
}

TEST_CASE(
    "a contact under a push lasts from W a / omega_c down, W = 2.21 at e = 0.6, in which the default lies") {
  // x'' = 1 to 1e-9 while a contact of a stiff wall lasts: an impact at once, in closed form.
  Scene scene{.x0 = -1, .until_time = 0.01, .dampers = {{.wall_stiffness = 1e10}}};
  const double contact = nominal_contact_time(scene.damper()), per_push = contact / std::numbers::pi;
  const auto lasts = [&](double speed) {
    scene.damper().w0 = -speed * per_push;
    const Run run = simulate(scene, Exact{}, everything());
    return run.contacts->end.at(0) - run.contacts->begin.at(0) > 2 * contact;
  };
  CHECK(lasts(2.20));
  CHECK(!lasts(2.22));
  const double at_paper = 2.21 * nominal_contact_time({}) / std::numbers::pi;
  CHECK(usual_stuck_speed > 1 * at_paper);
  CHECK(usual_stuck_speed < 6 * at_paper);
}

TEST_CASE("a speed that impacts have at small amplitudes too keeps the decay from reaching A = 0.1") {
  const Scene scene{.until_time = 4000, .until_amplitude = 0.1};
  const auto stop = [&](double speed) {
    return simulate(scene, Cem{.locate = true, .large_step = 0.02, .stuck_speed = speed}, {}).stop_reason;
  };
  CHECK(stop(0.4) == StopReason::amplitude);
  CHECK(stop(0.5) == StopReason::time);
}

TEST_CASE("a speed that is no positive number is rejected") {
  const Scene scene;
  for (const double speed : {0.0, -1.0, double(INFINITY), std::nan("")}) {
    const auto problems = problems_of(scene, resolved(scene, Cem{.stuck_speed = speed}));
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].field == "stuck_speed");
    CHECK(problems[0].message.starts_with("must be > 0 and finite, got "));
  }
  CHECK(problems_of(scene, resolved(scene, Cem{.stuck_speed = 1e-300})).empty());
}
