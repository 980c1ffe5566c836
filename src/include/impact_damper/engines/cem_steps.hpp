// A segment of equal steps of the component element method, and the motion at its last step.
//
// The step of one damper has both increments in closed form (cem_scheme.hpp); that of a list solves for x
// first and then for each q (M17.10), which for one damper takes twice as long. All else is common to both.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "impact_damper/engines/cem_masses.hpp"

namespace impact_damper {

// A step size and, for one damper, the coefficients of the equations with it.
template <class Real>
struct CemPace {
  Real h{};
  CemStep<Real> flight{}, contact{}, stuck{};
};

template <class Real, template <class> class ForEach>
class CemSteps {
  using Masses = CemMasses<Real, ForEach>;
  using State = typename Masses::State;
  using Moment = CemMoment<Real>;
  static constexpr bool one = Masses::one;

 public:
  static constexpr std::int64_t block = ForceAtSteps<Real>::block;

  // sums_powers: whether take() adds up `Sums`, for the energy balance.
  CemSteps(Masses& masses, Damper damper, bool sums_powers)
      : masses_(masses), centred_(damper == Damper::centred), sums_powers_(sums_powers) {}

  // Returns the pace with the step size h.
  CemPace<Real> pace_of(const Real& h) const {
    if constexpr (one) {
      const auto& m = masses_[0];
      const Real& zeta = masses_.zeta;
      const Damper damper = centred_ ? Damper::centred : Damper::lagged;
      return {h, cem_step<Real>({m.nu, zeta, 0, 0}, damper, h),
              cem_step<Real>({m.nu, zeta, m.c, m.omega_2}, damper, h), cem_step_stuck(m.nu, zeta, h)};
    } else {
      return {h};
    }
  }
  // Sets the pace of the segment that begins next.
  void set_pace(const CemPace<Real>& pace) { pace_ = pace; }
  const Real& h() const { return pace_.h; }

  // The number of the last step; 0 at the beginning of a segment.
  std::int64_t number() const { return number_; }
  // The times at which the last step, number() - 1 to number(), begins and ends; arcs count it as [0, h].
  Real begin() const { return origin_ + Real(number_ - 1) * pace_.h; }
  Real end() const { return origin_ + Real(number_) * pace_.h; }
  // The number of the step of this segment in which `time` lies; the first for earlier times.
  std::int64_t step_of(const Real& time) const { return whole_steps(double((time - origin_) / pace_.h)); }
  // x at the end of the last step, and its increment in it.
  const Moment& x() const { return now_; }
  // The parabola of x, as a function of the time since the last step began.
  Arc<Real> x_arc() const { return arc_of(before_, now_, pace_.h); }

