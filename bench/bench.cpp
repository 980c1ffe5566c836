// The bench: run time beside error, scene by scene and contender by contender.
//
//   impact-damper-bench FOLDER     writes FOLDER/bench.json and FOLDER/time_error.dat (time_error.gp draws
//   it)
//
//   S1  regular motion just above the first chaotic range: x0 = 4.5 to t = 100
//   S2  the same with rigid walls
//   S3  bounce-down and stuck: x0 = 6 to t = 400
//   S5  the whole decay, 6 to 0.03: chaotic, so no amplitude can be compared; time per impact only
// nu = 0.02, e = 0.6, zeta = 0, k = 1e4. Everything included: a run is one call of simulate(), which checks
// the scene and returns its half cycles.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "counted.hpp"
#include "impact_damper/files/file_output.hpp"
#include "impact_damper/files/number_text.hpp"
#include "impact_damper/files/provenance.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "timing.hpp"

namespace impact_damper::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int repeats = 9;

Scene scene_of(double x0) {
  Scene scene;
  scene.x0 = x0;
  return scene;
}
Scene until(Scene scene, double time) {
  scene.until_time = time;
  return scene;
}
Scene down_to(Scene scene, double amplitude) {
  scene.until_amplitude = amplitude;
  return scene;
}

const Scene regular = until(scene_of(4.5), 100);
const Scene bounce_down = until(scene_of(6), 400);
const Scene decay = down_to(scene_of(6), 0.03);

struct Contender {
  std::string scene_name;
  Scene scene;
  std::string name;
  Engine engine;
  bool has_error;
};

std::vector<Contender> contenders() {
  std::vector<Contender> all{
      {"S1", regular, "exact", Exact{}, true},     {"S2", regular, "restitution", Restitution{}, true},
      {"S3", bounce_down, "exact", Exact{}, true}, {"S3", bounce_down, "restitution", Restitution{}, true},
      {"S5", decay, "exact", Exact{}, false},      {"S5", decay, "restitution", Restitution{}, false},
  };
  for (const auto& [scene_name, scene] : {std::pair{"S1", regular}, std::pair{"S3", bounce_down}}) {
    for (bool locate : {false, true}) {
      for (int steps_in_contact = 8; steps_in_contact <= 1024; steps_in_contact *= 2) {
        Cem options;
        options.time_step = nominal_contact_time(scene) / steps_in_contact;
        options.locate = locate;
        all.push_back({scene_name, scene, locate ? "cem located" : "cem", options, true});
      }
    }
  }
  return all;
}

// Computed once for each scene and model; the component element method's is the exact engine's.
class References {
 public:
  struct Entry {
    Scene scene;
    bool rigid;
    std::vector<double> amplitude;
    std::optional<double> from_long_double;
  };
  const Entry& of(const Contender& contender) {
    const bool rigid = std::holds_alternative<Restitution>(contender.engine);
    for (const Entry& known : entries_) {
      if (known.scene == contender.scene && known.rigid == rigid) return known;
    }
    std::fprintf(stderr, "%s: reference in %s\n", contender.scene_name.c_str(),
                 std::string(reference_scalar()).c_str());
    const auto compute = [&](const auto& options) {
      auto amplitude = reference_amplitudes(contender.scene, options);
      const auto distance = amplitude_error(long_double_amplitudes(contender.scene, options), amplitude);
      entries_.push_back({contender.scene, rigid, std::move(amplitude), distance});
    };
    rigid ? compute(Restitution{}) : compute(Exact{});
    return entries_.back();
  }

 private:
  std::vector<Entry> entries_;
};

struct Result {
  Contender contender;
  std::int64_t impacts = 0;
  Timing timing;
  std::optional<double> error;
  std::optional<double> reference_error;  // the reference's distance from long double
  std::optional<CountedRun> counted;

