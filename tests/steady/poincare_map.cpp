#include "impact_damper/orbits/poincare_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <numbers>
#include <utility>

#include "engines/observed.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "steady_helpers.hpp"

using namespace impact_damper;

namespace {

constexpr auto with_parameters = PoincareMap::Derivatives::by_state_and_parameters;

// The end of a run in extended precision: what derivatives are held against, by differences.
using Number = long double;

struct LastState : TestObserver<Number> {
  void impact(double, Wall, double, double) override { ++impacts; }
  void ended(const State<Number>& state) override { end = {state.x, state.v, state.y, state.w}; }

  std::array<Number, 4> end{};
  int impacts = 0;
};

LastState last_of(const Scene& scene, const Engine& engine) {
  LastState last;
  observed(scene, engine, last);
  return last;
}

// The derivative of the end by a scene's number, and how many impacts the two runs had at the larger
// distance, unequal where the derivative is not one of a single sequence of events. Differences of both
// sides at h and 2h, without their errors of second order.
struct Difference {
  std::array<Number, 4> by{};
  std::array<int, 2> impacts{};
};
// change(scene, by): changes one number of the scene.
template <std::invocable<Scene&, double> Change>
Difference difference(const Scene& scene, const Engine& engine, double h, Change&& change) {
  const auto at = [&](double by) {
    Scene changed = scene;
    change(changed, by);
    return last_of(changed, engine);
  };
  const LastState a = at(h), b = at(-h), c = at(2 * h), d = at(-2 * h);
  Difference all;
  for (std::size_t i = 0; i < 4; ++i) {
    const Number near = (a.end[i] - b.end[i]) / (2 * Number(h)),
                 far = (c.end[i] - d.end[i]) / (4 * Number(h));
    all.by[i] = (4 * near - far) / 3;
  }
  all.impacts = {c.impacts, d.impacts};
  return all;
}
Difference difference(const Scene& scene, const Engine& engine, double h, const SceneNumber& number) {
  return difference(scene, engine, h, [&](Scene& changed, double by) { number.in(changed) += by; });
}

double determinant(StateMatrix a) {
  double all = 1;
  for (std::size_t k = 0; k < 4; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < 4; ++i)
      if (std::fabs(a[i][k]) > std::fabs(a[pivot][k])) pivot = i;
    if (pivot != k) std::swap(a[k], a[pivot]), all = -all;
    all *= a[k][k];
    if (all == 0) return 0;
    for (std::size_t i = k + 1; i < 4; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < 4; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  return all;
}

double largest(const StateMatrix& a) {
  double most = 0;
  for (const StateVector& row : a)
    for (const double entry : row) most = std::max(most, std::fabs(entry));
  return most;
}

// Numbers with few digits, so that scenes a power of two apart are exact.
double coarse(double x) { return std::round(x * 0x1p24) * 0x1p-24; }

struct Case {
  Scene scene;
  Engine engine;
  State<double> start;
};

Case random_case(std::uint64_t seed) {
  reference::Random random(seed);
  Case all;
  Scene& scene = all.scene;
  scene.damper().mass_ratio = random.log_uniform(1e-3, 3);
  scene.damper().restitution = random.uniform(0.2, 0.95);
  scene.damping_ratio = random.chance(0.3) ? 0 : random.log_uniform(1e-3, 1.5);
  scene.damper().wall_stiffness = random.log_uniform(1, 1e5);
  scene.force_amplitude = coarse(random.log_uniform(0.1, 8));
  scene.force_frequency = coarse(random.log_uniform(0.3, 3));
  all.start = {coarse(random.uniform(-3, 3)), coarse(random.uniform(-2, 2)), coarse(random.uniform(0.1, 0.9)),
               coarse(random.uniform(-2, 2))};
  if (random.chance(0.5)) {
    all.engine = Exact{};
    if (random.chance(0.3)) all.start.y = coarse(random.uniform(-0.02, 0));  // begins in a contact
  } else {
    all.engine = Restitution{};
    if (random.chance(0.2)) all.start.y = all.start.w = 0;  // begins at rest on a wall, perhaps sticking
  }
  return all;
}

constexpr double step = 0x1p-24;
constexpr std::array<SceneNumber, 4> numbers_of_state{&Scene::x0, &Scene::v0, &SceneDamper::y0,
                                                      &SceneDamper::w0};

}  // namespace

TEST_CASE("the derivative agrees with differences in extended precision, for every kind of event") {
  int impacts = 0, compliant = 0, sticking = 0, began_in_contact = 0, began_stuck = 0, ended_stuck = 0,
      ended_in_contact = 0, compared = 0;
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const Case c = random_case(seed);
    const PoincareMap map(c.scene, c.engine, 1 + int(seed % 3));
    const PoincareImage image = *map(c.start, with_parameters);
    // Near grazing, and where changes grow much, differences are no reference.
    if (image.slowest_impact && *image.slowest_impact < 0.02) continue;
    if (image.nearest_miss && *image.nearest_miss < 1e-3) continue;
    if (largest(image.by_state) > 1e4) continue;
    const Scene scene = released_from(map.scene(), c.start);
    const double mirror = map.half_periods() % 2 == 0 ? 1 : -1;
    const bool rests = c.start.y == 0 && has_rigid_walls(c.engine);
    const double scale = std::max(1.0, largest(image.by_state));

    bool one_sequence = true;
    std::array<Difference, 4> by;
    for (std::size_t j = 0; j < 4; ++j) {
      if (rests && j >= 2) continue;  // such a change would lead through the wall
      by[j] = difference(scene, c.engine, step, numbers_of_state[j]);
      one_sequence = one_sequence && (image.sticking > 0 || (by[j].impacts[0] == int(image.impacts.size()) &&
                                                             by[j].impacts[1] == int(image.impacts.size())));
    }
    if (!one_sequence) continue;
    const auto same = [&](double found, long double expected) {
      const double off = std::fabs(double(found - mirror * expected)) / scale;
      worst = std::max(worst, off);
      if (!(off < 1e-8)) FAIL_CHECK("seed ", seed, ": ", found, " should be ", double(mirror * expected));
    };
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < (rests ? 2u : 4u); ++j) same(image.by_state[i][j], by[j].by[i]);

