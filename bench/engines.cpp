// This project's own engines as contenders: one call of simulate() each, everything included.
#include <algorithm>
#include <functional>
#include <numbers>
#include <utility>

#include "contender.hpp"
#include "impact_damper/engines/cem.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper::bench {
namespace {

Rows rows_of(Run run) {
  HalfCycles& table = *run.half_cycles;
  Rows rows{std::move(table.zero_crossing), std::move(table.peak_time), std::move(table.amplitude), 0};
  for (const std::int64_t impacts : table.impacts) rows.impacts += impacts;
  return rows;
}

Contender closed_form(const std::string& name, Walls walls, const Engine& engine, const std::string& about) {
  return {name,
          walls,
          "",
          [](const Scene&) { return std::vector<double>{0}; },
          [engine](const Scene& scene, double) {
            return rows_of(simulate(scene, engine, {.half_cycles = true}));
          },
          about,
          true};
}

// From 2 steps in a contact of nominal length, near the limit of stability, to 4096, and the default of 100.
std::vector<double> time_steps(const Scene& scene) {
  std::vector<double> steps = geometric(nominal_contact_time(scene.damper()) / 2, 0.5, 12);
  steps.push_back(*resolved(scene, Cem{}).time_step);
  std::ranges::sort(steps, std::greater());
  return steps;
}

// Between impacts four times as many steps in a radian as in contact: a flight lasts longer, and its errors
// are those of the amplitude.
double large_step(const Scene& scene, double step) {
  return step * std::numbers::pi / nominal_contact_time(scene.damper()) / 4;
}

Contender stepping(const std::string& name, Cem options, bool two_rates, const std::string& about) {
  return {name,
          Walls::compliant,
          "time step",
          time_steps,
          [options, two_rates](const Scene& scene, double step) {
            Cem chosen = options;
            chosen.time_step = step;
            chosen.max_steps = 1'000'000'000;  // the finest go beyond the usual budget
            if (two_rates) chosen.large_step = large_step(scene, step);
            return rows_of(simulate(scene, chosen, {.half_cycles = true}));
          },
          about};
}

}  // namespace

std::vector<Contender> engines() {
  return {closed_form("exact", Walls::compliant, Exact{}, "closed forms, events solved for"),
          closed_form("restitution", Walls::rigid, Restitution{}, "the same on rigid walls"),
          stepping("cem", Cem{}, false, "central differences, fixed step"),
          stepping("cem two rates", Cem{}, true, "small steps only where a wall may be met"),
          stepping("cem located", Cem{.locate = true}, false, "touch and release inside the step"),
          stepping("cem located two rates", Cem{.locate = true}, true, "both")};
}

std::vector<double> geometric(double from, double factor, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i, from *= factor) values.push_back(from);
  return values;
}

}  // namespace impact_damper::bench
