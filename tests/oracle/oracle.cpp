#include "oracle.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <utility>

#include "reference.hpp"

// Of libquadmath, whose header clang does not find.
extern "C" {
oracle::Quad sinq(oracle::Quad);
oracle::Quad cosq(oracle::Quad);
oracle::Quad sqrtq(oracle::Quad);
oracle::Quad logq(oracle::Quad);
oracle::Quad acosq(oracle::Quad);
int quadmath_snprintf(char*, std::size_t, const char*, ...);
}

namespace oracle {
namespace {

using impact_damper::Calibration;
using impact_damper::Wall;

// A step is this long in units of the motion's rate; then term n is at most 4^n/n! of the state.
constexpr double step_by_rate = 4;
constexpr double negligible_term = 1e-36;
// A coefficient below this part of its polynomial's size is zero but for rounding.
const Quad zero_within_rounding = Quad(1e-29L);
// Events nearer to each other than this, times 1 + t, are one instant.
const Quad one_instant = Quad(1e-28L);

// The motion of a contact without its fast mode: d = place . (x, v, f, f'), s = speed . (x, v, f, f').
using Row = std::array<Quad, 4>;
struct SlowMotion {
  Row place{}, speed{};
};

struct Damper {
  Quad nu, e, clearance;
  int side = 1;                         // from which wall d is counted: +1 left, -1 right
  Quad d = 0, s = 0;                    // distance from it, velocity away from it
  bool stuck = false;                   // at rest in the cavity: pressed to a rigid wall or held by friction
  std::optional<std::size_t> contact;   // while stuck on a rigid wall or in contact: its own
  Polynomial path;                      // d in this step
  std::vector<std::size_t> chattering;  // impacts on this wall since it was met or left
  Quad rest = 0;  // how long the rest of the chattering takes that has been taken at once
  // Compliant walls: their force on the damper, away from them, is -nu (damping s + stiffness d) in contact.
  bool in_contact = false;
  bool pushes = true;  // the primary mass, too
  Quad stiffness = 0, damping = 0;
  std::optional<std::size_t> impact;  // that began the contact
  Polynomial push;                    // h^2 resistance in this step
  SlowMotion slow;
  Quad friction = 0, static_friction = 0, drag = 0;
  int slides = 0;        // where s is zero: the sign of the speed that follows
  bool lets_go = false;  // what holds it has just been exceeded
  int direction() const { return s != 0 ? sign_of(s) : slides; }
  bool is_resisted() const { return in_contact || friction != 0 || drag != 0; }
  // The force on it towards the wall, divided by nu, that its motion in the cavity causes.
  Quad resistance(Quad speed, Quad place, int sliding) const {
    Quad sum = 0;
    if (friction != 0 || drag != 0) sum = friction * sliding + drag * speed;
    if (in_contact) sum += damping * speed + stiffness * place;
    return sum;
  }
  Wall wall() const { return side > 0 ? Wall::left : Wall::right; }
  bool rests() const { return d == 0 && s == 0; }
};

int leading(const Polynomial& p) {  // the first coefficient that is more than rounding; -1: none
  const Quad least = p.sum_of_magnitudes() * zero_within_rounding;
  for (int n = 0; n <= p.degree; ++n)
    if (magnitude(p.at[n]) > least) return n;
  return -1;
}
int leading_sign(const Polynomial& p) {
  const int first = leading(p);
  return first < 0 ? 0 : sign_of(p.at[first]);
}
void clear_leading(Polynomial& p) {
  const int first = leading(p);
  for (int n = 0; n < first; ++n) p.at[n] = 0;
}
// The roots in (0, 1] but for those that the motion begins with.
std::vector<Root> roots_after_start(const Polynomial& p) {
  int first = 0;
  while (first < p.degree && p.at[first] == 0) ++first;
  if (2 * magnitude(p.at[first]) > p.sum_of_magnitudes() * (1 + zero_within_rounding)) return {};
  return changes_of_sign(first == 0 ? p : divided_by_power(p, first));
}
Quad first_root(const Polynomial& p, int direction) {  // 2: none
  for (const Root& root : roots_after_start(p))
    if (root.direction == direction) return root.s;
  return 2;
}

class Integrator {
 public:
  explicit Integrator(const Question& question)
      : question_(question),
        compliant_(question.walls == Walls::compliant),
        components_(has_components(question.scene)) {}

  Answer run() {
    prepare();
    for (Damper& each : dampers_)
      if (compliant_ && each.d < 0) open_contact(each);
    answer_.initial = energy();
    for (std::size_t i = 0; i < dampers_.size(); ++i) answer_.dampers[i].initial = kinetic(dampers_[i]);
    note_peak(0, x_);
    if (!compliant_) impact();  // of those that begin at a wall with a speed into it
    if (compliant_)
      for (Damper& each : dampers_)
        if (each.d == 0 && each.s < 0) touch(each);
    while (!done_ && t_ < until_) advance();
    answer_.end_time = t_;
    answer_.final = energy();
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
      answer_.dampers[i].final = kinetic(dampers_[i]);
      leave(dampers_[i], 0);
    }
    return std::move(answer_);
  }

