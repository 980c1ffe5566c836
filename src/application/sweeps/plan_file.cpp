#include "application/sweeps/plan_file.hpp"

#include <algorithm>
#include <set>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/orbits/lyapunov.hpp"
#include "impact_damper/responses/response_fields.hpp"

namespace impact_damper {
namespace {

using Layout = JsonWriter::Layout;
constexpr std::size_t most_numbers = 16, most_quantities = 64;
constexpr double most_seed = 9007199254740992;  // 2^53: any JSON reader has it exactly

// Returns the variable that "number" names.
std::optional<Variable> read_variable(ObjectReader& object, const std::vector<Variable>& variables) {
  std::vector<std::string_view> names(variables.size());
  std::ranges::transform(variables, names.begin(), &Variable::name);
  if (!object.require("number")) return std::nullopt;
  const auto index = object.word("number", names);
  if (!index) return std::nullopt;
  return variables[*index];
}

// Reads "from", "to" and "scale".
void read_ends(ObjectReader& object, const NumberRange& range, double& from, double& to, Spacing& spacing) {
  const bool has_from = object.required("from", from, range), has_to = object.required("to", to, range);
  const bool both = has_from && has_to;
  object.optional("scale", spacing);
  if (both && !(from < to))
    object.reject("to", "must be > from, " + number_text(from) + ", got " + number_text(to));
  if (both && spacing == Spacing::logarithmic && !(from > 0))
    object.reject("from", "must be > 0 for a logarithmic scale, got " + number_text(from));
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
      read_ends(object, axis.variable.range, axis.from, axis.to, axis.spacing);
      object.required("count", axis.count, within(2, double(most_axis_values)));
    }
    if (variable) grid.push_back(std::move(axis));
  }
  return grid;
}

SampledNumber read_sampled(ObjectReader& object, const Variable& variable) {
  using Law = SampledNumber::Law;
  SampledNumber number;
  number.variable = variable;
  const bool uniform = object.has("half_width"), normal = object.has("standard_deviation");
  if (uniform || normal) {
    number.law = uniform ? Law::uniform : Law::normal;
    object.required(uniform ? "half_width" : "standard_deviation", number.width, above(0));
    object.optional("relative", number.relative);
    if (uniform && normal)
      object.reject("half_width", "either it or standard_deviation must be given, got both");
  } else {
    read_ends(object, variable.range, number.from, number.to, number.spacing);
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
    if (reading.kept) {
      plan.quantities.push_back(*reading.kept);
    } else {
      object.reject("quantities", i, reading.problem);
    }
  }
}

void read_forced_rules(ObjectReader& object, ForcedRules& rules) {
  if (auto steady = object.optional_object("steady")) describe(JsonFields(*steady, true), rules.steady);
  if (auto frequencies = object.optional_object("frequencies")) {
    FrequencyRange range;
    const bool has_from = frequencies->required("from", range.from, above(0));
    const bool has_to = frequencies->required("to", range.to, above(0));
    if (has_from && has_to && !(range.from < range.to))
      frequencies->reject("to",
                          "must be > from, " + number_text(range.from) + ", got " + number_text(range.to));
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
  ObjectReader scene = object.required_object("scene");
  return read_scene_object(scene);
}

Plan finished(JsonDocument document, const std::filesystem::path& folder, const FindFile& find) {
  ObjectReader object = document.root();
  Plan plan = read_plan_object(object, folder, find);
  document.finish();
  return plan;
}

void write_ends(JsonWriter& out, double from, double to, Spacing spacing) {
  out.fields("from", from, "to", to, "scale", name_of(spacing));
}

void write_samples(JsonWriter& out, const Samples& samples) {
  out.open_object("samples", Layout::one_line);
  out.fields("count", samples.count, "seed", samples.seed, "method", name_of(samples.method));
  out.open_array("numbers", Layout::one_line);
  for (const SampledNumber& each : samples.numbers) {
    out.open_object(Layout::one_line);
    out.field("number", each.variable.name);
    switch (each.law) {
      case SampledNumber::Law::between:
        write_ends(out, each.from, each.to, each.spacing);
        break;
      case SampledNumber::Law::uniform:
        out.fields("half_width", each.width, "relative", each.relative);
        break;
      case SampledNumber::Law::normal:
        out.fields("standard_deviation", each.width, "relative", each.relative);
        break;
    }
    out.close();
  }
  out.close();
  out.close();
}

}  // namespace

Plan read_plan(const std::filesystem::path& file, const FindFile& find) {
  return finished(JsonDocument::read(file, plan_kind), file.parent_path(), find);
}

Plan parse_plan(const std::string& name, const std::string& text) {
  return finished(JsonDocument::parse(name, text), {}, {});
}

