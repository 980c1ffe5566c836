#include "impact_damper/responses/response_file.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/responses/response_fields.hpp"

namespace impact_damper {
namespace {

using Layout = JsonWriter::Layout;

constexpr std::size_t most_parts = 10'000;  // of starts, sweeps, branches, events
constexpr NumberRange counts = within(0, 9e15);
constexpr std::initializer_list<StopReason> ends_of_run{StopReason::time, StopReason::impact_budget,
                                                        StopReason::half_cycle_budget,
                                                        StopReason::time_budget, StopReason::step_budget};
// The words for the end of a simulation: `words` and the names of the budgets.
std::vector<std::string_view> ends_of_simulation(std::vector<std::string_view> words) {
  for (const StopReason reason : ends_of_run)
    if (reason != StopReason::time) words.push_back(name_of(reason));
  return words;
}

void describe_criteria(JsonFields fields, SteadyRule& rule) {
  fields.field("tolerance", rule.tolerance);
  fields.field("longest_period", rule.longest_period, longest_periods);
  fields.field("max_periods", rule.max_periods, most_periods);
}
}  // namespace

void describe(JsonFields fields, SceneState& state, const Scene& scene) {
  if (fields.reads()) state.dampers.resize(scene.dampers.size());
  fields.field("x", state.x);
  fields.field("v", state.v);
  if (has_one_damper(scene)) {
    fields.field("y", state.dampers[0].y);
    fields.field("w", state.dampers[0].w);
  }
  fields.dampers(listed_dampers(scene), Layout::one_line, [&](JsonFields its, std::size_t number) {
    its.field("y", state.dampers[number].y);
    its.field("w", state.dampers[number].w);
  });
}
bool describe(JsonFields fields, Axis& axis, const Scene& scene) {
  const std::vector<NamedSceneNumber> numbers = numbers_of(scene);
  std::vector<std::string_view> names(numbers.size());
  std::ranges::transform(numbers, names.begin(), &NamedSceneNumber::name);
  const auto number = fields.word("number", name_of(axis.number), names);
  if (number) axis.number = numbers[*number].number;
  bool is_valid = number || !fields.reads();
  is_valid = fields.field("from", axis.from) && is_valid;
  is_valid = fields.field("to", axis.to) && is_valid;
  is_valid = fields.field("count", axis.count, within(2, double(most_values))) && is_valid;
  if (!is_valid || axis.from < axis.to) return is_valid;
  fields.reject("to", "must be above \"from\", " + number_text(axis.from) + ", got " + number_text(axis.to));
  return false;
}

bool describe(JsonFields fields, ParameterRange& range) {
  bool is_valid = fields.field("number", range.parameter);
  is_valid = fields.field("from", range.from, above(0)) && is_valid;
  is_valid = fields.field("to", range.to, above(0)) && is_valid;
  if (!is_valid || range.from != range.to) return is_valid;
  fields.reject("to", "must differ from \"from\", " + number_text(range.from));
  return false;
}

void describe(JsonFields fields, SteadyRule& rule) {
  describe_criteria(fields, rule);
  fields.field("mean_periods", rule.mean_periods, mean_periods);
  fields.reject(problems_of(rule));
}
void describe(JsonFields fields, BasinRule& rule) {
  describe_criteria(fields, rule.steady);
  fields.field("capture_radius", rule.capture_radius);
  fields.reject(problems_of(rule));
}
void describe(JsonFields fields, BranchRule& rule) {
  describe_criteria(fields, rule.steady);
  fields.field("largest_step", rule.largest_step);
  fields.field("max_multiplier", rule.max_multiplier);
  fields.field("max_points", rule.max_points, most_branch_points);
  fields.field("max_branches", rule.max_branches, most_branches);
  fields.reject(problems_of(rule));
}

namespace {

void describe_state(JsonFields fields, std::string_view name, SceneState& state, const Scene& scene) {
  fields.object(name, Layout::one_line, [&](JsonFields its) { describe(its, state, scene); });
}

template <class Kind>
void describe_rule(JsonFields fields, Kind& response) {
  describe(fields, response.rule);
}
void describe_rule(JsonFields fields, LyapunovResponse& response) {
  fields.field("periods", response.periods, within(10, 1e9));
  fields.field("discard", response.discard, within(0, 1e9));
}

void describe(JsonFields fields, ImpactCounts& impacts) {
  fields.field("impacts_left", impacts[0], counts);
  fields.field("impacts_right", impacts[1], counts);
}

void describe(JsonFields fields, std::vector<SteadyState>& way, const Scene& scene) {
  const std::size_t dampers = listed_dampers(scene);
  std::vector<std::string_view> ends;
  ends.reserve(way.size());
  for (const SteadyState& each : way) ends.push_back(end_of(each));
  if (!fields.words("end", ends, ends_of_simulation({"periodic", "not_periodic"}))) return;
  way.resize(ends.size());
  for (std::size_t i = 0; fields.reads() && i < ends.size(); ++i) {
    SteadyState& steady = way[i];
    for (const StopReason reason : ends_of_run)
      if (ends[i] == name_of(reason)) steady.stop_reason = reason;
    if (ends[i] == "periodic") steady.period = 1;
    steady.state.dampers.resize(scene.dampers.size());
    if (steady.stop_reason != StopReason::time) continue;
    steady.means.emplace();
    steady.impacts_by_damper.resize(scene.dampers.size());
  }
  fields.columns(steady_columns(scene), way);
  fields.columns_of_dampers(dampers, way);
  for (SteadyState& each : way)
    if (fields.reads() && dampers == 0 && each.means) each.impacts_by_damper = {each.impacts};
}

// Whether the scene is valid at both ends of the axis; reports a problem if it is not.
bool is_valid_along(JsonFields fields, const Scene& scene, const Engine& engine, const Axis& axis) {
  for (const std::int64_t i : {std::int64_t(0), axis.count - 1}) {
    for (const Problem& problem : problems_of(axis.at(scene, i), engine)) {
      fields.reject("scene", "with " + name_of(axis.number) + " = " + number_text(axis.value(i)) + ": " +
                                 problem.field + " " + problem.message);
      return false;
    }
  }
  return true;
}

void describe(JsonFields fields, SweepResponse& response) {
  const Scene& scene = response.scene;
  Axis& axis = response.axis;
  bool has_axis = false;
  fields.objects({{"rule", [&](JsonFields its) { describe_rule(its, response); }},
                  {"axis", [&](JsonFields its) { has_axis = describe(its, axis, scene); }}});
  const bool is_valid = has_axis && is_valid_along(fields, scene, response.engine, axis);
  const std::vector<double> values = axis.values();
  fields.derived("values", {values.begin(), values.end()}, is_valid);
  for (const Column& column : linear_columns(scene, axis))
    fields.derived(column.name, column.numbers, is_valid);
  fields.array("sweeps", response.sweeps, most_parts, Layout::lines, [&](JsonFields its, Sweep& sweep) {
    describe_state(its, "start", sweep.start, scene);
    if (its.has("nudge", sweep.start.nudge != 0)) its.field("nudge", sweep.start.nudge, above(0));
    its.object("up", Layout::lines, [&](JsonFields way) { describe(way, sweep.up, scene); });
    its.object("down", Layout::lines, [&](JsonFields way) { describe(way, sweep.down, scene); });
    const auto require_length = [&](std::string_view name, const std::vector<SteadyState>& way) {
      if (has_axis && std::int64_t(way.size()) != axis.count)
        its.reject(name, "must hold " + std::to_string(axis.count) + " motions, one for each value, got " +
                             std::to_string(way.size()));
    };
    require_length("up", sweep.up);
    require_length("down", sweep.down);
  });
}

void describe(JsonFields fields, Attractor& attractor, const Scene& scene) {
  fields.field("idle", attractor.idle);
  fields.field("period", attractor.period, within(1, 64));
  describe(fields, attractor.impacts);
  fields.field("symmetric", attractor.symmetric);
  fields.field("points", attractor.points, counts);
  std::vector<ImpactCounts>& by_damper = attractor.impacts_by_damper;
  const auto describe_dampers = [&] {
    return fields.dampers(has_one_damper(scene) ? 0 : by_damper.size(), Layout::one_line,
                          [&](JsonFields its, std::size_t number) { describe(its, by_damper[number]); });
  };
  if (fields.reads()) {  // the dampers before the state, so their problems come first
    if (!attractor.idle) by_damper.assign(scene.dampers.size(), attractor.impacts);
    ImpactCounts all{};
    const bool is_complete = describe_dampers() && !has_one_damper(scene) && !by_damper.empty();
    for (const auto& [left, right] : by_damper) all = {all[0] + left, all[1] + right};
    if (is_complete && all != attractor.impacts)
      fields.reject("dampers", "must be hit as often as all, " + number_text(double(attractor.impacts[0])) +
                                   " and " + number_text(double(attractor.impacts[1])) + " times, got " +
                                   number_text(double(all[0])) + " and " + number_text(double(all[1])));
  }
  if (fields.has("state", !attractor.states.empty())) {
    if (fields.reads()) attractor.states.resize(1);
    describe_state(fields, "state", attractor.states.front(), scene);
  }
  if (!fields.reads()) describe_dampers();
}

void describe(JsonFields fields, BasinResponse& response) {
  const Scene& scene = response.scene;
  Basin& basin = response.basin;
  fields.object("rule", Layout::one_line, [&](JsonFields its) { describe_rule(its, response); });
  std::vector<Axis> axes;
  if (!fields.reads()) axes = {response.first, response.second};
  std::size_t valid = 0;
  fields.array("axes", axes, 2, Layout::one_line,
               [&](JsonFields its, Axis& axis) { valid += std::size_t(describe(its, axis, scene)); });
  if (axes.size() != 2) fields.reject("axes", "must be two axes, got " + std::to_string(axes.size()));
  const bool both = valid == 2;
  bool with_states = false;
  if (both && fields.reads()) {
    response.first = axes[0];
    response.second = axes[1];
    with_states = is_initial_value(axes[0].number) && is_initial_value(axes[1].number);
    if (is_valid_along(fields, axes[1].at(scene, 0), response.engine, axes[0]))
      is_valid_along(fields, axes[0].at(scene, 0), response.engine, axes[1]);
    if (axes[0].number == axes[1].number) fields.reject("axes", "must be of two different numbers");
  }
  fields.array("attractors", basin.attractors, std::size_t(most_rows), Layout::one_line,
               [&](JsonFields its, Attractor& attractor) {
                 describe(its, attractor, scene);
                 if (both && !with_states && !attractor.states.empty())
                   its.reject("state", "must not be given where the scene's parameters are varied");
               });
  std::int64_t open = std::ranges::count(basin.attractor, undecided);
  const bool open_is_read = fields.field("undecided", open, counts);
  std::vector<std::int64_t> attractor(basin.attractor.begin(), basin.attractor.end());
  const NumberRange indices = within(undecided, double(basin.attractors.size()) - 1);
  if (!fields.field("attractor", attractor, indices) || !fields.reads()) return;
  basin.attractor.assign(attractor.begin(), attractor.end());
  if (both && std::int64_t(attractor.size()) != axes[0].count * axes[1].count)
    fields.reject("attractor", "must hold " + std::to_string(axes[0].count * axes[1].count) +
                                   " points, one for each pair of values, got " +
                                   std::to_string(attractor.size()));
  std::vector<std::int64_t> points(basin.attractors.size());
  std::int64_t points_undecided = 0;
  for (const std::int64_t index : attractor)
    ++(index == undecided ? points_undecided : points[std::size_t(index)]);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (basin.attractors[i].points != points[i])
      fields.reject("attractors[" + std::to_string(i) + "].points",
                    "must be " + std::to_string(points[i]) + ", as many as end in it, got " +
                        std::to_string(basin.attractors[i].points));
  }
  if (open_is_read && open != points_undecided)
    fields.reject("undecided", "must be " + std::to_string(points_undecided) +
                                   ", as many as the points that are -1, got " + std::to_string(open));
}

void describe(JsonFields fields, OrbitBranch& branch, const Scene& scene) {
  const std::size_t dampers = listed_dampers(scene);
  fields.field("origin", branch.origin);
  fields.field("from", branch.from, counts);
  fields.index("event", branch.event);
  fields.field("end", branch.end);
  std::vector<double> values(branch.points.size());
  std::ranges::transform(branch.points, values.begin(), &OrbitPoint::value);
  fields.field("values", values);
  branch.points.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    OrbitPoint& point = branch.points[i];
    point.value = values[i];
    point.impacts_by_damper.resize(scene.dampers.size());
    point.state.dampers.resize(scene.dampers.size());
  }
  fields.columns(orbit_columns(scene), branch.points);
  fields.columns_of_dampers(dampers, branch.points);
  for (OrbitPoint& each : branch.points)
    if (fields.reads() && dampers == 0) each.impacts_by_damper = {each.impacts};
  fields.array("events", branch.events, most_parts, Layout::one_line, [&](JsonFields its, OrbitEvent& event) {
    its.field("kind", event.kind);
    its.field("value", event.value);
    its.field("points_before", event.points_before, within(0, double(values.size())));
    describe_state(its, "state", event.state, scene);
  });
}

