// Limits of friction, weight, drag and tables (docs/mathematics.md, chapter 18), each by all engines that
// have it, against closed forms:
//
//   friction, weight and drag -> 0    the run without them
//   friction -> infinity              masses that move as one
//   friction alone, no wall met       piecewise sinusoids; Den Hartog's block on a vibrating floor
//   weight alone, base at rest        the bouncing ball
//   drag -> infinity                  masses that move as one, damped by 1/d
//   a wall or a spring as a table     the linear one, by cem
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "impact_damper/simulate.hpp"
#include "same_run.hpp"

namespace limits {

using namespace impact_damper;
using reference::everything, reference::farthest;
using std::numbers::pi;

Cem by_steps(double time_step) { return {.time_step = time_step, .locate = true, .unstable = true}; }

// Checks error_of(engine): exact and restitution are off by `allowed` at most, cem besides by the square of
// its step, of which a quarter leaves a sixteenth.
template <class ErrorOf>
void check(double allowed, const ErrorOf& error_of, double time_step = 0.004) {
  const double rigid = error_of(Engine(Restitution{})), compliant = error_of(Engine(Exact{})),
               coarse = error_of(Engine(by_steps(time_step))),
               fine = error_of(Engine(by_steps(time_step / 4)));
  CHECK(rigid <= allowed);
  CHECK(compliant <= allowed);
  CHECK(coarse <= 1e-3);
  CHECK(fine <= coarse / 8 + allowed);
}
// The largest error of x, of which expected(t) is the closed form, at some times until the end of the scene.
template <class Expected>
double error_of_x(const Scene& scene, const Engine& engine, const Expected& expected) {
  const Run run = simulate(scene, engine, everything({{0, *scene.until_time, 251}}));
  std::vector<double> x;
  for (const double t : run.history->time) x.push_back(expected(t));
  return farthest(run.history->x, x);
}

}  // namespace limits

using namespace limits;

TEST_CASE("limit: friction, weight and drag to zero give the run without them") {
  const std::vector<Scene> scenes{
      {.x0 = 3, .until_time = 25},
      {.damping_ratio = 0.02, .x0 = 0.3, .force_amplitude = 0.4, .force_frequency = 0.9, .until_time = 25},
      {.x0 = -4, .until_time = 25, .dampers = {{.mass_ratio = 0.3, .restitution = 0.2}}},
      {.x0 = 3,
       .until_time = 12,
       .dampers = {{.clearance = 2, .y0 = 1}, {.mass_ratio = 0.1, .clearance = 0.7}}}};
  constexpr double tiny = 1e-11;
  for (const Scene& scene : scenes)
    for (int which = 0; which < 4; ++which) {
      CAPTURE(which);
      Scene with = scene;
      for (SceneDamper& each : with.dampers) {
        each.friction = which == 0 || which == 2 ? tiny : 0;
        each.drag = which > 1 ? tiny : 0;
      }
      with.weight = which == 1 || which == 2 ? tiny : 0;
      // Where friction is, cem begins anew as y' passes zero: that is off by the square of a step.
      const auto error = [&](const Engine& engine) {
        const Record record = everything({{0, *scene.until_time, 101}});
        const Run without = simulate(scene, engine, record), run = simulate(with, engine, record);
        CHECK(run.contacts->begin.size() == without.contacts->begin.size());
        CHECK(run.half_cycles->amplitude.size() == without.half_cycles->amplitude.size());
        return std::max(farthest(run.history->x, without.history->x),
                        farthest(run.history->dampers[0].y, without.history->dampers[0].y) / 10);
      };
      check(1e-7, error, 4e-5);
    }
}

