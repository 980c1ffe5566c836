#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>

#include "engines/observed.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/orbits/lyapunov.hpp"
#include "impact_damper/orbits/variational_equations.hpp"
#include "impact_damper/simulate.hpp"
#include "impact_damper/steady/steady_state.hpp"
#include "reference.hpp"
#include "steady_helpers.hpp"

using namespace impact_damper;

namespace {

// What happens in a run in extended precision, and the state that it ends in.
struct LastState : TestObserver<long double> {
  explicit LastState(double time) : until(time) {}
  bool wants_contacts() const override { return true; }
  double next_sample() const override {
    return end.empty() ? until : std::numeric_limits<double>::infinity();
  }
  void impact(double, Wall wall, double, double, std::int32_t damper) override {
    sequence.push_back(2 * damper + (wall == Wall::left));
  }
  void contact(double, double, Wall, std::int32_t damper) override { sequence.push_back(-1 - damper); }
  void settled(std::int32_t, const PlaceInCavity&, bool held, double slides, bool) override {
    sequence.push_back(held ? 1000 : 1001 + int(slides));
  }
  void sample(double, double x, double v, std::span<const PlaceInCavity> places) override {
    end = {x, v};
    for (const PlaceInCavity& each : places) end.push_back(each.y), end.push_back(each.w);
  }

