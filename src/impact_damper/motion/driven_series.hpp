// The Taylor series of x about the beginning of a motion under a force (M4.4). It holds as long as what it
// leaves out is below rounding. Its sum needs no sine, and nothing cancels near resonance.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "impact_damper/math/power_series.hpp"
#include "impact_damper/motion/oscillator.hpp"

namespace impact_damper {

inline constexpr std::size_t driven_terms = 24;
// The first term left out of x'' is driven_radians^(terms - 2) / (terms - 2)! of the motion: epsilon / 64, or
// near critical damping and in resonance up to `terms` times that, which is still below rounding.
template <class Real>
inline constexpr double driven_radians = std::numeric_limits<Real>::digits10 < 17   ? 1.4562250345325596
                                         : std::numeric_limits<Real>::digits10 < 20 ? 1.029
                                                                                    : 0.22;
template <class Real>
using DrivenTerms = PairedSeries<Real, driven_terms / 2>;

// The series is linear in x, v and the force f0 sin(phi) and f0 cos(phi) at the beginning: the coefficients
// of each, made once for an oscillator and a frequency of the force.
template <class Real>
class DrivenSeriesTable {
 public:
  DrivenSeriesTable(const Oscillator<Real>& oscillator, const Real& frequency)
      : reach_(Real(driven_radians<Real>) / (frequency > oscillator.rate() ? frequency : oscillator.rate())) {
    Real power = 1 / oscillator.root_b();
    for (Real& each : growth_) {
      each = power;
      power *= frequency;
    }
    fast_ = frequency * frequency > 4 * oscillator.b();
    const Real re = oscillator.b() - frequency * frequency, im = 2 * oscillator.a() * frequency;
    const Real h2 = re * re + im * im;
    steady_ = {re / h2, im / h2, 1 / square_root(h2)};
    columns_[0] = column(oscillator, frequency, {1, 0}, {0, 0});
    columns_[1] = column(oscillator, frequency, {0, 1}, {0, 0});
    columns_[2] = column(oscillator, frequency, {0, 0}, {1, 0});
    columns_[3] = column(oscillator, frequency, {0, 0}, {0, frequency});
    undamped_ = oscillator.a() == 0;
    if (!undamped_) return;
    for (std::size_t n = 0; n < driven_terms / 2; ++n) {
      columns_[0][n] = columns_[0][n] + columns_[1][n];
      columns_[2][n] = columns_[2][n] + columns_[3][n];
    }
  }

  // How long the series and its first two derivatives hold.
  const Real& reach() const { return reach_; }
  // By how much at most, per unit of time, a force of amplitude 1 increases the size (M3.4) of the n-th
  // derivative; n < 8.
  const Real& growth(std::size_t n) const { return growth_[n]; }
  // Whether the force is so fast that the steady state may give the smaller bound (M3.4).
  bool fast() const { return fast_; }
  // The steady state that a force of amplitude 1 keeps up: in phase with the force and a quarter of a period
  // behind it, and its amplitude.
  struct Steady {
    Real in_phase, behind, amplitude;
  };
  const Steady& steady() const { return steady_; }
  DrivenTerms<Real> terms_of(const Real& x, const Real& v, const Real& in_phase, const Real& across) const {
    DrivenTerms<Real> c;
    if (undamped_) {
      const SimdPair<Real> motion{x, v}, force{in_phase, across};
      for (std::size_t n = 0; n < c.size(); ++n) c[n] = columns_[0][n] * motion + columns_[2][n] * force;
      return c;
    }
    for (std::size_t n = 0; n < c.size(); ++n)
      c[n] =
          (columns_[0][n] * x + columns_[1][n] * v) + (columns_[2][n] * in_phase + columns_[3][n] * across);
    return c;
  }

 private:
  // x and x', f and f' at the beginning.
  static DrivenTerms<Real> column(const Oscillator<Real>& oscillator, const Real& frequency,
                                  const std::array<Real, 2>& start, const std::array<Real, 2>& force) {
    // c_n = x^(n)/n!, and likewise of the force.
    std::array<Real, driven_terms> c{start[0], start[1]};
    Real f_now = force[0], f_next = force[1];
    for (std::size_t n = 2; n < driven_terms; ++n) {
      const Real next = Real(double(n)), both = next * Real(double(n - 1));
      c[n] = (f_now - oscillator.b() * c[n - 2]) / both - 2 * oscillator.a() * c[n - 1] / next;
      const Real f_after = -frequency * frequency * f_now / both;
      f_now = f_next;
      f_next = f_after;
    }
    DrivenTerms<Real> pairs;
    for (std::size_t n = 0; n < pairs.size(); ++n) pairs[n] = SimdPair<Real>{c[2 * n], c[2 * n + 1]};
    return pairs;
  }

  Real reach_;
  bool fast_;
  Steady steady_;
  std::array<Real, 8> growth_;
  // Without damping x and the force's sine have even powers only, v and its cosine odd ones: then the first
  // and the third column have these of the second and the fourth beside them.
  bool undamped_;
  std::array<DrivenTerms<Real>, 4> columns_;
};

template <class Real>
class DrivenSeries {
 public:
  // From x and v, and the force f0 sin(phi) and f0 cos(phi).
  DrivenSeries(const DrivenSeriesTable<Real>& table, const Real& x, const Real& v, const Real& in_phase,
               const Real& across)
      : c_(table.terms_of(x, v, in_phase, across)) {}

  // By how much x and v differ from x0 + v0 t and v0, and x''; the first multiplied by `times`.
  Departure<Real, driven_terms / 2> departure(const Real& times = Real(1)) const { return {c_, times}; }
  // The n-th derivative of x at the beginning, n < 8.
  Real derivative(std::size_t n) const {
    constexpr std::array<double, 8> factorial{1, 1, 2, 6, 24, 120, 720, 5040};
    return c_[n / 2][n % 2] * Real(factorial[n]);
  }
  // The series of sign times the `order`-th derivative of x; order: 0, 1 or 2.
  DrivenTerms<Real> derivative(std::size_t order, const Real& sign) const {
    DrivenTerms<Real> all;
    const std::size_t last = all.size() - 1;
    if (order == 0) {
      for (std::size_t n = 0; n <= last; ++n) all[n] = c_[n] * sign;
      return all;
    }
    for (std::size_t n = 0; n <= last; ++n) {
      const double first = double(2 * n + 1), second = first + 1, third = first + 2;
      const SimdPair<Real> now = c_[n], after = n < last ? c_[n + 1] : SimdPair<Real>{Real(0), Real(0)};
      const SimdPair<Real> next{now[1], after[0]}, once{Real(first), Real(second)},
          twice{Real(first * second), Real(second * third)};
      all[n] = (order == 1 ? next * once : after * twice) * sign;
    }
    return all;
  }

 private:
  DrivenTerms<Real> c_;
};

}  // namespace impact_damper