    // At a fixed time, which until_time keeps, since the end of the period is not a round number.
    const auto by_frequency = difference(scene, c.engine, step, &Scene::force_frequency),
               by_amplitude = difference(scene, c.engine, step, &Scene::force_amplitude),
               by_time = difference(scene, c.engine, step,
                                    [](Scene&changed, double later) { *changed.until_time += later; });
    const double end_by_frequency = -map.duration() / scene.force_frequency;
    for (std::size_t i = 0; i < 4; ++i) {
      const double rate = std::max(1.0, std::fabs(double(by_time.by[i]) * end_by_frequency));
      same(image.by_frequency[i] / rate, (by_frequency.by[i] + by_time.by[i] * end_by_frequency) / rate);
      same(image.by_amplitude[i], by_amplitude.by[i]);
    }
    ended_in_contact += image.state.dampers[0].y < 0 || image.state.dampers[0].y > 1;
    ++compared;
    impacts += int(image.impacts.size()) * has_rigid_walls(c.engine);
    compliant += int(image.impacts.size()) * !has_rigid_walls(c.engine);
    sticking += int(image.sticking);
    began_in_contact += c.start.y < 0;
    began_stuck += rests && image.sticking > 0;
    ended_stuck += has_rigid_walls(c.engine) && image.state.dampers[0].w == 0;
  }
  MESSAGE("largest difference in units of the largest entry: ", worst);
  CHECK(compared >= 150);
  CHECK(impacts >= 300);
  CHECK(compliant >= 300);
  CHECK(sticking >= 20);
  CHECK(began_in_contact >= 10);
  CHECK(began_stuck >= 3);
  CHECK(ended_stuck >= 5);
  CHECK(ended_in_contact >= 5);
}

TEST_CASE("a mass that is pressed against its wall at phase 0 only adds to the momentum") {
  int began = 0, ended = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Case c = random_case(seed);
    c.start = {-std::fabs(c.start.x) - 0.5, c.start.v, 0, 0};
    if (!(-2 * c.scene.damping_ratio * c.start.v - c.start.x > 0)) continue;
    const PoincareImage image = *PoincareMap(c.scene, Restitution{}, 1 + int(seed % 2))(c.start);
    const double share = c.scene.damper().mass_ratio / (1 + c.scene.damper().mass_ratio);
    for (const StateVector& row : image.by_state) {
      CHECK(row[2] == doctest::Approx(share * row[0]).epsilon(1e-9).scale(1e-3));
      CHECK(row[3] == doctest::Approx(share * row[1]).epsilon(1e-9).scale(1e-3));
    }
    ++began;
    if (!(image.state.dampers[0].w == 0 && (image.state.dampers[0].y == 0 || image.state.dampers[0].y == 1)))
      continue;
    for (const std::size_t row : {2, 3})
      for (const double entry : image.by_state[row]) CHECK(entry == 0);
    ++ended;
  }
  CHECK(began >= 100);
  CHECK(ended >= 10);
}

TEST_CASE("two half periods are one period, with the derivative") {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Case c = random_case(seed);
    const PoincareImage half = *PoincareMap(c.scene, c.engine, 1)(c.start),
                        whole = *PoincareMap(c.scene, c.engine, 2)(c.start),
                        again = *PoincareMap(c.scene, c.engine, 1)(half.state);
    if (whole.slowest_impact.value_or(1) < 0.02 || whole.nearest_miss.value_or(1) < 1e-3) continue;
    const StateVector a = vector_of(whole.state), b = vector_of(again.state);
    const double scale = std::max(1.0, largest(whole.by_state));
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(std::fabs(a[i] - b[i]) < 1e-10 * scale);
      for (std::size_t j = 0; j < 4; ++j) {
        double product = 0;
        for (std::size_t k = 0; k < 4; ++k) product += again.by_state[i][k] * half.by_state[k][j];
        CHECK(std::fabs(product - whole.by_state[i][j]) <
              1e-8 * scale * std::max(1.0, largest(again.by_state)));
      }
    }
    CHECK(whole.impacts.size() == half.impacts.size() + again.impacts.size());
  }
}