 private:
  bool alone() const { return question_.scene.dampers.size() == 1; }
  // Several dampers' equal numbers of one kind get equal noise.
  Quad noisy(Quad number, std::uint64_t kind) const {
    if (question_.noise == 0) return number;
    const std::uint64_t value = alone() ? 0 : std::bit_cast<std::uint64_t>(double(number));
    reference::Random random(value ^ (question_.seed << 32) ^ kind);
    random.bits();
    return number * (1 + Quad(question_.noise) * Quad(random.uniform(-1, 1)));
  }

  void prepare() {
    const auto& scene = question_.scene;
    zeta_ = noisy(scene.damping_ratio, 1);
    f0_ = noisy(scene.force_amplitude, 2);
    omega_ = noisy(scene.force_frequency, 3);
    x_ = noisy(scene.x0, 4);
    v_ = noisy(scene.v0, 5);
    weight_ = noisy(scene.weight, 12);
    until_ = scene.until_time ? Quad(*scene.until_time) : Quad(1e30L);
    for (const impact_damper::SceneDamper& each : scene.dampers) {
      Damper damper;
      damper.nu = noisy(each.mass_ratio, 6);
      damper.e = each.restitution == 1 ? Quad(1) : noisy(each.restitution, 7);
      // Those as far from their right walls, with other clearances, reach these at one instant, too.
      const Quad from_left = noisy(each.y0, 8), from_right = noisy(Quad(each.clearance) - each.y0, 9);
      damper.clearance = alone() ? Quad(each.clearance) : from_left + from_right;
      damper.side = from_left <= from_right ? 1 : -1;
      damper.d = damper.side > 0 ? from_left : from_right;
      damper.s = damper.side * noisy(each.w0, 10);
      const auto& first = scene.dampers[0];
      const bool other_damper = question_.fault == Fault::wall_damper_of_first,
                 other_stiffness = question_.fault == Fault::stiffness_of_first;
      damper.stiffness = noisy((other_stiffness ? first : each).wall_stiffness, 11) / damper.nu;
      const Quad e = other_damper ? Quad(first.restitution) : damper.e;
      Quad ratio = 1;
      if (e > 0) {
        const Quad pi = acosq(-1), log = -logq(e);
        ratio = log / sqrtq(pi * pi + log * log);
      }
      if (question_.calibration == Calibration::two_body) ratio /= sqrtq(1 + damper.nu);
      damper.damping = 2 * sqrtq(damper.stiffness) * ratio;
      damper.friction = noisy(each.friction, 13);  // one kind, so that equal ones remain equal
      damper.static_friction = noisy(std::max(each.friction, each.static_friction), 13);
      damper.drag = noisy(each.drag, 14);
      damper.pushes = question_.fault == Fault::wall_force_left_out
                          ? dampers_.size() + 1 < scene.dampers.size()
                          : question_.fault != Fault::own_contact_only || dampers_.empty();
      dampers_.push_back(damper);
    }
    if (question_.fault == Fault::clearance_ignored) dampers_.back().clearance = dampers_[0].clearance;
    answer_.dampers.resize(dampers_.size());
  }

  static Quad square(Quad x) { return x * x; }
  Quad kinetic(const Damper& each) const { return each.nu * square(v_ + each.side * each.s) / 2; }
  Energy energy() const {
    Energy now{v_ * v_ / 2, x_ * x_ / 2, 0, (v_ * v_ + x_ * x_) / 2, 0};
    for (const Damper& each : dampers_) {
      now.kinetic += kinetic(each);
      now.paper += each.nu * (v_ * v_ + each.s * each.s) / 2;
      if (each.in_contact) now.wall += each.nu * each.stiffness * each.d * each.d / 2;
      now.weight += each.nu * weight_ * (x_ + (each.side > 0 ? each.d : each.clearance - each.d));
    }
    return now;
  }

  Quad joined_mass() const {
    Quad mass = 1, most = 0;
    for (const Damper& each : dampers_)
      if (each.stuck) mass += each.nu, most = each.nu;
    return question_.fault == Fault::own_mass_only ? 1 + most : mass;
  }

  // On all that moves together with the primary mass.
  Quad force() const {
    Quad sum = (f0_ != 0 ? f0_ * sinq(omega_ * t_) : Quad(0)) - x_ - 2 * zeta_ * v_;
    for (const Damper& each : dampers_)
      if (!each.stuck) sum += each.side * each.nu * each.resistance(each.s, each.d, each.direction());
    return sum - weight_ * (joined_mass() - 1);
  }
  // x'' + gamma, by which what moves with the primary mass presses walls.
  Quad acceleration() const { return force() / joined_mass() + weight_; }
  // A speed or a force that is rounding of what else moves.
  Quad rounded() const {
    Quad sum = magnitude(v_) + magnitude(x_) + magnitude(f0_) + weight_;
    for (const Damper& each : dampers_) sum += each.static_friction;
    return sum * zero_within_rounding;
  }

  // An upper bound of how fast the state can change, in the norm max(|x|, |v|, |f|, |f'|/omega, rate |d|,
  // |s|) with `rate` that of the undamped contacts.
  Quad rate() const {
    Quad most = 0, own = 0, sum = 0, damping = 0;
    for (const Damper& each : dampers_) {
      if (each.stuck || !each.is_resisted() || slow_) continue;
      const bool pressed = each.in_contact;
      const Quad by_speed = each.drag + (pressed ? each.damping : 0), by_place = pressed ? each.stiffness : 0;
      most = std::max(most, by_place), own = std::max(own, by_speed);
      sum += each.nu * by_place, damping += each.nu * by_speed;
    }
    const Quad bound = (slow_ ? 3 : 2) + 2 * zeta_ + sqrtq(most + sum) + own + damping;
    return f0_ != 0 ? std::max(bound, omega_) : bound;
  }