  double until;
  std::vector<double> end;
  std::vector<std::int32_t> sequence;  // of all events
};
LastState last_of(const Scene& scene, const Engine& engine) {
  LastState last(*scene.until_time);
  if (const auto* const exact = std::get_if<Exact>(&engine)) {
    observed_list(scene, *exact, last);
  } else {
    observed_list(scene, std::get<Restitution>(engine), last);
  }
  return last;
}

// A scene with the `index`-th number of its initial state, in the order of ChangeOfState, another; or, behind
// these, with another frequency or amplitude of its force, or another end.
Scene changed(Scene scene, std::size_t index, double by) {
  const std::size_t n = dimensions_of(scene);
  if (index >= n) {
    (index == n ? scene.force_frequency : index == n + 1 ? scene.force_amplitude : *scene.until_time) += by;
  } else if (index < 2) {
    (index == 0 ? scene.x0 : scene.v0) += by;
  } else {
    SceneDamper& damper = scene.dampers[index / 2 - 1];
    (index % 2 == 0 ? damper.y0 : damper.w0) += by;
  }
  return scene;
}

// The end's derivative by that number, by differences on both sides at h and 2h, without their errors of
// second order; nothing where the runs are not of one sequence of events, or these errors are not small
// beside `scale`: near grazing, and where changes grow much.
std::optional<std::vector<double>> difference(const Scene& scene, const Engine& engine, std::size_t index,
                                              double scale) {
  const double h = 0x1p-19;
  const LastState here = last_of(scene, engine);
  std::vector<LastState> at;
  for (const double by : {h, -h, 2 * h, -2 * h}) {
    at.push_back(last_of(changed(scene, index, by), engine));
    if (at.back().sequence != here.sequence) return {};
  }
  std::vector<double> all;
  for (std::size_t i = 0; i < here.end.size(); ++i) {
    const double near = (at[0].end[i] - at[1].end[i]) / (2 * h),
                 far = (at[2].end[i] - at[3].end[i]) / (4 * h);
    if (!(std::fabs(near - far) < 1e-6 * scale)) return {};
    all.push_back((4 * near - far) / 3);
  }
  return all;
}

// The change of a run's end by each number of the state at its beginning.
std::vector<ChangeOfState> changes_of_end(const Scene& scene, const Engine& engine, const RecordedRun& run,
                                          AlongRun* along = nullptr) {
  std::vector<ChangeOfState> columns(dimensions_of(scene), ChangeOfState(dimensions_of(scene), 0.0));
  for (std::size_t j = 0; j < columns.size(); ++j) columns[j][j] = 1;
  carry_changes(*variational_coefficients(scene, engine), run, columns, {}, along);
  return columns;
}

// By each number of the state, by the force's frequency and amplitude, and by the end.
std::vector<ChangeOfState> derivative(const Scene& scene, const Engine& engine) {
  const RecordedRun run = ForcedScene(scene, engine).record(release_of(scene), *scene.until_time);
  REQUIRE(run.stop_reason == StopReason::time);
  AlongRun along;
  std::vector<ChangeOfState> columns = changes_of_end(scene, engine, run, &along);
  for (ChangeOfState* each : {&along.by_frequency, &along.by_amplitude, &along.rates_at_end})
    columns.push_back(*each);
  return columns;
}

double coarse(double x) { return std::round(x * 0x1p20) * 0x1p-20; }

enum class Components { none, friction_and_weight, with_drag };

Scene random_scene(std::uint64_t seed, bool rigid, Components components = Components::none) {
  reference::Random random(seed);
  Scene scene;
  scene.damping_ratio = random.chance(0.3) ? 0 : random.log_uniform(1e-3, 1);
  scene.force_amplitude = coarse(random.log_uniform(0.1, 8));
  scene.force_frequency = coarse(random.log_uniform(0.3, 3));
  scene.x0 = coarse(random.uniform(-3, 3));
  scene.v0 = coarse(random.uniform(-2, 2));
  scene.until_time = random.uniform(1, 8);
  scene.dampers.clear();
  const bool some = components != Components::none;
  for (int i = 0; i < (some ? 1 : 2) + int(seed % 3); ++i) {
    SceneDamper damper;
    damper.mass_ratio = random.log_uniform(1e-3, 1);
    damper.restitution = random.uniform(0.1, 0.9);
    damper.clearance = coarse(random.log_uniform(0.3, 3));
    damper.wall_stiffness = random.log_uniform(1, 1e4);
    damper.y0 = coarse(damper.clearance * random.uniform(0.1, 0.9));
    damper.w0 = coarse(random.uniform(-2, 2));
    scene.dampers.push_back(damper);
  }
  // At rest on a wall, where it may stick; or in it.
  if (random.chance(0.3)) scene.dampers[0].y0 = rigid ? 0 : -0.01, scene.dampers[0].w0 = 0;
  if (!some) return scene;
  scene.weight = random.chance(0.4) ? 0 : random.log_uniform(0.02, 2);
  for (SceneDamper& damper : scene.dampers) {
    damper.friction = random.chance(0.2) ? 0 : random.log_uniform(0.02, 1);
    if (random.chance(0.6)) damper.static_friction = damper.friction * random.uniform(1, 2);
    if (random.chance(0.2)) damper.w0 = 0;
    if (components == Components::with_drag && random.chance(0.5)) damper.drag = random.log_uniform(0.01, 1);
  }
  return scene;
}

double largest(const std::vector<ChangeOfState>& columns) {
  double most = 1;
  for (const ChangeOfState& column : columns)
    for (const double entry : column) most = std::max(most, std::fabs(entry));
  return most;
}

struct Counts {
  int columns = 0, by_force = 0, at_end = 0, impacts = 0, held = 0, held_at_first = 0, kicked_off = 0,
      together = 0;
  int stops = 0, reversals = 0, releases = 0, jumping_releases = 0;  // with friction
  int stops_in_wall = 0, releases_in_wall = 0, let_go_by_edges = 0;
};
Counts compare_derivatives(const Engine& engine, std::uint64_t seeds,
                           Components components = Components::none) {
  Counts counts;
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Scene scene = random_scene(seed, has_rigid_walls(engine), components);
    const std::vector<ChangeOfState> found = derivative(scene, engine);
    const double scale = largest(found);
    int columns = 0;
    for (std::size_t j = 0; j < found.size(); ++j) {
      const auto expected = difference(scene, engine, j, scale);
      if (!expected) continue;
      ++columns;
      const std::size_t n = dimensions_of(scene);
      counts.by_force += j == n || j == n + 1;
      counts.at_end += j == n + 2;
      for (std::size_t i = 0; i < expected->size(); ++i) {
        const double off = std::fabs(found[j][i] - (*expected)[i]) / scale;
        worst = std::max(worst, off);
        if (!(off < 1e-8))
          FAIL_CHECK("seed ", seed, ", of ", i, " by ", j, ": ", found[j][i], " should be ", (*expected)[i]);
      }
    }
    counts.columns += columns;
    if (columns == 0) continue;
    const RecordedRun recorded = ForcedScene(scene, engine).record(release_of(scene), *scene.until_time);
    std::vector<const MotionChain::Settled*> before(scene.dampers.size());
    std::vector<std::size_t> edges;  // the motions before each touch and end of a contact
    for (const MotionChain::Settled& now : recorded.chain.settled) {
      const auto*& last = before[std::size_t(now.damper)];
      if (last && last->pushes != now.pushes) edges.push_back(now.motions);
      last = &now;
    }
    std::ranges::fill(before, nullptr);
    for (const MotionChain::Settled& now : recorded.chain.settled) {
      const auto*& last = before[std::size_t(now.damper)];
      const SceneDamper& damper = scene.dampers[std::size_t(now.damper)];
      if (last && now.motions > last->motions) {
        counts.stops += last->slides != 0 && now.held;
        counts.reversals += now.place.w == 0 && now.slides * last->slides < 0;
        counts.releases += last->held && !now.held && now.place.w == 0;
        counts.jumping_releases +=
            last->held && !now.held && now.place.w == 0 && damper.holding() > damper.friction;
        counts.stops_in_wall += last->slides != 0 && now.held && now.pushes;
        counts.releases_in_wall += last->held && !now.held && now.pushes;
        counts.let_go_by_edges += last->held && !now.held && std::ranges::count(edges, now.motions) > 0;
      }
      last = &now;
    }
    const Run run = simulate(scene, engine, {.half_cycles = false, .impacts = true, .contacts = true});
    counts.impacts += int(run.impacts->time.size());
    const Contacts& contacts = *run.contacts;
    counts.held += int(contacts.begin.size());
    for (std::size_t n = 0; n < contacts.end.size(); ++n) {
      counts.held_at_first += contacts.begin[n] == 0;
      counts.kicked_off += std::ranges::count(run.impacts->time, contacts.end[n]) > 0;
      for (std::size_t m = 0; m < n; ++m)
        counts.together += contacts.begin[m] < contacts.end[n] && contacts.begin[n] < contacts.end[m];
    }
  }
  CHECK(worst > 0);  // something was compared
  return counts;
}

