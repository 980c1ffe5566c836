// The comparison with the oracle, against planted faults.
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

#include "compare.hpp"
#include "scenes.hpp"

using namespace oracle;
using namespace impact_damper;

namespace {

// In how many of these scenes each program's run differs from the oracle's.
std::vector<int> found(const std::vector<Scene>& scenes, const Engine& engine, std::int64_t most_steps,
                       const std::vector<Program>& programs) {
  std::vector<int> counts(programs.size(), 0);
  for (const Scene& scene : scenes) {
    const auto all = compare(scene, engine, {.as_list = true, .most_steps = most_steps}, programs);
    for (std::size_t i = 0; i < all.size(); ++i) counts[i] += !all[i].differences.empty();
  }
  return counts;
}
std::vector<Program> with(Walls walls, const std::vector<Fault>& faults) {
  std::vector<Program> programs;
  for (const Fault fault : faults)
    programs.push_back([=](const Scene& scene) { return run_of_oracle(scene, walls, fault); });
  return programs;
}
void check_found(const std::vector<int>& counts) {
  CHECK(counts[0] == 0);  // no fault
  for (std::size_t i = 1; i < counts.size(); ++i) {
    CAPTURE(i);
    MESSAGE("found in " << counts[i] << " scenes");
    CHECK(counts[i] > 0);
  }
}

}  // namespace

TEST_CASE("the comparison finds no difference of the oracle's own run, and every planted fault") {
  std::vector<Scene> scenes;
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    for (Scene scene : {random_list(seed), round_list(seed)}) {
      scene.until_time = std::min(*scene.until_time, 6.0);
      scenes.push_back(scene);
    }
  std::vector<Program> programs =
      with(Walls::rigid, {Fault::none, Fault::one_after_another, Fault::not_released, Fault::released_apart,
                          Fault::chattering_cut_short, Fault::restitution_of_first, Fault::own_mass_only,
                          Fault::clearance_ignored});
  // Of what is recorded, a little off.
  const auto add = [&](const std::function<void(Run&)>& alter) {
    programs.push_back([alter](const Scene& scene) {
      Run run = run_of_oracle(scene, Walls::rigid);
      alter(run);
      return run;
    });
  };
  const auto nudge = [](std::vector<double>& column) {
    if (!column.empty()) column.back() *= 1 + 1e-6;
  };
  add([&](Run& run) { nudge(run.impacts->time); });
  add([&](Run& run) { nudge(run.impacts->displacement); });
  add([&](Run& run) { nudge(run.energy->impact_loss); });
  add([&](Run& run) { nudge(run.contacts->end); });
  add([&](Run& run) { nudge(run.half_cycles->amplitude); });
  add([&](Run& run) { nudge(run.history->dampers.back().w); });
  add([&](Run& run) { run.energy->dampers.back().final_kinetic *= 1 + 1e-6; });
  add([&](Run& run) { run.energy->dampers.back().impact_loss *= 1 + 1e-6; });
  add([&](Run& run) { std::ranges::reverse(run.impacts->damper); });
  add([&](Run& run) { std::ranges::reverse(run.half_cycles->dampers); });
  check_found(found(scenes, Restitution{}, 0, programs));
}

TEST_CASE(
    "the comparison finds no difference of the oracle's own run, and every fault planted in its walls") {
  std::vector<Scene> scenes;
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    for (Scene scene : {random_compliant_list(seed), round_compliant_list(seed)}) {
      scene.until_time = std::min(*scene.until_time, 2.0);
      scenes.push_back(scene);
    }
  check_found(found(scenes, Exact{}, 800,
                    with(Walls::compliant, {Fault::none, Fault::clearance_ignored, Fault::wall_force_left_out,
                                            Fault::wall_damper_of_first, Fault::stiffness_of_first,
                                            Fault::own_contact_only, Fault::let_go_by_force})));
}

TEST_CASE(
    "the comparison finds no difference of the oracle's own run, and every fault in friction, weight and "
    "drag") {
  for (const Walls walls : {Walls::rigid, Walls::compliant}) {
    const bool rigid = walls == Walls::rigid;
    std::vector<Scene> scenes;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const bool round = seed % 2 == 0;
      const Scene plain = rigid ? (round ? round_list(seed) : random_list(seed))
                                : (round ? round_compliant_list(seed) : random_compliant_list(seed));
      scenes.push_back(with_components(plain, seed, round));
      scenes.back().until_time = std::min(*plain.until_time, rigid ? 6.0 : 2.0);
    }
    std::vector<Program> programs = with(walls, {Fault::none});
    const auto add = [&](const std::function<void(Scene&)>& before, const std::function<void(Run&)>& after) {
      programs.push_back([=](const Scene& scene) {
        Scene other = scene;
        if (before) before(other);
        Run run = run_of_oracle(other, walls);
        if (after) after(run);
        run.scene = scene;
        return run;
      });
    };
    const auto nudge = [](double& number) { number *= 1 + 1e-6; };
    const auto add_of_each = [&](const std::function<void(SceneDamper&)>& alter) {
      add([=](Scene& scene) { std::ranges::for_each(scene.dampers, alter); }, {});
    };
    add([=](Scene& scene) { nudge(scene.weight); }, {});
    add_of_each([=](SceneDamper& its) { nudge(its.friction); });
    add_of_each([=](SceneDamper& its) { nudge(its.drag); });
    add_of_each([](SceneDamper& its) { its.static_friction = 0; });
    add({}, [=](Run& run) { nudge(run.energy->friction_loss); });
    add({}, [=](Run& run) { nudge(run.energy->drag_loss); });
    add({}, [=](Run& run) { nudge(run.energy->initial.weight); });
    add({}, [=](Run& run) { nudge(run.energy->final.weight); });
    add({}, [=](Run& run) { nudge(run.energy->dampers.back().friction_loss); });
    add({}, [=](Run& run) { nudge(run.energy->dampers.back().drag_loss); });
    check_found(found(scenes, rigid ? Engine(Restitution{}) : Engine(Exact{}), 3000, programs));
  }
}