  // x = x(s), t = t + h s, by Taylor's coefficients up to the order that leaves nothing.
  void expand(Quad h) {
    h_ = h;
    const double reach = double(h * rate());
    int order = 4;
    for (double term = std::pow(reach, 4) / 24; term > negligible_term && order < Polynomial::most - 3;
         ++order)
      term *= reach / (order + 1);
    for (Polynomial* each : {&px_, &pv_, &pf_, &pa_}) each->degree = order, each->at.fill(0);
    auto &x = px_.at, &v = pv_.at, &f = pf_.at, &a = pa_.at;
    if (f0_ != 0) {
      f[0] = f0_ * sinq(omega_ * t_);
      f[1] = f0_ * cosq(omega_ * t_) * omega_ * h;
      for (int n = 0; n + 2 <= order + 1; ++n)
        f[n + 2] = -(omega_ * h) * (omega_ * h) * f[n] / ((n + 1) * (n + 2));
    }
    x[0] = x_, x[1] = v_ * h;
    for (Damper& each : dampers_) {
      for (Polynomial* one : {&each.path, &each.push}) one->degree = order, one->at.fill(0);
      each.path.at[0] = each.d, each.path.at[1] = each.s * h;
    }
    const Quad mass = joined_mass(), by_mass = h * h / mass, viscous = 2 * zeta_ * h / mass;
    const Quad part = 1 / mass;
    for (int n = 0; n <= order; ++n) {
      a[n] = by_mass * (f[n] - x[n]) - viscous * ((n + 1) * x[n + 1]);
      if (n == 0) a[0] -= by_mass * weight_ * (mass - 1);
      for (Damper& each : dampers_) {
        if (each.stuck || !each.is_resisted()) continue;
        auto& d = each.path.at;
        Quad speed = (n + 1) * d[n + 1] / h;
        if (slow_) {
          const Row state{x[n], (n + 1) * x[n + 1] / h, f[n], (n + 1) * f[n + 1] / h};
          d[n] = product(each.slow.place, state), speed = product(each.slow.speed, state);
        }
        each.push.at[n] = h * h * each.resistance(speed, d[n], n == 0 ? each.direction() : 0);
        if (each.pushes) a[n] += each.side * each.nu * part * each.push.at[n];
      }
      x[n + 2] = a[n] / ((n + 1) * (n + 2));
      v[n] = (n + 1) * x[n + 1] / h;
      for (Damper& each : dampers_)
        if (!each.stuck && !(slow_ && each.in_contact))
          each.path.at[n + 2] =
              -(each.side * (n == 0 ? a[0] + h * h * weight_ : a[n]) + each.push.at[n]) / ((n + 1) * (n + 2));
    }
    // Where the motion begins at a wall, that is exact, and its leading coefficients are zero or more than
    // rounding.
    for (Damper& each : dampers_)
      if (each.d == 0) clear_leading(each.path);
  }
  Quad speed_of(const Damper& each, Quad s) const {
    Quad slope = 0;
    for (int n = each.path.degree; n > 0; --n) slope = slope * s + n * each.path.at[n];
    return slope / h_;
  }

  static Quad product(const Row& a, const Row& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  }
  // The slow motions of all that are in contact, as the fixed point of their equations, which contracts by
  // the ratio of slow and fast rates; false if it does not.
  bool find_slow_motions() {
    Quad mass = 1;
    for (Damper& each : dampers_)
      if (each.in_contact) mass += each.nu, each.slow = {};
    Row acceleration{};  // x'', of the driven motion
    // d/dt of row . (x, v, f, f'), where x' = v, v' = acceleration, f'' = -omega^2 f.
    const auto rate_of = [&](const Row& row) {
      Row rate;
      for (int i = 0; i < 4; ++i) rate[i] = row[1] * acceleration[i];
      rate[1] += row[0], rate[3] += row[2], rate[2] -= row[3] * omega_ * omega_;
      return rate;
    };
    Quad change = 1;
    for (int round = 0; round < 80; ++round) {
      acceleration = {-1, -2 * zeta_, 1, 0};
      for (const Damper& each : dampers_)
        if (each.in_contact)
          for (int i = 0; i < 4; ++i)
            acceleration[i] += each.side * each.nu *
                               (each.damping * each.slow.speed[i] + each.stiffness * each.slow.place[i]);
      // d'' of each; x'' (1 + sum of nu) is what drives, less what moves the masses relative to the walls.
      std::vector<Row> relative;
      Row driven{-1, -2 * zeta_, 1, 0};
      for (Damper& each : dampers_) {
        if (!each.in_contact) continue;
        each.slow.speed = rate_of(each.slow.place);
        relative.push_back(rate_of(each.slow.speed));
        for (int i = 0; i < 4; ++i) driven[i] -= each.side * each.nu * relative.back()[i];
      }
      const Quad last = std::exchange(change, 0);
      std::size_t n = 0;
      for (Damper& each : dampers_) {
        if (!each.in_contact) continue;
        Quad size = 0, its_change = 0;
        for (int i = 0; i < 4; ++i) {
          const Quad push = -(each.side * driven[i] / mass + relative[n][i]),
                     place = (push - each.damping * each.slow.speed[i]) / each.stiffness;
          its_change += magnitude(place - each.slow.place[i]);
          size += magnitude(place);
          each.slow.place[i] = place;
        }
        if (!(size < 1e30L)) return false;
        change = std::max(change, its_change / size);
        ++n;
      }
      if (change < Quad(1e-32L)) {
        for (Damper& each : dampers_)
          if (each.in_contact) each.slow.speed = rate_of(each.slow.place);
        return true;
      }
      if (round > 8 && !(change < last)) return false;
    }
    return false;
  }

