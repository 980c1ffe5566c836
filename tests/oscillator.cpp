#include "impact_damper/motion/oscillator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "impact_damper/motion/driven_series.hpp"
#include "reference.hpp"

using namespace impact_damper;
using reference::Quad;

namespace {

struct Expected {
  Quad c, s, c1, s1, v;  // C, S, C - 1, S - t, S'
};

Expected solutions(double a, double b, double t) {
  // S, S', the integral I of S, and S - t, whose rate is S' - 1 = -2 a S - b I.
  const Quad p = 2 * Quad(a), q = b;
  const auto e = reference::exponential<4>({{{0, 1, 0, 0}, {-q, -p, 0, 0}, {1, 0, 0, 0}, {-p, 0, -q, 0}}}, t);
  const Quad s = e[0][1], v = e[1][1];
  return {v + p * s, s, -q * e[2][1], e[3][1], v};
}

// Displacement and velocity at `t` after `begin`, from rest there, under f0 sin(omega t).
struct ExpectedResponse {
  Quad d, d1;
};
ExpectedResponse driven(double a, double b, double f0, double omega, double begin, double t) {
  const Quad w = omega;
  const auto phase = reference::exponential<2>({{{0, w}, {-w, 0}}}, begin);
  const auto e = reference::exponential<4>(
      {{{0, 1, 0, 0}, {-Quad(b), -2 * Quad(a), Quad(f0), 0}, {0, 0, 0, w}, {0, 0, -w, 0}}}, t);
  const auto u = reference::applied<4>(e, {0, 0, phase[0][1], phase[1][1]});
  return {u[0], u[1]};
}

double magnitude(Quad x) { return double(reference::absolute(x)); }

struct Damping {
  double a, b;
};
const std::vector<Damping> dampings{
    {0, 1},        {1e-12, 1},     {1e-3, 1},   {0.3, 1},       {0.7, 1},      {0.99, 1},
    {1 - 1e-9, 1}, {1 - 1e-15, 1}, {1, 1},      {1 + 1e-15, 1}, {1 + 1e-9, 1}, {1.01, 1},
    {2, 1},        {10, 1},        {1e3, 1},    {0.02, 0.98},   {3, 1e-4},     {1e4, 5e9},
    {1.2e5, 5e9},  {0, 1e10},      {0.5, 0.25}, {1.5, 2.25}};
const std::vector<double> times{1e-8, 1e-6, 1e-4, 0.01, 0.1, 0.49, 0.51, 0.9, 1.5, 3, 7, 25};

}  // namespace

TEST_CASE_TEMPLATE("the solutions from rest keep their relative accuracy for short times, at any damping",
                   Real, double, long double) {
  const double epsilon = double(std::numeric_limits<Real>::epsilon());
  for (const auto& damping : dampings) {
    const double a = damping.a, b = damping.b;
    const Oscillator<Real> oscillator(a, b);
    // C - 1 and S - t do not turn back while the slower of the two rates has not acted.
    const double slow = a * a > b ? b / (a + std::sqrt(a * a - b)) : std::sqrt(b);
    for (double scaled : times)
      for (double t : {scaled / double(oscillator.rate()), scaled / slow}) {
        if (t * slow > 0.6) continue;
        const Expected expected = solutions(a, b, t);
        const Propagator<Real> p = oscillator.propagate(t);
        INFO("a ", a, ", b ", b, ", t ", t);
        // A handful of roundings each.
        CHECK(magnitude(p.c - expected.c) <= 4 * epsilon * magnitude(expected.c));
        CHECK(magnitude(p.s - expected.s) <= 8 * epsilon * magnitude(expected.s));
        CHECK(magnitude(p.c1 - expected.c1) <= 16 * epsilon * magnitude(expected.c1));
        CHECK(magnitude(p.s1 - expected.s1) <= 32 * epsilon * magnitude(expected.s1));
      }
  }
}

