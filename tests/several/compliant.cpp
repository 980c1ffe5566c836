// Several dampers between compliant walls: the oracle against that of one damper and its own energy balance,
// and the exact engine against itself where two scenes are one.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "impact_damper/simulate.hpp"
#include "several_compare.hpp"
#include "several_scenes.hpp"

using namespace several;
using namespace impact_damper;

namespace {

const Tolerances compliant{.walls = Walls::compliant};

Answer answer_for(const Scene& scene) {
  Question question;
  question.scene = scene;
  question.walls = Walls::compliant;
  question.most_steps = 4000;
  question.samples = {0, *scene.until_time / 3, *scene.until_time};
  return answer_to(question);
}

double off(Quad a, Quad b) { return double(oracle::magnitude(a - b)); }

// The first scenes of both kinds, at most so long.
std::vector<Scene> scenes(std::uint64_t first, std::uint64_t count, double longest) {
  std::vector<Scene> all;
  for (std::uint64_t seed = first; seed < first + count; ++seed)
    for (Scene scene : {random_compliant_scene(seed), round_compliant_scene(seed)}) {
      scene.until_time = std::min(*scene.until_time, longest);
      all.push_back(scene);
    }
  return all;
}

std::vector<Scene> scenes_of_one(std::uint64_t first, std::uint64_t count, double longest) {
  std::vector<Scene> all = scenes(first, count, longest);
  for (Scene& scene : all) {
    SceneDamper& damper = scene.dampers[0];
    damper.y0 = damper.y0 == damper.clearance  ? 1
                : damper.y0 > damper.clearance ? 1 + (damper.y0 - damper.clearance)
                                               : std::min(damper.y0, 1.0);
    damper.clearance = 1;
    scene.dampers.resize(1);
  }
  return all;
}

}  // namespace

TEST_CASE("the oracle for several dampers has that for one as its case") {
  int compared = 0;
  for (const Scene& scene : scenes_of_one(1, 12, 10)) {
    CAPTURE(text_of(scene));
    const Answer a = answer_for(scene);
    oracle::Question question;
    question.scene = scene;
    question.samples = {0, *scene.until_time / 3, *scene.until_time};
    question.most_steps = 100'000;
    const oracle::Answer b = oracle::answer_to(question);
    if (!a.complete || a.impacts.size() > 60) continue;  // else rounding may grow too far
    REQUIRE(a.impacts.size() == b.impacts.size());
    REQUIRE(a.contacts.size() == b.contacts.size());
    compared += int(a.contacts.size());
    for (std::size_t i = 0; i < a.impacts.size(); ++i) {
      CHECK(off(a.impacts[i].time, b.impacts[i].time) < 1e-15);
      CHECK(off(a.impacts[i].loss, b.impacts[i].loss) < 1e-15);
    }
    for (std::size_t i = 0; i < a.contacts.size(); ++i)
      CHECK(off(a.contacts[i].end, b.contacts[i].end) < 1e-15);
    CHECK(off(a.samples.back().w[0], b.samples.back().w) < 1e-12);
    CHECK(off(a.contact_loss, b.contact_loss) < 1e-15);
    CHECK(off(a.final.wall, b.final.wall) < 1e-15);
    CHECK(off(a.final.paper, b.final.paper) < 1e-15);
  }
  CHECK(compared > 50);
}

TEST_CASE("energy is kept between compliant walls, and no order of the dampers changes anything") {
  int compared = 0, together = 0;
  for (Scene scene : scenes(1, 10, 4)) {
    CAPTURE(text_of(scene));
    const Answer a = answer_for(scene);
    if (!a.complete) continue;
    ++compared;
    Quad losses = 0;
    for (const Quad each : a.damper_loss) losses += each;
    const Quad all = a.initial.total() + a.turnover;
    CHECK(off(a.initial.total() + a.forcing_work, a.final.total() + losses + a.viscous_work) <=
          1e-20 * double(1 + all));
    for (std::size_t i = 0; i + 1 < a.contacts.size(); ++i)
      together += a.contacts[i].end > a.contacts[i + 1].begin;
    std::reverse(scene.dampers.begin(), scene.dampers.end());
    const Answer b = answer_for(scene);
    if (a.impacts.size() > 100) continue;
    CHECK(a.impacts.size() == b.impacts.size());
    CHECK(off(a.samples[2].x, b.samples[2].x) < 1e-12);
  }
  CHECK(compared > 15);
  CHECK(together > 20);
}

