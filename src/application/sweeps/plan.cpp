#include "application/sweeps/plan.hpp"

#include <algorithm>
#include <cmath>

#include "application/sweeps/sampling.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/math/elementary.hpp"

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

// A field of a CSV row (RFC 4180).
void append_field(std::string& row, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    row += text;
    return;
  }
  row += '"';
  for (const char c : text) row += c == '"' ? std::string("\"\"") : std::string(1, c);
  row += '"';
}

}  // namespace

std::optional<double> Variable::of(const SceneFile& scene) const {
  if (!scene.in_units) return number.in(scene.scene);
  return number_in_units.in(*scene.in_units);
}

void Variable::set(SceneFile& scene, double value) const {
  if (scene.in_units)
    number_in_units.in(*scene.in_units) = value;
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
        variables.push_back({.name = std::string(field.name) + (in_list ? "_" + std::to_string(i + 1) : ""),
                             .unit = unit_of(field.dimension, true),
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
  for (const GridAxis& axis : plan.grid) names.emplace_back(axis.variable.name);
  if (plan.samples) {
    for (const SampledNumber& number : plan.samples->numbers)
      names.push_back(std::string(number.variable.name) +
                      (is_in_grid(plan, number.variable) ? "_sampled" : ""));
  }
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

std::string row_of(const Plan& plan, std::int64_t i) {
  const PlannedRun run = run_of(plan, i);
  const KeptNumbers kept = run.problems.empty()
                               ? kept_of(run.scene, run.scales, plan.engine, plan.quantities, plan.forced)
                               : none_kept(plan.quantities.size(), run.problems);
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
  append_field(row, kept.problem);
  return row;
}

std::vector<PlanColumn> columns_of(const Plan& plan) {
  const bool in_units = plan.scene.in_units.has_value();
  std::vector<PlanColumn> columns{{"run", "", "number of the run, from 0"}};
  std::vector<std::string_view> units;
  for (const GridAxis& axis : plan.grid) units.push_back(axis.variable.unit);
  if (plan.samples)
    for (const SampledNumber& number : plan.samples->numbers) units.push_back(number.variable.unit);
  const std::vector<std::string> names = varied_names(plan);
  for (std::size_t n = 0; n < names.size(); ++n)
    columns.push_back({names[n], std::string(units[n]), "a number of the scene"});
  for (const KeptQuantity& kept : plan.quantities)
    columns.push_back({kept.column(), std::string(unit_of(kept.quantity->dimension, in_units)),
                       std::string(kept.quantity->meaning)});
  columns.push_back(
      {"end", "", "done; the budget of the engine that ended it early; not_valid: the scene; failed"});
  columns.push_back({"problem", "", "why a run is not_valid or failed"});
  return columns;
}

RowRange rows_of_part(const Plan& plan, std::int64_t part, std::int64_t parts) {
  const std::int64_t runs = runs_of(plan);
  return {runs * (part - 1) / parts, runs * part / parts};
}

}  // namespace impact_damper
