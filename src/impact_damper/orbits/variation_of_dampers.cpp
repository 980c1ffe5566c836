#include "impact_damper/orbits/variation_of_dampers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <variant>

#include "impact_damper/engines/compatibility.hpp"
#include "impact_damper/math/dense.hpp"
#include "impact_damper/motion/contact.hpp"
#include "impact_damper/motion/contact_without_modes.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/impact_law.hpp"
#include "impact_damper/motion/joint_contact.hpp"
#include "impact_damper/motion/wall.hpp"

namespace impact_damper {
namespace {

using Unforced = NoForcing<double>;
using UnforcedModes = ContactModes<double, Unforced>;
using ForcedOscillator = Driven<double, Forcing<double>>;

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

}  // namespace

struct VariationalCoefficients {
  struct OfDamper {
    double nu, e, clearance;
    double stiffness = 0, damping = 0;   // compliant walls: K and gamma of (M17.9)
    std::optional<UnforcedModes> modes;  // of their contacts
  };

  VariationalCoefficients(const Scene& of_scene, const Engine& engine)
      : scene(of_scene),
        rigid(has_rigid_walls(engine)),
        zeta(scene.damping_ratio),
        force{scene.force_amplitude, scene.force_frequency},
        free(zeta, 1, force) {
    const auto* const exact = std::get_if<Exact>(&engine);
    for (const SceneDamper& each : scene.dampers) {
      OfDamper& damper = dampers.emplace_back(
          OfDamper{.nu = each.mass_ratio, .e = each.restitution, .clearance = each.clearance, .modes = {}});
      if (!exact) continue;
      damper.modes.emplace(System<double, Unforced>(scene, each), zeta_m<double>(each, exact->calibration));
      damper.stiffness = damper.modes->stiffness;
      damper.damping = damper.modes->damping;
    }
  }
  std::size_t dimensions() const { return 2 + 2 * dampers.size(); }

