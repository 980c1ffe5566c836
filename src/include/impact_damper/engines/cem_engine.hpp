// The engine of cem.hpp, for one damper and for a list of them (docs/mathematics.md, 9 and 17.5): it takes
// steps, and carries out what happens in the last one. Its parts: the masses and their equations
// (cem_masses.hpp), the steps (cem_steps.hpp), the changes at walls in a step (cem_changes.hpp), the step
// size (cem_rates.hpp), and the energy balance (cem_balance.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "impact_damper/engines/cem_balance.hpp"
#include "impact_damper/engines/cem_changes.hpp"
#include "impact_damper/engines/cem_rates.hpp"
#include "impact_damper/engines/half_cycle_tracker.hpp"
#include "impact_damper/engines/observer.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Calls the observer's functions for a list or, where the scene has none, for one damper.
template <class Observer>
class CemReport {
 public:
  CemReport(Observer& observer, bool is_list, std::size_t dampers)
      : observer_(observer), is_list_(is_list), places_(dampers) {}

  void impact(double time, Wall wall, double w, double x, std::int32_t number) {
    if constexpr (DampersObserver<Observer>) {
      if (is_list_) return observer_.impact(time, wall, w, x, number);
    }
    observer_.impact(time, wall, w, x);
  }
  void contact(double begin, double end, Wall wall, std::int32_t number) {
    if (!observer_.wants_contacts()) return;
    if constexpr (DampersObserver<Observer>) {
      if (is_list_) return observer_.contact(begin, end, wall, number);
    }
    observer_.contact(begin, end, wall);
  }
  template <class Masses>
  void sample(double time, const Masses& masses, const typename Masses::State& s) {
    if constexpr (DampersObserver<Observer>) {
      if (is_list_) {
        for (std::size_t i = 0; i < masses.size(); ++i)
          places_[masses[i].number] = {double(masses.y(s, i)), double(s.w[i])};
        return observer_.sample(time, double(s.x), double(s.v), places_);
      }
    }
    observer_.sample(time, double(s.x), double(s.v), double(masses.y(s, 0)), double(s.w[0]));
  }

 private:
  Observer& observer_;
  const bool is_list_;
  std::vector<PlaceInCavity> places_;
};

template <class Real, class Observer, template <class> class ForEach>
class CemEngine {
  using Masses = CemMasses<Real, ForEach>;
  using State = typename Masses::State;
  using Change = CemChange<Real>;

 public:
  // options: resolved and free of problems. ForOne takes a scene of one damper without components, ForSeveral
  // any scene.
  CemEngine(const Scene& scene, const Cem& options, Observer& observer)
      : budget_(options.budget),
        until_amplitude_(scene.until_amplitude),
        horizon_(horizon_of(scene, options.budget)),
        end_time_(horizon_.end_time),
        locate_(options.locate),
        joins_(options.stuck_speed.has_value()),
        is_list_(!has_one_damper(scene)),
        observer_(observer),
        report_(observer, is_list_, scene.dampers.size()),
        masses_(scene, options),
        steps_(masses_, options.damper, observer.wants_energy()),
        rates_(masses_, steps_, scene, options),
        changes_(masses_, steps_, options.stuck_speed),
        balance_(masses_, steps_, observer.wants_energy() ? &observer.energy_balance() : nullptr),
        steps_left_(options.max_steps),
        looks_left_(std::max<std::int64_t>(options.max_steps / 32, 10'000'000)),
        half_cycles_(Real(scene.x0)),
        release_{scene.x0, scene.v0,
                 masses_.of_each([&](std::size_t i) { return Real(scene.dampers[masses_[i].number].y0); }),
                 masses_.of_each([&](std::size_t i) { return Real(scene.dampers[masses_[i].number].w0); })} {
    steps_.set_pace(rates_.small());
  }

