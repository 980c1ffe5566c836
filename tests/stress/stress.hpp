// The subjects of the stress program, one file each, and what they share: one line for each thing that was
// tried, with every miss and what repeats it; and what any scene promises, whatever the engine.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engines/observed.hpp"
#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/run.hpp"

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
  void add(const Check& part);  // its cases and misses
  const char* all_or_not() const { return missed == 0 ? "all" : "not all"; }
};

// The largest of many numbers, a NaN being larger than all.
class Worst {
 public:
  void take(double value) {
    if (!(value <= worst_) && !std::isnan(worst_)) worst_ = value;
  }
  double value() const { return worst_; }
  operator double() const { return worst_; }

 private:
  double worst_ = 0;
};

// "1.2e-16": two digits are enough to see how near a limit is.
std::string rounded(double value, int digits = 2);
std::string full(double value);  // 17 digits

// A line on standard error, at most one in two seconds; `done` of `all`.
class Progress {
 public:
  explicit Progress(std::string what) : what_(std::move(what)) {}
  void tell(std::int64_t done, std::int64_t all, const std::string& more = {});

 private:
  std::string what_;
  double last_ = -1;
};

void say(const std::string& what);  // a line on standard error
double seconds();                   // of a steady clock: for progress only, no result holds a time

// An observer that asks an engine for nothing but impacts, and for samples when it is told to.
struct Sample {
  double time = 0, x = 0, v = 0, y = 0, w = 0;
};

class Watch : public impact_damper::TestObserver<double> {
 public:
  void impact(double time, impact_damper::Wall, double, double) override {
    ++impacts;
    last_impact = time;
  }
  double next_sample() const override { return sample_at; }
  // Keeps it; the next is `every` later, counted from the first.
  void sample(double time, double x, double v, double y, double w) override {
    if (samples.empty()) first_ = time;
    samples.push_back({time, x, v, y, w});
    sample_at = every > 0 ? first_ + every * double(samples.size()) : std::numeric_limits<double>::infinity();
  }

  double sample_at = std::numeric_limits<double>::infinity();
  double every = 0;  // 0: no more than one sample
  std::vector<Sample> samples;
  std::int64_t impacts = 0;
  double last_impact = 0;

 private:
  double first_ = 0;
};

// Each broken promise in words.
enum class Promise {
  finite,          // every number of the run
  consistent,      // agrees with itself (consistency.hpp), impacts ascend, losses are not negative
  bounded,         // ends by time or by the impacts that were granted; no impacts heaped on one instant
  between_walls,   // 0 <= y <= 1 in flight, beyond the wall in contact
  end_on_the_dot,  // a contact that the end of the run cuts ends with it
  balance,         // closes
};
inline constexpr std::array<const char*, 6> promises{"finite",        "consistent",     "bounded",
                                                     "between walls", "end on the dot", "energy balance"};

struct Examined {
  std::array<std::string, promises.size()> broken;  // by Promise; empty: kept
  double outside = 0;   // farthest y beyond its side of a wall, by what rounding may do
  double residual = 0;  // of the energy balance
  bool all_kept() const;
};

// Runs the scene with everything recorded, sampled at times that crowd near the release.
Examined examine(const impact_damper::Scene& scene, const impact_damper::Engine& engine);
// The same; the check has one case more, and what is broken is a miss. `which`: what repeats it.
Examined keep_promises(Check& check, const std::string& which, const impact_damper::Scene& scene,
                       const impact_damper::Engine& engine);

// On one line.
std::string in_full(const impact_damper::Scene& scene);
std::string in_full(const impact_damper::Scene& scene, const impact_damper::Engine& engine);

inline constexpr double closed_balance = 1e-10;
// A rounding is epsilon (1 + t) by the speeds and lengths that y is made of.
inline constexpr double roundings_beyond_a_wall = 64;

// The value so many last bits farther up, or down.
double steps_from(double value, int ulps);
// Two neighbouring doubles between which `predicate`, false at `low` and true at `high`, turns.
double last_bit(double low, double high, const std::function<bool(double)>& predicate);

struct Options {
  bool brief = false;                  // the same with smaller counts
  std::optional<std::uint64_t> seed;   // this case only, told in full
  std::int64_t scenes = 0;             // how many random ones
  std::filesystem::path folder;        // for tables that are drawn
  std::filesystem::path scene_folder;  // the scenes of the figures
};

std::vector<Check> central_differences(const Options& options);
std::vector<Check> random_scenes_of_all_kinds(const Options& options);
std::vector<Check> aimed_scenes(const Options& options);
std::vector<Check> several_dampers(const Options& options);
std::vector<Check> sensitivity(const Options& options);

}  // namespace stress
