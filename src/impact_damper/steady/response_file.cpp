#include "impact_damper/steady/response_file.hpp"

#include <algorithm>
#include <iterator>

#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/steady/response_columns.hpp"

namespace impact_damper {
namespace {

using Layout = JsonWriter::Layout;

constexpr UnitInSi rate{"_per_s", [](const SiUnits& u) { return 1 / u.time; }};

OrbitPoint point_of(const Orbit& orbit, double value, double amplitude) {
  OrbitPoint point{.value = value,
                   .period = orbit.periods,
                   .symmetric = orbit.symmetric,
                   .stable = orbit.stable(),
                   .impacts = {},
                   .sticking = orbit.sticking,
                   .amplitude = amplitude,
                   .multipliers = orbit.multipliers,
                   .slowest_impact = orbit.slowest_impact,
                   .nearest_miss = orbit.nearest_miss,
                   .least_interval = orbit.least_interval,
                   .state = release_of(orbit.scene),
                   .impacts_by_damper = std::vector<ImpactCounts>(orbit.scene.dampers.size())};
  point.multipliers.resize(4);
  for (const OrbitImpact& impact : orbit.impacts) {
    const auto side = std::size_t(impact.wall);
    ++point.impacts[side];
    if (!orbit.scene.dampers.empty()) ++point.impacts_by_damper[std::size_t(impact.damper)][side];
  }
  return point;
}
std::vector<OrbitPoint> points_of(const FollowedBranch& followed, double Scene::*number) {
  std::vector<OrbitPoint> points;
  for (std::size_t i = 0; i < followed.branch.orbits.size(); ++i) {
    const Orbit& orbit = followed.branch.orbits[i];
    points.push_back(point_of(orbit, orbit.scene.*number, followed.amplitudes[i]));
  }
  return points;
}
// All points and events, in their order along the branch, and the names of the events among them.
struct PointsAndEvents {
  std::vector<OrbitPoint> points;
  std::vector<std::string_view> events;
};
PointsAndEvents points_and_events_of(const FollowedBranch& followed, double Scene::*number) {
  const std::vector<OrbitPoint> points = points_of(followed, number);
  PointsAndEvents all;
  const auto add = [&](const OrbitPoint& point, std::string_view event) {
    all.points.push_back(point);
    all.events.push_back(event);
  };
  for (std::size_t i = 0; i <= points.size(); ++i) {
    for (std::size_t n = 0; n < followed.branch.events.size(); ++n) {
      const BranchEvent& event = followed.branch.events[n];
      if (event.orbits_before == std::int64_t(i))
        add(point_of(event.orbit, event.parameter, followed.event_amplitudes[n]), name_of(event.kind));
    }
    if (i < points.size()) add(points[i], "");
  }
  return all;
}

void write_steady_rule(JsonWriter& out, const SteadyRule& rule) {
  out.fields("tolerance", rule.tolerance, "longest_period", rule.longest_period, "max_periods",
             rule.max_periods);
}

void write_axis(JsonWriter& out, const Axis& axis) {
  out.fields("number", axis.number.name(), "from", axis.from, "to", axis.to, "count", axis.count);
}

void write_range(JsonWriter& out, const ParameterRange& range) {
  out.object("range", Layout::one_line, "number", name_of(range.parameter), "from", range.from, "to",
             range.to);
}

std::optional<double> index_of(const std::optional<std::int64_t>& index) {
  return index ? std::optional(double(*index)) : std::nullopt;
}

void write_state(JsonWriter& out, std::string_view name, const State<double>& s) {
  out.object(name, Layout::one_line, "x", s.x, "v", s.v, "y", s.y, "w", s.w);
}

void write_state(JsonWriter& out, std::string_view name, const SceneState& s) {
  if (s.dampers.empty()) return write_state(out, name, static_cast<const State<double>&>(s));
  out.open_object(name, Layout::one_line);
  out.fields("x", s.x, "v", s.v);
  out.open_array("dampers", Layout::one_line);
  for (const PlaceInCavity& each : s.dampers) {
    out.open_object(Layout::one_line);
    out.fields("y", each.y, "w", each.w);
    out.close();
  }
  out.close();
  out.close();
}

template <class Motion>
void write_dampers(JsonWriter& out, const std::vector<Motion>& motions, std::size_t dampers) {
  if (dampers == 0) return;
  out.open_array("dampers", Layout::lines);
  for (std::size_t n = 0; n < dampers; ++n) {
    out.open_object(Layout::lines);
    for (const Column& column : columns_of(damper_columns(), of_damper(motions, n)))
      out.field(column.name, column.numbers);
    out.close();
  }
  out.close();
}

void write_way(JsonWriter& out, std::string_view name, const std::vector<SteadyState>& way,
               std::size_t dampers) {
  out.open_object(name, Layout::lines);
  std::vector<std::string> ends;
  ends.reserve(way.size());
  for (const SteadyState& each : way) ends.emplace_back(end_of(each));
  out.field("end", ends);
  for (const Column& column : columns_of(steady_columns(dampers > 0), way))
    out.field(column.name, column.numbers);
  write_dampers(out, way, dampers);
  out.close();
}

void write_branch(JsonWriter& out, const OrbitBranch& branch, std::size_t dampers) {
  out.open_object(Layout::lines);
  out.fields("origin", name_of(branch.origin), "from", branch.from, "event", index_of(branch.event), "end",
             name_of(branch.end));
  std::vector<double> values;
  values.reserve(branch.points.size());
  for (const OrbitPoint& each : branch.points) values.push_back(each.value);
  out.field("values", values);
  for (const Column& column : columns_of(orbit_columns(dampers > 0), branch.points))
    out.field(column.name, column.numbers);
  write_dampers(out, branch.points, dampers);
  out.open_array("events", Layout::lines);
  for (const OrbitEvent& event : branch.events) {
    out.open_object(Layout::one_line);
    out.fields("kind", name_of(event.kind), "value", event.value, "points_before", event.points_before);
    write_state(out, "state", event.state);
    out.close();
  }
  out.close();
  out.close();
}

// The stops of a scene do not count, and are not written.
void write_scene(JsonWriter& out, const Scene& scene) {
  out.open_object("scene", Layout::one_line);
  write_scene_numbers(out, scene);
  out.close();
}

void write_rule(JsonWriter& out, const SweepResponse& response) {
  out.open_object("rule", Layout::one_line);
  write_steady_rule(out, response.rule);
  out.field("mean_periods", response.rule.mean_periods);
  out.close();
}
void write_rule(JsonWriter& out, const BasinResponse& response) {
  out.open_object("rule", Layout::one_line);
  write_steady_rule(out, response.rule.steady);
  out.field("capture_radius", response.rule.capture_radius);
  out.close();
}
void write_rule(JsonWriter& out, const OrbitsResponse& response) {
  const BranchRule& rule = response.rule;
  out.open_object("rule", Layout::one_line);
  write_steady_rule(out, rule.steady);
  out.fields("largest_step", rule.largest_step, "max_multiplier", rule.max_multiplier, "max_points",
             rule.max_points, "max_branches", rule.max_branches);
  out.close();
}
void write_rule(JsonWriter& out, const LyapunovResponse& response) {
  out.object("rule", Layout::one_line, "periods", response.periods, "discard", response.discard);
}

// Writes the parts of the response that come after its rule.
void write_rest(JsonWriter& out, const SweepResponse& response) {
  out.open_object("axis", Layout::one_line);
  write_axis(out, response.axis);
  out.close();
  out.field("values", response.axis.values());
  for (const Column& column : linear_columns(response.scene, response.axis))
    out.field(column.name, column.numbers);
  out.open_array("sweeps", Layout::lines);
  for (const Sweep& sweep : response.sweeps) {
    out.open_object(Layout::lines);
    write_state(out, "start", sweep.start);
    if (sweep.start.nudge != 0) out.field("nudge", sweep.start.nudge);
    write_way(out, "up", sweep.up, response.scene.dampers.size());
    write_way(out, "down", sweep.down, response.scene.dampers.size());
    out.close();
  }
  out.close();
}
void write_rest(JsonWriter& out, const BasinResponse& response) {
  const Basin& basin = response.basin;
  out.open_array("axes", Layout::lines);
  for (const Axis* axis : {&response.first, &response.second}) {
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
    if (!each.impacts_by_damper.empty()) {
      out.open_array("dampers", Layout::one_line);
      for (const auto& [left, right] : each.impacts_by_damper) {
        out.open_object(Layout::one_line);
        out.fields("impacts_left", left, "impacts_right", right);
        out.close();
      }
      out.close();
    }
    out.close();
  }
  out.close();
  out.field("undecided", std::int64_t(std::ranges::count(basin.attractor, undecided)));
  out.field("attractor", std::vector<std::int64_t>(basin.attractor.begin(), basin.attractor.end()));
}
void write_rest(JsonWriter& out, const OrbitsResponse& response) {
  write_range(out, response.range);
  out.open_array("starts", Layout::lines);
  for (const OrbitStart& start : response.starts) {
    out.open_object(Layout::one_line);
    out.fields("end", start.end, "transient_periods", start.transient_periods, "branch",
               index_of(start.branch));
    write_state(out, "state", start.state);
    out.close();
  }
  out.close();
  out.field("complete", response.complete);
  out.open_array("branches", Layout::lines);
  for (const OrbitBranch& each : response.branches) write_branch(out, each, response.scene.dampers.size());
  out.close();
}
void write_rest(JsonWriter& out, const LyapunovResponse& response) {
  const LyapunovExponents& found = response.found;
  out.fields("stop_reason", name_of(found.stop_reason), "exponents", found.exponents, "standard_errors",
             found.standard_errors);
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
  void heading(std::string_view name, const UnitInSi& unit) {
    word(std::string(name) + std::string(units_ ? unit.suffix : ""));
  }
  void number(const std::optional<double>& value, const UnitInSi& unit) {
    word("");
    if (value) append_number(text_, units_ ? *value * unit.size(*units_) : *value);
  }

 private:
  std::string& text_;
  const std::optional<SiUnits>& units_;
  bool first_ = true;
};

void add_headings_of_dampers(CsvRow& row, std::size_t dampers) {
  for (std::size_t d = 0; d < dampers; ++d)
    for (const Column& column : columns_of(damper_columns(), std::vector<DamperOfMotion>{}))
      row.heading(std::string(column.name) + "_" + std::to_string(d + 1), column.unit);
}
template <class Motion>
void add_columns_of_dampers(std::vector<Column>& columns, const std::vector<Motion>& motions,
                            std::size_t dampers) {
  for (std::size_t d = 0; d < dampers; ++d)
    std::ranges::move(columns_of(damper_columns(), of_damper(motions, d)), std::back_inserter(columns));
}

}  // namespace

OrbitsResponse orbits_response(const Scene& scene, const Engine& engine, const BranchRule& rule,
                               const ParameterRange& range, const Branches& branches) {
  OrbitsResponse response{.scene = scene,
                          .engine = engine,
                          .rule = rule,
                          .range = range,
                          .starts = {},
                          .complete = branches.complete,
                          .branches = {}};
  for (const BranchStart& start : branches.starts)
    response.starts.push_back(
        {std::string(end_of(start)), start.steady.transient_periods, start.branch, start.state});
  for (const FollowedBranch& each : branches.branches) {
    OrbitBranch branch{.origin = each.origin,
                       .from = each.from,
                       .event = each.event,
                       .end = each.branch.end,
                       .points = points_of(each, member_of(range.parameter)),
                       .events = {}};
    for (const BranchEvent& event : each.branch.events)
      branch.events.push_back(
          {event.kind, event.parameter, event.orbits_before, release_of(event.orbit.scene)});
    response.branches.push_back(std::move(branch));
  }
  return response;
}

std::string_view kind_of(const Response& response) {
  return std::visit([](const auto& each) { return each.kind; }, response);
}

Response found_for(Response asked, const Threads& threads) {
  const auto ignored = [](std::int64_t) {};
  if (auto* const sweeps = std::get_if<SweepResponse>(&asked)) {
    std::vector<SweepStart> starts;
    for (const Sweep& each : sweeps->sweeps) starts.push_back(each.start);
    sweeps->sweeps =
        sweep(sweeps->scene, sweeps->engine, sweeps->axis, sweeps->rule, starts, threads, ignored);
  } else if (auto* const map = std::get_if<BasinResponse>(&asked)) {
    map->basin = basin(map->scene, map->engine, map->first, map->second, map->rule, threads, ignored);
  } else if (auto* const orbits = std::get_if<OrbitsResponse>(&asked)) {
    std::vector<SceneState> starts;
    for (const OrbitStart& each : orbits->starts) starts.push_back(each.state);
    return orbits_response(
        orbits->scene, orbits->engine, orbits->rule, orbits->range,
        find_branches(orbits->scene, orbits->engine, orbits->range, orbits->rule, starts, threads, ignored));
  } else if (auto* const lyapunov = std::get_if<LyapunovResponse>(&asked)) {
    lyapunov->found =
        lyapunov_exponents(lyapunov->scene, lyapunov->engine, lyapunov->periods, lyapunov->discard);
  }
  return asked;
}

std::string response_text(const Response& response, const std::optional<Scales>& scales) {
  return std::visit(
      [&](const auto& each) {
        JsonWriter out("response");
        out.open_object(Layout::lines);
        out.fields("schema", response_schema, "kind", each.kind);
        write_scene(out, each.scene);
        write_engine(out, each.engine);
        if (scales) write_units(out, si_units_of(*scales));
        write_rule(out, each);
        write_rest(out, each);
        write_provenance(out);
        return sealed(out.finish());
      },
      response);
}

std::vector<std::pair<std::string, std::string>> asked_of(const Response& response) {
  std::vector<std::pair<std::string, std::string>> parts{{"/kind", std::string(kind_of(response))}};
  const auto add = [&](const std::string& pointer, auto&& write) {
    JsonWriter out("response");
    out.open_object(Layout::one_line);
    write(out);
    out.close();
    std::string text = out.finish();  // {"name": PART}
    const std::size_t begin = text.find(": ") + 2;
    parts.emplace_back(pointer, text.substr(begin, text.size() - begin - 1));
  };
  const auto add_axis = [&](const std::string& pointer, const Axis& axis) {
    add(pointer, [&](JsonWriter& out) {
      out.open_object("axis", Layout::one_line);
      write_axis(out, axis);
      out.close();
    });
  };
  const auto add_start = [&](const std::string& pointer, const SceneState& start) {
    add(pointer, [&](JsonWriter& out) { write_state(out, "start", start); });
  };
  std::visit(
      [&](const auto& each) {
        const bool several = !each.scene.dampers.empty();
        for (const SceneField& field : scene_fields)
          if (!several || !is_of_one_damper(field))
            add("/scene/" + std::string(field.name),
                [&](JsonWriter& out) { out.field(field.name, each.scene.*field.member); });
        Scene dampers_alone;
        dampers_alone.dampers = each.scene.dampers;
        if (several)
          add("/scene/dampers", [&](JsonWriter& out) {
            out.open_object("scene", Layout::one_line);
            write_scene_numbers(out, dampers_alone);
            out.close();
          });
        add("/engine", [&](JsonWriter& out) { write_engine(out, each.engine); });
        add("/rule", [&](JsonWriter& out) { write_rule(out, each); });
      },
      response);
  if (const auto* const sweeps = std::get_if<SweepResponse>(&response)) {
    add_axis("/axis", sweeps->axis);
    for (std::size_t i = 0; i < sweeps->sweeps.size(); ++i) {
      const std::string sweep = "/sweeps/" + std::to_string(i);
      const double nudge = sweeps->sweeps[i].start.nudge;
      add_start(sweep + "/start", sweeps->sweeps[i].start);
      if (nudge != 0) add(sweep + "/nudge", [&](JsonWriter& out) { out.field("nudge", nudge); });
    }
  } else if (const auto* const basin = std::get_if<BasinResponse>(&response)) {
    add_axis("/axes/0", basin->first);
    add_axis("/axes/1", basin->second);
  } else if (const auto* const orbits = std::get_if<OrbitsResponse>(&response)) {
    add("/range", [&](JsonWriter& out) { write_range(out, orbits->range); });
    for (std::size_t i = 0; i < orbits->starts.size(); ++i)
      add_start("/starts/" + std::to_string(i) + "/state", orbits->starts[i].state);
  }
  return parts;
}

std::string sweep_csv(const Scene& scene, const Axis& axis, const std::vector<Sweep>& sweeps,
                      const std::optional<SiUnits>& units) {
  std::string text;
  const std::size_t dampers = scene.dampers.size();
  const std::vector<Column> linear = linear_columns(scene, axis);
  const UnitInSi given = unit_in_si_of(axis.number);
  {
    CsvRow row(text, units);
    row.word("sweep");
    row.word("way");
    row.heading(axis.number.name(), given);
    row.word("end");
    for (const Column& column : columns_of(steady_columns(dampers > 0), std::vector<SteadyState>{}))
      row.heading(column.name, column.unit);
    add_headings_of_dampers(row, dampers);
    for (const Column& column : linear) row.heading(column.name, column.unit);
  }
  for (std::size_t n = 0; n < sweeps.size(); ++n) {
    const auto add_way = [&](std::string_view name, const std::vector<SteadyState>& way) {
      std::vector<Column> columns = columns_of(steady_columns(dampers > 0), way);
      add_columns_of_dampers(columns, way, dampers);
      for (std::size_t i = 0; i < way.size(); ++i) {
        CsvRow row(text, units);
        row.word(std::to_string(n));
        row.word(name);
        row.number(axis.value(std::int64_t(i)), given);
        row.word(end_of(way[i]));
        for (const Column& column : columns) row.number(column.numbers[i], column.unit);
        for (const Column& column : linear) row.number(column.numbers[i], column.unit);
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
  const UnitInSi of_first = unit_in_si_of(first.number), of_second = unit_in_si_of(second.number);
  {
    CsvRow row(text, units);
    row.heading(first.number.name(), of_first);
    row.heading(second.number.name(), of_second);
    row.word("attractor");
  }
  for (std::size_t n = 0; n < basin.attractor.size(); ++n) {
    CsvRow row(text, units);
    row.number(first.value(std::int64_t(n) % first.count), of_first);
    row.number(second.value(std::int64_t(n) / first.count), of_second);
    row.word(std::to_string(basin.attractor[n]));
  }
  return text;
}

std::string orbits_csv(const Scene& scene, const ParameterRange& range, const Branches& branches,
                       const std::optional<SiUnits>& units) {
  std::string text;
  const std::size_t dampers = scene.dampers.size();
  double Scene::*const number = member_of(range.parameter);
  const UnitInSi varied = unit_in_si_of(number);
  {
    CsvRow row(text, units);
    row.word("branch");
    row.word("event");
    row.heading(name_of(range.parameter), varied);
    for (const Column& column : columns_of(orbit_columns(dampers > 0), std::vector<OrbitPoint>{}))
      row.heading(column.name, column.unit);
    add_headings_of_dampers(row, dampers);
  }
  for (std::size_t n = 0; n < branches.branches.size(); ++n) {
    const auto& [points, events] = points_and_events_of(branches.branches[n], number);
    std::vector<Column> columns = columns_of(orbit_columns(dampers > 0), points);
    add_columns_of_dampers(columns, points, dampers);
    for (std::size_t i = 0; i < points.size(); ++i) {
      CsvRow row(text, units);
      row.word(std::to_string(n));
      row.word(events[i]);
      row.number(points[i].value, varied);
      for (const Column& column : columns) row.number(column.numbers[i], column.unit);
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
