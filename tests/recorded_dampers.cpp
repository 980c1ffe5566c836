// Every number that a run with several dampers records, in each engine, against what the oracle finds, in
// quadruple precision and by no method of theirs (oracle/oracle.hpp).
// mutation/outputs.py sees to it that none is forgotten.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "compare.hpp"
#include "impact_damper/simulate.hpp"
#include "same_run.hpp"

using namespace impact_damper;
using oracle::Walls;
using reference::same;

namespace {

constexpr Budget budget{.max_impacts = 1000, .max_half_cycles = 1001, .max_time = 1002};

// As those of recorded.cpp, with another damper beside the one that begins pressed against its wall, or in
// it. Short of where the motion amplifies errors more than a hundredfold.
Scene eventful(Walls walls) {
  Scene scene{.damping_ratio = 0.05,
              .x0 = -2,
              .v0 = 0.3,
              .force_amplitude = 0.5,
              .force_frequency = 0.7,
              .until_time = 13.83,
              .until_amplitude = 0.01};
  if (walls == Walls::rigid)
    scene.dampers = {{0.3, 0.7, 1, 300, 0, 0}, {0.1, 0.8, 1.5, 200, 1.1, -0.4}};
  else
    scene.dampers = {{0.3, 0.7, 1, 300, -0.01, 0.1}, {0.1, 0.5, 1.5, 200, 0.3, -0.4}};
  return scene;
}

Run simulated(const Scene& scene, const Engine& engine) {
  return simulate(scene, engine,
                  {true, true, true, true, {{0, *scene.until_time, oracle::sample_count}}, {}});
}

void same_of_dampers(const Run& run, const Run& expected, double allowed) {
  same("impacts.damper", run.impacts->damper, expected.impacts->damper, 0);
  same("contacts.damper", run.contacts->damper, expected.contacts->damper, 0);
  const std::size_t count = run.scene.dampers.size();
  REQUIRE(run.half_cycles->dampers.size() == count);
  REQUIRE(run.history->dampers.size() == count);
  REQUIRE(run.energy->dampers.size() == count);
  for (std::size_t i = 0; i < count; ++i) {
    CAPTURE(i);
    same("half_cycles.dampers.impacts", run.half_cycles->dampers[i].impacts,
         expected.half_cycles->dampers[i].impacts, 0);
    same("history.dampers.y", run.history->dampers[i].y, expected.history->dampers[i].y, allowed);
    same("history.dampers.w", run.history->dampers[i].w, expected.history->dampers[i].w, allowed);
    const DamperEnergy &energy = run.energy->dampers[i], &its = expected.energy->dampers[i];
    for (const auto part :
         {&DamperEnergy::initial_kinetic, &DamperEnergy::final_kinetic, &DamperEnergy::impact_loss,
          &DamperEnergy::contact_loss, &DamperEnergy::bounce_down_loss})
      CHECK(std::abs(energy.*part - its.*part) < allowed);
    CHECK(energy.bounce_downs == its.bounce_downs);
  }
}

void check_against_oracle(Walls walls, const Engine& engine, double allowed) {
  const Scene scene = eventful(walls);
  const Run run = simulated(scene, engine), its = oracle::run_of_oracle(scene, walls);
  CHECK(run.engine == engine);
  same(run, its, allowed);
  same_of_dampers(run, its, allowed);
}

}  // namespace

TEST_CASE("all that the exact engine records of several dampers is what the oracle finds") {
  check_against_oracle(Walls::compliant, Exact{Calibration::fixed_wall, budget, 2'000'003}, 1e-11);
}

TEST_CASE("all that the restitution engine records of several dampers is what the oracle finds") {
  check_against_oracle(Walls::rigid, Restitution{1e-7, budget, 2'000'003}, 1e-11);
}

TEST_CASE("a damper's bounce-downs lose what was left after its last impact that is recorded") {
  Scene scene = eventful(Walls::rigid);
  scene.x0 = -7;
  std::swap(scene.dampers[0], scene.dampers[1]);
  scene.dampers[0].restitution = 0.3;
  scene.dampers[1].restitution = 0.9;  // does not come to rest again
  const Run run = simulated(scene, Restitution{});
  std::vector<DamperEnergy> sums(scene.dampers.size());
  for (std::size_t n = 0; n < run.contacts->begin.size(); ++n) {
    const std::int32_t damper = run.contacts->damper[n];
    const double begin = run.contacts->begin[n];
    if (begin == 0) continue;  // pressed to its wall from the release on
    double speed = 0, primary = 1;
    for (std::size_t i = 0; i < run.impacts->time.size() && run.impacts->time[i] <= begin; ++i)
      if (run.impacts->damper[i] == damper) speed = run.impacts->relative_velocity[i];
    // What sticks meanwhile counts to the primary mass.
    for (std::size_t other = 0; other < run.contacts->begin.size(); ++other)
      if (run.contacts->damper[other] != damper && run.contacts->begin[other] < begin &&
          begin < run.contacts->end[other])
        primary += scene.dampers[std::size_t(run.contacts->damper[other])].mass_ratio;
    const SceneDamper& its = scene.dampers[std::size_t(damper)];
    const double w = its.restitution * speed, nu = its.mass_ratio;
    ++sums[std::size_t(damper)].bounce_downs;
    sums[std::size_t(damper)].bounce_down_loss += primary * nu / (primary + nu) * w * w / 2;
  }
  std::int64_t count = 0;
  double loss = 0;
  for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
    CAPTURE(i);
    const DamperEnergy& its = run.energy->dampers[i];
    CHECK(its.bounce_downs == sums[i].bounce_downs);
    CHECK(std::abs(its.bounce_down_loss - sums[i].bounce_down_loss) <= 1e-12 * sums[i].bounce_down_loss);
    count += its.bounce_downs;
    loss += its.bounce_down_loss;
  }
  CHECK(count > 1);
  // The engine takes the limit of a chattering that the oracle follows farther.
  const Contacts &contacts = *run.contacts, oracles = *oracle::run_of_oracle(scene, Walls::rigid).contacts;
  same("contacts.begin", contacts.begin, oracles.begin, 1e-7);
  same("contacts.end", contacts.end, oracles.end, 1e-7);
  same("contacts.wall", contacts.wall, oracles.wall, 0);
  same("contacts.damper", contacts.damper, oracles.damper, 0);
  CHECK(run.energy->bounce_downs == count);
  CHECK(run.energy->bounce_down_loss == doctest::Approx(loss).epsilon(1e-12).scale(0));
}

// Second order in the step: h^2 omega^2 is 1.3e-8 in the contact that is the faster one.
TEST_CASE("all that the component element method records of several dampers is what the oracle finds") {
  Cem cem{.time_step = 2.5e-6, .damper = Damper::centred, .locate = true, .large_step = {}, .unstable = true};
  cem.max_steps = 8'000'003;
  cem.budget = budget;
  check_against_oracle(Walls::compliant, cem, 1e-6);
}
