// Several dampers on one primary mass: random lists, and events of several masses that fall on one instant.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>

#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "stress.hpp"

namespace stress {

using namespace impact_damper;

namespace {

constexpr Budget few_impacts{.max_impacts = 400, .max_time = 1e9};
const std::array<Engine, 2> both{Exact{.budget = few_impacts}, Restitution{.budget = few_impacts}};

Check about(const std::string& what, const std::string& allowed) {
  return {.subject = "dampers", .what = what, .measured = {}, .allowed = allowed};
}

// 1 to 6 dampers, some of them like the one before; at times up to 40.
Scene list_of(std::uint64_t seed) {
  reference::Random random(seed);
  Scene scene;
  scene.x0 = random.log_uniform(1e-2, 30) * random.sign();
  scene.v0 = random.chance(0.5) ? 0 : random.uniform(-10, 10);
  scene.damping_ratio = random.chance(0.5) ? 0 : random.log_uniform(1e-3, 3);
  if (random.chance(1 / 3.)) {
    scene.force_amplitude = random.log_uniform(0.01, 10);
    scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.1, 10);
  }
  scene.until_time = random.uniform(1, 6);
  scene.dampers.clear();
  const int count = 1 + int(random.bits() % (random.chance(0.05) ? 40 : 6));
  for (int i = 0; i < count; ++i) {
    SceneDamper damper;
    if (i > 0 && random.chance(0.3)) damper = scene.dampers.back();
    if (i == 0 || random.chance(0.7)) {
      damper.clearance = random.log_uniform(1e-3, 1e3);
      const bool flies = random.chance(0.5);
      damper.y0 = damper.clearance * (flies ? random.uniform(0, 1) : double(random.chance(0.5)));
      damper.w0 = flies && random.chance(0.7) ? random.uniform(-3, 3) : 0;
    }
    damper.mass_ratio = random.log_uniform(1e-4, random.chance(0.1) ? 10 : 0.3);
    damper.restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 1);
    damper.wall_stiffness = damper.mass_ratio * random.log_uniform(30, 1e6);
    scene.dampers.push_back(damper);
  }
  return scene;
}

std::vector<Check> random_lists(const Options& options) {
  constexpr std::int64_t block = 64;
  const std::uint64_t first = options.seed.value_or(1);
  const std::int64_t count = options.seed ? 1 : options.scenes / 10, blocks = (count + block - 1) / block;
  struct Part {
    std::array<Check, 2> checks;
    std::array<Worst, 2> residual;
  };
  std::vector<Part> parts(static_cast<std::size_t>(blocks));
  Progress progress("random lists of dampers");
  std::atomic<std::int64_t> done{0};
  for_each_index(blocks, {}, [&](std::int64_t b) {
    Part& part = parts[std::size_t(b)];
    for (std::int64_t i = b * block; i < std::min(count, (b + 1) * block); ++i) {
      const std::uint64_t seed = first + std::uint64_t(i);
      for (std::size_t e = 0; e < 2; ++e)
        part.residual[e].take(keep_promises(part.checks[e], "--only dampers --seed " + std::to_string(seed),
                                            list_of(seed), both[e])
                                  .residual);
    }
    done += block;
    if (b % 8 == 0) progress.tell(done, count);
  });
  std::vector<Check> checks;
  for (std::size_t e = 0; e < 2; ++e) {
    Check whole =
        about(std::string(name_of(both[e])) +
                  ": a random list, clearances from 1e-3 to 1e3: all that a scene promises; balance",
              "all; " + rounded(closed_balance));
    Worst residual;
    for (const Part& part : parts) {
      whole.add(part.checks[e]);
      residual.take(part.residual[e]);
    }
    whole.measured = std::string(whole.all_or_not()) + "; " + rounded(residual);
    checks.push_back(whole);
  }
  return checks;
}

// When it is first the damper's turn: of its impacts, or of the ends of its contacts.
double first_of(const std::vector<double>& times, const std::vector<std::int32_t>& dampers, int damper) {
  const auto at = std::ranges::find(dampers, damper);
  return at == dampers.end() ? std::numeric_limits<double>::infinity()
                             : times[std::size_t(at - dampers.begin())];
}
double first_impact(const Run& run, int damper) {
  return first_of(run.impacts->time, run.impacts->damper, damper);
}
double first_end_of_contact(const Run& run, int damper) {
  return first_of(run.contacts->end, run.contacts->damper, damper);
}
Run watched(const Scene& scene, const Engine& engine) {
  return simulate(scene, engine, {.impacts = true, .contacts = true});
}

