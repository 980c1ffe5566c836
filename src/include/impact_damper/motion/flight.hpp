// Flight, 0 < y < 1: (M2.1). The secondary mass flies straight, z = x + y = z0 + z'0 t. Several dampers share
// the motion of their primary mass, and each has a clearance of its own (engines/secondary_masses.hpp).
#pragma once

#include "impact_damper/events/impact_prediction.hpp"
#include "impact_damper/motion/forced_motion.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

// The clearance of a single damper, the unit of length, and that of one of several dampers.
template <class Real>
struct UnitClearance {
  static constexpr Real gap() { return Real(1); }
};
template <class Real>
struct OwnClearance {
  Real clearance;
  const Real& gap() const { return clearance; }
};

// A state in flight, with its distance u from the wall nearest to where the flight began: a small bounce
// keeps its relative accuracy, and a mirrored flight is the same to the bit.
template <class Real>
struct FlightStart {
  explicit FlightStart(const State<Real>& start)
      : state(copied(start)),
        wall(start.y > Real(0.5) ? 1 : 0),
        away(start.y > Real(0.5) ? -1 : 1),
        u(away * (start.y - wall)) {}
  // The start of a further piece of a flight.
  FlightStart(const State<Real>& now, const Real& which, const Real& direction, const Real& distance)
      : state(now), wall(which), away(direction), u(distance), goes_on(true) {}
  State<Real> state;
  Real wall, away;  // where the wall is, 0 or at the clearance, and which way leads away from it, 1 or -1
  Real u;
  bool goes_on = false;  // a piece of a flight that began before
};

// A motion of the secondary mass in flight. Primary: the type of the primary mass's motion, or a reference to
// it.
template <class Real, class Force = Forcing<Real>, class Clearance = UnitClearance<Real>,
          class Primary = ForcedMotion<Real, Force>>
