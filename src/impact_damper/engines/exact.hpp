// The exact engine: compliant walls, every motion a closed form, every event solved for.
//
// A scene is a chain of flights (flight.hpp) and contacts (contact.hpp). A flight ends where a wall is met, a
// contact where the secondary mass is back at the wall's position (a displacement criterion: near the end of
// a contact the wall's damper pulls). Both ends are predicted and validated (arrival.hpp, rebound.hpp) or,
// where the validation fails, searched for with proved steps (first_root.hpp): none is missed
// (docs/mathematics.md, chapter 7). There is no time step, and no error but rounding.
#pragma once

#include "impact_damper/arithmetic.hpp"
#include "impact_damper/engines/timeline.hpp"
#include "impact_damper/motion/contact_works.hpp"
#include "impact_damper/motion/coupled_contact.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {

// Runs a scene that problems_of finds nothing wrong with, telling `observer` (recorder.hpp) what it wants.
template <class Real, class Observer>
Outcome run_exact(const Scene& scene, const Exact& options, Observer& observer) {
  require_arithmetic();
  return with_system<Real>(scene,
                           [&](const auto& system) { return run_exact(system, scene, options, observer); });
}

template <class Real, class Force, class Observer>
Outcome run_exact(const System<Real, Force>& system, const Scene& scene, const Exact& options,
                  Observer& observer) {
  const ContactSystem<Real, Force> walls(system, zeta_m<Real>(scene, options.calibration));
  return walls.coupled ? run_exact<CoupledContact<Real, Force>>(walls, system, scene, options, observer)
                       : run_exact<Contact<Real, Force>>(walls, system, scene, options, observer);
}

// The same with the motion that contacts are.
template <class InContact, class Real, class Force, class Observer>
Outcome run_exact(const ContactSystem<Real, Force>& walls, const System<Real, Force>& system,
                  const Scene& scene, const Exact& options, Observer& observer) {
  Timeline<Real, Force, Observer> timeline(scene, system, options.budget, observer);

  State<Real> state{Real(scene.x0), Real(scene.v0), Real(scene.y0), Real(scene.w0)};
  const auto depth_of = [](const State<Real>& s) {
    return s.y < 0 ? Real(-s.y) : s.y > 1 ? Real(s.y - 1) : Real(0);
  };
  timeline.begin(state, depth_of(state));
  const Real wall_damping = system.nu * walls.damping;
  Real losses{0};

  // A release at rest on a wall: in contact if pressed against it. (With a velocity towards the wall it is an
  // impact, which the flight meets at once.)
  bool at_rest_on_wall = state.w == 0 && (state.y == 0 || state.y == 1);
  bool in_contact = state.y < 0 || state.y > 1 ||
                    (at_rest_on_wall && Flight<Real, Force>(system, timeline.now(), state).pressed());
  bool by_impact = false;
  Real depth{0};  // at the end
  Wall wall = state.y <= 0 ? Wall::left : Wall::right;

  while (!timeline.stopped()) {
    if (!in_contact) {
      const Flight<Real, Force> flight(system, timeline.now(), state);
      const auto met = at_rest_on_wall ? flight.released_meets_wall(timeline.remaining(), timeline.span())
                                       : flight.next_wall(timeline.remaining(), timeline.span());
      at_rest_on_wall = false;
      if (met) state = copied(met->state);
      timeline.pass(flight, met ? met->time : timeline.remaining(), state, Real(0));
      if (timeline.stopped()) break;
      wall = met->wall;
      if (!timeline.impact(wall, state)) break;
      in_contact = by_impact = true;
    } else {
      const InContact contact(walls, timeline.now(), state, wall);
      const auto left = contact.leave(timeline.remaining(), timeline.span());
      const Real begin = timeline.now();
      if (left) state = copied(left->state);
      const Works<Real> works =
          timeline.pass(contact, left ? left->time : timeline.remaining(), state, wall_damping);
      if (observer.wants_contacts())
        observer.contact(double(begin), timeline.stopped() ? timeline.end_time() : double(timeline.now()),
                         wall);
      if (observer.wants_energy()) {
        losses += works.wall;
        if (by_impact) {
          observer.ledger().impact_loss.push_back(double(works.wall));
        } else {
          observer.ledger().contact_loss += double(works.wall);
        }
      }
      if (timeline.stopped()) {
        depth = contact.overlap(timeline.passed());
        break;
      }
      in_contact = by_impact = at_rest_on_wall = false;
    }
  }
  timeline.finish(state, depth, losses);
  return {*timeline.stopped(), timeline.end_time()};
}

}  // namespace impact_damper
