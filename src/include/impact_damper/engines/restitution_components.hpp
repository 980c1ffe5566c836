// The restitution engine for scenes with friction, static friction, weight or drag (docs/mathematics.md,
// chapter 18): rigid walls, one or several dampers.
//
// Each secondary mass slides, with a constant force of friction on it, or is held: on a wall or, by friction,
// anywhere in its cavity. Between two events the primary mass and those that are held are one oscillator
// about a shifted position of rest (M18.7), and every distance in a cavity is a parabola less the departure
// of x from its straight line (M18.8). With drag all move by power series (motion_in_fluid.hpp), which take
// two to three times as long. Events are impacts, stops (y' falls through zero), and ends of holding (x''
// leaves the band of M18.9). All are found by Lemma L1 among all masses at once (first_of_many.hpp).
//
// After each event settle() decides anew who is held. A decision and the search that follows it must not
// contradict each other by rounding, or the run would stay where it is: settle() counts x'' as being at the
// edge of a band within `at_edge` of the sizes of its terms, where its first later derivative that is not
// zero decides; the search lets a function fall from zero only beyond four times as much.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/rigid_walls.hpp"
#include "impact_damper/events/first_of_many.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/motion_in_fluid.hpp"
#include "impact_damper/motion/shifted_motion.hpp"

namespace impact_damper {

// in_fluid: whether a mass has drag.
template <class Real, class Force, class Observer, bool in_fluid>
class RestitutionWithComponents : EngineWithRigidWalls<Real, Force, Observer> {
  using Base = EngineWithRigidWalls<Real, Force, Observer>;
  using Base::energy_of, Base::losses_, Base::masses_, Base::observer_, Base::system_, Base::tracker_,
      Base::v_, Base::x_;

 public:
  RestitutionWithComponents(const System<Real, Force>& system, const Scene& scene, const Restitution& options,
                            Observer& observer)
      : Base(system, scene, options.budget, options.max_steps, observer),
        tolerance_(options.accumulation_tolerance),
        weight_(scene.weight),
        lists_dampers_(!has_one_damper(scene)),
        slides_(masses_.size(), Real(0)),
        settles_(masses_.size(), Real(0)),
        rounding_of_w_(masses_.size(), Real(0)),
        by_friction_(masses_.size()),
        by_drag_(masses_.size(), Real(0)) {
    for (const std::int32_t i : masses_.number) {
      const SceneDamper& damper = scene.dampers[i];
      friction_.push_back(Real(damper.friction));
      holds_.push_back(Real(damper.holding()));
      drag_.push_back(Real(damper.drag));
    }
    forces_.weight = weight_;
  }

  Outcome run() {
    if (observer_.wants_energy()) {
      tracker_.begin(energy_now());
      Base::note_kinetic(&DamperEnergy::initial_kinetic);
    }
    settle();
    while (!tracker_.stopped()) {
      Motion& motion = begin_motion();
      const Event event = next_event(motion);
      const bool stopped_by_rounding = pass(motion, event.time);
      if (tracker_.stopped()) break;
      if (event.watch) {
        const auto [mass, kind] = *event.watch;
        if (kind == Kind::near_wall || kind == Kind::far_wall) {
          find_impacts(motion, mass, kind, event.time);
          if (!Base::impacts(meeting_)) break;
        } else if (kind == Kind::stop) {
          stop(mass);
          for (std::size_t i = 0; i < masses_.size(); ++i)
            if (slides_[i] != 0 && absolute(masses_.u1[i]) <= rounding_of_w_[i]) stop(i);
        }
      }
      if (event.watch || stopped_by_rounding) settle();
    }
    for (std::size_t i = 0; i < masses_.size(); ++i) let_go(i);
    if (observer_.wants_energy()) {
      Base::note_kinetic(&DamperEnergy::final_kinetic);
      for (std::size_t i = 0; i < masses_.size(); ++i)
        Base::count_in_cavity(i, by_friction_[i].now(), by_drag_[i]);
      Base::finish(energy_now());
      if (!lists_dampers_) observer_.energy_balance().dampers.clear();
    }
    return tracker_.outcome();
  }

