#include "several_oracle.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
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
}

namespace several {
namespace {

using impact_damper::Wall;
using oracle::magnitude, oracle::Polynomial, oracle::Root, oracle::sign_of;

// A step is this long in units of the motion's rate; then term n is at most 4^n/n! of the state.
constexpr double step_by_rate = 4;
// A coefficient below this part of its polynomial's size is zero but for rounding.
const Quad zero_within_rounding = Quad(1e-29L);
// Events nearer to each other than this, times 1 + t, are one instant.
const Quad one_instant = Quad(1e-28L);
// After a rebound slower than this part of the motion's speeds the rest of a complete chattering is taken at
// once: what it moves, and the loss, is of the order of this number squared.
const Quad no_rebound = Quad(1e-13L);

struct Damper {
  Quad nu, e, clearance;
  int side = 1;       // from which wall d is counted: +1 left, -1 right
  Quad d = 0, s = 0;  // distance from it, velocity away from it
  bool stuck = false;
  std::size_t contact = 0;  // while stuck or in contact: its own
  Polynomial path;          // d in this step
  // Compliant walls: their force on the damper, away from them, is -nu (damping s + stiffness d) in contact.
  bool in_contact = false;
  bool pushes = true;  // the primary mass, too
  Quad stiffness = 0, damping = 0;
  std::optional<std::size_t> impact;  // that began the contact
  Polynomial push;                    // h^2 (damping s + stiffness d) in this step
  Wall wall() const { return side > 0 ? Wall::left : Wall::right; }
};

int leading(const Polynomial& p) {  // the first coefficient that is more than rounding; -1: none
  const Quad least = p.sum_of_magnitudes() * zero_within_rounding;
  for (int n = 0; n <= p.degree; ++n)
    if (magnitude(p.at[n]) > least) return n;
  return -1;
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

class Integrator {
 public:
  explicit Integrator(const Question& question)
      : question_(question), compliant_(question.walls == Walls::compliant) {}

  Answer run() {
    prepare();
    for (Damper& each : dampers_)
      if (compliant_ && each.d < 0) open_contact(each), each.in_contact = true;
    answer_.initial = energy(answer_.damper_initial);
    note_peak(0, x_);
    if (!compliant_) impact();  // of those that begin at a wall with a speed into it
    if (compliant_)
      for (Damper& each : dampers_)
        if (each.d == 0 && each.s < 0) touch(each);
    while (t_ < until_ && answer_.complete) advance();
    answer_.end_time = t_;
    answer_.final = energy(answer_.damper_final);
    for (Damper& each : dampers_) leave(each);
    return std::move(answer_);
  }

 private:
  // Equal numbers of one kind get equal noise.
  Quad noisy(Quad number, std::uint64_t kind) const {
    if (question_.noise == 0) return number;
    reference::Random random(std::bit_cast<std::uint64_t>(double(number)) ^ (question_.seed << 32) ^ kind);
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
    until_ = *scene.until_time;
    for (const impact_damper::SceneDamper& each : scene.dampers) {
      Damper damper;
      damper.nu = noisy(each.mass_ratio, 6);
      damper.e = each.restitution == 1 ? Quad(1) : noisy(each.restitution, 7);
      // Those as far from their right walls, with other clearances, reach these at one instant, too.
      const Quad from_left = noisy(each.y0, 8), from_right = noisy(Quad(each.clearance) - each.y0, 9);
      damper.clearance = from_left + from_right;
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
      damper.damping = 2 * sqrtq(damper.stiffness) * ratio;
      damper.pushes = question_.fault == Fault::wall_force_left_out
                          ? dampers_.size() + 1 < scene.dampers.size()
                          : question_.fault != Fault::own_contact_only || dampers_.empty();
      dampers_.push_back(damper);
    }
    if (question_.fault == Fault::clearance_ignored) dampers_.back().clearance = dampers_[0].clearance;
    answer_.damper_loss.resize(dampers_.size());
    rate_ = 2 + 2 * zeta_;
    if (f0_ != 0) rate_ = std::max(rate_, omega_);
  }

  oracle::Energy energy(std::vector<Quad>& of_dampers) const {
    oracle::Energy now{v_ * v_ / 2, x_ * x_ / 2, 0, (v_ * v_ + x_ * x_) / 2};
    for (const Damper& each : dampers_) {
      const Quad z = v_ + each.side * each.s;
      of_dampers.push_back(each.nu * z * z / 2);
      now.kinetic += of_dampers.back();
      now.paper += each.nu * (v_ * v_ + each.s * each.s) / 2;
      if (each.in_contact) now.wall += each.nu * each.stiffness * each.d * each.d / 2;
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
      if (each.in_contact) sum += each.side * each.nu * (each.damping * each.s + each.stiffness * each.d);
    return sum;
  }

  // An upper bound of how fast the state can change: of the sums of the equations' coefficients with sqrt(K)
  // d in place of d.
  Quad rate() const {
    Quad sum = rate_, most = 0;
    for (const Damper& each : dampers_) {
      if (!each.in_contact) continue;
      const Quad own = sqrtq(each.stiffness) + each.damping;
      sum += each.nu * own;
      most = std::max(most, own);
    }
    return sum + most;
  }

  // x = x(s), t = t + h s, by Taylor's coefficients up to the order that leaves nothing.
  void expand(Quad h) {
    h_ = h;
    const double reach = double(h * rate());
    int order = 4;
    for (double term = std::pow(reach, 4) / 24; term > 1e-36 && order < Polynomial::most - 3; ++order)
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
    const Quad mass = joined_mass(), square = h * h / mass, drag = 2 * zeta_ * h / mass;
    for (int n = 0; n <= order; ++n) {
      a[n] = square * (f[n] - x[n]) - drag * ((n + 1) * x[n + 1]);
      for (Damper& each : dampers_) {
        if (!each.in_contact) continue;
        const auto& d = each.path.at;
        each.push.at[n] = each.damping * h * ((n + 1) * d[n + 1]) + each.stiffness * h * h * d[n];
        if (each.pushes) a[n] += each.side * each.nu * each.push.at[n];
      }
      x[n + 2] = a[n] / ((n + 1) * (n + 2));
      v[n] = (n + 1) * x[n + 1] / h;
      for (Damper& each : dampers_)
        if (!each.stuck) each.path.at[n + 2] = -(each.side * a[n] + each.push.at[n]) / ((n + 1) * (n + 2));
    }
    for (Damper& each : dampers_)
      if (each.d == 0) clear_leading(each.path);
  }

  void open_contact(Damper& each) {
    each.contact = answer_.contacts.size();
    answer_.contacts.push_back({t_, t_, int(&each - dampers_.data()), each.wall()});
  }
  // A compliant wall is met.
  void touch(Damper& each) {
    each.impact.reset();
    if (each.s < 0 || t_ > 0) {  // only at the beginning a contact needs no impact
      each.impact = answer_.impacts.size();
      answer_.impacts.push_back({t_, int(&each - dampers_.data()), each.wall(), each.side * each.s, x_, 0});
    }
    open_contact(each);
    each.in_contact = true;
  }

  // Those at rest on a wall: do they stick? The sign of x'' from now on does not depend on how many do.
  void decide() {
    const auto rests = [](const Damper& each) { return each.d == 0 && each.s == 0; };
    if (std::none_of(dampers_.begin(), dampers_.end(), rests)) return;
    if (compliant_) {
      expand(step_by_rate / rate());
      for (Damper& each : dampers_) {
        const int first = rests(each) && !each.in_contact ? leading(each.path) : -1;
        if (first >= 0 && each.path.at[first] < 0) touch(each);
      }
      return;
    }
    const Quad now = force();
    int push = sign_of(now);
    if (magnitude(now) <= Quad(1e-15L) * (magnitude(x_) + magnitude(v_) + magnitude(f0_))) {
      expand(step_by_rate / rate_);
      const int first = leading(pa_);
      push = first < 0 ? 0 : sign_of(pa_.at[first]);
    }
    for (Damper& each : dampers_) {
      if (!rests(each)) continue;
      const bool sticks = push == each.side;
      if (sticks && !each.stuck) {
        open_contact(each);
        each.stuck = true;
      } else if (!sticks) {
        leave(each);
      }
    }
  }
  void leave(Damper& each) {
    if (each.stuck || each.in_contact) answer_.contacts[each.contact].end = t_;
    each.stuck = each.in_contact = false;
  }

  void advance() {
    if (std::int64_t(answer_.impacts.size()) > question_.most_impacts || ++steps_ > question_.most_steps) {
      answer_.complete = false;
      return;
    }
    if (!released_) decide();
    released_ = false;
    Quad h = step_by_rate / rate();
    const Quad acceleration = force() / joined_mass();
    for (const Damper& each : dampers_) {  // what will soon be at a wall needs no long step
      if (each.stuck || each.in_contact) continue;
      const double push = double(each.side * acceleration), speed = double(each.s);
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

    std::vector<Quad> near(dampers_.size(), 2), far(dampers_.size(), 2);
    Quad end = 1, release = 2;
    const auto first = [&](const Polynomial& p, int direction) {
      for (const Root& root : roots_after_start(p))
        if (root.direction == direction) return root.s;
      return Quad(2);
    };
    int side = 0;
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
      const Damper& each = dampers_[i];
      if (each.stuck) {
        side = each.side;
        continue;
      }
      near[i] = first(each.path, each.in_contact ? +1 : -1);
      if (each.in_contact) {
        if (question_.fault == Fault::let_go_by_force) near[i] = std::min(near[i], first(each.push, +1));
        end = std::min(end, near[i]);
        continue;
      }
      // A speed away from a wall that is rounding of what leads it back.
      if (const int leads = leading(each.path);
          compliant_ && each.d == 0 && leads > 0 && each.path.at[leads] < 0)
        near[i] = 0;
      Polynomial gap = each.path;
      gap.at[0] -= each.clearance;
      far[i] = first(gap, +1);
      end = std::min({end, near[i], far[i]});
    }
    if (side != 0) {
      Polynomial push = pa_;
      clear_leading(push);
      if (question_.fault == Fault::released_apart) push.at[0] -= side * h * h * Quad(1e-6L);
      release = first(push, -side);
      end = std::min(end, release);
    }
    const Quad together = end + one_instant * (1 + t_) / h;
    observe(end);
    work(end);
    t_ = last && end == 1 ? until_ : t_ + h * end;
    x_ = px_(end), v_ = pv_(end);
    bool met = false;
    std::vector<bool> meets(dampers_.size(), false);  // a compliant wall
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
      Damper& each = dampers_[i];
      if (each.stuck) continue;
      each.d = each.path(end);
      each.s = derivative(each.path)(end) / h;
      if (each.in_contact) {
        if (near[i] > together) continue;
        each.d = 0, each.s = std::max(each.s, Quad(0));
        leave(each);
        released_ = true;
        continue;
      }
      if (!(each.d >= Quad(-1e-12L) && each.d <= each.clearance + Quad(1e-12L)))
        throw std::logic_error("the oracle has lost a damper");
      if (near[i] <= together || far[i] <= together) {
        if (far[i] <= together) each.side = -each.side, each.s = -each.s;
        each.d = 0;
        met = true;
        meets[i] = compliant_;
      }
    }
    if (release <= together) {
      for (Damper& each : dampers_) leave(each);
      released_ = true;
    }
    if (met || released_) perturb();
    if (compliant_) {
      for (std::size_t i = 0; i < dampers_.size(); ++i)
        if (meets[i]) dampers_[i].s = std::min(dampers_[i].s, Quad(0)), touch(dampers_[i]);
      released_ = false;
    } else if (met) {
      impact();
      released_ = false;
    }
  }

  void perturb() {
    if (question_.noise == 0) return;
    const auto event = std::uint64_t(++events_) << 8;
    x_ = noisy(x_, event + 11);
    v_ = noisy(v_, event + 12);
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
    const Quad jump = driven / mass;
    v_ += jump;
    // What is not at a wall sees the jump, too: its velocity relative to the cavity.
    for (Damper& each : dampers_)
      if (std::find(all.begin(), all.end(), &each) == all.end() && !each.stuck) each.s -= each.side * jump;
    const Quad now = force();
    const Quad speeds = magnitude(v_) + magnitude(x_) + magnitude(f0_);
    for (Damper* each : all) {
      const Quad before = each->s, e = e_of(*each);
      const bool active = impulse(*each, middle) > 0;
      const Quad impulse_by_mass = active ? impulse(*each, jump) : Quad(0);
      each->s = active ? -e * before : before - each->side * jump;
      if (before < 0) {
        const Quad loss = each->nu * impulse_by_mass * (1 - e) * -before / 2;
        const int number = int(each - dampers_.data());
        answer_.impacts.push_back({t_, number, each->wall(), each->side * before, x_, loss, active});
        answer_.damper_loss[number] += loss;
      }
    }
    const Quad least = question_.fault == Fault::chattering_cut_short ? Quad(1e-4L) : no_rebound * speeds;
    const Quad mass_now = joined_mass();
    std::vector<Damper*> last;  // of a chattering
    for (Damper* each : all) {
      if (each->s > 0) leave(*each);
      if (each->s > 0 && each->s <= least && each->s * mass_now <= each->side * now * Quad(1e-8L))
        last.push_back(each);
    }
    if (!last.empty()) join(last);
  }

  // The rest of a chattering: they give their momentum to the primary mass and what rests on the same wall.
  void join(const std::vector<Damper*>& last) {
    const int side = last.front()->side;
    Quad mass = 1, driven = 0;
    for (const Damper& each : dampers_)
      if (each.side == side && each.d == 0 && each.s == 0) mass += each.nu;
    for (const Damper* each : last) mass += each->nu, driven += each->nu * each->s;
    const Quad jump = driven / mass;
    for (Damper* each : last) {
      answer_.damper_loss[each - dampers_.data()] += each->nu * each->s * (each->s - jump) / 2;
      each->s = 0;
    }
    if (question_.fault == Fault::chattering_cut_short) return;
    v_ += side * jump;
    for (Damper& each : dampers_)
      if (each.side != side || each.d != 0 || each.s != 0) each.s -= each.side * side * jump;
  }

  void work(Quad end) {
    for (std::size_t i = 0; i < dampers_.size(); ++i) {
      const Damper& each = dampers_[i];
      if (!each.in_contact || each.damping == 0) continue;
      const Polynomial speed = derivative(each.path);
      const Quad loss = each.nu * each.damping * integral_of_product(speed, speed, end) / h_;
      answer_.damper_loss[i] += loss;
      (each.impact ? answer_.impacts[*each.impact].loss : answer_.contact_loss) += loss;
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

  // Zero crossings, peaks and samples in (0, end].
  void observe(Quad end) {
    Polynomial x = px_;
    clear_leading(x);
    const int first = leading(x), now = first < 0 ? 0 : sign_of(x.at[first]);
    if (side_of_x_ == 0) side_of_x_ = now;
    std::vector<std::pair<Quad, bool>> seen;  // whether a crossing
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
      answer_.half_cycles.push_back({t, peak_time_, peak_});
      side_of_x_ = -side_of_x_;
      peak_ = 0, peak_time_ = t;
    }
    note_peak(t_ + h_ * end, px_(end));
    for (; answer_.samples.size() < question_.samples.size();) {
      const Quad s = (question_.samples[answer_.samples.size()] - t_) / h_;
      if (s > end) break;
      Sample sample{px_(s), pv_(s), {}, {}};
      for (const Damper& each : dampers_) {
        const Quad d = each.path(s);
        sample.y.push_back(each.side > 0 ? d : each.clearance - d);
        sample.w.push_back(each.side * derivative(each.path)(s) / h_);
      }
      answer_.samples.push_back(sample);
    }
  }

  const Question& question_;
  bool compliant_;
  Quad zeta_ = 0, f0_ = 0, omega_ = 0, until_ = 0, rate_ = 0;
  Quad t_ = 0, x_ = 0, v_ = 0;
  std::vector<Damper> dampers_;
  Quad h_ = 0;
  Polynomial px_, pv_, pf_, pa_;  // of the step: x, x', the force, h^2 x''
  bool released_ = false;
  int side_of_x_ = 0;
  Quad peak_ = 0, peak_time_ = 0;
  std::int64_t steps_ = 0, events_ = 0;
  Answer answer_;
};

}  // namespace

Answer answer_to(const Question& question) { return Integrator(question).run(); }

}  // namespace several