class Flight : public WithoutContact<Flight<Real, Force, Clearance, Primary>, Real> {
 public:
  Flight(const System<Real, Force>& system, const Real& begin, const State<Real>& start)
      : Flight(system, begin, FlightStart<Real>(start)) {}
  Flight(const System<Real, Force>& system, const Real& begin, const FlightStart<Real>& start)
      : Flight(system, begin, system.forcing.phase(begin), start) {}
  // phase: of the force at the beginning.
  Flight(const System<Real, Force>& system, const Real& begin, const SinCos<Real>& phase,
         const FlightStart<Real>& start)
      : primary_(system.free, system.forcing, begin, phase, start.state.x, start.state.v),
        start_(start.state),
        wall_(start.wall),
        away_(start.away),
        u_(start.u),
        goes_on_(start.goes_on) {}
  Flight(const ForcedMotion<Real, Force>& primary, const Clearance& clearance, const FlightStart<Real>& start)
      : clearance_(clearance),
        primary_(primary),
        start_(start.state),
        wall_(start.wall),
        away_(start.away),
        u_(start.u),
        goes_on_(start.goes_on) {}

  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    return state_of(from_wall(t));
  }

  // The time after which, at the latest, the flight goes on as another piece, and the start of that piece at
  // t.
  Real length() const { return primary_.length(); }
  FlightStart<Real> start_of_rest(const Real& t) const {
    const FromWall now = from_wall(t);
    return {state_of(now), wall_, away_, now.u};
  }
  bool goes_on() const { return goes_on_; }  // as a piece of a flight that began before
  // Returns the first impact on a wall, if it is before `horizon`, which must not exceed length().
  std::optional<WallEvent<Real>> next_wall(const Real& horizon, Search<Real>& search) const {
    return met_from(Real(0), Real(0), horizon, search);
  }
  // Returns the same for a mass that begins at rest on a wall and leaves it.
  std::optional<WallEvent<Real>> released_meets_wall(const Real& horizon, Search<Real>& search) const {
    const Real begin = begin_by_lead_of_y(search.span);
    // No wall is met before `begin` (M7.4). The prediction begins there, too, because a y'' that differs from
    // zero by rounding alone may have the wrong sign. Only where y'' is exactly zero and y''' leads it begins
    // at 0: guess_by_parabola then uses y'''.
    const bool by_third = derivatives_of_y()[2] == 0 && primary_.lead().order <= 3;
    return met_from(by_third ? Real(0) : begin, begin, horizon, search);
  }
  // Returns the first impact in [from, horizon) by Lemma L1, step by step.
  std::optional<WallEvent<Real>> search_wall(const Real& from, const Real& horizon,
                                             Search<Real>& search) const {
    const auto met = first_root<Real>([&](const Real& t) { return gaps(t, search.span); }, from, horizon,
                                      search, this->resolution());
    if (!met) return {};
    const Wall wall = met->which == 0 ? Wall::left : Wall::right;
    const FromWall then = from_wall(met->time);
    State<Real> state = met->time == 0 ? start_ : state_of(then);
    state.y = wall == Wall::left ? Real(0) : gap();
    return WallEvent<Real>{met->time, wall, state, then.change};
  }
  // The first time in [from, until) at which sign times y' falls through zero.
  std::optional<Real> turn_of_y(const Real& sign, const Real& from, const Real& until,
                                Search<Real>& search) const {
    const auto enclose = [&](const Real& t) {
      const FromWall now = from_wall(t);
      const auto x = primary_.template instant<6>(now.x, now.v, t);
      return LocalEnclosure<Real>{
          {sign * away_ * now.u1, -sign * x[2], -sign * x[3], x.bound(4, search.span)}};
    };
    // A mass that begins at rest on a wall has y' = 0 there; rounding could show a second zero before
    // `begin`.
    const Real begin = start_.w == 0 && u_ == 0 ? begin_by_lead_of_y(search.span) : Real(0);
    return isolate_fall<Real>(enclose, from < begin ? begin : from, until, search, this->resolution());
  }
  // Encloses the two functions that fall through zero at an impact: the gap to the left wall, y, and the gap
  // to the right wall, both for a time `span` from t on.
  std::array<LocalEnclosure<Real>, 2> gaps(const Real& t, const Real& span) const {
    const FromWall now = from_wall(t);
    const Real near = now.u, far = gap() - now.u, y1 = away_ * now.u1;
    const Real left = away_ > 0 ? near : far, right = away_ > 0 ? far : near;
    const auto x = primary_.template instant<5>(now.x, now.v, t);
    const Real third = x.bound(3, span), amplitude = x.bound(0, span), z1 = y1 + now.v;
    return {
        LocalEnclosure<Real>{{left, y1, -x[2], third}, {left + now.x, z1, Real(0), Real(0)}, amplitude},
        LocalEnclosure<Real>{{right, -y1, x[2], third}, {right - now.x, -z1, Real(0), Real(0)}, amplitude}};
  }

  // y and its first three derivatives at the beginning.
  Derivatives<Real, 4> derivatives_of_y() const {
    const auto x = primary_.template derivatives<4>(start_.x, start_.v, Real(0), Real(1));
    return {start_.y, start_.w, -x[2], -x[3]};
  }
  // Whether a secondary mass at rest on the wall next to it sticks to it. The first derivative of y, from y''
  // = -x'' on, that is not zero to rounding decides: it must press the mass against the wall.
  bool sticks() const { return away_ * primary_.lead().value > 0; }
  // A bound on |y''''| for a time `span` from the beginning on.
  Real fourth_of_y(const Real& span) const { return primary_.beginning().bound(4, span); }

  const ForcedMotion<Real, Force>& primary() const { return primary_; }

 private:
  Real gap() const { return clearance_.gap(); }
  // The state with the position of the secondary mass as its distance u from the wall, u' and the change of
  // x.
  struct FromWall {
    Real x, v, u, u1;
    ChangeOfX<Real> change;  // of x
  };
  [[gnu::always_inline]] FromWall from_wall(const Real& t) const {
    const Real u1 = away_ * start_.w;
    if (t == 0) return {start_.x, start_.v, u_, u1, {Real(0), Real(0)}};
    const auto now = primary_.at(t);
    return {now.x, now.v, u_ + (u1 * t - away_ * now.dx), u1 - away_ * now.dv, {now.dx, now.dv}};
  }
  State<Real> state_of(const FromWall& place) const {
    return {place.x, place.v, wall_ + away_ * place.u, away_ * place.u1};
  }
  // u and its derivatives, which from the second on are those of -away x.
  template <std::size_t N>
  Derivatives<Real, N> derivatives_of_u(const FromWall& place, const Real& t) const {
    auto u = primary_.template derivatives<N>(-away_ * place.x, -away_ * place.v, t, -away_);
    u[0] = place.u;
    u[1] = place.u1;
    return u;
  }
  // Inlined: 2 % of a decay's time.
  [[gnu::always_inline]] std::optional<WallEvent<Real>> met_from(const Real& predict_from,
                                                                 const Real& search_from, const Real& horizon,
                                                                 Search<Real>& search) const {
    if constexpr (ForcedMotion<Real, Force>::forced) {
      if (predict_from == 0) {
        const auto predicted = predicted_by_series();
        if (predicted && predicted->wall)
          return predicted->wall->time < horizon ? predicted->wall : std::nullopt;
        if (predicted && horizon <= primary_.reach()) {
          search.take_step();  // each piece costs a step, so that a run without events ends
          return {};
        }
      }
    }
    std::optional<WallEvent<Real>> met = predicted_wall(predict_from, search.span);
    if (!met) {
      SearchCounter<Real>::found(FoundBy::search);
      met = search_wall(search_from, horizon, search);
    } else if (!(met->time < horizon)) {
      met.reset();
    }
    return met;
  }
  // For a mass that is released at rest and leaves its wall by y''', or a later derivative, alone: the time
  // (M7.4) before which it meets no wall. 0 for any other start.
  Real begin_by_lead_of_y(const Real& span) const {
    const auto y = derivatives_of_y();
    const Lead<Real> lead = primary_.lead();
    const bool by_third = lead.order <= 3;
    const std::size_t order = by_third ? 3 : lead.order;
    const Real size = away_ * (by_third ? y[3] : Real(-lead.value));
    if (!(size > 0) || (by_third && !(away_ * y[2] < size * Real(1e-6)))) return 0;
    const Real far = begin_by_lead<Real>(order, size, primary_.beginning().bound(order + 1, span), span),
               near = 1 / square_root(Real(1 + size / gap()));
    return near < far ? near : far;
  }
  // Whether the fourth-order terms that a correction by `shift` leaves out are below rounding for x and x',
  // too, which may be far smaller than the secondary mass's motion. |x''| + |x'''| stands for the size of x.
  static bool moves_x_by_series(const Derivatives<Real, 6>& u, const Real& shift, const Real& fourth) {
    const Real shift_2 = shift * shift, second = absolute(u[2]), third = absolute(u[3]);
    return fourth * (shift_2 * shift_2) <= 4 * std::numeric_limits<Real>::epsilon() * (second + third);
  }
  // Whether Lemma L2 proves that u stays between the walls for a time h from `begin` on. from: u and its
  // derivatives at `begin`; to: u and u' at the end; fourth: a bound on |u''''|. Where the ends do not prove
  // it the interval is halved, at most `halvings` times.
  template <std::size_t N>
  bool stays_between_walls(const Derivatives<Real, N>& from, const Real& begin,
                           const Derivatives<Real, 2>& to, const Real& h, const Real& fourth,
                           int halvings) const {
    if (stays_between<Real>({from[0], from[1], from[2], from[3]}, to[0], to[1], h, fourth, gap()))
      return true;
    if (halvings == 0) return false;
    const Real half = h / 2;
    const FromWall middle = from_wall(begin + half);
    // The third derivative -1 makes no claim: stays_between() uses it only for a beginning next to a wall.
    return stays_between_walls(from, begin, {middle.u, middle.u1}, half, fourth, halvings - 1) &&
           stays_between_walls(Derivatives<Real, 4>{middle.u, middle.u1, Real(0), Real(-1)},
                               Real(begin + half), to, half, fourth, halvings - 1);
  }
  // Returns the wall that is met first, or with an empty `wall` that none is met while the series (M4.4) of a
  // motion under a force holds, where it is as accurate as the closed form. Returns nothing where Lemma L2
  // proves neither.
  struct PredictedWall {
    std::optional<WallEvent<Real>> wall;
  };
  std::optional<PredictedWall> predicted_by_series() const {
    const Real reach = primary_.reach();
    const DrivenSeries<Real>& x = primary_.series();
    const Derivatives<Real, 4> u{u_, away_ * start_.w, -away_ * x.derivative(2), -away_ * x.derivative(3)};
    // A start on a wall and into it is an impact now. Lemma L2's products would lose a speed of one denormal
    // number.
    if (u[0] == 0 && u[1] < 0) return {};
    const Real& fourth = primary_.fourth_until_reach();
    // Returns the predicted impact if Lemma L2 proves it to be the first.
    const auto first = [&](const Prediction<Real>& predicted) -> std::optional<PredictedWall> {
      const Real& h = predicted.time;
      const auto& [by_u, by_u1] = predicted.gained;
      const Real level = predicted.across ? gap() : Real(0), u1 = u[1] + by_u1;
      if (!stays_between_walls(u, Real(0), {level, u1}, h, fourth, 2)) return {};
      SearchCounter<Real>::found(FoundBy::series);
      return PredictedWall{met(predicted.across, h, start_.x + (start_.v * h - away_ * by_u),
                               start_.v - away_ * by_u1, u1, {-away_ * by_u, -away_ * by_u1})};
    };
    const auto usable = [&](const Prediction<Real>& predicted) {
      return predicted.exact && predicted.time > 0 && predicted.time < reach;
    };
    const auto enough = [](const Real&, const Real&) { return true; };
    const auto go_on = enough;
    const Departure<Real, driven_pairs> departure = x.departure(-away_);
    std::optional<FromWall> end;
    const auto none = [&] {
      if (!end) end = from_wall(reach);
      return stays_between_walls(u, Real(0), {end->u, end->u1}, reach, fourth, 2);
    };
    const bool late = !(guess_by_parabola(u, reach, gap()).time < reach);
    if (late && none()) return PredictedWall{};
    if (!late || (end->u >= 0 && end->u <= gap())) {
      const Prediction<Real> predicted = predict_impact(u, departure, reach, enough, go_on, gap());
      if (usable(predicted)) return first(predicted);
      if (!late && none()) return PredictedWall{};
    }
    // The series ends beyond a wall: Halley's method starts again from that end.
    if (end->u >= 0 && end->u <= gap()) return {};
    const Prediction<Real> predicted = predict_from(FirstGuess<Real>{reach, end->u > gap()}, true, u,
                                                    departure, reach, enough, go_on, gap());
    if (usable(predicted)) return first(predicted);
    return {};
  }
  WallEvent<Real> met(bool across, const Real& time, const Real& x, const Real& v, const Real& u1,
                      const ChangeOfX<Real>& change) const {
    const bool left = across == (away_ < 0);
    return {time, left ? Wall::left : Wall::right, {x, v, left ? Real(0) : gap(), away_ * u1}, change};
  }
  // Returns the first impact after `from` by prediction and validation (impact_prediction.hpp), in at most
  // three pieces; nothing where that does not succeed. span: for how long the bounds hold.
  std::optional<WallEvent<Real>> predicted_wall(const Real& from, const Real& span) const {
    const Real rate = primary_.rate(), most = span * rate < 2 ? span : Real(2 / rate);
    Real begin = from;
    FromWall here = from_wall(from);
    for (int piece = 0; piece < 3; ++piece) {
      const auto u = derivatives_of_u<10>(here, begin);
      const Real fourth = primary_.fourth(u, -away_ * here.x, -away_ * here.v, begin, -away_, span);
      const auto reached = [&](bool across, const Real& h, const Real& x1, const Real& v1, const Real& u1,
                               const ChangeOfX<Real>& change, FoundBy way) -> std::optional<WallEvent<Real>> {
        const Real level = across ? gap() : Real(0);
        // A correction may lead beyond the span for which `fourth` holds.
        if (!(h <= span) || !stays_between_walls(u, begin, {level, u1}, h, fourth, 2)) return {};
        SearchCounter<Real>::found(way);
        return met(across, begin + h, x1, v1, u1, change);
      };

      const Prediction<Real> predicted = predict_impact(
          u, Departure<Real, 5>{departure_of(u)}, most,
          [&](const Real& u1, const Real& t) { return omits_nothing(u1, fourth, rate, t); },
          [&](const Real& t, const Real& size) { return !(rate * t > Real(0.05) && size * 32 < t); }, gap());
      Real h = predicted.time;
      if (!(h > 0)) return {};
      if (predicted.exact) {
        // x has departed from its own straight line by -away times as much.
        const auto& [by_u, by_u1] = predicted.gained;
        const auto& [dx, dv] = here.change;
        return reached(predicted.across, h, here.x + (here.v * h - away_ * by_u), here.v - away_ * by_u1,
                       here.u1 + by_u1, {dx + (dv * h - away_ * by_u), dv - away_ * by_u1}, FoundBy::series);
      }
      FromWall there;
      for (int correction = 0;; ++correction) {
        there = from_wall(begin + h);
        const auto u_there = derivatives_of_u<6>(there, begin + h);
        const bool across = there.u > gap() / 2;
        const auto [shift, newton, close] = time_to_level(across ? gap() : Real(0), u_there, h, fourth);
        if (close && absolute(shift) < h / 4 && moves_x_by_series(u_there, shift, fourth)) {
          const auto [x1, v1] = shifted<Real>(-away_ * there.x, -away_ * there.v, u_there, shift);
          const auto [dx, dv] =
              shifted<Real>(-away_ * there.change.dx, -away_ * there.change.dv, u_there, shift);
          return reached(across, h + shift, -away_ * x1, -away_ * v1,
                         shifted(there.u, there.u1, u_there, shift).u1, {-away_ * dx, -away_ * dv},
                         FoundBy::correction);
        }
        const bool near = absolute(shift) < h / 4, beyond = !(there.u >= 0 && there.u <= gap());
        if (correction == 5 || !(near || beyond)) break;
        // Far beyond a wall: the impact was earlier, so h moves back, by h/2 at most.
        h += near ? shift : newton < 0 && newton > -h / 2 ? newton : Real(-h / 2);
      }
      if (!(h <= span) || !stays_between_walls(u, begin, {there.u, there.u1}, h, fourth, 2)) return {};
      begin += h;
      here = there;
    }
    return {};
  }

  [[no_unique_address]] Clearance clearance_;
  Primary primary_;
  State<Real> start_;
  Real wall_, away_, u_;
  bool goes_on_;
};

}  // namespace impact_damper
