#include "impact_damper/io/run_file.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/sha256.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/provenance.hpp"
#include "impact_damper/io/run_columns.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "rejection.hpp"
#include "same_run.hpp"

using namespace impact_damper;

namespace {

using Lines = std::vector<std::string>;
using Json = nlohmann::ordered_json;

const Engine lagged_cem = Cem{.time_step = 1e-4, .damper = Damper::lagged, .budget = {.max_time = 1e6}};

const Engine cem_of_two_rates = Cem{
    .time_step = 1e-4, .locate = true, .large_step = 0.1, .stuck_speed = 0.02, .budget = {.max_time = 1e6}};

const Engine two_body_exact = Exact{.calibration = Calibration::two_body, .budget = {.max_time = 1e6}};

const Engine restitution_on_a_budget =
    Restitution{.accumulation_tolerance = 1e-5, .budget = {3, 4, 5.5}, .max_steps = 6};

Run full_run(const Engine& engine = lagged_cem) {
  Run run;
  run.stop_reason = StopReason::impact_budget;
  run.end_time = 7.25;
  run.scene.damper().mass_ratio = 0.1;
  run.scene.until_amplitude = 0.01;
  run.engine = engine;
  run.half_cycles = HalfCycles{{1.5, 4.6}, {0, 3}, {6, 5.9}, {3, 0}, {{{3, 0}}}};
  run.impacts = Impacts{{1, 2, 5},
                        {Wall::right, Wall::left, Wall::right},
                        {0.1 + 0.2, -1e-300, 5e-324},
                        {std::nullopt, 1.0 / 3, std::nullopt},
                        {6.0, 5.9, std::nullopt},
                        {3.5, -4, 1.0 / 3},
                        {0, 0, 0}};
  run.contacts = Contacts{{1, 2}, {1.125, 2}, {Wall::right, Wall::left}, {0, 0}};
  run.energy = EnergyBalance{{1, 2, 3, 4}, {0.1, 0.2, 0.3, 0.7}, {0.1, 0.2, 0.3}, 4, 5, 6, 7, 8, -1e-16};
  run.history = History{{0, 1}, {6, -0.0}, {0, -1}, {{{0, 0.5}, {1.7976931348623157e308, -1}}}};
  return run;
}

std::string without_provenance(const std::string& text) {
  return text.substr(0, text.find("\"provenance\""));
}

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const std::size_t place = text.find(old);
  REQUIRE(place != std::string::npos);
  return text.replace(place, old.size(), by);
}

Lines problems(const std::string& text) {
  try {
    parse_run("r.json", text);
  } catch (const InputError& error) {
    return error.problems();
  }
  return {};
}
// Of a text with one change, which must be one problem.
std::string only_problem(const std::string& text, const std::string& old, const std::string& by) {
  CAPTURE(old);
  const Lines found = problems(replaced(text, old, by));
  REQUIRE(found.size() == 1);
  return found[0];
}

}  // namespace

TEST_CASE("a run file has the keys of the schema, in its order, each column on one line") {
  CHECK(without_provenance(run_text(full_run())) == R"({
 "schema": "impact-damper/run/1",
 "scene": {"mass_ratio": 0.1, "restitution": 0.6, "damping_ratio": 0, "wall_stiffness": 10000, "x0": 6, "v0": 0, "y0": 0, "w0": 0, "force_amplitude": 0, "force_frequency": 1, "until_time": null, "until_amplitude": 0.01},
 "engine": {"name": "cem", "time_step": 1e-04, "damper": "lagged", "locate": false, "unstable": false, "calibration": "fixed-wall", "max_steps": 300000000, "max_impacts": 200000, "max_half_cycles": 200000, "max_time": 1e+06},
 "stop_reason": "impact_budget",
 "end_time": 7.25,
 "half_cycles": {
  "zero_crossing": [1.5,4.6],
  "peak_time": [0,3],
  "amplitude": [6,5.9],
  "impacts": [3,0]
 },
 "impacts": {
  "time": [1,2,5],
  "wall": [1,0,1],
  "relative_velocity": [0.30000000000000004,-1e-300,5e-324],
  "phase_deg": [null,0.3333333333333333,null],
  "amplitude": [6,5.9,null],
  "displacement": [3.5,-4,0.3333333333333333]
 },
 "contacts": {
  "begin": [1,2],
  "end": [1.125,2],
  "wall": [1,0]
 },
 "energy": {
  "initial": {"kinetic": 1, "spring": 2, "wall": 3, "total": 6, "paper": 4},
  "final": {"kinetic": 0.1, "spring": 0.2, "wall": 0.3, "total": 0.6000000000000001, "paper": 0.7},
  "impact_loss": [0.1,0.2,0.3],
  "impact_loss_total": 0.6000000000000001,
  "contact_loss": 4,
  "bounce_downs": 5,
  "bounce_down_loss": 6,
  "viscous_work": 7,
  "forcing_work": 8,
  "residual": -1e-16
 },
 "history": {
  "time": [0,1],
  "x": [6,-0.0],
  "v": [0,-1],
  "y": [0,0.5],
  "w": [1.7976931348623157e+308,-1]
 },
 )");
}

