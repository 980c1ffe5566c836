#include "many_runs.hpp"

#include <chrono>
#include <functional>

#include "application/sweeps/plan_file.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper::bench {
namespace {

double seconds(const auto& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// `analysis`: what the quantities ask of a run, which is none of the sweep's own time.
ManyRuns measure(const std::string& kept, double bound, const std::string& quantities, int repeats,
                 const std::function<void(const Run&)>& analysis) {
  const Plan plan = parse_plan("bench", R"({"schema": "impact-damper/plan/1",
    "scene": {"x0": 6, "until_amplitude": 0.03},
    "grid": [{"number": "restitution", "from": 0.5, "to": 0.7, "count": 16},
             {"number": "mass_ratio", "from": 0.045, "to": 0.055, "count": 16}],
    "quantities": [)" + quantities + "]}");
  ManyRuns found{.kept = kept, .bound = bound, .runs = runs_of(plan), .repeats = repeats};
  const auto rows = [&](std::int64_t threads) {
    for_each_in_order(
        found.runs, threads, [&](std::int64_t i) { return row_of(plan, i); }, [](const std::string&) {});
  };
  const auto runs = [&](const std::function<void(const Run&)>& then) {
    for (std::int64_t i = 0; i < found.runs; ++i)
      then(simulate(run_of(plan, i).scene, plan.engine, {.half_cycles = true}));
  };
  std::vector<double> engine, one, two, analysed, overhead, ratio;
  for (int i = 0; i < repeats; ++i) {
    engine.push_back(seconds([&] { runs([](const Run&) {}); }));
    const double both = seconds([&] { runs(analysis); });
    one.push_back(seconds([&] { rows(1); }));
    two.push_back(seconds([&] { rows(2); }));
    analysed.push_back(both / engine.back() - 1);
    overhead.push_back((one.back() - both) / engine.back());
    ratio.push_back(one.back() / two.back());
  }
  found.engine = spread_of(engine);
  found.analysis = spread_of(analysed);
  found.one = spread_of(one);
  found.two = spread_of(two);
  found.overhead = spread_of(overhead);
  found.ratio = spread_of(ratio);
  return found;
}

}  // namespace

std::vector<ManyRuns> measure_many_runs(int repeats) {
  return {measure("times and counts", 4, R"("time_to_amplitude=0.6", "time_to_amplitude=0.1", "impacts")",
                  repeats, [](const Run&) {}),
          measure("loss factors", 5, R"("largest_loss_factor", "loss_factor_at=1", "impacts")", repeats,
                  [](const Run& run) { loss_before_failure(run); })};
}

}  // namespace impact_damper::bench
