#include "impact_damper/orbits/masses_along_run.hpp"

#include <algorithm>
#include <cmath>

namespace impact_damper {
namespace {

// All intervals of contact of a run, with those that end with it, in the order of `first`. A mass whose
// chattering is complete sticks from the impact at which the limit is taken. scene: that of the run,
// except for initial condition and end.
std::vector<ContactInterval> contact_intervals(const Scene& scene, const RecordedRun& run, bool rigid) {
  const MotionChain& chain = run.chain;
  std::vector<ContactInterval> all;
  const auto add = [&](std::size_t damper, std::size_t last, Wall wall, double begin) {
    // Sticking is also begun by impacts of other masses, but not at the run's beginning.
    std::size_t after =
        std::size_t(std::ranges::lower_bound(chain.impacts, last, {}, &MotionChain::Impact::motions) -
                    chain.impacts.begin());
    while (after > 0 && !(chain.impacts[after - 1].time <= begin &&
                          ((rigid && begin > 0) || std::size_t(chain.impacts[after - 1].damper) == damper)))
      --after;
    const bool from_beginning = after == 0 && (begin == 0 || !rigid);
    const std::size_t first = after == 0 ? 0 : chain.impacts[after - 1].motions;
    if (first < last)
      all.push_back({damper, first, last, wall == Wall::left ? 1 : -1, after, from_beginning});
  };
  for (const MotionChain::Contact& each : chain.contacts)
    add(std::size_t(each.damper), each.motions, each.wall, each.begin);
  // A run that ends within a chattering whose limit has been taken reports no contact.
  if (rigid && run.stop_reason == StopReason::time) {
    for (std::size_t i = 0; i < run.end.dampers.size(); ++i) {
      const auto& [y, w] = run.end.dampers[i];
      const bool rests = w == 0 && (y == 0 || y == scene.dampers[i].clearance);
      const bool known = std::ranges::any_of(all, [&](const ContactInterval& each) {
        return each.damper == i && each.last == chain.motions.size();
      });
      if (rests && !known) add(i, chain.motions.size(), y == 0 ? Wall::left : Wall::right, run.end_time);
    }
  }
  std::ranges::sort(all, {}, &ContactInterval::first);
  return all;
}

}  // namespace

MassesAlongRun::MassesAlongRun(const VariationalCoefficients& of, const RecordedRun& run)
    : x(run.begin.x),
      v(run.begin.v),
      contacts(contact_intervals(of.scene, run, of.rigid)),
      of_(of),
      run_(run) {
  for (const PlaceInCavity& each : run.begin.dampers) masses.push_back({.y = each.y, .w = each.w});
}

double MassesAlongRun::force_in_cavity(std::size_t i) const {
  const VariationalCoefficients::OfDamper& its = of_.dampers[i];
  const Mass& mass = masses[i];
  double force = its.friction * mass.slides + its.drag * mass.w;
  if (mass.wall != 0) force += its.damping * mass.w + wall_spring(i);
  return force;
}

double MassesAlongRun::acceleration(double time) const {
  double force = of_.force.amplitude * of_.force.phase(time).sin - 2 * of_.zeta * v - x;
  for (std::size_t i = 0; i < masses.size(); ++i)
    force += of_.dampers[i].nu * (masses[i].held ? -of_.weight : force_in_cavity(i));
  return force / joined_mass();
}

void MassesAlongRun::come_to(std::size_t n) {
  continued = n > 0;
  const auto& all = run_.chain.impacts;
  const std::size_t first = next_impact_;
  while (next_impact_ < all.size() && all[next_impact_].motions == n) ++next_impact_;
  impacts = std::span(all).subspan(first, next_impact_ - first);
}

// Ends and begins contacts before the motion n. Returns whether there are any.
bool MassesAlongRun::take_contacts(std::size_t n) {
  bool some = some_begin_at(n);
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (!ends_contact(i, n)) continue;
    masses[i].wall = 0;
    masses[i].held = false;
    some = true;
  }
  for (; some_begin_at(n); ++next_contact_) {
    const ContactInterval& begins = contacts[next_contact_];
    masses[begins.damper].wall = begins.away;
    masses[begins.damper].held = of_.rigid;
    masses[begins.damper].end_of_contact = begins.last;
  }
  in_contact.clear();
  for (std::size_t i = 0; i < masses.size(); ++i)
    if (masses[i].wall != 0) in_contact.push_back(i);
  return some;
}

bool MassesAlongRun::comes_to_event(std::size_t n) {
  come_to(n);
  if (of_.has_components) {
    const auto& all = run_.chain.settled;
    const std::size_t first = next_settled_;
    while (next_settled_ < all.size() && all[next_settled_].motions == n) ++next_settled_;
    settled_ = std::span(all).subspan(first, next_settled_ - first);
    if (settled_.empty()) return false;
    for (const MotionChain::Settled& each : settled_) {
      Mass& mass = masses[std::size_t(each.damper)];
      if (!of_.rigid) {  // no event moves a mass
        mass.w = each.place.w;
      } else if (!mass.held) {  // y' + d y since the last event (M13.33)
        mass.w -= of_.dampers[std::size_t(each.damper)].drag * (each.place.y - mass.y);
      }
      mass.y = each.place.y;
    }
  } else if (impacts.empty() && !some_begin_at(n)) {
    if (take_contacts(n)) continued = false;
    return false;
  }
  continued = false;
  find_active();
  return true;
}

