// The series of x about the beginning of a motion under a force (M4.4): a Taylor series, shortened (M4.5). It
// holds as long as its error is below rounding. Its sum needs no sine, and nothing cancels near resonance.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "impact_damper/math/power_series.hpp"
#include "impact_damper/motion/oscillator.hpp"

namespace impact_damper {

// The number of pairs of an even and the next odd power in the series, and how many powers of the Taylor
// series contribute to them.
inline constexpr std::size_t driven_pairs = 9, taylor_terms = 28;
// The error of the series in x'' is 2 (driven_radians / 4)^16 / 16! of the motion: epsilon / 1024, or near
// critical damping and in resonance up to 17 times that, which is still below rounding. The Taylor series
// leaves out less.
template <class Real>
inline constexpr double driven_radians = std::numeric_limits<Real>::digits10 < 17   ? 1.775
                                         : std::numeric_limits<Real>::digits10 < 20 ? 1.102
                                                                                    : 0.1319;
template <class Real>
using DrivenTerms = PairedSeries<Real, driven_pairs>;

// A series. A small part of its first three pairs, at most 1e-12 of them, is kept apart: in a table the
// rounding of the sum would be the same in every flight, and add up.
template <class Real>
struct ShortenedSeries {
  DrivenTerms<Real> terms;
  PairedSeries<Real, 3> small;
};

// Makes the series of an oscillator under a force of one frequency.
template <class Real>
class DrivenSeriesMaker {
 public:
  DrivenSeriesMaker(const Oscillator<Real>& oscillator, const Real& frequency)
      : a2_(2 * oscillator.a()),
        b_(oscillator.b()),
        frequency_(frequency),
        reach_(Real(driven_radians<Real>) / (frequency > oscillator.rate() ? frequency : oscillator.rate())) {
    while (unit_ > reach_) unit_ /= 2;
    while (2 * unit_ <= reach_) unit_ *= 2;
  }

  // How long the series and its first two derivatives hold.
  const Real& reach() const { return reach_; }

  // Returns the Taylor coefficients of x, with time in the unit, from x and x', f and f' at the beginning.
  // Number: Real, or a pair of them, of two motions.
  template <class Number>
  std::array<Number, taylor_terms> taylor(const Number& x, const Number& x1, const Number& f,
                                          const Number& f1) const {
    // angle: that of the force's phase in one unit of time.
    const Real square = unit_ * unit_, b = b_ * square, a2 = a2_ * unit_, angle = frequency_ * unit_;
    std::array<Number, taylor_terms> c{x, x1 * unit_};
    Number f_now = f * square, f_next = f1 * (square * unit_);
    for (std::size_t n = 2; n < taylor_terms; ++n) {
      const Real next = Real(double(n)), both = Real(double(n * (n - 1)));
      c[n] = (f_now - c[n - 2] * b) / both - c[n - 1] * a2 / next;
      const Number f_after = f_now * -(angle * angle) / both;
      f_now = f_next;
      f_next = f_after;
    }
    return c;
  }
  // Returns the series with these coefficients, shortened over the reach (M4.5).
  ShortenedSeries<Real> shortened(const std::array<Real, taylor_terms>& c) const {
    constexpr std::size_t kept = 2 * driven_pairs - 2;
    const Real reach = reach_ / unit_;
    std::array<Real, taylor_terms - 2 - kept> higher;
    Real power{1};
    for (std::size_t n = 0; n < kept; ++n) power *= reach;
    for (std::size_t i = 0; i < higher.size(); ++i) {
      const double n = double(kept + i);
      higher[i] = c[kept + i + 2] * (power * Real((n + 1) * (n + 2)));
      power *= reach;
    }
    const PairedSeries<Real, kept / 2> share = share_of<kept>(higher);
    const Real over_reach = 1 / reach, over_unit = 1 / unit_, square = over_reach * over_reach;
    const auto& over = reciprocals<Real>;
    ShortenedSeries<Real> all;
    all.terms[0] = SimdPair<Real>{c[0], c[1] * over_unit};
    all.small[0] = SimdPair<Real>{Real(0), Real(0)};
    SimdPair<Real> powers{Real(1), over_reach},
        units{over_unit * over_unit, over_unit * over_unit * over_unit};
    for (std::size_t k = 1; k < driven_pairs; ++k) {
      const std::size_t n = 2 * k;
      const SimdPair<Real> integrated{over[n] * over[n - 1], over[n + 1] * over[n]}, taylor{c[n], c[n + 1]};
      const SimdPair<Real> change = share[k - 1] * (powers * integrated);
      if (k < all.small.size()) {
        all.terms[k] = taylor * units;
        all.small[k] = change * units;
      } else {
        all.terms[k] = (taylor + change) * units;
      }
      powers = powers * square;
      units = units * (over_unit * over_unit);
    }
    return all;
  }

