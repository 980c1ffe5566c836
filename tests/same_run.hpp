// A run held against what it should be, number by number.
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <optional>
#include <type_traits>
#include <vector>

#include "impact_damper/run.hpp"

namespace reference {

using impact_damper::Energy, impact_damper::EnergyBalance, impact_damper::Run, impact_damper::StopReason;

template <class Value>
void same(const char* name, const std::vector<Value>& found, const std::vector<Value>& expected,
          double allowed) {
  CAPTURE(name);
  REQUIRE(found.size() == expected.size());
  CHECK(!found.empty());
  for (std::size_t i = 0; i < found.size(); ++i) {
    CAPTURE(i);
    if constexpr (std::is_same_v<Value, double>) {
      CHECK(std::abs(found[i] - expected[i]) < allowed);
    } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
      REQUIRE(found[i].has_value() == expected[i].has_value());
      if (found[i]) CHECK(std::abs(*found[i] - *expected[i]) < allowed);
    } else {
      CHECK(found[i] == expected[i]);
    }
  }
}

inline void same(const char* name, const Energy& found, const Energy& expected, double allowed) {
  CAPTURE(name);
  CHECK(std::abs(found.kinetic - expected.kinetic) < allowed);
  CHECK(std::abs(found.spring - expected.spring) < allowed);
  CHECK(std::abs(found.wall - expected.wall) < allowed);
  CHECK(std::abs(found.paper - expected.paper) < allowed);
}

// All but the residual, for which see below. Phases are in degrees, so they may err by 180 times as much.
inline void same(const Run& run, const Run& expected, double allowed) {
  CHECK(run.stop_reason == StopReason::time);
  CHECK(run.end_time == *expected.scene.until_time);
  CHECK(run.scene == expected.scene);
  CHECK(!run.impacts->amplitude.back());
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
  same("history.time", run.history->time, expected.history->time, 1e-14);
  same("x", run.history->x, expected.history->x, allowed);
  same("v", run.history->v, expected.history->v, allowed);
  if (has_one_damper(run.scene)) {
    same("y", run.history->dampers[0].y, expected.history->dampers[0].y, allowed);
    same("w", run.history->dampers[0].w, expected.history->dampers[0].w, allowed);
  }
  const EnergyBalance &energy = *run.energy, &its = *expected.energy;
  same("initial", energy.initial, its.initial, 1e-14);
  same("final", energy.final, its.final, allowed);
  same("impact_loss", energy.impact_loss, its.impact_loss, allowed);
  CHECK(std::abs(energy.contact_loss - its.contact_loss) < allowed);
  CHECK(energy.bounce_downs == its.bounce_downs);
  CHECK(std::abs(energy.bounce_down_loss - its.bounce_down_loss) < allowed);
  CHECK(std::abs(energy.viscous_work - its.viscous_work) < allowed);
  CHECK(std::abs(energy.forcing_work - its.forcing_work) < allowed);
}

}  // namespace reference
