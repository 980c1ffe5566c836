#include "impact_damper/orbits/poincare_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "impact_damper/engines/compatibility.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/orbits/run_with_variation.hpp"
#include "impact_damper/orbits/variation_of_dampers.hpp"

namespace impact_damper {
namespace {

// The product of the matrices of all steps, and the derivatives by the parameters that they add up to.
class Product final : public VariationReceiver {
 public:
  using VariationReceiver::VariationReceiver;
  void joined() override {}
  int pieces(double) override { return 1; }

  RowsOfState<double, 4> by_state = identity<double>();
  RowsOfState<double, 2> by_parameters{};

 private:
  void take(const RowsOfState<double, 4>& a, const RowsOfState<double, 2>* added) override {
    by_state = product(a, by_state);
    if (!added) return;
    by_parameters = product(a, by_parameters);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 2; ++j) by_parameters[i][j] += (*added)[i][j];
  }
};

struct Sticking {
  std::size_t impacts_before;  // of all dampers
  std::int32_t damper;
};
// The least impact speed. Complete chattering counts with its first impact only: the later ones become
// arbitrarily slow.
std::optional<double> slowest(const std::vector<OrbitImpact>& impacts, const std::vector<Sticking>& all) {
  std::vector<bool> counts(impacts.size(), true);
  for (const Sticking& each : all) {
    std::optional<std::size_t> later;
    for (std::size_t i = each.impacts_before; i-- > 0;) {
      if (impacts[i].damper != each.damper) continue;
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

// The number of times that masses come to stick, without those that stick from the beginning.
std::int64_t comes_to_stick(const std::vector<Sticking>& all) {
  return std::ranges::count_if(all, [](const Sticking& each) { return each.impacts_before > 0; });
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

PoincareMap::PoincareMap(const Scene& scene, const Engine& engine, int half_periods)
    : scene_(scene), engine_(engine), half_periods_(half_periods) {
  scene_.x0 = scene_.v0 = 0;
  for (SceneDamper& damper : scene_.dampers) damper.y0 = damper.clearance / 2, damper.w0 = 0;
  scene_.until_amplitude.reset();
  scene_.until_time = half_periods * (half_turn<double>() / scene.force_frequency);
  std::vector<Problem> problems = problems_of(scene_);
  for (const Problem& problem : problems_of(engine)) problems.push_back(problem);
  if (!(half_periods >= 1)) problems.push_back({"periods", "must be >= 1"});
  if (scene.force_amplitude == 0)
    problems.push_back({"force_amplitude", "must not be 0: without a force there is no period"});
  if (std::holds_alternative<Cem>(engine))
    problems.push_back({"engine", "must be exact or restitution, got cem"});
  require_none(problems);
  if (!has_one_damper(scene_)) several_.emplace(scene_, engine_);
}

Expected<PoincareImage, StopReason> PoincareMap::operator()(const SceneState& s, Derivatives wanted) const {
  Expected<End, StopReason> end = several_ ? of_several(s, wanted) : of_one_damper(s, wanted);
  if (!end) return end.failure();
  PoincareImage image = std::move(end->image);

  // The end time n pi / omega_f depends on omega_f (M13.8).
  const double mirror = half_periods_ % 2 == 0 ? 1 : -1;
  for (std::vector<double>& row : image.by_state)
    for (double& entry : row) entry *= mirror;
  for (std::size_t i = 0; i < image.by_frequency.size(); ++i) {
    image.by_frequency[i] =
        mirror * (image.by_frequency[i] - end->rates[i] * (duration() / scene_.force_frequency));
    image.by_amplitude[i] *= mirror;
  }
  if (mirror < 0) image.state = mirrored(image.state, scene_);
  return image;
}

Expected<PoincareMap::End, StopReason> PoincareMap::of_one_damper(const SceneState& s,
                                                                  Derivatives wanted) const {
  Product all(wanted == Derivatives::by_state_and_parameters);
  Expected<VariedRun, StopReason> run =
      run_with_variation(released_from(scene_, s), engine_, all, Kept::impacts);
  if (!run) return run.failure();
  PoincareImage image;
  image.state = run->end;
  for (std::size_t i = 0; i < 4; ++i) {
    image.by_state.emplace_back(all.by_state[i].begin(), all.by_state[i].end());
    image.by_frequency.push_back(all.by_parameters[i][0]);
    image.by_amplitude.push_back(all.by_parameters[i][1]);
  }
  std::vector<Sticking> sticking;
  for (const std::size_t impacts : run->impacts_before_sticking) sticking.push_back({impacts, 0});
  image.sticking = comes_to_stick(sticking);
  image.slowest_impact = slowest(run->impacts, sticking);
  image.nearest_miss = run->nearest_miss;
  image.impacts = std::move(run->impacts);
  return End{std::move(image), {run->rates_at_end.begin(), run->rates_at_end.end()}};
}

Expected<PoincareMap::End, StopReason> PoincareMap::of_several(const SceneState& s,
                                                               Derivatives wanted) const {
  const Run run = several_->record(s, duration());
  if (run.stop_reason != StopReason::time) return run.stop_reason;
  PoincareImage image;
  image.state = state_in(*run.history, 1);
  const std::size_t n = dimensions_of(scene_);
  std::vector<ChangeOfState> columns(n, ChangeOfState(n));
  for (std::size_t j = 0; j < n; ++j) columns[j][j] = 1;
  AlongRun along;
  image.one_sided = carry_changes(
                        run, columns, [] {}, wanted == Derivatives::by_state ? nullptr : &along)
                        .one_sided;
  image.by_state.assign(n, StateVector(n));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) image.by_state[i][j] = columns[j][i];
  image.by_frequency = std::move(along.by_frequency);
  image.by_amplitude = std::move(along.by_amplitude);
  image.nearest_miss = along.nearest_miss;

  const Impacts& impacts = *run.impacts;
  const Contacts& contacts = *run.contacts;
  std::vector<bool> idle(scene_.dampers.size(), !impacts.time.empty());
  for (std::size_t i = 0; i < impacts.time.size(); ++i) {
    image.impacts.push_back(
        {impacts.time[i], impacts.wall[i], std::fabs(impacts.relative_velocity[i]), impacts.damper[i]});
    idle[std::size_t(impacts.damper[i])] = false;
  }
  std::vector<Sticking> sticking;
  for (std::size_t i = 0; i < contacts.begin.size(); ++i) {
    idle[std::size_t(contacts.damper[i])] = false;
    if (!has_rigid_walls(engine_)) continue;
    const auto before = std::ranges::upper_bound(impacts.time, contacts.begin[i]) - impacts.time.begin();
    sticking.push_back({std::size_t(before), contacts.damper[i]});
  }
  for (std::size_t i = 0; i < idle.size(); ++i)
    if (idle[i]) image.idle.push_back(i);
  image.sticking = comes_to_stick(sticking);
  image.slowest_impact = slowest(image.impacts, sticking);
  if (has_rigid_walls(engine_)) image.least_interval = least_interval(image.impacts, duration());
  return End{std::move(image), std::move(along.rates_at_end)};
}

}  // namespace impact_damper