// A mast of 40 kg on 16 kN/m with 10 mm of clearance: 20 rad/s.
constexpr Scales mast{.mass = 40, .stiffness = 16000, .length = 10};

TEST_CASE("a run of a scene in units says what one unit of each column is in SI, and is read with it") {
  const std::string text = run_text(full_run(), mast);
  const std::string units =
      R"("end_time": 7.25,
 "units": {"length_m": 0.01, "time_s": 0.05, "velocity_m_per_s": 0.19999999999999998, "mass_kg": 40, "force_N": 160, "energy_J": 1.6},
 "half_cycles": {)";
  CHECK(contains(text, units));
  CHECK(run_text(parse_run("r.json", text)) == run_text(full_run()));
}

TEST_CASE("units that do not go together are rejected, whichever of them is 1 percent off") {
  const std::string text = run_text(full_run(), mast);
  for (const auto& [given, wrong] :
       {std::pair<std::string, std::string>{"\"length_m\": 0.01", "\"length_m\": 0.0101"},
        {"\"time_s\": 0.05", "\"time_s\": 0.0505"},
        {"\"velocity_m_per_s\": 0.19999999999999998", "\"velocity_m_per_s\": 0.202"},
        {"\"mass_kg\": 40", "\"mass_kg\": 40.4"},
        {"\"force_N\": 160", "\"force_N\": 161.6"},
        {"\"energy_J\": 1.6", "\"energy_J\": 1.616"}}) {
    const Lines found = problems(replaced(text, given, wrong));
    REQUIRE(!found.empty());
    CHECK(found[0].starts_with("r.json: /units/"));
    CHECK(contains(found[0], "must be "));
  }
  const Lines missing = problems(replaced(text, "\"mass_kg\": 40, ", ""));
  REQUIRE(!missing.empty());
  CHECK(missing[0] == "r.json: /units/mass_kg: missing, a value must be given");
}

TEST_CASE("a section of a run as CSV has the columns of the run file, absent numbers being empty cells") {
  Run run = full_run();
  CHECK(run_csv(run) ==
        "zero_crossing,peak_time,amplitude,impacts\n"
        "1.5,0,6,3\n"
        "4.6,3,5.9,0\n");
  run.half_cycles.reset();
  CHECK(run_csv(run) ==
        "time,wall,relative_velocity,phase_deg,amplitude,displacement\n"
        "1,1,0.30000000000000004,,6,3.5\n"
        "2,0,-1e-300,0.3333333333333333,5.9,-4\n"
        "5,1,5e-324,,,0.3333333333333333\n");
  run.impacts.reset();
  CHECK(run_csv(run) ==
        "begin,end,wall\n"
        "1,1.125,1\n"
        "2,2,0\n");
  run.contacts.reset();
  CHECK(run_csv(run) ==
        "time,x,v,y,w\n"
        "0,6,0,0,1.7976931348623157e+308\n"
        "1,-0.0,-1,0.5,-1\n");
  run.history.reset();
  CHECK_THROWS_AS(run_csv(run), std::invalid_argument);
}

// Units of two, so that products are exact; no two of them alike.
TEST_CASE("in SI every column of the CSV is multiplied by its own unit, and its name says which") {
  // Length 2, time 1/4, velocity 8, mass 1, force 32, energy 64.
  const Scales units{.mass = 1, .stiffness = 16, .length = 2000};
  Run run = full_run();
  CHECK(run_csv(run, units) ==
        "zero_crossing_s,peak_time_s,amplitude_m,impacts\n"
        "0.375,0,12,3\n"
        "1.15,0.75,11.8,0\n");
  run.half_cycles.reset();
  CHECK(run_csv(run, units) ==
        "time_s,wall,relative_velocity_m_per_s,phase_deg,amplitude_m,displacement_m\n"
        "0.25,1,2.4000000000000004,,12,7\n"
        "0.5,0,-8e-300,0.3333333333333333,11.8,-8\n"
        "1.25,1,4e-323,,,0.6666666666666666\n");
  run.impacts.reset();
  CHECK(run_csv(run, units) ==
        "begin_s,end_s,wall\n"
        "0.25,0.28125,1\n"
        "0.5,0.5,0\n");
  run.contacts.reset();
  run.history->dampers[0].w = {3, -1};
  CHECK(run_csv(run, units) ==
        "time_s,x_m,v_m_per_s,y_m,w_m_per_s\n"
        "0,12,0,0,24\n"
        "0.25,-0.0,-8,1,-8\n");
}

TEST_CASE("a run that is read and written again has the same bytes, whatever its engine and sections") {
  for (const Engine& engine : {two_body_exact, restitution_on_a_budget, cem_of_two_rates,
                               Engine(Cem{.time_step = 1e-5, .budget = {.max_time = 1e6}})}) {
    Run run = full_run(engine);
    CHECK(run_text(parse_run("r.json", run_text(run))) == run_text(run));
    CHECK(parse_run("r.json", run_text(run)).engine == engine);
    CHECK(parse_run("r.json", run_text(run)).scene == run.scene);
    run.half_cycles.reset();
    run.impacts.reset();
    run.contacts.reset();
    run.energy.reset();
    run.history = History{};
    CHECK(run_text(parse_run("r.json", run_text(run))) == run_text(run));
    CHECK(!parse_run("r.json", run_text(run)).impacts);
    CHECK(parse_run("r.json", run_text(run)).history);
  }
}

