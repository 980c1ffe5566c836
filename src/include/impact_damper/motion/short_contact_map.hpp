// The short-contact map (M7.8): a contact that begins on the wall and lasts about T, half a period of the
// fast mode. Most contacts do. The whole contact is then a linear map of x, v and w at the touch and, under a
// force, of the force's amplitude times the sine and times the cosine of its phase at the touch. The map is
// tabulated once for a scene, in short_contact_table.hpp.
//
// The series in s, the time since T, has as many terms as are needed for the first omitted one to be below
// rounding. A rounding error of the table is the same in every impact, and adds up. So the table keeps small
// quantities: in place of x the change of the centre of both masses, and in place of w its difference from -E
// times the w at the touch, E = exp(-a T).
//
// Lemma L2 for exp(a t) q, with the decay rate a of the fast mode, proves that q has not been zero before the
// end (docs/mathematics.md, 7.6).
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/math/power_series.hpp"
#include "impact_damper/motion/oscillator.hpp"
#include "impact_damper/motion/short_contact_table.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

template <class Real>
struct ContactState {
  Real x, v, q, w;
};

template <class Real>
struct ContactParts {
  ContactState<Real> slow, fast;
};

// The position and velocity of the masses' centre X = x + nu/(1+nu) q, which the wall's force does not move.
template <class Real>
struct Centre {
  Real x, v;
};

// The slow and the fast mode of one unit of x, of v or of w at the touch.
template <class Real>
struct Touch {
  ContactState<Real> slow, fast;
};

// Bounds until `latest` on what a force of amplitude 1 adds, from rest, to x'' and the next derivatives, and
// to (a + d/dt)^4 q, which is exp(-a t) times the fourth derivative of exp(a t) q.
template <class Real>
struct DrivenBounds {
  Real fourth_of_q, second_of_x, third_of_x, fourth_of_x, fifth_of_x;
};

// The largest |s| at which a series of so many pairs of terms is used, and the longest last step to a zero of
// q. Both are multiplied by the rate, and so the same for all scenes.
template <class Real>
struct ReachInRadians {
  Real s, last_step;
};
template <class Real, std::size_t pairs>
inline const ReachInRadians<Real> reach_in_radians = [] {
  // The first omitted term of the velocity is (rate s)^(taken - 1) / (taken - 1)! of it.
  const std::size_t taken = 2 * pairs;
  Real factorial{1};
  for (std::size_t n = 2; n < taken; ++n) factorial *= Real(double(n));
  const Real epsilon = std::numeric_limits<Real>::epsilon(), enough = factorial * epsilon / 16;
  const Real s = exponential(Real(logarithm(enough) / Real(double(taken - 1))));
  // The last step takes q and q' along to second order. In q the third power of the step is then below
  // rounding. In q', with q''' summed to second order in s, (rate step)^2 (rate s)^3 / 12 of it is left out.
  const Real of_q = exponential(Real(logarithm(epsilon) * 2 / 5)),
             of_velocity = square_root(Real(3 * epsilon / (s * s * s)));
  return ReachInRadians<Real>{s, of_q < of_velocity ? of_q : of_velocity};
}();

// The map of a contact that begins with `columns` numbers. 3: x, v and w at the touch. 5: also the force's
// amplitude times the sine and times the cosine of its phase at the touch.
template <class Real, std::size_t columns>
class ShortContactMap {
 public:
  using Start = std::array<Real, columns>;
  static constexpr std::size_t terms = 24;

