// The component element method against the exact engine, which has no step and shares nothing with it but the
// names of a scene's numbers; and with two rates: no impact missed, nothing of its accuracy lost.
#include "impact_damper/engines/cem_rates.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "impact_damper/motion/system.hpp"
#include "impact_damper/simulate.hpp"
#include "same_run.hpp"

using namespace impact_damper;
using reference::everything, reference::farthest, reference::order;

namespace {

using std::numbers::pi;

// Bounce-down and stuck: no chaos, each stuck phase forgets the one before. Until 160 the amplitude falls
// from 6 to 5.3.
Scene bounce_down(double until) { return {.until_time = until}; }

const Scene forced{.damping_ratio = 0.02,
                   .x0 = 3,
                   .force_amplitude = 0.5,
                   .force_frequency = 0.9,
                   .until_time = 15,
                   .dampers = {{.mass_ratio = 0.1, .restitution = 0.3, .y0 = 0.4}}};
const Scene shaken{.damping_ratio = 0.3,
                   .x0 = 0.5,
                   .v0 = -1,
                   .force_amplitude = 3,
                   .force_frequency = 4,
                   .until_time = 8,
                   .dampers = {{.mass_ratio = 0.5, .restitution = 0.7, .y0 = 0.5}}};
const Scene overlapping{.damping_ratio = 1.2,
                        .x0 = -4,
                        .until_time = 4,
                        .dampers = {{.restitution = 0.2, .y0 = -0.01, .w0 = 0.5}}};
const Scene soft{
    .x0 = 2, .until_time = 8, .dampers = {{.mass_ratio = 0.05, .restitution = 0.5, .wall_stiffness = 50}}};

// x and y at 1001 times, the amplitudes, and the energy at the end.
struct Distance {
  double x, y, amplitude, energy;
};
Record looked_at(const Scene& scene) { return {.energy = true, .history = {{0, *scene.until_time, 1001}}}; }
Distance distance(const Scene& scene, const Cem& options, const Run& exact) {
  const Run run = simulate(scene, options, looked_at(scene));
  return {farthest(run.history->x, exact.history->x),
          farthest(run.history->dampers[0].y, exact.history->dampers[0].y),
          farthest(run.half_cycles->amplitude, exact.half_cycles->amplitude),
          std::abs(run.energy->final.total() - exact.energy->final.total())};
}

// A flight by itself, in closed form.
State<double> flown(const System<double>& system, const State<double>& s, double begin, double t) {
  const auto p = system.free.propagate(t);
  const auto driven = system.free.respond(system.forcing, system.forcing.phase(begin), t, p);
  const double x = s.x * p.c + s.v * p.s + driven.d, v = s.v * p.v - s.x * p.s + driven.d1;
  return {x, v, s.y + (s.v + s.w) * t - (x - s.x), s.v + s.w - v};
}

bool inside(double y) { return y > 0 && y < 1; }

}  // namespace

TEST_CASE(
    "with located events it converges to the exact engine with second order, with the damper lagged with "
    "first") {
  struct Case {
    Damper damper;
    double expected;
  };
  for (const Scene& scene : {bounce_down(160), forced, overlapping}) {
    const Run exact = simulate(scene, Exact{}, looked_at(scene));
    for (const Case& each : {Case{Damper::centred, 2}, Case{Damper::lagged, 1}}) {
      CAPTURE(name_of(each.damper));
      const Distance coarse =
                         distance(scene, {.time_step = 2e-5, .damper = each.damper, .locate = true}, exact),
                     fine =
                         distance(scene, {.time_step = 1e-5, .damper = each.damper, .locate = true}, exact);
      CHECK(std::abs(order(coarse.x, fine.x) - each.expected) < 0.15);
      if (fine.amplitude > 0) CHECK(std::abs(order(coarse.amplitude, fine.amplitude) - each.expected) < 0.15);
      CHECK(std::abs(order(coarse.energy, fine.energy) - each.expected) < 0.15);
    }
  }
}

