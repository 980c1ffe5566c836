// The measures that read responses, on responses and a decay made by hand, so that each number can be worked
// out on paper.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "application/reproduction/measures.hpp"
#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

constexpr double pi = std::numbers::pi;

// A = a0 - a1 t + a2 t^2 at the peaks t = i pi, to which a parabola is fitted exactly. A eta = -2 A' falls
// with the amplitude: A'^2 = a1^2 - 4 a2 (a0 - A).
constexpr double a0 = 4, a1 = 0.009, a2 = 4e-6;
constexpr int rows = 160;
constexpr double nu = 0.2;
double amplitude_at(double i) { return a0 - a1 * i * pi + a2 * i * i * pi * pi; }
double needed_at(double i) { return std::sqrt(1 + nu) * 2 * (a1 - 2 * a2 * i * pi); }
double predicted(double force) {
  const double slope = force / (2 * std::sqrt(1 + nu));
  return a0 - (a1 * a1 - slope * slope) / (4 * a2);
}
Run decay() {
  Scene scene{.until_time = 0.1};
  Run run = simulate(scene, Exact{}, Record{});
  run.scene.damper().mass_ratio = nu;
  HalfCycles& half_cycles = run.half_cycles.emplace();
  for (int i = 0; i < rows; ++i) {
    half_cycles.zero_crossing.push_back((i + 0.5) * pi);
    half_cycles.peak_time.push_back(i * pi);
    half_cycles.amplitude.push_back(amplitude_at(i));
    half_cycles.impacts.push_back(0);
  }
  return run;
}
// Points of the loss curve are at i = 6 to rows - 6, row 5 being left out.
constexpr int first_point = 6, last_point = rows - 6;

SteadyState steady(double amplitude, double scatter = 0) {
  SteadyState state;
  state.means = SteadyMeans{.amplitude = amplitude};
  state.amplitude_scatter = scatter;
  return state;
}
std::vector<SteadyState> with_amplitudes(const std::vector<double>& amplitudes) {
  std::vector<SteadyState> states;
  for (const double amplitude : amplitudes) states.push_back(steady(amplitude));
  return states;
}
SweepResponse over_force(double from, double to, const std::vector<double>& up,
                         const std::vector<double>& down) {
  SweepResponse response;
  response.axis = {&Scene::force_amplitude, from, to, static_cast<std::int64_t>(up.size())};
  response.sweeps.push_back({.up = with_amplitudes(up), .down = with_amplitudes(down)});
  return response;
}

Spread spread(const std::string& name, const std::map<std::string, double>& numbers,
              const std::vector<Response>& responses, bool of_decay = true) {
  Runs runs(std::nullopt, {.members = 1});
  runs.put("decay", decay());
  MeasureCall call;
  call.name = name;
  if (of_decay) call.scenes = {"decay"};
  call.numbers = numbers;
  for (const Response& response : responses) {
    call.responses.push_back("response" + std::to_string(call.responses.size()));
    runs.put(call.responses.back(), response);
  }
  return measure(runs, call);
}
double measured(const std::string& name, const std::map<std::string, double>& numbers,
                const std::vector<Response>& responses, bool of_decay = true) {
  const Spread found = spread(name, numbers, responses, of_decay);
  // Of one decay there is no spread.
  CHECK((found.low == found.median || std::isnan(found.median)));
  CHECK((found.high == found.median || std::isnan(found.median)));
  return found.median;
}
double share(const std::string& name, const std::vector<Response>& responses) {
  return measured(name, {}, responses, false);
}

const std::map<std::string, double> everything{{"from", 0.1}, {"to", 10}};

// Linear between points whose second difference is 2 a2 pi^2: the amplitude is good to a quarter of that.
constexpr double between_points = a2 * pi * pi / 2;

}  // namespace

