// What the engines of several dampers share (exact_dampers.hpp, restitution_dampers.hpp): the state of a run,
// and how it is advanced, recorded and ended.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "impact_damper/engines/observer.hpp"
#include "impact_damper/engines/run_tracker.hpp"
#include "impact_damper/engines/secondary_masses.hpp"

namespace impact_damper {

// A contact with a compliant wall that is under way.
template <class Real>
struct WallContact {
  std::optional<std::size_t> impact{};  // the one that began it, by index in impact_loss
  Real work{0};                         // of the wall's damper
};

// Base class of these engines. A secondary mass is either in flight or held at a wall: it sticks to a rigid
// one, or pushes a compliant one.
template <class Real, class Force, class Observer>
class EngineOfDampers {
 protected:
  EngineOfDampers(const System<Real, Force>& system, const Scene& scene, const Budget& budget,
                  std::int64_t max_steps, Observer& observer)
      : system_(system),
        observer_(observer),
        tracker_(scene, system, budget, max_steps, observer),
        masses_(scene.dampers),
        x_(scene.x0),
        v_(scene.v0),
        energy_(scene.dampers.size()),
        places_(scene.dampers.size()) {}

  DamperEnergy& energy_of(std::size_t i) { return energy_[masses_.number[i]]; }
  // Stores the kinetic energy that each secondary mass has now in the member `when` of its DamperEnergy,
  // initial_kinetic or final_kinetic.
  void note_kinetic(double DamperEnergy::*when) {
    for (std::size_t i = 0; i < masses_.size(); ++i) energy_of(i).*when = masses_.kinetic(i, v_);
  }
  // Returns the energy of all masses and walls now. wall(i): twice the energy of the i-th mass's wall.
  template <class OfWall>
  Energy energy_now(OfWall&& wall) const {
    return energy_of_masses(x_, v_, masses_.size(), [&](std::size_t i) {
      return EnergyTerms<Real>{masses_.nu[i], masses_.w(i), wall(i)};
    });
  }
  // Returns the energy that a weight gamma stores, counted from x = y = 0 (M18.5).
  double energy_of_weight(const Real& gamma) const {
    Real height{0};
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Real wall = masses_.away[i] > 0 ? Real(0) : masses_.clearance[i];
      height += masses_.nu[i] * (x_ + (wall + masses_.away[i] * masses_.u[i]));
    }
    return double(Real(gamma * height));
  }
  // Ends the energy balance, which must be wanted. last: the energy at the end of the run.
  void finish(const Energy& last) {
    tracker_.finish(last, losses_);
    observer_.energy_balance().dampers = std::move(energy_);
  }

