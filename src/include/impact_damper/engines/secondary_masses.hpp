// The secondary masses of several dampers, and which of them meets a wall next (docs/mathematics.md, 17.1 and
// 17.4). Only x couples them, so the impact time of each mass in flight is found separately, as for one
// damper (flight.hpp), and only for those that may be the first: a bound on x'' excludes the others (M17.8).
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "impact_damper/engines/damper_order.hpp"
#include "impact_damper/engines/observer.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/impact_law.hpp"

namespace impact_damper {

// One array for each quantity, which the processor reads two numbers at a time, in the order of
// damper_order.hpp.
template <class Real>
struct SecondaryMasses {
  explicit SecondaryMasses(std::span<const SceneDamper> dampers) : number(damper_order(dampers)) {
    for (const std::int32_t i : number) {
      const SceneDamper& d = dampers[i];
      const bool right = Real(d.y0) > Real(d.clearance) / 2;
      nu.push_back(Real(d.mass_ratio));
      e.push_back(Real(d.restitution));
      if (!d.restitution_by_speed.empty()) {
        e.back() = impact_damper::restitution_at(d.restitution_by_speed, Real(0));
        by_speed.resize(number.size());
        by_speed[e.size() - 1] = d.restitution_by_speed;
      }
      clearance.push_back(Real(d.clearance));
      away.push_back(right ? Real(-1) : Real(1));
      u.push_back(right ? Real(Real(d.clearance) - Real(d.y0)) : Real(d.y0));
      u1.push_back(away.back() * Real(d.w0));
    }
    held.resize(size());
    held_since.resize(size());
  }
  std::size_t size() const { return number.size(); }

  // The restitution of an impact with u' = speed <= 0.
  Real restitution_at(std::size_t i, const Real& speed) const {
    return varies(i) ? impact_damper::restitution_at(by_speed[i], absolute(speed)) : e[i];
  }
  // Whether it is that at rest, within `most`, for all impacts up to this speed (M18.19).
  bool is_settled(std::size_t i, const Real& speed, const Real& most) const {
    return !varies(i) || impact_damper::is_settled(by_speed[i], speed, most);
  }
  bool varies(std::size_t i) const { return !by_speed.empty() && !by_speed[i].empty(); }

  bool rests(std::size_t i) const { return u[i] == 0 && u1[i] == 0; }
  Wall wall(std::size_t i) const { return away[i] > 0 ? Wall::left : Wall::right; }
  Real w(std::size_t i) const { return away[i] * u1[i]; }
  PlaceInCavity place(std::size_t i, const Real& distance, const Real& speed) const {
    const Real wall = away[i] > 0 ? Real(0) : clearance[i];
    return {double(Real(wall + away[i] * distance)), double(Real(away[i] * speed))};
  }
  double kinetic(std::size_t i, const Real& v) const { return kinetic_energy(nu[i], v, w(i)); }

