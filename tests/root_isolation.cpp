#include "impact_damper/events/root_isolation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "impact_damper/motion/flight.hpp"
#include "reference.hpp"

using namespace impact_damper;

namespace {

using Long = long double;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

// The second root finder: the first time in [from, to] at which g lies below -depth, by samples, by the
// minimum (bisection of g') wherever g' turns from falling to rising between two samples, and by bisection.
// It needs samples so dense that g' turns at most once between two of them.
template <class G, class G1>
std::optional<Long> first_below(G&& g, G1&& g1, Long from, Long to, Long depth, int samples) {
  const auto crossing = [&](Long above, Long below) {
    for (int i = 0; i < 70; ++i) {
      const Long middle = (above + below) / 2;
      (g(middle) < -depth ? below : above) = middle;
    }
    return below;
  };
  double before = from;
  if (g(Long(before)) < -depth) return before;
  for (int i = 1; i <= samples; ++i) {
    const double now = from + (to - from) * i / samples;
    if (g1(before) < 0 && g1(now) > 0) {
      Long falling = before, rising = now;
      for (int j = 0; j < 70; ++j) {
        const Long middle = (falling + rising) / 2;
        (g1(middle) < 0 ? falling : rising) = middle;
      }
      if (g(rising) < -depth) return crossing(before, rising);
    }
    if (g(now) < 0 && g(Long(now)) < -depth) return crossing(before, now);
    before = now;
  }
  return std::nullopt;
}

// c0 + c1 t + c2 t^2 / 2 + c3 t^3 / 6 + a cos(w t + p).
struct Curve {
  double c0, c1, c2, c3, a, w, p;
  template <class Real>
  Real g(Real t) const {
    return c0 + t * (c1 + t * (Real(c2) / 2 + t * c3 / 6)) + a * std::cos(w * t + p);
  }
  template <class Real>
  Real g1(Real t) const {
    return c1 + t * (c2 + t * Real(c3) / 2) - Real(a) * w * std::sin(w * t + p);
  }
  LocalEnclosure<double> enclose(double t) const {
    const double cos = a * std::cos(w * t + p), sin = a * std::sin(w * t + p);
    LocalEnclosure<double> look;
    look.main = {c0 + t * (c1 + t * (c2 / 2 + t * c3 / 6)), c1 + t * (c2 + t * c3 / 2), c2 + t * c3,
                 std::abs(c3)};
    look.whole = {look.main.g + cos, look.main.g1 - w * sin, look.main.g2 - w * w * cos,
                  look.main.third + std::abs(a) * w * w * w};
    look.rest = std::abs(a);
    return look;
  }
  // What rounding makes of g in double.
  double noise(double t) const {
    return 4 * epsilon *
           (std::abs(c0) + t * (std::abs(c1) + t * (std::abs(c2) + t * std::abs(c3))) +
            std::abs(a) * (1 + w * t + std::abs(p)));
  }
};

Curve random_curve(reference::Random& random, double& horizon) {
  Curve c{};
  horizon = random.log_uniform(0.1, 30);
  c.w = random.log_uniform(0.1, 40) / horizon;
  c.a = random.chance(0.15) ? 0 : random.log_uniform(1e-6, 10) * random.sign();
  c.p = random.uniform(-3, 3);
  c.c1 = random.chance(0.1) ? 0 : random.uniform(-1, 1) / horizon;
  c.c2 = random.chance(0.3) ? 0 : random.uniform(-4, 4) / (horizon * horizon);
  c.c3 = random.chance(0.5) ? 0 : random.uniform(-16, 16) / (horizon * horizon * horizon);
  c.c0 = random.uniform(0, 2) - c.a * std::cos(c.p);
  return c;
}

// Holds first_root to its promise: a root only where g is zero within rounding, none that is later than the
// first place where g is below zero by more than rounding.
void hold(const Curve& c, double horizon, double& evaluations) {
  int calls = 0;
  Search<double> search{std::numeric_limits<double>::infinity()};
  const auto found = first_root<double>(
      [&](double t) {
        ++calls;
        return std::array{c.enclose(t)};
      },
      0.0, horizon, search, 1 / c.w);
  evaluations += calls;
  const double noise = c.noise(horizon);
  const auto below =
      first_below([&](auto t) { return c.g(t); }, [&](auto t) { return c.g1(t); }, 0, horizon, noise, 160);
  CAPTURE(c.c0);
  CAPTURE(c.c1);
  CAPTURE(c.c2);
  CAPTURE(c.c3);
  CAPTURE(c.a);
  CAPTURE(c.w);
  CAPTURE(c.p);
  CAPTURE(horizon);
  const double t = found ? found->time : horizon, resolved = 4 * epsilon * (t + 1 / c.w);
  if (found) {
    CHECK(std::abs(c.g(Long(t))) <= noise + resolved * std::abs(c.g1(t)));
  }
  if (below) CHECK(t <= *below + resolved);
}

// The smallest value of a jet's lower bound p on [0, s], by its stationary points.
Long least_of_bound(const Jet<double>& jet, Long s) {
  const Long g = jet.g, g1 = jet.g1, g2 = jet.g2, m = jet.third;
  const auto p = [&](Long t) { return g + t * (g1 + t * (g2 / 2 - t * m / 6)); };
  Long least = std::min(p(0), p(s));
  // p' = g1 + g2 t - m t^2 / 2
  const Long discriminant = g2 * g2 + 2 * m * g1;
  if (m == 0) {
    if (g2 != 0 && -g1 / g2 > 0 && -g1 / g2 < s) least = std::min(least, p(-g1 / g2));
  } else if (discriminant >= 0) {
    const Long q = g2 + (g2 < 0 ? -1 : 1) * std::sqrt(discriminant);
    for (Long t : {q / m, q == 0 ? Long(0) : -2 * g1 / q}) {
      if (t > 0 && t < s) least = std::min(least, p(t));
    }
  }
  return least;
}

}  // namespace

