// Loss factors between amplitudes, and of dampers that add: on decays whose loss is known, and on runs.
#include "impact_damper/analysis/damper_sets.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

constexpr double pi = std::numbers::pi;

// n peaks, pi apart, that fall as exp(-eta t/2) from `from`.
Run exponential_decay(int n, double from, double eta) {
  Run run;
  run.scene.damper().mass_ratio = 0.01;
  run.scene.until_amplitude = 0.01;
  HalfCycles& rows = run.half_cycles.emplace();
  for (int i = 0; i < n; ++i) {
    rows.peak_time.push_back(i * pi);
    rows.amplitude.push_back(from * std::exp(-eta * i * pi / 2));
  }
  return run;
}

double relative(double value, double to) { return std::abs(value / to - 1); }

Run decay_of(double mass_ratio, double x0, double until) {
  const Scene scene{
      .x0 = x0, .until_time = 1e5, .until_amplitude = until, .dampers = {{.mass_ratio = mass_ratio}}};
  return simulate(scene, Restitution{}, Record{});
}

}  // namespace

TEST_CASE("amplitudes descend in equal ratios and are at least as many as asked for") {
  const std::vector<double> edges = descending_amplitudes(9, 0.09, 12);
  REQUIRE(edges.size() == 25);
  CHECK(edges.front() == 9);
  CHECK(edges.back() == 0.09);
  for (std::size_t i = 1; i < edges.size(); ++i)
    CHECK(relative(edges[i - 1] / edges[i], std::pow(10, 1.0 / 12)) < 1e-14);
  CHECK(descending_amplitudes(2, 1, 1).size() == 2);
  CHECK(descending_amplitudes(20, 1, 1).size() == 3);
}

TEST_CASE("the loss factor between two amplitudes is exact on an exponential decay") {
  const Run run = exponential_decay(400, 3, 0.02);
  for (const double loss : losses_between(*run.half_cycles, {2.9, 2.89, 1, 0.3, 0.29}))
    CHECK(relative(loss, 0.02) < 1e-11);
}

TEST_CASE(
    "damper_sets: nothing is lost where the decay does not arrive, nothing is known above its beginning") {
  const Run run = exponential_decay(100, 3, 0.02);  // down to 0.13
  const std::vector<double> losses = losses_between(*run.half_cycles, {4, 3.5, 2, 1, 0.1, 0.05});
  CHECK(std::isnan(losses[0]));
  CHECK(std::isnan(losses[1]));
  CHECK(relative(losses[2], 0.02) < 1e-11);
  CHECK(losses[3] == 0);
  CHECK(losses[4] == 0);
}

TEST_CASE("a peak above one before it takes no time back") {
  Run run = exponential_decay(100, 3, 0.02);
  const std::vector<double> before = losses_between(*run.half_cycles, {2, 1});
  // Row 40 is at 0.86: above 1, where the decay has been.
  run.half_cycles->amplitude[40] = 1.5;
  CHECK(losses_between(*run.half_cycles, {2, 1}) == before);
}

TEST_CASE("several releases take the mean of their times") {
  const LossSpread losses =
      losses_between({exponential_decay(400, 3, 0.02), exponential_decay(400, 3, 0.06)}, {2, 1});
  CHECK(relative(losses.low[0], 0.02) < 1e-11);
  CHECK(relative(losses.high[0], 0.06) < 1e-11);
  CHECK(relative(losses.mean[0], 0.03) < 1e-11);  // half of 1/0.02 + 1/0.06 is 1/0.03
}

