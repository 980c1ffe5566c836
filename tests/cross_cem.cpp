// The component element method against the exact engine, which has no step: both run the same scene through
// code that shares nothing but the names of its numbers.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

// The largest differences between a run and the exact one.
struct Distance {
  double x = 0, amplitude = 0, energy = 0;
};

Record looked_at(double until) { return {.impacts = true, .energy = true, .history = {{0, until, 1001}}}; }

Distance distance(const Scene& scene, const Cem& options, const Run& exact) {
  const Run run = simulate(scene, options, looked_at(*scene.until_time));
  Distance far;
  REQUIRE(run.history->time == exact.history->time);
  for (std::size_t i = 0; i < run.history->x.size(); ++i) {
    far.x = std::max(far.x, std::abs(run.history->x[i] - exact.history->x[i]));
  }
  REQUIRE(run.half_cycles->amplitude.size() == exact.half_cycles->amplitude.size());
  for (std::size_t i = 0; i < run.half_cycles->amplitude.size(); ++i) {
    far.amplitude =
        std::max(far.amplitude, std::abs(run.half_cycles->amplitude[i] - exact.half_cycles->amplitude[i]));
  }
  far.energy = std::abs(run.energy->final.total() - exact.energy->final.total());
  return far;
}

double order(double coarse, double fine) { return std::log2(coarse / fine); }

void check_order(const Scene& scene, Cem options, double expected, double tolerance) {
  const Run exact = simulate(scene, Exact{}, looked_at(*scene.until_time));
  options.time_step = 2e-5;
  const Distance coarse = distance(scene, options, exact);
  options.time_step = 1e-5;
  const Distance fine = distance(scene, options, exact);
  CHECK(std::abs(order(coarse.x, fine.x) - expected) < tolerance);
  if (fine.amplitude > 0) CHECK(std::abs(order(coarse.amplitude, fine.amplitude) - expected) < tolerance);
  CHECK(std::abs(order(coarse.energy, fine.energy) - expected) < tolerance);
}

// Bounce-down and stuck, from an amplitude of 6 down to 5.3: no chaos, each stuck phase forgets the one
// before.
const Scene bounce_down{.until_time = 160};

const Scene forced{.damping_ratio = 0.02,
                   .x0 = 3,
                   .force_amplitude = 0.5,
                   .force_frequency = 0.9,
                   .until_time = 15,
                   .dampers = {{.mass_ratio = 0.1, .restitution = 0.3, .y0 = 0.4}}};
const Scene overlapping{.damping_ratio = 1.2,
                        .x0 = -4,
                        .until_time = 4,
                        .dampers = {{.restitution = 0.2, .y0 = -0.01, .w0 = 0.5}}};

}  // namespace

TEST_CASE(
    "with located events the component element method converges to the exact engine with second order") {
  for (const Scene& scene : {bounce_down, forced, overlapping}) check_order(scene, {.locate = true}, 2, 0.15);
}

TEST_CASE("with located events and the damper lagged it converges with first order") {
  for (const Scene& scene : {bounce_down, forced, overlapping}) {
    check_order(scene, {.damper = Damper::lagged, .locate = true}, 1, 0.15);
  }
}

TEST_CASE("unlocated it converges with first order, in the mean over neighbouring steps") {
  // The error with a single step depends on where in the step each touch and release happen to fall.
  const Scene& scene = bounce_down;
  const Run exact = simulate(scene, Exact{}, looked_at(*scene.until_time));
  for (Damper damper : {Damper::centred, Damper::lagged}) {
    const auto mean = [&](double h) {
      Distance sum;
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
    "with the default step a decay to 5.3 has the exact engine's amplitudes to three digits, located to "
    "five") {
  const Run exact = simulate(bounce_down, Exact{}, looked_at(160));
  CHECK(distance(bounce_down, {}, exact).amplitude < 2e-3);
  CHECK(distance(bounce_down, {.locate = true}, exact).amplitude < 5e-6);
}
