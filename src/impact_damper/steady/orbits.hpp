// Periodic motions under a force, stable or not: found by Newton's method on the Poincare map, followed in
// omega_f or f0, with the points at which their stability or their kind changes (docs/mathematics.md, 13.5
// and 13.6).
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/expected.hpp"
#include "impact_damper/steady/multipliers.hpp"
#include "impact_damper/steady/poincare_map.hpp"

namespace impact_damper {

// What Newton's iteration ended in.
enum class OrbitEnd {
  converged,
  no_convergence,  // the iteration went astray; or the orbit is not isolated (OrbitOptions::symmetric)
  no_derivative,   // several masses meet rigid walls at one instant: who is first decides what comes of a
                   // change
  run_stopped,     // a run ended before its periods were over, by a budget
};

struct OrbitOptions {
  // Only among orbits that are their own mirror image half of the periods later; `periods` must be odd. An
  // orbit without impacts needs this: its secondary mass may rest anywhere, and only y + x = 1/2, half of its
  // clearance, is symmetric. Where other dampers are struck one that is not rests where the guess has it, and
  // in the middle if the orbit of the others is symmetric.
  bool symmetric = false;
  // Of |H^n(s) - s|, the largest number, in units of the larger of 1 and the largest of |s|. In (0, 1e-3].
  // Newton's iteration goes on beyond it for as long as each step halves the rest.
  double tolerance = 1e-10;
  int max_iterations = 40;  // >= 1
};

// Why there is none.
struct NoOrbit {
  OrbitEnd end = OrbitEnd::no_convergence;  // never converged
  std::vector<double> residuals{};          // as in Orbit
};

struct Orbit {
  std::vector<double> residuals;  // |H^n(s) - s| at each iterate, in the units of `tolerance`; at least one
  Scene scene;                    // its initial condition is on the orbit, its until_time the orbit's period
  Engine engine;
  int periods = 1;                   // of the force, after which the orbit first closes
  bool symmetric = false;            // its own mirror image half a period of its own later
  std::vector<OrbitImpact> impacts;  // in one period of its own
  std::int64_t sticking = 0;         // in one period of its own, times in which masses stick
  std::vector<std::size_t> idle;     // as in PoincareImage
  // Of one period of its own; a mass that sticks makes two of them 0. Without those of dampers that are idle,
  // which are 1: one that rests elsewhere rests there, too.
  Multipliers multipliers;
  // Of half of that with the mirror, if symmetric: their squares are the multipliers.
  std::optional<Multipliers> half_multipliers;
  // How near to grazing, and to a coincidence, as in PoincareImage.
  std::optional<double> slowest_impact, nearest_miss, least_interval;

  // Without impacts two multipliers are 1: a secondary mass at rest elsewhere rests there, too.
  bool stable() const { return !impacts.empty() && multipliers[0].modulus() < 1; }
  double residual() const { return residuals.back(); }
};

// guess: at phase 0 of the force, of as many dampers as the scene has. Throws InvalidArguments as PoincareMap
// does, and for options out of range.
Expected<Orbit, NoOrbit> find_orbit(const Scene& scene, const Engine& engine, int periods,
                                    const SceneState& guess, const OrbitOptions& options = {});

enum class Parameter { force_frequency, force_amplitude };
double Scene::*member_of(Parameter parameter);

enum class BranchEventKind {
  fold,               // the branch turns back in the parameter: multiplier +1
  flip,               // multiplier -1: an orbit of twice the period branches off, or this one did
  symmetry_breaking,  // multiplier -1 of half a period with the mirror: two that are not symmetric branch
                      // off, or this one did
  neimark_sacker,     // two conjugate multipliers of modulus 1
  grazing,            // an impact appears, or vanishes, with speed 0
};

struct BranchEvent {
  BranchEventKind kind = BranchEventKind::fold;
  double parameter = 0;            // to about 1e-10; a grazing close to a fold to about 1e-7, one
                                   // with compliant walls at which the branch ends to 1e-9
  Orbit orbit;                     // there; at a grazing with rigid walls the last one that was found
  std::int64_t orbits_before = 0;  // of Branch::orbits
};

enum class BranchEnd {
  range,        // the parameter reached an end of its range; the last orbit is there
  grazing,      // rigid walls: beyond it the branch, if it goes on, has another number of impacts.
                // Compliant walls: it turns there so sharply that no step leads on
  closed,       // it came back to the first orbit
  joined,       // it met the branch of symmetric orbits, or of half its period, from which it branches off:
                // the last orbit. Beyond are mirror images, or the same orbits half of their period later
  coincidence,  // rigid walls: impacts of two dampers come to be at one instant, within 1e-6; beyond it the
                // other one is first, which is another motion
  step_too_small,  // no orbit was found near enough to the last
  unstable,        // FollowOptions::max_multiplier
  points,          // FollowOptions::max_points
  not_an_orbit,    // the first is none for the parameter's first value, or that is beyond the range
};

// Steps are measured along the branch in the space of the state and the parameter.
struct FollowOptions {
  double least = 0, most = 0;   // range of the parameter, > 0; the first orbit lies in it
  bool upwards = true;          // which way the parameter goes first
  double first_step = 1e-2;     // > 0
  double largest_step = 5e-2;   // >= first_step
  double smallest_step = 1e-9;  // > 0, <= first_step
  // Of the parameter in a step, as it is predicted; it may shorten steps to smallest_step. > 0.
  double largest_change = std::numeric_limits<double>::infinity();
  // Largest modulus of a multiplier, times the speed of the slowest impact if that is below 1, or its square
  // for symmetric orbits, which have two of them: so that grazing, where multipliers have no bound, is no
  // reason. Beyond it other orbits are so near that a step may lead to one. >= 1.
  double max_multiplier = std::numeric_limits<double>::infinity();
  int max_points = 1000;  // >= 1
  OrbitOptions orbit;     // tolerance and iterations of each point; `symmetric` is the first orbit's
};

struct Branch {
  BranchEnd end = BranchEnd::not_an_orbit;
  std::vector<Orbit> orbits;  // in the order in which they were met, the first included
  std::vector<BranchEvent> events;
};

// Throws InvalidArguments for options out of range.
Branch follow(const Orbit& orbit, Parameter parameter, const FollowOptions& options);

// An orbit of the branch that begins at a flip or a symmetry breaking of an orbit of half its length
// (M13.21), 0.01 away from it or 0.001. The other half of that branch holds
// mirror images, or the same orbits half of their period later. Throws InvalidArguments as find_orbit does.
Expected<Orbit, NoOrbit> branching_off(const BranchEvent& event, Parameter parameter,
                                       const OrbitOptions& options = {});

}  // namespace impact_damper
