#include "impact_damper/engines/restitution.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "same_run.hpp"

using namespace impact_damper;
using reference::everything;

namespace {

constexpr double pi_d = std::numbers::pi;

const std::vector<Scene> many_scenes{
    {.until_time = 60},
    {.until_time = 60, .dampers = {{.mass_ratio = 0.5}}},
    {.x0 = 0.3, .until_time = 60},
    {.x0 = 1e6, .until_time = 60},
    {.damping_ratio = 0.08, .until_time = 60},
    {.damping_ratio = 5, .v0 = 40, .until_time = 60},
    {.until_time = 60, .dampers = {{.restitution = 0}}},
    {.until_time = 60, .dampers = {{.restitution = 0.95}}},
    {.x0 = 0, .force_amplitude = 0.4, .force_frequency = 0.9, .until_time = 60},
    {.damping_ratio = 0.02, .x0 = 0.3, .force_amplitude = 0.2, .until_time = 60},
    {.damping_ratio = 5, .force_amplitude = 3, .force_frequency = 2.5, .until_time = 60},
    {.x0 = -4, .until_time = 60},
    {.x0 = 4, .until_time = 60, .dampers = {{.y0 = 1}}},
    {.x0 = 10, .until_time = 60, .dampers = {{.mass_ratio = 20}}}};

}  // namespace

TEST_CASE(
    "an impact keeps the momentum, turns the relative velocity into -e times it and loses the stated "
    "energy") {
  for (double nu : {1e-6, 0.02, 1.0, 40.0})
    for (double e : {0.0, 0.3, 0.6, 1.0}) {
      const Scene scene{.x0 = 0,
                        .until_time = 0.5 + 1e-9,
                        .dampers = {{.mass_ratio = nu, .restitution = e, .y0 = 0.5, .w0 = 1}}};
      // The primary mass rests until the impact at t = 0.5.
      const Run run = simulate(scene, Restitution{}, everything({{0.4, 0.5 + 1e-9, 2}}));
      REQUIRE(run.impacts->time.size() == 1);
      CHECK(run.impacts->time[0] == doctest::Approx(0.5).epsilon(1e-15));
      CHECK(run.impacts->relative_velocity[0] == 1);
      const double v = run.history->v[1], w = run.history->dampers[0].w[1];
      CHECK(w == doctest::Approx(-e).epsilon(1e-8));
      CHECK((1 + nu) * v + nu * w == doctest::Approx(nu).epsilon(1e-8));
      CHECK(run.energy->impact_loss[0] == doctest::Approx(nu * (1 - e * e) / (2 * (1 + nu))).epsilon(1e-15));
      CHECK(std::abs(run.energy->residual) < 1e-15);
    }
}

TEST_CASE("bouncing to rest ends after 2 w / (a (1 - e)) under a constant relative acceleration") {
  for (double e : {0.0, 0.2, 0.6, 0.9}) {
    // x stays near -1e4 for the short while that the bouncing takes: y'' = x, a = 1e4.
    const double a = 1e4, w = 0.3;
    const Scene scene{
        .x0 = -a, .until_time = 0.01, .dampers = {{.mass_ratio = 1e-9, .restitution = e, .w0 = w}}};
    const Run run = simulate(scene, Restitution{}, everything());
    const double end = 2 * w / (a * (1 - e));
    REQUIRE(run.contacts->begin.size() == 1);
    CAPTURE(e);
    // a changes by t^2/2 of itself, at most.
    CHECK(run.contacts->begin[0] == doctest::Approx(end).epsilon(end * end + 1e-12));
    // The bounces, one by one: each lasts e times the one before.
    double time = 2 * w / a;
    for (std::size_t i = 0; i < std::min<std::size_t>(run.impacts->time.size(), 6); ++i) {
      CHECK(run.impacts->time[i] == doctest::Approx(time).epsilon(end * end + 1e-12));
      time += 2 * w / a * std::pow(e, double(i + 1));
    }
    const EnergyBalance& balance = *run.energy;
    const double lost =
        std::accumulate(balance.impact_loss.begin(), balance.impact_loss.end(), balance.bounce_down_loss);
    CHECK(lost == doctest::Approx(1e-9 * w * w / 2 / (1 + 1e-9)).epsilon(1e-6));
    CHECK(balance.bounce_downs == (e > 0 ? 1 : 0));
  }
}

