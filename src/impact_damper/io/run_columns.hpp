// The columns of a run as one table, in the order of a run file. Run files, CSV and the interface for C are
// made from it; the Python module and the package for browsers use that interface. The schema of run files
// and the package's types are compared with it (tests/run_file.cpp). A section is one member of Run:
// half_cycles, impacts, contacts, energy or history.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "impact_damper/base/text.hpp"
#include "impact_damper/run.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// How a column appears in a run whose scene has one damper and no list: unchanged (same), left out (absent),
// or replaced by that damper's columns, directly in the section (in_section).
enum class WithoutList { same, absent, in_section };
// How the numbers of a column are ordered. Ascending: none is smaller than the one before, in the column or
// among the rows of one damper.
enum class Order { any, ascending, ascending_for_each_damper };

// All that is known of a column, a single number or a nested object, except which member holds its value.
struct RunColumnInfo {
  std::string_view name{};
  Dimension dimension = Dimension::ratio;  // also of objects, counts, and what stands for a wall or a damper
  // Allowed range of its numbers. A damper's must not exceed the number of dampers either.
  NumberRange range{};
  Order order = Order::any;
  WithoutList without_list = WithoutList::same;
  bool of_components = false;  // only of a scene with friction, drag or weight (has_components)
};

template <class Owner, class Value>
struct RunColumn {
  using value_type = Value;
  Value Owner::*member;  // a function for what files have but the run does not store: a sum of other values
  RunColumnInfo info;
};
template <class Owner, class Value>
RunColumn(Value Owner::*, RunColumnInfo) -> RunColumn<Owner, Value>;

namespace detail {

constexpr RunColumnInfo instant(std::string_view name, Order order = Order::ascending) {
  return {.name = name, .dimension = Dimension::time, .range = at_least(0), .order = order};
}
constexpr RunColumnInfo length(std::string_view name, NumberRange range = {}) {
  return {.name = name, .dimension = Dimension::length, .range = range};
}
constexpr RunColumnInfo velocity(std::string_view name) { return {name, Dimension::velocity}; }
constexpr RunColumnInfo energy(std::string_view name) { return {name, Dimension::energy}; }
constexpr RunColumnInfo component(std::string_view name) {
  return {.name = name, .dimension = Dimension::energy, .of_components = true};
}
constexpr RunColumnInfo count(std::string_view name) { return {.name = name, .range = at_least(0)}; }
inline constexpr RunColumnInfo wall{.name = "wall", .range = within(0, 1)};
inline constexpr RunColumnInfo damper{
    .name = "damper", .range = within(1, most_dampers), .without_list = WithoutList::absent};
constexpr RunColumnInfo dampers(WithoutList without_list) {
  return {.name = "dampers", .without_list = without_list};
}

}  // namespace detail

// The columns of Run, of a section or of a part of one; empty for every other type.
template <class Owner>
inline constexpr std::tuple<> run_columns{};

template <>
inline constexpr auto run_columns<HalfCycles::Damper> =
    std::tuple{RunColumn{&HalfCycles::Damper::impacts, detail::count("impacts")}};

template <>
inline constexpr auto run_columns<HalfCycles> =
    std::tuple{RunColumn{&HalfCycles::zero_crossing, detail::instant("zero_crossing")},
               RunColumn{&HalfCycles::peak_time, detail::instant("peak_time")},
               RunColumn{&HalfCycles::amplitude, detail::length("amplitude", at_least(0))},
               RunColumn{&HalfCycles::impacts, detail::count("impacts")},
               RunColumn{&HalfCycles::dampers, detail::dampers(WithoutList::absent)}};

template <>
inline constexpr auto run_columns<Impacts> =
    std::tuple{RunColumn{&Impacts::time, detail::instant("time")},
               RunColumn{&Impacts::wall, detail::wall},
               RunColumn{&Impacts::relative_velocity, detail::velocity("relative_velocity")},
               RunColumn{&Impacts::phase_deg, {.name = "phase_deg", .range = within(0, 180)}},
               RunColumn{&Impacts::amplitude, detail::length("amplitude", at_least(0))},
               RunColumn{&Impacts::displacement, detail::length("displacement")},
               RunColumn{&Impacts::damper, detail::damper}};

template <>
inline constexpr auto run_columns<Contacts> =
    std::tuple{RunColumn{&Contacts::begin, detail::instant("begin", Order::ascending_for_each_damper)},
               RunColumn{&Contacts::end, detail::instant("end", Order::ascending_for_each_damper)},
               RunColumn{&Contacts::wall, detail::wall}, RunColumn{&Contacts::damper, detail::damper}};

template <>
inline constexpr auto run_columns<Energy> =
    std::tuple{RunColumn{&Energy::kinetic, detail::energy("kinetic")},
               RunColumn{&Energy::spring, detail::energy("spring")},
               RunColumn{&Energy::wall, detail::energy("wall")},
               RunColumn{&Energy::weight, detail::component("weight")},
               RunColumn{&Energy::total, detail::energy("total")},
               RunColumn{&Energy::paper, detail::energy("paper")}};

