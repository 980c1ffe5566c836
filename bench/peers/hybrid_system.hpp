// The equations as an integrator of ordinary differential equations wants them, written down anew: nothing
// here comes from the library but the numbers of the scene.
//
// The state is (x, x', y, y'), y the secondary mass's distance from the left wall. In each regime
//   free         x'' + 2 zeta x' + x = f,                      y'' = -x''
//   in contact   x'' + 2 zeta x' + x = nu F + f,               y'' = -F - x'',   F = c y' + (k/nu) q,
//                q = y or y - 1, c = 2 sqrt(k/nu) zeta_m,      zeta_m = L / sqrt(pi^2 + L^2), L = -ln e
//   stuck        (1 + nu) x'' + 2 zeta x' + x = f,             y'' = 0
// with f = f0 sin(omega_f t). A regime ends where one of its guards falls through zero; that x or x' pass
// through zero ends nothing, but is what half cycles are made of.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "contender.hpp"

namespace impact_damper::bench {

enum class Regime { free, left, right, stuck_left, stuck_right };
inline constexpr std::size_t regimes = 5;

template <class Number>
class HybridSystem {
 public:
  using Real = Number;
  using State = std::array<Real, 4>;
  // Two guards, falling; then x and x', either way.
  static constexpr std::size_t events = 4;
  static constexpr std::size_t guards = 2;
  // A stepper's step lengths are kept for each of so many.
  static constexpr std::size_t paces = regimes;

  // The scene begins in flight, or on a wall that it is about to leave.
  HybridSystem(const Scene& scene, Walls walls)
      : rigid_(walls == Walls::rigid),
        nu_(scene.damper().mass_ratio),
        e_(scene.damper().restitution),
        two_zeta_(2 * Real(scene.damping_ratio)),
        stiffness_(Real(scene.damper().wall_stiffness) / nu_),
        f0_(scene.force_amplitude),
        omega_(scene.force_frequency),
        state{Real(scene.x0), Real(scene.v0), Real(scene.damper().y0), Real(scene.damper().w0)} {
    using std::acos, std::log, std::sqrt;
    const Real pi = acos(Real(-1));
    Real zeta_m = 1;
    if (e_ > 0) {
      const Real l = -log(e_);
      zeta_m = l / sqrt(Real(pi * pi + l * l));
    }
    damping_ = 2 * sqrt(stiffness_) * zeta_m;
    contact_time_ = pi / sqrt(Real(stiffness_ * (1 + nu_)));
  }

  Regime regime() const { return regime_; }
  std::size_t pace() const { return std::size_t(regime_); }
  // Half a unit of time; in contact a quarter of its period.
  Real longest_step(std::size_t pace) const {
    const bool contact = pace == std::size_t(Regime::left) || pace == std::size_t(Regime::right);
    return contact ? Real(contact_time_ / 2) : Real(0.5);
  }
  // Half a period of the contact.
  const Real& contact_time() const { return contact_time_; }

  void derivative(const State& u, State& du, const Real& t) const {
    const Real pull = force(t) - two_zeta_ * u[1] - u[0];
    du[0] = u[1];
    du[2] = u[3];
    switch (regime_) {
      case Regime::free:
        du[1] = pull;
        du[3] = -pull;
        return;
      case Regime::left:
      case Regime::right: {
        const Real q = regime_ == Regime::left ? u[2] : u[2] - 1;
        const Real wall = damping_ * u[3] + stiffness_ * q;
        du[1] = pull + nu_ * wall;
        du[3] = -wall - du[1];
        return;
      }
      case Regime::stuck_left:
      case Regime::stuck_right:
        du[1] = pull / (1 + nu_);
        du[2] = du[3] = 0;
        return;
    }
  }

  Real event(std::size_t which, const State& u, const Real& t) const {
    if (which == 2) return u[0];
    if (which == 3) return u[1];
    switch (regime_) {
      case Regime::free:
        return which == 0 ? u[2] : 1 - u[2];
      case Regime::left:
        return which == 0 ? -u[2] : Real(1);
      case Regime::right:
        return which == 0 ? u[2] - 1 : Real(1);
      case Regime::stuck_left:
      case Regime::stuck_right: {
        State du{};
        derivative(u, du, t);
        return which == 0 ? (regime_ == Regime::stuck_left ? du[1] : -du[1]) : Real(1);
      }
    }
    return 1;
  }
  // Its rate, for Newton's corrections; zero where it is not known.
  Real event_rate(std::size_t which, const State& u, const Real& t) const {
    State du{};
    derivative(u, du, t);
    if (which >= 2) return which == 2 ? u[1] : du[1];
    switch (regime_) {
      case Regime::free:
        return which == 0 ? u[3] : -u[3];
      case Regime::left:
        return -u[3];
      case Regime::right:
        return u[3];
      case Regime::stuck_left:
      case Regime::stuck_right:
        return 0;
    }
    return 0;
  }

  bool flies(std::size_t) const { return regime_ == Regime::free; }
  // Where in a state the rate of the gap stands whose guard this is.
  static constexpr std::size_t speed_of(std::size_t) { return 3; }

  // A guard was passed at time t in the state u, which is put right: y exactly on its wall, velocities as the
  // new regime begins with them. True if it was an impact.
  bool pass(std::size_t guard, State& u, const Real& t) {
    switch (regime_) {
      case Regime::free: {
        const bool left = guard == 0;
        u[2] = left ? 0 : 1;
        if (!rigid_) {
          regime_ = left ? Regime::left : Regime::right;
          return true;
        }
        u[1] += nu_ * (1 + e_) * u[3] / (1 + nu_);
        u[3] *= -e_;
        if (sticks(left, u, t)) {
          u[1] += nu_ * u[3] / (1 + nu_);
          u[3] = 0;
          regime_ = left ? Regime::stuck_left : Regime::stuck_right;
        }
        return true;
      }
      case Regime::left:
      case Regime::right:
        u[2] = regime_ == Regime::left ? 0 : 1;
        regime_ = Regime::free;
        return false;
      case Regime::stuck_left:
      case Regime::stuck_right:
        u[3] = 0;
        regime_ = Regime::free;
        return false;
    }
    return false;
  }

 private:
  Real force(const Real& t) const {
    using std::sin;
    return f0_ == 0 ? Real(0) : Real(f0_ * sin(Real(omega_ * t)));
  }
  // Bounces die out in finite time: what is left of it, 2 w / (a (1 - e)), is cut off where the displacement
  // of the primary mass that this costs, nu w^2 / 2a, is about 1e-15.
  bool sticks(bool left, const State& u, const Real& t) const {
    const Real push = (left ? 1 : -1) * (force(t) - two_zeta_ * u[1] - u[0]);
    const Real speed = left ? u[3] : -u[3];
    return push > 0 && 2 * speed < Real(1e-6) * push * (1 - e_);
  }

  bool rigid_;
  Real nu_, e_, two_zeta_, stiffness_, f0_, omega_, damping_, contact_time_;
  Regime regime_ = Regime::free;

 public:
  State state;  // the initial one
};

}  // namespace impact_damper::bench
