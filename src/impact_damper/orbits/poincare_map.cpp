#include "impact_damper/orbits/poincare_map.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "impact_damper/engines/compatibility.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/orbits/variation_of_dampers.hpp"

namespace impact_damper {
namespace {

// The least impact speed. Complete chattering counts with its first impact only: the later ones become
// arbitrarily slow.
std::optional<double> slowest(const std::vector<OrbitImpact>& impacts,
                              std::span<const ContactInterval> sticking) {
  std::vector<bool> counts(impacts.size(), true);
  for (const ContactInterval& each : sticking) {
    std::optional<std::size_t> later;
    for (std::size_t i = each.impacts_before; i-- > 0;) {
      if (std::size_t(impacts[i].damper) != each.damper) continue;
      if (later && impacts[i].wall != impacts[*later].wall) break;
      if (later) counts[*later] = false;
      later = i;
    }
  }
  std::optional<double> least;
  for (std::size_t i = 0; i < impacts.size(); ++i)
    if (counts[i] && !(least && *least <= impacts[i].speed)) least = impacts[i].speed;
  return least;
}

std::optional<double> least_interval(const std::vector<OrbitImpact>& impacts, double duration) {
  std::optional<double> least;
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    const bool is_last = i + 1 == impacts.size();
    const OrbitImpact& next = impacts[is_last ? 0 : i + 1];
    const double interval = next.time - impacts[i].time + (is_last ? duration : 0);
    if (next.damper != impacts[i].damper && !(least && *least <= interval)) least = interval;
  }
  return least;
}

}  // namespace

StateVector vector_of(const SceneState& s) {
  StateVector all{s.x, s.v};
  for (const PlaceInCavity& each : s.dampers) all.insert(all.end(), {each.y, each.w});
  return all;
}
SceneState state_of(const StateVector& s) {
  SceneState state;
  state.x = s[0], state.v = s[1];
  state.dampers.clear();
  for (std::size_t i = 2; i < s.size(); i += 2) state.dampers.push_back({s[i], s[i + 1]});
  return state;
}

namespace {

// The scene with the end of H^n, n = half_periods, and with any initial condition.
Scene scene_of_map(Scene scene, int half_periods) {
  if (!(half_periods >= 1)) require_none({{"periods", "must be >= 1"}});
  scene.x0 = scene.v0 = 0;
  for (SceneDamper& damper : scene.dampers) damper.y0 = damper.clearance / 2, damper.w0 = 0;
  scene.until_amplitude.reset();
  scene.until_time = half_periods * (half_turn<double>() / scene.force_frequency);
  require_none(problems_of(scene));
  return scene;
}

}  // namespace

PoincareMap::PoincareMap(const Scene& scene, const Engine& engine, int half_periods)
    : scene_(scene_of_map(scene, half_periods)),
      engine_(engine),
      half_periods_(half_periods),
      forced_(scene_, engine_),
      coefficients_(variational_coefficients(scene_, engine_)) {}

Expected<PoincareImage, StopReason> PoincareMap::operator()(const SceneState& s, Derivatives wanted) const {
  const RecordedRun run = forced_.record(s, duration());
  if (run.stop_reason != StopReason::time) return run.stop_reason;
  const bool with_parameters = wanted == Derivatives::by_state_and_parameters;
  const std::size_t n = dimensions_of(scene_);
  std::vector<ChangeOfState> columns = identity_of(n);
  AlongRun along;
  const Carried carried = carry_changes(*coefficients_, run, columns, {}, with_parameters ? &along : nullptr);

  const double mirror = half_periods_ % 2 == 0 ? 1 : -1;
  PoincareImage image;
  image.state = mirror < 0 ? mirrored(run.end, scene_) : run.end;
  image.by_state.assign(n, StateVector(n));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) image.by_state[i][j] = mirror * columns[j][i];
  // The end time n pi / omega_f depends on omega_f (M13.8).
  for (std::size_t i = 0; i < along.by_frequency.size(); ++i) {
    along.by_frequency[i] -= along.rates_at_end[i] * (duration() / scene_.force_frequency);
    image.by_frequency.push_back(mirror * along.by_frequency[i]);
    image.by_amplitude.push_back(mirror * along.by_amplitude[i]);
  }
  image.nearest_miss = carried.nearest_miss;
  image.one_sided = carried.one_sided;

  std::vector<bool> is_idle(scene_.dampers.size(), !run.chain.impacts.empty());
  for (const MotionChain::Impact& each : run.chain.impacts) {
    image.impacts.push_back({each.time, each.wall, std::fabs(each.w), each.damper});
    is_idle[std::size_t(each.damper)] = false;
  }
  const bool rigid = has_rigid_walls(engine_);
  const std::vector<ContactInterval> contacts = contact_intervals(scene_, run, rigid);
  for (const ContactInterval& each : contacts) {
    is_idle[each.damper] = false;
    image.sticking += rigid && !each.from_beginning;
  }
  for (std::size_t i = 0; i < is_idle.size(); ++i)
    if (is_idle[i]) image.idle.push_back(i);
  image.slowest_impact = slowest(image.impacts, rigid ? contacts : std::vector<ContactInterval>{});
  if (rigid) image.least_interval = least_interval(image.impacts, duration());
  return image;
}

}  // namespace impact_damper