// Two dampers under a force: the first is struck in each half period, the second at times.
Scene two_dampers() {
  return {.damping_ratio = 0.02,
          .x0 = 0.3,
          .force_amplitude = 0.1,
          .force_frequency = 0.95,
          .dampers = {{.mass_ratio = 0.05, .y0 = 0.4, .w0 = 0.2},
                      {.mass_ratio = 0.03, .clearance = 1.7, .y0 = 0.7}}};
}

// The same where a slow and strong force presses both to their walls.
Scene sticking_dampers() {
  Scene scene = two_dampers();
  scene.force_frequency = 0.3;
  scene.force_amplitude = 3;
  for (SceneDamper& each : scene.dampers) each.restitution = 0.2;
  return scene;
}

double sum_of(const std::vector<double>& all) { return std::accumulate(all.begin(), all.end(), 0.0); }

}  // namespace

TEST_CASE("the derivative for several dampers agrees with differences in extended precision: rigid walls") {
  const Counts counts = compare_derivatives(Restitution{}, 40);
  CHECK(counts.columns > 300);
  CHECK(counts.by_force > 60);
  CHECK(counts.at_end > 30);
  CHECK(counts.kicked_off > 100);
  CHECK(counts.held_at_first > 3);
  CHECK(counts.together > 20);
}

TEST_CASE(
    "the derivative for several dampers agrees with differences in extended precision: compliant walls") {
  const Counts counts = compare_derivatives(Exact{}, 40);
  CHECK(counts.columns > 300);
  CHECK(counts.by_force > 60);
  CHECK(counts.at_end > 30);
  CHECK(counts.held_at_first > 3);
  CHECK(counts.together > 100);
}