  // The fast modes of all contacts have died out within rounding of the force: go on without them.
  void drop_fast_modes() {
    if (slow_) return follow_slow_motions();
    if (question_.fault != Fault::none || components_) return;
    std::vector<int> sides;
    Quad mass = 1, least = -1;  // least: of how fast fast modes die out
    for (const Damper& each : dampers_) {
      sides.push_back(each.in_contact ? each.side : 0);
      if (!each.in_contact) continue;
      if (!(each.d < 0)) return;
      mass += each.nu;
      if (least < 0 || each.damping < least) least = each.damping;
    }
    // What has not yet fallen to 1e-9 need not be looked for.
    if (!(least * mass * (t_ - changed_) > 40)) return;
    if (sides != sides_) {
      sides_ = sides;
      slow_motions_found_ = find_slow_motions();
    }
    if (!slow_motions_found_) return;
    const Row state = driving_state();
    for (const Damper& each : dampers_) {
      if (!each.in_contact) continue;
      const Quad off =
          each.stiffness * magnitude(each.d - product(each.slow.place, state)) +
          (each.damping + sqrtq(each.stiffness)) * magnitude(each.s - product(each.slow.speed, state));
      if (off > Quad(1e-29L) * (magnitude(x_) + magnitude(v_) + magnitude(state[2]))) return;
    }
    slow_ = true;
    follow_slow_motions();
  }
  void follow_slow_motions() {
    const Row state = driving_state();
    for (Damper& each : dampers_)
      if (each.in_contact) each.d = product(each.slow.place, state), each.s = product(each.slow.speed, state);
  }
  Row driving_state() const { return {x_, v_, f0_ * sinq(omega_ * t_), f0_ * cosq(omega_ * t_) * omega_}; }

  int number_of(const Damper& each) const { return int(&each - dampers_.data()); }
  void open_contact(Damper& each) {
    each.contact = answer_.contacts.size();
    const bool by_friction = at_rigid_wall(each) && magnitude(acceleration()) <= each.static_friction;
    answer_.contacts.push_back({t_ + each.rest, t_, number_of(each), each.wall(), by_friction});
    each.rest = 0;
    (compliant_ ? each.in_contact : each.stuck) = true;
    slow_ = false;
    changed_ = t_;
  }
  // A compliant wall is met.
  void touch(Damper& each) {
    each.impact.reset();
    // Only at the beginning a contact needs no impact; one damper comes to rest on a wall by rounding only,
    // or by friction.
    if (each.s < 0 || (t_ > 0 && (!alone() || each.static_friction > 0))) {
      each.impact = answer_.impacts.size();
      answer_.impacts.push_back({t_, number_of(each), each.wall(), each.side * each.s, x_, 0});
    }
    open_contact(each);
  }
  void leave(Damper& each, Quad end_speed) {
    if (each.contact) {
      answer_.contacts[*each.contact].end = t_;
      answer_.contacts[*each.contact].end_speed = end_speed;
      each.chattering.clear();
      slow_ = false;
      changed_ = t_;
    }
    each.stuck = each.in_contact = false;
    each.contact.reset();
    each.impact.reset();
    each.rest = 0;
  }
  void close_chattering(Damper& each) {
    for (const std::size_t i : each.chattering) answer_.impacts[i].accumulation = t_ + each.rest;
    each.chattering.clear();
  }

