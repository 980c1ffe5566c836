#include "impact_damper/steady/response_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "impact_damper/analysis/design.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

using Layout = JsonWriter::Layout;
using Numbers = std::vector<std::optional<double>>;

// What a column measures: its suffix in SI, and what one dimensionless unit of it is there.
struct Quantity {
  std::string_view suffix;
  double (*unit)(const SiUnits&);
};
constexpr Quantity ratio{"", [](const SiUnits&) { return 1.0; }};
constexpr Quantity length{"_m", [](const SiUnits& u) { return u.length; }};
constexpr Quantity velocity{"_m_per_s", [](const SiUnits& u) { return u.velocity; }};
constexpr Quantity force{"_N", [](const SiUnits& u) { return u.force; }};
constexpr Quantity power{"_W", [](const SiUnits& u) { return u.energy / u.time; }};
constexpr Quantity rate{"_per_s", [](const SiUnits& u) { return 1 / u.time; }};
constexpr Quantity frequency{"_Hz", [](const SiUnits& u) { return 1 / (2 * half_turn<double>() * u.time); }};

Quantity quantity_of(const double Scene::*number) {
  if (number == &Scene::x0 || number == &Scene::y0) return length;
  if (number == &Scene::v0 || number == &Scene::w0) return velocity;
  if (number == &Scene::force_amplitude) return force;
  if (number == &Scene::force_frequency) return frequency;
  return ratio;
}

struct Column {
  std::string_view name;
  Quantity quantity;
  Numbers numbers;
};

// What happened at each value, in a word.
std::string_view end_of(const SteadyState& steady) {
  if (steady.stop_reason != StopReason::time) return name_of(steady.stop_reason);
  return steady.period ? "periodic" : "not_periodic";
}

std::vector<Column> columns_of(const std::vector<SteadyState>& way) {
  std::vector<Column> columns;
  const auto add = [&](std::string_view name, const Quantity& quantity, auto&& number) {
    Column column{name, quantity, {}};
    for (const SteadyState& each : way) column.numbers.push_back(number(each));
    columns.push_back(std::move(column));
  };
  const auto add_mean = [&](std::string_view name, const Quantity& quantity, double SteadyMeans::*number) {
    add(name, quantity, [&](const SteadyState& s) -> std::optional<double> {
      if (!s.means) return std::nullopt;
      return (*s.means).*number;
    });
  };
  // What is not known where a budget ended a run.
  const auto add_measured = [&](std::string_view name, const Quantity& quantity, auto&& number) {
    add(name, quantity, [&](const SteadyState& s) -> std::optional<double> {
      if (!s.means) return std::nullopt;
      return double(number(s));
    });
  };
  add("period", ratio, [](const SteadyState& s) -> std::optional<double> {
    if (!s.period) return std::nullopt;
    return double(*s.period);
  });
  add("transient_periods", ratio, [](const SteadyState& s) { return double(s.transient_periods); });
  add("contraction", ratio, [](const SteadyState& s) { return s.contraction; });
  add_measured("measured_periods", ratio, [](const SteadyState& s) { return s.measured_periods; });
  add_measured("impacts_left", ratio, [](const SteadyState& s) { return s.impacts[0]; });
  add_measured("impacts_right", ratio, [](const SteadyState& s) { return s.impacts[1]; });
  add_measured("symmetric", ratio, [](const SteadyState& s) { return s.symmetric; });
  add_mean("amplitude", length, &SteadyMeans::amplitude);
  add_measured("amplitude_scatter", length, [](const SteadyState& s) { return s.amplitude_scatter; });
  add_mean("fundamental", length, &SteadyMeans::fundamental);
  add_mean("lag_deg", ratio, &SteadyMeans::lag_deg);
  add_mean("power", power, &SteadyMeans::power);
  add_measured("power_scatter", power, [](const SteadyState& s) { return s.power_scatter; });
  add_mean("viscous_power", power, &SteadyMeans::viscous_power);
  add_mean("impact_power", power, &SteadyMeans::impact_power);
  add("x", length, [](const SteadyState& s) { return s.state.x; });
  add("v", velocity, [](const SteadyState& s) { return s.state.v; });
  add("y", length, [](const SteadyState& s) { return s.state.y; });
  add("w", velocity, [](const SteadyState& s) { return s.state.w; });
  return columns;
}

