#include "timing.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace impact_damper::bench {

double cpu_seconds(const std::function<void()>& work) {
  const std::clock_t begin = std::clock();
  work();
  return double(std::clock() - begin) / CLOCKS_PER_SEC;
}

Spread spread_of(std::vector<double> sample) {
  if (sample.empty()) return {};
  std::sort(sample.begin(), sample.end());
  const std::size_t n = sample.size();
  return {sample[(n - 1) / 4], sample[(n - 1) / 2], sample[n - 1 - (n - 1) / 4]};
}

double yardstick() {
  constexpr int calls = 100'000;
  [[maybe_unused]] static volatile double sink;
  return cpu_seconds([] {
           double angle = 1;
           for (int i = 0; i < calls; ++i) {
             double sin, cos;
             ::sincos(angle, &sin, &cos);
             angle = sin + cos;  // settles at 1.2587: always the same path through sincos
           }
           sink = angle;
         }) /
         calls;
}

Timing measure(const std::function<void()>& run, int repeats, std::optional<double> first) {
  constexpr double least = 0.02;
  int runs = 1;
  double seconds = first ? *first : cpu_seconds(run);
  if (seconds < least) {
    // A first estimate from a tenth of it: one run may be below the clock's resolution.
    int tried = 0;
    seconds = cpu_seconds([&] {
      const std::clock_t begin = std::clock();
      do {
        run();
        ++tried;
      } while (double(std::clock() - begin) / CLOCKS_PER_SEC < least / 10);
    });
    runs = std::max(1, int(std::ceil(least / seconds * tried)));
  }

  std::vector<double> times, ratios, yardsticks;
  double before = yardstick();
  for (int i = 0; i < repeats; ++i) {
    const double time = cpu_seconds([&] {
                          for (int j = 0; j < runs; ++j) run();
                        }) /
                        runs;
    const double after = yardstick();
    times.push_back(time);
    ratios.push_back(time / ((before + after) / 2));
    yardsticks.push_back(after);
    before = after;
  }
  return {spread_of(times), spread_of(ratios), spread_of(yardsticks), repeats, runs};
}

}  // namespace impact_damper::bench
