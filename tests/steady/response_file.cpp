// Response files read back as they were written, and what is altered in them is noticed: by the digest, and
// where that is made anew by what follows from the rest.
#include "impact_damper/responses/response_file.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/simulate.hpp"
#include "steady_helpers.hpp"

namespace {

using namespace impact_damper;

SweepResponse asked_sweep() {
  return {active_scene(0.9),
          Restitution{},
          {.tolerance = 1e-8, .max_periods = 300, .mean_periods = 40},
          {&Scene::force_frequency, 0.85, 1.15, 4},
          {{SceneState{1, 0, 0.5, 0}, {}, {}}, {{{-0.5, 0.1, 0.2, 0}, 1e-3}, {}, {}}}};
}
SweepResponse several_sweep() {
  SweepResponse several = asked_sweep();
  several.scene.dampers = {{.mass_ratio = 0.05, .y0 = 0.5}, {.mass_ratio = 0.02, .clearance = 2}};
  several.sweeps = {{release_of(several.scene), {}, {}}};
  return several;
}
SweepResponse ended_sweep() {
  SweepResponse ended = asked_sweep();
  ended.engine = Exact{.budget = {.max_impacts = 3}};
  return ended;
}
BasinResponse asked_basin() {
  return {active_scene(0.9),      Restitution{},          {.steady = {.tolerance = 1e-6, .max_periods = 200}},
          {&Scene::x0, -1, 1, 5}, {&Scene::v0, -1, 1, 4}, {}};
}
BasinResponse asked_map() {
  BasinResponse map = asked_basin();
  map.scene.force_amplitude = 0;  // never: both axes change it
  map.first = {&Scene::force_amplitude, 0.02, 0.2, 3};
  map.second = {&Scene::force_frequency, 0.8, 1.2, 3};
  return map;
}
OrbitsResponse asked_orbits() {
  OrbitsResponse orbits{.scene = active_scene(0.9),
                        .engine = Restitution{},
                        .rule = {},
                        .range = {Parameter::force_amplitude, 0.05, 0.12},
                        .starts = {{{}, 0, {}, {6, 0, 0, 0}}},
                        .complete = true,
                        .branches = {}};
  orbits.scene.damper().mass_ratio = 0.02;
  orbits.scene.damping_ratio = 0.02;
  return orbits;
}
OrbitsResponse several_orbits() {
  OrbitsResponse orbits = asked_orbits();
  orbits.scene.damping_ratio = 0.05;
  orbits.scene.force_frequency = 0.9;
  orbits.scene.dampers = {{.mass_ratio = 0.06, .y0 = 0.4, .w0 = 0.2},
                          {.mass_ratio = 0.04, .clearance = 1.5, .y0 = 0.7}};
  orbits.range = {Parameter::force_frequency, 0.9, 1.1};
  orbits.starts = {{{}, 0, {}, release_of(orbits.scene)}};
  return orbits;
}
LyapunovResponse asked_exponents() { return {active_scene(0.9), Restitution{}, 40, 10, {}}; }

// With something else in it, and the digest that belongs to it.
std::string altered(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE_MESSAGE(at != std::string::npos, from);
  text.replace(at, from.size(), to);
  return sealed(text.substr(0, text.rfind(seal_begin)));
}
// The first number of the first column of that name replaced by what `change` makes of it.
std::string changed(const std::string& text, const std::string& column, double (*change)(double)) {
  const std::size_t at = text.find('"' + column + "\": [") + column.size() + 5;
  const std::size_t end = text.find_first_of(",]", at);
  const std::string whole =
      text.substr(0, at) + number_text(change(std::stod(text.substr(at, end - at)))) + text.substr(end);
  return sealed(whole.substr(0, whole.rfind(seal_begin)));
}

std::string first_of(const std::vector<Problem>& problems) {
  return problems.empty() ? "" : problems[0].field + ' ' + problems[0].message;
}
std::string complaint(const std::string& text) {
  try {
    return first_of(inconsistencies_of(parse_response("f", text)));
  } catch (const InputError& error) {
    return error.problems()[0];
  }
}
void says(const std::string& text, const std::string& wanted) {
  const std::string said = complaint(text);
  INFO(said);
  CHECK(said.find(wanted) != std::string::npos);
}
double one_more(double n) { return n + 1; }

// What is found for what is asked, its text, and what that reads back as.
template <class Kind>
struct WrittenAndRead {
  Kind found, read;
  std::string text;
  explicit WrittenAndRead(const Kind& asked)
      : found(std::get<Kind>(found_for(asked, 1))), read(found), text(response_text(found)) {
    read = std::get<Kind>(parse_response("f", text));
  }
};

TEST_CASE("a response of each kind reads back as it was written, byte by byte") {
  for (const Response& asked : {Response(asked_sweep()), Response(several_sweep()), Response(ended_sweep()),
                                Response(asked_basin()), Response(asked_map()), Response(asked_orbits()),
                                Response(several_orbits()), Response(asked_exponents())}) {
    const Response found = found_for(asked, 1);
    const std::string text = response_text(found);
    const Response read = parse_response("f", text);
    CHECK(response_text(read) == text);
    CHECK(kind_of(read) == kind_of(asked));
    CHECK(asked_of(read) == asked_of(asked));
    CHECK(complaint(text).empty());
  }
}

TEST_CASE("of several dampers each has its columns, whose sums are those of all") {
  const auto& [found, read, text] = WrittenAndRead(several_sweep());
  CHECK(read.scene.dampers == found.scene.dampers);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(read.sweeps[0].up[i].impacts_by_damper == found.sweeps[0].up[i].impacts_by_damper);
    CHECK(read.sweeps[0].up[i].state.dampers[1].y == found.sweeps[0].up[i].state.dampers[1].y);
  }
  says(changed(text, "impacts_left", one_more), "the sum over the dampers");
  says(altered(text, R"("dampers": [{"y": 0.5, "w": 0}, )", R"("dampers": [)"),
       "must be as many as in the scene, 2, got 1");
  says(altered(text, R"({"damping_ratio")", R"({"mass_ratio": 1, "damping_ratio")"),
       "must not be given beside dampers");
}

