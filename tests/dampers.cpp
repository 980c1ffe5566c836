// Several dampers by each engine: against the engine of one damper, the oracle (oracle/oracle.hpp), closed
// forms, and themselves in another guise.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "compare.hpp"
#include "impact_damper/engines/cem_scheme.hpp"
#include "impact_damper/motion/impact_law.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "same_run.hpp"
#include "scenes.hpp"
#include "shared_scenes.hpp"

using namespace impact_damper;
using reference::columns_of, reference::farthest, reference::order;

namespace {

constexpr int samples = 201;
Record everything(const Scene& scene) { return reference::everything({{0, *scene.until_time, samples}}); }
Run run_of(const Scene& scene, const Engine& engine) { return simulate(scene, engine, everything(scene)); }
// What the engines of lists make of a scene of one damper.
Run run_of_list(const Scene& scene, const Engine& engine) {
  return in_its_own_units(run_of(list_of_one(scene), engine));
}
const Engine rigid = Restitution{.budget = {.max_impacts = 20'000}};

SceneDamper damper(double nu, double e, double clearance, double k, double y0, double w0) {
  return {
      .mass_ratio = nu, .restitution = e, .clearance = clearance, .wall_stiffness = k, .y0 = y0, .w0 = w0};
}

const Scene four{.damping_ratio = 0.03,
                 .x0 = 3,
                 .until_time = 7,
                 .dampers = {damper(0.05, 0.5, 1, 400, 0, 0), damper(0.1, 0.2, 0.3, 900, 0, 0),
                             damper(0.2, 0.7, 4, 300, 1, 0), damper(0.08, 0.4, 0.7, 2000, 0.7, -0.5)}};
const Scene two_shaken{.x0 = 0.2,
                       .v0 = 1,
                       .force_amplitude = 2,
                       .force_frequency = 1.7,
                       .until_time = 9,
                       .dampers = {damper(0.3, 0.6, 0.3, 200, 0.1, 0), damper(0.1, 0.3, 4, 500, -0.01, 0)}};

const std::vector<Scene> single{
    {.until_time = 30},
    {.damping_ratio = 0.02,
     .x0 = 3,
     .force_amplitude = 0.5,
     .force_frequency = 0.9,
     .until_time = 15,
     .dampers = {{.mass_ratio = 0.1, .restitution = 0.3, .y0 = 0.4}}},
    {.damping_ratio = 0.3,
     .x0 = 0.5,
     .v0 = -1,
     .force_amplitude = 3,
     .force_frequency = 4,
     .until_time = 8,
     .dampers = {{.mass_ratio = 0.5, .restitution = 0.7, .y0 = 0.5}}},
    {.damping_ratio = 1.2,
     .x0 = -4,
     .until_time = 4,
     .dampers = {{.restitution = 0.2, .y0 = -0.01, .w0 = 0.5}}},
    {.x0 = 2,
     .until_time = 8,
     .dampers = {{.mass_ratio = 0.05, .restitution = 0.5, .wall_stiffness = 50, .y0 = 1.05}}},
    {.x0 = 0, .force_amplitude = 1, .force_frequency = 2, .until_time = 10, .dampers = {{.y0 = 1}}}};

// The component element method by itself, and with the stuck regime, with two rates, and with both.
const std::vector<Cem> ways{{},
                            {.locate = true},
                            {.damper = Damper::lagged},
                            {.damper = Damper::lagged, .locate = true},
                            {.calibration = Calibration::two_body}};
const std::vector<Cem> further_ways{{.stuck_speed = 0.3},
                                    {.locate = true, .stuck_speed = 0.1},
                                    {.large_step = 0.05},
                                    {.damper = Damper::lagged, .large_step = 0.02},
                                    {.locate = true, .large_step = 0.02, .stuck_speed = 0.3}};

// 1 to 6 dampers; forced in a third of the scenes, damped in a half. Those that fly begin up to `overlap` of
// the clearance inside a wall. `clearance()` and `wall_stiffness(mass_ratio)` are asked for each in turn.
template <class Clearance, class Stiffness>
Scene random_list(reference::Random& random, double overlap, const Clearance& clearance,
                  const Stiffness& wall_stiffness) {
  Scene scene;
  scene.damping_ratio = random.chance(0.5) ? 0 : random.log_uniform(1e-3, 2);
  scene.x0 = random.uniform(-10, 10);
  scene.v0 = random.chance(0.5) ? 0 : random.uniform(-10, 10);
  if (random.chance(0.33)) {
    scene.force_amplitude = random.log_uniform(0.1, 10);
    scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.1, 10);
  }
  const int count = 1 + int(random.uniform(0, 6));
  scene.dampers.clear();
  for (int i = 0; i < count; ++i) {
    SceneDamper& each = scene.dampers.emplace_back();
    each.mass_ratio = random.log_uniform(1e-3, random.chance(0.2) ? 10 : 0.5);
    each.restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 1);
    each.clearance = clearance();
    each.wall_stiffness = wall_stiffness(each.mass_ratio);
    const bool flies = random.chance(0.4);
    each.y0 = each.clearance * (flies ? random.uniform(-overlap, 1 + overlap) : double(random.chance(0.5)));
    each.w0 = flies ? random.uniform(-3, 3) : 0;
  }
  scene.until_time = 10;
  return scene;
}
Scene random_rigid_list(std::uint64_t seed) {
  reference::Random random(seed);
  Scene scene = random_list(
      random, 0, [&] { return random.log_uniform(0.1, 10); },
      [](double) { return SceneDamper{}.wall_stiffness; });
  scene.until_time = 40;
  return scene;
}

// How far a run is from the reference, at 201 times and in all impacts.
struct Distance {
  double x = 0, y = 0, impacts = 0, losses = 0, viscous = 0, residual = 0;
};
Distance distance(const Run& run, const Run& reference) {
  Distance far;
  far.x = farthest(run.history->x, reference.history->x);
  double loss = run.energy->contact_loss, expected = reference.energy->contact_loss;
  for (std::size_t j = 0; j < run.scene.dampers.size(); ++j) {
    far.y = std::max(far.y, farthest(run.history->dampers[j].y, reference.history->dampers[j].y));
    // Impacts of each damper by itself: those of different ones may be closer together than the error.
    const auto of_damper = [j](const Impacts& impacts) {
      std::vector<std::size_t> its;
      for (std::size_t i = 0; i < impacts.time.size(); ++i)
        if (impacts.damper[i] == int(j)) its.push_back(i);
      return its;
    };
    const Impacts &mine = *run.impacts, &other = *reference.impacts;
    const std::vector<std::size_t> some = of_damper(mine), all = of_damper(other);
    if (some.size() != all.size()) far.impacts = 1;
    for (std::size_t n = 0; n < std::min(some.size(), all.size()); ++n)
      far.impacts = std::max({far.impacts, std::abs(mine.time[some[n]] - other.time[all[n]]),
                              std::abs(mine.relative_velocity[some[n]] - other.relative_velocity[all[n]])});
    const double its = run.energy->dampers[j].impact_loss,
                 true_loss = reference.energy->dampers[j].impact_loss;
    far.losses = std::max(far.losses, std::abs(its - true_loss));
    loss += its, expected += true_loss;
  }
  far.losses = std::max(far.losses, std::abs(loss - expected));
  far.viscous = std::abs(run.energy->viscous_work - reference.energy->viscous_work);
  far.residual = std::abs(run.energy->residual);
  return far;
}
// The mean over neighbouring steps: where in a step touch and release fall differs.
Distance mean_distance(const Scene& scene, const Run& reference, Cem options, double h, int runs) {
  Distance mean;
  for (int i = 0; i < runs; ++i) {
    options.time_step = h * (1 + i / (2.0 * runs));
    const Distance far = distance(run_of(scene, options), reference);
    for (const auto member : {&Distance::x, &Distance::y, &Distance::impacts, &Distance::losses,
                              &Distance::viscous, &Distance::residual})
      mean.*member += far.*member / runs;
  }
  return mean;
}
Run reference_of(const Scene& scene) {
  return oracle::run_of_oracle(scene, oracle::Walls::compliant, oracle::Fault::none, samples);
}
// The exact engine's run has the reference's motion and energy to rounding.
Distance check_exact(const Run& run, const Run& reference) {
  const Distance far = distance(run, reference);
  CHECK(far.x < 1e-13);
  CHECK(far.y < 1e-12);
  CHECK(far.viscous < 1e-13);
  CHECK(far.residual < 1e-14);
  return far;
}
// Enough happens in the reference: the three that are in contact at once, or both, and many impacts.
void check_eventful(const Run& reference) {
  const Contacts& contacts = *reference.contacts;
  int most = 0;
  for (const double begin : contacts.begin) {
    int count = 0;
    for (std::size_t i = 0; i < contacts.begin.size(); ++i)
      count += contacts.begin[i] <= begin && begin < contacts.end[i];
    most = std::max(most, count);
  }
  CHECK(most == std::min(3, int(reference.scene.dampers.size())));
  REQUIRE(reference.impacts->time.size() > 10);
}

// All columns of `some` are those of `all` to within `off`.
void check_alike(const Run& some, const Run& all, double off) {
  const auto alike = [&](const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) CHECK(std::abs(a[i] - b[i]) <= off * (1 + std::abs(b[i])));
  };
  CHECK(some.stop_reason == all.stop_reason);
  CHECK(some.end_time == doctest::Approx(all.end_time).epsilon(off));
  alike(some.half_cycles->zero_crossing, all.half_cycles->zero_crossing);
  alike(some.half_cycles->peak_time, all.half_cycles->peak_time);
  alike(some.half_cycles->amplitude, all.half_cycles->amplitude);
  alike(some.history->x, all.history->x);
  alike(some.history->v, all.history->v);
  const auto energies = [](const Run& run) {
    const EnergyBalance& e = *run.energy;
    double losses = 0;
    for (const double loss : e.impact_loss) losses += loss;
    return std::vector{e.initial.total(), e.initial.paper, e.final.kinetic, e.final.spring,
                       e.final.wall,      e.final.paper,   losses,          e.contact_loss,
                       e.viscous_work,    e.forcing_work,  e.residual};
  };
  alike(energies(some), energies(all));
}

