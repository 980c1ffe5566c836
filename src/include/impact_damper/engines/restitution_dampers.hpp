// The restitution engine for several dampers on one primary mass (docs/mathematics.md, chapter 17): rigid
// walls, impacts that take no time, simultaneous ones by Moreau's law (motion/impact_law.hpp).
//
// Between two events the primary mass and those that stick to it are one oscillator (M17.1), and each other
// secondary mass flies straight. Its state is the distance u from the wall that it left last, and u'. From
// one event to the next all distances change by the same departure of x from its straight line, which costs
// little. The impact times are found one by one, as for one damper (flight.hpp), but only for the masses that
// may be the first: a bound on x'' excludes the others (M17.8).
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/chattering.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/rigid_walls.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/sticking.hpp"

namespace impact_damper {

template <class Real, class Force, class Observer>
class RestitutionOfDampers : EngineWithRigidWalls<Real, Force, Observer> {
  using Base = EngineWithRigidWalls<Real, Force, Observer>;
  using Base::energy_of, Base::losses_, Base::masses_, Base::next_meeting_, Base::observer_, Base::system_,
      Base::tracker_, Base::v_, Base::x_;

 public:
  RestitutionOfDampers(const System<Real, Force>& system, const Scene& scene, const Restitution& options,
                       Observer& observer)
      : Base(system, scene, options.budget, options.max_steps, observer),
        chattering_(masses_, options.accumulation_tolerance) {}

  Outcome run() {
    if (observer_.wants_energy()) {
      tracker_.begin(energy_now());
      Base::note_kinetic(&DamperEnergy::initial_kinetic);
    }
    settle();
    while (!tracker_.stopped()) {
      Motion motion(oscillator(), force(), tracker_.now(), x_, v_, push_);
      const Event event = next_event(motion);
      pass(motion, event.time);
      if (tracker_.stopped()) break;
      if (!event.meeting.empty()) {
        if (!Base::impacts(event.meeting)) break;
        settle();
      } else if (event.released) {
        keep_sticking(Real(0));  // side 0 releases all; none can stick again before the next event
      }
    }
    for (std::size_t i = 0; i < masses_.size(); ++i) let_go(i);
    if (observer_.wants_energy()) {
      Base::note_kinetic(&DamperEnergy::final_kinetic);
      Base::finish(energy_now());
    }
    return tracker_.outcome();
  }

 private:
  // The motion of the primary mass and the masses that stick to it, from now until the next event.
  using Motion = JoinedMasses<Real, Force>;
  struct Event {
    Real time;
    bool released;
    std::span<const Meeting<Real>> meeting;
  };

  const Driven<Real, Force>& oscillator() const { return joined_ ? *joined_ : system_.free; }
  Force force() const { return {system_.forcing.amplitude / mass_, system_.forcing.frequency}; }

  // Returns the next event: a release, impacts, or the end of the motion's series or of the run.
  Event next_event(Motion& motion) {
    const Real remaining = tracker_.remaining(), length = motion.primary().length();
    Event event{length < remaining ? length : remaining, false, {}};
    if (push_ != 0) {
      const auto release = motion.release(not_followed_, event.time, tracker_.search());
      if (release) event = {*release, true, {}};
    }
    const auto meeting = next_meeting_.find(masses_, motion.primary(), x_, v_, event.time, tracker_.search());
    if (!meeting.empty()) event = {meeting.front().time, false, meeting};
    return event;
  }

  // Advances all masses to `until`, or to an earlier stop. The only events on the way are those of the half
  // cycles of x.
  void pass(const Motion& motion, const Real& until) {
    const auto last = next_meeting_.primary_at(motion.primary(), until);
    State<Real> end{last.x, last.v, Real(0), Real(0)};
    const auto stuck = [&](auto&& set) {
      for (std::size_t i = 0; some_rest_ && i < masses_.size(); ++i)
        if (masses_.held[i]) set(i, Real(0), Real(0));
    };
    tracker_.pass(motion, until, end, Real(0),
                  [&](const Real& t) { Base::report_sample(t, motion.primary().at(t), stuck); });
    const Real t = tracker_.passed();
    if (t == 0) return;
    Base::advance(t, t == until ? last : motion.primary().at(t), stuck);
    not_followed_ = 0;
  }