 private:
  Real a2_, b_, frequency_, reach_;
  Real unit_{1};  // a power of two
};

// The coefficients of the series for one unit of x, of v and of the force's f0 sin(phi) and f0 cos(phi) at
// the beginning, in which the series is linear. Made once for an oscillator and a frequency of the force.
template <class Real>
class DrivenSeriesTable {
 public:
  DrivenSeriesTable(const Oscillator<Real>& oscillator, const Real& frequency) {
    Real power = 1 / oscillator.root_b();
    for (Real& each : growth_) {
      each = power;
      power *= frequency;
    }
    fast_ = frequency * frequency > 4 * oscillator.b();
    const Real re = oscillator.b() - frequency * frequency, im = 2 * oscillator.a() * frequency;
    const Real h2 = re * re + im * im;
    steady_ = {re / h2, im / h2, 1 / square_root(h2)};
    const DrivenSeriesMaker<Real> maker(oscillator, frequency);
    reach_ = maker.reach();
    using Two = SimdPair<Real>;
    const Two none{Real(0), Real(0)}, first{Real(1), Real(0)}, last{Real(0), Real(1)};
    const auto free = maker.taylor(first, last, none, none),
               driven = maker.taylor(none, none, first, Two{Real(0), frequency});
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<Real, taylor_terms> column;
      for (std::size_t n = 0; n < taylor_terms; ++n) column[n] = (i < 2 ? free : driven)[n][i % 2];
      columns_[i] = maker.shortened(column);
    }
  }

  // How long the series and its first two derivatives hold.
  const Real& reach() const { return reach_; }
  // Upper bound of the growth, per unit of time, of the size (M3.4) of the n-th derivative under a force of
  // amplitude 1; n < 8.
  const Real& growth(std::size_t n) const { return growth_[n]; }
  // Whether the force is so fast that the steady state may give the smaller bound (M3.4).
  bool fast() const { return fast_; }
  // The steady state under a force of amplitude 1: its parts in phase with the force and a quarter of a
  // period behind it, and its amplitude.
  struct Steady {
    Real in_phase, behind, amplitude;
  };
  const Steady& steady() const { return steady_; }
  DrivenTerms<Real> terms_of(const Real& x, const Real& v, const Real& in_phase, const Real& across) const {
    const auto sum = [&](const auto part, std::size_t n) {
      const auto column = [&](std::size_t i) { return (columns_[i].*part)[n]; };
      return (column(0) * x + column(1) * v) + (column(2) * in_phase + column(3) * across);
    };
    DrivenTerms<Real> c;
    for (std::size_t n = 0; n < c.size(); ++n) c[n] = sum(&ShortenedSeries<Real>::terms, n);
    for (std::size_t n = 1; n < columns_[0].small.size(); ++n)
      c[n] = c[n] + sum(&ShortenedSeries<Real>::small, n);
    return c;
  }

 private:
  Real reach_;
  bool fast_;
  Steady steady_;
  std::array<Real, 8> growth_;
  std::array<ShortenedSeries<Real>, 4> columns_;
};

template <class Real>
class DrivenSeries {
 public:
  // in_phase: f0 sin(phi); across: f0 cos(phi); both at the beginning, like x and v.
  DrivenSeries(const DrivenSeriesTable<Real>& table, const Real& x, const Real& v, const Real& in_phase,
               const Real& across)
      : c_(table.terms_of(x, v, in_phase, across)) {}

  // The differences of x and v from x0 + v0 t and v0, and x'', all multiplied by `times`.
  Departure<Real, driven_pairs> departure(const Real& times = Real(1)) const { return {c_, times}; }
  // The n-th derivative of x at the beginning, n < 8, with an error of at most 1e-9 of the motion's (M4.5).
  Real derivative(std::size_t n) const {
    constexpr std::array<double, 8> factorial{1, 1, 2, 6, 24, 120, 720, 5040};
    return c_[n / 2][n % 2] * Real(factorial[n]);
  }
  // Returns the series of sign times the `order`-th derivative of x; order: 0, 1 or 2.
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