  Scene scene;
  bool rigid;
  double zeta;
  Forcing<double> force;
  ForcedOscillator free;
  std::vector<OfDamper> dampers;
};

namespace {

using OfDamper = VariationalCoefficients::OfDamper;

// The propagator of changes while several masses push their compliant walls (M13.27).
class JointPropagator {
 public:
  // in_contact: indices of these masses. with_force: for changes of the force, too.
  JointPropagator(const VariationalCoefficients& of, std::span<const std::size_t> in_contact, double duration,
                  bool with_force)
      : in_contact_(in_contact) {
    const std::size_t n = 2 + 2 * in_contact.size() + (with_force ? 4 : 0);
    double rate = with_force ? of.force.frequency : 0, all_k = 0, most_k = 0;
    for (const std::size_t i : in_contact) {
      const OfDamper& each = of.dampers[i];
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

  // Carries x, x', and y and y' of the masses in contact. `force`: (g, h, a, b) at the beginning.
  void carry(ChangeOfState& s, const std::array<double, 4>& force) const {
    Vector from(matrix_.size());
    from[0] = s[0], from[1] = s[1];
    const std::size_t n = 2 + 2 * in_contact_.size();
    for (std::size_t k = 0; k < in_contact_.size(); ++k) {
      from[2 + 2 * k] = s[index_of_y(in_contact_[k])];
      from[3 + 2 * k] = s[index_of_w(in_contact_[k])];
    }
    if (from.size() > n) std::copy(force.begin(), force.end(), from.begin() + std::ptrdiff_t(n));
    const Vector to = product(matrix_, from);
    s[0] = to[0], s[1] = to[1];
    for (std::size_t k = 0; k < in_contact_.size(); ++k) {
      s[index_of_y(in_contact_[k])] = to[2 + 2 * k];
      s[index_of_w(in_contact_[k])] = to[3 + 2 * k];
    }
  }

 private:
  // The right-hand sides of the variational equations (M13.27).
  void derive(const VariationalCoefficients& of, const Vector& s, Vector& rates) const {
    const std::size_t n = 2 + 2 * in_contact_.size();
    double a = -2 * of.zeta * s[1] - s[0];
    if (s.size() > n) a += s[n];
    for (std::size_t k = 0; k < in_contact_.size(); ++k) {
      const OfDamper& each = of.dampers[in_contact_[k]];
      const double push = each.damping * s[3 + 2 * k] + each.stiffness * s[2 + 2 * k];
      a += each.nu * push;
      rates[2 + 2 * k] = s[3 + 2 * k];
      rates[3 + 2 * k] = -push;
    }
    rates[0] = s[1], rates[1] = a;
    for (std::size_t k = 0; k < in_contact_.size(); ++k) rates[3 + 2 * k] -= a;
    if (s.size() == n) return;
    const double omega = of.force.frequency, *g = s.data() + n;
    rates[n] = omega * g[1] + g[2];
    rates[n + 1] = -omega * g[0] + g[3];
    rates[n + 2] = omega * g[3];
    rates[n + 3] = -omega * g[2];
  }

  std::span<const std::size_t> in_contact_;
  // Rows and columns of x, x', q and q' of each mass in contact, and (g, h, a, b) of (M13.27).
  Matrix matrix_;
};

// Carries changes along one run, motion by motion. x and x' at the end of each motion and y' at each impact
// are the run's; y and y' of all masses follow from these.
class VariationalEquations {
 public:
  VariationalEquations(const VariationalCoefficients& of, const RecordedRun& run, AlongRun* along,
                       const Changes& changes, const std::function<void()>& after_step)
      : of_(of),
        run_(run),
        along_(along),
        changes_(changes),
        after_step_(after_step),
        intervals_(contact_intervals(of.scene, run, of.rigid)),
        x_(run.begin.x),
        v_(run.begin.v),
        y_(of.dampers.size()),
        w_(of.dampers.size()),
        wall_of_(of.dampers.size()),
        end_of_contact_(of.dampers.size()),
        event_(of.dampers.size()) {
    for (std::size_t i = 0; i < y_.size(); ++i)
      y_[i] = run.begin.dampers[i].y, w_[i] = run.begin.dampers[i].w;
  }

  Carried carry() {
    for (std::size_t n = 0; n < run_.chain.motions.size(); ++n) {
      continued_ = n > 0;
      if (of_.rigid) {
        pass_rigid_event(n);
      } else {
        pass_compliant_events(n);
      }
      const MotionChain::Motion& motion = run_.chain.motions[n];
      in_contact_.clear();
      for (std::size_t i = 0; i < wall_of_.size(); ++i)
        if (wall_of_[i] != 0) in_contact_.push_back(i);
      if (of_.rigid) all_.lost = std::max(all_.lost, 2 * in_contact_.size());
      if (of_.rigid || in_contact_.empty()) {
        pass_flight(motion);
      } else if (in_contact_.size() > 1) {
        pass_joint_contact(motion);
      } else if (const UnforcedModes& modes = *of_.dampers[in_contact_.front()].modes; modes.coupled) {
        pass_contact<ContactWithoutModes<double, Unforced>>(modes, motion);
      } else {
        pass_contact<Contact<double, Unforced>>(modes, motion);
      }
      x_ = motion.x;
      v_ = motion.v;
    }
    if (along_) {
      x_ = run_.end.x, v_ = run_.end.v;
      for (std::size_t i = 0; i < y_.size(); ++i)
        y_[i] = run_.end.dampers[i].y, w_[i] = run_.end.dampers[i].w;
      rates(run_.end_time, along_->rates_at_end);
    }
    return all_;
  }

 private:
  bool wants_misses() const { return !after_step_; }
  double position_of_wall(std::size_t i) const { return wall_of_[i] > 0 ? 0 : of_.dampers[i].clearance; }
  // The primary mass and all that sticks to it.
  double joined_mass() const {
    double all = 1;
    for (std::size_t i = 0; i < wall_of_.size(); ++i)
      if (wall_of_[i] != 0) all += of_.dampers[i].nu;
    return all;
  }
  // The rates of the state: x', x'', then y' and y'' of each damper.
  void rates(double time, ChangeOfState& all) const {
    double a = of_.force.amplitude * of_.force.phase(time).sin - 2 * of_.zeta * v_ - x_;
    all.resize(of_.dimensions());
    for (std::size_t i = 0; i < w_.size(); ++i) {
      const bool free = wall_of_[i] == 0;
      all[index_of_y(i)] = free || !of_.rigid ? w_[i] : 0;
      all[index_of_w(i)] = 0;
      if (free || of_.rigid) continue;
      const OfDamper& its = of_.dampers[i];
      const double push = its.damping * w_[i] + its.stiffness * (y_[i] - position_of_wall(i));
      a += its.nu * push;
      all[index_of_w(i)] = -push;
    }
    if (of_.rigid) a /= joined_mass();
    all[0] = v_, all[1] = a;
    for (std::size_t i = 0; i < w_.size(); ++i)
      if (wall_of_[i] == 0 || !of_.rigid) all[index_of_w(i)] -= a;
  }
  // The impacts between the motion n and the one before.
  std::span<const MotionChain::Impact> impacts_before(std::size_t n) {
    const auto& impacts = run_.chain.impacts;
    const std::size_t first = next_impact_;
    while (next_impact_ < impacts.size() && impacts[next_impact_].motions == n) ++next_impact_;
    return std::span(impacts).subspan(first, next_impact_ - first);
  }

  // carry(s, piece): carries a change through an event, or a piece of a motion.
  template <class Carry>
  void carry_all(int pieces, Carry&& carry) {
    for (int piece = 0; piece < pieces; ++piece) {
      for (ChangeOfState* const each : changes_) carry(*each, piece);
      if (after_step_) after_step_();
    }
  }

  // What an event at rigid walls does to one mass.
  struct EventOfMass {
    bool meets, joins, is_active;  // is_active: gets an impulse from its wall (M17.3)
    double gain, share, of_w;      // x' gains gain y' by its impulse, share y' by its joining, of_w y' in all
    std::vector<double> saltation = {};  // meets: (F^+ - D F^-)/(n F^-) of (M13.4)
  };
  // Applies the event between the motion n and the one before, its impacts and the sticking of the masses
  // that stick from then on: to the changes its saltation matrix (M13.4), to the state its jump. The end of
  // sticking changes nothing, as the mass has no relative speed.
  void pass_rigid_event(std::size_t n) {
    const auto impacts = impacts_before(n);
    const std::vector<int> before = wall_of_;
    const bool some_begin = take_contacts(n);
    if (impacts.empty() && !some_begin) {
      continued_ = continued_ && wall_of_ == before;
      return;
    }
    continued_ = false;
    const std::vector<int> then = std::exchange(wall_of_, before);
    const double active_mass = find_active(impacts);
    double gained = 0;
    for (std::size_t i = 0; i < w_.size(); ++i)
      if (event_[i].is_active) gained += of_.dampers[i].nu * (1 + of_.dampers[i].e) * w_[i] / active_mass;
    const double time = run_.chain.motions[n].begin;
    rates(time, rates_before_);
    const std::vector<double> w_before = w_;
    wall_of_ = then;
    find_shares(before, active_mass);

    v_ += gained;
    double joined = 0;
    const double mass = joined_mass();
    for (std::size_t i = 0; i < w_.size(); ++i) {
      const EventOfMass& its = event_[i];
      w_[i] = its.is_active ? -of_.dampers[i].e * w_[i] : w_[i] - gained;
      if (its.joins) joined += of_.dampers[i].nu * w_[i] / mass;
      if (wall_of_[i] != 0) y_[i] = position_of_wall(i);
    }
    v_ += joined;
    for (std::size_t i = 0; i < w_.size(); ++i) w_[i] = wall_of_[i] != 0 ? 0 : w_[i] - joined;
    rates(time, rates_after_);
    for (const MotionChain::Impact& impact : impacts) {
      const auto i = std::size_t(impact.damper);
      find_saltation(event_[i].saltation, w_before[i] * double(impacts.size()));
    }
    carry_all(1, [&](ChangeOfState& s, int) { apply_saltation(s); });
  }
  // Finds the masses that meet walls, with y and y' then, and which of these and of those that stick get an
  // impulse. Returns 1 plus the mass ratios of the latter.
  double find_active(std::span<const MotionChain::Impact> impacts) {
    for (EventOfMass& each : event_) each.meets = each.is_active = false;
    if (impacts.empty()) return 1;
    all_.one_sided = all_.one_sided || impacts.size() > 1;
    at_walls_.clear();
    for (const MotionChain::Impact& impact : impacts) {
      const auto i = std::size_t(impact.damper);
      const OfDamper& its = of_.dampers[i];
      y_[i] = impact.wall == Wall::left ? 0 : its.clearance;
      w_[i] = impact.w;
      event_[i].meets = true;
      at_walls_.push_back({i, its.nu, its.e, w_[i] < 0 ? 1.0 : -1.0, -std::fabs(w_[i])});
    }
    for (std::size_t i = 0; i < w_.size(); ++i)
      if (wall_of_[i] != 0)
        at_walls_.push_back({i, of_.dampers[i].nu, of_.dampers[i].e, double(wall_of_[i]), 0.0});
    const double jump = jump_of_velocity<double>(std::span(at_walls_));
    double mass = 1;
    for (const MassAtWall<double>& each : at_walls_) {
      if (!(each.escape() + each.away * jump > 0)) continue;
      event_[each.index].is_active = true;
      mass += each.nu;
    }
    return mass;
  }
  // Finds which masses join, and the coefficients of (M13.23) and (M13.24), which is (M13.7) for one mass.
  // before: wall_of_ before the event.
  void find_shares(const std::vector<int>& before, double active_mass) {
    const double mass = joined_mass();
    const bool impacts = std::ranges::any_of(event_, &EventOfMass::meets);
    double passive = 0;  // the shares of masses that join without an impulse
    for (std::size_t i = 0; i < w_.size(); ++i) {
      EventOfMass& its = event_[i];
      // A mass that its wall leaves behind and that sticks again at the same event counts as newly stuck.
      const bool stays = before[i] != 0 && (!impacts || its.is_active);
      its.joins = wall_of_[i] != 0 && !stays;
      its.gain = its.is_active ? of_.dampers[i].nu * (1 + of_.dampers[i].e) / active_mass : 0;
      its.share = its.joins ? of_.dampers[i].nu / mass : 0;
      if (!its.is_active) passive += its.share;
    }
    for (std::size_t i = 0; i < w_.size(); ++i) {
      EventOfMass& its = event_[i];
      its.of_w = its.is_active ? its.gain * (1 - passive) + its.share * -of_.dampers[i].e : its.share;
    }
  }
  // What (M13.23) and (M13.24) take from y and y' of a mass that flies on, but for its own impact.
  struct Taken {
    double y = 0, gained = 0, joined = 0;
  };
  Taken taken_by(const ChangeOfState& s) const {
    Taken all;
    for (std::size_t i = 0; i < w_.size(); ++i) all.gained += event_[i].gain * s[index_of_w(i)];
    for (std::size_t i = 0; i < w_.size(); ++i) {
      const EventOfMass& its = event_[i];
      if (!its.joins) continue;
      const double w = s[index_of_w(i)];
      all.y += its.share * s[index_of_y(i)];
      all.joined += its.share * (its.is_active ? -of_.dampers[i].e * w : w - all.gained);
    }
    return all;
  }
  // y' of a mass that flies on after the jump.
  double velocity_after(std::size_t i, double w, const Taken& taken) const {
    return (event_[i].is_active ? -of_.dampers[i].e * w : w - taken.gained) - taken.joined;
  }
  // Sets `all` to (F^+ - D F^-)/w.
  void find_saltation(std::vector<double>& all, double w) const {
    const ChangeOfState& before = rates_before_;
    const Taken taken = taken_by(before);
    all = rates_after_;
    all[0] -= before[0];
    all[1] -= before[1];
    for (std::size_t i = 0; i < w_.size(); ++i) {
      all[0] -= event_[i].share * before[index_of_y(i)];
      all[1] -= event_[i].of_w * before[index_of_w(i)];
      if (wall_of_[i] != 0) continue;
      all[index_of_y(i)] -= before[index_of_y(i)] - taken.y;
      all[index_of_w(i)] -= velocity_after(i, before[index_of_w(i)], taken);
    }
    for (double& each : all) each /= w;
  }
  void apply_saltation(ChangeOfState& s) {
    const Taken taken = taken_by(s);
    double x = s[0], v = s[1];
    for (std::size_t i = 0; i < w_.size(); ++i) {
      const EventOfMass& its = event_[i];
      const double y = s[index_of_y(i)], w = s[index_of_w(i)];
      if (its.meets || its.joins) x += (its.share + (its.meets ? its.saltation[0] : 0)) * y;
      if (its.meets) v += its.saltation[1] * y;
      v += its.of_w * w;
    }
    shifted_.assign(s.size(), 0.0);  // by the delay of the impacts of other masses, and in y' of its own
    for (std::size_t k = 0; k < w_.size(); ++k) {
      if (!event_[k].meets) continue;
      for (std::size_t i = 2; i < s.size(); ++i)
        if (i != index_of_y(k)) shifted_[i] += event_[k].saltation[i] * s[index_of_y(k)];
    }
    s[0] = x;
    s[1] = v;
    for (std::size_t i = 0; i < w_.size(); ++i) {
      double &y = s[index_of_y(i)], &w = s[index_of_w(i)];
      if (wall_of_[i] != 0) {
        y = w = 0;
        continue;
      }
      const double own = event_[i].meets ? 1 + event_[i].saltation[index_of_y(i)] : 1;
      y = own * y - taken.y + shifted_[index_of_y(i)];
      w = velocity_after(i, w, taken) + shifted_[index_of_w(i)];
    }
  }

  // Ends and begins contacts before the motion n, in wall_of_. Returns whether some begin.
  bool take_contacts(std::size_t n) {
    for (std::size_t i = 0; i < wall_of_.size(); ++i)
      if (wall_of_[i] != 0 && end_of_contact_[i] == n) wall_of_[i] = 0;
    const std::size_t before = next_interval_;
    for (; next_interval_ < intervals_.size() && intervals_[next_interval_].first == n; ++next_interval_) {
      const ContactInterval& begins = intervals_[next_interval_];
      wall_of_[begins.damper] = begins.away;
      end_of_contact_[begins.damper] = begins.last;
    }
    return next_interval_ > before;
  }
  // Applies the touches and ends of contacts between the motion n and the one before (M13.25).
  void pass_compliant_events(std::size_t n) {
    for (std::size_t i = 0; i < wall_of_.size(); ++i) {
      if (wall_of_[i] == 0 || end_of_contact_[i] != n) continue;
      continued_ = false;
      y_[i] = position_of_wall(i);
      w_[i] = absolute_velocity_before(n, i) - v_;
      apply_edge(i, -1);
    }
    for (const MotionChain::Impact& impact : impacts_before(n)) {
      const auto i = std::size_t(impact.damper);
      continued_ = false;
      y_[i] = impact.wall == Wall::left ? 0 : of_.dampers[i].clearance;
      w_[i] = impact.w;
      apply_edge(i, 1);
    }
    take_contacts(n);
  }
  // x' + y' of a mass that flies on from before the motion n, which it keeps until its next impact.
  double absolute_velocity_before(std::size_t n, std::size_t damper) const {
    const auto& impacts = run_.chain.impacts;
    for (std::size_t k = next_impact_; k < impacts.size(); ++k)
      if (std::size_t(impacts[k].damper) == damper && impacts[k].motions > n)
        return run_.chain.motions[impacts[k].motions - 1].v + impacts[k].w;
    return run_.end.v + run_.end.dampers[damper].w;
  }
  // Applies the saltation matrix of touch (sign 1) or end (-1) of a contact (M13.25).
  void apply_edge(std::size_t damper, int sign) {
    const OfDamper& its = of_.dampers[damper];
    const double on_primary = sign * its.nu * its.damping, on_own = -sign * (1 + its.nu) * its.damping;
    carry_all(1, [&](ChangeOfState& s, int) {
      const double y = s[index_of_y(damper)];
      s[1] += on_primary * y;
      for (std::size_t i = 0; i < w_.size(); ++i)
        s[index_of_w(i)] += (i == damper ? on_own : -on_primary) * y;
    });
  }

  // In how many pieces a motion is taken. rate_of_loss: minus the divergence, the rate at which volumes
  // contract. A propagator by squaring (M13.27) loses digits where it contracts them much.
  int pieces_for(double rate_of_loss, double duration) {
    if (!after_step_ && in_contact_.size() < 2) return 1;
    const double loss = rate_of_loss * duration;
    if (is_lost(loss)) all_.lost = std::max(all_.lost, 2 * std::max<std::size_t>(1, in_contact_.size()));
    return pieces_of(loss);
  }
  // Carries changes, and the state of all masses, through a motion in which none pushes a compliant wall, by
  // (M13.2) or, while some stick, (M13.22).
  void pass_flight(const MotionChain::Motion& motion) {
    const double mass = joined_mass();
    const Oscillator<double> joined =
        mass == 1 ? Oscillator<double>() : Oscillator<double>(of_.zeta / mass, 1 / mass);
    const Oscillator<double>& oscillator = mass == 1 ? of_.free : joined;
    const int pieces = pieces_for(2 * oscillator.a(), motion.duration);
    const double duration = motion.duration / pieces;
    const Propagator<double> p = oscillator.propagate(duration);
    const double spring = oscillator.b() * p.s, slowed = p.c1 - 2 * oscillator.a() * p.s;  // S' - 1
    carry_all(pieces, [&](ChangeOfState& s, int) {
      const double x = s[0], v = s[1];
      s[0] = p.c * x + p.s * v;
      s[1] = p.v * v - spring * x;
      for (std::size_t i = 0; i < wall_of_.size(); ++i) {
        if (wall_of_[i] != 0) continue;
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
    if (wants_misses()) {
      pass_masses(motion, mass);
    } else if (of_.rigid) {
      for (std::size_t i = 0; i < w_.size(); ++i)
        if (wall_of_[i] == 0) w_[i] += v_ - motion.v;
    }
  }
  // Carries changes through a motion in which one mass pushes a compliant wall. The columns of the propagator
  // are contacts without a force, each from a unit state.
  template <class InContact>
  void pass_contact(const UnforcedModes& modes, const MotionChain::Motion& motion) {
    const std::size_t in = in_contact_.front();
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
    pass_masses_beside_contacts(motion);
  }
  // The same where several do.
  void pass_joint_contact(const MotionChain::Motion& motion) {
    double rate_of_loss = 2 * of_.zeta;
    for (const std::size_t i : in_contact_) rate_of_loss += (1 + of_.dampers[i].nu) * of_.dampers[i].damping;
    const int pieces = pieces_for(rate_of_loss, motion.duration);
    const double duration = motion.duration / pieces;
    const JointPropagator propagator(of_, in_contact_, duration, along_ != nullptr);
    carry_all(pieces, [&](ChangeOfState& s, int piece) {
      const double x = s[0], v = s[1], time = motion.begin + duration * piece;
      std::array<double, 4> force{};
      if (along_ && &s == &along_->by_frequency) force = JointPropagator::secular(of_.force, time);
      if (along_ && &s == &along_->by_amplitude) force = JointPropagator::harmonic(of_.force, time);
      propagator.carry(s, force);
      carry_free(s, duration, x, v);
    });
    pass_masses_beside_contacts(motion);
  }
  // Carries a change of y and y' of all masses that fly, x and v being those of x and x' before.
  void carry_free(ChangeOfState& s, double duration, double x, double v) const {
    for (std::size_t i = 0; i < wall_of_.size(); ++i) {
      if (wall_of_[i] != 0) continue;
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
      for (std::size_t i = 0; i < wall_of_.size(); ++i) {
        if (wall_of_[i] == 0) {
          s[index_of_y(i)] -= sum[0];
          s[index_of_w(i)] -= sum[1];
        } else if (!of_.rigid) {
          s[index_of_y(i)] += sum[2];
          s[index_of_w(i)] += sum[3];
        }
      }
    };
    add(by_frequency, along_->by_frequency);
    add(by_amplitude, along_->by_amplitude);
  }

  // Follows y and y' of the masses that fly, `mass` being that of the primary mass and all that sticks, and
  // updates the nearest miss.
  void pass_masses(const MotionChain::Motion& motion, double mass) {
    if (in_contact_.size() == w_.size()) return;
    const Forcing<double> force{of_.force.amplitude / mass, of_.force.frequency};
    std::optional<ForcedOscillator> joined;
    if (mass != 1) joined.emplace(of_.zeta / mass, 1 / mass, of_.force);
    const ForcedMotion<double> primary(joined ? *joined : of_.free, force, motion.begin, x_, v_);
    starts_.resize(w_.size(), FlightStart<double>(State<double>{}));
    for (std::size_t i = 0; i < w_.size(); ++i) {
      if (wall_of_[i] != 0) continue;
      const double clearance = of_.dampers[i].clearance;
      FlightStart<double>& start = starts_[i];
      if (!continued_) {
        const bool left = y_[i] <= clearance / 2;
        start = {{x_, v_, y_[i], w_[i]},
                 left ? 0 : clearance,
                 left ? 1.0 : -1.0,
                 left ? y_[i] : clearance - y_[i]};
      }
      const Flight<double, Forcing<double>, OwnClearance<double>, const ForcedMotion<double>&> flight(
          primary, {clearance}, start);
      look_for_misses(
          i, [&](double sign, double from) { return flight.turn_of_y(sign, from, motion.duration, search_); },
          [&](double time) { return flight.at(time).y; });
      start = flight.start_of_rest(motion.duration);
      y_[i] = start.state.y;
      w_[i] = start.state.w;
    }
  }
  // The same while some masses push compliant walls, which are followed, too.
  void pass_masses_beside_contacts(const MotionChain::Motion& motion) {
    if (!wants_misses() || w_.size() == 1) return;
    std::vector<PushedWall<double>> walls;
    for (const std::size_t i : in_contact_)
      walls.push_back({of_.dampers[i].nu, of_.dampers[i].stiffness, of_.dampers[i].damping,
                       y_[i] - position_of_wall(i), w_[i]});
    joint_.set_walls(of_.zeta, of_.force, walls);
    double x = x_, v = v_;
    for (double passed = 0; passed < motion.duration;) {
      joint_.begin(motion.begin + passed, x, v, walls);
      const double left = motion.duration - passed, until = std::min(joint_.length(), left);
      const auto end = joint_.change(until);
      for (std::size_t i = 0; i < w_.size(); ++i) {
        if (wall_of_[i] != 0) continue;
        look_for_misses(
            i,
            [&](double sign, double from) {
              return joint_.fall(joint_.relative_velocity(w_[i], sign), from, until, search_);
            },
            [&](double time) { return y_[i] + (w_[i] * time - joint_.change(time).dx); });
        y_[i] += w_[i] * until - end.dx;
        w_[i] -= end.dv;
      }
      for (std::size_t k = 0; k < walls.size(); ++k) {
        const auto [q, w] = joint_.overlap(k, until);
        walls[k].q = q, walls[k].w = w;
      }
      x = end.x, v = end.v;
      passed = until < left ? passed + until : motion.duration;
    }
    for (std::size_t k = 0; k < walls.size(); ++k) {
      y_[in_contact_[k]] = position_of_wall(in_contact_[k]) + walls[k].q;
      w_[in_contact_[k]] = walls[k].w;
    }
  }
  // Updates the nearest miss of the i-th mass in a piece of its flight from y_ and w_. next(sign, from): the
  // first time from `from` on at which sign times y' falls through zero; position(time): y.
  template <class Next, class Position>
  void look_for_misses(std::size_t i, Next&& next, Position&& position) {
    const double clearance = of_.dampers[i].clearance;
    double sign = y_[i] == 0 ? 1 : y_[i] == clearance ? -1 : w_[i] >= 0 ? 1 : -1, from = 0;
    while (const std::optional<double> time = next(sign, from)) {
      const double y = position(*time), gap = sign > 0 ? clearance - y : y;
      if (!(all_.nearest_miss && *all_.nearest_miss <= gap)) all_.nearest_miss = gap;
      sign = -sign;
      from = *time;
    }
  }

  const VariationalCoefficients& of_;
  const RecordedRun& run_;
  AlongRun* along_;
  const Changes& changes_;
  const std::function<void()>& after_step_;
  std::vector<ContactInterval> intervals_;
  std::size_t next_interval_ = 0, next_impact_ = 0;
  double x_, v_;
  // y is not followed without the nearest miss, nor y' with compliant walls, where no matrix depends on them.
  std::vector<double> y_, w_;
  std::vector<int> wall_of_;                 // ContactInterval::away of masses in contact, else 0
  std::vector<std::size_t> end_of_contact_;  // ContactInterval::last of these
  std::vector<std::size_t> in_contact_;
  std::vector<EventOfMass> event_;            // at rigid walls
  ChangeOfState rates_before_, rates_after_;  // F^- and F^+ of that event
  std::vector<MassAtWall<double>> at_walls_;
  ChangeOfState shifted_;
  bool continued_ = false;  // no event came before this motion: flights go on
  std::vector<FlightStart<double>> starts_;
  JointContact<double, Forcing<double>> joint_;
  Search<double> search_{2};
  Carried all_;
};

}  // namespace

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
