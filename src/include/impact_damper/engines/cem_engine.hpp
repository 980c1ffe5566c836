// The engine of cem.hpp, for one damper and for a list of them (docs/mathematics.md, 9 and 17.5). Only x
// couples the secondary masses. Each is in flight, in contact with a wall, or stuck to one, by itself.
//
// The step of one damper has both increments in closed form (cem_scheme.hpp); that of a list solves for x
// first and then for each q (M17.10), which for one damper takes twice as long. All else is common to both.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "impact_damper/engines/cem_rates.hpp"
#include "impact_damper/engines/cem_scheme.hpp"
#include "impact_damper/engines/damper_order.hpp"
#include "impact_damper/engines/half_cycle_tracker.hpp"
#include "impact_damper/engines/observer.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// The container in which CemEngine keeps something for each secondary mass.
template <class T>
using ForOne = std::array<T, 1>;
template <class T>
using ForSeveral = std::vector<T>;

template <class Real, class Observer, template <class> class ForEach>
class CemEngine {
  static constexpr bool one = std::is_same_v<ForEach<Real>, ForOne<Real>>;

 public:
  // options: resolved and free of problems. ForOne takes a scene without a list of dampers or with a list of
  // one, ForSeveral any list.
  CemEngine(const Scene& scene, const Cem& options, Observer& observer);

  Outcome run() {
    if (energy_balance_) {
      observer_.energy_balance().initial = energy(start_);
      for (std::size_t i = 0; i < masses_.size(); ++i)
        energy_[masses_[i].number].initial_kinetic = kinetic(start_, i);
    }
    if (observer_.next_sample() <= 0) tell_sample(0, start_);
    while (!end_) {
      if (rates_ && steps_at_pace_ == 0) {
        steps_at_pace_ = choose_pace();
        spend_look();
      }
      const bool unknown = side_or_trend_unknown();
      if (unknown) spend_look();
      take_steps(unknown ? 1 : steps_until_look());
      look_at_last_step();
    }
    return *end_;
  }

 private:
  struct Moment {  // a position at a step, and the increment that led there
    Real x, dx;
  };
  // A secondary mass: its q is y in flight and at the left wall, y - clearance at the right one.
  struct Mass {
    std::int32_t number;  // in the scene
    Real nu, k, clearance;
    Real c, omega_2;                // of its wall, whether the mass is there or not
    std::int64_t steps_of_contact;  // small steps in the nominal contact time
    std::optional<Wall> wall{};     // the wall it is at, in contact or stuck
    bool stuck = false;
    Moment before{}, now{};
    // For a list: dq_{n+1} = dq_dq dq_n + dq_q q_n + dq_dx (dx_n - dx_{n+1}), dx_{n+1} = ... + dx_dq dq_n +
    // dx_q q_n.
    Real dq_dq = 1, dq_q = 0, dq_dx = 1, dx_dq = 0, dx_q = 0;
    Real least{}, most{};  // limits of q while nothing changes
    Real contact_begin = 0;
    std::optional<std::size_t> impact{};  // the one that began the contact
    Real work = 0, sum_ww = 0;  // lost at the wall in this contact; sum of (2 h w)^2 not yet added to it
    Real impact_loss = 0, contact_loss = 0, loss = 0;  // past contacts, with and without an impact; their sum

    Real origin_of_q() const { return wall == Wall::right ? clearance : Real(0); }
    Real push() const { return wall == Wall::left ? Real(1) : Real(-1); }  // sign of the wall's push
    Wall wall_ahead() const { return now.x > clearance / 2 ? Wall::right : Wall::left; }
    Arc<Real> arc(const Real& h) const { return arc_of(before, now, h); }
  };
  // The state of all masses: x and x', and q and q' of each secondary mass.
  struct Whole {
    Real x, v;
    ForEach<Real> q, w;
  };
  // A mass that came to a wall or left it in the last step, the time of this since the beginning of the step,
  // and whether the mass sticks there.
  struct Change {
    std::size_t index;
    Real at;
    bool joins = false;
  };
  // A step size and, for one damper, the coefficients of the equations with it.
  struct Pace {
    Real h{};
    CemStep<Real> flight{}, contact{}, stuck{};
  };
  struct Rates {
    Pace large, pressed;
  };
  static Arc<Real> arc_of(const Moment& before, const Moment& now, const Real& h) {
    return {before.x, (before.dx + now.dx) / (2 * h), (now.dx - before.dx) / (h * h)};
  }
  static Real sign(const Real& value) { return Real((value > 0) - (value < 0)); }

  template <class Value>
  ForEach<Real> of_each(Value&& value) const {
    if constexpr (one) {
      return {value(0)};
    } else {
      std::vector<Real> all(masses_.size());
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = value(i);
      return all;
    }
  }

  Real forcing(const Real& time) const { return value_of(force_, time); }
  Real forcing_rate(const Real& time) const { return rate_of(force_, time); }
  // The times at which the last step, number step_ - 1 to step_, begins and ends; arcs count it as [0, h].
  Real last_step_begin() const { return origin_ + Real(step_ - 1) * pace_.h; }
  Real last_step_end() const { return origin_ + Real(step_) * pace_.h; }
  // The number of the step of this segment in which `time` lies; the first for earlier times.
  std::int64_t step_of(const Real& time) const { return whole_steps(double((time - origin_) / pace_.h)); }
  Arc<Real> x_arc() const { return arc_of(before_, now_, pace_.h); }
  Real y(const Whole& s, std::size_t i) const { return masses_[i].origin_of_q() + s.q[i]; }

