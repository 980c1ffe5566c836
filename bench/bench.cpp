// The bench: run time beside error, scene by scene and contender by contender, and what an impact costs.
//
//   impact-damper-bench FOLDER [--quick] [--only SCENE]...
//
// writes bench.json, results.json, results.md and the tables time_error.dat and cost.dat, which gnuplot
// draws. For trying it out: --quick has short runs and few repeats, --only S3 nothing but that scene's
// contenders.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "findings.hpp"
#include "impact_damper/io/file_output.hpp"
#include "reference.hpp"

namespace impact_damper::bench {
namespace {

// What Linux calls the processor; "unknown" elsewhere.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

void tell(const std::string& what) { std::fprintf(stderr, "%s\n", what.c_str()); }

void tell_point(const Curve& curve, const Point& point) {
  char error[32] = "none";
  if (point.error) std::snprintf(error, sizeof error, "%.1e", *point.error);
  std::fprintf(stderr, "  %s %.1e: error %s, %.3f ms\n", curve.setting.empty() ? "-" : curve.setting.c_str(),
               point.setting, error, point.timing.seconds.median * 1e3);
}

// Made when the first contender asks for it.
const Reference& reference_for(const BenchScene& scene, Walls walls, Findings& found) {
  for (const Reference& known : found.references) {
    if (known.scene == scene.name && known.walls == walls) return known;
  }
  tell(scene.name + " reference");
  Reference reference = reference_of(scene, walls);
  if (walls == scene.walls && !scene.chaotic) {
    const auto independent = independent_amplitudes(compared_part(scene), walls);
    if (independent) reference.from_independent = amplitude_error(*independent, reference.amplitude);
  }
  return found.references.emplace_back(std::move(reference));
}

void measure_curves(const Limits& limits, Findings& found) {
  const auto enter = [&](const std::vector<Contender>& contenders, bool ours, const BenchScene& scene) {
    for (const Contender& contender : contenders) {
      if (!takes_part(contender, ours, scene)) continue;
      const Reference& reference = reference_for(scene, contender.walls, found);
      found.curves.push_back(measure_curve(scene, contender, ours, reference, limits, {tell, tell_point}));
      const auto known = [&](const Findings::Entrant& entrant) { return entrant.name == contender.name; };
      if (std::ranges::none_of(found.entrants, known)) {
        found.entrants.push_back({contender.name, contender.about});
      }
    }
  };
  const std::vector<Contender> own = engines(), others = peers();
  for (const BenchScene& scene : found.scenes) {
    enter(own, true, scene);
    enter(others, false, scene);
    if (scene.dampers > 0) continue;
    if (scene.walls == Walls::compliant || scene.with_others) {
      found.counts.push_back({scene.name, "exact", count(scene.scene, Exact{})});
    }
    if (scene.walls == Walls::rigid || scene.with_others) {
      found.counts.push_back({scene.name, "restitution", count(scene.scene, Restitution{})});
    }
  }
  std::vector<double> reference_operations;
  for (const Curve& curve : found.curves) {
    for (const Point& point : curve.points)
      reference_operations.push_back(point.timing.reference_operation.median);
  }
  found.reference_operation = spread_of(reference_operations);
}

// The results, for the terminal.
void print(const std::vector<Result>& results) {
  for (const Result& result : results) {
    char measured[32] = "-";
    if (result.measured)
      std::snprintf(measured, sizeof measured, "%.3g %s", *result.measured, result.unit.c_str());
    std::printf("%-4s%-74s%s %-8g%-14s%s\n", result.within() ? "" : "NO", result.what.c_str(),
                result.at_most ? "<=" : ">=", result.bound, measured, result.note.c_str());
  }
}

struct Arguments {
  std::filesystem::path folder;
  bool quick = false;
  std::vector<std::string> only;  // names of scenes; empty: all, and all that is no scene
};

// Absent if they are not as they should be.
std::optional<Arguments> read_arguments(const std::vector<std::string>& given) {
  if (given.empty() || given[0].starts_with("--")) return std::nullopt;
  Arguments arguments{.folder = given[0]};
  const std::vector<BenchScene> scenes = bench_scenes();
  for (std::size_t i = 1; i < given.size(); ++i) {
    if (given[i] == "--quick") {
      arguments.quick = true;
    } else if (given[i] == "--only" && ++i < given.size() &&
               std::ranges::find(scenes, given[i], &BenchScene::name) != scenes.end()) {
      arguments.only.push_back(given[i]);
    } else {
      return std::nullopt;
    }
  }
  return arguments;
}

int bench(const Arguments& arguments) {
  const auto& [folder, quick, only] = arguments;
  if (!quick) add_repeats_for(300);
  std::filesystem::create_directories(folder);
  for (const char* name : {"bench.json", "results.json", "results.md", "time_error.dat", "cost.dat"}) {
    require_writable(folder / name);
  }
  const auto begin = std::chrono::steady_clock::now();
  const Limits limits = quick ? Limits{.longest_run = 0.03,
                                       .longest_chaotic_run = 0.03,
                                       .repeated_fully = 1,
                                       .repeats = 3,
                                       .few = 3}
                              : Limits{};

  Findings found{.processor = processor(), .scenes = bench_scenes(), .missing_peers = missing_peers()};
  for (const std::string& peer : found.missing_peers) tell("Not in this build: " + peer);
  if (!only.empty()) {
    std::erase_if(found.scenes, [&only = only](const BenchScene& scene) {
      return std::ranges::find(only, scene.name) == only.end();
    });
  }
  measure_curves(limits, found);
  if (only.empty()) {
    found.sweeps = measure_sweeps(quick ? 1e4 : 1e7, tell);
    tell("the figures' scenes and tables");
    found.figures = measure_figure_set(IMPACT_DAMPER_SOURCE, quick ? 3 : 9);
    found.allocations = count_allocations();
    tell("two threads");
    found.speedup = measure_speedup(quick ? 3 : 41);
    tell("sweeps");
    found.many_runs = measure_many_runs(quick ? 3 : 21);
    tell("friction, weight and drag");
    found.components = measure_components(quick ? 5 : 31);
    tell("elementary functions");
    found.functions = measure_functions(quick ? 9 : 101);
  }
  found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  write_file(folder / "bench.json", report_json(found));
  write_file(folder / "results.json", results_json(found));
  write_file(folder / "time_error.dat", time_error_table(found));
  write_file(folder / "cost.dat", sweep_table(found));
  write_file(folder / "results.md", report_page(found));
  print(results_of(found));
  return 0;
}

}  // namespace
}  // namespace impact_damper::bench

int main(int count, char** arguments) {
  const auto read = impact_damper::bench::read_arguments({arguments + 1, arguments + count});
  if (!read) {
    std::fprintf(stderr, "usage: %s FOLDER [--quick] [--only SCENE]...\nscenes:", arguments[0]);
    for (const auto& scene : impact_damper::bench::bench_scenes()) {
      std::fprintf(stderr, " '%s'", scene.name.c_str());
    }
    std::fputs("\n", stderr);
    return 2;
  }
  try {
    return impact_damper::bench::bench(*read);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 5;
  }
}
