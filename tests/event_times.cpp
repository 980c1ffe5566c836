// The short ways to an event, prediction and validation, closed form, table, against the search step by step.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "impact_damper/events/fall_by_ends.hpp"
#include "impact_damper/events/impact_prediction.hpp"
#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/motion/contact.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/sticking.hpp"
#include "impact_damper/motion/wall.hpp"
#include "reference.hpp"

using namespace impact_damper;
using Long = long double;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double infinite = std::numeric_limits<double>::infinity();

Scene scene_of(reference::Random& random, bool forced) {
  Scene scene;
  scene.damper().mass_ratio = random.log_uniform(1e-4, 10);
  scene.damper().restitution = random.chance(0.2) ? double(random.chance(0.5)) : random.uniform(0, 1);
  scene.damping_ratio = random.chance(0.4) ? 0 : random.log_uniform(1e-4, 3);
  scene.damper().wall_stiffness = random.log_uniform(1e2, 1e10);
  if (forced) {
    scene.force_amplitude = random.log_uniform(1e-3, 10);
    scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.1, 10);
  }
  return scene;
}

double signed_log(reference::Random& random, double low, double high) {
  return random.log_uniform(low, high) * random.sign();
}

}  // namespace

TEST_CASE("a gap is proved open only where it is") {
  // Random quartics, whose fourth derivative is one number, held against themselves at 400 points.
  reference::Random random(11);
  int proved = 0, open = 0;
  for (int n = 0; n < 200000; ++n) {
    // Often one that leaves a wall by its second or third derivative alone.
    const double u0 = random.chance(0.3) ? 0 : random.uniform(0, 1);
    const double w = random.chance(0.2) ? 0 : random.uniform(-2, 2);
    const double a = random.chance(0.2) ? 0 : random.uniform(-10, 10);
    const double j = random.uniform(-30, 30), f = random.uniform(-100, 100);
    const double h = random.uniform(0, 1);
    const auto u = [&](double t) { return u0 + t * (w + t * (a / 2 + t * (j / 6 + t * f / 24))); };
    const auto slope = [&](double t) { return w + t * (a + t * (j / 2 + t * f / 6)); };
    const double u1 = u(h);
    if (u1 < 0) continue;
    double least = infinite, most = -infinite;
    for (int i = 1; i < 400; ++i) {
      least = std::min(least, u(h * i / 400));
      most = std::max(most, u(h * i / 400));
    }
    CAPTURE(n);
    open += least > 0;
    if (stays_open(u0, w, u1, slope(h), h, std::abs(f))) {
      ++proved;
      CHECK(least > 0);
    }
    const Derivatives<double, 4> from{u0, w, a, j};
    if (stays_between(from, u1, slope(h), h, std::abs(f))) {
      CHECK(least > 0);
      CHECK(most < 1);
    }
  }
  CHECK(proved > 0.8 * open);  // and mostly where it is
}

TEST_CASE(
    "a level met nearby is met where the series meets it, as far as the correction vouches for itself") {
  // Cubics, whose root Newton's method finds in extended precision; with or without curvature, as without it
  // the third derivative alone is left to correct for. The fourth only keeps the correction short.
  reference::Random random(16);
  int close = 0;
  for (int n = 0; n < 100000; ++n) {
    const double away = signed_log(random, 1e-9, 1e-2), h = random.uniform(0.1, 1);
    const double curvature = random.chance(0.5) ? 0 : signed_log(random, 1e-3, 10);
    const Derivatives<double, 6> y{away, signed_log(random, 0.1, 10), curvature,
                                   signed_log(random, 1e-3, 30)};
    const TimeToLevel<double> found = time_to_level(0.0, y, h, random.log_uniform(0.1, 100));
    if (!found.close) continue;
    ++close;
    long double root = found.shift;
    for (int i = 0; i < 4; ++i) {
      const long double g = y[0] + root * (y[1] + root * (y[2] / 2.0L + root * y[3] / 6.0L));
      root -= g / (y[1] + root * (y[2] + root * y[3] / 2.0L));
    }
    CAPTURE(n);
    // The next terms of the reversion, 5 a^3 t and 5 a b t, are asked to be below epsilon h/64 without the 5.
    CHECK(std::abs(found.shift - root) <= epsilon * (h / 4 + 8 * std::abs(found.shift)));
  }
  CHECK(close > 10000);
}

TEST_CASE(
    "a function that falls to zero stays above the chord that is proved, which is rarely far below it") {
  reference::Random random(47);
  int proved = 0, close = 0;
  for (int n = 0; n < 100000; ++n) {
    const double h = random.uniform(0.1, 2), w = random.uniform(-2, 2), a = random.uniform(-6, 3),
                 j = random.uniform(-10, 10), f = random.uniform(-40, 40);
    const auto change = [&](double t) { return t * (w + t * (a / 2 + t * (j / 6 + t * f / 24))); };
    const double u0 = -change(h), slope = w + h * (a + h * (j / 2 + h * f / 6));
    if (!(u0 > 0)) continue;
    const double chord = chord_below(u0, w, slope, h, std::abs(f));
    if (!(chord > 0)) continue;
    ++proved;
    double highest = infinite;
    for (int i = 0; i < 200; ++i) {
      const double t = h * i / 200;
      highest = std::min(highest, (u0 + change(t)) / (1 - t / h));
    }
    CHECK(chord <= highest * (1 + 1e-12) + 1e-12);
    close += chord > highest / 2;
  }
  CHECK(proved > 10000);
  CHECK(close > 0.8 * proved);
}

