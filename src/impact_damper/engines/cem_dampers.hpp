// The component element method for several dampers on one primary mass (docs/mathematics.md, 17.5): cem.hpp
// with a sum over the walls. Each secondary mass is in flight or in contact by itself, and only x couples
// them, so that a step solves for x first and then for each q (M17.10). Contact, `locate`, observations,
// segments and energy balance are those of cem.hpp; there is no stuck regime.
//
// Two rates: steps of up to H where no secondary mass is in contact or can meet a wall (cem_rates.hpp). While
// one is in contact, pressed or not, the steps are small.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "impact_damper/engines/cem.hpp"
#include "impact_damper/engines/damper_order.hpp"
#include "impact_damper/engines/half_cycle_tracker.hpp"

namespace impact_damper {

template <class Real, class Observer>
class CemOfDampers {
 public:
  // `options` resolved and free of problems.
  CemOfDampers(const Scene& scene, const Cem& options, Observer& observer);

  Outcome run() {
    if (energy_balance_) {
      observer_.energy_balance().initial = energy(start_);
      for (std::size_t i = 0; i < masses_.size(); ++i)
        energy_[masses_[i].number].initial_kinetic = kinetic(start_, i);
    }
    if (observer_.next_sample() <= 0) tell_sample(0, start_);
    while (!end_) {
      if (large_h_ && steps_at_pace_ == 0) {
        steps_at_pace_ = choose_pace();
        spend_look();
      }
      const bool at_rest = !force_ && in_contact_.empty() && now_.x == 0 && now_.dx == 0;
      const bool unknown = (half_cycles_.side() == 0 || trend_ == 0) && !at_rest;
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
    Real nu, clearance;
    Real c, omega_2;             // of its wall, whether or not it is there
    std::optional<Wall> wall{};  // in contact with it
    Moment before{}, now{};
    // dq_{n+1} = dq_dq dq_n + dq_q q_n + dq_dx (dx_n - dx_{n+1}), dx_{n+1} = ... + dx_dq dq_n + dx_q q_n.
    Real dq_dq = 1, dq_q = 0, dq_dx = 1, dx_dq = 0, dx_q = 0;
    Real least{}, most{};  // q while nothing changes
    Real contact_begin = 0;
    std::optional<std::size_t> impact{};  // that began the contact
    Real work = 0, sum_ww = 0;            // of the wall's damper in it; of (2 h w)^2 over steps not yet in it
    Real impact_loss = 0, contact_loss = 0;  // of the contacts before

    Real origin_of_q() const { return wall == Wall::right ? clearance : Real(0); }
    Arc<Real> arc(const Real& h) const { return arc_of(before, now, h); }
  };
  // The state of all: x and x', and q and q' of each secondary mass.
  struct Whole {
    Real x, v;
    std::vector<Real> q, w;
  };
  struct Change {
    std::size_t index;
    Real at;
  };
  static Arc<Real> arc_of(const Moment& before, const Moment& now, const Real& h) {
    return {before.x, (before.dx + now.dx) / (2 * h), (now.dx - before.dx) / (h * h)};
  }
  static Real sign(const Real& value) { return Real((value > 0) - (value < 0)); }

  Real last_step_begin() const { return origin_ + Real(step_ - 1) * h_; }
  Real last_step_end() const { return origin_ + Real(step_) * h_; }
  std::int64_t step_of(const Real& time) const { return whole_steps(double((time - origin_) / h_)); }
  Arc<Real> x_arc() const { return arc_of(before_, now_, h_); }
  Real y(const Whole& s, std::size_t i) const { return masses_[i].origin_of_q() + s.q[i]; }

  Real wall_force(const Whole& s, std::size_t i) const {  // divided by the secondary mass
    const Mass& m = masses_[i];
    return m.wall ? m.c * s.w[i] + m.omega_2 * s.q[i] : Real(0);
  }
  Real acceleration(const Real& time, const Whole& s) const {  // x'', (M17.9)
    Real force = value_of(force_, time);
    for (const std::size_t i : in_contact_) force += masses_[i].nu * wall_force(s, i);
    return force - (2 * zeta_ * s.v + s.x);
  }

  // In the last step, which spans [0, h].
  Whole state_at(const Real& at) const {
    const Arc<Real> x = x_arc();
    Whole s{x.at(at), x.slope_at(at), {}, {}};
    for (const Mass& m : masses_) {
      const Arc<Real> q = m.arc(h_);
      s.q.push_back(q.at(at));
      s.w.push_back(q.slope_at(at));
    }
    return s;
  }
  // The same with the velocities by the trapezoid of the accelerations.
  Whole refined_state_at(const Real& at) const {
    Whole s = state_at(at);
    const Real bend = acceleration(last_step_begin() + at, s);
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Arc<Real> q = masses_[i].arc(h_);
      s.w[i] = q.slope + at * (q.bend - (wall_force(s, i) + bend)) / 2;
    }
    s.v = x_arc().slope + at * (x_arc().bend + bend) / 2;
    return s;
  }

