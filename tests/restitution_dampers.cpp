// Several dampers by the restitution engine: what must hold whatever their numbers. (Against an independent
// simulation: oracle/.)
#include "impact_damper/engines/restitution_dampers.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "impact_damper/simulate.hpp"
#include "reference.hpp"

using namespace impact_damper;

namespace {

Record everything() {
  Record record;
  record.impacts = record.contacts = record.energy = true;
  return record;
}

// 1 to 6 dampers with clearances from 0.1 to 10; forced in a third of the scenes, damped in a half.
Scene random_scene(std::uint64_t seed) {
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
    damper.clearance = random.log_uniform(0.1, 10);
    const bool flies = random.chance(0.4);
    damper.y0 = damper.clearance * (flies ? random.uniform(0, 1) : double(random.chance(0.5)));
    damper.w0 = flies ? random.uniform(-3, 3) : 0;
    scene.dampers.push_back(damper);
  }
  scene.until_time = 40;
  return scene;
}

Run run_of(const Scene& scene) {
  return simulate(scene, Restitution{.budget = {.max_impacts = 20'000}}, everything());
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

}  // namespace

TEST_CASE(
    "several dampers keep the energy balance, each impact loses by Newton's law, nobody leaves a cavity") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    const Scene scene = random_scene(seed);
    const Run run = run_of(scene);
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

TEST_CASE("a list of one damper is the scene with that damper") {
  double compared = 0, in_all = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    CAPTURE(seed);
    Scene list = random_scene(seed);
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
    const Run by_list = run_of(list), by_one = run_of(one);
    compared += agree_until(by_list, by_one, 1e-7, c);
    in_all += by_list.end_time;
    if (by_list.half_cycles->zero_crossing.size() > 1)
      CHECK(agree_until(by_list, by_one, 1e-7, c) >= by_list.half_cycles->zero_crossing.front());
  }
  CHECK(compared >= 0.7 * in_all);
}

TEST_CASE("the order of the dampers changes no bit") {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    CAPTURE(seed);
    const Scene scene = random_scene(seed);
    Scene turned = scene;
    std::rotate(turned.dampers.begin(), turned.dampers.begin() + 1, turned.dampers.end());
    const int count = int(scene.dampers.size());
    const Run one = run_of(scene), other = run_of(turned);
    CHECK(one.half_cycles->zero_crossing == other.half_cycles->zero_crossing);
    CHECK(one.half_cycles->amplitude == other.half_cycles->amplitude);
    CHECK(one.impacts->time == other.impacts->time);
    CHECK(one.energy->final.total() == other.energy->final.total());
    CHECK(one.energy->residual == other.energy->residual);
    // Of each damper by itself, as the impacts of one instant are in the order of numbers.
    for (int i = 0; i < count; ++i) {
      const auto speeds_of = [](const Run& run, int damper) {
        std::vector<double> speeds;
        for (std::size_t k = 0; k < run.impacts->time.size(); ++k)
          if (run.impacts->damper[k] == damper) speeds.push_back(run.impacts->relative_velocity[k]);
        return speeds;
      };
      CHECK(speeds_of(one, i) == speeds_of(other, (i + count - 1) % count));
      CHECK(one.energy->dampers[i].impact_loss == other.energy->dampers[(i + count - 1) % count].impact_loss);
    }
  }
}

TEST_CASE("halves of a damper that are released alike are that damper, and one of hardly any mass is none") {
  double compared = 0, in_all = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    const Scene scene = random_scene(seed);
    Scene halves = scene, more = scene;
    halves.dampers.front().mass_ratio /= 2;
    halves.dampers.push_back(halves.dampers.front());
    more.dampers.push_back({.mass_ratio = 1e-9, .restitution = 0.5, .clearance = 0.7});
    const Run whole = run_of(scene), split = run_of(halves), added = run_of(more);
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
  Scene scene;
  scene.x0 = 6;
  scene.until_time = 30;
  scene.dampers.assign(10, {.mass_ratio = 0.002, .restitution = 0.6, .clearance = 1});
  Scene one = scene;
  one.dampers = {{.mass_ratio = 0.02, .restitution = 0.6, .clearance = 1}};
  const Run by_ten = run_of(scene), by_one = run_of(one);
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
  Scene scene;
  scene.x0 = 6;
  scene.until_time = 1;
  // At rest at a distance of 0.25 from their right walls, towards which the cavities' x'' < 0 leads them.
  scene.dampers = {{.mass_ratio = 0.01, .clearance = 1, .y0 = 0.75},
                   {.mass_ratio = 0.01, .clearance = 1.5, .y0 = 1.25},
                   {.mass_ratio = 0.01, .clearance = 10, .y0 = 9.75}};
  const Run run = run_of(scene);
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
    Scene scene;
    scene.x0 = -1, scene.until_time = 2;
    scene.dampers = {{.mass_ratio = 0.02, .clearance = 0.5 + time - (1 - std::cos(time)), .y0 = 0.5, .w0 = 1},
                     {.mass_ratio = 0.02, .clearance = 10, .y0 = 3 * t + (1 - std::cos(t)), .w0 = -3}};
    const Run run = run_of(scene);
    REQUIRE(run.impacts->time.size() >= 2);
    CHECK((run.impacts->time[0] == run.impacts->time[1]) == (earlier == 1e-12));
  }
}

TEST_CASE("sticking masses count to the primary mass, and leave together") {
  // Plastic dampers: both come to rest on the same wall, and are let go when x'' changes its sign.
  Scene scene;
  scene.x0 = 1;
  scene.until_time = 20;
  scene.dampers = {{.mass_ratio = 0.3, .restitution = 0, .clearance = 0.5},
                   {.mass_ratio = 0.2, .restitution = 0, .clearance = 0.8}};
  const Run run = run_of(scene);
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
  Scene scene;
  scene.x0 = 1;
  scene.until_time = 3.4;
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
  Scene scene;
  scene.x0 = x0, scene.until_time = 0.01;
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
  Scene scene;
  scene.until_time = 1;
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
  Scene scene;
  scene.until_time = 1;
  scene.dampers = {{}, {.clearance = 2, .y0 = 3}};
  const auto field_of = [&](const Engine& engine) -> std::string {
    try {
      simulate(scene, engine, Record{});
    } catch (const InvalidArguments& error) {
      return error.problems().front().field;
    }
    return {};
  };
  CHECK(field_of(Restitution{}) == "dampers[1].y0");
  scene.dampers[1].y0 = 2;
  CHECK(field_of(Restitution{}).empty());
  scene.dampers[1].y0 = 3;
  CHECK(field_of(Exact{}).empty());  // whose walls give way
  CHECK(field_of(Cem{}).empty());
  scene.dampers[0].clearance = 0;
  CHECK(field_of(Restitution{}) == "dampers[0].clearance");
  scene.dampers.assign(1001, {});
  CHECK(field_of(Restitution{}) == "dampers");
}
