#include "impact_damper/orbits/variational_equations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "impact_damper/math/dense.hpp"
#include "impact_damper/motion/contact.hpp"
#include "impact_damper/motion/contact_without_modes.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/forced_motion.hpp"
#include "impact_damper/orbits/masses_along_run.hpp"

namespace impact_damper {
namespace {

using Unforced = NoForcing<double>;
using OfDamper = VariationalCoefficients::OfDamper;

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

// The number of pieces for a motion that contracts volumes by exp(-loss): each contracts by e at most, so
// that orthogonalisation between them keeps the digits of all directions, unless there would be more than
// most_pieces.
constexpr int most_pieces = 4096;
int pieces_of(double loss) { return loss < most_pieces ? 1 + int(loss) : most_pieces; }
// Whether even most_pieces pieces contract by more than exp(-36) each, a rounding error: directions are lost.
bool is_lost(double loss) { return loss > 36.0 * most_pieces; }

// A mass whose changes are coupled to those of x by y' or y: it pushes a compliant wall, K and c + d, or
// slides in a fluid, 0 and d.
struct Coupled {
  std::size_t damper;
  double nu, stiffness, damping;
};

// The propagator of changes while several masses push their compliant walls (M13.27), or slide in a fluid
// (M13.33).
class JointPropagator {
 public:
  // mass: of the primary mass and all that is held. with_force: for changes of the force, too.
  JointPropagator(const VariationalCoefficients& of, std::span<const Coupled> coupled, double mass,
                  double duration, bool with_force)
      : coupled_(coupled), mass_(mass) {
    const std::size_t n = 2 + 2 * coupled.size() + (with_force ? 4 : 0);
    double rate = with_force ? of.force.frequency : 0, all_k = 0, most_k = 0;
    for (const Coupled& each : coupled) {
      all_k += each.nu * each.stiffness;
      most_k = std::max(most_k, each.stiffness);
      rate += (1 + each.nu) * each.damping;
    }
    rate += 2 * of.zeta + std::sqrt(1 + all_k + most_k);
    matrix_ =
        matrix_exponential(n, duration, rate, [&](const Vector& s, Vector& rates) { derive(of, s, rates); });
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

  // Carries x, x', and y and y' of the coupled masses. `force`: (g, h, a, b) at the beginning.
  void carry(ChangeOfState& s, const std::array<double, 4>& force) const {
    Vector from(matrix_.size());
    from[0] = s[0], from[1] = s[1];
    const std::size_t n = 2 + 2 * coupled_.size();
    for (std::size_t k = 0; k < coupled_.size(); ++k) {
      from[2 + 2 * k] = s[index_of_y(coupled_[k].damper)];
      from[3 + 2 * k] = s[index_of_w(coupled_[k].damper)];
    }
    if (from.size() > n) std::copy(force.begin(), force.end(), from.begin() + std::ptrdiff_t(n));
    const Vector to = product(matrix_, from);
    s[0] = to[0], s[1] = to[1];
    for (std::size_t k = 0; k < coupled_.size(); ++k) {
      s[index_of_y(coupled_[k].damper)] = to[2 + 2 * k];
      s[index_of_w(coupled_[k].damper)] = to[3 + 2 * k];
    }
  }

 private:
  // The right-hand sides of the variational equations (M13.27).
  void derive(const VariationalCoefficients& of, const Vector& s, Vector& rates) const {
    const std::size_t n = 2 + 2 * coupled_.size();
    double a = -2 * of.zeta * s[1] - s[0];
    if (s.size() > n) a += s[n];
    for (std::size_t k = 0; k < coupled_.size(); ++k) {
      const Coupled& each = coupled_[k];
      const double push = each.damping * s[3 + 2 * k] + each.stiffness * s[2 + 2 * k];
      a += each.nu * push;
      rates[2 + 2 * k] = s[3 + 2 * k];
      rates[3 + 2 * k] = -push;
    }
    a /= mass_;
    rates[0] = s[1], rates[1] = a;
    for (std::size_t k = 0; k < coupled_.size(); ++k) rates[3 + 2 * k] -= a;
    if (s.size() == n) return;
    const double omega = of.force.frequency, *g = s.data() + n;
    rates[n] = omega * g[1] + g[2];
    rates[n + 1] = -omega * g[0] + g[3];
    rates[n + 2] = omega * g[3];
    rates[n + 3] = -omega * g[2];
  }

  std::span<const Coupled> coupled_;
  double mass_;
  // Rows and columns of x, x', q and q' of each coupled mass, and (g, h, a, b) of (M13.27).
  Matrix matrix_;
};

// Sets `all` to the rates of the state `now`: x', x'', then y' and y'' of each damper.
void find_rates(const VariationalCoefficients& of, const MassesAlongRun& now, double time,
                ChangeOfState& all) {
  all.resize(of.dimensions());
  all[0] = now.v;
  all[1] = now.acceleration(time);
  for (std::size_t i = 0; i < now.masses.size(); ++i) {
    const bool held = now.masses[i].held;
    all[index_of_y(i)] = held ? 0 : now.masses[i].w;
    all[index_of_w(i)] = held ? 0 : -(all[1] + now.force_in_cavity(i) + of.weight);
  }
}

// Adds what touch (sign 1) or end (-1) of a contact with a compliant wall changes, (M13.6), (M13.25) and
// (M13.35): `amount` times the jump of the rates, divided by y'.
void add_edge(const VariationalCoefficients& of, const MassesAlongRun& now, std::size_t damper, int sign,
              double amount, ChangeOfState& s) {
  const OfDamper& its = of.dampers[damper];
  const double share = its.nu / now.joined_mass_before();
  const double on_primary = sign * share * its.damping, on_own = -sign * (1 + share) * its.damping;
  s[1] += on_primary * amount;
  for (std::size_t i = 0; i < now.masses.size(); ++i)
    if (!now.masses[i].held_before) s[index_of_w(i)] += (i == damper ? on_own : -on_primary) * amount;
}

// The saltation matrix of an event (M13.4) at rigid walls, or with friction, weight or drag (13.11).
class Saltation {
 public:
  // All must outlive this object. Carried::one_sided and stop_margin are kept up to date.
  Saltation(const VariationalCoefficients& of, const MassesAlongRun& now, Carried& all)
      : of_(of), now_(now), all_(all) {}

