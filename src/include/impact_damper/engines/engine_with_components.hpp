// What the exact and the restitution engine share in scenes with friction, static friction, weight or drag
// (docs/mathematics.md, chapter 18), with one or several dampers: the motion between two events, its first
// event, and the losses in the cavities.
//
// Each secondary mass slides, pushes a compliant wall, or is held: by friction anywhere in its cavity, or on
// a rigid wall. While no mass pushes a wall or slides in a fluid, the primary mass and those that are held
// are one oscillator about a shifted position of rest (M18.7), and every distance in a cavity is a parabola
// less the departure of x from its straight line (M18.8). Else all move by power series
// (motion_by_series.hpp), in pieces. Events are impacts, ends of contacts, stops (y' falls through zero), and
// ends of holding (M18.22). They are predicted and validated, or found by Lemma L1, among all masses at once
// (first_of_many.hpp).
//
// After each event settle() decides anew who is held. A decision and the search that follows it must not
// contradict each other by rounding, or the run would stay where it is: goes() counts x'' as being at the
// edge of a band within `at_edge` of the sizes of its terms, where its first later derivative that is not
// zero decides; the search lets a function fall from zero only beyond four times as much.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/engine_of_dampers.hpp"
#include "impact_damper/events/first_of_many.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/motion_by_series.hpp"
#include "impact_damper/motion/shifted_motion.hpp"

namespace impact_damper {

// Base class of these engines. Walls: EngineOfDampers or EngineWithRigidWalls. Engine has settle(), which
// decides who is held, follow(stopped_by_rounding), which follows a motion to its first event, take(event),
// which carries it out and returns false if it is an impact too many, and end(i), at the end of a run.
template <class Engine, class Walls, class Real, class Force, class Observer>
class EngineWithComponents : protected Walls {
 protected:
  using Walls::masses_, Walls::observer_, Walls::system_, Walls::tracker_, Walls::v_, Walls::x_;

  template <class Options>
  EngineWithComponents(const System<Real, Force>& system, const Scene& scene, const Options& options,
                       Observer& observer)
      : Walls(system, scene, options.budget, options.max_steps, observer),
        lists_dampers_(!has_one_damper(scene)) {
    forces_.weight = Real(scene.weight);
    for (const std::int32_t i : masses_.number) {
      const SceneDamper& damper = scene.dampers[i];
      each_.push_back({Real(damper.friction), Real(damper.holding()), Real(damper.drag)});
    }
  }

  struct Mass {
    Real friction, holds, drag;     // phi, phi_s and d
    Real stiffness{0}, damping{0};  // K and c of (M18.1); a rigid wall has none
    bool still = false;             // held by friction, or on a rigid wall
    bool stays = false;             // held before the present event as well (the exact engine's)
    Real slides{0};                 // the sign of y' where friction acts, else 0
    std::size_t in_series{0};       // 1 + its index in pushed_, 0 where it is not there
    WallContact<Real> contact{};    // with a compliant wall
    Clock<Real> by_friction{};      // lost: a sum of many small terms, as time is
    Real by_drag{0};
    Real rounding_of_u{0}, rounding_of_w{0};  // at the end of the last motion
  };
  // What falls through zero: the gap to the wall that a mass left last or to the other one, the depth in its
  // wall, its speed, or what x'' + gamma + K q is above the lower or below the upper edge of its band.
  enum class Kind { near_wall, far_wall, depth, stop, lower_edge, upper_edge };
  struct Which {
    std::size_t mass;
    Kind kind;
  };
  struct Watched : Watch<Real>, Which {};
  struct Event {
    Real time;
    std::optional<Which> watch;  // nothing: the end of the piece or of the run
  };
  // x'' + gamma, and the error that rounding may have left in it.
  struct Acceleration {
    Real value, error;
  };