TEST_CASE("where x'' varies the bounces accumulate where a sum of stepped bounces does") {
  // nu -> 0: x = x0 cos(t), y'' = x. Each bounce by Newton's method in extended precision, its displacement
  // written without cancellation.
  const double e = 0.5, x0 = -3, w0 = 0.8;
  const auto sine_less_argument = [](long double s) {
    const long double q = s * s;
    if (s > 0.2L) return std::sin(s) - s;
    return -s * q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110 * (1 - q / 156)))));
  };
  long double time = 0, speed = w0;
  for (int n = 0; n < 100; ++n) {
    const long double sin = std::sin(time), cos = std::cos(time);
    const auto rise = [&](long double s) {  // y' - speed
      return x0 * (cos * std::sin(s) - 2 * sin * std::pow(std::sin(s / 2), 2));
    };
    const auto y = [&](long double s) {
      return speed * s + x0 * (2 * cos * std::pow(std::sin(s / 2), 2) + sin * sine_less_argument(s));
    };
    long double s = -2 * speed / (x0 * cos);
    for (int i = 0; i < 30; ++i) s -= y(s) / (speed + rise(s));
    speed = -e * (speed + rise(s));
    time += s;
  }
  // Set out from the wall, or thrown off it where x'' is at its extremum: there its rate of change, which is
  // zero, tells nothing of how it will have changed before the bounces accumulate.
  for (const double velocity : {w0, -w0 / e}) {
    CAPTURE(velocity);
    const auto accumulation = [&](double mass_ratio) {
      const Scene scene{.x0 = x0,
                        .until_time = 1.4,
                        .dampers = {{.mass_ratio = mass_ratio, .restitution = e, .w0 = velocity}}};
      const Run run = simulate(scene, Restitution{}, everything());
      REQUIRE(run.contacts->begin.size() == 1);
      return run.contacts->begin[0];
    };
    // What is linear in nu is taken out; its square is 1e-18.
    CHECK(2 * accumulation(1e-9) - accumulation(2e-9) == doctest::Approx(double(time)).epsilon(1e-12));
  }
}

TEST_CASE(
    "the secondary mass is released where x = 0, or where the joined masses' x'' = 0 if damped and forced") {
  for (const Scene& scene : many_scenes) {
    const Run run = simulate(scene, Restitution{}, everything());
    if (scene.damping_ratio == 0 && scene.force_amplitude == 0) {
      for (double end : run.contacts->end) {
        if (end == run.end_time) continue;
        double nearest = 1e9;
        for (double zero : run.half_cycles->zero_crossing) nearest = std::min(nearest, std::abs(zero - end));
        CHECK(nearest < 1e-12);
      }
      continue;
    }
    for (std::size_t i = 0; i < std::min<std::size_t>(5, run.contacts->end.size()); ++i) {
      const double begin = run.contacts->begin[i], end = run.contacts->end[i];
      if (end == run.end_time || end - begin < 1e-3) continue;
      const Run seen = simulate(scene, Restitution{}, everything({{begin, end, 3}}));
      const double f = scene.force_amplitude * std::sin(scene.force_frequency * end);
      const double x = seen.history->x[2], v = seen.history->v[2];
      const double size = std::abs(x) + 2 * scene.damping_ratio * std::abs(v) + std::abs(f);
      CHECK(std::abs(f - 2 * scene.damping_ratio * v - x) < 1e-12 * (1 + size));
      CHECK(seen.history->dampers[0].w[1] == 0);
      CHECK((seen.history->dampers[0].y[1] == 0 || seen.history->dampers[0].y[1] == 1));
    }
  }
}

TEST_CASE("nothing jumps where a stuck mass is released") {
  int released = 0;
  for (const Scene& scene : many_scenes) {
    const Run run = simulate(scene, Restitution{}, everything());
    for (std::size_t i = 0; i < std::min<std::size_t>(5, run.contacts->end.size()); ++i) {
      const double begin = run.contacts->begin[i], end = run.contacts->end[i], h = 1e-6;
      if (end + h >= run.end_time || end - begin < 1e-3) continue;
      const History seen =
          *simulate(scene, Restitution{}, everything({{end - h, end, 2}, {end + h, end + 2 * h, 2}})).history;
      ++released;
      // From before to after along the tangent, but for h^2 times the acceleration, which the motion's size
      // bounds.
      const double size = std::abs(seen.x[0]) + (1 + 2 * scene.damping_ratio) * std::abs(seen.v[0]) +
                          std::abs(scene.force_amplitude);
      CHECK(std::abs(seen.x[2] - seen.x[0] - 2 * h * seen.v[0]) <= 4 * h * h * size + 1e-14);
      CHECK(std::abs(seen.v[2] - seen.v[0]) <= 4 * h * size);
      CHECK(std::abs(seen.dampers[0].y[2] - seen.dampers[0].y[0]) <= 4 * h * h * size);
    }
  }
  CHECK(released > 10);
}