TEST_CASE("each option of each engine survives the file, and one that is out of its range is named") {
  for (Engine engine : default_engines()) {
    CAPTURE(name_of(engine));
    double next = 1e-4;  // ascending: a large step is larger than the time step
    for_each_option(engine, [&](const OptionInfo&, auto& value) {
      using Value = std::remove_cvref_t<decltype(value)>;
      if constexpr (std::is_enum_v<Value>) {
        value = std::data(all_of<Value>)[all_of<Value>.size() - 1];
      } else if constexpr (std::is_same_v<Value, bool>) {
        value = true;
      } else if constexpr (std::is_same_v<Value, std::int64_t>) {
        ++value;
      } else {
        value = next *= 2;
      }
    });
    CHECK(problems_of(engine).empty());
    CHECK(parse_run("r.json", run_text(full_run(engine))).engine == engine);

    std::vector<std::string> numbers, named;
    for_each_option(engine, [&](const OptionInfo& option, auto& value) {
      using Value = std::remove_cvref_t<decltype(value)>;
      if constexpr (!std::is_enum_v<Value> && !std::is_same_v<Value, bool>) {
        const Value allowed = std::exchange(value, Value(-1));
        numbers.emplace_back(option.name);
        const std::vector<Problem> found = problems_of(engine);
        REQUIRE(found.size() == 1);
        named.push_back(found[0].field);
        CHECK(found[0].message.starts_with("must be >"));
        CHECK(found[0].message.ends_with(", got -1"));
        CHECK_THROWS_AS(simulate(Scene{.until_time = 1}, engine, {}), std::invalid_argument);
        value = allowed;
      }
    });
    CHECK(numbers == named);
    CHECK(numbers.size() >= 4);
  }
}

TEST_CASE("a file of before the searches' steps were an option was made with the usual ones") {
  for (const Engine& engine : {two_body_exact, Engine(Restitution{.budget = {.max_time = 1e6}})}) {
    std::string text = replaced(run_text(full_run(engine)), "\"max_steps\": 10000000, ", "");
    text = sealed(text.substr(0, text.rfind(seal_begin)));
    CHECK(parse_run("r.json", text).engine == engine);
  }
  CHECK(problems(replaced(run_text(full_run()), "\"max_steps\": 300000000, ", "")) ==
        Lines{"r.json: /engine/max_steps: missing, a value must be given"});
}