  // Begins a segment at `time`, in the state s, with the second-order start: one step before, a coordinate u
  // is u - h u' + h^2 u''/2.
  void begin_segment(const Real& time, const State& s) {
    const Real h = pace_.h, second = masses_.second_of_x(time, s);
    now_ = {s.x, h * (s.v - h * second / 2)};
    for (std::size_t i = 0; i < masses_.size(); ++i)
      masses_[i].now = {s.q[i], h * (s.w[i] - h * masses_.second_of_q(s, i, second) / 2)};
    origin_ = time;
    number_ = 0;
    renew_coefficients();
  }
  // Adds y''' h^3/6 to the start of a mass at rest on a wall, where y'' = `second` and y''' = `third`, unless
  // y'' h^2/2 is larger. The second-order start leaves y on the wall, where the error of a y'' that is zero
  // would decide what comes next.
  void lead_from_rest(std::size_t i, const Real& second, const Real& third) {
    const Real h = pace_.h;
    if (3 * absolute(second) < h * absolute(third)) masses_[i].now.dx += h * h * h * third / 6;
  }
  // Adds x''' h^3/6 to the start of a primary mass at rest, on which a force grows at `rate`.
  void lead_x_by(const Real& rate) {
    const Real h = pace_.h;
    now_.dx += h * h * h * rate / 6 / masses_.joined;
  }
  // Computes the step's coefficients for h and the walls at which masses are (M17.10); for one damper they
  // are in pace_.
  void renew_coefficients() {
    if constexpr (!one) {
      if (masses_.has_laws()) masses_.set_secants(end(), now_.x, pace_.h);
      const Real h = pace_.h, outer = h * masses_.zeta, h_2 = h * h, joined = masses_.joined;
      const auto ahead = [&](const auto& m) {
        const Real of_wall = centred_ ? h * m.c / 2 : Real(0);
        return masses_.has_components() ? (m.wall ? of_wall : Real(0)) + h * m.drag / 2 : of_wall;
      };
      const auto behind = [&](const auto& m) {
        const Real of_wall = centred_ ? h * m.c / 2 : h * m.c;
        return masses_.has_components() ? (m.wall ? of_wall : Real(0)) + h * m.drag / 2 : of_wall;
      };
      Real determinant = joined + outer;
      for (const std::size_t i : masses_.coupled)
        determinant += masses_[i].nu * (ahead(masses_[i]) / (1 + ahead(masses_[i])));
      const Real xx = 1 / determinant;
      of_x_.dx_dx = xx * (joined - outer);
      of_x_.dx_x = -h_2 * xx;
      of_x_.dx_f = h_2 * xx;
      for (const std::size_t i : masses_.coupled) {
        auto& m = masses_[i];
        const Real spring = h_2 * m.spring();
        m.dq_dx = 1 / (1 + ahead(m));
        m.dq_dq = m.dq_dx * (1 - behind(m));
        m.dq_q = -m.dq_dx * spring;
        const Real xq = xx * m.nu * (ahead(m) * m.dq_dx);
        of_x_.dx_dx += xq;
        m.dx_dq = xx * m.nu * behind(m) + xq * (1 - behind(m));
        m.dx_q = spring * (xx * m.nu - xq);
      }
      if (!masses_.has_components()) return;
      Real pushes = (1 - joined) * masses_.weight;
      for (auto& m : masses_.all) {
        const Real friction = m.friction * m.slides;
        m.dq_1 = m.stuck ? Real(0) : Real(-h_2 * (friction + masses_.weight) * m.dq_dx);
        const Real shift = m.resistance() == 0 ? Real(0) : Real(ahead(m) * m.dq_1 / h_2);
        if (!m.stuck) pushes += m.nu * (friction + shift);
      }
      of_x_1_ = h_2 * xx * pushes;
    }
  }

  // Whether friction or weight pushes the primary mass now.
  bool is_pushed() const { return of_x_1_ != 0; }
  // Whether a block of 1024 steps of the segment begins: the force is then computed afresh, and the sums
  // must have been taken.
  bool begins_block() const { return number_ % block == 0; }
  // Takes steps until a wall is met or left (x'' changes its sign where masses are stuck), x is no longer on
  // `side` or x' no longer has the sign of `trend`, or `most` are done (fewer where a block ends).
  void take(std::int64_t most, const Real& side, const Real& trend) {
    const bool forced = bool(masses_.force);
    if (forced || sums_powers_) most = std::min(most, block - number_ % block);
    if (forced && begins_block()) force_ = {masses_.force, end(), pace_.h};
    if constexpr (one) {
      const auto choose = [&](auto in) {
        constexpr Regime regime = in;
        if (forced) {
          sums_powers_ ? take<regime, true, true>(most, side, trend)
                       : take<regime, true, false>(most, side, trend);
        } else {
          sums_powers_ ? take<regime, false, true>(most, side, trend)
                       : take<regime, false, false>(most, side, trend);
        }
      };
      const auto& m = masses_[0];
      m.stuck  ? choose(std::integral_constant<Regime, Regime::stuck>())
      : m.wall ? choose(std::integral_constant<Regime, Regime::contact>())
               : choose(std::integral_constant<Regime, Regime::flight>());
    } else {
      masses_.has_laws()         ? take_of_all<true, true>(most, side, trend)
      : masses_.has_components() ? take_of_all<true, false>(most, side, trend)
                                 : take_of_all<false, false>(most, side, trend);
    }
  }