void describe(JsonFields fields, OrbitsResponse& response) {
  const Scene& scene = response.scene;
  fields.objects({{"rule", [&](JsonFields its) { describe_rule(its, response); }},
                  {"range", [&](JsonFields its) { describe(its, response.range); }}});
  const std::vector<std::string_view> ends =
      ends_of_simulation({"periodic", "not_periodic", name_of(OrbitEnd::no_convergence),
                          name_of(OrbitEnd::no_derivative), name_of(OrbitEnd::run_stopped)});
  fields.array("starts", response.starts, most_parts, Layout::one_line,
               [&](JsonFields its, OrbitStart& start) {
                 if (const auto end = its.word("end", start.end, ends)) start.end = ends[*end];
                 its.field("transient_periods", start.transient_periods, counts);
                 its.index("branch", start.branch);
                 describe_state(its, "state", start.state, scene);
               });
  fields.field("complete", response.complete);
  fields.array("branches", response.branches, most_parts, Layout::lines,
               [&](JsonFields its, OrbitBranch& branch) { describe(its, branch, scene); });
}

void describe(JsonFields fields, LyapunovResponse& response) {
  fields.object("rule", Layout::one_line, [&](JsonFields its) { describe_rule(its, response); });
  LyapunovExponents& found = response.found;
  found.periods = response.periods;
  fields.field("stop_reason", found.stop_reason, ends_of_run);
  fields.field("exponents", found.exponents);
  fields.field("standard_errors", found.standard_errors, at_least(0));
}

