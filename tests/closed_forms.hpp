// Closed forms that only tests hold the program against. Conventions as in analysis/theory.hpp.
#pragma once

#include <vector>

namespace impact_damper {

// --- One impact, any nu -----------------------------------------------------------------------------------
// y' = w becomes -e w and (1 + nu) v + nu w is conserved.
struct ImpactOutcome {
  double v = 0, w = 0;  // primary velocity and relative velocity afterwards
  double loss = 0;      // nu (1 - e^2) w^2 / (2 (1 + nu)), by K epsilon^2
};
ImpactOutcome impact(double mass_ratio, double restitution, double v, double w);

// --- Two equal impacts per cycle under a force f0 sin(omega t), any nu, zeta = 0, rigid walls --------------
// Masri and Caughey's kind of solution. Seconds from a departure from the left wall, T = pi/omega:
//   x = C sin(omega t + tau) - nu V sin(t - T/2) / cos(T/2),  z = x(0) + V t,  0 < t < T,
// C = f0/(1 - omega^2); the free part is fixed by x(t + T) = -x(t) and by the jumps -2 nu V of x'. Meeting
// the right wall asks for a V = 1 - 2 C sin(tau), a = pi/omega + 2 nu tan(T/2), the restitution for
// cos(tau) = q V / C, q = b (1 + nu)/omega; tau eliminated, V solves a quadratic.
struct ForcedTwoImpact {
  double speed = 0;  // V > 0, absolute
  double tau = 0;    // phase of the force at the departure from the left wall, radian, in (-pi, pi]
  // The state in which a scene with this force starts at its time 0 on this motion.
  double x0 = 0, v0 = 0, y0 = 0, w0 = 0;
  bool within_walls = false;      // 0 < y < 1 strictly inside the flight: without it there is no such motion
  double largest_multiplier = 0;  // modulus, of the map from half period to half period: stable if < 1
};
// Both roots with V > 0, the faster first; none below |C| = q / sqrt(a^2 + 4 q^2), at resonance, and where
// cos(T/2) = 0 (omega an odd fraction of 1).
std::vector<ForcedTwoImpact> forced_two_impact(double mass_ratio, double restitution, double force_amplitude,
                                               double force_frequency);

// --- What a wall delivers ---------------------------------------------------------------------------------
// Damping ratio z in [0, 1) of q'' + 2 z q' + q = 0 during a contact that a unit velocity begins.
double restitution_by_displacement(double z);  // until q = 0: exp(-pi z / sqrt(1 - z^2))
double restitution_by_force(double z);         // until q'' = 0: exp(-2 z arccos(z) / sqrt(1 - z^2))
// With the paper's zeta_m, which a fixed wall calibrates, on a free primary mass: z = zeta_m sqrt(1 + nu).
double delivered_restitution(double restitution, double mass_ratio);
double delivered_restitution_without_pull(double restitution, double mass_ratio);

// --- Central differences ----------------------------------------------------------------------------------
// Largest stable omega h of q'' + 2 z omega q' + omega^2 q = 0. Centred damping: 2 at any z. Velocity one
// step behind: the root -1 of lambda^2 + (s^2 + 2 z s - 2) lambda + 1 - 2 z s is reached at s^2 + 4 z s = 4,
// s = 2 (sqrt(1 + z^2) - z).
double stable_step_centred();
double stable_step_lagged(double z);

}  // namespace impact_damper