TEST_CASE("a function keeps its sign between two ends as long as the deepest parabola through them does") {
  reference::Random random(17);
  for (int n = 0; n < 1000; ++n) {
    const double second = random.log_uniform(1e-3, 1e3), h = random.log_uniform(1e-3, 1e3);
    const double end = second * h * h / 8, side = random.sign();
    CHECK(keeps_sign(side * end * 1.001, side * end * 1.001, second, h));
    CHECK(!keeps_sign(side * end * 0.999, side * end * 1.001, second, h));
    CHECK(!keeps_sign(side * end * 1.001, side * end * 0.999, second, h));
  }
}

TEST_CASE("a motion moved on by its derivatives is the sum of their series") {
  reference::Random random(18);
  for (int n = 0; n < 1000; ++n) {
    Derivatives<double, 6> d;
    for (double& each : d) each = signed_log(random, 1e-3, 1e3);
    const double t = signed_log(random, 1e-3, 10);
    long double u = 0, u1 = 0, size = 0, size1 = 0, power = 1;  // power: t^k/k!
    for (int k = 0; k < 4; ++k) {
      u += d[k] * power;
      u1 += d[k + 1] * power;
      size += std::abs(d[k] * power);
      size1 += std::abs(d[k + 1] * power);
      power *= t / static_cast<long double>(k + 1);
    }
    const auto now = shifted(d[0], d[1], d, t);
    // Each term goes through a dozen roundings at most.
    CHECK(std::abs(double(now.u - u)) <= 12 * epsilon * double(size));
    CHECK(std::abs(double(now.u1 - u1)) <= 12 * epsilon * double(size1));
  }
}

TEST_CASE(
    "a series in pairs of terms is its polynomial beyond the straight line, with that one's derivatives") {
  reference::Random random(19);
  for (int n = 0; n < 1000; ++n) {
    Derivatives<double, 10> u;
    Derivatives<long double, 10> wide;
    for (std::size_t k = 0; k < u.size(); ++k) wide[k] = u[k] = signed_log(random, 1e-3, 1e3);
    const double t = signed_log(random, 1e-3, 10);
    long double sums[3]{}, first_six[3]{};
    for (std::size_t d = 0; d < 3; ++d) {
      long double size = 0, power = 1;  // t^(k-d)/(k-d)!
      for (std::size_t k = d; k < u.size(); ++k) {
        if (k > 1) sums[d] += wide[k] * power;
        if (k > 1 && k < 6) first_six[d] += wide[k] * power;
        size += std::abs(wide[k] * power);
        power *= t / static_cast<long double>(k - d + 1);
      }
      CAPTURE(n);
      // A term goes through a product and a sum for each power of t^2, and a few more.
      const double close = 20 * epsilon * double(size);
      const auto of = [d](const auto& at) { return d == 0 ? at.u : d == 1 ? at.u1 : at.u2; };
      CHECK(std::abs(double(of(sum<double>(departure_of(u), t)) - sums[d])) <= close);
      CHECK(std::abs(double(of(sum_of_first<double, 3>(departure_of(u), t)) - first_six[d])) <= close);
      // And in a scalar whose pairs no instruction takes at once.
      CHECK(std::abs(double(of(sum<long double>(departure_of(wide), t)) - sums[d])) <= close / 1024);
    }
  }
}

TEST_CASE("a predicted impact's departure from the straight line is its series at the predicted time") {
  reference::Random random(21);
  int exact = 0;
  for (int n = 0; n < 100000; ++n) {
    const double zeta = random.uniform(0, 0.9), w = random.log_uniform(0.05, 20);
    const Oscillator<double> oscillator(zeta, 1);
    Derivatives<double, 12> x{random.uniform(-5, 5), random.uniform(-5, 5)};
    for (std::size_t k = 2; k < x.size(); ++k) x[k] = -x[k - 2] - 2 * zeta * x[k - 1];
    Derivatives<double, 10> u{0, w};
    for (std::size_t k = 2; k < u.size(); ++k) u[k] = -x[k];
    const double rate = oscillator.rate();
    const double fourth = oscillator.bound(x[4], x[5]);
    const auto found = predict_impact<double>(
        u, Departure<double, 5>{departure_of(u)}, 2 / rate,
        [&](double u1, double t) { return omits_nothing(u1, fourth, rate, t); },
        [&](double t, double size) { return !(rate * t > 0.05 && size * 32 < t); });
    if (!found.exact) continue;
    ++exact;
    long double departure = 0, its_velocity = 0, size = 0, size1 = 0, power = found.time;  // power: t^k/k!
    for (std::size_t k = 1; k < 9; ++k) {
      its_velocity += u[k + 1] * power;
      if (k < 3) size1 += std::abs(u[k + 1] * power);
      power *= found.time / static_cast<long double>(k + 1);
      departure += u[k + 1] * power;
      if (k < 3) size += std::abs(u[k + 1] * power);
    }
    CAPTURE(n);
    // 2.2 units of 2^-52 were seen; 5.1 where the step's second power is omitted.
    CHECK(std::abs(double(found.gained.u - departure)) <= 3 * epsilon * double(size));
    CHECK(std::abs(double(found.gained.u1 - its_velocity)) <= 3 * epsilon * double(size1));
  }
  CHECK(exact > 5000);
}

