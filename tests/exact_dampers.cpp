// Several dampers by the exact engine: against the engine of one damper, a Taylor series in long double
// (compliant_dampers.hpp), rigid walls, and themselves in another guise.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "compliant_dampers.hpp"
#include "reference.hpp"

using namespace impact_damper;
using namespace compliant_dampers;

namespace {

Run run_of(const Scene& scene) { return compliant_dampers::run_of(scene, Exact{}); }

SceneDamper damper(double nu, double e, double clearance, double k, double y0, double w0) {
  return {
      .mass_ratio = nu, .restitution = e, .clearance = clearance, .wall_stiffness = k, .y0 = y0, .w0 = w0};
}

}  // namespace

TEST_CASE("a list of one damper is the scene with that damper") {
  for (const Scene& scene : single) {
    for (const Calibration calibration : {Calibration::fixed_wall, Calibration::two_body}) {
      CAPTURE(&scene - single.data());
      const Exact options{.calibration = calibration};
      const Run list = compliant_dampers::run_of_list(scene, options),
                one = compliant_dampers::run_of(scene, options);
      check_alike(list, one, 1e-10);
      CHECK(list.half_cycles->impacts == one.half_cycles->impacts);
      CHECK(list.half_cycles->dampers.front().impacts == one.half_cycles->impacts);
      CHECK(list.impacts->wall == one.impacts->wall);
      CHECK(list.contacts->end.size() == one.contacts->end.size());
      for (std::size_t i = 0; i < one.history->time.size(); ++i) {
        CHECK(std::abs(list.history->dampers[0].y[i] - one.history->dampers[0].y[i]) <= 1e-10);
        CHECK(std::abs(list.history->dampers[0].w[i] - one.history->dampers[0].w[i]) <= 1e-8);
      }
    }
  }
}

TEST_CASE("budgets end a list of one where they end the scene with that damper") {
  const Scene& scene = single.front();
  for (const Exact& options : {Exact{.budget = {.max_impacts = 7}}, Exact{.budget = {.max_half_cycles = 3}},
                               Exact{.budget = {.max_time = 5}}})
    check_alike(compliant_dampers::run_of_list(scene, options), compliant_dampers::run_of(scene, options),
                1e-10);
  Scene falls = scene;
  falls.until_amplitude = 5.95;
  falls = list_of_one(falls);
  CHECK(run_of(falls).stop_reason == StopReason::amplitude);
  // A joint contact spends steps, too.
  CHECK(compliant_dampers::run_of(four, Exact{.max_steps = 200}).stop_reason == StopReason::step_budget);
}

TEST_CASE("several dampers move as their Taylor series says") {
  for (const Scene& scene : {four, two_shaken}) {
    const Run reference = reference_of(scene);
    CHECK(most_in_contact(*reference.contacts) == std::min(3, int(scene.dampers.size())));
    REQUIRE(reference.impacts->time.size() > 10);
    const Distance far = distance(run_of(scene), reference);
    CHECK(far.x < 1e-13);
    CHECK(far.y < 1e-12);
    CHECK(far.impacts < 1e-11);
    CHECK(far.losses < 1e-13);
    CHECK(far.viscous < 1e-13);
    CHECK(far.residual < 1e-14);
  }
}

TEST_CASE("several that press their walls until these ring no more leave them when they should") {
  Scene scene;
  scene.x0 = -1, scene.damping_ratio = 0.05, scene.until_time = 3.5;
  scene.dampers = {damper(0.05, 0.3, 3, 5000, 0, 0), damper(0.02, 0.2, 4, 4000, 0, 0),
                   damper(0.3, 0.1, 5, 20000, 0, 0), damper(0.1, 0.4, 0.7, 900, 0.2, 0)};
  Scene shaken = scene;
  shaken.force_amplitude = 0.7, shaken.force_frequency = 0.9;
  Scene fast = scene;
  fast.force_amplitude = 3, fast.force_frequency = 7;
  for (const Scene& each : {scene, shaken, fast}) {
    const Run run = run_of(each);
    const Run reference = reference_of(each);
    const Distance far = distance(run, reference);
    CHECK(far.x < 1e-13);
    CHECK(far.y < 1e-12);
    CHECK(far.viscous < 1e-13);
    CHECK(far.residual < 1e-14);
    REQUIRE(run.contacts->end.size() > 3);
    CHECK(run.contacts->begin.front() == 0);
    CHECK(run.contacts->end.front() > 0.4);
  }
}