TEST_CASE("a certified step is free of roots, and so long that its bound vanishes at its end") {
  reference::Random random(1);
  for (int n = 0; n < 200000; ++n) {
    Jet<double> jet;
    const auto number = [&] {
      return random.chance(0.1) ? 0.0 : random.log_uniform(1e-9, 1e9) * random.sign();
    };
    jet.g = std::abs(number());
    jet.g1 = number();
    jet.g2 = number();
    jet.third = std::abs(number());
    if (random.chance(0.3) && jet.g2 > 0 && jet.g1 < 0) {
      // Nearly a double root of the parabola.
      jet.g = jet.g1 * jet.g1 / (2 * jet.g2) * (1 + random.log_uniform(1e-16, 1e-2) * random.sign());
      jet.third *= 1e-9;
    }
    const double most = random.log_uniform(1e-6, 1e6);
    const double step = step_without_root(jet, most);
    const double rounding =
        8 * epsilon *
            (jet.g + step * (std::abs(jet.g1) + step * (std::abs(jet.g2) / 2 + step * jet.third / 6))) +
        1e-300;
    CAPTURE(n);
    CAPTURE(jet.g);
    CAPTURE(jet.g1);
    CAPTURE(jet.g2);
    CAPTURE(jet.third);
    CAPTURE(most);
    CAPTURE(step);
    REQUIRE(step >= 0);
    REQUIRE(step <= most);
    CHECK(least_of_bound(jet, step) >= -rounding);
    if (jet.g == 0 || step == most) continue;
    CHECK(step > 0);
    // Beyond three quarters of the way to the root; or where p nearly touches zero, Newton's eight steps
    // having halved the distance each, and p fallen to a quarter each time but for the last.
    CHECK(least_of_bound(jet, std::min(Long(most), Long(step) * 4 / 3)) <= rounding + jet.g / 16384);
  }
}

TEST_CASE("cubic and trigonometric gaps: the same first root as by dense samples and bisection") {
  reference::Random random(2);
  double evaluations = 0;
  const int cases = 50000;
  for (int n = 0; n < cases; ++n) {
    double horizon;
    const Curve c = random_curve(random, horizon);
    hold(c, horizon, evaluations);
  }
  CHECK(evaluations / cases < 5);  // a flight costs a handful of evaluations
}

TEST_CASE("grazing gaps: a dip is found however shallow, and near misses are let pass") {
  reference::Random random(3);
  double evaluations = 0;
  for (int n = 0; n < 30000; ++n) {
    double horizon;
    Curve c = random_curve(random, horizon);
    // Lifts the curve until its smallest value inside is about +-1e-3 ... 1e-15.
    double least = std::min(c.g(0.0), c.g(horizon));
    for (int i = 0; i < 160; ++i) {
      double falling = horizon * i / 160, rising = horizon * (i + 1) / 160;
      if (!(c.g1(falling) < 0 && c.g1(rising) > 0)) continue;
      for (int j = 0; j < 64; ++j) {
        const double middle = (falling + rising) / 2;
        (c.g1(middle) < 0 ? falling : rising) = middle;
      }
      least = std::min(least, c.g(rising));
    }
    c.c0 -= least - random.log_uniform(1e-15, 1e-3) * random.sign();
    if (c.g(0.0) < 0) continue;
    hold(c, horizon, evaluations);
  }
}