  std::optional<double> time_step() const {
    const auto* cem = std::get_if<Cem>(&contender.engine);
    return cem ? cem->time_step : std::nullopt;
  }
  double yardsticks_per_impact() const { return timing.yardsticks.median / double(impacts); }
};

std::optional<CountedRun> count_calls(const Contender& contender) {
  if (const auto* exact = std::get_if<Exact>(&contender.engine)) return count(contender.scene, *exact);
  if (const auto* rigid = std::get_if<Restitution>(&contender.engine)) return count(contender.scene, *rigid);
  return {};
}

Result run(const Contender& contender, References& references) {
  Result result{.contender = contender};
  const Run once = simulate(contender.scene, contender.engine, {.half_cycles = true, .impacts = true});
  result.impacts = std::int64_t(once.impacts->time.size());
  if (contender.has_error) {
    const References::Entry& reference = references.of(contender);
    result.error = amplitude_error(once.half_cycles->amplitude, reference.amplitude);
    // Where the reference is long double itself there is nothing to hold it against.
    if (reference_scalar() != "long double") result.reference_error = reference.from_long_double;
  }
  result.counted = count_calls(contender);
  result.timing =
      measure([&] { simulate(contender.scene, contender.engine, {.half_cycles = true}); }, repeats);
  return result;
}

// What Linux calls the processor; "unknown" elsewhere.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

Json json_of(const Spread& spread, double scale = 1) {
  return {{"median", scale * spread.median},
          {"lower_quartile", scale * spread.lower},
          {"upper_quartile", scale * spread.upper}};
}

Json json_of(const CountedRun& counted) {
  const Counts& c = counted.counts;
  return {
      {"searches", c.searches},   {"evaluations", c.evaluations},          {"steps", c.steps},
      {"sincos", c.sincos},       {"exponentials", c.exponentials},        {"square_roots", c.square_roots},
      {"divisions", c.divisions}, {"other_arithmetic", c.other_arithmetic}};
}

Json json_of(const Result& result) {
  Json json{{"scene", result.contender.scene_name}, {"contender", result.contender.name}};
  if (result.time_step()) json["time_step"] = *result.time_step();
  json["impacts"] = result.impacts;
  if (result.error) json["error"] = *result.error;
  if (result.reference_error) json["reference_from_long_double"] = *result.reference_error;
  json["nanoseconds"] = json_of(result.timing.seconds, 1e9);
  json["yardsticks"] = json_of(result.timing.yardsticks);
  json["yardsticks_per_impact"] = result.yardsticks_per_impact();
  json["repeats"] = result.timing.repeats;
  json["runs_per_repeat"] = result.timing.runs;
  if (result.counted) json["counts"] = json_of(*result.counted);
  return json;
}

Json report(const std::vector<Result>& results, const Spread& yardstick) {
  const Provenance& made = provenance();
  Json json{{"schema", "impact-damper/bench/1"},
            {"machine", {{"processor", processor()}, {"threads", std::thread::hardware_concurrency()}}},
            {"provenance",
             {{"version", made.version},
              {"commit", made.commit},
              {"compiler", made.compiler},
              {"build_type", made.build_type},
              {"flags", made.flags},
              {"system", made.system}}},
            {"clock", "CPU time of the process"},
            {"yardstick",
             {{"what", "one of a chain of dependent sincos calls of the C library"},
              {"nanoseconds", json_of(yardstick, 1e9)}}},
            {"reference", reference_scalar()}};
  for (const Result& result : results) json["results"].push_back(json_of(result));
  return json;
}