TEST_CASE("a flight meets the wall that the certified search finds, when it finds it") {
  reference::Random random(12);
  int met = 0;
  for (int n = 0; n < 40000; ++n) {
    const Scene scene = scene_of(random, n % 4 == 0);
    const System<double> system(scene);
    const bool left = random.chance(0.5);
    const double w = random.chance(0.1) ? 0 : random.log_uniform(1e-9, 30);
    const State<double> start{random.chance(0.1) ? 0 : signed_log(random, 1e-3, 30),
                              random.chance(0.1) ? 0 : signed_log(random, 1e-3, 30),
                              random.chance(0.2) ? random.uniform(0, 1) : double(!left), left ? w : -w};
    const double begin = random.uniform(0, 10), horizon = 10;
    Search<double> search{bounded_span(system)};
    const Flight<double> flight(system, begin, start);
    const auto lead = flight.derivatives_of_y();
    const double away = left ? 1 : -1;
    if (w == 0 && (start.y == 0 || start.y == 1) && !(away * lead[2] > 0)) continue;
    const auto found = flight.next_wall(horizon, search), expected = flight.search_wall(0, horizon, search);
    CAPTURE(n);
    CHECK(found.has_value() == expected.has_value());
    if (!found || !expected) continue;
    ++met;
    CHECK(found->wall == expected->wall);
    // y is off by a few roundings of what it is the sum of; so is the time, by that over y' (or, grazing, by
    // the root of it over y'').
    const double size =
        std::abs(start.x) + std::abs(start.v) + w * expected->time + 1 + scene.force_amplitude;
    const double noise = 32 * epsilon * size * (1 + expected->time);
    const double w1 = std::abs(expected->state.w), graze = std::sqrt(2 * noise / (size + 1e-300));
    CHECK(std::abs(found->time - expected->time) <=
          8 * epsilon * expected->time + std::min(noise / w1, std::max(graze, 1e-6)));
    const State<double> there = flight.at(found->time);
    CHECK(std::abs(there.x - found->state.x) <= noise * (1 + scene.damping_ratio));
    CHECK(std::abs(there.v - found->state.v) <= noise * (1 + scene.damping_ratio));
    CHECK(std::abs(there.y - found->state.y) <= noise);
    CHECK(std::abs(there.w - found->state.w) <= noise * (1 + scene.damping_ratio));
  }
  CHECK(met > 20000);
}

TEST_CASE("a contact ends when the certified search says, in the state that its parts give") {
  reference::Random random(13);
  int left = 0, short_contacts = 0, lasting = 0, forced = 0;
  for (int n = 0; n < 60000; ++n) {
    const Scene scene = scene_of(random, n >= 40000);
    const System<double> system(scene);
    Search<double> search{bounded_span(system)};
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const Wall wall = random.chance(0.5) ? Wall::left : Wall::right;
    const double inward = wall == Wall::left ? -1 : 1;
    const double w = random.log_uniform(1e-6, 30) * inward;
    const State<double> start{signed_log(random, 1e-3, 30), signed_log(random, 1e-3, 30),
                              wall == Wall::left ? 0.0 : 1.0, w};
    const double begin = scene.force_amplitude == 0 ? 0 : random.uniform(0, 1000);
    const Contact<double> contact(walls, begin, start, wall);
    const auto found = contact.leave(100, search), expected = contact.search_leave(100, search);
    CAPTURE(n);
    CHECK(found.has_value() == expected.has_value());
    if (!found || !expected) continue;
    ++left;
    const double swing = walls.fast.half_period(), time = expected->time;
    short_contacts += time < 1.5 * swing;
    lasting += time > 4 * swing;
    if (walls.short_contact && scene.force_amplitude != 0) {
      const auto phase = walls.forcing.phase(begin);
      const double f0 = scene.force_amplitude;
      forced += bool(walls.short_contact.end({start.x, start.v, start.w, f0 * phase.sin, f0 * phase.cos}));
    }
    // What rounding makes of q, by what it is the sum of, over y' at the end.
    const auto slow = contact.slow_at(time), fast = contact.fast_at(time);
    const double size = std::abs(slow.q) + std::abs(fast.q) + std::abs(slow.w) * time * epsilon +
                        (std::abs(start.x) + std::abs(start.v)) / walls.stiffness +
                        std::abs(w) / std::sqrt(walls.stiffness);
    const double w1 = std::abs(expected->state.w);
    CHECK(std::abs(found->time - time) <= 16 * epsilon * time + 64 * epsilon * size / w1);
    const double rate = walls.fast.rate(), speed = std::abs(start.x) + std::abs(start.v) + std::abs(w) +
                                                   scene.force_amplitude * std::min(time, 1.0);
    const double off = std::abs(found->time - time);
    CHECK(std::abs(found->state.x - expected->state.x) <= 128 * epsilon * speed + speed * off);
    CHECK(std::abs(found->state.v - expected->state.v) <=
          128 * epsilon * speed + (scene.damper().mass_ratio * std::abs(w) * rate + speed) * off);
    CHECK(std::abs(found->state.w - expected->state.w) <=
          128 * epsilon * speed * (1 + scene.damper().mass_ratio) + (std::abs(w) * rate + speed) * off);
  }
  CHECK(left > 20000);
  CHECK(short_contacts > 5000);
  CHECK(lasting > 1000);
  CHECK(forced > 5000);
}