  // Finds the matrix of an event at a time: begin() is called before its jump of the state, find() after it.
  void begin(double time) { find_rates(of_, now_, time, rates_before_); }
  void find(double time, bool run_begins) {
    find_rates(of_, now_, time, rates_after_);
    find_shares();
    find_edges(run_begins);
    find_conditions(time);
    // A mass at rest that begins to slide as the run begins: after a change of y' against that direction it
    // would stop first.
    if (run_begins)
      for (const MassesAlongRun::Mass& mass : now_.masses)
        all_.one_sided = all_.one_sided || (mass.slides != 0 && mass.w == 0);
    const bool acts = !conditions_.empty();
    if (!acts && edges_.empty()) return;
    // Touches and ends of contacts at one instant have a derivative.
    const bool at_one_instant = of_.has_components && last_time_ && time - *last_time_ <= 1e-14 * (1 + time);
    if ((at_one_instant && (acts || last_acts_)) || (conditions_.size() > 1 && !all_stay_))
      all_.one_sided = true;
    last_time_ = time;
    last_acts_ = acts;
    if (!acts) return;
    shift_ = rates_before_;
    jump(shift_);
    for (const Edge& each : edges_)
      add_edge(of_, now_, each.damper, each.sign, now_.masses[each.damper].w, shift_);
    for (std::size_t i = 0; i < shift_.size(); ++i) shift_[i] = rates_after_[i] - shift_[i];
  }
  // Multiplies a change by it. by_force(): the derivative of f at that time by what is changed.
  template <class ByForce>
  void apply(ChangeOfState& s, ByForce&& by_force) const {
    double earlier = 0;  // by how much the event comes earlier after this change
    for (const Condition& each : conditions_)
      earlier += (each.index > 0 ? s[each.index] : by_force() + change_in_band(each.damper, s)) / each.rate;
    for (const Edge& each : edges_)
      add_edge(of_, now_, each.damper, each.sign, s[index_of_y(each.damper)], s);
    jump(s);
    if (conditions_.empty()) return;
    earlier /= double(conditions_.size());
    for (std::size_t i = 0; i < s.size(); ++i) s[i] += shift_[i] * earlier;
  }