// Until when two runs' half cycles agree to within `off` times (1 + time). (Impacts cannot be counted one by
// one: whether one more of a chattering is followed before its limit is taken is a matter of rounding.)
double agree_until(const Run& one, const Run& other, double off, double unit = 1) {
  const HalfCycles &a = *one.half_cycles, &b = *other.half_cycles;
  for (std::size_t i = 0; i < std::min(a.amplitude.size(), b.amplitude.size()); ++i) {
    const double t = a.zero_crossing[i], allowed = off * (1 + t);
    if (std::abs(t - b.zero_crossing[i]) > allowed ||
        std::abs(a.amplitude[i] - unit * b.amplitude[i]) > allowed * a.amplitude[i])
      return i == 0 ? 0 : a.zero_crossing[i - 1];
  }
  return one.end_time;
}

// The scene's first damper as so many parts, with their shares of its wall.
Scene in_parts(Scene scene, const std::array<double, 3>& shares) {
  scene.dampers.assign(shares.size(), scene.dampers.front());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    scene.dampers[i].mass_ratio *= shares[i];
    scene.dampers[i].wall_stiffness *= shares[i];
  }
  return scene;
}

std::size_t joined_contacts(const Run& run) {  // those that last for longer than a rebound
  std::size_t count = 0;
  for (std::size_t i = 0; i < run.contacts->end.size(); ++i)
    count += run.contacts->end[i] - run.contacts->begin[i] > 0.2;
  return count;
}

// All that a run records of one damper, in order.
std::vector<double> of_damper(const Run& run, std::size_t n) {
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
  for (const std::int64_t impacts : run.half_cycles->dampers[n].impacts) numbers.push_back(double(impacts));
  const DamperEnergy& energy = run.energy->dampers[n];
  for (const double each :
       {energy.initial_kinetic, energy.final_kinetic, energy.impact_loss, energy.contact_loss})
    numbers.push_back(each);
  return numbers;
}

// The scene with its dampers in another order has the same run, to the last bit, but for their numbers.
// Returns how many impacts were compared.
std::size_t check_order_is_free(const Scene& scene, const Engine& engine) {
  const std::size_t count = scene.dampers.size();
  if (count == 1) return 0;
  std::vector<std::size_t> place(count);  // where each stands in the other scene
  for (std::size_t n = 0; n < count; ++n) place[n] = count % 5 == 0 ? count - 1 - n : (n * 5 + 3) % count;
  Scene other = scene;
  for (std::size_t n = 0; n < count; ++n) other.dampers[place[n]] = scene.dampers[n];
  const Run a = run_of(scene, engine), b = run_of(other, engine);
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
  for (std::size_t n = 0; n < count; ++n) {
    CHECK(of_damper(a, n) == of_damper(b, place[n]));
    // Those that are the same move the same.
    for (std::size_t m = 0; m < n; ++m)
      if (scene.dampers[m] == scene.dampers[n]) CHECK(of_damper(a, m) == of_damper(a, n));
  }
  return a.impacts->time.size();
}

void check_mirrored(const Scene& scene, const Engine& engine, const Run& run) {
  const Run other = run_of(mirrored(scene), engine);
  for (std::size_t i = 0; i < std::min<std::size_t>(run.history->x.size(), 5); ++i)
    CHECK(std::abs(run.history->x[i] + other.history->x[i]) < 1e-6);
  for (std::size_t i = 0; i < std::min<std::size_t>(run.impacts->time.size(), 2); ++i)
    CHECK(std::abs(run.impacts->time[i] - other.impacts->time[i]) < 1e-6);
}

// "field: message" of the first problem, or nothing.
std::string problem_of(const Scene& scene, const Engine& engine) {
  try {
    simulate(scene, engine, Record{});
  } catch (const InvalidArguments& error) {
    return error.problems().front().field + ": " + error.problems().front().message;
  }
  return {};
}

}  // namespace

TEST_CASE("a list of one damper is the scene with that damper, by the component element method to the bit") {
  for (const Scene& scene : single) {
    CAPTURE(&scene - single.data());
    for (const Calibration calibration : {Calibration::fixed_wall, Calibration::two_body}) {
      const Exact options{.calibration = calibration};
      const Run list = run_of_list(scene, options), one = run_of(scene, options);
      check_alike(list, one, 1e-10);
      CHECK(list.half_cycles->impacts == one.half_cycles->impacts);
      CHECK(list.half_cycles->dampers.front().impacts == one.half_cycles->impacts);
      CHECK(list.impacts->wall == one.impacts->wall);
      CHECK(list.contacts->end.size() == one.contacts->end.size());
      CHECK(farthest(list.history->dampers[0].y, one.history->dampers[0].y) <= 1e-10);
      CHECK(farthest(list.history->dampers[0].w, one.history->dampers[0].w) <= 1e-8);
    }
    for (const auto& all : {ways, further_ways})
      for (const Cem& options : all) {
        CAPTURE(&options - all.data());
        Cem of_list = options;
        if (of_list.stuck_speed) *of_list.stuck_speed *= 2;
        const Run list = run_of_list(scene, of_list), one = run_of(scene, options);
        CHECK(std::get<Cem>(list.engine).time_step == std::get<Cem>(one.engine).time_step);
        CHECK(list.stop_reason == one.stop_reason);
        CHECK(list.end_time == one.end_time);
        CHECK(columns_of(list) == columns_of(one));
        CHECK(list.half_cycles->dampers.front().impacts == one.half_cycles->impacts);
        CHECK(list.impacts->damper == std::vector<std::int32_t>(one.impacts->time.size()));
      }
  }
}

