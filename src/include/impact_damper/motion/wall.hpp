// The wall: a spring k and a damper that together give the restitution e.
//
// In contact the wall pushes with F = 2 omega_m zeta_m q' + omega_m^2 q per unit secondary mass
// (equations 5-8), omega_m = sqrt(k/nu). Contact lasts from the wall position to the return to it.
#pragma once

#include "impact_damper/engine.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

// zeta_m for which a secondary mass bouncing on a wall that stands still keeps the fraction e of its speed
// (M2.4). e in [0, 1]: 0 gives 1 (no rebound), 1 gives 0.
template <class Real>
Real zeta_m_closed_form(const Real& restitution) {
  if (restitution <= 0) return 1;
  const Real l = -logarithm(restitution), p = half_turn<Real>();
  return l / square_root(Real(p * p + l * l));
}

// The same number, found as the paper's subroutine does: simulate the impact of a unit velocity on the spring
// and damper by stepping closed-form solutions through at least 100 steps, compare the velocity at the return
// to the wall with e, and correct zeta_m until they agree.
struct IterativeZeta {
  double zeta_m = 0;
  double velocity_error = 0;  // |rebound velocity - e| at the end, <= tolerance
  int steps = 0;              // taken through the last simulated impact, >= 100
};
IterativeZeta zeta_m_iterative(double restitution, double tolerance = 1e-8);

// zeta_m that an engine uses: fixed_wall as above; two_body divides by sqrt(1 + nu), so that the
// delivered restitution between two free masses is e exactly.
template <class Real = double>
Real zeta_m(const SceneDamper& damper, Calibration calibration) {
  const Real fixed = zeta_m_closed_form(Real(damper.restitution));
  switch (calibration) {
    case Calibration::fixed_wall:
      return fixed;
    case Calibration::two_body:
      return fixed / square_root(Real(1 + Real(damper.mass_ratio)));
  }
  return fixed;
}

// omega_m = sqrt(k/nu). In a contact between two otherwise free masses the frequency is omega_c = omega_m
// sqrt(1 + nu) and the damping ratio zeta_m sqrt(1 + nu).
double omega_m(const SceneDamper& damper);

// pi / omega_c: half a period of the contact, the nominal duration of one impact. With a law of its own the
// wall counts as linear and as stiff as it is on average over the overlap that an impact at WallLaw::speed
// reaches without losses.
double nominal_contact_time(const SceneDamper& damper);

}  // namespace impact_damper