  // Moves all masses in flight by a time t in which x departs from its straight line by dx and x' changes by
  // dv. The masses that are held are moved as well, and the caller sets them anew: to leave them out would
  // take a branch that no processor predicts.
  void fly(const Real& t, const Real& dx, const Real& dv) {
    for (std::size_t i = 0; i < size(); ++i) {
      u[i] += u1[i] * t - away[i] * dx;
      u1[i] -= away[i] * dv;
    }
  }
  // Puts the i-th mass on the wall `where`: u = 0, u' <= 0.
  void arrive(std::size_t i, Wall where) {
    const Real before = away[i];
    away[i] = Real(1 - 2 * int(where == Wall::right));
    u1[i] *= away[i] * before;
    if (u1[i] > 0) u1[i] = 0;  // grazed, by rounding
    u[i] = 0;
  }
  FlightStart<Real> start_of_flight(std::size_t i, const Real& x, const Real& v) const {
    const Real wall = (1 - away[i]) / 2 * clearance[i];
    return {{x, v, wall + away[i] * u[i], w(i)}, wall, away[i], u[i]};
  }
  // Whether the i-th is proved to meet no wall within a time t in which |x''| <= most, nor to come nearer to
  // one than `margin` (M17.8).
  bool stays_off_walls(std::size_t i, const Real& most, const Real& t, const Real& margin) const {
    const Real way = u1[i] * t, off = most * t * t / 2 + margin;
    return u[i] + (way < 0 ? way : Real(0)) > off && clearance[i] - u[i] - (way > 0 ? way : Real(0)) > off;
  }
  // A lower bound of the time at which the i-th mass, in flight, meets a wall if |x''| <= most: the smaller
  // root of (M17.8).
  Real lower_bound_of_meeting(std::size_t i, const Real& most) const {
    // Rounding may leave a mass a little beyond a wall that it has just left.
    const Real &speed = u1[i], near = u[i] > 0 ? u[i] : Real(0), beyond = clearance[i] - near,
               far = beyond > 0 ? beyond : Real(0);
    // The roots of near + u' t - most t^2/2, and of far - u' t - most t^2/2, without cancellation.
    const Real near_root = square_root(Real(speed * speed + 2 * most * near)),
               far_root = square_root(Real(speed * speed + 2 * most * far));
    const Real to_home = near_root - speed, to_far = far_root + speed;
    const Real home = speed > 0     ? Real((speed + near_root) / most)
                      : to_home > 0 ? Real(2 * near / to_home)
                                    : Real(0);
    const Real across = speed < 0    ? Real((far_root - speed) / most)
                        : to_far > 0 ? Real(2 * far / to_far)
                                     : Real(0);
    return home < across ? home : across;
  }
  // Returns the mass in flight that would meet a wall first if x'' stayed as it is. times: scratch space.
  std::size_t likely_first(const Real& second_of_x, std::vector<Real>& times) const {
    times.resize(size());
    for (std::size_t i = 0; i < times.size(); ++i) {
      // Without branches, which no processor would predict.
      const Real speed = absolute(u1[i]), rises = one_if_positive(u1[i]);
      const Real ahead = u[i] + rises * (clearance[i] - 2 * u[i]),
                 push = (1 - 2 * rises) * (away[i] * second_of_x);
      // The time to the wall ahead or, if the mass turns back before it, to the other wall.
      const Real square = speed * speed + 2 * push * ahead;
      const Real arrives = one_if_positive(square), turns = 1 - arrives;
      const Real sum = speed + square_root(Real(square - turns * (2 * push * clearance[i])));
      times[i] = (arrives * (2 * ahead) + turns * sum) / (arrives * sum - turns * push);
    }
    std::size_t first = 0;
    Real earliest = std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (held[i] || !(times[i] < earliest)) continue;
      first = i;
      earliest = times[i];
    }
    return first;
  }

  std::vector<std::int32_t> number;    // in the scene
  std::vector<Real> nu, e, clearance;  // e: where it depends on the speed, at rest
  std::vector<Pairs> by_speed;         // SceneDamper::restitution_by_speed; empty if all are
  // The wall that the mass left last, at the release the nearer one: 1 left, -1 right.
  std::vector<Real> away;
  std::vector<Real> u, u1;  // distance from that wall, and its derivative
  std::vector<char> held;   // at its wall: it sticks there, u = 0, or pushes it in, u <= 0
  std::vector<double> held_since;
};

template <class Real>
struct Meeting {
  std::size_t index;
  Real time;
  Wall wall;
  Real speed;  // relative to the wall
};

// Returns how much later than another an impact may come and still be at the same instant: the rounding of
// the mass's distance, known by the way that it has come, divided by its speed; but no longer than it keeps
// that speed. most: a bound on |y''|.
template <class Real>
Real slack_of_instant(const Real& way, const Real& speed, const Real& most) {
  const Real slack = 4 * std::numeric_limits<Real>::epsilon() * way / speed, keeps = speed / (4 * most);
  return slack < keeps ? slack : keeps;
}

// Finds the masses that meet walls next. The mass estimated to be the first is searched first. With its
// impact time known, (M17.8) and Lemma L2 exclude most others. No queue is kept: an impact changes the
// estimates of all.
template <class Real, class Force>
class NextMeeting {
 public:
  // Returns all masses that meet walls at the next instant (17.2), in their order. The first must do so
  // before `until`; the result is empty if none does. primary: the motion of x from now on.
  std::span<const Meeting<Real>> find(const SecondaryMasses<Real>& masses,
                                      const ForcedMotion<Real, Force>& primary, const Real& x, const Real& v,
                                      const Real& until, Search<Real>& search) {
    found_.clear();
    earliest_ = until;
    at_earliest_.reset();
    bounds_.reset();
    if (masses.size() == 1) {
      if (!masses.held[0]) look_for(masses, 0, primary, x, v, until, search);
      return found_;
    }
    const std::size_t likely = masses.likely_first(primary.beginning()[2], estimates_);
    if (!masses.held[likely]) look_for(masses, likely, primary, x, v, until, search);
    for (std::size_t i = 0; i < masses.size(); ++i)
      if (i != likely && !masses.held[i] && !is_excluded(masses, i, primary, search))
        look_for(masses, i, primary, x, v, until, search);
    if (found_.size() < 2) return found_;
    // At one instant: times that rounding cannot tell apart.
    std::erase_if(found_, [&](const Meeting<Real>& each) {
      return each.time - earliest_ > slack_of(masses, each, primary, search);
    });
    for (Meeting<Real>& each : found_) each.time = earliest_;
    std::ranges::sort(found_, {}, &Meeting<Real>::index);
    return found_;
  }
  // The state of the primary mass at t, known from the search if t is the time that it found.
  Displacement<Real> primary_at(const ForcedMotion<Real, Force>& primary, const Real& t) const {
    return at_earliest_ && t == earliest_ ? *at_earliest_ : primary.at(t);
  }

