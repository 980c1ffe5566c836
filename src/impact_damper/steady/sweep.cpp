#include "impact_damper/steady/sweep.hpp"

#include <algorithm>
#include <atomic>

namespace impact_damper {

double Axis::value(std::int64_t i) const {
  return i == count - 1 ? to : from + (to - from) * (double(i) / double(count - 1));
}

std::vector<double> Axis::values() const {
  std::vector<double> all;
  for (std::int64_t i = 0; i < count; ++i) all.push_back(value(i));
  return all;
}

void require_valid(const Scene& scene, const Engine& engine, const Axis& axis) {
  const std::vector<NamedSceneNumber> all = numbers_of(scene);
  if (std::ranges::find(all, axis.number, &NamedSceneNumber::number) == all.end())
    throw InvalidArguments(
        {{name_of(axis.number), has_one_damper(scene) ? "is for several dampers: the scene has no list"
                                                      : "must be of one of the scene's several dampers"}});
  for (std::int64_t i = 0; i < axis.count; ++i) require_none(problems_of(axis.at(scene, i), engine));
}

std::vector<SweepStart> nudged(const std::vector<SceneState>& starts, double nudge) {
  std::vector<SweepStart> all;
  for (std::size_t n = 0; n < starts.size(); ++n) all.emplace_back(starts[n], double(n) * nudge);
  return all;
}

Scene Axis::at(Scene scene, std::int64_t i) const {
  number.in(scene) = value(i);
  return scene;
}

std::vector<SteadyState> steady_states_along(const Scene& scene, const Engine& engine,
                                             const SceneNumber& number, const std::vector<double>& values,
                                             const SteadyRule& rule, const SweepStart& start,
                                             const std::function<void()>& after_each) {
  require_none(problems_of(rule));
  std::vector<SteadyState> all;
  Scene there = scene;
  SceneState state = start;
  for (const double value : values) {
    double& now = number.in(there);
    if (!all.empty()) {
      state.x += start.nudge;
      if (number.of_damper == &SceneDamper::clearance) state.dampers[*number.damper].y *= value / now;
    }
    now = value;
    all.push_back(ForcedScene(there, engine).settle(state, rule));
    state = all.back().state;
    after_each();
  }
  return all;
}

std::vector<Sweep> sweep(const Scene& scene, const Engine& engine, const Axis& axis, const SteadyRule& rule,
                         const std::vector<SweepStart>& starts, const Threads& threads,
                         const std::function<void(std::int64_t done)>& progress) {
  require_none(problems_of(rule));
  // Throws for all that is not valid before anything is simulated.
  for (const SweepStart& start : starts) require_valid(released_from(scene, start), engine, axis);

  progress(0);
  const std::vector<double> upwards = axis.values(), downwards(upwards.rbegin(), upwards.rend());
  std::vector<Sweep> sweeps(starts.size());
  std::atomic<std::int64_t> done{0};
  for_each_index(std::int64_t(starts.size()), threads, [&](std::int64_t n) {
    Sweep& all = sweeps[static_cast<std::size_t>(n)];
    all.start = starts[static_cast<std::size_t>(n)];
    const auto along = [&](const std::vector<double>& values, const SceneState& from) {
      return steady_states_along(released_from(scene, all.start), engine, axis.number, values, rule,
                                 {from, all.start.nudge}, [&] { progress(++done); });
    };
    all.up = along(upwards, all.start);
    all.down = along(downwards, all.up.back().state);
    std::ranges::reverse(all.down);
  });
  return sweeps;
}

}  // namespace impact_damper
