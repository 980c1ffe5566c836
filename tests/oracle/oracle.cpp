#include "oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "reference.hpp"

// Of libquadmath, whose header clang does not find.
extern "C" {
oracle::Quad sinq(oracle::Quad);
oracle::Quad cosq(oracle::Quad);
oracle::Quad sqrtq(oracle::Quad);
oracle::Quad logq(oracle::Quad);
oracle::Quad acosq(oracle::Quad);
}

namespace oracle {
namespace {

using impact_damper::Calibration;
using impact_damper::Wall;

// A step is this long in units of the regime's rate; then term n is at most 4^n/n! of the state.
constexpr double step_by_rate = 4;
constexpr double negligible_term = 1e-36;

// Below this part of a polynomial's size a leading coefficient is zero: at a motion's start it decides to
// which side of the wall it goes, and where events coincide it is zero but for rounding.
const Quad zero_within_rounding = Quad(1e-29L);

enum class Regime { flight, contact, slow_contact, stuck };

// The state, seen from the wall at which q = 0: the cavity is q > 0. For the right wall all is mirrored.
struct State {
  Quad t = 0, x = 0, v = 0, q = 0, w = 0;
};

struct Parameters {
  Quad nu, e, zeta, k, f0, omega_f;
  Quad stiffness, damping;  // of the wall: F = damping q' + stiffness q
};

// What a step is made of: all is a polynomial in s, t = t0 + h s.
struct Step {
  Quad h;
  Polynomial x, v, q, w, f, acceleration;  // acceleration: h^2 x''
};

// The motion of a contact without its fast mode: q = position . (x, v, f, f'), w = velocity . (x, v, f, f').
// Found as the fixed point of its equations, which contracts by the ratio of slow and fast rates.
struct SlowManifold {
  std::array<Quad, 4> position{}, velocity{};
};

std::optional<SlowManifold> slow_manifold(const Parameters& p) {
  SlowManifold slow;
  const auto times_system = [&](const std::array<Quad, 4>& row) {
    // The slow system's matrix: x' = v, v' = nu F + f - x - 2 zeta v, f' = g, g' = -omega_f^2 f.
    std::array<Quad, 4> v_row{};
    for (int i = 0; i < 4; ++i)
      v_row[i] = p.nu * (p.damping * slow.velocity[i] + p.stiffness * slow.position[i]);
    v_row[0] -= 1, v_row[1] -= 2 * p.zeta, v_row[2] += 1;
    std::array<Quad, 4> product{};
    for (int i = 0; i < 4; ++i) product[i] = row[1] * v_row[i];
    product[1] += row[0];
    product[3] += row[2];
    product[2] -= row[3] * p.omega_f * p.omega_f;
    return product;
  };
  const std::array<Quad, 4> driven{1, 2 * p.zeta, -1, 0};
  Quad change = 1;
  for (int i = 0; i < 80; ++i) {
    const SlowManifold before = slow;
    slow.velocity = times_system(slow.position);
    const std::array<Quad, 4> acceleration = times_system(slow.velocity);
    Quad size = 0, last = change;
    change = 0;
    for (int j = 0; j < 4; ++j) {
      slow.position[j] =
          ((driven[j] - acceleration[j]) / (1 + p.nu) - p.damping * slow.velocity[j]) / p.stiffness;
      size += magnitude(slow.position[j]);
      change += magnitude(slow.position[j] - before.position[j]);
    }
    if (!(size < 1e30L)) return {};
    change /= size;
    if (change < Quad(1e-32L)) {
      slow.velocity = times_system(slow.position);
      return slow;
    }
    if (i > 8 && !(change < last)) return {};
  }
  return {};
}

class Integrator {
 public:
  explicit Integrator(const Question& question)
      : question_(question), random_(question.seed), noisy_(question.noise != 0) {}

  Answer run() {
    prepare();
    enter_from_start();
    while (!done_) advance();
    finish();
    return std::move(answer_);
  }

 private:
  Quad noisy(Quad number) {
    return noisy_ ? number * (1 + Quad(question_.noise) * Quad(random_.uniform(-1, 1))) : number;
  }
  bool rigid() const { return question_.walls == Walls::rigid; }

