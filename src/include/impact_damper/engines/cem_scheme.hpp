// Central differences for one regime of the impact damper, solved for the new step.
//
// With u = (x, q), q the overlap's coordinate (y in flight and at the left wall, y - 1 at the right),
// equations (3)-(8) read M u'' + C u' + K u = (f, 0),
//     M = [1 0; 1 1],   C = [2 zeta, -nu c; 0, c],   K = [1, -k; 0, k/nu],   c = 2 omega_m zeta_m,
// and c = k = 0 in flight. u'' -> (u_{n+1} - 2 u_n + u_{n-1}) / h^2, u' -> (u_{n+1} - u_{n-1}) / 2h. Written
// for the increments d_n = u_n - u_{n-1} instead of the positions (a rounding error then costs eps t / h,
// not eps t / h^2):
//     (M + h C/2) d_{n+1} = (M - h C/2) d_n + h^2 ((f_n, 0) - K u_n).        (M9.1)
// `lagged` takes the wall damper's velocity from d_n / h: its c moves from the left side to the right and
// counts twice there. The damper of the primary mass is centred always: that costs nothing, and a limit
// h < 1/zeta would have nothing to do with the wall.
#pragma once

#include <algorithm>
#include <cstdint>

#include "impact_damper/engine.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/forcing.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

enum class Regime { flight, contact, stuck };

// The numbers in the equations of a regime.
template <class Real>
struct RegimeEquations {
  Real nu{}, zeta{};
  Real c{};        // 2 omega_m zeta_m, 0 in flight
  Real omega_2{};  // omega_m^2 = k/nu, 0 in flight

  struct Acceleration {
    Real x, q;
  };
  Acceleration acceleration(const Real& x, const Real& v, const Real& q, const Real& w, const Real& f) const {
    const Real force = c * w + omega_2 * q;
    const Real primary = f + nu * force - (2 * zeta * v + x);
    return {primary, -force - primary};
  }
};

template <class Real>
RegimeEquations<Real> regime_equations(const Scene& scene, const SceneDamper& damper, Calibration calibration,
                                       Regime regime) {
  RegimeEquations<Real> equations{.nu = damper.mass_ratio, .zeta = scene.damping_ratio, .c = 0, .omega_2 = 0};
  if (regime == Regime::flight) return equations;
  equations.omega_2 = Real(damper.wall_stiffness) / equations.nu;
  equations.c = 2 * square_root(equations.omega_2) * zeta_m<Real>(damper, calibration);
  return equations;
}

// x_{n+1} - x_n = dx_dx (x_n - x_{n-1}) + dx_dq (q_n - q_{n-1}) + dx_x x_n + dx_q q_n + dx_f f_n, and so on.
template <class Real>
struct CemStep {
  Real dx_dx, dx_dq, dx_x, dx_q, dx_f;
  Real dq_dx, dq_dq, dq_x, dq_q, dq_f;
};

template <class Real>
CemStep<Real> cem_step(const RegimeEquations<Real>& equations, Damper damper, const Real& h) {
  const auto& [nu, zeta, c, omega_2] = equations;
  const bool centred = damper == Damper::centred;
  const Real ahead = centred ? h * c / 2 : Real(0);  // the wall damper's share of the left side,
  const Real behind = centred ? h * c / 2 : h * c;   // and of the right
  const Real outer = h * zeta, h_2 = h * h, spring = h_2 * omega_2;
  const Real determinant = (1 + outer) * (1 + ahead) + nu * ahead;
  // The inverse of M + h C/2, times h^2 for the forces.
  const Real xx = (1 + ahead) / determinant, xq = nu * ahead / determinant;
  const Real qx = -1 / determinant, qq = (1 + outer) / determinant;
  return {
      .dx_dx = xx * (1 - outer) + xq,
      .dx_dq = xx * nu * behind + xq * (1 - behind),
      .dx_x = -h_2 * xx,
      .dx_q = spring * (xx * nu - xq),
      .dx_f = h_2 * xx,
      .dq_dx = qx * (1 - outer) + qq,
      .dq_dq = qx * nu * behind + qq * (1 - behind),
      .dq_x = -h_2 * qx,
      .dq_q = spring * (qx * nu - qq),
      .dq_f = h_2 * qx,
  };
}

// The step of both masses joined (M9.5) in the same form (M9.8).
template <class Real>
CemStep<Real> cem_step_stuck(const Real& nu, const Real& zeta, const Real& h) {
  const Real mass = 1 + nu, outer = h * zeta, h_2 = h * h;
  CemStep<Real> step{};
  step.dx_dx = (mass - outer) / (mass + outer);
  step.dx_x = -h_2 / (mass + outer);
  step.dx_f = h_2 / (mass + outer);
  return step;
}

