// A run held against what it should be, number by number.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "impact_damper/io/run_columns.hpp"
#include "impact_damper/run.hpp"

namespace reference {

using namespace impact_damper;

// A record of all there is.
inline Record everything(std::vector<HistoryWindow> history = {}) {
  return {.impacts = true, .contacts = true, .energy = true, .history = std::move(history)};
}

// The order seen between an error and the error at a step that is divided by `ratio`.
inline double order(double coarse, double fine, double ratio = 2) {
  return std::log(coarse / fine) / std::log(ratio);
}

// The largest difference between two columns of one length. A NaN in them fails.
inline double farthest(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double far = 0;
  for (std::size_t i = 0; i < a.size() && !std::isnan(far); ++i)
    if (const double difference = std::abs(a[i] - b[i]); !(difference <= far)) far = difference;
  REQUIRE_FALSE(std::isnan(far));
  return far;
}

constexpr double absent = std::numeric_limits<double>::infinity();  // no recorded number is infinite

// All that a run records, by name, each as a column of numbers.
using Columns = std::map<std::string, std::vector<double>>;

template <class Owner>
void add_columns(Columns& all, const std::string& above, const Owner& owner) {
  for_each_column(owner, RunShape{}, [&](const RunColumnInfo& info, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    const std::string name = above + std::string(info.name);
    if constexpr (HasRunColumns<Value>) {
      add_columns(all, name + '.', value);
    } else if constexpr (std::is_arithmetic_v<Value>) {
      all[name] = {double(value)};
    } else if constexpr (!PartsOfDampers<Value>) {
      std::vector<double>& column = all[name];
      for (const auto& each : value) {
        if constexpr (std::same_as<typename Value::value_type, std::optional<double>>)
          column.push_back(each.value_or(absent));
        else
          column.push_back(double(in_file(each)));
      }
    }
  });
}

inline Columns columns_of(const Run& run) {
  Columns all;
  for_each_column(run, RunShape{}, [&](const RunColumnInfo& info, const auto& section) {
    if (section) add_columns(all, std::string(info.name) + '.', *section);
  });
  return all;
}

inline void same(const char* name, double found, double expected, double allowed) {
  CAPTURE(name);
  CHECK(std::abs(found - expected) <= allowed);
}
template <class Value>
void same(const char* name, const std::vector<Value>& found, const std::vector<Value>& expected,
          double allowed) {
  CAPTURE(name);
  REQUIRE(found.size() == expected.size());
  CHECK(!found.empty());
  for (std::size_t i = 0; i < found.size(); ++i) {
    CAPTURE(i);
    if constexpr (std::is_same_v<Value, double>) {
      CHECK(std::abs(found[i] - expected[i]) <= allowed);
    } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
      REQUIRE(found[i].has_value() == expected[i].has_value());
      if (found[i]) CHECK(std::abs(*found[i] - *expected[i]) <= allowed);
    } else {
      CHECK(found[i] == expected[i]);
    }
  }
}
inline void same(const Energy& found, const Energy& expected, double allowed) {
  same("kinetic", found.kinetic, expected.kinetic, allowed);
  same("spring", found.spring, expected.spring, allowed);
  same("wall", found.wall, expected.wall, allowed);
  same("paper", found.paper, expected.paper, allowed);
}