  void prepare() {
    const auto& scene = question_.scene;
    p_.nu = noisy(scene.damper().mass_ratio);
    p_.e = noisy(scene.damper().restitution);
    if (scene.damper().restitution == 1) p_.e = 1;
    p_.zeta = noisy(scene.damping_ratio);
    p_.k = noisy(scene.damper().wall_stiffness);
    p_.f0 = noisy(scene.force_amplitude);
    p_.omega_f = noisy(scene.force_frequency);
    const Quad pi = acosq(-1);
    Quad ratio = 1;
    if (p_.e > 0) {
      const Quad l = -logq(p_.e);
      ratio = l / sqrtq(pi * pi + l * l);
    }
    if (question_.calibration == Calibration::two_body) ratio /= sqrtq(1 + p_.nu);
    p_.stiffness = p_.k / p_.nu;
    p_.damping = 2 * sqrtq(p_.stiffness) * ratio;
    if (!rigid() && ratio > 0) slow_ = slow_manifold(p_);

    state_.x = noisy(scene.x0);
    state_.v = noisy(scene.v0);
    state_.w = noisy(scene.damper().w0);
    mirrored_ = scene.damper().y0 > 0.5;
    // The distance from the nearer wall: 1 - y0 has no rounding in quadruple precision.
    state_.q = noisy(mirrored_ ? 1 - Quad(scene.damper().y0) : Quad(scene.damper().y0));
    if (mirrored_) state_.x = -state_.x, state_.v = -state_.v, state_.w = -state_.w;
    until_ = scene.until_time ? Quad(*scene.until_time) : Quad(1e30L);
  }

  Quad side() const { return mirrored_ ? -1 : 1; }
  Wall wall() const { return mirrored_ ? Wall::right : Wall::left; }

  Energy energy() const {
    Energy now;
    const Quad v = state_.v, w = state_.w, z = v + w;
    now.kinetic = (v * v + p_.nu * z * z) / 2;
    now.spring = state_.x * state_.x / 2;
    now.wall = in_contact() ? p_.k * state_.q * state_.q / 2 : Quad(0);
    now.paper = (v * v + p_.nu * (v * v + w * w) + state_.x * state_.x) / 2;
    return now;
  }
  bool in_contact() const { return regime_ == Regime::contact || regime_ == Regime::slow_contact; }

  // An upper bound of how fast the regime's state can change, in the norm max(|x|, |v|, |f|, |f'|/omega_f,
  // Omega |q|, |w|) with Omega the contact's frequency.
  Quad rate() const {
    Quad bound = (regime_ == Regime::slow_contact ? 3 : 2) + 2 * p_.zeta;
    if (regime_ == Regime::contact) bound += sqrtq(p_.stiffness * (1 + p_.nu)) + p_.damping * (1 + p_.nu);
    if (p_.f0 != 0) bound = std::max(bound, p_.omega_f);
    return bound;
  }