  // A wall keeps a mass at rest from moving one way.
  bool at_rigid_wall(const Damper& each) const { return !compliant_ && each.d == 0; }
  // h^2 times the force beyond static friction that would make a mass at rest slide in this direction: what
  // accelerates it relative to the cavity is -(x'' + gamma) and its wall.
  Polynomial excess(const Damper& each, int direction) const {
    Polynomial p = pa_;
    for (int n = 0; n <= p.degree; ++n) p.at[n] *= -each.side * direction;
    const Quad wall = each.in_contact ? each.stiffness * each.d : Quad(0);
    p.at[0] -= h_ * h_ * (direction * (each.side * weight_ + wall) + each.static_friction);
    return p;
  }
  // Of those that are to stay at rest the one that does it least; none if all do. Whether the rest do depends
  // on it, as it no longer is joined to the primary mass.
  Damper* first_to_slide() {
    const Quad second = acceleration(), nearly = Quad(1e14L) * rounded();
    Damper* first = nullptr;
    Quad most = nearly;
    bool undecided = false;
    for (Damper& each : dampers_) {
      if (!each.stuck) continue;
      const Quad wall = each.in_contact ? each.stiffness * each.d : Quad(0);
      const Quad pull = -(each.side * second + wall);
      const Quad beyond = (at_rigid_wall(each) ? pull : magnitude(pull)) - each.static_friction;
      if (beyond > most) first = &each, most = beyond, each.slides = sign_of(pull);
      undecided = undecided || beyond >= -nearly;
    }
    if (first || !undecided) return first;
    expand(step_by_rate / rate());  // what follows decides
    for (Damper& each : dampers_)
      for (const int direction : {+1, -1}) {
        if (!each.stuck || (direction < 0 && at_rigid_wall(each))) continue;
        const int sign = leading_sign(excess(each, direction));
        each.slides = direction;
        if (sign > 0 || (sign == 0 && each.static_friction == 0)) return &each;
      }
    return nullptr;
  }
  // One that has been let go from rest, in a direction in which nothing any longer moves it against its
  // friction, since another one has been let go after it: it is held again.
  Damper* first_to_hold() {
    const Quad second = acceleration(), nearly = Quad(1e14L) * rounded();
    for (Damper& each : dampers_) {
      if (each.stuck || each.s != 0 || each.slides == 0 || each.static_friction == 0) continue;
      const Quad wall = each.in_contact ? each.stiffness * each.d : Quad(0);
      if (each.slides * -(each.side * second + wall) < each.friction - nearly) return &each;
    }
    return nullptr;
  }
  // Those at rest: do they stay so, on a rigid wall or held by friction?
  void decide() {
    for (Damper& each : dampers_)  // a speed that is rounding of what goes on: what follows decides
      if (each.d == 0 && !each.in_contact && magnitude(each.s) <= rounded()) each.s = 0;
    for (Damper& each : dampers_)
      each.stuck = each.s == 0 && !std::exchange(each.lets_go, false) &&
                   (each.static_friction > 0 || at_rigid_wall(each));
    for (std::size_t changes = 0; changes < 16 * dampers_.size(); ++changes) {
      if (Damper* const slides = first_to_slide())
        slides->stuck = false;
      else if (Damper* const holds = first_to_hold())
        holds->stuck = true;
      else
        break;
    }
    const auto is_free = [](const Damper& each) { return each.rests() && !each.in_contact && !each.stuck; };
    if (compliant_) {
      if (std::none_of(dampers_.begin(), dampers_.end(), is_free)) return;
      expand(step_by_rate / rate());
      for (Damper& each : dampers_)
        if (is_free(each) && leading_sign(each.path) < 0) touch(each);
      return;
    }
    for (Damper& each : dampers_) {
      if (!each.rests()) continue;
      if (each.stuck && !each.contact) {
        // A chattering is complete, too, once its bounces are slower than rounding; friction has slowed them
        // since the last impact.
        if (!each.chattering.empty() &&
            (each.rest > 0 || components_ ||
             each.e * magnitude(answer_.impacts[each.chattering.back()].relative_velocity) <= 2 * rounded()))
          close_chattering(each);
        open_contact(each);
      } else if (!each.stuck) {
        leave(each, 0);
      }
    }
  }

