#include "impact_damper/orbits/variation_of_dampers.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <variant>

#include "impact_damper/math/dense.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/impact_law.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {
namespace {

// An interval in which a wall holds a mass: the mass sticks to it (rigid) or is in contact with it
// (compliant).
struct Held {
  std::size_t damper;
  double begin, end;
  int away;  // from the wall into the cavity: 1 at a left, -1 at a right wall
};
std::vector<Held> held_in(const Run& run) {
  std::vector<Held> all;
  const Contacts& contacts = *run.contacts;
  for (std::size_t i = 0; i < contacts.begin.size(); ++i)
    all.push_back({std::size_t(contacts.damper[i]), contacts.begin[i], contacts.end[i],
                   contacts.wall[i] == Wall::left ? 1 : -1});
  return all;
}
// For each damper Held::away if a wall holds it during all of an interval, else 0.
using HeldBy = std::vector<int>;
HeldBy held_between(const std::vector<Held>& held, double from, double to, std::size_t dampers) {
  HeldBy all(dampers, 0);
  for (const Held& each : held)
    if (each.begin <= from && to <= each.end) all[each.damper] = each.away;
  return all;
}
std::size_t number_of_held(const HeldBy& held) {
  return held.size() - std::size_t(std::ranges::count(held, 0));
}

// The times at which the motion changes, ascending: 0, each of `events`, and the end.
std::vector<double> times_of(std::vector<double> events, double end) {
  events.push_back(0);
  events.push_back(end);
  std::ranges::sort(events);
  events.erase(std::unique(events.begin(), events.end()), events.end());
  return events;
}

// The changes that are carried along a run: by address, as after_step() may replace them.
using Changes = std::vector<ChangeOfState*>;
Changes changes_of(std::vector<ChangeOfState>& changes, AlongRun* along) {
  Changes all;
  for (ChangeOfState& each : changes) all.push_back(&each);
  if (along) {
    all.push_back(&along->by_frequency);
    all.push_back(&along->by_amplitude);
  }
  return all;
}

// The coefficients of the variational equations.
struct Damper {
  double nu, e, clearance;
  double stiffness = 0, damping = 0;  // compliant walls: K and gamma of (M17.9)
};
struct Numbers {
  Numbers(const Scene& scene, const Engine& engine)
      : zeta(scene.damping_ratio), force{scene.force_amplitude, scene.force_frequency} {
    for (const SceneDamper& each : scene.dampers) {
      Damper damper{each.mass_ratio, each.restitution, each.clearance};
      if (const auto* const exact = std::get_if<Exact>(&engine)) {
        damper.stiffness = each.wall_stiffness / each.mass_ratio;
        damper.damping = 2 * zeta_m<double>(each, exact->calibration) * std::sqrt(damper.stiffness);
      }
      dampers.push_back(damper);
    }
  }
  std::size_t dimensions() const { return 2 + 2 * dampers.size(); }

  double zeta;
  Forcing<double> force;
  std::vector<Damper> dampers;
};

// The variational equations with rigid walls. The record has velocities of masses at their impacts only, so
// x, x' and with them y, y' of all masses are followed along.
class RigidWalls {
 public:
  RigidWalls(const Numbers& of, const Run& run, AlongRun* along)
      : of_(of),
        impacts_(*run.impacts),
        held_(held_in(run)),
        along_(along),
        is_held_(of.dampers.size(), 0),
        x_(run.scene.x0),
        v_(run.scene.v0) {
    for (const SceneDamper& each : run.scene.dampers) {
      y_.push_back(each.y0);
      w_.push_back(each.w0);
    }
    std::vector<double> events = impacts_.time;
    for (Held& each : held_) {
      events.push_back(each.end);
      // The limit of chattering is taken at the impact before: from then on the mass is held.
      const auto after = std::ranges::upper_bound(impacts_.time, each.begin);
      each.begin = after == impacts_.time.begin() ? 0 : *(after - 1);
    }
    times_ = times_of(std::move(events), run.end_time);
  }