 private:
  using Motion = std::conditional_t<in_fluid, MotionInFluid<Real, Force>, ShiftedMotion<Real, Force>>;
  using Now = typename Motion::Now;
  // What falls through zero: the gap to the wall that a mass left last or to the other one, its speed, or
  // what x'' + gamma is above the lower or below the upper edge of the band in which it is held.
  enum class Kind { near_wall, far_wall, stop, lower_edge, upper_edge };
  struct Which {
    std::size_t mass;
    Kind kind;
  };
  struct Watched : Watch<Real>, Which {};
  struct Event {
    Real time;
    std::optional<Which> watch;  // nothing: the end of the motion's series or of the run
  };

  const Driven<Real, Force>& oscillator() const { return joined_ ? *joined_ : system_.free; }
  Force force() const { return {system_.forcing.amplitude / mass_, system_.forcing.frequency}; }
  bool on_wall(std::size_t i) const { return masses_.u[i] == 0; }
  // Whether the i-th mass, held, leaves the cavity's place that it is at if it is let go in `direction`.
  bool may_go(std::size_t i, const Real& direction) const {
    return !on_wall(i) || masses_.away[i] == direction;
  }
  Real friction_of(std::size_t i) const { return friction_[i] * slides_[i]; }
  bool is_in_fluid(std::size_t i) const { return in_fluid && drag_[i] > 0; }
  // k of (M18.8), the constant part of -y'' of a mass that slides; 0 in a fluid, where the motion has all.
  Real pull(std::size_t i) const { return is_in_fluid(i) ? Real(0) : Real(friction_of(i) + weight_); }

  // Begins the motion of all masses as they are now; it lasts until the next is begun.
  Motion& begin_motion() {
    if constexpr (in_fluid) {
      forces_.friction.clear();
      forces_.others = 0;
      forces_.held = held_mass_;
      fluid_.clear();
      number_in_fluid_.assign(masses_.size(), 0);
      for (std::size_t i = 0; i < masses_.size(); ++i) {
        if (masses_.held[i]) continue;
        if (is_in_fluid(i)) {
          fluid_.push_back({masses_.nu[i], Real(0), drag_[i], Real(0), masses_.w(i)});
          forces_.friction.push_back(friction_of(i));
          number_in_fluid_[i] = fluid_.size();
        } else {
          forces_.others += masses_.nu[i] * friction_of(i);
        }
      }
      if (!motion_) motion_.emplace();
      motion_->begin(system_, tracker_.now(), x_, v_, fluid_, number_in_fluid_, forces_);
      return *motion_;
    } else {
      return motion_.emplace(oscillator(), force(), tracker_.now(), x_, v_, rest_);
    }
  }

  LocalEnclosure<Real> enclose(Now& now, const Real& t, const Which& which) const {
    const std::size_t i = which.mass;
    if (which.kind == Kind::lower_edge || which.kind == Kind::upper_edge) {
      auto&& x = now.of_x();
      const Real side = which.kind == Kind::lower_edge ? Real(1) : Real(-1);
      const Real& third = x.bound(5);
      return {{holds_[i] + side * (x[2] + weight_), side * x[3], side * x[4], third},
              {holds_[i] + side * weight_, Real(0), Real(0), Real(0)},
              x.bound(2)};
    }
    auto&& x = now.of_mass(i);
    const auto& [x_now, v_now, dx, dv] = x.displacement();
    const Real& away = masses_.away[i];
    const Real k = pull(i), u1 = masses_.u1[i] - away * (dv + k * t);
    if (which.kind == Kind::stop) {
      const Real& side = slides_[i];
      const Real w = away * u1;
      return {{side * w, -side * (x[2] + k), -side * x[3], x.bound(4)},
              {side * (w + v_now), -side * k, Real(0), Real(0)},
              x.bound(1)};
    }
    const Real u = masses_.u[i] + (masses_.u1[i] * t - away * (dx + k * t * t / 2));
    const Real up = which.kind == Kind::near_wall ? Real(1) : Real(-1),
               gap = up > 0 ? u : masses_.clearance[i] - u;
    const Real along = up * away;
    return {{gap, up * u1, -along * (x[2] + k), x.bound(3)},
            {gap + along * x_now, up * u1 + along * v_now, -along * k, Real(0)},
            x.bound(0)};
  }

