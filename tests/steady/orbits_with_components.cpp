#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "impact_damper/motion/wall.hpp"
#include "impact_damper/orbits/branches.hpp"
#include "impact_damper/orbits/corrector.hpp"
#include "impact_damper/orbits/lyapunov.hpp"
#include "impact_damper/orbits/orbits.hpp"
#include "impact_damper/orbits/poincare_map.hpp"
#include "impact_damper/orbits/variational_equations.hpp"
#include "impact_damper/simulate.hpp"
#include "impact_damper/steady/steady_state.hpp"
#include "steady_helpers.hpp"

using namespace impact_damper;

namespace {

// Friction holds its mass at all times.
Scene locked() {
  return {.damping_ratio = 0.07,
          .x0 = 0,
          .force_amplitude = 0.3,
          .force_frequency = 0.8,
          .dampers = {{.mass_ratio = 0.2, .y0 = 0.3, .friction = 100}}};
}
// The multipliers of a period of an oscillator of the mass 1 + nu.
std::complex<double> multiplier_of_locked(const Scene& scene) {
  const double mass = 1 + scene.damper().mass_ratio, a = scene.damping_ratio / mass;
  const double period = 2 * std::numbers::pi / scene.force_frequency;
  return std::exp(period * std::complex<double>(-a, std::sqrt(1 / mass - a * a)));
}

// The mass slides, stops, is let go and meets its walls.
Scene sliding(double static_friction, double weight, double friction = 0.15) {
  return {.damping_ratio = 0.05,
          .x0 = 1,
          .force_amplitude = 0.25,
          .force_frequency = 0.95,
          .weight = weight,
          .dampers = {{.mass_ratio = 0.1,
                       .restitution = 0.5,
                       .y0 = 0.3,
                       .friction = friction,
                       .static_friction = static_friction}}};
}

}  // namespace

TEST_CASE("a mass that friction holds has the multipliers of an oscillator of the mass 1 + nu") {
  const Scene scene = locked();
  const std::complex<double> expected = multiplier_of_locked(scene);
  const auto holds = [&](const Multipliers& found, std::complex<double> value) {
    return std::ranges::any_of(found, [&](const Multiplier& each) {
      return std::abs(std::complex<double>(each.re, each.im) - value) < 1e-12;
    });
  };
  SUBCASE("between walls that are alike it stays in the middle, where half a period mirrors it") {
    for (const Engine& engine : rigid_and_compliant) {
      CAPTURE(name_of(engine));
      const auto orbit = find_orbit(scene, engine, 1, {0.1, 0.2, 0.3, 0}, {.symmetric = true});
      REQUIRE(orbit);
      CHECK(orbit->scene.damper().y0 == doctest::Approx(0.5).epsilon(1e-12));
      REQUIRE(orbit->multipliers.size() == 4);
      CHECK(holds(orbit->multipliers, expected));
      CHECK(holds(orbit->multipliers, std::conj(expected)));
      CHECK(holds(orbit->multipliers, 1));  // of y
      CHECK(holds(orbit->multipliers, 0));  // of y', a change of which friction stops
    }
  }
  SUBCASE("with weight it stays where it is") {
    for (const Engine& engine : rigid_and_compliant) {
      CAPTURE(name_of(engine));
      Scene leaning = scene;
      leaning.weight = 1.5;
      const auto orbit = find_orbit(leaning, engine, 1, {0.1, 0.2, 0.3, 0});
      REQUIRE(orbit);
      CHECK(orbit->scene.damper().y0 == doctest::Approx(0.3).epsilon(1e-12));
      REQUIRE(orbit->idle.size() == 1);
      REQUIRE(orbit->multipliers.size() == 2);
      CHECK(holds(orbit->multipliers, expected));
      CHECK(holds(orbit->multipliers, std::conj(expected)));
      // x of the oscillator at phase 0, about its place of rest.
      const double mass = 1.2, w = scene.force_frequency, stiff = 1 - mass * w * w, loss = 2 * 0.07 * w;
      CHECK(orbit->scene.x0 ==
            doctest::Approx(-0.2 * 1.5 - 0.3 * loss / (stiff * stiff + loss * loss)).epsilon(1e-12));
    }
  }
  SUBCASE("its exponents") {
    for (const Engine& engine : rigid_and_compliant) {
      CAPTURE(name_of(engine));
      const LyapunovExponents found = lyapunov_exponents(scene, engine, 200, 10);
      const double rate = -0.07 / 1.2;
      REQUIRE(found.exponents.size() == 3);
      // Of y, which acts on nothing, and of x and x'.
      CHECK(*std::ranges::max_element(found.exponents) == doctest::Approx(0).scale(1).epsilon(1e-12));
      CHECK(std::accumulate(found.exponents.begin(), found.exponents.end(), 0.0) ==
            doctest::Approx(2 * rate).epsilon(1e-12));
    }
  }
}

