// What programs read of the bench: JSON and the tables that gnuplot draws.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "findings.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/provenance.hpp"
#include "reference.hpp"

namespace impact_damper::bench {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Spread& spread, double scale = 1) {
  return {{"median", scale * spread.median},
          {"lower_quartile", scale * spread.lower},
          {"upper_quartile", scale * spread.upper}};
}

void add(Json& json, const Timing& timing) {
  json["nanoseconds"] = json_of(timing.seconds, 1e9);
  json["reference_operations"] = json_of(timing.reference_operations);
  json["repeats"] = timing.repeats;
  json["undisturbed_repeats"] = timing.undisturbed;
  json["runs_per_repeat"] = timing.runs;
}

Json json_of(const std::optional<double>& number) { return number ? Json(*number) : Json(nullptr); }

std::string_view name_of(Walls walls) { return walls == Walls::compliant ? "compliant" : "rigid"; }

Json json_of(const Reference& reference) {
  Json json{{"scene", reference.scene}, {"walls", name_of(reference.walls)}};
  if (reference.loss_curve) {
    json["error_is"] =
        "rms over amplitudes of the loss factor, mean of 128 releases, by the mean of 896, less 1";
    json["scatter_of_the_ensemble"] = json_of(reference.loss_curve->scatter);
    return json;
  }
  json["error_is"] = "largest difference of a half-cycle amplitude, by epsilon";
  json["scalar"] = reference_scalar();
  json["distance_from_long_double"] = json_of(reference.from_long_double);
  json["distance_from_another_integrator"] = json_of(reference.from_independent);
  return json;
}

Json json_of(const Curve& curve) {
  Json json{{"scene", curve.scene}, {"contender", curve.contender}, {"walls", name_of(curve.walls)}};
  if (!curve.setting.empty()) json["setting"] = curve.setting;
  for (const Point& point : curve.points) {
    Json row;
    if (!curve.setting.empty()) row["setting"] = point.setting;
    row["error"] = json_of(point.error);
    row["impacts"] = point.impacts;
    add(row, point.timing);
    json["points"].push_back(row);
  }
  if (!curve.failures.empty()) json["failures"] = curve.failures;
  if (!curve.cut.empty()) json["finer_settings"] = "left out: " + curve.cut;
  return json;
}

Json json_of(const Counting& counting) {
  Json json{{"scene", counting.scene}, {"engine", counting.engine}, {"impacts", counting.run.impacts}};
  constexpr std::array<const char*, ways_to_find> ways{
      "series", "correction", "search", "short_contact_map", "slow_mode", "contact_search"};
  for (std::size_t i = 0; i < ways.size(); ++i) json["found_by"][ways[i]] = counting.run.counts.found[i];
  for (const CountInfo& info : per_impact) json["per_impact"][info.name] = info.of(counting.run);
  return json;
}

Json json_of(const Sweep& sweep) {
  Json json{{"engine", sweep.engine}, {"against", sweep.against}, {"what", sweep.what}};
  for (const SweepPoint& point : sweep.points) {
    Json row{{"at", point.at},
             {"impacts", point.impacts},
             {"half_cycles", point.half_cycles},
             {"reference_operations_per_impact", point.cost()},
             {"ledger_residual", point.residual}};
    add(row, point.timing);
    json["points"].push_back(row);
  }
  return json;
}

Json json_of(const FigureSet& set) {
  Json json{{"scenes", set.scenes}, {"tables", set.tables}, {"bytes", set.bytes}};
  add(json, set.timing);
  for (const FigureSet::Part& part : set.parts) json["shares"][part.name] = part.share;
  return json;
}

Json json_of(const Result& result) {
  return {{"what", result.what},       {result.at_most ? "at_most" : "at_least", result.bound},
          {"unit", result.unit},       {"measured", json_of(result.measured)},
          {"within", result.within()}, {"note", result.note}};
}

// Returns how it was measured, and the results with their bounds.
Json head_of(const Findings& found) {
  const Provenance& made = provenance();
  Json json{{"schema", "impact-damper/bench/1"},
            {"machine", {{"processor", found.processor}, {"threads", std::thread::hardware_concurrency()}}},
            {"provenance",
             {{"version", made.version},
              {"commit", made.commit},
              {"compiler", made.compiler},
              {"build_type", made.build_type},
              {"flags", made.flags},
              {"system", made.system}}},
            {"clock", "CPU time of the process; for threads the clock on the wall"},
            {"seconds_in_all", found.seconds},
            {"reference_operation",
             {{"what", "one of a chain of dependent sincos calls of the C library"},
              {"nanoseconds", json_of(found.reference_operation, 1e9)}}},
            {"missing_peers", found.missing_peers}};
  for (const Result& result : results_of(found)) json["results"].push_back(json_of(result));
  return json;
}

// A line for the title of a figure: on what machine, and what a reference operation is there.
std::string parameters(const Findings& found) {
  return found.processor + "; a reference operation, one of a chain of sincos calls, is " +
         number_text(std::round(found.reference_operation.median * 1e10) / 10) + " ns";
}

