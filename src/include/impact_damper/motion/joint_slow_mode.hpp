// Several secondary masses that press their walls together after their ringing has died away
// (docs/mathematics.md, 17.5): x is one oscillator again, the slow factor of (M17.18), and each q is a
// combination of x, x' and the force, (M17.20).
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "impact_damper/math/complex.hpp"
#include "impact_damper/motion/forced_motion.hpp"
#include "impact_damper/motion/joint_contact.hpp"

namespace impact_damper {

template <class Real, class Force>
class JointSlowMode {
 public:
  using Primary = ForcedMotion<Real, Force>;

  // Returns the slow mode of these walls, of which nu, stiffness and damping are used, not q and q'. Returns
  // nothing where a wall is not much stiffer than the spring of the primary mass.
  static std::optional<JointSlowMode> of(const Real& zeta, const Force& forcing,
                                         const std::vector<PushedWall<Real>>& walls) {
    Factor factor{};
    for (const PushedWall<Real>& wall : walls) factor.mass += wall.nu;
    factor.p = 2 * zeta / factor.mass;
    factor.b = 1 / factor.mass;
    std::vector<OfWall> of_walls(walls.size());
    for (int i = 0; i < 30; ++i) {  // (M17.19)
      const Real p = factor.p, b = factor.b;
      Real r0{0}, r1{0};
      for (std::size_t k = 0; k < walls.size(); ++k) {
        const auto& [nu, stiffness, damping, q, w] = walls[k];
        if (!(stiffness > 100 * b)) return {};
        const Real on_s = damping - p, on_1 = stiffness - b;
        const Real resultant = on_1 * (on_1 - on_s * p) + on_s * on_s * b;
        OfWall& of_wall = of_walls[k];
        of_wall.on_x = b * on_1 / resultant;
        of_wall.on_v = (p * on_1 - b * on_s) / resultant;
        r0 += nu * b * (of_wall.on_x - p * of_wall.on_v);
        r1 += nu * (p * of_wall.on_x - (p * p - b) * of_wall.on_v);
      }
      factor.p = (2 * zeta - r1) / factor.mass;
      factor.b = (1 - r0) / factor.mass;
      const Real enough = std::numeric_limits<Real>::epsilon() * b;
      if (absolute(factor.p - p) <= enough && absolute(factor.b - b) <= enough)
        return JointSlowMode(forcing, walls, factor, std::move(of_walls));
    }
    return {};
  }

  // The oscillator, its force, and the time by which the phase of this force is ahead of that of the scene.
  const Driven<Real, Force>& oscillator() const { return oscillator_; }
  const Force& force() const { return force_; }
  const Real& ahead() const { return ahead_; }

  // Returns q and q' of the k-th wall at a time since the release; x and v: those of the primary mass then.
  std::array<Real, 2> overlap(std::size_t k, const Real& time, const Real& x, const Real& v) const {
    const OfWall& wall = walls_[k];
    const auto f = force_.template derivatives<3>(force_.phase(time + ahead_));
    const Real x2 = f[0] - 2 * oscillator_.a() * v - oscillator_.b() * x;  // x''
    return {wall.on_x * x + wall.on_v * v + (wall.on_f * f[0] + wall.on_f1 * f[1]),
            wall.on_x * v + wall.on_v * x2 + (wall.on_f * f[1] + wall.on_f1 * f[2])};
  }
  // Whether the walls have stopped ringing: their q and q' are those of the slow mode but for rounding
  // errors.
  bool holds(const std::vector<PushedWall<Real>>& walls, const Real& time, const Real& x,
             const Real& v) const {
    const Real size_of_x = absolute(x) + absolute(v) / oscillator_.root_b();
    for (std::size_t k = 0; k < walls_.size(); ++k) {
      const OfWall& wall = walls_[k];
      const auto [q, w] = overlap(k, time, x, v);
      const Real size = absolute(wall.on_x) * size_of_x + absolute(wall.on_v * v) + wall.size_on_f;
      // The phase of the force has a rounding error of itself, which grows with time.
      const Real rounding =
          std::numeric_limits<Real>::epsilon() * (64 * size + 4 * force_.frequency * time * wall.size_on_f);
      if (!(absolute(walls[k].q - q) <= rounding && absolute(walls[k].w - w) <= rounding * wall.rate))
        return false;
    }
    return true;
  }
  // Encloses the depth of the k-th mass in its wall from the time t of `primary` on, which began at `begin`.
  LocalEnclosure<Real> depth(std::size_t k, Wall where, const Primary& primary, const Real& begin,
                             const Real& t, const Real& span) const {
    const Real inward = where == Wall::left ? -1 : 1;
    const OfWall& wall = walls_[k];
    const auto now = primary.at(t);
    const auto x = primary.template instant<7>(now.x, now.v, t);
    const auto f = force_.template derivatives<4>(force_.phase(begin + t + ahead_));
    const auto derivative = [&](std::size_t n) {
      return inward * (wall.on_x * x[n] + wall.on_v * x[n + 1] + (wall.on_f * f[n] + wall.on_f1 * f[n + 1]));
    };
    const Real& omega = force_.frequency;
    return {{derivative(0), derivative(1), derivative(2),
             absolute(wall.on_x) * x.bound(3, span) + absolute(wall.on_v) * x.bound(4, span) +
                 wall.size_on_f * omega * omega * omega}};
  }

 private:
  using Complex = impact_damper::Complex<Real>;
  struct Factor {
    Real p, b, mass{1};
  };
  struct OfWall {
    Real on_x, on_v;         // q = on_x x + on_v x' ...
    Real on_f{0}, on_f1{0};  // ... + on_f f + on_f1 f', with G f of (M17.20) for f
    Real size_on_f{0}, rate{0};
  };

  JointSlowMode(const Force& forcing, const std::vector<PushedWall<Real>>& walls, const Factor& factor,
                std::vector<OfWall> of_walls)
      : oscillator_(factor.p / 2, factor.b, forcing), force_(forcing), walls_(std::move(of_walls)) {
    const Real omega = forcing.frequency;
    Complex gain(factor.mass);
    for (std::size_t k = 0; k < walls.size(); ++k) {
      const auto& [nu, stiffness, damping, q, w] = walls[k];
      OfWall& wall = walls_[k];
      wall.rate = square_root(stiffness) + omega;
      if (!forcing) continue;
      const Complex h = Complex(-wall.on_x * stiffness / factor.b, -omega * wall.on_v) /
                        Complex(stiffness - omega * omega, omega * damping);
      wall.on_f = h.real();
      wall.on_f1 = h.imag() / omega;
      gain = gain - Complex(nu) * (Complex(factor.p * wall.on_v - wall.on_x, -omega * wall.on_v) +
                                   Complex(omega * omega) * h);
    }
    if (!forcing) return;
    force_.amplitude =
        forcing.amplitude / square_root(Real(gain.real() * gain.real() + gain.imag() * gain.imag()));
    ahead_ = -angle_of(gain.imag(), gain.real()) / omega;
    for (OfWall& wall : walls_)
      wall.size_on_f = absolute(force_.amplitude) * (absolute(wall.on_f) + omega * absolute(wall.on_f1));
  }

  Driven<Real, Force> oscillator_;
  Force force_;  // G f of (M17.20), but for its phase
  Real ahead_{0};
  std::vector<OfWall> walls_;
};

}  // namespace impact_damper