TEST_CASE("unlocated it converges with first order, in the mean over neighbouring steps") {
  // The error with a single step depends on where in the step each touch and release happen to fall.
  const Scene scene = bounce_down(160);
  const Run exact = simulate(scene, Exact{}, looked_at(scene));
  for (Damper damper : {Damper::centred, Damper::lagged}) {
    const auto mean = [&](double h) {
      Distance sum{};
      for (int i = 0; i < 16; ++i) {
        const Distance far = distance(scene, {.time_step = h * (1 + i / 32.0), .damper = damper}, exact);
        sum.x += far.x / 16;
        sum.amplitude += far.amplitude / 16;
      }
      return sum;
    };
    const Distance coarse = mean(8e-5), fine = mean(1e-5);
    CHECK(std::abs(order(coarse.x, fine.x) / 3 - 1) < 0.25);
    CHECK(std::abs(order(coarse.amplitude, fine.amplitude) / 3 - 1) < 0.25);
  }
}

TEST_CASE(
    "with the default step a decay to 5.3 has the exact engine's amplitudes, with one rate and with two") {
  const Scene scene = bounce_down(160);
  const Run exact = simulate(scene, Exact{}, looked_at(scene));
  CHECK(distance(scene, {}, exact).amplitude < 2e-3);
  CHECK(distance(scene, {.locate = true}, exact).amplitude < 5e-6);
  CHECK(distance(scene, {.locate = true, .large_step = 0.05}, exact).amplitude < 1e-3);
  CHECK(distance(scene, {.locate = true, .large_step = 0.01}, exact).amplitude < 5e-5);
  CHECK(distance(scene, {.large_step = 0.05}, exact).amplitude < 4e-3);
  CHECK(distance(scene, {.damper = Damper::lagged, .large_step = 0.05}, exact).amplitude < 4e-2);
}