// A point of a branch, or an event on it.
struct BranchPoint {
  const Orbit* orbit;
  double value, amplitude;
  std::string_view event{};
};

std::vector<BranchPoint> points_of(const FollowedBranch& followed, double Scene::*number) {
  std::vector<BranchPoint> points;
  for (std::size_t i = 0; i < followed.branch.orbits.size(); ++i) {
    const Orbit& orbit = followed.branch.orbits[i];
    points.push_back({&orbit, orbit.scene.*number, followed.amplitudes[i]});
  }
  return points;
}
BranchPoint point_of_event(const FollowedBranch& followed, std::size_t i) {
  const BranchEvent& event = followed.branch.events[i];
  return {&event.orbit, event.parameter, followed.event_amplitudes[i], name_of(event.kind)};
}
// All of them, in their order along the branch.
std::vector<BranchPoint> points_and_events_of(const FollowedBranch& followed, double Scene::*number) {
  const std::vector<BranchPoint> points = points_of(followed, number);
  std::vector<BranchPoint> all;
  for (std::size_t i = 0; i <= points.size(); ++i) {
    for (std::size_t n = 0; n < followed.branch.events.size(); ++n)
      if (followed.branch.events[n].orbits_before == std::int64_t(i))
        all.push_back(point_of_event(followed, n));
    if (i < points.size()) all.push_back(points[i]);
  }
  return all;
}

double impacts_on(Wall wall, const Orbit& orbit) {
  return double(std::ranges::count(orbit.impacts, wall, &OrbitImpact::wall));
}

std::vector<Column> columns_of(const std::vector<BranchPoint>& points) {
  std::vector<Column> columns;
  const auto add = [&](std::string_view name, const Quantity& quantity, auto&& number) {
    Column column{name, quantity, {}};
    for (const BranchPoint& each : points) column.numbers.push_back(number(*each.orbit));
    columns.push_back(std::move(column));
  };
  add("period", ratio, [](const Orbit& o) { return double(o.periods); });
  add("symmetric", ratio, [](const Orbit& o) { return double(o.symmetric); });
  add("stable", ratio, [](const Orbit& o) { return double(o.stable()); });
  add("impacts_left", ratio, [](const Orbit& o) { return impacts_on(Wall::left, o); });
  add("impacts_right", ratio, [](const Orbit& o) { return impacts_on(Wall::right, o); });
  add("sticking", ratio, [](const Orbit& o) { return double(o.sticking); });
  Column amplitudes{"amplitude", length, {}};
  for (const BranchPoint& each : points) amplitudes.numbers.push_back(each.amplitude);
  columns.push_back(std::move(amplitudes));
  static constexpr std::array<std::array<std::string_view, 2>, 4> names{
      {{"multiplier_1_re", "multiplier_1_im"},
       {"multiplier_2_re", "multiplier_2_im"},
       {"multiplier_3_re", "multiplier_3_im"},
       {"multiplier_4_re", "multiplier_4_im"}}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    add(names[i][0], ratio, [&](const Orbit& o) { return o.multipliers[i].re; });
    add(names[i][1], ratio, [&](const Orbit& o) { return o.multipliers[i].im; });
  }
  add("slowest_impact", velocity, [](const Orbit& o) { return o.slowest_impact; });
  add("nearest_miss", length, [](const Orbit& o) { return o.nearest_miss; });
  add("x", length, [](const Orbit& o) { return o.scene.x0; });
  add("v", velocity, [](const Orbit& o) { return o.scene.v0; });
  add("y", length, [](const Orbit& o) { return o.scene.y0; });
  add("w", velocity, [](const Orbit& o) { return o.scene.w0; });
  return columns;
}

