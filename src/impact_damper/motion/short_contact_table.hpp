// What the short-contact map (M7.8) tabulates: for one unit of each number that a contact depends on, the
// Taylor coefficients of q and of the centre a time T after the touch.
//
// A rounding error of the table is the same in every impact of a run. So the table is made from the equations
// themselves (M7.9) by Taylor series, in Extended<Real>, and rounded once. T, E = exp(-a T) and the share
// theta of q in the centre are given, rounded; the table is right for these rounded numbers.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "impact_damper/math/double_double.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

// The equations (M7.9) of the centre x + theta q and of q, time in units of h.
template <class Number>
struct CentreAndOverlap {
  Number share, rest_of_share;  // theta, 1 - theta
  Number both, remainder;       // 1 + nu, nu - theta (1 + nu)
  Number stiffness, damping;    // K h^2, c h
  Number spring, friction;      // h^2, 2 zeta h
  Number frequency;             // omega_f h

  // Coefficients of one power of time: of the centre, its velocity, q and q', and of the force, f' = omega_f
  // g.
  struct Term {
    Number x{0}, v{0}, q{0}, w{0}, f{0}, g{0};

    friend Term operator+(const Term& a, const Term& b) {
      return {a.x + b.x, a.v + b.v, a.q + b.q, a.w + b.w, a.f + b.f, a.g + b.g};
    }
  };

  template <class Rounded>
  CentreAndOverlap<Rounded> rounded() const {
    return {Rounded(share),     Rounded(rest_of_share), Rounded(both),
            Rounded(remainder), Rounded(stiffness),     Rounded(damping),
            Rounded(spring),    Rounded(friction),      Rounded(frequency)};
  }
  CentreAndOverlap in_units_of(const Number& h) const {
    const Number square = h * h;
    return {share,       rest_of_share,   both,         remainder,    stiffness * square,
            damping * h, spring * square, friction * h, frequency * h};
  }
  // The term of the next power, which is 1/part.
  template <bool forced>
  Term next(const Term& t, const Number& part) const {
    const Number wall = damping * t.w + stiffness * t.q;
    Number push = friction * (share * t.w - t.v) + spring * (share * t.q - t.x);
    if constexpr (forced) push = push + spring * t.f;
    Term to{part * t.v, part * (remainder * wall + rest_of_share * push), part * t.w,
            part * (-push - both * wall)};
    if constexpr (forced) {
      to.f = part * (frequency * t.g);
      to.g = part * -(frequency * t.f);
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
    const Number one(1), stiffness = Number(k) / Number(nu), both = one + Number(nu), theta(share);
    motion_ = {theta,
               one - theta,
               both,
               Number(nu) - theta * both,
               stiffness,
               Number(Real(2 * zeta_m)) * square_root(stiffness),
               one,
               Number(Real(2 * zeta)),
               Number(frequency)};
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
    if constexpr (forced)
      if (i >= 3) return column<terms, true>(i, half_period, decay_factor);
    return column<terms, false>(i, half_period, decay_factor);
  }

 private:
  using Number = typename Extended<Real>::Type;
  using Motion = CentreAndOverlap<Number>;
  using Rounded = CentreAndOverlap<Real>;
  using Term = typename Motion::Term;
  static constexpr double longest_step = 4, most_steps = 16;  // the first in units of 1/rate

  template <std::size_t terms, bool by_force>
  ShortContactColumn<Real, terms> column(std::size_t i, const Real& half_period,
                                         const Real& decay_factor) const {
    double steps = 1;
    while (half_period * rate_ > Real(steps * longest_step)) ++steps;
    const Number h = Number(half_period) / Number(steps), zero(0), one(1);
    const Real rate = rate_ * half_period / Real(steps);
    const Motion motion = motion_.in_units_of(h);
    const Rounded rounded = motion.template rounded<Real>();
    // One unit of w gives the centre the velocity theta.
    const Term begin{i == 0 ? one : zero,
                     i == 1   ? h
                     : i == 2 ? h * motion_.share
                              : zero,
                     zero,
                     i == 2 ? h : zero,
                     i == 3 ? one : zero,
                     i == 4 ? one : zero};
    Term change{zero, zero, zero, zero, zero, zero};
    for (int step = 0; step < steps; ++step) {
      Term term = begin + change;
      std::size_t n = 1;
      Real size{1};
      change = change + sum<by_force>(motion, term, n, size, rate, small);
      auto rest = round(term);
      change = change + widen(sum<by_force>(rounded, rest, n, size, rate, negligible));
    }
    const Term at{begin.x + change.x,       (begin.v + change.v) / h, change.q,
                  (begin.w + change.w) / h, begin.f + change.f,       begin.g + change.g};
    ShortContactColumn<Real, terms> all;
    all.q[0] = Real(at.q);
    all.q[1] = Real(i == 2 ? at.w + Number(decay_factor) : at.w);
    all.centre[0] = Real(change.x);
    all.centre[1] = Real(change.v / h);
    constexpr std::size_t extended_terms = 6;
    static_assert(extended_terms < terms);
    Term term = at;
    for (std::size_t n = 1; n < extended_terms; ++n) {
      term = motion_.template next<by_force>(term, parts<Number>()[n]);
      if (n == 1) continue;
      all.q[n] = Real(term.q);
      all.centre[n] = Real(term.x);
    }
    const Rounded late = motion_.template rounded<Real>();
    auto late_term = round(term);
    for (std::size_t n = extended_terms; n < terms; ++n) {
      late_term = late.template next<by_force>(late_term, parts<Real>()[n]);
      all.q[n] = late_term.q;
      all.centre[n] = late_term.x;
    }
    return all;
  }
  // The sum of the terms of the power n and higher, while (rate h)^n / n!, their size, is above `until`.
  template <bool by_force, class N>
  static typename CentreAndOverlap<N>::Term sum(const CentreAndOverlap<N>& motion,
                                                typename CentreAndOverlap<N>::Term& term, std::size_t& n,
                                                Real& size, const Real& rate, const Real& until) {
    typename CentreAndOverlap<N>::Term all{};
    for (; size > until && n < parts<N>().size(); ++n) {
      term = motion.template next<by_force>(term, parts<N>()[n]);
      all = all + term;
      size *= rate / Real(double(n));
    }
    return all;
  }
  static typename Rounded::Term round(const Term& t) {
    return {Real(t.x), Real(t.v), Real(t.q), Real(t.w), Real(t.f), Real(t.g)};
  }
  static Term widen(const typename Rounded::Term& t) {
    return {Number(t.x), Number(t.v), Number(t.q), Number(t.w), Number(t.f), Number(t.g)};
  }
  template <class N>
  static const std::array<N, 64>& parts() {
    static const std::array<N, 64> all = [] {
      std::array<N, 64> over{};
      for (std::size_t n = 1; n < over.size(); ++n) over[n] = N(1) / N(double(n));
      return over;
    }();
    return all;
  }

  Real rate_;
  // Terms below the first are summed in Real, those below the second left out.
  Real small = Real(1) / Real(1 << 10), negligible = std::numeric_limits<Real>::epsilon() / Real(1 << 10);
  Motion motion_;
};

}  // namespace impact_damper