TEST_CASE("a flight that is certified free meets no wall, in closed form or in central differences") {
  std::mt19937 random(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  int certain = 0, tight = 0;
  constexpr int trials = 20000;
  for (int i = 0; i < trials; ++i) {
    Scene scene;
    if (i % 2) scene.damping_ratio = std::pow(10, uniform(-3, 0.5));
    if (i % 3) {
      scene.force_amplitude = std::pow(10, uniform(-1, 1));
      scene.force_frequency = std::pow(10, uniform(-1, 1));
    }
    const double large = std::pow(10, uniform(-2.5, -0.4)), begin = uniform(0, 20);
    if (scene.force_amplitude != 0 && scene.force_frequency * large > 1)
      continue;  // too coarse for the force
    if (scene.damping_ratio * large > 0.5) continue;
    const System<double> system(scene);
    const double size = std::pow(10, uniform(-1, 1));
    const State<double> s{uniform(-size, size), uniform(-size, size), uniform(0, 1), uniform(-2, 2)};
    const double f = system.forcing.derivatives<2>(system.forcing.phase(begin))[0];
    const double x2 = f - 2 * system.zeta * s.v - s.x;
    const Certificate<double> sure(system.zeta, system.forcing, s, x2, large, 16 * large, 1, 1);

    // Either so many large steps, or one that is as long as is free.
    int steps = 16;
    while (steps > 0 && !sure.free_for(steps * large)) steps /= 2;
    const double h = steps > 0 ? large : sure.free_time(large) * (1 - 1e-9);
    if (!(h > 1e-6)) continue;
    ++certain;
    steps = std::max(steps, 1);

    const double duration = steps * h;
    for (int j = 1; j <= 64; ++j) CHECK(inside(flown(system, s, begin, duration * j / 64).y));

    // As the engine steps: own velocities are turned into the scheme's.
    const double f1 = system.forcing.derivatives<2>(system.forcing.phase(begin))[1];
    const double v = s.v * std::sqrt(1 - h * h / 4) + h * h / 6 * (f1 - 2 * system.zeta * x2);
    const auto a =
        cem_step(RegimeEquations<double>{.nu = system.nu, .zeta = system.zeta}, Damper::centred, h);
    double x = s.x, y = s.y, dx = h * (v - h * (f - 2 * system.zeta * v - s.x) / 2),
           dq = h * (s.v + s.w) - dx;
    for (int n = 0; n < steps; ++n) {
      const double next = a.dx_dx * dx + a.dx_x * x +
                          a.dx_f * system.forcing.derivatives<2>(system.forcing.phase(begin + n * h))[0];
      dq -= next - dx;
      dx = next;
      x += dx, y += dq;
      CHECK(inside(y));
      if (!inside(y)) MESSAGE("h " << h << " steps " << steps << " y " << y);
    }
    // Not by being too cautious: the wall is near, or the time well used.
    tight += steps == 16 || !inside(flown(system, s, begin, 2.5 * duration).y) ||
             !inside(flown(system, s, begin, 1.5 * duration).y);
  }
  CHECK(certain > trials / 2);
  CHECK(tight > certain / 2);
}

TEST_CASE("two rates find the very impacts that small steps alone find") {
  std::vector<Scene> scenes{bounce_down(60), overlapping, forced, shaken, soft};
  for (double beyond : {1e-2, 1e-4, 1e-6, -1e-6, -1e-4}) {
    scenes.push_back(
        {.x0 = 0.3, .until_time = 4, .dampers = {{.y0 = 0.4 + beyond}}});  // y = y0 + 0.3 (1 - cos t)
  }
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Scene& scene = scenes[i];
    CAPTURE(i);
    for (bool locate : {false, true}) {
      // Unlocated, errors of first order in h decide on bounces so small that the next zero crossing ends
      // them.
      if (!locate && i < 2) continue;
      const Run one = simulate(scene, Cem{.locate = locate}, everything());
      for (double large : {0.02, 0.005}) {
        const Run two = simulate(scene, Cem{.locate = locate, .large_step = large}, everything());
        REQUIRE(one.impacts->wall == two.impacts->wall);
        // The large steps' clock is wrong by H^2/24 of the time, and bounces magnify that.
        const double late = locate ? 5 * large * large : 0.1;
        CHECK(farthest(one.impacts->time, two.impacts->time) < late);
        CHECK(farthest(one.half_cycles->amplitude, two.half_cycles->amplitude) < late);
      }
    }
  }
  CHECK(simulate(scenes[5 + 2], Cem{}, everything()).impacts->time.size() == 1);
  CHECK(simulate(scenes[5 + 3], Cem{}, everything()).impacts->time.empty());
}

TEST_CASE("located, the method is of second order in S3's bounce-down, with one rate and with two") {
  const Scene scene = bounce_down(400);
  const double contact = nominal_contact_time(scene.damper());
  const Run exact = simulate(scene, Exact{}, {});
  const auto error = [&](double steps_in_contact, double large) {
    Cem options{.time_step = contact / steps_in_contact, .locate = true};
    if (large > 0) options.large_step = large;
    return farthest(simulate(scene, options, {}).half_cycles->amplitude, exact.half_cycles->amplitude);
  };
  CHECK(order(error(100, 0), error(800, 0), 8) == doctest::Approx(2).epsilon(0.1));
  CHECK(order(error(160, 0.016), error(1280, 0.002), 8) == doctest::Approx(2).epsilon(0.1));
  CHECK(error(1280, 0.002) < 5e-6);
}

TEST_CASE("located, with both steps halved two rates converge to the exact engine with second order") {
  for (const Scene& scene : {bounce_down(160), forced, shaken, overlapping, soft}) {
    const Run exact = simulate(scene, Exact{}, looked_at(scene));
    const double unit = nominal_contact_time(scene.damper()) / 0.0044;
    const auto far = [&](double scale) {
      return distance(scene, {.time_step = 2e-5 * unit * scale, .locate = true, .large_step = 0.008 * scale},
                      exact);
    };
    const Distance coarse = far(1), fine = far(0.125);
    CAPTURE(scene.damper().mass_ratio);
    CAPTURE(fine.x);
    CHECK(order(coarse.x, fine.x, 8) == doctest::Approx(2).epsilon(0.1));
    if (fine.amplitude > 0)
      CHECK(order(coarse.amplitude, fine.amplitude, 8) == doctest::Approx(2).epsilon(0.1));
    CHECK(order(coarse.energy, fine.energy, 8) == doctest::Approx(2).epsilon(0.15));
  }
}

