// x of one oscillator, with or without a force: in flight (flight.hpp), and where both masses move as one
// (sticking.hpp). From its beginning it follows in closed form (M3.2), and under a force by its series (M4.4)
// while that holds.
//
// Times are since the beginning of the motion.
#pragma once

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/events/halley.hpp"
#include "impact_damper/events/impact_prediction.hpp"
#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/motion/driven_series.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/motion/system.hpp"

namespace impact_damper {

// Returns the length of a quadrature panel (Oscillator::panel), at most six radians of the force.
template <class Real, class Force>
Real panel_under(const Force& forcing, const Real& panel) {
  return forcing && panel * forcing.frequency > 6 ? Real(6 / forcing.frequency) : panel;
}

// x of a single oscillator, with or without a force, and bounds on its derivatives.
template <class Real, class Force = Forcing<Real>>
class ForcedMotion {
 public:
  ForcedMotion(const Driven<Real, Force>& oscillator, const Force& forcing, const Real& begin, const Real& x0,
               const Real& v0)
      : ForcedMotion(oscillator, forcing, begin, forcing.phase(begin), x0, v0) {}
  // phase: of the force at the beginning.
  ForcedMotion(const Driven<Real, Force>& oscillator, const Force& forcing, const Real& begin,
               const SinCos<Real>& phase, const Real& x0, const Real& v0)
      : oscillator_(oscillator),
        forcing_(forcing),
        begin_(begin),
        phase_(phase),
        x0_(x0),
        v0_(v0),
        cached_(*this) {}

  // The departures are computed without cancellation.
  Displacement<Real> at(const Real& t) const {
    if (t == 0) return {x0_, v0_, Real(0), Real(0)};
    if constexpr (forced) {
      if (t <= reach()) {
        const SeriesAt<Real> by = departure(t);
        return {x0_ + (v0_ * t + by.u), v0_ + by.u1, by.u, by.u1};
      }
    }
    const Propagator<Real> p = oscillator_.propagate(t);
    Displacement<Real> now;
    now.x = x0_ * p.c + v0_ * p.s;
    now.dx = x0_ * p.c1 + v0_ * p.s1;
    const Real from_x = -x0_ * oscillator_.b() * p.s;
    now.dv = v0_ * (p.c1 - 2 * oscillator_.a() * p.s) + from_x;
    now.v = v0_ * p.v + from_x;
    if (forcing_) {
      const DrivenResponse<Real> driven = oscillator_.respond(forcing_, phase_, t, p);
      now.x += driven.d;
      now.dx += driven.d;
      now.dv += driven.d1;
      now.v += driven.d1;
    }
    return now;
  }

  template <std::size_t N>
  Instant<Real, N, Force> instant(const Real& x, const Real& v, const Real& t) const {
    return {oscillator_, x, v, Real(1), Real(0), forcing_, phase_at(t)};
  }
  // Returns the derivatives of `times` x. The arguments x and v have been multiplied by `times` already.
  template <std::size_t N>
  Derivatives<Real, N> derivatives(const Real& x, const Real& v, const Real& t, const Real& times) const {
    if (!forcing_) return impact_damper::derivatives<N>(oscillator_, x, v);
    return impact_damper::derivatives<N>(oscillator_, x, v, times, Real(0),
                                         forcing_.template derivatives<N + 1>(phase_at(t)));
  }
  // A bound on the fourth derivative of `times` x for a time `span` from t on. d: its derivatives at t.
  template <std::size_t N>
  Real fourth(const Derivatives<Real, N>& d, const Real& x, const Real& v, const Real& t, const Real& times,
              const Real& span) const {
    if (!forcing_) return oscillator_.bound(d[4], d[5]);
    return Instant<Real, 6, Force>{oscillator_, x, v, times, Real(0), forcing_, phase_at(t)}.bound(4, span);
  }
  // The derivatives at the beginning. Under a force they suffice for a bound on the fourth derivative of x''.
  static constexpr bool forced = !std::is_same_v<Force, NoForcing<Real>>;
  using Beginning = Instant<Real, forced ? 8 : 6, Force>;
  // A bound on |x^(n)| for a time `span` from the beginning on; n <= 6, without a force n <= 4.
  Real bound(std::size_t n, const Real& span) const {
    if constexpr (forced) {
      // Under a fast force the steady state may give the smaller of the two bounds (M3.4). Else only the
      // bound that grows with `span` is computed, from the series, which is there already. Its coefficients
      // differ from the derivatives by a smaller factor than `above` (M4.5).
      const DrivenSeriesTable<Real>& table = oscillator_.series;
      const Real& f0 = forcing_.amplitude;
      constexpr double above = 1 + 1.0 / 1048576;
      const Real d = series().derivative(n), next = series().derivative(n + 1);
      const Real growing = above * (oscillator_.bound(d, next) + absolute(f0) * table.growth(n) * span);
      if (!table.fast()) return growing;
      const auto& [in_phase, behind, amplitude] = table.steady();
      const Real minus_square = -forcing_.frequency * forcing_.frequency;
      Real power = f0;
      for (std::size_t i = 1; i < n; i += 2) power *= minus_square;
      const Real even = power * (in_phase * phase_.sin - behind * phase_.cos),
                 odd = power * forcing_.frequency * (in_phase * phase_.cos + behind * phase_.sin);
      const bool is_even = n % 2 == 0;
      const Real s = is_even ? even : odd, s_next = is_even ? odd : Real(minus_square * even);
      const Real size = absolute(power) * amplitude * (is_even ? Real(1) : forcing_.frequency);
      const Real steady = above * (size + oscillator_.bound(d - s, next - s_next));
      return steady < growing ? steady : growing;
    } else {
      return beginning().bound(n, span);
    }
  }
  decltype(auto) beginning() const {
    if constexpr (forced) {
      if (!cached_.beginning)
        cached_.beginning.emplace(oscillator_, x0_, v0_, Real(1), Real(0), forcing_, phase_);
      return static_cast<const Beginning&>(*cached_.beginning);
    } else {
      return instant<6>(x0_, v0_, Real(0));
    }
  }

