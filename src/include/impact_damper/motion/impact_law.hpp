// The impacts of one instant, with rigid walls and several dampers: Newton's law of restitution in Moreau's
// form (M17.2), (M17.3), and restitutions that depend on the speed (18.7).
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "impact_damper/math/elementary.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

// Returns the restitution at an impact speed >= 0. pairs: SceneDamper::restitution_by_speed, not empty.
template <class Real>
Real restitution_at(const Pairs& pairs, const Real& speed) {
  const auto next = std::ranges::find_if(pairs, [&](const auto& pair) { return speed < Real(pair[0]); });
  if (next == pairs.begin()) return Real(pairs.front()[1]);
  const auto& [from, e] = *(next - 1);
  if (next == pairs.end()) return Real(e);
  return e + (speed - from) * (Real((*next)[1]) - e) / (Real((*next)[0]) - from);
}
// Whether the restitution of all impacts up to this speed departs from e(0) by `most` at most (M18.19).
template <class Real>
bool is_settled(const Pairs& pairs, const Real& speed, const Real& most) {
  const Real e = pairs.front()[1];
  const auto departs = [&](const auto& pair) {
    return Real(pair[0]) < speed && !(absolute(Real(pair[1] - e)) <= most);
  };
  return absolute(Real(restitution_at(pairs, speed) - e)) <= most && std::ranges::none_of(pairs, departs);
}

// A secondary mass that is at a wall, impinging or at rest there. Velocities are divided by epsilon Omega_n.
template <class Real>
struct MassAtWall {
  std::size_t index;  // of the mass; decides ties, so that the order of the masses changes no bit
  Real nu, e;         // its mass, divided by the primary mass, > 0; its restitution, 0 to 1
  Real away;          // the direction from the wall into the cavity: 1 at a left, -1 at a right wall
  Real speed;         // before, relative to the wall and along `away`: < 0 impinging, 0 at rest
  // If the wall's velocity jumps away from the mass by this much, (1+e) |speed|, the impulse on it vanishes.
  Real escape() const { return (1 + e) * -speed; }
};

// Returns J, the jump of the primary mass's velocity x' (M17.3): the root of
//     J + sum of away nu max(0, escape + away J),
// which rises with J and is linear in pieces. at_walls: one or several masses; it is reordered.
template <class Real>
Real jump_of_velocity(std::span<MassAtWall<Real>> at_walls) {
  if (at_walls.size() == 1) {
    const MassAtWall<Real>& only = at_walls.front();
    return -only.away * (only.nu * only.escape() / (1 + only.nu));
  }
  // The impulses that the walls of each side would get if x' stayed as it is. The larger determines the sign
  // of J: the walls of the stronger side are thrown back.
  Real left{0}, right{0};
  for (const MassAtWall<Real>& each : at_walls) (each.away > 0 ? left : right) += each.nu * each.escape();
  const Real stronger = right > left ? -1 : 1;
  // With j = |J|: j (1 + sum of nu) = sum of +-nu escape, both sums over those masses that get an impulse.
  // All of the weaker side do, as their walls come towards them; of the stronger side those with escape > j.
  // These are added in descending order of escape: each makes j a mean of what it was and its escape, so that
  // j rises and stays below it, until the next one's is not above j.
  Real momentum = stronger > 0 ? -right : -left, mass = 1;
  for (const MassAtWall<Real>& each : at_walls)
    if (each.away != stronger) mass += each.nu;
  std::sort(at_walls.begin(), at_walls.end(), [](const auto& one, const auto& other) {
    const Real a = one.escape(), b = other.escape();
    return a > b || (a == b && one.index < other.index);
  });
  Real size{0};  // j, as far as it is not negative
  for (const MassAtWall<Real>& each : at_walls) {
    if (each.away != stronger) continue;
    if (!(each.escape() > size)) break;
    momentum += each.nu * each.escape();
    mass += each.nu;
    const Real mean = momentum / mass;
    if (mean > size) size = mean;
  }
  return -stronger * size;
}

// Returns the speed of a mass after the impacts, relative to the wall and along `away`, when x' has jumped by
// `jump`: that of restitution, or a larger one where the wall moves away faster than that.
template <class Real>
Real speed_after(const MassAtWall<Real>& mass, const Real& jump) {
  const Real rebound = mass.e * -mass.speed, untouched = mass.speed - mass.away * jump;
  return rebound > untouched ? rebound : untouched;
}

}  // namespace impact_damper