TEST_CASE("every bit of a number survives the file") {
  std::mt19937_64 bits(7);
  Run run = full_run();
  run.impacts.reset();
  std::vector<double>& x = run.history->x;
  x.clear();
  while (x.size() < 20'000) {
    const double value = std::bit_cast<double>(bits());
    if (std::isfinite(value)) x.push_back(value);
  }
  run.history->time.assign(x.size(), 0.5);
  run.history->v = run.history->dampers[0].y = run.history->dampers[0].w = run.history->time;
  const std::vector<double> back = parse_run("r.json", run_text(run)).history->x;
  REQUIRE(back.size() == x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    CHECK(std::bit_cast<std::uint64_t>(back[i]) == std::bit_cast<std::uint64_t>(x[i]));
}

TEST_CASE("any other byte makes another digest, which is told unless something plainer is") {
  const std::string text = run_text(full_run()), other_digest =
                                                     "r.json: /provenance/sha256: must be the digest of the "
                                                     "content, got another one: the file was altered or laid "
                                                     "out anew since it was written; make it again";
  for (const auto& [old, by] :
       std::vector<std::pair<std::string, std::string>>{{"\"x0\": 6,", "\"x0\": 6.5,"},
                                                        {"7.25", "7.5"},
                                                        {"[0.30000000000000004,", "[0.3,"},
                                                        {"\"fixed-wall\"", "\"two-body\""},
                                                        {"\"version\": \"", "\"version\": \"1"},
                                                        {",\n \"end_time\"", ", \"end_time\""},
                                                        {"\"}\n}\n", "\"}\n}\n\n"},
                                                        {"\"}\n}\n", "\"}\n}"}}) {
    const std::string changed = replaced(text, old, by);
    CAPTURE(changed);
    CHECK(problems(changed) == Lines{other_digest});
  }
  const std::string digest = text.substr(text.size() - seal_end.size() - 64, 64);
  CHECK(problems(replaced(text, digest, std::string(64, '0'))) == Lines{other_digest});
  CHECK(problems(replaced(text, ", \"sha256\": \"" + digest + "\"", "")) ==
        Lines{"r.json: /provenance/sha256: missing, a value must be given"});
  CHECK(problems(replaced(text, "\"x0\": 6,", "\"x0\": \"6\",")).size() == 1);
}

TEST_CASE("a file whose content was changed and that is sealed anew is read") {
  std::string text = replaced(run_text(full_run()), "\"end_time\": 7.25", "\"end_time\": 7.5");
  text = sealed(text.substr(0, text.rfind(seal_begin)));
  CHECK(parse_run("r.json", text).end_time == 7.5);
}

TEST_CASE("SHA-256 is that of the standard's examples, at every length about a block's") {
  // FIPS 180-4's examples, a million times "a", and by Python's hashlib: 119 bytes are the most that two
  // blocks hold beside the end, 120 the least that three do.
  const std::string two_blocks = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
  for (const auto& [text, digest] : std::vector<std::pair<std::string, std::string>>{
           {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
           {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
           {two_blocks, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
           {std::string(1'000'000, 'a'), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"},
           {std::string(119, '\xff'), "b863f94597d433ef2280e3b4656f13ea265a79bb8047287321c218905b03c99b"},
           {std::string(120, '\xff'), "9088fee917e5a748c2f0b4f5458c1cbdabbd696291c69be6e605bae0ef779e8f"},
           {std::string(64, '\0'), "f5a5fd42d16a20302798ef6ed309979b43003d2320d9f0e8ea9831a92759fb4b"},
           {std::string(55, 'x'), "d5e285683cd4efc02d021a5c62014694958901005d6f71e89e0989fac77e4072"},
           {std::string(56, 'x'), "04c26261370ee7541549d16dee320c723e3fd14671e66a099afe0a377c16888e"}})
    CHECK(sha256(text) == digest);
}

TEST_CASE("a run with energies has a loss for each impact, none less and none more") {
  for (const std::size_t losses : {2, 4}) {
    Run run = full_run();
    run.energy->impact_loss.resize(losses);
    CHECK(
        problems(run_text(run)) ==
        Lines{"r.json: /energy: must hold a loss for each of the 3 impacts, got " + std::to_string(losses)});
  }
}

TEST_CASE("a number that is not finite is never written") {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Run run = full_run();
    run.history->v[1] = bad;
    CHECK_THROWS_WITH_AS(run_text(run), doctest::Contains("\"v\""), NumericalError);
  }
}

TEST_CASE("a run file that was changed by hand is rejected with the place and the reason") {
  const std::string text = run_text(full_run());
  const auto only = [&](const std::string& old, const std::string& by) {
    return only_problem(text, old, by);
  };
  CHECK(only("run/1", "run/2") ==
        "r.json: /schema: must be one of \"impact-damper/run/1\", got the string \"impact-damper/run/2\"");
  CHECK(only("\"x0\": 6, ", "") == "r.json: /scene/x0: missing, a value must be given");
  CHECK(only("0.1,", "-0.1,").starts_with("r.json: /scene/mass_ratio: must be >= 1e-09"));
  CHECK(only("\"cem\"", "\"CEM\"") ==
        "r.json: /engine/name: must be one of \"exact\", \"restitution\", \"cem\", got the string \"CEM\"");
  CHECK(only("\"max_impacts\": 200000", "\"max_impacts\": -5") ==
        "r.json: /engine/max_impacts: must be a whole number >= 0, got -5");
  CHECK(only("[3,0]", "[3]") ==
        "r.json: /half_cycles/impacts: must be as long as the section's first column, 2, got a length of 1");
  CHECK(only("[3,0]", "[3,0.0]") ==
        "r.json: /half_cycles/impacts/1: must be a whole number >= 0, written without point or exponent, got "
        "0.0");
  CHECK(only("[1,2,5]", "[1,2,1.5]") ==
        "r.json: /impacts/time/2: must not be below the one before it, 2, got 1.5");
  CHECK(only("[1,0,1]", "[1,0,2]") == "r.json: /impacts/wall/2: must be a whole number >= 0 and <= 1, got 2");
  CHECK(only("[null,0.3333333333333333,null]", "[null,181,null]") ==
        "r.json: /impacts/phase_deg/1: must be null or a number >= 0 and <= 180, got 181");
  CHECK(only("[1.125,2]", "[1.125,1.5]") ==
        "r.json: /contacts/end/1: must not be before its begin, 2, got 1.5");
  CHECK(only("\"total\": 6,", "\"total\": 7,") ==
        "r.json: /energy/initial/total: must be the sum of its parts, 6, got 7");
  CHECK(only("\"impact_loss_total\": 0.6000000000000001", "\"impact_loss_total\": 0.6")
            .starts_with("r.json: /energy/impact_loss_total: must be the sum of its parts"));
  CHECK(only("\"history\"", "\"histroy\"") == "r.json: /histroy: unknown key, did you mean \"history\"?");
  CHECK(only("\"residual\"", "\"viscous_work\": 7, \"residual\"") ==
        "r.json: /energy/viscous_work: duplicate key, allowed is one value for each key");
  CHECK(only(" \"stop_reason\": \"impact_budget\",", "") ==
        "r.json: /stop_reason: missing, a value must be given");
}

TEST_CASE("whatever happens to a run file's bytes, it is read or rejected with at least one line") {
  const std::string text = run_text(full_run());
  std::mt19937_64 random(3);
  int rejected = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string damaged = text;
    for (std::uint64_t change = random() % 3; change < 3; ++change) {
      const std::size_t place = random() % damaged.size();
      switch (random() % 3) {
        case 0:
          damaged[place] = static_cast<char>(random());
          break;
        case 1:
          damaged.erase(place, random() % 20);
          break;
        case 2:
          damaged.insert(place, text.substr(random() % text.size(), random() % 20));
          break;
      }
    }
    try {
      parse_run("r.json", damaged);
    } catch (const InputError& error) {
      ++rejected;
      CHECK(!error.problems().empty());
    }
  }
  CHECK(rejected > 4000);  // what survives are changed digits and names in provenance
}

TEST_CASE("all that the default budgets allow and the longest history make a file that is allowed") {
  // No double's shortest text is longer: a sign, 17 digits with a point, an exponent of three digits.
  constexpr double longest = -2.2250738585072014e-308;
  REQUIRE(number_text(longest).size() == 24);
  constexpr Budget budget;
  const auto length = [&](std::size_t half_cycles, std::size_t impacts, std::size_t samples) {
    using Column = std::vector<double>;
    using Gaps = std::vector<std::optional<double>>;
    const Column rows(half_cycles, longest), times(impacts, longest), motion(samples, longest);
    const Column contacts(impacts + 1, longest);  // one may be there from the beginning
    Run run = full_run();
    run.half_cycles = HalfCycles{rows, rows, rows, std::vector(half_cycles, budget.max_impacts)};
    run.impacts = Impacts{
        times, std::vector(impacts, Wall::left), times, Gaps(impacts, longest), Gaps(impacts, longest),
        times};
    run.contacts = Contacts{contacts, contacts, std::vector(impacts + 1, Wall::left)};
    run.energy->impact_loss = times;
    run.history = History{motion, motion, motion, {{motion, motion}}};
    return static_cast<std::int64_t>(run_text(run).size());
  };
  // Rounded up, for the sum of the losses, which is written as well.
  const std::int64_t first = length(1, 1, 1);
  const auto row = [&](std::int64_t length_of_1001) { return (length_of_1001 - first + 999) / 1000; };
  const std::int64_t all = first + row(length(1001, 1, 1)) * budget.max_half_cycles +
                           row(length(1, 1001, 1)) * budget.max_impacts +
                           row(length(1, 1, 1001)) * most_samples;
  CAPTURE(all);
  CHECK(all <= static_cast<std::int64_t>(run_kind.most_bytes));
}

TEST_CASE("a scene file names what differs from the defaults") {
  const Scene scene =
      parse_scene("s.json", R"({"mass_ratio": 0.04, "until_amplitude": 0.01, "description": "d"})");
  const Scene expected{.until_amplitude = 0.01, .dampers = {{.mass_ratio = 0.04}}};
  CHECK(scene == expected);
  CHECK(parse_scene("s.json", scene_text(scene)) == scene);
}

TEST_CASE("a scene file's problems are reported together") {
  try {
    parse_scene("s.json",
                R"({"mass_ratio": -1, "x0": "6", "restitution": 1.5, "omega": 1, "until_time": "t"})");
    FAIL("read what is not valid");
  } catch (const InputError& error) {
    CHECK(error.problems() == Lines{"s.json: /x0: must be a number, got the string \"6\"",
                                    "s.json: /until_time: must be null or a number, got the string \"t\"",
                                    "s.json: /mass_ratio: must be >= 1e-09 and <= 1e+06, got -1",
                                    "s.json: /restitution: must be >= 0 and <= 1, got 1.5",
                                    "s.json: /omega: unknown key, did you mean \"force_frequency\"?"});
  }
  CHECK_THROWS_WITH_AS(parse_scene("s.json", "{}"),
                       "s.json: /until_time: until_time, until_amplitude or both must be given", InputError);
}

namespace {

// All but the sums, which the reader holds against their parts.
void check_same(const Run& a, const Run& b) {
  CHECK(a.stop_reason == b.stop_reason);
  CHECK(a.end_time == b.end_time);
  CHECK(a.engine == b.engine);
  reference::same(a, b, 0);
  reference::same_of_dampers(a, b, 0);
  CHECK(a.energy->residual == b.energy->residual);
}

}  // namespace

TEST_CASE("each entry of a run reads back as it was, be it absent, zero or neither") {
  for (const Engine& engine : {two_body_exact, restitution_on_a_budget, lagged_cem, cem_of_two_rates}) {
    Run run = full_run(engine);
    check_same(parse_run("run.json", run_text(run)), run);
    run.scene = {0.3, 5, 6, 9, 10, 0, 11, {}, {{0.1, 0.2, 1, 4, 0.7, 8}}};
    check_same(parse_run("run.json", run_text(run)), run);
    run.scene.until_amplitude = 0.5;
    run.scene.damping_ratio = run.scene.x0 = run.scene.v0 = run.scene.damper().y0 = run.scene.damper().w0 = 0;
    run.scene.force_amplitude = run.end_time = 0;
    run.energy = EnergyBalance{.initial = {}, .final = {}, .impact_loss = {0, 0, 0}};
    check_same(parse_run("run.json", run_text(run)), run);
  }
}

TEST_CASE("a run file says which program made it") {
  const std::string text = run_text(full_run());
  const Provenance made_by = provenance();
  CHECK(contains(text, "\"schema\": \"impact-damper/run/1\""));
  for (const auto& [key, value] : {std::pair{"version", made_by.version},
                                   {"commit", made_by.commit},
                                   {"compiler", made_by.compiler},
                                   {"build_type", made_by.build_type},
                                   {"flags", made_by.flags},
                                   {"system", made_by.system}}) {
    const std::string entry = '"' + std::string(key) + "\": \"" + std::string(value) + '"';
    CAPTURE(entry);
    CHECK(contains(text, entry));
  }
}

namespace {

Run run_of_several() {
  Run run = full_run(restitution_on_a_budget);
  run.scene.dampers = {{.mass_ratio = 0.1, .clearance = 1, .y0 = 0.5}, {.restitution = 1, .clearance = 0.25}};
  run.half_cycles->dampers = {{{1, 0}}, {{2, 0}}};
  run.impacts->damper = {0, 1, 1};
  run.contacts->damper = {1, 0};
  run.history->dampers = {{{0.5, 0.75}, {1, -1}}, {{0, 0.125}, {2, -0.0}}};
  run.energy->dampers = {{1, 2, 3, 0.5, 4, 5}, {1.5, 2.5, 3.5, -0.25, 0, 4.5}};
  return run;
}

}  // namespace

TEST_CASE("a run file of several dampers numbers them from 1 and has columns of each") {
  const std::string text = run_text(run_of_several());
  const auto holds = [&](const std::string& part) {
    CAPTURE(part);
    CHECK(contains(text, part));
  };
  holds(
      R"("scene": {"damping_ratio": 0, "x0": 6, "v0": 0, "force_amplitude": 0, "force_frequency": 1, "dampers": [{"mass_ratio": 0.1, "restitution": 0.6, "clearance": 1, "wall_stiffness": 10000, "y0": 0.5, "w0": 0}, {"mass_ratio": 0.02, "restitution": 1, "clearance": 0.25, "wall_stiffness": 10000, "y0": 0, "w0": 0}], "until_time": null,)");
  holds(R"(
  "impacts": [3,0],
  "dampers": [
   {"impacts": [1,0]},
   {"impacts": [2,0]}
  ]
 },)");
  holds(R"(
  "displacement": [3.5,-4,0.3333333333333333],
  "damper": [1,2,2]
 },)");
  holds(R"(
  "wall": [1,0],
  "damper": [2,1]
 },)");
  holds(R"(
  "residual": -1e-16,
  "dampers": [
   {"initial_kinetic": 1, "final_kinetic": 2, "impact_loss": 3, "contact_loss": 0.5, "bounce_down_loss": 5, "bounce_downs": 4},
   {"initial_kinetic": 1.5, "final_kinetic": 2.5, "impact_loss": 3.5, "contact_loss": -0.25, "bounce_down_loss": 4.5, "bounce_downs": 0}
  ]
 },)");
  holds(R"(
  "v": [0,-1],
  "dampers": [
   {"y": [0.5,0.75], "w": [1,-1]},
   {"y": [0,0.125], "w": [2,-0.0]}
  ]
 },)");
}

