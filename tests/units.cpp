#include "impact_damper/units.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "rejection.hpp"

using namespace impact_damper;

namespace {

// A mast of 40 kg at 20 rad/s, worked through by hand: every dimensionless number is a short decimal.
SceneInUnits mast() {
  return {.mass = 40,
          .stiffness = 16000,
          .damping = 3.2,
          .initial_displacement = 60,
          .initial_velocity = -50,
          .exciting_force = 4,
          .exciting_frequency = 3,
          .until_seconds = 30,
          .until_millimetres = 0.5,
          .dampers = {{1.6, 10, 0.7, 4e8, 2.5, 20}}};
}

doctest::Approx near(double value) { return doctest::Approx(value).epsilon(1e-14); }  // a few roundings

}  // namespace

TEST_CASE("a scene in units becomes the dimensionless one that is worked out by hand") {
  const Scene scene = dimensionless(mast());
  CHECK(scene.damper().mass_ratio == near(0.04));
  CHECK(scene.damper().restitution == 0.7);
  CHECK(scene.damping_ratio == near(0.002));  // 3.2 / (2 sqrt(16000 40)) = 3.2 / 1600
  CHECK(scene.damper().wall_stiffness == near(25000));
  CHECK(scene.x0 == near(6));
  CHECK(scene.v0 == near(-0.25));  // epsilon Omega_n = 10 mm 20/s
  CHECK(scene.damper().y0 == near(0.25));
  CHECK(scene.damper().w0 == near(0.1));
  CHECK(scene.force_amplitude == near(0.025));                 // K epsilon = 160 N
  CHECK(scene.force_frequency == near(0.942477796076937972));  // 3 2 pi / 20
  CHECK(*scene.until_time == near(600));
  CHECK(*scene.until_amplitude == near(0.05));
  CHECK(problems_of(mast()).empty());
}

TEST_CASE("a natural frequency stands for the stiffness, and only one of the two may be given") {
  SceneInUnits scene = mast();
  scene.natural_frequency = 10 / std::acos(-1.0);  // 20 rad/s
  CHECK(problems_of(scene).size() == 1);
  CHECK(problems_of(scene)[0].message == "either it or natural_frequency must be given, got both");
  scene.stiffness.reset();
  CHECK(problems_of(scene).empty());
  CHECK(*stiffness_of(scene) == near(16000));
  CHECK(dimensionless(scene).force_frequency == near(dimensionless(mast()).force_frequency));
  CHECK(dimensionless(scene).damper().wall_stiffness == near(25000));
  scene.mass = 160;
  CHECK(*stiffness_of(scene) == near(64000));
  scene.natural_frequency = 1e9;
  CHECK(problems_of(scene)[0].field == "natural_frequency");
  scene.natural_frequency.reset();
  CHECK(problems_of(scene)[0].field == "stiffness");
}

TEST_CASE("a number that is set takes the place of the one that it stands for") {
  SceneInUnits scene = mast();
  set_number(scene, &SceneInUnits::natural_frequency, 3);
  set_number(scene, &SceneInUnits::damping_ratio, 0.1);
  CHECK(!scene.stiffness);
  CHECK(!scene.damping);
  CHECK(problems_of(scene).empty());
  set_number(scene, &SceneInUnits::stiffness, 5);
  CHECK(scene.stiffness == 5);
  CHECK(!scene.natural_frequency);
}