TEST_CASE("the largest steady amplitude is held against the one that the decay predicts") {
  // The middle three forces have a prediction; one is below all that the decay needs, one above.
  const double least = needed_at(last_point), most = needed_at(first_point);
  const double from = least - 0.002, to = most + 0.002, step = (to - from) / 4;
  const double f1 = from + step, f2 = from + 2 * step, f3 = from + 3 * step;
  REQUIRE(f1 > least);
  REQUIRE(f3 < most);
  const double p1 = predicted(f1), p2 = predicted(f2), p3 = predicted(f3);
  // The largest of both responses counts, whichever it is in.
  const SweepResponse one = over_force(from, to, {9, 0.8 * p1, 1.04 * p2, 0.1, 9},
                                       {9, 1.1 * p1, 0.2, 0.98 * p3, 9}),
                      other = over_force(from, to, {9, 0.7 * p1, 0.3, 0.9 * p3, 9},
                                         {9, 0.9 * p1, 1.06 * p2, 0.2, 9});
  const auto of = [&](const std::string& name) { return measured(name, everything, {one, other}); };
  const double error = 100 * between_points / p1;
  CHECK(std::abs(of("steady_amplitude_falling_percent") - (10 + 6 + 2) / 3.0) < error);
  CHECK(std::abs(of("steady_amplitude_falling_worst_percent") - 10) < error);
  CHECK(std::abs(of("steady_amplitude_rising_percent") - (20 + 4 + 10) / 3.0) < error);
  CHECK(std::abs(of("steady_amplitude_rising_worst_percent") - 20) < error);

  // Only predicted amplitudes within the range count.
  const double above_p1 = (p1 + p2) / 2, below_p3 = (p2 + p3) / 2;
  CHECK(
      std::abs(measured("steady_amplitude_falling_percent", {{"from", above_p1}, {"to", 10}}, {one, other}) -
               (6 + 2) / 2.0) < error);
  CHECK(
      std::abs(measured("steady_amplitude_rising_percent", {{"from", 0.1}, {"to", below_p3}}, {one, other}) -
               (20 + 4) / 2.0) < error);
}

TEST_CASE(
    "where the force that is needed has no single amplitude, the one nearest below its largest counts") {
  // A decay that loses twice as much at its end as before needs the same forces there once more.
  Runs runs(std::nullopt, {.members = 1});
  Run run = decay();
  const double end = rows * pi, slope = a1 - 2 * a2 * end;
  for (int i = 0; i < 60; ++i) {
    run.half_cycles->zero_crossing.push_back(end + (i + 0.5) * pi);
    run.half_cycles->peak_time.push_back(end + i * pi);
    run.half_cycles->amplitude.push_back(amplitude_at(rows) - 1.5 * slope * i * pi);
    run.half_cycles->impacts.push_back(0);
  }
  runs.put("decay", run);
  const double force = 1.2 * needed_at(last_point), p = predicted(force);
  REQUIRE(p > amplitude_at(rows));
  runs.put("response", Response(over_force(force, 2 * force, {p, 1}, {1.05 * p, 1})));
  MeasureCall call;
  call.name = "steady_amplitude_falling_worst_percent";
  call.scenes = {"decay"};
  call.responses = {"response"};
  call.numbers = everything;
  REQUIRE(2 * force > needed_at(first_point));
  CHECK(std::abs(measure(runs, call).median - 5) < 100 * between_points / p);
}

TEST_CASE("the force beyond the largest that the decay needs is found between two forces of a rising sweep") {
  const double top = amplitude_at(first_point), needed = needed_at(first_point);
  // 0.02 and 0.03: a third of the way from below to above.
  const SweepResponse rises = over_force(0.01, 0.04, {0.5, top - 0.1, top + 0.2, 9}, {9, 9, 9, 9});
  CHECK(measured("force_limit_ratio", everything, {rises}) == doctest::Approx((0.02 + 0.01 / 3) / needed));
  // The range moves the top: to row 50.
  const double middle = amplitude_at(50);
  const SweepResponse lower = over_force(0.01, 0.04, {0.5, middle - 0.1, middle + 0.1, 9}, {9, 9, 9, 9});
  CHECK(measured("force_limit_ratio", {{"from", 0.1}, {"to", middle + 1e-9}}, {lower}) ==
        doctest::Approx(0.025 / needed_at(50)));
  // Never exceeded, or already at the first force.
  CHECK(std::isnan(measured("force_limit_ratio", everything, {over_force(0.01, 0.02, {1, 2}, {9, 9})})));
  CHECK(std::isnan(measured("force_limit_ratio", everything, {over_force(0.01, 0.02, {8, 9}, {1, 1})})));
}

