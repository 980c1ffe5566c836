// Friction, weight and drag (docs/mathematics.md, chapter 18) against closed forms.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/engines/recorded.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/simulate.hpp"
#include "rejection.hpp"
#include "same_run.hpp"

using namespace impact_damper;

namespace {

using std::numbers::pi;

// A primary mass that a secondary mass of a billionth does not move.
Scene on_heavy_base(const SceneDamper& damper) {
  Scene scene{.x0 = 0, .dampers = {damper}};
  scene.damper().mass_ratio = 1e-9;
  scene.damper().wall_stiffness = 1;  // omega_m is some 3e4
  return scene;
}

// A component that says nothing, beside which a scene without components takes the way of those with them.
Scene with_components(Scene scene) {
  scene.weight = least_magnitude;
  return scene;
}

State<double> state_at(Scene scene, double time, const Cem& options) {
  scene.until_time = time;
  const Run run = simulate(scene, options, {.half_cycles = false, .history = {{time / 2, time, 2}}});
  const auto& [y, w] = run.history->dampers[0];
  REQUIRE(y.size() == 2);
  return {run.history->x[1], run.history->v[1], y[1], w[1]};
}

// Checks that y at `time` is `expected`, with errors of second order in steps from 0.004 on.
void check_y(const Scene& scene, double time, double expected) {
  CAPTURE(time);
  std::array<double, 3> error{};
  for (int i = 0; i < 3; ++i)
    error[i] =
        std::abs(state_at(scene, time, {.time_step = 0.004 / (1 << i), .locate = true, .unstable = true}).y -
                 expected);
  CHECK(error[0] < 1e-3);
  if (error[0] < 1e-8) return;  // a parabola, which the method follows exactly, but for what moves the base
  CHECK(error[2] < error[0] / 8);  // of second order: some 16
}

// A eta/nu for nu = 0.02, by a fit over a factor of 1.44 in amplitude.
double specific_loss(const HalfCycles& rows, double amplitude) {
  double n = 0, t = 0, a = 0, tt = 0, ta = 0;
  for (std::size_t i = 0; i < rows.amplitude.size(); ++i) {
    if (!(rows.amplitude[i] < amplitude * 1.2 && rows.amplitude[i] > amplitude / 1.2)) continue;
    const double time = rows.peak_time[i], log = std::log(rows.amplitude[i]);
    n += 1, t += time, a += log, tt += time * time, ta += time * log;
  }
  return -2 * amplitude / 0.02 * (n * ta - t * a) / (n * tt - t * t);
}

// Random scenes of one to three dampers with all components.
Scene random_scene(std::mt19937_64& random) {
  std::uniform_real_distribution<> uniform;
  const auto between = [&](double low, double high) { return low + (high - low) * uniform(random); };
  Scene scene;
  scene.damping_ratio = between(0, 0.02);
  scene.x0 = between(0.5, 4);
  scene.force_amplitude = between(0, 0.3);
  scene.force_frequency = between(0.7, 1.3);
  scene.weight = between(0, 0.3);
  scene.until_time = 6;
  scene.dampers.resize(1 + random() % 3);
  for (SceneDamper& damper : scene.dampers) {
    damper.mass_ratio = between(0.01, 0.1);
    damper.restitution = between(0.3, 0.9);
    damper.clearance = between(0.5, 2);
    damper.wall_stiffness = between(10, 100);
    damper.y0 = damper.clearance * between(0.1, 0.9);
    damper.friction = between(0, 0.8);
    damper.static_friction = damper.friction * between(1, 2);
    damper.drag = between(0, 0.3);
  }
  return scene;
}

}  // namespace

TEST_CASE("components: friction stops a mass on a base at rest after w0^2 / (2 phi)") {
  const Scene scene = on_heavy_base({.y0 = 0.1, .w0 = 0.5, .friction = 0.25});
  for (const double time : {0.5, 1.5}) check_y(scene, time, 0.1 + 0.5 * time - 0.125 * time * time);
  for (const double time : {2.0, 2.5, 7.0}) check_y(scene, time, 0.1 + 0.5);
}

