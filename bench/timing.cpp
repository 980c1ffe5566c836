#include "timing.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "own_core.hpp"

namespace impact_damper::bench {

namespace {
double cpu_clock() {
  std::timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}
double seconds_to_add = 0;
}  // namespace

double cpu_seconds(const std::function<void()>& work) {
  const double begin = cpu_clock();
  work();
  return cpu_clock() - begin;
}

void add_repeats_for(double seconds) { seconds_to_add = seconds; }

Spread spread_of(std::vector<double> sample) {
  if (sample.empty()) return {};
  std::sort(sample.begin(), sample.end());
  const std::size_t n = sample.size();
  return {sample[(n - 1) / 4], sample[(n - 1) / 2], sample[n - 1 - (n - 1) / 4]};
}

double reference_operation() {
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
      const double begin = cpu_clock();
      do {
        run();
        ++tried;
      } while (cpu_clock() - begin < least / 10);
    });
    runs = std::max(1, int(std::ceil(least / seconds * tried)));
  }

  static OwnCore core;
  struct Sample {
    std::vector<double> times, ratios, reference_operations;
    int size() const { return int(times.size()); }
  } all, undisturbed;
  double before = reference_operation(), added = 0;
  bool own_before = core.now();
  while (all.size() < repeats || (undisturbed.size() < repeats && added < 3 && seconds_to_add > 0)) {
    const double time = cpu_seconds([&] {
                          for (int j = 0; j < runs; ++j) run();
                        }) /
                        runs;
    const bool own_after = core.now();
    const double after = reference_operation();
    const auto take = [&](Sample& sample) {
      sample.times.push_back(time);
      sample.ratios.push_back(time / ((before + after) / 2));
      sample.reference_operations.push_back(after);
    };
    take(all);
    if (own_before && own_after) take(undisturbed);
    if (all.size() > repeats) {
      added += time * runs;
      seconds_to_add -= time * runs;
    }
    before = after;
    own_before = own_after;
  }
  const Sample& taken = undisturbed.size() < repeats ? all : undisturbed;
  return {spread_of(taken.times), spread_of(taken.ratios), spread_of(taken.reference_operations),
          taken.size(),           undisturbed.size(),      runs};
}

}  // namespace impact_damper::bench
