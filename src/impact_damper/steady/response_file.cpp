#include "impact_damper/steady/response_file.hpp"

#include <algorithm>
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

void write_axis(JsonWriter& out, const Axis& axis) {
  out.fields("number", name_of(axis), "from", axis.from, "to", axis.to, "count", axis.count);
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

// What both kinds of file begin with. The stops of a scene do not count, and are not written.
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

std::string_view name_of(const Axis& axis) {
  const auto* const field =
      std::ranges::find_if(scene_fields, [&](const SceneField& each) { return each.member == axis.number; });
  return field->name;
}

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
    for (const Column& column : columns_of({})) row.heading(column.name, column.quantity);
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

}  // namespace impact_damper