  void advance() {
    if (++answer_.steps > question_.most_steps ||
        std::int64_t(answer_.impacts.size()) > question_.most_impacts)
      return stop(Stop::effort);
    decide();
    if (compliant_) drop_fast_modes();
    Quad h = step_by_rate / rate();
    const Quad second = acceleration();
    for (const Damper& each : dampers_) {  // what will soon be at a wall needs no long step
      if (each.stuck || each.in_contact) continue;
      const double push = double(each.side * second + each.resistance(each.s, each.d, each.direction())),
                   speed = double(each.s);
      const double way = double(push > 0 ? each.d : each.clearance - each.d),
                   towards = push > 0 ? -speed : speed;
      const double time =
          (std::sqrt(towards * towards + 2 * std::fabs(push) * std::max(way, 0.0)) - towards) /
          std::fabs(push);
      if (time > 0) h = std::min(h, Quad(2 * time));
    }
    const bool last = h >= until_ - t_;
    if (last) h = until_ - t_;
    expand(h);

    // When each meets its wall or leaves it, meets the other one, comes to rest, and begins to slide.
    std::vector<Quad> near(dampers_.size(), 2), far = near, halt = near, release = near;
    Quad end = 1;
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
      Damper& each = dampers_[i];
      if (each.stuck) {
        for (const int direction : {+1, -1}) {
          if (direction < 0 && at_rigid_wall(each)) continue;
          Polynomial beyond = excess(each, direction);
          clear_leading(beyond);
          if (question_.fault == Fault::released_apart) beyond.at[0] += h * h * Quad(1e-6L);
          const Quad exceeded = first_root(beyond, +1);
          if (exceeded < release[i]) release[i] = exceeded, each.slides = direction;
        }
        end = std::min(end, release[i]);
        continue;
      }
      if (each.static_friction > 0) {
        Polynomial speed = derivative(each.path);
        if (each.s == 0) clear_leading(speed);
        halt[i] = first_root(speed, -each.direction());
        end = std::min(end, halt[i]);
      }
      near[i] = first_root(each.path, each.in_contact ? +1 : -1);
      if (each.in_contact) {
        if (question_.fault == Fault::let_go_by_force) near[i] = std::min(near[i], first_root(each.push, +1));
        end = std::min(end, near[i]);
        continue;
      }
      // A speed away from a wall that is rounding of what leads it back.
      if (each.d == 0 && leading_sign(each.path) < 0) near[i] = 0;
      Polynomial gap = each.path;
      gap.at[0] -= each.clearance;
      far[i] = first_root(gap, +1);
      end = std::min({end, near[i], far[i]});
    }
    const Quad together = std::min(end + one_instant * (1 + t_) / h, Quad(1));  // 2: none
    end = observe(end);
    work(end);
    t_ = last && end == 1 ? until_ : t_ + h * end;
    x_ = px_(end), v_ = pv_(end);
    const Quad mass = joined_mass();
    bool met = false, event = false;
    std::vector<bool> meets(dampers_.size(), false);  // a compliant wall
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
      Damper& each = dampers_[i];
      if (each.stuck) {
        if (done_ || release[i] > together) continue;
        event = each.lets_go = true;
        if (at_rigid_wall(each)) leave(each, mass * magnitude(derivative(pa_)(end)) / (h * h * h));
        continue;
      }
      each.d = each.path(end);
      each.s = speed_of(each, end);
      if (done_) continue;
      if (halt[i] <= together) {  // on a wall, if within rounding of it
        event = true;
        each.s = 0;
        const auto is_zero = [](Quad value, Quad size) {
          return magnitude(value) <= size * zero_within_rounding;
        };
        if (is_zero(each.d, each.path.sum_of_magnitudes())) near[i] = end;
        if (is_zero(each.clearance - each.d, each.clearance)) far[i] = end;
      }
      if (each.in_contact) {
        if (near[i] > together) continue;
        each.d = 0, each.s = std::max(each.s, Quad(0));
        leave(each, each.s);
        event = true;
        continue;
      }
      if (near[i] <= together || far[i] <= together) {
        if (far[i] <= together) {
          each.side = -each.side, each.s = -each.s;
          each.chattering.clear();
        }
        each.d = 0;
        met = true;
        if (!(each.s < -rounded())) each.s = 0;  // what follows decides
        meets[i] = compliant_ && each.s < 0;
      } else if (!(each.d >= Quad(-1e-12L) && each.d <= each.clearance + Quad(1e-12L))) {
        if (question_.noise == 0) throw std::logic_error("the oracle has lost a damper");
        return stop(Stop::effort);  // changed by its noise to beyond a wall
      }
    }
    if (done_) return;
    // Not within a contact: noise would keep its fast mode alive for ever.
    if (met || event || (alone() && (!dampers_[0].in_contact || slow_))) perturb();
    if (compliant_) {
      for (std::size_t i = 0; i < dampers_.size(); ++i)
        if (meets[i]) touch(dampers_[i]);
    } else if (met) {
      impact();
      for (Damper& each : dampers_) each.lets_go = false;
    }
  }
  void stop(Stop why) {
    answer_.stop = why;
    done_ = true;
  }

  void perturb() {
    if (question_.noise == 0) return;
    const auto event = std::uint64_t(++events_) << 8;
    x_ = noisy(x_, event + 11);
    v_ = noisy(v_, event + 12);
    if (alone()) {
      t_ = noisy(t_, event + 17);
      Damper& one = dampers_[0];
      if (!one.stuck) one.s = noisy(one.s, event + 13), one.d = noisy(one.d, event + 14);
      return;
    }
    const Quad shift = noisy(1, event + 16) - 1;
    for (Damper& each : dampers_) {
      if (each.stuck) continue;
      each.s = noisy(each.s, event + 13);
      // All in one direction, too, so that those as far from the same wall remain so; not near a wall.
      if (each.s < 0 || each.in_contact) each.d = noisy(each.d, event + 14 + (each.side > 0));
      if (each.d > Quad(1e-3L) && each.clearance - each.d > Quad(1e-3L)) each.d += each.side * shift;
    }
  }

  // The impulses of this instant, of all that are at a wall and do not leave it; and of those that were
  // leaving it and that the wall overtakes.
  void impact() {
    for (;;) {
      std::vector<Damper*> all;
      for (Damper& each : dampers_)
        if (each.d == 0 && each.s <= 0) all.push_back(&each);
      if (std::none_of(all.begin(), all.end(), [](const Damper* each) { return each->s < 0; })) return;
      if (question_.fault == Fault::not_released)
        std::erase_if(all, [](const Damper* each) { return each->stuck; });
      if (question_.fault == Fault::one_after_another)
        all = {*std::find_if(all.begin(), all.end(), [](const Damper* each) { return each->s < 0; })};
      strike(all);
    }
  }

  void strike(const std::vector<Damper*>& all) {
    const auto e_of = [&](const Damper& each) {
      return question_.fault == Fault::restitution_of_first && each.side < 0 ? dampers_[0].e : each.e;
    };
    // p_i / nu_i = max(0, a_i J - (1 + e_i) s_i), and the residual J + sum a_i p_i rises with J.
    const auto impulse = [&](const Damper& each, Quad jump) {
      return std::max(Quad(0), each.side * jump - (1 + e_of(each)) * each.s);
    };
    const auto residual = [&](Quad jump) {
      Quad sum = jump;
      for (const Damper* each : all) sum += each->side * each->nu * impulse(*each, jump);
      return sum;
    };
    std::vector<Quad> kinks;
    for (const Damper* each : all) kinks.push_back(each->side * (1 + e_of(*each)) * each->s);
    std::sort(kinks.begin(), kinks.end());
    kinks.insert(kinks.begin(), kinks.front() - 1);
    kinks.push_back(kinks.back() + 1);
    std::size_t k = 1;
    while (k + 1 < kinks.size() && residual(kinks[k]) < 0) ++k;
    // Linear between kinks k - 1 and k: there those are active that are so in the middle.
    const Quad middle = (kinks[k - 1] + kinks[k]) / 2;
    Quad mass = 1, driven = 0;
    for (const Damper* each : all)
      if (impulse(*each, middle) > 0) {
        mass += each->nu;
        driven += each->side * each->nu * (1 + e_of(*each)) * each->s;
      }
    const Quad jump = driven / mass, second = magnitude(acceleration());
    v_ += jump;
    // What is not at a wall sees the jump, too: its velocity relative to the cavity. No friction holds it.
    for (Damper& each : dampers_)
      if (std::find(all.begin(), all.end(), &each) == all.end() && !(each.stuck && each.d == 0))
        each.s -= each.side * jump;
    for (Damper* each : all) {
      const Quad before = each->s, e = e_of(*each);
      const bool active = impulse(*each, middle) > 0;
      const Quad impulse_by_mass = active ? impulse(*each, jump) : Quad(0);
      each->s = active ? -e * before : before - each->side * jump;
      if (before < 0) {
        const Quad loss = each->nu * impulse_by_mass * (1 - e) * -before / 2;
        each->chattering.push_back(answer_.impacts.size());
        answer_.impacts.push_back({t_,
                                   number_of(*each),
                                   each->wall(),
                                   each->side * before,
                                   x_,
                                   loss,
                                   {},
                                   active,
                                   second + each->friction});
      }
    }
    for (Damper* each : all)
      if (each->s > 0) leave(*each, 0);
    std::vector<Damper*> last;  // of a chattering
    for (Damper* each : all)
      if (chattering_ends(*each, e_of(*each))) last.push_back(each);
    if (!last.empty()) join(last);
  }

  // Under the relative acceleration -a the rest of a chattering lasts 2 s / (a (1 - e)), but for the part by
  // which a changes in it: by itself and, through the damper, by the impacts. It is taken once that is beyond
  // quadruple rounding, but impacts that an engine may list, however little they matter, are listed here,
  // too. With friction, weight or drag nothing is taken at once: bounces end where they are slower than
  // rounding (decide()).
  bool chattering_ends(Damper& each, Quad e) {
    if (components_) return false;
    const Quad a = each.side * force() / joined_mass();
    if (!(each.s > 0 && a > 0 && e < 1)) return false;
    if (question_.fault == Fault::chattering_cut_short)
      return each.s <= Quad(1e-4L) && each.s <= a * Quad(1e-8L);
    const Quad rest = 2 * each.s / (a * (1 - e));
    if (rest > Quad(1e-15L) * (1 + t_)) return false;
    expand(step_by_rate / rate());
    Quad change = 2 * zeta_ * each.nu * (1 + e) * each.s / ((1 + each.nu) * (1 - e)), power = rest / h_;
    for (int n = 1; n <= 6; ++n, power *= rest / h_) change += magnitude(pa_.at[n]) / (h_ * h_) * power;
    if (change > a * Quad(1e-10L) || rest * change > a * zero_within_rounding * (1 + t_)) return false;
    each.rest = rest;
    return true;
  }
  // The rest of a chattering: they give their momentum to the primary mass and what rests on the same wall.
  // Joined at once they come to where they are after it, but for s times its length.
  void join(const std::vector<Damper*>& last) {
    const int side = last.front()->side;
    Quad mass = 1, driven = 0;
    for (const Damper& each : dampers_)
      if (each.side == side && each.rests()) mass += each.nu;
    for (const Damper* each : last) mass += each->nu, driven += each->nu * each->s;
    const Quad jump = driven / mass;
    for (Damper* each : last) {
      answer_.dampers[number_of(*each)].chatter_loss += each->nu * each->s * (each->s - jump) / 2;
      each->s = 0;
    }
    if (question_.fault == Fault::chattering_cut_short) return;
    v_ += side * jump;
    for (Damper& each : dampers_)
      if (each.side != side || !each.rests()) each.s -= each.side * side * jump;
  }

  void work(Quad end) {
    for (Damper& each : dampers_) {
      const Quad damping = each.in_contact ? each.damping : Quad(0);
      DamperEnergy& its = answer_.dampers[number_of(each)];
      its.friction_loss += each.nu * each.friction * magnitude(each.path(end) - each.path.at[0]);
      if (damping == 0 && each.drag == 0) continue;
      const Polynomial slope = derivative(each.path);
      const Quad square = integral_of_product(slope, slope, end);
      its.drag_loss += each.nu * each.drag * square / h_;
      (each.impact ? answer_.impacts[*each.impact].loss : its.contact_loss) +=
          each.nu * damping * square / h_;
    }
    if (zeta_ != 0) answer_.viscous_work += 2 * zeta_ * h_ * integral_of_product(pv_, pv_, end);
    if (f0_ == 0) return;
    const Quad work = h_ * integral_of_product(pf_, pv_, end);
    answer_.forcing_work += work;
    answer_.turnover += magnitude(work);
  }

  void note_peak(Quad t, Quad x) {
    if (magnitude(x) > peak_) peak_ = magnitude(x), peak_time_ = t;
  }

  // Zero crossings, peaks and samples in (0, end]; returns where the run stops, else `end`.
  Quad observe(Quad end) {
    // The side to which x goes, where it begins at zero by its first coefficient that is not: an event often
    // coincides with a crossing.
    Polynomial x = px_;
    clear_leading(x);
    const int now = leading_sign(x);
    if (side_of_x_ == 0) side_of_x_ = now;
    std::vector<std::pair<Quad, bool>> seen;  // whether a crossing
    // A crossing that the last step's end left to this one, by a rounding.
    if (now != 0 && now != side_of_x_) seen.push_back({0, true});
    for (const Root& root : roots_after_start(x)) seen.push_back({root.s, true});
    for (const Root& root : roots_after_start(pv_)) seen.push_back({root.s, false});
    std::stable_sort(seen.begin(), seen.end(), [](auto& a, auto& b) { return a.first < b.first; });
    for (const auto& [s, crossing] : seen) {
      if (s > end) break;
      const Quad t = t_ + h_ * s;
      if (!crossing) {
        note_peak(t, px_(s));
        continue;
      }
      answer_.half_cycles.push_back({t, peak_time_, peak_, magnitude(pv_(s))});
      side_of_x_ = -side_of_x_;
      if (question_.scene.until_amplitude && peak_ < Quad(*question_.scene.until_amplitude)) {
        stop(Stop::amplitude);
        end = s;
        break;
      }
      peak_ = 0, peak_time_ = t;
    }
    note_peak(t_ + h_ * end, px_(end));
    for (; answer_.samples.size() < question_.samples.size();) {
      const Quad t = question_.samples[answer_.samples.size()];
      if (t > t_ + h_ * end) break;
      const Quad s = std::max(std::min((t - t_) / h_, end), Quad(0));
      Sample sample{px_(s), pv_(s), {}, {}};
      for (const Damper& each : dampers_) {
        const Quad d = each.path(s);
        sample.y.push_back(each.side > 0 ? d : each.clearance - d);
        sample.w.push_back(each.side * speed_of(each, s));
        sample.in_contact = sample.in_contact || each.in_contact;
      }
      answer_.samples.push_back(sample);
    }
    return end;
  }

  const Question& question_;
  bool compliant_, components_, done_ = false;
  Quad weight_ = 0, zeta_ = 0, f0_ = 0, omega_ = 0, until_ = 0;
  Quad t_ = 0, x_ = 0, v_ = 0;
  std::vector<Damper> dampers_;
  bool slow_ = false;  // all contacts are without their fast modes
  bool slow_motions_found_ = false;
  Quad changed_ = 0;        // when a contact last began or ended
  std::vector<int> sides_;  // of the contacts that slow motions were last looked for
  Quad h_ = 0;
  Polynomial px_, pv_, pf_, pa_;  // of the step: x, x', the force, h^2 x''
  int side_of_x_ = 0;
  Quad peak_ = 0, peak_time_ = 0;
  std::int64_t events_ = 0;
  Answer answer_;
};

}  // namespace