TEST_CASE("volumes contract as the divergence and the impacts tell") {
  int rigid = 0, compliant = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Case c = random_case(seed);
    const PoincareMap map(c.scene, c.engine, 2);
    const PoincareImage image = *map(c.start);
    const Run run = simulate(released_from(map.scene(), c.start), c.engine,
                             {.half_cycles = false, .impacts = true, .contacts = true});
    const bool sticks = has_rigid_walls(c.engine) && !run.contacts->begin.empty();
    if (sticks || image.slowest_impact.value_or(1) < 1e-3) continue;
    // What is far below the largest product of four entries is lost in rounding errors.
    const double expected = std::exp(-shrinkage(c.scene, c.engine, run, map.duration())),
                 scale = std::pow(std::max(1.0, largest(image.by_state)), 4);
    CHECK(std::fabs(determinant(image.by_state) - expected) < 1e-12 * scale + 1e-9 * expected);
    if (expected > 1e-6 * scale) ++(has_rigid_walls(c.engine) ? rigid : compliant);
  }
  CHECK(rigid >= 10);
  CHECK(compliant >= 10);
}

TEST_CASE("the derivative grows as one divided by the speed of a grazing impact") {
  // At rest in the middle, z = 1/2 + w t: the later the right wall is met, the slower.
  Scene scene;
  scene.force_amplitude = 0.45 * (1 - 0.25);
  scene.force_frequency = 0.5;
  std::vector<double> speeds, sizes;
  for (double offset = 0.0505; offset < 0.09; offset = 0.05 + (offset - 0.05) * 4) {
    // x of the steady state is 0.45 sin(t/2); y = 1/2 + offset - x turns at its largest.
    const State<double> start{0, 0.225, 0.5 + offset, -0.225};
    const PoincareImage image = *PoincareMap(scene, Restitution{}, 2)(start);
    REQUIRE(image.impacts.size() >= 1);
    REQUIRE(image.slowest_impact);
    speeds.push_back(*image.slowest_impact);
    sizes.push_back(largest(image.by_state));
  }
  REQUIRE(speeds.size() >= 3);
  for (std::size_t i = 1; i < speeds.size(); ++i) {
    CHECK(speeds[i] > 1.5 * speeds[i - 1]);
    CHECK(sizes[i] * speeds[i] == doctest::Approx(sizes[i - 1] * speeds[i - 1]).epsilon(0.2));
  }
  const PoincareImage none = *PoincareMap(scene, Restitution{}, 2)({0, 0.225, 0.5, -0.225});
  CHECK(none.impacts.empty());
  CHECK(!none.slowest_impact);
  CHECK(*none.nearest_miss == doctest::Approx(0.05).epsilon(1e-12));
}

TEST_CASE("the nearest miss is that of densely sampled runs") {
  int misses = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Case c = random_case(seed);
    const PoincareMap map(c.scene, c.engine, 2);
    const PoincareImage image = *map(c.start);
    if (image.sticking > 0) continue;
    const std::int64_t count = 200'000;
    const Run run = simulate(released_from(map.scene(), c.start), c.engine,
                             {.half_cycles = false, .history = {{0, map.duration(), count}}});
    const std::vector<double>& y = run.history->dampers[0].y;
    double least = 1e9;
    for (std::size_t i = 1; i + 1 < y.size(); ++i) {
      if (y[i - 1] < 0 || y[i] < 0 || y[i + 1] < 0 || y[i - 1] > 1 || y[i] > 1 || y[i + 1] > 1) continue;
      // An impact is a corner; a turn is as flat as the samples are near.
      const double bend = std::fabs(y[i + 1] - 2 * y[i] + y[i - 1]), h = map.duration() / double(count - 1);
      if (bend > 100 * h * h) continue;
      if (y[i] > y[i - 1] && y[i] > y[i + 1]) least = std::min(least, 1 - y[i]);
      if (y[i] < y[i - 1] && y[i] < y[i + 1]) least = std::min(least, y[i]);
    }
    if (least > 1) {
      CHECK(image.nearest_miss.value_or(1) > 0.99);
      continue;
    }
    REQUIRE(image.nearest_miss);
    CHECK(std::fabs(*image.nearest_miss - least) < 1e-6);
    ++misses;
  }
  CHECK(misses >= 20);
}

TEST_CASE("what is no map is rejected, with its fields") {
  Scene scene;
  scene.force_amplitude = 1;
  CHECK_NOTHROW(PoincareMap(scene, Exact{}, 1));
  CHECK_THROWS_AS(PoincareMap(scene, Cem{}, 1), InvalidArguments);
  CHECK_THROWS_AS(PoincareMap(scene, Exact{}, 0), InvalidArguments);
  CHECK_THROWS_AS(PoincareMap(Scene{}, Exact{}, 1), InvalidArguments);
  scene.damper().mass_ratio = -1;
  CHECK_THROWS_AS(PoincareMap(scene, Exact{}, 1), InvalidArguments);
}
