// The exact engine: compliant walls, every motion a closed form, every event solved for.
//
// A scene is a chain of flights (flight.hpp) and contacts (contact.hpp). A flight ends where a wall is met, a
// contact where the secondary mass is back at the wall's position (a displacement criterion: near the end of
// a contact the wall's damper pulls). Both ends are predicted and validated (impact_prediction.hpp,
// short_contact_map.hpp, and contact.hpp for sustained contacts) or, where the validation fails, searched for
// with proved steps (root_isolation.hpp): none larger than rounding is missed (docs/mathematics.md, 7.8).
// There is no time step, and no error but rounding.
#pragma once

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/observer.hpp"
#include "impact_damper/engines/run_tracker.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/contact_without_modes.hpp"
#include "impact_damper/motion/contact_work.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {

// Runs a scene without a list of dampers, and reports to `observer` what it asks for.
template <Scalar Real, RunObserver Observer>
Outcome run_exact(const Checked& run, Observer& observer) {
  require_no_components(run.scene());
  return with_system<Real>(run.scene(), [&](const auto& system) {
    return run_exact(system, run.scene(), run.options<Exact>(), observer);
  });
}

template <class Real, class Force, class Observer>
Outcome run_exact(const System<Real, Force>& system, const Scene& scene, const Exact& options,
                  Observer& observer) {
  require_arithmetic();
  const ContactModes<Real, Force> walls(system, zeta_m<Real>(scene.damper(), options.calibration));
  return walls.coupled ? run_exact<ContactWithoutModes<Real, Force>>(walls, system, scene, options, observer)
                       : run_exact<Contact<Real, Force>>(walls, system, scene, options, observer);
}

// The same with the type of the motion in contact.
template <class InContact, class Real, class Force, class Observer>
Outcome run_exact(const ContactModes<Real, Force>& walls, const System<Real, Force>& system,
                  const Scene& scene, const Exact& options, Observer& observer) {
  RunTracker<Real, Force, Observer> tracker(scene, system, options.budget, options.max_steps, observer);

  State<Real> state{Real(scene.x0), Real(scene.v0), Real(scene.damper().y0), Real(scene.damper().w0)};
  const auto depth_of = [](const State<Real>& s) {
    return s.y < 0 ? Real(-s.y) : s.y > 1 ? Real(s.y - 1) : Real(0);
  };
  tracker.begin(state, depth_of(state));
  const Real wall_damping = system.nu * walls.damping;
  Real losses{0};

  // A release at rest on a wall: in contact if it sticks. (With a velocity towards the wall it is an
  // impact, which the flight meets at once.)
  bool at_rest_on_wall = state.w == 0 && (state.y == 0 || state.y == 1);
  bool in_contact = state.y < 0 || state.y > 1 ||
                    (at_rest_on_wall && Flight<Real, Force>(system, tracker.now(), state).sticks());
  bool by_impact = false;
  Real depth{0};  // of the overlap at the end of the run
  Wall wall = state.y <= 0 ? Wall::left : Wall::right;

  SinCos<Real> phase = system.forcing.phase(tracker.now());  // of the force, now

  while (!tracker.stopped()) {
    if (!in_contact) {
      Flight<Real, Force> flight(system, tracker.now(), phase, FlightStart<Real>(state));
      const auto met = pass_flight(system, tracker, flight, state, at_rest_on_wall);
      at_rest_on_wall = false;
      if (!met) break;
      phase = system.forcing.phase(tracker.now());
      wall = *met;
      if (!tracker.impact(wall, state)) break;
      in_contact = by_impact = true;
    } else {
      const InContact contact(walls, tracker.now(), phase, state, wall, Real(wall == Wall::left ? 0 : 1));
      const auto end = contact.leave(tracker.remaining(), tracker.search());
      const Real begin = tracker.now();
      if (end) state = copied(end->state);
      const Work<Real> works =
          tracker.pass(contact, end ? end->time : tracker.remaining(), state, wall_damping);
      if (observer.wants_contacts()) observer.contact(double(begin), tracker.time(), wall);
      if (observer.wants_energy()) {
        losses += works.wall;
        if (by_impact) {
          observer.energy_balance().impact_loss.push_back(double(works.wall));
        } else {
          observer.energy_balance().contact_loss += double(works.wall);
        }
      }
      if (tracker.stopped()) {
        depth = contact.overlap(tracker.passed());
        break;
      }
      phase = system.forcing.phase(tracker.now(), phase, tracker.passed());
      in_contact = by_impact = at_rest_on_wall = false;
    }
  }
  tracker.finish(state, depth, losses);
  return tracker.outcome();
}

}  // namespace impact_damper