TEST_CASE("multipliers with friction and weight are those of differences of plain runs") {
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    int in_walls = 0;
    int stops = 0, compared = 0, jumps = 0, by_weight = 0, held = 0;
    for (const auto& [friction, static_friction] :
         std::vector<std::array<double, 2>>{{0.15, 0}, {0.15, 0.25}, {0.5, 0}, {0.5, 0.7}}) {
      for (const double weight : {0.0, 0.06, 0.3}) {
        if (weight > 0.1 && has_rigid_walls(engine)) continue;  // as much as holds a mass in its floor
        for (const double frequency : {0.8, 0.95, 1.1}) {
          Scene scene = sliding(static_friction, weight, friction);
          scene.force_frequency = frequency;
          CAPTURE(scene.damper().friction);
          CAPTURE(scene.damper().static_friction);
          CAPTURE(scene.weight);
          CAPTURE(scene.force_frequency);
          const SteadyState steady = ForcedScene(scene, engine).settle(release_of(scene), {});
          if (!steady.period) continue;
          const auto orbit = find_orbit(scene, engine, int(*steady.period), steady.state);
          REQUIRE(orbit);
          CHECK(orbit->residuals.back() < 1e-10);
          CHECK(orbit->symmetric == (steady.symmetric && weight == 0));
          // On its walls, and where friction holds it, or nearly so, changes of y and y' have one side.
          const SceneState start = release_of(orbit->scene);
          if (std::fabs(start.dampers[0].w) < 1e-4) continue;
          const PoincareMap map(scene, engine, 2 * orbit->periods);
          const PoincareImage image = *map(start);
          Matrix differences(4, Vector(4));
          for (std::size_t j = 0; j < 4; ++j) {
            const double h = 1e-6;
            StateVector up = vector_of(start), down = up;
            up[j] += h, down[j] -= h;
            const StateVector a = vector_of(map(state_of(up))->state),
                              b = vector_of(map(state_of(down))->state);
            for (std::size_t i = 0; i < 4; ++i) {
              differences[i][j] = (a[i] - b[i]) / (2 * h);
              CHECK(image.by_state[i][j] == doctest::Approx(differences[i][j]).epsilon(2e-6).scale(1));
            }
          }
          const Multipliers expected = multipliers_of(differences);
          CHECK(orbit->multipliers[0].modulus() == doctest::Approx(expected[0].modulus()).epsilon(1e-5));
          ++compared;
          const RecordedRun run = ForcedScene(scene, engine).record(start, map.duration());
          held += int(std::ranges::count(run.chain.settled, true, &MotionChain::Settled::held));
          in_walls += std::ranges::any_of(
              run.chain.settled, [](const MotionChain::Settled& each) { return each.held && each.pushes; });
          stops += image.stop_margin.has_value();
          jumps += image.stop_margin.has_value() && static_friction > 0;
          by_weight += weight > 0;
        }
      }
    }
    CHECK(compared >= 12);
    CHECK(stops >= 12);
    CHECK(jumps >= 6);
    CHECK(by_weight >= 6);
    CHECK(held >= 10);
    CHECK((in_walls >= 4) == !has_rigid_walls(engine));
  }
}

