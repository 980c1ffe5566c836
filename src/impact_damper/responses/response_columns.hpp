// The columns of responses: one table for each kind of row, by which files are written and read, and CSV is
// written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "impact_damper/base/text.hpp"
#include "impact_damper/responses/responses.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// Where a row has a number of a column; null if the number belongs to a part of the row that is absent, such
// as its period or means. An optional number may itself be absent. Integers and flags are whole numbers in a
// file.
using NumberCell = std::variant<double*, std::int64_t*, bool*, std::optional<double>*>;
std::optional<double> number_in(const NumberCell& cell);

enum class Scenes { all, of_one_damper, of_list };
template <class Row>
struct RowColumn {
  std::string_view name;
  Dimension dimension;
  NumberRange range;  // of what a file may hold
  NumberCell (*cell_in)(Row&);
  Scenes scenes = Scenes::all;  // that have the column
};
template <class Row>
using RowColumns = std::vector<RowColumn<Row>>;
// The columns of steady states and orbits. dampers: length of the scene's list.
RowColumns<SteadyState> steady_columns(std::size_t dampers);
RowColumns<OrbitPoint> orbit_columns(std::size_t dampers);

// The part of a row that one damper of a list has.
struct DamperOfRow {
  ImpactCounts* impacts = nullptr;  // null where a budget ended the run
  PlaceInCavity* place = nullptr;
};
DamperOfRow damper_of(SteadyState& steady, std::size_t number);
DamperOfRow damper_of(OrbitPoint& point, std::size_t number);
template <class Row>
std::vector<DamperOfRow> dampers_of(std::vector<Row>& rows, std::size_t number) {
  std::vector<DamperOfRow> parts;
  parts.reserve(rows.size());
  for (Row& row : rows) parts.push_back(damper_of(row, number));
  return parts;
}
const RowColumns<DamperOfRow>& damper_columns();

// A column whose numbers follow from the scene and the axis.
struct Column {
  std::string_view name;
  Dimension dimension;
  std::vector<std::optional<double>> numbers;
};
// The amplitude without dampers and with their masses locked in, (M12.6), at each value of the axis. Absent
// at the resonance of an undamped oscillator, where it is infinite.
std::vector<Column> linear_columns(const Scene& scene, const Axis& axis);

}  // namespace impact_damper
