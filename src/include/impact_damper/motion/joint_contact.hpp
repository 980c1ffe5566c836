// Several secondary masses in contact with their walls at once (docs/mathematics.md, 17.5): x and each q as
// power series in time (M17.16), in pieces so short that the terms left out are below rounding (M17.17).
// Modes are not used: a set of masses seldom comes again, and equal dampers have equal modes.
//
// With components (chapter 18) the same series hold for masses that slide with friction in a wall, or in a
// fluid, where K = 0: what is constant in a piece enters at the order 0 (M18.20).
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/motion/driven_series.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/motion/motion.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

// What is constant in a piece with components.
template <class Real>
struct ConstantForces {
  std::vector<Real> friction{};  // phi_i s_i of each mass of the series
  Real others{0};                // sum of nu phi s over the masses that slide and are not in it
  Real weight{0}, held{0};       // gamma, and sigma: the masses that are held
};

// The motion (motion.hpp) of one piece at a time. y and y' in its states are not used. Arguments and results
// are in t. The series inside are in s = t/h_: their terms are h_^n/n! times the n-th derivatives by t.
template <class Real, class Force, bool components = false>
class JointContact : public ProofsByBounds<JointContact<Real, Force, components>, Real> {
 public:
  static constexpr std::size_t joint_terms = 24;
  // The first omitted term of x'' is joint_radians^(terms - 2) / (terms - 2)! of the motion: epsilon / 64, or
  // near critical damping and in resonance up to `terms` times that, which is still below rounding.
  static constexpr double joint_radians = std::numeric_limits<Real>::digits10 < 17   ? 1.4562250345325596
                                          : std::numeric_limits<Real>::digits10 < 20 ? 1.029
                                                                                     : 0.22;
  using Terms = PairedSeries<Real, joint_terms / 2>;
  // A function as a series in s, with a bound on its third derivative by t in the piece.
  struct Function {
    Terms terms;
    Real third;
    std::size_t order;  // of the derivative, of x or of a mass's distance from its wall
  };

  // Whether the walls with K >= `least` may follow the others (M17.22): at least one wall must be left to
  // lead, and `least` must exceed 1e4 rate^2, the rate (M17.17) being that of the walls that lead.
  static bool may_follow(const Real& least, const Real& zeta, const Force& forcing,
                         const std::vector<PushedWall<Real>>& walls) {
    const auto leads = [&](const PushedWall<Real>& wall) { return wall.stiffness < least; };
    const Real rate = rate_for(zeta, forcing, walls, least);
    return std::ranges::any_of(walls, leads) && least > 10000 * rate * rate;
  }
  // Sets the walls of the pieces to come. Walls with K >= `follow_from` have stopped ringing, and follow all
  // else (M17.22).
  void set_walls(const Real& zeta, const Force& forcing, const std::vector<PushedWall<Real>>& walls,
                 const Real& follow_from = std::numeric_limits<Real>::infinity()) {
    zeta_ = zeta;
    forcing_ = forcing;
    const Real rate = rate_for(zeta, forcing, walls, follow_from);
    length_ = Real(joint_radians) / rate;
    h_ = 1;
    while (h_ * rate > 2) h_ /= 2;
    over_h_ = 1 / h_;
    for (std::vector<Real>* each : {&nu_, &spring_, &damping_}) each->clear();
    followers_.clear();
    mass_ = 1;
    for (const auto& [nu, stiffness, damping, q, w] : walls) {
      const bool follows = stiffness >= follow_from;
      if (follows) {
        followers_.push_back({nu_.size(), h_ * h_ * stiffness, h_ * damping});
        mass_ += nu;
      }
      nu_.push_back(nu);
      spring_.push_back(follows ? Real(0) : Real(h_ * h_ * stiffness));
      damping_.push_back(follows ? Real(0) : Real(h_ * damping));
    }
    for (std::vector<Real>* each : {&force_, &end_q_, &end_w_, &fourth_}) each->resize(walls.size());
    q_.resize(joint_terms * walls.size());
    if constexpr (components) return;  // no look_until()
    const Real end = length_ * over_h_;
    Real power = over_h_ * over_h_ * over_h_ * over_h_;
    for (std::size_t n = 4; n < joint_terms; ++n) {
      fourth_weight_[n] = power * double(n * (n - 1) * (n - 2) * (n - 3));
      power *= end;
    }
  }
  // Sets what is constant in the next piece, after set_walls(): `forces` must outlive it.
  void set_forces(const ConstantForces<Real>& forces) requires components {
    forces_ = &forces;
    mass_ = 1 + forces.held;
  }
  // Begins a piece at `time` with x0 and v0. walls: those of set_walls(), with their q and q' now.
  void begin(const Real& time, const Real& x0, const Real& v0, const std::vector<PushedWall<Real>>& walls) {
    const std::size_t count = walls.size();
    std::array<Real, joint_terms> x{x0, h_ * v0};
    for (std::size_t i = 0; i < count; ++i) {
      q_[i] = walls[i].q;
      q_[count + i] = h_ * walls[i].w;
    }
    phase_ = forcing_.phase(time);
    pull_.fill(Real(0));
    expand(x);
    // Each step leaves at most 1e-4 of what it corrects.
    for (int i = 0; i < 5 && !followers_.empty(); ++i) {
      follow(x);
      expand(x);
    }
    if (!followers_.empty()) follow(x);
    for (std::size_t n = 0; n < x_.size(); ++n) x_[n] = SimdPair<Real>{x[2 * n], x[2 * n + 1]};
    end_ = -1;
  }
  // Whether q and q' of the walls that follow agree with `walls` but for rounding errors.
  bool follows(const std::vector<PushedWall<Real>>& walls) const {
    const std::size_t count = nu_.size();
    const Real size = rounding_size() + h_ * h_ * absolute(forcing_.amplitude * phase_.sin);
    return std::ranges::all_of(followers_, [&](const Follower& each) {
      const std::size_t i = each.index;
      const Real rounding = 64 * std::numeric_limits<Real>::epsilon() * size / each.spring;
      return absolute(walls[i].q - q_[i]) <= rounding &&
             absolute(h_ * walls[i].w - q_[count + i]) <= rounding * square_root(each.spring);
    });
  }

