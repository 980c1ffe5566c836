#include "impact_damper/analysis/consistency.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "impact_damper/simulate.hpp"
#include "rejection.hpp"
#include "same_run.hpp"

using namespace impact_damper;

namespace {

// Everything recorded; damped and forced where that is asked for. Bounces, sticking and single impacts.
Run full_run(const Engine& engine, bool driven) {
  Scene scene{.until_time = 40};
  if (driven) {
    scene.damping_ratio = 0.02;
    scene.force_amplitude = 0.1;
  }
  return simulate(scene, engine, reference::everything({{0, 40, 1001}}));
}

struct Alteration {
  const char* of;  // the field that is said to be wrong begins with this
  const char* means;
  std::function<void(Run&)> make;
};

std::string fields_of(const std::vector<Problem>& problems) {
  std::string all;
  for (const Problem& problem : problems) all += problem.field + ": " + problem.message + "\n";
  return all;
}

void check_found(const Run& run, const std::vector<Alteration>& alterations) {
  REQUIRE(fields_of(inconsistencies_of(run)) == "");
  for (const Alteration& alteration : alterations) {
    CAPTURE(std::string(alteration.means));
    Run altered = run;
    alteration.make(altered);
    const std::string found = fields_of(inconsistencies_of(altered));
    CAPTURE(found);
    CHECK(contains(('\n' + found), '\n' + std::string(alteration.of)));
  }
}

std::size_t row_with_impacts(const Run& run) {
  std::size_t row = 1;
  while (run.half_cycles->impacts[row] < 2) ++row;
  return row;
}

// An impact in the middle of the run, and a sample near the peak of a row.
std::size_t impact_of(const Run& run) { return run.impacts->time.size() / 2; }
std::size_t sample_at_peak(const Run& run, std::size_t row) {
  const std::vector<double>& time = run.history->time;
  return static_cast<std::size_t>(std::ranges::lower_bound(time, run.half_cycles->peak_time[row]) -
                                  time.begin());
}

const std::vector<Alteration> of_any_engine{
    {"/end_time", "another end than until_time", [](Run& run) { run.scene.until_time = 41; }},
    {"/end_time", "an end after until_time", [](Run& run) { run.end_time = 41; }},
    {"/end_time", "an end after max_time",
     [](Run& run) { std::visit([](auto& engine) { engine.budget.max_time = 39; }, run.engine); }},
    {"/stop_reason", "no amplitude was asked for", [](Run& run) { run.stop_reason = StopReason::amplitude; }},
    {"/end_time", "half cycles not used up",
     [](Run& run) { run.stop_reason = StopReason::half_cycle_budget; }},
    {"/impacts/time", "impacts not used up", [](Run& run) { run.stop_reason = StopReason::impact_budget; }},
    {"/end_time", "another time than max_time", [](Run& run) { run.stop_reason = StopReason::time_budget; }},
    {"/stop_reason", "stopped by an amplitude, with none below it",
     [](Run& run) {
       run.scene.until_amplitude = 1e-3;
       run.stop_reason = StopReason::amplitude;
     }},
    {"/half_cycles/amplitude/1", "went on below until_amplitude",
     [](Run& run) { run.scene.until_amplitude = 0.999 * run.half_cycles->amplitude[0]; }},
    {"/impacts/time", "more impacts than max_impacts",
     [](Run& run) { std::visit([](auto& engine) { engine.budget.max_impacts = 3; }, run.engine); }},
    {"/half_cycles/zero_crossing", "more half cycles than max_half_cycles",
     [](Run& run) { std::visit([](auto& engine) { engine.budget.max_half_cycles = 3; }, run.engine); }},
    {"/half_cycles/zero_crossing/3", "a half cycle of no length",
     [](Run& run) { run.half_cycles->zero_crossing[3] = run.half_cycles->zero_crossing[2]; }},
    {"/half_cycles/zero_crossing/", "after the end",
     [](Run& run) { run.half_cycles->zero_crossing.back() = 41; }},
    {"/half_cycles/peak_time/2", "a peak in the next row",
     [](Run& run) { run.half_cycles->peak_time[2] = run.half_cycles->peak_time[3]; }},
    {"/half_cycles/amplitude/0", "below x0", [](Run& run) { run.half_cycles->amplitude[0] = 5.9; }},
    {"/half_cycles/amplitude/0", "above x0, at the release",
     [](Run& run) { run.half_cycles->amplitude[0] = 6.1; }},
    {"/history/x/0", "another x0", [](Run& run) { run.scene.x0 = 5.9; }},
    {"/history/y/0", "another y0", [](Run& run) { run.scene.damper().y0 = 1e-6; }},
    {"/half_cycles/impacts", "more than all impacts",
     [](Run& run) { run.half_cycles->impacts.back() = 5000; }},
    {"/impacts/time/", "an impact moved from one row to the next",
     [](Run& run) {
       const std::size_t row = row_with_impacts(run);
       --run.half_cycles->impacts[row];
       ++run.half_cycles->impacts[row + 1];
     }},
    {"/impacts/time/", "one of the last row not counted",
     [](Run& run) { --run.half_cycles->impacts.back(); }},
    {"/impacts/time/", "an impact that has changed places with the next row's",
     [](Run& run) {
       const auto first = static_cast<std::size_t>(run.half_cycles->impacts[0]);
       run.impacts->time[first] = run.half_cycles->zero_crossing[0] - 0.1;
     }},
    {"/impacts/phase_deg/", "of one impact", [](Run& run) { *run.impacts->phase_deg[impact_of(run)] += 1; }},
    {"/impacts/phase_deg/0", "before the first crossing", [](Run& run) { run.impacts->phase_deg[0] = 90; }},
    {"/impacts/amplitude/", "of one impact",
     [](Run& run) { *run.impacts->amplitude[impact_of(run)] *= 1.01; }},
    {"/impacts/displacement/", "an impact outside the amplitude",
     [](Run& run) {
       run.impacts->displacement[impact_of(run)] = 1.01 * *run.impacts->amplitude[impact_of(run)];
     }},
    {"/impacts/phase_deg/", "no phase in the middle, with no half cycles beside it",
     [](Run& run) {
       run.half_cycles.reset();
       run.impacts->phase_deg[impact_of(run)].reset();
     }},
    {"/impacts/relative_velocity/", "an impact on the other wall",
     [](Run& run) {
       Wall& wall = run.impacts->wall[impact_of(run)];
       wall = wall == Wall::left ? Wall::right : Wall::left;
     }},
    {"/impacts/relative_velocity/", "an impact that goes away from its wall",
     [](Run& run) { run.impacts->relative_velocity[impact_of(run)] *= -1; }},
    {"/impacts/time/", "an impact after the end", [](Run& run) { run.impacts->time.back() = 41; }},
    {"/contacts/begin/", "a contact that stands there twice",
     [](Run& run) {
       Contacts& contacts = *run.contacts;
       contacts.begin.push_back(contacts.begin.back());
       contacts.end.push_back(contacts.end.back());
       contacts.wall.push_back(contacts.wall.back());
       contacts.damper.push_back(0);
     }},
    {"/contacts/end/", "a contact that ends after the end", [](Run& run) { run.contacts->end.back() = 41; }},
    {"/history/time/1000", "a sample after the end", [](Run& run) { run.history->time.back() = 41; }},
    {"/history/x/", "above the amplitude", [](Run& run) { run.history->x[sample_at_peak(run, 3)] *= 1.001; }},
    {"/history/x/", "an amplitude below it", [](Run& run) { run.half_cycles->amplitude[3] *= 0.999; }},
    {"/history/x/", "a sign without a crossing",
     [](Run& run) { run.history->x[sample_at_peak(run, 3)] *= -0.5; }},
    {"/history/x/", "a row that is left out",
     [](Run& run) {
       HalfCycles& rows = *run.half_cycles;
       for (auto* column : {&rows.zero_crossing, &rows.peak_time, &rows.amplitude})
         column->erase(column->begin() + 3, column->begin() + 5);
     }},
    {"/history/x/", "a sample that is not zero at a crossing",
     [](Run& run) {
       const std::size_t i = sample_at_peak(run, 3);
       run.half_cycles->zero_crossing[3] = run.history->time[i];
     }},
    {"/energy/initial/kinetic", "of masses at rest", [](Run& run) { run.energy->initial.kinetic = 0.1; }},
    {"/energy/initial/spring", "1 % off", [](Run& run) { run.energy->initial.spring *= 1.01; }},
    {"/energy/initial/wall", "of no overlap", [](Run& run) { run.energy->initial.wall = 1e-9; }},
    {"/energy/initial/paper", "1 % off", [](Run& run) { run.energy->initial.paper *= 1.01; }},
    {"/energy/final/kinetic", "1 % off", [](Run& run) { run.energy->final.kinetic *= 1.01; }},
    {"/energy/final/spring", "1 % off", [](Run& run) { run.energy->final.spring *= 1.01; }},
    {"/energy/final/paper", "1 % off", [](Run& run) { run.energy->final.paper *= 1.01; }},
    {"/energy/residual", "the loss of one impact",
     [](Run& run) { run.energy->impact_loss[impact_of(run)] += 0.05 * run.energy->initial.total(); }},
    {"/energy/residual", "the energy at the end", [](Run& run) { run.energy->final.wall += 1; }},
    {"/energy/residual", "another residual", [](Run& run) { run.energy->residual = 0.1; }},
    {"/energy/viscous_work", "a damper puts energy in", [](Run& run) { run.energy->viscous_work = -0.1; }},
};

// Three dampers, two of them alike, so that impacts coincide; none sticks.
Run run_of_several(const Engine& engine = Restitution{}) {
  const SceneDamper one{.restitution = 0.9, .y0 = 0.5},
      other{.mass_ratio = 0.01, .restitution = 0.95, .clearance = 0.3, .y0 = 0.2, .w0 = 0.1};
  const Scene scene{
      .damping_ratio = 0.01, .x0 = 1, .force_amplitude = 0.1, .until_time = 40, .dampers = {one, other, one}};
  return simulate(scene, engine, reference::everything({{0, 40, 1001}}));
}

void stick(Run& run, double begin, double end, std::int32_t damper) {
  run.contacts->begin.push_back(begin);
  run.contacts->end.push_back(end);
  run.contacts->wall.push_back(Wall::left);
  run.contacts->damper.push_back(damper);
}

// The first of two impacts at the same time.
std::size_t impact_of_two(const Run& run) {
  const std::vector<double>& time = run.impacts->time;
  return static_cast<std::size_t>(std::ranges::adjacent_find(time) - time.begin());
}

// The first impact at a time of its own.
std::size_t impact_of_one(const Run& run) {
  const std::vector<double>& time = run.impacts->time;
  std::size_t i = 1;
  while (time[i] == time[i - 1] || time[i] == time[i + 1]) ++i;
  return i;
}

const std::vector<Alteration> of_several_dampers{
    {"/half_cycles/impacts/2", "a count that is not the sum over all dampers",
     [](Run& run) { ++run.half_cycles->dampers[1].impacts[2]; }},
    {"/half_cycles/dampers/0/impacts/2", "impacts of one damper counted for another",
     [](Run& run) {
       --run.half_cycles->dampers[0].impacts[2];
       ++run.half_cycles->dampers[1].impacts[2];
       ++run.half_cycles->dampers[0].impacts[3];
       --run.half_cycles->dampers[1].impacts[3];
     }},
    {"/half_cycles/dampers/", "an impact that another damper is said to make",
     [](Run& run) {
       run.impacts->damper[impact_of_one(run)] = 1 - run.impacts->damper[impact_of_one(run)] % 2;
     }},
    {"/impacts/relative_velocity/", "an impact that goes away from its wall",
     [](Run& run) { run.impacts->relative_velocity[3] *= -1; }},
    {"/contacts/begin/1", "a damper that sticks twice at a time",
     [](Run& run) {
       stick(run, 39.5, 39.75, 1);
       stick(run, 39.625, 39.875, 1);
     }},
    {"/impacts/time/", "an impact of a damper that sticks",
     [](Run& run) {
       const double time = run.impacts->time[5];
       stick(run, time - 0.01, time + 0.01, run.impacts->damper[5]);
     }},
    {"/history/dampers/1/y/0", "another y0", [](Run& run) { run.scene.dampers[1].y0 = 0.1; }},
    {"/history/dampers/1/y/500", "behind its wall alone",
     [](Run& run) { run.history->dampers[1].y[500] = 0.301; }},
    {"/history/dampers/2/y/7", "before its left wall",
     [](Run& run) { run.history->dampers[2].y[7] = -1e-6; }},
    {"/energy/initial/kinetic", "a kinetic energy of the first damper only",
     [](Run& run) {
       const double w0 = run.scene.dampers[1].w0;
       run.energy->initial.kinetic -= 0.01 * w0 * w0 / 2;
     }},
    {"/energy/dampers/1/initial_kinetic", "1 % off",
     [](Run& run) { run.energy->dampers[1].initial_kinetic *= 1.01; }},
    {"/energy/dampers/2/final_kinetic", "1 % off",
     [](Run& run) { run.energy->dampers[2].final_kinetic *= 1.01; }},
    {"/energy/final/kinetic", "a final energy 1 % off", [](Run& run) { run.energy->final.kinetic *= 1.01; }},
    {"/energy/impact_loss/", "a loss 1 % below what its speed implies",
     [](Run& run) { run.energy->impact_loss[impact_of_one(run)] *= 0.99; }},
    {"/energy/impact_loss/", "a loss above what its speed and all masses imply",
     [](Run& run) { run.energy->impact_loss[impact_of_one(run)] *= 1.05; }},
    {"/energy/impact_loss/", "a gain of one of two impacts at the same time",
     [](Run& run) { run.energy->impact_loss[impact_of_two(run)] *= -1; }},
    {"/energy/dampers/1/impact_loss", "not the sum over its impacts",
     [](Run& run) { run.energy->dampers[1].impact_loss *= 1.01; }},
    {"/energy/impact_loss_total", "losses of dampers that are not those of all, with no impacts beside them",
     [](Run& run) {
       run.impacts.reset();
       run.energy->dampers[1].impact_loss *= 1.01;
     }},
    {"/energy/contact_loss", "one damper's, not of all",
     [](Run& run) { run.energy->dampers[0].contact_loss = 1e-3; }},
    {"/energy/dampers/0/bounce_down_loss", "of no bounce-down",
     [](Run& run) { run.energy->dampers[0].bounce_down_loss = 1e-3; }},
    {"/energy/bounce_down_loss", "a loss in bounce-downs of one damper that is not in that of all",
     [](Run& run) {
       run.energy->dampers[0].bounce_downs = run.energy->bounce_downs = 1;
       run.energy->dampers[0].bounce_down_loss = 1e-3;
     }},
    {"/energy/bounce_downs", "not among all", [](Run& run) { run.energy->dampers[0].bounce_downs = 1; }},
    {"/energy/residual", "another residual", [](Run& run) { run.energy->residual = 1e-3; }},
};

}  // namespace