  Real wall_force(const Whole& s, std::size_t i) const {  // divided by the secondary mass
    const Mass& m = masses_[i];
    return m.wall && !m.stuck ? m.c * s.w[i] + m.omega_2 * s.q[i] : Real(0);
  }
  // The sum of the primary mass and all masses at walls, divided by the primary mass.
  Real mass_with_walls() const {
    Real mass = joined_mass_;
    for (const std::size_t i : in_contact_) mass += masses_[i].nu;
    return mass;
  }
  // x'' by (M9.5) with `mass` in place of 1 + nu.
  Real second_as_one(const Real& time, const Whole& s, const Real& mass) const {
    return (forcing(time) - 2 * zeta_ * s.v - s.x) / mass;
  }
  // x'' by (M17.9), with `mass` for the primary mass and the masses joined to it.
  Real second_of_x(const Real& time, const Whole& s, const Real& mass) const {
    if (mass > 1 && in_contact_.empty()) return second_as_one(time, s, mass);
    Real force = forcing(time);
    for (const std::size_t i : in_contact_) force += masses_[i].nu * wall_force(s, i);
    return (force - (2 * zeta_ * s.v + s.x)) / mass;
  }
  Real second_of_x(const Real& time, const Whole& s) const { return second_of_x(time, s, joined_mass_); }
  Real second_of_q(const Whole& s, std::size_t i, const Real& bend) const {  // bend: x''
    return masses_[i].stuck ? Real(0) : Real(-wall_force(s, i) - bend);
  }
  // y''' of a mass in flight where x'' = 0.
  Real third_of_y(const Real& time, const Whole& s) const {
    Real jerk = s.v - forcing_rate(time);
    for (const std::size_t i : in_contact_)
      jerk -= masses_[i].nu * (masses_[i].omega_2 * s.w[i] - masses_[i].c * wall_force(s, i));
    return jerk;
  }
  // Returns h^2 x'' at a step.
  Real bend_at(const Moment& x, const Real& f) const {
    const CemStep<Real>& a = one ? pace_.stuck : step_of_x_;
    Real bend = (a.dx_dx - 1) * x.dx + a.dx_x * x.x + a.dx_f * f;
    for (const std::size_t i : in_contact_)
      bend += masses_[i].dx_dq * masses_[i].now.dx + masses_[i].dx_q * masses_[i].now.x;
    return bend;
  }

