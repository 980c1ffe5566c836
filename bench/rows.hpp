// What a contender delivers, and how a peer keeps it. (C++17 is enough, for peers whose headers know no
// more.)
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace impact_damper::bench {

// Half cycles as HalfCycles (run.hpp) has them.
struct Rows {
  std::vector<double> zero_crossing, peak_time, amplitude;
  std::int64_t impacts = 0;  // met in all, those after the last row too where they are counted
};

// Told of every zero crossing of x and of every instant at which |x| may be largest, in any order within a
// half cycle, it makes the rows that the engines' recorder makes.
class RowBook {
 public:
  explicit RowBook(double x0, std::optional<double> until_amplitude = {})
      : until_(until_amplitude), best_(std::abs(x0)) {}

  void peak(double time, double x) {
    if (!(std::abs(x) > best_)) return;
    best_ = std::abs(x);
    best_time_ = time;
  }
  // True if the scene ends here: the row that ends is the first below until_amplitude.
  bool zero_crossing(double time) {
    rows_.zero_crossing.push_back(time);
    rows_.peak_time.push_back(best_time_);
    rows_.amplitude.push_back(best_);
    const bool low = until_ && best_ < *until_;
    best_ = 0;
    best_time_ = time;
    return low;
  }
  void impact() { ++rows_.impacts; }

  Rows finish() { return std::move(rows_); }

 private:
  std::optional<double> until_;
  double best_, best_time_ = 0;
  Rows rows_;
};

}  // namespace impact_damper::bench