TEST_CASE("walls far faster than others that are pressed with them follow these, once they ring no more") {
  Scene scene;
  scene.x0 = -1, scene.damping_ratio = 0.05, scene.until_time = 0.05;
  scene.dampers = {damper(0.05, 0.6, 3, 200, 0, 0), damper(1e-6, 0.1, 4, 600, 0, 0),
                   damper(0.02, 0.5, 2, 70, 0, 0)};
  Scene shaken = scene;
  shaken.force_amplitude = 3, shaken.force_frequency = 7;
  for (const Scene& each : {scene, shaken}) {
    const Run run = run_of(each);
    const Run reference = reference_of(each);
    const Distance far = distance(run, reference);
    CHECK(far.x < 1e-13);
    CHECK(far.y < 1e-12);
    CHECK(far.residual < 1e-14);
  }
  // The fast wall alone would take 2e6 pieces for each unit of time. It rings for some hundreds of them.
  scene.until_time = 20;
  scene.dampers = {damper(0.02, 0.3, 1, 1e4, 0, 0), damper(1e-9, 0.6, 1, 1e4, 0, 0)};
  const Run run = simulate(scene, Exact{.max_steps = 20'000}, {});
  CHECK(run.stop_reason == StopReason::time);
}

TEST_CASE("that several press their walls is told late under a force as early") {
  // The phase of the force rounds the more the later it is: without regard to that no slow mode takes over.
  Scene scene;
  scene.damping_ratio = 0.05, scene.until_time = 20'000;
  scene.force_amplitude = 0.3, scene.force_frequency = 0.7;
  scene.dampers = {damper(0.05, 0.1, 0.3, 5000, 0, 0), damper(0.02, 0.1, 0.2, 2000, 0, 0)};
  const Exact options{.budget = {.max_impacts = 1'000'000, .max_half_cycles = 1'000'000},
                      .max_steps = 3'000'000};
  CHECK(simulate(scene, options, {}).stop_reason == StopReason::time);
}

TEST_CASE("the parts of a damper, with their shares of its wall, are that damper") {
  constexpr std::array shares{0.5, 0.3, 0.2};
  for (Scene scene : single) {
    scene.until_time = std::min(8.0, *scene.until_time);
    const Run whole = run_of(scene);
    Scene parts = scene;
    parts.dampers.assign(shares.size(), parts.dampers.front());
    for (std::size_t i = 0; i < shares.size(); ++i) {
      parts.dampers[i].mass_ratio *= shares[i];
      parts.dampers[i].wall_stiffness *= shares[i];
    }
    check_alike(run_of(parts), whole, 1e-10);
  }
}

TEST_CASE("several at rest on walls that only the third derivative presses in stay there") {
  // x'' = -2 zeta v0 - x0 is zero but for rounding, and x''' > 0.
  for (const double stiffness : {1e3, 1e7, 1e12}) {
    Scene scene;
    scene.damping_ratio = 0.05, scene.x0 = 0.07, scene.v0 = -0.7, scene.until_time = 4;
    scene.dampers.assign(2, damper(0.05, 0.6, 1, stiffness, 0, 0));
    Scene one = scene;
    one.dampers = {damper(0.1, 0.6, 1, 2 * stiffness, 0, 0)};
    const Run run = run_of(scene), whole = run_of(one);
    CAPTURE(stiffness);
    REQUIRE(run.contacts->end.size() >= 2);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(run.contacts->begin[i] == 0);
      CHECK(std::abs(run.contacts->end[i] - whole.contacts->end[0]) < 1e-9);
    }
    CHECK(run.contacts->end[0] > 0.5);
    CHECK(run.energy->contact_loss == doctest::Approx(whole.energy->contact_loss).epsilon(1e-6));
    REQUIRE(run.impacts->time.size() == 2 * whole.impacts->time.size());
  }
}

TEST_CASE("a damper of vanishing mass changes nothing of the others' motion") {
  Scene with = four;
  with.dampers.push_back(damper(1e-9, 0.5, 0.1, 1e-5, 0, 0));
  const Run one = run_of(four), other = run_of(with);
  for (std::size_t i = 0; i < one.history->x.size(); ++i)
    CHECK(std::abs(one.history->x[i] - other.history->x[i]) < 1e-7);
  CHECK(other.half_cycles->dampers.back().impacts.front() > 0);
}

TEST_CASE("renumbering the dampers changes no bit but the numbers") {
  Scene scene = four;
  scene.dampers.push_back(scene.dampers[1]);
  scene.dampers.back().wall_stiffness = 1100;
  scene.dampers.push_back(scene.dampers[2]);  // one that is there twice
  scene.dampers.push_back(scene.dampers[0]);
  scene.dampers.back().mass_ratio = 0.02;
  const std::size_t count = scene.dampers.size();
  Scene turned = scene;
  std::rotate(turned.dampers.begin(), turned.dampers.begin() + 2, turned.dampers.end());
  const Run one = run_of(scene), other = run_of(turned);
  CHECK(one.half_cycles->zero_crossing == other.half_cycles->zero_crossing);
  CHECK(one.half_cycles->amplitude == other.half_cycles->amplitude);
  CHECK(one.impacts->time == other.impacts->time);
  CHECK(one.history->x == other.history->x);
  CHECK(one.energy->final.total() == other.energy->final.total());
  CHECK(one.energy->residual == other.energy->residual);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = (i + count - 2) % count;
    CHECK(one.history->dampers[i].y == other.history->dampers[j].y);
    CHECK(one.energy->dampers[i].impact_loss == other.energy->dampers[j].impact_loss);
    CHECK(one.energy->dampers[i].final_kinetic == other.energy->dampers[j].final_kinetic);
    CHECK(one.half_cycles->dampers[i].impacts == other.half_cycles->dampers[j].impacts);
  }
}

