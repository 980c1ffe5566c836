// The variational equations along a run: what small changes of the state, of omega_f or of f0 become, to
// first order (docs/mathematics.md, 13.2 to 13.4 and 13.10). They need the record of the run alone: each
// motion is linear, so that its derivative is its own propagator, and each event adds a saltation matrix
// (M13.4). Nothing is approximated by differences.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "impact_damper/run.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {

// Changes of x, x', then y and y' of each damper by number in the scene; divided as in run.hpp.
using ChangeOfState = std::vector<double>;
constexpr std::size_t index_of_y(std::size_t damper) { return 2 + 2 * damper; }
constexpr std::size_t index_of_w(std::size_t damper) { return 3 + 2 * damper; }
inline std::size_t dimensions_of(const Scene& scene) { return 2 + 2 * scene.dampers.size(); }

// An interval in which a mass sticks to a rigid wall, or is in contact with a compliant one: from the motion
// `first` of a run's chain to the one before `last`.
struct ContactInterval {
  std::size_t damper, first, last;
  int away;                    // from the wall into the cavity: 1 at a left, -1 at a right wall
  std::size_t impacts_before;  // of all dampers, in the chain
  bool from_beginning;         // no event of this run began it
};

// What is known of a run after its changes have been carried along.
struct Carried {
  std::vector<ContactInterval> contacts;  // of the run, with those that end with it, in the order of `first`
  // Largest number of dimensions lost at one time: two for each mass that sticks, or whose contact is damped
  // by more than exp(-36) 4096 times.
  std::size_t lost = 0;
  // As in PoincareImage.
  bool one_sided = false;
  std::optional<double> stop_margin;
};
// The derivatives of the final state by omega_f and by f0, for a fixed end time, and its rates.
struct AlongRun {
  ChangeOfState by_frequency, by_amplitude;
  ChangeOfState rates_at_end;  // x', x'', then y' and y'' of each damper, before any event at that instant
};

// The coefficients of the variational equations of a scene (masses_along_run.hpp).
struct VariationalCoefficients;
// Returns them. The engine must be exact or restitution, and the scene must have a force.
std::shared_ptr<const VariationalCoefficients> variational_coefficients(const Scene& scene,
                                                                        const Engine& engine);

// Solves the variational equations: replaces each change of a run's initial state by what it has become at
// the run's end. The run must have ended by its time (StopReason::time). after_step(), if not empty, is
// called after each event that acts on changes and after each motion, and may replace the changes by others
// that span the same directions; a motion that contracts volumes to less than 1/e is then taken in pieces.
// `along` is filled in if it is not null.
Carried carry_changes(const VariationalCoefficients& of, const RecordedRun& run,
                      std::vector<ChangeOfState>& changes, const std::function<void()>& after_step,
                      AlongRun* along = nullptr);

}  // namespace impact_damper