// 2 to 10 masses, each released so that it meets its wall when the first one does, to the last bit, and a few
// last bits before and after; on the same wall or on the other one.
Check coincident(const Options& options) {
  Check check = about("2 to 10 impacts on one instant, to the last bit, and a few bits beside it", "all");
  for (int count = 2; count <= (options.brief ? 4 : 10); ++count) {
    for (const Engine& engine : both) {
      for (const bool opposite : {false, true}) {
        Scene scene{.x0 = 3, .until_time = 2, .dampers = {{.clearance = 1, .y0 = 0.3, .w0 = 0.1}}};
        const double at = first_impact(watched(scene, engine), 0);
        for (int i = 1; i < count; ++i) {
          SceneDamper damper{
              .mass_ratio = 0.01 * (1 + i % 3), .restitution = 0.1 * i, .wall_stiffness = 1e3 * i};
          damper.clearance = 1 + 0.1 * i;
          damper.w0 = (opposite && i % 2 == 1 ? -2 : 0.2) - 0.02 * i;
          Scene alone = scene;
          alone.dampers = {damper};
          alone.dampers[0].y0 = last_bit(0, damper.clearance, [&](double y0) {
            alone.dampers[0].y0 = y0;
            const double time = first_impact(watched(alone, engine), 0);
            return damper.w0 > -1 ? time <= at : time >= at;
          });
          scene.dampers.push_back(alone.dampers[0]);
        }
        for (int ulps = -4; ulps <= 4; ++ulps) {
          Scene near = scene;
          for (std::size_t i = 1; i < near.dampers.size(); ++i)
            near.dampers[i].y0 = steps_from(near.dampers[i].y0, i % 2 == 0 ? ulps : -ulps);
          keep_promises(check, "case", near, engine);
          const Run run = watched(near, engine);
          for (int i = 0; i < count; ++i) {
            const double off = std::abs(first_impact(run, i) - at);
            if (!(off <= 1e-14))
              check.miss("an impact is lost or " + rounded(off) + " off; " + in_full(near, engine));
          }
        }
      }
    }
  }
  check.measured = check.all_or_not();
  return check;
}

// One mass leaves its wall as another meets its own, to the last bit.
Check changing_together() {
  Check check = about("one leaves its wall as another meets its own, to the last bit, and beside it", "all");
  for (const Engine& engine : both) {
    for (const double k : {1e2, 1e4, 1e7}) {
      // Pressed to its left wall at first.
      const Scene scene{.x0 = -2, .until_time = 4, .dampers = {{.clearance = 4, .wall_stiffness = k}}};
      const double at = first_end_of_contact(watched(scene, engine), 0);
      SceneDamper damper{
          .mass_ratio = 0.05, .restitution = 0.4, .clearance = 5, .wall_stiffness = k, .w0 = -1};
      Scene alone = scene;
      alone.dampers.push_back(damper);
      alone.dampers[1].y0 = last_bit(0.5, 5, [&](double y0) {
        alone.dampers[1].y0 = y0;
        return first_impact(watched(alone, engine), 1) >= at;
      });
      for (int ulps = -16; ulps <= 16; ++ulps) {
        Scene near = alone;
        near.dampers[1].y0 = steps_from(near.dampers[1].y0, ulps);
        keep_promises(check, "case", near, engine);
        const Run run = watched(near, engine);
        if (!(std::abs(first_impact(run, 1) - at) <= 1e-13 &&
              std::abs(first_end_of_contact(run, 0) - at) <= 1e-13))
          check.miss("an event is lost; " + in_full(near, engine));
      }
    }
  }
  check.measured = check.all_or_not();
  return check;
}

// As many as a list may have, in one order and in the other.
Check a_thousand(const Options& options) {
  Check check =
      about("a thousand dampers, clearances from 1e-3 to 1e3; another order of them, the same bits", "all");
  Scene scene;
  scene.x0 = 6, scene.until_time = options.brief ? 0.04 : 3;
  scene.dampers.clear();
  for (int i = 0; i < int(most_dampers); ++i)
    scene.dampers.push_back({.mass_ratio = 2e-5,
                             .restitution = 0.2 + 0.0006 * i,
                             .clearance = std::pow(10, -3 + 0.006 * i),
                             .wall_stiffness = 20 + 0.02 * i});
  Scene reversed = scene;
  std::ranges::reverse(reversed.dampers);
  for (Engine engine : both) {
    std::visit([](auto& its) { its.budget.max_impacts = 2'000'000; }, engine);
    keep_promises(check, "case", scene, engine);
    const Run one = watched(scene, engine), other = watched(reversed, engine);
    if (!(one.impacts->time == other.impacts->time &&
          one.half_cycles->amplitude == other.half_cycles->amplitude))
      check.miss("another order, another motion; " + std::string(name_of(engine)));
  }
  check.measured = check.all_or_not();
  return check;
}

}  // namespace

std::vector<Check> several_dampers(const Options& options) {
  std::vector<Check> checks = random_lists(options);
  if (options.seed) return checks;
  say("dampers on one instant");
  checks.push_back(coincident(options));
  checks.push_back(changing_together());
  say("a thousand dampers");
  checks.push_back(a_thousand(options));
  return checks;
}

}  // namespace stress