// Finds the masses that meet walls, with y and y' then, and which of these and of those that stick get an
// impulse.
void MassesAlongRun::find_active() {
  for (Mass& each : masses) each.meets = each.is_active = false;
  active_mass = 1;
  if (impacts.empty()) return;
  at_walls_.clear();
  for (const MotionChain::Impact& impact : impacts) {
    const auto i = std::size_t(impact.damper);
    const VariationalCoefficients::OfDamper& its = of_.dampers[i];
    Mass& mass = masses[i];
    mass.y = impact.wall == Wall::left ? 0 : its.clearance;
    mass.w = impact.w;
    mass.meets = true;
    at_walls_.push_back({i, its.nu, its.e, impact.w < 0 ? 1.0 : -1.0, -std::fabs(impact.w)});
  }
  if (!of_.rigid) return;
  for (std::size_t i = 0; i < masses.size(); ++i)
    if (masses[i].wall != 0)
      at_walls_.push_back({i, of_.dampers[i].nu, of_.dampers[i].e, double(masses[i].wall), 0.0});
  const double jump = jump_of_velocity<double>(std::span(at_walls_));
  for (const MassAtWall<double>& each : at_walls_) {
    if (!(each.escape() + each.away * jump > 0)) continue;
    masses[each.index].is_active = true;
    active_mass += each.nu;
  }
}

void MassesAlongRun::pass_event(std::size_t n) {
  double gained = 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const VariationalCoefficients::OfDamper& its = of_.dampers[i];
    masses[i].wall_before = masses[i].wall;
    masses[i].held_before = masses[i].held;
    masses[i].slides_before = masses[i].slides;
    if (masses[i].is_active) gained += its.nu * (1 + its.e) * masses[i].w / active_mass;
  }
  if (of_.has_components) {
    take_settled();
  } else {
    take_contacts(n);
    for (const std::size_t i : in_contact) masses[i].y = position_of_wall(i);
  }

  v += gained;
  double joined = 0;
  const double joined_to = joined_mass();
  for (std::size_t i = 0; i < masses.size(); ++i) {
    Mass& mass = masses[i];
    // A mass that its wall leaves behind and that sticks again at the same event counts as newly stuck.
    const bool stays = mass.held_before && (!of_.rigid || impacts.empty() || mass.is_active);
    mass.joins = mass.held && !stays;
    mass.w = mass.is_active ? -of_.dampers[i].e * mass.w : mass.w - gained;
    if (mass.joins) joined += of_.dampers[i].nu * mass.w / joined_to;
  }
  v += joined;
  for (Mass& mass : masses) {
    mass.w = mass.held ? 0 : mass.w - joined;
    mass.joins_place = mass.joins;
  }
  if (!of_.has_components) return;
  for (const MotionChain::Settled& each : settled_) masses[std::size_t(each.damper)].w = each.place.w;
  const double pressed = n == 0 ? acceleration(run_.chain.motions[n].begin) + of_.weight : 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    Mass& mass = masses[i];
    mass.joins_place =
        of_.rigid && mass.joins && mass.wall != 0 && (n > 0 || mass.wall * pressed > of_.dampers[i].holding);
  }
}

// Sets where the masses are, and how, from the event that settled them; y' stays that before.
void MassesAlongRun::take_settled() {
  in_contact.clear();
  for (const MotionChain::Settled& each : settled_) {
    const auto i = std::size_t(each.damper);
    Mass& mass = masses[i];
    const bool left = each.place.y <= 0, right = each.place.y >= of_.dampers[i].clearance;
    mass.held = each.held;
    mass.wall = !(of_.rigid ? each.held : each.pushes) ? 0 : left ? 1 : right ? -1 : 0;
    mass.slides = each.slides;
    mass.y = each.place.y;
    if (mass.held || mass.wall != 0) in_contact.push_back(i);
  }
}

void MassesAlongRun::come_to_contacts(std::size_t n) {
  come_to(n);
  for (std::size_t i = 0; i < masses.size(); ++i)
    if (ends_contact(i, n)) continued = false;
  if (!impacts.empty()) continued = false;
}

void MassesAlongRun::pass_contacts(std::size_t n) {
  for (std::size_t i = 0; i < masses.size(); ++i) {
    if (!ends_contact(i, n)) continue;
    masses[i].y = position_of_wall(i);
    masses[i].w = absolute_velocity_before(n, i) - v;
  }
  for (const MotionChain::Impact& impact : impacts) {
    const auto i = std::size_t(impact.damper);
    masses[i].y = impact.wall == Wall::left ? 0 : of_.dampers[i].clearance;
    masses[i].w = impact.w;
  }
  take_contacts(n);
}

// x' + y' of a mass that flies on from before the motion n, which it keeps until its next impact.
double MassesAlongRun::absolute_velocity_before(std::size_t n, std::size_t damper) const {
  const auto& all = run_.chain.impacts;
  for (std::size_t k = next_impact_; k < all.size(); ++k)
    if (std::size_t(all[k].damper) == damper && all[k].motions > n)
      return run_.chain.motions[all[k].motions - 1].v + all[k].w;
  return run_.end.v + run_.end.dampers[damper].w;
}

}  // namespace impact_damper
