#include "impact_damper/steady/sweep.hpp"

#include <atomic>

namespace impact_damper {

double Axis::value(std::int64_t i) const {
  return i == count - 1 ? to : from + (to - from) * (double(i) / double(count - 1));
}

void require_valid(const Scene& scene, const Engine& engine, const Axis& axis) {
  for (std::int64_t i = 0; i < axis.count; ++i) require_none(problems_of(axis.at(scene, i), engine));
}

Scene Axis::at(Scene scene, std::int64_t i) const {
  scene.*number = value(i);
  return scene;
}

std::vector<Sweep> sweep(const Scene& scene, const Engine& engine, const Axis& axis, const SteadyRule& rule,
                         const std::vector<State<double>>& starts, const Threads& threads,
                         const std::function<void(std::int64_t done)>& progress) {
  require_none(problems_of(rule));
  const auto at = [&](std::int64_t i, const State<double>& start) {
    return ForcedScene(axis.at(released_from(scene, start), i), engine);
  };
  // What is not valid throws here, before anything is simulated.
  for (const State<double>& start : starts) require_valid(released_from(scene, start), engine, axis);

  progress(0);
  std::vector<Sweep> sweeps(starts.size());
  std::atomic<std::int64_t> done{0};
  for_each_index(std::int64_t(starts.size()), threads, [&](std::int64_t n) {
    Sweep& all = sweeps[static_cast<std::size_t>(n)];
    const auto count = static_cast<std::size_t>(axis.count);
    all.start = starts[static_cast<std::size_t>(n)];
    all.up.resize(count);
    all.down.resize(count);
    State<double> state = all.start;
    const auto step = [&](std::vector<SteadyState>& way, std::size_t i) {
      way[i] = at(std::int64_t(i), all.start).settle(state, rule);
      state = way[i].state;
      progress(++done);
    };
    for (std::size_t i = 0; i < count; ++i) step(all.up, i);
    for (std::size_t i = count; i-- > 0;) step(all.down, i);
  });
  return sweeps;
}

}  // namespace impact_damper
