#include <algorithm>
#include <array>
#include <cmath>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/steady/response_columns.hpp"
#include "impact_damper/steady/response_parts.hpp"

namespace impact_damper {
namespace {

constexpr std::size_t most_parts = 10'000;  // of starts, sweeps, branches, events
constexpr NumberRange counts = within(0, 9e15);

constexpr std::array budgets{StopReason::impact_budget, StopReason::half_cycle_budget,
                             StopReason::time_budget, StopReason::step_budget};

// Reads the numbers of a scene. All must be there, except the stops, which a response does not have.
Scene read_forced_scene(ObjectReader object) {
  Scene scene;
  const bool several = object.has("dampers");
  for (const SceneField& field : scene_fields) {
    if (!several || !is_of_one_damper(field))
      object.required(field.name, scene.*field.member, within(field.least, field.most));
    else if (object.has(field.name))
      object.reject(field.name, beside_dampers);
  }
  if (!several) return scene;
  for (ObjectReader& damper : object.optional_objects("dampers", most_dampers, 1)) {
    SceneDamper& its = scene.dampers.emplace_back();
    for (const SceneDamperField& field : scene_damper_fields)
      damper.required(field.name, its.*field.member, within(field.least, field.most));
  }
  return scene;
}
std::vector<ObjectReader> read_dampers(ObjectReader& object, std::size_t dampers) {
  if (dampers == 0) return {};
  std::vector<ObjectReader> objects = object.required_objects("dampers", most_dampers);
  if (objects.size() != dampers)
    object.reject("dampers", "must be as many as in the scene, " + std::to_string(dampers) + ", got " +
                                 std::to_string(objects.size()));
  while (objects.size() > dampers) objects.pop_back();
  return objects;
}

std::optional<std::int64_t> read_index(ObjectReader& object, std::string_view key) {
  if (!object.require(key)) return std::nullopt;
  std::optional<double> index;
  if (object.optional(key, index) && index && !(*index >= 0 && *index == std::floor(*index)))
    object.reject(key, "must be null or an index >= 0, got " + number_text(*index));
  return index && *index >= 0 && *index < 1e15 ? std::optional(std::int64_t(*index)) : std::nullopt;
}

// The rows that the columns of `object` make. The parts that `row` has before it is read determine which
// numbers are absent.
template <class Row>
void read_columns(ObjectReader& object, std::span<const RowColumn<Row>> table, std::vector<Row>& rows) {
  for (const RowColumn<Row>& column : table) {
    std::vector<std::optional<double>> numbers;
    if (!object.required(column.name, numbers, column.range)) continue;
    if (numbers.size() != rows.size()) {
      object.reject(column.name, "must be as long as the first column, " + std::to_string(rows.size()) +
                                     ", got a length of " + std::to_string(numbers.size()));
      continue;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::optional<double>& number = numbers[i];
      const bool is_wanted = column.get(rows[i]).has_value();
      if (!column.may_be_absent && number.has_value() != is_wanted) {
        object.reject(column.name, i,
                      is_wanted ? "must be a number, got null"
                                : "must be null, got " + number_text(*number) + ": there is none");
        break;
      }
      if (number && column.is_whole && *number != std::floor(*number)) {
        object.reject(column.name, i, "must be a whole number, got " + number_text(*number));
        break;
      }
      if (number) column.set(rows[i], *number);
    }
  }
}

std::vector<SteadyState> read_way(ObjectReader object, std::size_t dampers) {
  std::vector<std::string_view> words{"periodic", "not_periodic"};
  for (const StopReason budget : budgets) words.push_back(name_of(budget));
  std::vector<std::size_t> ends;
  std::vector<SteadyState> way;
  if (!object.require("end") || !object.words("end", words, ends)) {
    object.keys();  // the number of rows, and which numbers are absent, depends on "end"
    return way;
  }
  for (const std::size_t end : ends) {
    SteadyState& steady = way.emplace_back();
    if (end == 0) steady.period = 1;
    if (end <= 1) steady.means.emplace();
    if (end > 1) steady.stop_reason = budgets[end - 2];
    steady.state.dampers.resize(dampers);
    if (steady.means) steady.impacts_by_damper.resize(dampers);
  }
  read_columns(object, steady_columns(dampers > 0), way);
  std::size_t n = 0;
  for (ObjectReader& damper : read_dampers(object, dampers)) {
    std::vector<DamperOfMotion> rows = of_damper(way, n);
    read_columns(damper, damper_columns(), rows);
    for (std::size_t i = 0; i < way.size(); ++i) {
      if (way[i].means) way[i].impacts_by_damper[n] = rows[i].impacts;
      way[i].state.dampers[n] = rows[i].place;
    }
    ++n;
  }
  return way;
}

void require_length(ObjectReader& object, std::string_view way, std::size_t given, std::int64_t wanted) {
  if (std::int64_t(given) != wanted)
    object.reject(way, "must hold " + std::to_string(wanted) + " motions, one for each value, got " +
                           std::to_string(given));
}

// Checks a column whose numbers follow from the parameters of the computation.
void check_column(ObjectReader& object, std::string_view name,
                  const std::vector<std::optional<double>>& wanted) {
  std::vector<std::optional<double>> given;
  if (!object.required(name, given)) return;
  if (given.size() != wanted.size()) {
    object.reject(
        name, "must hold " + std::to_string(wanted.size()) + " numbers, got " + std::to_string(given.size()));
    return;
  }
  const auto text_of = [](const std::optional<double>& number) {
    return number ? number_text(*number) : std::string("null");
  };
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (given[i] == wanted[i]) continue;
    object.reject(name, i, "must be " + text_of(wanted[i]) + ", got " + text_of(given[i]));
    return;
  }
}

// Whether the scene is valid at both ends of the axis; adds a problem if it is not.
bool check_axis(ObjectReader& root, const Scene& scene, const Engine& engine, const Axis& axis) {
  for (const std::int64_t i : {std::int64_t(0), axis.count - 1}) {
    for (const Problem& problem : problems_of(axis.at(scene, i), engine)) {
      root.reject("scene", "with " + axis.number.name() + " = " + number_text(axis.value(i)) + ": " +
                               problem.field + " " + problem.message);
      return false;
    }
  }
  return true;
}

void read_rest(ObjectReader& root, SweepResponse& response) {
  ObjectReader rule = root.required_object("rule"), axis = root.required_object("axis");
  read_rule(rule, false, response.rule);
  const std::optional<Axis> read = read_axis(axis, response.scene);
  if (read) response.axis = *read;
  if (read && check_axis(root, response.scene, response.engine, *read)) {
    std::vector<std::optional<double>> values;
    for (const double value : read->values()) values.emplace_back(value);
    check_column(root, "values", values);
    for (const Column& column : linear_columns(response.scene, *read))
      check_column(root, column.name, column.numbers);
  } else {
    for (const std::string_view name : {"values", "empty_amplitude", "locked_amplitude"}) root.has(name);
  }
  for (ObjectReader item : root.required_objects("sweeps", most_parts)) {
    Sweep& sweep = response.sweeps.emplace_back();
    const std::size_t dampers = response.scene.dampers.size();
    sweep.start = read_state(item.required_object("start"), dampers);
    item.optional("nudge", sweep.start.nudge, above(0));
    sweep.up = read_way(item.required_object("up"), dampers);
    sweep.down = read_way(item.required_object("down"), dampers);
    if (!read) continue;
    require_length(item, "up", sweep.up.size(), read->count);
    require_length(item, "down", sweep.down.size(), read->count);
  }
}

void read_rest(ObjectReader& root, BasinResponse& response) {
  ObjectReader rule = root.required_object("rule");
  read_rule(rule, false, response.rule);
  std::vector<ObjectReader> items = root.required_objects("axes", 2);
  std::vector<Axis> axes;
  for (ObjectReader& item : items)
    if (const std::optional<Axis> axis = read_axis(item, response.scene)) axes.push_back(*axis);
  if (items.size() != 2) root.reject("axes", "must be two axes, got " + std::to_string(items.size()));
  const bool both = axes.size() == 2;
  if (both) {
    response.first = axes[0];
    response.second = axes[1];
    if (check_axis(root, axes[1].at(response.scene, 0), response.engine, axes[0]))
      check_axis(root, axes[0].at(response.scene, 0), response.engine, axes[1]);
    if (axes[0].number == axes[1].number) root.reject("axes", "must be of two different numbers");
  }
  Basin& basin = response.basin;
  const bool with_states = both && is_initial_value(axes[0].number) && is_initial_value(axes[1].number);
  std::vector<ObjectReader> entries = root.required_objects("attractors", std::size_t(most_rows));
  for (ObjectReader& item : entries) {
    Attractor& each = basin.attractors.emplace_back();
    item.required("idle", each.idle);
    item.required("period", each.period, within(1, 64));
    item.required("impacts_left", each.impacts[0], counts);
    item.required("impacts_right", each.impacts[1], counts);
    item.required("symmetric", each.symmetric);
    item.required("points", each.points, counts);
    const std::size_t dampers = each.idle ? 0 : response.scene.dampers.size();
    ImpactCounts of_all{};
    for (ObjectReader& damper : read_dampers(item, dampers)) {
      ImpactCounts& its = each.impacts_by_damper.emplace_back();
      damper.required("impacts_left", its[0], counts);
      damper.required("impacts_right", its[1], counts);
      for (const std::size_t wall : {0, 1}) of_all[wall] += its[wall];
    }
    if (each.impacts_by_damper.size() == dampers && dampers > 0 && of_all != each.impacts)
      item.reject("dampers", "must be hit as often as all, " + number_text(double(each.impacts[0])) +
                                 " and " + number_text(double(each.impacts[1])) + " times, got " +
                                 number_text(double(of_all[0])) + " and " + number_text(double(of_all[1])));
    if (item.has("state"))
      each.states = {read_state(item.required_object("state"), response.scene.dampers.size())};
    if (both && !with_states && item.has("state"))
      item.reject("state", "must not be given where the scene's parameters are varied");
  }
  std::int64_t open = 0;
  const bool open_is_read = root.required("undecided", open, counts);
  std::vector<std::int64_t> attractor;
  if (!root.required("attractor", attractor, within(-1, double(basin.attractors.size()) - 1))) return;
  basin.attractor.assign(attractor.begin(), attractor.end());
  if (both && std::int64_t(attractor.size()) != axes[0].count * axes[1].count)
    root.reject("attractor", "must hold " + std::to_string(axes[0].count * axes[1].count) +
                                 " points, one for each pair of values, got " +
                                 std::to_string(attractor.size()));
  std::vector<std::int64_t> points(basin.attractors.size());
  for (const std::int64_t index : attractor)
    if (index != undecided) ++points[std::size_t(index)];
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (basin.attractors[i].points != points[i])
      entries[i].reject("points", "must be " + std::to_string(points[i]) + ", as many as end in it, got " +
                                      std::to_string(basin.attractors[i].points));
  }
  if (const auto count = std::ranges::count(attractor, std::int64_t(undecided));
      open_is_read && count != open)
    root.reject("undecided", "must be " + std::to_string(count) +
                                 ", as many as the points that are -1, got " + std::to_string(open));
}

