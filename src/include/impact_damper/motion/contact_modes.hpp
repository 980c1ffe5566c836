// The modes of all contacts (M2.2) with the walls of a scene, made once for a scene.
//
// The characteristic polynomial is factored into a slow and a fast quadratic (M5.3, contact_factors.hpp). A
// state is split into its two modes by (M5.4), applied to q and to the centre of both masses, X (M5.5): these
// two are weakly coupled, so that nothing cancels. Each mode moves as its own oscillator.
//
// Where the factors are equal or nearly so, and where the primary mass is strongly damped, the parts are
// large and cancel, as the split's norm (M5.6) shows. Such contacts are followed without modes
// (contact_without_modes.hpp).
#pragma once

#include <type_traits>

#include "impact_damper/motion/contact_exponential.hpp"
#include "impact_damper/motion/contact_factors.hpp"
#include "impact_damper/motion/forced_motion.hpp"
#include "impact_damper/motion/short_contact_map.hpp"
#include "impact_damper/motion/x_in_short_contact.hpp"

namespace impact_damper {

template <class Real, class Force = Forcing<Real>>
class ContactModes {
 public:
  ContactModes(const System<Real, Force>& system, const Real& zeta_m)
      : nu(system.nu),
        zeta(system.zeta),
        stiffness(system.k / system.nu),
        damping(2 * zeta_m * square_root(stiffness)),
        forcing(system.forcing),
        joined_(1 / (1 + nu)),
        share_(nu / (1 + nu)) {
    const auto& [p, b, p2, b2, dp, db, db2] = factors_ = factor_contact(nu, zeta, stiffness, damping);
    slow = Oscillator<Real>(p / 2, b);
    fast = Oscillator<Real>(p2 / 2, b2);
    const Real alpha = p2 - p, beta = b2 - b, resultant = beta * (beta - alpha * p) + alpha * alpha * b;
    alpha_ = alpha / resultant;
    beta_ = beta / resultant;
    slow_ = (beta - alpha * p) / resultant;
    fast_ = (beta - alpha * p2) / resultant;
    // One unit of force accelerates x by 1, q by -1 and the centre by 1/(1+nu). From the last the slow mode
    // of x follows with all its digits. As 1 minus the fast mode it would lose those of 1 + nu.
    const Centre<Real> driven_centre = split({0, 1, 0, -1}, drive_slow, drive_fast),
                       driven_slow_centre{-driven_centre.x, joined_ - driven_centre.v};
    drive_slow.x = driven_slow_centre.x - share_ * drive_slow.q;
    drive_slow.v = driven_slow_centre.v - share_ * drive_slow.w;
    std::array<Touch<Real>, 3> touch;
    split({1, 0, 0, 0}, touch[0].slow, touch[0].fast);
    split({0, 1, 0, 0}, touch[1].slow, touch[1].fast);
    split({0, 0, 0, 1}, touch[2].slow, touch[2].fast);
    piece = fast.rings() ? Real(fast.half_period() / 2) : Real(1 / (2 * fast.rate()));
    slow_piece = slow.propagate(piece);
    fast_piece = fast.propagate(piece);
    const bool stiff = stiffness > stiff_above(zeta);
    if (!stiff && !(zeta <= 4 && norm_of_split() <= 3)) {
      coupled.emplace(
          ContactEquations<Real>{nu, zeta, stiffness, damping, {forcing.amplitude, forcing.frequency}});
    } else if (!(forcing && forcing.frequency > fast.rate())) {
      const Real rate = slow.rate() > fast.rate() ? slow.rate() : fast.rate();
      short_contact = ShortContactMap<Real, columns>(
          slow, fast, share_, zeta,
          {nu, zeta, system.k, zeta_m, forcing ? forcing.frequency : Real(0), share_, rate}, touch,
          [&](std::size_t column, const Real& latest) { return driven_bounds(column, latest); });
      if constexpr (columns == 5)
        if (!(rate > fast.rate()))
          x_in_short_contact = {short_contact, fast, nu, zeta, stiffness, damping, forcing.frequency};
    }
  }

  // Splits u into its slow and its fast mode. Returns the centre X of the fast mode.
  Centre<Real> split(const ContactState<Real>& u, ContactState<Real>& slow_part,
                     ContactState<Real>& fast_part) const {
    const auto& [p, b, p2, b2, dp, db, db2] = factors_;
    const Real dx = 2 * zeta * u.v + u.x;  // D x
    const Real q2 = dx - (1 + nu) * (damping * u.w + stiffness * u.q);
    // In this form a secondary mass that stands still leaves no rounding error, however heavy it is.
    const Real X = joined_ * (u.x + nu * (u.x + u.q)), X1 = joined_ * (u.v + nu * (u.v + u.w));
    const Real X2 = -joined_ * dx;

    const Real r = 2 * zeta * X1 + X - dp * u.w + db2 * u.q;  // Q2 q and its derivative
    const Real r1 = 2 * zeta * X2 + X1 - dp * q2 + db2 * u.w;
    slow_part.q = slow_ * r - alpha_ * r1;
    slow_part.w = beta_ * r1 + alpha_ * b * r;
    fast_part.q = u.q - slow_part.q;
    fast_part.w = u.w - slow_part.w;

    const Real f = share_ * joined_ * (2 * zeta * u.w + u.q) + dp * X1 + db * X;  // Q1 X and its derivative
    const Real f1 = share_ * joined_ * (2 * zeta * q2 + u.w) + dp * X2 + db * X1;
    const Centre<Real> centre{alpha_ * f1 - fast_ * f, -(beta_ * f1 + alpha_ * b2 * f)};
    fast_part.x = centre.x - share_ * fast_part.q;
    fast_part.v = centre.v - share_ * fast_part.w;
    slow_part.x = u.x - fast_part.x;
    slow_part.v = u.v - fast_part.v;
    return centre;
  }

