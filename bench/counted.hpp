// What a run costs that no clock can tell: a scalar that is a double and counts what is done with it.
//
// The engines are templates over their scalar, and call the elementary functions and the root finder by plain
// names: the overloads for Counted below are found first, count, and do the same in double. So a counted run
// goes bit by bit the way of the run in double.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "impact_damper/engine.hpp"
#include "impact_damper/events/impact_prediction.hpp"
#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper::bench {

struct Counts {
  std::int64_t guesses = 0;       // of a flight's end (impact_prediction.hpp)
  std::int64_t searches = 0;      // calls of first_root, where no guess is proved
  std::int64_t evaluations = 0;   // of a motion about a guess, and of the functions a search watches
  std::int64_t steps = 0;         // of the search, one for each function watched (step_without_root)
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

template <std::same_as<Counted> Real>
Prediction<Real> predict_impact(const Derivatives<Real, 10>& u, const Real& fourth, const Real& rate,
                                const Real& most) {
  ++counts.guesses;
  return impact_damper::predict_impact<Real>(u, fourth, rate, most);
}

template <std::same_as<Counted> Real>
TimeToLevel<Real> time_to_level(const Real& level, const Derivatives<Real, 6>& y, const Real& h,
                                const Real& fourth) {
  ++counts.evaluations;
  return impact_damper::time_to_level<Real>(level, y, h, fourth);
}

template <std::same_as<Counted> Real, class Watch>
std::optional<Root<Real>> first_root(Watch&& enclose, const Real& from, const Real& horizon, const Real& span,
                                     const Real& resolution) {
  ++counts.searches;
  const auto counting = [&](const Real& t) {
    ++counts.evaluations;
    return enclose(t);
  };
  return impact_damper::first_root<Real>(counting, from, horizon, span, resolution);
}

template <std::same_as<Counted> Real>
Real step_without_root(const Jet<Real>& jet, Real most) {
  ++counts.steps;
  return impact_damper::step_without_root<Real>(jet, most);
}

// What a run of the scene counts, its half cycles recorded, and how many impacts it has.
struct CountedRun {
  Counts counts;
  std::int64_t impacts = 0;
  std::vector<double> amplitude;  // of its half cycles
};
CountedRun count(const Scene& scene, const Exact& options);
CountedRun count(const Scene& scene, const Restitution& options);

}  // namespace impact_damper::bench

template <>
struct std::numeric_limits<impact_damper::bench::Counted> : std::numeric_limits<double> {};