// By how much the derivatives of a map by the state, and by the force's frequency and amplitude, differ from
// differences of step h at most. one_sided: y of the first damper is on a wall, so that it is moved inwards
// only.
double error_of(const PoincareImage& image, const Scene& scene, const Engine& engine, int half_periods,
                const SceneState& at, double h, bool one_sided = false) {
  const std::size_t n = dimensions_of(scene);
  double worst = 0;
  for (std::size_t j = 0; j < n + 2; ++j) {
    const auto moved = [&](double by) {
      Scene there = scene;
      StateVector s = vector_of(at);
      (j < n ? s[j] : j == n ? there.force_frequency : there.force_amplitude) += by;
      return vector_of(PoincareMap(there, engine, half_periods)(state_of(s))->state);
    };
    const bool inwards = one_sided && j == index_of_y(0);
    const double step = inwards && at.dampers[0].y > 0 ? -h : h;
    const StateVector up = moved(step), other = moved(inwards ? 2 * step : -step),
                      here = vector_of(image.state);
    for (std::size_t i = 0; i < n; ++i) {
      const double difference =
          inwards ? (4 * up[i] - other[i] - 3 * here[i]) / (2 * step) : (up[i] - other[i]) / (2 * step);
      const double derivative = j < n    ? image.by_state[i][j]
                                : j == n ? image.by_frequency[i]
                                         : image.by_amplitude[i];
      worst = std::max(worst, std::fabs(difference - derivative));
    }
  }
  return worst;
}
PoincareImage image_at(const Scene& scene, const Engine& engine, int half_periods, const SceneState& at) {
  return *PoincareMap(scene, engine, half_periods)(at, PoincareMap::Derivatives::by_state_and_parameters);
}

TEST_CASE("derivatives with drag are what central differences tend to, with the square of their step") {
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    int compared = 0, stopped = 0, held = 0, by_weight = 0, several = 0;
    for (const double drag : {0.02, 0.3, 2.0}) {
      for (const auto& [friction, static_friction] :
           std::vector<std::array<double, 2>>{{0, 0}, {0.1, 0}, {0.1, 0.2}}) {
        for (const double weight : {0.0, 0.06}) {
          for (const int dampers : {1, 2}) {
            // In much drag two chatter together at once: within any step their impacts change their order.
            if (drag > 1 && dampers > 1) continue;
            Scene scene = sliding(static_friction, weight, friction);
            scene.damper().drag = drag;
            scene.force_amplitude = 0.6;
            if (dampers > 1) {
              SceneDamper other = scene.damper();
              other.mass_ratio = 0.07;
              other.clearance = 0.6;
              other.drag = friction > 0 ? 0 : 0.5 * drag;
              // Let go while the first slides in its fluid.
              if (static_friction > 0)
                other.clearance = 100, other.y0 = 50, other.friction = 3, other.static_friction = 4;
              scene.dampers.push_back(other);
            }
            CAPTURE(drag);
            CAPTURE(scene.damper().friction);
            CAPTURE(scene.damper().static_friction);
            CAPTURE(weight);
            CAPTURE(dampers);
            const int half_periods = weight > 0 ? 2 : 1;
            const PoincareMap map(scene, engine, half_periods);
            SceneState at = release_of(scene);
            for (int n = 0; n < 31; ++n) at = map(at)->state;
            const PoincareImage image = image_at(scene, engine, half_periods, at);
            REQUIRE_FALSE(image.one_sided);
            if (has_rigid_walls(engine)) {
              double before = error_of(image, scene, engine, half_periods, at, 4e-4);
              for (const double h : {2e-4, 1e-4}) {
                const double error = error_of(image, scene, engine, half_periods, at, h);
                CHECK(before / error == doctest::Approx(4).epsilon(1e-3));
                before = error;
              }
              CHECK(before < 1e-5);
            } else {
              // Where a stiff wall rings down, larger steps change the order of events.
              CHECK(error_of(image, scene, engine, half_periods, at, 1e-6) < 1e-6);
            }
            ++compared;
            const auto settled = ForcedScene(scene, engine).record(at, map.duration()).chain.settled;
            stopped += image.stop_margin.has_value();
            held += std::ranges::any_of(settled, &MotionChain::Settled::held);
            by_weight += weight > 0;
            several += dampers > 1;
          }
        }
      }
    }
    CHECK(compared == 30);
    CHECK(stopped == 20);
    CHECK(held >= 15);
    CHECK(by_weight == 15);
    CHECK(several == 12);
  }
}

