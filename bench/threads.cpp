#include "threads.hpp"

#include <chrono>
#include <thread>

#include "impact_damper/analysis/ensemble.hpp"

namespace impact_damper::bench {

Speedup measure_speedup(int repeats) {
  const Scene decay{.x0 = 6, .until_amplitude = 0.03};
  Speedup speedup{.members = 128, .repeats = repeats};
  const auto ensemble = [&](std::int64_t threads) {
    simulate_ensemble(decay, Exact{}, {.half_cycles = true},
                      {.members = speedup.members, .threads = threads});
  };
  const auto seconds = [](auto&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
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
