// Friction, weight and drag by the engines without a step: against closed forms, limits, the engines without
// them, and themselves in another guise. The oracle has them beside an integrator that shares nothing with
// them (tests/oracle).
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "impact_damper/analysis/consistency.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "same_run.hpp"
#include "shared_scenes.hpp"

namespace components {

using namespace impact_damper;
using reference::everything;

Scene random_scene(std::uint64_t seed, int most_dampers) {
  reference::Random random(seed);
  Scene scene;
  scene.damping_ratio = random.chance(0.5) ? 0 : random.log_uniform(1e-3, 2);
  scene.x0 = random.uniform(-6, 6);
  scene.v0 = random.chance(0.5) ? 0 : random.uniform(-5, 5);
  if (random.chance(0.4)) {
    scene.force_amplitude = random.log_uniform(0.1, 5);
    scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.2, 5);
  }
  scene.weight = random.chance(0.5) ? 0 : random.log_uniform(1e-3, 5);
  const int count = 1 + int(random.uniform(0, most_dampers));
  scene.dampers.clear();
  for (int i = 0; i < count; ++i) {
    SceneDamper& each = scene.dampers.emplace_back();
    each.mass_ratio = random.log_uniform(1e-3, random.chance(0.2) ? 5 : 0.3);
    each.restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 0.95);
    if (most_dampers > 1) each.clearance = random.log_uniform(0.2, 5);
    each.friction = random.chance(0.2) ? 0 : random.log_uniform(1e-3, 5);
    if (random.chance(0.4)) each.static_friction = each.friction * random.uniform(1, 2);
    each.drag = random.chance(0.4) ? 0 : random.log_uniform(1e-3, 2);
    each.y0 = each.clearance * (random.chance(0.6) ? random.uniform(0, 1) : double(random.chance(0.5)));
    if (each.y0 > 0 && each.y0 < each.clearance && random.chance(0.5)) each.w0 = random.uniform(-2, 2);
  }
  if (scene.weight == 0 && !has_components(scene)) scene.weight = 0.1;
  scene.until_time = 40;
  return scene;
}
// Where things coincide: friction equal to |x''| at the release, weight 1, masses at rest at walls, equal
// dampers.
Scene round_scene(std::uint64_t seed) {
  reference::Random random(seed);
  const auto one_of = [&](std::initializer_list<double> values) {
    return values.begin()[random.bits() % values.size()];
  };
  Scene scene;
  scene.damping_ratio = one_of({0, 0, 0, 0.5, 1, 2});
  scene.x0 = one_of({0, 0.25, 0.5, 1, 2, 4}) * random.sign();
  scene.v0 = one_of({0, 0, 0, 1}) * random.sign();
  if (random.chance(0.3)) {
    scene.force_amplitude = one_of({0.25, 1, 4}) * random.sign();
    scene.force_frequency = one_of({1, 0.5, 2});
  }
  scene.weight = one_of({0, 0, 1, 1, 0.5, 2});
  const int count = int(one_of({1, 1, 1, 2, 3}));
  scene.dampers.clear();
  for (int i = 0; i < count; ++i) {
    SceneDamper& each = scene.dampers.emplace_back();
    each.mass_ratio = one_of({1, 0.5, 0.25, 4, 0.02});
    each.restitution = one_of({0, 0, 0.5, 0.6, 1});
    each.clearance = count == 1 ? 1 : one_of({1, 1, 2, 0.5});
    const double joined = std::abs(scene.x0) / (1 + each.mass_ratio);
    each.friction = one_of({0, joined, joined, std::abs(scene.x0), 0.5, 1, 0.25, scene.weight});
    if (random.chance(0.3)) each.static_friction = each.friction * one_of({1, 2}) + one_of({0, 0, 0.5});
    each.drag = one_of({0, 0.5, 1});
    each.y0 = each.clearance * one_of({0, 0, 0.5, 1, 0.25});
    each.w0 = one_of({0, 0, 0, 1}) * random.sign();
  }
  if (!has_components(scene)) scene.weight = 1;
  scene.until_time = one_of({5, 20, 40});
  return scene;
}
// Bounces for ever with e = 1 are cut short.
const std::array<Engine, 2> engines{Restitution{.budget = {.max_impacts = 50'000}, .max_steps = 2'000'000},
                                    Exact{.budget = {.max_impacts = 50'000}, .max_steps = 2'000'000}};

}  // namespace components

using namespace components;

TEST_CASE("under weight and friction bounces shrink by e sqrt((gamma - phi) / (gamma + phi))") {
  const double gamma = 2, phi = 0.7, height = 0.5, nu = 1e-9;
  for (const double e : {0.0, 0.5, 0.9, 1.0}) {
    CAPTURE(e);
    const Scene scene{.x0 = 0,
                      .weight = gamma,
                      .until_time = 60,
                      .dampers = {{.mass_ratio = nu, .restitution = e, .y0 = height, .friction = phi}}};
    const Run run = simulate(scene, Restitution{}, everything());
    const double out = gamma + phi, back = gamma - phi, r = std::sqrt(back / out), q = e * r;
    const double falls = std::sqrt(2 * height / back), speed = back * falls;
    REQUIRE(run.contacts->begin.size() == 1);
    CHECK(run.contacts->begin[0] ==
          doctest::Approx(falls + e * speed * (1 / out + r / back) / (1 - q)).epsilon(1e-7));
    for (std::size_t i = 0; i < std::min<std::size_t>(run.impacts->time.size(), 8); ++i)
      CHECK(run.impacts->relative_velocity[i] ==
            doctest::Approx(-speed * std::pow(q, double(i))).epsilon(1e-7));
    // Friction takes nu phi for each unit of path, impacts the rest of nu gamma h.
    const double path = height + e * e * speed * speed / out / (1 - q * q);
    CHECK(run.energy->friction_loss == doctest::Approx(nu * phi * path).epsilon(1e-7));
    CHECK(run.energy->impact_loss_total() + run.energy->bounce_down_loss + run.energy->friction_loss ==
          doctest::Approx(nu * gamma * height).epsilon(1e-7));
    CHECK(std::abs(run.energy->residual) < 1e-14);
  }
  // With phi > gamma it stays where it is; thrown up it stops above its wall, which is no contact.
  for (const double speed : {0.0, 0.3}) {
    const Scene scene{.x0 = 0,
                      .weight = gamma,
                      .until_time = 5,
                      .dampers = {{.mass_ratio = nu, .y0 = height, .w0 = speed, .friction = 2.5}}};
    const Run run = simulate(scene, Restitution{}, everything({{4, 5, 2}}));
    CHECK(run.impacts->time.empty());
    CHECK(run.contacts->begin.empty());
    CHECK(run.history->dampers[0].y[1] ==
          doctest::Approx(height + speed * speed / (2 * (2.5 + gamma))).epsilon(1e-8));
    CHECK(run.history->dampers[0].w[1] == 0);
  }
}

TEST_CASE("the energy balance closes, and the run is consistent, in random and in round scenes") {
  for (const Engine& engine : engines) {
    CAPTURE(name_of(engine));
    int worst_seed = 0;
    double worst = 0;
    const auto examine = [&](const Scene& scene, int seed) {
      const Run run = simulate(scene, engine, everything({{0, *scene.until_time, 41}}));
      CAPTURE(seed);
      CHECK((run.stop_reason == StopReason::time || run.stop_reason == StopReason::impact_budget));
      for (const Problem& each : inconsistencies_of(run)) FAIL_CHECK(each.field << ": " << each.message);
      // Each event rounds the state once; where weight draws the masses down the balance may be between
      // numbers much larger than what is available.
      const double events = double(run.impacts->time.size() + run.contacts->begin.size() + 30);
      double turned = 0.1;
      for (const SceneDamper& each : scene.dampers) turned += scene.weight * each.mass_ratio;
      const double available = run.energy->initial.total() + turned * turned / 2;
      const double residual =
          std::abs(run.energy->residual) / std::sqrt(events) * std::min(1.0, available / turned);
      if (residual > worst) worst = residual, worst_seed = seed;
    };
    for (int seed = 0; seed < many(150); ++seed) examine(random_scene(std::uint64_t(seed), 1), seed);
    for (int seed = 150; seed < 150 + many(150); ++seed) examine(random_scene(std::uint64_t(seed), 5), seed);
    for (int seed = 300; seed < 300 + many(300); ++seed) examine(round_scene(std::uint64_t(seed)), seed);
    CAPTURE(worst_seed);
    CHECK(worst < (has_rigid_walls(engine) ? 2e-15 : 1e-14));  // a contact is more than one event
  }
}

TEST_CASE("a shorter run with friction, weight and drag is the beginning of a longer one") {
  for (const Engine& engine : engines) {
    CAPTURE(name_of(engine));
    for (int seed = 0; seed < many(60); ++seed) {
      CAPTURE(seed);
      Scene scene = random_scene(std::uint64_t(seed), seed % 2 ? 1 : 4);
      scene.until_time = 20;
      const Run all = simulate(scene, engine, everything());
      scene.until_time = 8.7;
      const Run some = simulate(scene, engine, everything());
      REQUIRE(some.impacts->time.size() <= all.impacts->time.size());
      for (std::size_t i = 0; i < some.impacts->time.size(); ++i) {
        CHECK(some.impacts->time[i] == all.impacts->time[i]);
        CHECK(some.impacts->relative_velocity[i] == all.impacts->relative_velocity[i]);
      }
      for (std::size_t i = 0; i < some.half_cycles->amplitude.size(); ++i)
        CHECK(some.half_cycles->zero_crossing[i] == all.half_cycles->zero_crossing[i]);
    }
  }
}

TEST_CASE("a list of one is the run of its damper, and renumbering a list changes no bit") {
  for (const Engine& engine : engines) {
    CAPTURE(name_of(engine));
    for (int seed = 0; seed < 40; ++seed) {
      CAPTURE(seed);
      Scene scene = random_scene(std::uint64_t(seed), 1);
      scene.until_time = 12;
      const Run flat = simulate(scene, engine, everything({{0, 12, 61}}));
      const Run run = in_its_own_units(simulate(list_of_one(scene), engine, everything({{0, 12, 61}})));
      CHECK(run.history->x == flat.history->x);
      CHECK(run.history->dampers[0].y == flat.history->dampers[0].y);
      CHECK(run.impacts->time == flat.impacts->time);
      CHECK(run.impacts->relative_velocity == flat.impacts->relative_velocity);
      CHECK(run.contacts->begin == flat.contacts->begin);
      CHECK(run.contacts->end == flat.contacts->end);
      CHECK(run.energy->friction_loss == flat.energy->friction_loss);
      CHECK(run.energy->drag_loss == flat.energy->drag_loss);
      CHECK(run.energy->bounce_down_loss == flat.energy->bounce_down_loss);
      CHECK(flat.energy->dampers.empty());
      REQUIRE(run.energy->dampers.size() == 1);
      CHECK(run.energy->dampers[0].friction_loss == run.energy->friction_loss);

      Scene several = random_scene(std::uint64_t(seed + 100), 4);
      several.until_time = 12;
      if (several.dampers.size() > 1)
        several.dampers[1] = several.dampers[0], several.dampers[1].friction *= 1.5;
      if (!problems_of(several).empty()) continue;
      const Run one = simulate(several, engine, everything({{0, 12, 61}}));
      std::ranges::reverse(several.dampers);
      const Run other = simulate(several, engine, everything({{0, 12, 61}}));
      CHECK(one.history->x == other.history->x);
      CHECK(one.history->dampers.front().y == other.history->dampers.back().y);
      CHECK(one.energy->dampers.front().friction_loss == other.energy->dampers.back().friction_loss);
      CHECK(one.energy->dampers.front().drag_loss == other.energy->dampers.back().drag_loss);
    }
  }
}

TEST_CASE("two masses held by friction part from their cavities at one instant") {
  for (const Engine& engine : engines) {
    CAPTURE(name_of(engine));
    // x'' of all, held, falls through -phi of both at the same time: nu, clearance and place are their own.
    const double phi = 0.5;
    Scene scene{.x0 = 0,
                .v0 = 2,
                .until_time = 1.2,
                .dampers = {{.mass_ratio = 0.1, .clearance = 3, .y0 = 1, .friction = phi},
                            {.mass_ratio = 0.3, .clearance = 5, .y0 = 4, .friction = phi}}};
    const Run run = simulate(scene, engine, everything({{0, 1.2, 1201}}));
    const double omega = 1 / std::sqrt(1.4), parts = std::asin(phi / (2 * omega)) / omega;
    for (std::size_t n = 0; n < 1201; ++n) {
      const double t = run.history->time[n];
      for (const auto& its : run.history->dampers) {
        if (t <= parts) CHECK(its.w[n] == 0);
        if (t > parts + 1e-3) CHECK(its.w[n] > 0);
      }
      CHECK(run.history->dampers[0].w[n] == doctest::Approx(run.history->dampers[1].w[n]).epsilon(1e-12));
    }
    CHECK(std::abs(run.energy->residual) < 1e-15);
  }
}

TEST_CASE("at the edge of a band the drag of another mass decides, where it turns x'''") {
  // x'' = 1 = phi_s of the first mass, and 2 x''' = -v - 1/2, the latter by the second mass in its fluid.
  for (const double v : {-0.25, -0.75}) {
    const Scene scene{.x0 = -2,
                      .v0 = v,
                      .until_time = 0.01,
                      .dampers = {{.mass_ratio = 1, .y0 = 0.5, .friction = 0.5, .static_friction = 1},
                                  {.mass_ratio = 0.5, .y0 = 0.5, .drag = 1}}};
    CAPTURE(v);
    for (const Engine& engine : std::vector<Engine>{Exact{}, Restitution{}}) {
      CAPTURE(name_of(engine));
      const Run run = simulate(scene, engine, everything({{0, 0.01, 2}}));
      CHECK((run.history->dampers[0].w[1] == 0) == (v == -0.25));
    }
  }
}

TEST_CASE(
    "of two masses at rest friction holds the one that would exceed its bound by more if the other stayed") {
  // Held both, x'' = 1.07: the second needs 3.47 of friction, 1.47 more than it has, the first 0.82 more.
  // With the first let go (1 + nu) x'' is 4.87, and the second needs 1.29.
  const Scene scene{
      .x0 = -5.87,
      .until_time = 0.25,
      .dampers = {{.mass_ratio = 4, .clearance = 2, .y0 = 1, .friction = 0.25},
                  {.mass_ratio = 0.5, .clearance = 2, .wall_stiffness = 50, .y0 = -0.0454, .friction = 2}}};
  for (const Engine& engine : {Engine(Exact{}), Engine(Cem{.time_step = 1e-4, .locate = true})}) {
    CAPTURE(name_of(engine));
    const Run run = simulate(scene, engine, everything({{0, 0.25, 26}}));
    const double allowed = name_of(engine) == Exact::name ? 1e-14 : 1e-6;
    for (std::size_t n = 0; n < 26; ++n) {
      const double t = run.history->time[n], root = std::sqrt(1.5);
      CHECK(std::abs(run.history->x[n] - (-1 - 4.87 * std::cos(t / root))) < allowed);
      CHECK(std::abs(run.history->dampers[0].w[n] - (0.25 * t - 4.87 / root * std::sin(t / root))) < allowed);
      CHECK(run.history->dampers[1].w[n] == 0);
    }
  }
}

TEST_CASE("friction that stops a mass exactly at a wall lets it rest there") {
  for (const Engine& engine : engines)
    for (const double side : {-1.0, 1.0}) {
      CAPTURE(name_of(engine));
      // nu phi holds x against its spring as long as the mass slides, for a time of 1.
      const Scene scene{
          .x0 = side * 0.25,
          .until_time = 3,
          .dampers = {{.mass_ratio = 0.5, .y0 = 0.5 + side / 4, .w0 = side / 2, .friction = 0.5}}};
      const Run run = simulate(scene, engine, everything({{0, 3, 31}}));
      for (const double w : run.impacts->relative_velocity) CHECK(std::abs(w) < 1e-7);  // sqrt(2 epsilon phi)
      for (std::size_t n = 0; n < 31; ++n) {
        const double t = run.history->time[n], rests = std::max(t - 1, 0.0);
        CHECK(run.history->x[n] ==
              doctest::Approx(side / 4 * std::cos(rests / std::sqrt(1.5))).epsilon(1e-7));
        if (t > 1) CHECK(std::abs(run.history->dampers[0].y[n] - (1 + side) / 2) < 1e-14);
        if (t > 1) CHECK(run.history->dampers[0].w[n] == 0);
      }
      CHECK(std::abs(run.energy->residual) < 1e-14);
    }
}

TEST_CASE("static friction alone holds a mass that then slides without loss") {
  for (const Engine& engine : engines) {
    CAPTURE(name_of(engine));
    const Scene scene{.x0 = 0, .v0 = 1, .until_time = 3, .dampers = {{.y0 = 0.5, .static_friction = 0.4}}};
    const Run run = simulate(scene, engine, everything({{0, 3, 301}}));
    const double omega = 1 / std::sqrt(1.02), parts = std::asin(0.4 / omega) / omega;
    for (std::size_t n = 0; n < 301; ++n)
      CHECK((run.history->dampers[0].w[n] == 0) == (run.history->time[n] <= parts));
    CHECK(run.energy->friction_loss == 0);
    CHECK(std::abs(run.energy->residual) < 1e-15);
  }
}

TEST_CASE("drag slows a mass on a base at rest exponentially") {
  for (const Engine& engine : engines) {
    CAPTURE(name_of(engine));
    Scene scene{
        .x0 = 0, .until_time = 3, .dampers = {{.mass_ratio = 1e-9, .y0 = 0.1, .w0 = 0.4, .drag = 0.9}}};
    scene.damper().wall_stiffness = 1;
    const Run run = simulate(scene, engine, everything({{0, 3, 31}}));
    for (std::size_t n = 0; n < run.history->time.size(); ++n)
      CHECK(run.history->dampers[0].y[n] ==
            doctest::Approx(0.1 + 0.4 / 0.9 * (1 - std::exp(-0.9 * run.history->time[n]))).epsilon(1e-8));
    CHECK(run.energy->drag_loss == doctest::Approx(0.5e-9 * 0.16 * (1 - std::exp(-5.4))).epsilon(1e-7));
  }
}

TEST_CASE("a ball that bounces in a fluid falls and rises exponentially, and comes to rest when it does") {
  const double gamma = 2, height = 0.5, nu = 1e-9;
  for (const double d : {0.5, 20.0})
    for (const double e : {0.0, 0.5, 0.9}) {
      CAPTURE(d);
      CAPTURE(e);
      // Beside it a mass that its right wall and friction hold lets the base hang at rest at x = -gamma, so
      // that much of the bounces is below the rounding of x.
      const Scene scene{.x0 = -gamma,
                        .weight = gamma,
                        .until_time = 40,
                        .dampers = {{.mass_ratio = nu, .restitution = e, .y0 = height, .drag = d},
                                    {.mass_ratio = 1, .y0 = 1, .friction = 3}}};
      const Run run = simulate(scene, Restitution{}, everything());
      const auto y = [&](double y0, double w0, double t) {
        return y0 - (w0 + gamma / d) * std::expm1(-d * t) / d - gamma / d * t;
      };
      double time = 0, from = height, speed = 0, energy = gamma * height;
      for (std::size_t i = 0; speed > 1e-9 || i == 0; ++i) {
        double before = speed / (gamma + d * speed), after = before + 1;  // y' = 0 after `before` or later
        while (y(from, speed, after) > 0) after *= 2;
        for (int n = 0; n < 100; ++n) {
          const double middle = (before + after) / 2;
          (y(from, speed, middle) > 0 ? before : after) = middle;
        }
        time += before;
        const double lands = gamma / d - (speed + gamma / d) * std::exp(-d * before);
        if (i < 8 && i < run.impacts->time.size()) {
          CHECK(run.impacts->time[i] == doctest::Approx(time).epsilon(1e-8));
          CHECK(run.impacts->relative_velocity[i] == doctest::Approx(-lands).epsilon(1e-7));
        }
        energy -= (1 - e * e) * lands * lands / 2;
        speed = e * lands, from = 0;
      }
      const std::vector<double>& begin = run.contacts->begin;
      const auto rests = std::ranges::find(run.contacts->damper, 0);
      REQUIRE(rests != run.contacts->damper.end());
      CHECK(std::abs(begin[std::size_t(rests - run.contacts->damper.begin())] - time) < 1e-8);
      CHECK(run.energy->drag_loss == doctest::Approx(nu * energy).epsilon(1e-6));
      CHECK(std::abs(run.energy->residual) < 1e-14);
    }
}

TEST_CASE("a mass comes to rest in its floor under its weight, pressing it in by gamma / K") {
  Scene scene{.x0 = -1e-4 * 0.5,
              .weight = 0.5,
              .until_time = 20,
              .dampers = {{.mass_ratio = 1e-4, .restitution = 0.2}}};
  scene.damper().wall_stiffness = 1;
  scene.damper().y0 = 0.01;
  const Run run = simulate(scene, Exact{}, everything({{19, 20, 2}}));
  CHECK(run.history->dampers[0].y[1] == doctest::Approx(-0.5 * 1e-4).epsilon(1e-6));
  CHECK(run.contacts->end.back() == 20);
  // With friction it is held above or below that place, by no more than phi / K.
  scene.damper().friction = 0.1;
  const Run held = simulate(scene, Exact{}, everything({{19, 20, 2}}));
  CHECK(held.history->dampers[0].w[1] == 0);
  CHECK(std::abs(held.history->dampers[0].y[1] + 0.5 * 1e-4) <= 0.1 * 1e-4);
  CHECK(std::abs(held.energy->residual) < 1e-13);
}