TEST_CASE_TEMPLATE("over long times the solutions are as accurate as the argument omega t lets them be", Real,
                   double, long double) {
  const double epsilon = double(std::numeric_limits<Real>::epsilon());
  for (const auto& damping : dampings) {
    const double a = damping.a, b = damping.b;
    const Oscillator<Real> oscillator(a, b);
    const double slow = a * a > b ? b / (a + std::sqrt(a * a - b)) : a > 0 ? a : std::sqrt(b);
    for (double scaled : {0.5, 1.0, 3.0, 10.0, 30.0, 100.0, 1e4})
      for (double t : {scaled / double(oscillator.rate()), scaled / slow}) {
        if (a * t > 1e6 || (a > 0 && slow * t > 40)) continue;
        const Expected expected = solutions(a, b, t);
        const Propagator<Real> p = oscillator.propagate(t);
        INFO("a ", a, ", b ", b, ", t ", t);
        // The envelope, with the rounding of omega t and of the exponent.
        const double root_b = std::sqrt(b);
        const double of_s = std::hypot(magnitude(expected.s), magnitude(expected.v) / root_b);
        const double of_v = std::hypot(magnitude(expected.v),
                                       magnitude(expected.s) * root_b * std::min(1.0, root_b / (a + 1e-300)));
        const double of_c = std::hypot(magnitude(expected.c), magnitude(expected.s) * root_b);
        const double roundings = 4 * epsilon * (1 + t * (a * a > b ? slow : root_b));
        CHECK(magnitude(p.s - expected.s) <= roundings * of_s);
        CHECK(magnitude(p.c - expected.c) <= roundings * of_c);
        CHECK(magnitude(p.v - expected.v) <= 2 * roundings * of_v);
      }
  }
}

TEST_CASE_TEMPLATE("the driven response from rest is right at, near and away from resonance", Real, double,
                   long double) {
  const double epsilon = double(std::numeric_limits<Real>::epsilon());
  for (double a : {0.0, 1e-15, 1e-12, 1e-8, 1e-3, 0.1, 0.7, 0.72, 1.0, 3.0, 10.0}) {
    const double natural = std::sqrt(std::abs(1 - a * a));
    std::vector<double> frequencies{1e-3, 0.3, 0.5, 2, 17, 1e3};
    for (double detuning : {0.0, 1e-12, 1e-10, 1e-8, 1e-6, 1e-3}) {
      frequencies.push_back(natural + detuning);
      frequencies.push_back(1 - detuning);
    }
    for (double omega : frequencies) {
      if (omega <= 0) continue;
      const Oscillator<Real> oscillator(a, 1);
      const Forcing<Real> forcing{Real(0.7), Real(omega)};
      for (double begin : {0.0, 0.8, 41.3})
        for (double t : {1e-8, 1e-3, 0.3, 0.6, 2.0, 11.0, 300.0}) {
          const ExpectedResponse expected = driven(a, 1, 0.7, omega, begin, t);
          const DrivenResponse<Real> found =
              oscillator.respond(forcing, forcing.phase(begin), t, oscillator.propagate(t));
          INFO("a ", a, ", omega ", omega, ", begin ", begin, ", t ", t);
          // What the response could at most have grown to in this time, and how far the rounding of the
          // phases omega t and omega begin can shift it.
          const double most1 = 0.7 * std::min({t, 2 / std::max(a, 1e-300), 4 / omega + (omega < 2 ? t : 0)});
          const double most = 0.7 * std::min({t * t / 2, most1 * std::min(t, 2.0)});
          const double roundings = 8 * epsilon * (1 + (1 + omega) * (begin + std::min(t, 1e3)));
          CHECK(magnitude(found.d - expected.d) <= roundings * most);
          CHECK(magnitude(found.d1 - expected.d1) <= roundings * most1);
        }
    }
  }
}