TEST_CASE("changing the step does not change the energy") {
  // Without losses; some thousand changes of step.
  Scene scene{.until_time = 300, .dampers = {{.restitution = 1}}};
  for (double large : {0.2, 0.05}) {
    const Run run = simulate(scene, Cem{.locate = true, .large_step = large}, everything());
    CHECK(run.impacts->time.size() > 100);
    CHECK(std::abs(run.energy->final.total() / 18 - 1) < 2e-6);
    CHECK(std::abs(run.energy->residual) < 2e-6);
  }
}

TEST_CASE("damped and forced too, a change of step during rest is wrong by no more than a step's own error") {
  // One small step from rest, then some large ones H. By Taylor's theorem their own error, of order H^2 in
  // the acceleration, has in so many steps come to H^3 in the velocity and H^4 in the position. If H^2/6 (f'
  // - 2 zeta x'') were left out of the velocity handed on, or went in twice, the position would be an order
  // worse.
  constexpr int steps = 4;
  for (double zeta : {0.0, 0.4}) {
    for (double force : {0.0, 0.3}) {
      if (zeta == 0 && force == 0) continue;
      struct Errors {
        double x, v;
      };
      const auto errors = [&](double large) {
        const double small = 1e-5 * large;
        const Scene scene{.damping_ratio = zeta,
                          .x0 = 0.6,
                          .force_amplitude = force,
                          .force_frequency = 1.5,
                          .until_time = small + steps * large,
                          .dampers = {{.y0 = 0.5}}};
        const Record record{.history = {{0, *scene.until_time, 2}}};
        const Run exact = simulate(scene, Exact{}, record);
        // One step more than that: should the last one end a rounding error short of the time.
        const Run run =
            simulate(scene, Cem{.time_step = small, .large_step = large, .max_steps = 2 + steps}, record);
        REQUIRE(run.stop_reason == StopReason::time);
        return Errors{std::abs(run.history->x[1] - exact.history->x[1]),
                      std::abs(run.history->v[1] - exact.history->v[1])};
      };
      const Errors coarse = errors(0.02), fine = errors(0.0025);
      CAPTURE(zeta);
      CAPTURE(force);
      CHECK(order(coarse.x, fine.x, 8) == doctest::Approx(4).epsilon(0.1));
      CHECK(order(coarse.v, fine.v, 8) == doctest::Approx(3).epsilon(0.1));
    }
  }
}

TEST_CASE("with two rates the energy balance closes with second order") {
  for (double zeta : {0.0, 0.008}) {
    for (double force : {0.0, 0.3}) {
      const Scene scene{
          .damping_ratio = zeta, .force_amplitude = force, .force_frequency = 0.8, .until_time = 12};
      const auto residual = [&](double scale) {
        const Run run = simulate(
            scene, Cem{.time_step = 1e-4 * scale, .locate = true, .large_step = 0.08 * scale}, everything());
        const EnergyBalance& balance = *run.energy;
        CHECK(balance.impact_loss.size() == run.impacts->time.size());
        CHECK((balance.viscous_work > 0) == (zeta > 0));
        CHECK((balance.forcing_work != 0) == (force != 0));
        return std::abs(balance.residual);
      };
      const double coarse = residual(1), fine = residual(0.125);
      CAPTURE(zeta);
      CAPTURE(force);
      CHECK(coarse < 5e-4);
      CHECK(order(coarse, fine, 8) == doctest::Approx(2).epsilon(0.2));
    }
  }
}

