// Loss factors between amplitudes, and of dampers that add: on decays whose loss is known, and on runs.
#include "impact_damper/analysis/damper_sets.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "application/sweeps/damper_set_design.hpp"
#include "application/sweeps/sampling.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/base/errors.hpp"
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

// --- Designs of several dampers, held against plain searches and runs
// ----------------------------------------------------------------------------

namespace {

DamperSetQuestion question(std::int64_t count) {
  return {.release = 60, .upper = 54, .to = 2, .mass_ratio = 0.02, .count = count};
}
DamperSet answer(const DamperSetQuestion& asked, int threads = 2) {
  return best_damper_set(asked, threads, [](const std::string&) {});
}
double least(const std::vector<double>& values) { return *std::ranges::min_element(values); }

}  // namespace

TEST_CASE("a question out of range is rejected, with its fields") {
  DamperSetQuestion asked = question(3);
  CHECK(problems_of(asked).empty());
  asked.upper = 55, asked.to = 40, asked.mass_ratio = 0.3, asked.count = 41, asked.restitution = 0.95;
  asked.clearance_off = 0.6, asked.damping_ratio = -1;
  std::vector<std::string> fields;
  for (const Problem& problem : problems_of(asked)) fields.push_back(problem.field);
  CHECK(fields == std::vector<std::string>{"upper", "to", "mass_ratio", "count", "clearance_off",
                                           "restitution", "damping_ratio"});
  CHECK_THROWS_AS(answer(asked), InvalidArguments);
}

TEST_CASE("the dampers are those asked for, and what is said of them is a run's") {
  const DamperSetQuestion asked = question(4);
  const DamperSet set = answer(asked);
  REQUIRE(!set.dampers.empty());
  CHECK(set.dampers.size() <= 4);
  double mass = 0;
  for (const SceneDamper& damper : set.dampers) {
    mass += damper.mass_ratio;
    CHECK(damper.clearance <= 1.8 * asked.release);
    CHECK(damper.restitution == asked.restitution);
  }
  CHECK(mass == doctest::Approx(asked.mass_ratio).epsilon(2e-3));
  CHECK(set.edges.front() == asked.upper);
  CHECK(set.edges.back() == asked.to);
  const Restitution engine{.budget = {.max_impacts = 10'000'000}};
  // In millimetres instead of releases.
  Scene scene = scene_of_set(asked, set.dampers);
  scene.x0 = asked.release;
  scene.dampers = set.dampers;
  *scene.until_amplitude *= asked.release;
  const std::vector<double> losses =
      losses_between(*simulate(scene, engine, Record{}).half_cycles, set.edges);
  // Before chaos tells two lengths apart.
  for (std::size_t i = 0; i < 4; ++i) CHECK(losses[i] == doctest::Approx(set.run.mean[i]).epsilon(1e-3));
  for (std::size_t i = 0; i < losses.size(); ++i) {
    CHECK(set.run.low[i] <= set.run.mean[i]);
    CHECK(set.run.mean[i] <= set.run.high[i]);
    CHECK(set.worst[i] <= set.expected[i] * (1 + 1e-12));
  }
}

TEST_CASE("no shares have a larger least than those of the linear programme") {
  for (std::uint32_t problem = 0; problem < 20; ++problem) {
    std::vector<std::vector<double>> columns(3);
    for (std::uint32_t j = 0; j < 3; ++j)
      for (std::int64_t i = 0; i < 7; ++i)
        columns[j].push_back(uniform_draw({problem, j, i}) + (std::int64_t(j) == i % 3 ? 1 : 0));
    const auto least_of = [&](const std::vector<double>& share) {
      double least = 1e9;
      for (std::size_t i = 0; i < 7; ++i)
        least =
            std::min(least, share[0] * columns[0][i] + share[1] * columns[1][i] + share[2] * columns[2][i]);
      return least;
    };
    const Shares found = best_shares(columns);
    REQUIRE(found.share.size() == 3);
    CHECK(found.share[0] + found.share[1] + found.share[2] == doctest::Approx(1).epsilon(1e-12));
    CHECK(least_of(found.share) == doctest::Approx(found.least).epsilon(1e-12));
    double best = 0;
    constexpr int steps = 200;
    for (int a = 0; a <= steps; ++a)
      for (int b = 0; a + b <= steps; ++b)
        best =
            std::max(best, least_of({double(a) / steps, double(b) / steps, double(steps - a - b) / steps}));
    CHECK(best <= found.least * (1 + 1e-12));
    CHECK(best > found.least * 0.98);
  }
}

