#include "scenes.hpp"

namespace impact_damper::bench {

std::vector<BenchScene> bench_scenes() {
  const Scene regular{.x0 = 4.5, .until_time = 100};
  return {
      {.name = "S1", .what = "x₀ = 4.5 to t = 100", .scene = regular},
      {.name = "S2", .what = "the same with rigid walls", .scene = regular, .walls = Walls::rigid},
      {.name = "S3",
       .what = "x₀ = 6 to t = 400: bounce-down, stuck",
       .scene = {.x0 = 6, .until_time = 400},
       .with_others = true},
      {.name = "S4",
       .what = "forced and damped to t = 100",
       .scene = {.damping_ratio = 0.01, .x0 = 6, .force_amplitude = 0.05, .until_time = 100}},
      {.name = "S5",
       .what = "the whole decay, 6 to 0.03",
       .scene = {.x0 = 6, .until_amplitude = 0.03},
       .with_others = true,
       .chaotic = true},
  };
}

bool takes_part(const Contender& contender, bool ours, const BenchScene& scene) {
  return contender.walls == scene.walls || (ours && scene.with_others);
}

}  // namespace impact_damper::bench