TEST_CASE("long steps in a long contact, of a heavy mass too, leave the energy as small ones do") {
  for (double mass_ratio : {0.02, 1.0}) {
    const Scene scene{
        .x0 = 20,
        .until_time = 60,
        .dampers = {{.mass_ratio = mass_ratio, .restitution = 0.3, .wall_stiffness = 1e4 * mass_ratio}}};
    const Run one = simulate(scene, Cem{.locate = true}, everything());
    const Run two = simulate(scene, Cem{.locate = true, .large_step = 0.02}, everything());
    double longest = 0;
    for (std::size_t i = 0; i < two.contacts->end.size(); ++i) {
      longest = std::max(longest, two.contacts->end[i] - two.contacts->begin[i]);
    }
    CHECK(longest > 1);
    CAPTURE(mass_ratio);
    CHECK(std::abs(two.energy->residual - one.energy->residual) < 2e-6);
  }
}

TEST_CASE("in long flights times are counted and the motion keeps to the scheme's closed form") {
  // The first step is small; each of the others takes x by 2 asin(H/2) round the circle, the last a shorter
  // one.
  const double small = 1e-4, large = 2999 * small, time = 1e6;
  const Scene scene{.x0 = 0.2, .v0 = 0.1, .until_time = time, .dampers = {{.y0 = 0.5, .w0 = -0.1}}};
  const Run run = simulate(scene,
                           Cem{.time_step = small,
                               .large_step = 0.29999,
                               .budget = {.max_half_cycles = 1'000'000, .max_time = time}},
                           {.history = {{time - 0.25, time, 2}}});
  const double steps = std::floor((time - small) / large), rest = std::fma(-steps, large, time - small);
  const double angle = steps * 2 * std::asin(large / 2) + 2 * std::asin(rest / 2) + small;
  CHECK(run.history->time.back() == time);
  // Rounding: 1e-16 of the time, and an increment's last bit, which the steps that follow turn into phase.
  CHECK(std::abs(run.history->x.back() - (0.2 * std::cos(angle) + 0.1 * std::sin(angle))) < 1e-9);
  CHECK(std::abs(run.history->v.back() - (0.1 * std::cos(angle) - 0.2 * std::sin(angle))) < 1e-9);
}

TEST_CASE("amplitudes, zero crossings and samples in large steps are those of the closed form") {
  const double amplitude = std::hypot(0.2, 0.1), phase = std::atan2(0.1, 0.2);
  for (double large : {0.2, 0.05}) {
    const Scene scene{.x0 = 0.2, .v0 = 0.1, .until_time = 40, .dampers = {{.y0 = 0.5, .w0 = -0.1}}};
    const Run run = simulate(scene, Cem{.large_step = large}, {.history = {{0, 40, 999}}});
    const HalfCycles& rows = *run.half_cycles;
    REQUIRE(rows.amplitude.size() == 13);
    const double h_2 = large * large;
    for (std::size_t i = 0; i < rows.amplitude.size(); ++i) {
      const double time = phase + double(i) * pi, slip = (time + pi) * h_2 / 23;
      CHECK(std::abs(rows.amplitude[i] / amplitude - 1) < h_2 * h_2 / 16);
      CHECK(std::abs(rows.peak_time[i] - time) < slip + h_2 * large / 6);
      CHECK(std::abs(rows.zero_crossing[i] - (time + pi / 2)) < slip + h_2 * large / 6);
    }
    for (std::size_t i = 0; i < run.history->x.size(); ++i) {
      const double t = run.history->time[i], clock = (t + 1) * h_2 / 23 + h_2 * large / 6;
      CHECK(std::abs(run.history->x[i] - amplitude * std::cos(t - phase)) < amplitude * clock);
      CHECK(std::abs(run.history->v[i] + amplitude * std::sin(t - phase)) <
            amplitude * (clock + h_2 * large / 3));
      CHECK(std::abs(run.history->dampers[0].y[i] - (0.5 + 0.2 - run.history->x[i])) < 1e-9);
    }
  }
}