template <class Real>
Real value_of(const Forcing<Real>& force, const Real& time) {
  return force ? force.amplitude * sin_cos(Real(force.frequency * time)).sin : Real(0);
}
template <class Real>
Real rate_of(const Forcing<Real>& force, const Real& time) {
  return force ? force.amplitude * force.frequency * sin_cos(Real(force.frequency * time)).cos : Real(0);
}

// The force f_n at the next step, by f_{n+1} - 2 f_n + f_{n-1} = -4 sin^2(omega_f h/2) f_n; computed afresh
// at every 1024th step, before rounding can add up.
template <class Real>
struct ForceAtSteps {
  static constexpr std::int64_t block = 1024;

  ForceAtSteps() = default;
  // time: that of the next step.
  ForceAtSteps(const Forcing<Real>& force, const Real& time, const Real& h) {
    const Real half = force.frequency * h / 2;
    const Real sin_half = sin_cos(half).sin;
    f = value_of(force, time);
    df = 2 * force.amplitude * sin_half * sin_cos(Real(force.frequency * time + half)).cos;
    curb = 4 * sin_half * sin_half;
  }
  void advance() {
    f += df;
    df -= curb * f;
  }

  Real f = 0, df = 0, curb = 0;
};

// The parabola through three successive steps of one coordinate, about the middle one: its value, slope and
// second derivative there.
template <class Real>
struct Arc {
  Real g, slope, second;

  Real at(const Real& t) const { return g + t * (slope + t * second / 2); }
  Real slope_at(const Real& t) const { return slope + t * second; }
  Arc times(const Real& factor) const { return {factor * g, factor * slope, factor * second}; }

  // Returns the time in [0, h] at which an arc that begins at or above zero falls through it.
  Real fall(const Real& h) const {
    const Real square = slope * slope - 2 * second * g;
    const Real root = square > 0 ? square_root(square) : Real(0);
    if (slope > 0) return second < 0 ? std::clamp((slope + root) / -second, Real(0), h) : h;
    return root > slope ? std::clamp(2 * g / (root - slope), Real(0), h) : Real(0);
  }
  // Returns the time of its extremum in [from, to], or the end nearest to it; `from` where rounding has `to`
  // before it.
  Real extremum(const Real& from, const Real& to) const {
    return second == 0 || !(from < to) ? from : std::clamp(-slope / second, from, to);
  }
};
// A coordinate at a step, and the increment that led there.
template <class Real>
struct CemMoment {
  Real x, dx;
};
template <class Real>
Arc<Real> arc_of(const CemMoment<Real>& before, const CemMoment<Real>& now, const Real& h) {
  return {before.x, (before.dx + now.dx) / (2 * h), (now.dx - before.dx) / (h * h)};
}

[[noreturn]] void fail_of_overflow(double time, double step);
// Walls and springs with laws of their own: where a slope is met that time_step is too long for.
[[noreturn]] void fail_of_slope(double time, double step);
// Returns `steps` rounded up, at least 1 and at most 1e15.
std::int64_t whole_steps(double steps);
// Returns the largest whole multiple of h that is at most `step`; `step` itself where that is too many steps.
template <class Real>
Real multiple_of(const Real& h, const Real& step) {
  const Real steps = step / h;
  return steps < 1e15 ? Real(std::int64_t(steps)) * h : step;
}

// Returns the frequency of the fastest undamped mode in contact (M9.3), for a list with all its masses in
// contact; larger than 1 and sqrt(k/nu).
double fastest_contact_frequency(const Scene& scene);

// Returns the largest step at which no mode grows, in flight or in contact.
//
// By Jury's conditions for (M9.2) no mode grows as long as 4 M - 2 h C'' - h^2 K is positive semidefinite,
// with C'' the lagged part of the damping; where it ceases to be, its determinant, which is the
// characteristic polynomial at lambda = -1, changes sign and one real lambda passes -1: the limit is sharp.
//     centred: C'' = 0, h = 2 / omega with omega the fastest contact frequency, whatever the damping.
//     lagged:  the determinant's first root; for a free primary mass it is
//              2 (sqrt(1 + z^2) - z) / omega_c, z = zeta_m sqrt(1 + nu), omega_c = omega_m sqrt(1 + nu).
// The limit in flight is 2 and never the lower one, for omega > 1. For a list it is that of all masses in
// contact (M17.11): fewer in contact have a higher one.
double stability_limit(const Scene& scene, Damper damper, Calibration calibration);

}  // namespace impact_damper
