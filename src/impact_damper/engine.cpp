#include "impact_damper/engine.hpp"

#include <algorithm>

#include "impact_damper/engine_options.hpp"

namespace impact_damper {
namespace {

template <class... Options>
std::vector<Engine> one_of_each(const std::variant<Options...>&) {
  return {Options{}...};
}

// Adds a problem if a number is out of its range. Words, flags and absent numbers are always valid.
template <class Value>
void check(const OptionInfo& option, const Value& value, std::vector<Problem>& problems) {
  if constexpr (std::is_same_v<Value, std::optional<double>>) {
    if (value) check(option, *value, problems);
  } else if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, std::int64_t>) {
    if (option.range.allows(value)) return;
    const bool bounded = std::is_integral_v<Value> || option.range.most < NumberRange{}.most;
    problems.push_back(
        {std::string(option.name),
         option.range.describe("must be") + (bounded ? "" : " and finite") + ", got " + option_text(value)});
  }
}

}  // namespace

const std::vector<Engine>& default_engines() {
  static const std::vector<Engine> engines = one_of_each(Engine{});
  return engines;
}

std::vector<std::string_view> engine_names() {
  std::vector<std::string_view> names;
  names.reserve(default_engines().size());
  for (const Engine& engine : default_engines()) names.push_back(name_of(engine));
  return names;
}

std::vector<Problem> problems_of(const Engine& engine) {
  std::vector<Problem> problems;
  for_each_option(engine,
                  [&](const OptionInfo& option, const auto& value) { check(option, value, problems); });
  return problems;
}

bool has_rigid_walls(const Engine& engine) {
  return std::visit([](const auto& options) { return options.rigid_walls; }, engine);
}

Calibration calibration_of(const Engine& engine) {
  return std::visit(
      [](const auto& options) {
        if constexpr (requires { options.calibration; }) return options.calibration;
        return Calibration::fixed_wall;
      },
      engine);
}

std::string_view name_of(const Engine& engine) {
  return std::visit([](const auto& options) { return options.name; }, engine);
}

std::string_view name_of(Calibration calibration) {
  switch (calibration) {
    case Calibration::fixed_wall:
      return "fixed-wall";
    case Calibration::two_body:
      return "two-body";
  }
  return {};
}

}  // namespace impact_damper
