#include "impact_damper/analysis/theory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {
constexpr double pi = std::numbers::pi;
constexpr int most_bounces = 1000;
double square(double x) { return x * x; }

// The secondary mass at the far wall, under the relative acceleration A sin(t).
struct Bounce {
  double time, speed;  // the relative speed at which it meets the wall
};

double time_to_accumulation(double e, double a, const Bounce& at) {
  return accumulation_time(e, a * sin_cos(at.time).sin, e * at.speed);
}

// The bounce after `at`; absent if the mass is not back at the wall before t = pi.
std::optional<Bounce> next_bounce(double e, double a, const Bounce& at) {
  const double t = at.time, u = e * at.speed, left = pi - t;
  const SinCos<double> turn = sin_cos(t);
  const double sin_t = turn.sin, cos_t = turn.cos;
  // Distance from the wall after s: u s + A (cos(t) (sin(s) - s) - sin(t) (1 - cos(s))), concave up to
  // t + s = pi: at most one return, and Newton's steps from behind it fall onto it from above.
  struct After {
    double distance, speed;
  };
  const auto after = [&](double s) {
    const auto [sin, cos] = sin_cos(s / 2);
    return After{u * s + a * (cos_t * (2 * sin * cos - s) - sin_t * 2 * square(sin)),
                 u - 2 * a * sin * (sin_t * cos + cos_t * sin)};
  };
  // Newton's method starts behind the return: where an acceleration that falls linearly from A sin(t) to 0
  // would bring the mass back, as the sine lies above its chord: u = A sin(t) (s / 2 - s^2 / (6 left)). That
  // s exists within `left` if r = u / (A sin(t)) is below a third of that.
  const double r = u / (a * sin_t);
  double s = left;
  if (r < left / 3) {
    s = 4 * r / (1 + std::sqrt(1 - 8 * r / (3 * left)));
  } else if (!(after(left).distance < 0)) {
    return std::nullopt;
  }
  After there = after(s);
  for (double next; (next = s - there.distance / there.speed) < s; there = after(s)) s = next;
  return Bounce{t + s, -there.speed};
}

Bounce first_bounce(double amplitude) {
  const StuckRelease release = stuck_release(amplitude);
  return {release.time, release.speed};
}

// Whether the bounces accumulate before t = pi. From t = pi/2 on the acceleration falls, so that each bounce
// returns a speed below e times the last one's. If all flights end within half of the time left, the
// acceleration is half of A sin(t) or more in them, and they take twice time_to_accumulation at most: they do
// end there if that is a quarter of the time left.
bool accumulates(double e, double a) {
  std::optional<Bounce> at = first_bounce(a);
  for (int n = 0; at && n < most_bounces; ++n, at = next_bounce(e, a, *at))
    if (at->time >= pi / 2 && time_to_accumulation(e, a, *at) <= (pi - at->time) / 4) return true;
  return false;
}
}  // namespace

double asymmetry(double restitution) { return (1 - restitution) / (1 + restitution); }

std::optional<SingleImpact> single_impact(double restitution, double amplitude) {
  const double b = asymmetry(restitution), a = amplitude;
  const double denominator = square(pi) + 4 * square(b);
  const double discriminant = square(pi) - denominator * (1 - 4 * square(a));
  if (!(discriminant >= 0)) return std::nullopt;
  SingleImpact motion;
  motion.speed = (pi + std::sqrt(discriminant)) / denominator;
  motion.theta = angle_of(b * motion.speed, (pi * motion.speed - 1) / 2);
  motion.phase_deg = 90 + motion.theta * 180 / pi;
  motion.loss = 4 * b * square(motion.speed / a) / pi;
  return motion;
}

double fold_amplitude(double restitution) {
  const double b = asymmetry(restitution);
  return b / std::sqrt(square(pi) + 4 * square(b));
}

double peak_loss_amplitude(double restitution) { return asymmetry(restitution) / pi; }

double peak_loss(double restitution) { return 4 / (pi * asymmetry(restitution)); }