 private:
  // What sets the time of an event: a number of the state that comes to zero, at a rate; or, where `index` is
  // 0, (1 + sigma)(x'' + K q) of a damper that comes to the edge of its band. No condition sets the time at
  // which a run begins.
  struct Condition {
    std::size_t index;
    double rate;
    std::size_t damper = 0;
  };
  struct Edge {
    std::size_t damper;
    int sign;
  };

  // Finds the coefficients of (M13.23) and (M13.24), which is (M13.7) for one mass.
  void find_shares() {
    const double joined_mass = now_.joined_mass();
    gain_.assign(now_.masses.size(), 0.0);
    share_.assign(now_.masses.size(), 0.0);
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      const OfDamper& its = of_.dampers[i];
      if (now_.masses[i].is_active) gain_[i] = its.nu * (1 + its.e) / now_.active_mass;
      if (now_.masses[i].joins) share_[i] = its.nu / joined_mass;
    }
  }
  // Finds the touches and ends of contacts with compliant walls.
  void find_edges(bool run_begins) {
    edges_.clear();
    if (of_.rigid) return;
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      const MassesAlongRun::Mass& mass = now_.masses[i];
      if (mass.meets) edges_.push_back({i, 1});
      if (!run_begins && mass.wall_before != 0 && mass.wall == 0) edges_.push_back({i, -1});
    }
  }
  void find_conditions(double time) {
    conditions_.clear();
    all_stay_ = false;
    if (of_.rigid)
      for (const MotionChain::Impact& impact : now_.impacts)
        conditions_.push_back({index_of_y(std::size_t(impact.damper)), impact.w});
    // Beside the jump of the wall's force, an edge lets go whom friction cannot hold against that jump.
    bool some_let_go = false;
    for (std::size_t i = 0; i < now_.masses.size() && !edges_.empty(); ++i) {
      const MassesAlongRun::Mass& mass = now_.masses[i];
      if (!mass.held_before) continue;
      some_let_go = some_let_go || !mass.held;
      if (of_.dampers[i].holding > of_.dampers[i].friction) note_margin(distance_from_band(i));
    }
    if (some_let_go)
      for (const Edge& each : edges_)
        conditions_.push_back({index_of_y(each.damper), now_.masses[each.damper].w});
    if (!conditions_.empty()) return;
    // Stops (M13.29), (M13.30).
    all_stay_ = edges_.empty();
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      const MassesAlongRun::Mass& mass = now_.masses[i];
      // One that joins its wall at another's stop has chattered there, and no speed of its own sets a time.
      const bool turns = mass.slides_before != 0 && mass.slides == -mass.slides_before;
      const bool holds = mass.slides_before != 0 && mass.held && !mass.joins_place;
      if (!turns && !holds) continue;
      all_stay_ = all_stay_ && mass.held;
      const double rate = rates_before_[index_of_w(i)];
      conditions_.push_back({index_of_w(i), rate});
      note_margin(std::fabs(rate));
      if (of_.dampers[i].holding > of_.dampers[i].friction) note_margin(distance_from_band(i));
    }
    if (!conditions_.empty()) {
      if (!edges_.empty()) all_.one_sided = true;
      return;
    }
    find_release(time);
  }
  // Releases (M13.31), at which the rates jump only where phi_s > phi (M13.32). Of several that are let go at
  // one instant the one that comes to its edge lets the others go by that jump. Those that come to their
  // edges together do so by the same condition, unless walls push one of them.
  void find_release(double time) {
    std::optional<std::size_t> first;
    double nearest = 0;
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      const MassesAlongRun::Mass& mass = now_.masses[i];
      const OfDamper& its = of_.dampers[i];
      if (!mass.held_before || mass.held || !(its.holding > its.friction)) continue;
      const double needs = std::fabs(rates_before_[1] + of_.weight + now_.wall_spring(i));
      const double off = std::fabs(needs - its.holding);
      const auto pushed = [&](std::size_t j) { return !of_.rigid && now_.masses[j].wall != 0; };
      if (first && off <= 1e-12 * its.holding && nearest <= 1e-12 * its.holding &&
          (pushed(i) || pushed(*first)))
        all_.one_sided = true;
      if (first && nearest <= off) continue;
      first = i;
      nearest = off;
    }
    if (!first) return;
    const double by_force = of_.force.amplitude * of_.force.frequency * of_.force.phase(time).cos;
    conditions_.push_back({0, by_force + change_in_band(*first, rates_before_), *first});
    note_margin(std::fabs(conditions_.back().rate));
  }
  void note_margin(double margin) {
    if (!(all_.stop_margin && *all_.stop_margin <= margin)) all_.stop_margin = margin;
  }
  // How far from phi_s the force is with which a mass has to be held just after an event.
  double distance_from_band(std::size_t i) const {
    const OfDamper& its = of_.dampers[i];
    const double own = rates_after_[index_of_w(i)];                                      // 0 if it is held
    const double held = rates_after_[1] + its.nu / (now_.joined_mass() + its.nu) * own;  // x'', if it is
    return std::fabs(std::fabs(held + of_.weight + now_.wall_spring(i)) - its.holding);
  }
  // The change of (1 + sigma)(x'' + K q) of a damper that is held, before the event and without that of the
  // force.
  double change_in_band(std::size_t damper, const ChangeOfState& s) const {
    double change = -2 * of_.zeta * s[1] - s[0];
    const auto in_wall = [&](std::size_t i) { return !of_.rigid && now_.masses[i].wall_before != 0; };
    for (std::size_t i = 0; i < of_.dampers.size(); ++i) {
      if (now_.masses[i].held_before) continue;
      const OfDamper& its = of_.dampers[i];
      double force = its.drag * s[index_of_w(i)];
      if (in_wall(i)) force += its.damping * s[index_of_w(i)] + its.stiffness * s[index_of_y(i)];
      change += its.nu * force;
    }
    if (in_wall(damper))
      change += now_.joined_mass_before() * (of_.dampers[damper].stiffness * s[index_of_y(damper)]);
    return change;
  }
  // Multiplies a change by the derivative D of the jump, (M13.23) and (M13.24).
  void jump(ChangeOfState& s) const {
    double gained = 0, x = 0, v = 0;
    for (std::size_t i = 0; i < gain_.size(); ++i) gained += gain_[i] * s[index_of_w(i)];
    for (std::size_t i = 0; i < gain_.size(); ++i) {
      const MassesAlongRun::Mass& mass = now_.masses[i];
      double& w = s[index_of_w(i)];
      w = mass.is_active ? -of_.dampers[i].e * w : w - gained;
      v += share_[i] * w;
      if (mass.joins_place) x += share_[i] * s[index_of_y(i)];
    }
    s[0] += x;
    s[1] += gained + v;
    for (std::size_t i = 0; i < gain_.size(); ++i) {
      const MassesAlongRun::Mass& mass = now_.masses[i];
      double &y = s[index_of_y(i)], &w = s[index_of_w(i)];
      w = mass.held ? 0 : w - v;
      if (!mass.held) y -= x;
      if (mass.joins_place) y = 0;
    }
  }

  const VariationalCoefficients& of_;
  const MassesAlongRun& now_;
  Carried& all_;
  std::vector<double> gain_, share_;  // nu (1+e) of those with an impulse, nu of those that join; over masses
  std::vector<Edge> edges_;
  std::vector<Condition> conditions_;
  bool all_stay_ = false;  // the event is stops of masses that are held from then on, in whatever order
  std::optional<double> last_time_;
  bool last_acts_ = false;                            // whether the event then had conditions
  ChangeOfState rates_before_, rates_after_, shift_;  // F^-, F^+ and F^+ - D F^-
};

