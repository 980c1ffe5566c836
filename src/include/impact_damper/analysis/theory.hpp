// Closed forms for this system: the program is tested against them, and figures draw them beside its results.
//
// Throughout: e restitution, b = (1 - e)/(1 + e), A peak amplitude of the primary mass divided by epsilon,
// loss factors per radian and divided by the mass ratio, zeta = 0. "nu -> 0" means that the primary mass
// moves as x = -A cos(t + const), with an amplitude that changes by a fraction of order nu per cycle; the
// relative errors are then of order nu. Each function has a sketch of its derivation; tests/theory.cpp
// compares each with a small computation that does not use it. Arguments outside the ranges that are stated
// give meaningless numbers; nothing is thrown.
#pragma once

#include <optional>
#include <vector>

namespace impact_damper {

double asymmetry(double restitution);  // b = (1 - e)/(1 + e), from 1 for e = 0 to 0 for e = 1

// --- One impact per half cycle, equally spaced, nu -> 0 ---------------------------------------------------
// The mass flies at constant absolute speed V for half a period, pi. It leaves the left wall where the
// wall is at -A cos(theta), with velocity A sin(theta); by symmetry it meets the right wall where that is at
// 1 + A cos(theta): pi V = 1 + 2 A cos(theta). The impact turns -V into V: V - v = e (V + v), so the wall's
// speed is v = A sin(theta) = b V. Eliminating theta leaves a quadratic in V, whose larger root is stable.
struct SingleImpact {
  double speed = 0;      // V, absolute, divided by epsilon Omega_n
  double theta = 0;      // in radians, after the wall's extreme position, 0 to pi
  double phase_deg = 0;  // 90 + theta in degrees: counted from the zero crossing, as in the paper
  double loss = 0;       // eta / nu = 4 b V^2 / (pi A^2): each impact costs nu 2 b V^2, a cycle has two
};
// Absent below the fold. e in [0, 1), A > 0.
std::optional<SingleImpact> single_impact(double restitution, double amplitude);
// A = b / sqrt(pi^2 + 4 b^2), where the two roots coincide; below it this motion does not exist: impact
// failure.
double fold_amplitude(double restitution);
// A = b / pi: V/A is largest where theta = 90 degrees, and the loss is then eta/nu = (4/pi) (1 + e)/(1 - e).
// e < 1 for both.
double peak_loss_amplitude(double restitution);
double peak_loss(double restitution);
// The amplitude of the peak of A eta/nu next to the fold. By the angle, V = 1/(pi - 2 b cot(theta)) and
// A eta/nu = 4 b V^2/(pi A) = 4 V sin(theta)/pi, which is stationary where 2 b t^2 - pi t + 4 b = 0, t =
// tan(theta): the larger root is the peak. NaN for e < 0.286, where pi^2 < 32 b^2 and there is none; e < 1.
double peak_product_amplitude(double restitution);
// The amplitude above which equal spacing is unstable (a multiplier of the map from impact to impact passes
// -1): A cos(theta) = 2/(pi^2 - 4), V = pi/(pi^2 - 4), for every e.
// Linearised at the fixed point, the map from one departure (phase, speed) to the next is
//   d phase' = e d phase - g d speed,  d speed' = e d speed + (1 + e) c d phase',
// g = pi (1 + e)/(2 V), c = A cos(theta): determinant e^2, trace 2 e - (1 + e) c g.
double equal_spacing_amplitude(double restitution);

// --- Bounce-down that ends stuck, nu -> 0 -----------------------------------------------------------------
// Released at x = 0 by a wall of speed A, the mass flies straight while x = A sin(t): the far wall is met
// where A (t* - sin t*) = 1, at relative speed w = A (1 - cos t*).
struct StuckRelease {
  double time = 0;   // t*, in (0, pi]
  double speed = 0;  // w, relative, at the far wall
  // eta/nu = w^2 / (pi A^2): nu w^2 / 2 is lost in each half cycle. Exact for e = 0; for e > 0 see
  // BounceDown::loss.
  double loss = 0;
};
// A >= 1/pi (the far wall is met before x returns to 0).
StuckRelease stuck_release(double amplitude);

// Plastic impacts, e = 0, x = A sin(tau), one on each wall in a cycle: up to A = 1/pi the mass flies on at
// once (single_impact), above it sticks to its wall until x = 0 (stuck_release). z'' has at the fundamental
// frequency the part A (in_phase sin(tau) + loss cos(tau)), with x'' being -A sin(tau); in_phase is -1 for a
// mass that is locked, loss is eta/nu. By (M14.10), a force of frequency w then holds (M14.11)
//   (f0/A)^2 = (1 - w^2 (1 - nu in_phase))^2 + (nu w^2 loss)^2.
struct PlasticImpacts {
  double in_phase = 0, loss = 0;
};
PlasticImpacts plastic_impacts(double amplitude);  // >= fold_amplitude(0)
// The frequencies w of it, the lower first: none, two or, where f0 > A, the upper one alone.
std::vector<double> plastic_frequencies(double mass_ratio, double force_amplitude, double amplitude);

// The same with the bounces that follow: under the falling relative acceleration A sin(t) each flight of
// the mass from the far wall is a bounce at a known speed, and each bounce loses nu (1 - e^2) w^2 / 2.
struct BounceDown {
  std::vector<double> time;   // of the bounces at the far wall, from release; the first is t*
  std::vector<double> speed;  // relative speed at which the wall is met
  bool sticks = false;        // they accumulate before x returns to 0
  double accumulation = 0;    // the time of it, if sticks
  double loss = 0;            // eta/nu of the bounces listed (and of the rest, if sticks)
};
// e in [0, 1), A >= 1/pi. Follows at most 1000 bounces; they count as accumulated once the remaining ones
// would last at most 1e-6, and at most 1e-6 of the time left until x = 0.
BounceDown bounce_down(double restitution, double amplitude);
// The amplitude at which the bounces accumulate just as x returns to 0, by bisection to 1e-12 of it:
// 2.05 for e = 0.4, 5.23 for 0.6, 21.6 for 0.8. e in [0, 0.95].
double bounce_down_end(double restitution);

// --- Friction and weight -----------------------------------------------------------------------------------
// The largest amplitude at which a secondary mass that does not move in its cavity stays there (M18.4) and
// damps nothing: omega^2 A = |x''| <= most. omega: the frequency of the motion, > 0; without damping and
// force 1/sqrt(1 + nu). most >= 0: phi_s; on the floor of a cavity that is not level phi_s + gamma.
double locking_amplitude(double omega, double most);

// Under a constant relative acceleration a > 0 into the wall and a first rebound speed w0 >= 0 the bounces
// accumulate after T = sum of 2 w0 e^n / a over n >= 0 = 2 w0 / (a (1 - e)). e < 1.
double accumulation_time(double restitution, double acceleration, double rebound_speed);

}  // namespace impact_damper