  // The first derivative of x at the beginning, from x'' on, that is not zero to rounding (M7.12).
  Lead<Real> lead() const {
    return lead_of_x(Real(2 * oscillator_.a()), oscillator_.b(), forcing_, phase_, x0_, v0_);
  }

  // Whether x (keeps_side), or x' (keeps_course), is proved to keep its sign in [0, t], from x and v at both
  // ends.
  bool keeps_side(const Real& side, const Real& x, const Real& v, const Real& t) const {
    if (!(side * x0_ > 0 && side * x >= 0)) return false;  // a zero at the end is the next motion's
    if constexpr (forced) {
      const Real fourth = t <= reach() ? fourth_until_reach() : bound(4, t);
      return stays_open(Real(side * x0_), Real(side * v0_), Real(side * x), Real(side * v), t, fourth);
    } else {
      return t < oscillator_.half_period();
    }
  }
  bool keeps_course(const Real& v, const Real& t) const {
    if (!(v0_ * v > 0)) return false;
    if constexpr (forced) {
      if (keeps_sign(v0_, v, bound(3, t), t)) return true;
      if (!(t <= reach())) return false;
      const Real sign = v > 0 ? 1 : -1;
      return stays_open(Real(sign * v0_), Real(sign * series().derivative(2)), Real(sign * v),
                        Real(sign * departure(t).u2), t, bound(5, t));
    } else {
      return t < oscillator_.half_period();
    }
  }
  // Returns a time after t within which x' has at most one zero; without a force x and every derivative, too.
  Real one_turn_within(const Real& t) const {
    if constexpr (forced) {
      if (!(t < reach())) return 0;
      // While x'' keeps its sign x' has at most one zero, and |x'''| <= m proves that for a time |x''(t)|/m.
      const Real rest = reach() - t, within = absolute(departure(t).u2) / bound(3, reach());
      return within < rest ? within : rest;
    } else {
      return oscillator_.half_period();
    }
  }
  // Whether x, zero at `from`, is proved to have no other zero until t, when its velocity is v.
  bool leaves_zero(const Real& from, const Real& v, const Real& t) const {
    return forcing_ ? absolute(v) > bound(2, t) * (t - from) : t < from + oscillator_.half_period();
  }
  // The first time in [from, until) at which sign times the `order`-th derivative of x falls through zero.
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            Search<Real>& search) const {
    if constexpr (forced)
      if (const auto predicted = predicted_fall(order, sign, from, until)) return predicted->time;
    if (forcing_ || !(oscillator_.half_period() < std::numeric_limits<Real>::infinity()))
      return isolate_fall<Real>([&](const Real& t) { return enclosure_at(order, sign, t, search.span); },
                                from, until, search, Real(1));
    const auto x = derivatives<4>(x0_, v0_, Real(0), Real(1));
    const Real u = sign * x[order], u1 = sign * x[order + 1];
    if (u == 0 && u1 == 0) return {};
    if (!(from > 0) && u <= 0 && u1 < 0) return from < until ? std::optional(from) : std::nullopt;
    const Real time = oscillator_.fall(u, u1, from);
    return time < until ? std::optional(time) : std::nullopt;
  }
  // Returns |x| at a turning point, x'(t) = 0.
  Real height(const Real& t) const {
    if (forcing_ || !(oscillator_.half_period() < std::numeric_limits<Real>::infinity()))
      return absolute(at(t).x);
    return oscillator_.height(x0_, v0_, t);
  }
  // Returns the last turning point of x, x' = 0, before t, the first zero of x''; nothing where it has no
  // closed form.
  std::optional<Real> turning_point_before(const Real& t) const {
    const Real& half_period = oscillator_.half_period();
    if (forcing_ || !(half_period < std::numeric_limits<Real>::infinity()) || !(t < half_period)) return {};
    return t - oscillator_.peak_to_inflection();
  }
  // Returns |x'| at a zero of x'' at t, where x is -2a/b times x'; nothing where it has no closed form.
  std::optional<Real> speed_at_inflection(const Real& t) const {
    if (forcing_ || !(oscillator_.half_period() < std::numeric_limits<Real>::infinity())) return {};
    const auto x = derivatives<4>(x0_, v0_, Real(0), Real(1));
    return oscillator_.height(x[1], x[2], t);
  }
  Real per_speed() const { return 2 * oscillator_.a() / oscillator_.b(); }
  // Encloses sign times the `order`-th derivative of x for a time `span` from t on.
  LocalEnclosure<Real> enclosure_at(std::size_t order, const Real& sign, const Real& t,
                                    const Real& span) const {
    const Displacement<Real> now = at(t);
    const auto x = instant<7>(now.x, now.v, t);
    return {{sign * x[order], sign * x[order + 1], sign * x[order + 2], x.bound(order + 3, span)}};
  }