TEST_CASE("limit: much friction locks the masses, free, forced and under weight") {
  const double nu = 0.3;
  const SceneDamper damper{.mass_ratio = nu, .y0 = 0.5, .friction = 1e6};
  const double zeta = 0.05, omega = 0.8, f0 = 0.5;
  const Scene forced{.damping_ratio = zeta,
                     .x0 = 0,
                     .force_amplitude = f0,
                     .force_frequency = omega,
                     .until_time = 600,
                     .dampers = {damper}};
  // What is left of the transient: exp(-zeta t / (1 + nu)) is 1e-10.
  check(1e-9, [&](const Engine& engine) {
    const Run run = simulate(forced, engine, everything());
    CHECK(run.impacts->time.empty());
    CHECK(run.contacts->begin.empty());
    CHECK(run.energy->friction_loss == 0);
    return std::abs(run.half_cycles->amplitude.back() -
                    f0 / std::hypot(1 - (1 + nu) * omega * omega, 2 * zeta * omega));
  });
  for (const double gamma : {0.0, 3.0}) {
    CAPTURE(gamma);
    const Scene free{.x0 = 2, .weight = gamma, .until_time = 20, .dampers = {damper}};
    check(1e-13, [&](const Engine& engine) {
      return error_of_x(free, engine, [&](double t) {
        return -gamma * nu + (2 + gamma * nu) * std::cos(t / std::sqrt(1 + nu));
      });
    });
  }
}

TEST_CASE("limit: friction against a mass that stands still leaves piecewise sinusoids until it locks") {
  // The heavy mass moves by less than phi t^2 / 2 = 4e-5, at first with x.
  const double nu = 1e6, loss = 0.11;
  const Scene scene{.x0 = 1,
                    .until_time = 25,
                    .dampers = {{.mass_ratio = nu, .clearance = 10, .y0 = 5, .friction = loss / nu}}};
  check(4e-5, [&](const Engine& engine) {
    return error_of_x(scene, engine, [&](double t) {
      // Half cycles of x about +-loss, the friction's sign being that of -x'.
      double amplitude = 1, sign = 1;
      for (; t > pi && amplitude > loss; t -= pi) amplitude -= 2 * loss, sign = -sign;
      return sign * (amplitude > loss ? loss + (amplitude - loss) * std::cos(t) : amplitude);
    });
  });
}

TEST_CASE("limit: a block on a vibrating floor slides as in Den Hartog's closed form") {
  const double amplitude = 3, omega = 0.5, phi = 0.2, nu = 1e-9;  // of the floor
  Scene scene{.x0 = 0,
              .v0 = amplitude * omega,
              .force_amplitude = amplitude * (1 - omega * omega),
              .force_frequency = omega,
              .dampers = {{.mass_ratio = nu, .clearance = 1e4, .y0 = 5e3, .friction = phi}}};
  // y' = 0 where cos(omega t0) = pi phi / (2 X omega^2); between two zeros the block slides by 2 X
  // sin(omega t0).
  const double cosine = pi * phi / (2 * amplitude * omega * omega);
  const double path = 2 * amplitude * std::sqrt(1 - cosine * cosine);
  check(1e-6, [&](const Engine& engine) {
    const auto loss = [&](double periods) {
      scene.until_time = periods * 2 * pi / omega;
      return simulate(scene, engine, everything()).energy->friction_loss;
    };
    return std::abs((loss(120) - loss(100)) / 20 / (2 * nu * phi * path) - 1);
  });
}

