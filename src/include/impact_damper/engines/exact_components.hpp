// The exact engine for scenes with friction, static friction, weight or drag (docs/mathematics.md, 18.8):
// compliant walls, one or several dampers.
//
// Each secondary mass flies, pushes a wall, or is held by friction where it is, in flight or in its wall.
// Between two events everything is linear with constant forces, and all move by power series, in pieces
// (joint_contact.hpp). Events are the beginnings and ends of contacts, stops (y' falls through zero), and
// ends of holding (M18.22). All are found by Lemma L1 among all masses at once (first_of_many.hpp). A contact
// of the only mass has a closed form besides, which takes its ringing in few steps (shifted_contact.hpp).
//
// After each event settle() decides anew who is held. How a decision and the search that follows it are kept
// from contradicting each other: restitution_components.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/engine_of_dampers.hpp"
#include "impact_damper/events/first_of_many.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/joint_contact.hpp"
#include "impact_damper/motion/shifted_contact.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {

template <class Real, class Force, class Observer>
class ExactWithComponents : EngineOfDampers<Real, Force, Observer> {
  using Base = EngineOfDampers<Real, Force, Observer>;
  using Base::energy_of, Base::losses_, Base::masses_, Base::observer_, Base::system_, Base::tracker_,
      Base::v_, Base::x_;

 public:
  ExactWithComponents(const System<Real, Force>& system, const Scene& scene, const Exact& options,
                      Observer& observer)
      : Base(system, scene, options.budget, options.max_steps, observer),
        lists_dampers_(!has_one_damper(scene)) {
    forces_.weight = Real(scene.weight);
    for (const std::int32_t number : masses_.number) {
      const SceneDamper& damper = scene.dampers[number];
      Mass& mass = each_.emplace_back();
      mass.stiffness = Real(damper.wall_stiffness) / Real(damper.mass_ratio);
      mass.damping = 2 * zeta_m<Real>(damper, options.calibration) * square_root(mass.stiffness);
      mass.drag = Real(damper.drag);
      mass.friction = Real(damper.friction);
      mass.holds = Real(damper.holding());
      if (masses_.size() > 1) continue;
      modes_.emplace(System<Real, Force>(scene, damper),
                     Real((mass.damping + mass.drag) / (2 * square_root(mass.stiffness))));
      if (modes_->coupled) modes_.reset();
    }
  }

  Outcome run() {
    const bool balance = observer_.wants_energy();
    if (balance) Base::note_kinetic(&DamperEnergy::initial_kinetic);
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (masses_.u[i] < 0) enter(i);
    if (balance) tracker_.begin(energy_now());
    settle();
    while (!tracker_.stopped()) {
      bool stopped_by_rounding = false;
      const Event event = is_alone() ? push_alone(stopped_by_rounding) : follow_piece(stopped_by_rounding);
      if (tracker_.stopped()) break;
      if (event.watch && !take(*event.watch, event.time)) break;
      if (event.watch || stopped_by_rounding) settle();
    }
    if (balance) Base::note_kinetic(&DamperEnergy::final_kinetic);
    const Energy last = energy_now();
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (masses_.held[i]) leave(i);
    if (balance) {
      for (std::size_t i = 0; i < masses_.size(); ++i)
        Base::count_in_cavity(i, each_[i].by_friction.now(), each_[i].by_drag);
      Base::finish(last);
      if (!lists_dampers_) observer_.energy_balance().dampers.clear();
    }
    return tracker_.outcome();
  }

