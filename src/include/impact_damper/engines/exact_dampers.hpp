// The exact engine for several dampers on one primary mass (docs/mathematics.md, 17.5): compliant walls,
// every event solved for.
//
// While all secondary masses fly, the primary mass is one oscillator, and the next impact is found as with
// rigid walls (secondary_masses.hpp). While one mass pushes its wall, it moves as the single damper of
// exact.hpp does, and the others fly: most often a bound on x'' shows at once that none of these meets a wall
// meanwhile (M17.8). While several push their walls, all move by power series (joint_contact.hpp), and once
// these walls have stopped ringing as one oscillator again (joint_slow_mode.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/engine_of_dampers.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/contact_without_modes.hpp"
#include "impact_damper/motion/contact_work.hpp"
#include "impact_damper/motion/joint_contact.hpp"
#include "impact_damper/motion/joint_slow_mode.hpp"
#include "impact_damper/motion/sticking.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {

// The contact modes of each damper's wall, by number in the scene. An empty one is made for its first
// contact.
template <class Real, class Force>
using ModesOfDampers = std::vector<std::shared_ptr<const ContactModes<Real, Force>>>;

template <class Real, class Force>
std::shared_ptr<const ContactModes<Real, Force>> modes_of_damper(const Scene& scene, std::size_t number,
                                                                 const Exact& options) {
  const SceneDamper& damper = scene.dampers[number];
  return std::make_shared<const ContactModes<Real, Force>>(System<Real, Force>(scene, damper),
                                                           zeta_m<Real>(damper, options.calibration));
}

template <class Real, class Force, class Observer>
class ExactOfDampers : EngineOfDampers<Real, Force, Observer> {
  using Base = EngineOfDampers<Real, Force, Observer>;
  using Base::energy_of, Base::losses_, Base::masses_, Base::next_meeting_, Base::observer_, Base::system_,
      Base::tracker_, Base::v_, Base::x_;