TEST_CASE("a number is read with the units that engineers write behind it") {
  const auto read = [](const char* text, Dimension dimension) { return parse_quantity(text, dimension); };
  CHECK(read("12mm", Dimension::length) == 12);
  CHECK(read("1.2 cm", Dimension::length) == 12);
  CHECK(read("-0.012m", Dimension::length) == -12);
  CHECK(read("2in", Dimension::length) == near(50.8));
  CHECK(read("12000um", Dimension::length) == 12);
  CHECK(read("1e3ms", Dimension::time) == 1);
  CHECK(read("2min", Dimension::time) == 120);
  CHECK(read("+0.2m/s", Dimension::velocity) == 200);
  CHECK(read("800g", Dimension::mass) == 0.8);
  CHECK(read("16kN/m", Dimension::stiffness) == 16000);
  CHECK(read("16N/mm", Dimension::stiffness) == 16000);
  CHECK(read("3.2 N s/m", Dimension::damping) == 3.2);
  CHECK(read("9.81m/s^2", Dimension::acceleration) == 9.81);
  CHECK(read("4.2Hz", Dimension::frequency) == 4.2);
  CHECK(read("30deg", Dimension::inclination) == 30);
  for (const char* const wrong :
       {"12", "mm", "", "12kg", "12mmm", "1 2mm", "nanmm", "infmm", "12MM", "0x1mm", "1e999mm"}) {
    CAPTURE(wrong);
    CHECK(!read(wrong, Dimension::length));
  }
  for (const UnitField& field : unit_fields) {
    CAPTURE(field.name);
    if (field.dimension == Dimension::ratio) continue;
    CHECK(parse_quantity("7" + std::string(unit_of(field.dimension, true)), field.dimension) == 7);
    CHECK(written_units(field.dimension) != "");
  }
}

TEST_CASE("the scales are those of the primary system and the clearance") {
  const Scales scales = scales_of(mast());
  CHECK(scales.of(Dimension::time) == near(0.05));
  CHECK(scales.of(Dimension::frequency) == near(3.18309886183790672));  // 20 / (2 pi)
  CHECK(scales.length == 10);
  CHECK(scales.of(Dimension::velocity) == near(200));
  CHECK(scales.of(Dimension::force) == near(160));
  CHECK(scales.of(Dimension::energy) == near(1.6));  // 16000 N/m (0.01 m)^2
  CHECK(scales.of(Dimension::damping) == near(1600));
}

TEST_CASE("what is not said of a scene in units is at rest, undamped, unforced and has the usual walls") {
  const SceneInUnits scene{.mass = 2, .stiffness = 50, .until_seconds = 1, .dampers = {{0.1, 4}}};
  const Scene expected{.x0 = 0, .until_time = 5, .dampers = {{.mass_ratio = 0.05}}};
  CHECK(dimensionless(scene) == expected);
}

TEST_CASE("an impact speed below 0 is rejected before it becomes 0 by rounding") {
  SceneInUnits scene = mast();
  scene.dampers[0].restitution_by_speed = {{-5e-324, 0.5}};
  const std::vector<Problem> problems = problems_of(scene);
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].field == "restitution");
  CHECK(problems[0].message == "must have speeds >= 0, got -5e-324");
}

TEST_CASE("a motion in units obeys the equations with their units") {
  // Until the secondary mass meets a wall the primary mass is alone: M x'' + C x' + K x = F sin(2 pi f t).
  // Its closed form in millimetres and seconds, from rest, against the run of the dimensionless scene.
  SceneInUnits given = mast();
  given.dampers = {{1.6, 1000, 0.7, 4e8, 500, 0}};
  given.until_millimetres.reset();
  given.until_seconds = 2;
  given.initial_velocity = given.initial_displacement = 0;
  const Scales scales = scales_of(given);
  const Record record{.impacts = true, .history = {{0, 2 / scales.of(Dimension::time), 41}}};
  const Run run = simulate(dimensionless(given), Exact{}, record);
  REQUIRE(run.impacts->time.empty());

  const double m = 40, c = 3.2, k = 16000, force = 4, omega = 2 * M_PI * 3;
  const double real = k - m * omega * omega, imaginary = c * omega,
               square = real * real + imaginary * imaginary;
  const double s = force * real / square, q = -force * imaginary / square;  // of sin and cos, steady state, m
  const double decay = c / (2 * m), omega_d = std::sqrt(k / m - decay * decay);
  const double a = -q, b = (-s * omega + a * decay) / omega_d;
  for (std::size_t i = 0; i < run.history->time.size(); ++i) {
    const double t = run.history->time[i] * scales.of(Dimension::time);
    const double x = s * std::sin(omega * t) + q * std::cos(omega * t) +
                     std::exp(-decay * t) * (a * std::cos(omega_d * t) + b * std::sin(omega_d * t));
    // Twelve digits of the largest, about 2 mm: both sides round.
    CHECK(run.history->x[i] * scales.length == doctest::Approx(1000 * x).epsilon(1e-12).scale(2));
  }
}