TEST_CASE("an alteration of any number that follows from others is found, whatever the engine") {
  for (const Engine& engine :
       {Engine(Exact{}), Engine(Restitution{}), Engine(Cem{}), Engine(Cem{.locate = true})})
    for (const bool driven : {false, true}) {
      INFO("engine ", name_of(engine), ", driven ", driven);
      check_found(full_run(engine, driven), of_any_engine);
    }
}

TEST_CASE("an alteration of what only compliant walls have is found") {
  for (const Engine& engine : {Engine(Exact{}), Engine(Cem{})}) {
    CAPTURE(name_of(engine));
    check_found(
        full_run(engine, false),
        {{"/contacts/begin", "a contact too few",
          [](Run& run) {
            run.contacts->begin.pop_back();
            run.contacts->end.pop_back();
            run.contacts->wall.pop_back();
          }},
         {"/contacts/begin/", "an impact later", [](Run& run) { run.impacts->time[impact_of(run)] += 1e-9; }},
         {"/contacts/wall/", "a contact with the other wall",
          [](Run& run) {
            run.contacts->wall[3] = run.contacts->wall[3] == Wall::left ? Wall::right : Wall::left;
          }},
         {"/energy/bounce_downs", "a bounce-down", [](Run& run) { run.energy->bounce_downs = 1; }},
         {"/energy/bounce_down_loss", "a bounce-down's loss",
          [](Run& run) { run.energy->bounce_down_loss = 0.1; }},
         {"/energy/residual", "a contact's loss", [](Run& run) { run.energy->contact_loss = 1; }}});
  }
}