TEST_CASE("another order of the dampers changes no byte of what the exact engine records but their numbers") {
  std::size_t impacts = 0;
  for (const Scene& scene : scenes(1, 60, 20)) {
    CAPTURE(text_of(scene));
    const std::size_t count = scene.dampers.size();
    std::vector<std::size_t> order(count);  // where each stands in the other scene
    for (std::size_t n = 0; n < count; ++n) order[n] = (n * 5 + 3) % count;
    if (std::set(order.begin(), order.end()).size() != count)
      for (std::size_t n = 0; n < count; ++n) order[n] = count - 1 - n;
    Scene other = scene;
    for (std::size_t n = 0; n < count; ++n) other.dampers[order[n]] = scene.dampers[n];
    const Run a = simulated(scene, Walls::compliant), b = simulated(other, Walls::compliant);
    impacts += a.impacts->time.size();
    CHECK(a.history->x == b.history->x);
    CHECK(a.history->v == b.history->v);
    CHECK(a.half_cycles->zero_crossing == b.half_cycles->zero_crossing);
    CHECK(a.half_cycles->peak_time == b.half_cycles->peak_time);
    CHECK(a.half_cycles->amplitude == b.half_cycles->amplitude);
    CHECK(a.impacts->time == b.impacts->time);
    CHECK(a.energy->residual == b.energy->residual);
    CHECK(a.energy->viscous_work == b.energy->viscous_work);
    CHECK(a.energy->contact_loss == b.energy->contact_loss);
    CHECK(a.energy->final.total() == b.energy->final.total());
    const auto of_damper = [](const Run& run, std::size_t n) {
      std::vector<double> numbers;
      for (std::size_t i = 0; i < run.impacts->time.size(); ++i)
        if (run.impacts->damper[i] == std::int32_t(n))
          for (const double each :
               {run.impacts->time[i], double(int(run.impacts->wall[i])), run.impacts->relative_velocity[i],
                run.impacts->displacement[i], run.energy->impact_loss[i]})
            numbers.push_back(each);
      for (std::size_t i = 0; i < run.contacts->begin.size(); ++i)
        if (run.contacts->damper[i] == std::int32_t(n))
          for (const double each : {run.contacts->begin[i], run.contacts->end[i]}) numbers.push_back(each);
      for (const auto* column : {&run.history->dampers[n].y, &run.history->dampers[n].w})
        numbers.insert(numbers.end(), column->begin(), column->end());
      const DamperEnergy& energy = run.energy->dampers[n];
      for (const double each :
           {energy.initial_kinetic, energy.final_kinetic, energy.impact_loss, energy.contact_loss})
        numbers.push_back(each);
      return numbers;
    };
    for (std::size_t n = 0; n < count; ++n) {
      CHECK(of_damper(a, n) == of_damper(b, order[n]));
      // Those that are the same move the same.
      for (std::size_t m = 0; m < n; ++m)
        if (scene.dampers[m] == scene.dampers[n]) CHECK(of_damper(a, m) == of_damper(a, n));
    }
  }
  CHECK(impacts > 5'000);
}

TEST_CASE("the exact engine moves two halves of each damper as the whole") {
  const auto halved = [](const Scene& scene) {
    Scene halves = scene;
    halves.dampers.clear();
    for (SceneDamper each : scene.dampers) {
      each.mass_ratio /= 2, each.wall_stiffness /= 2;
      halves.dampers.insert(halves.dampers.end(), 2, each);
    }
    Run run = simulated(halves, Walls::compliant), folded = run;
    folded.scene = scene;
    Impacts& impacts = folded.impacts.emplace();
    folded.energy->impact_loss.clear();
    for (std::size_t i = 0; i < run.impacts->time.size(); ++i) {
      if (run.impacts->damper[i] % 2 != 0) continue;
      impacts.time.push_back(run.impacts->time[i]);
      impacts.wall.push_back(run.impacts->wall[i]);
      impacts.damper.push_back(run.impacts->damper[i] / 2);
      impacts.relative_velocity.push_back(run.impacts->relative_velocity[i]);
      impacts.displacement.push_back(run.impacts->displacement[i]);
      folded.energy->impact_loss.push_back(2 * run.energy->impact_loss[i]);
    }
    Contacts& contacts = folded.contacts.emplace();
    for (std::size_t i = 0; i < run.contacts->begin.size(); ++i) {
      if (run.contacts->damper[i] % 2 != 0) continue;
      contacts.begin.push_back(run.contacts->begin[i]), contacts.end.push_back(run.contacts->end[i]);
      contacts.wall.push_back(run.contacts->wall[i]);
      contacts.damper.push_back(run.contacts->damper[i] / 2);
    }
    folded.history->dampers.clear(), folded.energy->dampers.clear();
    folded.half_cycles->dampers.clear();
    for (auto& each : folded.half_cycles->impacts) each /= 2;
    for (std::size_t n = 0; n < halves.dampers.size(); n += 2) {
      folded.history->dampers.push_back(run.history->dampers[n]);
      folded.half_cycles->dampers.push_back(run.half_cycles->dampers[n]);
      const DamperEnergy &p = run.energy->dampers[n], &q = run.energy->dampers[n + 1];
      folded.energy->dampers.push_back({p.initial_kinetic + q.initial_kinetic,
                                        p.final_kinetic + q.final_kinetic, p.impact_loss + q.impact_loss,
                                        p.contact_loss + q.contact_loss, 0, 0});
    }
    return folded;
  };
  for (const Scene& scene : scenes(23, 2, 3)) {
    CAPTURE(text_of(scene));
    const Comparison result = compare(scene, compliant, halved);
    CHECK(result.differences.size() == 0);
    if (!result.differences.empty()) MESSAGE(result.differences[0]);
  }
}

TEST_CASE("a list of one damper is the scene without a list") {
  const auto alone = [](const Scene& scene) {
    const Run list = simulated(scene, Walls::compliant);
    Run run = simulate(scene, Exact{},
                       {.half_cycles = true,
                        .impacts = true,
                        .contacts = true,
                        .energy = true,
                        .history = {{0, *scene.until_time, std::int64_t(list.history->time.size())}}});
    run.energy->dampers = list.energy->dampers;  // has none of its own
    return run;
  };
  for (const Scene& scene : scenes_of_one(41, 6, 6)) {
    CAPTURE(text_of(scene));
    for (const Program& program : {Program(alone), Program()}) {
      const Comparison result = compare(scene, compliant, program);
      CHECK(result.differences.size() == 0);
      if (!result.differences.empty()) MESSAGE(result.differences[0]);
    }
  }
}

TEST_CASE("scenes in which the exact engine was wrong once") {
  const auto agrees = [](double x0, const std::vector<SceneDamper>& dampers, double end = 1) {
    Scene scene;
    scene.x0 = x0, scene.until_time = end;
    scene.dampers = dampers;
    for (int order = 0; order < 2; ++order) {
      CAPTURE(text_of(scene));
      const Comparison result = compare(scene, compliant);
      CHECK(result.until == end);
      CHECK(result.differences.size() == 0);
      if (!result.differences.empty()) MESSAGE(result.differences[0]);
      std::ranges::reverse(scene.dampers);
    }
  };
  const auto damper = [](double nu, double y0, double w0) {
    SceneDamper one;
    one.mass_ratio = nu, one.y0 = y0, one.w0 = w0;
    return one;
  };
  // Two that begin with impacts, while a third is pressed against its wall.
  agrees(1, {damper(0.1, 1, 0), damper(0.2, 0, -1), damper(0.3, 0, -1)});
  // One at rest that the wall force of another's impact at the beginning presses to its wall; or takes off.
  agrees(0.5, {damper(0.1, 0, 0), damper(0.2, 1, 1)});
  agrees(0.5, {damper(0.1, 1, 0), damper(0.2, 1, 1)});
  // One that rests on its wall until another's impact presses it there: with an impact of no speed.
  agrees(0, {damper(0.1, 0, 0), damper(0.2, 0.5, 1)});
  // Small bounces of one while another is in contact: to the digits of the distance, not of x.
  SceneDamper stiff = damper(0.05, 0, 0), soft = damper(2, 0, 0);
  stiff.restitution = soft.restitution = 1;
  stiff.wall_stiffness = 150'000, soft.wall_stiffness = 50;
  agrees(-4, {stiff, soft}, 0.1);
}

TEST_CASE("slow bounces keep the digits of their distance while another mass presses its wall") {
  Scene scene;
  scene.x0 = -1, scene.damping_ratio = 1, scene.until_time = 0.1;
  scene.dampers = {{.mass_ratio = 1e-6, .restitution = 1, .clearance = 0.5, .wall_stiffness = 100},
                   {.mass_ratio = 1e-6, .restitution = 0.6, .clearance = 1, .wall_stiffness = 12.5}};
  const Comparison result = compare(scene, {.walls = Walls::compliant, .growth = 20});
  CHECK(result.until == 0.1);
  CHECK(result.impacts > 100);
  CHECK(result.differences.size() == 0);
  if (!result.differences.empty()) MESSAGE(result.differences[0]);
}
