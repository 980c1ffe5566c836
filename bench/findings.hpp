// Everything one run of the bench has found, its results beside their regression bounds, and what it writes
// of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "counted.hpp"
#include "measurements.hpp"
#include "time_error.hpp"

namespace impact_damper::bench {

struct Counting {
  std::string scene, engine;
  CountedRun run;
};

struct Findings {
  std::string processor;
  struct Entrant {
    std::string name, about;
  };
  std::vector<Entrant> entrants;  // each name once
  Spread reference_operation;     // seconds
  std::vector<BenchScene> scenes;
  std::vector<Reference> references;
  std::vector<Curve> curves;
  std::vector<Counting> counts;
  std::vector<Sweep> sweeps;
  std::optional<FigureSet> figures;
  std::vector<Allocations> allocations;
  std::optional<Speedup> speedup;
  std::vector<ManyRuns> many_runs;
  std::vector<FunctionCost> functions;
  std::vector<ComponentCost> components;
  std::vector<std::string> missing_peers;
  double seconds = 0;  // that it all took, by the clock on the wall

  const Curve* curve(const std::string& scene, const std::string& contender) const;
};

// What an impact of S9 costs by one of our engines, in nanoseconds, and what it may cost with so many
// dampers: what the engine of one damper takes, and 20 ns for each further one.
struct DamperCost {
  int dampers = 0;
  bool list = true;  // else by the engine of one damper
  const Curve* curve = nullptr;
  double cost = 0, bound = 0;

  bool within() const { return cost <= bound; }
};
// First that of the engine of one damper. Empty if that was not measured.
std::vector<DamperCost> damper_costs(const Findings& findings, const std::string& engine);

// One result, held against the bound beyond which something has become slower or less exact than it was. A
// number that could not be measured is absent, and `note` says why.
struct Result {
  std::string what;
  bool at_most = true;  // else at least
  double bound = 0;
  std::string unit;  // "", "ms", "ns", "x"
  std::optional<double> measured;
  std::string note;

  bool within() const { return measured && (at_most ? *measured <= bound : *measured >= bound); }
};
std::vector<Result> results_of(const Findings& findings);

// What a run of the bench leaves: a JSON with every number, one with the results alone, tables for gnuplot, a
// page for people.
std::string report_json(const Findings& findings);
std::string results_json(const Findings& findings);

// One block for each curve, "S1-exact": error, median and quartiles of the run time in reference operations,
// setting.
std::string time_error_table(const Findings& findings);
// One block for each sweep, "exact-impacts": at, reference operations per impact, residual.
std::string sweep_table(const Findings& findings);

std::string report_page(const Findings& findings);

}  // namespace impact_damper::bench
