// The motions over the frequency of the force that a page shows, against closed forms, against runs that know
// nothing of steady states, and against made-up amplitudes.
#include "application/report/forced_response.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "impact_damper/simulate.hpp"
#include "plain_integration.hpp"

using namespace impact_damper;
using std::numbers::pi;

namespace {

// A mast: 40 kg on 16 kN/m, 1.6 kg in a box with a clearance of 10 mm.
Scene mast(double force, double frequency) {
  Scene scene{.damping_ratio = 0.002,
              .x0 = 0,
              .force_amplitude = force,
              .force_frequency = frequency,
              .dampers = {{.mass_ratio = 0.04}}};
  return scene;
}

ForcedResponse response_of(const Scene& scene, const Engine& engine = Exact{}, const Threads& threads = 2) {
  return forced_response(scene, engine, threads, [](std::int64_t) {});
}

// The scene at a point, from the end of one of its motions on, at phase 0 of the force.
Scene going_on(Scene scene, const ResponsePoint& point, const ArrivedMotion& motion, double periods) {
  scene.force_frequency = point.frequency;
  scene = released_from(scene, motion.steady.state);
  scene.until_time = periods * 2 * pi / point.frequency;
  scene.until_amplitude.reset();
  return scene;
}

double largest_amplitude(const Run& run) { return std::ranges::max(run.half_cycles->amplitude); }
// The median of the largest in ten parts of it: an irregular motion rises high now and then.
double usual_amplitude(const Run& run) {
  const std::vector<double>& all = run.half_cycles->amplitude;
  std::vector<double> largest;
  for (std::size_t i = 0; i < 10; ++i)
    largest.push_back(*std::max_element(all.begin() + std::ptrdiff_t(all.size() * i / 10),
                                        all.begin() + std::ptrdiff_t(all.size() * (i + 1) / 10)));
  std::ranges::sort(largest);
  return (largest[4] + largest[5]) / 2;
}

ArrivedMotion made_up(double amplitude, double scatter = 0) {
  ArrivedMotion motion;
  motion.steady.means.emplace().amplitude = amplitude;
  motion.steady.amplitude_scatter = scatter;
  if (scatter == 0) motion.steady.period = 1;
  return motion;
}

}  // namespace

TEST_CASE("a mass that is never struck leaves the closed form of the empty box at every frequency") {
  Scene scene = mast(0.01, 0.9);
  scene.damper().y0 = 0.5;
  scene.damping_ratio = 0.02;
  const ForcedResponse response = response_of(scene);
  double largest = 0;
  for (const ResponsePoint& point : response.points) {
    const double omega = point.frequency;
    const double amplitude = 0.01 / std::abs(std::complex(1 - omega * omega, 0.04 * omega));
    for (const ArrivedMotion* motion : {&point.rising, &point.falling}) {
      REQUIRE(motion->is_known());
      CHECK(motion->is_periodic());
      CHECK(motion->steady.impacts == ImpactCounts{0, 0});
      CHECK(motion->amplitude() == doctest::Approx(amplitude).epsilon(1e-5));
    }
    largest = std::max(largest, amplitude);
  }
  CHECK(response.two_motions().empty());
  CHECK(response.largest()->motion.amplitude() == doctest::Approx(largest).epsilon(1e-5));
  // The refined frequencies meet the peak, 0.01 / (2 zeta sqrt(1 - zeta^2)).
  CHECK(largest == doctest::Approx(0.01 / (0.04 * std::sqrt(1 - 0.0004))).epsilon(1e-5));
}

TEST_CASE("frequencies ascend, lie about both resonances, and have the scene's own among them") {
  for (const double given : {0.01, 0.98, 1.0, 1.0001, 3.0}) {
    Scene scene = mast(0.01, given);
    scene.damper().y0 = 0.5;
    scene.damping_ratio = 0.1;
    const ForcedResponse response = response_of(scene);
    const auto frequencies = [&](std::size_t i) { return response.points[i].frequency; };
    CHECK(frequencies(response.given) == given);
    for (std::size_t i = 1; i < response.points.size(); ++i) CHECK(frequencies(i) > frequencies(i - 1));
    CHECK(response.points.size() > 30);
    CHECK(frequencies(0) < 0.9);
    CHECK(frequencies(response.points.size() - 1) > 1.1);
  }
}