// The stops of a scene do not count, and are not written.
void write_scene(JsonWriter& out, const Scene& scene) {
  out.open_object("scene", Layout::one_line);
  write_scene_numbers(out, scene);
  out.close();
}
// Reads the numbers of a scene. All must be there, except the stops, which a response does not have.
Scene read_forced_scene(ObjectReader object) {
  Scene scene;
  read_numbers(object, scene, scene_fields, scene_damper_fields,
               [](ObjectReader& from, const SceneField& field, double& number, const std::string&) {
                 const NumberRange range = within(field.least, field.most);
                 field.component ? from.optional(field.name, number, range)
                                 : from.required(field.name, number, range);
               });
  return scene;
}

Response read_whole(SealedDocument file) {
  ObjectReader root = file.root();
  if (root.require("schema")) root.word("schema", {response_schema});
  const std::array<Response, 4> kinds{SweepResponse{}, BasinResponse{}, OrbitsResponse{}, LyapunovResponse{}};
  std::vector<std::string_view> names(kinds.size());
  std::ranges::transform(kinds, names.begin(), kind_of);
  const auto kind = root.require("kind") ? root.word("kind", names) : std::nullopt;
  if (!kind) {
    root.keys();  // which of them are known depends on the kind
    file.document.finish();
  }
  Response read = kinds[kind.value_or(0)];
  std::visit(
      [&](auto& response) {
        ObjectReader engine = root.required_object("engine");
        response.scene = read_forced_scene(root.required_object("scene"));
        if (const auto its = read_engine(engine, Lacking::null)) response.engine = *its;
        if (std::holds_alternative<Cem>(response.engine))
          engine.reject("name", "must be exact or restitution, got cem");
        check_units(root);
        describe(JsonFields(root), response);
      },
      read);
  file.finish(root);
  return read;
}

}  // namespace

