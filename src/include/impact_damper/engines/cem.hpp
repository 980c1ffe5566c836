// The component element method: the paper's way of running a scene, equations (3)-(8) by central
// differences with a fixed step h (cem_scheme.hpp), after a second-order start from the initial state. With
// `stuck_speed` the paper's (9) as well, corrected (M9.5): an impact slower
// than that, with the wall pushing, joins both masses with their momentum kept, until x'' changes its sign.
//
// Contact. As in the paper, the sign of the overlap at a step decides which equations make the next one, so
// touch and release come up to h late. With a damper in the wall, whose force jumps at touch, this makes the
// delivered restitution, and all that follows from it, accurate to first order in h only. With `locate` touch
// and release are put where the parabola through the three steps around them meets the wall: the method steps
// exactly onto the event and starts anew from there, and is of second order (first with the lagged damper).
// Two crossings of a wall within one step are not seen. Where the masses join or part the motion begins anew,
// so these two events are located in any case, the second by a straight line through x''.
//
// With `large_step` the steps are small only near contact (cem_rates.hpp).
//
// In a list of dampers each mass is in flight, in contact or stuck by itself (docs/mathematics.md, 17.5).
//
// Observations (zero crossing, peak, history, and touch and release without `locate`) are read off the
// parabola through three steps, errors O(h^3) in position and O(h^2) in velocity. Times are counted, n h
// from the start, the last located event or the last change of step, not accumulated.
//
// Observing changes nothing. A segment is the sequence of equal steps since the start, the last located event
// or the last change of step. Within it, whatever steps carry on from one to the next (the recurrence of the
// force, the sums of the works, the number of steps until a step size is chosen) is renewed at fixed step
// numbers or where the regime changes, never where the loop over steps was left for an observation. Crossings
// and peaks are followed whether or not they are recorded, because they count against the limit on looks;
// which step a time lies in follows from the segment alone. So the motion, the energy balance and the stop
// are functions of scene and options, and a run that ends earlier is the beginning of a longer one.
//
// Energy. The scheme conserves |d/h|^2_M / 2 + u_n.K u_{n+1} / 2 within a regime but for the sums of damping
// and forcing power at the steps, so those sums are the energy balance's losses. The residual contains the
// difference between this form of the energy and the true one, O(h^2); it is no measure of the first-order
// error.
#pragma once

#include <vector>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/cem_engine.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

// Returns the options with the step filled in if absent: a hundredth of the nominal contact time, or of half
// a period of the primary mass or of the forcing where that is shorter; for a list the shortest contact time
// counts.
Cem resolved(const Scene& scene, Cem options);

// Returns the problems of the (resolved) options: those of each by itself (engine.hpp) or, if there are none,
// a step beyond the stability limit without `unstable`, and a large step that is not larger than the step,
// beyond the limit in flight, or longer than half a period of the forcing. Empty if there are none.
std::vector<Problem> problems_of(const Scene& scene, const Cem& options);

// Runs a scene of one damper without friction, drag, weight and laws of its own (is_ideal), for an observer
// with the members of Recorder. Throws NumericalError where the numbers overflow.
template <Scalar Real = double, RunObserver Observer>
Outcome run_cem(const Checked& run, Observer& observer) {
  require_ideal(run.scene());
  require_arithmetic();
  return CemEngine<Real, Observer, ForOne>(run.scene(), run.options<Cem>(), observer).run();
}

// Runs any scene in the same way.
template <Scalar Real = double, DampersObserver Observer>
Outcome run_cem_dampers(const Checked& run, Observer& observer) {
  if (run.scene().dampers.size() == 1 && is_ideal(run.scene())) return run_cem<Real>(run, observer);
  require_arithmetic();
  return CemEngine<Real, Observer, ForSeveral>(run.scene(), run.options<Cem>(), observer).run();
}

}  // namespace impact_damper