  Carried carry(const Changes& changes, const std::function<void()>& after_step) {
    std::size_t most_held = 0;
    for (std::size_t n = 0; n + 1 < times_.size(); ++n) {
      happens(times_[n], held_between(held_, times_[n], times_[n + 1], is_held_.size()), changes);
      after_step();
      move(times_[n], times_[n + 1] - times_[n], changes);
      after_step();
      most_held = std::max(most_held, number_of_held(is_held_));
    }
    if (along_) along_->rates_at_end = rates(times_.back());
    return {2 * most_held, one_sided_};
  }

 private:
  double mass_with(const HeldBy& held) const {
    double all = 1;
    for (std::size_t i = 0; i < held.size(); ++i)
      if (held[i] != 0) all += of_.dampers[i].nu;
    return all;
  }
  // The rates of the state: x', x'', then y' and y'' of each damper.
  ChangeOfState rates(double time) const {
    const double f = of_.force.amplitude * of_.force.phase(time).sin;
    const double a = (f - 2 * of_.zeta * v_ - x_) / mass_with(is_held_);
    ChangeOfState all(of_.dimensions());
    all[0] = v_, all[1] = a;
    for (std::size_t i = 0; i < w_.size(); ++i) {
      all[index_of_y(i)] = w_[i];
      all[index_of_w(i)] = is_held_[i] != 0 ? 0 : -a;
    }
    return all;
  }

  // Carries changes by (M13.22), and the state, through a motion between two events.
  void move(double begin, double duration, const Changes& changes) {
    const double mass = mass_with(is_held_);
    const Forcing<double> force{of_.force.amplitude / mass, of_.force.frequency};
    if (along_) look_for_turns(mass, force, begin, duration);
    const Oscillator<double> oscillator(of_.zeta / mass, 1 / mass);
    const Propagator<double> p = oscillator.propagate(duration);
    const double spring = oscillator.b() * p.s, slowed = p.c1 - 2 * oscillator.a() * p.s;  // S' - 1
    for (ChangeOfState* const each : changes) {
      ChangeOfState& s = *each;
      const double x = s[0], v = s[1], departs = x * p.c1 + v * p.s1, gains = v * slowed - x * spring;
      s[0] = x * p.c + v * p.s;
      s[1] = v * p.v - x * spring;
      for (std::size_t i = 0; i < is_held_.size(); ++i) {
        if (is_held_[i] != 0) continue;
        s[index_of_y(i)] += duration * s[index_of_w(i)] - departs;
        s[index_of_w(i)] -= gains;
      }
    }
    if (along_) add_driven(oscillator, mass, begin, duration);
    const DrivenResponse<double> driven = oscillator.respond(force, force.phase(begin), duration, p);
    const double x = x_ * p.c + v_ * p.s + driven.d, v = v_ * p.v - x_ * spring + driven.d1;
    for (std::size_t i = 0; i < w_.size(); ++i) {
      if (is_held_[i] != 0) continue;
      y_[i] += w_[i] * duration - (x_ * p.c1 + v_ * p.s1 + driven.d);
      w_[i] -= v - v_;
    }
    x_ = x;
    v_ = v;
  }
  // Adds the derivatives by omega_f and f0 (M13.3), by Gauss's 16 points in panels of the time tau that is
  // left until the end.
  void add_driven(const Oscillator<double>& oscillator, double mass, double begin, double duration) {
    struct Sum {
      double x = 0, v = 0;
    } by_frequency, by_amplitude;
    for (double from = 0; from < duration;) {
      const double panel = panel_under(of_.force, oscillator.panel(from)),
                   to = std::min(duration, from + std::max(panel, duration / 65536));
      const double half = (to - from) / 2, middle = from + half;
      for (const auto& [abscissa, weight] : gauss_16) {
        for (const double side : {-abscissa, abscissa}) {
          const double tau = middle + half * side, time = begin + (duration - tau);
          const auto [sin, cos] = of_.force.phase(time);
          const Propagator<double> p = oscillator.propagate(tau);
          const double impulse = half * weight / mass, secular = of_.force.amplitude * time * cos;
          by_frequency.x += impulse * p.s * secular;
          by_frequency.v += impulse * p.v * secular;
          by_amplitude.x += impulse * p.s * sin;
          by_amplitude.v += impulse * p.v * sin;
        }
      }
      from = to;
    }
    const auto add = [&](const Sum& sum, ChangeOfState& s) {
      s[0] += sum.x;
      s[1] += sum.v;
      for (std::size_t i = 0; i < is_held_.size(); ++i) {
        if (is_held_[i] != 0) continue;
        s[index_of_y(i)] -= sum.x;
        s[index_of_w(i)] -= sum.v;
      }
    };
    add(by_frequency, along_->by_frequency);
    add(by_amplitude, along_->by_amplitude);
  }
  // Updates along_->nearest_miss where a mass in flight turns back.
  void look_for_turns(double mass, const Forcing<double>& force, double begin, double duration) const {
    const Driven<double, Forcing<double>> oscillator(of_.zeta / mass, 1 / mass, of_.force);
    const ForcedMotion<double> primary(oscillator, force, begin, x_, v_);
    Search<double> search{2};
    for (std::size_t i = 0; i < w_.size(); ++i) {
      if (is_held_[i] != 0) continue;
      const double clearance = of_.dampers[i].clearance;
      const bool left = y_[i] <= clearance / 2;
      const Flight<double, Forcing<double>, OwnClearance<double>, const ForcedMotion<double>&> flight(
          primary, {clearance},
          {{x_, v_, y_[i], w_[i]},
           left ? 0 : clearance,
           left ? 1.0 : -1.0,
           left ? y_[i] : clearance - y_[i]});
      double sign = y_[i] == 0 ? 1 : y_[i] == clearance ? -1 : w_[i] >= 0 ? 1 : -1, from = 0;
      while (const auto turn = flight.turn_of_y(sign, from, duration, search)) {
        const double y = flight.at(*turn).y, gap = sign > 0 ? clearance - y : y;
        if (!(along_->nearest_miss && *along_->nearest_miss <= gap)) along_->nearest_miss = gap;
        sign = -sign;
        from = *turn;
      }
    }
  }