  // The largest modulus of an eigenvalue, or omega_f if that is larger.
  Real rate() const {
    return forcing_ && forcing_.frequency > oscillator_.rate() ? forcing_.frequency : oscillator_.rate();
  }
  Real panel(const Real& t) const { return panel_under(forcing_, oscillator_.panel(t)); }

  // The series under a force about the beginning of the motion. It holds for reach().
  const DrivenSeries<Real>& series() const { return cached_.series; }
  // The departure of x from its straight line at t, by the series. The values at its end and at the latest
  // other time are kept: both are often needed again.
  const SeriesAt<Real>& departure(const Real& t) const {
    if (t == cached_.time) return cached_.then;
    if (t == reach()) {
      if (!cached_.at_reach) cached_.at_reach = series().departure().at(t);
      return *cached_.at_reach;
    }
    cached_.time = t;
    return cached_.then = series().departure().at(t);
  }
  const Real& reach() const { return oscillator_.series.reach(); }
  // A bound on |x''''| while the series holds.
  const Real& fourth_until_reach() const {
    if (cached_.fourth < 0) cached_.fourth = bound(4, reach());
    return cached_.fourth;
  }
  // How long the motion is followed as one piece: under a force as long as the series holds. But a fast force
  // or strong damping would cut a slow motion into many pieces: then the closed form is cheaper.
  Real length() const {
    if constexpr (forced)
      if (forcing_.frequency <= 64 * oscillator_.root_b() && oscillator_.rate() <= 4 * oscillator_.root_b())
        return reach();
    return std::numeric_limits<Real>::infinity();
  }