TEST_CASE("0 <= y <= 1 always, energy never rises unforced, and the energy balance closes") {
  for (const Scene& scene : many_scenes) {
    CAPTURE(scene_text(scene));
    const Run run = simulate(scene, Restitution{}, everything({{0, 60, 6001}}));
    CHECK(std::abs(run.energy->residual) < 1e-12);
    const System<double> system(scene);
    double before = run.energy->initial.total();
    // y is the difference of displacements of the size of x.
    const double rounding = 1e-14 * (1 + std::abs(scene.x0));
    for (std::size_t i = 0; i < run.history->time.size(); ++i) {
      const History& h = *run.history;
      const double y = h.dampers[0].y[i], w = h.dampers[0].w[i];
      CHECK(y >= -rounding);
      CHECK(y <= 1 + rounding);
      const double now = energy_of<double>(system, {h.x[i], h.v[i], y, w}, 0.0).total();
      if (scene.force_amplitude == 0) CHECK(now <= before * (1 + 1e-13));
      before = now;
    }
  }
}

TEST_CASE("bounce-down that ends stuck costs w^2 / (pi A^2) per radian and mass ratio, exactly if e = 0") {
  // t* with A (t* - sin t*) = 1, w = A (1 - cos t*): physics of the limit nu -> 0.
  for (double amplitude : {1.0, 7.5, 100.0}) {
    const double nu = 1e-7;
    const Scene scene{.x0 = amplitude, .until_time = 30, .dampers = {{.mass_ratio = nu, .restitution = 0}}};
    const Run run = simulate(scene, Restitution{}, everything());
    double low = 0, high = pi_d;
    for (int i = 0; i < 100; ++i) {
      const double t = (low + high) / 2;
      (amplitude * (t - std::sin(t)) < 1 ? low : high) = t;
    }
    const double w = amplitude * (1 - std::cos(low));
    const std::vector<std::int64_t>& impacts = run.half_cycles->impacts;
    for (std::size_t n = 3; n < impacts.size(); ++n) CHECK(impacts[n] == 1);
    for (std::size_t i = 4; i < run.impacts->time.size(); ++i) {
      CHECK(std::abs(run.impacts->relative_velocity[i]) == doctest::Approx(w).epsilon(1e-5));
      CHECK(run.energy->impact_loss[i] == doctest::Approx(nu * w * w / 2).epsilon(1e-5));
    }
  }
}

TEST_CASE("e = 1 conserves energy through a hundred thousand impacts") {
  const Scene scene{.x0 = 2, .until_time = 1e7, .dampers = {{.mass_ratio = 0.3, .restitution = 1}}};
  const Restitution options{.budget = {.max_impacts = 100000}};
  const Run run = simulate(scene, options, everything());
  CHECK(run.stop_reason == StopReason::impact_budget);
  CHECK(run.impacts->time.size() == 100000);
  const double before = run.energy->initial.total();
  // A random walk of 1e5 steps, a few roundings each: 300 of them.
  CHECK(std::abs(run.energy->final.total() - before) < 1e-12 * before);
}

TEST_CASE("the accumulation tolerance does not show in the motion") {
  std::vector<Run> runs;
  for (double tolerance : {1e-6, 1e-8, 1e-10}) {
    const Restitution options{.accumulation_tolerance = tolerance};
    runs.push_back(simulate({.x0 = 8, .until_time = 80}, options, everything()));
  }
  for (const Run& run : runs) {
    REQUIRE(run.half_cycles->amplitude.size() == runs[0].half_cycles->amplitude.size());
    for (std::size_t n = 0; n < run.half_cycles->amplitude.size(); ++n) {
      // The displacement that a jump ignores, nu w^2 / 2a with w of order tolerance a^2, is 1e-13 at most.
      CHECK(std::abs(run.half_cycles->amplitude[n] - runs[2].half_cycles->amplitude[n]) < 1e-12);
    }
  }
  CHECK(runs[0].impacts->time.size() < runs[2].impacts->time.size());
  CHECK(runs[0].energy->bounce_downs == runs[2].energy->bounce_downs);
}