 private:
  void look_for(const SecondaryMasses<Real>& masses, std::size_t i, const ForcedMotion<Real, Force>& primary,
                const Real& x, const Real& v, const Real& until, Search<Real>& search) {
    const Flight<Real, Force, OwnClearance<Real>, const ForcedMotion<Real, Force>&> flight(
        primary, {masses.clearance[i]}, masses.start_of_flight(i, x, v));
    const Real horizon = latest_of_instant(masses, i, primary, until, search);
    const auto met =
        masses.rests(i) ? flight.released_meets_wall(horizon, search) : flight.next_wall(horizon, search);
    if (!met) return;
    found_.push_back({i, met->time, met->wall, absolute(met->state.w)});
    if (!(met->time < earliest_)) return;
    earliest_ = met->time;
    at_earliest_ = {met->state.x, met->state.v, met->change->dx, met->change->dv};
  }
  // Returns the latest time at which the i-th mass may be found to meet a wall at the earliest instant known.
  // No slack (slack_of) is longer than the geometric mean of the two that it is the lesser of.
  Real latest_of_instant(const SecondaryMasses<Real>& masses, std::size_t i,
                         const ForcedMotion<Real, Force>& primary, const Real& until,
                         const Search<Real>& search) {
    if (!(earliest_ < until)) return until;
    const Real &t = earliest_, &most = bounds(primary, search).second;
    const Real way = masses.clearance[i] + (absolute(masses.u1[i]) + most * t) * t;
    const Real late = t + square_root(Real(2 * std::numeric_limits<Real>::epsilon() * way / most));
    return late < until ? late : until;
  }
  // Returns how much later than another an impact may be found and still be at the same instant.
  Real slack_of(const SecondaryMasses<Real>& masses, const Meeting<Real>& met,
                const ForcedMotion<Real, Force>& primary, const Search<Real>& search) {
    const Real from = met.wall == masses.wall(met.index) ? masses.u[met.index] : masses.clearance[met.index];
    const Real &t = met.time, &most = bounds(primary, search).second;
    const Real way = absolute(from) + (absolute(masses.u1[met.index]) + most * t / 2) * t;
    return slack_of_instant(way, met.speed, most);
  }
  // Whether the i-th mass is proved to meet no wall until the earliest impact known, nor to come as near as
  // rounding.
  bool is_excluded(const SecondaryMasses<Real>& masses, std::size_t i,
                   const ForcedMotion<Real, Force>& primary, const Search<Real>& search) {
    if (masses.rests(i)) return false;
    const Real &time = earliest_, &most = bounds(primary, search).second;
    if (!(time <= bounds_->span)) return false;
    const Real &u = masses.u[i], &u1 = masses.u1[i], &gap = masses.clearance[i], &away = masses.away[i];
    const Real way = gap + (absolute(u1) + most * time / 2) * time;
    const Real rounding = 16 * std::numeric_limits<Real>::epsilon() * way;
    if (masses.stays_off_walls(i, most, time, rounding)) return true;
    if (!at_earliest_) at_earliest_ = primary.at(time);
    const Real u_then = u + (u1 * time - away * at_earliest_->dx), u1_then = u1 - away * at_earliest_->dv;
    return u_then > rounding && gap - u_then > rounding &&
           stays_between<Real>({u, u1, -away * bounds_->second_now, -away * bounds_->third_now}, u_then,
                               u1_then, time, bounds_->fourth, gap);
  }
  // Bounds on |x''| and |x''''| for a time `span`, which does not depend on where the run ends; x'' and x'''
  // now.
  struct Bounds {
    Real span, second, fourth, second_now, third_now;
  };
  const Bounds& bounds(const ForcedMotion<Real, Force>& primary, const Search<Real>& search) {
    if (!bounds_) {
      const Real span = primary.length() < search.span ? primary.length() : search.span;
      const auto beginning = primary.beginning();
      bounds_ = {span, primary.bound(2, span), primary.bound(4, span), beginning[2], beginning[3]};
    }
    return *bounds_;
  }

  std::vector<Real> estimates_;
  std::vector<Meeting<Real>> found_;
  Real earliest_{0};
  std::optional<Displacement<Real>> at_earliest_;
  std::optional<Bounds> bounds_;
};

}  // namespace impact_damper
