#include <chrono>
#include <functional>
#include <thread>

#include "application/sweeps/plan.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/simulate.hpp"
#include "measurements.hpp"

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

Speedup measure_speedup(int repeats) {
  const Scene decay{.x0 = 6, .until_amplitude = 0.03};
  Speedup speedup{.members = 128, .repeats = repeats};
  const auto ensemble = [&](std::int64_t threads) {
    simulate_ensemble(decay, Exact{}, {.half_cycles = true},
                      {.members = speedup.members, .threads = threads});
  };
  struct Sample {
    std::vector<double> one, two, ratio, side_by_side;
  } all, on_two_cores;
  ensemble(2);
  for (int i = 0; i < repeats; ++i) {
    const double one = seconds([&] { ensemble(1); }), two = seconds([&] { ensemble(2); });
    // Beside another run of one: a slow one must not be in both, and choose what counts.
    const double alone = seconds([&] { ensemble(1); });
    const double side_by_side = 2 * alone / seconds([&] {
                                  std::thread other([&] { ensemble(1); });
                                  ensemble(1);
                                  other.join();
                                });
    for (Sample* sample : {&all, &on_two_cores}) {
      if (sample == &on_two_cores && side_by_side < 1.9) continue;
      sample->one.push_back(one);
      sample->two.push_back(two);
      sample->ratio.push_back(one / two);
      sample->side_by_side.push_back(side_by_side);
    }
  }
  speedup.on_two_cores = int(on_two_cores.one.size());
  const Sample& taken = speedup.on_two_cores < 9 ? all : on_two_cores;
  speedup.one = spread_of(taken.one);
  speedup.two = spread_of(taken.two);
  speedup.ratio = spread_of(taken.ratio);
  speedup.side_by_side = spread_of(taken.side_by_side);
  return speedup;
}

}  // namespace impact_damper::bench