TEST_CASE("a run of several dampers reads back as it was") {
  Run other = run_of_several();  // zero where the first is not, and the other way round
  other.scene.dampers[0].y0 = 0;
  other.scene.dampers[0].w0 = 2;
  other.energy->dampers[0] = {};
  for (const Run& run : {run_of_several(), other}) {
    const std::string text = run_text(run);
    const Run back = parse_run("r.json", text);
    check_same(back, run);
    CHECK(run_text(back) == text);
  }
}

TEST_CASE("columns of dampers that are not those of the scene are rejected") {
  const std::string text = run_text(run_of_several());
  const auto only = [&](const std::string& old, const std::string& by) {
    return only_problem(text, old, by);
  };
  CHECK(only("\"damper\": [1,2,2]", "\"damper\": [1,2,3]") ==
        "r.json: /impacts/damper/2: must be a whole number >= 1 and <= 2, got 3");
  CHECK(only("\"damper\": [2,1]", "\"damper\": [2,0]") ==
        "r.json: /contacts/damper/1: must be a whole number >= 1 and <= 2, got 0");
  CHECK(only("\"damper\": [2,1]", "\"damper\": [2]") ==
        "r.json: /contacts/damper: must be as long as the section's first column, 2, got a length of 1");
  CHECK(only("{\"impacts\": [2,0]}", "{\"impacts\": [2]}") ==
        "r.json: /half_cycles/dampers/1/impacts: must be as long as the section's first column, 2, got a "
        "length of 1");
  CHECK(only(",\n   {\"impacts\": [2,0]}", "") ==
        "r.json: /half_cycles/dampers: must be as many as in the scene, 2, got 1");
  CHECK(only("\"w\": [1,-1]", "\"w\": [1]") ==
        "r.json: /history/dampers/0/w: must be as long as the section's first column, 2, got a length of 1");
  CHECK(only("\"bounce_downs\": 4}", "\"bounce_downs\": -4}") ==
        "r.json: /energy/dampers/0/bounce_downs: must be a whole number >= 0, got -4");
  CHECK(only("\"clearance\": 0.25, ", "") ==
        "r.json: /scene/dampers/1/clearance: missing, a value must be given");
  CHECK(only("\"clearance\": 1, ", "\"clearance\": 0.4, ") ==
        "r.json: /scene/dampers/0/y0: must be >= 0 and <= 0.4, its clearance, as walls are rigid, got 0.5");
}

