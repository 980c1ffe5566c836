#include "impact_damper/orbits/poincare_map.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <span>
#include <utility>

#include "impact_damper/math/elementary.hpp"
#include "impact_damper/orbits/masses_along_run.hpp"
#include "impact_damper/orbits/variational_equations.hpp"

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

double Multiplier::modulus() const { return std::sqrt(re * re + im * im); }

Multipliers multipliers_of(const Matrix& matrix) {
  Multipliers all;
  for (const std::complex<double>& value : eigenvalues_of(matrix))
    all.push_back({value.real(), value.imag()});
  std::ranges::stable_sort(all, std::greater<>(),
                           [](const Multiplier& m) { return m.re * m.re + m.im * m.im; });
  return all;
}

Scene scene_of_map(Scene scene, int half_periods) {
  if (!(half_periods >= 1)) require_none({{"periods", "must be >= 1"}});
  if (half_periods % 2 != 0 && !has_mirror(scene))
    require_none({{"half_periods", "must be even with weight, without which left and right are alike"}});
  scene.x0 = scene.v0 = 0;
  for (SceneDamper& damper : scene.dampers) damper.y0 = damper.clearance / 2, damper.w0 = 0;
  scene.until_amplitude.reset();
  scene.until_time = half_periods * (half_turn<double>() / scene.force_frequency);
  return scene;
}

PoincareMap::PoincareMap(const Scene& scene, const Engine& engine, int half_periods)
    : scene_(scene_of_map(scene, half_periods)),
      engine_(engine),
      half_periods_(half_periods),
      forced_(scene_, engine_),
      coefficients_(variational_coefficients(scene_, engine_)) {}

Expected<PoincareImage, StopReason> PoincareMap::operator()(const SceneState& s, Derivatives wanted,
                                                            double misses_within) const {
  const RecordedRun run = forced_.record(s, duration());
  if (run.stop_reason != StopReason::time) return run.stop_reason;
  const double mirror = half_periods_ % 2 == 0 ? 1 : -1;
  PoincareImage image;
  image.state = mirror < 0 ? mirrored(run.end, scene_) : run.end;
  std::vector<bool> is_idle(scene_.dampers.size(), !run.chain.impacts.empty() || !has_mirror(scene_));
  for (const MotionChain::Impact& each : run.chain.impacts) is_idle[std::size_t(each.damper)] = false;
  for (const MotionChain::Contact& each : run.chain.contacts)
    if (!has_components(scene_)) is_idle[std::size_t(each.damper)] = false;
  for (const MotionChain::Settled& each : run.chain.settled)
    if (!each.held) is_idle[std::size_t(each.damper)] = false;
  for (std::size_t i = 0; i < is_idle.size(); ++i)
    if (is_idle[i]) image.idle.push_back(i);
  if (wanted == Derivatives::none) return image;

  const std::size_t n = dimensions_of(scene_);
  std::vector<ChangeOfState> columns = identity_of(n);
  AlongRun along;
  const Carried carried = carry_changes(*coefficients_, run, columns, {},
                                        wanted == Derivatives::by_state_and_parameters ? &along : nullptr);
  image.by_state.assign(n, StateVector(n));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) image.by_state[i][j] = mirror * columns[j][i];
  image.by_frequency = std::move(along.by_frequency);
  image.by_amplitude = std::move(along.by_amplitude);
  // The end time n pi / omega_f depends on omega_f (M13.8).
  for (std::size_t i = 0; i < image.by_frequency.size(); ++i) {
    const double by_end = along.rates_at_end[i] * (duration() / scene_.force_frequency);
    image.by_frequency[i] = mirror * (image.by_frequency[i] - by_end);
    image.by_amplitude[i] *= mirror;
  }
  image.one_sided = carried.one_sided;
  image.stop_margin = carried.stop_margin;
  if (distance(image.state, s) <= misses_within) image.nearest_miss = nearest_miss(*coefficients_, run);
  image.impacts.reserve(run.chain.impacts.size());
  for (const MotionChain::Impact& each : run.chain.impacts)
    image.impacts.push_back({each.time, each.wall, std::fabs(each.w), each.damper});
  if (!has_rigid_walls(engine_)) {
    image.slowest_impact = slowest(image.impacts, {});
    return image;
  }
  image.sticking = std::ranges::count(carried.contacts, false, &ContactInterval::from_beginning);
  image.slowest_impact = slowest(image.impacts, carried.contacts);
  image.least_interval = least_interval(image.impacts, duration());
  return image;
}

}  // namespace impact_damper
