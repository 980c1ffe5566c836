// What the stress program finds: one line for each thing that was tried, and every miss with what repeats it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace stress {

struct Check {
  std::string subject;   // of the program's --only
  std::string what;      // a sentence
  std::string measured;  // the worst of all cases, as text
  std::string allowed;
  std::int64_t cases = 0, missed = 0;
  std::vector<std::string> misses;  // the first ones: seed, numbers, scene

  static constexpr std::size_t most_misses = 20;
  void miss(const std::string& what_and_how_to_repeat) {
    ++missed;
    if (misses.size() < most_misses) misses.push_back(what_and_how_to_repeat);
  }
};

// The largest of many numbers, a NaN being larger than all.
class Worst {
 public:
  void take(double value) {
    if (!(value <= worst_)) worst_ = value;
  }
  double value() const { return worst_; }
  operator double() const { return worst_; }

 private:
  double worst_ = 0;
};

// "1.2e-16": two digits are enough to see how near a limit is.
std::string rounded(double value, int digits = 2);
std::string full(double value);  // 17 digits

// Markdown: the table, then every miss. The same as JSON.
std::string markdown(const std::vector<Check>& checks);
std::string json(const std::vector<Check>& checks);

// A line on standard error, at most one in two seconds; `done` of `all`.
class Progress {
 public:
  explicit Progress(std::string what) : what_(std::move(what)) {}
  void tell(std::int64_t done, std::int64_t all, const std::string& more = {});

 private:
  std::string what_;
  double last_ = -1;
};

double seconds();  // of a steady clock: for progress only, no result holds a time

}  // namespace stress
