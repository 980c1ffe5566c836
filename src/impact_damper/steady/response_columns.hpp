// The columns of response files: written and read by the same table.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "impact_damper/base/text.hpp"
#include "impact_damper/steady/response_file.hpp"

namespace impact_damper {

// The SI unit of a column: its suffix, and the size in it of one dimensionless unit.
struct UnitInSi {
  std::string_view suffix;
  double (*size)(const SiUnits&);
};
UnitInSi unit_in_si_of(const SceneNumber& number);

// A column over rows of type Row. `get` returns nothing if the number belongs to a part of the row that is
// absent, such as its period or means.
template <class Row>
struct RowColumn {
  std::string_view name;
  UnitInSi unit;
  NumberRange range;  // of what a file may hold
  bool is_whole;
  // Whether the number may be absent although the part of the row to which it belongs is there.
  bool may_be_absent;
  std::optional<double> (*get)(const Row&);
  void (*set)(Row&, double);
};
// The columns of steady states and orbits. several: for a list of dampers, without y and w, which are in
// damper_columns().
std::span<const RowColumn<SteadyState>> steady_columns(bool several);
std::span<const RowColumn<OrbitPoint>> orbit_columns(bool several);
// One damper of a list in a steady state or an orbit.
struct DamperOfMotion {
  bool is_known = false;  // whether the impacts are known: not where a budget ended the run
  ImpactCounts impacts{};
  PlaceInCavity place{};
};
std::span<const RowColumn<DamperOfMotion>> damper_columns();
// The rows of one damper, by number, for the states of a way or the points of a branch.
std::vector<DamperOfMotion> of_damper(const std::vector<SteadyState>& way, std::size_t number);
std::vector<DamperOfMotion> of_damper(const std::vector<OrbitPoint>& points, std::size_t number);

// A column of numbers under a name.
struct Column {
  std::string_view name;
  UnitInSi unit;
  std::vector<std::optional<double>> numbers;
};
template <class Row>
std::vector<Column> columns_of(std::span<const RowColumn<Row>> table, const std::vector<Row>& rows) {
  std::vector<Column> columns;
  for (const RowColumn<Row>& each : table) {
    Column column{each.name, each.unit, {}};
    column.numbers.reserve(rows.size());
    for (const Row& row : rows) column.numbers.push_back(each.get(row));
    columns.push_back(std::move(column));
  }
  return columns;
}

// The amplitude without dampers and with their masses locked in, (M12.6), at each value of the axis. Absent
// at the resonance of an undamped oscillator, where it is infinite.
std::vector<Column> linear_columns(const Scene& scene, const Axis& axis);

// How the simulation at a value of a sweep ended: "periodic", "not_periodic" or the budget that ended it.
std::string_view end_of(const SteadyState& steady);

}  // namespace impact_damper