TEST_CASE_TEMPLATE("a contact that lasts ends when the certified search says, whatever it is told by", Force,
                   Forcing<double>, NoForcing<double>) {
  constexpr bool forced = std::is_same_v<Force, Forcing<double>>;
  reference::Random random(43);
  int told = 0, while_it_rings = 0, lasting = 0;
  for (int n = 0; n < 40000; ++n) {
    Scene scene = scene_of(random, forced);
    // The mass comes slowly to a wall that it is mostly pushed to.
    scene.damper().mass_ratio = random.log_uniform(1e-3, 1);
    scene.damping_ratio = random.chance(0.5) ? 0 : random.log_uniform(1e-4, 0.3);
    if (forced && random.chance(0.1)) scene.force_frequency = random.log_uniform(1e-3, 100);
    const System<double, Force> system(scene);
    Search<double> search{bounded_span(system)};
    const ContactModes<double, Force> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const Wall wall = random.chance(0.5) ? Wall::left : Wall::right;
    const double inward = wall == Wall::left ? -1 : 1;
    const State<double> start{inward * random.uniform(-0.5, 6), random.uniform(-3, 3),
                              wall == Wall::left ? 0.0 : 1.0, inward * random.log_uniform(1e-5, 3)};
    const Contact<double, Force> contact(walls, forced ? random.uniform(0, 100) : 0.0, start, wall);
    if (walls.coupled) continue;
    const auto end = SustainedContact<double, Force>(contact).end();
    if (!end) continue;
    ++told;
    const auto expected = contact.search_leave(100, search);
    CAPTURE(n);
    CHECK(expected.has_value());
    if (!expected) continue;
    const double time = expected->time, swing = walls.fast.half_period();
    while_it_rings += time < 3 * swing;
    lasting += time > 10 * swing;
    const auto slow = contact.slow_at(time), fast = contact.fast_at(time);
    const double size = std::abs(slow.q) + std::abs(fast.q) +
                        (std::abs(start.x) + std::abs(start.v) + scene.force_amplitude) / walls.stiffness +
                        std::abs(start.w) / std::sqrt(walls.stiffness);
    const double off = std::abs(end->time - time);
    CHECK(off <= 16 * epsilon * time + 64 * epsilon * size / std::abs(expected->state.w));
    const double speed = std::abs(start.x) + std::abs(start.v) + std::abs(start.w) +
                         scene.force_amplitude * std::min(time, 1.0);
    CHECK(std::abs(end->x - expected->state.x) <= 128 * epsilon * speed + speed * off);
    CHECK(std::abs(end->v - expected->state.v) <= 128 * epsilon * speed + 2 * speed * off);
    CHECK(std::abs(end->w - expected->state.w) <= 128 * epsilon * speed * (1 + scene.damper().mass_ratio) +
                                                      2 * (speed + size * walls.stiffness) * off);
  }
  MESSAGE(told, " told, ", while_it_rings, " while it rings, ", lasting, " lasting");
  CHECK(told > 5000);
  CHECK(lasting > 2000);
  if (forced) CHECK(while_it_rings > 500);
}

TEST_CASE("under a force x falls through zero, and turns, when the certified search says") {
  reference::Random random(23);
  int found_both = 0;
  for (int n = 0; n < 40000; ++n) {
    Scene scene = scene_of(random, true);
    if (random.chance(0.2)) scene.damping_ratio = random.uniform(0.9, 1.1);
    const System<double> system(scene);
    const double begin = random.uniform(0, 1000), until = random.uniform(0.1, 3);
    // Also where x begins at zero, or turns.
    const double x0 = random.chance(0.1) ? 0 : signed_log(random, 1e-3, 30),
                 v0 = random.chance(0.1) ? 0 : signed_log(random, 1e-3, 30);
    const ForcedMotion<double> motion(system.free, system.forcing, begin, x0, v0);
    Search<double> search{bounded_span(system)};
    for (std::size_t order = 0; order < 3; ++order) {
      const auto enclose = [&](double sign, double t) {
        return motion.enclosure_at(order, sign, t, search.span);
      };
      // The first fall, and then from there on the next one of the opposite sign.
      double from = 0, sign = enclose(1, 0).whole.g < 0 ? -1 : 1;
      for (int i = 0; i < 2; ++i) {
        const auto found = motion.falls(order, sign, from, until, search);
        const auto expected =
            isolate_fall<double>([&](double t) { return enclose(sign, t); }, from, until, search, 1.0);
        INFO("n ", n, ", order ", order, ", i ", i);
        CHECK(found.has_value() == expected.has_value());
        if (!found || !expected) break;
        ++found_both;
        const double slope = std::abs(enclose(sign, *expected).whole.g1);
        // The phase of the force is rounded where the motion begins, and where the search looks.
        const double phase = scene.force_frequency * (begin + until), damped = 1 + 2 * scene.damping_ratio;
        const double size = std::abs(x0) + std::abs(v0) + scene.force_amplitude * (4 + phase);
        CHECK(std::abs(*found - *expected) * slope <=
              16 * epsilon * (damped * damped * size + slope * *expected));
        from = *found;
        sign = -sign;
      }
    }
  }
  CHECK(found_both > 20000);
}