// One response for all of it: each takes seconds under the sanitizers.
TEST_CASE(
    "the forced mast's amplitudes are those of long runs and of a plain integration, the largest near the "
    "locked resonance") {
  const Scene scene = mast(0.0625, 0.999);
  const ForcedResponse response = response_of(scene);
  const auto largest = response.largest();
  REQUIRE(largest);

  // Of each motion, by a long run of the engine from the state that it ends in.
  int periodic = 0;
  for (const ResponsePoint& point : response.points)
    for (const ArrivedMotion* motion : {&point.rising, &point.falling}) {
      REQUIRE(motion->is_known());
      const double amplitude = largest_amplitude(simulate(going_on(scene, point, *motion, 200), Exact{}, {}));
      if (motion->is_periodic()) {
        ++periodic;
        CHECK(motion->amplitude() == doctest::Approx(amplitude).epsilon(1e-5));
      } else {
        CHECK(std::abs(motion->amplitude() - amplitude) <=
              std::max(0.02 * amplitude, 6 * motion->steady.amplitude_scatter));
      }
      CHECK(amplitude <= 1.01 * largest->motion.amplitude());
    }
  CHECK(periodic > 20);

  // At the scene's own frequency, by a plain integration.
  const ResponsePoint& given = response.points[response.given];
  REQUIRE(given.rising.is_periodic());
  const reference::PlainIntegration plain(going_on(scene, given, given.rising, 20), false, 2);
  CHECK(given.rising.amplitude() == doctest::Approx(largest_amplitude(plain.run())).epsilon(1e-6));

  // The largest, near the resonance with the mass locked, is below the locked mast's.
  const double locked = 0.0625 * 1.04 / (0.004 * std::sqrt(1.04 - 4e-6));
  CHECK(std::abs(largest->frequency * std::sqrt(1.04) - 1) < 0.002);
  CHECK(largest->motion.amplitude() < locked);
  CHECK(largest->motion.amplitude() > 0.7 * locked);
  const double rising = response.largest(&ResponsePoint::rising)->motion.amplitude(),
               falling = response.largest(&ResponsePoint::falling)->motion.amplitude();
  CHECK(largest->motion.amplitude() == std::max(rising, falling));
}

TEST_CASE(
    "the way up begins at the release, the way down where the way up has ended, each motion at the one "
    "before") {
  const Scene scene = mast(0.0125, 1.01);
  const ForcedResponse response = response_of(scene, Restitution{});
  const std::vector<ResponsePoint>& points = response.points;
  const auto follows = [&](const ResponsePoint& point, const SceneState& from, const ArrivedMotion& motion) {
    Scene there = scene;
    there.force_frequency = point.frequency;
    const SteadyState steady = ForcedScene(there, Restitution{}).settle(from, response.rule);
    CHECK(distance(steady.state, motion.steady.state) == 0);
    CHECK(steady.means->amplitude == motion.amplitude());
  };
  const std::size_t last = points.size() - 1;
  follows(points[0], release_of(scene), points[0].rising);
  follows(points[1], points[0].rising.steady.state, points[1].rising);
  follows(points[last], points[last].rising.steady.state, points[last].falling);
  follows(points[last - 1], points[last].falling.steady.state, points[last - 1].falling);
}

TEST_CASE("where the two ways differ each motion keeps its own amplitude in a further run") {
  const Scene scene = mast(0.0125, 0.99);
  const ForcedResponse response = response_of(scene);
  const std::vector<PointRange> ranges = response.two_motions();
  REQUIRE(!ranges.empty());
  for (const PointRange& range : ranges)
    for (std::size_t i = range.first; i <= range.last; ++i) {
      const ResponsePoint& point = response.points[i];
      for (const auto& [own, other] :
           {std::pair{&point.rising, &point.falling}, {&point.falling, &point.rising}}) {
        const double amplitude = usual_amplitude(simulate(going_on(scene, point, *own, 500), Exact{}, {}));
        CHECK(std::abs(amplitude - own->amplitude()) < 0.7 * std::abs(amplitude - other->amplitude()));
        CHECK(own->earlier_amplitude.has_value() != own->is_periodic());
      }
    }
}