  // Computes the derivatives of x and q from the equations; f: those of the force.
  template <std::size_t N>
  void derive(const ContactState<Real>& state, Derivatives<Real, N>& x, Derivatives<Real, N>& q,
              const Derivatives<Real, N>& f = {}) const {
    x[0] = state.x;
    x[1] = state.v;
    q[0] = state.q;
    q[1] = state.w;
    for (std::size_t n = 2; n < N; ++n) {
      const Real force = damping * q[n - 1] + stiffness * q[n - 2];
      x[n] = nu * force - 2 * zeta * x[n - 1] - x[n - 2] + f[n - 2];
      q[n] = -force - x[n];
    }
  }

  Real nu, zeta, stiffness, damping;  // nu, zeta, K = k/nu, c
  Force forcing;
  Oscillator<Real> slow, fast;
  ContactState<Real> drive_slow, drive_fast;

  std::optional<ContactExponential<Real>> coupled;  // for a contact without modes, else empty
  static constexpr std::size_t columns = std::is_same_v<Force, NoForcing<Real>> ? 3 : 5;
  ShortContactMap<Real, columns> short_contact;
  struct Nothing {};
  [[no_unique_address]] std::conditional_t<columns == 5, XInShortContactTable<Real>, Nothing>
      x_in_short_contact;
  // A time in which the fast mode moves little, a quarter of its period if it oscillates, and the propagators
  // of both modes over that time.
  Real piece;
  Propagator<Real> slow_piece, fast_piece;

 private:
  // The force of a column of the short-contact map, with amplitude 1: cos(omega_f t) in column 3 and
  // sin(omega_f t) in column 4, t being the time since the touch; none in the first three columns.
  Force unit_force(std::size_t column) const { return {column < 3 ? Real(0) : Real(1), forcing.frequency}; }
  static SinCos<Real> phase_of(std::size_t column) {
    return column == 3 ? SinCos<Real>{Real(1), Real(0)} : SinCos<Real>{Real(0), Real(1)};
  }
  // Bounds until `latest` on the motion of the slow and the fast mode from rest under the force of a column.
  DrivenBounds<Real> driven_bounds(std::size_t column, const Real& latest) const {
    const Force force = unit_force(column);
    const SinCos<Real> phase = phase_of(column);
    DrivenBounds<Real> all{};
    const auto add = [&](const Oscillator<Real>& mode, const ContactState<Real>& drive) {
      // Such a part p begins with p = 0, p' = displacement f, and obeys p'' + 2 a p' + b p = (velocity + 2 a
      // displacement) f + displacement f'.
      const auto instant = [&](const Real& displacement, const Real& velocity) {
        return Instant<Real, 7, Force>(mode, Real(0), displacement * (column == 3 ? 1 : 0),
                                       velocity + 2 * mode.a() * displacement, displacement, force, phase);
      };
      const auto q = instant(drive.q, drive.w), x = instant(drive.x, drive.v);
      const Real a = fast.a();  // the fourth derivative of exp(a t) q is exp(a t) (a + d/dt)^4 q
      Real weight{1};
      for (std::size_t n = 4;; --n) {
        constexpr std::array<int, 5> binomial{1, 4, 6, 4, 1};
        all.fourth_of_q += weight * binomial[n] * q.bound(n, latest);
        if (n == 0) break;
        weight *= a;
      }
      all.second_of_x += x.bound(2, latest);
      all.third_of_x += x.bound(3, latest);
      all.fourth_of_x += x.bound(4, latest);
      all.fifth_of_x += x.bound(5, latest);
    };
    add(slow, drive_slow);
    add(fast, drive_fast);
    return all;
  }

  // An upper bound of the size of a fast mode divided by that of the motion, in the norm (M5.6): the square
  // root of the sum of squares over four orthogonal states of norm 1.
  Real norm_of_split() const {
    const Real root_k = square_root(stiffness);
    Real sum{0};
    for (const ContactState<Real>& u :
         {ContactState<Real>{1, 0, 0, 0}, ContactState<Real>{0, 1, 0, -1}, ContactState<Real>{0, 0, 0, 1},
          ContactState<Real>{0, 0, 1 / root_k, 0}}) {
      ContactState<Real> slow_part, fast_part;
      split(u, slow_part, fast_part);
      const Real z1 = fast_part.v + fast_part.w, depth = root_k * fast_part.q;
      sum += fast_part.x * fast_part.x + fast_part.v * fast_part.v + z1 * z1 + depth * depth;
    }
    return square_root(sum);
  }

  Real joined_, share_;  // 1/(1+nu), nu/(1+nu)
  ContactFactors<Real> factors_;
  Real alpha_, beta_, slow_, fast_;  // alpha, beta, beta - alpha p, beta - alpha p2; divided by the resultant
};

}  // namespace impact_damper
