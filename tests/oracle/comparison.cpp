// The comparison with the oracle, against planted faults.
#include <doctest/doctest.h>

#include <algorithm>

#include "compare.hpp"
#include "lists.hpp"

using namespace oracle;
using namespace impact_damper;

TEST_CASE("the comparison finds no difference of the oracle's own run, and every planted fault") {
  // In how many of 10 short scenes; or, for what has been altered, whether in the first few of them.
  const auto found = [](const Program& program, bool all = false) {
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
      for (Scene scene : {random_list(seed), round_list(seed)}) {
        scene.until_time = std::min(*scene.until_time, 6.0);
        if (!all && count > 0) return count;
        count += !compare(scene, Restitution{}, {.as_list = true, .program = program}).differences.empty();
      }
    return count;
  };
  const auto with = [](Fault fault) {
    return [fault](const Scene& scene) { return run_of_oracle(scene, Walls::rigid, fault); };
  };
  CHECK(found(with(Fault::none), true) == 0);
  for (const Fault fault :
       {Fault::one_after_another, Fault::not_released, Fault::released_apart, Fault::chattering_cut_short,
        Fault::restitution_of_first, Fault::own_mass_only, Fault::clearance_ignored}) {
    CAPTURE(int(fault));
    const int scenes = found(with(fault), true);
    MESSAGE("fault " << int(fault) << ": found in " << scenes << " of 10 scenes");
    CHECK(scenes > 0);
  }
  // Of what is recorded, a little off.
  const auto altered = [&](const std::function<void(Run&)>& alter) {
    return [alter](const Scene& scene) {
      Run run = run_of_oracle(scene, Walls::rigid);
      alter(run);
      return run;
    };
  };
  const auto nudge = [](std::vector<double>& column) {
    if (!column.empty()) column.back() *= 1 + 1e-6;
  };
  CHECK(found(altered([&](Run& run) { nudge(run.impacts->time); })) > 0);
  CHECK(found(altered([&](Run& run) { nudge(run.impacts->displacement); })) > 0);
  CHECK(found(altered([&](Run& run) { nudge(run.energy->impact_loss); })) > 0);
  CHECK(found(altered([&](Run& run) { nudge(run.contacts->end); })) > 0);
  CHECK(found(altered([&](Run& run) { nudge(run.half_cycles->amplitude); })) > 0);
  CHECK(found(altered([&](Run& run) { nudge(run.history->dampers.back().w); })) > 0);
  CHECK(found(altered([&](Run& run) { run.energy->dampers.back().final_kinetic *= 1 + 1e-6; })) > 0);
  CHECK(found(altered([&](Run& run) { run.energy->dampers.back().impact_loss *= 1 + 1e-6; })) > 0);
  CHECK(found(altered([&](Run& run) { std::ranges::reverse(run.impacts->damper); })) > 0);
  CHECK(found(altered([&](Run& run) { std::ranges::reverse(run.half_cycles->dampers); })) > 0);
}

TEST_CASE(
    "the comparison finds no difference of the oracle's own run, and every fault planted in its walls") {
  const auto found = [&](Fault fault) {
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
      for (Scene scene : {random_compliant_list(seed), round_compliant_list(seed)}) {
        scene.until_time = std::min(*scene.until_time, 2.0);
        const auto planted = [fault](const Scene& asked) {
          return run_of_oracle(asked, Walls::compliant, fault);
        };
        count += !compare(scene, Exact{}, {.as_list = true, .program = planted, .most_steps = 800})
                      .differences.empty();
      }
    return count;
  };
  CHECK(found(Fault::none) == 0);
  for (const Fault fault : {Fault::clearance_ignored, Fault::wall_force_left_out, Fault::wall_damper_of_first,
                            Fault::stiffness_of_first, Fault::own_contact_only, Fault::let_go_by_force}) {
    CAPTURE(int(fault));
    const int count = found(fault);
    MESSAGE("fault " << int(fault) << ": found in " << count << " of 8 scenes");
    CHECK(count > 0);
  }
}