TEST_CASE("a run may begin with an impact, and its derivative is that of the impact and what follows") {
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    for (const double friction : {0.0, 0.1}) {
      for (const double drag : {0.0, 0.2}) {
        for (const double weight : {0.0, 0.06}) {
          for (const double wall : {0.0, 1.0}) {
            CAPTURE(friction);
            CAPTURE(drag);
            CAPTURE(weight);
            CAPTURE(wall);
            Scene scene = sliding(0, weight, friction);
            scene.damper().drag = drag;
            const int half_periods = weight > 0 ? 2 : 1;
            SceneState at = release_of(scene);
            at.dampers[0] = {wall, wall > 0 ? 0.8 : -0.8};
            const PoincareImage image = image_at(scene, engine, half_periods, at);
            REQUIRE(!image.impacts.empty());
            CHECK(image.impacts.front().time == 0);
            CHECK_FALSE(image.one_sided);
            const double coarse = error_of(image, scene, engine, half_periods, at, 4e-5, true),
                         fine = error_of(image, scene, engine, half_periods, at, 2e-5, true);
            CHECK(coarse / fine == doctest::Approx(4).epsilon(0.02));
          }
        }
      }
    }
  }
}

TEST_CASE("volumes contract by the damper, drag and impacts, so multipliers and exponents add up to these") {
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    Scene scene = sliding(0, 0, 0);
    scene.force_amplitude = 0.6;
    scene.damper().restitution = 0.8;
    scene.damper().drag = 0.15;
    scene.dampers.push_back({.mass_ratio = 0.07, .restitution = 0.9, .clearance = 0.8, .y0 = 0.2});
    for (const double drag : {0.0, 0.4}) {
      CAPTURE(drag);
      scene.dampers[1].drag = drag;
      const PoincareMap map(scene, engine, 2);
      SceneState at = release_of(scene);
      double expected = 0;
      const int periods = 20;
      for (int n = 0; n < periods; ++n) {
        const PoincareImage image = *map(at);
        REQUIRE(image.sticking == 0);
        double logarithm = -(2 * scene.damping_ratio + 1.1 * 0.15 + 1.07 * drag) * map.duration();
        if (has_rigid_walls(engine)) {
          for (const OrbitImpact& each : image.impacts)
            logarithm += 2 * std::log(each.damper == 0 ? 0.8 : 0.9);
        } else {
          const RecordedRun run = ForcedScene(scene, engine).record(at, map.duration());
          for (const MotionChain::Contact& each : run.chain.contacts) {
            const SceneDamper& its = scene.dampers[std::size_t(each.damper)];
            const double damping = 2 * omega_m(its) * zeta_m<double>(its, Calibration::fixed_wall);
            logarithm -= (1 + its.mass_ratio) * damping * (each.end - each.begin);
          }
        }
        double found = 0;
        const Multipliers all = multipliers_of(image.by_state);
        for (const Multiplier& each : all) found += std::log(each.modulus());
        // The least multiplier has the rounding errors of the largest, and the matrix is not normal.
        const double spread = all.front().modulus() / all.back().modulus();
        CHECK(std::fabs(found - logarithm) < 1e-12 * spread);
        expected += logarithm;
        at = image.state;
      }
      const LyapunovExponents exponents = lyapunov_exponents(scene, engine, periods, 0);
      REQUIRE(exponents.exponents.size() == 6);
      CHECK(std::accumulate(exponents.exponents.begin(), exponents.exponents.end(), 0.0) ==
            doctest::Approx(expected / (periods * map.duration())).epsilon(1e-12));
    }
  }
}

TEST_CASE("masses that stop together and are held, and are let go together, have a derivative") {
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    Scene scene{.damping_ratio = 0.05, .x0 = 0.3, .force_amplitude = 0.2, .force_frequency = 0.8};
    for (const double static_friction : {0.0, 0.3}) {
      CAPTURE(static_friction);
      scene.dampers.assign(2, {.mass_ratio = 0.1,
                               .clearance = 100,
                               .y0 = 50,
                               .friction = 0.25,
                               .static_friction = static_friction});
      const PoincareMap map(scene, engine, 4);
      const SceneState start = release_of(scene);
      const PoincareImage image = *map(start);
      const auto settled = ForcedScene(scene, engine).record(start, map.duration()).chain.settled;
      CHECK(std::ranges::count(settled, true, &MotionChain::Settled::held) >= 6);
      CHECK(image.stop_margin);
      CHECK_FALSE(image.one_sided);
      for (std::size_t j = 0; j < 2; ++j) {
        const double h = 1e-6;
        StateVector up = vector_of(start), down = up;
        up[j] += h, down[j] -= h;
        const StateVector a = vector_of(map(state_of(up))->state), b = vector_of(map(state_of(down))->state);
        for (std::size_t i = 0; i < a.size(); ++i)
          CHECK(image.by_state[i][j] == doctest::Approx((a[i] - b[i]) / (2 * h)).epsilon(1e-6).scale(1));
      }
    }
  }
}