  Outcome run_to_end() {
    Engine& engine = static_cast<Engine&>(*this);
    const bool balance = observer_.wants_energy();
    if (balance) {
      tracker_.begin(energy_now());
      Walls::note_kinetic(&DamperEnergy::initial_kinetic);
    }
    settle();
    while (!tracker_.stopped()) {
      bool stopped_by_rounding = false;
      const Event event = engine.follow(stopped_by_rounding);
      if (tracker_.stopped()) break;
      if (event.watch && !engine.take(*event.watch)) break;
      if (event.watch || stopped_by_rounding) settle();
    }
    if (balance) Walls::note_kinetic(&DamperEnergy::final_kinetic);
    const Energy last = energy_now();
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (masses_.held[i]) engine.end(i);
    if (balance) {
      for (std::size_t i = 0; i < masses_.size(); ++i)
        Walls::count_in_cavity(i, each_[i].by_friction.now(), each_[i].by_drag);
      Walls::finish(last);
      if (!lists_dampers_) observer_.energy_balance().dampers.clear();
    }
    return tracker_.outcome();
  }

  // q of (M18.1), and K q and c where the mass is in contact.
  Real q(std::size_t i) const { return masses_.away[i] * masses_.u[i]; }
  bool touches(std::size_t i) const { return masses_.held[i] && each_[i].stiffness > 0; }
  Real wall_spring(std::size_t i) const { return touches(i) ? Real(each_[i].stiffness * q(i)) : Real(0); }
  Real rate_damping(std::size_t i) const {
    return touches(i) ? Real(each_[i].damping + each_[i].drag) : each_[i].drag;
  }
  bool on_wall(std::size_t i) const { return masses_.u[i] == 0; }
  // Whether a mass that is held leaves its place if it is let go in `direction`.
  bool may_go(std::size_t i, const Real& direction) const {
    return each_[i].stiffness > 0 || !on_wall(i) || masses_.away[i] == direction;
  }
  Real friction_of(std::size_t i) const { return each_[i].friction * each_[i].slides; }
  // k of (M18.8), the constant part of -y'' of a mass that slides; 0 in the series, which have all.
  Real pull(std::size_t i) const {
    return each_[i].in_series > 0 ? Real(0) : Real(friction_of(i) + forces_.weight);
  }
  Real mass() const { return 1 + forces_.held; }
  // Sums up the masses that are held.
  void sum_up_held() {
    forces_.held = 0;
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (each_[i].still) forces_.held += masses_.nu[i];
  }

  // Begins the motion of all masses as they are now, which lasts until the next is begun, and returns
  // use(motion).
  template <class Use>
  auto with_motion(Use&& use) {
    pushed_.clear();
    forces_.friction.clear();
    forces_.others = 0;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Mass& mass = each_[i];
      mass.in_series = 0;
      if (mass.still) continue;
      const Real damping = rate_damping(i);
      if (!touches(i) && damping == 0) {
        forces_.others += masses_.nu[i] * friction_of(i);
        continue;
      }
      const bool pushes = touches(i);
      pushed_.push_back(
          {masses_.nu[i], pushes ? mass.stiffness : Real(0), damping, pushes ? q(i) : Real(0), masses_.w(i)});
      forces_.friction.push_back(friction_of(i));
      mass.in_series = pushed_.size();
    }
    if (!pushed_.empty()) {
      if (!series_) series_.emplace();
      series_->begin(system_.zeta, system_.forcing, tracker_.now(), x_, v_, pushed_, forces_);
      return use(*series_);
    }
    const Real all = mass(), rest = forces_.others - forces_.weight * forces_.held;
    if (forces_.held > 0 && joined_mass_ != all) {
      joined_.emplace(system_.zeta / all, 1 / all, system_.forcing);
      joined_mass_ = all;
    }
    ShiftedMotion<Real, Force> motion(forces_.held > 0 ? *joined_ : system_.free,
                                      {system_.forcing.amplitude / all, system_.forcing.frequency},
                                      tracker_.now(), x_, v_, rest);
    return use(motion);
  }
  // Follows the motion from now on to its first event.
  Event follow_motion(bool& stopped_by_rounding) {
    return with_motion([&](auto& motion) {
      const Event event = next_event(motion);
      const auto change = [&](const Real& t) { return motion.displacement(t); };
      const auto gained = [&](std::size_t i, const Real& t, const Displacement<Real>& x_now) {
        const Displacement<Real> now = motion.of_mass(each_[i].in_series, t, x_now);
        const Real k = pull(i), &away = masses_.away[i];
        return ChangeOfX<Real>{masses_.u1[i] * t - away * (now.dx + k * t * t / 2), -away * (now.dv + k * t)};
      };
      const auto sum_ww = [&](std::size_t i, const Real& t, const Work<Real>&) {
        return each_[i].in_series > 0 ? series_->integral_of_ww(each_[i].in_series, t) : Real(0);
      };
      stopped_by_rounding = pass(motion.of_x(), event.time, Real(0), change, gained, sum_ww);
      if (event.watch && (event.watch->kind == Kind::near_wall || event.watch->kind == Kind::far_wall)) {
        const Real& t = event.time;
        const Real span = motion.span(t < tracker_.search().span ? t : tracker_.search().span);
        Walls::find_meeting(
            meeting_, event.watch->mass, event.watch->kind == Kind::near_wall, t,
            [&](std::size_t j) {
              return Real(motion.bound_of_mass(each_[j].in_series, 2, span) + absolute(pull(j)));
            },
            [&](std::size_t j) { return masses_.held[j] || each_[j].still; });
      }
      return event;
    });
  }