// One block for each curve: "scene-contender", columns error and run time in yardsticks.
std::string table_of(const std::vector<Result>& results, const Spread& yardstick) {
  std::string text =
      "# Run time beside error, drawn by bench/time_error.gp.\n"
      "# error: largest difference of a half-cycle amplitude from the reference, by epsilon\n"
      "# time, lower, upper: median and quartiles of a run, in yardsticks (dependent sincos calls)\n"
      "# Parameters: " +
      processor() + "; a yardstick is " + number_text(std::round(yardstick.median * 1e10) / 10) + " ns\n";
  std::string block;
  for (const Result& result : results) {
    if (!result.error) continue;
    std::string name = result.contender.scene_name + "-" + result.contender.name;
    std::replace(name.begin(), name.end(), ' ', '-');
    if (name != block) {
      text += "\n\n# " + name + "\nerror time lower upper\n";
      block = name;
    }
    const Spread& time = result.timing.yardsticks;
    for (double number : {*result.error, time.median, time.lower, time.upper})
      text += number_text(number) + " ";
    text.back() = '\n';
  }
  return text;
}

std::string printed(const char* format, double number) {
  char text[32];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

void print(const std::vector<Result>& results, const Spread& yardstick) {
  std::printf("yardstick: %.1f ns (quartiles %.1f to %.1f)\n\n", yardstick.median * 1e9,
              yardstick.lower * 1e9, yardstick.upper * 1e9);
  std::printf("%-5s%-13s%11s%11s%12s%13s%8s%14s\n", "", "", "time step", "error", "run, ms", "yardsticks",
              "spread", "per impact");
  for (const Result& result : results) {
    const Spread& time = result.timing.yardsticks;
    std::printf(
        "%-5s%-13s%11s%11s%12.3f%13.0f%7.1f%%%14.2f\n", result.contender.scene_name.c_str(),
        result.contender.name.c_str(), result.time_step() ? printed("%.2e", *result.time_step()).c_str() : "",
        result.error ? printed("%.1e", *result.error).c_str() : "", result.timing.seconds.median * 1e3,
        time.median, 50 * (time.upper - time.lower) / time.median, result.yardsticks_per_impact());
  }
  std::printf("\nspread: half the distance of the quartiles; per impact: yardsticks. Counts per impact:\n\n");
  std::printf("%-5s%-13s%9s%10s%13s%8s%8s%7s%7s%11s%8s\n", "", "", "impacts", "searches", "evaluations",
              "steps", "sincos", "exp", "sqrt", "divisions", "+ - *");
  for (const Result& result : results) {
    if (!result.counted) continue;
    const Counts& c = result.counted->counts;
    const double n = double(result.counted->impacts);
    std::printf("%-5s%-13s%9lld%10.2f%13.2f%8.2f%8.2f%7.2f%7.2f%11.0f%8.0f\n",
                result.contender.scene_name.c_str(), result.contender.name.c_str(),
                static_cast<long long>(result.counted->impacts), c.searches / n, c.evaluations / n,
                c.steps / n, c.sincos / n, c.exponentials / n, c.square_roots / n, c.divisions / n,
                c.other_arithmetic / n);
  }
}

int bench(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const std::filesystem::path json_file = folder / "bench.json", table_file = folder / "time_error.dat";
  require_writable(json_file);
  require_writable(table_file);

  const std::vector<Contender> all = contenders();
  References references;
  std::vector<Result> results;
  std::vector<double> yardsticks;
  for (const Contender& contender : all) {
    const auto* cem = std::get_if<Cem>(&contender.engine);
    std::fprintf(stderr, "[%zu/%zu] %s %s%s\n", results.size() + 1, all.size(), contender.scene_name.c_str(),
                 contender.name.c_str(), cem ? printed(", step %.2e", *cem->time_step).c_str() : "");
    results.push_back(run(contender, references));
    yardsticks.push_back(results.back().timing.yardstick.median);
  }
  const Spread yardstick = spread_of(yardsticks);
  write_file(json_file, report(results, yardstick).dump(1) + "\n");
  write_file(table_file, table_of(results, yardstick));
  print(results, yardstick);
  return 0;
}

}  // namespace
}  // namespace impact_damper::bench

int main(int count, char** arguments) {
  if (count != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", arguments[0]);
    return 2;
  }
  try {
    return impact_damper::bench::bench(arguments[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 5;
  }
}