std::string block_name(std::string name) {
  std::ranges::replace(name, ' ', '-');
  return name;
}

void add_row(std::string& text, std::initializer_list<double> numbers) {
  for (const double number : numbers) text += number_text(number) + " ";
  text.back() = '\n';
}

}  // namespace

std::string results_json(const Findings& found) { return head_of(found).dump(1) + "\n"; }

std::string report_json(const Findings& found) {
  Json json = head_of(found);
  for (const Findings::Entrant& entrant : found.entrants) json["contenders"][entrant.name] = entrant.about;
  for (const Reference& reference : found.references) json["references"].push_back(json_of(reference));
  for (const Curve& curve : found.curves) json["curves"].push_back(json_of(curve));
  for (const Counting& counting : found.counts) json["counts"].push_back(json_of(counting));
  for (const Sweep& sweep : found.sweeps) json["sweeps"].push_back(json_of(sweep));
  if (found.figures) json["figures"] = json_of(*found.figures);
  for (const Allocations& counted : found.allocations) {
    json["allocations"].push_back({{"engine", counted.engine},
                                   {"impacts", counted.impacts},
                                   {"nothing_recorded", counted.quiet},
                                   {"half_cycles_recorded", counted.recorded}});
  }
  for (const ManyRuns& many : found.many_runs) {
    json["sweeps_of_runs"].push_back({{"kept", many.kept},
                                      {"runs", many.runs},
                                      {"repeats", many.repeats},
                                      {"engine_milliseconds", json_of(many.engine, 1e3)},
                                      {"one_milliseconds", json_of(many.one, 1e3)},
                                      {"two_milliseconds", json_of(many.two, 1e3)},
                                      {"analysis", json_of(many.analysis)},
                                      {"overhead", json_of(many.overhead)},
                                      {"speedup", json_of(many.ratio)}});
  }
  if (found.speedup) {
    json["threads"] = {{"members", found.speedup->members},
                       {"one_milliseconds", json_of(found.speedup->one, 1e3)},
                       {"two_milliseconds", json_of(found.speedup->two, 1e3)},
                       {"speedup", json_of(found.speedup->ratio)},
                       {"side_by_side", json_of(found.speedup->side_by_side)},
                       {"repeats", found.speedup->repeats},
                       {"repeats_on_two_cores", found.speedup->on_two_cores}};
  }
  for (const FunctionCost& function : found.functions) {
    json["functions"].push_back({{"name", function.name},
                                 {"arguments", function.arguments},
                                 {"nanoseconds", json_of(function.own, 1e9)},
                                 {"library_nanoseconds", json_of(function.library, 1e9)},
                                 {"ratio", json_of(function.ratio)},
                                 {"error_ulp", function.own_error},
                                 {"library_error_ulp", function.library_error}});
  }
  return json.dump(1) + "\n";
}

std::string time_error_table(const Findings& found) {
  std::string text =
      "# Run time beside error, drawn by bench/time_error.gp.\n"
      "# error: largest difference of a half-cycle amplitude from the reference, by epsilon; S5: of the loss "
      "factor's curve from the ensemble's, relative, root mean square\n"
      "# time, lower, upper: median and quartiles of a run, in reference operations\n"
      "# setting: tolerance or time step; 0 where there is none\n"
      "# Parameters: " +
      parameters(found) + "\n";
  for (const Curve& curve : found.curves) {
    std::string rows;
    for (const Point& point : curve.points) {
      if (!point.error) continue;
      const Spread& time = point.timing.reference_operations;
      add_row(rows, {*point.error, time.median, time.lower, time.upper, point.setting});
    }
    if (rows.empty()) continue;
    text += "\n\n# " + block_name(curve.scene + "-" + curve.contender) +
            "\nerror time lower upper setting\n" + rows;
  }
  for (const Reference& reference : found.references) {
    if (!reference.loss_curve) continue;
    text += "\n\n# " + reference.scene +
            (reference.walls == Walls::compliant ? "-scatter" : "-scatter-rigid") + "\nlower median upper\n";
    const Spread& scatter = reference.loss_curve->scatter;
    add_row(text, {scatter.lower, scatter.median, scatter.upper});
  }
  return text;
}

std::string sweep_table(const Findings& found) {
  std::string text =
      "# What an impact costs, drawn by bench/cost.gp.\n"
      "# cost, lower, upper: median and quartiles, in reference operations; residual: of the energy balance, "
      "relative, at least 2^-53\n"
      "# Parameters: " +
      parameters(found) + "\n";
  for (const Sweep& sweep : found.sweeps) {
    text += "\n\n# " + sweep.engine + "-" + sweep.against + "\n# " + sweep.what +
            "\nat cost lower upper residual impacts\n";
    for (const SweepPoint& point : sweep.points) {
      const double n = double(point.impacts);
      const Spread& time = point.timing.reference_operations;
      add_row(text, {point.at, time.median / n, time.lower / n, time.upper / n,
                     std::max(point.residual, 0x1p-53), n});
    }
  }
  return text;
}

}  // namespace impact_damper::bench