  // force: (1 + sigma) x'', the F of chapter 17.1, or 0 if that is zero to rounding. side: the sign of x''
  // or, where it is zero, of its first derivative that is not.
  struct Acceleration {
    Real force, side;
  };
  // Decides which of the masses at rest on a wall stick: those that x'' presses against it, and those whose
  // chattering ends so soon that its limit is taken.
  void settle() {
    const Acceleration now = acceleration();
    keep_sticking(now.side);
    if (now.side == 0) return;
    const auto gained = chattering_.find({&oscillator(), system_.forcing, system_.zeta, mass_, some_rest_,
                                          tracker_.now(), x_, v_, tracker_.search().span},
                                         now.force, now.side);
    if (!gained) return;
    join(*gained, now);
    keep_sticking(now.side);
  }
  // Lets the masses that rest on `side` stick, 1 for the left walls, -1 for the right ones. All others fly.
  void keep_sticking(const Real& side) {
    some_rest_ = false;
    Real sticking{0};
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (masses_.rests(i) && masses_.away[i] == side) {
        if (!masses_.held[i]) stick(i, Real(0));
        sticking += masses_.nu[i];
        some_rest_ = true;
      } else {
        let_go(i);
      }
    }
    push_ = some_rest_ ? side : Real(0);
    if (1 + sticking == mass_) return;
    mass_ = 1 + sticking;
    joined_.reset();
    if (some_rest_) joined_.emplace(system_.zeta / mass_, 1 / mass_, system_.forcing);
  }
  Acceleration acceleration() const {
    const Lead<Real> lead = lead_of_x(Real(2 * system_.zeta), Real(1), system_.forcing,
                                      system_.forcing.phase(tracker_.now()), x_, v_);
    return {lead.order == 2 ? lead.value : Real(0), lead.side()};
  }
  void stick(std::size_t i, const Real& later) {
    Base::hold(i, Real(tracker_.now() + later));
    masses_.u[i] = masses_.u1[i] = 0;
  }
  void let_go(std::size_t i) {
    if (masses_.held[i]) Base::let_go(i);
  }

  // Lets all masses stick from now on whose chattering ends; `gained` is the jump of x'.
  void join(const Real& gained, const Acceleration& now) {
    auto& joining = chattering_.joining();
    const bool alone = joining.size() == 1 && !some_rest_;
    const Real a = absolute(now.force) / mass_;
    for (auto& each : joining) {
      const std::size_t i = each.index;
      if (alone) {  // (M6.2)
        const ForcedMotion<Real, Force> motion(oscillator(), force(), tracker_.now(), x_, v_);
        const Real change = now.side * motion.beginning()[3];
        each.lasts -= each.lasts * each.lasts *
                      (change / (3 * a) + system_.zeta * masses_.e[i] * masses_.nu[i] / (1 + masses_.nu[i]));
      }
      if (observer_.wants_energy()) {
        const Real w = masses_.w(i), loss = masses_.nu[i] * w * (w - gained) / 2;  // (M17.7)
        losses_ += loss;
        DamperEnergy& energy = energy_of(i);
        energy.bounce_down_loss += double(loss);
        ++energy.bounce_downs;
        observer_.energy_balance().bounce_down_loss += double(loss);
        ++observer_.energy_balance().bounce_downs;
      }
      if (not_followed_ < each.lasts) not_followed_ = each.lasts;
    }
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (!masses_.held[i]) masses_.u1[i] -= masses_.away[i] * gained;
    v_ += gained;
    for (const auto& each : joining) stick(each.index, each.lasts);
  }

  Energy energy_now() const {
    return Base::energy_now([](std::size_t) { return Real(0); });
  }

  Real mass_{1};                               // of the primary mass and what sticks to it
  std::optional<Driven<Real, Force>> joined_;  // their oscillator, if anything sticks
  Real push_{0};                               // the side on which masses stick, 1 or -1; 0: none sticks
  bool some_rest_ = false;
  Real not_followed_{0};  // how long the chattering whose limit has been taken lasts
  ChatteringLimit<Real, Force> chattering_;
};

// Runs a scene with a list of dampers, without friction, weight and drag.
template <Scalar Real, DampersObserver Observer>
Outcome run_restitution_dampers(const Checked& run, Observer& observer) {
  require_no_components(run.scene());
  return with_system<Real>(run.scene(), [&](const auto& system) {
    return run_restitution_dampers(system, run.scene(), run.options<Restitution>(), observer);
  });
}

template <class Real, class Force, class Observer>
Outcome run_restitution_dampers(const System<Real, Force>& system, const Scene& scene,
                                const Restitution& options, Observer& observer) {
  require_arithmetic();
  return RestitutionOfDampers<Real, Force, Observer>(system, scene, options, observer).run();
}

}  // namespace impact_damper