TEST_CASE("a contact with a wall softer than the spring ends when the mass first comes back") {
  // There both modes oscillate about as fast, and the short ways find a later return, too: only their proofs
  // exclude it. Without the proof of the short-contact map one end in a thousand is wrong, by much.
  reference::Random random(15);
  Search<double> search{infinite};
  int short_contacts = 0;
  for (int n = 0; n < 20000; ++n) {
    Scene scene;
    scene.damper().mass_ratio = random.log_uniform(1e-3, 100);
    scene.damper().restitution = random.uniform(0, 1);
    scene.damping_ratio = random.chance(0.4) ? 0 : random.log_uniform(1e-4, 3);
    scene.damper().wall_stiffness = random.log_uniform(1e-2, 1);
    const System<double> system(scene);
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const State<double> start{signed_log(random, 1e-3, 30), signed_log(random, 1e-3, 30), 0,
                              -random.log_uniform(1e-6, 30)};
    const Contact<double> contact(walls, 0.0, start, Wall::left);
    short_contacts += walls.short_contact && walls.short_contact.end({start.x, start.v, start.w});
    const auto found = contact.leave(1000, search), expected = contact.search_leave(1000, search);
    CAPTURE(n);
    CHECK(found.has_value() == expected.has_value());
    if (found && expected) CHECK(found->time == doctest::Approx(expected->time).epsilon(1e-6));
  }
  CHECK(short_contacts > 1000);
}

TEST_CASE("a free motion's derivatives fall through zero where the certified search finds it") {
  reference::Random random(14);
  Search<double> search{infinite};
  int fell = 0;
  for (int n = 0; n < 40000; ++n) {
    Scene scene = scene_of(random, false);
    scene.damping_ratio = random.chance(0.3) ? 0 : random.uniform(0, 1.5);
    const System<double> system(scene);
    const double x = random.chance(0.1) ? 0 : signed_log(random, 1e-6, 10), v = signed_log(random, 1e-6, 10);
    const ForcedMotion<double> swing(system.free, system.forcing, 0.0, x, v);
    const std::size_t order = n % 3;
    const double sign = random.sign(), from = random.chance(0.5) ? 0 : random.uniform(0, 10), until = 20;
    const auto found = swing.falls(order, sign, from, until, search);
    const auto expected = isolate_fall<double>(
        [&](double t) { return swing.enclosure_at(order, sign, t, infinite); }, from, until, search, 1.0);
    CAPTURE(n);
    const auto start = swing.enclosure_at(order, sign, from, infinite).whole;
    // From above; at a zero to rounding the two may take it for before or after.
    if (!(start.g > 1e-14 * (std::abs(x) + std::abs(v)))) continue;
    CHECK(found.has_value() == expected.has_value());
    if (!found || !expected) continue;
    ++fell;
    CHECK(*found == doctest::Approx(*expected).epsilon(1e-12));
  }
  CHECK(fell > 10000);
}

TEST_CASE("stuck masses, their release known, turn where the certified search finds it") {
  reference::Random random(19);
  Search<double> search{infinite};
  int turned = 0, released = 0;
  for (int n = 0; n < 20000; ++n) {
    Scene scene = scene_of(random, false);
    scene.damping_ratio = random.chance(0.3) ? 0 : random.uniform(0, 1);
    const System<double> system(scene);
    // Pressed on the left wall by x, and on the way further out or back.
    const double x = -random.log_uniform(1e-2, 30), v = signed_log(random, 1e-2, 30);
    Stuck<double> stuck(system, 0.0, x, v, Wall::left);
    if (!(stuck.leads_of_x()[2] > 0)) continue;
    const auto release = stuck.release(0, 100, search);
    if (!release) continue;
    ++released;
    const auto found = stuck.falls(1, -1, 0, *release, search);
    const auto expected = isolate_fall<double>(
        [&](double t) { return stuck.derivative_of_x(1, -1, t, infinite); }, 0.0, *release, search, 1.0);
    CAPTURE(n);
    CHECK(!stuck.falls(1, 1, 0, *release, search));
    CHECK(found.has_value() == (v < 0 && expected.has_value()));
    if (!found) continue;
    ++turned;
    // Off by what rounding makes of a phase, and of x', by its slope.
    const double slope = stuck.derivative_of_x(1, 1, *expected, infinite).whole.g1;
    CHECK(std::abs(*found - *expected) <=
          16 * epsilon * (system.stuck.half_period() + (std::abs(x) + std::abs(v)) / slope));
  }
  CHECK(turned > 2000);
  CHECK(turned < released);
}