TEST_CASE("a touch that passes phase 0 is crossed to first order, beside a mass that friction holds") {
  Scene scene = sliding(0, 0.06, 0.1);
  scene.damper().drag = 0.7;
  scene.dampers.push_back(scene.damper());
  scene.dampers[1].mass_ratio = 0.3, scene.dampers[1].friction = 100;
  const double x = 0.3, v = 0.2, w = -0.9, nu = 0.1, mass = 1.3;
  const double in_cavity = 0.7 * w - 0.1, a = (-2 * 0.05 * v - x + nu * in_cavity - 0.3 * 0.06) / mass;
  double before = 0;
  for (const double time : {1e-5, 5e-6}) {
    // In the wall, as if there were none.
    const StateVector at{x, v, 0, w, 0.5, 0};
    const StateVector rates{v, a, w, -(a + in_cavity + 0.06), 0, 0};
    StateVector beyond = at;
    for (std::size_t i = 0; i < beyond.size(); ++i) beyond[i] += rates[i] * time;
    const auto crossed = corrector::across_phase_0(scene, Exact{}, at, beyond);
    REQUIRE(crossed);
    const RecordedRun run = ForcedScene(scene, Exact{}).record(state_of(at), time);
    const StateVector expected = vector_of(run.end);
    double error = 0;
    for (std::size_t i = 0; i < 6; ++i) error = std::max(error, std::fabs(crossed->state[i] - expected[i]));
    if (before > 0) CHECK(before / error == doctest::Approx(4).epsilon(0.1));
    before = error;
  }
  // Held by what is just enough after the touch.
  const double c = 2 * omega_m(scene.damper()) * zeta_m<double>(scene.damper(), Calibration::fixed_wall);
  const double needs = std::fabs(a + nu * c * w / mass + 0.06);
  scene.dampers[1].friction = 5, scene.dampers[1].static_friction = needs * (1 + 1e-6);
  const PoincareImage image = *PoincareMap(scene, Exact{}, 2)(state_of({x, v, 0, w, 0.5, 0}));
  REQUIRE(image.stop_margin);
  CHECK(*image.stop_margin == doctest::Approx(1e-6 * needs).epsilon(1e-6));
}

TEST_CASE("an impact that passes phase 0 is crossed to first order, with friction, weight and drag") {
  Scene scene = sliding(0, 0.06, 0.1);
  scene.damper().drag = 0.7;
  scene.dampers.push_back(scene.damper());
  scene.dampers[1].drag = 1.5;  // another: the impact of a mass and its own drag do not care who is first
  const double x = 0.3, v = 0.2, w = -0.9, d = 0.7, phi = 0.1, gamma = 0.06, nu = 0.1, other = 0.4;
  const double in_1 = d * w - phi, in_2 = 1.5 * other + phi, a = -2 * 0.05 * v - x + nu * (in_1 + in_2);
  double before = 0;
  for (const double time : {2e-3, 1e-3}) {
    // Beyond the wall, as if there were none.
    const StateVector at{x, v, 0, w, 0.5, other};
    const StateVector rates{v, a, w, -(a + in_1 + gamma), other, -(a + in_2 + gamma)};
    StateVector beyond = at;
    for (std::size_t i = 0; i < beyond.size(); ++i) beyond[i] += rates[i] * time;
    const auto crossed = corrector::across_phase_0(scene, Restitution{}, at, beyond);
    REQUIRE(crossed);
    const RecordedRun run = ForcedScene(scene, Restitution{}).record(state_of(at), time);
    const StateVector expected = vector_of(run.end);
    double error = 0;
    for (std::size_t i = 0; i < 6; ++i) error = std::max(error, std::fabs(crossed->state[i] - expected[i]));
    if (before > 0) CHECK(before / error == doctest::Approx(4).epsilon(0.02));
    before = error;
  }
}

