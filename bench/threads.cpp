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
  ensemble(2);
  std::vector<double> one, two, ratio, side_by_side;
  for (int i = 0; i < repeats; ++i) {
    one.push_back(seconds([&] { ensemble(1); }));
    two.push_back(seconds([&] { ensemble(2); }));
    ratio.push_back(one.back() / two.back());
    side_by_side.push_back(2 * one.back() / seconds([&] {
                             std::thread other([&] { ensemble(1); });
                             ensemble(1);
                             other.join();
                           }));
  }
  speedup.one = spread_of(one);
  speedup.two = spread_of(two);
  speedup.ratio = spread_of(ratio);
  speedup.side_by_side = spread_of(side_by_side);
  return speedup;
}

}  // namespace impact_damper::bench
