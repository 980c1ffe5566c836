#include <algorithm>
#include <optional>
#include <vector>

#include "impact_damper/engines/observer.hpp"
#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/joint_contact.hpp"
#include "impact_damper/motion/motion_by_series.hpp"
#include "impact_damper/motion/shifted_motion.hpp"
#include "impact_damper/orbits/masses_along_run.hpp"

namespace impact_damper {
namespace {

using ForcedOscillator = Driven<double, Forcing<double>>;

class NearestMiss {
 public:
  NearestMiss(const VariationalCoefficients& of, const RecordedRun& run)
      : of_(of), run_(run), now_(of, run), free_(of.zeta, 1, of.force) {}

  std::optional<double> find() {
    for (std::size_t n = 0; n < run_.chain.motions.size(); ++n) {
      const MotionChain::Motion& motion = run_.chain.motions[n];
      if (!of_.plain_contacts) {
        if (now_.comes_to_event(n)) {
          now_.pass_event(n);
          note_stops();
        }
        if (of_.has_components) {
          pass_with_components(motion);
        } else {
          pass_masses(motion, now_.joined_mass());
        }
      } else {
        now_.come_to_contacts(n);
        now_.pass_contacts(n);
        if (now_.in_contact.empty()) {
          pass_masses(motion, 1);
        } else if (now_.masses.size() > 1) {
          pass_masses_beside_contacts(motion);
        }
      }
      now_.pass(motion);
    }
    return nearest_;
  }