TEST_CASE("a release that grazes the edge of its band is told by its margin") {
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    Scene scene = locked();
    const PoincareMap settles(scene, engine, 2);
    SceneState at = release_of(scene);
    for (int n = 0; n < 400; ++n) at = settles(at)->state;
    at.dampers[0].w = 0;
    const double w = scene.force_frequency, stiff = 1 - 1.2 * w * w, loss = 2 * scene.damping_ratio * w;
    const double most = w * w * scene.force_amplitude / std::hypot(stiff, loss);  // |x''|
    scene.damper().friction = 0.1;
    scene.damper().wall_stiffness = 2;
    for (const double overlap : {0.0, 0.001}) {
      if (overlap > 0 && has_rigid_walls(engine)) continue;
      if (overlap > 0) at.dampers[0].y = -overlap;
      const double pushed = 2 / scene.damper().mass_ratio * overlap;  // by the wall
      for (const double beyond : {1e-1, 1e-3, 1e-5}) {
        scene.damper().static_friction = pushed + most * (1 - beyond);
        const PoincareImage image = *PoincareMap(scene, engine, 1)(at);
        REQUIRE(image.stop_margin);
        CHECK(*image.stop_margin ==
              doctest::Approx(1.2 * w * most * std::sqrt(beyond * (2 - beyond))).epsilon(1e-6));
      }
      scene.damper().static_friction = pushed + most * (1 + 1e-5);
      CHECK_FALSE(PoincareMap(scene, engine, 1)(at)->stop_margin);
    }
  }
}

TEST_CASE("a stop in a compliant wall that nearly fails to hold the mass is told by its margin") {
  Scene scene{
      .damping_ratio = 0.05,
      .x0 = 0.1,
      .force_amplitude = 0.2,
      .force_frequency = 0.8,
      .weight = 0.04,
      .dampers = {{.mass_ratio = 0.2, .wall_stiffness = 2, .y0 = -0.02, .w0 = -0.1, .friction = 0.1}}};
  const PoincareMap map(scene, Exact{}, 2);
  const RecordedRun run = ForcedScene(scene, Exact{}).record(release_of(scene), map.duration());
  const MotionChain::Settled& stop = run.chain.settled.at(1);
  REQUIRE(stop.place.w == 0);
  REQUIRE(stop.pushes);
  const MotionChain::Motion& before = run.chain.motions.at(stop.motions - 1);
  const double f = 0.2 * std::sin(0.8 * (before.begin + before.duration));
  const double held = (f - 2 * 0.05 * before.v - before.x - 0.2 * 0.04) / 1.2;  // x''
  const double needs = std::fabs(held + 0.04 + 10 * stop.place.y);
  REQUIRE(needs > 0.1);
  for (const double off : {1e-6, -1e-6}) {
    scene.damper().static_friction = needs * (1 + off);
    const PoincareImage image = *PoincareMap(scene, Exact{}, 2)(release_of(scene));
    REQUIRE(image.stop_margin);
    CHECK(*image.stop_margin == doctest::Approx(1e-6 * needs).epsilon(1e-6));
  }
}

TEST_CASE("a branch of orbits with friction is followed, with the amplitudes of steady states") {
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    const bool rigid = has_rigid_walls(engine);
    // Static friction makes the map jump, which ends a branch.
    Scene scene = sliding(rigid ? 0.25 : 0, 0.06);
    scene.damper().wall_stiffness = 50;
    const auto found = find_branches(scene, engine, {Parameter::force_frequency, 0.95, rigid ? 1.05 : 0.96},
                                     {}, {release_of(scene)}, {}, no_progress);
    REQUIRE(!found.branches.empty());
    const FollowedBranch& followed = found.branches[0];
    for (const Orbit& orbit : followed.branch.orbits) CHECK_FALSE(orbit.symmetric);
    if (!rigid) CHECK(followed.branch.end == BranchEnd::range);
    const Orbit& last = followed.branch.orbits.back();
    CHECK(last.stable());
    const SteadyState steady = ForcedScene(last.scene, engine).settle(release_of(last.scene), {});
    REQUIRE(steady.means);
    CHECK(steady.means->amplitude == doctest::Approx(followed.amplitudes.back()).epsilon(1e-9));
  }
}

