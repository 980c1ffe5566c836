// Several dampers by the component element method: against the engine of one damper, the restitution engine,
// and the oracle (oracle/oracle.hpp).
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "compliant_dampers.hpp"
#include "impact_damper/engines/cem_scheme.hpp"
#include "reference.hpp"

using namespace impact_damper;
using namespace compliant_dampers;

namespace {

double order(double coarse, double fine, double ratio = 2) {
  return std::log(coarse / fine) / std::log(ratio);
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

const std::vector<Cem> ways{{},
                            {.locate = true},
                            {.damper = Damper::lagged},
                            {.damper = Damper::lagged, .locate = true},
                            {.calibration = Calibration::two_body}};
// With the stuck regime, with two rates, and with both.
const std::vector<Cem> further_ways{{.stuck_speed = 0.3},
                                    {.locate = true, .stuck_speed = 0.1},
                                    {.large_step = 0.05},
                                    {.damper = Damper::lagged, .large_step = 0.02},
                                    {.locate = true, .large_step = 0.02, .stuck_speed = 0.3}};
constexpr double always = 1e6;  // faster than any impact here

std::size_t joined_contacts(const Run& run) {  // those that last for longer than a rebound
  std::size_t count = 0;
  for (std::size_t i = 0; i < run.contacts->end.size(); ++i)
    count += run.contacts->end[i] - run.contacts->begin[i] > 0.2;
  return count;
}
double farthest(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double far = 0;
  for (std::size_t i = 0; i < a.size(); ++i) far = std::max(far, std::abs(a[i] - b[i]));
  return far;
}

}  // namespace

TEST_CASE("a list of one damper is the scene with that damper, to the bit") {
  for (const Scene& scene : single) {
    for (const auto& all : {ways, further_ways}) {
      for (const Cem& options : all) {
        CAPTURE(&scene - single.data());
        CAPTURE(&options - all.data());
        Cem of_list = options;
        if (of_list.stuck_speed) *of_list.stuck_speed *= 2;
        const Run list = run_of_list(scene, of_list), one = run_of(scene, options);
        CHECK(std::get<Cem>(list.engine).time_step == std::get<Cem>(one.engine).time_step);
        CHECK(list.stop_reason == one.stop_reason);
        CHECK(list.end_time == one.end_time);
        CHECK(list.half_cycles->zero_crossing == one.half_cycles->zero_crossing);
        CHECK(list.half_cycles->peak_time == one.half_cycles->peak_time);
        CHECK(list.half_cycles->amplitude == one.half_cycles->amplitude);
        CHECK(list.half_cycles->impacts == one.half_cycles->impacts);
        CHECK(list.half_cycles->dampers.front().impacts == one.half_cycles->impacts);
        CHECK(list.impacts->time == one.impacts->time);
        CHECK(list.impacts->wall == one.impacts->wall);
        CHECK(list.impacts->relative_velocity == one.impacts->relative_velocity);
        CHECK(list.impacts->damper == std::vector<std::int32_t>(one.impacts->time.size()));
        CHECK(list.contacts->begin == one.contacts->begin);
        CHECK(list.contacts->end == one.contacts->end);
        CHECK(list.history->x == one.history->x);
        CHECK(list.history->v == one.history->v);
        CHECK(list.history->dampers[0].y == one.history->dampers[0].y);
        CHECK(list.history->dampers[0].w == one.history->dampers[0].w);
        CHECK(list.energy->final.total() == one.energy->final.total());
        CHECK(list.energy->final.paper == one.energy->final.paper);
        CHECK(list.energy->impact_loss == one.energy->impact_loss);
        CHECK(list.energy->contact_loss == one.energy->contact_loss);
        CHECK(list.energy->viscous_work == one.energy->viscous_work);
        CHECK(list.energy->forcing_work == one.energy->forcing_work);
        CHECK(list.energy->residual == one.energy->residual);
      }
    }
  }
}

TEST_CASE("budgets end a list of one where they end the scene with that damper") {
  const Scene& scene = single.front();
  for (Cem options : {Cem{.budget = {.max_impacts = 7}}, Cem{.budget = {.max_half_cycles = 3}},
                      Cem{.budget = {.max_time = 5}}, Cem{.max_steps = 50'000}}) {
    for (const bool locate : {false, true}) {
      options.locate = locate;
      check_alike(run_of_list(scene, options), run_of(scene, options), 1e-9);
    }
  }
  Scene falls = scene;
  falls.until_amplitude = 5.95;
  check_alike(run_of_list(falls, Cem{}), run_of(falls, Cem{}), 1e-9);
  CHECK(run_of(list_of_one(falls), Cem{}).stop_reason == StopReason::amplitude);
}

TEST_CASE("a clearance of a power of two is another unit of length, to the bit") {
  for (const double c : {0.25, 4.0}) {
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
}

TEST_CASE("the parts of a damper, with their shares of its wall, are that damper") {
  // Always in contact together: what is summed over the walls is the one wall's. (Shares by which the
  // stiffness divided by the mass stays the same to the bit: otherwise the parts leave a wall a rounding
  // apart, and with `locate` and the damper lagged each new start is an error of first order.)
  constexpr std::array shares{0.5, 0.25, 0.25};
  for (Scene scene : single) {
    scene.until_time = std::min(8.0, *scene.until_time);
    for (Cem options : ways) {
      if (options.calibration == Calibration::two_body) continue;  // it depends on each mass
      const Run whole = run_of(scene, options);
      options.time_step = std::get<Cem>(whole.engine).time_step;
      Scene parts = scene;
      parts.dampers.assign(shares.size(), parts.dampers.front());
      for (std::size_t i = 0; i < shares.size(); ++i) {
        parts.dampers[i].mass_ratio *= shares[i];
        parts.dampers[i].wall_stiffness *= shares[i];
      }
      check_alike(run_of(parts, options), whole, 1e-8);
    }
  }
}

TEST_CASE("renumbering the dampers changes no bit but the numbers") {
  Scene scene = four;
  // Of equal numbers but for the wall, and one that is there twice.
  scene.dampers.push_back(scene.dampers[1]);
  scene.dampers.back().wall_stiffness = 1100;
  scene.dampers.push_back(scene.dampers[2]);
  scene.dampers.push_back(scene.dampers[0]);
  scene.dampers.back().mass_ratio = 0.02;
  const std::size_t count = scene.dampers.size();
  Scene turned = scene;
  std::rotate(turned.dampers.begin(), turned.dampers.begin() + 2, turned.dampers.end());
  for (const Cem& options :
       {Cem{}, Cem{.locate = true}, Cem{.large_step = 0.05}, Cem{.locate = true, .large_step = 0.05},
        Cem{.stuck_speed = 0.3}, Cem{.locate = true, .large_step = 0.05, .stuck_speed = 0.3}}) {
    const Run one = run_of(scene, options), other = run_of(turned, options);
    CHECK(one.half_cycles->zero_crossing == other.half_cycles->zero_crossing);
    CHECK(one.half_cycles->amplitude == other.half_cycles->amplitude);
    CHECK(one.impacts->time == other.impacts->time);
    CHECK(one.history->x == other.history->x);
    CHECK(one.energy->final.total() == other.energy->final.total());
    CHECK(one.energy->residual == other.energy->residual);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = (i + count - 2) % count;
      CHECK(one.history->dampers[i].y == other.history->dampers[j].y);
      CHECK(one.energy->dampers[i].impact_loss == other.energy->dampers[j].impact_loss);
      CHECK(one.energy->dampers[i].final_kinetic == other.energy->dampers[j].final_kinetic);
      CHECK(one.half_cycles->dampers[i].impacts == other.half_cycles->dampers[j].impacts);
    }
  }
}

TEST_CASE("with located events several dampers converge to their Taylor series with second order") {
  for (const Scene& scene : {four, two_shaken}) {
    const Run reference = reference_of(scene);
    CHECK(most_in_contact(*reference.contacts) == std::min(3, int(scene.dampers.size())));
    REQUIRE(reference.impacts->time.size() > 10);
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

TEST_CASE("as the walls get stiff several dampers tend to rigid walls") {
  Scene scene = four;
  scene.until_time = 1.5;
  scene.dampers[1].restitution = 0.5;
  const Run rigid = simulate(scene, Restitution{}, everything(scene));
  const auto off = [&](double k) {
    for (SceneDamper& damper : scene.dampers) damper.wall_stiffness = k;
    const Run run =
        run_of(scene, Cem{.locate = true, .large_step = 0.01, .calibration = Calibration::two_body});
    double largest = 0;
    for (std::size_t i = 0; i < rigid.history->x.size(); ++i)
      largest = std::max(largest, std::abs(run.history->x[i] - rigid.history->x[i]));
    return largest;
  };
  const double soft = off(1e6), stiff = off(1e8);
  CHECK(stiff < 1e-4);
  CHECK(order(soft, stiff, 10) == doctest::Approx(1).epsilon(0.3));
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
  Scene many;
  many.until_time = 1e-3;
  many.dampers.assign(1000, {.mass_ratio = 1e6, .wall_stiffness = 1e4});
  CHECK(run_of(many, Cem{}).stop_reason == StopReason::time);
}

TEST_CASE(
    "what is recorded of several dampers changes nothing of their motion, and a shorter run is its "
    "beginning") {
  for (const Cem& options : {Cem{}, Cem{.locate = true, .large_step = 0.05}, Cem{.stuck_speed = 0.5},
                             Cem{.locate = true, .large_step = 0.05, .stuck_speed = 0.5}}) {
    const Run all = run_of(two_shaken, options);
    const Run less = simulate(two_shaken, options, {.impacts = true});
    CHECK(all.impacts->time == less.impacts->time);
    CHECK(all.half_cycles->amplitude == less.half_cycles->amplitude);
    Scene shorter = two_shaken;
    shorter.until_time = 5;
    const Run begun = simulate(shorter, options, {.impacts = true});
    REQUIRE(begun.impacts->time.size() > 4);
    CHECK(std::equal(begun.impacts->time.begin(), begun.impacts->time.end(), all.impacts->time.begin()));
  }
}

TEST_CASE(
    "random lists, in every way, run, agree with themselves and are what they are looked at from the other "
    "side") {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    CAPTURE(seed);
    reference::Random random(seed);
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
      SceneDamper damper;
      damper.mass_ratio = random.log_uniform(1e-3, random.chance(0.2) ? 10 : 0.5);
      damper.restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 1);
      damper.clearance = random.chance(0.2) ? 1 : random.log_uniform(0.1, 10);
      damper.wall_stiffness = damper.mass_ratio * random.log_uniform(10, 1e4);
      const bool flies = random.chance(0.4);
      damper.y0 = damper.clearance * (flies ? random.uniform(-0.1, 1.1) : double(random.chance(0.5)));
      damper.w0 = flies ? random.uniform(-3, 3) : 0;
      scene.dampers.push_back(damper);
    }
    scene.until_time = 10;
    Cem options{.damper = random.chance(0.5) ? Damper::centred : Damper::lagged,
                .locate = random.chance(0.5),
                .calibration = random.chance(0.5) ? Calibration::fixed_wall : Calibration::two_body};
    options.time_step =
        std::min(0.01, stability_limit(scene, options.damper, options.calibration) / random.uniform(20, 60));
    if (random.chance(0.5)) options.large_step = 0.1;
    if (random.chance(0.3)) options.stuck_speed = random.log_uniform(0.01, 3);
    if (random.chance(0.2)) options.budget.max_impacts = std::int64_t(random.uniform(0, 20));
    if (random.chance(0.2)) options.budget.max_half_cycles = 2;

    const Run run = run_of(scene, options);  // every_run.cpp holds it against itself
    CHECK(std::abs(run.energy->residual) < 0.3);
    const Run less = simulate(scene, options, {.impacts = true});
    CHECK(less.impacts->time == run.impacts->time);
    CHECK(less.half_cycles->amplitude == run.half_cycles->amplitude);
    CHECK(less.end_time == run.end_time);

    Scene mirrored = scene;
    mirrored.x0 = -scene.x0, mirrored.v0 = -scene.v0, mirrored.force_amplitude = -scene.force_amplitude;
    for (SceneDamper& damper : mirrored.dampers)
      damper.y0 = damper.clearance - damper.y0, damper.w0 = -damper.w0;
    const Run other = run_of(mirrored, options);
    for (std::size_t i = 0; i < std::min<std::size_t>(run.history->x.size(), 5); ++i)
      CHECK(std::abs(run.history->x[i] + other.history->x[i]) < 1e-6);
    for (std::size_t i = 0; i < std::min<std::size_t>(run.impacts->time.size(), 2); ++i)
      CHECK(std::abs(run.impacts->time[i] - other.impacts->time[i]) < 1e-6);
  }
}

TEST_CASE("parts of a damper that join the primary mass, or settle, together are that damper") {
  // As above, with the step at which one damper's walls are pressed and the others' are: half the stability
  // limit, the same for both. A list solves (M17.10) in another order, and every impact makes more of the
  // rounding.
  constexpr std::array shares{0.5, 0.25, 0.25};
  std::size_t joined = 0;
  for (Scene scene : single) {
    scene.until_time = std::min(8.0, *scene.until_time);
    for (const Cem& way : further_ways) {
      Cem options = way;
      const Run whole = run_of(scene, options);
      options.time_step = std::get<Cem>(whole.engine).time_step;
      Scene parts = scene;
      parts.dampers.assign(shares.size(), parts.dampers.front());
      for (std::size_t i = 0; i < shares.size(); ++i) {
        parts.dampers[i].mass_ratio *= shares[i];
        parts.dampers[i].wall_stiffness *= shares[i];
      }
      CAPTURE(scene.damper().mass_ratio);
      CAPTURE(&way - further_ways.data());
      check_alike(run_of(parts, options), whole, 1e-7);
      joined += joined_contacts(whole);
    }
  }
  CHECK(joined > 10);
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
  Record record{.impacts = true, .contacts = true, .energy = true};
  record.history = {{touch + 0.1, touch + 0.2, 2}};
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

TEST_CASE("what the component element method does not take of a list is said by its field") {
  const auto problem_of = [&](const Cem& options) -> std::string {
    try {
      simulate(four, options, Record{});
    } catch (const InvalidArguments& error) {
      const Problem& problem = error.problems().front();
      return problem.field + ": " + problem.message;
    }
    return {};
  };
  CHECK(problem_of({}).empty());
  CHECK(problem_of({.stuck_speed = 0.01}).empty());
  CHECK(problem_of({.time_step = 1}).starts_with("time_step: must be <= 0.0"));
  CHECK(problem_of({.large_step = 2}).starts_with("large_step: must be > "));
}