OrbitBranch read_branch(ObjectReader& item, std::size_t dampers) {
  OrbitBranch branch;
  item.required("origin", branch.origin);
  item.required("from", branch.from, counts);
  branch.event = read_index(item, "event");
  item.required("end", branch.end);
  std::vector<double> values;
  item.required("values", values);
  for (const double value : values) {
    OrbitPoint& point = branch.points.emplace_back();
    point.value = value;
    point.impacts_by_damper.resize(dampers);
    point.state.dampers.resize(dampers);
  }
  read_columns(item, orbit_columns(dampers > 0), branch.points);
  std::size_t n = 0;
  for (ObjectReader& damper : read_dampers(item, dampers)) {
    std::vector<DamperOfMotion> rows = of_damper(branch.points, n);
    read_columns(damper, damper_columns(), rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      branch.points[i].impacts_by_damper[n] = rows[i].impacts;
      branch.points[i].state.dampers[n] = rows[i].place;
    }
    ++n;
  }
  for (ObjectReader entry : item.required_objects("events", most_parts)) {
    OrbitEvent& event = branch.events.emplace_back();
    entry.required("kind", event.kind);
    entry.required("value", event.value);
    entry.required("points_before", event.points_before, within(0, double(values.size())));
    event.state = read_state(entry.required_object("state"), dampers);
  }
  return branch;
}

