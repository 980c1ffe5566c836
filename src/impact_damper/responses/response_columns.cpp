#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "impact_damper/analysis/design.hpp"
#include "impact_damper/io/csv.hpp"
#include "impact_damper/responses/response_fields.hpp"
#include "impact_damper/responses/response_file.hpp"

namespace impact_damper {
namespace {

using enum Dimension;
constexpr NumberRange any{}, counts = within(0, 9e15), flag = within(0, 1), periods = within(1, 64);

bool is_among(const Scene& scene, Scenes scenes) {
  switch (scenes) {
    case Scenes::all:
      return true;
    case Scenes::of_one_damper:
      return listed_dampers(scene) == 0;
    case Scenes::of_list:
      return listed_dampers(scene) > 0;
    case Scenes::with_friction:
      break;
  }
  return std::ranges::any_of(scene.dampers, [](const SceneDamper& each) { return each.holding() > 0; });
}
template <class Row>
RowColumns<Row> those_of(const RowColumns<Row>& table, const Scene& scene) {
  RowColumns<Row> columns;
  std::copy_if(table.begin(), table.end(), std::back_inserter(columns),
               [&](const RowColumn<Row>& each) { return is_among(scene, each.scenes); });
  return columns;
}

}  // namespace

std::optional<double> number_in(const NumberCell& cell) {
  return std::visit(
      [](const auto* number) {
        if constexpr (std::is_same_v<decltype(number), const std::optional<double>*>)
          return *number;
        else
          return number ? std::optional(double(*number)) : std::nullopt;
      },
      cell);
}

RowColumns<SteadyState> steady_columns(const Scene& scene) {
  using S = SteadyState;
  static const RowColumns<S> table{
      {"period", ratio, periods, [](S& s) -> NumberCell { return s.period ? &*s.period : nullptr; }},
      {"transient_periods", ratio, counts, [](S& s) -> NumberCell { return &s.transient_periods; }},
      {"contraction", ratio, flag, [](S& s) -> NumberCell { return &s.contraction; }},
      {"measured_periods", ratio, counts,
       [](S& s) -> NumberCell { return s.means ? &s.measured_periods : nullptr; }},
      {"impacts_left", ratio, counts,
       [](S& s) -> NumberCell { return s.means ? s.impacts.data() : nullptr; }},
      {"impacts_right", ratio, counts, [](S& s) -> NumberCell { return s.means ? &s.impacts[1] : nullptr; }},
      {"symmetric", ratio, flag, [](S& s) -> NumberCell { return s.means ? &s.symmetric : nullptr; }},
      {"amplitude", length, at_least(0),
       [](S& s) -> NumberCell { return s.means ? &s.means->amplitude : nullptr; }},
      {"amplitude_scatter", length, at_least(0),
       [](S& s) -> NumberCell { return s.means ? &s.amplitude_scatter : nullptr; }},
      {"fundamental", length, at_least(0),
       [](S& s) -> NumberCell { return s.means ? &s.means->fundamental : nullptr; }},
      {"lag_deg", ratio, within(-180, 180),
       [](S& s) -> NumberCell { return s.means ? &s.means->lag_deg : nullptr; }},
      {"power", power, any, [](S& s) -> NumberCell { return s.means ? &s.means->power : nullptr; }},
      {"power_scatter", power, at_least(0),
       [](S& s) -> NumberCell { return s.means ? &s.power_scatter : nullptr; }},
      {"viscous_power", power, any,
       [](S& s) -> NumberCell { return s.means ? &s.means->viscous_power : nullptr; }},
      {"impact_power", power, any,
       [](S& s) -> NumberCell { return s.means ? &s.means->impact_power : nullptr; }},
      {"x", length, any, [](S& s) -> NumberCell { return &s.state.x; }},
      {"v", velocity, any, [](S& s) -> NumberCell { return &s.state.v; }},
      {"y", length, any, [](S& s) -> NumberCell { return &s.state.dampers[0].y; }, Scenes::of_one_damper},
      {"w", velocity, any, [](S& s) -> NumberCell { return &s.state.dampers[0].w; }, Scenes::of_one_damper},
  };
  return those_of(table, scene);
}

RowColumns<OrbitPoint> orbit_columns(const Scene& scene) {
  using P = OrbitPoint;
  static const RowColumns<P> table{
      {"period", ratio, periods, [](P& p) -> NumberCell { return &p.period; }},
      {"symmetric", ratio, flag, [](P& p) -> NumberCell { return &p.symmetric; }},
      {"stable", ratio, flag, [](P& p) -> NumberCell { return &p.stable; }},
      {"impacts_left", ratio, counts, [](P& p) -> NumberCell { return p.impacts.data(); }},
      {"impacts_right", ratio, counts, [](P& p) -> NumberCell { return &p.impacts[1]; }},
      {"sticking", ratio, counts, [](P& p) -> NumberCell { return &p.sticking; }},
      {"amplitude", length, at_least(0), [](P& p) -> NumberCell { return &p.amplitude; }},
      {"multiplier_1_re", ratio, any, [](P& p) -> NumberCell { return &p.multipliers[0].re; }},
      {"multiplier_1_im", ratio, any, [](P& p) -> NumberCell { return &p.multipliers[0].im; }},
      {"multiplier_2_re", ratio, any, [](P& p) -> NumberCell { return &p.multipliers[1].re; }},
      {"multiplier_2_im", ratio, any, [](P& p) -> NumberCell { return &p.multipliers[1].im; }},
      {"multiplier_3_re", ratio, any, [](P& p) -> NumberCell { return &p.multipliers[2].re; }},
      {"multiplier_3_im", ratio, any, [](P& p) -> NumberCell { return &p.multipliers[2].im; }},
      {"multiplier_4_re", ratio, any, [](P& p) -> NumberCell { return &p.multipliers[3].re; }},
      {"multiplier_4_im", ratio, any, [](P& p) -> NumberCell { return &p.multipliers[3].im; }},
      {"slowest_impact", velocity, at_least(0), [](P& p) -> NumberCell { return &p.slowest_impact; }},
      {"nearest_miss", length, at_least(0), [](P& p) -> NumberCell { return &p.nearest_miss; }},
      {"least_interval", time, at_least(0), [](P& p) -> NumberCell { return &p.least_interval; },
       Scenes::of_list},
      {"stop_margin", acceleration, at_least(0), [](P& p) -> NumberCell { return &p.stop_margin; },
       Scenes::with_friction},
      {"x", length, any, [](P& p) -> NumberCell { return &p.state.x; }},
      {"v", velocity, any, [](P& p) -> NumberCell { return &p.state.v; }},
      {"y", length, any, [](P& p) -> NumberCell { return &p.state.dampers[0].y; }, Scenes::of_one_damper},
      {"w", velocity, any, [](P& p) -> NumberCell { return &p.state.dampers[0].w; }, Scenes::of_one_damper},
  };
  return those_of(table, scene);
}

DamperOfRow damper_of(SteadyState& steady, std::size_t number) {
  return {steady.means ? &steady.impacts_by_damper[number] : nullptr, &steady.state.dampers[number]};
}
DamperOfRow damper_of(OrbitPoint& point, std::size_t number) {
  return {&point.impacts_by_damper[number], &point.state.dampers[number]};
}
const RowColumns<DamperOfRow>& damper_columns() {
  using D = DamperOfRow;
  static const RowColumns<D> table{
      {"impacts_left", ratio, counts,
       [](D& d) -> NumberCell { return d.impacts ? d.impacts->data() : nullptr; }},
      {"impacts_right", ratio, counts,
       [](D& d) -> NumberCell { return d.impacts ? d.impacts->data() + 1 : nullptr; }},
      {"y", length, any, [](D& d) -> NumberCell { return &d.place->y; }},
      {"w", velocity, any, [](D& d) -> NumberCell { return &d.place->w; }},
  };
  return table;
}

std::vector<Column> linear_columns(const Scene& scene, const Axis& axis) {
  Column empty{"empty_amplitude", length, {}}, locked{"locked_amplitude", length, {}};
  for (std::int64_t i = 0; i < axis.count; ++i) {
    const Scene there = axis.at(scene, i);
    const auto add = [&](Column& column, double mass) {
      const double amplitude =
          linear_response(there.force_amplitude, mass, there.damping_ratio, there.force_frequency);
      column.numbers.push_back(std::isfinite(amplitude) ? std::optional(amplitude) : std::nullopt);
    };
    add(empty, 1);
    add(locked, 1 + secondary_mass(there));
  }
  return {empty, locked};
}

namespace {

using Words = std::vector<std::string>;
using Numbers = std::vector<std::optional<double>>;

template <class Row>
void add(CsvTable& table, const RowColumns<Row>& columns, std::vector<Row>& rows,
         const std::string& after_name = {}) {
  for (const RowColumn<Row>& each : columns) {
    Numbers numbers;
    for (Row& row : rows) numbers.push_back(number_in(each.cell_in(row)));
    table.add(std::string(each.name) + after_name, each.dimension, numbers);
  }
}
// Adds the columns of each damper of a list.
template <class Row>
void add_dampers(CsvTable& table, std::size_t dampers, std::vector<Row>& rows) {
  for (std::size_t d = 0; d < dampers; ++d) {
    std::vector<DamperOfRow> parts = dampers_of(rows, d);
    add(table, damper_columns(), parts, '_' + std::to_string(d + 1));
  }
}

void add(CsvTable& table, const SweepResponse& response) {
  Words numbers, ways, ends;
  std::vector<SteadyState> states;
  for (std::size_t n = 0; n < response.sweeps.size(); ++n) {
    const Sweep& sweep = response.sweeps[n];
    for (const auto& [name, way] : {std::pair("up", &sweep.up), std::pair("down", &sweep.down)}) {
      for (const SteadyState& each : *way) {
        numbers.push_back(std::to_string(n));
        ways.emplace_back(name);
        ends.emplace_back(end_of(each));
        states.push_back(each);
      }
    }
  }
  const Axis& axis = response.axis;
  const std::size_t dampers = listed_dampers(response.scene);
  table.add("sweep", numbers);
  table.add("way", ways);
  table.add(name_of(axis.number), field_of(axis.number).dimension, axis.values());
  table.add("end", ends);
  add(table, steady_columns(response.scene), states);
  add_dampers(table, dampers, states);
  for (const Column& column : linear_columns(response.scene, axis))
    table.add(std::string(column.name), column.dimension, column.numbers);
}

void add(CsvTable& table, const BasinResponse& response) {
  const Axis &first = response.first, &second = response.second;
  const std::vector<std::int32_t>& attractor = response.basin.attractor;
  std::vector<double> of_first, of_second;
  Words attractors;
  for (std::size_t n = 0; n < attractor.size(); ++n) {
    of_first.push_back(first.value(std::int64_t(n) % first.count));
    of_second.push_back(second.value(std::int64_t(n) / first.count));
    attractors.push_back(std::to_string(attractor[n]));
  }
  table.add(name_of(first.number), field_of(first.number).dimension, of_first);
  table.add(name_of(second.number), field_of(second.number).dimension, of_second);
  table.add("attractor", attractors);
}

void add(CsvTable& table, const OrbitsResponse& response) {
  Words numbers, events;
  std::vector<double> values;
  std::vector<OrbitPoint> points;
  for (std::size_t n = 0; n < response.branches.size(); ++n) {
    const OrbitBranch& branch = response.branches[n];
    const auto add_row = [&](std::string_view event, const OrbitPoint& point) {
      numbers.push_back(std::to_string(n));
      events.emplace_back(event);
      values.push_back(point.value);
      points.push_back(point);
    };
    for (std::size_t i = 0; i <= branch.points.size(); ++i) {
      for (const OrbitEvent& event : branch.events)
        if (event.points_before == std::int64_t(i)) add_row(name_of(event.kind), event);
      if (i < branch.points.size()) add_row("", branch.points[i]);
    }
  }
  const Parameter parameter = response.range.parameter;
  const std::size_t dampers = listed_dampers(response.scene);
  table.add("branch", numbers);
  table.add("event", events);
  table.add(std::string(name_of(parameter)), field_of(member_of(parameter)).dimension, values);
  add(table, orbit_columns(response.scene), points);
  add_dampers(table, dampers, points);
}

void add(CsvTable& table, const LyapunovResponse& response) {
  const LyapunovExponents& found = response.found;
  Numbers errors(found.standard_errors.begin(), found.standard_errors.end());
  errors.resize(found.exponents.size());  // there are none for less than ten periods
  table.add("exponent", Dimension::rate, found.exponents);
  table.add("standard_error", Dimension::rate, errors);
}

}  // namespace

std::string response_csv(const Response& response, const std::optional<Scales>& scales) {
  CsvTable table("response", scales);
  std::visit([&](const auto& each) { add(table, each); }, response);
  return table.text();
}

}  // namespace impact_damper
