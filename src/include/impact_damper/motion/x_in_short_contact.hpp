// x in a contact of the short-contact map under a force, by its Taylor series about a time in the contact
// (M7.10). Zeros of x and x' are found on this series, which needs neither the modes nor a sine.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "impact_damper/math/power_series.hpp"
#include "impact_damper/motion/short_contact_map.hpp"

namespace impact_damper {

// The columns of the series, made once for a scene: one for each number that the map depends on, x, v and w
// at the touch and the force's amplitude times the sine and times the cosine of its phase then.
template <class Real>
class XInShortContactTable {
 public:
  using Map = ShortContactMap<Real, 5>;
  static constexpr std::size_t pairs = 13;
  using Series = PairedSeries<Real, pairs>;

  XInShortContactTable() = default;
  // nu, zeta, stiffness K and damping c of the contact.
  XInShortContactTable(const Map& map, const Oscillator<Real>& fast, const Real& nu, const Real& zeta,
                       const Real& stiffness, const Real& damping, const Real& frequency)
      : about_(reach_in_radians<Real, pairs>.s / fast.rate()), rate_(fast.rate()) {
    if (!map.holds_at(about_)) return;
    end_ = 2 * about_;
    const SinCos<Real> phase = sin_cos(Real(frequency * about_));
    const Rates rates{nu, 1 + nu, 2 * zeta, stiffness, damping, frequency};
    const auto at = [&](std::size_t i) { return map.unit_at(i, about_); };
    tabulate(0, 1, Term(at(0), at(1)), rates);
    tabulate(2, 2, Term(at(2), at(2)), rates);
    Term by_force(at(3), at(4));
    by_force.f = Pair{phase.cos, phase.sin};
    by_force.g = Pair{-phase.sin, phase.cos};
    tabulate(3, 4, by_force, rates);
  }

  // The time after the touch until which the series holds; 0: it is not used.
  const Real& end() const { return end_; }
  const Real& about() const { return about_; }
  const Real& rate() const { return rate_; }
  Series series_of(const typename Map::Start& start) const {
    Series x;
    for (std::size_t n = 0; n < pairs; ++n)
      x[n] = ((columns_[0][n] * start[0] + columns_[1][n] * start[1]) +
              (columns_[3][n] * start[3] + columns_[4][n] * start[4])) +
             columns_[2][n] * start[2];
    return x;
  }

 private:
  using Pair = SimdPair<Real>;
  struct Rates {
    Real nu, both, friction, stiffness, damping, frequency;
  };
  // Coefficients of one power of time, in two columns: of x, x', q, q' and the force f and g, f' = omega_f g.
  struct Term {
    Pair x, v, q, w, f{Real(0), Real(0)}, g{Real(0), Real(0)};
    Term(const ContactState<Real>& a, const ContactState<Real>& b)
        : x{a.x, b.x}, v{a.v, b.v}, q{a.q, b.q}, w{a.w, b.w} {}

    void advance(const Rates& by, const Real& part) {
      const Pair wall = w * by.damping + q * by.stiffness, push = f - (v * by.friction + x);
      const Pair after = g * by.frequency;
      x = v * part;
      q = w * part;
      v = (wall * by.nu + push) * part;
      w = (wall * by.both + push) * -part;
      g = f * (-by.frequency * part);
      f = after * part;
    }
  };
  void tabulate(std::size_t first, std::size_t second, Term term, const Rates& rates) {
    for (std::size_t n = 0; n < pairs; ++n) {
      const Pair even = term.x;
      term.advance(rates, reciprocals<Real>[2 * n + 1]);
      columns_[first][n] = Pair{even[0], term.x[0]};
      columns_[second][n] = Pair{even[1], term.x[1]};
      term.advance(rates, reciprocals<Real>[2 * n + 2]);
    }
  }

  Real about_{0}, rate_{0}, end_{0};
  std::array<Series, 5> columns_{};
};

// The series of one contact.
template <class Real>
class XInShortContact {
 public:
  using Table = XInShortContactTable<Real>;
  XInShortContact(const Table& table, const typename Table::Map::Start& start, const Real& end)
      : about_(table.about()), end_(end), x_(table.series_of(start)) {}

  // The end of the contact.
  const Real& end() const { return end_; }
  // x and its first two derivatives at t.
  SeriesAt<Real> x_at(const Real& t) const { return sum<Real>(x_, Real(t - about_)); }
  // x' and its first two derivatives at t.
  SeriesAt<Real> v_at(const Real& t) const {
    if (!v_) {
      v_.emplace();
      for (std::size_t n = 0; n < Table::pairs; ++n) {
        const Real after = n + 1 < Table::pairs ? x_[n + 1][0] : Real(0);
        (*v_)[n] = SimdPair<Real>{x_[n][1], after} * SimdPair<Real>{Real(2 * n + 1), Real(2 * n + 2)};
      }
    }
    return sum<Real>(*v_, Real(t - about_));
  }
  const SeriesAt<Real>& x_at_end() const {
    if (!x_at_end_) x_at_end_ = x_at(end_);
    return *x_at_end_;
  }

  // The zero of x' found last, and x'' there.
  struct Turn {
    Real time{-1}, x2{0};
  };
  Turn turn{};

 private:
  Real about_, end_;
  typename Table::Series x_;
  mutable std::optional<typename Table::Series> v_{};
  mutable std::optional<SeriesAt<Real>> x_at_end_{};
};

}  // namespace impact_damper
