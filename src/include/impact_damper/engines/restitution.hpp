// The restitution engine: Brown and North's model. Rigid walls, impacts that take no time.
//
// An impact turns the relative velocity w into -e w and keeps (1+nu) v + nu w. Between impacts the secondary
// mass flies (flight.hpp).
//
// Complete chattering, the paper's bounce-down, is an infinite sequence of impacts in a finite time (M6.1).
// Its impacts are stepped through one by one until the relative acceleration a towards the wall changes by
// less than the fraction Restitution::accumulation_tolerance within that time, the displacement that the
// limit ignores, nu w^2 / (2a (1+nu)), is below rounding of x, and x has no turning point within that time
// (M6.3). Then the engine takes the limit: the masses join, keep their momentum, and stick from the time
// (M6.2) later on. With the tolerance tol and |a'| <= m, the rebound speed w is then at most tol a^2 (1-e) /
// 2m; at the default tolerance that is some 1e-9, or where a' is small, as after a release from rest, what
// (M6.3) allows. Chattering that begins with w takes about ln(2 m w / (tol a^2 (1-e))) / ln(1/e) impacts
// until then; the energy of the impacts left out, nu w^2 / (2 (1+nu)), is recorded as bounce_down_loss.
//
// A restitution that depends on the speed is e(|w|); then the limit is also for impacts so slow that all have
// the same (M18.19).
//
// Sticking masses move by (M2.3) until the wall's push on the secondary mass, nu x'', vanishes.
#pragma once

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/observer.hpp"
#include "impact_damper/engines/run_tracker.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/impact_law.hpp"
#include "impact_damper/motion/sticking.hpp"

namespace impact_damper {

// Runs a scene without a list of dampers, friction, weight and drag.
template <Scalar Real, RunObserver Observer>
Outcome run_restitution(const Checked& run, Observer& observer) {
  require_no_components(run.scene());
  return with_system<Real>(run.scene(), [&](const auto& system) {
    return run_restitution(system, run.scene(), run.options<Restitution>(), observer);
  });
}

template <class Real, class Force, class Observer>
Outcome run_restitution(const System<Real, Force>& system, const Scene& scene, const Restitution& options,
                        Observer& observer) {
  require_arithmetic();
  RunTracker<Real, Force, Observer> tracker(scene, system, options.budget, options.max_steps, observer);
  const Pairs& by_speed = scene.damper().restitution_by_speed;
  const bool varies = !by_speed.empty();
  const Real nu = system.nu, e = varies ? restitution_at(by_speed, Real(0)) : system.e, zeta = system.zeta,
             tolerance = options.accumulation_tolerance;

  State<Real> state{Real(scene.x0), Real(scene.v0), Real(scene.damper().y0), Real(scene.damper().w0)};
  tracker.begin(state, Real(0));
  Real losses{0};

  // Whether a secondary mass on a wall sticks to it. At rest it does if it is pressed against the wall. With
  // w > 0 away from the wall it does after a time `accumulation`, which this sets, if its bouncing is too
  // short to follow. Else it bounces on, or is released.
  Wall wall = state.y <= Real(0.5) ? Wall::left : Wall::right;
  Real accumulation{0};
  const auto sticks = [&](const Flight<Real, Force>& flight) {
    const Real away = wall == Wall::left ? 1 : -1;
    const Real speed = away * state.w;
    if (speed < 0) return false;
    const auto y = flight.derivatives_of_y();
    const Real push = -away * y[2];
    accumulation = 0;
    if (speed == 0) return flight.sticks();
    if (!(push > 0) || e == 1) return false;
    if (varies && !is_settled(by_speed, speed, Real(tolerance * (1 - e)))) return false;
    accumulation = 2 * speed / (push * (1 - e));
    const Real change_of_push = -away * y[3];
    // The acceleration changes in flight, and by the impacts (M6.2).
    const auto steady_for = [&](const Real& rate) {
      return (rate + 2 * zeta * push) * accumulation <= tolerance * push;
    };
    if (!(steady_for(absolute(y[3])) && accumulation < tracker.search().span &&
          steady_for(absolute(y[3]) + flight.fourth_of_y(tracker.search().span) * accumulation)))
      return false;
    // (M6.3). x' of the joined masses, and by how much x' may differ from it meanwhile.
    const Real epsilon = std::numeric_limits<Real>::epsilon(), share = nu / (1 + nu);
    const Real joined_speed = absolute(state.v + share * state.w);
    const Real ignored = share * speed * speed / (2 * push);
    if (!(8 * ignored <= epsilon * (absolute(state.x) + joined_speed * accumulation))) return false;
    const bool may_turn = joined_speed <= share * (1 + e) * speed + push * accumulation;
    if (may_turn && !(2 * accumulation <= epsilon * tracker.now())) return false;
    accumulation -= accumulation * accumulation * (change_of_push / (3 * push) + zeta * e * nu / (1 + nu));
    return true;
  };

  bool on_wall = (state.y == 0 || state.y == 1) && state.w == 0, released = false;
  while (!tracker.stopped()) {
    Flight<Real, Force> flight(system, tracker.now(), state);
    if (on_wall && !released && sticks(flight)) {
      const Real joined = nu * state.w / (1 + nu);
      if (observer.wants_energy() && state.w != 0) {
        const Real loss = joined * state.w / 2;
        losses += loss;
        ++observer.energy_balance().bounce_downs;
        observer.energy_balance().bounce_down_loss += double(loss);
      }
      Stuck<Real, Force> stuck(system, tracker.now(), state.x, state.v + joined, wall);
      const Real begin = tracker.now() + accumulation;
      const auto release = stuck.release(accumulation, tracker.remaining(), tracker.search());
      if (release) state = stuck.released(*release);
      tracker.pass(stuck, release ? *release : tracker.remaining(), state, Real(0));
      if (observer.wants_contacts() && begin <= tracker.now())
        observer.contact(double(begin), tracker.time(), wall);
      released = true;
      continue;
    }
    released = false;

    const auto met = pass_flight(system, tracker, flight, state, on_wall && state.w == 0);
    if (!met) break;
    wall = *met;
    if (!tracker.impact(wall, state)) break;
    const Real now_e = varies ? restitution_at(by_speed, absolute(state.w)) : e;
    if (observer.wants_energy()) {
      const Real loss = nu * (1 - now_e) * (1 + now_e) * state.w * state.w / (2 * (1 + nu));
      losses += loss;
      observer.energy_balance().impact_loss.push_back(double(loss));
    }
    state.v += nu * (1 + now_e) * state.w / (1 + nu);
    state.w *= -now_e;
    on_wall = true;
  }
  tracker.finish(state, Real(0), losses);
  return tracker.outcome();
}

}  // namespace impact_damper
