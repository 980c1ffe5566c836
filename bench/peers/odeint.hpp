// Boost.odeint with events: Runge-Kutta-Fehlberg 78, whose steps are repeated up to an event, and dopri5,
// whose dense output is searched for it.
//
// After every step the guards and x, x' are compared at its two ends; what changed sign is solved for by
// Newton's method inside a bracket, to the last bits of the step. A gap that closes and opens again within a
// step is looked for where the cubic through its two ends dips. Each regime keeps the step length that it
// last went with.
#pragma once

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <optional>
#include <stdexcept>

#include "peers/hybrid_system.hpp"
#include "rows.hpp"

namespace impact_damper::bench {

namespace odeint = boost::numeric::odeint;

// odeint's view of the system; t counts from the beginning of the regime, so that a short contact late in a
// run is resolved as well as one at its start.
template <class System>
struct OdeintSystem {
  using Real = typename System::Real;
  using State = typename System::State;
  const System* system;
  Real origin{0};
  void operator()(const State& u, State& du, const Real& t) const { system->derivative(u, du, origin + t); }
};

// One step from (t, u) at a time, and any state inside it.
template <class System>
class Fehlberg {
 public:
  using Real = typename System::Real;
  using State = typename System::State;
  using Method = odeint::runge_kutta_fehlberg78<State, Real, State, Real, odeint::array_algebra>;

  explicit Fehlberg(const Real& tolerance)
      : controlled_(odeint::make_controlled<Method>(tolerance, tolerance)) {}

  void restart(const State& u, const Real& step) {
    begin_ = end_ = u;
    t0_ = t1_ = 0;
    next_ = step;
  }
  void step(const OdeintSystem<System>& system, const Real& longest) {
    t0_ = t1_;
    begin_ = end_;
    if (next_ > longest) next_ = longest;
    for (int tries = 0; controlled_.try_step(system, end_, t1_, next_) == odeint::fail; ++tries) {
      if (tries == 100) throw std::runtime_error("odeint: no step is short enough");
    }
  }
  State at(const OdeintSystem<System>& system, const Real& t) {
    State u;
    method_.do_step(system, begin_, t0_, u, Real(t - t0_));
    return u;
  }
  const State& begin() const { return begin_; }
  const State& end() const { return end_; }
  const Real& t0() const { return t0_; }
  const Real& t1() const { return t1_; }
  const Real& next_step() const { return next_; }

 private:
  decltype(odeint::make_controlled<Method>(Real(), Real())) controlled_;
  Method method_;
  State begin_{}, end_{};
  Real t0_{0}, t1_{0}, next_{0};
};

template <class System>
class DormandPrince {
 public:
  using Real = typename System::Real;
  using State = typename System::State;
  using Method = odeint::runge_kutta_dopri5<State, Real, State, Real, odeint::array_algebra>;

  explicit DormandPrince(const Real& tolerance)
      : dense_(odeint::make_dense_output<Method>(tolerance, tolerance)) {}

  void restart(const State& u, const Real& step) { dense_.initialize(u, Real(0), step); }
  void step(const OdeintSystem<System>& system, const Real& longest) {
    // Only a restart can shorten the step that the stepper has chosen.
    if (dense_.current_time_step() > longest) {
      dense_.initialize(State(dense_.current_state()), dense_.current_time(), longest);
    }
    dense_.do_step(system);
  }
  State at(const OdeintSystem<System>&, const Real& t) {
    State u;
    dense_.calc_state(t, u);
    return u;
  }
  const State& begin() const { return dense_.previous_state(); }
  const State& end() const { return dense_.current_state(); }
  Real t0() const { return dense_.previous_time(); }
  Real t1() const { return dense_.current_time(); }
  Real next_step() const { return dense_.current_time_step(); }

 private:
  decltype(odeint::make_dense_output<Method>(Real(), Real())) dense_;
};

template <class System, template <class> class Stepper>
class OdeintRun {
 public:
  using Real = typename System::Real;
  using State = typename System::State;

  OdeintRun(const Scene& scene, Walls walls, const Real& tolerance)
      : scene_(scene),
        system_(scene, walls),
        view_{&system_},
        stepper_(tolerance),
        rows_(scene.x0, scene.until_amplitude) {
    for (std::size_t pace = 0; pace < System::paces; ++pace) longest_[pace] = system_.longest_step(pace);
    steps_ = longest_;
    for (Real& step : steps_) step /= 16;
  }

  Rows run() {
    const Real end = scene_.until_time ? Real(*scene_.until_time) : Real(1e6);
    restart(system_.state, Real(0));
    for (;;) {
      const std::size_t pace = system_.pace();
      stepper_.step(view_, longest_[pace]);
      const std::size_t guard = find_guard();
      const bool passed = guard < System::guards;
      const Real until = guard_time_;
      State last = guard_state_;
      if (observe(until, last, end)) break;
      const Real now = view_.origin + until;
      if (now >= end) break;
      if (!passed) continue;
      rows_.peak(double(now), double(last[0]));  // x' may jump here
      steps_[pace] = stepper_.next_step();
      if (system_.pass(guard, last, now)) rows_.impact();
      restart(last, now);
    }
    return rows_.finish();
  }

 private:
  void restart(const State& u, const Real& now) {
    view_.origin = now;
    stepper_.restart(u, steps_[system_.pace()]);
    // What is zero at a regime's beginning has the sign of its rate; a guard is open.
    for (std::size_t i = 0; i < System::events; ++i) {
      const Real g = i < System::guards ? Real(1) : system_.event(i, u, now);
      positive_[i] = g > 0 || (g == 0 && system_.event_rate(i, u, now) > 0);
    }
  }