TEST_CASE("a peak that falls between two steps of unequal length is not lost") {
  // Impacts, and with them changes of step, at all phases of x: bounds follow from the energy, which the
  // impacts leave as it is, and y' = 0 at no peak in particular.
  Scene scene{.until_time = 400, .dampers = {{.mass_ratio = 1e-9, .restitution = 1}}};
  scene.x0 = 3;
  const Run run = simulate(scene, Cem{.locate = true, .large_step = 0.3}, {.impacts = true});
  CHECK(run.impacts->time.size() > 500);
  // A parabola's height within H^4/16; and what so light a mass takes, of order 1e-9.
  for (double amplitude : run.half_cycles->amplitude) CHECK(std::abs(amplitude / 3 - 1) < 5.1e-4);
}

TEST_CASE("a whole decay takes an eightieth of the steps") {
  const Scene scene{.until_amplitude = 0.03};  // to t = 1700 or so: 39 million steps of the default length
  const auto end = [&](Cem options) {
    options.max_steps = 480'000;
    return simulate(scene, options, {}).stop_reason;
  };
  CHECK(end({}) == StopReason::step_budget);
  CHECK(end({.large_step = 0.05}) == StopReason::amplitude);
  CHECK(end({.locate = true, .large_step = 0.05}) == StopReason::amplitude);
}

TEST_CASE("with two rates a run ends at its time, and when its steps are used up, in whichever step") {
  for (bool locate : {false, true}) {
    double last = 0;
    for (std::int64_t steps = 1; steps < 1500; ++steps) {
      const Run run = simulate({.until_time = 50},
                               Cem{.locate = locate, .large_step = 0.1, .max_steps = steps}, everything());
      CHECK(run.stop_reason == StopReason::step_budget);
      CHECK(run.end_time > last);
      CHECK(run.end_time <= last + 0.1 * (1 + 1e-12));
      last = run.end_time;
    }
    CHECK(last > 3);
    for (double time : {0.01, 0.333, 2.5, 17.77}) {
      const Run run = simulate({.until_time = time}, Cem{.locate = locate, .large_step = 0.1}, everything());
      CHECK(run.stop_reason == StopReason::time);
      CHECK(run.end_time == time);
      CHECK(std::abs(run.energy->residual) < 1e-3);
    }
  }
}

TEST_CASE("a scene at rest stays there in steps of any length") {
  const Run run =
      simulate({.x0 = 0, .until_time = 1000, .dampers = {{.y0 = 0.5}}}, Cem{.large_step = 1.9}, everything());
  CHECK(run.impacts->time.empty());
  CHECK(run.energy->final.total() == 0);
}

TEST_CASE(
    "a large step is rejected if it is not larger, beyond the limit in flight, or too coarse for the force") {
  const Scene scene{.until_time = 1}, driven{.force_amplitude = 1, .force_frequency = 10, .until_time = 1};
  const auto message = [](const Scene& of, const Cem& options) -> std::string {
    try {
      simulate(of, options, {});
    } catch (const std::invalid_argument& rejection) {
      return rejection.what();
    }
    return {};
  };
  CHECK(message(scene, {.large_step = 1.9999}).empty());
  CHECK(message(driven, {.large_step = 0.314}).empty());
  for (double large : {5e-5, 1e-4, 2.0}) {
    CHECK(
        message(scene, {.time_step = 1e-4, .large_step = large}).starts_with("large_step: must be > 0.0001"));
  }
  for (double large : {0.0, -1.0, double(NAN), double(INFINITY)}) {
    CHECK(message(scene, {.time_step = 1e-4, .large_step = large})
              .starts_with("large_step: must be > 0 and finite, got "));
  }
  CHECK(message(driven, {.large_step = 0.315}) ==
        "large_step: must be <= 0.314158, half a period of the forcing, got 0.315");
  // Less than two small ones, and more than can be counted.
  CHECK(message(scene, {.time_step = 1e-4, .large_step = 1.5e-4}).empty());
  CHECK(message(scene, {.time_step = 1e-300, .large_step = 0.1, .max_steps = 1000}).empty());
  // Every problem at once.
  const std::string both = message(scene, {.time_step = 1, .large_step = 0.5});
  CHECK(both.starts_with("time_step: "));
  CHECK(both.find("\nlarge_step: ") != std::string::npos);
}