TEST_CASE("a list of one damper between rigid walls is the scene with that damper") {
  double compared = 0, in_all = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    CAPTURE(seed);
    Scene list = random_rigid_list(seed);
    list.dampers.resize(1);
    // In units of another length: the scene's epsilon is the clearance.
    const SceneDamper& damper = list.dampers.front();
    const double c = damper.clearance;
    Scene one = list;
    one.damper().clearance = 1;
    one.x0 = list.x0 / c;
    one.v0 = list.v0 / c;
    one.damper().y0 = damper.y0 == c ? 1 : damper.y0 / c;
    one.damper().w0 = damper.w0 / c;
    one.force_amplitude = list.force_amplitude / c;
    const Run by_list = run_of(list, rigid), by_one = run_of(one, rigid);
    compared += agree_until(by_list, by_one, 1e-7, c);
    in_all += by_list.end_time;
    if (by_list.half_cycles->zero_crossing.size() > 1)
      CHECK(agree_until(by_list, by_one, 1e-7, c) >= by_list.half_cycles->zero_crossing.front());
  }
  CHECK(compared >= 0.7 * in_all);
}

TEST_CASE("budgets end a list of one where they end the scene with that damper") {
  Scene falls = single.front();
  falls.until_amplitude = 5.95;
  const auto check = [&](const Scene& scene, const Engine& engine) {
    check_alike(run_of_list(scene, engine), run_of(scene, engine),
                std::holds_alternative<Exact>(engine) ? 1e-10 : 1e-9);
  };
  for (const Budget& budget :
       {Budget{.max_impacts = 7}, Budget{.max_half_cycles = 3}, Budget{.max_time = 5}}) {
    check(single.front(), Exact{.budget = budget});
    for (const bool locate : {false, true}) check(single.front(), Cem{.locate = locate, .budget = budget});
  }
  for (const bool locate : {false, true}) check(single.front(), Cem{.locate = locate, .max_steps = 50'000});
  for (const Engine& engine : {Engine(Exact{}), Engine(Cem{})}) {
    check(falls, engine);
    CHECK(run_of(list_of_one(falls), engine).stop_reason == StopReason::amplitude);
  }
  // A joint contact spends steps, too.
  CHECK(run_of(four, Exact{.max_steps = 200}).stop_reason == StopReason::step_budget);
}

TEST_CASE("a clearance of a power of two is another unit of length, to the bit") {
  for (const double c : {0.25, 4.0})
    for (const Cem& options : ways) {
      Scene scene = single[1], wide = scene;
      SceneDamper& damper = wide.dampers.front();
      damper.clearance = c;
      damper.y0 *= c;
      wide.x0 *= c;
      wide.force_amplitude *= c;
      const Run run = run_of(scene, options), its = run_of(wide, options);
      CHECK(run.half_cycles->zero_crossing == its.half_cycles->zero_crossing);
      CHECK(run.contacts->end == its.contacts->end);
      REQUIRE(run.half_cycles->amplitude.size() > 3);
      for (std::size_t i = 0; i < run.half_cycles->amplitude.size(); ++i)
        CHECK(c * run.half_cycles->amplitude[i] == its.half_cycles->amplitude[i]);
      CHECK(c * c * run.energy->final.total() == its.energy->final.total());
    }
}

TEST_CASE("the parts of a damper, with their shares of its wall, are that damper") {
  std::size_t joined = 0;
  for (Scene scene : single) {
    CAPTURE(scene.damper().mass_ratio);
    scene.until_time = std::min(8.0, *scene.until_time);
    check_alike(run_of(in_parts(scene, {0.5, 0.3, 0.2}), Exact{}), run_of(scene, Exact{}), 1e-10);
    // Always in contact together: what is summed over the walls is the one wall's. (Shares by which the
    // stiffness divided by the mass stays the same to the bit: otherwise the parts leave a wall a rounding
    // apart, and with `locate` and the damper lagged each new start is an error of first order.)
    const Scene parts = in_parts(scene, {0.5, 0.25, 0.25});
    const auto check = [&](Cem options, double off) {
      const Run whole = run_of(scene, options);
      options.time_step = std::get<Cem>(whole.engine).time_step;
      check_alike(run_of(parts, options), whole, off);
      return joined_contacts(whole);
    };
    for (const Cem& options : ways)
      if (options.calibration != Calibration::two_body) check(options, 1e-8);  // it depends on each mass
    // Those that join the primary mass, or settle, do so together. The step at which one damper's walls are
    // pressed and the others' are is half the stability limit, the same for both. A list solves (M17.10) in
    // another order, and every impact makes more of the rounding.
    for (const Cem& options : further_ways) {
      CAPTURE(&options - further_ways.data());
      joined += check(options, 1e-7);
    }
  }
  CHECK(joined > 10);
}

TEST_CASE("halves of a damper that are released alike are that damper, and one of hardly any mass is none") {
  double compared = 0, in_all = 0;
  for (int seed = 0; seed < many(60); ++seed) {
    CAPTURE(seed);
    const Scene scene = random_rigid_list(std::uint64_t(seed));
    Scene halves = scene, more = scene;
    halves.dampers.front().mass_ratio /= 2;
    halves.dampers.push_back(halves.dampers.front());
    more.dampers.push_back({.mass_ratio = 1e-9, .restitution = 0.5, .clearance = 0.7});
    const Run whole = run_of(scene, rigid), split = run_of(halves, rigid), added = run_of(more, rigid);
    compared += agree_until(whole, split, 1e-6);
    in_all += whole.end_time;
    if (whole.half_cycles->zero_crossing.size() > 1)
      CHECK(agree_until(whole, split, 1e-6) >= whole.half_cycles->zero_crossing.front());
    for (std::size_t i = 0; i < std::min<std::size_t>(3, whole.half_cycles->amplitude.size()); ++i) {
      if (whole.half_cycles->zero_crossing[i] > 5) break;
      CHECK(added.half_cycles->amplitude[i] ==
            doctest::Approx(whole.half_cycles->amplitude[i]).epsilon(1e-5));
    }
  }
  CHECK(compared >= 0.9 * in_all);  // chaos parts a few
}

TEST_CASE("a damper of vanishing mass changes nothing of the others' motion") {
  Scene with = four;
  with.dampers.push_back(damper(1e-9, 0.5, 0.1, 1e-5, 0, 0));
  const Run one = run_of(four, Exact{}), other = run_of(with, Exact{});
  for (std::size_t i = 0; i < one.history->x.size(); ++i)
    CHECK(std::abs(one.history->x[i] - other.history->x[i]) < 1e-7);
  CHECK(other.half_cycles->dampers.back().impacts.front() > 0);
}

TEST_CASE("another order of the dampers changes no bit of what is recorded but their numbers") {
  // Of equal numbers but for the wall or the mass, and one that is there twice.
  Scene scene = four;
  scene.dampers.push_back(scene.dampers[1]);
  scene.dampers.back().wall_stiffness = 1100;
  scene.dampers.push_back(scene.dampers[2]);
  scene.dampers.push_back(scene.dampers[0]);
  scene.dampers.back().mass_ratio = 0.02;
  for (const Engine& engine :
       {Engine(Exact{}), Engine(Cem{}), Engine(Cem{.locate = true}), Engine(Cem{.large_step = 0.05}),
        Engine(Cem{.locate = true, .large_step = 0.05}), Engine(Cem{.stuck_speed = 0.3}),
        Engine(Cem{.locate = true, .large_step = 0.05, .stuck_speed = 0.3})})
    CHECK(check_order_is_free(scene, engine) > 10);
  std::size_t impacts = 0;
  for (int seed = 1; seed <= many(60); ++seed) {
    CAPTURE(seed);
    impacts += check_order_is_free(oracle::random_compliant_list(std::uint64_t(seed)), Exact{});
    impacts += check_order_is_free(oracle::round_compliant_list(std::uint64_t(seed)), Exact{});
  }
  CHECK(impacts > std::size_t(many(5'000)));
  impacts = 0;
  for (int seed = 0; seed < many(100); ++seed) {
    CAPTURE(seed);
    impacts += check_order_is_free(random_rigid_list(std::uint64_t(seed)), rigid);
  }
  CHECK(impacts > std::size_t(many(5'000)));
}

TEST_CASE(
    "what is recorded of several dampers changes no bit of their motion, and a shorter run is its "
    "beginning") {
  for (const Engine& engine :
       {Engine(Exact{}), Engine(Cem{}), Engine(Cem{.locate = true, .large_step = 0.05}),
        Engine(Cem{.stuck_speed = 0.5}),
        Engine(Cem{.locate = true, .large_step = 0.05, .stuck_speed = 0.5})}) {
    for (const Scene& scene : {four, two_shaken}) {
      const Run all = run_of(scene, engine), less = simulate(scene, engine, {.impacts = true});
      CHECK(all.impacts->time == less.impacts->time);
      CHECK(all.half_cycles->amplitude == less.half_cycles->amplitude);
      Scene shorter = scene;
      shorter.until_time = 5;
      const Run begun = simulate(shorter, engine, {.impacts = true});
      REQUIRE(begun.impacts->time.size() > 4);
      CHECK(std::equal(begun.impacts->time.begin(), begun.impacts->time.end(), all.impacts->time.begin()));
    }
  }
}

TEST_CASE("as the walls get stiff several dampers tend to rigid walls") {
  Scene scene = four;
  scene.until_time = 1.5;
  scene.dampers[1].restitution = 0.5;
  const Run limit = run_of(scene, Restitution{});
  const auto off = [&](const Engine& engine, double k) {
    for (SceneDamper& each : scene.dampers) each.wall_stiffness = k;
    return farthest(run_of(scene, engine).history->x, limit.history->x);
  };
  struct Case {
    Engine engine;
    double stiffness, most, tolerance;
  };
  for (const Case& each : {Case{Exact{.calibration = Calibration::two_body}, 1e8, 1e-5, 0.1},
                           Case{Cem{.locate = true, .large_step = 0.01, .calibration = Calibration::two_body},
                                1e6, 1e-4, 0.3}}) {
    CAPTURE(name_of(each.engine));
    const double soft = off(each.engine, each.stiffness), stiff = off(each.engine, 100 * each.stiffness);
    CHECK(stiff < each.most);
    CHECK(order(soft, stiff, 10) == doctest::Approx(1).epsilon(each.tolerance));  // as k^(-1/2)
  }
}

TEST_CASE("random lists run, keep their energy and are what they are looked at from the other side") {
  int together = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    reference::Random random(seed);
    const Scene scene = random_list(
        random, 0.1, [&] { return random.chance(0.2) ? 1 : random.log_uniform(1e-3, 1e3); },
        [&](double nu) { return random.chance(0.1) ? nu : random.log_uniform(10, 1e5); });
    const Run run = run_of(scene, Exact{});  // doctest_main.cpp holds it against itself
    CHECK(run.stop_reason == StopReason::time);
    CHECK(std::abs(run.energy->residual) < 1e-12);
    for (std::size_t i = 1; i < run.contacts->end.size(); ++i)
      together += run.contacts->begin[i] < run.contacts->end[i - 1];
    check_mirrored(scene, Exact{}, run);
  }
  CHECK(together > 500);
}

TEST_CASE(
    "random lists, in every way of the component element method, are what they are from the other side") {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    CAPTURE(seed);
    reference::Random random(seed);
    const Scene scene = random_list(
        random, 0.1, [&] { return random.chance(0.2) ? 1 : random.log_uniform(0.1, 10); },
        [&](double nu) { return nu * random.log_uniform(10, 1e4); });
    Cem options{.damper = random.chance(0.5) ? Damper::centred : Damper::lagged,
                .locate = random.chance(0.5),
                .calibration = random.chance(0.5) ? Calibration::fixed_wall : Calibration::two_body};
    options.time_step =
        std::min(0.01, stability_limit(scene, options.damper, options.calibration) / random.uniform(20, 60));
    if (random.chance(0.5)) options.large_step = 0.1;
    if (random.chance(0.3)) options.stuck_speed = random.log_uniform(0.01, 3);
    if (random.chance(0.2)) options.budget.max_impacts = std::int64_t(random.uniform(0, 20));
    if (random.chance(0.2)) options.budget.max_half_cycles = 2;

    const Run run = run_of(scene, options);  // doctest_main.cpp holds it against itself
    CHECK(std::abs(run.energy->residual) < 0.3);
    const Run less = simulate(scene, options, {.impacts = true});
    CHECK(less.impacts->time == run.impacts->time);
    CHECK(less.half_cycles->amplitude == run.half_cycles->amplitude);
    CHECK(less.end_time == run.end_time);
    check_mirrored(scene, options, run);
  }
}

TEST_CASE("several dampers move as their Taylor series says") {
  for (const Scene& scene : {four, two_shaken}) {
    const Run reference = reference_of(scene);
    check_eventful(reference);
    const Distance far = check_exact(run_of(scene, Exact{}), reference);
    CHECK(far.impacts < 1e-11);
    CHECK(far.losses < 1e-13);
  }
}

TEST_CASE("several that press their walls until these ring no more leave them when they should") {
  const Scene scene{.damping_ratio = 0.05,
                    .x0 = -1,
                    .until_time = 3.5,
                    .dampers = {damper(0.05, 0.3, 3, 5000, 0, 0), damper(0.02, 0.2, 4, 4000, 0, 0),
                                damper(0.3, 0.1, 5, 20000, 0, 0), damper(0.1, 0.4, 0.7, 900, 0.2, 0)}};
  Scene shaken = scene;
  shaken.force_amplitude = 0.7, shaken.force_frequency = 0.9;
  Scene fast = scene;
  fast.force_amplitude = 3, fast.force_frequency = 7;
  for (const Scene& each : {scene, shaken, fast}) {
    const Run run = run_of(each, Exact{});
    check_exact(run, reference_of(each));
    REQUIRE(run.contacts->end.size() > 3);
    CHECK(run.contacts->begin.front() == 0);
    CHECK(run.contacts->end.front() > 0.4);
  }
}

TEST_CASE("walls far faster than others that are pressed with them follow these, once they ring no more") {
  Scene scene{.damping_ratio = 0.05,
              .x0 = -1,
              .until_time = 0.05,
              .dampers = {damper(0.05, 0.6, 3, 200, 0, 0), damper(1e-6, 0.1, 4, 600, 0, 0),
                          damper(0.02, 0.5, 2, 70, 0, 0)}};
  Scene shaken = scene;
  shaken.force_amplitude = 3, shaken.force_frequency = 7;
  for (const Scene& each : {scene, shaken}) check_exact(run_of(each, Exact{}), reference_of(each));
  // The fast wall alone would take 2e6 pieces for each unit of time. It rings for some hundreds of them.
  scene.until_time = 20;
  scene.dampers = {damper(0.02, 0.3, 1, 1e4, 0, 0), damper(1e-9, 0.6, 1, 1e4, 0, 0)};
  const Run run = simulate(scene, Exact{.max_steps = 20'000}, {});
  CHECK(run.stop_reason == StopReason::time);
}

TEST_CASE("that several press their walls is told late under a force as early") {
  // The phase of the force rounds the more the later it is: without regard to that no slow mode takes over.
  const Scene scene{.damping_ratio = 0.05,
                    .force_amplitude = 0.3,
                    .force_frequency = 0.7,
                    .until_time = 20'000,
                    .dampers = {damper(0.05, 0.1, 0.3, 5000, 0, 0), damper(0.02, 0.1, 0.2, 2000, 0, 0)}};
  const Exact options{.budget = {.max_impacts = 1'000'000, .max_half_cycles = 1'000'000},
                      .max_steps = 3'000'000};
  CHECK(simulate(scene, options, {}).stop_reason == StopReason::time);
}

TEST_CASE("several at rest on walls that only the third derivative presses in stay there") {
  // x'' = -2 zeta v0 - x0 is zero but for rounding, and x''' > 0.
  for (const double stiffness : {1e3, 1e7, 1e12}) {
    Scene scene{.damping_ratio = 0.05, .x0 = 0.07, .v0 = -0.7, .until_time = 4};
    scene.dampers.assign(2, damper(0.05, 0.6, 1, stiffness, 0, 0));
    Scene one = scene;
    one.dampers = {damper(0.1, 0.6, 1, 2 * stiffness, 0, 0)};
    const Run run = run_of(scene, Exact{}), whole = run_of(one, Exact{});
    CAPTURE(stiffness);
    REQUIRE(run.contacts->end.size() >= 2);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(run.contacts->begin[i] == 0);
      CHECK(std::abs(run.contacts->end[i] - whole.contacts->end[0]) < 1e-9);
    }
    CHECK(run.contacts->end[0] > 0.5);
    CHECK(run.energy->contact_loss == doctest::Approx(whole.energy->contact_loss).epsilon(1e-6));
    REQUIRE(run.impacts->time.size() == 2 * whole.impacts->time.size());
  }
}

TEST_CASE("masses that meet their walls at the same instant, to the last bit, do so together") {
  // From rest at x0 on the left walls, masses of one clearance leave together and arrive together.
  for (std::size_t count = 2; count <= 10; ++count) {
    Scene scene{.x0 = 5, .until_time = 3};
    scene.dampers.clear();
    for (std::size_t i = 0; i < count; ++i)
      scene.dampers.push_back(
          damper(0.01 * (1 + double(i % 3)), 0.2 * double(1 + i % 4), 1, 1000.0 * double(1 + i % 5), 0, 0));
    const Run run = run_of(scene, Exact{});
    CAPTURE(count);
    REQUIRE(run.impacts->time.size() > 2 * count);
    for (std::size_t i = 1; i < count; ++i) {
      CHECK(run.impacts->time[i] == run.impacts->time[0]);
      CHECK(run.impacts->damper[i] == int(i));
    }
    CHECK(std::abs(run.energy->residual) < 1e-14);
    if (count <= 3) CHECK(distance(run, reference_of(scene)).x < 1e-12);
  }
}

TEST_CASE("a thousand dampers, their clearances over six decades") {
  Scene scene{.until_time = 2, .dampers = {}};
  for (int i = 0; i < 1000; ++i)
    scene.dampers.push_back(
        damper(2e-5, 0.2 + 0.0006 * i, std::pow(10, -3 + 0.006 * i), 20 + 0.02 * i, 0, 0));
  const Run run = simulate(scene, Exact{}, {.impacts = true, .energy = true});
  CHECK(run.stop_reason == StopReason::time);
  CHECK(std::abs(run.energy->residual) < 1e-12);
  CHECK(run.impacts->time.size() > 2000);
}

// --- Rigid walls ------------------------------------------------------------------------------------------

TEST_CASE(
    "several dampers keep the energy balance, each impact loses by Newton's law, nobody leaves a cavity") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    const Scene scene = random_rigid_list(seed);
    const Run run = run_of(scene, rigid);
    const EnergyBalance& energy = *run.energy;
    CHECK(std::abs(energy.residual) <= 1e-12);
    const auto [low, high] = std::minmax_element(energy.impact_loss.begin(), energy.impact_loss.end());
    if (low != energy.impact_loss.end()) CHECK(*low >= -1e-15 * energy.initial.total());
    double kinetic = 0, losses = 0, in_all = energy.bounce_down_loss;
    for (const DamperEnergy& damper : energy.dampers) {
      kinetic += damper.final_kinetic;
      losses += damper.impact_loss + damper.bounce_down_loss;
    }
    for (const double loss : energy.impact_loss) in_all += loss;
    CHECK(losses == doctest::Approx(in_all).epsilon(1e-12));
    CHECK(kinetic <= energy.final.kinetic * (1 + 1e-12));
    CHECK(run.impacts->damper.size() == run.impacts->time.size());
    std::size_t out_of_the_wall = 0;
    for (std::size_t i = 0; i < run.impacts->time.size(); ++i) {
      const double into = run.impacts->wall[i] == Wall::left ? -1 : 1;
      out_of_the_wall += !(into * run.impacts->relative_velocity[i] >= 0);
    }
    CHECK(out_of_the_wall == 0);
  }
}

TEST_CASE("masses that meet walls at one instant, by the law's own conditions") {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    CAPTURE(seed);
    reference::Random random(seed);
    std::vector<MassAtWall<double>> masses(1 + std::size_t(random.uniform(0, 6)));
    for (std::size_t i = 0; i < masses.size(); ++i) {
      const double speed = random.chance(0.3) ? 0 : -random.log_uniform(1e-6, 10);
      masses[i] = {i, random.log_uniform(1e-3, 1e3), random.chance(0.2) ? 0 : random.uniform(0, 1),
                   random.sign(), speed};
    }
    const std::vector<MassAtWall<double>> as_given = masses;
    const double jump = jump_of_velocity<double>(masses);
    double momentum = jump, size = std::abs(jump);
    for (const MassAtWall<double>& mass : as_given) {
      const double after = speed_after(mass, jump);
      const double impulse = mass.nu * (after - (mass.speed - mass.away * jump));
      CHECK(impulse >= 0);
      CHECK(after >= mass.e * -mass.speed);
      CHECK((impulse == 0 || after == mass.e * -mass.speed));
      momentum += mass.away * impulse;
      size += mass.nu * (after - mass.speed + std::abs(jump));
    }
    CHECK(std::abs(momentum) <= 1e-15 * size);
  }
}

TEST_CASE("ten dampers that rest on their left walls leave them and meet them together") {
  Scene scene{.x0 = 6, .until_time = 30};
  scene.dampers.assign(10, {.mass_ratio = 0.002, .restitution = 0.6, .clearance = 1});
  Scene one = scene;
  one.dampers = {{.mass_ratio = 0.02, .restitution = 0.6, .clearance = 1}};
  const Run by_ten = run_of(scene, rigid), by_one = run_of(one, rigid);
  REQUIRE(by_ten.impacts->time.size() % 10 == 0);
  REQUIRE(by_one.impacts->time.size() > 40);
  for (std::size_t i = 0; i < by_ten.impacts->time.size(); ++i) {
    CHECK(by_ten.impacts->damper[i] == int(i % 10));
    CHECK(by_ten.impacts->time[i] == by_ten.impacts->time[i - i % 10]);
  }
  // Ten times 0.002 is not 0.02 to the bit: so far the difference has not grown.
  for (std::size_t i = 0; i < 40; ++i)
    CHECK(by_ten.impacts->time[10 * i] == doctest::Approx(by_one.impacts->time[i]).epsilon(1e-9));
}

TEST_CASE("equal distances to the right walls of different cavities are met together") {
  Scene scene{.x0 = 6, .until_time = 1};
  // At rest at a distance of 0.25 from their right walls, towards which the cavities' x'' < 0 leads them.
  scene.dampers = {{.mass_ratio = 0.01, .clearance = 1, .y0 = 0.75},
                   {.mass_ratio = 0.01, .clearance = 1.5, .y0 = 1.25},
                   {.mass_ratio = 0.01, .clearance = 10, .y0 = 9.75}};
  const Run run = run_of(scene, rigid);
  REQUIRE(run.impacts->time.size() >= 3);
  CHECK(run.impacts->time[0] == run.impacts->time[2]);
  CHECK(run.impacts->damper[2] == 2);
}

TEST_CASE("a mass that hardly arrives is at one instant with another that rounding cannot tell it from") {
  // x = -cos t; the first mass meets its right wall at 1.53 with a thousandth of its speed, the second its
  // left one a little earlier.
  const double time = std::asin(0.999);
  for (const double earlier : {1e-12, 1e-10}) {
    const double t = time - earlier;
    Scene scene{.x0 = -1, .until_time = 2};
    scene.dampers = {{.mass_ratio = 0.02, .clearance = 0.5 + time - (1 - std::cos(time)), .y0 = 0.5, .w0 = 1},
                     {.mass_ratio = 0.02, .clearance = 10, .y0 = 3 * t + (1 - std::cos(t)), .w0 = -3}};
    const Run run = run_of(scene, rigid);
    REQUIRE(run.impacts->time.size() >= 2);
    CHECK((run.impacts->time[0] == run.impacts->time[1]) == (earlier == 1e-12));
  }
}

TEST_CASE("slow masses released onto their walls meet them together, plastic ones as well") {
  // Each alone would have ended its chattering at once.
  Scene scene{.x0 = -0.5, .until_time = 0.01};
  scene.dampers = {{.mass_ratio = 1e-4, .restitution = 0, .clearance = 1, .w0 = -2e-7},
                   {.mass_ratio = 6e-4, .restitution = 0.1, .clearance = 1, .w0 = -8e-5},
                   {.mass_ratio = 0.02, .restitution = 0.4, .clearance = 1, .w0 = -5e-7}};
  const Run run = run_of(scene, rigid);
  REQUIRE(run.impacts->time.size() >= 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(run.impacts->damper[i] == int(i));
    CHECK(run.impacts->time[i] == 0);
    CHECK(run.impacts->relative_velocity[i] == scene.dampers[i].w0);
  }
}

TEST_CASE("sticking masses count to the primary mass, and leave together") {
  // Plastic dampers: both come to rest on the same wall, and are let go when x'' changes its sign.
  Scene scene{.x0 = 1, .until_time = 20};
  scene.dampers = {{.mass_ratio = 0.3, .restitution = 0, .clearance = 0.5},
                   {.mass_ratio = 0.2, .restitution = 0, .clearance = 0.8}};
  const Run run = run_of(scene, rigid);
  const Contacts& contacts = *run.contacts;
  int together = 0;
  for (std::size_t i = 0; i + 1 < contacts.end.size(); ++i) {
    if (contacts.end[i] != contacts.end[i + 1] || contacts.end[i] >= 20) continue;
    ++together;
    CHECK(contacts.wall[i] == contacts.wall[i + 1]);
    CHECK(contacts.damper[i] != contacts.damper[i + 1]);
  }
  CHECK(together >= 2);
  // While both stick the frequency is 1/sqrt(1 + 0.5): from the release of the first scene's equal on.
  CHECK(std::abs(run.energy->residual) < 1e-14);
}

TEST_CASE("of masses that bounce together none is left behind to bounce for ever") {
  // At t = 3.38 eight of these chatter on one wall, of which six and seven, but not eight, can join at once.
  Scene scene{.x0 = 1, .until_time = 3.4};
  const double numbers[][3] = {{0.0009760000000000001, 0.5519604290848342, 1.1760412681610501},
                               {0.0017000000000000001, 0.6725785929029169, 0.8670030363656981},
                               {0.00049, 0.6781366644382792, 0.668568339180735},
                               {0.000738, 0.5631642179114158, 0.5629047848367928},
                               {0.000844, 0.647865797906189, 0.42024820709722255},
                               {0.0008260000000000001, 0.5772667436655944, 0.3463625126693932},
                               {0.000722, 0.696065655425152, 0.2668982413599258},
                               {0.000802, 0.6503643520317268, 0.21480530489251362},
                               {0.00118, 0.5007035783279944, 0.16526297672595447},
                               {0.0007620000000000001, 0.6450170331025704, 0.13654707643129765},
                               {0.0008780000000000001, 0.6691248275219867, 0.1046596739041376},
                               {0.0007720000000000001, 0.6068733148788801, 0.08283581679942986},
                               {0.000928, 0.556553327264536, 0.06188953455494517},
                               {0.001196, 0.5578582117461958, 0.04586664808907617},
                               {0.0005920000000000001, 0.5770862414949032, 0.03798021654428534},
                               {0.001018, 0.5407613934192218, 0.03243154497875873},
                               {0.000786, 0.500600734182527, 0.023701987310484878},
                               {0.00117, 0.6721063148696672, 0.018828340261876866},
                               {0.00362, 0.6195497627328963, 0.014725460798971968}};
  scene.dampers.clear();
  for (const auto& [mass_ratio, restitution, clearance] : numbers)
    scene.dampers.push_back({.mass_ratio = mass_ratio, .restitution = restitution, .clearance = clearance});
  const Run run = simulate(scene, Restitution{}, Record{});
  CHECK(run.stop_reason == StopReason::time);
}

TEST_CASE(
    "a mass that chatters beside those that stick comes to rest under the acceleration of all of them") {
  // The wall meets it at 0. From then on it bounces on 1 + 10, and each bounce kicks the other off for a time
  // that is short; with a constant force this is a geometric sum, and x'' hardly changes.
  const double nu = 1e-6, e = 0.6, other = 10, w = 1e-4, x0 = 6;
  Scene scene{.x0 = x0, .until_time = 0.01};
  scene.dampers = {{.mass_ratio = nu, .restitution = e, .y0 = 1, .w0 = w},
                   {.mass_ratio = other, .restitution = 0, .y0 = 1}};
  const double kept = e - (1 + e) * nu / (1 + nu) * other / (1 + other), acceleration = x0 / (1 + other);
  const double rest = 2 * kept * w / (acceleration * (1 - kept));
  for (const double tolerance : {1e-8, 1e-11}) {
    const Run run = simulate(scene, Restitution{.accumulation_tolerance = tolerance}, {.contacts = true});
    const auto chattered = std::ranges::find(run.contacts->damper, 0) - run.contacts->damper.begin();
    REQUIRE(std::ranges::count(run.contacts->damper, 0) == 1);
    CHECK(std::abs(run.contacts->begin[std::size_t(chattered)] - rest) < 1e-10);
  }
}

TEST_CASE("half cycles of many dampers take no more memory than those of one may") {
  Scene scene{.until_time = 1};
  scene.dampers.assign(1000, {.mass_ratio = 1e-5});
  const auto allowed = [&](const Record& record) {
    return std::get<Restitution>(simulate(scene, Restitution{}, record).engine).budget.max_half_cycles;
  };
  CHECK(allowed({}) == most_rows / 1000);
  CHECK(allowed({.half_cycles = false, .impacts = true}) == Budget{}.max_half_cycles);
  scene.dampers.resize(10);
  CHECK(allowed({}) == Budget{}.max_half_cycles);
}

TEST_CASE("what is not allowed of a list is said by its field") {
  Scene scene{.until_time = 1};
  scene.dampers = {{}, {.clearance = 2, .y0 = 3}};
  CHECK(problem_of(scene, Restitution{}).starts_with("dampers[1].y0: "));
  scene.dampers[1].y0 = 2;
  CHECK(problem_of(scene, Restitution{}).empty());
  scene.dampers[1].y0 = 3;
  CHECK(problem_of(scene, Exact{}).empty());  // whose walls give way
  CHECK(problem_of(scene, Cem{}).empty());
  scene.dampers[0].clearance = 0;
  CHECK(problem_of(scene, Restitution{}).starts_with("dampers[0].clearance: "));
  scene.dampers.assign(1001, {});
  CHECK(problem_of(scene, Restitution{}).starts_with("dampers: "));
  CHECK(problem_of(four, Cem{}).empty());
  CHECK(problem_of(four, Cem{.stuck_speed = 0.01}).empty());
  CHECK(problem_of(four, Cem{.time_step = 1}).starts_with("time_step: must be <= 0.0"));
  CHECK(problem_of(four, Cem{.large_step = 2}).starts_with("large_step: must be > "));
}

// --- The component element method -------------------------------------------------------------------------

TEST_CASE("with located events several dampers converge to their Taylor series with second order") {
  for (const Scene& scene : {four, two_shaken}) {
    const Run reference = reference_of(scene);
    check_eventful(reference);
    const Distance coarse = mean_distance(scene, reference, {.locate = true}, 4e-4, 4),
                   fine = mean_distance(scene, reference, {.locate = true}, 1e-4, 4);
    for (const auto member : {&Distance::x, &Distance::y, &Distance::impacts, &Distance::losses})
      CHECK(order(coarse.*member, fine.*member, 4) == doctest::Approx(2).epsilon(0.1));
    CHECK(fine.x < 1e-5);
    CHECK(fine.viscous < 2e-6);
  }
}

TEST_CASE("unlocated, or with the damper lagged, several dampers converge with first order") {
  for (Scene scene : {four, two_shaken}) {
    scene.until_time = 3;  // before the errors of first order decide who meets which wall next
    const Run reference = reference_of(scene);
    for (const Cem& options :
         {Cem{}, Cem{.damper = Damper::lagged}, Cem{.damper = Damper::lagged, .locate = true}}) {
      const Distance coarse = mean_distance(scene, reference, options, 4e-4, 12),
                     fine = mean_distance(scene, reference, options, 5e-5, 12);
      for (const auto member : {&Distance::x, &Distance::y, &Distance::losses})
        CHECK(order(coarse.*member, fine.*member, 8) == doctest::Approx(1).epsilon(0.25));
    }
  }
}

TEST_CASE("the energy balance of several dampers closes with second order") {
  for (const Scene& scene : {four, two_shaken}) {
    const auto residual = [&](double h, bool locate) {
      double mean = 0;
      for (int i = 0; i < 8; ++i)
        mean +=
            std::abs(run_of(scene, Cem{.time_step = h * (1 + i / 16.0), .locate = locate}).energy->residual) /
            8;
      return mean;
    };
    CHECK(order(residual(4e-4, true), residual(1e-4, true), 4) > 1.7);
    CHECK(residual(1e-4, true) < 1e-5);
    CHECK(residual(1e-4, false) < 1e-4);
  }
}

TEST_CASE("two rates lose nothing of the accuracy of small steps, and spare most of them") {
  for (Scene scene : {four, two_shaken}) {
    scene.until_time = 3;
    const Run reference = reference_of(scene);
    for (const bool locate : {false, true}) {
      Cem options{.locate = locate};
      const Distance small = mean_distance(scene, reference, options, 1e-4, 8);
      options.large_step = 0.01;
      const Distance mixed = mean_distance(scene, reference, options, 1e-4, 8);
      CHECK(mixed.x < 1.2 * small.x + 5e-5);
      CHECK(mixed.y < 1.2 * small.y + 1e-4);
      CHECK(mixed.impacts < 1.2 * small.impacts + 2e-4);
      CHECK(mixed.losses < 1.2 * small.losses + 5e-5);
      CHECK(mixed.residual < 1.2 * small.residual + 2e-5);
    }
    // The large steps' own error is of second order.
    const Distance coarse = mean_distance(scene, reference, {.locate = true, .large_step = 0.04}, 2e-5, 1),
                   fine = mean_distance(scene, reference, {.locate = true, .large_step = 0.01}, 2e-5, 1);
    CHECK(order(coarse.x, fine.x, 4) > 1.5);
  }
  // A flight in large steps: x and x' of the samples are on the circle, and both secondary masses stay where
  // they are.
  Scene flight{
      .x0 = 3, .until_time = 10, .dampers = {{.clearance = 50, .y0 = 20}, {.clearance = 90, .y0 = 50}}};
  const Run far = run_of(flight, Cem{.large_step = 0.1, .max_steps = 200});
  REQUIRE(far.end_time == 10);
  for (std::size_t i = 0; i < far.history->x.size(); ++i) {
    const double x = far.history->x[i], v = far.history->v[i];
    CHECK(std::abs(x * x + v * v - 9) < 1e-5);
    CHECK(std::abs(x + far.history->dampers[1].y[i] - 53) < 1e-12);
    CHECK(std::abs(v + far.history->dampers[1].w[i]) < 1e-12);
  }
  // Stiff walls, so that contacts are short.
  Scene stiff = four;
  for (SceneDamper& damper : stiff.dampers) damper.wall_stiffness *= 1e6, damper.restitution = 0.9;
  stiff.until_time = 1;
  const Run run = run_of(stiff, Cem{.large_step = 0.02, .max_steps = 300'000});
  CHECK(run.stop_reason == StopReason::time);
  CHECK(*stiff.until_time / *std::get<Cem>(run.engine).time_step > 1'500'000);
}

TEST_CASE("the stability limit of a list is that of all masses in contact") {
  Scene one = single[1];
  for (const Damper damper : {Damper::centred, Damper::lagged}) {
    const double limit = stability_limit(one, damper, {});
    Scene list = list_of_one(one);
    CHECK(stability_limit(list, damper, {}) == doctest::Approx(limit).epsilon(1e-12));
    list.dampers.assign(2, list.dampers.front());
    for (SceneDamper& half : list.dampers) half.mass_ratio /= 2, half.wall_stiffness /= 2;
    CHECK(stability_limit(list, damper, {}) == doctest::Approx(limit).epsilon(1e-12));
  }
  // The square of the highest frequency is a root of the secular equation of all masses and springs.
  const double square = std::pow(fastest_contact_frequency(four), 2);
  double sum = 1 / square - 1;
  for (const SceneDamper& damper : four.dampers)
    sum += damper.wall_stiffness / (square - damper.wall_stiffness / damper.mass_ratio);
  CHECK(std::abs(sum) < 1e-10);
  // The longest list of the heaviest masses runs with the default step.
  Scene many{.until_time = 1e-3};
  many.dampers.assign(1000, {.mass_ratio = 1e6, .wall_stiffness = 1e4});
  CHECK(run_of(many, Cem{}).stop_reason == StopReason::time);
}

TEST_CASE("two masses stick and part as one with the primary mass, to their closed form, second order") {
  // The first mass is pressed to the left wall from the beginning: x = -cos(t/r), r^2 = 1 + nu. The second
  // goes straight on, from -0.9 with the speed -0.3, and joins both; all part where x is zero.
  // A third one, of no weight, flies on with the speed 0.4.
  const double nu_1 = 0.3, nu_2 = 0.2, both = 1 + nu_1, all = both + nu_2;
  const Scene scene{
      .x0 = -1,
      .until_time = 3,
      .dampers = {{.mass_ratio = nu_1},
                  {.mass_ratio = nu_2, .clearance = 2, .y0 = 0.1, .w0 = -0.3},
                  {.mass_ratio = 1e-9, .clearance = 50, .wall_stiffness = 1e-4, .y0 = 20, .w0 = 0.4}}};
  const double r = std::sqrt(both), root = std::sqrt(all);
  const auto gap = [&](double t) { return -0.9 - 0.3 * t + std::cos(t / r); };
  double before = 0, after = 1;
  while (after - before > 1e-15) {
    const double middle = (before + after) / 2;
    (gap(middle) > 0 ? before : after) = middle;
  }
  const double touch = before, x = -std::cos(touch / r), v = std::sin(touch / r) / r, w = -0.3 - v;
  const double joined = v + nu_2 * w / all, end = touch + root * std::atan2(-x / root, joined);
  const double loss = both * nu_2 / all * w * w / 2;
  const double v_then = joined * std::cos(0.1 / root) - x / root * std::sin(0.1 / root);
  const Record record{
      .impacts = true, .contacts = true, .energy = true, .history = {{touch + 0.1, touch + 0.2, 2}}};
  for (const Cem& way : {Cem{}, Cem{.locate = true}, Cem{.large_step = 2e-2}}) {
    std::array<double, 3> time{}, speed{};
    for (int i = 0; i < 3; ++i) {
      Cem options = way;
      options.stuck_speed = 0.6;
      options.time_step = 1e-3 / (1 << i);
      if (way.large_step) options.large_step = *way.large_step / (1 << i);
      const Run run = simulate(scene, options, record);
      REQUIRE(run.impacts->time.size() == 1);
      CHECK(run.impacts->damper[0] == 1);
      CHECK(run.impacts->relative_velocity[0] == doctest::Approx(w).epsilon(2e-5));
      REQUIRE(run.contacts->end.size() >= 2);
      CHECK(run.contacts->begin[0] == 0);
      CHECK(run.contacts->end[0] == run.contacts->end[1]);
      CHECK(run.energy->impact_loss.at(0) == doctest::Approx(loss).epsilon(4e-5));
      CHECK(run.energy->dampers[1].impact_loss == run.energy->impact_loss.at(0));
      CHECK(run.energy->contact_loss == 0);
      time[i] = std::abs(run.contacts->end[0] - end);
      speed[i] = std::abs(run.history->v[0] - v_then);
      CHECK(run.history->dampers[0].w[0] == 0);
      CHECK(run.history->dampers[1].w[0] == 0);
      CHECK(std::abs(run.history->dampers[2].w[0] + run.history->v[0] - 0.4) < 1e-6);
    }
    const double h = way.large_step.value_or(1e-3);
    CHECK(time[0] < h * h);
    CHECK(speed[0] < h * h);
    CHECK(time[2] < time[0] / 8);
    CHECK(speed[2] < speed[0] / 8);
  }
}

TEST_CASE("masses that join at one instant lose what they would one after the other, each its own share") {
  // Momentum makes the velocity of all; each wall loses half the momentum that it passes on times the speed
  // at which it is met. Both meet the left wall at once.
  const double nu_1 = 0.3, nu_2 = 0.1, all = 1 + nu_1 + nu_2, w_1 = -0.2, w_2 = -0.1;
  const Scene scene{.x0 = -1,
                    .until_time = 0.05,
                    .dampers = {{.mass_ratio = nu_1, .y0 = 0, .w0 = w_1}, {.mass_ratio = nu_2, .w0 = w_2}}};
  const Run run = run_of(scene, Cem{.time_step = 1e-4, .stuck_speed = 0.5});
  const double v = (nu_1 * w_1 + nu_2 * w_2) / all;
  REQUIRE(run.impacts->time == std::vector<double>{0, 0});
  CHECK(run.energy->dampers[0].impact_loss == doctest::Approx(nu_1 * w_1 * (w_1 - v) / 2).epsilon(1e-3));
  CHECK(run.energy->dampers[1].impact_loss == doctest::Approx(nu_2 * w_2 * (w_2 - v) / 2).epsilon(1e-3));
  CHECK(std::abs(run.energy->residual) < 1e-7);
}

TEST_CASE("where an impact that joins the masses turns the primary mass back, its peak is there") {
  // x rises with x'' > 0, under a force, when a heavy mass meets the left wall.
  const Scene scene{
      .x0 = 0.1,
      .v0 = 0.1,
      .force_amplitude = 1,
      .until_time = 3,
      .dampers = {{.mass_ratio = 2, .y0 = 0.9, .w0 = -1.2}, {.mass_ratio = 1e-3, .clearance = 9, .y0 = 5}}};
  const Run run = run_of(scene, Cem{.stuck_speed = 5});
  REQUIRE(run.impacts->time.size() > 0);
  REQUIRE(run.half_cycles->amplitude.size() > 0);
  CHECK(run.half_cycles->peak_time[0] == run.impacts->time[0]);
  CHECK(run.half_cycles->amplitude[0] == run.impacts->displacement[0]);
}

TEST_CASE("a fast impact on the other wall throws off what is stuck, as between compliant walls alone") {
  // The first mass is stuck to the left wall; the second, heavy, meets its right one at 3.
  Scene scene{.x0 = -1,
              .until_time = 0.6,
              .dampers = {{.mass_ratio = 0.1, .restitution = 0.5, .clearance = 4},
                          {.mass_ratio = 0.5, .restitution = 0.5, .y0 = 0.5, .w0 = 3}}};
  const auto run_with = [&](const Engine& engine) { return run_of(scene, engine); };
  const auto highest = [](const Run& run) { return std::ranges::max(run.history->dampers[0].y); };
  const Run thrown = run_with(Cem{.locate = true, .stuck_speed = 0.01}), exact = run_with(Exact{});
  CHECK(highest(exact) > 0.05);
  // It was not pressed in, by x''/omega_m^2 = 1e-5, which a speed of 2 makes of the overlap of its rebound.
  CHECK(farthest(thrown.history->dampers[0].y, exact.history->dampers[0].y) < 1e-3);
  // Where impacts of that speed join the masses it stays.
  CHECK(highest(run_with(Cem{.locate = true, .stuck_speed = 10})) < 5e-3);
}

TEST_CASE("two rates take long steps while all that are in contact are pressed, to the same motion") {
  // Both are pressed to their left walls until x is zero, at 1.8. Small steps alone would be 11000; they lead
  // through a tenth of it, until the ringing has decayed to (omega_m h)^2 of what is pressed in.
  Scene scene{.x0 = -6,
              .until_time = 1.5,
              .dampers = {{.mass_ratio = 0.2, .restitution = 0.3},
                          {.mass_ratio = 0.1, .restitution = 0.2, .clearance = 3, .wall_stiffness = 3000}}};
  const Run small = run_of(scene, Cem{.locate = true}),
            mixed = run_of(scene, Cem{.locate = true, .large_step = 0.05, .max_steps = 2500});
  CHECK(mixed.stop_reason == StopReason::time);
  CHECK(mixed.contacts->end.size() == 2);
  // Long steps are of half the stability limit at most; an error of theirs in x is h^2/24 of x times the
  // phase.
  const double h = stability_limit(scene, Damper::centred, {}) / 2, error = h * h / 24 * 6 * 1.5;
  CHECK(farthest(small.history->x, mixed.history->x) < 2 * error);
  CHECK(farthest(small.history->v, mixed.history->v) < 2 * error);
  CHECK(std::abs(small.energy->contact_loss - mixed.energy->contact_loss) < 6 * error);
  // One rings far longer than the other, and is too light to keep that from settling: long steps begin when
  // it has settled, too. Its overlap is 6e-5.
  const SceneDamper first = scene.dampers[0];
  scene.dampers[0] = {.mass_ratio = 1e-3, .restitution = 0.95, .wall_stiffness = 100};
  CHECK(farthest(run_of(scene, Cem{.locate = true}).history->dampers[0].y,
                 run_of(scene, Cem{.locate = true, .large_step = 0.05}).history->dampers[0].y) < 1e-6);
  // A third one flies, and meets walls meanwhile. Not located, a touch in a long step would come late by that
  // much, 4e-3, in which the mass would go three times as deep into its wall as it does.
  scene.dampers[0] = first;
  scene.dampers.push_back({.mass_ratio = 0.01, .restitution = 0.9, .clearance = 2, .y0 = 1, .w0 = 0.3});
  const Run flies = run_of(scene, Cem{}), its = run_of(scene, Cem{.large_step = 0.05, .max_steps = 15'000});
  REQUIRE(flies.impacts->time.size() > 2);
  CHECK(farthest(flies.impacts->time, its.impacts->time) < 1e-3);
  CHECK(farthest(flies.history->x, its.history->x) < 1e-4);
}