TEST_CASE("masses that meet their walls at the same instant, to the last bit, do so together") {
  // From rest at x0 on the left walls, masses of one clearance leave together and arrive together.
  for (std::size_t count = 2; count <= 10; ++count) {
    Scene scene;
    scene.x0 = 5, scene.until_time = 3;
    scene.dampers.clear();
    for (std::size_t i = 0; i < count; ++i)
      scene.dampers.push_back(
          damper(0.01 * (1 + double(i % 3)), 0.2 * double(1 + i % 4), 1, 1000.0 * double(1 + i % 5), 0, 0));
    const Run run = run_of(scene);
    CAPTURE(count);
    REQUIRE(run.impacts->time.size() > 2 * count);
    for (std::size_t i = 1; i < count; ++i) {
      CHECK(run.impacts->time[i] == run.impacts->time[0]);
      CHECK(run.impacts->damper[i] == int(i));
    }
    CHECK(std::abs(run.energy->residual) < 1e-14);
    if (count <= 3) CHECK(distance(run, reference_of(scene)).x < 1e-12);
  }
}

TEST_CASE("as the walls get stiff several dampers tend to rigid walls") {
  Scene scene = four;
  scene.until_time = 1.5;
  scene.dampers[1].restitution = 0.5;
  const Run rigid = simulate(scene, Restitution{}, everything(scene));
  const auto off = [&](double k) {
    for (SceneDamper& each : scene.dampers) each.wall_stiffness = k;
    const Run run = compliant_dampers::run_of(scene, Exact{.calibration = Calibration::two_body});
    double largest = 0;
    for (std::size_t i = 0; i < rigid.history->x.size(); ++i)
      largest = std::max(largest, std::abs(run.history->x[i] - rigid.history->x[i]));
    return largest;
  };
  const double soft = off(1e8), stiff = off(1e10);
  CHECK(stiff < 1e-5);
  CHECK(std::log10(soft / stiff) == doctest::Approx(1).epsilon(0.1));  // as k^(-1/2)
}

