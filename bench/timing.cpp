#include "timing.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>

namespace impact_damper::bench {

namespace {
double cpu_clock() {
  std::timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}
double seconds_to_add = 0;

// Whether the core is one's own for the moment.
//
// A processor may be half a core, whose other half is another guest's. The two share caches, the decoder and
// the memory of branches: long code that branches much takes a fifth to a third longer beside a busy
// neighbour, and a chain of operations that wait for each other, as the reference operation is, hardly
// notices. What does notice is a short sort: the third time over, a core of one's own knows each of its
// branches.
class OwnCore {
 public:
  OwnCore();
  // Asks once more. Beside a neighbour a sort takes twice as long at least: 1.75 times the fastest is the
  // limit.
  bool now();

 private:
  double sorting() const;  // CPU seconds

  std::vector<unsigned> numbers_;
  double least_;
};

OwnCore::OwnCore() : numbers_(2000) {
  std::mt19937 random;
  for (unsigned& number : numbers_) number = unsigned(random());
  least_ = sorting();
}

bool OwnCore::now() {
  const double time = sorting();
  least_ = std::min(least_, time);
  return time < 1.75 * least_;
}

double OwnCore::sorting() const {
  double least = 1;
  for (int i = 0; i < 3; ++i) {
    std::vector<unsigned> numbers = numbers_;
    least = std::min(least, cpu_seconds([&] { std::sort(numbers.begin(), numbers.end()); }));
  }
  return least;
}
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