// The amplitude without the damper and with its mass locked in, (M12.6), at each value of the axis. Infinite
// at the resonance of an undamped oscillator: absent.
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
    add(locked, 1 + there.mass_ratio);
  }
  return {empty, locked};
}

void write_rule(JsonWriter& out, const SteadyRule& rule) {
  out.fields("tolerance", rule.tolerance, "longest_period", rule.longest_period, "max_periods",
             rule.max_periods);
}

std::string_view key_of(double Scene::*number) {
  return std::ranges::find(scene_fields, number, &SceneField::member)->name;
}

void write_axis(JsonWriter& out, const Axis& axis) {
  out.fields("number", key_of(axis.number), "from", axis.from, "to", axis.to, "count", axis.count);
}

std::optional<double> index_of(const std::optional<std::int64_t>& index) {
  return index ? std::optional(double(*index)) : std::nullopt;
}

void write_state(JsonWriter& out, std::string_view name, const State<double>& s) {
  out.object(name, Layout::one_line, "x", s.x, "v", s.v, "y", s.y, "w", s.w);
}

void write_way(JsonWriter& out, std::string_view name, const std::vector<SteadyState>& way) {
  out.open_object(name, Layout::lines);
  std::vector<std::string> ends;
  ends.reserve(way.size());
  for (const SteadyState& each : way) ends.emplace_back(end_of(each));
  out.field("end", ends);
  for (const Column& column : columns_of(way)) out.field(column.name, column.numbers);
  out.close();
}

void write_branch(JsonWriter& out, const FollowedBranch& followed, double Scene::*number) {
  const Branch& branch = followed.branch;
  out.open_object(Layout::lines);
  out.fields("origin", name_of(followed.origin), "from", followed.from, "event", index_of(followed.event),
             "end", name_of(branch.end));
  const std::vector<BranchPoint> points = points_of(followed, number);
  std::vector<double> values;
  values.reserve(points.size());
  for (const BranchPoint& each : points) values.push_back(each.value);
  out.field("values", values);
  for (const Column& column : columns_of(points)) out.field(column.name, column.numbers);
  out.open_array("events", Layout::lines);
  for (const BranchEvent& event : branch.events) {
    out.open_object(Layout::one_line);
    out.fields("kind", name_of(event.kind), "value", event.parameter, "points_before", event.orbits_before);
    write_state(out, "state", release_of(event.orbit.scene));
    out.close();
  }
  out.close();
  out.close();
}

// What all kinds of file begin with. The stops of a scene do not count, and are not written.
JsonWriter begun(std::string_view kind, const Scene& scene, const Engine& engine,
                 const std::optional<Scales>& scales) {
  JsonWriter out("response");
  out.open_object(Layout::lines);
  out.fields("schema", response_schema, "kind", kind);
  out.open_object("scene", Layout::one_line);
  for (const SceneField& field : scene_fields) out.field(field.name, scene.*field.member);
  out.close();
  write_engine(out, engine);
  if (scales) write_units(out, si_units_of(*scales));
  return out;
}

std::string ended(JsonWriter& out) {
  write_provenance(out);
  return sealed(out.finish());
}

class CsvRow {
 public:
  CsvRow(std::string& text, const std::optional<SiUnits>& units) : text_(text), units_(units) {}
  ~CsvRow() { text_ += '\n'; }
  CsvRow(const CsvRow&) = delete;
  CsvRow& operator=(const CsvRow&) = delete;

  void word(std::string_view word) {
    if (!first_) text_ += ',';
    first_ = false;
    text_ += word;
  }
  void heading(std::string_view name, const Quantity& quantity) {
    word(std::string(name) + std::string(units_ ? quantity.suffix : ""));
  }
  void number(const std::optional<double>& value, const Quantity& quantity) {
    word("");
    if (value) append_number(text_, units_ ? *value * quantity.unit(*units_) : *value);
  }

