// What the impacts of one instant change, with rigid walls and several dampers: Newton's law of restitution
// in Moreau's form (M17.2), (M17.3).
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace impact_damper {

// A secondary mass that is at a wall, impinging or at rest there.
template <class Real>
struct MassAtWall {
  std::size_t index;  // whose; in ascending order where several are given
  Real nu, e;
  Real away;   // 1 at a left, -1 at a right wall
  Real speed;  // away from the wall, <= 0; 0 at rest
  // By how much its wall has to move away for it to be met with no impulse, (1+e) |speed|.
  Real reach() const { return (1 + e) * -speed; }
};

// By how much x' jumps (M17.3): the root of a sum that is linear in pieces and rises. `at_walls` is
// reordered.
template <class Real>
Real jump_of_velocity(std::span<MassAtWall<Real>> at_walls) {
  if (at_walls.size() == 1) {
    const MassAtWall<Real>& mass = at_walls.front();
    return -mass.away * (mass.nu * mass.reach() / (1 + mass.nu));
  }
  Real to_right{0}, to_left{0};
  for (const MassAtWall<Real>& mass : at_walls)
    (mass.away > 0 ? to_left : to_right) += mass.nu * mass.reach();
  // The masses at the walls of the stronger side drive x' their way. Those at the others are met by their
  // walls all the more; of the stronger side's, those which the walls do not escape.
  const Real driving = to_right > to_left ? -1 : 1;
  Real impulse = driving > 0 ? -to_right : -to_left, mass = 1;
  for (const MassAtWall<Real>& each : at_walls)
    if (each.away != driving) mass += each.nu;
  std::sort(at_walls.begin(), at_walls.end(), [](const auto& one, const auto& other) {
    const Real a = one.reach(), b = other.reach();
    return a > b || (a == b && one.index < other.index);
  });
  Real jump{0};
  for (const MassAtWall<Real>& each : at_walls) {
    if (each.away != driving) continue;
    if (!(each.reach() > jump)) break;
    impulse += each.nu * each.reach();
    mass += each.nu;
    const Real next = impulse / mass;
    if (next > jump) jump = next;
  }
  return -driving * jump;
}

// The speed away from the wall after the impacts, when x' has jumped.
template <class Real>
Real speed_after(const MassAtWall<Real>& mass, const Real& jump) {
  const Real rebound = mass.e * -mass.speed, untouched = mass.speed - mass.away * jump;
  return rebound > untouched ? rebound : untouched;
}

}  // namespace impact_damper
