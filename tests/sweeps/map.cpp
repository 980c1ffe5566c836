// What a map computes beside its cells, which tests/cli/map.py finds by another program.
#include "application/sweeps/map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace impact_damper;

namespace {

using Values = std::vector<std::optional<double>>;

void check_numbers(const std::vector<double>& found, const std::vector<double>& wanted) {
  REQUIRE(found.size() == wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == doctest::Approx(wanted[i]).epsilon(1e-14));
}

}  // namespace

TEST_CASE("cells end halfway between two places, and as far beyond the first and the last") {
  check_numbers(MapAxis{.values = {5, 10, 20}}.edges(), {2.5, 7.5, 15, 25});
  check_numbers(MapAxis{.values = {1, 4, 64}, .spacing = Spacing::logarithmic}.edges(), {0.5, 2, 16, 256});
  CHECK_THROWS_AS(MapAxis{.values = {5}}.edges(), InvalidArguments);
}

TEST_CASE("levels are round and lie between the least and the greatest value") {
  check_numbers(contour_levels(7.2, 41.3), {10, 15, 20, 25, 30, 35, 40});
  check_numbers(contour_levels(0, 1), {0.2, 0.4, 0.6, 0.8});
  check_numbers(contour_levels(-3, 5), {-2, -1, 0, 1, 2, 3, 4});
  check_numbers(contour_levels(1200, 8000), {2000, 3000, 4000, 5000, 6000, 7000});
  check_numbers(contour_levels(2e-6, 2.5e-5), {5e-6, 1e-5, 1.5e-5, 2e-5});
}

TEST_CASE("a contour of what is linear in the places of both axes is straight and goes from edge to edge") {
  const MapAxis x{.values = {1, 2, 5, 10, 40}, .spacing = Spacing::logarithmic}, y{.values = {-1, 0, 3, 4}};
  Values values;
  for (const double b : y.values)
    for (const double a : x.values) values.emplace_back(2 * std::log(a) + b);
  const MapLine line = contour(x, y, values, 3.3);
  REQUIRE(line.x.size() == line.y.size());
  double left = 1e9, right = 0;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    CHECK(2 * std::log(line.x[i]) + line.y[i] == doctest::Approx(3.3).epsilon(1e-13));
    left = std::min(left, line.x[i]);
    right = std::max(right, line.x[i]);
  }
  // From the lower edge, y = -1, at 2 ln x = 4.3 to the left one: 1 is met at y = 3.3.
  CHECK(left == doctest::Approx(1));
  CHECK(right == doctest::Approx(std::exp(4.3 / 2)));
  REQUIRE(line.gaps.size() == line.x.size() / 2 - 1);
  for (std::size_t i = 0; i < line.gaps.size(); ++i) CHECK(line.gaps[i] == 2 * (i + 1));
}

TEST_CASE("where a square has two high corners and two low ones its middle decides which are cut off") {
  const MapAxis axis{.values = {0, 1}};
  // High at (0, 0) and (1, 1), and in the middle: the low corners are cut off.
  const MapLine high = contour(axis, axis, {4, -1, -1, 4}, 0);
  check_numbers(high.x, {0.8, 1, 0.2, 0});
  check_numbers(high.y, {0, 0.2, 1, 0.8});
  CHECK(high.gaps == std::vector<std::size_t>{2});
  // Low in the middle: the high corners are.
  const MapLine low = contour(axis, axis, {1, -4, -4, 1}, 0);
  check_numbers(low.x, {0, 0.2, 1, 0.8});
  check_numbers(low.y, {0.2, 0, 0.8, 1});
}

TEST_CASE("no contour is drawn through a square one of whose corners has no value") {
  const MapAxis x{.values = {0, 1, 2}}, y{.values = {0, 1}};
  const MapLine line = contour(x, y, {0, 0, std::nullopt, 2, 2, 2}, 1);
  check_numbers(line.x, {1, 0});
  check_numbers(line.y, {0.5, 0.5});
}

TEST_CASE("a limit is where the amplitude is it, in clearances, on the side that is told; a force has none") {
  const auto plan_of = [](const std::string& force, const std::string& quantity) {
    return parse_plan("plan.json",
                      R"({"schema": "impact-damper/plan/1", "scene": {"mass": 40, "stiffness": 16000,
        "secondary_mass": 1.6, "clearance": 10, "restitution": 0.6, "initial_displacement": 60, "until_seconds": 1)" +
                          force + R"(}, "grid": [{"number": "clearance", "from": 5, "to": 160, "count": 6,
        "scale": "logarithmic"}, {"number": "secondary_mass", "values": [1, 2, 3]}], "quantities": [")" +
                          quantity + R"("]})");
  };
  const MapQuestion question{.fixed = {0, 0}};
  const auto limit_of = [&](const std::string& force, const std::string& quantity, Limit limit) {
    const Plan plan = plan_of(force, quantity);
    return limit_line(plan, question, MapMaker(plan, question).finish(), limit);
  };
  const double fold = 0.25 / std::sqrt(std::acos(-1.0) * std::acos(-1.0) + 4 * 0.0625);
  const auto failure = limit_of("", "time_to_amplitude=6", Limit::impact_failure);
  REQUIRE(failure);
  for (const double clearance : failure->line.x) CHECK(clearance == doctest::Approx(6 / fold).epsilon(1e-12));
  CHECK(failure->lower_side == "right");
  // 60 mm, the release, are 5.23 clearances.
  const auto bounces = limit_of("", "impacts", Limit::bounce_down_end);
  REQUIRE(bounces);
  for (const double clearance : bounces->line.x) CHECK(clearance == doctest::Approx(60 / 5.23).epsilon(1e-3));
  CHECK(bounces->lower_side == "right");
  CHECK_FALSE(limit_of("", "impacts", Limit::impact_failure));  // at 760 mm
  CHECK_FALSE(limit_of(R"(, "exciting_force": 2)", "time_to_amplitude=6", Limit::impact_failure));
  CHECK_FALSE(limit_of("", "steady_amplitude", Limit::bounce_down_end));
}
