// Periodic orbits under a force, stable or unstable (docs/mathematics.md, 13.5, 13.6 and 13.9). find_orbit()
// solves H^n(s) = s by Newton's method. follow() continues an orbit in omega_f or f0 and locates bifurcation
// points and grazings on its branch.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/orbits/poincare_map.hpp"

namespace impact_damper {

// Why Newton's iteration ended.
enum class OrbitEnd {
  converged,
  no_convergence,  // the residual did not come below the tolerance, for instance because the orbit is not
                   // isolated (OrbitOptions::symmetric)
  no_derivative,   // several masses meet rigid walls at one instant: the effect of a change depends on their
                   // order. With friction also where other events coincide, or stop_margin is <= tolerance
  run_stopped,     // a budget ended a run before its periods were over
};

struct OrbitOptions {
  // Search only among symmetric orbits, which are their own mirror image half of the periods later; `periods`
  // must be odd. An orbit without impacts needs this: its secondary mass may rest anywhere, and only y + x =
  // 1/2, half of its clearance, is symmetric. Where other dampers have impacts, one that has none rests where
  // the guess has it, and in the middle if the orbit of the others is symmetric.
  bool symmetric = false;
  // Largest component of the residual |H^n(s) - s| that counts as converged, in units of the larger of 1 and
  // the largest of |s|. In (0, 1e-3]. Newton's iteration goes on below it for as long as each step halves the
  // residual.
  double tolerance = 1e-10;
  int max_iterations = 40;  // >= 1
};

// Why no orbit was found.
struct NoOrbit {
  OrbitEnd end = OrbitEnd::no_convergence;  // never converged
  std::vector<double> residuals{};          // as in Orbit
};

struct Orbit {
  std::vector<double> residuals;  // of each Newton iterate, in the units of `tolerance`; at least one
  Scene scene;                    // its initial condition is on the orbit, its until_time the orbit's period
  Engine engine;
  int periods = 1;                   // of the force, after which the orbit first closes
  bool symmetric = false;            // it is its own mirror image half of its period later
  std::vector<OrbitImpact> impacts;  // in its period
  std::int64_t sticking = 0;         // how often masses come to stick in its period
  std::vector<std::size_t> idle;     // as in PoincareImage
  // Floquet multipliers of its period, the eigenvalues of the monodromy matrix. A mass that sticks makes two
  // of them 0. Those of idle dampers are left out. They are 1: such a mass stays wherever it rests.
  Multipliers multipliers;
  // Symmetric orbits: the multipliers of half its period with the mirror, whose squares are `multipliers`.
  std::optional<Multipliers> half_multipliers;
  // Distances from grazing and from a coincidence of impacts, as in PoincareImage.
  std::optional<double> slowest_impact, nearest_miss, stop_margin, least_interval;

  // Whether all multipliers lie inside the unit circle. False without impacts: two are 1, as the secondary
  // mass stays wherever it rests.
  bool stable() const { return !impacts.empty() && multipliers[0].modulus() < 1; }
  double residual() const { return residuals.back(); }
};

// Finds a fixed point of H^n near `guess` by Newton's method, n = periods if symmetric, else 2 periods, and
// returns it with the shortest period that it has. guess: the state at phase 0 of the force, with as many
// dampers as the scene has. Throws InvalidArguments as PoincareMap does, and for options out of range.
Expected<Orbit, NoOrbit> find_orbit(const Scene& scene, const Engine& engine, int periods,
                                    const SceneState& guess, const OrbitOptions& options = {});

enum class Parameter { force_frequency, force_amplitude };
double Scene::*member_of(Parameter parameter);

// Bifurcation points on a branch (M13.12), and grazings.
enum class BranchEventKind {
  fold,  // the branch turns back in the parameter: multiplier +1
  flip,  // multiplier -1, period doubling: orbits of twice the period branch off, or this branch joins that
         // of half its period
  symmetry_breaking,  // multiplier -1 of half a period with the mirror: two asymmetric branches begin, or
                      // this one, asymmetric, joins the symmetric one
  neimark_sacker,     // two conjugate multipliers of modulus 1
  grazing,            // an impact appears or vanishes, with speed 0
};

struct BranchEvent {
  BranchEventKind kind = BranchEventKind::fold;
  double parameter = 0;  // error about 1e-10; of a grazing close to a fold about 1e-7, of one at which a
                         // branch with compliant walls ends 1e-9
  Orbit orbit;           // at that parameter; at a grazing with rigid walls the last one found before it
  std::int64_t orbits_before = 0;  // how many of Branch::orbits come before it
};

enum class BranchEnd {
  range,    // the parameter reached an end of its range; the last orbit is there
  grazing,  // rigid walls: beyond it the branch, if it goes on, has another number of impacts. Compliant
            // walls: the kink is so sharp that no step leads past it
  closed,   // it came back to the first orbit
  joined,   // the last orbit lies on the branch from which this one branches off, of symmetric orbits or of
            // half its period. Beyond are mirror images, or the same orbits half of their period later
  coincidence,  // rigid walls: impacts of two dampers come within 1e-6 of the same instant; beyond it their
                // order changes, which is another motion
  step_too_small,  // the corrector found no orbit close enough to the last one
  unstable,        // FollowOptions::max_multiplier
  points,          // FollowOptions::max_points
  not_an_orbit,    // the corrector does not converge from the first orbit, or its parameter is out of range
};

// Options of the continuation. Steps are distances along the branch in the space of state and parameter.
struct FollowOptions {
  double least = 0, most = 0;   // range of the parameter, > 0; the first orbit lies in it
  bool upwards = true;          // whether the parameter rises at first
  double first_step = 1e-2;     // > 0
  double largest_step = 5e-2;   // >= first_step
  double smallest_step = 1e-9;  // > 0, <= first_step
  // Largest predicted change of the parameter in a step, > 0. It shortens no step below smallest_step.
  double largest_change = std::numeric_limits<double>::infinity();
  // Largest modulus of a multiplier, >= 1. Beyond it other orbits are so near that a step may lead to one.
  // The modulus is first multiplied by the speed of the slowest impact if that is below 1 (by its square for
  // symmetric orbits, which have two such impacts): multipliers have no bound at grazing, which must not end
  // the branch.
  double max_multiplier = std::numeric_limits<double>::infinity();
  int max_points = 1000;  // >= 1
  OrbitOptions orbit;     // of the corrector; `symmetric` is that of the first orbit
};

struct Branch {
  BranchEnd end = BranchEnd::not_an_orbit;
  std::vector<Orbit> orbits;  // in the order in which they were found, with the first
  std::vector<BranchEvent> events;
};

// Numerical continuation of `orbit`: a predictor step along the tangent of the branch, then Newton's method
// as the corrector on a plane across it (M13.11). Throws InvalidArguments for options out of range.
Branch follow(const Orbit& orbit, Parameter parameter, const FollowOptions& options);

// Switches branches: returns an orbit of H^(2n) on the branch that begins at a flip or a symmetry breaking of
// an orbit of H^n (M13.21), 0.01 away from it or 0.001. The other half of that branch holds mirror images, or
// the same orbits half of their period later. Throws InvalidArguments as find_orbit does.
Expected<Orbit, NoOrbit> branching_off(const BranchEvent& event, Parameter parameter,
                                       const OrbitOptions& options = {});

}  // namespace impact_damper