TEST_CASE("the jump is between the forces of a falling sweep where the amplitude falls below 0.5") {
  const double from = 0.5 * (amplitude_at(99) + amplitude_at(100)), least = needed_at(99);
  const std::map<std::string, double> range{{"from", from}, {"to", 10}};
  // Held at 0.04 and 0.05; not at 0.03; what is at 0.02 lies below the jump.
  const SweepResponse falls = over_force(0.01, 0.05, {0, 0, 0, 0, 0}, {0, 1, 0.45, 0.5, 3});
  CHECK(measured("force_jump_ratio", range, {falls}) == doctest::Approx(0.035 / least));
  CHECK(std::isnan(measured("force_jump_ratio", range, {over_force(0.01, 0.02, {0, 0}, {3, 3})})));
  CHECK(std::isnan(measured("force_jump_ratio", range, {over_force(0.01, 0.02, {3, 3}, {3, 0.1})})));
}

TEST_CASE(
    "a state that was not reached has no amplitude, and responses of other kinds or forces are rejected") {
  const double force = needed_at(80), p = predicted(force);
  SweepResponse sweep = over_force(force, 2 * force, {p, p}, {p, p});
  CHECK(measured("steady_amplitude_falling_percent", everything, {sweep}) < 1);
  SweepResponse ended = sweep;
  ended.sweeps[0].down[0].means.reset();
  CHECK(std::isnan(measured("steady_amplitude_falling_percent", everything, {ended, sweep})));
  CHECK(std::isnan(measured("steady_amplitude_falling_percent", everything, {sweep, ended})));
  CHECK(std::isnan(share("one_motion_share", {ended})));
  SweepResponse frequencies = sweep;
  frequencies.axis.number = &Scene::force_frequency;
  CHECK_THROWS_AS(measured("force_limit_ratio", everything, {frequencies}), std::invalid_argument);
  CHECK_THROWS_AS(
      measured("force_limit_ratio", everything, {sweep, over_force(force, 3 * force, {p, p}, {p, p})}),
      std::invalid_argument);
  CHECK_THROWS_AS(share("one_motion_share", {BasinResponse{}}), std::invalid_argument);
  CHECK_THROWS_AS(share("two_impact_share", {sweep}), std::invalid_argument);
}

TEST_CASE("sweeps from other starts are an ensemble, whose median counts") {
  const double force = needed_at(80), p = predicted(force), error = 100 * between_points / p;
  REQUIRE(2 * force > needed_at(first_point));  // without a prediction
  const auto sweeps = [&](const std::vector<double>& amplitudes) {
    SweepResponse all = over_force(force, 2 * force, {p, 9}, {p, 9});
    all.sweeps.clear();
    for (const double amplitude : amplitudes)
      all.sweeps.push_back(
          {.up = with_amplitudes({amplitude * p, 9}), .down = with_amplitudes({(amplitude + 0.1) * p, 9})});
    return all;
  };
  // Of both responses the larger counts, start by start: 1.3, 1.1, 1.2; force falling 1.4, 1.2, 1.3.
  const SweepResponse one = sweeps({1.3, 0.5, 1.2}), other = sweeps({0.4, 1.1, 0.3});
  const auto is = [&](const std::string& name, double low, double median, double high) {
    const Spread found = spread(name, everything, {one, other});
    CHECK(std::abs(found.low - low) < error);
    CHECK(std::abs(found.median - median) < error);
    CHECK(std::abs(found.high - high) < error);
  };
  is("steady_amplitude_rising_percent", 10, 20, 30);
  is("steady_amplitude_falling_worst_percent", 20, 30, 40);
  CHECK_THROWS_AS(spread("steady_amplitude_rising_percent", everything, {one, sweeps({1, 1})}),
                  std::invalid_argument);

  const SweepResponse same = over_force(1, 2, {1, 1}, {1, 1});
  SweepResponse both = same;
  both.sweeps.push_back({.up = with_amplitudes({1, 1}), .down = with_amplitudes({1, 2})});
  const Spread share_of_both = spread("one_motion_share", {}, {both, both}, false);
  CHECK(share_of_both.low == doctest::Approx(0.5));
  CHECK(share_of_both.median == doctest::Approx(0.75));
  CHECK(share_of_both.high == doctest::Approx(1));
  CHECK_THROWS_AS(spread("one_motion_share", {}, {both, same}, false), std::invalid_argument);
}