TEST_CASE("x crosses zero and turns in a contact where the certified search finds it") {
  reference::Random random(16);
  Search<double> search{infinite};
  int fell = 0, lasting = 0;
  for (int n = 0; n < 20000; ++n) {
    Scene scene = scene_of(random, false);
    scene.damping_ratio = random.chance(0.4) ? 0 : random.log_uniform(1e-4, 0.3);
    const System<double> system(scene);
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    // Pressed on the wall by x, and on its way to zero or to a turn.
    const State<double> start{-random.log_uniform(1e-2, 30), signed_log(random, 1e-2, 30), 0,
                              -random.log_uniform(1e-6, 1)};
    const Contact<double> contact(walls, 0.0, start, Wall::left);
    const auto end = contact.leave(100, search);
    if (!end) continue;
    const std::size_t order = n % 2;
    const double sign = order == 0 ? -1 : start.v > 0 ? 1 : -1;
    const auto found = contact.falls(order, sign, 0, end->time, search);
    const auto expected =
        isolate_fall<double>([&](double t) { return contact.derivative_of_x(order, sign, t, infinite); }, 0.0,
                             end->time, search, contact.resolution());
    CAPTURE(n);
    CHECK(found.has_value() == expected.has_value());
    if (!found || !expected) continue;
    ++fell;
    lasting += *found > 10 * walls.fast.half_period();
    // Off by what rounding makes of x or x', by their slope.
    const auto slow = contact.slow_at(*expected), fast = contact.fast_at(*expected);
    const double slope = std::abs(contact.derivative_of_x(order, sign, *expected, infinite).whole.g1);
    const double size = std::abs(slow.x) + std::abs(fast.x) + std::abs(slow.v) + std::abs(fast.v) +
                        std::abs(start.x) + std::abs(start.v) + scene.damper().mass_ratio * std::abs(start.w);
    CHECK(std::abs(*found - *expected) <= 16 * epsilon * *expected + 64 * epsilon * size / slope);
  }
  CHECK(fell > 2000);
  CHECK(lasting > 1000);
}

TEST_CASE("of a function with known zeros the first between two ends is found, however close the next is") {
  reference::Random random(29);
  int found = 0, none = 0, close = 0, undecided = 0;
  const int all = 200000;
  for (int n = 0; n < all; ++n) {
    // c (t - z_0) (t - z_1) (t - z_2) (t - z_3), whose fourth derivative is 24 c, on [0, 1].
    std::array<double, 4> zeros{};
    for (double& z : zeros) z = random.uniform(-1, 2);
    const bool close_pair = random.chance(0.5);
    if (close_pair) {
      const double apart = random.log_uniform(1e-5, 1e-1), near = random.log_uniform(1e-4, 0.5);
      zeros[0] = random.chance(0.5) ? near : 1 - near;
      zeros[1] = zeros[0] + apart;
    }
    if (random.chance(0.1)) zeros[2] = 0;
    std::sort(zeros.begin(), zeros.end());
    const auto derivatives_at = [&](double t) {
      std::array<double, 3> u{1, 0, 0};
      for (const double z : zeros) {
        u[2] = u[2] * (t - z) + 2 * u[1];
        u[1] = u[1] * (t - z) + u[0];
        u[0] *= t - z;
      }
      return u;
    };
    const auto start = derivatives_at(0);
    const double sign = start[0] == 0 ? (start[1] > 0 ? 1 : -1) : (start[0] > 0 ? 1 : -1);
    const double scale = random.log_uniform(1e-3, 1e3) * sign;
    const auto at = [&](double t) {
      const auto u = derivatives_at(t);
      return SeriesAt<double>{scale * u[0], scale * u[1], scale * u[2]};
    };
    const SeriesAt<double> begin = at(0), end = at(1);
    const auto fall =
        fall_by_ends<double>(at, {0, begin.u, begin.u1}, {1, end.u, end.u1}, 24 * std::abs(scale), 1.0);
    CAPTURE(n);
    if (!fall) {
      undecided += !close_pair;
      continue;
    }
    std::size_t first = 0;
    while (first < 4 && !(zeros[first] > 0)) ++first;
    const bool falls = first < 4 && zeros[first] < 1;
    CHECK(fall->time.has_value() == falls);
    if (!fall->time || !falls) {
      ++none;
      continue;
    }
    ++found;
    const double zero = zeros[first], slope = std::abs(derivatives_at(zero)[1]);
    close += first < 3 && zeros[first + 1] - zero < 0.01;
    CHECK(fall->slope < 0);
    CHECK(std::abs(*fall->time - zero) <= 64 * epsilon * (1 + 1 / slope));
  }
  CHECK(undecided < all / 20);
  CHECK(found > all / 3);
  CHECK(none > all / 20);
  CHECK(close > all / 100);
}