TEST_CASE(
    "what is recorded of several dampers changes nothing of their motion, and a shorter run is its "
    "beginning") {
  for (const Scene& scene : {four, two_shaken}) {
    const Run all = run_of(scene), less = simulate(scene, Exact{}, {.impacts = true});
    CHECK(all.impacts->time == less.impacts->time);
    CHECK(all.half_cycles->amplitude == less.half_cycles->amplitude);
    Scene shorter = scene;
    shorter.until_time = 5;
    const Run begun = simulate(shorter, Exact{}, {.impacts = true});
    REQUIRE(begun.impacts->time.size() > 4);
    CHECK(std::equal(begun.impacts->time.begin(), begun.impacts->time.end(), all.impacts->time.begin()));
  }
}

TEST_CASE("random lists run, keep their energy and are what they are looked at from the other side") {
  int together = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    reference::Random random(seed);
    Scene scene;
    scene.damping_ratio = random.chance(0.5) ? 0 : random.log_uniform(1e-3, 2);
    scene.x0 = random.uniform(-10, 10);
    scene.v0 = random.chance(0.5) ? 0 : random.uniform(-10, 10);
    if (random.chance(0.33)) {
      scene.force_amplitude = random.log_uniform(0.1, 10);
      scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.1, 10);
    }
    const int count = 1 + int(random.uniform(0, 6));
    scene.dampers.clear();
    for (int i = 0; i < count; ++i) {
      SceneDamper each;
      each.mass_ratio = random.log_uniform(1e-3, random.chance(0.2) ? 10 : 0.5);
      each.restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 1);
      each.clearance = random.chance(0.2) ? 1 : random.log_uniform(1e-3, 1e3);
      each.wall_stiffness = random.chance(0.1) ? each.mass_ratio : random.log_uniform(10, 1e5);
      const bool flies = random.chance(0.4);
      each.y0 = each.clearance * (flies ? random.uniform(-0.1, 1.1) : double(random.chance(0.5)));
      each.w0 = flies ? random.uniform(-3, 3) : 0;
      scene.dampers.push_back(each);
    }
    scene.until_time = 10;
    const Run run = run_of(scene);  // every_run.cpp holds it against itself
    CHECK(run.stop_reason == StopReason::time);
    CHECK(std::abs(run.energy->residual) < 1e-12);
    for (std::size_t i = 1; i < run.contacts->end.size(); ++i)
      together += run.contacts->begin[i] < run.contacts->end[i - 1];

    Scene mirrored = scene;
    mirrored.x0 = -scene.x0, mirrored.v0 = -scene.v0, mirrored.force_amplitude = -scene.force_amplitude;
    for (SceneDamper& each : mirrored.dampers) each.y0 = each.clearance - each.y0, each.w0 = -each.w0;
    const Run other = run_of(mirrored);
    for (std::size_t i = 0; i < std::min<std::size_t>(run.history->x.size(), 5); ++i)
      CHECK(std::abs(run.history->x[i] + other.history->x[i]) < 1e-6);
    for (std::size_t i = 0; i < std::min<std::size_t>(run.impacts->time.size(), 2); ++i)
      CHECK(std::abs(run.impacts->time[i] - other.impacts->time[i]) < 1e-6);
  }
  CHECK(together > 500);
}

TEST_CASE("a thousand dampers, their clearances over six decades") {
  Scene scene{.until_time = 2, .dampers = {}};
  for (int i = 0; i < 1000; ++i)
    scene.dampers.push_back(
        damper(2e-5, 0.2 + 0.0006 * i, std::pow(10, -3 + 0.006 * i), 20 + 0.02 * i, 0, 0));
  const Run run = simulate(scene, Exact{}, {.impacts = true, .energy = true});
  CHECK(run.stop_reason == StopReason::time);
  CHECK(std::abs(run.energy->residual) < 1e-12);
  CHECK(run.impacts->time.size() > 2000);
}