Plan read_plan_object(ObjectReader& object, const std::filesystem::path& folder, const FindFile& find) {
  Plan plan;
  if (object.require("schema")) object.word("schema", {plan_schema});
  object.optional("description", plan.description);
  plan.scene = read_scene_of(object, folder, find);
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

void write_plan_fields(JsonWriter& out, const Plan& plan) {
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
  out.open_array("grid", Layout::one_line);
  for (const GridAxis& axis : plan.grid) {
    out.open_object(Layout::one_line);
    out.field("number", axis.variable.name);
    if (axis.values.empty()) {
      write_ends(out, axis.from, axis.to, axis.spacing);
      out.field("count", axis.count);
    } else {
      out.field("values", axis.values);
    }
    out.close();
  }
  out.close();
  if (plan.samples) write_samples(out, *plan.samples);
  std::vector<std::string> quantities;
  for (const KeptQuantity& each : plan.quantities) quantities.push_back(each.text());
  out.field("quantities", quantities);
  const ForcedRules& forced = plan.forced;
  out.object("steady", Layout::one_line, "tolerance", forced.steady.tolerance, "longest_period",
             forced.steady.longest_period, "max_periods", forced.steady.max_periods, "mean_periods",
             forced.steady.mean_periods);
  if (forced.frequencies)
    out.object("frequencies", Layout::one_line, "from", forced.frequencies->from, "to",
               forced.frequencies->to, "count", forced.frequencies->count);
  out.object("lyapunov", Layout::one_line, "periods", forced.lyapunov_periods, "discard",
             forced.lyapunov_discard);
}

std::vector<Problem> problems_of(const Plan& plan) {
  std::vector<Problem> problems;
  if (plan.grid.empty() && !(plan.samples && !plan.samples->numbers.empty()))
    problems.push_back({"grid", "a number that varies must be given, in grid or in the numbers of samples"});
  if (plan.grid.size() > most_numbers)
    problems.push_back({"grid", "must be at most " + std::to_string(most_numbers) + " numbers, got " +
                                    std::to_string(plan.grid.size())});
  std::set<std::string_view> names;
  for (const GridAxis& axis : plan.grid) {
    if (!names.insert(axis.variable.name).second)
      problems.push_back(
          {"grid", "must name each number once, got " + in_quotes(axis.variable.name) + " twice"});
    if (axis.values.size() > std::size_t(most_listed_values))
      problems.push_back({"grid", "must list at most " + std::to_string(most_listed_values) + " values of " +
                                      std::string(axis.variable.name) + ", got " +
                                      std::to_string(axis.values.size())});
  }
  names.clear();
  if (plan.samples) {
    for (const SampledNumber& number : plan.samples->numbers) {
      const std::string_view name = number.variable.name;
      if (!names.insert(name).second)
        problems.push_back({"samples", "must name each number once, got " + in_quotes(name) + " twice"});
      const bool in_grid =
          std::ranges::any_of(plan.grid, [&](const GridAxis& axis) { return axis.variable.name == name; });
      if (number.law == SampledNumber::Law::between && in_grid)
        problems.push_back(
            {"samples", in_quotes(name) +
                            " is in the grid: it may vary about its value there, "
                            "by half_width or standard_deviation, not from one number to another"});
      if (number.law != SampledNumber::Law::between && !in_grid && !number.variable.of(plan.scene))
        problems.push_back({"samples", in_quotes(name) + " has no value in the scene to vary about"});
    }
  }
  if (runs_of(plan) > most_runs)
    problems.push_back({"grid", "must make at most " + std::to_string(most_runs) + " runs in all"});
  if (plan.quantities.empty()) problems.push_back({"quantities", "at least one must be given"});
  if (plan.quantities.size() > most_quantities)
    problems.push_back({"quantities", "must be at most " + std::to_string(most_quantities) + ", got " +
                                          std::to_string(plan.quantities.size())});
  bool worst = false, forced = false;
  std::set<std::string> columns;
  for (const KeptQuantity& each : plan.quantities) {
    if (!columns.insert(each.column()).second)
      problems.push_back(
          {"quantities", "must name each quantity once, got " + in_quotes(each.text()) + " twice"});
    worst = worst || each.quantity->experiment == Experiment::worst;
    forced = forced || each.quantity->experiment != Experiment::run;
  }
  const bool exponents = std::ranges::any_of(plan.quantities, [](const KeptQuantity& each) {
    return each.quantity->experiment == Experiment::lyapunov;
  });
  const std::size_t dampers = plan.scene.scene.dampers.size();
  if (exponents && dampers > most_dampers_with_changes)
    problems.push_back({"quantities", "must not be of exponents with more than " +
                                          std::to_string(most_dampers_with_changes) +
                                          " dampers, as the scene has " + std::to_string(dampers)});
  if (worst && !plan.forced.frequencies)
    problems.push_back(
        {"frequencies", "missing, the range must be given in which the worst one is looked for"});
  if (forced && std::holds_alternative<Cem>(plan.engine))
    problems.push_back(
        {"engine", "must be exact or restitution for quantities of motions under a force, got cem"});
  return problems;
}

}  // namespace impact_damper
