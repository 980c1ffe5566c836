// The tables of the short-contact map (M7.8): for one unit of each number that a contact depends on, the
// Taylor coefficients of q and of the centre a time T after the touch.
//
// A rounding error of the table is the same in every impact of a run. So the table is made from the equations
// themselves (M7.9) by Taylor series. In the column of w, which is nearly all of an impact, the large terms
// of q and q' are Extended<Real> and rounded once. Its other terms are smaller by 2^-10, all else by a factor
// of T or more, and so are their roundings. T, E = exp(-a T) and the share theta of q in the centre are
// given, rounded; the table is right for these rounded numbers.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "impact_damper/math/double_double.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/math/power_series.hpp"

namespace impact_damper {

// Coefficients of one power of time, in one column or in two: of the centre, its velocity, q and q', and of
// the force f and g, f' = omega_f g.
template <class Value, class Overlap>
struct CentreAndOverlapTerm {
  Value x{}, v{};
  Overlap q{}, w{};
  Value f{}, g{};

  friend CentreAndOverlapTerm operator+(const CentreAndOverlapTerm& a, const CentreAndOverlapTerm& b) {
    return {a.x + b.x, a.v + b.v, a.q + b.q, a.w + b.w, a.f + b.f, a.g + b.g};
  }
  CentreAndOverlapTerm<Value, Value> rounded() const { return {x, v, Value(q), Value(w), f, g}; }
};

// The equations (M7.9) of the centre x + theta q and of q, with time in units of h. Overlap: the type of q
// and q'.
template <class Real, class Overlap>
struct CentreAndOverlap {
  Overlap stiffness, damping;  // (1 + nu) K h^2, (1 + nu) c h
  Real share, rest_of_share;   // theta, 1 - theta
  Real remainder;              // nu/(1 + nu) - theta
  Real spring, friction;       // h^2, 2 zeta h
  Real frequency;              // omega_f h

  CentreAndOverlap<Real, Real> rounded() const {
    return {Real(stiffness), Real(damping), share, rest_of_share, remainder, spring, friction, frequency};
  }
  CentreAndOverlap in_units_of(const Overlap& h) const {
    const Real by(h), square = by * by;
    return {stiffness * (h * h), damping * h,     share,         rest_of_share,
            remainder,           spring * square, friction * by, frequency * by};
  }
  // Returns the term of the next power n; part: 1/n.
  template <bool forced, class Value, class Q>
  CentreAndOverlapTerm<Value, Q> next(const CentreAndOverlapTerm<Value, Q>& t, const Overlap& part) const {
    const Q wall = t.w * damping + t.q * stiffness;
    Value push = (Value(t.w) * share - t.v) * friction + (Value(t.q) * share - t.x) * spring;
    if constexpr (forced) push = push + t.f * spring;
    const Real by(part);
    CentreAndOverlapTerm<Value, Q> to{t.v * by, (Value(wall) * remainder + push * rest_of_share) * by,
                                      t.w * part, (wall + Q(push)) * -part};
    if constexpr (forced) {
      to.f = t.g * frequency * by;
      to.g = t.f * frequency * -by;
    }
    return to;
  }
};

// The series of one column, or of two, in the time since T. centre: the change of the centre since the touch.
template <class Value, std::size_t terms>
struct ShortContactColumn {
  std::array<Value, terms> q, centre;
};

template <class Real>
class ShortContactTable {
 public:
  // share: nu/(1+nu). rate: at least that of each mode and of the force.
  ShortContactTable(const Real& nu, const Real& zeta, const Real& k, const Real& zeta_m,
                    const Real& frequency, const Real& share, const Real& rate)
      : rate_(rate) {
    const Number one(1), stiffness = Number(k) / Number(nu), both = one + Number(nu);
    motion_ = {both * stiffness,
               both * (Number(Real(2 * zeta_m)) * square_root(stiffness)),
               share,
               Real(one - Number(share)),
               Real(Number(nu) / both - Number(share)),
               Real(1),
               2 * zeta,
               frequency};
  }

  // Whether T takes at most `most_steps` steps.
  bool reaches(const Real& half_period) const {
    return half_period * rate_ <= Real(most_steps * longest_step);
  }

  // Returns the column of w. decay_factor: E, which is added to its q'.
  template <std::size_t terms>
  ShortContactColumn<Real, terms> column_of_w(const Real& half_period, const Real& decay_factor) const {
    // One unit of w gives the centre the velocity theta.
    return series<terms, false>(motion_, half_period, Number(decay_factor), [&](const Number& h) {
      return CentreAndOverlapTerm<Real, Number>{Real(0), Real(Real(h) * motion_.share), Number(0), h};
    });
  }
  // Returns the columns of x and v.
  template <std::size_t terms>
  ShortContactColumn<SimdPair<Real>, terms> columns_of_x_and_v(const Real& half_period) const {
    return series<terms, false>(motion_.rounded(), half_period, Both{}, [](const Real& h) {
      return CentreAndOverlapTerm<Both, Both>{Both{Real(1), Real(0)}, Both{Real(0), h}};
    });
  }
  // Returns the columns of the forces cos(omega_f t) and sin(omega_f t), from rest.
  template <std::size_t terms>
  ShortContactColumn<SimdPair<Real>, terms> columns_of_force(const Real& half_period) const {
    return series<terms, true>(motion_.rounded(), half_period, Both{}, [](const Real&) {
      return CentreAndOverlapTerm<Both, Both>{{}, {}, {}, {}, Both{Real(1), Real(0)}, Both{Real(0), Real(1)}};
    });
  }