  // Applies the event at `time`, its impacts and the sticking of the masses in held_then from then on: to the
  // changes its saltation matrix (M13.4), to the state its jump. The end of sticking changes nothing, as the
  // mass has no relative speed.
  void happens(double time, HeldBy held_then, const Changes& changes) {
    Event event = impacts_at(time);
    event.mass_then = mass_with(held_then);
    // A mass that its wall leaves behind and that is held again at the same event counts as newly stuck.
    for (std::size_t i = 0; i < w_.size(); ++i) {
      const bool stays = is_held_[i] != 0 && (event.meeting.empty() || event.is_active[i]);
      event.role[i] = held_then[i] == 0 ? Role::flies : stays ? Role::stays_held : Role::joins;
    }
    const bool joins = std::ranges::find(event.role, Role::joins) != event.role.end();
    if (event.meeting.empty() && !joins) {
      is_held_ = std::move(held_then);
      return;
    }
    one_sided_ = one_sided_ || event.meeting.size() > 1;
    ChangeOfState kick = rates(time);  // F^-, which becomes F^+ - D F^-
    const std::vector<double> w_before = w_;
    // The velocities jump by the same linear map as changes of them.
    ChangeOfState velocities(of_.dimensions(), 0.0);
    velocities[1] = v_;
    for (std::size_t i = 0; i < w_.size(); ++i) velocities[index_of_w(i)] = w_[i];
    jump(event, velocities);
    v_ = velocities[1];
    for (std::size_t i = 0; i < w_.size(); ++i) w_[i] = velocities[index_of_w(i)];
    is_held_ = std::move(held_then);

    jump(event, kick);
    const ChangeOfState after = rates(time);
    for (std::size_t k = 0; k < kick.size(); ++k) kick[k] = after[k] - kick[k];
    for (ChangeOfState* const each : changes) {
      ChangeOfState& s = *each;
      double earlier = 0;
      for (const std::size_t i : event.meeting)
        earlier += s[index_of_y(i)] / w_before[i] / double(event.meeting.size());
      jump(event, s);
      for (std::size_t k = 0; k < kick.size(); ++k) s[k] += kick[k] * earlier;
    }
  }

