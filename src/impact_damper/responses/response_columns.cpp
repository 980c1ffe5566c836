#include "impact_damper/responses/response_columns.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "impact_damper/analysis/design.hpp"

namespace impact_damper {
namespace {

using enum Dimension;
constexpr NumberRange any{}, counts = within(0, 9e15), flag = within(0, 1), periods = within(1, 64);

template <class Row>
RowColumns<Row> those_of(const RowColumns<Row>& table, std::size_t dampers) {
  const Scenes others = dampers > 0 ? Scenes::of_one_damper : Scenes::of_list;
  RowColumns<Row> columns;
  std::copy_if(table.begin(), table.end(), std::back_inserter(columns),
               [&](const RowColumn<Row>& each) { return each.scenes != others; });
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

RowColumns<SteadyState> steady_columns(std::size_t dampers) {
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
  return those_of(table, dampers);
}

RowColumns<OrbitPoint> orbit_columns(std::size_t dampers) {
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
      {"x", length, any, [](P& p) -> NumberCell { return &p.state.x; }},
      {"v", velocity, any, [](P& p) -> NumberCell { return &p.state.v; }},
      {"y", length, any, [](P& p) -> NumberCell { return &p.state.dampers[0].y; }, Scenes::of_one_damper},
      {"w", velocity, any, [](P& p) -> NumberCell { return &p.state.dampers[0].w; }, Scenes::of_one_damper},
  };
  return those_of(table, dampers);
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

}  // namespace impact_damper
