// The end of a run in extended precision: what derivatives are held against, by differences.
#pragma once

#include <array>
#include <concepts>

#include "engines/observed.hpp"

namespace long_double_run {

using namespace impact_damper;
using Number = long double;

struct LastState : TestObserver<Number> {
  void impact(double, Wall, double, double) override { ++impacts; }
  void ended(const State<Number>& state) override { end = {state.x, state.v, state.y, state.w}; }

  std::array<Number, 4> end{};
  int impacts = 0;
};

inline LastState run(const Scene& scene, const Engine& engine) {
  LastState last;
  observed(scene, engine, last);
  return last;
}

// The derivative of the end by a scene's number, and how many impacts the two runs had at the larger
// distance, unequal where the derivative is not one of a single sequence of events. Differences of both
// sides at h and 2h, without their errors of second order.
struct Difference {
  std::array<Number, 4> by{};
  std::array<int, 2> impacts{};
};
// change(scene, by): changes one number of the scene.
template <std::invocable<Scene&, double> Change>
Difference difference(const Scene& scene, const Engine& engine, double h, Change&& change) {
  const auto at = [&](double by) {
    Scene changed = scene;
    change(changed, by);
    return run(changed, engine);
  };
  const LastState a = at(h), b = at(-h), c = at(2 * h), d = at(-2 * h);
  Difference all;
  for (std::size_t i = 0; i < 4; ++i) {
    const Number near = (a.end[i] - b.end[i]) / (2 * Number(h)),
                 far = (c.end[i] - d.end[i]) / (4 * Number(h));
    all.by[i] = (4 * near - far) / 3;
  }
  all.impacts = {c.impacts, d.impacts};
  return all;
}
inline Difference difference(const Scene& scene, const Engine& engine, double h, const SceneNumber& number) {
  return difference(scene, engine, h, [&](Scene& changed, double by) { number.in(changed) += by; });
}

}  // namespace long_double_run