  void begin_segment(const Real& time, const Whole& s) {
    const Real bend = acceleration(time, s);
    now_ = {s.x, h_ * (s.v - h_ * bend / 2)};
    for (std::size_t i = 0; i < masses_.size(); ++i)
      masses_[i].now = {s.q[i], h_ * (s.w[i] + h_ * (wall_force(s, i) + bend) / 2)};
    origin_ = time;
    step_ = 0;
    if (energy_balance_) add_powers(-h_ / 2, time, s, time);
    renew_step();
  }
  // The step's coefficients (M17.10), for h and those that are in contact.
  void renew_step() {
    const Real outer = h_ * zeta_, h_2 = h_ * h_;
    const auto ahead = [&](const Mass& m) { return centred_ ? h_ * m.c / 2 : Real(0); };
    Real determinant = 1 + outer;
    for (const std::size_t i : in_contact_)
      determinant += masses_[i].nu * (ahead(masses_[i]) / (1 + ahead(masses_[i])));
    const Real xx = 1 / determinant;
    dx_dx_ = xx * (1 - outer);
    dx_x_ = -h_2 * xx;
    dx_f_ = h_2 * xx;
    for (const std::size_t i : in_contact_) {
      Mass& m = masses_[i];
      const Real behind = centred_ ? h_ * m.c / 2 : h_ * m.c, spring = h_2 * m.omega_2;
      m.dq_dx = 1 / (1 + ahead(m));
      m.dq_dq = m.dq_dx * (1 - behind);
      m.dq_q = -m.dq_dx * spring;
      const Real xq = xx * m.nu * (ahead(m) * m.dq_dx);
      dx_dx_ += xq;
      m.dx_dq = xx * m.nu * behind + xq * (1 - behind);
      m.dx_q = spring * (xx * m.nu - xq);
    }
  }
  // To a wall or into flight, with the same y.
  void set_wall(std::size_t i, std::optional<Wall> wall) {
    Mass& m = masses_[i];
    constexpr Real smallest = std::numeric_limits<Real>::denorm_min();
    constexpr Real infinity = std::numeric_limits<Real>::infinity();
    const Real old_origin = m.origin_of_q();
    m.wall = wall;
    m.before.x += old_origin - m.origin_of_q();
    m.now.x += old_origin - m.origin_of_q();
    if (!wall) m.dq_dq = m.dq_dx = 1, m.dq_q = m.dx_dq = m.dx_q = 0;
    m.least = !wall ? Real(0) : wall == Wall::left ? -infinity : smallest;
    m.most = !wall ? m.clearance : wall == Wall::left ? -smallest : infinity;
    std::erase(in_contact_, i);
    if (wall) in_contact_.insert(std::ranges::lower_bound(in_contact_, i), i);
  }

  void spend_look() {  // as CemEngine
    if (--looks_left_ < 0) steps_left_ = std::min<std::int64_t>(steps_left_, 1);
  }
  std::int64_t steps_until_look() const {
    const Real sample = observer_.next_sample();
    std::int64_t steps = std::min(step_of(sample < end_time_ ? sample : end_time_) - step_, steps_left_);
    if (large_h_) steps = std::min(steps, steps_at_pace_);
    return std::max<std::int64_t>(steps, 1);
  }
  // Steps until a wall is met or left, x changes its sign or x' its own, or `most` are done.
  void take_steps(std::int64_t most) {
    const bool forced = bool(force_);
    const Real side = half_cycles_.side(), trend = trend_, dx_dx = dx_dx_, dx_x = dx_x_;
    const std::int64_t from = step_;
    Real x = now_.x, dx = now_.dx, last_x, last_dx;
    bool uneventful;
    do {
      if ((forced || energy_balance_) && step_ % ForceAtSteps<Real>::block == 0) {
        add_sums();
        if (forced) force_at_steps_ = {force_, origin_ + Real(step_) * h_, h_};
      }
      last_x = x;
      last_dx = dx;
      dx = dx_dx * last_dx + dx_x * x;
      for (const std::size_t i : in_contact_)
        dx += masses_[i].dx_dq * masses_[i].now.dx + masses_[i].dx_q * masses_[i].now.x;
      if (forced) dx += dx_f_ * force_at_steps_.f;
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
      ++step_;
    } while (uneventful && --most > 0);
    before_ = {last_x, last_dx};
    now_ = {x, dx};
    steps_left_ -= step_ - from;
    if (large_h_) steps_at_pace_ -= step_ - from;
  }

