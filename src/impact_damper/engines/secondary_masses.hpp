// The secondary masses of several dampers, and which of them meets a wall next (docs/mathematics.md, 17.1 and
// 17.4). Only x couples them, so that each that flies is searched for by itself, as one damper's would be
// (flight.hpp), and only those that may be the first: a bound on x'' excludes the others (M17.8).
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "impact_damper/engines/damper_order.hpp"
#include "impact_damper/engines/observer.hpp"
#include "impact_damper/motion/flight.hpp"

namespace impact_damper {

// Number by number in arrays, which the processor moves two at a time, and in the order of damper_order.hpp.
template <class Real>
struct SecondaryMasses {
  explicit SecondaryMasses(std::span<const SceneDamper> dampers) : number(damper_order(dampers)) {
    for (const std::int32_t i : number) {
      const SceneDamper& d = dampers[i];
      const bool right = Real(d.y0) > Real(d.clearance) / 2;
      nu.push_back(Real(d.mass_ratio));
      e.push_back(Real(d.restitution));
      clearance.push_back(Real(d.clearance));
      away.push_back(right ? Real(-1) : Real(1));
      u.push_back(right ? Real(Real(d.clearance) - Real(d.y0)) : Real(d.y0));
      u1.push_back(away.back() * Real(d.w0));
    }
    held.resize(size());
    held_since.resize(size());
  }
  std::size_t size() const { return number.size(); }

  bool rests(std::size_t i) const { return u[i] == 0 && u1[i] == 0; }
  Wall wall(std::size_t i) const { return away[i] > 0 ? Wall::left : Wall::right; }
  Real w(std::size_t i) const { return away[i] * u1[i]; }
  PlaceInCavity place(std::size_t i, const Real& distance, const Real& speed) const {
    const Real wall = away[i] > 0 ? Real(0) : clearance[i];
    return {double(Real(wall + away[i] * distance)), double(Real(away[i] * speed))};
  }
  double kinetic(std::size_t i, const Real& v) const {
    const Real z1 = v + w(i);
    return double(Real(nu[i] * z1 * z1 / 2));
  }

  // Those that fly do so for a time t in which x departs from its straight line by dx, and x' changes by dv.
  void fly(const Real& t, const Real& dx, const Real& dv) {
    for (std::size_t i = 0; i < size(); ++i) {
      if (held[i]) continue;
      u[i] += u1[i] * t - away[i] * dx;
      u1[i] -= away[i] * dv;
    }
  }
  // One arrives at a wall.
  void arrive(std::size_t i, Wall where) {
    if (where != wall(i)) {
      away[i] = -away[i];
      u1[i] = -u1[i];
    }
    if (u1[i] > 0) u1[i] = 0;  // grazed, by rounding
    u[i] = 0;
  }
  FlightStart<Real> start_of_flight(std::size_t i, const Real& x, const Real& v) const {
    const Real wall = away[i] > 0 ? Real(0) : clearance[i];
    return {{x, v, wall + away[i] * u[i], w(i)}, wall, away[i], u[i]};
  }
  // Times before which no wall is met if |x''| <= most (M17.8), which holds for a time `span`.
  void find_lower_bounds(const Real& most, const Real& span, std::vector<Real>& bounds) const {
    bounds.resize(size());
    for (std::size_t i = 0; i < bounds.size(); ++i) {
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
      const Real first = home < across ? home : across;
      // What lies after the span is not excluded.
      bounds[i] = held[i] ? std::numeric_limits<Real>::infinity() : first < span ? first : span;
    }
  }