 private:
  using Piece = JointContact<Real, Force, true>;
  using Function = typename Piece::Function;
  struct Mass {
    Real stiffness, damping, drag;          // K, c and d of (M18.1)
    Real friction, holds;                   // phi and phi_s
    bool still = false;                     // held by friction
    bool stays = false;                     // held before the present event as well
    Real slides{0};                         // the sign of y' where friction acts, else 0
    std::optional<std::size_t> in_piece{};  // its index in pushed_, if it has to be in the series
    WallContact<Real> contact{};
    Clock<Real> by_friction{};  // lost: a sum of many small terms, as time is
    Real by_drag{0};
    Real rounding_of_u{0}, rounding_of_w{0};  // at the end of the last piece
  };
  // What falls through zero: the gap to the wall that a mass left last or to the other one, the depth in its
  // wall, its speed, or what x'' + gamma + K q is above the lower or below the upper edge of its band.
  enum class Kind { near_wall, far_wall, depth, stop, lower_edge, upper_edge };
  struct Which {
    std::size_t mass;
    Kind kind;
  };
  struct Watched : Watch<Real>, Which {
    Function function;
  };
  // x'' + gamma, and the error that rounding may have left in it.
  struct Acceleration {
    Real value, error;
  };
  struct Event {
    Real time;
    std::optional<Which> watch;  // nothing: the end of the piece or of the run
  };

  // q of (M18.1), and K q where the mass is in contact.
  Real q(std::size_t i) const { return masses_.away[i] * masses_.u[i]; }
  Real wall_spring(std::size_t i) const {
    return masses_.held[i] ? Real(each_[i].stiffness * q(i)) : Real(0);
  }
  Real rate_damping(std::size_t i) const {
    return masses_.held[i] ? Real(each_[i].damping + each_[i].drag) : each_[i].drag;
  }
  bool rests_on_wall(std::size_t i) const { return masses_.u[i] == 0 && masses_.u1[i] == 0; }
  // The constant part of -y'' of a mass that slides and is not in the series.
  Real pull(std::size_t i) const { return each_[i].friction * each_[i].slides + forces_.weight; }