  // Taylor's coefficients up to the order that leaves nothing.
  void expand(Quad h) {
    const double reach = double(h * rate());
    int order = 4;
    for (double term = std::pow(reach, 4) / 24; term > negligible_term && order < Polynomial::most - 3;
         ++order)
      term *= reach / (order + 1);
    step_.h = h;
    for (Polynomial* each : {&step_.x, &step_.v, &step_.q, &step_.w, &step_.f, &step_.acceleration}) {
      each->degree = order;
      each->at.fill(0);
    }
    auto &x = step_.x.at, &v = step_.v.at, &q = step_.q.at, &w = step_.w.at, &f = step_.f.at,
         &a = step_.acceleration.at;
    if (p_.f0 != 0) {
      const Quad angle = p_.omega_f * state_.t;
      f[0] = side() * p_.f0 * sinq(angle);
      f[1] = side() * p_.f0 * cosq(angle) * p_.omega_f * h;
      const Quad square = p_.omega_f * h * p_.omega_f * h;
      for (int n = 0; n + 2 <= order + 1; ++n) f[n + 2] = -square * f[n] / ((n + 1) * (n + 2));
    }
    x[0] = state_.x, x[1] = state_.v * h;
    q[0] = state_.q, q[1] = state_.w * h;
    const Quad drag = 2 * p_.zeta * h, h2 = h * h;
    const Quad wall_drag = p_.damping * h, wall_spring = p_.stiffness * h2;
    for (int n = 0; n <= order; ++n) {
      const Quad free = h2 * (f[n] - x[n]) - drag * ((n + 1) * x[n + 1]);
      const int below = (n + 1) * (n + 2);
      switch (regime_) {
        case Regime::flight:
          a[n] = free;
          q[n + 2] = -free / below;
          break;
        case Regime::contact: {
          const Quad push = wall_drag * ((n + 1) * q[n + 1]) + wall_spring * q[n];
          a[n] = p_.nu * push + free;
          q[n + 2] = -(push + a[n]) / below;
          break;
        }
        case Regime::slow_contact: {
          const std::array<Quad, 4> s{x[n], (n + 1) * x[n + 1] / h, f[n], (n + 1) * f[n + 1] / h};
          q[n] = w[n] = 0;
          for (int i = 0; i < 4; ++i) {
            q[n] += slow_->position[i] * s[i];
            w[n] += slow_->velocity[i] * s[i];
          }
          a[n] = p_.nu * h2 * (p_.damping * w[n] + p_.stiffness * q[n]) + free;
          break;
        }
        case Regime::stuck:
          a[n] = free / (1 + p_.nu);
          q[n + 2] = 0;
          break;
      }
      x[n + 2] = a[n] / below;
    }
    // Where the motion begins at a wall, that is exact, and its leading coefficients are zero or more than
    // rounding.
    if (regime_ == Regime::flight && q[0] == 0) clear_leading(step_.q);
    for (int n = 0; n <= order; ++n) {
      v[n] = (n + 1) * x[n + 1] / h;
      if (regime_ != Regime::slow_contact) w[n] = (n + 1) * q[n + 1] / h;
    }
  }

  static int leading(const Polynomial& p) {  // the first coefficient that is more than rounding; -1: none
    const Quad least = p.sum_of_magnitudes() * zero_within_rounding;
    for (int n = 0; n <= p.degree; ++n)
      if (magnitude(p.at[n]) > least) return n;
    return -1;
  }
  static void clear_leading(Polynomial& p) {
    const int first = leading(p);
    for (int n = 0; n < first; ++n) p.at[n] = 0;
  }
  // Whether a motion that has just begun goes this way, against what its beginning was decided by: only
  // rounding.
  bool departs(const Polynomial& p, int direction) const {
    if (!begins_) return false;
    const int first = leading(p);
    return first >= 0 && sign_of(p.at[first]) == direction;
  }
  // Its roots in (0, 1] but for those that the motion begins with.
  static std::vector<Root> roots_after_start(const Polynomial& p) {
    if (p.at[0] != 0) return changes_of_sign(p);
    int first = 0;
    while (first < p.degree && p.at[first] == 0) ++first;
    return changes_of_sign(divided_by_power(p, first));
  }

  // A relative speed that is rounding of what else moves.
  Quad rounded_speed() const {
    return (magnitude(state_.v) + magnitude(state_.x) + magnitude(p_.f0)) * zero_within_rounding;
  }

  // At the wall: to which side will the motion go that begins now as a flight? +1 off the wall, -1 into it, 0
  // if it stays.
  int side_of_departure() {
    if (state_.w != 0) {
      // A speed that is rounding of what goes on: decided by what follows.
      if (magnitude(state_.w) > rounded_speed()) return sign_of(state_.w);
      state_.w = 0;
    }
    const Regime before = regime_;
    regime_ = Regime::flight;
    const Quad q = state_.q;
    state_.q = 0;
    expand(step_by_rate / rate());
    state_.q = q;
    regime_ = before;
    const int first = leading(step_.q);
    return first < 0 ? 0 : sign_of(step_.q.at[first]);
  }

  void enter_from_start() {
    regime_ = !rigid() && state_.q < 0 ? Regime::contact : Regime::flight;
    answer_.initial = energy();
    if (state_.q <= 0) {
      if (regime_ == Regime::contact)
        open_contact();
      else
        decide_at_wall();
    }
    note_peak(state_.t, state_.x);
  }

