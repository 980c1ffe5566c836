#include "scenes.hpp"

#include <cmath>

namespace impact_damper::bench {
namespace {

void add_several_dampers(std::vector<BenchScene>& scenes) {
  const auto add = [&](const std::string& name, int count, const Scene& scene) {
    BenchScene added{.name = name, .scene = scene, .compared_until = 30.5, .dampers = count};
    scenes.push_back(added);
    added.name += " rigid";
    added.walls = Walls::rigid;
    scenes.push_back(added);
  };
  const Scene one{.x0 = 3, .until_time = 101, .dampers = {{.restitution = 0.8, .wall_stiffness = 1e8}}};
  add("S9 one", 1, one);
  for (const int count : {2, 5, 20, 100}) {
    Scene several = one;
    several.dampers.clear();
    for (int i = 0; i < count; ++i) {
      const double clearance = 1 + 0.7 * i / count;
      // The golden section spreads any number of them evenly and out of order.
      const double place = std::fmod(0.381966 * i, 1.0) / 2;
      several.dampers.push_back({.mass_ratio = one.damper().mass_ratio / count,
                                 .restitution = one.damper().restitution,
                                 .clearance = clearance,
                                 .wall_stiffness = one.damper().wall_stiffness / count,
                                 .y0 = clearance * place});
    }
    add("S9 " + std::to_string(count), count, several);
  }
}

}  // namespace

std::vector<BenchScene> bench_scenes() {
  const Scene regular{.x0 = 4.5, .until_time = 100};
  std::vector<BenchScene> scenes{
      {.name = "S1", .what = "x₀ = 4.5 to t = 100", .scene = regular},
      {.name = "S2", .what = "the same with rigid walls", .scene = regular, .walls = Walls::rigid},
      {.name = "S3",
       .what = "x₀ = 6 to t = 400: bounce-down, stuck",
       .scene = {.x0 = 6, .until_time = 400},
       .with_others = true},
      {.name = "S4",
       .what = "forced and damped to t = 100",
       .scene = {.damping_ratio = 0.01, .x0 = 6, .force_amplitude = 0.05, .until_time = 100},
       .with_others = true},
      {.name = "S5",
       .what = "the whole decay, 6 to 0.03",
       .scene = {.x0 = 6, .until_amplitude = 0.03},
       .with_others = true,
       .chaotic = true},
      {.name = "S7",
       .what = "forced near resonance, undamped, to t = 2000",
       .scene = {.x0 = 1, .force_amplitude = 0.006, .force_frequency = 0.988, .until_time = 2000},
       .with_others = true,
       .compared_until = 60},
      {.name = "S8 slow",
       .what = "a force of frequency 0.2 to t = 400",
       .scene = {.x0 = 0.1,
                 .force_amplitude = 1,
                 .force_frequency = 0.2,
                 .until_time = 400,
                 .dampers = {{.y0 = 0.5}}},
       .compared_until = 100},
      {.name = "S8 fast",
       .what = "a force of frequency 5 to t = 100",
       .scene = {.damping_ratio = 0.01,
                 .x0 = 0.1,
                 .v0 = -5,
                 .force_amplitude = 24,
                 .force_frequency = 5,
                 .until_time = 100,
                 .dampers = {{.y0 = 0.5}}},
       .compared_until = 12},
      {.name = "S8 very fast",
       .what = "a force of frequency 50 to t = 20",
       .scene = {.damping_ratio = 0.01,
                 .x0 = 0.1,
                 .v0 = -50,
                 .force_amplitude = 2499,
                 .force_frequency = 50,
                 .until_time = 20,
                 .dampers = {{.y0 = 0.5}}},
       .compared_until = 1},
  };
  add_several_dampers(scenes);
  return scenes;
}

Scene compared_part(const BenchScene& scene) {
  Scene part = scene.scene;
  if (scene.compared_until) part.until_time = scene.compared_until;
  return part;
}

bool takes_part(const Contender& contender, bool ours, const BenchScene& scene) {
  if (scene.dampers > 0 && !(contender.several && (ours || !has_one_damper(scene.scene)))) return false;
  return contender.walls == scene.walls || (ours && scene.with_others);
}

}  // namespace impact_damper::bench