TEST_CASE_TEMPLATE("the series of a motion under a force is the motion, as long as it holds", Real, double,
                   long double) {
  const double epsilon = double(std::numeric_limits<Real>::epsilon());
  reference::Random random(41);
  double most = 0;
  for (double a : {0.0, 1e-12, 1e-3, 0.01, 0.3, 0.99, 1.0, 1.01, 2.0})
    for (double b : {1.0, 0.98, 1e-4})
      for (double omega : {1e-6, 0.2, 0.5, 0.988, 1.0, 1.4, 5.0, 60.0, 1e6}) {
        const Oscillator<Real> oscillator(a, b);
        const DrivenSeriesTable<Real> table(oscillator, Real(omega));
        const double reach = double(table.reach()), rate = driven_radians<Real> / reach;
        for (int n = 0; n < 6; ++n) {
          const double x = random.uniform(-1, 1), v = rate * random.uniform(-1, 1);
          const double f = rate * rate * random.uniform(-1, 1), g = rate * rate * random.uniform(-1, 1);
          const DrivenSeries<Real> series(table, Real(x), Real(v), Real(f), Real(g));
          for (double share : {0.01, 0.2, 0.5, 0.8, 1.0}) {
            const Real t = Real(share) * table.reach();
            const Quad w = omega;
            const auto e = reference::exponential<4>(
                {{{0, 1, 0, 0}, {-Quad(b), -2 * Quad(a), 1, 0}, {0, 0, 0, w}, {0, 0, -w, 0}}}, Quad(t));
            const auto u = reference::applied<4>(e, {x, v, f, g});
            const Quad u2 = u[2] - 2 * Quad(a) * u[1] - Quad(b) * u[0];
            const SeriesAt<Real> found = series.departure().at(t);
            INFO("a ", a, ", b ", b, ", omega ", omega, ", share ", share);
            // The terms of a damped motion alternate, and add up to more than itself.
            const double noise = (a * a < b / 4 ? 12 : 40) * epsilon;
            CHECK(magnitude(Quad(x) + Quad(v) * Quad(t) + Quad(found.u) - u[0]) <= noise);
            CHECK(magnitude(Quad(v) + Quad(found.u1) - u[1]) <= noise * rate);
            CHECK(magnitude(Quad(found.u2) - u2) <= noise * rate * rate);
            most = std::max(most, magnitude(Quad(found.u2) - u2) / (epsilon * rate * rate));
          }
        }
      }
  MESSAGE("largest error of x'' ", most, " roundings");
}

TEST_CASE("the phase of a force after a short time is turned, after a longer one that of the time") {
  const double epsilon = std::numeric_limits<double>::epsilon();
  for (const double frequency : {0.01, 1.0, 33.0})
    for (const double angle : {0.0, 0.4, 1.5707, 3.2, 12.9, 700.1})
      for (const double by : {0.0, 1e-9, 0.01, 0.03, 0.06, 0.0624}) {
        INFO("frequency ", frequency, ", angle ", angle, ", by ", by);
        const Forcing<double> force{1, frequency};
        const double begin = angle / frequency, since = by / frequency;
        const SinCos<double> before = force.phase(begin), then = force.phase(-1e9, before, since);
        const Quad turn = Quad(frequency) * since;
        const auto exact = reference::exponential<2>({{{0, turn}, {-turn, 0}}}, 1);
        CHECK(magnitude(then.sin - (exact[0][0] * before.sin + exact[0][1] * before.cos)) < 0.8 * epsilon);
        CHECK(magnitude(then.cos - (exact[0][0] * before.cos - exact[0][1] * before.sin)) < 0.8 * epsilon);
        const double longer = 0.0626 / frequency;
        CHECK(force.phase(begin + longer, {0, 0}, longer).sin == force.phase(begin + longer).sin);
      }
  const Forcing<long double> fine{1, 1};
  CHECK(fine.phase(1.01L, {0, 0}, 0.01L).cos == fine.phase(1.01L).cos);
}