  // Returns the state at a time in the last step.
  Whole state_at(const Real& at) const {
    const Arc<Real> x = x_arc();
    return {x.at(at), x.slope_at(at), of_each([&](std::size_t i) {
              const Mass& m = masses_[i];
              const Real q = m.arc(pace_.h).at(at);
              // For one damper q has the rounding of y.
              return one ? Real((m.origin_of_q() + q) - m.origin_of_q()) : q;
            }),
            of_each([&](std::size_t i) { return masses_[i].arc(pace_.h).slope_at(at); })};
  }
  // Returns the same with the velocities by the trapezoid of the accelerations, one order better than the
  // slopes.
  Whole refined_state_at(const Real& at) const {
    Whole s = state_at(at);
    const Real bend = second_of_x(last_step_begin() + at, s);
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Arc<Real> q = masses_[i].arc(pace_.h);
      s.w[i] = q.slope + at * (q.bend + second_of_q(s, i, bend)) / 2;
    }
    s.v = x_arc().slope + at * (x_arc().bend + bend) / 2;
    return s;
  }

  // Begins a segment with the second-order start: the step before the first is u - h u' + h^2 u''/2.
  void begin_segment(const Real& time, const Whole& s) {
    const Real h = pace_.h, bend = second_of_x(time, s);
    now_ = {s.x, h * (s.v - h * bend / 2)};
    for (std::size_t i = 0; i < masses_.size(); ++i)
      masses_[i].now = {s.q[i], h * (s.w[i] - h * second_of_q(s, i, bend) / 2)};
    origin_ = time;
    step_ = 0;
    if (energy_balance_) add_powers(-h / 2, time, s);
    renew_step();
  }
  // Adds y''' = `jerk` to the start of a mass at rest on a wall, where y'' is `bend`. The second-order start
  // leaves y on the wall, where the error of a y'' that is zero would decide what comes next.
  void lead_from_rest(std::size_t i, const Real& bend, const Real& jerk) {
    const Real h = pace_.h;
    if (3 * absolute(bend) < h * absolute(jerk)) masses_[i].now.dx += h * h * h * jerk / 6;
  }
  // Computes the step's coefficients for h and the walls at which masses are (M17.10); for one damper they
  // are in pace_.
  void renew_step() {
    if constexpr (!one) {
      const Real h = pace_.h, outer = h * zeta_, h_2 = h * h;
      const auto ahead = [&](const Mass& m) { return centred_ ? h * m.c / 2 : Real(0); };
      Real determinant = joined_mass_ + outer;
      for (const std::size_t i : in_contact_)
        determinant += masses_[i].nu * (ahead(masses_[i]) / (1 + ahead(masses_[i])));
      const Real xx = 1 / determinant;
      step_of_x_.dx_dx = xx * (joined_mass_ - outer);
      step_of_x_.dx_x = -h_2 * xx;
      step_of_x_.dx_f = h_2 * xx;
      for (const std::size_t i : in_contact_) {
        Mass& m = masses_[i];
        const Real behind = centred_ ? h * m.c / 2 : h * m.c, spring = h_2 * m.omega_2;
        m.dq_dx = 1 / (1 + ahead(m));
        m.dq_dq = m.dq_dx * (1 - behind);
        m.dq_q = -m.dq_dx * spring;
        const Real xq = xx * m.nu * (ahead(m) * m.dq_dx);
        step_of_x_.dx_dx += xq;
        m.dx_dq = xx * m.nu * behind + xq * (1 - behind);
        m.dx_q = spring * (xx * m.nu - xq);
      }
    }
  }
  // Puts a mass to a wall, in contact with it or stuck, or into flight, with the same y.
  void set_wall(std::size_t i, std::optional<Wall> wall, bool stuck = false) {
    Mass& m = masses_[i];
    const Real smallest = std::numeric_limits<Real>::denorm_min();
    const Real infinity = std::numeric_limits<Real>::infinity();
    const Real old_origin = m.origin_of_q();
    const bool was_stuck = std::exchange(m.stuck, stuck);
    m.wall = wall;
    m.before.x += old_origin - m.origin_of_q();
    m.now.x += old_origin - m.origin_of_q();
    if (!wall || stuck) m.dq_dq = m.dq_dx = Real(!stuck), m.dq_q = m.dx_dq = m.dx_q = 0;
    m.least = !wall || stuck ? Real(0) : wall == Wall::left ? -infinity : smallest;
    m.most = !wall ? m.clearance : stuck ? Real(0) : wall == Wall::left ? -smallest : infinity;
    if constexpr (one) {
      in_contact_.resize(wall && !stuck ? 1 : 0);
    } else {
      std::erase(in_contact_, i);
      if (wall && !stuck) in_contact_.insert(std::ranges::lower_bound(in_contact_, i), i);
    }
    if (!stuck && !was_stuck) return;
    joined_mass_ = 1;
    least_bend_ = -infinity;
    most_bend_ = infinity;
    for (const Mass& each : masses_) {
      if (!each.stuck) continue;
      joined_mass_ += each.nu;
      (each.wall == Wall::left ? least_bend_ : most_bend_) = 0;
    }
  }

  // Spends one look at a step. Steps that are looked at one by one, at events or because no event can be
  // excluded, cost many times what the others do: when the allowed number of looks is spent, one step
  // remains. Looks at samples do not count, as they must not change where the run ends.
  void spend_look() {
    if (--looks_left_ < 0) steps_left_ = std::min<std::int64_t>(steps_left_, 1);
  }
  // Whether the side of x or the sign of x' is unknown, because it has been zero until now: each step is then
  // looked at for the first movement, unless nothing can move x before the next impact.
  bool side_or_trend_unknown() const {
    const bool at_rest = !force_ && in_contact_.empty() && !(joined_mass_ > 1) && now_.x == 0 && now_.dx == 0;
    return (half_cycles_.side() == 0 || trend_ == 0) && !at_rest;
  }
  std::int64_t steps_until_look() const {  // at least one
    const Real sample = observer_.next_sample();
    std::int64_t steps = std::min(step_of(sample < end_time_ ? sample : end_time_) - step_, steps_left_);
    if (rates_) steps = std::min(steps, steps_at_pace_);
    return std::max<std::int64_t>(steps, 1);
  }

  // Takes steps until a wall is met or left (x'' changes its sign where masses are stuck), x changes its sign
  // or x' its own, or `most` are done (fewer where a force or an energy balance is renewed).
  void take_steps(std::int64_t most) {
    const bool forced = bool(force_);
    // At every 1024th step of a segment the force is computed afresh, and the sums are added up.
    if (forced || energy_balance_) {
      constexpr std::int64_t block = ForceAtSteps<Real>::block;
      const std::int64_t in_block = step_ % block;
      most = std::min(most, block - in_block);
      if (in_block == 0) {
        if (energy_balance_) add_sums();
        if (forced) force_at_steps_ = {force_, origin_ + Real(step_) * pace_.h, pace_.h};
      }
    }
    const std::int64_t from = step_;
    if constexpr (one) {
      const auto choose = [&](auto in) {
        constexpr Regime regime = in;
        if (forced) {
          energy_balance_ ? take_steps<regime, true, true>(most) : take_steps<regime, true, false>(most);
        } else {
          energy_balance_ ? take_steps<regime, false, true>(most) : take_steps<regime, false, false>(most);
        }
      };
      const Mass& m = masses_[0];
      m.stuck  ? choose(std::integral_constant<Regime, Regime::stuck>())
      : m.wall ? choose(std::integral_constant<Regime, Regime::contact>())
               : choose(std::integral_constant<Regime, Regime::flight>());
    } else {
      take_steps_of_all(most);
    }
    steps_left_ -= step_ - from;
    if (rates_) steps_at_pace_ -= step_ - from;
  }
  // The same for one damper, in one regime.
  template <Regime regime, bool forced, bool balance>
  void take_steps(std::int64_t most) {
    Mass& m = masses_[0];
    const CemStep<Real> a = regime == Regime::contact  ? pace_.contact
                            : regime == Regime::flight ? pace_.flight
                                                       : pace_.stuck;
    const Real side = half_cycles_.side(), trend = trend_, push = m.push(), clearance = m.clearance;
    const bool centred = centred_;
    Moment x = now_, q = m.now, last_x, last_q;
    ForceAtSteps<Real> force = force_at_steps_;
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
    step_ += n;
    if constexpr (forced) force_at_steps_ = force;
    if constexpr (balance) {
      sums_ = {sum_vv, sum_fv};
      if constexpr (regime == Regime::contact) m.sum_ww = sum_ww;
    }
  }
  // The same for a list.
  void take_steps_of_all(std::int64_t most) {
    const bool forced = bool(force_), stuck = joined_mass_ > 1;
    const Real side = half_cycles_.side(), trend = trend_, dx_dx = step_of_x_.dx_dx, dx_x = step_of_x_.dx_x;
    Real x = now_.x, dx = now_.dx, last_x, last_dx;
    bool uneventful;
    do {
      last_x = x;
      last_dx = dx;
      dx = dx_dx * last_dx + dx_x * x;
      for (const std::size_t i : in_contact_)
        dx += masses_[i].dx_dq * masses_[i].now.dx + masses_[i].dx_q * masses_[i].now.x;
      if (forced) dx += step_of_x_.dx_f * force_at_steps_.f;
      x += dx;
      const Real slows = last_dx - dx;
      uneventful = (side * x >= 0) & (trend * dx >= 0);
      for (Mass& m : masses_) {
        const Real q = m.now.x, last_dq = m.now.dx;
        const Real dq = (m.dq_dq * last_dq + m.dq_q * q) + m.dq_dx * slows, next = q + dq;
        m.before.x = q;
        m.before.dx = last_dq;
        m.now.x = next;
        m.now.dx = dq;
        uneventful &= (next >= m.least) & (next <= m.most);
      }
      if (energy_balance_) {
        const Real v = last_dx + dx;
        sums_.vv += v * v;
        sums_.fv += force_at_steps_.f * v;
        for (const std::size_t i : in_contact_) {
          Mass& m = masses_[i];
          const Real w = m.before.dx + m.now.dx;
          m.sum_ww += (centred_ ? w : 2 * m.before.dx) * w;
        }
      }
      if (forced) force_at_steps_.advance();
      if (stuck) {
        const Real bend = bend_at({x, dx}, force_at_steps_.f);
        uneventful &= (bend >= least_bend_) & (bend <= most_bend_);
      }
      ++step_;
    } while (uneventful && --most > 0);
    before_ = {last_x, last_dx};
    now_ = {x, dx};
  }

  void look_at_last_step() {
    const Real begin = last_step_begin(), h = pace_.h, side = half_cycles_.side();
    const bool last = step_ >= step_of(end_time_);
    const auto too_late = [&](const Real& at) { return begin + at > end_time_; };
    const bool crosses = side * now_.x < 0, turns = trend_ * now_.dx < 0;
    find_changes();
    if (!changes_.empty() || crosses || turns) spend_look();
    if (!changes_.empty()) std::erase_if(changes_, [&](const Change& each) { return too_late(each.at); });

    // Where masses join or part, the motion begins anew, with or without `locate`.
    bool restart = locate_ && !changes_.empty();
    if (stuck_speed_) {
      for (Change& change : changes_) {
        change.joins = joins(change);
        restart = restart || change.joins || masses_[change.index].stuck;
      }
    }
    bool slows_down = false;
    std::optional<Whole> anew;
    if (restart) {
      keep_first_changes();
      slows_down = rates_ && std::ranges::any_of(changes_, [&](const Change& each) {
                     const Mass& m = masses_[each.index];
                     return m.stuck || (!m.wall && h > small_.h);
                   });
      anew = slows_down ? motion_at(changes_.front().at) : refined_state_at(changes_.front().at);
    }
    const Real span = restart ? changes_.front().at : last ? std::max(end_time_ - begin, Real(0)) : h;
    std::optional<Real> zero;
    if (crosses) zero = x_arc().times(side).fall(h);
    if (zero && (too_late(*zero) || (restart && *zero > span))) zero.reset();

    if (turns || restart) consider_peak(turns && step_ > 1 ? -h / 2 : Real(0), span);
    if (turns) trend_ = -trend_;
    if (half_cycles_.side() == 0) half_cycles_.take_side(sign(now_.x));
    if (trend_ == 0) trend_ = sign(now_.dx);

    for (const Change& change : changes_) {
      if (zero && !(change.at < *zero)) {
        cross_zero(*zero, span);
        zero.reset();
      }
      if (!end_) change_regime(change, anew);
      if (end_) return;
    }
    if (zero) cross_zero(*zero, span);
    if (end_) return;
    if (restart) return begin_anew(span, *std::move(anew), slows_down);
    if (!changes_.empty()) renew_step();
    if (last) return finish(horizon_.stop_reason, span, true);
    if (steps_left_ == 0) return finish(StopReason::step_budget, span);
    give_samples(end_time_);
  }
  // Sets changes_, the masses that came to a wall or left one in the last step, in the order of time.
  void find_changes() {
    changes_.clear();
    bool finite = std::isfinite(double(now_.x));
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Mass& m = masses_[i];
      finite = finite && std::isfinite(double(m.now.x));
      if (m.stuck) {
        if (const auto at = parting(m)) changes_.push_back({i, *at});
      }
      if (!(m.now.x >= m.least && m.now.x <= m.most)) changes_.push_back({i, wall_crossing(m)});
    }
    if (!finite) fail_of_overflow(double(last_step_begin()), double(pace_.h));
    if constexpr (!one) {
      std::sort(changes_.begin(), changes_.end(), [&](const Change& some, const Change& other) {
        const double at = double(last_step_begin() + some.at), then = double(last_step_begin() + other.at);
        return at < then || (at == then && masses_[some.index].number < masses_[other.index].number);
      });
    }
  }
  // Returns the time in the last step at which a mass came to a wall or left it.
  Real wall_crossing(const Mass& m) const {
    const bool falls = m.wall == Wall::right || (!m.wall && m.now.x < 0);
    Arc<Real> gap = m.arc(pace_.h).times(falls ? Real(1) : Real(-1));
    if (!m.wall && !falls) gap.g += m.clearance;
    return gap.fall(pace_.h);
  }
  // Returns the time in the last step at which x'' of a stuck mass changed its sign, and with it the wall's
  // push; nothing if it did not.
  std::optional<Real> parting(const Mass& m) const {
    const Real from = m.push() * (now_.dx - before_.dx), to = m.push() * bend_at(now_, force_at_steps_.f);
    if (!(to < 0)) return {};
    return from > 0 ? pace_.h * from / (from - to) : Real(0);
  }
  // Whether a touch begins the stuck regime (M9.9).
  bool joins(const Change& touch) const {
    const Mass& m = masses_[touch.index];
    if (m.wall) return false;
    Whole s = refined_state_at(touch.at);
    const Real w = s.w[touch.index], mass = joined_mass_ + m.nu;
    const Real towards = m.now.x < 0 ? Real(1) : Real(-1);
    s.v += m.nu / mass * w;
    return absolute(w) < Real(*stuck_speed_) &&
           towards * second_of_x(last_step_begin() + touch.at, s, mass) > 0;
  }
  // Keeps the changes of the earliest time; what comes later in the step is found from there.
  void keep_first_changes() {
    const auto time_of = [&](const Change& change) { return double(last_step_begin() + change.at); };
    const Real first = std::ranges::min_element(changes_, {}, &Change::at)->at;
    std::erase_if(changes_, [&](const Change& each) { return time_of(each) > time_of({0, first}); });
    for (Change& each : changes_) each.at = first;
  }
  // Carries out a change. anew: the state at the change, where the motion begins anew there.
  void change_regime(const Change& change, const std::optional<Whole>& anew) {
    const Mass& m = masses_[change.index];
    const Real& at = change.at;
    if (energy_balance_) add_sums();
    const Real y = m.now.x + m.origin_of_q();
    // A step too coarse can lead from one wall through to the other; with `locate` the mass leaves the first
    // wall.
    const bool met = !m.wall || (!anew && !(y >= 0 && y <= m.clearance));
    std::int64_t meeting = met;
    if (anew && &change == &changes_.front()) {  // all of them, or none
      meeting =
          std::ranges::count_if(changes_, [&](const Change& each) { return !masses_[each.index].wall; });
      if (meeting <= budget_.max_impacts - impacts_ && steps_left_ == 0)
        return finish(StopReason::step_budget, at);
    }
    if (meeting > budget_.max_impacts - impacts_) return finish(StopReason::impact_budget, at);
    const Real time = last_step_begin() + at;
    give_samples(time);
    if (!anew && m.wall) leave(change.index, time);
    if (!met) return;
    const Real w = anew ? anew->w[change.index] : m.arc(pace_.h).slope_at(at);
    const Wall wall = y > m.clearance / 2 ? Wall::right : Wall::left;
    ++impacts_;
    tell_impact(double(time), wall, double(w), double(x_arc().at(at)), m.number);
    if (!anew) enter(change.index, wall, time, w);
  }
  // Begins the motion anew at the time of the changes, with the masses that change exactly on their walls.
  void begin_anew(const Real& at, Whole s, bool slows_down) {
    const Real time = last_step_begin() + at;
    if (energy_balance_) close_powers(at);
    std::vector<std::size_t> parted;
    for (const Change& change : changes_) {
      const std::size_t i = change.index;
      const Mass& m = masses_[i];
      const Real place = m.wall == Wall::right ? m.clearance : Real(0);
      s.q[i] = 0;
      if (!m.wall) {
        enter(i, m.wall_ahead(), time, s.w[i]);
      } else {
        if (m.stuck) parted.push_back(i);
        s.q[i] = place;
        leave(i, time);
      }
    }
    if (stuck_speed_) join(time, s);
    if (slows_down) {
      pace_ = small_;
      s = of_scheme(std::move(s), time, pace_.h);
    }
    trend_ = sign(s.v);
    begin_segment(time, s);
    for (const std::size_t i : parted) lead_from_rest(i, -second_of_x(time, s), third_of_y(time, s));
  }
  void enter(std::size_t i, Wall wall, const Real& time, const Real& w) {
    set_wall(i, wall);
    Mass& m = masses_[i];
    m.contact_begin = time;
    steps_at_pace_ = 0;
    if (energy_balance_) {
      m.impact = observer_.energy_balance().impact_loss.size();
      observer_.energy_balance().impact_loss.push_back(0);
    }
    if (joined_mass_ == 1) return;
    // Thrown by this impact, the primary mass meets the masses that are stuck to its other wall. Where that
    // may be as fast as an impact that bounces, these are left to their compliant wall, too.
    if (2 * m.nu / (1 + m.nu) * absolute(w) < Real(*stuck_speed_)) return;
    for (std::size_t other = 0; other < masses_.size(); ++other)
      if (masses_[other].stuck && masses_[other].wall != wall) set_wall(other, masses_[other].wall);
  }
  // Joins the masses that are to join, with their momentum (M17.24), for one damper (M9.10). The energy lost
  // (M9.11) is a loss of the contacts that begin.
  void join(const Real& time, Whole& s) {
    std::vector<std::size_t> joining;
    for (const Change& change : changes_)
      if (change.joins) joining.push_back(change.index);
    if (joining.empty()) return;
    if constexpr (!one) std::ranges::sort(joining);
    const Real before = joined_mass_;
    for (const std::size_t i : joining) set_wall(i, masses_[i].wall, true);
    Real gain = 0;  // of x'
    for (const std::size_t i : joining) {
      Mass& m = masses_[i];
      Real excess = before * s.w[i];
      for (const std::size_t j : joining) excess += masses_[j].nu * (s.w[i] - s.w[j]);
      if (energy_balance_) m.work += m.nu / joined_mass_ * s.w[i] * excess / 2;
      gain += m.nu / joined_mass_ * s.w[i];
    }
    half_cycles_.peak(half_cycles_.side() * s.x, time);  // x' may change its sign by the gain
    s.v += gain;
    for (std::size_t i = 0; i < masses_.size(); ++i)
      s.w[i] = masses_[i].stuck ? Real(0) : Real(s.w[i] - gain);
  }
  void leave(std::size_t i, const Real& time) {
    Mass& m = masses_[i];
    tell_contact(double(m.contact_begin), double(time), *m.wall, m.number);
    if (energy_balance_) {
      EnergyBalance& balance = observer_.energy_balance();
      if (m.impact) balance.impact_loss[*m.impact] = double(m.work);
      (m.impact ? m.impact_loss : m.contact_loss) += m.work;
      m.loss += m.work;
    }
    m.impact.reset();
    m.work = 0;
    set_wall(i, {});
    steps_at_pace_ = 0;
  }

  // Completes a half cycle at a zero of x in the last step. span: the part of the step that counts.
  void cross_zero(const Real& at, const Real& span) {
    if (energy_balance_) energy(state_at(at));
    half_cycles_.crossing(last_step_begin() + at, observer_);
    trend_ = sign(now_.dx);
    consider_peak(at, span);  // x' may have changed its sign after x did
    if (until_amplitude_ && half_cycles_.last_amplitude() < Real(*until_amplitude_))
      return finish(StopReason::amplitude, at);
    if (half_cycles_.complete() >= budget_.max_half_cycles) finish(StopReason::half_cycle_budget, at);
  }
  void consider_peak(const Real& from, const Real& to) {
    const Arc<Real> x = x_arc();
    const Real at = x.extremum(from, to);
    half_cycles_.peak(half_cycles_.side() * x.at(at), last_step_begin() + at);
  }
  void give_samples(const Real& until) {  // those in the last step
    for (;;) {
      const double time = observer_.next_sample();
      if (!(time <= until && step_of(time) <= step_)) return;
      tell_sample(time, motion_at(Real(time) - last_step_begin()));
    }
  }
  // Calls the observer's functions for a list or, where the scene has none, for one damper.
  void tell_impact(double time, Wall wall, double w, double x, std::int32_t number) {
    if constexpr (DampersObserver<Observer>) {
      if (is_list_) return observer_.impact(time, wall, w, x, number);
    }
    if constexpr (one) observer_.impact(time, wall, w, x);
  }
  void tell_contact(double begin, double end, Wall wall, std::int32_t number) {
    if (!observer_.wants_contacts()) return;
    if constexpr (DampersObserver<Observer>) {
      if (is_list_) return observer_.contact(begin, end, wall, number);
    }
    if constexpr (one) observer_.contact(begin, end, wall);
  }
  void tell_sample(double time, const Whole& s) {
    if constexpr (DampersObserver<Observer>) {
      if (is_list_) {
        for (std::size_t i = 0; i < masses_.size(); ++i)
          places_[masses_[i].number] = {double(y(s, i)), double(s.w[i])};
        return observer_.sample(time, double(s.x), double(s.v), places_);
      }
    }
    if constexpr (one) observer_.sample(time, double(s.x), double(s.v), double(y(s, 0)), double(s.w[0]));
  }
  void finish(StopReason reason, const Real& at, bool by_horizon = false) {
    const Real time = by_horizon ? end_time_ : last_step_begin() + at;
    give_samples(time);
    if (energy_balance_) {
      const Whole s = motion_at(at);
      close_powers(at);
      observer_.energy_balance().final = energy(s);
      for (std::size_t i = 0; i < masses_.size(); ++i)
        energy_[masses_[i].number].final_kinetic = kinetic(s, i);
    }
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (masses_[i].wall) leave(i, time);
    if (energy_balance_) {
      EnergyBalance& balance = observer_.energy_balance();
      balance.viscous_work = double(viscous_work_);
      balance.forcing_work = double(forcing_work_);
      const double largest = std::max(largest_energy_, std::abs(balance.forcing_work));
      Real contact_loss = 0, losses = 0;
      for (const Mass& m : masses_) {
        energy_[m.number].impact_loss = double(m.impact_loss);
        energy_[m.number].contact_loss = double(m.contact_loss);
        contact_loss += m.contact_loss;
        losses += m.loss;
      }
      balance.contact_loss = double(contact_loss);
      const Real open =
          (balance.initial.total() + forcing_work_) - (balance.final.total() + losses + viscous_work_);
      balance.residual = largest > 0 ? double(open) / largest : 0.0;
      if (is_list_) balance.dampers = energy_;
    }
    end_ = Outcome{reason, double(time)};
  }

  double kinetic(const Whole& s, std::size_t i) const {
    const Real z1 = s.v + s.w[i];
    return double(Real(masses_[i].nu * z1 * z1 / 2));
  }
  Energy energy(const Whole& s) {
    Real kinetic = s.v * s.v, paper = kinetic, wall = 0;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Mass& m = masses_[i];
      const Real &w = s.w[i], z1 = s.v + w;
      kinetic += m.nu * z1 * z1;
      paper += m.nu * (s.v * s.v + w * w);
      if (m.wall) wall += m.k * s.q[i] * s.q[i];
    }
    const Energy energy{double(Real(kinetic / 2)), double(Real(s.x * s.x / 2)), double(Real(wall / 2)),
                        double(Real((paper + s.x * s.x) / 2))};
    largest_energy_ = std::max(largest_energy_, energy.total());
    return energy;
  }
  // The energy balance's integrals are trapezoids over the steps: the loop adds whole powers, this function
  // the ends.
  void add_powers(const Real& weight, const Real& time, const Whole& s) {
    viscous_work_ += weight * 2 * zeta_ * s.v * s.v;
    forcing_work_ += weight * forcing(time) * s.v;
    for (const std::size_t i : in_contact_) {
      Mass& m = masses_[i];
      m.work += weight * m.nu * m.c * s.w[i] * s.w[i];
    }
  }
  void add_sums() {
    viscous_work_ += zeta_ * sums_.vv / (2 * pace_.h);
    forcing_work_ += sums_.fv / 2;
    sums_ = {};
    for (const std::size_t i : in_contact_) {
      Mass& m = masses_[i];
      m.work += m.nu * m.c * m.sum_ww / (4 * pace_.h);
      m.sum_ww = 0;
    }
  }
  void close_powers(const Real& at) {
    add_sums();
    add_powers((at - pace_.h) / 2, last_step_begin(), state_at(Real(0)));
    add_powers(at / 2, last_step_begin() + at, state_at(at));
  }

  // With two rates (cem_rates.hpp): chooses the pace of the next steps, and returns the number of steps for
  // which it is right.
  std::int64_t choose_pace() {
    if (in_contact_.empty()) {
      // A segment's first step shows what its motion is.
      return step_ == 0 ? 1 : choose_pace_without_contact();
    }
    // A contact begins in small steps.
    const bool small = pace_.h == small_.h;
    std::int64_t begun = 0;
    for (const std::size_t i : in_contact_)
      if (step_ == 0 || last_step_end() - masses_[i].contact_begin < small_.h)
        begun = std::max(begun, masses_[i].steps_of_contact);
    if (step_ == 0) return small ? begun : 1;
    return begun > 0 && small ? begun : choose_pace_in_contact();
  }
  std::int64_t choose_pace_without_contact() {
    constexpr int many = 16, few = 4;
    const Real h = pace_.h, time = last_step_end(), large = rates_->large.h;
    const Whole s =
        joined_mass_ > 1
            ? motion_at(h)
            : flown({now_.x, now_.dx / h, of_each([&](std::size_t i) { return masses_[i].now.x; }),
                     of_each([&](std::size_t i) { return masses_[i].now.dx / h; })},
                    time, h);
    int steps = many;
    const Real free = free_time(s, large, steps);
    const Real step = steps > 0 ? large : multiple_of(small_.h, free);
    if (!(steps > 0 || step >= few * small_.h)) {
      change_pace(small_, s);
      return few;
    }
    change_pace(steps > 0 ? rates_->large : pace_of(step), s);
    return std::max(steps, 1);
  }
  // Takes long steps once the masses in contact follow (M17.23), q_pressed and w_pressed, and none is about
  // to leave its wall.
  std::int64_t choose_pace_in_contact() {
    const Real time = last_step_end(), mass = mass_with_walls();
    const Whole s = motion_at(pace_.h);
    const Real bend = second_as_one(time, s, mass);
    const Real jerk = (forcing_rate(time) - 2 * zeta_ * bend - s.v) / mass;
    const Real many = 64;
    Real least = many;
    std::int64_t longest = 0;
    bool settled = true;
    for (const std::size_t i : in_contact_) {
      const Mass& m = masses_[i];
      const Real w_pressed = -jerk / m.omega_2, q_pressed = -(bend + m.c * w_pressed) / m.omega_2;
      const Real q = s.q[i], dq = q - q_pressed, dw = s.w[i] - w_pressed;
      const Real tolerance = m.omega_2 * small_.h * small_.h * q_pressed;
      settled = settled && dw * dw + m.omega_2 * dq * dq <= m.omega_2 * tolerance * tolerance;
      // Half of the steps that lead out of the wall at this speed.
      const Real overlap = -m.push() * q, per_step = 2 * m.push() * s.w[i] * rates_->pressed.h;
      const Real steps = overlap > many * per_step ? many : overlap / per_step;
      settled = settled && steps >= 1;
      least = std::min(least, steps);
      longest = std::max(longest, m.steps_of_contact);
    }
    int steps = settled ? int(double(least)) : 0;
    free_time(s, rates_->pressed.h, steps);
    if (steps > 0) {
      change_pace(rates_->pressed, s);
      return steps;
    }
    change_pace(small_, s);
    return longest;
  }
  // Halves `steps` of h until no mass in flight can meet a wall in them. Returns the part of h in which none
  // does, which is of use where not even one step is free.
  Real free_time(const Whole& s, const Real& h, int& steps) const {
    const Real bend = second_as_one(last_step_end(), s, joined_mass_), horizon = steps * h;
    Real free = h;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (masses_[i].wall) continue;
      const Certificate<Real> sure(zeta_, force_, {s.x, s.v, s.q[i], s.w[i]}, bend, h, horizon,
                                   masses_[i].clearance, joined_mass_);
      while (steps > 0 && !sure.free_for(steps * h)) steps /= 2;
      if (steps == 0) free = std::min(free, sure.free_time(h));
    }
    return free;
  }
  // Changes the pace from the last step on, with the motion's own state there.
  void change_pace(const Pace& pace, Whole s) {
    const Real h = pace_.h, time = last_step_end();
    if (pace.h == h) return;
    if (energy_balance_) close_powers(h);
    consider_peak(step_ == 1 ? Real(0) : -h / 2, h);
    trend_ = sign(s.v);
    pace_ = pace;
    begin_segment(time, of_scheme(std::move(s), time, pace.h));
  }
  OwnVelocity<Real> own_velocity() const { return {zeta_, force_, 1 / mass_with_walls()}; }
  // Sets x' to v, and keeps x' + y' of masses in flight.
  void set_velocity(Whole& s, const Real& v) const {
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (!masses_[i].wall) s.w[i] += s.v - v;
    s.v = v;
  }
  // Returns the scheme's state, with v_n, for the motion's own, with V.
  Whole of_scheme(Whole s, const Real& time, const Real& h) const {
    set_velocity(s, own_velocity().to_scheme(s.x, s.v, time, h));
    return s;
  }
  // Returns the motion's own state where all fly, at the end of a step h, from the velocities in the middle
  // of it.
  Whole flown(Whole s, const Real& time, const Real& h) const {
    const Real v = (s.v + h / 2 * (forcing(time) - s.x)) / (1 + h * zeta_);
    const Real own = own_velocity().from_scheme(s.x, v, time, h);
    for (Real& w : s.w) w = s.v + w - own;
    s.v = own;
    return s;
  }
  // Returns the motion's own state at a time in the last step. In flight, where the step may be long, it is
  // that of a step that ends there.
  Whole motion_at(const Real& at) const {
    if (!rates_) return state_at(at);
    const Real begin = last_step_begin(), time = begin + at;
    if (joined_mass_ > 1 || !in_contact_.empty()) {
      Whole s = refined_state_at(at);
      set_velocity(s, own_velocity().from_scheme(s.x, s.v, time, pace_.h));
      return s;
    }
    Whole s = state_at(Real(0));
    set_velocity(s, own_velocity().from_scheme(s.x, s.v, begin, pace_.h));
    s = of_scheme(std::move(s), begin, at);
    const Real bend = second_of_x(begin, s);
    s.v += at * bend / 2;
    s.x += at * s.v;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      s.w[i] -= at * bend / 2;
      s.q[i] += at * s.w[i];
    }
    return flown(std::move(s), time, at);
  }
  Pace pace_of(const Real& h) const {
    if constexpr (one) {
      const Mass& m = masses_[0];
      const Damper damper = centred_ ? Damper::centred : Damper::lagged;
      return {h, cem_step<Real>({m.nu, zeta_, 0, 0}, damper, h),
              cem_step<Real>({m.nu, zeta_, m.c, m.omega_2}, damper, h), cem_step_stuck(m.nu, zeta_, h)};
    } else {
      return {h};
    }
  }

  const Budget budget_;
  const std::optional<double> until_amplitude_;
  const Outcome horizon_;  // the end, if nothing else ends the run before
  const Real end_time_;    // of horizon_
  const bool centred_, locate_;
  const std::optional<double> stuck_speed_;
  Observer& observer_;
  const Real zeta_;
  const Forcing<Real> force_;
  const bool energy_balance_, is_list_;

  ForEach<Mass> masses_;  // in the order of damper_order.hpp
  std::vector<std::size_t> in_contact_;
  Real joined_mass_ = 1;             // the primary mass and those stuck to it, divided by the first
  Real least_bend_{}, most_bend_{};  // limits of x'' while these stay stuck
  Whole start_;

  Pace small_;                            // the time step
  std::optional<Rates> rates_;            // the larger steps, where there are any
  Pace pace_;                             // of the steps since origin_
  CemStep<Real> step_of_x_{};             // for a list, by (M17.10)
  Moment before_{}, now_{};               // x before and after the last step
  Real origin_ = 0;                       // time of step 0
  std::int64_t step_ = 0;                 // number of now_
  std::int64_t steps_left_, looks_left_;  // left of max_steps; left for spend_look()
  std::int64_t steps_at_pace_ = 0;        // with two rates: left until the pace is chosen anew
  ForceAtSteps<Real> force_at_steps_;
  Real trend_ = 0;  // sign of x' since the last turning point
  HalfCycleTracker<Real> half_cycles_;
  std::int64_t impacts_ = 0;
  std::vector<Change> changes_;
  // Sums over steps not yet in the works below, of (2 h v)^2 and f (2 h v), v centred.
  struct Sums {
    Real vv = 0, fv = 0;
  } sums_;
  Real viscous_work_ = 0, forcing_work_ = 0;
  double largest_energy_ = 0;
  std::vector<DamperEnergy> energy_;  // by number in the scene
  std::vector<PlaceInCavity> places_;
  std::optional<Outcome> end_;
};