TEST_CASE("as CSV, columns of a damper have its number behind their names") {
  Run run = run_of_several();
  run.energy.reset();
  CHECK(run_csv(run) ==
        "zero_crossing,peak_time,amplitude,impacts,impacts_1,impacts_2\n1.5,0,6,3,1,2\n4.6,3,5.9,0,0,0\n");
  run.half_cycles.reset();
  CHECK(run_csv(run).starts_with("time,wall,relative_velocity,phase_deg,amplitude,displacement,damper\n"));
  CHECK(run_csv(run).ends_with(",0.3333333333333333,2\n"));
  run.impacts.reset();
  CHECK(run_csv(run) == "begin,end,wall,damper\n1,1.125,1,2\n2,2,0,1\n");
  run.contacts.reset();
  CHECK(run_csv(run) == "time,x,v,y_1,w_1,y_2,w_2\n0,6,0,0.5,1,0,2\n1,-0.0,-1,0.75,-1,0.125,-0.0\n");
  CHECK(run_csv(run, mast).starts_with(
      "time_s,x_m,v_m_per_s,y_1_m,w_1_m_per_s,y_2_m,w_2_m_per_s\n0,0.06,0,0.005,"));
}

TEST_CASE(
    "a scene with a list of dampers is read and written with the list in place of one damper's numbers") {
  const std::string text =
      R"({"x0": 2, "dampers": [{}, {"mass_ratio": 0.01, "restitution": 0.5, "clearance": 3,
                               "wall_stiffness": 5, "y0": 2, "w0": -1}], "until_time": 4})";
  const Scene expected{.x0 = 2, .until_time = 4, .dampers = {SceneDamper{}, {0.01, 0.5, 3, 5, 2, -1}}};
  const Scene scene = parse_scene("s.json", text);
  CHECK(scene == expected);
  CHECK(parse_scene("s.json", scene_text(scene)) == scene);
  CHECK(contains(scene_text(scene), "\"mass_ratio\": 0.02, \"restitution\": 0.6, \"clearance\": 1,"));
}