  // Returns h^2 x'' at the end of the last step, and at its beginning.
  Real second_after() const {
    return masses_.has_laws() ? second_at<true>(now_, force_.f) : second_at<false>(now_, force_.f);
  }
  Real second_before() const { return now_.dx - before_.dx; }

  // Returns the state at a time in the last step.
  State state_at(const Real& at) const {
    const Arc<Real> x = x_arc();
    return {x.at(at), x.slope_at(at), masses_.of_each([&](std::size_t i) {
              const auto& m = masses_[i];
              const Real q = m.arc(pace_.h).at(at);
              // For one damper q has the rounding of y.
              return one ? Real((m.origin_of_q() + q) - m.origin_of_q()) : q;
            }),
            masses_.of_each([&](std::size_t i) { return masses_[i].arc(pace_.h).slope_at(at); })};
  }
  // Returns the same with the velocities by the trapezoid of the accelerations, one order better than the
  // slopes.
  State refined_state_at(const Real& at) const {
    State s = state_at(at);
    const Real second = masses_.second_of_x(begin() + at, s);
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Arc<Real> q = masses_[i].arc(pace_.h);
      s.w[i] = q.slope + at * (q.second + masses_.second_of_q(s, i, second)) / 2;
    }
    s.v = x_arc().slope + at * (x_arc().second + second) / 2;
    return s;
  }

  // Sums over steps of (2 h v)^2 and f (2 h v), v centred, until they are taken.
  struct Sums {
    Real vv = 0, fv = 0;
  };
  Sums take_sums() { return std::exchange(sums_, {}); }