  Outcome run() {
    begin(release_);
    while (!end_) {
      if (rates_ && steps_at_pace_ == 0) {
        steps_at_pace_ = rates_.choose([&](const auto& pace, const State& s) { change_pace(pace, s); });
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
  static Real sign(const Real& value) { return Real((value > 0) - (value < 0)); }

  // Begins the run in the state s, with y instead of q.
  void begin(State s) {
    const auto [second, third] = masses_.begin_contacts(s, steps_.h(), joins_);
    if (masses_.has_components()) masses_.hold(Real(0), s, {});
    begin_segment(Real(0), s);
    const Real second_of_x = masses_.second_of_x(Real(0), s);
    bool impact_at_once = false;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (masses_.rests(s, i) && !masses_[i].stuck)
        steps_.lead_from_rest(i, masses_.has_components() ? masses_.second_of_q(s, i, second_of_x) : second,
                              third);
      impact_at_once = impact_at_once || masses_.meets_wall(s, i);
    }
    // A force moves a primary mass at rest in the middle by x''' h^3/6, which the second-order start leaves
    // out, too. It is added, unless an impact moves the mass.
    const bool moved_by_force =
        s.x == 0 && s.v == 0 && (masses_.has_components() ? second_of_x : second) == 0 && !impact_at_once;
    if (moved_by_force) steps_.lead_x_by(masses_.force.amplitude * masses_.force.frequency);

    half_cycles_.take_side(sign(s.x != 0 ? s.x : s.v));
    trend_ = sign(s.v);
    balance_.begin(s);
    if (observer_.next_sample() <= 0) report_.sample(0, masses_, s);
  }
  void begin_segment(const Real& time, const State& s) {
    balance_.open(time, s);
    steps_.begin_segment(time, s);
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
    const bool at_rest = !masses_.force && masses_.coupled.empty() && !(masses_.joined > 1) &&
                         !steps_.is_pushed() && steps_.x().x == 0 && steps_.x().dx == 0;
    return (half_cycles_.side() == 0 || trend_ == 0) && !at_rest;
  }
  std::int64_t steps_until_look() const {  // at least one
    const Real sample = observer_.next_sample();
    const Real until = sample < end_time_ ? sample : end_time_;
    std::int64_t steps = std::min(steps_.step_of(until) - steps_.number(), steps_left_);
    if (rates_) steps = std::min(steps, steps_at_pace_);
    return std::max<std::int64_t>(steps, 1);
  }
  void take_steps(std::int64_t most) {
    if (steps_.begins_block()) balance_.add_sums();
    const std::int64_t from = steps_.number();
    steps_.take(most, half_cycles_.side(), trend_);
    const std::int64_t taken = steps_.number() - from;
    steps_left_ -= taken;
    if (rates_) steps_at_pace_ -= taken;
  }
  // Changes the pace from the last step on, with the motion's own state there.
  void change_pace(const CemPace<Real>& pace, const State& s) {
    const Real h = steps_.h(), time = steps_.end();
    if (pace.h == h) return;
    balance_.close(h);
    consider_peak(steps_.number() == 1 ? Real(0) : -h / 2, h);
    trend_ = sign(s.v);
    steps_.set_pace(pace);
    begin_segment(time, rates_.of_scheme(s, time, pace.h));
  }

  void look_at_last_step() {
    const Real begin = steps_.begin(), h = steps_.h(), side = half_cycles_.side();
    const bool last = steps_.number() >= steps_.step_of(end_time_);
    const bool crosses = side * steps_.x().x < 0, turns = trend_ * steps_.x().dx < 0;
    changes_.find();
    if (!changes_.all().empty() || crosses || turns) spend_look();
    changes_.erase_after(end_time_);

    // Where masses join or part, the motion begins anew, with or without `locate`.
    bool restart = locate_ && !changes_.all().empty();
    if ((joins_ || masses_.has_components()) && changes_.find_joining()) restart = true;
    bool slows_down = false;
    std::optional<State> anew;
    if (restart) {
      changes_.keep_first();
      slows_down = rates_ && std::ranges::any_of(changes_.all(), [&](const Change& each) {
                     const auto& m = masses_[each.index];
                     return m.stuck || (!m.wall && h > rates_.small().h);
                   });
      const Real& at = changes_.all().front().at;
      anew = slows_down ? rates_.motion_at(at) : steps_.refined_state_at(at);
    }
    const Real span = restart ? changes_.all().front().at : last ? std::max(end_time_ - begin, Real(0)) : h;
    std::optional<Real> zero;
    if (crosses) zero = steps_.x_arc().times(side).fall(h);
    if (zero && (begin + *zero > end_time_ || (restart && *zero > span))) zero.reset();

    if (turns || restart) consider_peak(turns && steps_.number() > 1 ? -h / 2 : Real(0), span);
    if (turns) trend_ = -trend_;
    if (half_cycles_.side() == 0) half_cycles_.take_side(sign(steps_.x().x));
    if (trend_ == 0) trend_ = sign(steps_.x().dx);

    for (const Change& change : changes_.all()) {
      if (zero && !(change.at < *zero)) {
        cross_zero(*zero, span);
        zero.reset();
      }
      if (!end_) carry_out(change, anew);
      if (end_) return;
    }
    if (zero) cross_zero(*zero, span);
    if (end_) return;
    if (restart) return begin_anew(span, *std::move(anew), slows_down);
    if (!changes_.all().empty()) steps_.renew_coefficients();
    if (last) return finish(horizon_.stop_reason, span, true);
    if (steps_left_ == 0) return finish(StopReason::step_budget, span);
    give_samples(end_time_);
  }
  // anew: the state at the change, where the motion begins anew there.
  void carry_out(const Change& change, const std::optional<State>& anew) {
    const auto& m = masses_[change.index];
    const Real& at = change.at;
    balance_.add_sums();
    const Real y = m.now.x + m.origin_of_q();
    // A step too coarse can lead from one wall through to the other; with `locate` the mass leaves the first
    // wall.
    const bool met = !change.slips && (!m.wall || (!anew && !(y >= 0 && y <= m.clearance)));
    std::int64_t meeting = met;
    if (anew && &change == &changes_.all().front()) {  // all of them, or none
      meeting = std::ranges::count_if(
          changes_.all(), [&](const Change& each) { return !each.slips && !masses_[each.index].wall; });
      if (meeting <= budget_.max_impacts - impacts_ && steps_left_ == 0)
        return finish(StopReason::step_budget, at);
    }
    if (meeting > budget_.max_impacts - impacts_) return finish(StopReason::impact_budget, at);
    const Real time = steps_.begin() + at;
    give_samples(time);
    if (!anew && m.wall) leave(change.index, time);
    if (!met) return;
    const Real w = anew ? anew->w[change.index] : m.arc(steps_.h()).slope_at(at);
    const Wall wall = y > m.clearance / 2 ? Wall::right : Wall::left;
    ++impacts_;
    report_.impact(double(time), wall, double(w), double(steps_.x_arc().at(at)), m.number);
    if (!anew) enter(change.index, wall, time, w);
  }
  // Begins the motion anew at the time of the changes, with the masses that change exactly on their walls.
  void begin_anew(const Real& at, State s, bool slows_down) {
    const Real time = steps_.begin() + at;
    balance_.close(at);
    std::vector<std::size_t> parted;
    for (const Change& change : changes_.all()) {
      const std::size_t i = change.index;
      const auto& m = masses_[i];
      if (change.slips) {
        s.w[i] = 0;
        if (m.stuck) parted.push_back(i);
        continue;
      }
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
    if (changes_.any_joins()) {
      half_cycles_.peak(half_cycles_.side() * s.x, time);  // x' may change its sign where masses join
      changes_.join(s);
    }
    if (slows_down) {
      steps_.set_pace(rates_.small());
      s = rates_.of_scheme(std::move(s), time, steps_.h());
    }
    trend_ = sign(s.v);
    if (masses_.has_components()) masses_.hold(time, s, parted);
    begin_segment(time, s);
    for (const std::size_t i : parted) {
      const Real second = masses_.second_of_x(time, s);
      masses_.has_components()
          ? steps_.lead_from_rest(i, masses_.second_of_q(s, i, second), masses_.third_where_freed(time, s))
          : steps_.lead_from_rest(i, -second, masses_.third_of_y(time, s));
    }
  }
  void enter(std::size_t i, Wall wall, const Real& time, const Real& w) {
    masses_.set_wall(i, wall);
    masses_[i].contact_begin = time;
    steps_at_pace_ = 0;
    balance_.enter(i);
    changes_.release_other_side(i, wall, w);
  }
  void leave(std::size_t i, const Real& time) {
    const auto& m = masses_[i];
    report_.contact(double(m.contact_begin), double(time), *m.wall, m.number);
    balance_.leave(i);
    masses_.set_wall(i, {});
    steps_at_pace_ = 0;
  }

  // Completes a half cycle at a zero of x in the last step. span: the part of the step that counts.
  void cross_zero(const Real& at, const Real& span) {
    if (balance_) balance_.look_at(steps_.state_at(at));
    half_cycles_.crossing(steps_.begin() + at, observer_);
    trend_ = sign(steps_.x().dx);
    consider_peak(at, span);  // x' may have changed its sign after x did
    if (const auto reason = half_cycles_.stops(until_amplitude_, budget_)) finish(*reason, at);
  }
  void consider_peak(const Real& from, const Real& to) {
    const Arc<Real> x = steps_.x_arc();
    const Real at = x.extremum(from, to);
    half_cycles_.peak(half_cycles_.side() * x.at(at), steps_.begin() + at);
  }
  void give_samples(const Real& until) {  // those in the last step
    for (;;) {
      const double time = observer_.next_sample();
      if (!(time <= until && steps_.step_of(time) <= steps_.number())) return;
      report_.sample(time, masses_, rates_.motion_at(Real(time) - steps_.begin()));
    }
  }
  void finish(StopReason reason, const Real& at, bool by_horizon = false) {
    const Real time = by_horizon ? end_time_ : steps_.begin() + at;
    give_samples(time);
    if (balance_) {
      const State s = rates_.motion_at(at);
      balance_.close(at);
      balance_.set_final(s);
    }
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (masses_[i].wall) leave(i, time);
    balance_.finish(is_list_);
    end_ = Outcome{reason, double(time)};
  }

  const Budget budget_;
  const std::optional<double> until_amplitude_;
  const Outcome horizon_;  // the end, if nothing else ends the run before
  const Real end_time_;    // of horizon_
  const bool locate_, joins_, is_list_;
  Observer& observer_;
  CemReport<Observer> report_;

  Masses masses_;
  CemSteps<Real, ForEach> steps_;
  CemRates<Real, ForEach> rates_;
  CemChanges<Real, ForEach> changes_;  // in the last step
  CemBalance<Real, ForEach> balance_;

  std::int64_t steps_left_, looks_left_;  // left of max_steps; left for spend_look()
  std::int64_t steps_at_pace_ = 0;        // with two rates: left until the pace is chosen anew
  Real trend_ = 0;                        // sign of x' since the last turning point
  HalfCycleTracker<Real> half_cycles_;
  State release_;  // with y instead of q
  std::int64_t impacts_ = 0;
  std::optional<Outcome> end_;
};

}  // namespace impact_damper
