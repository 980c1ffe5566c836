// What a run costs that no clock can tell: a scalar that is a double and counts what is done with it.
//
// The engines are templates over their scalar. They call the elementary functions by plain names, so that a
// scalar may bring its own, and tell SearchCounter what a search does. Both count here, and the functions do
// the same as in double: a counted run goes bit by bit the way of the run in double.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "impact_damper/engine.hpp"
#include "impact_damper/events/search.hpp"
#include "impact_damper/math/double_double.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper::bench {

struct Counts {
  std::int64_t predictions = 0;  // the first four as SearchCounter tells them (events/search.hpp)
  std::int64_t searches = 0;
  std::int64_t evaluations = 0;  // corrections, too
  std::int64_t steps = 0;
  std::array<std::int64_t, ways_to_find> found{};
  std::int64_t sincos = 0;        // sine and cosine of one angle count once
  std::int64_t exponentials = 0;  // exp and expm1
  std::int64_t arctangents = 0;
  std::int64_t square_roots = 0;
  std::int64_t divisions = 0;
  std::int64_t other_arithmetic = 0;  // + - *
};
inline thread_local Counts counts;

class Counted {
 public:
  Counted() = default;
  Counted(double value) : value_(value) {}
  explicit operator double() const { return value_; }

  Counted operator-() const { return -value_; }
  friend Counted operator+(const Counted& a, const Counted& b) { return counted(a.value_ + b.value_); }
  friend Counted operator-(const Counted& a, const Counted& b) { return counted(a.value_ - b.value_); }
  friend Counted operator*(const Counted& a, const Counted& b) { return counted(a.value_ * b.value_); }
  friend Counted operator/(const Counted& a, const Counted& b) {
    ++counts.divisions;
    return a.value_ / b.value_;
  }
  Counted& operator+=(const Counted& b) { return *this = *this + b; }
  Counted& operator-=(const Counted& b) { return *this = *this - b; }
  Counted& operator*=(const Counted& b) { return *this = *this * b; }
  Counted& operator/=(const Counted& b) { return *this = *this / b; }

  friend bool operator==(const Counted& a, const Counted& b) { return a.value_ == b.value_; }
  friend auto operator<=>(const Counted& a, const Counted& b) { return a.value_ <=> b.value_; }

 private:
  static double counted(double value) {
    ++counts.other_arithmetic;
    return value;
  }
  double value_ = 0;
};

// What tables are made in that have to be better than double: once per scene, not counted.
class ExtendedCounted {
 public:
  ExtendedCounted() = default;
  explicit ExtendedCounted(double value) : value_(value) {}
  explicit ExtendedCounted(const Counted& value) : value_(double(value)) {}
  explicit operator Counted() const { return double(value_); }

  ExtendedCounted operator-() const { return -value_; }
  friend ExtendedCounted operator+(const ExtendedCounted& a, const ExtendedCounted& b) {
    return a.value_ + b.value_;
  }
  friend ExtendedCounted operator-(const ExtendedCounted& a, const ExtendedCounted& b) {
    return a.value_ - b.value_;
  }
  friend ExtendedCounted operator*(const ExtendedCounted& a, const ExtendedCounted& b) {
    return a.value_ * b.value_;
  }
  friend ExtendedCounted operator/(const ExtendedCounted& a, const ExtendedCounted& b) {
    return a.value_ / b.value_;
  }
  friend ExtendedCounted sqrt(const ExtendedCounted& a) { return sqrt(a.value_); }

 private:
  ExtendedCounted(const DoubleDouble& value) : value_(value) {}
  DoubleDouble value_;
};

inline SinCos<Counted> sin_cos(const Counted& angle) {
  ++counts.sincos;
  const auto [sin, cos] = impact_damper::sin_cos(double(angle));
  return {sin, cos};
}
inline Counted exponential(const Counted& x) {
  ++counts.exponentials;
  return impact_damper::exponential(double(x));
}
inline Counted exponential_minus_1(const Counted& x) {
  ++counts.exponentials;
  return impact_damper::exponential_minus_1(double(x));
}
inline Counted angle_of(const Counted& y, const Counted& x) {
  ++counts.arctangents;
  return impact_damper::angle_of(double(y), double(x));
}
inline Counted square_root(const Counted& x) {
  ++counts.square_roots;
  return impact_damper::square_root(double(x));
}
// Once per scene: not counted.
inline Counted logarithm(const Counted& x) { return impact_damper::logarithm(double(x)); }
inline Counted acos(const Counted& x) { return std::acos(double(x)); }

// What a run of the scene counts, its half cycles recorded, and how many impacts it has.
struct CountedRun {
  Counts counts;
  std::int64_t impacts = 0;
  std::vector<double> amplitude;  // of its half cycles
};
// What is given out by impact: its key in JSON, its heading on the page, which shows large counts without
// decimals.
struct CountInfo {
  const char *name, *heading;
  std::int64_t Counts::*count;
  bool many = false;
  double of(const CountedRun& run) const { return double(run.counts.*count) / double(run.impacts); }
};
inline constexpr CountInfo per_impact[] = {{"predictions", "predictions", &Counts::predictions},
                                           {"searches", "searches", &Counts::searches},
                                           {"evaluations", "evaluations", &Counts::evaluations},
                                           {"steps", "steps", &Counts::steps},
                                           {"sincos", "sincos", &Counts::sincos},
                                           {"exponentials", "exp", &Counts::exponentials},
                                           {"arctangents", "atan", &Counts::arctangents},
                                           {"square_roots", "sqrt", &Counts::square_roots},
                                           {"divisions", "divisions", &Counts::divisions, true},
                                           {"other_arithmetic", "+ − ×", &Counts::other_arithmetic, true}};
CountedRun count(const Scene& scene, const Exact& options);
CountedRun count(const Scene& scene, const Restitution& options);

}  // namespace impact_damper::bench

template <>
struct std::numeric_limits<impact_damper::bench::Counted> : std::numeric_limits<double> {};

template <>
struct impact_damper::Extended<impact_damper::bench::Counted> {
  using Type = bench::ExtendedCounted;
};

template <>
struct impact_damper::SearchCounter<impact_damper::bench::Counted> {
  static void prediction() { ++bench::counts.predictions; }
  static void correction() { ++bench::counts.evaluations; }
  static void search() { ++bench::counts.searches; }
  static void evaluation() { ++bench::counts.evaluations; }
  static void step() { ++bench::counts.steps; }
  static void found(FoundBy way) { ++bench::counts.found[std::size_t(way)]; }
};