TEST_CASE("the linear programme's odd cases") {
  // A row in which nothing is lost, one damper, equal ones, one that is never worth its mass.
  CHECK(best_shares({{1, 0}, {2, 0}}).least == 0);
  CHECK(best_shares({{3, 2, 4}}).least == doctest::Approx(2));
  CHECK(best_shares({{3, 2, 4}}).share == std::vector<double>{1});
  CHECK(best_shares({{1, 1}, {1, 1}}).least == doctest::Approx(1));
  const Shares best = best_shares({{2, 0, 1}, {0, 2, 1}, {0.1, 0.1, 0.1}});
  CHECK(best.least == doctest::Approx(1));
  CHECK(best.share[2] == doctest::Approx(0));
}

TEST_CASE("one damper is what is said of one") {
  DamperSetQuestion asked = question(2);
  const DamperSet two = answer(asked);
  CHECK(least(two.run.mean) > two.one.value().least);
  asked.count = 3;
  const DamperSet three = answer(asked);
  asked.count = 1;
  const DamperSet one = answer(asked);
  CHECK(one.dampers.size() == 1);
  CHECK_FALSE(one.one);
  for (const DamperSet& several : {two, three}) {
    CHECK(several.one->least == least(one.run.mean));
    CHECK(several.one->clearance == one.dampers.front().clearance);
  }
}

// The fold of the widest cavity lies below the whole range, so the widest loses most everywhere.
TEST_CASE("where the release bounds all clearances, the widest has all mass") {
  DamperSetQuestion asked = question(4);
  asked.to = 27;
  asked.restitution = 0.8;
  const DamperSet set = answer(asked);
  REQUIRE(set.dampers.size() == 1);
  CHECK(set.dampers[0].clearance == doctest::Approx(1.8 * asked.release).epsilon(1e-2));
  CHECK(set.dampers[0].clearance == set.one.value().clearance);
  CHECK(least(set.run.mean) == set.one->least);
}

TEST_CASE("more dampers damp a wide range better than one, in runs too") {
  DamperSetQuestion asked = question(5);
  asked.to = 1;
  const DamperSet set = answer(asked);
  CHECK(least(set.run.mean) > 1.3 * set.one->least);
  CHECK(least(set.varied.mean) > 1.3 * set.one->least);
}

TEST_CASE("viscous damping adds to all, and the number of threads changes nothing") {
  DamperSetQuestion asked = question(3);
  const DamperSet set = answer(asked, 1), again = answer(asked, 2);
  CHECK(set.run.mean == again.run.mean);
  CHECK(set.varied.low == again.varied.low);
  CHECK(set.dampers == again.dampers);
  asked.count = 1;
  const DamperSet free = answer(asked);
  asked.damping_ratio = 0.003;
  CHECK(least(answer(asked).expected) - least(free.expected) ==
        doctest::Approx(2 * 0.003 / 1.02).epsilon(1e-9));
}

// --- With friction, weight and drag -----------------------------------------------------------------------

namespace {

// The mast of README.md in mm: a coefficient of friction of 0.2, Omega_n = 20 1/s.
constexpr double friction = 0.2 * 9806.65 / 400;
DamperSetQuestion rough_question(std::int64_t count) {
  return {.release = 60, .upper = 54, .to = 9, .mass_ratio = 0.04, .count = count, .friction = friction};
}
// The least loss factor of these dampers, with the friction of the question, by its own runs in mm.
double least_loss(const DamperSetQuestion& asked, const std::vector<SceneDamper>& dampers,
                  const std::vector<double>& edges) {
  Scene scene{.x0 = asked.release, .until_time = 1e4, .until_amplitude = asked.to, .dampers = dampers};
  scene.weight = asked.weight;
  for (SceneDamper& each : scene.dampers)
    each.friction = asked.friction, each.drag = asked.drag / each.mass_ratio;
  return least(losses_between(simulate_ensemble(scene, Restitution{}, Record{}, {.members = 8}), edges).mean);
}

}  // namespace