void read_rest(ObjectReader& root, OrbitsResponse& response) {
  ObjectReader rule = root.required_object("rule"), range = root.required_object("range");
  read_rule(rule, false, response.rule);
  if (const auto read = read_range(range)) response.range = *read;
  for (ObjectReader item : root.required_objects("starts", most_parts)) {
    OrbitStart& start = response.starts.emplace_back();
    std::vector<std::string_view> ends{"periodic", "not_periodic", name_of(OrbitEnd::no_convergence),
                                       name_of(OrbitEnd::no_derivative), name_of(OrbitEnd::run_stopped)};
    for (const StopReason budget : budgets) ends.push_back(name_of(budget));
    if (item.require("end"))
      if (const auto end = item.word("end", ends)) start.end = ends[*end];
    item.required("transient_periods", start.transient_periods, counts);
    start.branch = read_index(item, "branch");
    start.state = read_state(item.required_object("state"), response.scene.dampers.size());
  }
  root.required("complete", response.complete);
  for (ObjectReader item : root.required_objects("branches", most_parts))
    response.branches.push_back(read_branch(item, response.scene.dampers.size()));
}

void read_rest(ObjectReader& root, LyapunovResponse& response) {
  ObjectReader rule = root.required_object("rule");
  rule.required("periods", response.periods, within(10, 1e9));
  rule.required("discard", response.discard, within(0, 1e9));
  LyapunovExponents& found = response.found;
  found.periods = response.periods;
  root.required("stop_reason", found.stop_reason,
                {StopReason::time, StopReason::impact_budget, StopReason::half_cycle_budget,
                 StopReason::time_budget, StopReason::step_budget});
  root.required("exponents", found.exponents);
  root.required("standard_errors", found.standard_errors, at_least(0));
}

