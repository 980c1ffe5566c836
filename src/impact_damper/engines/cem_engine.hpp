// The members of CemEngine (cem.hpp).
#pragma once

#include <type_traits>

#include "impact_damper/engines/cem.hpp"

namespace impact_damper {

template <class Real, class Observer>
CemEngine<Real, Observer>::CemEngine(const Scene& scene, const Cem& options, Observer& observer)
    : budget_(options.budget),
      until_amplitude_(scene.until_amplitude),
      horizon_(horizon_of(scene, options.budget)),
      end_time_(horizon_.end_time),
      damper_(options.damper),
      locate_(options.locate),
      stuck_speed_(options.stuck_speed),
      observer_(observer),
      system_(scene),
      force_(system_.forcing),
      flight_(regime_equations<Real>(scene, options.calibration, Regime::flight)),
      contact_(regime_equations<Real>(scene, options.calibration, Regime::contact)),
      small_(pace_of(options.time_step.value())),
      forced_(bool(force_)),
      energy_balance_(observer.wants_energy()),
      initial_{scene.x0, scene.v0, scene.y0, scene.w0},
      pace_(small_),
      steps_left_(options.max_steps),
      looks_left_(std::max<std::int64_t>(options.max_steps / 32, 10'000'000)) {
  if (options.large_step) {
    const Real large = multiple_of_h(*options.large_step);
    const Real pressed = stability_limit(scene, options.damper, options.calibration) / 2;
    rates_ = Rates{pace_of(large), pace_of(multiple_of_h(std::clamp(pressed, small_.h, large))),
                   whole_steps(nominal_contact_time(scene) / double(small_.h))};
  }
  // In contact from the beginning, by no impact: overlapping, or at rest at a wall and pressed to it, which
  // y'' tells, or y''' where that is zero to rounding: by where y is a step later, y'' h^2/2 + y''' h^3/6.
  // In the stuck regime, where both are zero to rounding, the first derivative after them that is not tells;
  // else the first step does.
  const State<Real>& s = initial_;
  const Real h = small_.h;
  const Real bend = acceleration(Real(0), s).q, jerk = s.v - force_.amplitude * force_.frequency;
  const bool at_rest_on_wall = (s.y == 0 || s.y == 1) && s.w == 0;
  const Lead<Real> lead = lead_of_x(Real(2 * flight_.zeta), Real(1), force_, force_.phase(Real(0)), s.x, s.v);
  const bool by_lead = stuck_speed_ && lead.order > 3;
  const Real moves = !at_rest_on_wall ? Real(0) : by_lead ? Real(-lead.value) : Real(bend + h / 3 * jerk);
  if (s.y < 0 || (s.y == 0 && moves < 0)) wall_ = Wall::left;
  if (s.y > 1 || (s.y == 1 && moves > 0)) wall_ = Wall::right;
  stuck_ = stuck_speed_ && wall_ && at_rest_on_wall;
  begin_segment(Real(0), initial_);
  if (at_rest_on_wall && !stuck_) lead_from_rest(bend, jerk);
  // Nor would it know to which side a force moves a primary mass at rest in the middle: that is x''' h^3/6,
  // too, unless an impact does.
  const bool impact_at_once = (s.y == 0 && s.w < 0) || (s.y == 1 && s.w > 0);
  const bool moved_by_force = s.x == 0 && s.v == 0 && acceleration(Real(0), s).x == 0 && !impact_at_once;
  const Real mass = stuck_ ? 1 + flight_.nu : Real(1);
  if (moved_by_force) now_.dx += h * h * h * force_.amplitude * force_.frequency / 6 / mass;

  side_ = sign(s.x != 0 ? s.x : s.v);
  trend_ = sign(s.v);
  peak_ = absolute(s.x);
}

template <class Real, class Observer>
Outcome CemEngine<Real, Observer>::run() {
  if (energy_balance_) observer_.energy_balance().initial = energy(initial_);
  if (observer_.next_sample() <= 0) {
    observer_.sample(0, double(initial_.x), double(initial_.v), double(initial_.y), double(initial_.w));
  }
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

// Steps that each end in an event, or in none that can be told, cost many times what the others do: when as
// many as are allowed have been looked at, one step remains. Looks at samples do not count, as they must not
// change where the run ends.
template <class Real, class Observer>
void CemEngine<Real, Observer>::spend_look() {
  if (--looks_left_ < 0) steps_left_ = std::min<std::int64_t>(steps_left_, 1);
}

// The second-order start: the step before the first is u - h u' + h^2 u''/2.
template <class Real, class Observer>
void CemEngine<Real, Observer>::begin_segment(const Real& time, const State<Real>& s) {
  const auto a = acceleration(time, s);
  now_ = {s.x, s.y - origin_of_q(), pace_.h * (s.v - pace_.h * a.x / 2), pace_.h * (s.w - pace_.h * a.q / 2)};
  origin_ = time;
  step_ = 0;
  if (energy_balance_) add_powers(-pace_.h / 2, time, s);
}

// At rest on a wall: the second-order start leaves y''' out, and y on the wall, where the error of a y'' that
// is zero would decide what comes next.
template <class Real, class Observer>
void CemEngine<Real, Observer>::lead_from_rest(const Real& bend, const Real& jerk) {
  const Real h = pace_.h;
  if (3 * absolute(bend) < h * absolute(jerk)) now_.dq += h * h * h * jerk / 6;
}

// Where x or x' has been zero until now its first movement has to be seen, to know the sides: unless nothing
// can move x before the next impact.
template <class Real, class Observer>
bool CemEngine<Real, Observer>::side_or_trend_unknown() const {
  const bool at_rest = !forced_ && !wall_ && now_.x == 0 && now_.dx == 0;
  return (side_ == 0 || trend_ == 0) && !at_rest;
}

template <class Real, class Observer>
std::int64_t CemEngine<Real, Observer>::steps_until_look() const {
  const Real sample = observer_.next_sample();
  std::int64_t steps = std::min(step_of(sample < end_time_ ? sample : end_time_) - step_, steps_left_);
  if (rates_) steps = std::min(steps, steps_at_pace_);
  return std::max<std::int64_t>(steps, 1);
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::take_steps(std::int64_t most) {
  const auto choose = [&](auto in) {
    constexpr Regime regime = in;
    if (forced_) {
      energy_balance_ ? take_steps<regime, true, true>(most) : take_steps<regime, true, false>(most);
    } else {
      energy_balance_ ? take_steps<regime, false, true>(most) : take_steps<regime, false, false>(most);
    }
  };
  stuck_  ? choose(std::integral_constant<Regime, Regime::stuck>())
  : wall_ ? choose(std::integral_constant<Regime, Regime::contact>())
          : choose(std::integral_constant<Regime, Regime::flight>());
}

// Steps until the wall is crossed (x'' where both masses are one), x changes its sign or x' its own, or
// `most` are done (fewer where a force or an energy balance is renewed).
template <class Real, class Observer>
template <Regime regime, bool forced, bool balance>
void CemEngine<Real, Observer>::take_steps(std::int64_t most) {
  const CemStep<Real> a = regime == Regime::contact  ? pace_.contact
                          : regime == Regime::flight ? pace_.flight
                                                     : pace_.stuck;
  const Real side = side_, trend = trend_, overlap = -push();
  const bool centred = damper_ == Damper::centred;
  Moment now = now_, before = now_;

  // At every 1024th step of a segment the force is computed afresh, and the sums are added up.
  if constexpr (forced || balance) {
    constexpr std::int64_t block = ForceAtSteps<Real>::block;
    const std::int64_t in_block = step_ % block;
    most = std::min(most, block - in_block);
    if (in_block == 0) {
      if constexpr (balance) add_sums();
      if constexpr (forced)
        force_at_steps_ = ForceAtSteps<Real>(force_, origin_ + Real(step_) * pace_.h, pace_.h);
    }
  }
  ForceAtSteps<Real> force = force_at_steps_;
  const Real& f = force.f;
  auto [sum_vv, sum_ww, sum_fv] = sums_;

  bool uneventful;
  std::int64_t n = 0;
  do {
    before = now;
    if constexpr (regime != Regime::contact) {
      now.dx = a.dx_dx * before.dx + a.dx_x * before.x;
      if constexpr (forced) now.dx += a.dx_f * f;
      if constexpr (regime == Regime::flight) now.dq = before.dq - (now.dx - before.dx);
    } else {
      now.dx = (a.dx_dx * before.dx + a.dx_x * before.x) + (a.dx_dq * before.dq + a.dx_q * before.q);
      now.dq = (a.dq_dq * before.dq + a.dq_q * before.q) + (a.dq_dx * before.dx + a.dq_x * before.x);
      if constexpr (forced) {
        now.dx += a.dx_f * f;
        now.dq += a.dq_f * f;
      }
    }
    now.x = before.x + now.dx;
    now.q = before.q + now.dq;
    if constexpr (balance) {
      const Real v = before.dx + now.dx, w = before.dq + now.dq;
      sum_vv += v * v;
      if constexpr (regime == Regime::contact) sum_ww += (centred ? w : 2 * before.dq) * w;
      if constexpr (forced) sum_fv += f * v;
    }
    if constexpr (forced) {
      force.advance();
    }
    ++n;
    if constexpr (regime == Regime::flight) {
      uneventful = (now.q >= 0) & (now.q <= 1);
    } else if constexpr (regime == Regime::stuck) {
      uneventful = -overlap * bend_of_stuck(a, now, f) >= 0;
    } else {
      uneventful = overlap * now.q > 0;
    }
    uneventful &= (side * now.x >= 0) & (trend * now.dx >= 0);
  } while (uneventful && n < most);

  before_ = before;
  now_ = now;
  step_ += n;
  steps_left_ -= n;
  if (rates_) steps_at_pace_ -= n;
  if constexpr (forced) force_at_steps_ = force;
  if constexpr (balance) sums_ = {sum_vv, sum_ww, sum_fv};
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::look_at_last_step() {
  const Real begin = last_step_begin();
  if (!std::isfinite(double(now_.x)) || !std::isfinite(double(now_.q))) {
    fail_of_overflow(double(begin), double(pace_.h));
  }
  const bool last = step_ >= step_of(end_time_);
  const auto too_late = [&](const Real& at) { return begin + at > end_time_; };

  std::optional<Real> change = stuck_ ? parting() : wall_crossing();
  const bool crosses = side_ * now_.x < 0, turns = trend_ * now_.dx < 0;
  if (change || crosses || turns) spend_look();
  if (change && too_late(*change)) change.reset();
  const bool joining = change && joins(*change);
  const bool restart = change && (locate_ || joining || stuck_);
  const Real span = restart ? *change : last ? std::max(end_time_ - begin, Real(0)) : pace_.h;
  std::optional<Real> zero;
  if (crosses) zero = x_arc().times(side_).fall(pace_.h);
  if (zero && (too_late(*zero) || (restart && *zero > span))) zero.reset();

  if (turns) {
    consider_peak(step_ == 1 ? Real(0) : -pace_.h / 2, span);
    trend_ = -trend_;
  } else if (restart) {
    consider_peak(Real(0), span);
  }
  if (side_ == 0) side_ = sign(now_.x);
  if (trend_ == 0) trend_ = sign(now_.dx);

  const bool zero_first = zero && !(change && *change < *zero);
  if (zero_first) cross_zero(*zero, span);
  if (change && !end_) {
    give_samples(begin + *change);
    change_regime(*change, restart, joining);
  }
  if (zero && !zero_first && !end_) cross_zero(*zero, span);
  if (end_ || restart) return;
  if (last) return finish(horizon_.stop_reason, span, true);
  if (steps_left_ == 0) return finish(StopReason::step_budget, span);
  give_samples(end_time_);
}

// Where in the last step the mass came to a wall or away from it.
template <class Real, class Observer>
std::optional<Real> CemEngine<Real, Observer>::wall_crossing() const {
  if (wall_) {
    const Real overlap = *wall_ == Wall::left ? Real(-1) : Real(1);
    if (overlap * now_.q > 0) return {};
    return q_arc().times(overlap).fall(pace_.h);
  }
  if (now_.q < 0) return q_arc().fall(pace_.h);
  if (now_.q > 1) {
    Arc<Real> gap = q_arc().times(Real(-1));
    gap.g += 1;
    return gap.fall(pace_.h);
  }
  return {};
}

// Where in the last step x'' of both masses changed its sign, and with it the wall's push.
template <class Real, class Observer>
std::optional<Real> CemEngine<Real, Observer>::parting() const {
  const Real from = push() * (now_.dx - before_.dx);
  const Real to = push() * bend_of_stuck(pace_.stuck, now_, force_at_steps_.f);
  if (!(to < 0)) return {};
  return from > 0 ? pace_.h * from / (from - to) : Real(0);
}

// Whether the touch at that time is the beginning of the stuck regime (M9.9).
template <class Real, class Observer>
bool CemEngine<Real, Observer>::joins(const Real& at) const {
  if (!stuck_speed_ || wall_) return false;
  const State<Real> s = refined(state_at(at), at);
  const Real towards = now_.q < 0 ? Real(1) : Real(-1);
  return absolute(s.w) < Real(*stuck_speed_) &&
         towards * joined_acceleration(last_step_begin() + at, joined(s)).x > 0;
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::change_regime(const Real& at, bool restart, bool joining) {
  const Real time = last_step_begin() + at;
  if (energy_balance_) add_sums();
  State<Real> s = state_at(at);
  const Real y = now_.q + origin_of_q();
  // A step too coarse can lead from one wall through to the other; located, the mass leaves the one first.
  const bool met = !wall_ || (!locate_ && !(y >= 0 && y <= 1));
  const Wall wall = y > Real(0.5) ? Wall::right : Wall::left;
  if (met && impacts_ >= budget_.max_impacts) return finish(StopReason::impact_budget, at);
  if (restart && steps_left_ == 0) return finish(StopReason::step_budget, at);

  const bool parted = stuck_;
  if (restart) {
    s = parted && rates_ ? motion_at(at) : refined(s, at);
    s.y = (wall_ ? *wall_ : wall) == Wall::right ? 1 : 0;
    if (energy_balance_) close_powers(at);
  }
  const Real old_origin = origin_of_q();
  if (wall_) leave(time);
  if (met) enter(wall, time, s);
  if (joining) s = join(s);
  if (parted && rates_) {
    pace_ = small_;
    s = of_scheme(s, time, pace_.h);
  }
  steps_at_pace_ = 0;
  if (restart) {
    trend_ = sign(s.v);
    begin_segment(time, s);
    if (parted) lead_from_rest(acceleration(time, s).q, s.v - forcing_rate(time));
  } else {
    before_.q += old_origin - origin_of_q();
    now_.q += old_origin - origin_of_q();
  }
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::enter(Wall wall, const Real& time, const State<Real>& s) {
  wall_ = wall;
  contact_begin_ = time;
  impact_began_contact_ = true;
  ++impacts_;
  observer_.impact(double(time), wall, double(s.w), double(s.x));
}

// Both masses with their momentum (M9.10); the energy (M9.11) is lost in the contact that begins.
template <class Real, class Observer>
State<Real> CemEngine<Real, Observer>::join(const State<Real>& s) {
  const Real nu = flight_.nu;
  if (energy_balance_) wall_work_ += nu / (1 + nu) * s.w * s.w / 2;
  stuck_ = true;
  return joined(s);
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::leave(const Real& time) {
  if (observer_.wants_contacts()) observer_.contact(double(contact_begin_), double(time), *wall_);
  if (energy_balance_) {
    if (impact_began_contact_) {
      observer_.energy_balance().impact_loss.push_back(double(wall_work_));
    } else {
      observer_.energy_balance().contact_loss += double(wall_work_);
    }
    losses_ += wall_work_;
    wall_work_ = 0;
  }
  wall_.reset();
  stuck_ = false;
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::cross_zero(const Real& at, const Real& span) {
  const Real time = last_step_begin() + at;
  if (observer_.wants_half_cycles()) {
    observer_.half_cycle(double(row_begin_), double(time), double(peak_time_), double(peak_));
  }
  if (energy_balance_) energy(state_at(at));
  ++rows_;
  const bool small = until_amplitude_ && peak_ < Real(*until_amplitude_);
  side_ = -side_;
  trend_ = sign(now_.dx);
  row_begin_ = time;
  peak_ = 0;
  peak_time_ = time;
  consider_peak(at, span);  // should x' have changed its sign after x did
  if (small) return finish(StopReason::amplitude, at);
  if (rows_ >= budget_.max_half_cycles) finish(StopReason::half_cycle_budget, at);
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::consider_peak(const Real& from, const Real& to) {
  const Arc<Real> x = x_arc();
  const Real at = x.extremum(from, to), height = side_ * x.at(at);
  if (!(height > peak_)) return;
  peak_ = height;
  peak_time_ = last_step_begin() + at;
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::give_samples(const Real& until) {
  for (;;) {
    const double time = observer_.next_sample();
    if (!(time <= until && step_of(time) <= step_)) return;
    const State<Real> s = motion_at(Real(time) - last_step_begin());
    observer_.sample(time, double(s.x), double(s.v), double(s.y), double(s.w));
  }
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::finish(StopReason reason, const Real& at, bool by_horizon) {
  const Real time = by_horizon ? end_time_ : last_step_begin() + at;
  give_samples(time);
  if (energy_balance_) {
    close_powers(at);
    observer_.energy_balance().final = energy(motion_at(at));
  }
  if (wall_) leave(time);
  if (energy_balance_) {
    EnergyBalance& balance = observer_.energy_balance();
    balance.viscous_work = double(viscous_work_);
    balance.forcing_work = double(forcing_work_);
    const double largest = std::max(largest_energy_, std::abs(balance.forcing_work));
    const Real open =
        (balance.initial.total() + forcing_work_) - (balance.final.total() + losses_ + viscous_work_);
    balance.residual = largest > 0 ? double(open) / largest : 0.0;
  }
  end_ = Outcome{reason, double(time)};
}

template <class Real, class Observer>
Energy CemEngine<Real, Observer>::energy(const State<Real>& s) {
  const Energy energy = energy_of(system_, s, wall_ ? absolute(Real(s.y - origin_of_q())) : Real(0));
  largest_energy_ = std::max(largest_energy_, energy.total());
  return energy;
}

// The energy balance's integrals are trapezoids over the steps: the loop adds whole powers, these the ends.
template <class Real, class Observer>
void CemEngine<Real, Observer>::add_powers(const Real& weight, const Real& time, const State<Real>& s) {
  viscous_work_ += weight * 2 * flight_.zeta * s.v * s.v;
  forcing_work_ += weight * forcing(time) * s.v;
  wall_work_ += weight * equations().nu * equations().c * s.w * s.w;
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::add_sums() {
  viscous_work_ += flight_.zeta * sums_.vv / (2 * pace_.h);
  if (wall_) wall_work_ += contact_.nu * contact_.c * sums_.ww / (4 * pace_.h);
  forcing_work_ += sums_.fv / 2;
  sums_ = {};
}

template <class Real, class Observer>
void CemEngine<Real, Observer>::close_powers(const Real& at) {
  add_sums();
  add_powers((at - pace_.h) / 2, last_step_begin(), state_at(Real(0)));
  add_powers(at / 2, last_step_begin() + at, state_at(at));
}

}  // namespace impact_damper
