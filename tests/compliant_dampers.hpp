// What the tests of several dampers with compliant walls (cem_dampers.cpp, exact_dampers.cpp) share: the
// Taylor series of the oracle, scenes, and how far runs are apart.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "compare.hpp"
#include "impact_damper/simulate.hpp"
#include "list_of_one.hpp"

namespace compliant_dampers {

using namespace impact_damper;

constexpr int samples = 201;
inline Record everything(const Scene& scene) {
  return {.impacts = true, .contacts = true, .energy = true, .history = {{0, *scene.until_time, samples}}};
}
inline Run run_of(const Scene& scene, const Engine& engine) {
  return simulate(scene, engine, everything(scene));
}

inline const Scene four{
    .damping_ratio = 0.03,
    .x0 = 3,
    .until_time = 7,
    .dampers = {{.mass_ratio = 0.05, .restitution = 0.5, .wall_stiffness = 400},
                {.mass_ratio = 0.1, .restitution = 0.2, .clearance = 0.3, .wall_stiffness = 900},
                {.mass_ratio = 0.2, .restitution = 0.7, .clearance = 4, .wall_stiffness = 300, .y0 = 1},
                {.mass_ratio = 0.08,
                 .restitution = 0.4,
                 .clearance = 0.7,
                 .wall_stiffness = 2000,
                 .y0 = 0.7,
                 .w0 = -0.5}}};
inline const Scene two_shaken{
    .x0 = 0.2,
    .v0 = 1,
    .force_amplitude = 2,
    .force_frequency = 1.7,
    .until_time = 9,
    .dampers = {{.mass_ratio = 0.3, .restitution = 0.6, .clearance = 0.3, .wall_stiffness = 200, .y0 = 0.1},
                {.mass_ratio = 0.1, .restitution = 0.3, .clearance = 4, .wall_stiffness = 500, .y0 = -0.01}}};

// How far a run is from the reference, at 201 times and in all impacts.
struct Distance {
  double x = 0, y = 0, impacts = 0, losses = 0, viscous = 0, residual = 0;
};
inline Distance distance(const Run& run, const Run& reference) {
  Distance far;
  const std::size_t count = run.scene.dampers.size();
  for (std::size_t i = 0; i < run.history->time.size(); ++i) {
    far.x = std::max(far.x, std::abs(run.history->x[i] - reference.history->x[i]));
    for (std::size_t j = 0; j < count; ++j)
      far.y = std::max(far.y, std::abs(run.history->dampers[j].y[i] - reference.history->dampers[j].y[i]));
  }
  double loss = run.energy->contact_loss, expected = reference.energy->contact_loss;
  for (std::size_t j = 0; j < count; ++j) {
    // Impacts of each damper by itself: those of different ones may be closer together than the error.
    const auto of_damper = [j](const Impacts& impacts) {
      std::vector<std::size_t> its;
      for (std::size_t i = 0; i < impacts.time.size(); ++i)
        if (impacts.damper[i] == int(j)) its.push_back(i);
      return its;
    };
    const Impacts &mine = *run.impacts, &other = *reference.impacts;
    const std::vector<std::size_t> some = of_damper(mine), all = of_damper(other);
    if (some.size() != all.size()) far.impacts = 1;
    for (std::size_t n = 0; n < std::min(some.size(), all.size()); ++n)
      far.impacts = std::max({far.impacts, std::abs(mine.time[some[n]] - other.time[all[n]]),
                              std::abs(mine.relative_velocity[some[n]] - other.relative_velocity[all[n]])});
    const double its = run.energy->dampers[j].impact_loss,
                 true_loss = reference.energy->dampers[j].impact_loss;
    far.losses = std::max(far.losses, std::abs(its - true_loss));
    loss += its, expected += true_loss;
  }
  far.losses = std::max(far.losses, std::abs(loss - expected));
  far.viscous = std::abs(run.energy->viscous_work - reference.energy->viscous_work);
  far.residual = std::abs(run.energy->residual);
  return far;
}
inline Run reference_of(const Scene& scene) {
  return oracle::run_of_oracle(scene, oracle::Walls::compliant, oracle::Fault::none, samples);
}
inline int most_in_contact(const Contacts& contacts) {
  int most = 0;
  for (const double begin : contacts.begin) {
    int count = 0;
    for (std::size_t i = 0; i < contacts.begin.size(); ++i)
      count += contacts.begin[i] <= begin && begin < contacts.end[i];
    most = std::max(most, count);
  }
  return most;
}
// What the engines of lists make of a scene of one damper.
inline Run run_of_list(const Scene& scene, const Engine& engine) {
  return in_its_own_units(run_of(list_of_one(scene), engine));
}

inline const std::vector<Scene> single{
    {.until_time = 30},
    {.damping_ratio = 0.02,
     .x0 = 3,
     .force_amplitude = 0.5,
     .force_frequency = 0.9,
     .until_time = 15,
     .dampers = {{.mass_ratio = 0.1, .restitution = 0.3, .y0 = 0.4}}},
    {.damping_ratio = 0.3,
     .x0 = 0.5,
     .v0 = -1,
     .force_amplitude = 3,
     .force_frequency = 4,
     .until_time = 8,
     .dampers = {{.mass_ratio = 0.5, .restitution = 0.7, .y0 = 0.5}}},
    {.damping_ratio = 1.2,
     .x0 = -4,
     .until_time = 4,
     .dampers = {{.restitution = 0.2, .y0 = -0.01, .w0 = 0.5}}},
    {.x0 = 2,
     .until_time = 8,
     .dampers = {{.mass_ratio = 0.05, .restitution = 0.5, .wall_stiffness = 50, .y0 = 1.05}}},
    {.x0 = 0, .force_amplitude = 1, .force_frequency = 2, .until_time = 10, .dampers = {{.y0 = 1}}}};
// All columns of `some` are those of `all` to within `off`, and `unit` times as large.
inline void check_alike(const Run& some, const Run& all, double off) {
  const auto alike = [&](const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) CHECK(std::abs(a[i] - b[i]) <= off * (1 + std::abs(b[i])));
  };
  CHECK(some.stop_reason == all.stop_reason);
  CHECK(some.end_time == doctest::Approx(all.end_time).epsilon(off));
  alike(some.half_cycles->zero_crossing, all.half_cycles->zero_crossing);
  alike(some.half_cycles->peak_time, all.half_cycles->peak_time);
  alike(some.half_cycles->amplitude, all.half_cycles->amplitude);
  alike(some.history->x, all.history->x);
  alike(some.history->v, all.history->v);
  const auto energies = [](const Run& run) {
    const EnergyBalance& e = *run.energy;
    double losses = 0;
    for (const double loss : e.impact_loss) losses += loss;
    return std::vector{e.initial.total(), e.initial.paper, e.final.kinetic, e.final.spring,
                       e.final.wall,      e.final.paper,   losses,          e.contact_loss,
                       e.viscous_work,    e.forcing_work,  e.residual};
  };
  alike(energies(some), energies(all));
}

}  // namespace compliant_dampers