TEST_CASE("components: friction on a vibrating base drags, stops and holds the mass as Coulomb's law says") {
  // x = A cos t. From rest the mass slides forwards, y'' = A cos t - phi, until A sin t = phi t.
  for (const double amplitude : {1.2, 0.4}) {
    CAPTURE(amplitude);
    Scene scene = on_heavy_base({.clearance = 10, .y0 = 5, .friction = 0.3});
    scene.x0 = amplitude;
    double stops = 2;
    for (int i = 0; i < 50; ++i)
      stops -= (amplitude * std::sin(stops) - 0.3 * stops) / (amplitude * std::cos(stops) - 0.3);
    const auto slid = [&](double t) { return 5 + amplitude * (1 - std::cos(t)) - 0.15 * t * t; };
    for (const double part : {0.3, 0.9}) check_y(scene, part * stops, slid(part * stops));
    const bool holds = amplitude * std::abs(std::cos(stops)) <= 0.3;
    CHECK(holds == (amplitude < 0.5));
    // Where it is held it begins to slide back at A |cos t| = phi, after t = pi / 2.
    const double back = holds ? std::acos(-0.3 / amplitude) : stops, then = back + 0.6;
    if (holds) check_y(scene, (stops + back) / 2, slid(stops));
    check_y(scene, then,
            slid(stops) + amplitude * (std::cos(back) - std::cos(then)) + 0.15 * 0.6 * 0.6 -
                amplitude * std::sin(back) * 0.6);
  }
}

TEST_CASE("components: static friction holds a mass longer than friction stops it") {
  // x = A cos t: |x''| reaches phi_s at cos t = -phi_s / A, and the mass, at rest since the release, slides
  // then.
  Scene scene = on_heavy_base({.clearance = 10, .y0 = 5, .friction = 0.1, .static_friction = 0.5});
  scene.x0 = 0;
  scene.v0 = 0.8;  // x = 0.8 sin t
  const double slides = std::asin(0.5 / 0.8), time = slides + 0.4;
  CHECK(state_at(scene, slides - 0.02, {.time_step = 1e-3, .unstable = true}).y == 5);
  // y'' = 0.8 sin t - 0.1
  check_y(scene, time,
          5 + 0.8 * (std::sin(slides) - std::sin(time)) + 0.8 * std::cos(slides) * 0.4 - 0.05 * 0.16);
}

TEST_CASE("components: drag slows a mass on a base at rest exponentially") {
  const Scene scene = on_heavy_base({.y0 = 0.1, .w0 = 0.4, .drag = 0.9});
  for (const double time : {0.7, 3.0}) check_y(scene, time, 0.1 + 0.4 / 0.9 * (1 - std::exp(-0.9 * time)));
}

TEST_CASE("components: a mass comes to rest on the floor under its weight, pressing it in by gamma / K") {
  Scene scene = on_heavy_base({.restitution = 0.2, .wall_stiffness = 1, .y0 = 0.01});
  scene.damper().mass_ratio = 1e-4;
  scene.weight = 0.5;
  const State<double> end = state_at(scene, 20, {});
  CHECK(end.y == doctest::Approx(-0.5 * 1e-4).epsilon(1e-3));
}

TEST_CASE("components: so small that they say nothing, they leave a run as it is") {
  const Scene scene{.x0 = 2, .force_amplitude = 0.1, .until_time = 4};
  const Record record{.impacts = true, .contacts = true, .energy = true, .history = {{0, 4, 50}}};
  for (const Cem& options : {Cem{}, Cem{.damper = Damper::lagged}, Cem{.locate = true}}) {
    Run run = simulate(with_components(scene), options, record);
    CHECK(run.energy->final.weight != 0);
    run.scene.weight = 0;
    reference::same(run, simulate(scene, options, record), 1e-9);
  }
}

TEST_CASE("components: two equal dampers are one of their mass") {
  Scene one = {.x0 = 1.5, .force_amplitude = 0.2, .weight = 0.1, .until_time = 12};
  one.damper() = {.mass_ratio = 0.04, .y0 = 0.3, .friction = 0.2, .static_friction = 0.3, .drag = 0.1};
  one.damper().wall_stiffness = 50;
  Scene two = one;
  two.damper().mass_ratio /= 2;
  two.damper().wall_stiffness /= 2;
  two.dampers.push_back(two.damper());
  const Record record{.impacts = true, .energy = true, .history = {{0, 12, 100}}};
  const Cem options{.time_step = 1e-3};
  const Run run = simulate(two, options, record), expected = simulate(one, options, record);
  reference::same("x", run.history->x, expected.history->x, 1e-8);
  for (const History::Damper& each : run.history->dampers)
    reference::same("y", each.y, expected.history->dampers[0].y, 1e-8);
  const EnergyBalance &energy = *run.energy, &its = *expected.energy;
  CHECK(its.friction_loss > 0.001);
  CHECK(its.drag_loss > 0.001);
  CHECK(energy.friction_loss == doctest::Approx(its.friction_loss).epsilon(1e-9));
  CHECK(energy.drag_loss == doctest::Approx(its.drag_loss).epsilon(1e-9));
  CHECK(energy.final.weight == doctest::Approx(its.final.weight).epsilon(1e-9));
  CHECK(energy.dampers[0].friction_loss == doctest::Approx(its.friction_loss / 2).epsilon(1e-9));
}