  enum class Role { flies, joins, stays_held };  // after the event
  struct Event {
    std::vector<std::size_t> meeting;  // dampers at impact
    std::vector<bool> is_active;       // gets an impulse from its wall (M17.3)
    double weight = 1;                 // 1 plus the mass ratios of these
    std::vector<Role> role;
    double mass_then = 1;
  };
  // The impacts at a time, and which of the masses that meet walls then or are held by one get an impulse.
  // Sets y_ and w_ of those that meet walls from the record.
  Event impacts_at(double time) {
    Event event{{}, std::vector<bool>(w_.size(), false), 1, std::vector<Role>(w_.size(), Role::flies), 1};
    std::vector<MassAtWall<double>> at_walls;
    const auto [first, last] = std::equal_range(impacts_.time.begin(), impacts_.time.end(), time);
    for (auto each = first; each != last; ++each) {
      const auto row = std::size_t(each - impacts_.time.begin());
      const auto i = std::size_t(impacts_.damper[row]);
      y_[i] = impacts_.wall[row] == Wall::left ? 0 : of_.dampers[i].clearance;
      w_[i] = impacts_.relative_velocity[row];
      event.meeting.push_back(i);
      at_walls.push_back({i, of_.dampers[i].nu, of_.dampers[i].e, w_[i] < 0 ? 1.0 : -1.0, -std::fabs(w_[i])});
    }
    if (event.meeting.empty()) return event;
    for (std::size_t i = 0; i < w_.size(); ++i)
      if (is_held_[i] != 0)
        at_walls.push_back({i, of_.dampers[i].nu, of_.dampers[i].e, double(is_held_[i]), 0.0});
    const double jump = jump_of_velocity<double>(std::span(at_walls));
    for (const MassAtWall<double>& each : at_walls) {
      if (!(each.escape() + each.away * jump > 0)) continue;
      event.is_active[each.index] = true;
      event.weight += each.nu;
    }
    return event;
  }
  // Applies D, (M13.23) and then (M13.24), to a change, to velocities or to rates.
  void jump(const Event& event, ChangeOfState& s) const {
    double gained = 0;
    for (std::size_t i = 0; i < w_.size(); ++i)
      if (event.is_active[i])
        gained += of_.dampers[i].nu * (1 + of_.dampers[i].e) * s[index_of_w(i)] / event.weight;
    s[1] += gained;
    double moves = 0, speeds = 0;
    for (std::size_t i = 0; i < w_.size(); ++i) {
      double &y = s[index_of_y(i)], &w = s[index_of_w(i)];
      w = event.is_active[i] ? -of_.dampers[i].e * w : w - gained;
      if (event.role[i] == Role::joins) {
        moves += of_.dampers[i].nu / event.mass_then * y;
        speeds += of_.dampers[i].nu / event.mass_then * w;
      }
      if (event.role[i] != Role::flies) y = w = 0;
    }
    s[0] += moves;
    s[1] += speeds;
    for (std::size_t i = 0; i < w_.size(); ++i) {
      if (event.role[i] != Role::flies) continue;
      s[index_of_y(i)] -= moves;
      s[index_of_w(i)] -= speeds;
    }
  }

  const Numbers& of_;
  const Impacts& impacts_;
  std::vector<Held> held_;
  AlongRun* along_;
  std::vector<double> times_;
  HeldBy is_held_;
  double x_, v_;
  std::vector<double> y_, w_;
  bool one_sided_ = false;
};

// The variational equations with compliant walls. Neither the propagators nor the saltation matrices of touch
// and end of a contact depend on the state.
class CompliantWalls {
 public:
  CompliantWalls(const Numbers& of, const Run& run, AlongRun* along)
      : of_(of), run_(run), along_(along), held_(held_in(run)) {
    std::vector<double> events;
    for (const Held& each : held_) {
      events.push_back(each.begin);
      events.push_back(each.end);
    }
    times_ = times_of(std::move(events), run.end_time);
  }