TEST_CASE("gaps that begin at zero and rise are not taken for roots, and the return is found") {
  reference::Random random(4);
  int returned = 0;
  for (int n = 0; n < 20000; ++n) {
    double horizon;
    Curve c = random_curve(random, horizon);
    c.c0 = -c.a * std::cos(c.p);
    const double rise = random.log_uniform(1e-9, 10);
    c.c1 = rise + c.a * c.w * std::sin(c.p);
    if (c.enclose(0).whole.g > 0 || !(c.enclose(0).whole.g1 > 0)) continue;
    Search<double> search{std::numeric_limits<double>::infinity()};
    const auto found =
        first_root<double>([&](double t) { return std::array{c.enclose(t)}; }, 0.0, horizon, search, 1 / c.w);
    CAPTURE(n);
    CAPTURE(rise);
    if (!found) continue;
    // Where it comes back there was room in between: g rises at `rise` before |g''| <= most can turn it.
    const double most = std::abs(c.c2) + horizon * std::abs(c.c3) + std::abs(c.a) * c.w * c.w;
    CHECK(found->time >= rise / most);
    const double t = found->time;
    CHECK(std::abs(c.g(Long(t))) <= c.noise(t) + 4 * epsilon * (t + 1 / c.w) * std::abs(c.g1(t)));
    ++returned;
  }
  CHECK(returned > 5000);
}

TEST_CASE("flights across the cavity meet the wall that an independent search finds, when it does") {
  reference::Random random(5);
  int met = 0;
  for (int n = 0; n < 20000; ++n) {
    Scene scene;
    scene.x0 = random.chance(0.1) ? 0 : random.log_uniform(1e-3, 30) * random.sign();
    scene.v0 = random.chance(0.3) ? 0 : random.log_uniform(1e-3, 30) * random.sign();
    scene.damper().y0 = random.chance(0.3) ? double(random.chance(0.5)) : random.uniform(0, 1);
    scene.damper().w0 = random.chance(0.2) ? 0 : random.log_uniform(1e-3, 30) * random.sign();
    if ((scene.damper().y0 == 0 && scene.damper().w0 <= 0) ||
        (scene.damper().y0 == 1 && scene.damper().w0 >= 0))
      continue;
    const auto y = [&](auto t) {
      return scene.damper().y0 + scene.damper().w0 * t - scene.x0 * (std::cos(t) - 1) -
             scene.v0 * (std::sin(t) - t);
    };
    const auto w = [&](auto t) {
      return scene.damper().w0 + scene.x0 * std::sin(t) - scene.v0 * (std::cos(t) - 1);
    };

    const System<double> system(scene);
    const Flight<double> flight(system, 0.0, {scene.x0, scene.v0, scene.damper().y0, scene.damper().w0});
    const double horizon = 20;
    Search<double> search{std::numeric_limits<double>::infinity()};
    const auto found =
        first_root<double>([&](double t) { return flight.gaps(t, search.span); }, 0.0, horizon, search, 1.0);
    const double noise =
        4 * epsilon * (1 + 20 * std::abs(scene.damper().w0) + std::abs(scene.x0) + 20 * std::abs(scene.v0));
    const auto left = first_below(y, w, 0, horizon, noise, 100);
    const auto right =
        first_below([&](auto t) { return 1 - y(t); }, [&](auto t) { return -w(t); }, 0, horizon, noise, 100);
    CAPTURE(n);
    CAPTURE(scene.x0);
    CAPTURE(scene.v0);
    CAPTURE(scene.damper().y0);
    CAPTURE(scene.damper().w0);
    if (!found) {
      CHECK(!left);
      CHECK(!right);
      continue;
    }
    ++met;
    const Long expected = std::min(left.value_or(1e9L), right.value_or(1e9L)), t = found->time;
    CHECK(t <= expected + 4 * epsilon * (t + 1));
    CHECK(std::abs(found->which == 0 ? y(t) : 1 - y(t)) <= noise + 4 * epsilon * (t + 1) * std::abs(w(t)));
  }
  CHECK(met > 10000);
}
