// What the short-contact map (M7.8) tabulates: for one unit of each number that a contact depends on, the
// Taylor coefficients of q and of the centre a time T after the touch.
//
// A rounding error of the table is the same in every impact of a run. So the table is made from the equations
// themselves (M7.9) by Taylor series. Of the column of w, which is nearly all of an impact, the large terms
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

namespace impact_damper {

// The equations (M7.9) of the centre x + theta q and of q, time in units of h. Overlap: of q and q'.
template <class Real, class Overlap>
struct CentreAndOverlap {
  Overlap stiffness, damping;  // (1 + nu) K h^2, (1 + nu) c h
  Real share, rest_of_share;   // theta, 1 - theta
  Real remainder;              // nu/(1 + nu) - theta
  Real spring, friction;       // h^2, 2 zeta h
  Real frequency;              // omega_f h

  // Coefficients of one power of time: of the centre, its velocity, q and q', and of the force, f' = omega_f
  // g.
  struct Term {
    Real x{0}, v{0};
    Overlap q{0}, w{0};
    Real f{0}, g{0};

    friend Term operator+(const Term& a, const Term& b) {
      return {a.x + b.x, a.v + b.v, a.q + b.q, a.w + b.w, a.f + b.f, a.g + b.g};
    }
  };

  CentreAndOverlap<Real, Real> rounded() const {
    return {Real(stiffness), Real(damping), share, rest_of_share, remainder, spring, friction, frequency};
  }
  CentreAndOverlap in_units_of(const Overlap& h) const {
    const Real by(h), square = by * by;
    return {stiffness * (h * h), damping * h,     share,         rest_of_share,
            remainder,           spring * square, friction * by, frequency * by};
  }
  // The term of the next power, which is 1/part.
  template <bool forced>
  Term next(const Term& t, const Overlap& part) const {
    const Overlap wall = damping * t.w + stiffness * t.q;
    Real push = friction * (share * Real(t.w) - t.v) + spring * (share * Real(t.q) - t.x);
    if constexpr (forced) push = push + spring * t.f;
    const Real by(part);
    Term to{by * t.v, by * (remainder * Real(wall) + rest_of_share * push), part * t.w,
            part * -(wall + Overlap(push))};
    if constexpr (forced) {
      to.f = by * (frequency * t.g);
      to.g = by * -(frequency * t.f);
    }
    return to;
  }
};

// The series of one column in the time since T; of the centre: what it has changed by since the touch.
template <class Real, std::size_t terms>
struct ShortContactColumn {
  std::array<Real, terms> q, centre;
};

template <class Real, bool forced>
class ShortContactTable {
 public:
  // `share`: nu/(1+nu). `rate`: no mode and no force is faster.
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

  // Whether T takes few steps.
  bool reaches(const Real& half_period) const {
    return half_period * rate_ <= Real(most_steps * longest_step);
  }

  // The column of x, v or w, or of a force that is cos(omega_f t) or sin(omega_f t), from rest. In the column
  // of w, `decay_factor` is added to q'.
  template <std::size_t terms>
  ShortContactColumn<Real, terms> column(std::size_t i, const Real& half_period,
                                         const Real& decay_factor) const {
    if (i == 2) return column<Number, terms, false>(motion_, i, half_period, decay_factor);
    if constexpr (forced)
      if (i >= 3) return column<Real, terms, true>(motion_.rounded(), i, half_period, decay_factor);
    return column<Real, terms, false>(motion_.rounded(), i, half_period, decay_factor);
  }

 private:
  using Number = typename Extended<Real>::Type;
  static constexpr double longest_step = 4, most_steps = 16;  // the first in units of 1/rate

  template <class Overlap, std::size_t terms, bool by_force>
  ShortContactColumn<Real, terms> column(const CentreAndOverlap<Real, Overlap>& motion, std::size_t i,
                                         const Real& half_period, const Real& decay_factor) const {
    using Term = typename CentreAndOverlap<Real, Overlap>::Term;
    double steps = 1;
    while (half_period * rate_ > Real(steps * longest_step)) ++steps;
    const Overlap h = Overlap(half_period) / Overlap(steps), zero(0);
    const Real rate = rate_ * half_period / Real(steps), by(h);
    const CentreAndOverlap<Real, Overlap> in_steps = motion.in_units_of(h);
    const CentreAndOverlap<Real, Real> rounded = in_steps.rounded();
    // One unit of w gives the centre the velocity theta.
    const Term begin{Real(i == 0 ? 1 : 0),
                     i == 1   ? by
                     : i == 2 ? Real(by * motion.share)
                              : Real(0),
                     zero,
                     i == 2 ? h : zero,
                     Real(i == 3 ? 1 : 0),
                     Real(i == 4 ? 1 : 0)};
    Term change{};
    for (int step = 0; step < steps; ++step) {
      Term term = begin + change;
      std::size_t n = 1;
      Real size{1};
      if constexpr (!std::is_same_v<Overlap, Real>)
        change = change + sum<by_force>(in_steps, term, n, size, rate, small_);
      auto rest = round(term);
      change = change + widen<Term>(sum<by_force>(rounded, rest, n, size, rate, negligible_));
    }
    const Term at{begin.x + change.x,       (begin.v + change.v) / by, change.q,
                  (begin.w + change.w) / h, begin.f + change.f,        begin.g + change.g};
    ShortContactColumn<Real, terms> all;
    all.q[0] = Real(at.q);
    all.q[1] = Real(i == 2 ? at.w + Overlap(decay_factor) : at.w);
    all.centre[0] = change.x;
    all.centre[1] = change.v / by;
    constexpr std::size_t extended_terms = std::is_same_v<Overlap, Real> ? 2 : 6;
    static_assert(extended_terms < terms);
    Term term = at;
    for (std::size_t n = 1; n < extended_terms; ++n) {
      term = motion.template next<by_force>(term, reciprocal<Overlap>(n));
      if (n == 1) continue;
      all.q[n] = Real(term.q);
      all.centre[n] = term.x;
    }
    const CentreAndOverlap<Real, Real> late = motion.rounded();
    auto late_term = round(term);
    for (std::size_t n = extended_terms; n < terms; ++n) {
      late_term = late.template next<by_force>(late_term, reciprocal<Real>(n));
      all.q[n] = late_term.q;
      all.centre[n] = late_term.x;
    }
    return all;
  }
  // The sum of the terms of the power n and higher, while (rate h)^n / n!, their size, is above `until`.
  template <bool by_force, class Overlap>
  static auto sum(const CentreAndOverlap<Real, Overlap>& motion,
                  typename CentreAndOverlap<Real, Overlap>::Term& term, std::size_t& n, Real& size,
                  const Real& rate, const Real& until) {
    typename CentreAndOverlap<Real, Overlap>::Term all{};
    for (; size > until && n < most_terms; ++n) {
      term = motion.template next<by_force>(term, reciprocal<Overlap>(n));
      all = all + term;
      size *= rate * reciprocal<Real>(n);
    }
    return all;
  }
  template <class Term>
  static typename CentreAndOverlap<Real, Real>::Term round(const Term& t) {
    return {t.x, t.v, Real(t.q), Real(t.w), t.f, t.g};
  }
  template <class Term>
  static Term widen(const typename CentreAndOverlap<Real, Real>::Term& t) {
    return {t.x, t.v, decltype(Term::q)(t.q), decltype(Term::w)(t.w), t.f, t.g};
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