  // q = 0: what happens now.
  void decide_at_wall() {
    const int departure = side_of_departure();
    if (departure >= 0) {  // 0: nothing moves, and nothing presses
      regime_ = Regime::flight;
      return;
    }
    if (rigid()) {
      if (state_.w < 0) return strike();
      regime_ = Regime::stuck;
      state_.w = 0;
      // A chattering is complete, too, once its bounces are slower than rounding.
      if (answer_.impacts.size() > chatter_begin_ &&
          p_.e * magnitude(answer_.impacts.back().relative_velocity) <= 2 * rounded_speed())
        close_chattering();
      open_contact();
      return;
    }
    if (state_.w < 0) {
      answer_.impacts.push_back({state_.t, wall(), side() * state_.w, 0, side() * state_.x, {}});
      of_impact_ = true;
    }
    regime_ = Regime::contact;
    open_contact();
  }

  void open_contact() { answer_.contacts.push_back({state_.t, state_.t, wall()}), contact_open_ = true; }
  void close_contact() {
    answer_.contacts.back().end = state_.t;
    answer_.contacts.back().end_speed = magnitude(state_.w);
    contact_open_ = of_impact_ = false;
    chatter_begin_ = answer_.impacts.size();
  }

  // Rigid walls: the impact, and what the bouncing that follows comes to.
  void strike() {
    const Quad speed = -state_.w;
    if (answer_.impacts.size() > chatter_begin_ && answer_.impacts.back().wall != wall())
      chatter_begin_ = answer_.impacts.size();
    const Quad loss = p_.nu * (1 - p_.e * p_.e) * speed * speed / (2 * (1 + p_.nu));
    answer_.impacts.push_back({state_.t, wall(), side() * state_.w, loss, side() * state_.x, {}});
    // Relative speed w becomes -e w, v + nu (v + w) is kept.
    state_.v += p_.nu * state_.w * (1 + p_.e) / (1 + p_.nu);
    state_.w = p_.e * speed;
    if (state_.w == 0) {
      if (side_of_departure() < 0) {
        complete_chattering(0);
      } else {
        regime_ = Regime::flight;
      }
      return;
    }
    regime_ = Regime::flight;
    if (p_.e == 1) return;
    // Under the relative acceleration -a the rest lasts 2 w / (a (1 - e)), but for the part by which a
    // changes in it: by itself and, through the damper, by the impacts. It is taken once that is beyond
    // quadruple rounding.
    expand(step_by_rate / rate());
    const Quad h = step_.h, a = step_.acceleration.at[0] / (h * h);
    if (!(a > 0)) return;
    const Quad rest = 2 * state_.w / (a * (1 - p_.e));
    Quad change = 2 * p_.zeta * p_.nu * (1 + p_.e) * state_.w / ((1 + p_.nu) * (1 - p_.e));
    Quad power = rest / h;
    for (int n = 1; n <= 6; ++n, power *= rest / h)
      change += magnitude(step_.acceleration.at[n]) / (h * h) * power;
    // But impacts that an engine may list, however little they matter, are listed here, too.
    if (change <= a * Quad(1e-10L) && rest * change <= a * Quad(1e-29L) * (1 + state_.t) &&
        rest <= Quad(1e-15L) * (1 + state_.t))
      complete_chattering(rest);
  }

  void complete_chattering(Quad rest) {
    // Momentum with what acts on both masses; all relative energy is lost.
    const Quad w = state_.w;
    answer_.chatter_loss += p_.nu * w * w / (2 * (1 + p_.nu));
    if (rest > 0) {
      const Quad angle = p_.omega_f * state_.t;
      const Quad force = p_.f0 != 0 ? side() * p_.f0 * sinq(angle) : Quad(0);
      const Quad acting = force - state_.x - 2 * p_.zeta * state_.v;
      const Quad v = state_.v + (p_.nu * w + rest * acting) / (1 + p_.nu);
      const Quad mean = (state_.v + v) / 2;
      answer_.viscous_work += 2 * p_.zeta * mean * mean * rest;
      add_forcing_work(force * mean * rest);
      state_.x += mean * rest;
      state_.v = v;
      state_.t += rest;
    } else {
      state_.v += p_.nu * w / (1 + p_.nu);
    }
    state_.w = 0;
    state_.q = 0;
    close_chattering();
    decide_at_wall();
  }

  void close_chattering() {
    for (std::size_t i = chatter_begin_; i < answer_.impacts.size(); ++i)
      answer_.impacts[i].accumulation = state_.t;
    chatter_begin_ = answer_.impacts.size();
  }

  void perturb() {
    if (!noisy_) return;
    state_.t = noisy(state_.t);
    state_.x = noisy(state_.x);
    state_.v = noisy(state_.v);
    state_.q = noisy(state_.q);
    state_.w = noisy(state_.w);
  }