  const Real& length() const { return length_; }
  Real rate() const { return Real(joint_radians) / length_; }
  Displacement<Real> change(const Real& t) const { return now(x_, t).displacement; }
  State<Real> at(const Real& t) const {
    const Displacement<Real> now = change(t);
    return {now.x, now.v, Real(0), Real(0)};
  }
  // Returns q and q' of the i-th wall at t.
  std::array<Real, 2> overlap(std::size_t i, const Real& t) const {
    if (t == end_) return {end_q_[i], end_w_[i]};
    const SeriesAt<Real> now = sum<Real>(terms_of(i), t * over_h_);
    return {now.u, over_h_ * now.u1};
  }
  // Returns the work of the i-th wall's damper: the integral of nu c q'^2 over [0, t].
  Real wall_work(std::size_t i, const Real& t) const {
    Real damping = damping_[i];
    for (const Follower& each : followers_)
      if (each.index == i) damping = each.damping;
    return nu_[i] * (damping * over_h_) * integral_of_ww(i, t);
  }
  // Returns the integral of q'^2 of the i-th mass over [0, t].
  Real integral_of_ww(std::size_t i, const Real& t) const {
    const Terms q = terms_of(i);
    const Real half = t / 2;
    Real sum_ww{0};
    for (const auto& [abscissa, weight] : gauss_16) {
      for (const double side : {-abscissa, abscissa}) {
        const Real w = over_h_ * sum<Real>(q, Real((half + half * side) * over_h_)).u1;
        sum_ww += half * weight * (w * w);
      }
    }
    return sum_ww;
  }