TEST_CASE("branches of several dampers tell state and impacts of each, whose sums are those of all") {
  const auto& [found, read, text] = WrittenAndRead(several_orbits());
  REQUIRE_FALSE(found.branches.empty());
  const OrbitBranch &a = found.branches[0], &b = read.branches[0];
  REQUIRE(a.points.size() == b.points.size());
  REQUIRE_FALSE(a.events.empty());
  CHECK(b.points[1].impacts == ImpactCounts{2, 2});
  CHECK(b.points[1].impacts_by_damper == std::vector<ImpactCounts>{{1, 1}, {1, 1}});
  CHECK(a.points[1].state.dampers[1].y == b.points[1].state.dampers[1].y);
  CHECK(a.points[1].multipliers[3].re == b.points[1].multipliers[3].re);
  CHECK(a.events[0].state.dampers[0].w == b.events[0].state.dampers[0].w);
  CHECK(a.points[1].state.x != 0);
  says(changed(text, "impacts_left", one_more),
       "/branches/0/impacts_left/0 must be 2, the sum over the dampers, got 3");
  says(altered(text, R"({"y": 0.4, "w": 0.2}, )", ""), "as many as in the scene, 2, got 1");
}

TEST_CASE("orbits with friction have the margin of their stops, which is that of a run from their state") {
  OrbitsResponse asked = asked_orbits();
  CHECK(response_text(found_for(asked, 1)).find("stop_margin") == std::string::npos);
  asked.scene = {.damping_ratio = 0.05,
                 .x0 = 1,
                 .force_amplitude = 0.25,
                 .force_frequency = 0.95,
                 .weight = 0.06,
                 .dampers = {{.mass_ratio = 0.1, .restitution = 0.5, .y0 = 0.3, .friction = 0.15}}};
  asked.range = {Parameter::force_frequency, 0.95, 0.96};
  asked.starts = {{{}, 0, {}, release_of(asked.scene)}};
  const WrittenAndRead orbits(asked);
  CHECK(response_text(orbits.read) == orbits.text);
  CHECK(complaint(orbits.text).empty());
  REQUIRE_FALSE(orbits.read.branches.empty());
  int stopped = 0;
  const std::vector<OrbitPoint>& points = orbits.read.branches[0].points;
  for (std::size_t p = 0; p < points.size(); p += 7) {
    const OrbitPoint& point = points[p];
    Scene scene = released_from(asked.scene, point.state);
    scene.force_frequency = point.value;
    scene.until_time = double(point.period) * 2 * std::numbers::pi / point.value;
    const Run run =
        simulate(scene, Restitution{}, {.half_cycles = false, .history = {{0, *scene.until_time, 200'001}}});
    const std::vector<double>&w = run.history->dampers[0].w, &time = run.history->time;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 2; n < w.size(); ++n)
      if (w[n - 1] != 0 && w[n] * w[n - 1] <= 0 && std::fabs(w[n - 1]) < 1e-3)
        least = std::min(least, std::fabs(w[n - 1] - w[n - 2]) / (time[n - 1] - time[n - 2]));
    REQUIRE(point.stop_margin.has_value() == std::isfinite(least));
    if (!point.stop_margin) continue;
    CHECK(*point.stop_margin == doctest::Approx(least).epsilon(1e-3));
    ++stopped;
  }
  CHECK(stopped > 3);
}

TEST_CASE("the impacts of an orbit are those of a run from its state") {
  const OrbitsResponse asked = asked_orbits();
  const auto found = std::get<OrbitsResponse>(found_for(asked, 1));
  int unequal = 0;
  for (const OrbitBranch& branch : found.branches) {
    const OrbitPoint& point = branch.points[branch.points.size() / 2];
    Scene scene = released_from(asked.scene, point.state);
    scene.force_amplitude = point.value;
    scene.until_time = double(point.period) * 2 * std::numbers::pi / scene.force_frequency;
    const Run run = simulate(scene, asked.engine, {.half_cycles = false, .impacts = true});
    CHECK(std::ranges::count(run.impacts->wall, Wall::left) == point.impacts[0]);
    CHECK(std::ranges::count(run.impacts->wall, Wall::right) == point.impacts[1]);
    unequal += point.impacts[0] != point.impacts[1];
  }
  CHECK(unequal > 0);
}

TEST_CASE("what is swept may be a number of one of several dampers") {
  SweepResponse asked = several_sweep();
  asked.axis = {{&SceneDamper::clearance, 1}, 0.5, 2, 4};
  const auto& [found, read, text] = WrittenAndRead(asked);
  CHECK(text.find(R"("number": "clearance_2")") != std::string::npos);
  CHECK(read.axis.number == asked.axis.number);
  CHECK(response_text(read) == text);
  for (const char* other : {"clearance_3", "mass_ratio"})
    says(altered(text, "clearance_2", other), "/axis/number: unknown");
}

TEST_CASE("a map of several dampers tells the impacts of each, whose sums are those of all") {
  BasinResponse asked = asked_basin();
  asked.scene.damping_ratio = 0.05;
  asked.scene.dampers = {{.mass_ratio = 0.06, .y0 = 0.5}, {.mass_ratio = 0.04, .clearance = 1.5, .y0 = 0.7}};
  asked.second = {{&SceneDamper::y0, 1}, 0, 1.5, 4};
  const auto& [found, read, text] = WrittenAndRead(asked);
  CHECK(response_text(read) == text);
  CHECK(read.second.number == asked.second.number);
  REQUIRE_FALSE(read.basin.attractors.empty());
  CHECK(read.basin.attractors[0].impacts_by_damper.size() == 2);
  CHECK(read.basin.attractors[0].states[0].dampers.size() == 2);
  const std::int64_t left = read.basin.attractors[0].impacts[0];
  const std::string impacts = R"("impacts_left": )";
  says(altered(text, impacts + std::to_string(left), impacts + std::to_string(left + 1)),
       "/dampers: must be hit as often as all");
}

TEST_CASE("what is read has the numbers that were found") {
  const WrittenAndRead sweep(asked_sweep());
  const SweepResponse &found = sweep.found, &read = sweep.read;
  REQUIRE(read.sweeps.size() == 2);
  CHECK(read.scene == found.scene);
  CHECK(read.engine == found.engine);
  CHECK(read.axis.number.is(&Scene::force_frequency));
  int periodic = 0, open = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const SteadyState &a = found.sweeps[1].down[i], &b = read.sweeps[1].down[i];
    CHECK(a.period == b.period);
    CHECK(a.transient_periods == b.transient_periods);
    CHECK(a.impacts == b.impacts);
    CHECK(a.symmetric == b.symmetric);
    CHECK(a.contraction == b.contraction);
    CHECK(a.measured_periods == b.measured_periods);
    REQUIRE(a.means);
    REQUIRE(b.means);
    CHECK(a.means->amplitude == b.means->amplitude);
    CHECK(a.means->lag_deg == b.means->lag_deg);
    CHECK(a.means->impact_power == b.means->impact_power);
    CHECK(a.power_scatter == b.power_scatter);
    CHECK(a.state.dampers[0].w == b.state.dampers[0].w);
    periodic += a.period.has_value();
    open += !a.period;
  }
  CHECK(periodic > 0);
  CHECK(open > 0);

  const WrittenAndRead ended(ended_sweep());
  CHECK(ended.read.sweeps[0].up[0].stop_reason == StopReason::impact_budget);
  CHECK(!ended.read.sweeps[0].up[0].means);

  const WrittenAndRead basin(asked_basin());
  CHECK(basin.read.basin.attractor == basin.found.basin.attractor);
  REQUIRE(!basin.found.basin.attractors.empty());
  CHECK(basin.read.basin.attractors[0].states[0].v == basin.found.basin.attractors[0].states[0].v);

  const WrittenAndRead orbits(asked_orbits());
  REQUIRE(orbits.found.branches.size() > 1);
  CHECK(orbits.read.range.parameter == Parameter::force_amplitude);
  const OrbitBranch &a = orbits.found.branches[1], &b = orbits.read.branches[1];
  CHECK(a.origin == b.origin);
  CHECK(a.event == b.event);
  CHECK(a.end == b.end);
  REQUIRE(a.points.size() == b.points.size());
  CHECK(a.points.back().value == b.points.back().value);
  CHECK(a.points.back().multipliers[3].im == b.points.back().multipliers[3].im);
  CHECK(a.points.back().nearest_miss == b.points.back().nearest_miss);
  CHECK(a.points.back().stable == b.points.back().stable);
  REQUIRE(!b.events.empty());
  CHECK(a.events[0].kind == b.events[0].kind);
  CHECK(a.events[0].value == b.events[0].value);
}

TEST_CASE("what is asked for differs in each part that is another") {
  const SweepResponse asked = asked_sweep();
  const auto differences = [&](const SweepResponse& other) {
    const auto a = asked_of(asked), b = asked_of(other);
    std::string found;
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i)
      if (i >= a.size() || i >= b.size() || a[i] != b[i]) found += (i < a.size() ? a : b)[i].first + ' ';
    return found;
  };
  CHECK(differences(asked).empty());
  struct Change {
    const char* fields;
    void (*make)(SweepResponse&);
  };
  for (const auto& [fields, make] :
       {Change{"/scene/restitution ", [](SweepResponse& other) { other.scene.damper().restitution = 0.7; }},
        {"/engine ", [](SweepResponse& other) { other.engine = Exact{}; }},
        {"/rule ", [](SweepResponse& other) { other.rule.mean_periods = 41; }},
        {"/axis ", [](SweepResponse& other) { other.axis.count = 5; }},
        {"/sweeps/1/start ", [](SweepResponse& other) { other.sweeps[1].start.dampers[0].w = 1; }},
        {"/sweeps/1/nudge ", [](SweepResponse& other) { other.sweeps[1].start.nudge = 2e-3; }},
        {"/sweeps/1/start /sweeps/1/nudge ", [](SweepResponse& other) { other.sweeps.pop_back(); }}}) {
    SweepResponse other = asked;
    make(other);
    CHECK(differences(other) == fields);
  }
  OrbitsResponse orbits = asked_orbits();
  orbits.range.to = 0.13;
  const auto a = asked_of(asked_orbits()), b = asked_of(orbits);
  for (std::size_t i = 0; i < a.size(); ++i) CHECK((a[i] == b[i]) == (a[i].first != "/range"));
}

TEST_CASE("an altered response is noticed by its digest, and then by what follows from the rest") {
  const std::string text = response_text(found_for(asked_sweep(), 1));
  std::string other = text;
  other.replace(other.find("\"x\": 1,"), 7, "\"x\": 2,");
  says(other, "/provenance/sha256: must be the digest");

  says(altered(text, "\"kind\": \"sweep\"", "\"kind\": \"swept\""), "/kind: must be one of");
  says(altered(text, "\"restitution\", \"acc", "\"cem\", \"acc"), "/engine");
  says(altered(text, "\"mass_ratio\": 0.1", "\"mass_ratio\": 0.2"), "/locked_amplitude/0: must be");
  says(altered(text, "\"damping_ratio\": 0.01", "\"damping_ratio\": 0.011"), "/empty_amplitude/0: must be");
  says(altered(text, "\"mean_periods\": 40", "\"mean_periods\": 41"), "measured_periods");
  says(altered(text, "\"count\": 4", "\"count\": 5"), "/values: must hold 5 numbers, got 4");
  says(altered(text, "\"longest_period\": 16", "\"longest_period\": 0"), "/rule/longest_period: must be");
  says(altered(text, "\"transient_periods\": [", "\"transient_periods\": [1,"),
       "must be as long as the first");
  says(altered(text, "\"amplitude\": [", "\"amplitude\": [null,"), "must be as long as the first");
  says(altered(text, "\"down\": {", "\"don\": {"), "/sweeps/0/down: missing");
  says(altered(text, "\"end\": [\"", "\"end\": [\"quasi"), "/sweeps/0/up/end/0: must be one of");

  const auto percent = [](double value) { return value * 1.01; };
  for (const char* column : {"power", "fundamental", "lag_deg"})
    says(changed(text, column, percent), "/sweeps/0/up/power/0");
  says(changed(text, "measured_periods", one_more), "measured_periods/0");
  says(changed(text, "symmetric", [](double) { return 0.5; }), "must be a whole number");
  says(changed(text, "transient_periods", [](double) { return 301.0; }), "must be <= max_periods");
  says(changed(text, "viscous_power", [](double value) { return -value; }), "viscous_power/0");
  says(altered(text, "not_periodic", "periodic"), "must be a number, got null");
}

TEST_CASE("the powers of a periodic motion balance, and no other may scatter") {
  auto response = std::get<SweepResponse>(found_for(asked_sweep(), 1));
  SteadyState* periodic = nullptr;
  for (SteadyState& each : response.sweeps[0].up)
    if (each.period) periodic = &each;
  REQUIRE(periodic);
  const SteadyState before = *periodic;
  const auto said = [&] {
    const std::string first = first_of(inconsistencies_of(response));
    *periodic = before;
    return first;
  };
  CHECK(said().empty());
  periodic->means->impact_power *= 1.01;
  CHECK(said().find("what damper and impacts take out") != std::string::npos);
  periodic->amplitude_scatter = 1e-9;
  CHECK(said().find("amplitude_scatter") != std::string::npos);
  periodic->means->amplitude = std::abs(before.state.x) * 0.99;
  CHECK(said().find("must not exceed the amplitude") != std::string::npos);
  periodic->symmetric = true;
  periodic->impacts[0] = periodic->impacts_by_damper[0][0] = before.impacts[1] + 1;
  CHECK(said().find("/symmetric") != std::string::npos);
  periodic->period.reset();
  periodic->measured_periods = response.rule.mean_periods;
  CHECK(said().find("/contraction") != std::string::npos);
}

TEST_CASE("counts of a map and the points of orbits agree with the rest") {
  const Response map = found_for(asked_basin(), 1);
  const std::string text = response_text(map);
  const auto& attractors = std::get<BasinResponse>(map).basin.attractors;
  REQUIRE(attractors.size() >= 2);
  const std::string points = "\"points\": " + std::to_string(attractors[0].points);
  says(altered(text, points, points + "0"), "/attractors/0/points: must be");
  says(altered(text, "\"undecided\": ", "\"undecided\": 1"), "/undecided: must be");
  says(altered(text, "\"attractor\": [", "\"attractor\": [99,"), "/attractor/0: must be a whole number");
  says(altered(text, "\"attractor\": [", "\"attractor\": [0,"), "/attractor: must hold 20 points");
  says(altered(text, "\"idle\": false", "\"idle\": true"), "/attractors/0/idle");

  const std::string orbits = response_text(found_for(asked_orbits(), 1));
  says(changed(orbits, "stable", [](double value) { return 1 - value; }), "/branches/0/stable/0");
  says(changed(orbits, "multiplier_1_re", [](double) { return 0.0; }), "/branches/0/");
  says(changed(orbits, "amplitude", [](double value) { return value / 100; }), "/branches/0/x/0");
  says(changed(orbits, "impacts_left", one_more), "/branches/0/symmetric/0");
  says(altered(orbits, "\"branch\": 0", "\"branch\": 99"), "/starts/0/branch");
  says(altered(orbits, "\"event\": 0", "\"event\": 99"), "/event must be the index");

  const std::string exponents = response_text(found_for(asked_exponents(), 1));
  says(altered(exponents, "\"stop_reason\": \"time\"", "\"stop_reason\": \"step_budget\""), "/exponents");
  says(altered(exponents, "\"standard_errors\": [", "\"standard_errors\": [1,"), "/standard_errors");
}

}  // namespace
