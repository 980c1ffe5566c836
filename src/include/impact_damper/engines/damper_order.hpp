// The order in which engines keep the dampers of a list.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "impact_damper/scene.hpp"

namespace impact_damper {

// Returns the numbers of the dampers in the scene, in an order that depends on the dampers alone: so
// renumbering them changes no bit of any sum over them.
inline std::vector<std::int32_t> damper_order(std::span<const SceneDamper> dampers) {
  std::vector<std::int32_t> order(dampers.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](const std::int32_t& one, const std::int32_t& other) {
    const auto key = [&](const std::int32_t& i) {
      const SceneDamper& d = dampers[i];
      return std::tie(d.clearance, d.mass_ratio, d.restitution, d.y0, d.w0, d.wall_stiffness, d.friction,
                      d.static_friction, d.drag, d.wall.law, d.wall.exponent, d.wall.speed, d.wall.pairs,
                      d.restitution_by_speed, i);
    };
    return key(one) < key(other);
  });
  return order;
}

}  // namespace impact_damper