  // Returns the next event, or the end of the motion's series or of the run.
  Event next_event(Motion& motion) {
    const Real remaining = tracker_.remaining(), length = motion.length();
    const Real until = length < remaining ? length : remaining;
    const Real resolution = watch_all(motion);
    Search<Real>& search = tracker_.search();
    const Real span = motion.span(search.span);
    Search<Real> of_motion{span, search.steps_left};
    const auto first = first_of_many<Real>(
        watched_, [&](const Real& t) { return Now(motion, t, span); },
        [&](Now& now, const Real& t, const Watched& each) { return enclose(now, t, each); }, until, of_motion,
        resolution);
    search.steps_left = of_motion.steps_left;
    if (!first) return {until, {}};
    return {first->time, watched_[first->which]};
  }
  // Sets watched_ to what may end the motion. Returns the shortest time in which one of these changes.
  //
  // Functions that begin at zero: the gap to a wall and the speed of a mass that leaves it, or begins to
  // slide, from rest. With y'' and y''' in its direction the mass goes on that way for 3 y'''/(2m), |y''''|
  // <= m, as in (M7.4), so that the search begins there if y'' is small. The gap after an impact, with its
  // slope > 0. The edge of a band: see settle().
  Real watch_all(Motion& motion) {
    watched_.clear();
    const Real span = motion.span(tracker_.search().span);
    Now now(motion, Real(0), span);
    const Driven<Real, Force>& its = oscillator();
    const Real rate = motion.rate(), epsilon = std::numeric_limits<Real>::epsilon();
    const Real of_x = its.b() * (absolute(x_) + absolute(rest_)) +
                      (2 * its.a() + its.root_b()) * absolute(v_) + absolute(force().amplitude) + weight_ +
                      size_of_drag() / mass_;
    Real resolution{1};
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Real& away = masses_.away[i];
      const Real& u1 = masses_.u1[i];
      const Real noise = 4 * at_edge * epsilon * (of_x + holds_[i]);
      if (masses_.held[i]) {
        const Real later = Real(masses_.held_since[i]) - tracker_.now();
        const Real begin = later > 0 ? later : Real(0);
        for (const Kind edge : {Kind::lower_edge, Kind::upper_edge})
          if (may_go(i, edge == Kind::lower_edge ? Real(1) : Real(-1)))
            watched_.push_back({{begin, 0, noise, noise * rate}, {i, edge}});
        continue;
      }
      auto&& x = now.of_mass(i);
      const Real k = pull(i), second = x[2] + k;
      Watch<Real> gap, speed;
      const Real direction = on_wall(i) ? away : slides_[i];
      if (u1 == 0 && direction != 0) {
        const Real third = -direction * x[3];
        if (-direction * second < third * Real(1e-6)) {
          const Real leaves = Real(1.5) * third / x.bound(4);
          gap.begin = speed.begin = leaves < span ? leaves : span;
        }
        if (!on_wall(i)) gap.begin = 0;
        if (on_wall(i)) gap.order = 2, gap.noise = gap.slope_noise = noise;
        speed.order = 1, speed.noise = speed.slope_noise = noise;
      }
      const Real most = absolute(x[2]) + absolute(k), &u = masses_.u[i];
      if (u1 != 0 || u > 0) {
        const Real changes = u1 != 0 ? Real(absolute(u1) / most) : square_root(Real(2 * u / most));
        if (changes < resolution) resolution = changes;
      }
      watched_.push_back({gap, {i, Kind::near_wall}});
      watched_.push_back({{}, {i, Kind::far_wall}});
      if (holds_[i] > 0) watched_.push_back({speed, {i, Kind::stop}});
    }
    return resolution;
  }