// Carries changes along one run, motion by motion.
class VariationalEquations {
 public:
  VariationalEquations(const VariationalCoefficients& of, const RecordedRun& run, AlongRun* along,
                       const Changes& changes, const std::function<void()>& after_step)
      : of_(of),
        run_(run),
        along_(along),
        changes_(changes),
        after_step_(after_step),
        now_(of, run),
        saltation_(of, now_, all_),
        dimensions_lost_(of.dampers.size()) {}

  Carried carry() {
    for (std::size_t n = 0; n < run_.chain.motions.size(); ++n) {
      if (of_.plain_contacts) {
        pass_contacts(n);
      } else {
        pass_event(n);
      }
      const MotionChain::Motion& motion = run_.chain.motions[n];
      find_coupled();
      if (coupled_.empty()) {
        pass_flight(motion);
      } else if (!is_contact_alone()) {
        pass_coupled(motion);
      } else if (const UnforcedModes& modes = *of_.dampers[coupled_[0].damper].modes; modes.coupled) {
        pass_contact<ContactWithoutModes<double, Unforced>>(modes, motion);
      } else {
        pass_contact<Contact<double, Unforced>>(modes, motion);
      }
      if (of_.rigid)
        for (std::size_t i = 0; i < now_.masses.size(); ++i)
          if (!now_.masses[i].held) now_.masses[i].w += now_.v - motion.v - now_.pull(i) * motion.duration;
      now_.pass(motion);
    }
    if (along_) {
      now_.x = run_.end.x, now_.v = run_.end.v;
      for (std::size_t i = 0; i < now_.masses.size(); ++i)
        now_.masses[i].y = run_.end.dampers[i].y, now_.masses[i].w = run_.end.dampers[i].w;
      find_rates(of_, now_, run_.end_time, along_->rates_at_end);
    }
    all_.contacts = std::move(now_.contacts);
    return std::move(all_);
  }