  // The fast mode of a contact has died out within rounding of the force: go on without it.
  void drop_fast_mode() {
    const Quad angle = p_.omega_f * state_.t;
    const Quad f = side() * p_.f0 * sinq(angle), g = side() * p_.f0 * cosq(angle) * p_.omega_f;
    const std::array<Quad, 4> s{state_.x, state_.v, f, g};
    Quad q = 0, w = 0;
    for (int i = 0; i < 4; ++i) q += slow_->position[i] * s[i], w += slow_->velocity[i] * s[i];
    const Quad off =
        p_.stiffness * magnitude(state_.q - q) + (p_.damping + sqrtq(p_.stiffness)) * magnitude(state_.w - w);
    if (off > Quad(1e-29L) * (magnitude(state_.x) + magnitude(state_.v) + magnitude(f))) return;
    regime_ = Regime::slow_contact;
    state_.q = q, state_.w = w;
  }

  void advance() {
    if (++answer_.steps > question_.most_steps ||
        std::int64_t(answer_.impacts.size()) > question_.most_impacts) {
      answer_.stop = Stop::effort;
      done_ = true;
      return;
    }
    if (regime_ == Regime::contact && slow_ && state_.q < 0) drop_fast_mode();
    Quad h = step_by_rate / rate();
    if (regime_ == Regime::flight && state_.q == 0 && state_.w > 0) {
      // A bounce that will be short needs no long step.
      expand(Quad(0x1p-10) / rate());
      const Quad a = step_.acceleration.at[0] / (step_.h * step_.h);
      if (a > 0) h = std::min(h, 8 * state_.w / a);
    }
    if (h > until_ - state_.t) h = until_ - state_.t;
    if (!(h > 0)) {
      done_ = true;
      return;
    }
    expand(h);

    // The terminal event, if any.
    Quad end = 1;
    enum class Event { none, near_wall, far_wall, off_wall, release } event = Event::none;
    const auto first = [&](const Polynomial& p, int direction, Event kind) {
      for (const Root& root : roots_after_start(p)) {
        if (root.direction != direction) continue;
        if (root.s < end || (root.s == end && event == Event::none)) end = root.s, event = kind;
        return;
      }
    };
    switch (regime_) {
      case Regime::flight: {
        if (departs(step_.q, -1))
          end = 0, event = Event::near_wall;
        else
          first(step_.q, -1, Event::near_wall);
        Polynomial gap = step_.q;
        gap.at[0] -= 1;
        first(gap, +1, Event::far_wall);
        break;
      }
      case Regime::contact:
      case Regime::slow_contact:
        first(step_.q, +1, Event::off_wall);
        break;
      case Regime::stuck: {
        Polynomial pressing = step_.acceleration;
        if (begins_) clear_leading(pressing);
        if (departs(pressing, -1))
          end = 0, event = Event::release;
        else
          first(pressing, -1, Event::release);
        break;
      }
    }
    const Quad stop = observe(end);
    if (stop < end) end = stop, event = Event::none;
    work(end);
    move_to(end);
    begins_ = false;
    if (done_) return;
    // Not within a contact: noise would keep its fast mode alive for ever.
    if (event != Event::none || regime_ != Regime::contact) perturb();
    switch (event) {
      case Event::none:
        return;
      case Event::far_wall:
        mirrored_ = !mirrored_;
        state_.x = -state_.x, state_.v = -state_.v, state_.w = -state_.w;
        [[fallthrough]];
      case Event::near_wall:
        state_.q = 0;
        begins_ = true;
        if (state_.w > 0) state_.w = 0;
        decide_at_wall();
        return;
      case Event::off_wall:
        state_.q = 0;
        begins_ = true;
        close_contact();
        if (state_.w < 0) state_.w = 0;
        decide_at_wall();
        return;
      case Event::release:
        state_.q = state_.w = 0;
        begins_ = true;
        close_contact();
        answer_.contacts.back().end_speed =
            (1 + p_.nu) * magnitude(derivative(step_.acceleration)(end)) / (step_.h * step_.h * step_.h);
        regime_ = Regime::flight;
        return;
    }
  }