TEST_CASE("a scene file in units is read as the scene that its numbers make") {
  const SceneFile file = parse_scene_file(
      "mast.json",
      R"({"description": "A mast", "mass": 40, "stiffness": 16000, "secondary_mass": 1.6, "clearance": 10,
          "restitution": 0.7, "damping": 3.2, "contact_stiffness": 4e8, "initial_displacement": 60,
          "initial_velocity": -50, "secondary_displacement": 2.5, "secondary_velocity": 20, "exciting_force": 4,
          "exciting_frequency": 3, "until_seconds": 30, "until_millimetres": 0.5})");
  CHECK(file.scene == dimensionless(mast()));
  CHECK(file.scales == scales_of(mast()));
  CHECK(file.description == "A mast");
  CHECK(!parse_scene_file("s.json", R"({"restitution": 0.5, "until_time": 3})").scales);
}

TEST_CASE("keys of both kinds in one file are all named") {
  CHECK_THROWS_WITH_AS(
      parse_scene("s.json", R"({"mass": 1, "stiffness": 1, "secondary_mass": 1, "clearance": 1, "x0": 1,
                                "until_seconds": 1, "until_amplitude": 1, "restitution": 1})"),
      "s.json: must be either in units or dimensionless, got mass, stiffness, secondary_mass, clearance, "
      "until_seconds beside x0, until_amplitude",
      InputError);
}

TEST_CASE("no number in units that is allowed makes a scale of zero or infinity") {
  for (const double mass : {1e-15, 1e15})
    for (const double stiffness : {1e-15, 1e15})
      for (const double length : {1e-15, 1e15})
        for (const Dimension dimension : all_of<Dimension>) {
          const Scales scales{mass, stiffness, length};
          CHECK(std::isnormal(scales.of(dimension)));
          CHECK(std::isnormal(scales.in_si(dimension)));
        }
}

TEST_CASE("each unit has a name in a scene in units, without units, and as the end of a name in SI") {
  std::string all;
  for (const Dimension each : all_of<Dimension>)
    all += std::string(name_of(each)) + ": " + std::string(unit_of(each, true)) + ", " +
           std::string(unit_of(each, false)) + ", " + std::string(suffix_of(each)) + "\n";
  CHECK(all ==
        "ratio: , , \n"
        "count: , , \n"
        "length: mm, epsilon, _m\n"
        "time: s, 1/Omega_n, _s\n"
        "velocity: mm/s, epsilon Omega_n, _m_per_s\n"
        "mass: kg, M, _kg\n"
        "force: N, K epsilon, _N\n"
        "energy: J, K epsilon^2, _J\n"
        "power: W, K epsilon^2 Omega_n, _W\n"
        "frequency: Hz, Omega_n, _Hz\n"
        "rate: 1/s, Omega_n, _per_s\n"
        "stiffness: N/m, K, _N_per_m\n"
        "damping: N s/m, 2 sqrt(K M), _N_s_per_m\n"
        "acceleration: m/s^2, epsilon Omega_n^2, _m_per_s2\n"
        "inclination: deg, deg, _deg\n");
}

TEST_CASE("what one unit is in engineers' units and in SI is worked out by hand") {
  const Scales scales = scales_of(mast());
  const auto is = [&](Dimension dimension, double in_units, double in_si) {
    CHECK(scales.of(dimension) == near(in_units));
    CHECK(scales.in_si(dimension) == near(in_si));
  };
  is(Dimension::ratio, 1, 1);
  is(Dimension::count, 1, 1);
  is(Dimension::length, 10, 0.01);
  is(Dimension::time, 0.05, 0.05);
  is(Dimension::velocity, 200, 0.2);
  is(Dimension::mass, 40, 40);
  is(Dimension::force, 160, 160);
  is(Dimension::energy, 1.6, 1.6);
  is(Dimension::power, 32, 32);
  is(Dimension::frequency, 3.18309886183790672, 3.18309886183790672);  // 20 / (2 pi)
  is(Dimension::rate, 20, 20);
  is(Dimension::stiffness, 16000, 16000);
  is(Dimension::damping, 1600, 1600);
  is(Dimension::acceleration, 4, 4);  // 0.01 m times (20/s)^2
  is(Dimension::inclination, 1, 1);
}