TEST_CASE("two motions differ by more than a twentieth and by more than three times their scatter") {
  const auto differ = [](const ArrivedMotion& a, const ArrivedMotion& b) {
    const bool there = ResponsePoint{1, a, b}.has_two_motions();
    CHECK(ResponsePoint{1, b, a}.has_two_motions() == there);
    return there;
  };
  CHECK(differ(made_up(1), made_up(0.94)));
  CHECK_FALSE(differ(made_up(1), made_up(0.96)));
  CHECK(differ(made_up(1), made_up(0.8, 0.066)));
  CHECK_FALSE(differ(made_up(1), made_up(0.8, 0.067)));
  CHECK_FALSE(differ(made_up(1, 0.048), made_up(0.8, 0.048)));
  CHECK(differ(made_up(1, 0.047), made_up(0.8, 0.047)));
  CHECK_FALSE(differ(made_up(1), ArrivedMotion{}));
  // Still growing when it was followed again.
  ArrivedMotion growing = made_up(0.8, 0.01);
  growing.earlier_amplitude = 0.79;
  CHECK(differ(made_up(1), growing));
  growing.earlier_amplitude = 0.7;
  CHECK(growing.changes());
  CHECK_FALSE(differ(made_up(1), growing));
  // The force puts in more than is lost, or less.
  for (const auto& [lost, changes] : {std::pair{0.81, false}, {0.79, true}, {1.24, false}, {1.26, true}}) {
    ArrivedMotion motion = made_up(0.8, 0.01);
    motion.steady.means->power = 1;
    motion.steady.means->viscous_power = 0.3;
    motion.steady.means->impact_power = lost - 0.3;
    CHECK(motion.changes() == changes);
    CHECK(differ(made_up(1), motion) == !changes);
    motion.steady.period = 3;
    CHECK_FALSE(motion.changes());
  }
}

TEST_CASE("points with two motions next to each other are one range") {
  ForcedResponse response;
  for (const int two : {0, 1, 1, 0, 1, 0, 1, 1, 1})
    response.points.push_back({0.1 * double(response.points.size() + 1), made_up(1), made_up(two ? 2 : 1)});
  const std::vector<PointRange> ranges = response.two_motions();
  REQUIRE(ranges.size() == 3);
  CHECK(ranges[0].first == 1);
  CHECK(ranges[0].last == 2);
  CHECK(ranges[1].first == 4);
  CHECK(ranges[1].last == 4);
  CHECK(ranges[2].first == 6);
  CHECK(ranges[2].last == 8);
}

TEST_CASE(
    "without viscous damping a force that impacts cannot hold leads to no steady motion, and that is seen") {
  Scene scene{.x0 = 0};
  scene.force_amplitude = 2.5 * scene.damper().mass_ratio;
  const ForcedResponse response = response_of(scene);
  const auto largest = response.largest();
  REQUIRE(largest);
  CHECK_FALSE(largest->motion.is_periodic());
  CHECK(largest->motion.changes());
  const Run longer =
      simulate(going_on(scene, {largest->frequency, {}, {}}, largest->motion, 500), Exact{}, {});
  CHECK(std::abs(largest_amplitude(longer) / largest->motion.amplitude() - 1) > 0.1);
  // What is not steady is no second motion: two runs of different length differ.
  for (const ResponsePoint& point : response.points)
    if (point.rising.changes() || point.falling.changes()) CHECK_FALSE(point.has_two_motions());
}

TEST_CASE("a motion that a budget of the engine ends is not known, and none of them is the largest") {
  const Exact engine{.budget = {.max_impacts = 1}};
  Scene scene = mast(0.0625, 1);
  const ForcedResponse response = response_of(scene, engine);
  CHECK_FALSE(response.points[response.given].rising.is_known());
  CHECK_FALSE(response.points[response.given].has_two_motions());
}

TEST_CASE("the response is the same by any number of threads, and progress counts its motions") {
  const Scene scene = mast(0.0625, 0.999);
  const ForcedResponse all = response_of(scene, Restitution{}, 3);
  std::int64_t most = 0;
  const ForcedResponse alone =
      forced_response(scene, Restitution{}, 1, [&](std::int64_t done) { most = std::max(most, done); });
  REQUIRE(all.points.size() == alone.points.size());
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    CHECK(all.points[i].frequency == alone.points[i].frequency);
    CHECK(all.points[i].rising.amplitude() == alone.points[i].rising.amplitude());
    CHECK(all.points[i].falling.amplitude() == alone.points[i].falling.amplitude());
  }
  CHECK(most >= 2 * std::ssize(all.points));
}