 private:
  std::string& text_;
  const std::optional<SiUnits>& units_;
  bool first_ = true;
};

}  // namespace

std::string_view name_of(const Axis& axis) { return key_of(axis.number); }

std::string sweep_text(const Scene& scene, const Engine& engine, const SteadyRule& rule, const Axis& axis,
                       const std::vector<Sweep>& sweeps, const std::optional<Scales>& scales) {
  JsonWriter out = begun("sweep", scene, engine, scales);
  out.open_object("rule", Layout::one_line);
  write_rule(out, rule);
  out.field("mean_periods", rule.mean_periods);
  out.close();
  out.open_object("axis", Layout::one_line);
  write_axis(out, axis);
  out.close();
  out.field("values", axis.values());
  for (const Column& column : linear_columns(scene, axis)) out.field(column.name, column.numbers);
  out.open_array("sweeps", Layout::lines);
  for (const Sweep& sweep : sweeps) {
    out.open_object(Layout::lines);
    write_state(out, "start", sweep.start);
    write_way(out, "up", sweep.up);
    write_way(out, "down", sweep.down);
    out.close();
  }
  out.close();
  return ended(out);
}

std::string basin_text(const Scene& scene, const Engine& engine, const BasinRule& rule, const Axis& first,
                       const Axis& second, const Basin& basin, const std::optional<Scales>& scales) {
  JsonWriter out = begun("basin", scene, engine, scales);
  out.open_object("rule", Layout::one_line);
  write_rule(out, rule.steady);
  out.field("capture_radius", rule.capture_radius);
  out.close();
  out.open_array("axes", Layout::lines);
  for (const Axis* axis : {&first, &second}) {
    out.open_object(Layout::one_line);
    write_axis(out, *axis);
    out.close();
  }
  out.close();
  out.open_array("attractors", Layout::lines);
  for (const Attractor& each : basin.attractors) {
    out.open_object(Layout::one_line);
    out.fields("idle", each.idle, "period", each.period, "impacts_left", each.impacts[0], "impacts_right",
               each.impacts[1], "symmetric", each.symmetric, "points", each.points);
    if (!each.states.empty()) write_state(out, "state", each.states.front());
    out.close();
  }
  out.close();
  out.field("undecided", std::int64_t(std::ranges::count(basin.attractor, undecided)));
  out.field("attractor", std::vector<std::int64_t>(basin.attractor.begin(), basin.attractor.end()));
  return ended(out);
}

std::string orbits_text(const Scene& scene, const Engine& engine, const BranchRule& rule,
                        const ParameterRange& range, const Branches& branches,
                        const std::optional<Scales>& scales) {
  double Scene::*const number = member_of(range.parameter);
  JsonWriter out = begun("orbits", scene, engine, scales);
  out.open_object("rule", Layout::one_line);
  write_rule(out, rule.steady);
  out.fields("largest_step", rule.largest_step, "max_multiplier", rule.max_multiplier, "max_points",
             rule.max_points, "max_branches", rule.max_branches);
  out.close();
  out.object("range", Layout::one_line, "number", key_of(number), "from", range.from, "to", range.to);
  out.open_array("starts", Layout::lines);
  for (const BranchStart& start : branches.starts) {
    out.open_object(Layout::one_line);
    out.fields("end", end_of(start), "transient_periods", start.steady.transient_periods, "branch",
               index_of(start.branch));
    write_state(out, "state", start.state);
    out.close();
  }
  out.close();
  out.field("complete", branches.complete);
  out.open_array("branches", Layout::lines);
  for (const FollowedBranch& each : branches.branches) write_branch(out, each, number);
  out.close();
  return ended(out);
}

