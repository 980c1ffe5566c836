#include "impact_damper/steady/response_columns.hpp"

#include <cmath>

#include "impact_damper/analysis/design.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

constexpr UnitInSi ratio{"", [](const SiUnits&) { return 1.0; }};
constexpr UnitInSi length{"_m", [](const SiUnits& u) { return u.length; }};
constexpr UnitInSi velocity{"_m_per_s", [](const SiUnits& u) { return u.velocity; }};
constexpr UnitInSi force{"_N", [](const SiUnits& u) { return u.force; }};
constexpr UnitInSi time{"_s", [](const SiUnits& u) { return u.time; }};
constexpr UnitInSi power{"_W", [](const SiUnits& u) { return u.energy / u.time; }};
constexpr UnitInSi frequency{"_Hz", [](const SiUnits& u) { return 1 / (2 * half_turn<double>() * u.time); }};

constexpr NumberRange any{}, counts = within(0, 9e15);

// A number that every row has.
template <class Row>
RowColumn<Row> always(std::string_view name, const UnitInSi& unit, NumberRange range,
                      std::optional<double> (*get)(const Row&), void (*set)(Row&, double)) {
  return {name, unit, range, false, false, get, set};
}
template <class Row>
RowColumn<Row> whole(RowColumn<Row> column) {
  column.is_whole = true;
  return column;
}
template <class Row>
RowColumn<Row> optional(RowColumn<Row> column) {
  column.may_be_absent = true;
  return column;
}

// The component `member` of the state of a steady state or of an orbit's point.
template <class Row, auto member>
RowColumn<Row> of_state(std::string_view name, const UnitInSi& unit) {
  return always<Row>(
      name, unit, any, [](const Row& row) { return std::optional(row.state.*member); },
      [](Row& row, double value) { row.state.*member = value; });
}
// A number that is absent where a budget ended the run.
template <auto member>
RowColumn<SteadyState> mean(std::string_view name, const UnitInSi& unit, NumberRange range) {
  return always<SteadyState>(
      name, unit, range,
      [](const SteadyState& s) { return s.means ? std::optional((*s.means).*member) : std::nullopt; },
      [](SteadyState& s, double value) {
        if (s.means) (*s.means).*member = value;
      });
}
template <auto member>
RowColumn<SteadyState> measured(std::string_view name, const UnitInSi& unit, NumberRange range) {
  return always<SteadyState>(
      name, unit, range,
      [](const SteadyState& s) { return s.means ? std::optional(double(s.*member)) : std::nullopt; },
      [](SteadyState& s, double value) { s.*member = std::remove_reference_t<decltype(s.*member)>(value); });
}
template <std::size_t wall>
RowColumn<SteadyState> impacts_on(std::string_view name) {
  return whole(always<SteadyState>(
      name, ratio, counts,
      [](const SteadyState& s) { return s.means ? std::optional(double(s.impacts[wall])) : std::nullopt; },
      [](SteadyState& s, double value) { s.impacts[wall] = std::int64_t(value); }));
}

// The impacts of one damper of a list on a wall.
template <std::size_t wall>
RowColumn<DamperOfMotion> of_damper_impacts(std::string_view name) {
  using D = DamperOfMotion;
  return whole(always<D>(
      name, ratio, counts,
      [](const D& d) { return d.is_known ? std::optional(double(d.impacts[wall])) : std::nullopt; },
      [](D& d, double value) { d.impacts[wall] = std::int64_t(value); }));
}
template <auto member>
RowColumn<DamperOfMotion> of_place(std::string_view name, const UnitInSi& unit) {
  using D = DamperOfMotion;
  return always<D>(
      name, unit, any, [](const D& d) { return std::optional(d.place.*member); },
      [](D& d, double value) { d.place.*member = value; });
}

// A number of an orbit's point.
template <auto member>
RowColumn<OrbitPoint> of_point(std::string_view name, const UnitInSi& unit, NumberRange range) {
  return always<OrbitPoint>(
      name, unit, range, [](const OrbitPoint& p) { return std::optional(double(p.*member)); },
      [](OrbitPoint& p, double value) { p.*member = std::remove_reference_t<decltype(p.*member)>(value); });
}
template <auto member>
RowColumn<OrbitPoint> distance_of(std::string_view name, const UnitInSi& unit) {
  return optional(always<OrbitPoint>(
      name, unit, at_least(0), [](const OrbitPoint& p) { return p.*member; },
      [](OrbitPoint& p, double value) { p.*member = value; }));
}
template <std::size_t wall>
RowColumn<OrbitPoint> impacts_at(std::string_view name) {
  return whole(always<OrbitPoint>(
      name, ratio, counts, [](const OrbitPoint& p) { return std::optional(double(p.impacts[wall])); },
      [](OrbitPoint& p, double value) { p.impacts[wall] = std::int64_t(value); }));
}
template <std::size_t i, auto part>
RowColumn<OrbitPoint> multiplier(std::string_view name) {
  return always<OrbitPoint>(
      name, ratio, any, [](const OrbitPoint& p) { return std::optional(p.multipliers[i].*part); },
      [](OrbitPoint& p, double value) { p.multipliers[i].*part = value; });
}

template <class Motion, class IsKnown>
std::vector<DamperOfMotion> of_damper_in(const std::vector<Motion>& motions, std::size_t number,
                                         IsKnown&& is_known) {
  std::vector<DamperOfMotion> rows;
  rows.reserve(motions.size());
  for (const Motion& each : motions) {
    DamperOfMotion& row = rows.emplace_back();
    row.is_known = is_known(each);
    if (number < each.impacts_by_damper.size()) row.impacts = each.impacts_by_damper[number];
    row.place = each.state.dampers[number];
  }
  return rows;
}

}  // namespace