TEST_CASE("the forced solution with two symmetric impacts per cycle holds for ten thousand cycles") {
  // x = C sin(omega t + tau) - nu V sin(t - T/2)/cos(T/2), t since the departure from the left wall, T =
  // pi/omega.
  const double nu = 0.05, e = 0.6, omega = 1.05, f0 = 0.03;  // stable: largest multiplier 0.96
  const double big_c = f0 / (1 - omega * omega), period = pi_d / omega, b = (1 - e) / (1 + e);
  const double a = period + 2 * nu * std::tan(period / 2), q = b * (1 + nu) / omega;
  const double speed =
      (a + std::sqrt(a * a - (a * a + 4 * q * q) * (1 - 4 * big_c * big_c))) / (a * a + 4 * q * q);
  const double tau = std::atan2((1 - a * speed) / (2 * big_c), q * speed / big_c);
  const auto x = [&](double t) {
    return big_c * std::sin(omega * t + tau) - nu * speed * std::sin(t - period / 2) / std::cos(period / 2);
  };
  const auto v = [&](double t) {
    return big_c * omega * std::cos(omega * t + tau) -
           nu * speed * std::cos(t - period / 2) / std::cos(period / 2);
  };
  // The scene's force has phase zero at its time 0; so it starts in the flight in which that happens.
  double since = -tau / omega;
  double side = 1;
  while (since < 0) since += period, side = -side;
  while (since >= period) since -= period, side = -side;
  Scene scene{.x0 = x(since),
              .v0 = v(since),
              .force_amplitude = side * f0,
              .force_frequency = omega,
              .dampers = {{.mass_ratio = nu, .restitution = e}}};
  scene.damper().y0 = x(0) + speed * since - scene.x0;
  scene.damper().w0 = speed - scene.v0;
  scene.until_time = 1e4 * 2 * period;
  for (int i = 1; i < 1000; ++i) {
    const double y = x(0) + speed * i * period / 1000 - x(i * period / 1000);
    REQUIRE(y > 0);
    REQUIRE(y < 1);
  }
  const Run run = simulate(scene, Restitution{}, everything());
  REQUIRE(run.impacts->time.size() == 20000);
  double worst = 0;
  for (std::size_t n = 0; n < 20000; ++n) {
    worst = std::max(worst, std::abs(run.impacts->time[n] - (period * double(n + 1) - since)));
    CHECK((run.impacts->wall[n] == Wall::right) == (n % 2 == 0));
  }
  // Stable: only the rounding of omega t, 6e4 at the end, remains.
  CHECK(worst < 1e-10);
  CHECK(std::abs(run.energy->residual) < 1e-12 * 1e4);
}

TEST_CASE("the clock of many motions is right to its last two digits") {
  // What is left are the roundings of what is added, not of the sum.
  constexpr double last_two = 0x1p-50;
  Clock<double> clock;
  long double sum = 0;
  for (int n = 1; n <= 200000; ++n) {
    const double duration = 1.0 / (1 + n % 97);
    const long double next = sum + duration;
    CHECK(std::abs(clock.after(duration) - next) <= last_two * next);
    clock.advance(duration);
    sum = next;
  }
  CHECK(std::abs(clock.now() - sum) <= last_two * sum);
}

TEST_CASE("where an impact throws x back, its height then is the half cycle's amplitude") {
  const Scene scene{.x0 = 0,
                    .v0 = 1,
                    .until_time = 1,
                    .dampers = {{.mass_ratio = 1, .restitution = 1, .y0 = 0.5, .w0 = -5}}};
  const Run run = simulate(scene, Restitution{}, everything());
  REQUIRE(!run.impacts->time.empty());
  REQUIRE(!run.half_cycles->amplitude.empty());
  const double first = run.impacts->time[0];
  CHECK(first < 0.2);
  CHECK(run.half_cycles->amplitude[0] == doctest::Approx(std::sin(first)).epsilon(1e-14));
  CHECK(run.half_cycles->peak_time[0] == first);
  CHECK(run.impacts->amplitude[0] == run.half_cycles->amplitude[0]);
}

TEST_CASE("x thrown back just as it comes to zero begins no half cycle by rounding") {
  // Released from the left wall at x0 = 1, the secondary mass flies straight and is at the right one when x
  // is zero; a heavy one turns the primary mass back there. Rounding puts x on either side.
  for (int n = -4; n <= 4; ++n)
    for (double nu = 2; nu < 1e6; nu *= 1.1) {
      const Scene scene{.x0 = 1 + n * std::numeric_limits<double>::epsilon(),
                        .until_time = 1.6,
                        .dampers = {{.mass_ratio = nu, .restitution = 1}}};
      const Run run = simulate(scene, Restitution{}, everything());
      REQUIRE(run.impacts->time.size() == 1);
      for (double amplitude : run.half_cycles->amplitude) CHECK(amplitude > 0.5);
    }
}

TEST_CASE("a fast light mass costs the primary mass's speed no digits") {
  // Some 690 000 impacts at a speed 1700 times the primary mass's. Rounding of each is allowed, a bias is
  // not.
  const Scene scene{.damping_ratio = 0.06,
                    .x0 = -5,
                    .v0 = 20,
                    .until_time = 20,
                    .dampers = {{.mass_ratio = 2e-7, .restitution = 1, .w0 = -34488}}};
  const Restitution options{.budget = {.max_impacts = 1'000'000}};
  const Run run = simulate(scene, options, {.energy = true});
  const double impacts = double(run.energy->impact_loss.size());
  CHECK(impacts > 600'000);
  CHECK(std::abs(run.energy->residual) < std::sqrt(impacts) * std::numeric_limits<double>::epsilon());
}