  void begin_piece() {
    pushed_.clear();
    forces_.friction.clear();
    forces_.others = 0;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Mass& mass = each_[i];
      mass.in_piece.reset();
      if (mass.still) continue;
      const Real friction = mass.friction * mass.slides, damping = rate_damping(i);
      if (!masses_.held[i] && damping == 0) {
        forces_.others += masses_.nu[i] * friction;
        continue;
      }
      mass.in_piece = pushed_.size();
      pushed_.push_back(
          {masses_.nu[i], masses_.held[i] ? mass.stiffness : Real(0), damping, q(i), masses_.w(i)});
      forces_.friction.push_back(friction);
    }
    piece_.set_walls(system_.zeta, system_.forcing, pushed_);
    piece_.set_forces(forces_);
    piece_.begin(tracker_.now(), x_, v_, pushed_);
  }

  // Returns the next event, or the end of the piece or of the run.
  Event next_event() {
    const Real remaining = tracker_.remaining();
    const Real until = piece_.length() < remaining ? piece_.length() : remaining;
    const Real resolution = watch_all();
    Search<Real>& search = tracker_.search();
    Search<Real> of_piece{piece_.length(), search.steps_left - 1};
    const auto first = first_of_many<Real>(
        watched_, [](const Real& t) { return t; },
        [&](const Real&, const Real& t, const Watched& each) { return piece_.enclosure(each.function, t); },
        until, of_piece, resolution);
    search.steps_left = of_piece.steps_left;
    if (!first) return {until, {}};
    return {first->time, watched_[first->which]};
  }
  // Sets watched_ to what may end the piece. Returns the shortest time in which one of these changes.
  Real watch_all() {
    watched_.clear();
    const Acceleration acceleration_now = acceleration();
    const Real most_of_x = piece_.second_of_x();
    Real resolution = piece_.resolution();
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Mass& mass = each_[i];
      const Real noise = 4 * error_for(i, acceleration_now);
      if (mass.still) {
        watch_edges(i, noise);
        continue;
      }
      const Real &u = masses_.u[i], &u1 = masses_.u1[i];
      const Real k = pull(i), most = most_of_x + absolute(k);
      // With k, of what moves by x alone: most often all events are excluded at once (M17.8).
      if (!mass.in_piece && u1 != 0 && masses_.stays_off_walls(i, most, piece_.length(), Real(0)) &&
          (mass.holds == 0 || absolute(u1) > most * piece_.length()))
        continue;
      const Real now = mass.in_piece ? absolute(piece_.second_of_q(*mass.in_piece)) : most;
      if (u1 != 0 || u != 0) {
        const Real changes = u1 != 0 ? Real(absolute(u1) / now) : square_root(Real(2 * absolute(u) / now));
        if (changes < resolution) resolution = changes;
      }
      const int order = rests_on_wall(i) ? 2 : 0;
      if (masses_.held[i]) {
        watch({i, Kind::depth}, distance(i, Real(-1)), order, noise);
      } else {
        Function far = distance(i, Real(-1));
        piece_.add(far, 0, masses_.clearance[i]);
        watch({i, Kind::near_wall}, distance(i, Real(1)), order, noise);
        watch({i, Kind::far_wall}, far, 0, noise);
      }
      if (mass.holds > 0) watch({i, Kind::stop}, speed(i), u1 == 0 ? 1 : 0, noise);
    }
    return resolution;
  }
  // Sign times u, the distance from the wall that a mass left last.
  Function distance(std::size_t i, const Real& sign) const {
    const Real &away = masses_.away[i], along = sign * away;
    if (const auto& index = each_[i].in_piece) return piece_.of_mass(*index, along, 0);
    Function gap = piece_.gap(Real(sign * masses_.u[i]), Real(sign * masses_.u1[i]), along);
    piece_.add(gap, 2, Real(-along * pull(i)));
    return gap;
  }
  // The speed of a mass that slides.
  Function speed(std::size_t i) const {
    const Real& sign = each_[i].slides;
    if (const auto& index = each_[i].in_piece) return piece_.of_mass(*index, sign, 1);
    Function speed = piece_.relative_velocity(masses_.w(i), sign);
    piece_.add(speed, 1, Real(-sign * pull(i)));
    return speed;
  }
  void watch_edges(std::size_t i, const Real& noise) {
    for (const Kind edge : {Kind::lower_edge, Kind::upper_edge}) {
      const Real side = edge == Kind::lower_edge ? Real(1) : Real(-1);
      Function function = piece_.of_x(side, 2);
      piece_.add(function, 0, Real(each_[i].holds + side * (forces_.weight + wall_spring(i))));
      Watched each{{{}, 0, noise, Real(noise * piece_.rate())}, {i, edge}, function};
      if (!piece_.stays(function)) watched_.push_back(each);
    }
  }
  // Watches a function. order, if it is not 0: of its zero at the beginning. It grows for 3/2 of b/m, b and m
  // being its (order + 1)-th derivative and a bound on the next one, so that the search begins there if its
  // first is small (M7.4).
  void watch(const Which& which, const Function& function, int order, const Real& noise) {
    Watched each{{}, which, function};
    if (order > 0) {
      const auto n = std::size_t(order);
      const Real next = piece_.begins(function, n + 1);
      if (const Real first = piece_.begins(function, n);
          next > 0 && first >= -noise && first < next * Real(1e-6)) {
        const Real leaves = Real(1.5) * next / piece_.bound(function, n + 2);
        each.begin = leaves < piece_.length() ? leaves : piece_.length();
      }
      each.order = order;
      each.noise = each.slope_noise = noise;
    } else if (piece_.stays(function)) {
      return;
    }
    watched_.push_back(each);
  }

  // u and u' of a mass at the time t of the piece.
  std::array<Real, 2> place_at(std::size_t i, const Real& t, const Displacement<Real>& now) const {
    const Real &u = masses_.u[i], &u1 = masses_.u1[i], &away = masses_.away[i];
    if (each_[i].still) return {u, u1};
    if (const auto& index = each_[i].in_piece) {
      const auto [q, w] = piece_.overlap(*index, t);
      return {away * q, away * w};
    }
    const Real k = pull(i);
    return {u + (u1 * t - away * (now.dx + k * t * t / 2)), u1 - away * (now.dv + k * t)};
  }
  Event follow_piece(bool& stopped_by_rounding) {
    begin_piece();
    const Event event = next_event();
    const auto works = [&](std::size_t i, const Real& t, const Work<Real>&) {
      return each_[i].in_piece ? piece_.integral_of_ww(*each_[i].in_piece, t) : Real(0);
    };
    stopped_by_rounding = pass(
        piece_, event.time, Real(0), [&](const Real& t) { return piece_.change(t); },
        [&](std::size_t i, const Real& t, const Displacement<Real>& now) { return place_at(i, t, now); },
        works);
    return event;
  }
  // Whether the only mass pushes a wall and moves there.
  bool is_alone() const {
    return modes_ && masses_.held[0] && !each_[0].still && masses_.u1[0] != 0 && masses_.u[0] <= 0;
  }
  // Follows the only mass, which pushes a wall, until it leaves it or stops in it.
  Event push_alone(bool& stopped_by_rounding) {
    const Mass& mass = each_[0];
    const Real &nu = masses_.nu[0], &away = masses_.away[0];
    const ShiftedContact<Real, Force> contact(*modes_, tracker_.now(), {x_, v_, q(0), masses_.w(0)},
                                              masses_.wall(0),
                                              {-nu * forces_.weight, -pull(0) / mass.stiffness});
    watched_.clear();
    watched_.push_back({{}, {0, Kind::depth}, {}});
    if (mass.holds > 0) watched_.push_back({{}, {0, Kind::stop}, {}});
    Search<Real>& search = tracker_.search();
    const auto enclose = [&](const Real&, const Real& t, const Watched& each) {
      return each.kind == Kind::depth ? contact.derivative_of_q(0, Real(-away), t, search.span)
                                      : contact.derivative_of_q(1, mass.slides, t, search.span);
    };
    const auto first = first_of_many<Real>(
        watched_, [](const Real& t) { return t; }, enclose, tracker_.remaining(), search,
        contact.resolution());
    const auto state = [&](const Real& t) {
      const State<Real> now = contact.at(t);
      return Displacement<Real>{now.x, now.v, Real(0), Real(now.v - v_)};
    };
    const auto place = [&](std::size_t, const Real& t, const Displacement<Real>&) {
      const State<Real> now = contact.at(t);
      return std::array<Real, 2>{away * now.y, away * now.w};
    };
    const Real until = first ? first->time : tracker_.remaining();
    stopped_by_rounding = pass(contact, until, Real(1), state, place,
                               [](std::size_t, const Real&, const Work<Real>& works) { return works.wall; });
    if (!first) return {until, {}};
    return {until, watched_[first->which]};
  }
  // Advances all masses to `until`, or to an earlier stop. Returns whether rounding has turned a mass back
  // that has just begun to slide: it then counts as at rest. change(t), place(i, t, change): x, and u and u'
  // of the i-th mass, at t; sum_ww(i, t, works): the integral of its w^2, works having been computed for
  // wall_damping.
  template <class Motion, class Change, class Place, class SumOfWw>
  bool pass(const Motion& motion, const Real& until, const Real& wall_damping, Change&& change, Place&& place,
            SumOfWw&& sum_ww) {
    const Displacement<Real> last = change(until);
    State<Real> end{last.x, last.v, Real(0), Real(0)};
    const Work<Real> works = tracker_.pass(motion, until, end, wall_damping, [&](const Real& t) {
      const Displacement<Real> now = change(t);
      Base::report_sample(t, now, [&](auto&& set) {
        for (std::size_t i = 0; i < masses_.size(); ++i) {
          const auto [u, u1] = place(i, t, now);
          set(i, u, u1);
        }
      });
    });
    const Real t = tracker_.passed();
    if (t == 0) return false;
    const Displacement<Real> now = t == until ? last : change(t);
    bool stopped = false;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Mass& mass = each_[i];
      if (mass.still) continue;
      const auto [u, u1] = place(i, t, now);
      if (observer_.wants_energy()) add_losses(i, sum_ww(i, t, works), Real(absolute(u - masses_.u[i])));
      const Real epsilon = std::numeric_limits<Real>::epsilon(), speed = absolute(masses_.u1[i]),
                 pulled = absolute(pull(i)) * t;
      mass.rounding_of_u =
          16 * epsilon * (absolute(masses_.u[i]) + speed * t + absolute(now.dx) + pulled * t / 2);
      mass.rounding_of_w = 16 * epsilon * (speed + absolute(now.dv) + pulled);
      masses_.u[i] = u;
      masses_.u1[i] = u1;
      if (mass.slides == 0 || mass.slides * masses_.w(i) > 0) continue;
      stop(i);
      stopped = true;
    }
    x_ = now.x;
    v_ = now.v;
    return stopped;
  }
  // way: that the mass has gone in its cavity, in one direction if it has friction.
  void add_losses(std::size_t i, const Real& sum_ww, const Real& way) {
    Mass& mass = each_[i];
    const Real& nu = masses_.nu[i];
    if (mass.slides != 0) mass.by_friction.advance(Real(nu * mass.friction * way));
    mass.by_drag += nu * mass.drag * sum_ww;
    if (masses_.held[i]) mass.contact.work += nu * mass.damping * sum_ww;
  }

  // Carries out an event after a time t of the piece, and others of its kind that rounding cannot tell apart
  // from it. Returns false if they are impacts more than the impact budget allows.
  bool take(const Which& event, const Real& t) {
    const std::size_t i = event.mass;
    const bool to_wall = event.kind == Kind::near_wall || event.kind == Kind::far_wall;
    if (to_wall && each_[i].slides != 0 && masses_.u1[i] == 0) return true;  // stopped on it, by rounding
    if (event.kind == Kind::depth) {
      leave(i);
      for (std::size_t j = 0; j < masses_.size(); ++j)
        if (masses_.held[j] && masses_.u1[j] > 0 && -masses_.u[j] <= each_[j].rounding_of_u) leave(j);
    } else if (event.kind == Kind::stop) {
      stop(i);
      for (std::size_t j = 0; j < masses_.size(); ++j)
        if (each_[j].slides != 0 && absolute(masses_.u1[j]) <= each_[j].rounding_of_w) stop(j);
    } else if (to_wall) {
      const Real most = piece_.second_of_x();
      Base::find_meeting(
          meeting_, i, event.kind == Kind::near_wall, t,
          [&](std::size_t j) {
            const auto& index = each_[j].in_piece;
            return index ? absolute(piece_.second_of_q(*index)) : Real(most + absolute(pull(j)));
          },
          [&](std::size_t j) { return masses_.held[j] || each_[j].still; });
      if (!tracker_.has_room_for(std::int64_t(meeting_.size()))) return false;
      std::ranges::sort(meeting_, {}, [&](const auto& each) { return masses_.number[each.index]; });
      for (const Meeting<Real>& each : meeting_) meet(each.index, each.wall);
    }
    return true;
  }
  void meet(std::size_t i, Wall wall) {
    Base::report_impact(i, wall);
    masses_.arrive(i, wall);
    enter(i);
    Base::begin_with_impact(each_[i].contact);
  }
  // Sets y' of a mass to zero. If rounding has left it beyond a wall it is on that wall.
  void stop(std::size_t i) {
    masses_.u1[i] = 0;
    if (masses_.held[i]) return;
    if (!(masses_.u[i] > 0)) masses_.u[i] = 0;
    if (!(masses_.clearance[i] - masses_.u[i] > 0)) masses_.arrive(i, opposite(masses_.wall(i)));
  }
  void enter(std::size_t i) { Base::hold(i, tracker_.now()); }
  void leave(std::size_t i) {
    Base::end_contact(i, each_[i].contact);
    if (masses_.u1[i] < 0) masses_.u1[i] = 0;  // by rounding
  }

  // Decides who is held: of the masses at rest those that can be. Always the first one that contradicts its
  // state changes it, which ends; with static friction equal to friction there is one answer only (18.8).
  // Then a mass at rest on its wall enters it or leaves it.
  void settle() {
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Mass& mass = each_[i];
      const Real w = masses_.w(i);
      mass.stays = mass.still;
      mass.still = w == 0 && mass.holds > 0;
      mass.slides = mass.holds > 0 ? Real(w > 0) - Real(w < 0) : Real(0);
    }
    // With static friction above friction there may be more than one answer: who is held already stays held
    // where that can be, so those that have just stopped are decided upon first.
    for (const bool all : {false, true}) {
      sum_up_held();
      for (std::size_t changes = 0; change_one(all, changes > 8 * masses_.size()); ++changes) sum_up_held();
    }
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (!rests_on_wall(i)) continue;
      const Mass& mass = each_[i];
      const Real direction = mass.still ? Real(0) : mass.slides != 0 ? mass.slides : goes(i, acceleration());
      const bool enters = direction * masses_.away[i] < 0;
      // Later than at the release that is an impact, but by rounding for one that friction did not hold.
      if (enters && !masses_.held[i]) {
        if (tracker_.now() == 0 || (masses_.size() == 1 && mass.holds == 0))
          enter(i);
        else if (tracker_.has_room_for(1))
          meet(i, masses_.wall(i));
      }
      if (!enters && masses_.held[i]) leave(i);
    }
    if constexpr (requires { observer_.settled(std::int32_t{}, PlaceInCavity{}, false, 0.0); })
      for (std::size_t i = 0; i < masses_.size(); ++i)
        observer_.settled(masses_.number[i], masses_.place(i, masses_.u[i], masses_.u1[i]), each_[i].still,
                          double(each_[i].slides));
  }
  void sum_up_held() {
    forces_.held = 0;
    for (std::size_t i = 0; i < masses_.size(); ++i)
      if (each_[i].still) forces_.held += masses_.nu[i];
  }
  // Lets go the first mass that cannot be held, or holds one again that would be pushed against the direction
  // in which it was let go. Returns false if there is none. all: not only those that have just stopped.
  // only_holds: static friction larger than friction leaves more than one answer, so that without an end to
  // it one might be let go and held for ever.
  bool change_one(bool all, bool only_holds) {
    const Acceleration now = acceleration();
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      Mass& mass = each_[i];
      if (masses_.u1[i] != 0 || !(mass.holds > 0) || (mass.stays && !all)) continue;
      if (mass.still) {
        const Real direction = only_holds ? Real(0) : goes(i, now);
        if (direction == 0) continue;
        mass.still = false;
        mass.slides = direction;
        return true;
      }
      const Real pushed = -mass.slides * (now.value + wall_spring(i)) - mass.friction;
      if (pushed >= -error_for(i, now)) continue;
      mass.still = true;
      mass.slides = 0;
      return true;
    }
    return false;
  }
  Real error_for(std::size_t i, const Acceleration& now) const {
    return now.error +
           at_edge * std::numeric_limits<Real>::epsilon() * (each_[i].holds + absolute(wall_spring(i)));
  }
  // The direction in which a mass at rest is let go; 0 if it stays.
  Real goes(std::size_t i, const Acceleration& now) const {
    const Real needs = -(now.value + wall_spring(i)), &holds = each_[i].holds, error = error_for(i, now);
    for (const Real& direction : {Real(1), Real(-1)}) {
      const Real excess = direction * needs - holds;
      if (excess > error || (excess >= -error && direction * later() < 0)) return direction;
    }
    return 0;
  }
  Acceleration acceleration() const {
    const Force& forcing = system_.forcing;
    const Real f = forcing.template derivatives<2>(forcing.phase(tracker_.now()))[0], a2 = 2 * system_.zeta;
    Real sum = f - a2 * v_ - x_ + forces_.weight,
         size = absolute(forcing.amplitude) + a2 * absolute(v_) + absolute(x_) + forces_.weight;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Mass& mass = each_[i];
      if (mass.still) continue;
      const Real friction = mass.friction * mass.slides, spring = wall_spring(i),
                 damper = rate_damping(i) * masses_.w(i);
      sum += masses_.nu[i] * (friction + spring + damper);
      size += masses_.nu[i] * (absolute(friction) + absolute(spring) + absolute(damper));
    }
    const Real all = 1 + forces_.held;
    return {sum / all, at_edge * std::numeric_limits<Real>::epsilon() * size / all};
  }
  // The sign of the first derivative of x from x''' on that is not zero to rounding (M7.12), 0 if there is
  // none among the next four.
  Real later() const {
    const Force& forcing = system_.forcing;
    auto [f, f1] = forcing.template derivatives<2>(forcing.phase(tracker_.now()));
    const Real a2 = 2 * system_.zeta, tiny = at_edge * std::numeric_limits<Real>::epsilon();
    const Acceleration now = acceleration();
    Real amplitude = absolute(forcing.amplitude), before = v_, last = now.value - forces_.weight;
    if (absolute(last) <= now.error + tiny * forces_.weight) last = 0;
    struct Moving {
      Real nu, spring, damping, q1, q2;  // q1, q2: two consecutive derivatives of q
    };
    std::vector<Moving> moving;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Mass& mass = each_[i];
      if (mass.still || (!masses_.held[i] && mass.drag == 0)) continue;
      const Real damping = rate_damping(i), spring = masses_.held[i] ? mass.stiffness : Real(0),
                 w = masses_.w(i);
      moving.push_back({masses_.nu[i], spring, damping, w, -(last + pull(i) + damping * w + wall_spring(i))});
    }
    for (int n = 3; n < 7; ++n) {
      amplitude *= forcing.frequency;
      Real sum = f1 - a2 * last - before, size = amplitude + a2 * absolute(last) + absolute(before);
      for (const Moving& each : moving) {
        sum += each.nu * (each.damping * each.q2 + each.spring * each.q1);
        size += each.nu * (absolute(each.damping * each.q2) + absolute(each.spring * each.q1));
      }
      if (absolute(sum) > tiny * size) return sum > 0 ? Real(1) : Real(-1);
      for (Moving& each : moving) {
        const Real next = -(each.damping * each.q2 + each.spring * each.q1);
        each.q1 = each.q2;
        each.q2 = next;
      }
      before = last;
      last = 0;
      const Real f2 = -forcing.frequency * forcing.frequency * f;
      f = f1;
      f1 = f2;
    }
    return 0;
  }

  Energy energy_now() const {
    Energy energy = Base::energy_now([&](std::size_t i) {
      const Real& u = masses_.u[i];
      return masses_.held[i] ? Real(masses_.nu[i] * each_[i].stiffness * (u * u)) : Real(0);
    });
    energy.weight = Base::energy_of_weight(forces_.weight);
    return energy;
  }

  // In roundings of the terms of x''.
  static constexpr double at_edge = 8;

  bool lists_dampers_;
  std::optional<ContactModes<Real, Force>> modes_;  // of the only mass in contact, if they are apart
  std::vector<Mass> each_;
  ConstantForces<Real> forces_;
  std::vector<PushedWall<Real>> pushed_;
  Piece piece_;
  std::vector<Watched> watched_;
  std::vector<Meeting<Real>> meeting_;
};

// Runs a scene that has friction, weight or drag, with one damper or a list.
template <Scalar Real, DampersObserver Observer>
Outcome run_exact_with_components(const Checked& run, Observer& observer) {
  return with_system<Real>(run.scene(), [&](const auto& system) {
    return run_exact_with_components(system, run.scene(), run.options<Exact>(), observer);
  });
}

template <class Real, class Force, class Observer>
Outcome run_exact_with_components(const System<Real, Force>& system, const Scene& scene, const Exact& options,
                                  Observer& observer) {
  require_arithmetic();
  return ExactWithComponents<Real, Force, Observer>(system, scene, options, observer).run();
}

}  // namespace impact_damper