TEST_CASE("an alteration of what only rigid walls have is found") {
  check_found(
      full_run(Restitution{}, false),
      {{"/impacts/time/", "an impact of a mass that is stuck",
        [](Run& run) {
          const double middle = (run.contacts->begin[2] + run.contacts->end[2]) / 2;
          *std::ranges::lower_bound(run.impacts->time, middle) = middle;
        }},
       {"/energy/impact_loss/", "an impact's speed",
        [](Run& run) { run.impacts->relative_velocity[impact_of(run)] *= 1.0001; }},
       {"/energy/impact_loss/", "another restitution",
        [](Run& run) { run.scene.damper().restitution = 0.61; }},
       {"/energy/impact_loss/", "another mass ratio",
        [](Run& run) { run.scene.damper().mass_ratio = 0.021; }},
       {"/energy/contact_loss", "a loss in a wall", [](Run& run) { run.energy->contact_loss = 0.1; }},
       {"/energy/bounce_down_loss", "of no bounce-down", [](Run& run) { run.energy->bounce_downs = 0; }},
       {"/energy/residual", "a bounce-down's loss", [](Run& run) { run.energy->bounce_down_loss = 1; }}});
}

TEST_CASE("an alteration of a work is found, even where the residual's divisor is not recorded") {
  for (const Engine& engine : {Engine(Exact{}), Engine(Restitution{})}) {
    CAPTURE(name_of(engine));
    check_found(
        full_run(engine, true),
        {{"/energy/residual", "more viscous work", [](Run& run) { run.energy->viscous_work *= 1.01; }},
         {"/energy/residual", "the force's work with the other sign",
          [](Run& run) { run.energy->forcing_work *= -1; }},
         {"/energy/viscous_work", "work of a damper that is not there",
          [](Run& run) { run.scene.damping_ratio = 0; }},
         {"/energy/forcing_work", "work of a force that is not there",
          [](Run& run) { run.scene.force_amplitude = 0; }},
         {"/energy/", "one impact's loss", [](Run& run) { run.energy->impact_loss[0] *= 1.01; }}});
  }
}