  ShortContactMap() = default;
  // share: nu/(1+nu). zeta: of the primary mass. start: the modes of one unit of x, of v and of w at the
  // touch. driven(column, latest) returns the bounds for the columns 3 and 4, those of the force.
  template <class Driven>
  ShortContactMap(const Oscillator<Real>& slow, const Oscillator<Real>& fast, const Real& share,
                  const Real& zeta, const ShortContactTable<Real>& table,
                  const std::array<Touch<Real>, 3>& start, Driven&& driven)
      : share_(share), zeta_(zeta) {
    half_period_ = fast.half_period();
    if (!table.reaches(half_period_)) return;
    decay_factor_ = exponential(Real(-fast.a() * half_period_));
    reach_5_ = reach_of<5>(fast);
    reach_7_ = reach_of<7>(fast);
    reach_9_ = reach_of<9>(fast);
    reach_ = reach_of<all_pairs>(fast);
    decay_ = fast.a();
    growth_ = exponential(Real(fast.a() * half_period_));
    latest_ = half_period_ + reach_.s;
    tabulate(0, table.template columns_of_x_and_v<terms>(half_period_));
    const auto [q, centre] = table.template column_of_w<terms>(half_period_, decay_factor_);
    for (std::size_t n = 0; n < all_pairs; ++n) {
      q_[2][n] = Both{q[2 * n], q[2 * n + 1]};
      centre_[2][n] = Both{centre[2 * n], centre[2 * n + 1]};
    }
    if constexpr (columns == 5) tabulate(3, table.template columns_of_force<terms>(half_period_));
    for (std::size_t i = 0; i < 3; ++i) tabulate_bounds(i, slow, fast, start[i]);
    if constexpr (columns == 5) {
      for (std::size_t i = 3; i < 5; ++i) {
        const DrivenBounds<Real> by_force = driven(i, latest_);
        fourth_of_q_[i] = Both{Real(0), growth_ * by_force.fourth_of_q};
        second_and_third_of_x_[i] = Both{by_force.second_of_x, by_force.third_of_x};
        fourth_and_fifth_of_x_[i] = Both{by_force.fourth_of_x, by_force.fifth_of_x};
      }
    }
  }

  explicit operator bool() const { return latest_ > 0; }

  // An upper bound of the end of a contact that the map gives. Under a force the bounds on the derivatives of
  // x hold until then; without a force they hold for ever.
  const Real& latest() const { return latest_; }

  // The end of a contact: the time since the touch, and x, x' and q' then. There is none where |s| is beyond
  // the reach of the series, or where Lemma L2 does not prove the end to be the first zero of q.
  struct End {
    Real time, x, v, w;
  };
  // The end with the change of x since the touch (M17.15). dx has an error of a rounding of x' times the
  // time.
  struct EndAndChange {
    Real time, x, v, w;
    ChangeOfX<Real> change;
  };
  template <class Result = End>
  [[gnu::always_inline]] std::optional<Result> end(const Start& start) const {
    const auto q = overlap_after<5>(start);
    const Real over = 1 / q[0][1], t = -q[0][0] * over, a = t * (q[1][0] * over),
               b = t * t * (q[1][1] * over);
    Real s = t * (1 - a + (2 * a * a - b));
    if (absolute(s) < reach_5_.s)
      if (const auto end = end_within<Result>(start, q, s, reach_5_)) return end;
    if (!(absolute(s) < reach_.s)) return {};
    // With the fewest terms two steps bring s near enough to choose the number of terms.
    for (int i = 0; i < 2; ++i) s += step_to_zero(q, s).rest;
    if (absolute(s) < reach_7_.s)
      if (const auto end = end_within<Result>(start, overlap_after<7>(start), s, reach_7_)) return end;
    if (absolute(s) < reach_9_.s)
      if (const auto end = end_within<Result>(start, overlap_after<9>(start), s, reach_9_)) return end;
    if (!(absolute(s) < reach_.s)) return {};
    return end_within<Result>(start, overlap_after<all_pairs>(start), s, reach_);
  }
  // Bounds on the absolute values of the derivatives of x during the contact.
  Real second_of_x(const Start& start) const { return bounds(second_and_third_of_x_, start)[0]; }
  Real third_of_x(const Start& start) const { return bounds(second_and_third_of_x_, start)[1]; }
  Real fourth_of_x(const Start& start) const { return bounds(fourth_and_fifth_of_x_, start)[0]; }
  Real fifth_of_x(const Start& start) const { return bounds(fourth_and_fifth_of_x_, start)[1]; }

  // Whether the table's series hold at a time t < T after the touch. unit_at(i, t) is the state then of a
  // contact that begins with one unit of column i and nothing else.
  bool holds_at(const Real& t) const { return latest_ > 0 && !(reach_.s < half_period_ - t); }
  ContactState<Real> unit_at(std::size_t i, const Real& t) const {
    const Real s = t - half_period_, v = i == 1 ? Real(1) : i == 2 ? share_ : Real(0);
    const SeriesAt<Real> q = sum<Real>(q_[i], s), centre = sum<Real>(centre_[i], s);
    const Real kept = i == 2 ? decay_factor_ : Real(0), depth = q.u - kept * s, w = q.u1 - kept;
    const Real x = (i == 0 ? Real(1) : Real(0)) + (v * s + centre.u);
    return {x - share_ * depth, (v + centre.u1) - share_ * w, depth, w};
  }

