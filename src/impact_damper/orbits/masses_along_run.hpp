// The state of all masses at the events of a recorded run, one event after the other, for the variational
// equations and the search for the nearest miss. The record has x and x' at the end of each motion, and y'
// before each impact; y and y' of the other masses follow from these (docs/mathematics.md, 13.10).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "impact_damper/motion/contact_modes.hpp"
#include "impact_damper/motion/impact_law.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/orbits/variational_equations.hpp"

namespace impact_damper {

using UnforcedModes = ContactModes<double, NoForcing<double>>;

// The coefficients of the variational equations: those of a scene with the engine exact or restitution, the
// same for all of its runs.
struct VariationalCoefficients {
  struct OfDamper {
    double nu, e, clearance;
    double stiffness = 0, damping = 0;   // compliant walls: K and gamma of (M17.9)
    double friction = 0, holding = 0;    // phi and phi_s
    double drag = 0;                     // d
    std::optional<UnforcedModes> modes;  // of their contacts
  };

  VariationalCoefficients(Scene of_scene, const Engine& engine)
      : scene(std::move(of_scene)),
        rigid(has_rigid_walls(engine)),
        has_components(impact_damper::has_components(scene)),
        plain_contacts(!rigid && !has_components),
        zeta(scene.damping_ratio),
        weight(scene.weight),
        force{scene.force_amplitude, scene.force_frequency},
        free(zeta, 1) {
    const auto* const exact = std::get_if<Exact>(&engine);
    for (const SceneDamper& each : scene.dampers) {
      OfDamper& damper = dampers.emplace_back(
          OfDamper{.nu = each.mass_ratio, .e = each.restitution, .clearance = each.clearance, .modes = {}});
      damper.friction = each.friction;
      damper.holding = each.holding();
      damper.drag = each.drag;
      if (!exact) continue;
      damper.modes.emplace(System<double, NoForcing<double>>(scene, each),
                           zeta_m<double>(each, exact->calibration));
      damper.stiffness = damper.modes->stiffness;
      damper.damping = damper.modes->damping;
    }
  }
  std::size_t dimensions() const { return 2 + 2 * dampers.size(); }

  Scene scene;
  bool rigid, has_components;
  bool plain_contacts;  // compliant walls, without friction, weight and drag
  double zeta, weight;
  Forcing<double> force;
  Oscillator<double> free;  // the primary mass alone
  std::vector<OfDamper> dampers;
};

// For each motion n of the run, from 0, the caller calls comes_to_event(n) and, if that is true,
// pass_event(n), or with plain contacts come_to_contacts(n) and pass_contacts(n). Then it advances y and y'
// of the masses in flight to the end of the motion, as far as it needs them, and calls pass(motion). With
// drag and rigid walls y' may be advanced without it where y is not advanced: the next event adds it. With
// compliant walls and friction, weight or drag the events have y and y' of all masses.
class MassesAlongRun {
 public:
  struct Mass {
    double y, w;
    int wall = 0;         // ContactInterval::away while it sticks or is in contact, else 0
    bool held = false;    // it moves with the primary mass: it sticks to a rigid wall, or friction holds it
    int wall_before = 0;  // both before the last event, not of plain contacts
    bool held_before = false;
    std::size_t end_of_contact = 0;  // ContactInterval::last of that contact
    // Whether at the last event it had an impact, was held from then on, got an impulse from its rigid wall
    // (M17.3).
    bool meets = false, joins = false, is_active = false;
    bool joins_place = false;  // it joined with the change of y, too (M13.24)
    // With friction: the sign of y' with which it acts, 0 where the mass does not slide, and the same before
    // the last event.
    double slides = 0, slides_before = 0;
  };

  // Both must outlive this object.
  MassesAlongRun(const VariationalCoefficients& of, const RecordedRun& run);

  // Whether there is an event between the motions n - 1 and n. At rigid walls: impacts, or sticking that
  // begins. If so, finds which masses it acts on; x', y', `wall` and `held` are still those before. If not,
  // ends the sticking that ends there, which changes no speed. With friction, weight or drag also stops,
  // releases and, at compliant walls, touches and ends of contacts; the first is the beginning of the run.
  bool comes_to_event(std::size_t n);
  // Applies that event to x', y, y', `wall` and `held` of all masses.
  void pass_event(std::size_t n);
  // Sets `impacts` and `continued` for the plain touches and ends of contacts, for which ends_contact() is
  // true, between the motions n - 1 and n.
  void come_to_contacts(std::size_t n);
  // Sets y and y' of the masses of these events, and ends and begins their contacts.
  void pass_contacts(std::size_t n);
  // Sets x and x' to those at the end of a motion.
  void pass(const MotionChain::Motion& motion) { x = motion.x, v = motion.v; }

  // Whether the i-th mass is in contact until the motion n begins.
  bool ends_contact(std::size_t i, std::size_t n) const {
    return masses[i].wall != 0 && masses[i].end_of_contact == n;
  }
  double position_of_wall(std::size_t i) const { return masses[i].wall > 0 ? 0 : of_.dampers[i].clearance; }
  // The primary mass and all that is held, divided by the primary mass, now and before the last event.
  double joined_mass() const { return joined_by(&Mass::held); }
  double joined_mass_before() const { return joined_by(&Mass::held_before); }
  // x'', for which y and y' of all that pushes a compliant wall and y' of all that slides in a fluid must be
  // those of now.
  double acceleration(double time) const;
  // The force R of (M18.1) of a mass that is not held.
  double force_in_cavity(std::size_t i) const;
  // K q of a mass in a compliant wall, else 0.
  double wall_spring(std::size_t i) const {
    return of_.rigid || masses[i].wall == 0 ? 0
                                            : of_.dampers[i].stiffness * (masses[i].y - position_of_wall(i));
  }
  // What is constant in -(x'' + y'') of a mass in flight, to which drag adds d y'.
  double pull(std::size_t i) const { return of_.dampers[i].friction * masses[i].slides + of_.weight; }

  double x, v;
  std::vector<Mass> masses;
  std::vector<std::size_t> in_contact;           // masses whose `wall` is not 0, ascending
  std::vector<ContactInterval> contacts;         // of the whole run
  std::span<const MotionChain::Impact> impacts;  // between the motions n - 1 and n
  double active_mass = 1;  // at the last event at rigid walls: 1 plus the mass ratios that are active
  bool continued = false;  // no event lies between the motions n - 1 and n: flights go on

 private:
  void come_to(std::size_t n);
  double joined_by(bool Mass::*held) const {
    double all = 1;
    for (std::size_t i = 0; i < masses.size(); ++i)
      if (masses[i].*held) all += of_.dampers[i].nu;
    return all;
  }
  bool some_begin_at(std::size_t n) const {
    return next_contact_ < contacts.size() && contacts[next_contact_].first == n;
  }
  bool take_contacts(std::size_t n);
  void take_settled();
  void find_active();
  double absolute_velocity_before(std::size_t n, std::size_t damper) const;

  const VariationalCoefficients& of_;
  const RecordedRun& run_;
  std::size_t next_contact_ = 0, next_impact_ = 0, next_settled_ = 0;
  std::span<const MotionChain::Settled> settled_;  // between the motions n - 1 and n
  std::vector<MassAtWall<double>> at_walls_;
};

// Returns the least distance from a wall, divided as in run.hpp, at which a mass turns back in flight: y'
// changes its sign there without an impact (docs/mathematics.md, 13.10). Nothing if no mass does.
std::optional<double> nearest_miss(const VariationalCoefficients& of, const RecordedRun& run);

}  // namespace impact_damper