TEST_CASE("at resonance without damping the amplitude grows by f0/2 per time") {
  const Oscillator<double> oscillator(0, 1);
  const Forcing<double> forcing{0.3, 1};
  for (double t : {1e-8, 1e-3, 1.0, 10.0, 1e3, 1e5}) {
    const DrivenResponse<double> found =
        oscillator.respond(forcing, forcing.phase(0), t, oscillator.propagate(t));
    // x = f0/2 (sin t - t cos t), which for short times is f0 t^3/6.
    const double exact =
        t < 1e-2 ? 0.05 * t * t * t * (1 - t * t / 10) : 0.15 * (std::sin(t) - t * std::cos(t));
    CHECK(std::abs(found.d - exact) <= 1e-15 * 0.3 * std::min(t * t * t, 1 + t));
    CHECK(std::abs(found.d1 - 0.15 * t * std::sin(t)) <= 1e-15 * 0.3 * std::min(t * t, 1 + t));
  }
}

TEST_CASE("a very slow and a very fast force give the static and the inertial response") {
  const Oscillator<double> oscillator(0.05, 1);
  // f0 sin(omega t), omega -> 0: x'' + 2 a x' + x = f0 omega t, which rises as f0 omega (t - 2 a) +
  // transient.
  const Forcing<double> slow{1.0, 1e-9};
  const double late = oscillator.respond(slow, slow.phase(0), 900, oscillator.propagate(900)).d;
  CHECK(late == doctest::Approx(1e-9 * (900 - 0.1)).epsilon(1e-12));
  // omega -> infinity: x'' = f0 sin(omega t) leaves the drift f0/omega t while t << 1, less f0 sin(omega
  // t)/omega^2.
  const double t = 1e-4, omega = 1e6;
  const Forcing<double> fast{1.0, omega};
  const double drift = t / omega * (1 - 0.05 * t) - std::sin(omega * t) / (omega * omega);
  // Next terms: relative t^2/6 and the damping acting on the ripple.
  CHECK(oscillator.respond(fast, fast.phase(0), t, oscillator.propagate(t)).d ==
        doctest::Approx(drift).epsilon(1e-8));
}

TEST_CASE("the bound on a motion holds and is reached") {
  reference::Random random(7);
  for (int n = 0; n < 2000; ++n) {
    const double a = random.chance(0.2) ? 0 : random.log_uniform(1e-3, 10), b = random.log_uniform(0.01, 100);
    const double u = random.uniform(-1, 1), u1 = random.uniform(-3, 3);
    const double f0 = random.chance(0.5) ? random.uniform(-1, 1) : 0, omega = random.log_uniform(0.1, 10);
    const double begin = random.uniform(0, 10), span = random.log_uniform(0.1, 10);
    const Oscillator<double> oscillator(a, b);
    const Forcing<double> forcing{f0, omega};
    const double bound =
        Instant<double, 2>(oscillator, u, u1, 1, 0, forcing, forcing.phase(begin)).bound(0, span);
    double largest = 0;
    for (int i = 0; i <= 400; ++i) {
      const double t = span * i / 400;
      const auto p = oscillator.propagate(t);
      largest = std::max(
          largest, std::abs(p.c * u + p.s * u1 + oscillator.respond(forcing, forcing.phase(begin), t, p).d));
    }
    CHECK(largest <= bound * (1 + 1e-14));
    if (a == 0 && f0 == 0 && span * std::sqrt(b) > 3.2) CHECK(largest >= 0.99 * bound);
  }
}

TEST_CASE("the lower bound of a decay is never above it, and the bound of a decaying motion never below it") {
  reference::Random random(8);
  for (int n = 0; n < 2000; ++n) {
    const double a = random.log_uniform(1e-3, 10), b = random.log_uniform(0.01, 100);
    const double u = random.uniform(-1, 1), u1 = random.uniform(-3, 3), t = random.log_uniform(1e-3, 10);
    const Oscillator<double> oscillator(a, b);
    CHECK(oscillator.lower_bound_of_decay(t) <= std::exp(-a * t) * (1 + 1e-14));
    CHECK(oscillator.lower_bound_of_decay(t) >= std::exp(-a * t) / 2);
    const double bound = oscillator.bound_after(u, u1, t);
    for (int i = 0; i <= 100; ++i) {
      const auto p = oscillator.propagate(t * (1 + i / 10.0));
      CHECK(std::abs(p.c * u + p.s * u1) <= bound * (1 + 1e-14));
    }
  }
}