template <class Kind>
Response read_as(JsonDocument& document, ObjectReader& root, bool sealed) {
  Kind response;
  ObjectReader engine = root.required_object("engine");
  response.scene = read_forced_scene(root.required_object("scene"));
  if (const std::optional<Engine> read = read_engine_of_response(engine)) response.engine = *read;
  if (std::holds_alternative<Cem>(response.engine))
    engine.reject("name", "must be exact or restitution, got cem");
  check_units(root);
  read_rest(root, response);
  finish_sealed(document, root, sealed);
  return response;
}

Response read_whole(JsonDocument document, bool sealed) {
  ObjectReader root = document.root();
  if (root.require("schema")) root.word("schema", {response_schema});
  const std::vector<std::string_view> kinds{SweepResponse::kind, BasinResponse::kind, OrbitsResponse::kind,
                                            LyapunovResponse::kind};
  const auto kind = root.require("kind") ? root.word("kind", kinds) : std::nullopt;
  if (!kind) {
    root.keys();  // which of them are known depends on the kind
    document.finish();
  }
  switch (kind.value_or(0)) {
    case 0:
      return read_as<SweepResponse>(document, root, sealed);
    case 1:
      return read_as<BasinResponse>(document, root, sealed);
    case 2:
      return read_as<OrbitsResponse>(document, root, sealed);
    default:
      return read_as<LyapunovResponse>(document, root, sealed);
  }
}