TEST_CASE("what a damper does alone is known from its release down to where its run ends") {
  const LossAlone alone = loss_alone({exponential_decay(700, 3, 0.02)});  // to 8e-10
  CHECK(relative(alone.at(2.5), 2) < 1e-11);
  CHECK(relative(alone.at(3), 2) < 0.05);  // from the release itself, whose peak is at its time
  CHECK(std::isnan(alone.at(3.1)));
  CHECK(relative(alone.at(0.0101), 2) < 1e-11);
  CHECK(alone.at(0.0099) == 0);
  Run several = exponential_decay(10, 3, 0.02);
  several.scene.dampers.resize(2);
  CHECK_THROWS_AS(loss_alone({several}), std::invalid_argument);
  CHECK_THROWS_AS(loss_alone({}), std::invalid_argument);
  several = exponential_decay(10, 3, 0.02);
  several.scene.until_amplitude.reset();
  CHECK_THROWS_AS(loss_alone({several}), std::invalid_argument);
}

TEST_CASE("dampers add by their masses, each at its amplitude in its own clearance") {
  // eta/nu = 1 above an amplitude of 1, 4 from there to 0.1, nothing below.
  LossAlone alone{{100, 1, 0.1}, {1, 4}};
  const std::vector<SceneDamper> dampers{{.mass_ratio = 0.01, .clearance = 1},
                                         {.mass_ratio = 0.03, .clearance = 10}};
  // Between 20 and 10: 0.01 + 0.03; to 5: 0.01 + 0.12; to 1: the same; to 0.9: 0.04; to 0.5: 0.04 alone
  const std::vector<double> sums = sum_of_losses(dampers, alone, {20, 10, 5, 1, 0.9, 0.5, 0.1, 0.09});
  const double wanted[] = {0.04, 0.13, 0.13, 0.04, 0.04, 0.04, 0};
  for (std::size_t i = 0; i < std::size(wanted); ++i)
    CHECK(sums[i] == doctest::Approx(wanted[i]).epsilon(1e-12));
  // Half of the way at each: the mean of the times, not of the losses.
  CHECK(sum_of_losses({{.mass_ratio = 0.01, .clearance = 1}}, alone, {2, 0.5})[0] ==
        doctest::Approx(1 / (0.5 / 0.01 + 0.5 / 0.04)));
  CHECK(std::isnan(sum_of_losses(dampers, alone, {2000, 200})[0]));
}

TEST_CASE("the sum of one damper is that damper, in clearances of its own") {
  const Run run = decay_of(0.02, 6, 0.05);
  const LossAlone alone = loss_alone({run});
  const std::vector<double> edges = descending_amplitudes(5, 0.1, 12);
  const std::vector<double> own = losses_between(*run.half_cycles, edges);
  std::vector<double> wide = edges;
  for (double& edge : wide) edge *= 7;
  const std::vector<double> sum = sum_of_losses({{.mass_ratio = 0.02}}, alone, edges),
                            scaled = sum_of_losses({{.mass_ratio = 0.02, .clearance = 7}}, alone, wide);
  for (std::size_t i = 0; i < own.size(); ++i) {
    CHECK(relative(sum[i], own[i]) < 0.06);  // the sum's steps do not end where the edges are
    CHECK(relative(scaled[i], sum[i]) < 1e-9);
  }
}

TEST_CASE("two dampers that strike regularly lose what each does alone") {
  // Clearances of 1 and 1.5 at amplitudes of 0.11 to 0.2: one impact in each half cycle of both (Figure 5).
  Scene scene{.x0 = 6, .until_time = 1e5, .until_amplitude = 0.1};
  scene.dampers = {{.mass_ratio = 0.002, .clearance = 1}, {.mass_ratio = 0.004, .clearance = 1.5}};
  const Run together = simulate(scene, Restitution{.budget = {.max_impacts = 1'000'000}}, Record{});
  const std::vector<double> edges{0.2, 0.15, 0.11};
  const std::vector<double> losses = losses_between(*together.half_cycles, edges);
  const std::vector<double> sum = sum_of_losses(scene.dampers, loss_alone({decay_of(0.003, 6, 0.05)}), edges);
  for (std::size_t i = 0; i < losses.size(); ++i) CHECK(relative(losses[i], sum[i]) < 0.03);
}
