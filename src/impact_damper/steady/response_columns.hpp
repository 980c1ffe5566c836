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

// What a column measures: its suffix in SI, and what one dimensionless unit of it is there.
struct UnitInSi {
  std::string_view suffix;
  double (*size)(const SiUnits&);
};
UnitInSi unit_in_si_of(const SceneNumber& number);

// A column over rows of some kind. Of a row whose period, means or other numbers are absent `get` is absent
// where the number belongs to them.
template <class Row>
struct RowColumn {
  std::string_view name;
  UnitInSi unit;
  NumberRange range;  // of what a file may hold
  bool is_whole;
  // Whether a number may be absent on its own, not only where `get` of a row says so whose other numbers are
  // read.
  bool may_be_absent;
  std::optional<double> (*get)(const Row&);
  void (*set)(Row&, double);
};
// Of a scene with several dampers without y and w, which each of them has for itself: damper_columns().
std::span<const RowColumn<SteadyState>> steady_columns(bool several);
std::span<const RowColumn<OrbitPoint>> orbit_columns(bool several);
// What one of several dampers does in a steady state or an orbit.
struct DamperOfMotion {
  bool is_known = false;  // whether the impacts are: not where a budget ended the run
  ImpactCounts impacts{};
  PlaceInCavity place{};
};
std::span<const RowColumn<DamperOfMotion>> damper_columns();
// Of the states of a way, or of the points of a branch, those of one damper, by number.
std::vector<DamperOfMotion> of_damper(const std::vector<SteadyState>& way, std::size_t number);
std::vector<DamperOfMotion> of_damper(const std::vector<OrbitPoint>& points, std::size_t number);

// Numbers under a name.
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

// The amplitude without dampers and with their masses locked in, (M12.6), at each value of the axis. Infinite
// at the resonance of an undamped oscillator: absent.
std::vector<Column> linear_columns(const Scene& scene, const Axis& axis);

// What happened at a value of a sweep, in a word: "periodic", "not_periodic" or the budget that ended it.
std::string_view end_of(const SteadyState& steady);

}  // namespace impact_damper