TEST_CASE("two ways arrive at one motion if they differ by 5 percent or three standard deviations at most") {
  SweepResponse sweep = over_force(1, 5, {1, 1, 1, 1, 1}, {1.04, 1.06, 0.94, 1.2, 1.2});
  CHECK(share("one_motion_share", {sweep}) == doctest::Approx(1 / 5.0));
  // 3 sqrt(0.03^2 + 0.06^2) = 0.2012
  sweep.sweeps[0].up[3].amplitude_scatter = sweep.sweeps[0].up[4].amplitude_scatter = 0.03;
  sweep.sweeps[0].down[3].amplitude_scatter = 0.06;
  sweep.sweeps[0].down[4].amplitude_scatter = 0.059;
  CHECK(share("one_motion_share", {sweep}) == doctest::Approx(2 / 5.0));
  CHECK(share("one_motion_share", {sweep, over_force(1, 2, {1, 1}, {1, 2})}) == doctest::Approx(3 / 7.0));
}

TEST_CASE("points of a map with one impact on each wall in a period are counted, equally spaced or not") {
  BasinResponse map;
  map.basin.attractors = {{.period = 1, .impacts = {1, 1}, .symmetric = true, .points = 5},
                          {.period = 1, .impacts = {1, 1}, .symmetric = false, .points = 2},
                          {.period = 1, .impacts = {2, 2}, .symmetric = true, .points = 1},
                          {.period = 3, .impacts = {1, 1}, .symmetric = true, .points = 1},
                          {.period = 1, .impacts = {1, 0}, .symmetric = false, .points = 1},
                          {.period = 1, .impacts = {1, 1}, .symmetric = true, .points = 3},
                          {.idle = true, .symmetric = true, .points = 4}};
  map.basin.attractor.assign(20, undecided);
  CHECK(share("two_impact_share", {map}) == doctest::Approx(8 / 20.0));
  CHECK(share("equally_spaced_share", {map}) == doctest::Approx(8 / 10.0));
}

TEST_CASE("two impacts in a period are held against the power of the closed form") {
  // Undamped, M13.18.
  SweepResponse sweep;
  sweep.scene.damper().mass_ratio = 0.1;
  sweep.scene.damper().restitution = 0.5;
  sweep.scene.force_amplitude = 0.08;
  sweep.axis = {&Scene::force_frequency, 0.9, 1, 3};
  const auto powers = [](double omega) {
    const double m = 0.1, e = 0.5, b = (1 - e) / (1 + e), c = 0.08 / (1 - omega * omega);
    const double a = pi / omega + 2 * m * std::tan(pi / (2 * omega)), q = b * (1 + m) / omega;
    const double square = a * a + 4 * q * q, root = std::sqrt(a * a - square * (1 - 4 * c * c));
    std::vector<double> found;
    for (const double v : {(a + root) / square, (a - root) / square}) {
      if (v < 0) continue;
      const double w = v * (1 + b) * (1 + m);
      found.push_back(omega / (2 * pi) * m / (1 + m) * (1 - e * e) * w * w);
    }
    return found;
  };
  const auto two_impacts = [](double power) {
    SteadyState state = steady(1);
    state.period = 1;
    state.impacts = {1, 1};
    state.symmetric = true;
    state.means->impact_power = power;
    return state;
  };
  SteadyState unequal = two_impacts(7), more = two_impacts(7), longer = two_impacts(7), open = two_impacts(7);
  unequal.symmetric = false;
  more.impacts = {2, 2};
  longer.period = 3;
  open.period.reset();
  REQUIRE(powers(0.9).size() == 2);
  const double at_090 = powers(0.9)[0], at_095 = powers(0.95)[0], slow_at_090 = powers(0.9)[1];
  // At 1 there is no closed form.
  sweep.sweeps = {{.up = {two_impacts(1.01 * at_090), two_impacts(0.96 * at_095), two_impacts(7)},
                   .down = {two_impacts(slow_at_090), unequal, two_impacts(7)}},
                  {.up = {more, longer, open}, .down = {open, open, open}}};
  CHECK(share("two_impact_error", {sweep}) == doctest::Approx(0.04));
  sweep.sweeps[0].down[0] = two_impacts(1.05 * slow_at_090);
  CHECK(share("two_impact_error", {sweep}) == doctest::Approx(0.05));
  sweep.sweeps.erase(sweep.sweeps.begin());
  CHECK(std::isnan(share("two_impact_error", {sweep})));
}