  // Reports the observer's next sample, a time t after the beginning of a motion. now: x and its
  // displacement from a straight line then. held(set) calls set(i, u, u') for each mass that is held, with
  // its distance u from its wall then.
  template <class Held>
  void report_sample(const Real& t, const Displacement<Real>& now, Held&& held) {
    const auto set = [&](std::size_t i, const Real& u, const Real& u1) {
      places_[masses_.number[i]] = masses_.place(i, u, u1);
    };
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Real& away = masses_.away[i];
      if (!masses_.held[i])
        set(i, Real(masses_.u[i] + (masses_.u1[i] * t - away * now.dx)), Real(masses_.u1[i] - away * now.dv));
    }
    held(set);
    observer_.sample(observer_.next_sample(), double(now.x), double(now.v), places_);
  }
  // Advances all masses by a time t from the beginning of a motion. Arguments as above.
  template <class Held>
  void advance(const Real& t, const Displacement<Real>& now, Held&& held) {
    masses_.fly(t, now.dx, now.dv);
    held([&](std::size_t i, const Real& u, const Real& u1) {
      masses_.u[i] = u;
      masses_.u1[i] = u1;
    });
    x_ = now.x;
    v_ = now.v;
  }

  // Sets `meeting` to the masses that meet walls now, at the end of a motion of the length t: the i-th one,
  // the wall that it left last if `near`, and all in flight that rounding cannot tell apart from it (17.2).
  // second(j): a bound on |y''|; skips(j): whether a mass is not in flight.
  template <class Second, class Skips>
  void find_meeting(std::vector<Meeting<Real>>& meeting, std::size_t i, bool near, const Real& t,
                    Second&& second, Skips&& skips) const {
    meeting.clear();
    for (std::size_t j = 0; j < masses_.size(); ++j) {
      if (skips(j)) continue;
      const Real& u1 = masses_.u1[j];
      const bool to_near = j == i ? near : u1 < 0;
      const Real speed = absolute(u1);
      if (j != i) {
        if (u1 == 0) continue;
        const Real distance = to_near ? masses_.u[j] : Real(masses_.clearance[j] - masses_.u[j]),
                   from = to_near ? absolute(masses_.u[j]) : masses_.clearance[j], most = second(j);
        const Real way = from + (speed + most * t) * t;
        if (!(distance <= slack_of_instant(way, speed, most) * speed)) continue;
      }
      const Wall home = masses_.wall(j);
      meeting.push_back({j, t, to_near ? home : opposite(home), speed});
    }
  }

  // Reports an impact of the i-th mass.
  void report_impact(std::size_t i, Wall wall) {
    observer_.impact(double(tracker_.now()), wall, double(masses_.w(i)), double(x_), masses_.number[i]);
  }
  // Marks a mass as held from the time `since`, which may be later than now where its chattering is not over.
  void hold(std::size_t i, const Real& since) {
    masses_.held[i] = true;
    masses_.held_since[i] = double(since);
  }
  // Marks a held mass as in flight, and reports its contact, unless that would have begun later than now.
  void let_go(std::size_t i) {
    masses_.held[i] = false;
    const double begin = masses_.held_since[i], end = tracker_.time();
    if (observer_.wants_contacts() && begin <= end)
      observer_.contact(begin, end, masses_.wall(i), masses_.number[i]);
  }

  // Notes that a contact has begun with an impact, the last one reported.
  void begin_with_impact(WallContact<Real>& contact) {
    if (!observer_.wants_energy()) return;
    contact.impact = observer_.energy_balance().impact_loss.size();
    observer_.energy_balance().impact_loss.push_back(0);
  }
  // Ends the contact of the i-th mass, and counts what its wall has taken.
  void end_contact(std::size_t i, WallContact<Real>& contact) {
    let_go(i);
    if (observer_.wants_energy()) {
      EnergyBalance& balance = observer_.energy_balance();
      losses_ += contact.work;
      if (contact.impact) {
        balance.impact_loss[*contact.impact] = double(contact.work);
        energy_of(i).impact_loss += double(contact.work);
      } else {
        balance.contact_loss += double(contact.work);
        energy_of(i).contact_loss += double(contact.work);
      }
    }
    contact = {};
    masses_.u[i] = 0;
  }
  // Counts what friction and drag have taken from the i-th mass in the whole run.
  void count_in_cavity(std::size_t i, const Real& by_friction, const Real& by_drag) {
    losses_ += by_friction + by_drag;
    energy_of(i).friction_loss = double(by_friction);
    energy_of(i).drag_loss = double(by_drag);
    observer_.energy_balance().friction_loss += energy_of(i).friction_loss;
    observer_.energy_balance().drag_loss += energy_of(i).drag_loss;
  }

  const System<Real, Force>& system_;
  Observer& observer_;
  RunTracker<Real, Force, Observer> tracker_;
  SecondaryMasses<Real> masses_;
  NextMeeting<Real, Force> next_meeting_;
  Real x_, v_;
  Real losses_{0};

 private:
  std::vector<DamperEnergy> energy_;  // by number in the scene
  std::vector<PlaceInCavity> places_;
};

}  // namespace impact_damper
