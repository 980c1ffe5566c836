// Every number that a run records, in each engine, against what shares nothing with it: of one damper a plain
// integration, of several what the oracle finds, in quadruple precision (oracle/oracle.hpp); and where these
// cannot tell against what follows from other columns. mutation/outputs.py sees to it that none is forgotten.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "compare.hpp"
#include "impact_damper/simulate.hpp"
#include "plain_integration.hpp"
#include "same_run.hpp"

using namespace impact_damper;
using oracle::Walls;
using reference::same, reference::same_of_dampers, reference::same_until_its_time;

namespace {

// Damped and forced at no round numbers, from a start that is pressed against its wall, or in it, to an end
// that is in a contact, with impacts before the first zero crossing and behind the last. Short of where the
// motion amplifies errors more than a hundredfold.
Scene eventful(Walls walls) {
  Scene scene{.damping_ratio = 0.05,
              .x0 = -2,
              .v0 = 0.3,
              .force_amplitude = 0.5,
              .force_frequency = 0.7,
              .until_time = 10.9,
              .until_amplitude = 0.01,
              .dampers = {{0.3, 0.7, 1, 300, 0, 0}}};
  if (walls == Walls::compliant) scene.damper().y0 = -0.01, scene.damper().w0 = 0.1;
  return scene;
}
// The same with another damper beside it.
Scene eventful_list(Walls walls) {
  Scene scene = eventful(walls);
  scene.until_time = 13.83;
  scene.dampers.push_back(walls == Walls::rigid ? SceneDamper{0.1, 0.8, 1.5, 200, 1.1, -0.4}
                                                : SceneDamper{0.1, 0.5, 1.5, 200, 0.3, -0.4});
  return scene;
}

constexpr Budget budget{.max_impacts = 1000, .max_half_cycles = 1001, .max_time = 1002};
const Exact exact{Calibration::fixed_wall, budget, 2'000'003};
const Restitution restitution{1e-7, budget, 2'000'003};
Cem cem(double time_step, std::int64_t max_steps) {
  Cem options{
      .time_step = time_step, .locate = true, .unstable = true, .max_steps = max_steps, .budget = budget};
  return options;
}

Run simulated(const Scene& scene, const Engine& engine, int samples = oracle::sample_count) {
  return simulate(scene, engine, {true, true, true, true, {{0, *scene.until_time, samples}}, {}});
}
// Of one damper.
constexpr int samples = 110;
Run integrated(const Scene& scene, Walls walls) {
  return reference::PlainIntegration(scene, walls == Walls::rigid, samples).run();
}

void check_against_integration(Walls walls, const Engine& engine, double allowed) {
  const Scene scene = eventful(walls);
  const Run run = simulated(scene, engine, samples);
  CHECK(run.engine == engine);
  same_until_its_time(run, integrated(scene, walls), allowed);
}
void check_against_oracle(Walls walls, const Engine& engine, double allowed) {
  const Scene scene = eventful_list(walls);
  const Run run = simulated(scene, engine), its = oracle::run_of_oracle(scene, walls);
  CHECK(run.engine == engine);
  same_until_its_time(run, its, allowed);
  same_of_dampers(run, its, allowed);
}

// Without the impacts of bounce-downs that the plain integration does not step through.
Run without_slow_impacts(Run run) {
  const Run all = run;
  const auto& crossing = all.half_cycles->zero_crossing;
  run.impacts.emplace(), run.energy->impact_loss.clear();
  for (std::size_t i = 0; i < all.impacts->time.size(); ++i) {
    const double time = all.impacts->time[i];
    if (std::abs(all.impacts->relative_velocity[i]) < reference::PlainIntegration::slowest) {
      const auto row = std::size_t(std::ranges::upper_bound(crossing, time) - crossing.begin());
      if (row < crossing.size()) --run.half_cycles->impacts[row];
      run.energy->bounce_down_loss += all.energy->impact_loss[i];
      continue;
    }
    run.impacts->time.push_back(time);
    run.impacts->wall.push_back(all.impacts->wall[i]);
    run.impacts->relative_velocity.push_back(all.impacts->relative_velocity[i]);
    run.impacts->phase_deg.push_back(all.impacts->phase_deg[i]);
    run.impacts->amplitude.push_back(all.impacts->amplitude[i]);
    run.impacts->displacement.push_back(all.impacts->displacement[i]);
    run.energy->impact_loss.push_back(all.energy->impact_loss[i]);
  }
  return run;
}

}  // namespace

// The plain integration errs by up to 1e-9, and the motion amplifies that by up to a hundred.
TEST_CASE("all that the exact engine records is what a plain integration finds") {
  check_against_integration(Walls::compliant, exact, 1e-7);
}

