// The exact engine for scenes with friction, static friction, weight or drag (docs/mathematics.md, 18.8):
// compliant walls, one or several dampers. What it shares with the restitution engine, and how it moves:
// engine_with_components.hpp. Here is who is held, and the contact of the only mass, which has a closed form
// besides the series: it takes its ringing in few steps (shifted_contact.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/engine_with_components.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/shifted_contact.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {

template <class Real, class Force, class Observer>
class ExactWithComponents
    : EngineWithComponents<ExactWithComponents<Real, Force, Observer>, EngineOfDampers<Real, Force, Observer>,
                           Real, Force, Observer> {
  using Base = EngineWithComponents<ExactWithComponents, EngineOfDampers<Real, Force, Observer>, Real, Force,
                                    Observer>;
  friend Base;
  using Base::each_, Base::forces_, Base::masses_, Base::meeting_, Base::tracker_, Base::v_, Base::watched_,
      Base::x_;
  using typename Base::Acceleration, typename Base::Event, typename Base::Kind, typename Base::Mass,
      typename Base::Watched, typename Base::Which;

 public:
  ExactWithComponents(const System<Real, Force>& system, const Scene& scene, const Exact& options,
                      Observer& observer)
      : Base(system, scene, options, observer) {
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const SceneDamper& damper = scene.dampers[masses_.number[i]];
      Mass& mass = each_[i];
      mass.stiffness = Real(damper.wall_stiffness) / Real(damper.mass_ratio);
      mass.damping = 2 * zeta_m<Real>(damper, options.calibration) * square_root(mass.stiffness);
      if (masses_.u[i] < 0) enter(i);
      if (masses_.size() > 1) continue;
      modes_.emplace(System<Real, Force>(scene, damper),
                     Real((mass.damping + mass.drag) / (2 * square_root(mass.stiffness))));
      if (modes_->coupled) modes_.reset();
    }
  }

  Outcome run() { return Base::run_to_end(); }

 private:
  Event follow(bool& stopped_by_rounding) {
    return is_alone() ? push_alone(stopped_by_rounding) : Base::follow_motion(stopped_by_rounding);
  }
  // Whether the only mass pushes a wall, and moves there or begins to.
  bool is_alone() const {
    if (!modes_ || !masses_.held[0] || each_[0].still || masses_.u[0] > 0) return false;
    if (masses_.u1[0] != 0) return true;
    const Acceleration now = Base::acceleration();
    return masses_.u[0] < 0 &&
           -each_[0].slides * (now.value + Base::wall_spring(0)) - each_[0].friction > Base::noise_of(0, now);
  }
  // Follows the only mass, which pushes a wall, until it leaves it or stops in it.
  Event push_alone(bool& stopped_by_rounding) {
    const Mass& mass = each_[0];
    const Real &nu = masses_.nu[0], &away = masses_.away[0];
    const ShiftedContact<Real, Force> contact(
        *modes_, tracker_.now(), {x_, v_, Base::q(0), masses_.w(0)}, masses_.wall(0),
        {-nu * forces_.weight, -(Base::friction_of(0) + forces_.weight) / mass.stiffness});
    watched_.clear();
    watched_.push_back({{}, {0, Kind::depth}});
    if (mass.holds > 0) {
      watched_.push_back({{}, {0, Kind::stop}});
      if (masses_.u1[0] == 0) {
        const Real noise = Base::noise_of(0, Base::acceleration());
        watched_.back().order = 1, watched_.back().noise = watched_.back().slope_noise = noise;
      }
    }
    Search<Real>& search = tracker_.search();
    const auto order_of = [](const Watched& each) { return each.kind == Kind::depth ? 0 : 1; };
    const auto sign_of = [&](const Watched& each) { return each.kind == Kind::depth ? -away : mass.slides; };
    const auto at = [&](const Real& t) { return contact.leads_of_q(t); };
    const auto jet = [&](const std::array<Real, 4>& q, const Real&, const Watched& each) {
      const int n = order_of(each);
      const Real sign = sign_of(each);
      return Jet<Real>{sign * q[n], sign * q[n + 1], sign * q[n + 2], Real(0)};
    };
    const auto guess = [&](const Watched& each) {
      return modes_->fast.rings() ? modes_->fast.fall(each.start.g, each.start.g1, Real(0))
                                  : fall_near_parabola(each.start);
    };
    const auto fourth = [&](const Watched& each) {
      return contact.bound_of_q(4 + order_of(each), search.span);
    };
    const auto enclose = [&](const Real&, const Real& t, const Watched& each) {
      return contact.derivative_of_q(order_of(each), sign_of(each), t, search.span);
    };
    auto start = at(Real(0));
    const auto predicted =
        predict_first<Real>(watched_, start, at, jet, guess, fourth, tracker_.remaining(), search);
    const auto first = predicted ? predicted->root
                                 : first_of_many<Real>(
                                       watched_, [](const Real& t) { return t; }, enclose,
                                       tracker_.remaining(), search, contact.resolution());
    const Real until = first ? first->time : tracker_.remaining();
    const State<Real> end = contact.at(until);
    const auto state_at = [&](const Real& t) { return t == until ? end : contact.at(t); };
    const auto state = [&](const Real& t) {
      const State<Real> now = state_at(t);
      return Displacement<Real>{now.x, now.v, Real(0), Real(now.v - v_)};
    };
    const auto gained = [&](std::size_t, const Real& t, const Displacement<Real>&) {
      const State<Real> now = state_at(t);
      return ChangeOfX<Real>{away * now.y - masses_.u[0], away * now.w - masses_.u1[0]};
    };
    stopped_by_rounding =
        Base::pass(contact, until, Real(1), state, gained,
                   [](std::size_t, const Real&, const Work<Real>& works) { return works.wall; });
    if (!first) return {until, {}};
    return {until, watched_[first->which]};
  }
  // Carries out an event, and others of its kind that rounding cannot tell apart from it. Returns false if
  // they are impacts more than the impact budget allows.
  bool take(const Which& event) {
    const std::size_t i = event.mass;
    const bool to_wall = event.kind == Kind::near_wall || event.kind == Kind::far_wall;
    if (to_wall && each_[i].slides != 0 && masses_.u1[i] == 0) return true;  // stopped on it, by rounding
    if (event.kind == Kind::depth) {
      leave(i);
      for (std::size_t j = 0; j < masses_.size(); ++j)
        if (masses_.held[j] && masses_.u1[j] > 0 && -masses_.u[j] <= each_[j].rounding_of_u) leave(j);
    } else if (event.kind == Kind::stop) {
      Base::stop_all(i);
    } else if (to_wall) {
      if (!tracker_.has_room_for(std::int64_t(meeting_.size()))) return false;
      std::ranges::sort(meeting_, {}, [&](const auto& each) { return masses_.number[each.index]; });
      for (const Meeting<Real>& each : meeting_) meet(each.index, each.wall);
    }
    return true;
  }
  void meet(std::size_t i, Wall wall) {
    Base::report_impact(i, wall);
    masses_.arrive(i, wall);
    enter(i);
    Base::begin_with_impact(each_[i].contact);
  }
  void enter(std::size_t i) { Base::hold(i, tracker_.now()); }
  void leave(std::size_t i) {
    Base::end_contact(i, each_[i].contact);
    if (masses_.u1[i] < 0) masses_.u1[i] = 0;  // by rounding
  }
  void end(std::size_t i) { leave(i); }

  // Decides who is held: of the masses at rest those that can be. Always the first one that contradicts its
  // state changes it, which ends; with static friction equal to friction there is one answer only (18.8).
  // Then a mass at rest on its wall enters it or leaves it.
  void settle() {
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Mass& mass = each_[i];
      const Real w = masses_.w(i);
      mass.stays = mass.still;
      mass.still = w == 0 && mass.holds > 0;
      mass.slides = mass.holds > 0 ? Real(w > 0) - Real(w < 0) : Real(0);
    }
    // With static friction above friction there may be more than one answer: who is held already stays held
    // where that can be, so those that have just stopped are decided upon first.
    for (const bool all : {false, true}) {
      Base::sum_up_held();
      for (std::size_t changes = 0; change_one(all, changes > 8 * masses_.size()); ++changes)
        Base::sum_up_held();
    }
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (!masses_.rests(i)) continue;
      const Mass& mass = each_[i];
      const Real direction = mass.still         ? Real(0)
                             : mass.slides != 0 ? mass.slides
                                                : Base::goes(i, Base::acceleration());
      const bool enters = direction * masses_.away[i] < 0;
      // Later than at the release that is an impact, but by rounding for one that friction did not hold.
      if (enters && !masses_.held[i]) {
        if (tracker_.now() == 0 || (masses_.size() == 1 && mass.holds == 0))
          enter(i);
        else if (tracker_.has_room_for(1))
          meet(i, masses_.wall(i));
      }
      if (!enters && masses_.held[i]) leave(i);
    }
  }
  // Lets go the first mass that cannot be held, or holds one again that would be pushed against the direction
  // in which it was let go. Returns false if there is none. all: not only those that have just stopped.
  // only_holds: static friction larger than friction leaves more than one answer, so that without an end to
  // it one might be let go and held for ever.
  bool change_one(bool all, bool only_holds) {
    const Acceleration now = Base::acceleration();
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Mass& mass = each_[i];
      if (masses_.u1[i] != 0 || !(mass.holds > 0) || (mass.stays && !all)) continue;
      if (mass.still) {
        const Real direction = only_holds ? Real(0) : Base::goes(i, now);
        if (direction == 0) continue;
        mass.still = false;
        mass.slides = direction;
        return true;
      }
      const Real pushed = -mass.slides * (now.value + Base::wall_spring(i)) - mass.friction;
      if (pushed >= -Base::error_for(i, now)) continue;
      mass.still = true;
      mass.slides = 0;
      return true;
    }
    return false;
  }

  std::optional<ContactModes<Real, Force>> modes_;  // of the only mass in contact, if they are apart
};

// Runs a scene that has friction, weight or drag, with one damper or a list.
template <Scalar Real, DampersObserver Observer>
Outcome run_exact_with_components(const Checked& run, Observer& observer) {
  return with_system<Real>(run.scene(), [&](const auto& system) {
    return run_exact_with_components(system, run.scene(), run.options<Exact>(), observer);
  });
}

template <class Real, class Force, class Observer>
Outcome run_exact_with_components(const System<Real, Force>& system, const Scene& scene, const Exact& options,
                                  Observer& observer) {
  require_arithmetic();
  return ExactWithComponents<Real, Force, Observer>(system, scene, options, observer).run();
}

}  // namespace impact_damper
