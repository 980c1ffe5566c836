#include <algorithm>
#include <cmath>
#include <cstdio>

#include "findings.hpp"
#include "impact_damper/io/provenance.hpp"
#include "reference.hpp"

namespace impact_damper::bench {
namespace {

template <class... Numbers>
std::string printed(const char* format, Numbers... numbers) {
  char text[128];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

// Of a spread, `scale` times: median, lower and upper quartile.
std::string with_quartiles(const char* format, const Spread& spread, double scale = 1) {
  return printed(format, scale * spread.median, scale * spread.lower, scale * spread.upper);
}

// Three digits, never an exponent where a person would not write one.
std::string rounded(double number) {
  const double size = std::abs(number);
  if (size == 0) return "0";
  if (size < 1e-3) return printed("%.1e", number);
  if (size < 10) return printed("%.3g", number);
  return printed(size < 100 ? "%.1f" : "%.0f", number);
}

std::string rounded(const std::optional<double>& number) { return number ? rounded(*number) : "—"; }

using Cells = std::vector<std::string>;

class PageTable {
 public:
  PageTable(std::string& page, const Cells& headings) : page_(page) {
    row(headings);
    page_ += "|";
    for (std::size_t i = 0; i < headings.size(); ++i) page_ += i == 0 ? "---|" : "---:|";
    page_ += "\n";
  }
  void row(const Cells& cells) {
    page_ += "|";
    for (const std::string& cell : cells) page_ += " " + cell + " |";
    page_ += "\n";
  }

 private:
  std::string& page_;
};

std::string with_unit(double number, const std::string& unit) {
  return rounded(number) + (unit.empty() ? "" : " " + unit);
}

void add_results(std::string& page, const Findings& found) {
  page += "## Results and their regression bounds\n\n";
  PageTable table(page, {"", "bound", "measured", "within", "how"});
  for (const Result& result : results_of(found)) {
    const std::string sign = result.at_most ? "≤ " : "≥ ";
    table.row({result.what, sign + with_unit(result.bound, result.unit),
               result.measured ? with_unit(*result.measured, result.unit) : "—",
               result.within() ? "yes" : "**no**", result.note});
  }
}

std::string time_cell(const Findings& found, const Curve& curve, double error) {
  const auto time = time_at(curve, error);
  if (!time) return "—";
  return rounded(*time * found.reference_operation.median * 1e3) + " ms (" + printed("%.0f", *time) + ")";
}

void add_times(std::string& page, const Findings& found) {
  page +=
      "\n## Run time for an error\n\n"
      "![Run time against error, scene by scene](time_error.svg)\n\n"
      "Milliseconds, in brackets reference operations; —: the error is not reached. Interpolated between "
      "settings on straight lines in both logarithms. Errors: largest difference of a half-cycle amplitude, "
      "by the free travel; S5: root mean square over amplitudes from 5 to 0.1 of the averaged loss factor, "
      "the mean of 128 releases, by the mean of 896 of the engine in closed form, less 1.\n\n"
      "That engine's own groups of 128 have such an error too: sampling scatter. Twice the upper quartile of "
      "it is the smallest error taken for a method's own, and where two settings are below it finer ones are "
      "left out. At that error two rates are held against the fixed step of the paper, which does not locate "
      "events.\n";
  for (const BenchScene& scene : found.scenes) {
    if (scene.dampers > 0) continue;
    page += "\n### " + scene.name + ": " + scene.what + "\n\n";
    if (scene.compared_until) {
      page += "Amplitudes are compared up to t = " + printed("%g", *scene.compared_until) +
              ": from there on a shift of the release grows. Times are those of the whole run.\n\n";
    }
    const double errors[] = {scene.chaotic ? 0.03 : 1e-6, scene.chaotic ? 0.005 : 1e-9};
    PageTable table(page, {"", "for " + rounded(errors[0]), "for " + rounded(errors[1]), "smallest error",
                           "in", "at", "repeats"});
    for (const Curve& curve : found.curves) {
      if (curve.scene != scene.name) continue;
      const Point* best = curve.best();
      if (!best) {
        table.row({curve.contender, "—", "—", "no run that can be compared", "", "", ""});
        continue;
      }
      const Spread& time = best->timing.reference_operations;
      table.row({curve.contender, time_cell(found, curve, errors[0]), time_cell(found, curve, errors[1]),
                 rounded(*best->error),
                 rounded(best->timing.seconds.median * 1e3) + " ms (" +
                     printed("%.0f ± %.0f %%", time.median, 50 * (time.upper - time.lower) / time.median) +
                     ")",
                 curve.setting.empty() ? "" : curve.setting + " " + printed("%.1e", best->setting),
                 std::to_string(best->timing.repeats)});
    }
  }
}

void add_entrants(std::string& page, const Findings& found) {
  page += "\n## Who takes part\n\n";
  PageTable table(page, {"", "how"});
  for (const Findings::Entrant& entrant : found.entrants) table.row({entrant.name, entrant.about});
}

void add_references(std::string& page, const Findings& found) {
  page += "\n## What the errors are measured from\n\n";
  page += "The engine for the walls in question in " + std::string(reference_scalar()) +
          "; Runge-Kutta-Fehlberg 78 of odeint in the same precision, tolerance 1e-20, as another "
          "integrator.\n\n";
  PageTable table(page,
                  {"", "distance from long double", "from another integrator", "the ensemble's own scatter"});
  for (const Reference& reference : found.references) {
    table.row({reference.scene + (reference.walls == Walls::compliant ? ", compliant" : ", rigid"),
               rounded(reference.from_long_double), rounded(reference.from_independent),
               reference.loss_curve ? rounded(reference.loss_curve->scatter.median) + " (" +
                                          rounded(reference.loss_curve->scatter.lower) + " to " +
                                          rounded(reference.loss_curve->scatter.upper) + ")"
                                    : ""});
  }
}

void add_counts(std::string& page, const Findings& found) {
  page += "\n## What an impact takes\n\nCounted, not timed, by impact.\n\n";
  Cells headings{"", "impacts"};
  for (const CountInfo& info : per_impact) headings.push_back(std::string(info.heading));
  PageTable table(page, headings);
  for (const Counting& counting : found.counts) {
    Cells cells{counting.scene + " " + counting.engine, std::to_string(counting.run.impacts)};
    for (const CountInfo& info : per_impact)
      cells.push_back(printed(info.many ? "%.0f" : "%.2f", info.of(counting.run)));
    table.row(cells);
  }
}

void add_ways(std::string& page, const Findings& found) {
  page +=
      "\n## How an impact is found\n\nShares of all flights, and of all contacts ([what they "
      "are](../../docs/mathematics.md#78-the-cascade)).\n\n";
  PageTable table(page, {"", "flights: series", "closed form", "step by step", "contacts: map", "slow mode",
                         "step by step"});
  for (const Counting& counting : found.counts) {
    const auto& ways = counting.run.counts.found;
    Cells cells{counting.scene + " " + counting.engine};
    for (const std::size_t first : {0, 3}) {
      const std::int64_t all = ways[first] + ways[first + 1] + ways[first + 2];
      for (std::size_t i = first; i < first + 3; ++i)
        cells.push_back(all == 0 ? "—" : printed("%.1f %%", 100 * double(ways[i]) / double(all)));
    }
    table.row(cells);
  }
}

void add_sweeps(std::string& page, const Findings& found) {
  if (found.sweeps.empty()) return;
  page +=
      "\n## What an impact costs\n\n![Cost of an impact against number of impacts, stiffness and "
      "restitution](cost.svg)\n\nReference operations per impact, in brackets the residual of the energy "
      "balance.\n\n";
  for (const char* against : {"impacts", "stiffness", "restitution"}) {
    std::vector<const Sweep*> columns;
    for (const Sweep& sweep : found.sweeps) {
      if (sweep.against == against) columns.push_back(&sweep);
    }
    if (columns.empty()) continue;
    Cells headings{columns[0]->what};
    for (const Sweep* sweep : columns) {
      headings.push_back(sweep->engine);
      headings.push_back("impacts in a half cycle");
    }
    PageTable table(page, headings);
    for (std::size_t i = 0; i < columns[0]->points.size(); ++i) {
      Cells cells{printed("%g", columns[0]->points[i].at)};
      for (const Sweep* sweep : columns) {
        const SweepPoint& point = sweep->points[i];
        cells.push_back(printed("%.1f (%.0e)", point.cost(), point.residual));
        cells.push_back(printed("%.1f", double(point.impacts) / double(point.half_cycles)));
      }
      table.row(cells);
    }
    page += "\n";
  }
}

void add_own_costs_of_dampers(std::string& page, const Findings& found) {
  PageTable table(page, {"engine", "dampers", "impacts", "an impact", "at most", "error"});
  std::string missed;
  for (const std::string engine : {"exact", "restitution"}) {
    for (const DamperCost& cost : damper_costs(found, engine)) {
      const Point& point = cost.curve->finest();
      const std::string time = printed("%.0f ns (%.1f)", cost.cost,
                                       point.timing.reference_operations.median / double(point.impacts));
      table.row({engine, std::to_string(cost.dampers) + (cost.list ? "" : ", no list"),
                 std::to_string(point.impacts), cost.within() ? time : "**" + time + "**",
                 cost.list ? printed("%.0f ns", cost.bound) : "", rounded(point.error)});
      if (!cost.within()) {
        missed += (missed.empty() ? "" : ", ") + engine + " with " + std::to_string(cost.dampers) +
                  printed(" (%.2f times)", cost.cost / cost.bound);
      }
    }
  }
  page += missed.empty() ? "\nThe bound is met everywhere.\n" : "\nThe bound is missed by " + missed + ".\n";
}

void add_peers_of_dampers(std::string& page, const Findings& found) {
  page +=
      "\nHow many times as long the peers take for the whole run, at an error of the amplitudes and at the "
      "smallest that they reach; —: it is not reached, or a run would take too long:\n\n";
  PageTable table(page,
                  {"peer", "walls", "dampers", "for 1.0e-06", "for 1.0e-09", "smallest error", "for it"});
  for (const Curve& curve : found.curves) {
    const auto scene = std::ranges::find(found.scenes, curve.scene, &BenchScene::name);
    const bool rigid = curve.walls == Walls::rigid;
    const Curve* own = found.curve(curve.scene, rigid ? "restitution" : "exact");
    if (curve.ours || scene == found.scenes.end() || scene->dampers == 0 || !own || own->points.empty())
      continue;
    const double unit = own->finest().timing.reference_operations.median;
    const auto times = [&](const std::optional<double>& time) {
      return time ? rounded(*time / unit) + " x" : "—";
    };
    const Point* best = curve.best();
    table.row({curve.contender, rigid ? "rigid" : "compliant", std::to_string(scene->dampers),
               times(time_at(curve, 1e-6)), times(time_at(curve, 1e-9)),
               best                   ? rounded(*best->error)
               : curve.points.empty() ? "not run: too slow"
                                      : "no run that can be compared",
               best ? times(best->timing.reference_operations.median) : "—"});
  }
}

void add_dampers(std::string& page, const Findings& found) {
  if (damper_costs(found, "exact").empty() && damper_costs(found, "restitution").empty()) return;
  page +=
      "\n## Several dampers\n\n"
      "S9: a free decay from x₀ = 3 to t = 101 with a list of dampers, which share ν = 0.02 and k = 10⁸ "
      "equally; e = 0.8, clearances from 1 up to below 1.7, the masses begin in the left halves of their "
      "cavities. No mass comes to rest on a wall, and few contacts overlap. Amplitudes are compared up to t "
      "= 30.5, before rounding decides; times are those of the whole run, by its impacts in nanoseconds, in "
      "brackets reference operations.\n\n"
      "An impact may cost what it costs with one damper that is no list, and 20 ns for each further one. A "
      "run that is repeated as it is the processor learns: other releases in turn take up to a fifth longer "
      "with 2 to 20 dampers ([tried.md](../tried.md)).\n\n";
  add_own_costs_of_dampers(page, found);
  add_peers_of_dampers(page, found);
}

void add_rest(std::string& page, const Findings& found) {
  if (found.figures) {
    const FigureSet& set = *found.figures;
    page += "## The figures' scenes and tables\n\n" + std::to_string(set.scenes) + " scenes, " +
            std::to_string(set.tables) + " tables, " + printed("%.1f", double(set.bytes) / 1e6) +
            " MB of text: " + rounded(set.timing.seconds.median * 1e3) + " ms (" +
            printed("%.0f", set.timing.reference_operations.median) + "). Where it goes:\n\n";
    PageTable parts(page, {"", "share"});
    for (const FigureSet::Part& part : set.parts) {
      parts.row({part.name, printed("%.0f %%", 100 * part.share)});
    }
  }
  if (found.speedup) {
    const Speedup& speedup = *found.speedup;
    page += "\n## Two threads\n\n" + std::to_string(speedup.members) +
            " decays from 6 to 0.03: " + rounded(speedup.one.median * 1e3) + " ms on one thread, " +
            rounded(speedup.two.median * 1e3) + " ms on two; " +
            with_quartiles("%.2f (quartiles %.2f to %.2f)", speedup.ratio) +
            " times as fast. Two ensembles side by side got " + printed("%.2f", speedup.side_by_side.median) +
            " cores; " + std::to_string(speedup.on_two_cores) + " of " + std::to_string(speedup.repeats) +
            " repeats were next to more than 1.9.\n";
  }
  if (!found.many_runs.empty()) {
    page += "\n## Sweeps\n\nThe rows of a sweep of decays from 6 to 0.03, in milliseconds for each run.\n\n";
    PageTable table(page, {"kept", "engine alone", "one thread", "two threads", "analysis by engine",
                           "the sweep's own by engine (quartiles)", "two by one (quartiles)"});
    for (const ManyRuns& many : found.many_runs) {
      const auto each = [&](const Spread& spread) {
        return printed("%.3f", spread.median / double(many.runs) * 1e3);
      };
      table.row({many.kept, each(many.engine), each(many.one), each(many.two),
                 printed("%.1f %%", 100 * many.analysis.median),
                 with_quartiles("%.1f %% (%.1f to %.1f)", many.overhead, 100),
                 with_quartiles("%.2f (%.2f to %.2f)", many.ratio)});
    }
  }
  if (!found.functions.empty()) {
    page +=
        "\n## Elementary functions\n\n"
        "One of a chain of dependent calls of the project's own and of the C library's, in nanoseconds, with "
        "the product and the sum that make it wait for the one before; largest errors in units of the last "
        "place.\n\n";
    PageTable table(page,
                    {"", "arguments", "own", "the C library's", "ratio (quartiles)", "error", "its error"});
    for (const FunctionCost& function : found.functions) {
      table.row({function.name, function.arguments, printed("%.1f", function.own.median * 1e9),
                 printed("%.1f", function.library.median * 1e9),
                 with_quartiles("%.2f (%.2f to %.2f)", function.ratio), printed("%.2f", function.own_error),
                 printed("%.2f", function.library_error)});
    }
  }

  std::string notes;
  for (const std::string& peer : found.missing_peers) notes += "- not in this build: " + peer + "\n";
  for (const Curve& curve : found.curves) {
    for (const std::string& failure : curve.failures) {
      notes += "- " + curve.scene + " " + curve.contender + " fails at " + failure + "\n";
    }
  }
  if (!notes.empty()) page += "\n## Missing\n\n" + notes;
}

std::string disturbances(const Findings& found) {
  int settings = 0, disturbed = 0;
  const auto see = [&](const Timing& timing) {
    ++settings;
    disturbed += timing.undisturbed < timing.repeats;
  };
  for (const Curve& curve : found.curves) {
    for (const Point& point : curve.points) see(point.timing);
  }
  for (const Sweep& sweep : found.sweeps) {
    for (const SweepPoint& point : sweep.points) see(point.timing);
  }
  if (found.figures) see(found.figures->timing);
  return std::to_string(disturbed) + " of " + std::to_string(settings) +
         " times, where beside a busy neighbour not enough repeats were to be had on a core of one's own";
}

}  // namespace

std::string report_page(const Findings& found) {
  const Provenance& made = provenance();
  std::string page =
      "# Run time and error, as measured\n\nMade by `make bench`, which writes every number to "
      "`build/bench/bench.json`, too.\n\n";
  page += "| | |\n|---|---|\n| processor | " + found.processor + " |\n| compiler | " +
          std::string(made.compiler) + ", " + std::string(made.build_type) +
          (made.flags.empty() ? "" : ", " + std::string(made.flags)) + " |\n| commit | " +
          std::string(made.commit) +
          " |\n| reference operation | one of a chain of dependent `sincos` calls: " +
          with_quartiles("%.1f ns (quartiles %.1f to %.1f)", found.reference_operation, 1e9) +
          " |\n| times | CPU time, median of 7 repeats or more, of 3 where a run takes over 0.4 s; for "
          "threads the clock on the wall |\n| disturbed | " +
          disturbances(found) + " |\n| in all | " + printed("%.0f s", found.seconds) + " |\n\n";
  add_results(page, found);
  add_times(page, found);
  add_entrants(page, found);
  add_references(page, found);
  add_counts(page, found);
  add_ways(page, found);
  add_sweeps(page, found);
  add_dampers(page, found);
  add_rest(page, found);
  return page;
}

}  // namespace impact_damper::bench