TEST_CASE("components: the energy balance closes with the square of the step") {
  std::mt19937_64 random(20261129);
  int falling = 0;
  constexpr int scenes = 40;
  for (int n = 0; n < scenes; ++n) {
    CAPTURE(n);
    const Scene scene = random_scene(random);
    std::array<double, 2> residual{};
    for (int i = 0; i < 2; ++i) {
      const Run run = simulate(scene, Cem{.time_step = 2e-4 / (1 << (2 * i)), .locate = true},
                               {.impacts = true, .energy = true});
      residual[i] = std::abs(run.energy->residual);
      CHECK(run.energy->friction_loss >= 0);
      CHECK(run.energy->drag_loss >= 0);
    }
    CHECK(residual[0] < 1e-4);
    falling += residual[1] < residual[0] / 4;
  }
  CHECK(falling >= scenes * 3 / 4);  // most fall by 16; others are small by chance
}

TEST_CASE("components: a shorter run is the beginning of a longer one") {
  std::mt19937_64 random(5);
  for (int n = 0; n < 10; ++n) {
    Scene scene = random_scene(random);
    const Record record{.impacts = true, .history = {{0, 4, 60}}};
    const Run longer = simulate(scene, Cem{}, record);
    scene.until_time = 4;
    const Run shorter = simulate(scene, Cem{}, record);
    CHECK(shorter.history->x == longer.history->x);
    for (std::size_t i = 0; i < scene.dampers.size(); ++i)
      CHECK(shorter.history->dampers[i].y == longer.history->dampers[i].y);
    REQUIRE(shorter.impacts->time.size() <= longer.impacts->time.size());
    CHECK(
        std::equal(shorter.impacts->time.begin(), shorter.impacts->time.end(), longer.impacts->time.begin()));
  }
}

TEST_CASE("components: exact data end every run") {
  // phi = |x''| at the release to the last bit; gamma = 1; w = 0 at a wall; friction that stops the mass
  // exactly at a wall; two held masses that part at one instant.
  std::vector<Scene> scenes;
  const auto add = [&](const Scene& scene) {
    scenes.push_back(scene);
    scenes.back().until_time = 30;
  };
  for (const double static_friction : {0.0, 1.5})
    for (const double y0 : {0.0, 0.5, 1.0})
      add({.x0 = 1, .dampers = {{.y0 = y0, .friction = 1, .static_friction = static_friction}}});
  for (const double y0 : {0.0, 0.5, 1.0}) add({.x0 = 1, .weight = 1, .dampers = {{.y0 = y0}}});
  add({.x0 = 0,
       .dampers = {{.mass_ratio = 1e-9, .wall_stiffness = 1e-2, .y0 = 0.5, .w0 = 0.5, .friction = 0.25}}});
  add({.x0 = 2, .weight = 0.25, .dampers = {{.y0 = 0.5, .friction = 1}, {.y0 = 0.5, .friction = 1}}});
  add({.x0 = 2, .dampers = {{.y0 = 0.5, .friction = 1}, {.mass_ratio = 0.1, .y0 = 0.2, .friction = 1}}});
  add({.x0 = 0, .dampers = {{.y0 = 0.5, .friction = 0.1}}});
  for (const Scene& scene : scenes)
    for (const bool locate : {false, true}) {
      CAPTURE(scene.x0);
      const Run run = simulate(scene, Cem{.locate = locate, .max_steps = 20'000'000}, {.energy = true});
      CHECK(run.stop_reason == StopReason::time);
      CHECK(std::abs(run.energy->residual) < 1e-3);
    }
}

TEST_CASE("components: the engines have them, and reject what does not go with them") {
  Scene scene{.weight = 0.5, .until_time = 1};
  scene.damper().friction = 0.1;
  scene.damper().drag = 0.2;
  const auto told = [&](const Engine& engine) {
    return rejection_of<InvalidArguments>([&] { simulate(scene, engine, {}); });
  };
  CHECK(told(Exact{}) == not_rejected);
  CHECK(told(Restitution{}) == not_rejected);
  Recorder recorder(Record{});
  CHECK(contains(rejection_of<InvalidArguments>([&] { run_cem(checked(scene, Cem{}), recorder); }),
                 "scene: must have no friction, drag and weight for this function"));
  const Checked rigid = checked(scene, Restitution{});
  CHECK_THROWS_AS(run_restitution<double>(rigid, recorder), InvalidArguments);
  CHECK_THROWS_AS(run_restitution_dampers<double>(rigid, recorder), InvalidArguments);
  CHECK(contains(rejection_of<InvalidArguments>([&] { simulate(scene, Cem{.large_step = 0.01}, {}); }),
                 "large_step: must be absent beside friction, weight and drag"));
  scene.damper().static_friction = 0.05;
  CHECK(contains(rejection_of<InvalidArguments>([&] { simulate(scene, Cem{}, {}); }),
                 "static_friction: must be 0 or at least the friction, 0.1, got 0.05"));
}