TEST_CASE("a run that ends by an amplitude or a budget agrees with itself") {
  const Scene scene{.until_time = 100, .until_amplitude = 5.8};
  const Record record{.impacts = true, .contacts = true, .energy = true};
  for (Engine engine : {Engine(Exact{}), Engine(Restitution{}), Engine(Cem{})}) {
    std::visit([](auto& options) { options.max_steps = 40; }, engine);
    Scene forced = scene;
    forced.force_amplitude = 0.05;
    const Run run = simulate(forced, engine, record);
    CHECK(run.stop_reason == StopReason::step_budget);
    CHECK(fields_of(inconsistencies_of(run)) == "");
  }
  for (const Budget& budget :
       {Budget{}, Budget{.max_impacts = 7}, Budget{.max_half_cycles = 3}, Budget{.max_time = 9}}) {
    for (Engine engine : {Engine(Exact{}), Engine(Restitution{}), Engine(Cem{})}) {
      std::visit([&](auto& options) { options.budget = budget; }, engine);
      const Run run = simulate(scene, engine, record);
      CAPTURE(name_of(run.stop_reason));
      CHECK(run.stop_reason != StopReason::time);
      CHECK(fields_of(inconsistencies_of(run)) == "");
      Run later = run;
      later.end_time = std::nextafter(run.end_time, 100);
      if (run.stop_reason != StopReason::impact_budget) CHECK(fields_of(inconsistencies_of(later)) != "");
    }
  }
}