std::string lyapunov_text(const Scene& scene, const Engine& engine, std::int64_t periods,
                          std::int64_t skipped, const LyapunovExponents& found,
                          const std::optional<Scales>& scales) {
  JsonWriter out = begun("lyapunov", scene, engine, scales);
  out.object("rule", Layout::one_line, "periods", periods, "discard", skipped);
  out.fields("stop_reason", name_of(found.stop_reason), "exponents", found.exponents, "standard_errors",
             found.standard_errors);
  return ended(out);
}

std::string sweep_csv(const Scene& scene, const Axis& axis, const std::vector<Sweep>& sweeps,
                      const std::optional<SiUnits>& units) {
  std::string text;
  const std::vector<Column> linear = linear_columns(scene, axis);
  const Quantity given = quantity_of(axis.number);
  {
    CsvRow row(text, units);
    row.word("sweep");
    row.word("way");
    row.heading(name_of(axis), given);
    row.word("end");
    for (const Column& column : columns_of(std::vector<SteadyState>{}))
      row.heading(column.name, column.quantity);
    for (const Column& column : linear) row.heading(column.name, column.quantity);
  }
  for (std::size_t n = 0; n < sweeps.size(); ++n) {
    const auto add_way = [&](std::string_view name, const std::vector<SteadyState>& way) {
      const std::vector<Column> columns = columns_of(way);
      for (std::size_t i = 0; i < way.size(); ++i) {
        CsvRow row(text, units);
        row.word(std::to_string(n));
        row.word(name);
        row.number(axis.value(std::int64_t(i)), given);
        row.word(end_of(way[i]));
        for (const Column& column : columns) row.number(column.numbers[i], column.quantity);
        for (const Column& column : linear) row.number(column.numbers[i], column.quantity);
      }
    };
    add_way("up", sweeps[n].up);
    add_way("down", sweeps[n].down);
  }
  return text;
}

std::string basin_csv(const Axis& first, const Axis& second, const Basin& basin,
                      const std::optional<SiUnits>& units) {
  std::string text;
  const Quantity of_first = quantity_of(first.number), of_second = quantity_of(second.number);
  {
    CsvRow row(text, units);
    row.heading(name_of(first), of_first);
    row.heading(name_of(second), of_second);
    row.word("attractor");
  }
  for (std::size_t n = 0; n < basin.attractor.size(); ++n) {
    CsvRow row(text, units);
    row.number(first.value(std::int64_t(n) % first.count), of_first);
    row.number(second.value(std::int64_t(n) / first.count), of_second);
    row.word(basin.attractor[n] == undecided ? "" : std::to_string(basin.attractor[n]));
  }
  return text;
}

std::string orbits_csv(const ParameterRange& range, const Branches& branches,
                       const std::optional<SiUnits>& units) {
  std::string text;
  double Scene::*const number = member_of(range.parameter);
  const Quantity varied = quantity_of(number);
  {
    CsvRow row(text, units);
    row.word("branch");
    row.word("event");
    row.heading(key_of(number), varied);
    for (const Column& column : columns_of(std::vector<BranchPoint>{}))
      row.heading(column.name, column.quantity);
  }
  for (std::size_t n = 0; n < branches.branches.size(); ++n) {
    const std::vector<BranchPoint> points = points_and_events_of(branches.branches[n], number);
    const std::vector<Column> columns = columns_of(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      CsvRow row(text, units);
      row.word(std::to_string(n));
      row.word(points[i].event);
      row.number(points[i].value, varied);
      for (const Column& column : columns) row.number(column.numbers[i], column.quantity);
    }
  }
  return text;
}

std::string lyapunov_csv(const LyapunovExponents& found, const std::optional<SiUnits>& units) {
  std::string text;
  {
    CsvRow row(text, units);
    row.heading("exponent", rate);
    row.heading("standard_error", rate);
  }
  for (std::size_t i = 0; i < found.exponents.size(); ++i) {
    CsvRow row(text, units);
    row.number(found.exponents[i], rate);
    row.number(i < found.standard_errors.size() ? std::optional(found.standard_errors[i]) : std::nullopt,
               rate);
  }
  return text;
}

}  // namespace impact_damper