  // A function at the time t of a motion, and its first two derivatives, at t = 0 the third. now: what drives
  // each mass then.
  template <class Now>
  Jet<Real> jet_of(Now& now, const Real& t, const Which& which) const {
    const std::size_t i = which.mass;
    const Mass& mass = each_[i];
    if (is_edge(which)) {
      auto&& x = now.of_mass(0);
      const Real side = which.kind == Kind::lower_edge ? Real(1) : Real(-1);
      return {mass.holds + side * (x[2] + forces_.weight + wall_spring(i)), side * x[3], side * x[4],
              Real(0)};
    }
    auto&& x = now.of_mass(mass.in_series);
    const auto& [x_now, v_now, dx, dv] = x.displacement();
    const Real& away = masses_.away[i];
    const Real k = pull(i), u1 = masses_.u1[i] - away * (dv + k * t);
    if (which.kind == Kind::stop) {
      const Real& side = mass.slides;
      return {side * (away * u1), -side * (x[2] + k), -side * x[3], t == 0 ? Real(-side * x[4]) : Real(0)};
    }
    const Real u = masses_.u[i] + (masses_.u1[i] * t - away * (dx + k * t * t / 2));
    const Real up = which.kind == Kind::near_wall ? Real(1) : Real(-1),
               gap = which.kind == Kind::far_wall ? Real(masses_.clearance[i] - u) : Real(up * u);
    const Real along = up * away;
    return {gap, up * u1, -along * (x[2] + k), t == 0 ? Real(-along * x[3]) : Real(0)};
  }
  // The same with bounds, and with what moves by x apart.
  template <class Now>
  LocalEnclosure<Real> enclose(Now& now, const Real& t, const Which& which) const {
    const std::size_t i = which.mass;
    Jet<Real> whole = jet_of(now, t, which);
    if (is_edge(which)) {
      auto&& x = now.of_mass(0);
      const Real side = which.kind == Kind::lower_edge ? Real(1) : Real(-1);
      whole.third = x.bound(5);
      return {whole, {whole.g - side * x[2], Real(0), Real(0), Real(0)}, x.bound(2)};
    }
    auto&& x = now.of_mass(each_[i].in_series);
    const Displacement<Real>& x_now = x.displacement();
    const Real k = pull(i);
    if (which.kind == Kind::stop) {
      const Real& side = each_[i].slides;
      whole.third = x.bound(4);
      return {whole, {whole.g + side * x_now.v, -side * k, Real(0), Real(0)}, x.bound(1)};
    }
    const Real along = masses_.away[i] * (which.kind == Kind::near_wall ? Real(1) : Real(-1));
    whole.third = x.bound(3);
    return {whole, {whole.g + along * x_now.x, whole.g1 + along * x_now.v, -along * k, Real(0)}, x.bound(0)};
  }
  static bool is_edge(const Which& which) {
    return which.kind == Kind::lower_edge || which.kind == Kind::upper_edge;
  }

