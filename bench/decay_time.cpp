// Times a decay by the C interface, as the WebAssembly module is timed (decay_time.mjs): decay_time SCENE
// COUNT. Prints the median of COUNT runs after as many to warm up, in ms, and the time at which the decay
// ended.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "impact_damper/c_interface.h"

int main(int count_of_words, char** words) {
  if (count_of_words != 3) return std::fputs("usage: decay_time SCENE COUNT\n", stderr), 2;
  std::ifstream file(words[1]);
  const std::string scene{std::istreambuf_iterator<char>(file), {}};
  const int count = std::atoi(words[2]);
  std::vector<double> times;
  double end_time = 0;
  for (int i = 0; i < 2 * count; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    impact_damper_run* run = nullptr;
    char error[500];
    if (impact_damper_simulate_recording(scene.c_str(), "exact", 0, nullptr, &run, error, sizeof error) !=
        IMPACT_DAMPER_DONE)
      return std::fprintf(stderr, "%s\n", error), 1;
    const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - begin;
    std::size_t rows = 0;
    end_time = *impact_damper_column(run, "end_time", &rows);
    impact_damper_free(run);
    if (i >= count) times.push_back(passed.count());
  }
  std::ranges::nth_element(times, times.begin() + count / 2);
  std::printf("%.17g %.17g\n", times[std::size_t(count / 2)], end_time);
}
