#include "threads.hpp"

#include <chrono>

#include "impact_damper/analysis/ensemble.hpp"

namespace impact_damper::bench {

Speedup measure_speedup(int repeats) {
  const Scene decay{.x0 = 6, .until_amplitude = 0.03};
  Speedup speedup{.members = 128, .repeats = repeats};
  const auto seconds = [&](std::int64_t threads) {
    const auto begin = std::chrono::steady_clock::now();
    simulate_ensemble(decay, Exact{}, {.half_cycles = true},
                      {.members = speedup.members, .threads = threads});
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  seconds(2);
  std::vector<double> one, two, ratio;
  for (int i = 0; i < repeats; ++i) {
    one.push_back(seconds(1));
    two.push_back(seconds(2));
    ratio.push_back(one.back() / two.back());
  }
  speedup.one = spread_of(one);
  speedup.two = spread_of(two);
  speedup.ratio = spread_of(ratio);
  return speedup;
}

}  // namespace impact_damper::bench