  void move_to(Quad s) {
    state_.t = s == 1 && step_.h == until_ - state_.t ? until_ : state_.t + step_.h * s;
    state_.x = step_.x(s), state_.v = step_.v(s), state_.w = step_.w(s), state_.q = step_.q(s);
  }

  void add_forcing_work(Quad work) {
    answer_.forcing_work += work;
    answer_.forcing_turnover += magnitude(work);
  }

  void work(Quad end) {
    if (p_.zeta != 0)
      answer_.viscous_work += 2 * p_.zeta * step_.h * integral_of_product(step_.v, step_.v, end);
    if (p_.f0 != 0) add_forcing_work(step_.h * integral_of_product(step_.f, step_.v, end));
    if (in_contact() && p_.damping != 0) {
      const Quad loss = p_.nu * p_.damping * step_.h * integral_of_product(step_.w, step_.w, end);
      (of_impact_ ? answer_.impacts.back().loss : answer_.contact_loss) += loss;
    }
  }

  void note_peak(Quad t, Quad x) {
    if (magnitude(x) > peak_) peak_ = magnitude(x), peak_time_ = t;
  }

  // Crossings, peaks and samples in (0, end]; returns where the run stops, else `end`.
  Quad observe(Quad end) {
    struct Seen {
      Quad s;
      enum { turn, crossing, sample } kind;
    };
    std::vector<Seen> seen;
    const Quad t0 = state_.t, h = step_.h;
    // The side to which x goes, where it begins at zero by its first coefficient that is not: an event often
    // coincides with a crossing.
    Polynomial x = step_.x;
    clear_leading(x);
    const int first = leading(x);
    const int now = first < 0 ? 0 : int(side()) * sign_of(x.at[first]);
    if (side_of_x_ == 0) side_of_x_ = now;
    // A crossing that the last step's end left to this one, by a rounding.
    if (now != 0 && now != side_of_x_) seen.push_back({0, Seen::crossing});
    for (const Root& root : roots_after_start(x))
      if (root.s <= end) seen.push_back({root.s, Seen::crossing});
    for (const Root& root : roots_after_start(step_.v))
      if (root.s <= end) seen.push_back({root.s, Seen::turn});
    while (sample_ < question_.samples.size()) {
      const Quad t = question_.samples[sample_];
      if (t > t0 + h * end) break;
      const Quad s = std::min((t - t0) / h, end);
      seen.push_back({std::max(s, Quad(0)), Seen::sample});
      ++sample_;
    }
    std::stable_sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) { return a.s < b.s; });
    for (const Seen& each : seen) {
      const Quad t = t0 + h * each.s;
      switch (each.kind) {
        case Seen::turn:
          note_peak(t, step_.x(each.s));
          break;
        case Seen::sample: {
          const Quad q = step_.q(each.s);
          answer_.samples.push_back({side() * step_.x(each.s), side() * step_.v(each.s),
                                     mirrored_ ? 1 - q : q, side() * step_.w(each.s), in_contact()});
          break;
        }
        case Seen::crossing:
          answer_.half_cycles.push_back({t, peak_time_, peak_, magnitude(step_.v(each.s))});
          side_of_x_ = -side_of_x_;
          if (question_.scene.until_amplitude && peak_ < Quad(*question_.scene.until_amplitude)) {
            answer_.stop = Stop::amplitude;
            done_ = true;
            return each.s;
          }
          peak_ = 0, peak_time_ = t;
          break;
      }
    }
    note_peak(t0 + h * end, step_.x(end));
    return end;
  }

  void finish() {
    answer_.end_time = state_.t;
    answer_.final = energy();
    if (contact_open_) answer_.contacts.back().end = state_.t;
  }

  const Question& question_;
  reference::Random random_;
  bool noisy_;
  Parameters p_;
  std::optional<SlowManifold> slow_;
  State state_;
  Regime regime_ = Regime::flight;
  Step step_;
  bool mirrored_ = false, done_ = false, begins_ = true;
  bool contact_open_ = false, of_impact_ = false;
  std::size_t chatter_begin_ = 0;
  int side_of_x_ = 0;
  Quad peak_ = 0, peak_time_ = 0;
  std::size_t sample_ = 0;
  Quad until_ = 0;
  Answer answer_;
};

}  // namespace

Answer answer_to(const Question& question) { return Integrator(question).run(); }

}  // namespace oracle