 private:
  // carry(s, piece): carries a change through an event, or a piece of a motion.
  template <class Carry>
  void carry_all(int pieces, Carry&& carry) {
    for (int piece = 0; piece < pieces; ++piece) {
      for (ChangeOfState* const each : changes_) carry(*each, piece);
      if (after_step_) after_step_();
    }
  }

  // The derivative (g, h, a, b) of the force at a time (M13.27) by what a change is by; 0 for the state's.
  std::array<double, 4> change_of_force(const ChangeOfState& s, double time) const {
    if (along_ && &s == &along_->by_frequency) return JointPropagator::secular(of_.force, time);
    if (along_ && &s == &along_->by_amplitude) return JointPropagator::harmonic(of_.force, time);
    return {};
  }

  // Applies the event between the motion n and the one before, if there is one: to the changes its saltation
  // matrix (M13.4), to the state its jump.
  void pass_event(std::size_t n) {
    if (!now_.comes_to_event(n)) return;
    const double time = run_.chain.motions[n].begin;
    saltation_.begin(time);
    now_.pass_event(n);
    saltation_.find(time, n == 0);
    carry_all(
        1, [&](ChangeOfState& s, int) { saltation_.apply(s, [&] { return change_of_force(s, time)[0]; }); });
    // A mass that friction stops loses the change of y', one that stays on its wall that of y, too.
    std::size_t lost = 0;
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      const MassesAlongRun::Mass& mass = now_.masses[i];
      if (mass.joins) dimensions_lost_[i] = mass.joins_place || mass.meets ? 2 : 1;
      if (mass.held) lost += dimensions_lost_[i];
    }
    all_.lost = std::max(all_.lost, lost);
  }
  // Applies the plain touches and ends of contacts between the motion n and the one before (M13.25).
  void pass_contacts(std::size_t n) {
    now_.come_to_contacts(n);
    for (std::size_t i = 0; i < now_.masses.size(); ++i)
      if (now_.ends_contact(i, n)) apply_edge(i, -1);
    for (const MotionChain::Impact& impact : now_.impacts) apply_edge(std::size_t(impact.damper), 1);
    now_.pass_contacts(n);
  }
  void apply_edge(std::size_t damper, int sign) {
    carry_all(1, [&](ChangeOfState& s, int) { add_edge(of_, now_, damper, sign, s[index_of_y(damper)], s); });
  }

  // In how many pieces a motion is taken. rate_of_loss: minus the divergence, the rate at which volumes
  // contract. A propagator by squaring (M13.27) loses digits where it contracts them much.
  int pieces_for(double rate_of_loss, double duration, bool by_squaring = false) {
    if (!after_step_ && !by_squaring) return 1;
    const double loss = rate_of_loss * duration;
    if (is_lost(loss)) all_.lost = std::max(all_.lost, 2 * std::max<std::size_t>(1, now_.in_contact.size()));
    return pieces_of(loss);
  }
  // Carries changes, and the state of all masses, through a motion in which none pushes a compliant wall, by
  // (M13.2) or, while some stick, (M13.22).
  void pass_flight(const MotionChain::Motion& motion) {
    const double mass = now_.joined_mass();
    const Oscillator<double> oscillator =
        mass == 1 ? of_.free : Oscillator<double>(of_.zeta / mass, 1 / mass);
    const int pieces = pieces_for(2 * oscillator.a(), motion.duration);
    const double duration = motion.duration / pieces;
    const Propagator<double> p = oscillator.propagate(duration);
    const double spring = oscillator.b() * p.s, slowed = p.c1 - 2 * oscillator.a() * p.s;  // S' - 1
    carry_all(pieces, [&](ChangeOfState& s, int) {
      const double x = s[0], v = s[1];
      s[0] = p.c * x + p.s * v;
      s[1] = p.v * v - spring * x;
      for (std::size_t i = 0; i < now_.masses.size(); ++i) {
        if (now_.masses[i].held) continue;
        double &y = s[index_of_y(i)], &w = s[index_of_w(i)];
        y = (y - (p.c1 * x + p.s1 * v)) + duration * w;
        w += spring * x - slowed * v;
      }
    });
    if (along_)
      add_driven(
          motion, [&](double tau) { return oscillator.panel(tau); },
          [&](double tau) {
            const Propagator<double> impulse = oscillator.propagate(tau);
            return std::array<double, 4>{impulse.s / mass, impulse.v / mass, 0, 0};
          });
  }
  // Carries changes through a motion in which one mass pushes a compliant wall. The columns of the propagator
  // are contacts without a force, each from a unit state.
  template <class InContact>
  void pass_contact(const UnforcedModes& modes, const MotionChain::Motion& motion) {
    const std::size_t in = coupled_[0].damper;
    const OfDamper& its = of_.dampers[in];
    const auto from = [&](const State<double>& start) { return InContact(modes, 0, start, Wall::left); };
    const int pieces = pieces_for(2 * of_.zeta + (1 + its.nu) * its.damping, motion.duration);
    const double duration = motion.duration / pieces;
    const std::array columns{from({1, 0, 0, 0}).at(duration), from({0, 1, 0, 0}).at(duration),
                             from({0, 0, 1, 0}).at(duration), from({0, 0, 0, 1}).at(duration)};
    carry_all(pieces, [&](ChangeOfState& s, int) {
      const std::array<double, 4> now{s[0], s[1], s[index_of_y(in)], s[index_of_w(in)]};
      State<double> to{0, 0, 0, 0};
      for (std::size_t j = 0; j < 4; ++j) {
        to.x += columns[j].x * now[j], to.v += columns[j].v * now[j];
        to.y += columns[j].y * now[j], to.w += columns[j].w * now[j];
      }
      s[0] = to.x, s[1] = to.v, s[index_of_y(in)] = to.y, s[index_of_w(in)] = to.w;
      carry_free(s, duration, now[0], now[1]);
    });
    if (along_) {
      const InContact impulse = from({0, 1, 0, -1});
      add_driven(
          motion, [&](double tau) { return impulse.panel(tau); },
          [&](double tau) {
            const State<double> s = impulse.at(tau);
            return std::array<double, 4>{s.x, s.v, s.y, s.w};
          });
    }
  }
  // Sets coupled_ to the masses that push compliant walls, in which none holds them, or slide in a fluid.
  void find_coupled() {
    coupled_.clear();
    for (std::size_t i = 0; i < now_.masses.size(); ++i)
      if (const OfDamper& its = of_.dampers[i]; is_coupled(i)) {
        const bool pushes = now_.masses[i].wall != 0;
        coupled_.push_back(
            {i, its.nu, pushes ? its.stiffness : 0, pushes ? its.damping + its.drag : its.drag});
      }
  }
  bool is_coupled(std::size_t i) const {
    return !now_.masses[i].held && (now_.masses[i].wall != 0 || of_.dampers[i].drag != 0);
  }
  // Whether all that is coupled is one mass that pushes its wall, beside the primary mass alone.
  bool is_contact_alone() const {
    return coupled_.size() == 1 && now_.masses[coupled_[0].damper].wall != 0 &&
           of_.dampers[coupled_[0].damper].drag == 0 && now_.joined_mass() == 1;
  }
  // Carries changes through a motion in which several masses push compliant walls, or some slide in a fluid.
  void pass_coupled(const MotionChain::Motion& motion) {
    const double mass = now_.joined_mass();
    double rate_of_loss = 2 * of_.zeta / mass;
    for (const Coupled& each : coupled_) rate_of_loss += (1 + each.nu / mass) * each.damping;
    const int pieces = pieces_for(rate_of_loss, motion.duration, true);
    const double duration = motion.duration / pieces;
    const JointPropagator propagator(of_, coupled_, mass, duration, along_ != nullptr);
    carry_all(pieces, [&](ChangeOfState& s, int piece) {
      const double x = s[0], v = s[1];
      propagator.carry(s, change_of_force(s, motion.begin + duration * piece));
      carry_free(s, duration, x, v);
    });
  }
  // Carries a change of y and y' of all masses that fly, x and v being those of x and x' before.
  void carry_free(ChangeOfState& s, double duration, double x, double v) const {
    for (std::size_t i = 0; i < now_.masses.size(); ++i) {
      if (now_.masses[i].held || is_coupled(i)) continue;
      s[index_of_y(i)] += duration * s[index_of_w(i)] - (s[0] - x - duration * v);
      s[index_of_w(i)] -= s[1] - v;
    }
  }

  // Adds the derivatives by omega_f and f0 (M13.3), by Gauss's 16 points in panels of the time tau that is
  // left until the end. response(tau): x, x', and y, y' of a mass that pushes its wall, a time tau after a
  // unit impulse of the force.
  template <class Panel, class Response>
  void add_driven(const MotionChain::Motion& motion, Panel&& panel, Response&& response) const {
    std::array<double, 4> by_frequency{}, by_amplitude{};
    const double duration = motion.duration;
    for (double from = 0; from < duration;) {
      const double to =
          std::min(duration, from + std::max(panel_under(of_.force, panel(from)), duration / 65536));
      const double half = (to - from) / 2, middle = from + half;
      for (const auto& [abscissa, weight] : gauss_16) {
        for (const double side : {-abscissa, abscissa}) {
          const double tau = middle + half * side, time = motion.begin + (duration - tau);
          const auto [sin, cos] = of_.force.phase(time);
          const std::array<double, 4> unit = response(tau);
          for (std::size_t i = 0; i < 4; ++i) {
            by_frequency[i] += half * weight * unit[i] * (of_.force.amplitude * time * cos);
            by_amplitude[i] += half * weight * unit[i] * sin;
          }
        }
      }
      from = to;
    }
    const auto add = [&](const std::array<double, 4>& sum, ChangeOfState& s) {
      s[0] += sum[0];
      s[1] += sum[1];
      for (std::size_t i = 0; i < now_.masses.size(); ++i) {
        if (now_.masses[i].held) continue;
        if (now_.masses[i].wall == 0) {
          s[index_of_y(i)] -= sum[0];
          s[index_of_w(i)] -= sum[1];
        } else {
          s[index_of_y(i)] += sum[2];
          s[index_of_w(i)] += sum[3];
        }
      }
    };
    add(by_frequency, along_->by_frequency);
    add(by_amplitude, along_->by_amplitude);
  }

  const VariationalCoefficients& of_;
  const RecordedRun& run_;
  AlongRun* along_;
  const Changes& changes_;
  const std::function<void()>& after_step_;
  // y is not followed, nor y' with compliant walls, where no matrix depends on them.
  MassesAlongRun now_;
  std::vector<Coupled> coupled_;
  Carried all_;
  Saltation saltation_;
  std::vector<std::size_t> dimensions_lost_;  // by each mass while it sticks or is held
};

}  // namespace

std::shared_ptr<const VariationalCoefficients> variational_coefficients(const Scene& scene,
                                                                        const Engine& engine) {
  return std::make_shared<const VariationalCoefficients>(scene, engine);
}

Carried carry_changes(const VariationalCoefficients& of, const RecordedRun& run,
                      std::vector<ChangeOfState>& changes, const std::function<void()>& after_step,
                      AlongRun* along) {
  if (along) {
    *along = {};
    along->by_frequency.assign(of.dimensions(), 0.0);
    along->by_amplitude.assign(of.dimensions(), 0.0);
  }
  const Changes all = changes_of(changes, along);
  return VariationalEquations(of, run, along, all, after_step).carry();
}

}  // namespace impact_damper
