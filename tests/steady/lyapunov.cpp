#include "impact_damper/orbits/lyapunov.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "impact_damper/simulate.hpp"
#include "steady_helpers.hpp"

using namespace impact_damper;

namespace {

Scene forced(double nu, double zeta, double frequency, double amplitude) {
  Scene scene = forced_scene(nu, zeta, frequency, amplitude);
  scene.x0 = 0.3;
  scene.damper().y0 = 0.4;
  scene.damper().w0 = 0.2;
  return scene;
}

// Minus the mean divergence over periods that are each begun at phase 0, as the exponents' are.
double mean_loss(const Scene& scene, const Engine& engine, int periods) {
  const PoincareMap map(scene, engine, 2);
  SceneState s = release_of(scene);
  double loss = 0;
  for (int i = 0; i < periods; ++i) {
    const Run run = simulate(released_from(map.scene(), s), engine,
                             {.half_cycles = false, .impacts = true, .contacts = true});
    loss += shrinkage(scene, engine, run, map.duration());
    s = map(s)->state;
  }
  return loss / (periods * map.duration());
}

double sum_of(const std::vector<double>& all) { return std::accumulate(all.begin(), all.end(), 0.0); }

// The stable orbit beside the one of two impacts, from which rounding alone leads away late or early.
Orbit stable_orbit(const Scene& scene, const Engine& engine) {
  SceneState s = two_impact_state(scene);
  s.x += 1e-6;
  return *find_orbit(scene, engine, 1, state_after(scene, engine, s, 500));
}

}  // namespace

TEST_CASE("the exponents add up to the mean divergence") {
  const Scene chaotic = forced(0.05, 0.01, 0.9, 0.3), regular = forced(0.02, 0.05, 0.9, 0.1);
  Scene soft = chaotic;
  soft.damper().wall_stiffness = 20;
  const Scene sustained = forced(0.1, 0.02, 0.95, 0.3);  // contacts that damp the fast mode by exp(-200)
  int compared = 0;
  for (const Scene& scene : {chaotic, regular, soft, sustained}) {
    for (const Engine& engine : rigid_and_compliant) {
      const int periods = 60;
      const LyapunovExponents found = lyapunov_exponents(scene, engine, periods);
      REQUIRE(found.stop_reason == StopReason::time);
      CHECK(found.periods == periods);
      if (found.exponents.size() < 4) continue;
      ++compared;
      CHECK(sum_of(found.exponents) == doctest::Approx(-mean_loss(scene, engine, periods)).epsilon(1e-9));
    }
  }
  CHECK(compared >= 6);
}

TEST_CASE("on a stable orbit they are the logarithms of the multipliers divided by the period") {
  const Scene scene = forced(0.02, 0.05, 0.9, 0.1);
  for (const Engine& engine : rigid_and_compliant) {
    const Orbit orbit = stable_orbit(scene, engine);
    REQUIRE(orbit.stable());
    const double period = *orbit.scene.until_time;
    const int periods = 400;
    const std::vector<double> found = lyapunov_exponents(orbit.scene, engine, periods, 400).exponents;
    REQUIRE(found.size() == 4);
    // Of a conjugate pair each period's stretch varies as the pair turns; so it is known to one part in
    // `periods`, the pair's sum to all digits.
    for (std::size_t i = 0; i < 4; ++i) {
      const double expected = std::log(orbit.multipliers[i].modulus()) / period;
      if (orbit.multipliers[i].im > 0) {
        CHECK(found[i] + found[i + 1] == doctest::Approx(2 * expected).epsilon(1e-9));
        CHECK(found[i] == doctest::Approx(expected).epsilon(0.03));
      } else if (orbit.multipliers[i].im == 0) {
        CHECK(found[i] == doctest::Approx(expected).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("a chaotic run's largest exponent is the rate at which two neighbours part") {
  const Scene scene = forced(0.05, 0.01, 0.9, 0.3);
  const int periods = 1500;
  const LyapunovExponents found = lyapunov_exponents(scene, Restitution{}, periods);
  REQUIRE(found.stop_reason == StopReason::time);
  const PoincareMap map(scene, Restitution{}, 2);
  const double distance = 1e-9;
  SceneState one = release_of(scene), other = one;
  other.x += distance;
  double stretch = 0;
  for (int i = 0; i < periods; ++i) {
    one = map(one)->state;
    other = map(other)->state;
    const StateVector a = vector_of(one), b = vector_of(other);
    StateVector c(4);
    double size = 0;
    for (std::size_t k = 0; k < 4; ++k) size += (b[k] - a[k]) * (b[k] - a[k]);
    size = std::sqrt(size);
    stretch += std::log(size / distance);
    for (std::size_t k = 0; k < 4; ++k) c[k] = a[k] + (b[k] - a[k]) * (distance / size);
    c[2] = std::min(1.0, std::max(0.0, c[2]));
    other = state_of(c);
  }
  const double expected = stretch / (periods * map.duration());
  MESSAGE("largest exponent ", found.exponents[0], ", of two neighbours ", expected);
  CHECK(found.exponents[0] == doctest::Approx(expected).epsilon(0.02));
  CHECK(found.exponents[0] > 0.01);
}

TEST_CASE("the standard errors are how much the exponents of independent runs scatter") {
  Scene scene = forced(0.05, 0.01, 0.9, 0.3);
  constexpr int runs = 24;
  double mean = 0, squares = 0, told = 0;
  std::vector<double> all;
  for (int i = 0; i < runs; ++i) {
    scene.x0 = 0.3 + 0.01 * i;
    const LyapunovExponents found = lyapunov_exponents(scene, Restitution{}, 1005, 50);
    REQUIRE(found.standard_errors.size() == found.exponents.size());
    all.push_back(found.exponents[0]);
    mean += found.exponents[0] / runs;
    told += found.standard_errors[0] / runs;
  }
  for (const double one : all) squares += (one - mean) * (one - mean);
  const double scatter = std::sqrt(squares / (runs - 1));
  MESSAGE("scatter ", scatter, ", standard error ", told);
  CHECK(told > 0.6 * scatter);
  CHECK(told < 1.6 * scatter);

  // Of what is the same in each period there is none; of nine periods it is not told.
  const Orbit orbit = stable_orbit(forced(0.02, 0.05, 0.9, 0.1), Restitution{});
  const LyapunovExponents regular = lyapunov_exponents(orbit.scene, Restitution{}, 100, 400);
  double sum_of_errors = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (orbit.multipliers[i].im == 0) sum_of_errors += regular.standard_errors[i];
  CHECK(sum_of_errors < 1e-9);
  CHECK(lyapunov_exponents(orbit.scene, Restitution{}, 9).standard_errors.empty());

  std::int64_t calls = 0;
  lyapunov_exponents(orbit.scene, Restitution{}, 12, 3, [&](std::int64_t done) { CHECK(done == ++calls); });
  CHECK(calls == 15);
}

TEST_CASE("sticking leaves two exponents") {
  const Scene from = forced(0.1, 0.02, 0.95, 0.3), scene = released_from(from, two_impact_state(from));
  const LyapunovExponents found = lyapunov_exponents(scene, Restitution{}, 100, 100);
  REQUIRE(found.exponents.size() == 2);
  CHECK(found.exponents[0] < 0);
  CHECK_THROWS_AS(lyapunov_exponents(scene, Restitution{}, 0), InvalidArguments);
  CHECK_THROWS_AS(lyapunov_exponents(scene, Cem{}, 1), InvalidArguments);
}