  void look_at_last_step() {
    const Real begin = last_step_begin();
    const bool last = step_ >= step_of(end_time_);
    const auto too_late = [&](const Real& at) { return begin + at > end_time_; };
    const Real side = half_cycles_.side();
    const bool crosses = side * now_.x < 0, turns = trend_ * now_.dx < 0;
    const bool changes = find_changes();
    if (changes || crosses || turns) spend_look();
    std::erase_if(changes_, [&](const Change& change) { return too_late(change.at); });

    const bool restart = locate_ && !changes_.empty();
    std::optional<Whole> anew;
    if (restart) {
      keep_first_changes();
      anew = refined_state_at(changes_.front().at);
    }
    const Real span = restart ? changes_.front().at : last ? std::max(end_time_ - begin, Real(0)) : h_;
    std::optional<Real> zero;
    if (crosses) zero = x_arc().times(side).fall(h_);
    if (zero && (too_late(*zero) || (restart && *zero > span))) zero.reset();

    if (turns || restart) consider_peak(turns && step_ > 1 ? -h_ / 2 : Real(0), span);
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
    if (restart) return begin_anew(span, *std::move(anew));
    if (!changes_.empty()) renew_step();
    if (last) return finish(horizon_.stop_reason, span, true);
    if (steps_left_ == 0) return finish(StopReason::step_budget, span);
    give_samples(end_time_);
  }
  // Sets changes_: who came to a wall in the last step, or away from it, and where, in the order of time.
  bool find_changes() {
    changes_.clear();
    bool finite = std::isfinite(double(now_.x));
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Mass& m = masses_[i];
      finite = finite && std::isfinite(double(m.now.x));
      if (m.now.x >= m.least && m.now.x <= m.most) continue;
      const bool falls = m.wall == Wall::right || (!m.wall && m.now.x < 0);
      Arc<Real> gap = m.arc(h_).times(falls ? Real(1) : Real(-1));
      if (!m.wall && !falls) gap.g += m.clearance;
      changes_.push_back({i, gap.fall(h_)});
    }
    if (!finite) fail_of_overflow(double(last_step_begin()), double(h_));
    std::sort(changes_.begin(), changes_.end(), [&](const Change& one, const Change& other) {
      const double at = double(last_step_begin() + one.at), then = double(last_step_begin() + other.at);
      return at < then || (at == then && masses_[one.index].number < masses_[other.index].number);
    });
    return !changes_.empty();
  }
  // Those at the first time; what comes later in the step is found from there.
  void keep_first_changes() {
    const auto time_of = [&](const Change& change) { return double(last_step_begin() + change.at); };
    const Real first = std::ranges::min_element(changes_, {}, &Change::at)->at;
    std::erase_if(changes_, [&](const Change& each) { return time_of(each) > time_of({0, first}); });
    for (Change& each : changes_) each.at = first;
  }
  void change_regime(const Change& change, const std::optional<Whole>& anew) {
    Mass& m = masses_[change.index];
    const Real& at = change.at;
    const Real y = m.now.x + m.origin_of_q();
    const bool met = !m.wall || (!locate_ && !(y >= 0 && y <= m.clearance));
    std::int64_t meeting = met;
    if (locate_ && &change == &changes_.front()) {  // all of them, or none
      meeting =
          std::ranges::count_if(changes_, [&](const Change& each) { return !masses_[each.index].wall; });
      if (meeting <= budget_.max_impacts - impacts_ && steps_left_ == 0)
        return finish(StopReason::step_budget, at);
    }
    if (meeting > budget_.max_impacts - impacts_) return finish(StopReason::impact_budget, at);
    const Real time = last_step_begin() + at;
    give_samples(time);
    if (!locate_ && m.wall) leave(change.index, time);
    if (!met) return;
    const Real w = anew ? anew->w[change.index] : m.arc(h_).slope_at(at);
    const Wall wall = y > m.clearance / 2 ? Wall::right : Wall::left;
    ++impacts_;
    observer_.impact(double(time), wall, double(w), double(x_arc().at(at)), m.number);
    if (!locate_) enter(change.index, wall, time);
  }
  // At the changes' own time: those that change are on their walls exactly.
  void begin_anew(const Real& at, Whole s) {
    const Real time = last_step_begin() + at;
    if (energy_balance_) close_powers(at);
    for (const auto& [i, same] : changes_) {
      const Mass& m = masses_[i];
      s.q[i] = 0;
      if (!m.wall) {
        enter(i, m.now.x > m.clearance / 2 ? Wall::right : Wall::left, time);
      } else {
        if (m.wall == Wall::right) s.q[i] = m.clearance;
        leave(i, time);
      }
    }
    trend_ = sign(s.v);
    begin_segment(time, s);
  }
  void enter(std::size_t i, Wall wall, const Real& time) {
    Mass& m = masses_[i];
    set_wall(i, wall);
    m.contact_begin = time;
    steps_at_pace_ = 0;
    if (!energy_balance_) return;
    m.impact = observer_.energy_balance().impact_loss.size();
    observer_.energy_balance().impact_loss.push_back(0);
  }
  void leave(std::size_t i, const Real& time) {
    Mass& m = masses_[i];
    if (observer_.wants_contacts())
      observer_.contact(double(m.contact_begin), double(time), *m.wall, m.number);
    if (energy_balance_) {
      add_sums();
      if (m.impact) observer_.energy_balance().impact_loss[*m.impact] = double(m.work);
      (m.impact ? m.impact_loss : m.contact_loss) += m.work;
    }
    m.impact.reset();
    m.work = 0;
    set_wall(i, {});
    steps_at_pace_ = 0;
  }
  void cross_zero(const Real& at, const Real& span) {
    if (energy_balance_) energy(state_at(at));
    half_cycles_.crossing(last_step_begin() + at, observer_);
    trend_ = sign(now_.dx);
    consider_peak(at, span);  // should x' have changed its sign after x did
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
  void tell_sample(double time, const Whole& s) {
    for (std::size_t i = 0; i < masses_.size(); ++i)
      places_[masses_[i].number] = {double(y(s, i)), double(s.w[i])};
    observer_.sample(time, double(s.x), double(s.v), places_);
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
        losses += m.impact_loss + m.contact_loss;
      }
      balance.contact_loss = double(contact_loss);
      const Real open =
          (balance.initial.total() + forcing_work_) - (balance.final.total() + losses + viscous_work_);
      balance.residual = largest > 0 ? double(open) / largest : 0.0;
      balance.dampers = energy_;
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
      if (m.wall) wall += m.nu * m.omega_2 * s.q[i] * s.q[i];
    }
    const Energy energy{double(Real(kinetic / 2)), double(Real(s.x * s.x / 2)), double(Real(wall / 2)),
                        double(Real((paper + s.x * s.x) / 2))};
    largest_energy_ = std::max(largest_energy_, energy.total());
    return energy;
  }
  // As in CemEngine, of the walls that are pushed since `since`.
  void add_powers(const Real& weight, const Real& time, const Whole& s, const Real& since) {
    viscous_work_ += weight * 2 * zeta_ * s.v * s.v;
    forcing_work_ += weight * value_of(force_, time) * s.v;
    for (const std::size_t i : in_contact_) {
      Mass& m = masses_[i];
      if (m.contact_begin <= since) m.work += weight * m.nu * m.c * s.w[i] * s.w[i];
    }
  }
  void add_sums() {
    viscous_work_ += zeta_ * sums_.vv / (2 * h_);
    forcing_work_ += sums_.fv / 2;
    sums_ = {};
    for (const std::size_t i : in_contact_) {
      Mass& m = masses_[i];
      m.work += m.nu * m.c * m.sum_ww / (4 * h_);
      m.sum_ww = 0;
    }
  }
  void close_powers(const Real& at) {
    const Real begin = last_step_begin();
    add_sums();
    add_powers((at - h_) / 2, begin, state_at(Real(0)), begin);
    add_powers(at / 2, begin + at, state_at(at), begin);
  }

  // Two rates (cem_rates.hpp).
  OwnVelocity<Real> own_velocity() const { return {zeta_, force_, Real(1)}; }
  std::int64_t choose_pace() {
    constexpr int many = 16, few = 4;
    if (step_ == 0) return 1;  // a segment's first step tells what its motion is
    if (!in_contact_.empty()) {
      if (h_ > small_h_) change_pace(small_h_, refined_state_at(h_));
      return steps_left_;  // until a wall is met or left
    }
    Whole s{now_.x, now_.dx / h_, {}, {}};
    for (const Mass& m : masses_) {
      s.q.push_back(m.now.x);
      s.w.push_back(m.now.dx / h_);
    }
    s = flown(std::move(s), h_, last_step_end());
    const Real bend = acceleration(last_step_end(), s);
    int steps = many;
    Real free = *large_h_;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Certificate<Real> sure(zeta_, force_, {s.x, s.v, s.q[i], s.w[i]}, bend, *large_h_,
                                   many * *large_h_, masses_[i].clearance);
      while (steps > 0 && !sure.free_for(steps * *large_h_)) steps /= 2;
      if (steps == 0) free = std::min(free, sure.free_time(*large_h_));
    }
    const Real step = steps > 0 ? *large_h_ : multiple_of(small_h_, free);
    const bool is_long = step >= few * small_h_;
    change_pace(is_long ? step : small_h_, s);
    return steps > 0 ? steps : is_long ? 1 : few;
  }
  // From the last step on, with the motion's own state there.
  void change_pace(const Real& h, Whole s) {
    if (h == h_) return;
    const Real time = last_step_end();
    if (energy_balance_) close_powers(h_);
    consider_peak(step_ == 1 ? Real(0) : -h_ / 2, h_);
    trend_ = sign(s.v);
    set_own_velocity(s, own_velocity().to_scheme(s.x, s.v, time, h));
    h_ = h;
    begin_segment(time, s);
  }
  // x' anew, with x' + y' kept.
  static void set_own_velocity(Whole& s, const Real& v) {
    for (Real& w : s.w) w += s.v - v;
    s.v = v;
  }
  // The motion's own state in flight at the end of a step h, from the velocities in the middle of it.
  Whole flown(Whole s, const Real& h, const Real& time) const {
    const Real v = (s.v + h / 2 * (value_of(force_, time) - s.x)) / (1 + h * zeta_);
    set_own_velocity(s, own_velocity().from_scheme(s.x, v, time, h));
    return s;
  }
  // Within the last step: in flight, where that may be long, by a step that ends there.
  Whole motion_at(const Real& at) const {
    if (!large_h_ || !in_contact_.empty()) return state_at(at);
    const Real begin = last_step_begin(), time = begin + at;
    Whole s = state_at(Real(0));
    const Real own = own_velocity().from_scheme(s.x, s.v, begin, h_);
    set_own_velocity(s, own_velocity().to_scheme(s.x, own, begin, at));
    const Real bend = acceleration(begin, s);
    s.v += at * bend / 2;
    s.x += at * s.v;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      s.w[i] -= at * bend / 2;
      s.q[i] += at * s.w[i];
    }
    return flown(std::move(s), at, time);
  }

  const Budget budget_;
  const std::optional<double> until_amplitude_;
  const Outcome horizon_;  // if nothing else ends the scene before
  const Real end_time_;    // its
  const bool centred_, locate_;
  Observer& observer_;
  const Real zeta_;
  const Forcing<Real> force_;
  const Real small_h_;
  std::optional<Real> large_h_;
  const bool energy_balance_;

  std::vector<Mass> masses_;  // in the order of damper_order.hpp
  std::vector<std::size_t> in_contact_;
  Whole start_;

  Real h_;  // of the steps since origin_
  Real dx_dx_{}, dx_x_{}, dx_f_{};
  Moment before_{}, now_{};  // of x: the last step went from the one to the other
  Real origin_ = 0;          // time of step 0
  std::int64_t step_ = 0;    // number of now_
  std::int64_t steps_left_, looks_left_;
  std::int64_t steps_at_pace_ = 0;
  ForceAtSteps<Real> force_at_steps_;
  Real trend_ = 0;
  HalfCycleTracker<Real> half_cycles_;
  std::int64_t impacts_ = 0;
  std::vector<Change> changes_;
  struct Sums {
    Real vv = 0, fv = 0;
  } sums_;
  Real viscous_work_ = 0, forcing_work_ = 0;
  double largest_energy_ = 0;
  std::vector<DamperEnergy> energy_;  // by number in the scene
  std::vector<PlaceInCavity> places_;
  std::optional<Outcome> end_;
};