template <>
inline constexpr auto run_columns<DamperEnergy> =
    std::tuple{RunColumn{&DamperEnergy::initial_kinetic, detail::energy("initial_kinetic")},
               RunColumn{&DamperEnergy::final_kinetic, detail::energy("final_kinetic")},
               RunColumn{&DamperEnergy::impact_loss, detail::energy("impact_loss")},
               RunColumn{&DamperEnergy::contact_loss, detail::energy("contact_loss")},
               RunColumn{&DamperEnergy::bounce_down_loss, detail::energy("bounce_down_loss")},
               RunColumn{&DamperEnergy::bounce_downs, detail::count("bounce_downs")},
               RunColumn{&DamperEnergy::friction_loss, detail::component("friction_loss")},
               RunColumn{&DamperEnergy::drag_loss, detail::component("drag_loss")}};

template <>
inline constexpr auto run_columns<EnergyBalance> =
    std::tuple{RunColumn{&EnergyBalance::initial, {.name = "initial"}},
               RunColumn{&EnergyBalance::final, {.name = "final"}},
               RunColumn{&EnergyBalance::impact_loss, detail::energy("impact_loss")},
               RunColumn{&EnergyBalance::impact_loss_total, detail::energy("impact_loss_total")},
               RunColumn{&EnergyBalance::contact_loss, detail::energy("contact_loss")},
               RunColumn{&EnergyBalance::bounce_downs, detail::count("bounce_downs")},
               RunColumn{&EnergyBalance::bounce_down_loss, detail::energy("bounce_down_loss")},
               RunColumn{&EnergyBalance::viscous_work, detail::energy("viscous_work")},
               RunColumn{&EnergyBalance::forcing_work, detail::energy("forcing_work")},
               RunColumn{&EnergyBalance::friction_loss, detail::component("friction_loss")},
               RunColumn{&EnergyBalance::drag_loss, detail::component("drag_loss")},
               RunColumn{&EnergyBalance::residual, {.name = "residual"}},
               RunColumn{&EnergyBalance::dampers, detail::dampers(WithoutList::absent)}};

template <>
inline constexpr auto run_columns<History::Damper> =
    std::tuple{RunColumn{&History::Damper::y, detail::length("y")},
               RunColumn{&History::Damper::w, detail::velocity("w")}};

template <>
inline constexpr auto run_columns<History> =
    std::tuple{RunColumn{&History::time, detail::instant("time")},
               RunColumn{&History::x, detail::length("x")}, RunColumn{&History::v, detail::velocity("v")},
               RunColumn{&History::dampers, detail::dampers(WithoutList::in_section)}};

// The sections, each absent unless it was recorded.
template <>
inline constexpr auto run_columns<Run> =
    std::tuple{RunColumn{&Run::half_cycles, {.name = "half_cycles"}},
               RunColumn{&Run::impacts, {.name = "impacts"}}, RunColumn{&Run::contacts, {.name = "contacts"}},
               RunColumn{&Run::energy, {.name = "energy"}}, RunColumn{&Run::history, {.name = "history"}}};

template <class Type>
concept HasRunColumns = !std::same_as<decltype(run_columns<Type>), const std::tuple<>>;
template <class Type>
concept PartsOfDampers =
    HasRunColumns<typename Type::value_type> && std::same_as<Type, std::vector<typename Type::value_type>>;

// What decides which columns a run has: the length of its scene's list of dampers, 0 without one, and whether
// the scene has components.
struct RunShape {
  std::size_t listed = 0;
  bool has_components = false;
};
inline RunShape shape_of(const Scene& scene) { return {listed_dampers(scene), has_components(scene)}; }

// Calls visit(info, value) for each column that `owner` has in a run of that shape; a sum is passed as a
// temporary.
template <class Owner, class Visit>
void for_each_column(Owner& owner, const RunShape& shape, Visit&& visit) {
  const auto visit_one = [&](const auto& column) {
    if (column.info.of_components && !shape.has_components) return;
    if (shape.listed > 0 || column.info.without_list == WithoutList::same) {
      visit(column.info, std::invoke(column.member, owner));
    } else if constexpr (PartsOfDampers<typename std::remove_cvref_t<decltype(column)>::value_type>) {
      if (column.info.without_list == WithoutList::in_section)
        for (auto& damper : owner.*column.member) for_each_column(damper, shape, visit);
    }
  };
  std::apply([&](const auto&... columns) { (visit_one(columns), ...); },
             run_columns<std::remove_const_t<Owner>>);
}

// What files have as numbers: a wall, 0 for the left one, and a damper's index, from 1; in a run an int32_t
// is nothing else.
template <class Type>
concept NumberedInFiles = std::same_as<Type, Wall> || std::same_as<Type, std::int32_t>;

// Returns a wall or a damper's index as files have it, and any other value as it is.
template <NumberedInFiles Numbered>
std::int64_t in_file(const Numbered& value) {
  constexpr std::int64_t first = std::same_as<Numbered, std::int32_t> ? 1 : 0;
  return first + static_cast<std::int64_t>(value);
}
template <NumberedInFiles Numbered>
std::vector<std::int64_t> in_file(const std::vector<Numbered>& values) {
  std::vector<std::int64_t> numbers;
  numbers.reserve(values.size());
  for (const Numbered value : values) numbers.push_back(in_file(value));
  return numbers;
}
template <class Value>
const Value& in_file(const Value& value) {
  return value;
}

}  // namespace impact_damper
