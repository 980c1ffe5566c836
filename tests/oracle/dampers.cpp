// Several dampers between compliant walls: the oracle's energy balance, and the exact engine against itself
// where two scenes are one.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "compare.hpp"
#include "impact_damper/simulate.hpp"
#include "lists.hpp"

using namespace oracle;
using namespace impact_damper;

namespace {

Answer answer_for(const Scene& scene) {
  Question question;
  question.scene = scene;
  question.walls = Walls::compliant;
  question.most_steps = 4000;
  question.samples = {0, *scene.until_time / 3, *scene.until_time};
  return answer_to(question);
}

Run run_of(const Scene& scene) { return simulated(scene, Exact{}, true); }

// The first scenes of both kinds, at most so long.
std::vector<Scene> scenes(std::uint64_t first, std::uint64_t count, double longest) {
  std::vector<Scene> all;
  for (std::uint64_t seed = first; seed < first + count; ++seed)
    for (Scene scene : {random_compliant_list(seed), round_compliant_list(seed)}) {
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

TEST_CASE("energy is kept between compliant walls, and no order of the dampers changes anything") {
  int compared = 0, together = 0;
  for (Scene scene : scenes(1, 10, 4)) {
    CAPTURE(text_of(scene));
    const Answer a = answer_for(scene);
    if (!a.complete()) continue;
    ++compared;
    const Quad all = a.initial.total() + a.turnover;
    CHECK(double(magnitude(a.residual())) <= 1e-20 * double(1 + all));
    for (std::size_t i = 0; i + 1 < a.contacts.size(); ++i)
      together += a.contacts[i].end > a.contacts[i + 1].begin;
    std::reverse(scene.dampers.begin(), scene.dampers.end());
    const Answer b = answer_for(scene);
    if (a.impacts.size() > 100) continue;
    CHECK(a.impacts.size() == b.impacts.size());
    CHECK(double(magnitude(a.samples[2].x - b.samples[2].x)) < 1e-12);
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
    const Run a = run_of(scene), b = run_of(other);
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
      const impact_damper::DamperEnergy& energy = run.energy->dampers[n];
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
    Run run = run_of(halves), folded = run;
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
      impacts.phase_deg.push_back(run.impacts->phase_deg[i]);
      impacts.amplitude.push_back(run.impacts->amplitude[i]);
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
      const impact_damper::DamperEnergy &p = run.energy->dampers[n], &q = run.energy->dampers[n + 1];
      folded.energy->dampers.push_back({p.initial_kinetic + q.initial_kinetic,
                                        p.final_kinetic + q.final_kinetic, p.impact_loss + q.impact_loss,
                                        p.contact_loss + q.contact_loss, 0, 0});
    }
    return folded;
  };
  for (const Scene& scene : scenes(23, 2, 3)) {
    CAPTURE(text_of(scene));
    const Comparison result = compare(scene, Exact{}, {.as_list = true}, {halved}).front();
    CHECK(result.differences.size() == 0);
    if (!result.differences.empty()) MESSAGE(result.differences[0]);
  }
}

TEST_CASE("a list of one damper is the scene without a list") {
  for (const Scene& scene : scenes_of_one(41, 6, 6)) {
    CAPTURE(text_of(scene));
    for (const bool as_list : {false, true}) {
      const Comparison result = compare(scene, Exact{}, {.as_list = as_list, .most_steps = 5000});
      CHECK(result.differences.size() == 0);
      if (!result.differences.empty()) MESSAGE(result.differences[0]);
    }
  }
}