  Real value(std::size_t which, const State& u, const Real& t) const {
    return system_.event(which, u, view_.origin + t);
  }

  // Where an event that is positive (or not) at the begin of [low, high] is no longer so. Newton from the
  // end that the caller guesses, held in the bracket.
  template <class Value, class Rate>
  Real solve(bool positive, Real low, Real high, const Real& guess, Value&& value_at, Rate&& rate_at) {
    Real t = guess;
    const Real resolution = 2 * std::numeric_limits<Real>::epsilon() * high;
    for (int i = 0; i < 100; ++i) {
      const State u = stepper_.at(view_, t);
      const Real g = value_at(u, t);
      (g == 0 || (g > 0) != positive ? high : low) = t;
      const Real rate = rate_at(u, t);
      Real next = rate != 0 ? Real(t - g / rate) : Real((low + high) / 2);
      if (!(next >= low && next <= high)) next = (low + high) / 2;
      const Real move = next > t ? next - t : t - next;
      t = next;
      if (move <= resolution || high - low <= resolution) break;
    }
    return t;
  }
  Real solve(std::size_t which, Real low, Real high) {
    const Real a = value(which, stepper_.begin(), stepper_.t0()), b = value(which, stepper_.end(), high);
    const Real guess = a != b && a != 0 ? Real(low + (high - low) * (a / (a - b))) : Real((low + high) / 2);
    return solve(
        positive_[which], low, high, std::clamp(guess, low, high),
        [&](const State& u, const Real& t) { return value(which, u, t); },
        [&](const State& u, const Real& t) { return system_.event_rate(which, u, view_.origin + t); });
  }

  // Which guard is passed first in the step, and when and in which state; events if none is.
  std::size_t find_guard() {
    std::size_t first = System::events;
    guard_time_ = stepper_.t1();
    guard_state_ = stepper_.end();
    for (std::size_t i = 0; i < System::guards; ++i) {
      Real high = guard_time_;
      if (value(i, guard_state_, high) > 0) {
        const std::optional<Real> dip = system_.flies(i) ? find_dip(i) : std::nullopt;
        if (!dip || !(*dip < high) || value(i, stepper_.at(view_, *dip), *dip) > 0) continue;
        high = *dip;
      }
      const Real t = solve(i, stepper_.t0(), high);
      if (first < System::events && guard_time_ <= t) continue;
      first = i;
      guard_time_ = t;
      guard_state_ = stepper_.at(view_, t);
    }
    return first;
  }

  // Where in a step of flight a gap that is open at both ends is least, if the cubic through the two ends
  // comes near closing it.
  std::optional<Real> find_dip(std::size_t guard) {
    using std::sqrt;
    const Real t0 = stepper_.t0(), h = stepper_.t1() - t0, away = guard % 2 == 0 ? 1 : -1;
    const std::size_t speed = System::speed_of(guard);
    const Real g0 = value(guard, stepper_.begin(), t0), g1 = value(guard, stepper_.end(), stepper_.t1());
    const Real r0 = h * away * stepper_.begin()[speed], r1 = h * away * stepper_.end()[speed];
    const Real c = 3 * (g1 - g0) - 2 * r0 - r1, d = r0 + r1 - 2 * (g1 - g0);  // g0 + r0 s + c s^2 + d s^3
    const Real square = c * c - 3 * d * r0;
    if (!(square > 0) || !(r1 > 0)) return std::nullopt;
    const Real root = sqrt(square);
    const Real s = c > 0 ? Real(-r0 / (c + root)) : Real((root - c) / (3 * d));
    if (!(s > 0 && s < 1) || g0 + s * (r0 + s * (c + s * d)) > Real(0.02)) return std::nullopt;
    // From where the cubic falls steepest the gap's rate grows.
    const Real low = d > 0 && c < 0 ? Real(t0 + h * (-c / (3 * d))) : t0;
    if (!(away * stepper_.at(view_, low)[speed] < 0)) return std::nullopt;
    return solve(
        away < 0, low, stepper_.t1(), Real(t0 + h * s), [&](const State& u, const Real&) { return u[speed]; },
        [&](const State& u, const Real& t) {
          State du{};
          system_.derivative(u, du, view_.origin + t);
          return du[speed];
        });
  }

  // Peaks and zero crossings up to `until`, in their order; true if the scene ends at one of them.
  bool observe(const Real& until, const State& last, const Real& end) {
    std::array<std::pair<Real, std::size_t>, 2> seen;
    std::size_t n = 0;
    for (std::size_t i = System::guards; i < System::events; ++i) {
      const Real g = value(i, last, until);
      if (g == 0 || (g > 0) == positive_[i]) continue;
      seen[n++] = {solve(i, stepper_.t0(), until), i};
      positive_[i] = !positive_[i];
    }
    if (n == 2 && seen[1].first < seen[0].first) std::swap(seen[0], seen[1]);
    for (std::size_t j = 0; j < n; ++j) {
      const Real now = view_.origin + seen[j].first;
      if (now > end) return true;
      if (seen[j].second == System::guards + 1) {
        rows_.peak(double(now), double(stepper_.at(view_, seen[j].first)[0]));
      } else if (rows_.zero_crossing(double(now))) {
        return true;
      }
    }
    return false;
  }

  const Scene& scene_;
  System system_;
  OdeintSystem<System> view_;
  Stepper<System> stepper_;
  RowBook rows_;
  std::array<Real, System::paces> longest_, steps_;
  std::array<bool, System::events> positive_{};
  Real guard_time_{0};
  State guard_state_{};
};

// By DormandPrince, a list of as many dampers as a scene of the bench has (odeint_dampers.cpp).
Rows run_dampers(const Scene& scene, Walls walls, double tolerance);

}  // namespace impact_damper::bench