  Carried carry(const Changes& changes, const std::function<void()>& after_step) const {
    std::size_t most_lost = 0;
    HeldBy held;
    for (std::size_t n = 0; n + 1 < times_.size(); ++n) {
      for (const Held& each : held_) {
        if (each.end == times_[n]) edge(each.damper, -1, changes);
        if (each.begin == times_[n] && begins_by_impact(each)) edge(each.damper, 1, changes);
      }
      after_step();
      held = held_between(held_, times_[n], times_[n + 1], of_.dampers.size());
      const double duration = times_[n + 1] - times_[n];
      double rate_of_loss = 2 * of_.zeta;
      for (std::size_t i = 0; i < held.size(); ++i)
        if (held[i] != 0) rate_of_loss += (1 + of_.dampers[i].nu) * of_.dampers[i].damping;
      if (is_lost(rate_of_loss * duration)) most_lost = std::max(most_lost, number_of_held(held));
      const int pieces = pieces_of(rate_of_loss * duration);
      const Step step(of_, held, duration / pieces, along_ != nullptr);
      for (int i = 0; i < pieces; ++i) {
        const double time = times_[n] + duration * i / pieces;
        for (ChangeOfState* const each : changes) {
          const bool by_frequency = along_ && each == &along_->by_frequency,
                     by_amplitude = along_ && each == &along_->by_amplitude;
          step.carry(*each, by_frequency   ? Step::secular(of_.force, time)
                            : by_amplitude ? Step::harmonic(of_.force, time)
                                           : std::array<double, 4>{});
        }
        after_step();
      }
    }
    if (along_) along_->rates_at_end = rates_at_end(held);
    return {2 * most_lost, false};
  }

 private:
  // Whether an impact begins the contact; one from the run's beginning may go on from before.
  bool begins_by_impact(const Held& held) const {
    const Impacts& impacts = *run_.impacts;
    const auto [first, last] = std::equal_range(impacts.time.begin(), impacts.time.end(), held.begin);
    for (auto each = first; each != last; ++each)
      if (std::size_t(impacts.damper[std::size_t(each - impacts.time.begin())]) == held.damper) return true;
    return false;
  }
  // Applies the saltation matrix of touch (sign 1) or end (-1) of a contact (M13.25).
  void edge(std::size_t damper, int sign, const Changes& changes) const {
    const Damper& of = of_.dampers[damper];
    for (ChangeOfState* const each : changes) {
      ChangeOfState& s = *each;
      const double force = sign * of.damping * s[index_of_y(damper)];
      s[1] += of.nu * force;
      for (std::size_t i = 0; i < of_.dampers.size(); ++i) s[index_of_w(i)] -= of.nu * force;
      s[index_of_w(damper)] -= force;
    }
  }
  ChangeOfState rates_at_end(const HeldBy& held) const {
    const History& history = *run_.history;
    const double x = history.x.back(), v = history.v.back();
    double a = of_.force.amplitude * of_.force.phase(run_.end_time).sin - 2 * of_.zeta * v - x;
    ChangeOfState all(of_.dimensions());
    for (std::size_t i = 0; i < held.size(); ++i) {
      const double y = history.dampers[i].y.back(), w = history.dampers[i].w.back();
      all[index_of_y(i)] = w;
      if (held[i] == 0) continue;
      const Damper& of = of_.dampers[i];
      const double push = of.damping * w + of.stiffness * (held[i] > 0 ? y : y - of.clearance);
      a += of.nu * push;
      all[index_of_w(i)] = -push;
    }
    all[0] = v, all[1] = a;
    for (std::size_t i = 0; i < held.size(); ++i) all[index_of_w(i)] -= a;
    return all;
  }

  // The propagator of changes over a time in which the same masses are in contact.
  class Step {
   public:
    // with_force: for changes of the force, too.
    Step(const Numbers& of, const HeldBy& held, double duration, bool with_force) : duration_(duration) {
      for (std::size_t i = 0; i < held.size(); ++i) (held[i] == 0 ? free_ : pushed_).push_back(i);
      const std::size_t n = 2 + 2 * pushed_.size() + (with_force ? 4 : 0);
      double rate = with_force ? of.force.frequency : 0, all_k = 0, most_k = 0;
      for (const std::size_t i : pushed_) {
        const Damper& each = of.dampers[i];
        all_k += each.nu * each.stiffness;
        most_k = std::max(most_k, each.stiffness);
        rate += (1 + each.nu) * each.damping;
      }
      rate += 2 * of.zeta + std::sqrt(1 + all_k + most_k);
      matrix_ = matrix_exponential(n, duration, rate,
                                   [&](const Vector& s, Vector& rates) { derive(of, s, rates); });
    }