TEST_CASE(
    "components: what friction, weight and drag change in a decay, with compliant and with rigid walls") {
  // Numbers of an independent integrator with rigid walls and extended precision, of one release each: A
  // eta/nu by fits over a factor of 1.44 in amplitude, which chaos scatters by some 2 percent, and the
  // amplitude at t = 1200 of a mass that is locked by then. Under a weight of 0.1 releases scatter by more at
  // A = 1, where it has 0.261, both engines and the oracle (tests/oracle/oracle_itself.cpp) 0.27 on average,
  // and at A = 0.2, where impacts of some fail already.
  constexpr double unknown = -1;
  struct Row {
    double friction, weight, drag;
    std::vector<double> losses;
    double locked = 0;
  };
  constexpr std::array<double, 5> amplitudes{2.5, 1.5, 1, 0.5, 0.2};
  for (const Row& row : {Row{0, 0, 0, {0.380, 0.332, 0.292, 0.264, 0.265}},
                         {0.01, 0, 0, {0.383, 0.338, 0.291, 0.278, 0.281}},
                         {0.05, 0, 0, {0.395, 0.356, 0.307, 0.305, 0.358}, 0.0589},
                         {0.2, 0, 0, {0.439, 0.411, 0.351, 0.375, 0.006}, 0.221},
                         {0.5, 0, 0, {0.491, 0.426, 0.401, 0.010}, 0.539},
                         {0, 0.1, 0, {0.376, 0.339, unknown, 0.275}},
                         {0, 0.5, 0, {0.363, 0.237, 0.317, 0.006}, 0.588},
                         {0, 0, 0.1, {0.400, 0.357, 0.315, 0.306, 0.334}}}) {
    CAPTURE(row.friction);
    CAPTURE(row.weight);
    Scene scene{.x0 = 3, .weight = row.weight, .until_time = 1200};
    scene.damper().friction = row.friction;
    scene.damper().drag = row.drag;
    // Half a unit of the last digit is what the table leaves open beside the scatter.
    const auto check = [&](const std::vector<HalfCycles>& runs, double scatter, double down_to) {
      for (std::size_t n = 0; n < row.losses.size(); ++n) {
        if (row.losses[n] == unknown || amplitudes[n] < down_to) continue;
        CAPTURE(amplitudes[n]);
        double mean = 0;
        for (const HalfCycles& rows : runs) mean += specific_loss(rows, amplitudes[n]) / double(runs.size());
        CHECK(std::abs(mean - row.losses[n]) <= scatter * row.losses[n] + 0.0005);
      }
    };
    std::vector<HalfCycles> runs;
    for (const Scene& each : ensemble_of(scene))
      runs.push_back(*simulate(each, Restitution{}, {}).half_cycles);
    check(runs, 0.02, 0);
    if (row.locked > 0) CHECK(std::abs(runs.front().amplitude.back() - row.locked) <= 0.0005);
    // One release scatters by half as much again; a locked mass takes many steps to the end.
    const double down_to = row.drag == 0 ? 0.5 : 0.2;
    scene.until_amplitude = 0.75 * down_to;
    check({*simulate(scene, Cem{}, {}).half_cycles}, 0.03, down_to);
  }
}

TEST_CASE("components: below the amplitude of locking a mass at rest stays where it is, above it does not") {
  for (const bool forced : {false, true})
    for (const double weight : {0.0, 0.1})
      for (const double part : {0.97, 1.03}) {
        CAPTURE(forced);
        CAPTURE(weight);
        CAPTURE(part);
        const double nu = 0.1, omega = forced ? 0.8 : 1 / std::sqrt(1 + nu);
        const double amplitude = part * locking_amplitude(omega, 0.3 + weight);
        Scene scene{.x0 = -weight * nu, .weight = weight, .until_time = 60};
        scene.damper() = {.mass_ratio = nu, .wall_stiffness = 1e5, .y0 = -weight * nu / 1e5, .friction = 0.3};
        if (forced) {  // steady from the beginning
          scene.force_frequency = omega;
          scene.force_amplitude = amplitude * (1 - (1 + nu) * omega * omega);
          scene.v0 = amplitude * omega;
        } else {
          scene.x0 -= amplitude;
        }
        const Run run = simulate(scene, Cem{}, {.impacts = true, .energy = true});
        // On a floor it stays until it is lifted; in the middle it does not slide at all.
        CHECK((weight == 0 ? run.energy->friction_loss == 0 : run.impacts->time.empty()) == (part < 1));
      }
}
