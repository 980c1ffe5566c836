// The subjects of the stress program, one file each, and what they find: one line for each thing that was
// tried, and every miss with what repeats it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"

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

struct Options {
  bool brief = false;                 // the same with smaller counts
  std::optional<std::uint64_t> seed;  // this case only, told in full
  std::int64_t scenes = 0;            // how many random ones
  impact_damper::Threads threads;
  std::filesystem::path folder;        // for tables that are drawn
  std::filesystem::path scene_folder;  // the scenes of the figures
};

std::vector<Check> central_differences(const Options& options);
std::vector<Check> random_scenes_of_all_kinds(const Options& options);
std::vector<Check> aimed_scenes(const Options& options);
std::vector<Check> several_dampers(const Options& options);
std::vector<Check> sensitivity(const Options& options);

}  // namespace stress
