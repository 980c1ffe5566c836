// Each engine's options as one table. Run files, the command line and its help, the C interface, the checks
// of simulate() and the headers of tables all go through it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/engine.hpp"

namespace impact_damper {

// The description of an option, except for the member that holds its value.
struct OptionInfo {
  std::string_view name{};    // key in a run file; option of the command line with '-' for '_'
  std::string_view symbol{};  // stands for its number in help; words and flags have none
  NumberRange range{};        // of a number
  std::string_view meaning{};
  std::string_view further{};    // limits that `range` cannot express, in words
  std::string_view otherwise{};  // the default in words, where it depends on the scene
  // True: every run file has it, and simulate() fills in an absent value. False: a file lacks it if it has no
  // value, or if the file is older than the option.
  bool in_every_file = true;
  bool decides_motion = true;  // false: decides only whether, and until when, a scene is run
};

template <class Owner, class Value>
struct EngineOption {
  Value Owner::*member;  // double, optional of double, std::int64_t, bool, or an enumeration
  OptionInfo info;
};
template <class Owner, class Value>
EngineOption(Value Owner::*, OptionInfo) -> EngineOption<Owner, Value>;

// A value as text, as the command line takes it; "" if there is none.
template <class Value>
std::string option_text(const Value& value) {
  if constexpr (std::is_enum_v<Value>) return std::string(name_of(value));
  if constexpr (std::is_same_v<Value, bool>) return value ? "true" : "false";
  if constexpr (std::is_same_v<Value, std::int64_t>) return std::to_string(value);
  if constexpr (std::is_same_v<Value, double>) return number_text(value);
  if constexpr (std::is_same_v<Value, std::optional<double>>) return value ? number_text(*value) : "";
}

namespace detail {

inline constexpr OptionInfo calibration{.name = "calibration",
                                        .meaning =
                                            "fixed-wall, the paper's, delivers the restitution to a primary "
                                            "mass held still, two-body to a free one"};

// Run files of the exact and restitution engines made before the option existed lack it: they were made with
// the default.
constexpr OptionInfo max_steps(bool in_every_file) {
  return {.name = "max_steps",
          .symbol = "N",
          .range = at_least(1),
          .meaning = "largest number of steps, of searches for events or, with cem, of time",
          .in_every_file = in_every_file,
          .decides_motion = false};
}

}  // namespace detail

// The options of an engine, or of its budget, in the order of a run file.
template <class Owner>
inline constexpr std::tuple<> engine_options{};

template <>
inline constexpr auto engine_options<Exact> =
    std::tuple{EngineOption{&Exact::calibration, detail::calibration},
               EngineOption{&Exact::max_steps, detail::max_steps(false)}};

template <>
inline constexpr auto engine_options<Restitution> = std::tuple{
    EngineOption{&Restitution::accumulation_tolerance,
                 {.name = "accumulation_tolerance",
                  .symbol = "X",
                  .range = {0, 1e-3, false},
                  .meaning = "bounce-down jumps to its end once the relative acceleration changes by less "
                             "than this fraction in the rest of it"}},
    EngineOption{&Restitution::max_steps, detail::max_steps(false)}};

template <>
inline constexpr auto engine_options<Cem> = std::tuple{
    EngineOption{
        &Cem::time_step,
        {.name = "time_step",
         .symbol = "H",
         .range = above(0),
         .meaning = "the fixed step",
         .further = "at most the stability limit",
         .otherwise = "a hundredth of an impact's duration, or of half the primary mass's or the forcing's "
                      "period where that is shorter"}},
    EngineOption{&Cem::damper,
                 {.name = "damper",
                  .meaning = "the velocity the wall's damper sees, centred or lagged (one step behind)"}},
    EngineOption{&Cem::locate, {.name = "locate", .meaning = "locate touch and release inside the step"}},
    EngineOption{
        &Cem::large_step,
        {.name = "large_step",
         .symbol = "H",
         .range = above(0),
         .meaning = "steps of up to H, for instance 0.05, while no wall can be met, the time step near "
                    "contact only, best with --locate",
         .further = "above the time step and < 2, with forcing at most half its period",
         .otherwise = "none",
         .in_every_file = false}},
    EngineOption{
        &Cem::stuck_speed,
        {.name = "stuck_speed",
         .symbol = "U",
         .range = above(0),
         .meaning = "with --stuck paper, an impact slower than this, with the wall pushing, joins the masses",
         .in_every_file = false}},
    EngineOption{&Cem::unstable,
                 {.name = "unstable",
                  .meaning = "run even with a step beyond the stability limit",
                  .decides_motion = false}},
    EngineOption{&Cem::calibration, detail::calibration},
    EngineOption{&Cem::max_steps, detail::max_steps(true)}};

template <>
inline constexpr auto engine_options<Budget> =
    std::tuple{EngineOption{&Budget::max_impacts,
                            {.name = "max_impacts",
                             .symbol = "N",
                             .range = at_least(0),
                             .meaning = "stop after so many impacts",
                             .decides_motion = false}},
               EngineOption{&Budget::max_half_cycles,
                            {.name = "max_half_cycles",
                             .symbol = "N",
                             .range = at_least(1),
                             .meaning = "stop after so many half cycles",
                             .decides_motion = false}},
               EngineOption{&Budget::max_time,
                            {.name = "max_time",
                             .symbol = "T",
                             .range = {0, 1e12, false},
                             .meaning = "stop at this time at the latest",
                             .otherwise = "500000, divided by the forcing's frequency where that is above 1",
                             .decides_motion = false}}};

// Calls visit(info, value) for each option of an engine, then of its budget.
template <class Options, class Visit>
void for_each_option(Options& engine, const Visit& visit) {
  const auto each = [&](auto& owner) {
    std::apply([&](const auto&... option) { (visit(option.info, owner.*option.member), ...); },
               engine_options<std::remove_cvref_t<decltype(owner)>>);
  };
  each(engine);
  each(engine.budget);
}
template <class Visit>
void for_each_option(const Engine& engine, const Visit& visit) {
  std::visit([&](const auto& options) { for_each_option(options, visit); }, engine);
}
template <class Visit>
void for_each_option(Engine& engine, const Visit& visit) {
  std::visit([&](auto& options) { for_each_option(options, visit); }, engine);
}

}  // namespace impact_damper