template <class Number>
void read_number(ObjectReader& object, bool may_be_missing, std::string_view name, Number& number,
                 NumberRange range = {}) {
  if (may_be_missing) {
    object.optional(name, number, range);
  } else {
    object.required(name, number, range);
  }
}
void read_steady_rule(ObjectReader& object, bool may_be_missing, SteadyRule& rule) {
  read_number(object, may_be_missing, "tolerance", rule.tolerance);
  read_number(object, may_be_missing, "longest_period", rule.longest_period, longest_periods);
  read_number(object, may_be_missing, "max_periods", rule.max_periods, most_periods);
}
void reject_all(ObjectReader& object, const std::vector<Problem>& problems) {
  for (const Problem& problem : problems) object.reject(problem.field, problem.message);
}

}  // namespace

SceneState read_state(ObjectReader object, std::size_t dampers) {
  SceneState state;
  object.required("x", state.x);
  object.required("v", state.v);
  if (dampers == 0) {
    object.required("y", state.y);
    object.required("w", state.w);
    return state;
  }
  for (ObjectReader& damper : read_dampers(object, dampers)) {
    PlaceInCavity& place = state.dampers.emplace_back();
    damper.required("y", place.y);
    damper.required("w", place.w);
  }
  state.dampers.resize(dampers);
  return state;
}

std::optional<Axis> read_axis(ObjectReader& object, const Scene& scene) {
  Axis axis;
  const std::vector<NamedSceneNumber> numbers = numbers_of(scene);
  std::vector<std::string_view> names(numbers.size());
  std::ranges::transform(numbers, names.begin(), &NamedSceneNumber::name);
  const auto name = object.require("number") ? object.word("number", names) : std::nullopt;
  bool all_read = object.required("from", axis.from);
  all_read = object.required("to", axis.to) && all_read;
  all_read = object.required("count", axis.count, within(2, double(most_values))) && all_read;
  if (!name || !all_read) return std::nullopt;
  if (!(axis.from < axis.to)) {
    object.reject("to",
                  "must be above \"from\", " + number_text(axis.from) + ", got " + number_text(axis.to));
    return std::nullopt;
  }
  axis.number = numbers[*name].number;
  return axis;
}

std::optional<ParameterRange> read_range(ObjectReader& object) {
  ParameterRange range;
  bool all_read = object.required("number", range.parameter);
  all_read = object.required("from", range.from, above(0)) && all_read;
  all_read = object.required("to", range.to, above(0)) && all_read;
  if (all_read && range.from == range.to)
    object.reject("to", "must differ from \"from\", " + number_text(range.from));
  return all_read && range.from != range.to ? std::optional(range) : std::nullopt;
}

void read_rule(ObjectReader& object, bool may_be_missing, SteadyRule& rule) {
  read_steady_rule(object, may_be_missing, rule);
  read_number(object, may_be_missing, "mean_periods", rule.mean_periods, mean_periods);
  reject_all(object, problems_of(rule));
}
void read_rule(ObjectReader& object, bool may_be_missing, BasinRule& rule) {
  read_steady_rule(object, may_be_missing, rule.steady);
  read_number(object, may_be_missing, "capture_radius", rule.capture_radius);
  reject_all(object, problems_of(rule));
}
void read_rule(ObjectReader& object, bool may_be_missing, BranchRule& rule) {
  read_steady_rule(object, may_be_missing, rule.steady);
  read_number(object, may_be_missing, "largest_step", rule.largest_step);
  read_number(object, may_be_missing, "max_multiplier", rule.max_multiplier);
  read_number(object, may_be_missing, "max_points", rule.max_points, most_branch_points);
  read_number(object, may_be_missing, "max_branches", rule.max_branches, most_branches);
  reject_all(object, problems_of(rule));
}

Response read_response(const std::filesystem::path& file) {
  std::string text = read_text(file, response_kind);
  const bool sealed = is_sealed(text);
  JsonDocument document = JsonDocument::parse(file.string(), text);
  std::string().swap(text);
  return read_whole(std::move(document), sealed);
}

Response parse_response(const std::string& name, const std::string& text) {
  return read_whole(JsonDocument::parse(name, text), is_sealed(text));
}

}  // namespace impact_damper