TEST_CASE("friction, drag, inclination and gravity are made dimensionless as worked out by hand") {
  SceneInUnits scene = mast();
  scene.damper().friction_coefficient = 0.2;
  CHECK(dimensionless(scene).damper().friction == near(0.2 * 9.80665 / 4));
  CHECK(dimensionless(scene).damper().static_friction == 0);
  CHECK(dimensionless(scene).weight == 0);
  scene.damper().static_friction_coefficient = 0.3;
  scene.damper().drag = 16;  // by 1.6 kg times 20/s
  scene.gravity = 8;
  scene.inclination = 60;
  Scene made = dimensionless(scene);
  CHECK(made.damper().friction == near(0.2 * 2 * 0.5));
  CHECK(made.damper().static_friction == near(0.3 * 2 * 0.5));
  CHECK(made.damper().drag == near(0.5));
  CHECK(made.weight == near(2 * 0.86602540378443865));
  scene.inclination = 90;
  made = dimensionless(scene);
  CHECK(made.damper().friction == 0);
  CHECK(made.weight == near(2));
  scene.inclination = 30;
  CHECK(dimensionless(scene).weight == near(1));
  CHECK(contains(rejection_of<InputError>([] {
                   parse_scene("s.json", R"({"mass": 1, "stiffness": 1, "secondary_mass": 1, "clearance": 1,
                       "until_seconds": 1, "inclination": 91, "friction_coefficient": 0.2,
                       "static_friction_coefficient": 0.1})");
                 }),
                 "/inclination: must be >= 0 and <= 90, got 91"));
  // drag is a key of both kinds, and tells neither.
  CHECK(parse_scene("s.json", R"({"drag": 0.5, "until_time": 1})").damper().drag == 0.5);
  CHECK(parse_scene("s.json",
                    R"({"drag": 16, "mass": 40, "stiffness": 16000, "secondary_mass": 1.6, "clearance": 10,
                                  "until_seconds": 1})")
            .damper()
            .drag == near(0.5));
}

TEST_CASE("a mass outside its cavity and a heavy one are cautioned about, and nothing else is") {
  Scene scene{.x0 = 6, .dampers = {{.mass_ratio = 0.04, .wall_stiffness = 1e4, .y0 = 3}}};
  REQUIRE(cautions_of(scene, {}).size() == 1);
  // k q^2 / 2 = 1e4 * 2^2 / 2 in the wall, 6^2 / 2 in the spring
  CHECK(cautions_of(scene, {})[0] ==
        "the secondary mass begins 2 times the clearance outside its cavity, which reaches from 0 to 1 (y0 "
        "is 3): a "
        "compliant wall there holds an energy of 20000, beside 18 in the primary spring");
  // The same by K epsilon^2 = 1.6 J and epsilon = 10 mm.
  CHECK(cautions_of(scene, scales_of(mast()))[0] ==
        "the secondary mass begins 20 mm outside its cavity, which reaches from 0 to 10 mm "
        "(secondary_displacement is "
        "30 mm): a compliant wall there holds an energy of 32000 J, beside 28.8 J in the primary spring");
  Scene list{.x0 = 6, .dampers = {{}, {.clearance = 0.2, .wall_stiffness = 1e4, .y0 = 0.5}}};
  REQUIRE(cautions_of(list, {}).size() == 1);
  CHECK(cautions_of(list, {})[0] ==
        "the secondary mass of damper 2 begins 0.3 outside its cavity, which reaches from 0 to 0.2 (y0 is "
        "0.5): "
        "a compliant wall there holds an energy of 450, beside 18 in the primary spring");
  scene.damper().y0 = -0.5;
  CHECK(cautions_of(scene, {})[0].starts_with("the secondary mass begins 0.5 times the clearance outside"));
  scene.damper().mass_ratio = 40;
  REQUIRE(cautions_of(scene, {}).size() == 2);
  CHECK(cautions_of(scene, {})[1] == "the secondary mass is 40 times as heavy as the primary mass");
  for (const double y0 : {0.0, 0.5, 1.0})
    CHECK(cautions_of({.dampers = {{.mass_ratio = 1, .y0 = y0}}}, {}).empty());
}

