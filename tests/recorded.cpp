// Every number that a run records, in each engine, against an integration that shares nothing with them, and
// where that cannot tell against what follows from other columns. mutation/outputs.py sees to it that none is
// forgotten.
#include <doctest/doctest.h>

#include <cmath>

#include "impact_damper/simulate.hpp"
#include "plain_integration.hpp"
#include "same_run.hpp"

using namespace impact_damper;
using reference::same;

namespace {

constexpr int samples = 110;
constexpr double duration = 10.9;
const Record everything{true, true, true, true, {{0, duration, samples}}, {}};

// Damped and forced at no round numbers, from a start that is pressed against its wall, or in it, to an end
// that is in a contact, with impacts before the first zero crossing and behind the last. Short of where the
// motion amplifies errors more than a hundredfold.
Scene eventful(bool rigid) {
  return {.damping_ratio = 0.05,
          .x0 = -2,
          .v0 = 0.3,
          .force_amplitude = 0.5,
          .force_frequency = 0.7,
          .until_time = duration,
          .until_amplitude = 0.01,
          .dampers = {{.mass_ratio = 0.3,
                       .restitution = 0.7,
                       .wall_stiffness = 300,
                       .y0 = rigid ? 0 : -0.01,
                       .w0 = rigid ? 0 : 0.1}}};
}
constexpr Budget budget{.max_impacts = 1000, .max_half_cycles = 1001, .max_time = 1002};

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
  const Scene scene = eventful(false);
  const Exact exact{Calibration::fixed_wall, budget, 2'000'003};
  const Run run = simulate(scene, exact, everything);
  CHECK(run.engine == Engine(exact));
  same(run, reference::PlainIntegration(scene, false, samples).run(), 1e-7);
}

TEST_CASE("all that the restitution engine records is what a plain integration finds") {
  const Scene scene = eventful(true);
  const Restitution restitution{1e-7, budget, 2'000'003};
  const Run run = simulate(scene, restitution, everything);
  CHECK(run.engine == Engine(restitution));
  same(run, reference::PlainIntegration(scene, true, samples).run(), 1e-7);
}

TEST_CASE(
    "all that the restitution engine records of a mass that bounces to rest is what a plain integration "
    "finds") {
  Scene scene = eventful(true);
  scene.damper().restitution = 0.4;
  scene.x0 = 7;
  // The tolerance is such that the engine steps through all the impacts that the plain integration does.
  const Run run = simulate(scene, Restitution{.accumulation_tolerance = 1e-10}, everything);
  CHECK(run.contacts->begin.size() == 3);
  same(without_slow_impacts(run), reference::PlainIntegration(scene, true, samples).run(), 1e-7);
}

TEST_CASE("a bounce-down's loss is the energy that was left after the last impact that is recorded") {
  Scene scene = eventful(true);
  scene.damper().restitution = 0.4;
  scene.x0 = 7;
  const Run run = simulate(scene, Restitution{}, everything);
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

// Second order in the step: h^2 omega^2 is 4e-8 of the contact's omega.
TEST_CASE("all that the component element method records is what a plain integration finds") {
  const Scene scene = eventful(false);
  Cem cem{.time_step = 1e-5, .damper = Damper::centred, .locate = true, .large_step = {}, .unstable = true};
  cem.max_steps = 2'000'003;
  cem.budget = budget;
  const Run run = simulate(scene, cem, everything);
  CHECK(run.engine == Engine(cem));
  same(run, reference::PlainIntegration(scene, false, samples).run(), 1e-6);
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