  // Evaluates each q and q' at t, and a bound on each q''''. stays(i, wall) is then whether Lemma L2 proves
  // that q of the i-th mass keeps its sign until t.
  void look_until(const Real& t) {
    const std::size_t count = nu_.size();
    const Real s = t * over_h_;
    const Real* last = q_.data() + (joint_terms - 1) * count;
    for (std::size_t i = 0; i < count; ++i) {
      end_q_[i] = last[i];
      end_w_[i] = 0;
      fourth_[i] = fourth_weight_[joint_terms - 1] * absolute(last[i]);
    }
    for (std::size_t n = joint_terms - 1; n-- > 0;) {
      const Real *now = q_.data() + n * count, weight = fourth_weight_[n];
      for (std::size_t i = 0; i < count; ++i) {
        end_w_[i] = end_w_[i] * s + end_q_[i];
        end_q_[i] = end_q_[i] * s + now[i];
        fourth_[i] += weight * absolute(now[i]);
      }
    }
    for (std::size_t i = 0; i < count; ++i) end_w_[i] *= over_h_;
    end_ = t;
  }
  bool stays(std::size_t i, Wall wall) const {
    const Real inward = wall == Wall::left ? -1 : 1;
    return stays_open(Real(inward * q_[i]), Real(inward * (over_h_ * q_[nu_.size() + i])),
                      Real(inward * end_q_[i]), Real(inward * end_w_[i]), end_, fourth_[i]);
  }
  // Returns the function that falls through zero where the i-th mass leaves its wall: its depth in the wall.
  Function depth(std::size_t i, Wall wall) const {
    return function(terms_of(i), wall == Wall::left ? Real(-1) : Real(1), 0);
  }
  // Returns the function that falls through zero where a mass in flight meets a wall: its distance from the
  // wall, now u with the derivative u1. away: 1 at a left wall, -1 at a right one, so that u'' = -away x''.
  Function gap(const Real& u, const Real& u1, const Real& away) const {
    Function gap = function(x_, -away, 0);
    set(gap.terms, 0, u);
    set(gap.terms, 1, h_ * u1);
    return gap;
  }
  // Returns the function that falls through zero where a mass in flight turns back: sign times y', now w.
  Function relative_velocity(const Real& w, const Real& sign) const {
    Function speed = function(x_, -sign, 1);
    set(speed.terms, 0, sign * w);
    return speed;
  }
  // The series of x, and of -q of the i-th mass; what a series is at t, with its second derivative, and
  // others of its derivatives by t there; a bound on its `order`-th derivative in the piece. Orders are at
  // most 6.
  const Terms& of_x() const { return x_; }
  Terms of_minus_q(std::size_t i) const {
    Terms q = terms_of(i);
    for (auto& each : q) each = SimdPair<Real>{-each[0], -each[1]};
    return q;
  }
  struct Now {
    Displacement<Real> displacement{};
    Real second{0};
  };
  Now now(const Terms& terms, const Real& t) const {
    const SeriesAt<Real> by = Departure<Real, joint_terms / 2>{terms}.at(t * over_h_);
    const Real v0 = over_h_ * get(terms, 1), dv = over_h_ * by.u1;
    return {{get(terms, 0) + (v0 * t + by.u), v0 + dv, by.u, dv}, over_h_ * over_h_ * by.u2};
  }
  Real derivative(const Terms& terms, std::size_t order, const Real& t) const {
    const Real s = t * over_h_;
    Real all{0};
    for (std::size_t n = joint_terms; n-- > order;) all = all * s + falling(n, order) * get(terms, n);
    for (std::size_t k = 0; k < order; ++k) all *= over_h_;
    return all;
  }
  Real bound(const Terms& terms, std::size_t order) const {
    const Real end = length_ * over_h_;
    Real all{0};
    for (std::size_t n = joint_terms; n-- > order;)
      all = all * end + falling(n, order) * absolute(get(terms, n));
    for (std::size_t k = 0; k < order; ++k) all *= over_h_;
    return all;
  }
  LocalEnclosure<Real> enclosure(const Function& g, const Real& t) const {
    const SeriesAt<Real> now = sum<Real>(g.terms, t * over_h_);
    return {{now.u, over_h_ * now.u1, over_h_ * over_h_ * now.u2, g.third}};
  }
  // Bounds on |x''| and |x'''| in the whole piece.
  Real second_of_x(const Real& = Real(0)) const { return bound(x_, 2); }
  Real third_of_x(const Real&) const { return bound(x_, 3); }
  Real start_x() const { return get(x_, 0); }
  Real start_v() const { return over_h_ * get(x_, 1); }
  // Returns the first time in [0, until) at which g falls through zero.
  std::optional<Real> fall(const Function& g, const Real& until, Search<Real>& search) const {
    Real from{0};
    // At rest on a wall the third derivative, or a later one, may decide alone (M7.4).
    if (get(g.terms, 0) == 0 && get(g.terms, 1) == 0) {
      const std::size_t lead = order_of_lead() - g.order, order = lead > 3 ? lead : 3;
      Real value = get(g.terms, order);
      for (std::size_t n = order; n > 0; --n) value *= Real(double(n)) * over_h_;
      if (value > 0 && (lead > 2 || get(g.terms, 2) >= 0))
        from = begin_by_lead<Real>(order, value, bound(g.terms, order + 1), until);
    }
    return fall(g, from, until, search);
  }
  // The same in [from, until).
  std::optional<Real> fall(const Function& g, const Real& from, const Real& until,
                           Search<Real>& search) const {
    if (from == 0 && get(g.terms, 0) >= 0) {
      const SeriesAt<Real> end = sum<Real>(g.terms, until * over_h_);
      if (stays_open(get(g.terms, 0), Real(over_h_ * get(g.terms, 1)), end.u, Real(over_h_ * end.u1), until,
                     bound(g.terms, 4)))
        return {};
    }
    return isolate_fall<Real>([&](const Real& t) { return enclosure(g, t); }, from, until, search, h_);
  }

  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            Search<Real>& search) const {
    return fall(function(x_, sign, order), from, until, search);
  }
  std::array<Real, 4> leads_of_x() const {
    return {get(x_, 0), over_h_ * get(x_, 1), 2 * get(x_, 2) * over_h_ * over_h_,
            6 * get(x_, 3) * over_h_ * over_h_ * over_h_};
  }
  LocalEnclosure<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t,
                                       const Real&) const {
    return enclosure(function(x_, sign, order), t);
  }
  Real panel(const Real&) const { return length_; }
  Real resolution() const { return h_; }

 private:
  struct Unused {};
  // Returns the rate (M17.17) of the walls with K < `follow_from`.
  static Real rate_for(const Real& zeta, const Force& forcing, const std::vector<PushedWall<Real>>& walls,
                       const Real& follow_from) {
    Real all_k{0}, most_k{0}, all_c{0}, most_c{0};
    for (const auto& [nu, stiffness, damping, q, w] : walls) {
      if (stiffness >= follow_from) continue;
      all_k += nu * stiffness;
      all_c += nu * damping;
      if (stiffness > most_k) most_k = stiffness;
      if (damping > most_c) most_c = damping;
    }
    return square_root(Real(1 + all_k + most_k)) + 2 * zeta + all_c + most_c +
           (forcing ? forcing.frequency : Real(0));
  }
  // Returns the order of the first derivative of x at the beginning, from x'' on, that is not zero (M7.12),
  // but no higher one than the series has.
  std::size_t order_of_lead() const {
    if constexpr (components) {
      std::size_t order = 2;
      while (order + 2 < joint_terms && get(x_, order) == 0) ++order;
      return order;
    }
    std::vector<PushedWall<Real>> walls;
    for (std::size_t i = 0; i < nu_.size(); ++i)
      walls.push_back({nu_[i], spring_[i] * over_h_ * over_h_, damping_[i] * over_h_, q_[i],
                       over_h_ * q_[nu_.size() + i]});
    for (const Follower& each : followers_) {
      walls[each.index].stiffness = each.spring * over_h_ * over_h_;
      walls[each.index].damping = each.damping * over_h_;
    }
    const std::size_t order =
        lead_of_x<Real>(2 * zeta_, Real(1), forcing_, phase_, get(x_, 0), over_h_ * get(x_, 1), walls).order;
    return order > 0 && order + 1 < joint_terms ? order : joint_terms - 2;
  }
  // Computes the terms of x from its first two, and those of each q that leads, by (M17.16). Those of the
  // walls that follow come from follow().
  void expand(std::array<Real, joint_terms>& x) {
    const std::size_t count = nu_.size();
    const auto& [sin, cos] = phase_;
    // angle: that of the force's phase in one unit of time.
    const Real h_2 = h_ * h_, angle = h_ * forcing_.frequency;
    Real f_now = h_2 * (forcing_.amplitude * sin), f_next = h_2 * (forcing_.amplitude * (angle * cos));
    const auto& over = reciprocals<Real>;
    for (std::size_t n = 0; n + 2 < joint_terms; ++n) {
      const Real both = over[n + 1] * over[n + 2], next = Real(double(n + 1));
      const Real *now = q_.data() + n * count, *rate = now + count;
      Real* const after = q_.data() + (n + 2) * count;
      for (std::size_t i = 0; i < count; ++i)
        force_[i] = next * damping_[i] * rate[i] + spring_[i] * now[i];  // (M17.9)
      Real sum = f_now - 2 * zeta_ * h_ * next * x[n + 1] - h_2 * x[n];
      if constexpr (components) {
        if (n == 0) {
          sum += h_2 * (forces_->others - forces_->held * forces_->weight);
          for (std::size_t i = 0; i < count; ++i) force_[i] += h_2 * forces_->friction[i];
        }
      }
      for (std::size_t i = 0; i < count; ++i) sum += nu_[i] * force_[i];
      if constexpr (components)
        sum /= mass_;
      else if (!followers_.empty())
        sum = (sum - pull_[n]) / mass_;
      x[n + 2] = sum * both;
      if constexpr (components)
        if (n == 0) sum += h_2 * forces_->weight;
      for (std::size_t i = 0; i < count; ++i) after[i] = -(sum + force_[i]) * both;
      const Real f_after = -angle * angle * f_now * both;
      f_now = f_next;
      f_next = f_after;
    }
  }
  // Computes the terms of each q that follows from those of x by (M17.22), K q = -(x'' + q'') - c q', from
  // the highest order down.
  void follow(const std::array<Real, joint_terms>& x) {
    const std::size_t count = nu_.size();
    pull_.fill(Real(0));
    for (const auto& [i, spring, damping] : followers_) {
      Real next{0}, second{0};  // those of order n + 1 and n + 2
      for (std::size_t n = joint_terms; n-- > 0;) {
        const Real both = Real(double((n + 1) * (n + 2)));
        pull_[n] += nu_[i] * both * second;
        const Real of_z = n + 2 < joint_terms ? Real(x[n + 2] + second) : Real(0);  // z = x + q
        const Real now = -(both * of_z + double(n + 1) * damping * next) / spring;
        second = next;
        next = q_[n * count + i] = now;
      }
    }
  }
  // The sum of the sizes of the terms that make up h^2 x'' at the beginning, without the force.
  Real rounding_size() const {
    const std::size_t count = nu_.size();
    Real size = h_ * h_ * absolute(get(x_, 0)) + 2 * zeta_ * h_ * absolute(get(x_, 1));
    for (std::size_t i = 0; i < count; ++i)
      size += nu_[i] * absolute(damping_[i] * q_[count + i] + spring_[i] * q_[i]);
    return size;
  }
  static Real get(const Terms& terms, std::size_t n) { return terms[n / 2][n % 2]; }
  static void set(Terms& terms, std::size_t n, const Real& value) {
    terms[n / 2] =
        n % 2 == 0 ? SimdPair<Real>{value, terms[n / 2][1]} : SimdPair<Real>{terms[n / 2][0], value};
  }
  // n (n - 1) ..., with `order` factors.
  static Real falling(std::size_t n, std::size_t order) {
    static constexpr auto all = [] {
      std::array<std::array<double, joint_terms>, 7> of{};
      for (std::size_t k = 0; k < of.size(); ++k)
        for (std::size_t m = k; m < joint_terms; ++m)
          of[k][m] = k == 0 ? 1 : of[k - 1][m] * double(m - (k - 1));
      return of;
    }();
    return Real(all[order][n]);
  }
  Terms terms_of(std::size_t i) const {
    const std::size_t count = nu_.size();
    Terms q;
    for (std::size_t n = 0; n < q.size(); ++n)
      q[n] = SimdPair<Real>{q_[2 * n * count + i], q_[(2 * n + 1) * count + i]};
    return q;
  }
  // Returns sign times the `order`-th derivative by t of a series; order is 0, 1 or 2.
  Function function(const Terms& terms, const Real& sign, std::size_t order) const {
    Function g{};
    Real factor = sign;
    for (std::size_t k = 0; k < order; ++k) factor *= over_h_;
    for (std::size_t n = 0; n + order < joint_terms; ++n) {
      const Real falling = order == 0   ? Real(1)
                           : order == 1 ? Real(double(n + 1))
                                        : Real(double((n + 1) * (n + 2)));
      set(g.terms, n, factor * (falling * get(terms, n + order)));
    }
    g.third = bound(g.terms, 3);
    g.order = order;
    return g;
  }

  [[no_unique_address]] std::conditional_t<components, const ConstantForces<Real>*, Unused> forces_{};
  Real zeta_{0};
  Force forcing_{};
  SinCos<Real> phase_{};  // of the force, when the piece begins
  Real length_{0};
  // The unit of time of the series, a power of two, so that no number is rounded by it: the rounding would be
  // the same in every piece, and add up.
  Real h_{1}, over_h_{1};
  std::vector<Real> nu_, spring_, damping_;  // of each wall: nu, h^2 K, h c; the last two 0 if it follows
  struct Follower {
    std::size_t index;
    Real spring, damping;
  };
  std::vector<Follower> followers_;
  Real mass_{1};                          // of the primary mass and the walls that follow
  std::array<Real, joint_terms> pull_{};  // terms of h^2 sum nu q'' over these (M17.22)
  std::vector<Real> q_;                   // the terms of order 0 of all walls, then those of order 1 ...
  std::vector<Real> force_;
  Terms x_{};
  std::array<Real, joint_terms>
      fourth_weight_{};  // |q''''| of a wall is at most the sum of these times the sizes of its terms
  Real end_{-1};         // the time of look_until(), for which these hold:
  std::vector<Real> end_q_, end_w_, fourth_;
};

}  // namespace impact_damper