namespace {

// The mast with three boxes; every dimensionless number is a short decimal.
SceneInUnits mast_with_boxes() {
  SceneInUnits scene = mast();
  scene.dampers = {{1.6, 10}, {0.8, 25, 0.5, 4e8, 2.5, 20}};
  return scene;
}

}  // namespace

TEST_CASE("several dampers in units are made dimensionless with the clearance of the first") {
  REQUIRE(problems_of(mast_with_boxes()).empty());
  CHECK(scales_of(mast_with_boxes()) == scales_of(mast()));
  const Scene scene = dimensionless(mast_with_boxes());
  CHECK(scene.x0 == near(6));
  REQUIRE(scene.dampers.size() == 2);
  CHECK(scene.dampers[0] == SceneDamper{.mass_ratio = 1.6 / 40, .y0 = 0});
  CHECK(scene.dampers[1].mass_ratio == near(0.02));
  CHECK(scene.dampers[1].restitution == 0.5);
  CHECK(scene.dampers[1].clearance == near(2.5));
  CHECK(scene.dampers[1].wall_stiffness == near(25000));
  CHECK(scene.dampers[1].y0 == near(0.25));
  CHECK(scene.dampers[1].w0 == near(0.1));
}

TEST_CASE("what is wrong with one of several dampers in units is said by its own name") {
  const auto wrong = [](const auto& make) {
    SceneInUnits scene = mast_with_boxes();
    make(scene);
    std::string all;
    for (const Problem& problem : problems_of(scene)) all += problem.field + ": " + problem.message + "\n";
    return all;
  };
  CHECK(wrong([](SceneInUnits& scene) { scene.dampers[1].clearance.reset(); }) ==
        "dampers[1].clearance: missing, a value must be given in mm\n");
  CHECK(wrong([](SceneInUnits& scene) { scene.dampers[0].secondary_mass = 0; }) ==
        "dampers[0].secondary_mass: must be >= 1e-15 and <= 1e+15, got 0\n");
  CHECK(
      wrong([](SceneInUnits& scene) { scene.dampers[1].contact_stiffness = 1e-9; }) ==
      "dampers[1].contact_stiffness: made dimensionless, as dampers[1].wall_stiffness, must be >= 1e-06 and "
      "<= 1e+15, got 6.25e-14\n");
  CHECK(wrong([](SceneInUnits& scene) { scene.dampers.resize(1001, scene.dampers[0]); }) ==
        "dampers: must be at most 1000, got 1001\n");
}

TEST_CASE("a scene file with several dampers in units is read as the scene that its numbers make") {
  const std::string text =
      R"({"mass": 40, "stiffness": 16000, "damping": 3.2, "initial_displacement": 60, "initial_velocity": -50,
          "exciting_force": 4, "exciting_frequency": 3, "until_seconds": 30, "until_millimetres": 0.5,
          "dampers": [{"secondary_mass": 1.6, "clearance": 10},
                      {"secondary_mass": 0.8, "clearance": 25, "restitution": 0.5, "contact_stiffness": 4e8,
                       "secondary_displacement": 2.5, "secondary_velocity": 20}]})";
  const SceneFile file = parse_scene_file("boxes.json", text);
  CHECK(file.scene == dimensionless(mast_with_boxes()));
  CHECK(file.scales == scales_of(mast()));
}

TEST_CASE("a secondary mass of several that is heavier than the primary mass is warned of by its number") {
  Scene scene;
  scene.dampers = {SceneDamper{}, {.mass_ratio = 3}};
  CHECK(cautions_of(scene, {}) ==
        std::vector<std::string>{"the secondary mass of damper 2 is 3 times as heavy as the primary mass"});
}