 private:
  // A series is summed with 5, 7, 9 or all of its pairs of terms, as |s| needs.
  static constexpr std::size_t all_pairs = terms / 2;
  using Table = std::array<PairedSeries<Real, all_pairs>, columns>;
  using Both = SimdPair<Real>;
  using Bounds = std::array<Both, columns>;
  template <std::size_t pairs>
  static PairedSeries<Real, pairs> combine(const Table& by, const Start& start) {
    PairedSeries<Real, pairs> all;
    for (std::size_t n = 0; n < pairs; ++n)
      all[n] = by[0][n] * start[0] + by[1][n] * start[1] + by[2][n] * start[2];
    for (std::size_t i = 3; i < columns; ++i)
      for (std::size_t n = 0; n < pairs; ++n) all[n] = all[n] + by[i][n] * start[i];
    return all;
  }

  // Stores the columns `first` and `first` + 1 of q and of the centre.
  void tabulate(std::size_t first, const ShortContactColumn<Both, terms>& two) {
    for (const std::size_t i : {0, 1}) {
      for (std::size_t n = 0; n < all_pairs; ++n) {
        q_[first + i][n] = Both{two.q[2 * n][i], two.q[2 * n + 1][i]};
        centre_[first + i][n] = Both{two.centre[2 * n][i], two.centre[2 * n + 1][i]};
      }
    }
  }

  // Sets what column i contributes to the bounds on the fourth derivative of exp(a t) q and on x'' to x'''''.
  void tabulate_bounds(std::size_t i, const Oscillator<Real>& slow, const Oscillator<Real>& fast,
                       const Touch<Real>& touch) {
    const ContactState<Real>&s = touch.slow, &f = touch.fast;
    const Real omega = half_turn<Real>() / half_period_;
    unweighted_ = fast.b() * fast.b() / (omega * omega * omega * omega);
    // One differentiation increases the size of a free motion at most by this factor (mathematics.md, 7.6).
    const auto fastest = [](const Oscillator<Real>& o) {
      const Real root_b = square_root(o.b()), z = o.a() / root_b;
      return Real(root_b * (z + square_root(Real(1 + z * z))));
    };
    const Real slow_rate = fastest(slow), fast_rate = fastest(fast), weighted = slow_rate + fast.a();
    const Real along = (f.w + fast.a() * f.q) / omega;
    fourth_of_q_[i] = Both{omega * omega * omega * omega * square_root(Real(f.q * f.q + along * along)),
                           growth_ * weighted * weighted * weighted * weighted * slow.bound(s.q, s.w)};
    const Real slow_x = slow_rate * slow_rate * slow.bound(s.x, s.v);
    const Real fast_x = fast_rate * fast_rate * fast.bound(f.x, f.v);
    second_and_third_of_x_[i] = Both{slow_x + fast_x, slow_rate * slow_x + fast_rate * fast_x};
    const Real slow_square = slow_rate * slow_rate, fast_square = fast_rate * fast_rate;
    fourth_and_fifth_of_x_[i] = Both{slow_square * slow_x + fast_square * fast_x,
                                     slow_square * slow_rate * slow_x + fast_square * fast_rate * fast_x};
  }

  // How far from T a series of so many pairs of terms is used.
  struct Reach {
    Real s{0};          // the longest |s|
    Real growth{0};     // exp(a s), by which exp(a t) grows from T on
    Real last_step{0};  // the longest last step of s
  };
  template <std::size_t pairs>
  static Reach reach_of(const Oscillator<Real>& fast) {
    const auto& in_radians = reach_in_radians<Real, pairs>;
    const Real s = in_radians.s / fast.rate();
    return {s, exponential(Real(fast.a() * s)), in_radians.last_step / fast.rate()};
  }

