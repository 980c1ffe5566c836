#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>

#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "shared_scenes.hpp"

using namespace impact_damper;
using random_scenes::scene_of;

namespace {

bool finite(const std::vector<double>& values) {
  for (double value : values) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

constexpr std::uint64_t first_seed = 1, seeds = 2000;
constexpr double closed = 1e-10;  // 1e4 impacts at most, each a few dozen roundings

// Everything that any scene promises: finite numbers, times in order, an energy balance that closes.
void check(const Scene& scene, const Engine& engine) {
  const Record record{
      .impacts = true, .contacts = true, .energy = true, .history = {{0, *scene.until_time, 50}}};
  const Run run = simulate(scene, engine, record);
  CHECK(std::isfinite(run.end_time));
  CHECK(run.end_time <= *scene.until_time);
  CHECK((run.stop_reason == StopReason::time || run.stop_reason == StopReason::impact_budget));
  CHECK(finite(run.half_cycles->zero_crossing));
  CHECK(finite(run.half_cycles->peak_time));
  CHECK(finite(run.half_cycles->amplitude));
  CHECK(finite(run.impacts->time));
  CHECK(finite(run.impacts->relative_velocity));
  CHECK(finite(run.energy->impact_loss));
  CHECK(finite(run.history->x));
  CHECK(finite(run.history->v));
  CHECK(finite(run.history->dampers[0].y));
  CHECK(finite(run.history->dampers[0].w));
  for (std::size_t i = 0; i < run.impacts->time.size(); ++i) {
    const double before = i > 0 ? run.impacts->time[i - 1] : 0;
    CHECK(run.impacts->time[i] >= before);
    const double w = run.impacts->relative_velocity[i];
    CHECK((run.impacts->wall[i] == Wall::left ? w <= 0 : w >= 0));
    CHECK(run.energy->impact_loss[i] >= 0);
  }
  for (std::size_t i = 0; i < run.contacts->begin.size(); ++i)
    CHECK(run.contacts->end[i] >= run.contacts->begin[i]);
  for (std::size_t i = 1; i < run.half_cycles->zero_crossing.size(); ++i) {
    CHECK(run.half_cycles->zero_crossing[i] > run.half_cycles->zero_crossing[i - 1]);
    CHECK(run.half_cycles->amplitude[i] >= 0);
  }
  CHECK(std::abs(run.energy->residual) < closed);
}

}  // namespace

TEST_CASE(
    "any scene runs to its end in the exact engine, finite, in order and with an energy balance that "
    "closes") {
  const Exact options{.budget = {.max_impacts = 10000}};
  for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
    const Scene scene = scene_of(seed);
    CAPTURE(seed);
    CAPTURE(scene_text(scene));
    check(scene, options);
  }
}

// x is a rounding error of what the wall makes of it: whether it rises or falls cannot be told for a while.
TEST_CASE("a scene whose primary mass has hardly moved when it is struck is no effort") {
  const Exact options{.budget = {.max_impacts = 1000}};
  for (const std::uint64_t seed : {27136u, 40313u, 99905u, 120138u, 131791u}) {
    Scene scene = scene_of(seed);
    REQUIRE(scene.x0 == 0);
    CAPTURE(scene_text(scene));
    check(scene, options);
  }
}

TEST_CASE("any scene that begins between rigid walls runs to its end in the restitution engine") {
  const Restitution options{.budget = {.max_impacts = 10000}};
  for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
    Scene scene = scene_of(seed);
    scene.damper().y0 = std::fmin(std::fmax(scene.damper().y0, 0), 1);
    CAPTURE(seed);
    CAPTURE(scene_text(scene));
    check(scene, options);
  }
}
