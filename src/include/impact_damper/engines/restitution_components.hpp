// The restitution engine for scenes with friction, static friction, weight or drag (docs/mathematics.md,
// 18.5): rigid walls, one or several dampers. What it shares with the exact engine, and how it moves:
// engine_with_components.hpp. Here is who is held, and the limit of complete chattering.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/engine_with_components.hpp"
#include "impact_damper/engines/rigid_walls.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

template <class Real, class Force, class Observer>
class RestitutionWithComponents
    : EngineWithComponents<RestitutionWithComponents<Real, Force, Observer>,
                           EngineWithRigidWalls<Real, Force, Observer>, Real, Force, Observer> {
  using Base = EngineWithComponents<RestitutionWithComponents, EngineWithRigidWalls<Real, Force, Observer>,
                                    Real, Force, Observer>;
  friend Base;
  using Base::each_, Base::energy_of, Base::forces_, Base::losses_, Base::masses_, Base::observer_,
      Base::system_, Base::tracker_, Base::v_, Base::x_;
  using typename Base::Acceleration, typename Base::Event, typename Base::Kind, typename Base::Mass,
      typename Base::Which;

 public:
  RestitutionWithComponents(const System<Real, Force>& system, const Scene& scene, const Restitution& options,
                            Observer& observer)
      : Base(system, scene, options, observer),
        tolerance_(options.accumulation_tolerance),
        settles_(masses_.size(), Real(0)) {}

  Outcome run() { return Base::run_to_end(); }

 private:
  Event follow(bool& stopped_by_rounding) { return Base::follow_motion(stopped_by_rounding); }
  bool take(const Which& event) {
    if (event.kind == Kind::near_wall || event.kind == Kind::far_wall) return Base::impacts(Base::meeting_);
    if (event.kind == Kind::stop) Base::stop_all(event.mass);
    return true;
  }
  void end(std::size_t i) { let_go(i); }

  // Decides who is held: of the masses at rest all that R = -(x'' + gamma), computed with all of them held,
  // does not move (M18.9). Who is let go makes |x'' + gamma| larger, and leaves its sign, so those that have
  // to go are the same in whatever order they go, and each pass lets all go that exceed their bound (18.5).
  // Then takes the limit of masses whose chattering is over soon.
  void settle() {
    settle_at_rest();
    for (std::size_t n = 0; n < masses_.size() && take_limits(); ++n) settle_at_rest();
  }
  void settle_at_rest() {
    bool any = false;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Mass& mass = each_[i];
      const Real w = masses_.w(i);
      mass.still = masses_.u1[i] == 0 && (mass.holds > 0 || Base::on_wall(i));
      mass.slides = mass.holds > 0 ? Real(w > 0) - Real(w < 0) : Real(0);
      any = any || mass.still;
    }
    Base::sum_up_held();
    for (bool again = any; again;) {
      again = false;
      const Acceleration now = Base::acceleration();
      for (std::size_t i = 0; i < masses_.size(); ++i) {
        Mass& mass = each_[i];
        const Real direction = mass.still ? Base::goes(i, now) : Real(0);
        if (direction == 0) continue;
        mass.still = false;
        if (mass.holds > 0) mass.slides = direction;
        again = true;
      }
      Base::sum_up_held();
    }
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (!each_[i].still) {
        let_go(i);
      } else if (!masses_.held[i]) {
        Base::hold(i, Real(tracker_.now() + settles_[i]));
      }
      settles_[i] = 0;
    }
  }
  void let_go(std::size_t i) {
    if (!masses_.held[i]) return;
    if (Base::on_wall(i))
      Base::let_go(i);
    else
      masses_.held[i] = false;  // by friction: no contact with a wall
  }

  // A mass that bounces down under (M18.10), for the time (M18.11).
  struct Chattering {
    std::size_t index;
    Real lasts;        // T_i of (M18.12)
    Real per_speed;    // duration of all bounces, divided by the speed with which they begin
    Real lost;         // lambda_i, the fraction of its speed that a bounce takes
    Real landing;      // the speed with which it comes back to its wall
    Real top;          // how high above its wall it comes
    Real moves;        // by how much its bounces move x at most
    Real by_friction;  // the fraction of its energy that friction takes
    Real by_drag;      // the most that drag adds to its deceleration
  };
  // Finds the masses whose bounces are over before anything else happens, and move x by less than rounding,
  // and joins them to the primary mass (18.5). Returns whether there are any.
  bool take_limits() {
    const Acceleration now = Base::acceleration();
    if (!(absolute(now.value) > now.error)) return false;
    const Real side = now.value > 0 ? 1 : -1, epsilon = std::numeric_limits<Real>::epsilon();
    const Real x_scale = epsilon / 8 * (absolute(x_) + absolute(v_));
    candidates_.clear();
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (masses_.held[i] || masses_.away[i] != side || masses_.u1[i] == 0) continue;
      if (masses_.u[i] == 0 && masses_.u1[i] < 0) continue;  // an impact now, maybe with others, comes first
      const Real &u1 = masses_.u1[i], out = u1 > 0 ? u1 : Real(0),
                 high = masses_.u[i] > 0 ? masses_.u[i] : Real(0);
      if (masses_.nu[i] * (high + out * out / (4 * absolute(now.value))) <= Base::mass() * x_scale)
        candidates_.push_back(i);
    }
    if (candidates_.empty()) return false;
    // One whose bounces are over before anybody else moves on sees the others as they are now; else those
    // that kick each other have to join together.
    return Base::with_motion([&](auto& motion) {
      for (const std::size_t i : candidates_) {
        joins_.assign(masses_.size(), false);
        joins_[i] = true;
        const Joined all = joined_with_all(side);
        if (all.a > each_[i].holds && join_most(motion, side, all)) return true;
      }
      if (candidates_.size() == 1) return false;
      for (const std::size_t i : candidates_) joins_[i] = true;
      return join_most(motion, side, joined_with_all(side));
    });
  }
  // x'' + gamma, times `side`, and the sums if all of joins_ have joined those that are held.
  struct Joined {
    Real a, mass, loses;  // loses: sum of nu (1 - e^2 r^2), see bounces_of()
  };
  Joined joined_with_all(const Real& side) const {
    Joined all{Real(0), Base::mass(), Real(0)};
    Real others = Base::force_in_cavities()[0];
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (!joins_[i]) continue;
      all.mass += masses_.nu[i];
      others -= masses_.nu[i] * (Base::friction_of(i) + each_[i].drag * masses_.w(i));
    }
    const Real f = system_.forcing.template derivatives<2>(system_.forcing.phase(tracker_.now()))[0];
    all.a = side * (f - 2 * system_.zeta * v_ - x_ + others + forces_.weight) / all.mass;
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (joins_[i] || is_kicked(i, side)) all.loses += loses(i, all.a);
    return all;
  }
  // Whether impacts on the walls of `side` set a mass that is held in motion.
  bool is_kicked(std::size_t i, const Real& side) const {
    return masses_.held[i] && (!Base::on_wall(i) || masses_.away[i] == side);
  }
  // The fraction r^2 of its energy with which a mass comes back to its wall: 0 where friction holds it above.
  Real comes_back(std::size_t i, const Real& a) const {
    return a > each_[i].holds ? Real((a - each_[i].friction) / (a + each_[i].friction)) : Real(0);
  }
  Real loses(std::size_t i, const Real& a) const {
    return masses_.nu[i] * (1 - masses_.e[i] * masses_.e[i] * comes_back(i, a));
  }
  // all.a: with all that join.
  Chattering bounces_of(std::size_t i, const Joined& all) const {
    const Real &nu = masses_.nu[i], &e = masses_.e[i], &phi = each_[i].friction, &u1 = masses_.u1[i];
    const Real others = all.mass - nu, share = all.mass / others;
    const Real out = share * (all.a + phi), back = share * (all.a - phi), r_2 = comes_back(i, all.a),
               r = square_root(r_2);
    const Real kicks = nu / (1 + nu) * (all.loses - loses(i, all.a)) / others;
    const Real lost = (1 - e * r) + (1 + e) * r * (kicks > 0 ? kicks : Real(0));
    Chattering one{i, {}, {}, lost < 1 ? lost : Real(1), {}, {}, {}, {}, {}};
    const Real u = masses_.u[i] > 0 ? masses_.u[i] : Real(0), up = u1 > 0 ? u1 : Real(0), down = up - u1;
    const Real top = u + up * up / (2 * out), falls = 2 * (back > 0 ? back : Real(0)) * top;
    one.top = top;
    one.landing = square_root(Real(down * down + falls));
    one.by_drag = each_[i].drag * (up > one.landing ? up : one.landing);
    if (r > 0) {
      one.per_speed = (1 + 1 / r) / (out * one.lost);  // of the speed upwards
      one.lasts = up / out + (one.landing - down) / back;
      if (one.landing > 0) one.lasts += one.landing * ((1 - one.lost) / r) * one.per_speed;
    } else {  // it stops the next time that its speed is zero, after one impact at most
      one.per_speed = 1 / out;
      one.lasts = up / out + (down > 0 ? Real(2 * u / down) : Real(0)) + e * one.landing / out;
    }
    one.moves = nu * (down > 0 && r > 0 ? Real(one.landing * one.landing / (2 * back)) : top) / Base::mass();
    one.by_friction = phi > 0 ? Real((1 - r_2) / (1 - e * e * r_2)) : Real(0);
    return one;
  }
  // Whether the restitution of all its bounces is that at rest (M18.19).
  bool is_settled(const Chattering& one, const Real& a) const {
    const std::size_t i = one.index;
    if (!masses_.varies(i)) return true;
    const Real p = masses_.e[i] * square_root(comes_back(i, a));
    return masses_.is_settled(i, one.landing, Real(tolerance_ * (1 - p)));
  }
  // Of the masses in joins_ joins as many as can (M18.23), those that are over first before others.
  template <class Motion>
  bool join_most(Motion& motion, const Real& side, const Joined& all) {
    chattering_.clear();
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (!joins_[i]) continue;
      chattering_.push_back(bounces_of(i, all));
      joins_[i] = is_settled(chattering_.back(), all.a);
      if (!joins_[i]) chattering_.pop_back();
    }
    std::sort(chattering_.begin(), chattering_.end(), [](const Chattering& one, const Chattering& other) {
      return one.lasts < other.lasts || (one.lasts == other.lasts && one.index < other.index);
    });
    const Real span = motion.span(tracker_.search().span), epsilon = std::numeric_limits<Real>::epsilon();
    const Real m3 = absolute(motion.third()), m4 = motion.bound(4, span);
    const auto lower_bound_of_meeting = [&](std::size_t i) {
      return masses_.lower_bound_of_meeting(
          i, Real(motion.bound_of_mass(each_[i].in_series, 2, span) + absolute(Base::pull(i))));
    };
    Real damping = 2 * system_.zeta;  // of the primary mass, with that by fluids
    for (std::size_t i = 0; i < masses_.size(); ++i) damping += masses_.nu[i] * each_[i].drag;
    Real slowest{0};  // of those that are held and can be kicked off their walls
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (!is_kicked(i, side)) continue;
      const Real its = bounces_of(i, all).per_speed;
      if (slowest < its) slowest = its;
    }
    const bool alone = chattering_.size() == 1 && slowest == 0;
    sums_.assign(1, Sums{});
    sums_[0].slowest = slowest;
    for (const Chattering& each : chattering_)
      sums_.push_back(sums_.back().with(each, masses_, all.a, each_[each.index]));
    Real others_meet = span;  // a lower bound
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (masses_.held[i] || joins_[i]) continue;
      const Real time = lower_bound_of_meeting(i);
      if (time < others_meet) others_meet = time;
    }
    // Whether friction keeps its direction on all others, or holds them, as long as the masses bounce, which
    // changes velocities by `change` at most: else it is not that of the limit.
    const auto friction_stays = [&](const Real& change, const Real& lasts) {
      for (std::size_t i = 0; i < masses_.size(); ++i) {
        if (joins_[i] || Base::on_wall(i) || !(each_[i].holds > 0)) continue;
        if (masses_.held[i] ? absolute(all.a) > each_[i].holds
                            : absolute(masses_.u1[i]) <= change + each_[i].friction * lasts)
          return false;
      }
      return true;
    };
    for (std::size_t count = chattering_.size(); count > 0; --count) {
      const Sums& sums = sums_[count];
      const Real heavy = all.mass * all.mass;
      const Real lasts = alone ? sums.longest : Real(sums.longest + sums.given_speed * sums.slowest * heavy);
      const Real speed = absolute(v_ + sums.momentum / (Base::mass() + sums.mass));
      const Real turns = sums.impulse / Base::mass() +
                         (absolute(side * all.a - forces_.weight) + sums.forces / Base::mass()) * lasts;
      const Real changes =
          (m3 + m4 * lasts + damping * (all.a + forces_.weight + sums.forces) / Base::mass()) * lasts +
          sums.by_drag;
      if (8 * sums.moves <= epsilon * (absolute(x_) + speed * lasts) && lasts < span &&
          (alone || lasts <= tolerance_) && changes <= tolerance_ * sums.margin && changes <= sums.holding &&
          ((speed > turns && friction_stays(turns, lasts)) || 2 * lasts <= epsilon * tracker_.now()) &&
          2 * lasts <= others_meet) {
        join(count, all, Real(sums.momentum / (Base::mass() + sums.mass)));
        return true;
      }
      const std::size_t i = chattering_[count - 1].index;  // from now on this one is left out, too
      const Real time = lower_bound_of_meeting(i);
      if (time < others_meet) others_meet = time;
    }
    return false;
  }
  // Sums over the first masses of chattering_, as in 17.3.
  struct Sums {
    Real mass{0}, momentum{0}, impulse{0}, moves{0}, forces{0}, given_speed{0}, longest{0}, slowest{0},
        by_drag{0};
    Real margin = std::numeric_limits<Real>::infinity(), holding = margin;
    Sums with(const Chattering& each, const SecondaryMasses<Real>& masses, const Real& a,
              const Mass& its) const {
      const std::size_t i = each.index;
      const Real &nu = masses.nu[i], &e = masses.e[i];
      Sums all = *this;
      all.mass += nu;
      all.momentum += nu * masses.w(i);
      all.impulse += nu * (1 + e) * each.landing;
      all.moves += each.moves;
      all.forces += nu * (a + its.friction);
      all.given_speed += nu / (1 + nu) * (1 + e) * each.landing / each.lost;
      if (longest < each.lasts) all.longest = each.lasts;
      if (slowest < each.per_speed) all.slowest = each.per_speed;
      if (by_drag < each.by_drag) all.by_drag = each.by_drag;
      if (a > its.holds && a - its.friction < margin) all.margin = a - its.friction;
      if (absolute(a - its.holds) < holding) all.holding = absolute(a - its.holds);
      return all;
    }
  };
  // Joins the first `count` masses of chattering_ to the primary mass; `jump` is that of x'.
  void join(std::size_t count, const Joined& all, const Real& jump) {
    for (std::size_t n = 0; n < count; ++n) {
      const Chattering& each = chattering_[n];
      const std::size_t i = each.index;
      const bool bounces = all.a > each_[i].holds;
      if (observer_.wants_energy()) {
        const Real w = masses_.w(i), loss = masses_.nu[i] * w * (w - jump) / 2;  // (M17.7)
        const Real by_friction = loss * each.by_friction;
        each_[i].by_friction.advance(by_friction);
        losses_ += loss - by_friction;
        energy_of(i).bounce_down_loss += double(Real(loss - by_friction));
        energy_of(i).bounce_downs += bounces;
        observer_.energy_balance().bounce_down_loss += double(Real(loss - by_friction));
        observer_.energy_balance().bounce_downs += bounces;
      }
      masses_.u[i] = bounces ? Real(0) : each.top;
      masses_.u1[i] = 0;
      settles_[i] = each.lasts;
      joins_[i] = true;
    }
    for (std::size_t n = count; n < chattering_.size(); ++n) joins_[chattering_[n].index] = false;
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (!masses_.held[i] && !joins_[i]) masses_.u1[i] -= masses_.away[i] * jump;
    v_ += jump;
  }

  Real tolerance_;
  std::vector<Real> settles_;  // how long chattering lasts whose limit has just been taken
  std::vector<char> joins_;
  std::vector<std::size_t> candidates_;  // to join
  std::vector<Chattering> chattering_;
  std::vector<Sums> sums_;
};

// Runs a scene that has friction, weight or drag, with one damper or a list.
template <Scalar Real, DampersObserver Observer>
Outcome run_restitution_with_components(const Checked& run, Observer& observer) {
  return with_system<Real>(run.scene(), [&](const auto& system) {
    return run_restitution_with_components(system, run.scene(), run.options<Restitution>(), observer);
  });
}

template <class Real, class Force, class Observer>
Outcome run_restitution_with_components(const System<Real, Force>& system, const Scene& scene,
                                        const Restitution& options, Observer& observer) {
  require_arithmetic();
  return RestitutionWithComponents<Real, Force, Observer>(system, scene, options, observer).run();
}

}  // namespace impact_damper