// All that a run records of each damper.
inline void same_of_dampers(const Run& run, const Run& expected, double allowed) {
  same("impacts.damper", run.impacts->damper, expected.impacts->damper, 0);
  same("contacts.damper", run.contacts->damper, expected.contacts->damper, 0);
  const std::size_t count = run.scene.dampers.size();
  for (const Run* each : {&run, &expected}) {
    REQUIRE(each->half_cycles->dampers.size() == count);
    REQUIRE(each->history->dampers.size() == count);
    REQUIRE(each->energy->dampers.size() == listed_dampers(run.scene));
  }
  for (std::size_t i = 0; i < count; ++i) {
    CAPTURE(i);
    same("half_cycles.dampers.impacts", run.half_cycles->dampers[i].impacts,
         expected.half_cycles->dampers[i].impacts, 0);
    same("history.dampers.y", run.history->dampers[i].y, expected.history->dampers[i].y, allowed);
    same("history.dampers.w", run.history->dampers[i].w, expected.history->dampers[i].w, allowed);
  }
  for (std::size_t i = 0; i < run.energy->dampers.size(); ++i) {
    const DamperEnergy &energy = run.energy->dampers[i], &its = expected.energy->dampers[i];
    CAPTURE(i);
    for (const auto part :
         {&DamperEnergy::initial_kinetic, &DamperEnergy::final_kinetic, &DamperEnergy::impact_loss,
          &DamperEnergy::contact_loss, &DamperEnergy::bounce_down_loss})
      CHECK(std::abs(energy.*part - its.*part) <= allowed);
    CHECK(energy.bounce_downs == its.bounce_downs);
  }
}

// All but the residual, and but what is of each of several dampers. Phases are in degrees, so they may err by
// 180 times as much.
inline void same(const Run& run, const Run& expected, double allowed) {
  const double from_the_scene = std::min(allowed, 1e-14);
  CHECK(run.scene == expected.scene);
  same("zero_crossing", run.half_cycles->zero_crossing, expected.half_cycles->zero_crossing, allowed);
  same("peak_time", run.half_cycles->peak_time, expected.half_cycles->peak_time, allowed);
  same("amplitude", run.half_cycles->amplitude, expected.half_cycles->amplitude, allowed);
  same("impacts", run.half_cycles->impacts, expected.half_cycles->impacts, 0);
  same("time", run.impacts->time, expected.impacts->time, allowed);
  same("wall", run.impacts->wall, expected.impacts->wall, 0);
  same("relative_velocity", run.impacts->relative_velocity, expected.impacts->relative_velocity, allowed);
  same("phase_deg", run.impacts->phase_deg, expected.impacts->phase_deg, 180 * allowed);
  same("impacts.amplitude", run.impacts->amplitude, expected.impacts->amplitude, allowed);
  same("displacement", run.impacts->displacement, expected.impacts->displacement, allowed);
  same("begin", run.contacts->begin, expected.contacts->begin, allowed);
  same("end", run.contacts->end, expected.contacts->end, allowed);
  same("contacts.wall", run.contacts->wall, expected.contacts->wall, 0);
  same("history.time", run.history->time, expected.history->time, from_the_scene);
  same("x", run.history->x, expected.history->x, allowed);
  same("v", run.history->v, expected.history->v, allowed);
  if (has_one_damper(run.scene)) {
    same("y", run.history->dampers[0].y, expected.history->dampers[0].y, allowed);
    same("w", run.history->dampers[0].w, expected.history->dampers[0].w, allowed);
  }
  const EnergyBalance &energy = *run.energy, &its = *expected.energy;
  same(energy.initial, its.initial, from_the_scene);
  same(energy.final, its.final, allowed);
  same("impact_loss", energy.impact_loss, its.impact_loss, allowed);
  same("contact_loss", energy.contact_loss, its.contact_loss, allowed);
  CHECK(energy.bounce_downs == its.bounce_downs);
  same("bounce_down_loss", energy.bounce_down_loss, its.bounce_down_loss, allowed);
  same("viscous_work", energy.viscous_work, its.viscous_work, allowed);
  same("forcing_work", energy.forcing_work, its.forcing_work, allowed);
}

// The same of a run to its scene's time, whose last half cycle is unfinished.
inline void same_until_its_time(const Run& run, const Run& expected, double allowed) {
  CHECK(run.stop_reason == StopReason::time);
  CHECK(run.end_time == *expected.scene.until_time);
  CHECK(!run.impacts->amplitude.back());
  same(run, expected, allowed);
}

}  // namespace reference