UnitInSi unit_in_si_of(const SceneNumber& number) {
  if (const auto its = number.of_damper) {
    if (its == &SceneDamper::y0 || its == &SceneDamper::clearance) return length;
    return its == &SceneDamper::w0 ? velocity : ratio;
  }
  if (number.is(&Scene::x0) || number.is(&Scene::y0)) return length;
  if (number.is(&Scene::v0) || number.is(&Scene::w0)) return velocity;
  if (number.is(&Scene::force_amplitude)) return force;
  if (number.is(&Scene::force_frequency)) return frequency;
  return ratio;
}

std::string_view end_of(const SteadyState& steady) {
  if (steady.stop_reason != StopReason::time) return name_of(steady.stop_reason);
  return steady.period ? "periodic" : "not_periodic";
}

std::span<const RowColumn<SteadyState>> steady_columns(bool several) {
  using S = SteadyState;
  static const std::array table{
      whole(always<S>(
          "period", ratio, within(1, 64),
          [](const S& s) { return s.period ? std::optional(double(*s.period)) : std::nullopt; },
          [](S& s, double value) { s.period = std::int64_t(value); })),
      whole(always<S>(
          "transient_periods", ratio, counts,
          [](const S& s) { return std::optional(double(s.transient_periods)); },
          [](S& s, double value) { s.transient_periods = std::int64_t(value); })),
      optional(always<S>(
          "contraction", ratio, within(0, 1), [](const S& s) { return s.contraction; },
          [](S& s, double value) { s.contraction = value; })),
      whole(measured<&S::measured_periods>("measured_periods", ratio, counts)),
      impacts_on<0>("impacts_left"),
      impacts_on<1>("impacts_right"),
      whole(measured<&S::symmetric>("symmetric", ratio, within(0, 1))),
      mean<&SteadyMeans::amplitude>("amplitude", length, at_least(0)),
      measured<&S::amplitude_scatter>("amplitude_scatter", length, at_least(0)),
      mean<&SteadyMeans::fundamental>("fundamental", length, at_least(0)),
      mean<&SteadyMeans::lag_deg>("lag_deg", ratio, within(-180, 180)),
      mean<&SteadyMeans::power>("power", power, any),
      measured<&S::power_scatter>("power_scatter", power, at_least(0)),
      mean<&SteadyMeans::viscous_power>("viscous_power", power, any),
      mean<&SteadyMeans::impact_power>("impact_power", power, any),
      of_state<S, &State<double>::x>("x", length),
      of_state<S, &State<double>::v>("v", velocity),
      of_state<S, &State<double>::y>("y", length),
      of_state<S, &State<double>::w>("w", velocity),
  };
  return std::span(table).first(table.size() - (several ? 2 : 0));
}

std::span<const RowColumn<DamperOfMotion>> damper_columns() {
  static const std::array table{of_damper_impacts<0>("impacts_left"), of_damper_impacts<1>("impacts_right"),
                                of_place<&PlaceInCavity::y>("y", length),
                                of_place<&PlaceInCavity::w>("w", velocity)};
  return table;
}

std::vector<DamperOfMotion> of_damper(const std::vector<SteadyState>& way, std::size_t number) {
  return of_damper_in(way, number, [](const SteadyState& steady) { return steady.means.has_value(); });
}
std::vector<DamperOfMotion> of_damper(const std::vector<OrbitPoint>& points, std::size_t number) {
  return of_damper_in(points, number, [](const OrbitPoint&) { return true; });
}

std::span<const RowColumn<OrbitPoint>> orbit_columns(bool several) {
  using P = OrbitPoint;
  static const std::array table{
      whole(of_point<&P::period>("period", ratio, within(1, 64))),
      whole(of_point<&P::symmetric>("symmetric", ratio, within(0, 1))),
      whole(of_point<&P::stable>("stable", ratio, within(0, 1))),
      impacts_at<0>("impacts_left"),
      impacts_at<1>("impacts_right"),
      whole(of_point<&P::sticking>("sticking", ratio, counts)),
      of_point<&P::amplitude>("amplitude", length, at_least(0)),
      multiplier<0, &Multiplier::re>("multiplier_1_re"),
      multiplier<0, &Multiplier::im>("multiplier_1_im"),
      multiplier<1, &Multiplier::re>("multiplier_2_re"),
      multiplier<1, &Multiplier::im>("multiplier_2_im"),
      multiplier<2, &Multiplier::re>("multiplier_3_re"),
      multiplier<2, &Multiplier::im>("multiplier_3_im"),
      multiplier<3, &Multiplier::re>("multiplier_4_re"),
      multiplier<3, &Multiplier::im>("multiplier_4_im"),
      distance_of<&P::slowest_impact>("slowest_impact", velocity),
      distance_of<&P::nearest_miss>("nearest_miss", length),
      of_state<P, &State<double>::x>("x", length),
      of_state<P, &State<double>::v>("v", velocity),
      of_state<P, &State<double>::y>("y", length),
      of_state<P, &State<double>::w>("w", velocity),
  };
  static const std::vector<RowColumn<P>> table_of_several = [] {
    std::vector<RowColumn<P>> columns(table.begin(), table.end() - 2);
    columns.insert(columns.end() - 2, distance_of<&P::least_interval>("least_interval", time));
    return columns;
  }();
  if (several) return table_of_several;
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