TEST_CASE("in a short contact under a force x crosses zero and turns where the certified search says") {
  reference::Random random(31);
  int fell = 0, by_series = 0, close = 0, early = 0;
  for (int n = 0; n < 60000; ++n) {
    Scene scene = scene_of(random, true);
    if (random.chance(0.5)) {  // a force as fast as the wall gives way
      scene.force_frequency =
          random.log_uniform(0.01, 1) * std::sqrt(scene.damper().wall_stiffness / scene.damper().mass_ratio);
      scene.force_amplitude = scene.force_frequency * random.log_uniform(1e-2, 30);
    }
    const System<double> system(scene);
    Search<double> search{bounded_span(system)};
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    if (!walls.short_contact || !(walls.x_in_short_contact.end() > 0)) continue;
    const Wall wall = random.chance(0.5) ? Wall::left : Wall::right;
    const double inward = wall == Wall::left ? -1 : 1,
                 begin = random.uniform(0, 100) / std::max(scene.force_frequency, 1.0);
    const double w = random.log_uniform(1e-3, 30) * inward;
    // What the contact changes x' and x by tells how large these are if they vanish in it.
    const double kick = scene.damper().mass_ratio / (1 + scene.damper().mass_ratio) * std::abs(w),
                 swing = walls.fast.half_period();
    State<double> start{signed_log(random, 1e-3, 30), signed_log(random, 1e-3, 2) * kick,
                        wall == Wall::left ? 0.0 : 1.0, w};
    if (random.chance(0.5)) start.x = signed_log(random, 1e-4, 1) * (std::abs(start.v) + kick) * swing;
    const std::size_t order = n % 2;
    const auto enclose = [&](const Contact<double>& of, double sign, double t) {
      return of.derivative_of_x(order, sign, t, search.span);
    };
    const bool aimed = order == 1 && random.chance(0.5);
    if (aimed) {
      // Twice x' is shifted by what it is at a turn of its own: it has two close zeros there, or none.
      const double off = random.log_uniform(1e-9, 1e-2) * random.sign() * kick;
      const int first = random.chance(0.5) ? 1 : 32;  // of 64 parts of the contact, in which it is sought
      bool turned = true;
      for (int i = 0; i < 3 && turned; ++i) {
        const Contact<double> contact(walls, begin, start, wall);
        const auto end = contact.leave(100, search);
        const double part = end ? end->time / 64 : 0;
        const auto x2 = [&](double t) { return enclose(contact, 1, t).whole.g1; };
        int k = first;
        while (k < 64 && (x2((k - 1) * part) > 0) == (x2(k * part) > 0)) ++k;
        turned = end && k < 64;
        if (!turned) break;
        double low = (k - 1) * part, high = k * part;
        const bool rises = x2(high) > 0;
        for (int halving = 0; halving < 40; ++halving) {
          const double middle = (low + high) / 2;
          ((x2(middle) > 0) == rises ? high : low) = middle;
        }
        start.v += (i < 2 ? 0 : off) - contact.at(low).v;
      }
      if (!turned) continue;
    }
    const Contact<double> contact(walls, begin, start, wall);
    const auto end = contact.leave(100, search);
    if (!end) continue;
    // One after the other, each of the opposite sign.
    double from = 0, sign = enclose(contact, 1, 0).whole.g < 0 ? -1 : 1;
    for (int i = 0; i < 4; ++i) {
      const auto steps = search.steps_left;
      const auto found = contact.falls(order, sign, from, end->time, search);
      by_series += search.steps_left == steps;
      const auto expected = isolate_fall<double>([&](double t) { return enclose(contact, sign, t); }, from,
                                                 end->time, search, contact.resolution());
      INFO("n ", n, ", i ", i);
      const auto slow = contact.slow_at(end->time), fast = contact.fast_at(end->time);
      const double rate = walls.fast.rate(),
                   speed = std::abs(start.v) + kick + std::abs(slow.v) + std::abs(fast.v) +
                           scene.force_amplitude / rate,
                   size = order == 1 ? speed
                                     : std::abs(start.x) + std::abs(slow.x) + std::abs(fast.x) + speed / rate;
      CHECK(found.has_value() == expected.has_value());
      if (!found || !expected) break;
      ++fell;
      const auto there = enclose(contact, sign, *expected).whole;
      const double slope = std::abs(there.g1);
      CHECK(std::abs(*found - *expected) * slope <= 16 * epsilon * slope * *expected + 128 * epsilon * size);
      close += i > 0 && *found - from < 0.01 * swing;
      if (*found * rate < 0.5) {
        ++early;
        const double begun = order == 1 ? std::abs(start.v) : std::abs(start.x) + std::abs(start.v) * *found;
        CHECK(std::abs(*found - *expected) * slope <= 256 * epsilon * (begun + slope * *found));
      }
      if (*found - from <= 0) break;
      from = *found;
      sign = -sign;
    }
  }
  CHECK(fell > 15000);
  CHECK(by_series > 30000);
  CHECK(close > 1000);
  CHECK(early > 5000);
}