 private:
  using Number = typename Extended<Real>::Type;
  using Both = SimdPair<Real>;
  static constexpr double longest_step = 4, most_steps = 16;  // the first in units of 1/rate

  // Returns the series about T. begin(h): the term of the power 0 at the touch, time in units of h. kept:
  // added to q' at T.
  template <std::size_t terms, bool by_force, class Overlap, class Q, class Begin>
  auto series(const CentreAndOverlap<Real, Overlap>& motion, const Real& half_period, const Q& kept,
              Begin begin) const {
    double steps = 1;
    while (half_period * rate_ > Real(steps * longest_step)) ++steps;
    const Overlap h = Overlap(half_period) / Overlap(steps);
    const Real rate = rate_ * half_period / Real(steps), by(h);
    const CentreAndOverlap<Real, Overlap> in_steps = motion.in_units_of(h);
    const CentreAndOverlap<Real, Real> rounded = in_steps.rounded();
    const auto touch = begin(h);
    using Term = std::remove_const_t<decltype(touch)>;
    using Value = decltype(Term::x);
    Term change{};
    for (int step = 0; step < steps; ++step) {
      Term term = touch + change;
      std::size_t n = 1;
      Real size{1};
      if constexpr (!std::is_same_v<Overlap, Real>)
        change = change + sum<by_force>(in_steps, term, n, size, rate, small_);
      auto rest = term.rounded();
      change = change + widen<Q>(sum<by_force>(rounded, rest, n, size, rate, negligible_));
    }
    Term term{touch.x + change.x,       (touch.v + change.v) / by, change.q,
              (touch.w + change.w) / h, touch.f + change.f,        touch.g + change.g};
    ShortContactColumn<Value, terms> all;
    all.q[0] = Value(term.q);
    all.q[1] = Value(term.w + kept);
    all.centre[0] = change.x;
    all.centre[1] = change.v / by;
    constexpr std::size_t extended_terms = std::is_same_v<Overlap, Real> ? 2 : 6;
    static_assert(extended_terms < terms);
    for (std::size_t n = 1; n < extended_terms; ++n) {
      term = motion.template next<by_force>(term, reciprocal<Overlap>(n));
      if (n == 1) continue;
      all.q[n] = Value(term.q);
      all.centre[n] = term.x;
    }
    const CentreAndOverlap<Real, Real> late = motion.rounded();
    auto late_term = term.rounded();
    for (std::size_t n = extended_terms; n < terms; ++n) {
      late_term = late.template next<by_force>(late_term, reciprocal<Real>(n));
      all.q[n] = late_term.q;
      all.centre[n] = late_term.x;
    }
    return all;
  }
  // Returns the sum of the terms of the power n and higher, while (rate h)^n / n!, their size, is above
  // `until`.
  template <bool by_force, class Overlap, class Term>
  static Term sum(const CentreAndOverlap<Real, Overlap>& motion, Term& term, std::size_t& n, Real& size,
                  const Real& rate, const Real& until) {
    Term all{};
    for (; size > until && n < most_terms; ++n) {
      term = motion.template next<by_force>(term, reciprocal<Overlap>(n));
      all = all + term;
      size *= rate * reciprocal<Real>(n);
    }
    return all;
  }
  template <class Q, class Value>
  static CentreAndOverlapTerm<Value, Q> widen(const CentreAndOverlapTerm<Value, Value>& t) {
    return {t.x, t.v, Q(t.q), Q(t.w), t.f, t.g};
  }
  static constexpr std::size_t most_terms = 64;
  // 1/n, n > 0. The table is made before a run begins: it is no part of what a run costs.
  template <class N>
  static const N& reciprocal(std::size_t n) {
    const std::array<N, most_terms>& all = reciprocals<N>;
    return all[n];
  }
  template <class N>
  static std::array<N, most_terms> made_reciprocals() {
    std::array<N, most_terms> all{};
    for (std::size_t n = 1; n < all.size(); ++n) all[n] = N(1) / N(double(n));
    return all;
  }
  template <class N>
  static inline const std::array<N, most_terms> reciprocals = made_reciprocals<N>();

  Real rate_;
  // Terms below the first are summed in Real, those below the second left out.
  Real small_ = Real(1) / Real(1 << 10), negligible_ = std::numeric_limits<Real>::epsilon() / Real(1 << 10);
  CentreAndOverlap<Real, Number> motion_;
};

}  // namespace impact_damper