TEST_CASE("the nearest miss with friction, weight or drag is that of densely sampled runs") {
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    int turned = 0, stopped = 0, in_fluid = 0;
    for (const std::array<double, 3>& components : std::vector<std::array<double, 3>>{{0, 0.06, 0},
                                                                                      {0, 0.2, 0},
                                                                                      {0.15, 0, 0},
                                                                                      {0.15, 0.06, 0},
                                                                                      {0.5, 0, 0},
                                                                                      {0.5, 0.2, 0},
                                                                                      {0, 0, 0.3},
                                                                                      {0, 0.06, 0.8},
                                                                                      {0.15, 0.06, 0.3}}) {
      const double friction = components[0], weight = components[1], drag = components[2];
      for (const double frequency : {0.6, 0.8, 0.95, 1.1, 1.4}) {
        Scene scene = sliding(friction > 0 ? 0.6 : 0, weight, friction);
        scene.force_frequency = frequency;
        scene.damper().drag = drag;
        CAPTURE(friction);
        CAPTURE(weight);
        CAPTURE(drag);
        CAPTURE(frequency);
        const PoincareMap map(scene, engine, 4);
        const PoincareImage image = *map(release_of(scene));
        scene.until_time = map.duration();
        const Run run = simulate(scene, engine,
                                 {.half_cycles = false,
                                  .impacts = true,
                                  .contacts = true,
                                  .history = {{0, map.duration(), 100'001}}});
        const auto& [y, w] = run.history->dampers[0];
        const std::vector<double>& time = run.history->time;
        double nearest = std::numeric_limits<double>::infinity();
        bool by_stop = false;
        for (std::size_t n = 1; n < y.size(); ++n) {
          const auto between = [&](double event) { return event > time[n - 1] && event <= time[n]; };
          if (std::ranges::any_of(run.impacts->time, between) || y[n] <= 0 || y[n] >= 1) continue;
          if (!(w[n] * w[n - 1] < 0 || (w[n] == 0 && w[n - 1] != 0))) continue;
          const double gap = w[n - 1] > 0 ? 1 - y[n] : y[n];
          if (!(gap < nearest)) continue;
          nearest = gap;
          by_stop = w[n] == 0;
        }
        REQUIRE(image.nearest_miss.has_value() == std::isfinite(nearest));
        if (!image.nearest_miss) continue;
        CHECK(*image.nearest_miss == doctest::Approx(nearest).epsilon(1e-6));
        ++turned;
        stopped += by_stop;
        in_fluid += drag > 0 && !by_stop;
      }
    }
    CHECK(turned >= 12);
    CHECK(stopped >= 4);
    CHECK(in_fluid >= 4);
  }
}

TEST_CASE("the force feeds what damper, impacts, friction and drag take, with every engine that has them") {
  Scene scene = sliding(0.25, 0.06);
  scene.damper().drag = 0.02;
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    const SteadyState steady = ForcedScene(scene, engine).settle(release_of(scene), {});
    REQUIRE(steady.period);
    CHECK_FALSE(steady.symmetric);
    CHECK(steady.means->power ==
          doctest::Approx(steady.means->viscous_power + steady.means->impact_power).epsilon(1e-8));
  }
}

TEST_CASE("a scene with weight has no map of half a period, and no symmetric orbit") {
  const Scene scene = sliding(0, 0.06);
  CHECK_THROWS_AS(PoincareMap(scene, Restitution{}, 1), InvalidArguments);
  CHECK_THROWS_AS(find_orbit(scene, Restitution{}, 1, release_of(scene), {.symmetric = true}),
                  InvalidArguments);
}

TEST_CASE("the stiffer the wall, the nearer the orbit and its multipliers to those of rigid walls") {
  for (const std::array<double, 4>& components :
       std::vector<std::array<double, 4>>{{0.15, 0, 0, 0}, {0.15, 0.25, 0.06, 0}, {0.1, 0, 0.06, 0.2}}) {
    const double friction = components[0], static_friction = components[1], weight = components[2],
                 drag = components[3];
    Scene scene = sliding(static_friction, weight, friction);
    scene.damper().drag = drag;
    CAPTURE(friction);
    CAPTURE(static_friction);
    const SteadyState steady = ForcedScene(scene, Restitution{}).settle(release_of(scene), {});
    REQUIRE(steady.period);
    const auto rigid = find_orbit(scene, Restitution{}, int(*steady.period), steady.state);
    REQUIRE(rigid);
    double before = 0;
    for (const double stiffness : {1e8, 1e10}) {
      scene.damper().wall_stiffness = stiffness;
      const auto stiff = find_orbit(scene, Exact{.calibration = Calibration::two_body}, rigid->periods,
                                    release_of(rigid->scene));
      REQUIRE(stiff);
      CHECK(stiff->stop_margin.has_value() == rigid->stop_margin.has_value());
      double error = distance(release_of(stiff->scene), release_of(rigid->scene));
      for (std::size_t i = 0; i < 4; ++i)
        error = std::max({error, std::fabs(stiff->multipliers[i].re - rigid->multipliers[i].re),
                          std::fabs(stiff->multipliers[i].im - rigid->multipliers[i].im)});
      // As the duration of a contact.
      if (before > 0) CHECK(before / error == doctest::Approx(10).epsilon(0.1));
      before = error;
    }
  }
}

TEST_CASE("equal dampers that slide back at one instant have no derivative, and that is said") {
  Scene scene = sliding(0, 0.06, 0.05);
  scene.dampers.push_back(scene.damper());
  for (const Engine& engine : rigid_and_compliant) {
    CAPTURE(name_of(engine));
    const SteadyState steady = ForcedScene(scene, engine).settle(release_of(scene), {});
    REQUIRE(steady.period);
    const auto orbit = find_orbit(scene, engine, int(*steady.period), steady.state);
    REQUIRE_FALSE(orbit);
    CHECK(orbit.failure().end == OrbitEnd::no_derivative);
    CHECK(lyapunov_exponents(scene, engine, 10, 0).one_sided);
  }
}

TEST_CASE("a mass on its compliant floor: what its wall, drag and friction leave of a volume") {
  Scene scene = locked();
  scene.weight = 2, scene.damper().y0 = -1e-3, scene.force_amplitude = 0.1;
  scene.damper().wall_stiffness = 50;
  const SceneDamper& damper = scene.damper();
  const double nu = damper.mass_ratio, period = 2 * std::numbers::pi / scene.force_frequency;
  const double c = 2 * omega_m(damper) * zeta_m<double>(damper, Calibration::fixed_wall);
  for (const double drag : {0.0, 0.4}) {
    for (const double friction : {0.0, 0.02, 100.0}) {
      CAPTURE(drag);
      CAPTURE(friction);
      scene.damper().friction = friction, scene.damper().drag = drag;
      const SteadyState steady = ForcedScene(scene, Exact{}).settle(release_of(scene), {});
      REQUIRE(steady.period);
      const auto orbit = find_orbit(scene, Exact{}, int(*steady.period), steady.state);
      REQUIRE(orbit);
      CHECK(orbit->impacts.empty());
      const auto settled =
          ForcedScene(orbit->scene, Exact{}).record(release_of(orbit->scene), period).chain.settled;
      CHECK(std::ranges::all_of(settled, &MotionChain::Settled::pushes));
      double volume = 0;
      for (const Multiplier& each : orbit->multipliers) volume += std::log(each.modulus());
      if (friction == 0) {
        const double expected = -(2 * scene.damping_ratio + (1 + nu) * (c + drag)) * period;
        CHECK(volume == doctest::Approx(expected).epsilon(1e-6));
        CHECK(lyapunov_exponents(scene, Exact{}, 20, 0).exponents[3] < -1);
      } else if (friction < 1) {  // it slides and is held in each period, which takes one dimension
        CHECK(std::ranges::count(settled, true, &MotionChain::Settled::held) >= 2);
        CHECK(std::ranges::count(settled, false, &MotionChain::Settled::held) >= 2);
        CHECK(orbit->multipliers.back().modulus() < 1e-12);
        CHECK(lyapunov_exponents(scene, Exact{}, 20, 10).exponents.size() == 3);
      } else {  // an oscillator of the mass 1 + nu
        CHECK(orbit->idle.size() == 1);
        CHECK(volume == doctest::Approx(-2 * scene.damping_ratio / (1 + nu) * period).epsilon(1e-12));
      }
    }
  }
}