TEST_CASE("the derivative with friction and weight agrees with differences in extended precision") {
  const Counts counts = compare_derivatives(Restitution{}, 60, Components::friction_and_weight);
  CHECK(counts.columns > 400);
  CHECK(counts.by_force > 100);
  CHECK(counts.at_end > 50);
  CHECK(counts.impacts > 300);
  CHECK(counts.stops > 100);
  CHECK(counts.reversals > 30);
  CHECK(counts.releases > 40);
  CHECK(counts.jumping_releases > 20);
}

TEST_CASE("the derivative with friction, weight and drag agrees with these, compliant walls") {
  const Counts counts = compare_derivatives(Exact{}, 80, Components::with_drag);
  CHECK(counts.columns > 400);
  CHECK(counts.by_force > 100);
  CHECK(counts.at_end > 50);
  CHECK(counts.impacts > 400);
  CHECK(counts.stops > 100);
  CHECK(counts.reversals > 400);
  CHECK(counts.jumping_releases > 60);
  CHECK(counts.stops_in_wall > 80);
  CHECK(counts.releases_in_wall > 80);
  CHECK(counts.let_go_by_edges > 10);
}

TEST_CASE("a list of one damper has the exponents of the scene without a list") {
  for (const Engine& engine : rigid_and_compliant) {
    for (const double frequency : {0.9, 0.5}) {
      Scene scene = two_dampers();
      scene.force_frequency = frequency;
      scene.dampers.resize(1);
      Scene alone = scene;
      alone.damper().clearance = 1;
      const LyapunovExponents list = lyapunov_exponents(scene, engine, 12, 2),
                              one = lyapunov_exponents(alone, engine, 12, 2);
      REQUIRE(list.exponents.size() == one.exponents.size());
      for (std::size_t i = 0; i < one.exponents.size(); ++i)
        CHECK(list.exponents[i] == doctest::Approx(one.exponents[i]).epsilon(1e-6));
    }
  }
}

TEST_CASE("the exponents of several dampers add up to the mean divergence") {
  const Scene scene = two_dampers();
  constexpr int periods = 60;
  for (const Engine& engine : rigid_and_compliant) {
    const LyapunovExponents found = lyapunov_exponents(scene, engine, periods);
    REQUIRE(found.exponents.size() == 6);
    double loss = 0, duration = 0;
    Scene period = scene;
    const ForcedScene forced(scene, engine);
    for (int n = 0; n < periods; ++n) {
      const RecordedRun run = forced.record(release_of(period), forced.period());
      duration += run.end_time;
      loss += 2 * scene.damping_ratio * run.end_time;
      if (has_rigid_walls(engine)) {
        CHECK(run.chain.contacts.empty());
        for (const MotionChain::Impact& impact : run.chain.impacts)
          loss -= 2 * std::log(scene.dampers[std::size_t(impact.damper)].restitution);
      } else {
        for (const MotionChain::Contact& contact : run.chain.contacts) {
          const SceneDamper& alone = scene.dampers[std::size_t(contact.damper)];
          const double damping = 2 * std::sqrt(alone.wall_stiffness / alone.mass_ratio) *
                                 zeta_m<double>(alone, Calibration::fixed_wall);
          loss += (1 + alone.mass_ratio) * damping * (contact.end - contact.begin);
        }
      }
      period = released_from(scene, run.end);
    }
    CHECK(sum_of(found.exponents) == doctest::Approx(-loss / duration).epsilon(1e-9));
    for (std::size_t i = 1; i < found.exponents.size(); ++i)
      CHECK(found.exponents[i] <= found.exponents[i - 1] + 0.05);
  }
}

TEST_CASE("on a stable motion of two dampers the largest exponent is that of its contraction") {
  Scene scene = two_dampers();
  scene.damping_ratio = 0.05, scene.force_amplitude = 0.05, scene.force_frequency = 0.9, scene.x0 = 0.5;
  scene.dampers[0].mass_ratio = 0.06, scene.dampers[1].mass_ratio = 0.04, scene.dampers[1].clearance = 1.5;
  const Engine engine = Restitution{};
  const SteadyState steady = ForcedScene(scene, engine).settle(release_of(scene), {});
  REQUIRE(steady.period);
  REQUIRE(steady.contraction);
  const double expected =
      std::log(*steady.contraction) / (2 * std::numbers::pi / scene.force_frequency * double(*steady.period));
  const LyapunovExponents found = lyapunov_exponents(released_from(scene, steady.state), engine, 400, 100);
  CHECK(found.exponents[0] == doctest::Approx(expected).epsilon(0.02));
}