 public:
  // modes: empty, or those that several runs of one scene share.
  ExactOfDampers(const System<Real, Force>& system, const Scene& scene, const Exact& options,
                 Observer& observer, const ModesOfDampers<Real, Force>& modes = {})
      : Base(system, scene, options.budget, options.max_steps, observer),
        scene_(scene),
        options_(options),
        walls_(scene.dampers.size()) {
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const SceneDamper& damper = scene.dampers[masses_.number[i]];
      walls_[i].stiffness = Real(damper.wall_stiffness) / Real(damper.mass_ratio);
      walls_[i].damping = 2 * zeta_m<Real>(damper, options.calibration) * square_root(walls_[i].stiffness);
      if (!modes.empty()) walls_[i].modes = modes[masses_.number[i]];
    }
  }

  Outcome run() {
    const bool balance = observer_.wants_energy();
    if (balance) Base::note_kinetic(&DamperEnergy::initial_kinetic);
    begin_contacts();
    if (balance) tracker_.begin(energy_now());
    while (!tracker_.stopped()) {
      if (in_contact_.empty()) {
        fly();
      } else if (in_contact_.size() > 1) {
        push_together();
      } else if (const ContactModes<Real, Force>& modes = modes_of(in_contact_.front()); modes.coupled) {
        push_alone<ContactWithoutModes<Real, Force>>(modes);
      } else {
        push_alone<Contact<Real, Force>>(modes);
      }
    }
    if (balance) Base::note_kinetic(&DamperEnergy::final_kinetic);
    const Energy last = energy_now();
    while (!in_contact_.empty()) leave(in_contact_.front());
    if (balance) Base::finish(last);
    return tracker_.outcome();
  }

 private:
  // A mass's wall, and the contact that is under way there.
  struct OwnWall {
    Real stiffness, damping;  // K and c of (M2.2)
    std::shared_ptr<const ContactModes<Real, Force>> modes{};
    WallContact<Real> contact{};
  };
  struct Event {
    std::size_t index;
    Real time;
    std::optional<Wall> met;  // the wall that is met; empty: the mass leaves its wall
  };

  const ContactModes<Real, Force>& modes_of(std::size_t i) {
    OwnWall& wall = walls_[i];
    if (!wall.modes) wall.modes = modes_of_damper<Real, Force>(scene_, masses_.number[i], options_);
    return *wall.modes;
  }

  // Begins the contacts of the release: of masses that overlap a wall or move into the one at which they are,
  // then of masses at rest on a wall against which x'' presses them.
  void begin_contacts() {
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (masses_.u[i] < 0) enter(i);
      if (masses_.u[i] == 0 && masses_.u1[i] < 0) events_.push_back({i, Real(0), masses_.wall(i)});
    }
    take_events();
    const Real side = side_of_acceleration();
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (masses_.rests(i) && !masses_.held[i] && masses_.away[i] == side) enter(i);
  }
  // Sets pushed_ to the walls in contact, with their q and q' now.
  void list_pushed() {
    pushed_.clear();
    for (const std::size_t i : in_contact_)
      pushed_.push_back({masses_.nu[i], walls_[i].stiffness, walls_[i].damping,
                         masses_.away[i] * masses_.u[i], masses_.w(i)});
  }
  // Returns the side on which x'' presses masses at rest against their walls: 1 left, -1 right, 0 neither.
  // Where x'' is zero to rounding, the first later derivative that is not zero decides.
  Real side_of_acceleration() {
    list_pushed();
    return lead_of_x<Real>(2 * system_.zeta, Real(1), system_.forcing, system_.forcing.phase(tracker_.now()),
                           x_, v_, pushed_)
        .side();
  }

  // Follows the motion without a contact until a wall is met.
  void fly() {
    const JoinedMasses<Real, Force> motion(system_.free, system_.forcing, tracker_.now(), x_, v_, Real(0));
    const ForcedMotion<Real, Force>& primary = motion.primary();
    const Real remaining = tracker_.remaining(), length = primary.length();
    Real until = length < remaining ? length : remaining;
    events_.clear();
    for (const Meeting<Real>& each : next_meeting_.find(masses_, primary, x_, v_, until, tracker_.search()))
      consider({each.index, each.time, each.wall}, until);
    const auto last = next_meeting_.primary_at(primary, until);
    State<Real> end{last.x, last.v, Real(0), Real(0)};
    pass(
        motion, until, end, Real(0), [&](const Real& t) { return t == until ? last : primary.at(t); },
        [](std::size_t, const Real&) { return std::array<Real, 2>{}; });
    take_events();
  }

  // Follows the motion of one mass in contact, until it leaves its wall or another mass meets one.
  template <class InContact>
  void push_alone(const ContactModes<Real, Force>& modes) {
    const std::size_t i = in_contact_.front();
    events_.clear();
    if (!(masses_.u[i] < 0) && masses_.u1[i] > 0) {  // has left with others, but for rounding
      events_.push_back({i, Real(0), {}});
      return take_events();
    }
    const Real q = masses_.away[i] * masses_.u[i], remaining = tracker_.remaining();
    const InContact contact(modes, tracker_.now(), modes.forcing.phase(tracker_.now()),
                            {x_, v_, q, masses_.w(i)}, masses_.wall(i), Real(0));
    if constexpr (std::is_same_v<InContact, Contact<Real, Force>>) {
      // The short-contact map's change of x errs by a rounding of x' h (M17.15). It is used where all others
      // stay so far from their walls that this is no more than a rounding of any distance.
      const auto end = contact.end_of_short_contact();
      if (end && end->time < remaining &&
          all_stay_off_walls(contact.second_of_x(end->time), end->time, Real(absolute(v_) * end->time))) {
        events_.push_back({i, end->time, {}});
        return pass_contact(contact, end->time, {end->x, end->v, Real(0), end->w}, &end->change);
      }
    }
    const auto leaves = contact.leave(remaining, tracker_.search());
    Real until = leaves ? leaves->time : remaining;
    if (leaves) events_.push_back({i, until, {}});
    const Real most = contact.second_of_x(until);
    for (std::size_t j = 0; j < masses_.size(); ++j)
      if (!masses_.held[j] && !masses_.stays_off_walls(j, most, until, Real(0)))
        if (const auto met = meets_beside(contact, j, until)) consider(*met, until);
    pass_contact(contact, until, leaves && until == leaves->time ? leaves->state : contact.at(until),
                 nullptr);
  }
  // Follows the contact until it is in the state `end`. change: of x by then, where it is known.
  template <class InContact>
  void pass_contact(const InContact& contact, const Real& until, State<Real> end,
                    const ChangeOfX<Real>* change) {
    const std::size_t i = in_contact_.front();
    const auto state = [&](const Real& t) { return t == until ? end : contact.at(t); };
    const Work<Real> works = pass(
        contact, until, end, masses_.nu[i] * walls_[i].damping,
        [&](const Real& t) {
          const State<Real> now = state(t);
          const auto [dx, dv] = change && t == until ? *change : change_of_x(contact, t, now.x, now.v);
          return Displacement<Real>{now.x, now.v, dx, dv};
        },
        [&](std::size_t, const Real& t) {
          const State<Real> now = state(t);
          return std::array{now.y, now.w};
        });
    walls_[i].contact.work += works.wall;
    take_events();
  }
  // Returns the departure of x from its straight line and the change of x' at t, while one mass is in
  // contact.
  template <class InContact>
  ChangeOfX<Real> change_of_x(const InContact& contact, const Real& t, const Real& x, const Real& v) const {
    if (const auto change = contact.change_of_x(t)) return *change;
    return {Real(x - (x_ + v_ * t)), Real(v - v_)};
  }
  // Returns the first impact of the j-th mass on a wall while another is in contact, if not after `until`.
  template <class InContact>
  std::optional<Event> meets_beside(const InContact& contact, std::size_t j, const Real& until) {
    const Real &away = masses_.away[j], &u = masses_.u[j], &u1 = masses_.u1[j];
    const auto gaps = [&](const Real& t) {
      const LocalEnclosure<Real> x = contact.derivative_of_x(0, Real(1), t, tracker_.search().span);
      const auto change = contact.change_of_x(t);
      const auto near = [&](const Jet<Real>& of_x, bool whole) {
        const bool known = whole && change;
        const Real dx = known ? change->dx : Real(of_x.g - (x_ + v_ * t)),
                   dv = known ? change->dv : Real(of_x.g1 - v_);
        return Jet<Real>{u + (u1 * t - away * dx), u1 - away * dv, -away * of_x.g2, of_x.third};
      };
      const auto far = [&](const Jet<Real>& gap) {
        return Jet<Real>{masses_.clearance[j] - gap.g, -gap.g1, -gap.g2, gap.third};
      };
      const Jet<Real> whole = near(x.whole, true), main = near(x.main, false);
      // The main part has the digits of x, not those of the distance, which may be far smaller.
      const Real rest = x.rest + 4 * std::numeric_limits<Real>::epsilon() *
                                     (absolute(x.main.g) + absolute(x_) + absolute(v_) * t);
      return std::array{LocalEnclosure<Real>{whole, main, rest},
                        LocalEnclosure<Real>{far(whole), far(main), rest}};
    };
    const auto met =
        first_root<Real>(gaps, Real(0), just_after(until), tracker_.search(), contact.resolution());
    if (!met) return {};
    return Event{j, met->time, met->which == 0 ? masses_.wall(j) : opposite(masses_.wall(j))};
  }

  // Follows the motion of several masses in contact for one piece, or until one leaves or another meets a
  // wall.
  void push_together() {
    list_pushed();
    if (ring_no_more()) return press_together();
    Piece& piece = piece_;
    begin_piece();
    Search<Real>& search = tracker_.search();
    search.steps_left -= std::int64_t(in_contact_.size());
    const Real remaining = tracker_.remaining();
    Real until = piece.length() < remaining ? piece.length() : remaining;
    events_.clear();
    const auto look_for = [&](std::size_t i, const typename Piece::Function& gap, std::optional<Wall> wall) {
      if (const auto time = piece.fall(gap, just_after(until), search)) consider({i, *time, wall}, until);
    };
    piece.look_until(until);
    for (std::size_t k = 0; k < in_contact_.size(); ++k) {
      const Wall wall = masses_.wall(in_contact_[k]);
      if (!piece.stays(k, wall)) look_for(in_contact_[k], piece.depth(k, wall), {});
    }
    const Real most = piece.second_of_x();
    for (std::size_t j = 0; j < masses_.size(); ++j) {
      if (masses_.held[j] || masses_.stays_off_walls(j, most, until, Real(0))) continue;
      const Real &u = masses_.u[j], &u1 = masses_.u1[j], &away = masses_.away[j];
      look_for(j, piece.gap(u, u1, away), masses_.wall(j));
      look_for(j, piece.gap(masses_.clearance[j] - u, -u1, -away), opposite(masses_.wall(j)));
    }
    State<Real> end = piece.at(until);
    pass(
        piece, until, end, Real(0), [&](const Real& t) { return piece.change(t); },
        [&](std::size_t k, const Real& t) { return piece.overlap(k, t); });
    if (observer_.wants_energy()) {
      for (std::size_t k = 0; k < in_contact_.size(); ++k)
        walls_[in_contact_[k]].contact.work += piece.wall_work(k, tracker_.passed());
    }
    take_events();
  }

  // Begins a piece of the series. Every `soonest` pieces more walls are tried as followers (M17.22): those
  // that have stopped ringing and are much faster than the others.
  void begin_piece() {
    const auto begin_with = [&](const Real& follow_from) {
      piece_.set_walls(system_.zeta, system_.forcing, pushed_, follow_from);
      piece_.begin(tracker_.now(), x_, v_, pushed_);
    };
    const Real nothing = std::numeric_limits<Real>::infinity();
    if (pieces_together_ == 1) return begin_with(follow_from_ = nothing);
    bool tried = false;
    for (Real last{0}; pieces_together_ % soonest == 0;) {
      Real least = follow_from_;
      for (const PushedWall<Real>& each : pushed_)
        if (each.stiffness > last && each.stiffness < least &&
            Piece::may_follow(each.stiffness, system_.zeta, system_.forcing, pushed_))
          least = each.stiffness;
      if (!(least < follow_from_)) break;
      begin_with(least);
      if (piece_.follows(pushed_)) {
        follow_from_ = least;
        return;
      }
      tried = true;
      last = least;
    }
    if (tried) return begin_with(follow_from_);
    piece_.begin(tracker_.now(), x_, v_, pushed_);
  }
  // Whether the walls in contact have stopped ringing, so that the slow mode (M17.20) holds. It is not asked
  // for in the first pieces, in which they ring.
  static constexpr int soonest = 16;
  bool ring_no_more() {
    if (++pieces_together_ < soonest) return false;
    if (pieces_together_ == soonest) slow_mode_ = SlowMode::of(system_.zeta, system_.forcing, pushed_);
    return slow_mode_ && slow_mode_->holds(pushed_, tracker_.now(), x_, v_);
  }
  // Follows the slow mode of several masses that press their walls until one leaves or another meets a wall.
  void press_together() {
    const SlowMode& slow = *slow_mode_;
    const Real begin = tracker_.now();
    const JoinedMasses<Real, Force> motion(slow.oscillator(), slow.force(), begin + slow.ahead(), x_, v_,
                                           Real(0));
    const ForcedMotion<Real, Force>& primary = motion.primary();
    Search<Real>& search = tracker_.search();
    const Real remaining = tracker_.remaining(), length = primary.length();
    Real until = length < remaining ? length : remaining;
    events_.clear();
    for (const Meeting<Real>& each : next_meeting_.find(masses_, primary, x_, v_, until, search))
      consider({each.index, each.time, each.wall}, until);
    for (std::size_t k = 0; k < in_contact_.size(); ++k) {
      const std::size_t i = in_contact_[k];
      const auto depth = [&](const Real& t) {
        return slow.depth(k, masses_.wall(i), primary, begin, t, search.span);
      };
      if (const auto time =
              isolate_fall<Real>(depth, Real(0), just_after(until), search, motion.resolution()))
        consider({i, *time, {}}, until);
    }
    const auto overlap = [&](std::size_t k, const Real& t) {
      const auto now = primary.at(t);
      return slow.overlap(k, begin + t, now.x, now.v);
    };
    State<Real> end = motion.at(until);
    pass(
        motion, until, end, Real(0), [&](const Real& t) { return primary.at(t); }, overlap);
    if (observer_.wants_energy()) {
      const auto panel = [&](const Real& t) { return motion.panel(t); };
      for (std::size_t k = 0; k < in_contact_.size(); ++k) {
        OwnWall& wall = walls_[in_contact_[k]];
        const auto rates = [&](const Real& t) { return std::array{Real(0), overlap(k, t)[1]}; };
        wall.contact.work += integrated_work(system_, rates, panel, begin, tracker_.passed(),
                                             Real(masses_.nu[in_contact_[k]] * wall.damping), search)
                                 .wall;
      }
    }
    take_events();
  }

  // Whether (M17.8) proves for all masses in flight that they stay off their walls by `margin` for a time t.
  bool all_stay_off_walls(const Real& most, const Real& t, const Real& margin) const {
    for (std::size_t j = 0; j < masses_.size(); ++j)
      if (!masses_.held[j] && !masses_.stays_off_walls(j, most, t, margin)) return false;
    return true;
  }
  // The end of a search for events beside one at `time`, a few roundings later: an event at the same instant
  // may come out later by that much.
  static Real just_after(const Real& time) { return time * (1 + 8 * std::numeric_limits<Real>::epsilon()); }
  // Adds an event to events_, which holds the earliest events known, all at the time `until`. An earlier
  // event replaces them, a later one is ignored.
  void consider(const Event& event, Real& until) {
    if (event.time > until) return;
    if (event.time < until) events_.clear();
    until = event.time;
    events_.push_back(event);
  }

  // Advances all by a time without an event, or to an earlier stop. change(t) gives x, x' and their
  // departures from a straight line; overlap(k, t) gives q and q' of the k-th mass in contact. Returns the
  // work done.
  template <class Motion, class ChangeAt, class OverlapAt>
  Work<Real> pass(const Motion& motion, const Real& until, State<Real>& end, const Real& wall_damping,
                  ChangeAt&& change, OverlapAt&& overlap) {
    const auto held_at = [&](const Real& t) {
      return [this, &overlap, &t](auto&& set) {
        for (std::size_t k = 0; k < in_contact_.size(); ++k) {
          const auto [q, w] = overlap(k, t);
          const Real& away = masses_.away[in_contact_[k]];
          set(in_contact_[k], Real(away * q), Real(away * w));
        }
      };
    };
    const Work<Real> works = tracker_.pass(motion, until, end, wall_damping, [&](const Real& t) {
      Base::report_sample(t, change(t), held_at(t));
    });
    const Real t = tracker_.passed();
    if (t > 0) Base::advance(t, change(t), held_at(t));
    return works;
  }

  // Carries out events_, unless the run has stopped: first the masses that leave a wall, then those that meet
  // one.
  void take_events() {
    if (tracker_.stopped()) return;
    const auto meets = [](const Event& event) { return event.met.has_value(); };
    if (!tracker_.has_room_for(std::ranges::count_if(events_, meets))) return;
    for (const Event& event : events_)
      if (!event.met) leave(event.index);
    std::ranges::sort(events_, {}, [&](const Event& event) { return masses_.number[event.index]; });
    for (const auto& [i, time, met] : events_) {
      if (!met) continue;
      Base::report_impact(i, *met);
      masses_.arrive(i, *met);
      enter(i);
      Base::begin_with_impact(walls_[i].contact);
    }
  }
  void enter(std::size_t i) {
    Base::hold(i, tracker_.now());
    in_contact_.insert(std::ranges::lower_bound(in_contact_, i), i);
    pieces_together_ = 0;
  }
  void leave(std::size_t i) {
    Base::end_contact(i, walls_[i].contact);
    std::erase(in_contact_, i);
    pieces_together_ = 0;
  }

  Energy energy_now() const {
    return Base::energy_now([&](std::size_t i) {
      const Real& u = masses_.u[i];
      return masses_.held[i] ? Real(masses_.nu[i] * walls_[i].stiffness * (u * u)) : Real(0);
    });
  }

  using Piece = JointContact<Real, Force>;
  using SlowMode = JointSlowMode<Real, Force>;
  const Scene& scene_;
  const Exact& options_;
  std::vector<OwnWall> walls_;           // of each mass
  std::vector<std::size_t> in_contact_;  // ascending
  std::vector<Event> events_;
  std::vector<PushedWall<Real>> pushed_;
  Piece piece_;
  std::optional<SlowMode> slow_mode_;  // of the contacts under way
  int pieces_together_ = 0;            // since a contact began or ended
  Real follow_from_{0};                // walls with this K or more follow in these pieces
};

// Runs a scene with a list of dampers.
template <Scalar Real, DampersObserver Observer>
Outcome run_exact_dampers(const Checked& run, Observer& observer) {
  require_no_components(run.scene());
  return with_system<Real>(run.scene(), [&](const auto& system) {
    return run_exact_dampers(system, run.scene(), run.options<Exact>(), observer, {});
  });
}

// modes: empty, or those that several runs of one scene share.
template <class Real, class Force, class Observer>
Outcome run_exact_dampers(const System<Real, Force>& system, const Scene& scene, const Exact& options,
                          Observer& observer, const ModesOfDampers<Real, Force>& modes) {
  require_arithmetic();
  return ExactOfDampers<Real, Force, Observer>(system, scene, options, observer, modes).run();
}

}  // namespace impact_damper