double peak_product_amplitude(double restitution) {
  const double b = asymmetry(restitution);
  const double tangent = (pi + std::sqrt(square(pi) - 32 * square(b))) / (4 * b);
  const double sine = tangent / std::sqrt(1 + square(tangent));
  return b / (sine * (pi - 2 * b / tangent));
}

double equal_spacing_amplitude(double restitution) {
  return std::sqrt(4 + square(asymmetry(restitution) * pi)) / (square(pi) - 4);
}

StuckRelease stuck_release(double amplitude) {
  // t - sin t = 1/A: convex and rising on [0, pi], so Newton's steps from pi fall onto the root from above.
  StuckRelease release;
  const auto newton = [&](double t) {
    const auto [sin, cos] = sin_cos(t);
    return t - (t - sin - 1 / amplitude) / (1 - cos);
  };
  double t = pi;
  for (double next; (next = newton(t)) < t;) t = next;
  release.time = t;
  release.speed = 2 * amplitude * square(sin_cos(t / 2).sin);
  release.loss = square(release.speed / amplitude) / pi;
  return release;
}

PlasticImpacts plastic_impacts(double amplitude) {
  if (amplitude < 1 / pi) {
    // The impulses 2 V on the mass at the phases theta - pi/2 and theta + pi/2.
    const auto motion = single_impact(0, amplitude);
    if (!motion) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    return {-4 * motion->speed * sin_cos(motion->theta).cos / (pi * amplitude), motion->loss};
  }
  // The impulse A (1 - cos t*) at t*, then x'' until x = 0.
  const StuckRelease release = stuck_release(amplitude);
  const auto [sin, cos] = sin_cos(release.time);
  return {-(2 * (1 - cos) * sin + pi - release.time + sin * cos) / pi, release.loss};
}

std::vector<double> plastic_frequencies(double mass_ratio, double force_amplitude, double amplitude) {
  const PlasticImpacts impacts = plastic_impacts(amplitude);
  const double a = 1 - mass_ratio * impacts.in_phase, b = mass_ratio * impacts.loss,
               f = force_amplitude / amplitude, squares = square(a) + square(b),
               discriminant = square(a) - squares * (1 - square(f));
  if (!(discriminant >= 0)) return {};
  std::vector<double> frequencies;
  for (const double sign : {-1, 1})
    if (const double of_square = a + sign * std::sqrt(discriminant); of_square > 0)
      frequencies.push_back(std::sqrt(of_square / squares));
  return frequencies;
}

BounceDown bounce_down(double restitution, double amplitude) {
  constexpr double short_rest = 1e-6;  // of the time left: the acceleration changes by as little in the rest
  const double e = restitution, a = amplitude;
  BounceDown bounces;
  double squares = 0;
  std::optional<Bounce> at = first_bounce(a);
  for (int n = 0; at && n < most_bounces; ++n, at = next_bounce(e, a, *at)) {
    bounces.time.push_back(at->time);
    bounces.speed.push_back(at->speed);
    const double rest = time_to_accumulation(e, a, *at);
    if (rest <= short_rest * std::min(1.0, pi - at->time)) {
      bounces.sticks = true;
      bounces.accumulation = at->time + rest;
      squares += square(at->speed);
      break;
    }
    squares += (1 - e * e) * square(at->speed);
  }
  bounces.loss = squares / (pi * square(a));
  return bounces;
}

double bounce_down_end(double restitution) {
  double low = 1 / pi;
  if (accumulates(restitution, low)) return low;
  double high = 2 * low;
  while (!accumulates(restitution, high)) {
    low = high;
    high *= 2;
  }
  while (high - low > 1e-12 * high) {  // below that the rounding of the last bounces decides
    const double middle = low + (high - low) / 2;
    (accumulates(restitution, middle) ? high : low) = middle;
  }
  return high;
}

double locking_amplitude(double omega, double most) { return most / square(omega); }

double accumulation_time(double restitution, double acceleration, double rebound_speed) {
  return 2 * rebound_speed / (acceleration * (1 - restitution));
}

}  // namespace impact_damper