template <class Real, class Observer>
CemOfDampers<Real, Observer>::CemOfDampers(const Scene& scene, const Cem& options, Observer& observer)
    : budget_(options.budget),
      until_amplitude_(scene.until_amplitude),
      horizon_(horizon_of(scene, options.budget)),
      end_time_(horizon_.end_time),
      centred_(options.damper == Damper::centred),
      locate_(options.locate),
      observer_(observer),
      zeta_(scene.damping_ratio),
      force_{Real(scene.force_amplitude), Real(scene.force_frequency)},
      small_h_(options.time_step.value()),
      energy_balance_(observer.wants_energy()),
      start_{scene.x0, scene.v0, {}, {}},
      h_(small_h_),
      steps_left_(options.max_steps),
      looks_left_(std::max<std::int64_t>(options.max_steps / 32, 10'000'000)),
      half_cycles_(Real(scene.x0)),
      energy_(scene.dampers.size()),
      places_(scene.dampers.size()) {
  if (options.large_step) large_h_ = multiple_of(small_h_, Real(*options.large_step));
  for (const std::int32_t number : damper_order(scene.dampers)) {
    const SceneDamper& d = scene.dampers[number];
    const auto wall = regime_equations<Real>(with_alone(scene, d), options.calibration, Regime::contact);
    masses_.push_back({number, wall.nu, d.clearance, wall.c, wall.omega_2});
    start_.q.push_back(d.y0);
    start_.w.push_back(d.w0);
  }
  const auto begin_contact = [&](std::size_t i, std::optional<Wall> wall) {
    set_wall(i, wall);
    start_.q[i] -= masses_[i].origin_of_q();
  };
  // In contact from the beginning, as in CemEngine: first who overlaps, then who rests and is pressed.
  const std::vector<Real> y0 = start_.q;
  bool impact_at_once = false;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const Real &c = masses_[i].clearance, &w = start_.w[i];
    begin_contact(i, y0[i] < 0   ? std::optional(Wall::left)
                     : y0[i] > c ? std::optional(Wall::right)
                                 : std::nullopt);
    impact_at_once = impact_at_once || (y0[i] == 0 && w < 0) || (y0[i] == c && w > 0);
  }
  const Real h = h_, bend = -acceleration(Real(0), start_);
  const Real jerk = start_.v - force_.amplitude * force_.frequency, moves = bend + h / 3 * jerk;
  const auto rests = [&](std::size_t i) {
    return (y0[i] == 0 || y0[i] == masses_[i].clearance) && start_.w[i] == 0;
  };
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    if (!rests(i)) continue;
    if (y0[i] == 0 && moves < 0) begin_contact(i, Wall::left);
    if (y0[i] > 0 && moves > 0) begin_contact(i, Wall::right);
  }
  begin_segment(Real(0), start_);
  const bool leads = 3 * absolute(bend) < h * absolute(jerk);
  for (std::size_t i = 0; i < masses_.size(); ++i)
    if (leads && rests(i)) masses_[i].now.dx += h * h * h * jerk / 6;
  const bool moved_by_force = start_.x == 0 && start_.v == 0 && bend == 0 && !impact_at_once;
  if (moved_by_force) now_.dx += h * h * h * force_.amplitude * force_.frequency / 6;

  half_cycles_.take_side(sign(start_.x != 0 ? start_.x : start_.v));
  trend_ = sign(start_.v);
}

// Runs a scene with a list of dampers for an observer with the members of Recorder. Checks and throws as
// run_cem does.
template <Scalar Real = double, DampersObserver Observer>
Outcome run_cem_dampers(const Scene& scene, const Cem& options, Observer& observer) {
  require_arithmetic();
  const Cem complete = resolved(scene, options);
  require_none(problems_of(scene, complete));
  return CemOfDampers<Real, Observer>(scene, complete, observer).run();
}

}  // namespace impact_damper
