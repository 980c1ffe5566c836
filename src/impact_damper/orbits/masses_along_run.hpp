// The masses of a run as its record has them, event by event: what the variational equations and the search
// for near misses go by. x and x' at the end of each motion and y' at each impact are the run's; y and y' of
// all masses follow from these.
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

struct VariationalCoefficients {
  struct OfDamper {
    double nu, e, clearance;
    double stiffness = 0, damping = 0;   // compliant walls: K and gamma of (M17.9)
    std::optional<UnforcedModes> modes;  // of their contacts
  };

  VariationalCoefficients(Scene of_scene, const Engine& engine)
      : scene(std::move(of_scene)),
        rigid(has_rigid_walls(engine)),
        zeta(scene.damping_ratio),
        force{scene.force_amplitude, scene.force_frequency},
        free(zeta, 1) {
    const auto* const exact = std::get_if<Exact>(&engine);
    for (const SceneDamper& each : scene.dampers) {
      OfDamper& damper = dampers.emplace_back(
          OfDamper{.nu = each.mass_ratio, .e = each.restitution, .clearance = each.clearance, .modes = {}});
      if (!exact) continue;
      damper.modes.emplace(System<double, NoForcing<double>>(scene, each),
                           zeta_m<double>(each, exact->calibration));
      damper.stiffness = damper.modes->stiffness;
      damper.damping = damper.modes->damping;
    }
  }
  std::size_t dimensions() const { return 2 + 2 * dampers.size(); }

  Scene scene;
  bool rigid;
  double zeta;
  Forcing<double> force;
  Oscillator<double> free;  // the primary mass alone
  std::vector<OfDamper> dampers;
};

class MassesAlongRun {
 public:
  struct Mass {
    double y, w;
    int wall = 0;  // ContactInterval::away while it is in contact, else 0
    int wall_before = 0;
    std::size_t end_of_contact = 0;  // ContactInterval::last of that contact
    // What the last event at rigid walls did to it. is_active: it got an impulse from its wall (M17.3).
    bool meets = false, joins = false, is_active = false;
  };

  MassesAlongRun(const VariationalCoefficients& of, const RecordedRun& run);

  // Come to the motion n, which follows the one that was passed, and to the events between both. With rigid
  // walls an event is the impacts together with the sticking that begins; the end of sticking changes
  // nothing, as the mass has no relative speed.
  bool comes_to_rigid_event(std::size_t n);  // takes contacts if there is none
  void pass_rigid_event(std::size_t n);      // that one
  void come_to_compliant_events(std::size_t n);
  void pass_compliant_events(std::size_t n);
  void pass(const MotionChain::Motion& motion) { x = motion.x, v = motion.v; }

  bool ends_contact(std::size_t i, std::size_t n) const {
    return masses[i].wall != 0 && masses[i].end_of_contact == n;
  }
  double position_of_wall(std::size_t i) const { return masses[i].wall > 0 ? 0 : of_.dampers[i].clearance; }
  // The primary mass and all that sticks to it.
  double joined_mass() const;

  double x, v;
  std::vector<Mass> masses;
  std::vector<std::size_t> in_contact;           // of the motion that was come to
  std::vector<ContactInterval> contacts;         // of the whole run
  std::span<const MotionChain::Impact> impacts;  // of the events that were come to
  double active_mass = 1;  // at the last rigid event: 1 plus the mass ratios that are active
  bool continued = false;  // no event came before this motion: flights go on

 private:
  void come_to(std::size_t n);
  bool some_begin_at(std::size_t n) const {
    return next_contact_ < contacts.size() && contacts[next_contact_].first == n;
  }
  bool take_contacts(std::size_t n);
  void find_active();
  double absolute_velocity_before(std::size_t n, std::size_t damper) const;

  const VariationalCoefficients& of_;
  const RecordedRun& run_;
  std::size_t next_contact_ = 0, next_impact_ = 0;
  std::vector<MassAtWall<double>> at_walls_;
};

}  // namespace impact_damper
