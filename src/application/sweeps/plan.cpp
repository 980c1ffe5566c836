#include "application/sweeps/plan.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "application/sweeps/sampling.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/csv.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/orbits/lyapunov.hpp"
#include "impact_damper/responses/response_fields.hpp"

namespace impact_damper {
namespace {

// Returns the value at the fraction `part` of a range (M15.4).
double between(double from, double to, Spacing spacing, double part) {
  switch (spacing) {
    case Spacing::linear:
      return from + (to - from) * part;
    case Spacing::logarithmic:
      return from * exponential(part * logarithm(to / from));
  }
  return from;
}

std::int64_t samples_of(const Plan& plan) { return plan.samples ? plan.samples->count : 1; }

bool is_in_grid(const Plan& plan, const Variable& variable) {
  return std::ranges::any_of(plan.grid,
                             [&](const GridAxis& axis) { return axis.variable.name == variable.name; });
}

// Sets the scene of a run from `changed`, whose numbers have been set, or else its problems.
void finish(PlannedRun& run, const SceneFile& changed) {
  if (!changed.in_units) {
    run.scene = changed.scene;
    run.problems = problems_of(run.scene);
  } else if (run.problems = problems_of(*changed.in_units); run.problems.empty()) {
    run.scene = dimensionless(*changed.in_units);
    run.scales = scales_of(*changed.in_units);
  }
}

// Returns the columns of the numbers that vary, each with its unit.
std::vector<std::pair<std::string, std::string_view>> varied(const Plan& plan) {
  std::vector<std::pair<std::string, std::string_view>> columns;
  for (const GridAxis& axis : plan.grid) columns.emplace_back(axis.variable.name, axis.variable.unit);
  if (plan.samples)
    for (const SampledNumber& number : plan.samples->numbers)
      columns.emplace_back(number.variable.name + (is_in_grid(plan, number.variable) ? "_sampled" : ""),
                           number.variable.unit);
  return columns;
}

double drawn(const Samples& samples, std::size_t n, std::int64_t i, double otherwise) {
  const SampledNumber& number = samples.numbers[n];
  const Draw draw{std::uint64_t(samples.seed), std::uint32_t(n), i};
  const double u =
      samples.method == SamplingMethod::random ? uniform_draw(draw) : stratified_draw(draw, samples.count);
  const double width = number.relative ? number.width * absolute(otherwise) : number.width;
  switch (number.law) {
    case SampledNumber::Law::between:
      return between(number.from, number.to, number.spacing, u);
    case SampledNumber::Law::uniform:
      return otherwise + width * (2 * u - 1);
    case SampledNumber::Law::normal:
      return otherwise + width * normal_quantile(u);
  }
  return otherwise;
}

}  // namespace

std::optional<double> Variable::of(const SceneFile& scene) const {
  if (!scene.in_units) return number.in(scene.scene);
  return number_in_units.in(*scene.in_units);
}

void Variable::set(SceneFile& scene, double value) const {
  if (scene.in_units)
    set_number(*scene.in_units, number_in_units, value);
  else
    number.in(scene.scene) = value;
}

std::vector<Variable> variables_of(const SceneFile& scene) {
  std::vector<Variable> variables;
  if (scene.in_units) {
    const std::size_t dampers = scene.in_units->dampers.size();
    for (const UnitField& field : unit_fields) {
      if (field.becomes == "until_time" || field.becomes == "until_amplitude") continue;
      const bool in_list = field.number.of_damper && dampers > 1;
      for (std::size_t i = 0; i < (in_list ? dampers : 1); ++i)
        if (!field.number.of_damper || !is_replaced(scene.in_units->dampers[i], field.name))
          variables.push_back({.name = std::string(field.name) + (in_list ? "_" + std::to_string(i + 1) : ""),
                               .unit = unit_of(field.dimension, true),
                               .dimension = field.dimension,
                               .range = field.range,
                               .number_in_units = {field.number, i}});
    }
    return variables;
  }
  for (const auto& [name, number, least, most] : numbers_of(scene.scene))
    variables.push_back({.name = name, .range = within(least, most), .number = number});
  return variables;
}

double GridAxis::value(std::int64_t i) const {
  if (!values.empty()) return values[static_cast<std::size_t>(i)];
  if (i == 0) return from;
  return i == count - 1 ? to : between(from, to, spacing, double(i) / double(count - 1));
}

std::int64_t runs_of(const Plan& plan) {
  std::int64_t runs = samples_of(plan);
  for (const GridAxis& axis : plan.grid) {
    if (axis.size() > 0 && runs > most_runs / axis.size()) return most_runs + 1;
    runs *= axis.size();
  }
  return runs;
}

std::vector<std::string> varied_names(const Plan& plan) {
  std::vector<std::string> names;
  for (const auto& [name, unit] : varied(plan)) names.push_back(name);
  return names;
}

PlannedRun run_of(const Plan& plan, std::int64_t i) {
  PlannedRun run;
  SceneFile changed = plan.scene;
  run.values.resize(plan.grid.size());
  std::int64_t rest = i / samples_of(plan);
  for (std::size_t n = plan.grid.size(); n-- > 0;) {
    const GridAxis& axis = plan.grid[n];
    run.values[n] = axis.value(rest % axis.size());
    axis.variable.set(changed, run.values[n]);
    rest /= axis.size();
  }
  if (plan.samples) {
    for (std::size_t n = 0; n < plan.samples->numbers.size(); ++n) {
      const Variable& variable = plan.samples->numbers[n].variable;
      run.values.push_back(drawn(*plan.samples, n, i % samples_of(plan), variable.of(changed).value_or(0)));
      variable.set(changed, run.values.back());
    }
  }
  finish(run, changed);
  return run;
}

PlannedRun run_of(const Plan& plan, const std::vector<double>& grid) {
  PlannedRun run{.values = grid, .problems = {}, .scene = {}, .scales = {}};
  SceneFile changed = plan.scene;
  for (std::size_t n = 0; n < grid.size(); ++n) plan.grid[n].variable.set(changed, grid[n]);
  finish(run, changed);
  return run;
}

std::string header_of(const Plan& plan) {
  std::string header;
  for (const PlanColumn& column : columns_of(plan)) header += (header.empty() ? "" : ",") + column.name;
  return header;
}

KeptNumbers kept_of(const Plan& plan, const PlannedRun& run) {
  return run.problems.empty() ? kept_of(run.scene, run.scales, plan.engine, plan.quantities, plan.forced)
                              : none_kept(plan.quantities.size(), run.problems);
}

std::string row_of(const Plan& plan, std::int64_t i) {
  const PlannedRun run = run_of(plan, i);
  const KeptNumbers kept = kept_of(plan, run);
  std::string row;
  append_number(row, i);
  for (const double value : run.values) {
    row += ',';
    append_number(row, value);
  }
  for (std::size_t n = 0; n < kept.numbers.size(); ++n) {
    row += ',';
    if (!kept.numbers[n]) continue;
    if (plan.quantities[n].quantity->dimension == Dimension::count) {
      append_number(row, std::int64_t(*kept.numbers[n]));
    } else {
      append_number(row, *kept.numbers[n]);
    }
  }
  row += ',';
  row += kept.end;
  row += ',';
  append_csv_cell(row, kept.problem);
  return row;
}

std::vector<PlanColumn> columns_of(const Plan& plan) {
  const bool in_units = plan.scene.in_units.has_value();
  std::vector<PlanColumn> columns{{"run", "", "number of the run, from 0"}};
  for (const auto& [name, unit] : varied(plan))
    columns.push_back({name, std::string(unit), "a number of the scene"});
  for (const KeptQuantity& kept : plan.quantities)
    columns.push_back({kept.column(), std::string(unit_of(kept.quantity->dimension, in_units)),
                       std::string(kept.quantity->meaning)});
  columns.push_back(
      {"end", "", "done; the budget of the engine that ended it early; not_valid: the scene; failed"});
  columns.push_back({"problem", "", "why a run is not_valid or failed"});
  return columns;
}

std::string remark_on_walls(const Plan& plan) {
  const auto is_of_walls = [](std::string_view name) {
    return name.starts_with("wall_stiffness") || name.starts_with("contact_stiffness");
  };
  const Scene& scene = plan.scene.scene;
  const bool is_kept = std::ranges::any_of(
      plan.quantities, [](const KeptQuantity& each) { return each.quantity->name == "largest_wall_force"; });
  const bool is_assumed = std::ranges::any_of(scene.dampers, [](const SceneDamper& damper) {
    return damper.wall.law == WallForm::linear && damper.wall_stiffness == SceneDamper{}.wall_stiffness;
  });
  if (!is_kept || !is_assumed || std::holds_alternative<Restitution>(plan.engine) ||
      std::ranges::any_of(varied_names(plan), is_of_walls))
    return "";
  const auto& scales = plan.scene.scales;
  return filled(
      "largest_wall_force is that of walls {} times as stiff as the primary spring{}: the program's default, "
      "an "
      "assumption. It goes as the square root of that: give {} of your own walls",
      SceneDamper{}.wall_stiffness,
      scales ? filled(", {} N/m", rounded_text(SceneDamper{}.wall_stiffness * scales->stiffness, 4)) : "",
      scales ? "contact_stiffness" : "wall_stiffness");
}

RowRange rows_of_part(const Plan& plan, std::int64_t part, std::int64_t parts) {
  const std::int64_t runs = runs_of(plan);
  return {runs * (part - 1) / parts, runs * part / parts};
}

// --- Files ------------------------------------------------------------------------------------------------

namespace {

using Layout = JsonWriter::Layout;
constexpr std::string_view plan_schema = "impact-damper/plan/1";
constexpr FileKind plan_kind{"plan", 1 << 20};
constexpr std::size_t most_numbers = 16, most_quantities = 64;
constexpr double most_seed = 9007199254740992;  // 2^53: any JSON reader has it exactly

// Returns the variable that "number" names.
std::optional<Variable> read_variable(ObjectReader& object, const std::vector<Variable>& variables) {
  std::vector<std::string_view> names(variables.size());
  std::ranges::transform(variables, names.begin(), &Variable::name);
  const auto index = object.require("number") ? object.word("number", names) : std::nullopt;
  return index ? std::optional(variables[*index]) : std::nullopt;
}

// Reads "from" and "to" and, unless `scale` is null, "scale".
void read_ends(ObjectReader& object, const NumberRange& range, double& from, double& to, Spacing* scale) {
  const bool has_from = object.required("from", from, range), has_to = object.required("to", to, range);
  if (scale) object.optional("scale", *scale);
  if (!has_from || !has_to) return;
  if (!(from < to)) object.reject("to", filled("must be > from, {}, got {}", from, to));
  if (scale && *scale == Spacing::logarithmic && !(from > 0))
    object.reject("from", filled("must be > 0 for a logarithmic scale, got {}", from));
}

std::vector<GridAxis> read_grid(ObjectReader& plan, const std::vector<Variable>& variables) {
  std::vector<GridAxis> grid;
  for (ObjectReader object : plan.optional_objects("grid", most_numbers)) {
    const auto variable = read_variable(object, variables);
    GridAxis axis;
    if (variable) axis.variable = *variable;
    if (object.has("values")) {
      if (object.required("values", axis.values, axis.variable.range) && axis.values.empty())
        object.reject("values", "must be 1 or more numbers, got 0");
    } else {
      read_ends(object, axis.variable.range, axis.from, axis.to, &axis.spacing);
      object.required("count", axis.count, within(2, double(most_axis_values)));
    }
    if (variable) grid.push_back(std::move(axis));
  }
  return grid;
}

using Law = SampledNumber::Law;
std::string_view name_of_width(Law law) { return law == Law::uniform ? "half_width" : "standard_deviation"; }

SampledNumber read_sampled(ObjectReader& object, const Variable& variable) {
  SampledNumber number;
  number.variable = variable;
  const bool uniform = object.has(name_of_width(Law::uniform)),
             normal = object.has(name_of_width(Law::normal));
  if (uniform || normal) {
    number.law = uniform ? Law::uniform : Law::normal;
    object.required(name_of_width(number.law), number.width, above(0));
    object.optional("relative", number.relative);
    if (uniform && normal)
      object.reject("half_width", "either it or standard_deviation must be given, got both");
  } else {
    read_ends(object, variable.range, number.from, number.to, &number.spacing);
  }
  return number;
}

Samples read_samples(ObjectReader& object, const std::vector<Variable>& variables) {
  Samples samples;
  object.required("count", samples.count, within(1, double(most_runs)));
  object.optional("seed", samples.seed, within(0, most_seed));
  object.optional("method", samples.method);
  for (ObjectReader each : object.required_objects("numbers", most_numbers))
    if (const auto variable = read_variable(each, variables))
      samples.numbers.push_back(read_sampled(each, *variable));
  return samples;
}

void read_quantities(ObjectReader& object, Plan& plan) {
  std::vector<std::string> texts;
  if (!object.required("quantities", texts, some_text, most_quantities)) return;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const QuantityReading reading = read_quantity(texts[i]);
    if (reading.kept) plan.quantities.push_back(*reading.kept);
    if (!reading.kept) object.reject("quantities", i, reading.problem);
  }
}

void read_forced_rules(ObjectReader& object, ForcedRules& rules) {
  if (auto steady = object.optional_object("steady")) describe(JsonFields(*steady, true), rules.steady);
  if (auto frequencies = object.optional_object("frequencies")) {
    FrequencyRange range;
    read_ends(*frequencies, above(0), range.from, range.to, nullptr);
    frequencies->required("count", range.count, within(2, 100'000));
    rules.frequencies = range;
  }
  if (auto lyapunov = object.optional_object("lyapunov")) {
    lyapunov->optional("periods", rules.lyapunov_periods, within(10, 1e9));
    lyapunov->optional("discard", rules.lyapunov_discard, within(0, 1e9));
  }
}

SceneFile read_scene_of(ObjectReader& object, const std::filesystem::path& folder, const FindFile& find) {
  if (object.has("scene_file")) {
    std::string name;
    const bool both = object.has("scene");
    if (both) object.reject("scene", "either it or scene_file must be given, got both");
    if (!object.required("scene_file", name, some_text) || both) return {};
    const std::filesystem::path beside = folder / name;
    std::error_code none;
    const auto elsewhere = find && !std::filesystem::exists(beside, none) ? find(name) : std::nullopt;
    return read_scene_file(elsewhere.value_or(beside.string()));
  }
  if (!object.has("scene")) {
    object.reject("scene", "it or scene_file must be given");
    return {};
  }
  if (object.is_text("scene")) {
    object.reject("scene", "must be an object; the name of a file is given as \"scene_file\"");
    return {};
  }
  ObjectReader scene = object.required_object("scene");
  return read_scene_object(scene, &folder);
}

Plan read_fields(ObjectReader& object, const std::filesystem::path& folder, const FindFile& find) {
  Plan plan;
  if (object.require("schema")) object.word("schema", {plan_schema});
  object.optional("description", plan.description);
  plan.scene = read_scene_of(object, folder, find);
  if (object.is_text("scene")) {
    object.keys();  // which say nothing without the scene's numbers
    return plan;
  }
  if (auto engine = object.optional_object("engine"))
    if (const auto read = read_engine(*engine, Lacking::any_or_null)) plan.engine = *read;
  const std::vector<Variable> variables = variables_of(plan.scene);
  plan.grid = read_grid(object, variables);
  if (auto samples = object.optional_object("samples")) plan.samples = read_samples(*samples, variables);
  read_quantities(object, plan);
  read_forced_rules(object, plan.forced);
  if (object.all_valid())
    for (const Problem& problem : problems_of(plan)) object.reject(problem.field, problem.message);
  return plan;
}

Plan finished(JsonDocument document, const std::filesystem::path& folder, const FindFile& find) {
  ObjectReader object = document.root();
  Plan plan = read_fields(object, folder, find);
  document.finish();
  return plan;
}

void write_ends(JsonWriter& out, double from, double to, Spacing spacing) {
  out.fields("from", from, "to", to, "scale", name_of(spacing));
}

void write_samples(JsonWriter& out, const Samples& samples) {
  out.open_object("samples", Layout::one_line);
  out.fields("count", samples.count, "seed", samples.seed, "method", name_of(samples.method));
  out.objects("numbers", Layout::one_line, samples.numbers, [&](const SampledNumber& each) {
    out.field("number", each.variable.name);
    if (each.law == Law::between)
      write_ends(out, each.from, each.to, each.spacing);
    else
      out.fields(name_of_width(each.law), each.width, "relative", each.relative);
  });
  out.close();
}

void write_fields(JsonWriter& out, const Plan& plan) {
  out.field("schema", plan_schema);
  if (!plan.description.empty()) out.field("description", plan.description);
  out.open_object("scene", Layout::one_line);
  if (!plan.scene.description.empty()) out.field("description", plan.scene.description);
  if (plan.scene.in_units) {
    write_unit_fields(out, *plan.scene.in_units);
  } else {
    write_scene_fields(out, plan.scene.scene);
  }
  out.close();
  write_engine(out, plan.engine);
  out.objects("grid", Layout::one_line, plan.grid, [&](const GridAxis& axis) {
    out.field("number", axis.variable.name);
    if (!axis.values.empty()) return out.field("values", axis.values);
    write_ends(out, axis.from, axis.to, axis.spacing);
    out.field("count", axis.count);
  });
  if (plan.samples) write_samples(out, *plan.samples);
  std::vector<std::string> quantities;
  for (const KeptQuantity& each : plan.quantities) quantities.push_back(each.text());
  out.field("quantities", quantities);
  ForcedRules forced = plan.forced;
  JsonFields(out).object("steady", Layout::one_line,
                         [&](JsonFields steady) { describe(steady, forced.steady); });
  if (forced.frequencies)
    out.object("frequencies", Layout::one_line, "from", forced.frequencies->from, "to",
               forced.frequencies->to, "count", forced.frequencies->count);
  out.object("lyapunov", Layout::one_line, "periods", forced.lyapunov_periods, "discard",
             forced.lyapunov_discard);
}

}  // namespace

Plan read_plan(const std::filesystem::path& file, const FindFile& find) {
  return finished(JsonDocument::read(file, plan_kind), file.parent_path(), find);
}

Plan parse_plan(const std::string& name, const std::string& text) {
  return finished(JsonDocument::parse(name, text), {}, {});
}

Plan read_plan_in(ObjectReader& object) {
  ObjectReader plan = object.required_object("plan");
  return read_fields(plan, {}, {});
}

void write_plan(JsonWriter& out, const Plan& plan) {
  out.open_object("plan", Layout::one_line);
  write_fields(out, plan);
  out.close();
}

std::string plan_text(const Plan& plan) {
  JsonWriter out("plan");
  out.open_object(Layout::lines);
  write_fields(out, plan);
  out.close();
  return out.finish() + '\n';
}

std::vector<Problem> problems_of(const Plan& plan) {
  std::vector<Problem> problems;
  const auto demand = [&](bool holds, const std::string& field, const std::string& message) {
    if (!holds) problems.push_back({field, message});
  };
  const auto demand_at_most = [&](std::size_t most, std::size_t given, const std::string& field,
                                  const std::string& of) {
    demand(given <= most, field, filled("must be at most {}{}, got {}", most, of, given));
  };
  std::set<std::string> names;
  const auto demand_once = [&](const std::string& name, const std::string& field, const std::string& thing) {
    demand(names.insert(name).second, field,
           filled("must name each {} once, got {} twice", thing, in_quotes(name)));
  };
  demand(!plan.grid.empty() || (plan.samples && !plan.samples->numbers.empty()), "grid",
         "a number that varies must be given, in grid or in the numbers of samples");
  demand_at_most(most_numbers, plan.grid.size(), "grid", " numbers");
  for (const GridAxis& axis : plan.grid) {
    demand_once(axis.variable.name, "grid", "number");
    demand(axis.values.size() <= std::size_t(most_listed_values), "grid",
           filled("must list at most {} values of {}, got {}", most_listed_values, axis.variable.name,
                  axis.values.size()));
  }
  names.clear();
  for (const SampledNumber& number : plan.samples ? plan.samples->numbers : std::vector<SampledNumber>{}) {
    const Variable& variable = number.variable;
    const bool in_grid = is_in_grid(plan, variable), is_between = number.law == Law::between;
    demand_once(variable.name, "samples", "number");
    demand(!is_between || !in_grid, "samples",
           filled("{} is in the grid: it may vary about its value there, by half_width or "
                  "standard_deviation, not from one number to another",
                  in_quotes(variable.name)));
    demand(is_between || in_grid || variable.of(plan.scene), "samples",
           filled("{} has no value in the scene to vary about", in_quotes(variable.name)));
  }
  demand(runs_of(plan) <= most_runs, "grid", filled("must make at most {} runs in all", most_runs));
  demand(!plan.quantities.empty(), "quantities", "at least one must be given");
  demand_at_most(most_quantities, plan.quantities.size(), "quantities", "");
  names.clear();
  for (const KeptQuantity& each : plan.quantities) demand_once(each.text(), "quantities", "quantity");
  const auto are_of = [&](Experiment experiment) {
    return std::ranges::any_of(
        plan.quantities, [&](const KeptQuantity& each) { return each.quantity->experiment == experiment; });
  };
  const std::size_t dampers = plan.scene.scene.dampers.size();
  demand(dampers <= most_dampers_with_changes || !are_of(Experiment::lyapunov), "quantities",
         filled("must not be of exponents with more than {} dampers, as the scene has {}",
                most_dampers_with_changes, dampers));
  demand(plan.forced.frequencies || !are_of(Experiment::worst), "frequencies",
         "missing, the range must be given in which the worst one is looked for");
  const bool forced = are_of(Experiment::steady) || are_of(Experiment::worst) || are_of(Experiment::lyapunov);
  demand(!forced || !std::holds_alternative<Cem>(plan.engine), "engine",
         "must be exact or restitution for quantities of motions under a force, got cem");
  return problems;
}

}  // namespace impact_damper