 private:
  void note(double gap) {
    if (!(nearest_ && *nearest_ <= gap)) nearest_ = gap;
  }
  // A mass with friction turns back only where it stops.
  void note_stops() {
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      const MassesAlongRun::Mass& mass = now_.masses[i];
      if (mass.slides_before == 0 || mass.meets || mass.w != 0 || in_wall(i)) continue;
      note(mass.slides_before > 0 ? of_.dampers[i].clearance - mass.y : mass.y);
    }
  }
  // Whether a mass pushes a compliant wall.
  bool in_wall(std::size_t i) const { return !of_.rigid && now_.masses[i].wall != 0; }
  // Whether a mass in flight may turn back without a stop.
  bool may_turn(std::size_t i) const {
    return !now_.masses[i].held && !in_wall(i) && of_.dampers[i].friction == 0;
  }
  // Follows the masses in flight, on which friction, weight or drag act, and those that push compliant walls,
  // and updates the nearest miss.
  void pass_with_components(const MotionChain::Motion& motion) {
    // An event at compliant walls tells where all masses are.
    bool some_may_turn = of_.rigid;
    for (std::size_t i = 0; i < now_.masses.size(); ++i) some_may_turn = some_may_turn || may_turn(i);
    if (!some_may_turn) return;
    const double joined_mass = now_.joined_mass();
    in_series_.clear();
    number_in_series_.assign(now_.masses.size(), 0);
    forces_ = {.weight = of_.weight, .held = joined_mass - 1};
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      const VariationalCoefficients::OfDamper& its = of_.dampers[i];
      const MassesAlongRun::Mass& mass = now_.masses[i];
      if (mass.held) continue;
      const double friction = its.friction * mass.slides;
      if (in_wall(i)) {
        in_series_.push_back(
            {its.nu, its.stiffness, its.damping + its.drag, mass.y - now_.position_of_wall(i), mass.w});
      } else if (its.drag != 0) {
        in_series_.push_back({its.nu, 0, its.drag, 0, mass.w});
      } else {
        forces_.others += its.nu * friction;
        continue;
      }
      forces_.friction.push_back(friction);
      number_in_series_[i] = in_series_.size();
    }
    if (!in_series_.empty()) {
      series_.begin(of_.zeta, of_.force, motion.begin, now_.x, now_.v, in_series_, forces_);
      return follow(series_, motion.duration);
    }
    const Forcing<double> force{of_.force.amplitude / joined_mass, of_.force.frequency};
    std::optional<ForcedOscillator> joined;
    if (joined_mass != 1) joined.emplace(of_.zeta / joined_mass, 1 / joined_mass, of_.force);
    ShiftedMotion<double, Forcing<double>> shifted(joined ? *joined : free_, force, motion.begin, now_.x,
                                                   now_.v, forces_.others - of_.weight * forces_.held);
    follow(shifted, motion.duration);
  }
  // moved_by: a ShiftedMotion, or a MotionBySeries.
  template <class MovedBy>
  void follow(MovedBy& moved_by, double duration) {
    using Now = typename MovedBy::Now;
    const double span = moved_by.span(search_.span);
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      MassesAlongRun::Mass& mass = now_.masses[i];
      if (mass.held) continue;
      const double pull = number_in_series_[i] > 0 ? 0 : now_.pull(i);
      // Let go by its wall it has y'' = 0 there, too; see Flight::turn_of_y().
      double begin = 0;
      if (mass.w == 0) {
        Now now(moved_by, 0, span);
        auto&& first = now.of_mass(number_in_series_[i]);
        begin = begin_by_lead<double>(2, first[3], first.bound(4), span);
      }
      const auto gained = [&](double t) {
        const auto [x, v, dx, dv] = moved_by.of_mass(number_in_series_[i], t, moved_by.displacement(t));
        return PlaceInCavity{mass.w * t - (dx + pull * t * t / 2), -(dv + pull * t)};
      };
      const auto turn = [&](double sign, double from) {
        return isolate_fall<double>(
            [&](double t) {
              Now now(moved_by, t, span);
              auto&& x = now.of_mass(number_in_series_[i]);
              const double w = mass.w - (x.displacement().dv + pull * t);
              return LocalEnclosure<double>{{sign * w, -sign * (x[2] + pull), -sign * x[3], x.bound(4)}};
            },
            std::max(from, begin), duration, search_, 1.0);
      };
      if (may_turn(i)) look_for_misses(i, turn, [&](double time) { return mass.y + gained(time).y; });
      const PlaceInCavity end = gained(duration);
      mass.y += end.y;
      mass.w += end.w;
    }
  }
  // Follows y and y' of the masses that fly, `joined_mass` being that of the primary mass and all that
  // sticks, and updates the nearest miss.
  void pass_masses(const MotionChain::Motion& motion, double joined_mass) {
    if (now_.in_contact.size() == now_.masses.size()) return;
    const Forcing<double> force{of_.force.amplitude / joined_mass, of_.force.frequency};
    std::optional<ForcedOscillator> joined;
    if (joined_mass != 1) joined.emplace(of_.zeta / joined_mass, 1 / joined_mass, of_.force);
    const ForcedMotion<double> primary(joined ? *joined : free_, force, motion.begin, now_.x, now_.v);
    starts_.resize(now_.masses.size(), FlightStart<double>(State<double>{}));
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      MassesAlongRun::Mass& mass = now_.masses[i];
      if (mass.wall != 0) continue;
      const double clearance = of_.dampers[i].clearance;
      FlightStart<double>& start = starts_[i];
      if (!now_.continued) {
        const bool left = mass.y <= clearance / 2;
        start = {{now_.x, now_.v, mass.y, mass.w},
                 left ? 0 : clearance,
                 left ? 1.0 : -1.0,
                 left ? mass.y : clearance - mass.y};
      }
      const Flight<double, Forcing<double>, OwnClearance<double>, const ForcedMotion<double>&> flight(
          primary, {clearance}, start);
      look_for_misses(
          i, [&](double sign, double from) { return flight.turn_of_y(sign, from, motion.duration, search_); },
          [&](double time) { return flight.at(time).y; });
      start = flight.start_of_rest(motion.duration);
      mass.y = start.state.y;
      mass.w = start.state.w;
    }
  }
  // The same while some masses push compliant walls, which are followed, too.
  void pass_masses_beside_contacts(const MotionChain::Motion& motion) {
    std::vector<PushedWall<double>> walls;
    for (const std::size_t i : now_.in_contact)
      walls.push_back({of_.dampers[i].nu, of_.dampers[i].stiffness, of_.dampers[i].damping,
                       now_.masses[i].y - now_.position_of_wall(i), now_.masses[i].w});
    joint_.set_walls(of_.zeta, of_.force, walls);
    double x = now_.x, v = now_.v;
    for (double passed = 0; passed < motion.duration;) {
      joint_.begin(motion.begin + passed, x, v, walls);
      const double left = motion.duration - passed, until = std::min(joint_.length(), left);
      const auto end = joint_.change(until);
      for (std::size_t i = 0; i < now_.masses.size(); ++i) {
        MassesAlongRun::Mass& mass = now_.masses[i];
        if (mass.wall != 0) continue;
        look_for_misses(
            i,
            [&](double sign, double from) {
              return joint_.fall(joint_.relative_velocity(mass.w, sign), from, until, search_);
            },
            [&](double time) { return mass.y + (mass.w * time - joint_.change(time).dx); });
        mass.y += mass.w * until - end.dx;
        mass.w -= end.dv;
      }
      for (std::size_t k = 0; k < walls.size(); ++k) {
        const auto [q, w] = joint_.overlap(k, until);
        walls[k].q = q, walls[k].w = w;
      }
      x = end.x, v = end.v;
      passed = until < left ? passed + until : motion.duration;
    }
    for (std::size_t k = 0; k < walls.size(); ++k) {
      const std::size_t i = now_.in_contact[k];
      now_.masses[i].y = now_.position_of_wall(i) + walls[k].q;
      now_.masses[i].w = walls[k].w;
    }
  }
  // Updates the nearest miss of the i-th mass in a piece of its flight that begins now. next(sign, from): the
  // first time from `from` on at which sign times y' falls through zero; position(time): y.
  template <class Next, class Position>
  void look_for_misses(std::size_t i, Next&& next, Position&& position) {
    const double clearance = of_.dampers[i].clearance;
    const MassesAlongRun::Mass& mass = now_.masses[i];
    double sign = mass.y == 0 ? 1 : mass.y == clearance ? -1 : mass.w >= 0 ? 1 : -1, from = 0;
    while (const std::optional<double> time = next(sign, from)) {
      const double y = position(*time), gap = sign > 0 ? clearance - y : y;
      note(gap);
      sign = -sign;
      from = *time;
    }
  }

  const VariationalCoefficients& of_;
  const RecordedRun& run_;
  MassesAlongRun now_;
  ForcedOscillator free_;
  MotionBySeries<double, Forcing<double>> series_;
  std::vector<PushedWall<double>> in_series_;  // the masses that slide in a fluid or push compliant walls
  std::vector<std::size_t> number_in_series_;  // 1 + the index there, 0 where a mass is not
  ConstantForces<double> forces_;
  std::vector<FlightStart<double>> starts_;
  JointContact<double, Forcing<double>> joint_;
  Search<double> search_{2};
  std::optional<double> nearest_;
};

}  // namespace

std::optional<double> nearest_miss(const VariationalCoefficients& of, const RecordedRun& run) {
  return NearestMiss(of, run).find();
}

}  // namespace impact_damper