Response read_response(const std::filesystem::path& file) {
  return read_whole(SealedDocument::read(file, response_kind));
}

Response parse_response(const std::string& name, const std::string& text) {
  return read_whole(SealedDocument::parse(name, text));
}

std::string response_text(const Response& response, const std::optional<Scales>& scales) {
  Response described = response;  // as JsonFields takes what may be read
  return std::visit(
      [&](auto& each) {
        JsonWriter out("response");
        out.open_object(Layout::lines);
        out.fields("schema", response_schema, "kind", each.kind);
        write_scene(out, each.scene);
        write_engine(out, each.engine);
        if (scales) write_units(out, *scales);
        describe(JsonFields(out), each);
        write_provenance(out);
        return sealed(out.finish());
      },
      described);
}

std::vector<std::pair<std::string, std::string>> asked_of(const Response& response) {
  std::vector<std::pair<std::string, std::string>> parts{{"/kind", std::string(kind_of(response))}};
  const auto add = [&](const std::string& pointer, const std::function<void(JsonWriter&)>& write) {
    JsonWriter out("response");
    out.open_object(Layout::one_line);
    write(out);
    out.close();
    const std::string text = out.finish();  // {"name": PART}
    const std::size_t begin = text.find(": ") + 2;
    parts.emplace_back(pointer, text.substr(begin, text.size() - begin - 1));
  };
  const auto add_object = [&](const std::string& pointer, const JsonFields::Describe& describe_its) {
    add(pointer, [&](JsonWriter& out) { JsonFields(out).object("part", Layout::one_line, describe_its); });
  };
  const auto add_state = [&](const std::string& pointer, SceneState& state, const Scene& scene) {
    add_object(pointer, [&](JsonFields its) { describe(its, state, scene); });
  };
  Response asked = response;
  std::visit(
      [&](auto& each) {
        const bool several = !has_one_damper(each.scene);
        for (const SceneField& field : scene_fields)
          if ((!several || field.number.own) && !field.is_absent(field.number.in(each.scene)))
            add("/scene/" + std::string(field.name),
                [&](JsonWriter& out) { out.field(field.name, field.number.in(each.scene)); });
        Scene dampers_alone;
        dampers_alone.dampers = each.scene.dampers;
        if (several) add("/scene/dampers", [&](JsonWriter& out) { write_scene(out, dampers_alone); });
        add("/engine", [&](JsonWriter& out) { write_engine(out, each.engine); });
        add_object("/rule", [&](JsonFields its) { describe_rule(its, each); });
      },
      asked);
  if (auto* const sweeps = std::get_if<SweepResponse>(&asked)) {
    add_object("/axis", [&](JsonFields its) { describe(its, sweeps->axis, sweeps->scene); });
    for (std::size_t i = 0; i < sweeps->sweeps.size(); ++i) {
      const std::string sweep = "/sweeps/" + std::to_string(i);
      SweepStart& start = sweeps->sweeps[i].start;
      add_state(sweep + "/start", start, sweeps->scene);
      if (start.nudge != 0) add(sweep + "/nudge", [&](JsonWriter& out) { out.field("nudge", start.nudge); });
    }
  } else if (auto* const basin = std::get_if<BasinResponse>(&asked)) {
    add_object("/axes/0", [&](JsonFields its) { describe(its, basin->first, basin->scene); });
    add_object("/axes/1", [&](JsonFields its) { describe(its, basin->second, basin->scene); });
  } else if (auto* const orbits = std::get_if<OrbitsResponse>(&asked)) {
    add_object("/range", [&](JsonFields its) { describe(its, orbits->range); });
    for (std::size_t i = 0; i < orbits->starts.size(); ++i)
      add_state("/starts/" + std::to_string(i) + "/state", orbits->starts[i].state, orbits->scene);
  }
  return parts;
}

}  // namespace impact_damper