    // (g, h, a, b) of (M13.27) at a time: g is the change of the force by f0 (harmonic) or by omega_f
    // (secular), and the other three make its equations linear.
    static std::array<double, 4> harmonic(const Forcing<double>& force, double time) {
      const auto [sin, cos] = force.phase(time);
      return {sin, cos, 0, 0};
    }
    static std::array<double, 4> secular(const Forcing<double>& force, double time) {
      const auto [sin, cos] = force.phase(time);
      return {force.amplitude * time * cos, -force.amplitude * time * sin, force.amplitude * cos,
              -force.amplitude * sin};
    }

    // Carries a change s through the step. `force`: (g, h, a, b) at its beginning, the last four components.
    void carry(ChangeOfState& s, const std::array<double, 4>& force) const {
      Vector from(matrix_.size());
      from[0] = s[0], from[1] = s[1];
      const std::size_t n = 2 + 2 * pushed_.size();
      for (std::size_t k = 0; k < pushed_.size(); ++k) {
        from[2 + 2 * k] = s[index_of_y(pushed_[k])];
        from[3 + 2 * k] = s[index_of_w(pushed_[k])];
      }
      if (from.size() > n) std::copy(force.begin(), force.end(), from.begin() + std::ptrdiff_t(n));
      const Vector to = product(matrix_, from);
      s[0] = to[0], s[1] = to[1];
      for (std::size_t k = 0; k < pushed_.size(); ++k) {
        s[index_of_y(pushed_[k])] = to[2 + 2 * k];
        s[index_of_w(pushed_[k])] = to[3 + 2 * k];
      }
      for (const std::size_t i : free_) {
        s[index_of_y(i)] += duration_ * s[index_of_w(i)] - (s[0] - from[0] - duration_ * from[1]);
        s[index_of_w(i)] -= s[1] - from[1];
      }
    }

   private:
    // The right-hand sides of the variational equations (M13.27).
    void derive(const Numbers& of, const Vector& s, Vector& rates) const {
      const std::size_t n = 2 + 2 * pushed_.size();
      double a = -2 * of.zeta * s[1] - s[0];
      if (s.size() > n) a += s[n];
      for (std::size_t k = 0; k < pushed_.size(); ++k) {
        const Damper& each = of.dampers[pushed_[k]];
        const double push = each.damping * s[3 + 2 * k] + each.stiffness * s[2 + 2 * k];
        a += each.nu * push;
        rates[2 + 2 * k] = s[3 + 2 * k];
        rates[3 + 2 * k] = -push;
      }
      rates[0] = s[1], rates[1] = a;
      for (std::size_t k = 0; k < pushed_.size(); ++k) rates[3 + 2 * k] -= a;
      if (s.size() == n) return;
      const double omega = of.force.frequency, *g = s.data() + n;
      rates[n] = omega * g[1] + g[2];
      rates[n + 1] = -omega * g[0] + g[3];
      rates[n + 2] = omega * g[3];
      rates[n + 3] = -omega * g[2];
    }

    double duration_;
    std::vector<std::size_t> pushed_, free_;
    // Rows and columns of x, x', q and q' of each mass in contact, and (g, h, a, b) of (M13.27).
    Matrix matrix_;
  };

  const Numbers& of_;
  const Run& run_;
  AlongRun* along_;
  std::vector<Held> held_;
  std::vector<double> times_;
};

}  // namespace

Carried carry_changes(const Run& run, std::vector<ChangeOfState>& changes,
                      const std::function<void()>& after_step, AlongRun* along) {
  const Numbers numbers(run.scene, run.engine);
  if (along) {
    *along = {};
    along->by_frequency.assign(numbers.dimensions(), 0.0);
    along->by_amplitude.assign(numbers.dimensions(), 0.0);
  }
  const Changes all = changes_of(changes, along);
  return has_rigid_walls(run.engine) ? RigidWalls(numbers, run, along).carry(all, after_step)
                                     : CompliantWalls(numbers, run, along).carry(all, after_step);
}

}  // namespace impact_damper