TEST_CASE("the longest list of dampers is read from a file as it was") {
  Scene scene{.until_time = 1.0 / 3, .dampers = {}};
  for (std::size_t i = 0; i < most_dampers; ++i) {
    const double number = 1 / (30003.0 + static_cast<double>(i));
    scene.dampers.push_back({number, number, 7 * number, number, number, -number});
  }
  const auto file = std::filesystem::temp_directory_path() / "longest_list_of_dampers.json";
  write_file(file, scene_text(scene));
  CHECK(read_scene(file) == scene);
  std::filesystem::remove(file);
  scene.dampers.emplace_back();
  CHECK_THROWS_WITH_AS(parse_scene("s.json", scene_text(scene)),
                       "s.json: /dampers: must have at most 1000 elements, got 1001", InputError);
  CHECK(problems_of(scene).size() == 1);
}

TEST_CASE("a list of dampers beside numbers of one is rejected with all that is wrong") {
  try {
    parse_scene("s.json", R"({"mass_ratio": 0.1, "restitution": 0.1, "wall_stiffness": 1, "y0": 0, "w0": 0,
        "dampers": [{"mass_ratio": 0, "x0": 1}, 3, {"clearance": "1"}], "until_time": 4})");
    FAIL("read what is not valid");
  } catch (const InputError& error) {
    const std::string beside = ": must not be given beside dampers, each of which has its own";
    CHECK(error.problems() == Lines{"s.json: /mass_ratio" + beside, "s.json: /restitution" + beside,
                                    "s.json: /wall_stiffness" + beside, "s.json: /y0" + beside,
                                    "s.json: /w0" + beside, "s.json: /dampers/1: must be an object, got 3",
                                    "s.json: /dampers/2/clearance: must be a number, got the string \"1\"",
                                    "s.json: /dampers/0/mass_ratio: must be >= 1e-09 and <= 1e+06, got 0",
                                    "s.json: /dampers/0/x0: unknown key, did you mean \"w0\"?"});
  }
}

// --- The table of columns ----------------------------------------------------------------------------------

// The table of columns of a run against what else lists them: the schema of run files, and the types that the
// package for browsers and node declares.