  // Advances all masses to `until`, or to an earlier stop. Returns whether rounding has turned a mass back
  // that has just begun to slide: it then counts as at rest.
  bool pass(const Motion& motion, const Real& until) {
    const auto last = motion.displacement(until);
    State<Real> end{last.x, last.v, Real(0), Real(0)};
    tracker_.pass(motion.of_x(), until, end, Real(0), [&](const Real& t) {
      const auto now = motion.displacement(t);
      Base::report_sample(t, now, [&](auto&& set) {
        for (std::size_t i = 0; i < masses_.size(); ++i) {
          const auto [du, du1] =
              masses_.held[i] ? std::array{Real(0), Real(0)} : gained(i, t, motion.of_mass(i, t, now));
          set(i, Real(masses_.u[i] + du), Real(masses_.u1[i] + du1));
        }
      });
    });
    const Real t = tracker_.passed();
    if (t == 0) return false;
    const auto x_now = t == until ? last : motion.displacement(t);
    bool stopped = false;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (masses_.held[i]) continue;
      const auto now = motion.of_mass(i, t, x_now);
      const auto [du, du1] = gained(i, t, now);
      rounding_of_w_[i] = 16 * std::numeric_limits<Real>::epsilon() *
                          (absolute(masses_.u1[i]) + absolute(now.dv) + absolute(pull(i)) * t);
      if constexpr (in_fluid)
        if (is_in_fluid(i) && observer_.wants_energy())
          by_drag_[i] += masses_.nu[i] * drag_[i] * motion.integral_of_ww(i, t);
      masses_.u[i] += du;
      masses_.u1[i] += du1;
      if (slides_[i] == 0) continue;
      if (observer_.wants_energy())
        by_friction_[i].advance(Real(masses_.nu[i] * friction_[i] * absolute(du)));
      if (slides_[i] * masses_.w(i) <= 0) {
        stop(i);
        stopped = true;
      }
    }
    x_ = x_now.x;
    v_ = x_now.v;
    return stopped;
  }
  // By how much u and u' of a mass that slides have grown at t (M18.8); now: the displacement that moves it.
  std::array<Real, 2> gained(std::size_t i, const Real& t, const Displacement<Real>& now) const {
    const Real k = pull(i), &away = masses_.away[i];
    return {masses_.u1[i] * t - away * (now.dx + k * t * t / 2), -away * (now.dv + k * t)};
  }
  // Sets y' of a mass to zero. If rounding has left it beyond a wall it is on that wall.
  void stop(std::size_t i) {
    masses_.u1[i] = 0;
    if (!(masses_.u[i] > 0)) masses_.u[i] = 0;
    if (!(masses_.clearance[i] - masses_.u[i] > 0)) masses_.arrive(i, opposite(masses_.wall(i)));
  }

  // Sets meeting_ to the masses that meet walls now, at the end of a motion of the length t.
  void find_impacts(Motion& motion, std::size_t i, Kind kind, const Real& t) {
    const Real span = t < tracker_.search().span ? t : tracker_.search().span;
    Base::find_meeting(
        meeting_, i, kind == Kind::near_wall, t,
        [&](std::size_t j) { return Real(motion.bound_of_mass(j, 2, span) + absolute(pull(j))); },
        [&](std::size_t j) { return bool(masses_.held[j]); });
  }

  // Decides who is held: of the masses at rest all that R = -(x'' + gamma), computed with all of them held,
  // does not move (M18.9). Who is let go makes |x'' + gamma| larger, and leaves its sign, so those that have
  // to go are the same in whatever order they go, and each pass lets all go that exceed their bound (18.5).
  // Then takes the limit of masses whose chattering is over soon.
  void settle() {
    settle_at_rest();
    for (std::size_t n = 0; n < masses_.size() && take_limits(); ++n) settle_at_rest();
    if constexpr (requires { observer_.settled(std::int32_t{}, PlaceInCavity{}, false, 0.0); })
      for (std::size_t i = 0; i < masses_.size(); ++i)
        observer_.settled(masses_.number[i], masses_.place(i, masses_.u[i], masses_.u1[i]),
                          bool(masses_.held[i]), double(slides_[i]));
  }
  void settle_at_rest() {
    stays_.assign(masses_.size(), false);
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      stays_[i] = masses_.u1[i] == 0 && (holds_[i] > 0 || on_wall(i));
      const Real w = masses_.w(i);
      slides_[i] = stays_[i] || !(holds_[i] > 0) ? Real(0) : w > 0 ? Real(1) : w < 0 ? Real(-1) : Real(0);
    }
    sum_up();
    for (bool again = true; again;) {
      again = false;
      const Acceleration now = acceleration();
      for (std::size_t i = 0; i < masses_.size(); ++i) {
        if (!stays_[i]) continue;
        for (const Real& direction : {Real(1), Real(-1)}) {
          if (!may_go(i, direction) || !goes(i, direction, now)) continue;
          stays_[i] = false;
          if (holds_[i] > 0) slides_[i] = direction;
          again = true;
          break;
        }
      }
      sum_up();
    }
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (!stays_[i]) {
        let_go(i);
      } else if (!masses_.held[i]) {
        Base::hold(i, Real(tracker_.now() + settles_[i]));
      }
      settles_[i] = 0;
    }
    if (1 + held_mass_ == mass_) return;
    mass_ = 1 + held_mass_;
    joined_.reset();
    if (held_mass_ > 0) joined_.emplace(system_.zeta / mass_, 1 / mass_, system_.forcing);
  }
  // The force of friction and drag on the primary mass.
  Real in_cavity(std::size_t i) const {
    const Real by_friction = masses_.nu[i] * friction_[i] * slides_[i];
    return is_in_fluid(i) ? Real(by_friction + masses_.nu[i] * drag_[i] * masses_.w(i)) : by_friction;
  }
  Real size_of_drag() const {
    Real size{0};
    for (std::size_t i = 0; in_fluid && i < masses_.size(); ++i)
      size += masses_.nu[i] * drag_[i] * absolute(masses_.u1[i]);
    return size;
  }
  // Sums over the masses in the state that stays_ and slides_ give: sigma, friction and drag, and `rest`.
  void sum_up() {
    held_mass_ = in_cavities_ = 0;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (stays_[i]) held_mass_ += masses_.nu[i];
      in_cavities_ += in_cavity(i);
    }
    rest_ = in_cavities_ - weight_ * held_mass_;
  }
  // x'' + gamma, the error that rounding may have left in it, and the sign of the first derivative of x from
  // x''' on that is not zero to rounding (M7.12), 0 if there is none.
  struct Acceleration {
    Real value, error, later;
  };
  Acceleration acceleration() const {
    const Real mass = 1 + held_mass_, a2 = 2 * system_.zeta,
               tiny = at_edge * std::numeric_limits<Real>::epsilon();
    const Force& forcing = system_.forcing;
    auto [f, f1] = forcing.template derivatives<2>(forcing.phase(tracker_.now()));
    Real amplitude = absolute(forcing.amplitude);
    Real friction = size_of_drag();
    for (std::size_t i = 0; i < masses_.size(); ++i)
      friction += masses_.nu[i] * friction_[i] * absolute(slides_[i]);
    Acceleration now{(f - a2 * v_ - x_ + in_cavities_ + weight_) / mass,
                     tiny * (amplitude + a2 * absolute(v_) + absolute(x_) + friction + weight_) / mass,
                     Real(0)};
    Real before = v_, last = now.value - weight_;
    if (absolute(last) <= now.error + tiny * weight_) last = 0;
    for (int n = 3; n < 7 && now.later == 0; ++n) {
      amplitude *= forcing.frequency;
      Real sum = f1 - a2 * last - before, size = amplitude + a2 * absolute(last) + absolute(before);
      for (std::size_t i = 0; in_fluid && i < masses_.size(); ++i) {
        if (stays_[i] || !is_in_fluid(i)) continue;
        // d w^(n-2), if x''' to x^(n-1) are zero.
        Real force = -(now.value + friction_of(i) + drag_[i] * masses_.w(i));
        for (int k = 3; k < n; ++k) force *= -drag_[i];
        force *= drag_[i];
        sum += masses_.nu[i] * force;
        size += masses_.nu[i] * absolute(force);
      }
      const bool is_zero = !(absolute(sum) > tiny * size);
      if (!is_zero) now.later = sum > 0 ? Real(1) : Real(-1);
      before = last;
      last = is_zero ? Real(0) : Real(sum / mass);
      const Real f2 = -forcing.frequency * forcing.frequency * f;
      f = f1;
      f1 = f2;
    }
    return now;
  }
  // Whether a mass at rest is let go in a direction.
  bool goes(std::size_t i, const Real& direction, const Acceleration& now) const {
    const Real excess = -direction * now.value - holds_[i],
               error = now.error + at_edge * std::numeric_limits<Real>::epsilon() * holds_[i];
    if (excess > error) return true;
    // Without friction a mass on which nothing ever acts is free, as in 7.3.
    return excess >= -error && (-direction * now.later > 0 || (now.later == 0 && holds_[i] == 0));
  }
  void let_go(std::size_t i) {
    if (!masses_.held[i]) return;
    if (on_wall(i))
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
    const Acceleration now = acceleration();
    if (!(absolute(now.value) > now.error)) return false;
    const Real side = now.value > 0 ? 1 : -1, epsilon = std::numeric_limits<Real>::epsilon();
    const Real x_scale = epsilon / 8 * (absolute(x_) + absolute(v_));
    candidates_.clear();
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (masses_.held[i] || masses_.away[i] != side || masses_.u1[i] == 0) continue;
      if (masses_.u[i] == 0 && masses_.u1[i] < 0) continue;  // an impact now, maybe with others, comes first
      const Real &u1 = masses_.u1[i], out = u1 > 0 ? u1 : Real(0),
                 high = masses_.u[i] > 0 ? masses_.u[i] : Real(0);
      if (masses_.nu[i] * (high + out * out / (4 * absolute(now.value))) <= mass_ * x_scale)
        candidates_.push_back(i);
    }
    if (candidates_.empty()) return false;
    // One whose bounces are over before anybody else moves on sees the others as they are now; else those
    // that kick each other have to join together.
    Motion& motion = begin_motion();
    for (const std::size_t i : candidates_) {
      joins_.assign(masses_.size(), false);
      joins_[i] = true;
      const Joined all = joined_with_all(side);
      if (all.a > holds_[i] && join_most(motion, side, all)) return true;
    }
    if (candidates_.size() == 1) return false;
    for (const std::size_t i : candidates_) joins_[i] = true;
    return join_most(motion, side, joined_with_all(side));
  }
  // x'' + gamma, times `side`, and the sums if all of joins_ have joined those that are held.
  struct Joined {
    Real a, mass, loses;  // loses: sum of nu (1 - e^2 r^2), see bounces_of()
  };
  Joined joined_with_all(const Real& side) const {
    Joined all{Real(0), mass_, Real(0)};
    Real friction = in_cavities_;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (joins_[i]) {
        all.mass += masses_.nu[i];
        friction -= in_cavity(i);
      }
    }
    const Real f = system_.forcing.template derivatives<2>(system_.forcing.phase(tracker_.now()))[0];
    all.a = side * (f - 2 * system_.zeta * v_ - x_ + friction + weight_) / all.mass;
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (joins_[i] || is_kicked(i, side)) all.loses += loses(i, all.a);
    return all;
  }
  // Whether impacts on the walls of `side` set a mass that is held in motion.
  bool is_kicked(std::size_t i, const Real& side) const {
    return masses_.held[i] && (!on_wall(i) || masses_.away[i] == side);
  }
  // The fraction r^2 of its energy with which a mass comes back to its wall: 0 where friction holds it above.
  Real comes_back(std::size_t i, const Real& a) const {
    return a > holds_[i] ? Real((a - friction_[i]) / (a + friction_[i])) : Real(0);
  }
  Real loses(std::size_t i, const Real& a) const {
    return masses_.nu[i] * (1 - masses_.e[i] * masses_.e[i] * comes_back(i, a));
  }
  // all.a: with all that join.
  Chattering bounces_of(std::size_t i, const Joined& all) const {
    const Real &nu = masses_.nu[i], &e = masses_.e[i], &phi = friction_[i], &u1 = masses_.u1[i];
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
    one.by_drag = drag_[i] * (up > one.landing ? up : one.landing);
    if (r > 0) {
      one.per_speed = (1 + 1 / r) / (out * one.lost);  // of the speed upwards
      one.lasts = up / out + (one.landing - down) / back;
      if (one.landing > 0) one.lasts += one.landing * ((1 - one.lost) / r) * one.per_speed;
    } else {  // it stops the next time that its speed is zero, after one impact at most
      one.per_speed = 1 / out;
      one.lasts = up / out + (down > 0 ? Real(2 * u / down) : Real(0)) + e * one.landing / out;
    }
    one.moves = nu * (down > 0 && r > 0 ? Real(one.landing * one.landing / (2 * back)) : top) / mass_;
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
      return masses_.lower_bound_of_meeting(i, Real(motion.bound_of_mass(i, 2, span) + absolute(pull(i))));
    };
    Real damping = 2 * system_.zeta;  // of the primary mass, with that by fluids
    for (std::size_t i = 0; i < masses_.size(); ++i) damping += masses_.nu[i] * drag_[i];
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
      sums_.push_back(sums_.back().with(each, masses_, all.a, friction_, holds_));
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
        if (joins_[i] || on_wall(i) || !(holds_[i] > 0)) continue;
        if (masses_.held[i] ? absolute(all.a) > holds_[i]
                            : absolute(masses_.u1[i]) <= change + friction_[i] * lasts)
          return false;
      }
      return true;
    };
    for (std::size_t count = chattering_.size(); count > 0; --count) {
      const Sums& sums = sums_[count];
      const Real heavy = all.mass * all.mass;
      const Real lasts = alone ? sums.longest : Real(sums.longest + sums.given_speed * sums.slowest * heavy);
      const Real speed = absolute(v_ + sums.momentum / (mass_ + sums.mass));
      const Real turns =
          sums.impulse / mass_ + (absolute(side * all.a - weight_) + sums.forces / mass_) * lasts;
      const Real changes =
          (m3 + m4 * lasts + damping * (all.a + weight_ + sums.forces) / mass_) * lasts + sums.by_drag;
      if (8 * sums.moves <= epsilon * (absolute(x_) + speed * lasts) && lasts < span &&
          (alone || lasts <= tolerance_) && changes <= tolerance_ * sums.margin && changes <= sums.holding &&
          ((speed > turns && friction_stays(turns, lasts)) || 2 * lasts <= epsilon * tracker_.now()) &&
          2 * lasts <= others_meet) {
        join(count, all, Real(sums.momentum / (mass_ + sums.mass)));
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
              const std::vector<Real>& friction, const std::vector<Real>& holds) const {
      const std::size_t i = each.index;
      const Real &nu = masses.nu[i], &e = masses.e[i];
      Sums all = *this;
      all.mass += nu;
      all.momentum += nu * masses.w(i);
      all.impulse += nu * (1 + e) * each.landing;
      all.moves += each.moves;
      all.forces += nu * (a + friction[i]);
      all.given_speed += nu / (1 + nu) * (1 + e) * each.landing / each.lost;
      if (longest < each.lasts) all.longest = each.lasts;
      if (slowest < each.per_speed) all.slowest = each.per_speed;
      if (by_drag < each.by_drag) all.by_drag = each.by_drag;
      if (a > holds[i] && a - friction[i] < margin) all.margin = a - friction[i];
      if (absolute(a - holds[i]) < holding) all.holding = absolute(a - holds[i]);
      return all;
    }
  };
  // Joins the first `count` masses of chattering_ to the primary mass; `jump` is that of x'.
  void join(std::size_t count, const Joined& all, const Real& jump) {
    for (std::size_t n = 0; n < count; ++n) {
      const Chattering& each = chattering_[n];
      const std::size_t i = each.index;
      const bool bounces = all.a > holds_[i];
      if (observer_.wants_energy()) {
        const Real w = masses_.w(i), loss = masses_.nu[i] * w * (w - jump) / 2;  // (M17.7)
        const Real by_friction = loss * each.by_friction;
        by_friction_[i].advance(by_friction);
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

  Energy energy_now() const {
    Energy energy = Base::energy_now([](std::size_t) { return Real(0); });
    energy.weight = Base::energy_of_weight(weight_);
    return energy;
  }

  // In roundings of the terms of x'': see the head of this file.
  static constexpr double at_edge = 8;

  Real tolerance_, weight_;
  bool lists_dampers_;
  std::vector<Real> friction_, holds_, drag_;  // phi, phi_s and d
  std::vector<Real> slides_;                   // the sign of y' where friction acts, else 0
  std::vector<Real> settles_;                  // how long chattering lasts whose limit has just been taken
  std::vector<Real> rounding_of_w_;            // of y' at the end of the last motion
  std::vector<Clock<Real>> by_friction_;       // lost: a sum of many small terms, as time is
  std::vector<Real> by_drag_;
  std::vector<char> stays_, joins_;
  Real held_mass_{0}, in_cavities_{0}, rest_{0};  // sigma, sum of nu (phi sgn w + d w), F of (M18.7)
  Real mass_{1};                                  // 1 + sigma
  std::optional<Driven<Real, Force>> joined_;     // the oscillator of this mass, if anything is held
  std::optional<Motion> motion_;
  std::vector<PushedWall<Real>> fluid_;  // the masses that slide in a fluid
  std::vector<std::size_t> number_in_fluid_;
  ConstantForces<Real> forces_;
  std::vector<Watched> watched_;
  std::vector<Meeting<Real>> meeting_;
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
  if (std::ranges::any_of(scene.dampers, [](const SceneDamper& each) { return each.drag != 0; }))
    return RestitutionWithComponents<Real, Force, Observer, true>(system, scene, options, observer).run();
  return RestitutionWithComponents<Real, Force, Observer, false>(system, scene, options, observer).run();
}

}  // namespace impact_damper