  // Returns the terms of q(T + s) as a series in s.
  template <std::size_t pairs>
  PairedSeries<Real, pairs> overlap_after(const Start& start) const {
    PairedSeries<Real, pairs> q = combine<pairs>(q_, start);
    q[0] = q[0] - SimdPair<Real>{Real(0), decay_factor_ * start[2]};
    return q;
  }
  // The step from s to the zero of q, to second order, and q' and q'' at s.
  struct Step {
    Real rest, curvature, w, w1;  // curvature as in HalleyStep; rest = Newton's step (1 - curvature)
  };
  template <std::size_t pairs>
  static Step step_to_zero(const std::array<SimdPair<Real>, pairs>& q, const Real& s) {
    const auto [depth, w, w1] = sum<Real>(q, s);
    const Real over = 1 / w, newton = -depth * over, curvature = newton * (w1 * over) / 2;
    return {newton * (1 - curvature), curvature, w, w1};
  }
  template <class Result, std::size_t pairs>
  std::optional<Result> end_within(const Start& start, const std::array<SimdPair<Real>, pairs>& q, Real s,
                                   const Reach& reach) const {
    const Real &x = start[0], &v = start[1], &w = start[2];
    Step step;
    for (int i = 0;; ++i) {
      if (i == 8 || !(absolute(s) < reach.s)) return {};
      step = step_to_zero(q, s);
      if (absolute(step.rest) < reach.last_step) break;
      s += step.rest;
    }
    // All other series are summed at s and moved on by the last step.
    const Real rest = step.rest, whole = s + rest, time = half_period_ + whole;
    // The step also vanishes where the curvature is 1 and q is not zero. A small one excludes that.
    if (!(absolute(step.curvature) < Real(0.0625) && absolute(whole) < reach.s)) return {};
    const Real half_w2 = 3 * q[1][1] + s * (12 * q[2][0] + 30 * s * q[2][1]);
    const Real end_w = step.w + rest * (step.w1 + rest * half_w2);
    if (!(end_w * w < 0)) return {};
    const Real inward = w < 0 ? -1 : 1, into = absolute(w), out = absolute(end_w);
    const Both fourth = bounds(fourth_of_q_, start);
    const Real fast_fourth = fourth[0], slow_fourth = fourth[1];
    // The slope of exp(a t) q at the end is at least as steep as this one: exp(a s) >= 1 + a s.
    bool proved = stays_open(Real(0), into, Real(0), Real(-growth_ * (1 + decay_ * whole) * out), time,
                             Real(fast_fourth + reach.growth * slow_fourth));
    if (!proved && whole > 0) {
      // Two pieces: up to T with the weight exp(a t), and from T on without it. There the fourth derivative
      // of the fast mode is at most b^2 N E, N being the amplitude of exp(a t) times the fast mode.
      const Real depth = inward * q[0][0], slope = inward * q[0][1];
      proved = stays_open(Real(0), into, Real(growth_ * depth), Real(growth_ * (slope + decay_ * depth)),
                          half_period_, Real(fast_fourth + slow_fourth)) &&
               stays_open(depth, slope, Real(0), Real(-out), whole,
                          Real(decay_factor_ * (unweighted_ * fast_fourth + slow_fourth)));
    }
    if (!proved) return {};
    const SeriesAt<Real> change = sum<Real>(combine<pairs>(centre_, start), s);
    const Real centre_v = v + share_ * w;
    const Real moved = change.u + rest * change.u1, gained = share_ * (w - end_w) + change.u1;
    const Real end_x = x + (centre_v * whole + moved), v_before = v + gained;
    const Real by_rest =
        columns == 5 ? Real(rest * change.u2) : Real(-rest * ((1 - share_) * (2 * zeta_ * v_before + end_x)));
    if constexpr (std::is_same_v<Result, EndAndChange>) {
      const Real dx = share_ * w * whole + (moved - v * half_period_);
      return Result{time, end_x, v_before + by_rest, end_w, {dx, gained + by_rest}};
    } else {
      return Result{time, end_x, v_before + by_rest, end_w};
    }
  }
  [[gnu::always_inline]] static Both bounds(const Bounds& rows, const Start& start) {
    Both sum = rows[0] * absolute(start[0]) + rows[1] * absolute(start[1]) + rows[2] * absolute(start[2]);
    for (std::size_t i = 3; i < columns; ++i) sum = sum + rows[i] * absolute(start[i]);
    return sum;
  }

  Real half_period_{0}, decay_factor_{0};      // T and E = exp(-a T)
  Real decay_{0}, growth_{0};                  // a and exp(a T)
  Real unweighted_{0};                         // (b / omega^2)^2
  Reach reach_5_, reach_7_, reach_9_, reach_;  // with 5, 7, 9 and all pairs
  Real latest_{0};
  Real share_{0}, zeta_{0};
  Table centre_{}, q_{};
  Bounds fourth_of_q_{}, second_and_third_of_x_{},
      fourth_and_fifth_of_x_{};  // of q: the fast and the slow part
};

}  // namespace impact_damper