TEST_CASE("dampers that slide are designed for their friction, and better than without") {
  const DamperSetQuestion asked = rough_question(3);
  const DamperSet set = answer(asked);
  const double found = least(set.run.mean);
  CHECK(least_loss(asked, set.dampers, set.edges) == doctest::Approx(found).epsilon(0.05));
  DamperSetQuestion smooth = asked;
  smooth.friction = 0;
  const DamperSet unaware = answer(smooth);
  CHECK(found > 1.2 * least_loss(asked, unaware.dampers, set.edges));
  CHECK(found > 1.2 * set.one.value().least);
  // The runs confirm what is known of one damper in each bin, with its friction.
  for (std::size_t i = 0; i < set.run.mean.size(); ++i)
    CHECK(set.run.mean[i] == doctest::Approx(set.expected[i]).epsilon(0.2));
}

TEST_CASE("below the amplitude at which friction and weight hold all masses no dampers are designed") {
  DamperSetQuestion asked = rough_question(2);
  const double held = 1.04 * friction;
  CHECK(locking_amplitude_of(asked) == doctest::Approx(held));
  asked.to = held * (1 + 1e-9);
  CHECK(problems_of(asked).empty());
  asked.to = held * (1 - 1e-9);
  REQUIRE(problems_of(asked).size() == 1);
  CHECK(problems_of(asked)[0].field == "to");
  // Held they are: the decay ends there.
  Scene scene{.x0 = 60, .until_time = 4000};
  scene.dampers = {{.mass_ratio = 0.03, .clearance = 20, .friction = friction},
                   {.mass_ratio = 0.01, .clearance = 8, .friction = friction}};
  const double end = simulate(scene, Restitution{}, Record{}).half_cycles->amplitude.back();
  CHECK(end > 0.9 * held);
  CHECK(end < 1.02 * held);
  asked.static_friction = 2 * friction, asked.weight = 1;
  CHECK(locking_amplitude_of(asked) == doctest::Approx(1.04 * (2 * friction + 1)));
  asked.to = 20, asked.static_friction = friction / 2, asked.weight = -1, asked.drag = -1;
  std::vector<std::string> fields;
  for (const Problem& problem : problems_of(asked)) fields.push_back(problem.field);
  CHECK(fields == std::vector<std::string>{"weight", "static_friction", "drag"});
}

TEST_CASE("lengths of friction and weight scale with the question") {
  DamperSetQuestion asked = rough_question(2);
  asked.friction = 0.5, asked.weight = 0.3, asked.drag = 0.002;
  asked.static_friction = 0.75;
  const Scene simulated = scene_of_set(asked, {{.mass_ratio = 0.01, .clearance = 30}, {.mass_ratio = 0.04}});
  CHECK(simulated.weight * 60 == doctest::Approx(0.3));
  for (const SceneDamper& each : simulated.dampers) {
    CHECK(each.friction * 60 == doctest::Approx(0.5));
    CHECK(each.static_friction * 60 == doctest::Approx(0.75));
    CHECK(each.drag * each.mass_ratio == doctest::Approx(0.002));
  }
  asked.static_friction = 0;
  const DamperSet set = answer(asked);
  for (double* each : {&asked.release, &asked.upper, &asked.to, &asked.friction, &asked.weight}) *each *= 8;
  const DamperSet eight = answer(asked);
  REQUIRE(set.dampers.size() == eight.dampers.size());
  for (std::size_t j = 0; j < set.dampers.size(); ++j) {
    CHECK(eight.dampers[j].clearance == doctest::Approx(8 * set.dampers[j].clearance).epsilon(1e-2));
    CHECK(eight.dampers[j].mass_ratio == doctest::Approx(set.dampers[j].mass_ratio).epsilon(0.1));
  }
  asked = rough_question(2);
  asked.friction = 0.5, asked.weight = 0.3, asked.drag = 0.002;
  CHECK(least_loss(asked, set.dampers, set.edges) == doctest::Approx(least(set.run.mean)).epsilon(0.05));
}