TEST_CASE("a run of several dampers agrees with itself, and an altered one does not") {
  Run run = run_of_several();
  REQUIRE(impact_of_two(run) + 1 < run.impacts->time.size());
  check_found(run, of_several_dampers);
  // Two dampers may stick at the same time.
  run.contacts = Contacts{};
  stick(run, 39.8, 39.9, 0);
  stick(run, 39.85, 39.95, 1);
  CHECK(fields_of(inconsistencies_of(run)) == "");
}

TEST_CASE("contacts of several dampers are told apart, and all or none of simultaneous impacts are there") {
  const Run by_cem = run_of_several(Cem{});
  REQUIRE(by_cem.contacts->begin.size() > 8);
  check_found(by_cem, {{"/contacts/begin", "a contact that another damper is said to have",
                        [](Run& run) { run.contacts->damper[5] = 1 - run.contacts->damper[5] % 2; }},
                       {"/contacts/begin", "a contact too few",
                        [](Run& run) {
                          run.contacts->begin.pop_back(), run.contacts->end.pop_back();
                          run.contacts->wall.pop_back(), run.contacts->damper.pop_back();
                        }},
                       {"/contacts/begin/", "a contact a little later",
                        [](Run& run) { run.contacts->begin[4] += 1e-3; }},
                       {"/contacts/wall/", "the other wall",
                        [](Run& run) { run.contacts->wall[4] = Wall(1 - int(run.contacts->wall[4])); }},
                       {"/energy/initial/wall", "energy in a wall that is not pushed",
                        [](Run& run) { run.energy->initial.wall = 1e-3; }},
                       {"/energy/dampers/1/impact_loss", "not the sum over its impacts",
                        [](Run& run) { run.energy->dampers[1].impact_loss *= 1.01; }},
                       {"/energy/residual", "another loss in contacts that no impact began",
                        [](Run& run) { run.energy->contact_loss += 0.01; }}});
  Run ended = run_of_several(Restitution{.budget = {.max_impacts = 20}});
  CHECK(fields_of(inconsistencies_of(ended)) == "");
  std::get<Restitution>(ended.engine).budget.max_impacts = 23;
  CHECK(fields_of(inconsistencies_of(ended)).starts_with("/impacts/time"));
}