TEST_CASE("limit: under weight a mass on a base at rest is the bouncing ball") {
  const double gamma = 2, height = 0.5, nu = 1e-9, falls = std::sqrt(2 * height / gamma);
  struct Case {
    Engine engine;
    double wall_stiffness;  // the stiffest that the steps of cem allow in a second
  };
  for (const Case& each :
       {Case{Restitution{}, 1e6}, Case{Exact{}, 1e6}, Case{Cem{.time_step = 2.5e-7, .locate = true}, 1}})
    for (const double e : {0.0, 0.3, 0.6, 0.9}) {
      CAPTURE(name_of(each.engine));
      CAPTURE(e);
      const double total = falls * (1 + e) / (1 - e),
                   end = (each.wall_stiffness > 1 ? total : std::min(total, 4.0)) + 0.2;
      Scene scene{.x0 = 0,
                  .weight = gamma,
                  .until_time = end,
                  .dampers = {{.mass_ratio = nu, .restitution = e, .y0 = height}}};
      scene.damper().wall_stiffness = each.wall_stiffness;
      const Run run = simulate(scene, each.engine, everything({{0, end, 501}}));
      // A compliant wall delays each bounce by a contact of at most twice the undamped half period.
      const double contact =
          has_rigid_walls(each.engine) ? 0 : 2 * pi * std::sqrt(nu / scene.damper().wall_stiffness);
      const auto allowed = [&](std::size_t bounces) { return 1e-7 + contact * double(bounces); };
      double time = falls, speed = gamma * falls;
      std::size_t sample = 0;
      const auto compare_until = [&](double until, double begin, double from, double up,
                                     std::size_t bounces) {
        for (; sample < 501 && run.history->time[sample] < until; ++sample) {
          const double t = run.history->time[sample] - begin;
          CHECK(std::abs(run.history->dampers[0].y[sample] - (from + up * t - gamma * t * t / 2)) <=
                gamma * allowed(bounces));
        }
      };
      compare_until(time, 0, height, 0, 0);
      for (std::size_t i = 0; i < std::min<std::size_t>(run.impacts->time.size(), 8); ++i) {
        CHECK(run.impacts->wall[i] == Wall::left);
        CHECK(std::abs(run.impacts->time[i] - time) <= allowed(i));
        CHECK(std::abs(run.impacts->relative_velocity[i] + speed) <= gamma * allowed(i));
        speed *= e;
        compare_until(time + 2 * speed / gamma, time, 0, speed, i + 1);
        time += 2 * speed / gamma;
      }
      if (total > end) continue;
      CHECK(std::abs(run.contacts->begin.back() - total) <= allowed(run.impacts->time.size()));
      CHECK(run.contacts->end.back() == end);
      const EnergyBalance& balance = *run.energy;
      CHECK(balance.impact_loss_total() + balance.bounce_down_loss + balance.contact_loss ==
            doctest::Approx(nu * gamma * height).epsilon(1e-6));
    }
}

TEST_CASE("limit: much drag locks the masses, and lets them fall by its reciprocal") {
  const double nu = 0.3, omega = 1 / std::sqrt(1 + nu);
  for (const Engine& engine : {Engine(Restitution{}), Engine(Exact{}), Engine(by_steps(1e-4))}) {
    CAPTURE(name_of(engine));
    std::array<double, 2> error{};
    for (int i = 0; i < 2; ++i) {
      const double d = i == 0 ? 1e2 : 1e3, slip = nu / ((1 + nu) * (1 + nu) * d);
      const Scene scene{.x0 = 2, .until_time = 10, .dampers = {{.mass_ratio = nu, .y0 = 0.5, .drag = d}}};
      // w = -x''/d after a time of some 1/d, in which the momentum of both masses together remains: x' is
      // then -2 slip. Terms with 1/d^2 are left out.
      error[i] = error_of_x(scene, engine, [&](double t) {
        return std::exp(-slip * t / 2) * (2 * std::cos(omega * t) - slip / omega * std::sin(omega * t));
      });
    }
    CHECK(error[1] < 1e-5);
    CHECK(reference::order(error[0], error[1], 10) == doctest::Approx(2).epsilon(0.05));
  }
}

TEST_CASE("limit: a table, a power of 1 and a spring that are linear are the linear ones to rounding") {
  Scene scene{.damping_ratio = 0.01, .x0 = 2, .force_amplitude = 0.1, .until_time = 4};
  scene.damper() = {.mass_ratio = 0.05, .restitution = 1, .wall_stiffness = 2000, .y0 = 0.3};
  const Record record = everything({{0, 4, 50}});
  for (const Cem& options : {Cem{}, Cem{.damper = Damper::lagged}, Cem{.locate = true}}) {
    const Run expected = simulate(scene, options, record);
    REQUIRE(expected.impacts->time.size() > 2);
    Cem same = options;
    same.time_step = std::get<Cem>(expected.engine).time_step;
    for (int n = 0; n < 4; ++n) {
      CAPTURE(n);
      Scene with_law = scene;
      if (n == 0) with_law.damper().wall = {.law = WallForm::power, .exponent = 1};
      if (n == 1)
        with_law.damper().wall = {.law = WallForm::table, .pairs = {{0, 0}, {0.001, 2}, {0.5, 1000}}};
      if (n == 2) with_law.spring = {.law = SpringForm::table, .pairs = {{0, 0}, {0.7, 0.7}, {5, 5}}};
      if (n == 3) with_law.spring = {.law = SpringForm::table, .pairs = {{-5, -5}, {0, 0}, {5, 5}}};
      Run run = simulate(with_law, same, record);
      run.scene = scene;
      reference::same(run, expected, 1e-9);
    }
  }
}