TEST_CASE("the derivatives of x in a rebound stay within their bounds") {
  reference::Random random(17);
  for (const bool forced : {false, true}) {
    std::array<double, 4> reached{};
    for (int n = 0; n < 4000; ++n) {
      const Scene scene = scene_of(random, forced);
      const System<double> system(scene);
      const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
      if (!walls.short_contact) continue;
      State<double> start{signed_log(random, 1e-3, 30), signed_log(random, 1e-3, 30), 0,
                          -random.log_uniform(1e-6, 30)};
      if (forced && n % 2 == 0) start.x = start.v = start.w = 0;  // what the force does alone
      const double begin = forced ? random.uniform(0, 1000) : 0, f0 = scene.force_amplitude;
      const Contact<double> contact(walls, begin, start, Wall::left);
      const auto phase = walls.forcing.phase(begin);
      const std::array<double, 5> columns{start.x, start.v, start.w, f0 * phase.sin, f0 * phase.cos};
      const auto& map = walls.short_contact;
      const std::array<double, 4> bounds{map.second_of_x(columns), map.third_of_x(columns),
                                         map.fourth_of_x(columns), map.fifth_of_x(columns)};
      const double latest = forced ? map.latest() : 2 * walls.fast.half_period();
      for (int i = 0; i <= 64; ++i) {
        const double t = i / 64.0 * latest;
        Derivatives<double, 6> x{}, q{};
        walls.derive(contact.sum_at(t), x, q, walls.forcing.derivatives<6>(walls.forcing.phase(begin + t)));
        for (std::size_t k = 0; k < 4; ++k) reached[k] = std::max(reached[k], std::abs(x[k + 2]) / bounds[k]);
      }
    }
    for (const double each : reached) {
      CAPTURE(forced);
      CHECK(each <= 1 + 1e-9);
      CHECK(each > (forced ? 0.4 : 0.5));
    }
  }
}

TEST_CASE("the series of x in a short contact is its motion") {
  reference::Random random(37);
  double off = 0, off_v = 0;
  int told = 0;
  for (int n = 0; n < 4000; ++n) {
    Scene scene = scene_of(random, true);
    const System<double> system(scene);
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const auto& table = walls.x_in_short_contact;
    if (!walls.short_contact || !(table.end() > 0)) continue;
    ++told;
    const State<double> start{signed_log(random, 1e-3, 30), signed_log(random, 1e-3, 30), 0,
                              -random.log_uniform(1e-3, 30)};
    const double begin = random.uniform(0, 10), f0 = scene.force_amplitude, rate = walls.fast.rate();
    const Contact<double> contact(walls, begin, start, Wall::left);
    const auto phase = walls.forcing.phase(begin);
    const XInShortContact<double> x(table, {start.x, start.v, start.w, f0 * phase.sin, f0 * phase.cos},
                                    table.end());
    const double speed = std::abs(start.v) +
                         scene.damper().mass_ratio / (1 + scene.damper().mass_ratio) * std::abs(start.w) +
                         (std::abs(start.x) + f0) / rate;
    for (int i = 0; i <= 32; ++i) {
      const double t = i / 32.0 * table.end();
      const auto now = contact.sum_at(t);
      const auto by_x = x.x_at(t), by_v = x.v_at(t);
      off = std::max(off, std::abs(by_x.u - now.x) / (std::abs(start.x) + speed / rate));
      off_v = std::max(off_v, std::max(std::abs(by_x.u1 - now.v), std::abs(by_v.u - now.v)) / speed);
    }
  }
  CHECK(told > 1000);
  CHECK(off < 64 * epsilon);
  CHECK(off_v < 64 * epsilon);
}

TEST_CASE("the next turn of a secondary mass at rest away from the walls is found") {
  // x = -0.1 cos t + sin t, so y' = 1 - cos t - 0.1 sin t: zero at 0 and where tan(t/2) = 0.1.
  const Scene scene;
  const System<double, NoForcing<double>> system(scene);
  Search<double> search{infinite};
  for (const double side : {1.0, -1.0}) {
    const Flight<double, NoForcing<double>> flight(system, 0.0, {-0.1 * side, side, 0.5, 0});
    const auto turn = flight.turn_of_y(-side, 0, 1, search);
    REQUIRE(turn);
    CHECK(*turn == doctest::Approx(2 * std::atan(0.1)).epsilon(1e-14));
  }
}

// --- Certified search --------------------------------------------------------------------------------------

namespace {

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
  Search<double> search{infinite};
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
  INFO("c.c0 ", c.c0, ", c.c1 ", c.c1, ", c.c2 ", c.c2, ", c.c3 ", c.c3, ", c.a ", c.a, ", c.w ", c.w);
  INFO("c.p ", c.p, ", horizon ", horizon);
  const double t = found ? found->time : horizon, resolved = 4 * epsilon * (t + 1 / c.w);
  if (found) CHECK(std::abs(c.g(Long(t))) <= noise + resolved * std::abs(c.g1(t)));
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
    INFO("n ", n, ", jet.g ", jet.g, ", jet.g1 ", jet.g1, ", jet.g2 ", jet.g2, ", jet.third ", jet.third);
    INFO("most ", most, ", step ", step);
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
    Search<double> search{infinite};
    const auto found =
        first_root<double>([&](double t) { return std::array{c.enclose(t)}; }, 0.0, horizon, search, 1 / c.w);
    INFO("n ", n, ", rise ", rise);
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
    Search<double> search{infinite};
    const auto found =
        first_root<double>([&](double t) { return flight.gaps(t, search.span); }, 0.0, horizon, search, 1.0);
    const double noise =
        4 * epsilon * (1 + 20 * std::abs(scene.damper().w0) + std::abs(scene.x0) + 20 * std::abs(scene.v0));
    const auto left = first_below(y, w, 0, horizon, noise, 100);
    const auto right =
        first_below([&](auto t) { return 1 - y(t); }, [&](auto t) { return -w(t); }, 0, horizon, noise, 100);
    INFO("n ", n, ", x0 ", scene.x0, ", v0 ", scene.v0, ", y0 ", scene.damper().y0);
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
