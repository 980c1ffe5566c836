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
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/engine_of_dampers.hpp"
#include "impact_damper/math/scalar.hpp"
#include "impact_damper/motion/impact_law.hpp"
#include "impact_damper/motion/sticking.hpp"

namespace impact_damper {

template <class Real, class Force, class Observer>
class RestitutionOfDampers : EngineOfDampers<Real, Force, Observer> {
  using Base = EngineOfDampers<Real, Force, Observer>;
  using Base::energy_of, Base::losses_, Base::masses_, Base::next_meeting_, Base::observer_, Base::system_,
      Base::tracker_, Base::v_, Base::x_;

 public:
  RestitutionOfDampers(const System<Real, Force>& system, const Scene& scene, const Restitution& options,
                       Observer& observer)
      : Base(system, scene, options.budget, options.max_steps, observer), options_(options) {}

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
        if (!impacts(event.meeting)) break;
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

  // Carries out the impacts of the masses in `meeting` (M17.2), which also push masses at rest on a wall.
  // Returns false if these are more than the impact budget allows: the run then stops before them.
  bool impacts(std::span<const Meeting<Real>> meeting) {
    if (!tracker_.has_room_for(std::int64_t(meeting.size()))) return false;
    at_walls_.clear();
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const auto meets = [&](const Meeting<Real>& each) { return each.index == i; };
      if (masses_.rests(i) && std::none_of(meeting.begin(), meeting.end(), meets))
        at_walls_.push_back(mass_at_wall(i));
    }
    const std::size_t resting = at_walls_.size();
    for (const Meeting<Real>& each : meeting) {
      const std::size_t i = each.index;
      masses_.arrive(i, each.wall);
      at_walls_.push_back(mass_at_wall(i));
    }
    reported_.assign(at_walls_.begin() + std::ptrdiff_t(resting), at_walls_.end());
    std::sort(reported_.begin(), reported_.end(), [&](const auto& one, const auto& other) {
      return masses_.number[one.index] < masses_.number[other.index];
    });
    for (const MassAtWall<Real>& each : reported_) Base::report_impact(each.index, masses_.wall(each.index));
    std::sort(at_walls_.begin(), at_walls_.end(),
              [](const auto& one, const auto& other) { return one.index < other.index; });
    const Real jump = jump_of_velocity<Real>(at_walls_);
    // The jump of x' changes u' of all masses; those at walls then get the speeds that they have after the
    // impact.
    for (std::size_t i = 0; i < masses_.size(); ++i) masses_.u1[i] -= masses_.away[i] * jump;
    for (const MassAtWall<Real>& each : at_walls_) {
      masses_.u1[each.index] = speed_after(each, jump);
      if (masses_.held[each.index] && masses_.u1[each.index] > 0) let_go(each.index);
    }
    v_ += jump;
    if (observer_.wants_energy()) {
      for (const MassAtWall<Real>& each : reported_) {
        const Real after = masses_.u1[each.index];
        const Real impulse = each.nu * (after - (each.speed - each.away * jump));
        const Real loss = -impulse * (each.speed + after) / 2;  // (M17.4)
        losses_ += loss;
        energy_of(each.index).impact_loss += double(loss);
        observer_.energy_balance().impact_loss.push_back(double(loss));
      }
    }
    return true;
  }
  MassAtWall<Real> mass_at_wall(std::size_t i) const {
    return {i, masses_.nu[i], masses_.e[i], masses_.away[i], masses_.u1[i]};
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
    if (now.side != 0 && take_limit_of_chattering(now)) keep_sticking(now.side);
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

  // Takes the limit of complete chattering: masses on the side to which x'' leads join the primary mass now
  // if their chattering ends before any other event and moves x by less than rounding (M17.5). Returns
  // whether any join.
  bool take_limit_of_chattering(const Acceleration& now) {
    const Real a = absolute(now.force) / mass_;
    const Real span = tracker_.search().span;
    if (!(a > 0)) return false;
    const OnSide all = find_chattering(a, now.side);
    if (chattering_.empty()) return false;
    Real m3{0}, m4{0};
    bool has_bounds = false;
    const Real epsilon = std::numeric_limits<Real>::epsilon(), tolerance = options_.accumulation_tolerance;
    const auto ends_soon = [&](const Real& duration) {
      if (!has_bounds) {
        const ForcedMotion<Real, Force> motion(oscillator(), force(), tracker_.now(), x_, v_);
        m3 = absolute(motion.beginning()[3]);
        m4 = motion.bound(4, span);
        has_bounds = true;
      }
      return duration < span &&
             (m3 + m4 * duration + 2 * system_.zeta * a / mass_) * duration <= tolerance * a;
    };
    std::erase_if(chattering_, [&](Chattering& each) {
      each.settles = settling_of(each.index, all, absolute(now.force));
      each.lasts = duration_of(each);
      return !(8 * each.moves <= epsilon * (absolute(x_) + absolute(v_) * each.lasts)) ||
             !ends_soon(each.lasts);
    });
    // Those whose chattering ends first join, as many as can. A mass that bounces longer, or meets its wall
    // meanwhile, is left out. Every number is tried: a mass left out that could join would bounce for ever.
    std::sort(chattering_.begin(), chattering_.end(), [](const Chattering& one, const Chattering& other) {
      return one.lasts < other.lasts || (one.lasts == other.lasts && one.index < other.index);
    });
    const std::optional<Joining> found = most_that_join(all, absolute(now.force), ends_soon);
    if (!found) return false;
    join(Real(found->momentum / (mass_ + found->mass)), now.side, a);
    return true;
  }
  // a_i and lambda_i of (M17.6): the acceleration with which a mass comes back to its wall, and the fraction
  // of its speed that it loses at each bounce.
  struct Settling {
    Real a, lost;
    Real per_speed() const { return 2 / (a * lost); }  // duration of all bounces
  };
  struct Chattering {
    std::size_t index;
    Real speed;  // r of (M17.5), with which it comes back to its wall
    Real moves;  // its term of (M17.5), by which x moves at most
    Settling settles{};
    Real lasts{0};
  };
  // Sums over the masses that chatter or stick on one side, J in 17.3: nu, and nu (1 - e^2). A mass that
  // throws them off their walls loses speed to them (M17.6).
  struct OnSide {
    Real mass{0}, loses{0};
  };
  // Sets chattering_ to the masses in flight on `side` whose bounces move x by less than rounding, under the
  // acceleration a of x. Returns the sums over these and those that stick there.
  OnSide find_chattering(const Real& a, const Real& side) {
    chattering_.clear();
    OnSide all;
    const Real moves_little = std::numeric_limits<Real>::epsilon() * (absolute(x_) + absolute(v_)) / 8,
               per_moves = 2 * a * mass_;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Real& u1 = masses_.u1[i];
      const Real square =
          masses_.held[i] ? Real(0) : Real(u1 * u1 + 2 * a * (masses_.u[i] > 0 ? masses_.u[i] : Real(0)));
      // This test excludes most masses without a division. It precedes that of the side, a branch that no
      // processor predicts.
      if (!(masses_.nu[i] * square <= 2 * moves_little * per_moves) || masses_.away[i] != side) continue;
      const Real moves = masses_.nu[i] * square / per_moves;
      if (!(moves <= moves_little)) continue;
      all.mass += masses_.nu[i];
      all.loses += loses(i);
      if (masses_.held[i]) continue;
      chattering_.push_back({i, square_root(square), moves});
    }
    return all;
  }
  // Returns a_i and lambda_i of (M17.6). All others on the side of the i-th mass are taken to be at rest, as
  // they are most of the time: the present state may be that of a moment in which one has just been thrown
  // off its wall. force: |F|, on all of them and the primary mass.
  Settling settling_of(std::size_t i, const OnSide& all, const Real& force) const {
    const Real &nu = masses_.nu[i], &e = masses_.e[i], joined = 1 + (all.mass - nu);
    const Real lost = (1 - e) + (1 + e) * (nu / (1 + nu)) * ((all.loses - loses(i)) / joined);
    return {force / joined, lost < 1 ? lost : Real(1)};
  }
  // Returns T_i of (M17.6), how long a mass chatters.
  Real duration_of(const Chattering& one) const {
    const auto& [a, lost] = one.settles;
    const Real &u = masses_.u[one.index], &u1 = masses_.u1[one.index];
    const Real speed = square_root(Real(u1 * u1 + 2 * a * (u > 0 ? u : Real(0))));
    const Real more = 2 * (1 - lost) / lost;
    return (u1 + speed + more * speed) / a;
  }
  // Lets all of chattering_ stick from now on; `gained` is the jump of x'. a: |x''|, side: its sign.
  void join(const Real& gained, const Real& side, const Real& a) {
    const bool alone = chattering_.size() == 1 && !some_rest_;
    for (Chattering& each : chattering_) {
      const std::size_t i = each.index;
      if (alone) {  // (M6.2)
        const ForcedMotion<Real, Force> motion(oscillator(), force(), tracker_.now(), x_, v_);
        const Real change = side * motion.beginning()[3];
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
    for (const Chattering& each : chattering_) stick(each.index, each.lasts);
  }
  // Sums over the first masses of chattering_. impulse: nu (1 + e) r, the second sum of (M17.5).
  struct Joining {
    Real mass{0}, momentum{0}, impulse{0}, moves{0};
    Real given_speed{0};  // the sum in (M17.21): speed that they give to another mass
    Real duration{0};     // (M17.21)
  };
  // Shortens chattering_ to as many of its first masses as can join, and returns their sums; nothing if none
  // can.
  template <class EndsSoon>
  std::optional<Joining> most_that_join(const OnSide& everyone, const Real& on_all, EndsSoon&& ends_soon) {
    Real slowest{0};  // the largest 2/(a lambda) of (M17.21)
    for (std::size_t i = 0; some_rest_ && i < masses_.size(); ++i) {
      if (!masses_.held[i]) continue;
      const Real per_speed = settling_of(i, everyone, on_all).per_speed();
      if (slowest < per_speed) slowest = per_speed;
    }
    const Real a = on_all / mass_, heavy = (1 + everyone.mass) * (1 + everyone.mass);
    const bool alone =
        !some_rest_ && !chattering_.empty() && everyone.mass == masses_.nu[chattering_.front().index];
    joining_.assign(1, {});
    Real longest{0};
    for (const Chattering& each : chattering_) {
      const std::size_t i = each.index;
      Joining all = joining_.back();
      all.mass += masses_.nu[i];
      all.momentum += masses_.nu[i] * masses_.w(i);
      all.impulse += masses_.nu[i] * (1 + masses_.e[i]) * each.speed;
      all.moves += each.moves;
      all.given_speed +=
          masses_.nu[i] / (1 + masses_.nu[i]) * (1 + masses_.e[i]) * each.speed / each.settles.lost;
      if (longest < each.lasts) longest = each.lasts;
      const Real of_others = slowest, own = each.settles.per_speed();
      if (slowest < own) slowest = own;
      all.duration = longest + all.given_speed * (joining_.size() == 1 ? of_others : slowest) * heavy;
      joining_.push_back(all);
    }
    Real most{0};                     // a bound on |x''|
    std::optional<Real> others_meet;  // a lower bound of this time for the masses left out
    for (std::size_t count = chattering_.size(); count > 0; --count) {
      const Joining& all = joining_[count];
      if ((alone || all.duration <= options_.accumulation_tolerance) && limit_holds(all, a, ends_soon)) {
        if (!others_meet) {
          const Real until = 2 * all.duration, most_span = tracker_.search().span;
          const Real span = until < most_span ? until : most_span;
          most = ForcedMotion<Real, Force>(oscillator(), force(), tracker_.now(), x_, v_).bound(2, span);
          others_meet = first_meeting(most, span, count);
        }
        if (*others_meet >= 2 * all.duration) {
          chattering_.resize(count);
          return all;
        }
      }
      if (!others_meet) continue;
      // From now on this one is left out, too.
      const Real time = masses_.lower_bound_of_meeting(chattering_[count - 1].index, most);
      if (time < *others_meet) others_meet = time;
    }
    return std::nullopt;
  }
  // Whether (M17.5) holds, except that the masses left out are not looked at.
  template <class EndsSoon>
  bool limit_holds(const Joining& all, const Real& a, EndsSoon&& ends_soon) const {
    const Real epsilon = std::numeric_limits<Real>::epsilon();
    const Real speed = absolute(v_ + all.momentum / (mass_ + all.mass));
    if (!(8 * all.moves <= epsilon * (absolute(x_) + speed * all.duration)) || !ends_soon(all.duration))
      return false;
    const bool may_turn = speed <= all.impulse / mass_ + a * all.duration;
    return !may_turn || 2 * all.duration <= epsilon * tracker_.now();
  }
  Real loses(std::size_t i) const { return masses_.nu[i] * (1 - masses_.e[i] * masses_.e[i]); }
  // Returns a lower bound, `span` at most, of the time at which a mass in flight meets a wall while |x''| <=
  // most. The first `first` of chattering_ are excluded.
  Real first_meeting(const Real& most, const Real& span, std::size_t first) {
    joins_.assign(masses_.size(), false);
    for (std::size_t k = 0; k < first; ++k) joins_[chattering_[k].index] = true;
    Real least = span;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (joins_[i] || masses_.held[i]) continue;
      const Real time = masses_.lower_bound_of_meeting(i, most);
      if (time < least) least = time;
    }
    return least;
  }

  Energy energy_now() const {
    return Base::energy_now([](std::size_t) { return Real(0); });
  }

  const Restitution& options_;
  Real mass_{1};                               // of the primary mass and what sticks to it
  std::optional<Driven<Real, Force>> joined_;  // their oscillator, if anything sticks
  Real push_{0};                               // the side on which masses stick, 1 or -1; 0: none sticks
  bool some_rest_ = false;
  Real not_followed_{0};  // how long the chattering whose limit has been taken lasts
  std::vector<MassAtWall<Real>> at_walls_, reported_;  // reported_: those that meet their walls
  std::vector<Chattering> chattering_;
  std::vector<Joining> joining_;  // of the first 0, 1, 2 ... of them
  std::vector<char> joins_;
};

// Runs a scene with a list of dampers.
template <Scalar Real, DampersObserver Observer>
Outcome run_restitution_dampers(const Checked& run, Observer& observer) {
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