TEST_CASE("all that the restitution engine records is what a plain integration finds") {
  check_against_integration(Walls::rigid, restitution, 1e-7);
}

// Second order in the step: h^2 omega^2 is 4e-8 of the contact's omega.
TEST_CASE("all that the component element method records is what a plain integration finds") {
  check_against_integration(Walls::compliant, cem(1e-5, 2'000'003), 1e-6);
}

TEST_CASE("all that the exact engine records of several dampers is what the oracle finds") {
  check_against_oracle(Walls::compliant, exact, 1e-11);
}

TEST_CASE("all that the restitution engine records of several dampers is what the oracle finds") {
  check_against_oracle(Walls::rigid, restitution, 1e-11);
}

// Second order in the step: h^2 omega^2 is 1.3e-8 in the contact that is the faster one.
TEST_CASE("all that the component element method records of several dampers is what the oracle finds") {
  check_against_oracle(Walls::compliant, cem(2.5e-6, 8'000'003), 1e-6);
}

TEST_CASE(
    "all that the restitution engine records of a mass that bounces to rest is what a plain integration "
    "finds") {
  Scene scene = eventful(Walls::rigid);
  scene.damper().restitution = 0.4;
  scene.x0 = 7;
  // The tolerance is such that the engine steps through all the impacts that the plain integration does.
  const Run run = simulated(scene, Restitution{.accumulation_tolerance = 1e-10}, samples);
  CHECK(run.contacts->begin.size() == 3);
  same_until_its_time(without_slow_impacts(run), integrated(scene, Walls::rigid), 1e-7);
}

TEST_CASE("a bounce-down's loss is the energy that was left after the last impact that is recorded") {
  Scene scene = eventful(Walls::rigid);
  scene.damper().restitution = 0.4;
  scene.x0 = 7;
  const Run run = simulated(scene, Restitution{}, samples);
  double loss = 0;
  for (const double begin : run.contacts->begin) {
    std::size_t i = 0;
    while (i < run.impacts->time.size() && run.impacts->time[i] <= begin) ++i;
    REQUIRE(i > 0);
    const double w = scene.damper().restitution * run.impacts->relative_velocity[i - 1];
    loss += scene.damper().mass_ratio * w * w / (2 * (1 + scene.damper().mass_ratio));
  }
  CHECK(run.energy->bounce_downs == std::int64_t(run.contacts->begin.size()));
  CHECK(run.energy->bounce_down_loss == doctest::Approx(loss).epsilon(1e-12).scale(0));
}

TEST_CASE("a damper's bounce-downs lose what was left after its last impact that is recorded") {
  Scene scene = eventful_list(Walls::rigid);
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

TEST_CASE("the residual is what the recorded terms leave open, in units of the energy that was handled") {
  // Unforced that is the initial energy. Long runs of lossless impacts, so that rounding errors add up to
  // more than a hundred times those of this sum's own.
  const Scene one{.damping_ratio = 1e-4,
                  .x0 = 3.59,
                  .until_time = 3000,
                  .dampers = {{.mass_ratio = 0.02, .restitution = 1, .y0 = 0.2}}};
  const Scene several{.damping_ratio = 1e-4,
                      .x0 = 3.59,
                      .until_time = 3000,
                      .dampers = {{.mass_ratio = 0.02, .restitution = 1, .y0 = 0.2},
                                  {.mass_ratio = 0.01, .restitution = 1, .clearance = 1.5, .y0 = 0.7}}};
  const double rounding = 1e-15;
  for (const Engine& engine : {Engine(Exact{}), Engine(Restitution{}), Engine(Cem{.locate = true})}) {
    CAPTURE(name_of(engine));
    for (Scene scene : {one, several}) {
      CAPTURE(scene.dampers.size());
      // The residual of central differences is of the order of their step.
      if (std::holds_alternative<Cem>(engine)) scene.until_time = 30;
      const EnergyBalance energy = *simulate(scene, engine, {.energy = true}).energy;
      double losses = energy.contact_loss + energy.bounce_down_loss;
      for (const double loss : energy.impact_loss) losses += loss;
      const double open = energy.initial.total() - (energy.final.total() + losses + energy.viscous_work);
      CHECK(std::abs(energy.residual) > 100 * rounding);
      CHECK(std::abs(energy.residual - open / energy.initial.total()) < rounding);
    }
    const Scene at_rest{.x0 = 0, .until_time = 1, .dampers = {{.y0 = 0.5}}};  // no energy is handled
    CHECK(simulate(at_rest, engine, {.energy = true}).energy->residual == 0);
  }
}