template <class Real, class Observer, template <class> class ForEach>
CemEngine<Real, Observer, ForEach>::CemEngine(const Scene& scene, const Cem& options, Observer& observer)
    : budget_(options.budget),
      until_amplitude_(scene.until_amplitude),
      horizon_(horizon_of(scene, options.budget)),
      end_time_(horizon_.end_time),
      centred_(options.damper == Damper::centred),
      locate_(options.locate),
      stuck_speed_(options.stuck_speed),
      observer_(observer),
      zeta_(scene.damping_ratio),
      force_{Real(scene.force_amplitude), Real(scene.force_frequency)},
      energy_balance_(observer.wants_energy()),
      is_list_(!has_one_damper(scene)),
      start_{scene.x0, scene.v0, {}, {}},
      steps_left_(options.max_steps),
      looks_left_(std::max<std::int64_t>(options.max_steps / 32, 10'000'000)),
      half_cycles_(Real(scene.x0)) {
  const Real h = *options.time_step;
  const std::size_t count = scene.dampers.size();
  if constexpr (!one) {
    masses_.resize(count);
    start_.q.resize(count);
    start_.w.resize(count);
  }
  energy_.resize(count);
  places_.resize(count);
  const auto keep = [&](std::size_t place, std::int32_t number) {
    const SceneDamper& its = scene.dampers[number];
    const auto wall = regime_equations<Real>(scene, its, options.calibration, Regime::contact);
    masses_[place] = {number,
                      wall.nu,
                      its.wall_stiffness,
                      its.clearance,
                      wall.c,
                      wall.omega_2,
                      whole_steps(nominal_contact_time(its) / double(h))};
    start_.q[place] = its.y0;
    start_.w[place] = its.w0;
  };
  if constexpr (one) {
    keep(0, 0);  // a sort of one is a sixtieth of the packed module for browsers
  } else {
    std::size_t place = 0;
    for (const std::int32_t number : damper_order(scene.dampers)) keep(place++, number);
  }
  small_ = pace_ = pace_of(h);
  if (options.large_step) {
    const Real large = multiple_of(h, Real(*options.large_step));
    const Real pressed = stability_limit(scene, options.damper, options.calibration) / 2;
    rates_ = Rates{pace_of(large), pace_of(multiple_of(h, std::clamp(pressed, h, large)))};
  }

  const auto begin_contact = [&](std::size_t i, std::optional<Wall> wall, bool stuck = false) {
    set_wall(i, wall, stuck);
    start_.q[i] -= masses_[i].origin_of_q();
  };
  // Contacts at the beginning, which no impact begins. First the masses that overlap a wall. Then those at
  // rest at a wall and pressed to it, as y'' decides, or y''' where that is zero to rounding: by where y is a
  // step later, y'' h^2/2 + y''' h^3/6. In the stuck regime, where both are zero to rounding, the first later
  // derivative that is not decides; else the first step does.
  const ForEach<Real> y0 = start_.q;
  bool impact_at_once = false;
  for (std::size_t i = 0; i < count; ++i) {
    const Real &c = masses_[i].clearance, &w = start_.w[i];
    begin_contact(i, y0[i] < 0   ? std::optional(Wall::left)
                     : y0[i] > c ? std::optional(Wall::right)
                                 : std::nullopt);
    impact_at_once = impact_at_once || (y0[i] == 0 && w < 0) || (y0[i] == c && w > 0);
  }
  const auto rests = [&](std::size_t i) {
    return (y0[i] == 0 || y0[i] == masses_[i].clearance) && start_.w[i] == 0;
  };
  const Real bend = -second_of_x(Real(0), start_);  // y''
  const Real jerk = start_.v - force_.amplitude * force_.frequency;
  const Lead<Real> lead =
      lead_of_x(Real(2 * zeta_), Real(1), force_, force_.phase(Real(0)), start_.x, start_.v);
  const bool by_lead = stuck_speed_ && lead.order > 3 && in_contact_.empty();
  const Real moves = by_lead ? Real(-lead.value) : Real(bend + h / 3 * jerk);
  for (std::size_t i = 0; i < count; ++i) {
    if (!rests(i)) continue;
    if (y0[i] == 0 && moves < 0) begin_contact(i, Wall::left, stuck_speed_.has_value());
    if (y0[i] > 0 && moves > 0) begin_contact(i, Wall::right, stuck_speed_.has_value());
  }
  begin_segment(Real(0), start_);
  for (std::size_t i = 0; i < count; ++i)
    if (rests(i) && !masses_[i].stuck) lead_from_rest(i, bend, jerk);
  // A force moves a primary mass at rest in the middle by x''' h^3/6, which the second-order start leaves
  // out, too. It is added, unless an impact moves the mass.
  const bool moved_by_force = start_.x == 0 && start_.v == 0 && bend == 0 && !impact_at_once;
  if (moved_by_force) now_.dx += h * h * h * force_.amplitude * force_.frequency / 6 / joined_mass_;

  half_cycles_.take_side(sign(start_.x != 0 ? start_.x : start_.v));
  trend_ = sign(start_.v);
}

}  // namespace impact_damper
