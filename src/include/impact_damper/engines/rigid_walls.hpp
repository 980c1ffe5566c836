// Impacts between several dampers' masses and rigid walls, which take no time, simultaneous ones by Moreau's
// law (motion/impact_law.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "impact_damper/engines/engine_of_dampers.hpp"
#include "impact_damper/motion/impact_law.hpp"

namespace impact_damper {

template <class Real, class Force, class Observer>
class EngineWithRigidWalls : protected EngineOfDampers<Real, Force, Observer> {
  using Base = EngineOfDampers<Real, Force, Observer>;

 protected:
  using Base::Base, Base::losses_, Base::masses_, Base::observer_, Base::tracker_, Base::v_;

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
      if (masses_.held[each.index] && masses_.u1[each.index] > 0) Base::let_go(each.index);
    }
    v_ += jump;
    if (observer_.wants_energy()) {
      for (const MassAtWall<Real>& each : reported_) {
        const Real after = masses_.u1[each.index];
        const Real impulse = each.nu * (after - (each.speed - each.away * jump));
        const Real loss = -impulse * (each.speed + after) / 2;  // (M17.4)
        losses_ += loss;
        Base::energy_of(each.index).impact_loss += double(loss);
        observer_.energy_balance().impact_loss.push_back(double(loss));
      }
    }
    return true;
  }

 private:
  MassAtWall<Real> mass_at_wall(std::size_t i) const {
    return {i, masses_.nu[i], masses_.restitution_at(i, masses_.u1[i]), masses_.away[i], masses_.u1[i]};
  }

  std::vector<MassAtWall<Real>> at_walls_, reported_;  // reported_: those that meet their walls
};

}  // namespace impact_damper
