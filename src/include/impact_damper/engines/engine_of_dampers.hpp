// What the engines of several dampers share (exact_dampers.hpp, restitution_dampers.hpp): the state of a run,
// and how it is advanced, recorded and ended.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "impact_damper/engines/observer.hpp"
#include "impact_damper/engines/run_tracker.hpp"
#include "impact_damper/engines/secondary_masses.hpp"

namespace impact_damper {

// A mass is in flight or held at a wall: in contact with it, or stuck to it.
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
  // Notes the kinetic energy of each mass, as the initial or the final one.
  void note_kinetic(double DamperEnergy::*when) {
    for (std::size_t i = 0; i < masses_.size(); ++i) energy_of(i).*when = masses_.kinetic(i, v_);
  }
  // wall(i): twice the energy of the i-th mass's wall.
  template <class OfWall>
  Energy energy_now(OfWall&& wall) const {
    return energy_of_masses(x_, v_, masses_.size(), [&](std::size_t i) {
      return EnergyTerms<Real>{masses_.nu[i], masses_.w(i), wall(i)};
    });
  }
  void finish(const Energy& last) {
    tracker_.finish(last, losses_);
    observer_.energy_balance().dampers = std::move(energy_);
  }

  // Reports a sample at the time t of a motion. now: x, x' and their departures from a straight line then.
  // held(set): calls set(i, u, u') for each mass that is held.
  template <class Change, class Held>
  void report_sample(const Real& t, const Change& now, Held&& held) {
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
  // Advances all masses to the time t of a motion. Arguments as above.
  template <class Change, class Held>
  void advance(const Real& t, const Change& now, Held&& held) {
    masses_.fly(t, now.dx, now.dv);
    held([&](std::size_t i, const Real& u, const Real& u1) {
      masses_.u[i] = u;
      masses_.u1[i] = u1;
    });
    x_ = now.x;
    v_ = now.v;
  }

  // Reports an impact of the i-th mass.
  void report_impact(std::size_t i, Wall wall) {
    observer_.impact(double(tracker_.now()), wall, double(masses_.w(i)), double(x_), masses_.number[i]);
  }
  void hold(std::size_t i, const Real& since) {
    masses_.held[i] = true;
    masses_.held_since[i] = double(since);
  }
  // Lets a mass fly that is held, and reports its contact, which may be one that has not begun.
  void let_go(std::size_t i) {
    masses_.held[i] = false;
    const double begin = masses_.held_since[i], end = tracker_.time();
    if (observer_.wants_contacts() && begin <= end)
      observer_.contact(begin, end, masses_.wall(i), masses_.number[i]);
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