namespace {

std::string source(const std::string& file) { return read_text(SOURCE_FOLDER "/" + file); }

// The schema's rule for a number.
Json rule_of(const NumberRange& range, const double&) {
  return {{"type", "number"}, {"minimum", range.least}, {"maximum", range.most}};
}
Json rule_of(const NumberRange& range, const std::optional<double>&) {
  return {{"type", {"number", "null"}}, {"minimum", range.least}, {"maximum", range.most}};
}
template <class Whole>
Json rule_of(const NumberRange& range, const Whole&) {
  const bool is_bounded = range.most < std::numeric_limits<double>::max();
  const auto most = is_bounded ? std::int64_t(range.most) : std::numeric_limits<std::int64_t>::max();
  return {{"type", "integer"}, {"minimum", range.least}, {"maximum", most}};
}

constexpr RunShape every_column{.listed = 1, .has_components = true};

// The schema of a section or a part of one, without descriptions, and its additions for runs with a list of
// dampers and for those without.
struct Schema {
  Json whole, with_list, without_list;
};

template <class Owner>
Schema schema_of(const Json& type) {
  Schema schema;
  Json properties, required = Json::array(), of_list = Json::array();
  const Owner owner{};
  for_each_column(owner, every_column, [&](const RunColumnInfo& info, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    const std::string name(info.name);
    if (!info.of_components) (info.without_list == WithoutList::same ? required : of_list).push_back(name);
    if constexpr (HasRunColumns<Value>) {
      properties[name] = schema_of<Value>("object").whole;
    } else if constexpr (PartsOfDampers<Value>) {
      const Json part = schema_of<typename Value::value_type>("object").whole;
      if (info.without_list == WithoutList::in_section) {
        properties.update(part["properties"]);
        schema.without_list["required"] = part["required"];
        for (const auto& column : part["properties"].items())
          schema.with_list["properties"][column.key()] = false;
      }
      properties[name] = {{"type", "array"}, {"items", part}};
    } else if constexpr (std::is_arithmetic_v<Value>) {
      properties[name] = rule_of(info.range, value);
    } else {
      properties[name] = {{"type", "array"}, {"items", rule_of(info.range, typename Value::value_type{})}};
    }
    if (info.without_list != WithoutList::same) schema.without_list["properties"][name] = false;
  });
  schema.whole = {
      {"type", type}, {"properties", properties}, {"required", required}, {"additionalProperties", false}};
  schema.with_list["required"] = of_list;
  return schema;
}

Json without_descriptions(Json schema) {
  if (schema.is_structured()) {
    if (schema.is_object()) schema.erase("description");
    for (Json& each : schema) each = without_descriptions(each);
  }
  return schema;
}

// Checks that the description of each column, or of what it is in, names its unit. above: of what it is in.
template <class Owner>
void units_are_named(const Json& schema, const std::string& above) {
  const auto words_of = [](Dimension dimension) {
    return dimension == Dimension::time       ? "1/Omega_n"
           : dimension == Dimension::length   ? "of epsilon"
           : dimension == Dimension::velocity ? "epsilon Omega_n"
                                              : "K epsilon\\^2";
  };
  const Owner owner{};
  for_each_column(owner, every_column, [&](const RunColumnInfo& info, const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    const Json& its = schema.at("properties").at(std::string(info.name));
    const std::string text = above + its.at("description").get<std::string>();
    CAPTURE(text);
    if constexpr (HasRunColumns<Value>)
      units_are_named<Value>(its, text);
    else if constexpr (PartsOfDampers<Value>)
      units_are_named<typename Value::value_type>(its["items"], text);
    else if (info.dimension != Dimension::ratio)
      CHECK(std::regex_search(text, std::regex(std::string(words_of(info.dimension)) + "[.;]")));
  });
}

// What the package declares of a section: the columns and numbers that every run has.
template <class Section>
std::string type_of() {
  std::string columns, numbers;
  const Section section{};
  for_each_column(section, every_column, [&](const RunColumnInfo& info, const auto& value) {
    if (info.of_components || info.without_list != WithoutList::same ||
        HasRunColumns<std::remove_cvref_t<decltype(value)>>)
      return;
    std::string& words = std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>> ? numbers : columns;
    words.append(words.empty() ? "\"" : " | \"").append(info.name) += '"';
  });
  return "Columns & Record<" + columns + ", Float64Array>" +
         (numbers.empty() ? "" : " & Record<" + numbers + ", number>") + ";";
}

// Calls visit(name, section of its type) for each section.
template <class Visit>
void for_each_section(const Visit& visit) {
  const Run run{};
  for_each_column(run, every_column,
                  [&]<class Section>(const RunColumnInfo& info, const std::optional<Section>&) {
                    visit(std::string(info.name), Section{});
                  });
}

}  // namespace

TEST_CASE("the schema of run files has the columns of the table, in its order, with their ranges and units") {
  const Json schema = Json::parse(source("data/schema/run.schema.json"));
  Json with_list, without_list;
  for_each_section([&]<class Section>(const std::string& name, const Section&) {
    CAPTURE(name);
    const Schema expected = schema_of<Section>({"object", "null"});
    const Json& given = schema["properties"][name];
    CHECK(without_descriptions(given) == expected.whole);
    units_are_named<Section>(given, given["description"]);
    with_list["properties"][name] = expected.with_list;
    without_list["properties"][name] = expected.without_list;
  });
  CHECK(nlohmann::json(schema["then"]) == nlohmann::json(with_list));
  CHECK(nlohmann::json(schema["else"]) == nlohmann::json(without_list));
}

TEST_CASE("the package for browsers and node declares the columns that every run has") {
  const std::string types =
      std::regex_replace(source("src/wasm/package/index.d.ts"), std::regex("\\s+"), " ");
  for_each_section([&]<class Section>(const std::string& name, const Section&) {
    const std::string expected = name + "?: " + type_of<Section>();
    CAPTURE(expected);
    CHECK(contains(types, expected));
  });
}