Answer answer_to(const Question& question) { return Integrator(question).run(); }

Quad Answer::impact_loss() const {
  Quad sum = 0;
  for (const Impact& each : impacts) sum += each.loss;
  return sum;
}
Quad Answer::sum(Quad DamperEnergy::*term) const {
  Quad sum = 0;
  for (const DamperEnergy& each : dampers) sum += each.*term;
  return sum;
}
Quad Answer::losses() const {
  return impact_loss() + sum(&DamperEnergy::contact_loss) + sum(&DamperEnergy::chatter_loss) +
         sum(&DamperEnergy::friction_loss) + sum(&DamperEnergy::drag_loss);
}
Quad Answer::residual() const {
  return initial.total() + forcing_work - final.total() - losses() - viscous_work;
}

std::string text(Quad number, int digits) {
  char out[96];
  quadmath_snprintf(out, sizeof out, "%.*Qg", digits, number);
  return out;
}

std::string lines_of(const Answer& answer) {
  struct Line {
    Quad time;
    std::string text;
  };
  std::vector<Line> lines;
  const bool several = answer.dampers.size() > 1;
  const auto name = [several](impact_damper::Wall wall, int damper) {
    return (wall == impact_damper::Wall::left ? "left" : "right") +
           (several ? ", damper " + std::to_string(damper) : "");
  };
  for (const Impact& each : answer.impacts)
    lines.push_back({each.time, "impact " + name(each.wall, each.damper) + " speed " +
                                    text(each.relative_velocity) + " at x " + text(each.displacement) +
                                    " loss " + text(each.loss, 12)});
  for (const Contact& each : answer.contacts) {
    lines.push_back({each.begin, "contact begins, " + name(each.wall, each.damper)});
    lines.push_back({each.end, "contact ends, " + name(each.wall, each.damper)});
  }
  for (std::size_t i = 0; i < answer.half_cycles.size(); ++i) {
    const HalfCycle& each = answer.half_cycles[i];
    lines.push_back({each.zero_crossing, "crossing, row " + std::to_string(i) + " amplitude " +
                                             text(each.amplitude) + " at " + text(each.peak_time)});
  }
  std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.time < b.time; });
  std::string all;
  for (const Line& line : lines) all += text(line.time) + "  " + line.text + "\n";
  const char* const stops[] = {"time", "amplitude", "effort"};
  all += text(answer.end_time) + "  end (" + stops[int(answer.stop)] + "), steps " +
         std::to_string(answer.steps) + "\n";
  all += "energy: initial " + text(answer.initial.total()) + " forcing " + text(answer.forcing_work) +
         " final " + text(answer.final.total()) + " viscous " + text(answer.viscous_work) +
         " impacts, friction, drag " + text(answer.losses()) + " residual " + text(answer.residual(), 3) +
         "\n";
  return all;
}

}  // namespace oracle
