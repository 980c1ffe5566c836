// Energies of the two masses and the walls, and the work that changes them: the balance (M8.1).
//
// Work is integrated along the motion itself by Gauss-Legendre quadrature, not taken as a difference of
// energies. So the residual is a test of the motion and not an identity.
#pragma once

#include <array>
#include <cstddef>

#include "impact_damper/events/search.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/motion/system.hpp"

namespace impact_damper {

// What a secondary mass adds to the energy: its mass ratio, y', and twice the energy of its wall.
template <class Real>
struct EnergyTerms {
  Real nu, w, wall;
};
// Returns the energy of the primary mass with x and x' = v, and of `count` secondary masses, divided by K
// epsilon^2. of(i): the EnergyTerms of the i-th. The kinetic energy has the cross term that the paper's sum
// of squares drops: m is carried along with x'.
template <class Real, class Of>
Energy energy_of_masses(const Real& x, const Real& v, std::size_t count, Of&& of) {
  Real kinetic = v * v, paper = kinetic, walls{0};
  for (std::size_t i = 0; i < count; ++i) {
    const auto [nu, w, wall] = of(i);
    const Real z1 = v + w;
    kinetic += nu * z1 * z1;
    paper += nu * (v * v + w * w);
    walls += wall;
  }
  Energy energy;
  energy.kinetic = double(Real(kinetic / 2));
  energy.spring = double(Real(x * x / 2));
  energy.wall = double(Real(walls / 2));
  energy.paper = double(Real((paper + x * x) / 2));
  return energy;
}
// Returns the kinetic energy of a secondary mass, where x' = v and y' = w.
template <class Real>
double kinetic_energy(const Real& nu, const Real& v, const Real& w) {
  const Real z1 = v + w;
  return double(Real(nu * z1 * z1 / 2));
}

// Returns the energy of the primary mass and a single secondary mass. depth: of the latter in a compliant
// wall.
template <class Real, class Force>
Energy energy_of(const System<Real, Force>& system, const State<Real>& s, const Real& depth) {
  return energy_of_masses(s.x, s.v, 1, [&](std::size_t) {
    return EnergyTerms<Real>{system.nu, s.w, system.k * depth * depth};
  });
}

template <class Real>
struct Work {
  Real wall{0}, viscous{0}, forcing{0};
  Real reactive{0};  // of the forcing a quarter of a period ahead, f0 cos(omega_f t)
  Real turnover{0};  // integral of the forcing's |power|: the scale of its rounding errors
};

// Abscissae (positive half) and weights of the 16-point Gauss-Legendre rule on [-1, 1]
// (Abramowitz and Stegun, table 25.4).
struct GaussPoint {
  double abscissa, weight;
};
inline constexpr std::array<GaussPoint, 8> gauss_16{{{0.0950125098376374402, 0.1894506104550684963},
                                                     {0.2816035507792589132, 0.1826034150449235889},
                                                     {0.4580167776572273863, 0.1691565193950025382},
                                                     {0.6178762444026437484, 0.1495959888165767321},
                                                     {0.7554044083550030339, 0.1246289712555338720},
                                                     {0.8656312023878317439, 0.0951585116824927848},
                                                     {0.9445750230732325761, 0.0622535239386478929},
                                                     {0.9894009349916499326, 0.0271524594117540949}}};

// Returns the work over [0, duration] of a motion that begins at `begin`. rates(t): x' and y'; panel(t): the
// length of the panel that begins at t; wall_damping: nu c in contact, else 0. As exact as Gauss's 16 points
// are over a panel (Oscillator::panel: to rounding), as long as there are no more than 65536 panels: then
// they get longer, and an oscillation that fast averages out.
template <class Real, class Force, class Rates, class Panel>
Work<Real> integrated_work(const System<Real, Force>& system, Rates&& rates, Panel&& panel, const Real& begin,
                           const Real& duration, const Real& wall_damping, Search<Real>& search) {
  Work<Real> works;
  Real from{0};
  const Real least = duration / 65536;
  for (int panels = 1; from < duration; ++panels) {
    --search.steps_left;  // only a search ends the run for lack of steps: a quadrature is short
    Real to = from + panel(from);
    if (panels > 65536 && to < from + least) to = from + least;
    if (!(to < duration)) to = duration;
    const Real half = (to - from) / 2, middle = from + half;
    for (const auto& [abscissa, weight] : gauss_16) {
      for (const double side : {-abscissa, abscissa}) {
        const Real t = middle + half * side;
        const auto [v, w] = rates(t);
        const Real dt = half * weight;
        works.viscous += dt * (2 * system.zeta) * (v * v);
        works.wall += dt * wall_damping * (w * w);
        if (system.forcing) {
          const SinCos<Real> phase = system.forcing.phase(begin + t);
          const Real work = dt * v * system.forcing.template derivatives<2>(phase)[0];
          works.forcing += work;
          works.reactive += dt * v * (system.forcing.amplitude * phase.cos);
          works.turnover += absolute(work);
        }
      }
    }
    from = to;
  }
  return works;
}

template <class Motion, class Real, class Force>
Work<Real> work_of(const System<Real, Force>& system, const Motion& motion, const Real& begin,
                   const Real& duration, const Real& wall_damping, Search<Real>& search) {
  if (system.zeta == 0 && !system.forcing && wall_damping == 0) return {};
  const auto rates = [&](const Real& t) {
    const State<Real> now = motion.at(t);
    return std::array{now.v, now.w};
  };
  return integrated_work(
      system, rates, [&](const Real& t) { return motion.panel(t); }, begin, duration, wall_damping, search);
}

}  // namespace impact_damper