 private:
  SinCos<Real> phase_at(const Real& t) const { return t == 0 ? phase_ : forcing_.phase(begin_ + t); }
  // Returns sign times x (order 0) or x' (order 1), and its derivative, by the series.
  std::array<Real, 2> x_or_v(std::size_t order, const Real& sign, const Real& t) const {
    const SeriesAt<Real> by =
        t == 0 ? SeriesAt<Real>{Real(0), Real(0), series().derivative(2)} : departure(t);
    const Real v = v0_ + by.u1;
    if (order == 1) return {sign * v, sign * by.u2};
    return {sign * (x0_ + (v0_ * t + by.u)), sign * v};
  }
  // The result of falls(), if Lemma L2 proves it: the fall that Halley's method finds on the series is the
  // first; or, with an empty `time`, there is none before `until`. Nothing where neither is proved. The time
  // of a fall does not depend on `until`, so a shorter run is the beginning of a longer one.
  struct PredictedFall {
    std::optional<Real> time;
  };
  std::optional<PredictedFall> predicted_fall(std::size_t order, const Real& sign, const Real& from,
                                              const Real& until) const {
    if (!(from < reach())) return {};
    const Real fourth = order == 0 ? fourth_until_reach() : bound(order + 4, reach());
    const bool whole = until <= reach();
    // The ends alone show most often that x or x' does not fall.
    if (whole && order < 2) {
      const auto [end, end_slope] = x_or_v(order, sign, until);
      auto [begin, slope] = from == cached_.zero.time && order == cached_.zero.order
                                ? std::array<Real, 2>{Real(0), sign * cached_.zero.slope}
                                : x_or_v(order, sign, from);
      if (begin < 0 && from > 0) begin = 0;
      if (end > 0 && (begin > 0 || slope > 0) &&
          stays_open(begin, slope, end, end_slope, Real(until - from), fourth))
        return PredictedFall{};
    }
    const auto g = series().derivative(order, sign);
    SeriesAt<Real> begin = from == 0 ? SeriesAt<Real>{g[0][0], g[0][1], 2 * g[1][0]} : sum<Real>(g, from);
    // After the beginning a search starts where g is positive, or at a zero of g that has just been left: if
    // g is negative there, then by rounding.
    if (begin.u < 0 && from > 0) begin.u = 0;
    if (begin.u < 0 || (begin.u == 0 && !(begin.u1 > 0))) return {};
    if (const auto root = root_of_series(g, begin, from, reach())) {
      if (root->slope < 0 &&
          stays_open(begin.u, begin.u1, Real(0), root->slope, Real(root->time - from), fourth)) {
        cached_.zero = {order, root->time, sign * root->slope};
        return PredictedFall{root->time < until ? std::optional(root->time) : std::nullopt};
      }
    }
    if (!whole) return {};
    const SeriesAt<Real> end = sum<Real>(g, until);
    if (stays_open(begin.u, begin.u1, end.u, end.u1, Real(until - from), fourth)) return PredictedFall{};
    return {};
  }
  const Driven<Real, Force>& oscillator_;
  Force forcing_;
  Real begin_;
  SinCos<Real> phase_;  // of the force at the beginning
  Real x0_, v0_;
  // All but the series is made at the first call; without a force there is nothing.
  struct Nothing {
    explicit Nothing(const ForcedMotion&) {}
  };
  struct Cached {
    explicit Cached(const ForcedMotion& motion)
        : series(motion.oscillator_.series, motion.x0_, motion.v0_,
                 motion.forcing_.amplitude * motion.phase_.sin,
                 motion.forcing_.amplitude * motion.phase_.cos) {}
    DrivenSeries<Real> series;
    Real fourth{-1};  // none yet
    Real time{-1};    // the latest time of departure(t)
    SeriesAt<Real> then{};
    std::optional<SeriesAt<Real>> at_reach{};
    struct Zero {
      std::size_t order;
      Real time{-1}, slope;
    } zero{};  // of the x or x' that fell last
    std::optional<Beginning> beginning{};
  };
  [[no_unique_address]] mutable std::conditional_t<forced, Cached, Nothing> cached_;
};

// What `MotionOf` (motion.hpp) asks for of x, of a Motion in which no wall pushes the primary mass, alone or
// with masses that stick to it: its primary(), a ForcedMotion, has it.
template <class Motion, class Real>
class WithoutContact {
 public:
  bool keeps_side(const Real& side, const State<Real>& end, const Real& t) const {
    return primary().keeps_side(side, end.x, end.v, t);
  }
  bool keeps_course(const Real&, const State<Real>& end, const Real& t) const {
    return primary().keeps_course(end.v, t);
  }
  bool leaves_zero(const Real& from, const State<Real>& end, const Real& t) const {
    return primary().leaves_zero(from, end.v, t);
  }
  Real one_turn_within(const Real& t) const { return primary().one_turn_within(t); }
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            Search<Real>& search) const {
    return primary().falls(order, sign, from, until, search);
  }
  Real height(const Real& t) const { return primary().height(t); }
  LocalEnclosure<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t,
                                       const Real& span) const {
    return primary().enclosure_at(order, sign, t, span);
  }
  auto leads_of_x() const { return primary().beginning(); }
  Real panel(const Real& t) const { return primary().panel(t); }
  Real resolution() const { return 1; }

 private:
  const auto& primary() const { return static_cast<const Motion&>(*this).primary(); }
};

}  // namespace impact_damper