  // Returns the next event, or the end of the motion's series or of the run.
  template <class Motion>
  Event next_event(Motion& motion) {
    using Now = typename Motion::Now;
    const Real remaining = tracker_.remaining(), length = motion.length();
    const Real until = length < remaining ? length : remaining;
    Search<Real>& search = tracker_.search();
    const Real span = motion.span(search.span);
    Now start(motion, Real(0), span);
    const Real resolution = watch_all(motion, start, span);
    Search<Real> of_motion{span, search.steps_left};
    const auto at = [&](const Real& t) { return Now(motion, t, span); };
    const auto enclose_at = [&](Now& now, const Real& t, const Watched& each) {
      return enclose(now, t, each);
    };
    const auto jet_at = [&](Now& now, const Real& t, const Watched& each) { return jet_of(now, t, each); };
    const auto guess = [](const Watched& each) { return fall_near_parabola(each.start); };
    const auto fourth = [&](const Watched& each) {
      return is_edge(each) ? start.of_mass(0).bound(6)
                           : start.of_mass(each_[each.mass].in_series).bound(each.kind == Kind::stop ? 5 : 4);
    };
    const auto predicted = predict_first<Real>(watched_, start, at, jet_at, guess, fourth, until, of_motion);
    const auto first = predicted
                           ? predicted->root
                           : first_of_many<Real>(watched_, at, enclose_at, until, of_motion, resolution);
    search.steps_left = of_motion.steps_left;
    if (!first) return {until, {}};
    return {first->time, watched_[first->which]};
  }
  // Sets watched_ to what may end the motion. Returns the shortest time in which one of these changes.
  //
  // Functions that begin at zero: the distance from a wall and the speed of a mass that leaves it, or begins
  // to slide, from rest. With y'' and y''' in its direction it goes on that way for 3 y'''/(2m) as in (M7.4),
  // m being a bound on |y''''|, so that the search begins there if y'' is small. The gap after an impact,
  // with its slope > 0. The edge of a band: see the head of this file.
  template <class Motion, class Now>
  Real watch_all(const Motion& motion, Now& now, const Real& span) {
    watched_.clear();
    const Acceleration acceleration_now = acceleration();
    Real resolution = motion.resolution();
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Mass& mass = each_[i];
      const Real &away = masses_.away[i], &u = masses_.u[i], &u1 = masses_.u1[i];
      const Real noise = noise_of(i, acceleration_now);
      if (mass.still) {
        const Real later = Real(masses_.held_since[i]) - tracker_.now();
        const Real begin = later > 0 ? later : Real(0);
        for (const Kind edge : {Kind::lower_edge, Kind::upper_edge})
          if (may_go(i, edge == Kind::lower_edge ? Real(1) : Real(-1)))
            watched_.push_back({{begin, 0, noise, noise * motion.rate()}, {i, edge}});
        continue;
      }
      auto&& x = now.of_mass(mass.in_series);
      const Real k = pull(i), second = x[2] + k;
      Watch<Real> gap, speed;
      const bool pushes = touches(i);
      const Real direction = mass.slides != 0 ? mass.slides
                             : on_wall(i)     ? (pushes ? Real(-away) : away)
                                              : Real(0);
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
      const Real most = absolute(x[2]) + absolute(k);
      if (u1 != 0 || u != 0) {
        const Real changes = u1 != 0 ? Real(absolute(u1) / most) : square_root(Real(2 * absolute(u) / most));
        if (changes < resolution) resolution = changes;
      }
      watched_.push_back({gap, {i, pushes ? Kind::depth : Kind::near_wall}});
      if (!pushes) watched_.push_back({{}, {i, Kind::far_wall}});
      if (mass.holds > 0) watched_.push_back({speed, {i, Kind::stop}});
    }
    return resolution;
  }

  // Advances all masses to `until`, or to an earlier stop. Returns whether rounding has turned a mass back
  // that has just begun to slide: it then counts as at rest. change(t): x at t; gained(i, t, change): by how
  // much u and u' of the i-th mass have grown; sum_ww(i, t, works): the integral of its w^2, works having
  // been computed for wall_damping.
  template <class Motion, class Change, class Gained, class SumOfWw>
  bool pass(const Motion& motion, const Real& until, const Real& wall_damping, Change&& change,
            Gained&& gained, SumOfWw&& sum_ww) {
    const Displacement<Real> last = change(until);
    State<Real> end{last.x, last.v, Real(0), Real(0)};
    const Work<Real> works = tracker_.pass(motion, until, end, wall_damping, [&](const Real& t) {
      const Displacement<Real> now = change(t);
      Walls::report_sample(t, now, [&](auto&& set) {
        for (std::size_t i = 0; i < masses_.size(); ++i) {
          const auto by = each_[i].still ? ChangeOfX<Real>{Real(0), Real(0)} : gained(i, t, now);
          set(i, Real(masses_.u[i] + by.dx), Real(masses_.u1[i] + by.dv));
        }
      });
    });
    const Real t = tracker_.passed();
    if (t == 0) return false;
    const Displacement<Real> now = t == until ? last : change(t);
    bool stopped = false;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Mass& mass = each_[i];
      if (mass.still) continue;
      const auto [du, du1] = gained(i, t, now);
      const Real epsilon = std::numeric_limits<Real>::epsilon(), speed = absolute(masses_.u1[i]),
                 pulled = absolute(pull(i)) * t;
      mass.rounding_of_u = 16 * epsilon * (absolute(masses_.u[i]) + speed * t + absolute(du) + pulled * t);
      mass.rounding_of_w = 16 * epsilon * (speed + absolute(du1) + pulled);
      if (observer_.wants_energy()) add_losses(i, sum_ww(i, t, works), Real(absolute(du)));
      masses_.u[i] += du;
      masses_.u1[i] += du1;
      if (mass.slides == 0 || mass.slides * masses_.w(i) > 0) continue;
      stop(i);
      stopped = true;
    }
    x_ = now.x;
    v_ = now.v;
    return stopped;
  }
  // way: that the mass has gone in its cavity, in one direction if it has friction.
  void add_losses(std::size_t i, const Real& sum_ww, const Real& way) {
    Mass& mass = each_[i];
    const Real& nu = masses_.nu[i];
    if (mass.slides != 0) mass.by_friction.advance(Real(nu * mass.friction * way));
    mass.by_drag += nu * mass.drag * sum_ww;
    if (touches(i)) mass.contact.work += nu * mass.damping * sum_ww;
  }
  // Sets y' of a mass to zero. If rounding has left it beyond a wall it is on that wall.
  void stop(std::size_t i) {
    masses_.u1[i] = 0;
    if (masses_.held[i]) return;
    if (!(masses_.u[i] > 0)) masses_.u[i] = 0;
    if (!(masses_.clearance[i] - masses_.u[i] > 0)) masses_.arrive(i, opposite(masses_.wall(i)));
  }
  // The same for all that rounding cannot tell apart from it.
  void stop_all(std::size_t i) {
    stop(i);
    for (std::size_t j = 0; j < masses_.size(); ++j)
      if (each_[j].slides != 0 && absolute(masses_.u1[j]) <= each_[j].rounding_of_w) stop(j);
  }

  // The force of friction, drag and wall on the primary mass, and the sum of the sizes of its parts.
  std::array<Real, 2> force_in_cavities() const {
    Real sum{0}, size{0};
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (each_[i].still) continue;
      const Real friction = friction_of(i), spring = wall_spring(i), damper = rate_damping(i) * masses_.w(i);
      sum += masses_.nu[i] * (friction + spring + damper);
      size += masses_.nu[i] * (absolute(friction) + absolute(spring) + absolute(damper));
    }
    return {sum, size};
  }
  // x'' + gamma as the masses are held now.
  Acceleration acceleration() const {
    const Force& forcing = system_.forcing;
    const Real f = forcing.template derivatives<2>(forcing.phase(tracker_.now()))[0], a2 = 2 * system_.zeta;
    const auto [in_cavities, size_in_cavities] = force_in_cavities();
    const Real size = absolute(forcing.amplitude) + a2 * absolute(v_) + absolute(x_) + forces_.weight;
    return {(f - a2 * v_ - x_ + forces_.weight + in_cavities) / mass(),
            tiny() * (size + size_in_cavities) / mass()};
  }
  Real error_for(std::size_t i, const Acceleration& now) const {
    return now.error + tiny() * (each_[i].holds + absolute(wall_spring(i)));
  }
  // What rounding errors may leave in y'' in a motion from now on, with what moves x meanwhile.
  Real noise_of(std::size_t i, const Acceleration& now) const {
    return 4 * (error_for(i, now) + tiny() * (absolute(v_) + forces_.weight));
  }
  // The direction in which a mass at rest is let go; 0 if it stays.
  Real goes(std::size_t i, const Acceleration& now) const {
    const Real needs = -(now.value + wall_spring(i)), &holds = each_[i].holds, error = error_for(i, now);
    for (const Real& direction : {Real(1), Real(-1)}) {
      const Real excess = direction * needs - holds;
      if (!(excess >= -error) || !may_go(i, direction)) continue;
      if (excess > error) return direction;
      const Real by_later = -direction * later(now);
      // Without friction a mass on which nothing ever acts is free, as in 7.3.
      if (by_later > 0 || (by_later == 0 && holds == 0 && each_[i].stiffness == 0)) return direction;
    }
    return 0;
  }
  // The sign of the first derivative of x from x''' on that is not zero to rounding (M7.12), 0 if there is
  // none among the next four.
  Real later(const Acceleration& now) const {
    const Force& forcing = system_.forcing;
    auto [f, f1] = forcing.template derivatives<2>(forcing.phase(tracker_.now()));
    const Real a2 = 2 * system_.zeta;
    Real amplitude = absolute(forcing.amplitude), before = v_, last = now.value - forces_.weight;
    if (absolute(last) <= now.error + tiny() * forces_.weight) last = 0;
    struct Moving {
      Real nu, spring, damping, q1, q2;  // q1, q2: two consecutive derivatives of q
    };
    std::vector<Moving> moving;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Mass& mass = each_[i];
      const Real damping = rate_damping(i), w = masses_.w(i);
      if (mass.still || (!touches(i) && damping == 0)) continue;
      const Real second = -(last + friction_of(i) + forces_.weight + damping * w + wall_spring(i));
      moving.push_back({masses_.nu[i], touches(i) ? mass.stiffness : Real(0), damping, w, second});
    }
    for (int n = 3; n < 7; ++n) {
      amplitude *= forcing.frequency;
      Real sum = f1 - a2 * last - before, size = amplitude + a2 * absolute(last) + absolute(before);
      for (const Moving& each : moving) {
        sum += each.nu * (each.damping * each.q2 + each.spring * each.q1);
        size += each.nu * (absolute(each.damping * each.q2) + absolute(each.spring * each.q1));
      }
      if (absolute(sum) > tiny() * size) return sum > 0 ? Real(1) : Real(-1);
      for (Moving& each : moving) {
        const Real next = -(each.damping * each.q2 + each.spring * each.q1);
        each.q1 = each.q2;
        each.q2 = next;
      }
      before = last;
      last = 0;
      const Real f2 = -forcing.frequency * forcing.frequency * f;
      f = f1;
      f1 = f2;
    }
    return 0;
  }

  Energy energy_now() const {
    Energy energy = Walls::energy_now([&](std::size_t i) {
      const Real& u = masses_.u[i];
      return touches(i) ? Real(masses_.nu[i] * each_[i].stiffness * (u * u)) : Real(0);
    });
    energy.weight = Walls::energy_of_weight(forces_.weight);
    return energy;
  }

  std::vector<Mass> each_;
  ConstantForces<Real> forces_;
  std::vector<Watched> watched_;
  std::vector<Meeting<Real>> meeting_;  // the masses that meet walls in the present event

 private:
  // In roundings of the terms of x'': see the head of this file.
  static constexpr double at_edge = 8;
  static Real tiny() { return at_edge * std::numeric_limits<Real>::epsilon(); }

  void settle() {
    static_cast<Engine&>(*this).settle();
    if constexpr (requires { observer_.settled(std::int32_t{}, PlaceInCavity{}, false, 0.0, false); })
      for (std::size_t i = 0; i < masses_.size(); ++i)
        observer_.settled(masses_.number[i], masses_.place(i, masses_.u[i], masses_.u1[i]), each_[i].still,
                          double(each_[i].slides), touches(i));
  }

  bool lists_dampers_;
  std::vector<PushedWall<Real>> pushed_;  // the masses that push a wall or slide in a fluid
  std::optional<MotionBySeries<Real, Force>> series_;
  std::optional<Driven<Real, Force>> joined_;  // the oscillator of the mass joined_mass_
  Real joined_mass_{0};
};

}  // namespace impact_damper
