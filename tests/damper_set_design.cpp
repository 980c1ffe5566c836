// Designs of several dampers, held against plain searches and runs.
#include "application/sweeps/damper_set_design.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "application/sweeps/sampling.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

DamperSetQuestion question(std::int64_t count) {
  DamperSetQuestion asked;
  asked.release = 60;
  asked.upper = 54;
  asked.to = 2;
  asked.mass_ratio = 0.02;
  asked.count = count;
  return asked;
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