  std::vector<std::int32_t> number;  // in the scene
  std::vector<Real> nu, e, clearance;
  std::vector<Real> away;   // 1 if the wall that was left last is the left one, -1 if it is the right one
  std::vector<Real> u, u1;  // distance from that wall, and its derivative
  std::vector<char> held;   // at its wall: it sticks there, or pushes it in (then u < 0)
  std::vector<double> held_since;
};

template <class Real>
struct Meeting {
  std::size_t index;
  Real time;
  Wall wall;
  Real slack;  // how much later than another it may seem to be and still be at the same time
};

// Searches for those that meet walls next. No queue is kept: after an event all bounds move with x', and
// making them anew takes a square root or two for each mass. Once one meeting is known, Lemma L2 up to its
// time excludes most of the others whose bounds are earlier.
template <class Real>
class NextMeeting {
 public:
  // All that meet walls at one instant (17.2), the first before `until`, from now on, while x moves as
  // `primary` tells; in the order of the masses. Empty: nobody does.
  template <class Force>
  std::span<const Meeting<Real>> find(const SecondaryMasses<Real>& masses,
                                      const ForcedMotion<Real, Force>& primary, const Real& x, const Real& v,
                                      const Real& until, Search<Real>& search) {
    const Real span = until < search.span ? until : search.span;
    const Real most = primary.bound(2, span);
    if (masses.size() > 1) {
      masses.find_lower_bounds(most, span, bounds_);
    } else {
      bounds_.assign(1, masses.held[0] ? std::numeric_limits<Real>::infinity() : Real(0));
    }
    found_.clear();
    Real earliest = until;
    using Then = ThenOf<typename ForcedMotion<Real, Force>::Change>;
    Then then{};
    for (;;) {
      const auto next = std::min_element(bounds_.begin(), bounds_.end());
      const std::size_t i = next - bounds_.begin();
      const Real late = 16 * std::numeric_limits<Real>::epsilon() * (earliest + 1);
      if (!(*next <= earliest + late)) break;
      *next = std::numeric_limits<Real>::infinity();
      if (!found_.empty() && earliest <= span) {
        if (then.time != earliest)
          then = {earliest, primary.at(earliest), primary.beginning()[2], primary.beginning()[3],
                  primary.bound(4, span)};
        if (is_excluded(masses, i, then, most)) continue;
      }
      const Flight<Real, Force, OwnClearance<Real>, const ForcedMotion<Real, Force>&> flight(
          primary, {masses.clearance[i]}, masses.start_of_flight(i, x, v));
      const Real horizon = earliest + late < until ? Real(earliest + late) : until;
      const auto met =
          masses.rests(i) ? flight.released_meets_wall(horizon, search) : flight.next_wall(horizon, search);
      if (!met) continue;
      // What rounding leaves of its distance from that wall.
      const Real from = met->wall == masses.wall(i) ? masses.u[i] : masses.clearance[i];
      const Real &t = met->time, speed = absolute(met->state.w);
      const Real way = absolute(from) + (absolute(masses.u1[i]) + most * t / 2) * t;
      // But no longer than it keeps its speed.
      const Real slack = 4 * std::numeric_limits<Real>::epsilon() * way / speed, keeps = speed / (4 * most);
      found_.push_back({i, met->time, met->wall, slack < keeps ? slack : keeps});
      if (met->time < earliest) earliest = met->time;
    }
    if (found_.size() < 2) return found_;
    // At one instant: what rounding cannot tell apart.
    std::erase_if(found_, [&](const Meeting<Real>& each) { return each.time - earliest > each.slack; });
    for (Meeting<Real>& each : found_) each.time = earliest;
    std::ranges::sort(found_, {}, &Meeting<Real>::index);
    return found_;
  }

 private:
  // The primary mass at the time of a meeting, its second and third derivative now, and a bound on the
  // fourth.
  template <class Change>
  struct ThenOf {
    Real time{-1};
    Change at{};
    Real second{0}, third{0}, fourth{0};
  };
  // Whether the i-th is proved to fly on beyond that time, by more than rounding.
  template <class Then>
  static bool is_excluded(const SecondaryMasses<Real>& masses, std::size_t i, const Then& then,
                          const Real& most) {
    if (masses.rests(i)) return false;
    const Real &away = masses.away[i], &u = masses.u[i], &u1 = masses.u1[i], &gap = masses.clearance[i],
               &time = then.time;
    const Real u_then = u + (u1 * time - away * then.at.dx), u1_then = u1 - away * then.at.dv;
    const Real way = gap + (absolute(u1) + most * time / 2) * time;
    const Real rounding = 16 * std::numeric_limits<Real>::epsilon() * way;
    return u_then > rounding && gap - u_then > rounding &&
           stays_between<Real>({u, u1, -away * then.second, -away * then.third}, u_then, u1_then, time,
                               then.fourth, gap);
  }

  std::vector<Real> bounds_;
  std::vector<Meeting<Real>> found_;
};

}  // namespace impact_damper