 private:
  // take() for one damper, in one regime.
  template <Regime regime, bool forced, bool balance>
  void take(std::int64_t most, const Real side, const Real trend) {
    auto& m = masses_[0];
    const CemStep<Real> a = regime == Regime::contact  ? pace_.contact
                            : regime == Regime::flight ? pace_.flight
                                                       : pace_.stuck;
    const Real push = m.push(), clearance = m.clearance;
    const bool centred = centred_;
    Moment x = now_, q = m.now, last_x, last_q;
    ForceAtSteps<Real> force = force_;
    const Real& f = force.f;
    auto [sum_vv, sum_fv] = sums_;
    [[maybe_unused]] Real sum_ww = regime == Regime::contact ? m.sum_ww : Real(0);

    bool uneventful;
    std::int64_t n = 0;
    do {
      last_x = x;
      last_q = q;
      if constexpr (regime != Regime::contact) {
        x.dx = a.dx_dx * last_x.dx + a.dx_x * last_x.x;
        if constexpr (forced) x.dx += a.dx_f * f;
        if constexpr (regime == Regime::flight) q.dx = last_q.dx - (x.dx - last_x.dx);
      } else {
        x.dx = (a.dx_dx * last_x.dx + a.dx_x * last_x.x) + (a.dx_dq * last_q.dx + a.dx_q * last_q.x);
        q.dx = (a.dq_dq * last_q.dx + a.dq_q * last_q.x) + (a.dq_dx * last_x.dx + a.dq_x * last_x.x);
        if constexpr (forced) {
          x.dx += a.dx_f * f;
          q.dx += a.dq_f * f;
        }
      }
      x.x = last_x.x + x.dx;
      q.x = last_q.x + q.dx;
      if constexpr (balance) {
        const Real v = last_x.dx + x.dx, w = last_q.dx + q.dx;
        sum_vv += v * v;
        if constexpr (regime == Regime::contact) sum_ww += (centred ? w : 2 * last_q.dx) * w;
        if constexpr (forced) sum_fv += f * v;
      }
      if constexpr (forced) {
        force.advance();
      }
      ++n;
      if constexpr (regime == Regime::flight) {
        uneventful = (q.x >= 0) & (q.x <= clearance);
      } else if constexpr (regime == Regime::stuck) {
        uneventful = push * ((a.dx_dx - 1) * x.dx + a.dx_x * x.x + a.dx_f * f) >= 0;
      } else {
        uneventful = push * q.x < 0;
      }
      uneventful &= (side * x.x >= 0) & (trend * x.dx >= 0);
    } while (uneventful && n < most);

    before_ = last_x;
    now_ = x;
    m.before = last_q;
    m.now = q;
    number_ += n;
    if constexpr (forced) force_ = force;
    if constexpr (balance) {
      sums_ = {sum_vv, sum_fv};
      if constexpr (regime == Regime::contact) m.sum_ww = sum_ww;
    }
  }
  // take() for a list.
  template <bool components, bool laws>
  void take_of_all(std::int64_t most, const Real side, const Real trend) {
    auto& masses = masses_.all;
    const auto& coupled = masses_.coupled;
    const bool forced = bool(masses_.force), stuck = masses_.joined > 1;
    Real dx_dx = of_x_.dx_dx, dx_x = of_x_.dx_x;
    const Real h_2 = pace_.h * pace_.h;
    Real x = now_.x, dx = now_.dx, last_x, last_dx;
    bool uneventful;
    do {
      last_x = x;
      last_dx = dx;
      dx = dx_dx * last_dx + dx_x * (laws ? masses_.primary_force(x) : x);
      for (const std::size_t i : coupled)
        dx += masses[i].dx_dq * masses[i].now.dx + masses[i].dx_q * masses[i].now.x;
      if (forced) dx += of_x_.dx_f * force_.f;
      if constexpr (components) dx += of_x_1_;
      x += dx;
      const Real slows = last_dx - dx;
      uneventful = (side * x >= 0) & (trend * dx >= 0);
      for (auto& m : masses) {
        const Real q = m.now.x, last_dq = m.now.dx;
        Real dq = (m.dq_dq * last_dq + m.dq_q * q) + m.dq_dx * slows;
        if constexpr (components) {
          dq += m.dq_1;
          uneventful &= m.slides_on(last_dq, dq);
        }
        const Real next = q + dq;
        m.before.x = q;
        m.before.dx = last_dq;
        m.now.x = next;
        m.now.dx = dq;
        uneventful &= (next >= m.least) & (next <= m.most);
      }
      if (sums_powers_) {
        const Real v = last_dx + dx;
        sums_.vv += v * v;
        sums_.fv += force_.f * v;
        for (const std::size_t i : coupled) {
          auto& m = masses[i];
          const Real w = m.before.dx + m.now.dx;
          const Real square = (centred_ ? w : 2 * m.before.dx) * w;
          m.sum_ww += laws ? m.c * square : square;
          if constexpr (components) m.sum_drag += w * w;
        }
      }
      if (forced) force_.advance();
      ++number_;
      if constexpr (laws) {  // the walls' secants change with q
        now_ = {x, dx};
        renew_coefficients();
        dx_dx = of_x_.dx_dx, dx_x = of_x_.dx_x;
      }
      if (stuck) {
        const Real second = second_at<laws>({x, dx}, force_.f);
        uneventful &= (second >= h_2 * masses_.least_second) & (second <= h_2 * masses_.most_second);
      }
    } while (uneventful && --most > 0);
    before_ = {last_x, last_dx};
    now_ = {x, dx};
  }
  template <bool laws>
  Real second_at(const Moment& x, const Real& f) const {
    const CemStep<Real>& a = one ? pace_.stuck : of_x_;
    Real second = (a.dx_dx - 1) * x.dx + a.dx_x * (laws ? masses_.primary_force(x.x) : x.x) + a.dx_f * f;
    for (const std::size_t i : masses_.coupled)
      second += masses_[i].dx_dq * masses_[i].now.dx + masses_[i].dx_q * masses_[i].now.x;
    return one ? second : Real(second + of_x_1_);
  }

  Masses& masses_;
  const bool centred_, sums_powers_;
  CemPace<Real> pace_;
  CemStep<Real> of_x_{};      // for a list, by (M17.10)
  Real of_x_1_ = 0;           // with components, by (M18.6)
  Moment before_{}, now_{};   // x before and after the last step
  Real origin_ = 0;           // time of step 0
  std::int64_t number_ = 0;   // of now_
  ForceAtSteps<Real> force_;  // at the next step
  Sums sums_;
};

}  // namespace impact_damper