TEST_CASE("masses that stick take two dimensions each that does so at the same time") {
  Scene scene = sticking_dampers();
  CHECK(lyapunov_exponents(scene, Restitution{}, 20, 5).exponents.size() == 2);
  scene.dampers[1].clearance = 1000;  // never met
  scene.dampers[1].y0 = 500;
  CHECK(lyapunov_exponents(scene, Restitution{}, 20, 5).exponents.size() == 4);
}

TEST_CASE("exponents are for at most a hundred dampers, which take seconds for each period") {
  Scene scene = two_dampers();
  scene.dampers.resize(101);
  CHECK_THROWS_WITH_AS(lyapunov_exponents(scene, Restitution{}, 10),
                       "dampers: must be at most 100 for exponents, got 101", InvalidArguments);
}

TEST_CASE("a mass that sticks before the periods that are averaged takes nothing away") {
  // Pressed to their walls at the release, and not again.
  Scene scene = two_dampers();
  scene.x0 = -0.3;
  for (SceneDamper& each : scene.dampers) each.y0 = each.w0 = 0;
  CHECK(lyapunov_exponents(scene, Restitution{}, 50).exponents.size() == 2);
  const LyapunovExponents later = lyapunov_exponents(scene, Restitution{}, 50, 100);
  REQUIRE(later.exponents.size() == 6);
  int impacts = 0;
  Scene period = scene;
  const ForcedScene forced(scene, Restitution{});
  for (int n = 0; n < 150; ++n) {
    const RecordedRun run = forced.record(release_of(period), forced.period());
    if (n >= 100) impacts += int(run.chain.impacts.size());
    period = released_from(scene, run.end);
  }
  const double expected = -2 * 0.02 + 2 * impacts * std::log(0.6) / (50 * forced.period());
  CHECK(sum_of(later.exponents) == doctest::Approx(expected).epsilon(1e-9));
  CHECK_FALSE(later.one_sided);

  Scene alone = scene;
  alone.dampers = {scene.damper()};
  alone.damper().y0 = alone.damper().w0 = 0;
  CHECK(lyapunov_exponents(alone, Restitution{}, 50).exponents.size() == 2);
  const LyapunovExponents of_one = lyapunov_exponents(alone, Restitution{}, 50, 100);
  REQUIRE(of_one.exponents.size() == 4);
}

TEST_CASE("a mass whose chattering is complete sticks where the run ends before its accumulation point") {
  Scene scene = sticking_dampers();
  Scene alone = scene;
  alone.dampers.resize(1);
  for (const Scene& each : {scene, alone}) {
    const ForcedScene forced(each, Restitution{});
    const RecordedRun whole = forced.record(release_of(each), forced.period());
    REQUIRE_FALSE(whole.chain.contacts.empty());
    const MotionChain::Contact& contact = whole.chain.contacts.front();
    double last_impact = 0;
    for (const MotionChain::Impact& impact : whole.chain.impacts)
      if (impact.time <= contact.begin) last_impact = impact.time;
    REQUIRE(last_impact < contact.begin);
    const RecordedRun cut = forced.record(release_of(each), last_impact + (contact.begin - last_impact) / 2);
    CHECK(cut.chain.contacts.empty());
    const auto damper = std::size_t(contact.damper);
    for (const ChangeOfState& column : changes_of_end(each, Restitution{}, cut)) {
      CHECK(column[index_of_y(damper)] == 0);
      CHECK(column[index_of_w(damper)] == 0);
      CHECK(column[0] != 0);
    }
  }
}

TEST_CASE("that several masses meet walls at one instant is told") {
  Scene scene = two_dampers();
  scene.dampers[1] = scene.dampers[0];
  CHECK(lyapunov_exponents(scene, Restitution{}, 20, 5).one_sided);
  scene.dampers[1].y0 += 1e-6;
  CHECK_FALSE(lyapunov_exponents(scene, Restitution{}, 20, 5).one_sided);
}
