// Contact with a compliant wall (M2.2) in closed form.
//
// x and the overlap q (y at the left wall, y - 1 at the right) are each the sum of a slow mode, in which both
// masses move together, and a fast mode, in which the wall gives way (M5.3). A state is split into the two
// (contact_modes.hpp), and each moves by its own oscillator's C and S (oscillator.hpp).
#pragma once

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/events/fall_by_ends.hpp"
#include "impact_damper/events/impact_prediction.hpp"
#include "impact_damper/motion/contact_modes.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/motion/sustained_contact.hpp"

namespace impact_damper {

template <class Real, class Force = Forcing<Real>>
class Contact {
 public:
  Contact(const ContactModes<Real, Force>& system, const Real& begin, const State<Real>& start, Wall wall)
      : Contact(system, begin, system.forcing.phase(begin), start, wall, Real(wall == Wall::left ? 0 : 1)) {}
  // phase: of the force at the beginning. origin: the position of the wall on the axis of start.y. With y
  // counted from the wall itself, origin = 0, y has all the digits of q.
  Contact(const ContactModes<Real, Force>& system, const Real& begin, const SinCos<Real>& phase,
          const State<Real>& start, Wall wall, const Real& origin)
      : system_(system),
        begin_(begin),
        phase_(phase),
        start_(copied(start)),
        wall_(origin),
        inward_(wall == Wall::left ? -1 : 1) {
    if constexpr (forced) {
      const Real& f0 = system.forcing.amplitude;
      touch_ = {start_.x, start_.v, start_.w, f0 * phase_.sin, f0 * phase_.cos};
    }
  }

  State<Real> at(const Real& t) const {
    if (t == 0) return start_;
    const ContactState<Real> s = sum_at(t);
    return {s.x, s.v, wall_ + s.q, s.w};
  }

  // Returns the end of the contact, q = 0 again, with the state then; nothing if it is not before `horizon`.
  // From the wall it is taken from the short-contact map or from the slow mode, else from search_leave().
  std::optional<WallEvent<Real>> leave(const Real& horizon, Search<Real>& search) const {
    if (start_.y == wall_ && (start_.w != 0 || pressed_until() == 0)) {
      std::optional<End> end;
      if (system_.short_contact) end = system_.short_contact(start_of_map());
      if constexpr (forced)
        if (end) short_.end = end->time;
      if (end) SearchCounter<Real>::found(FoundBy::short_contact_map);
      if (!end) {
        end = SustainedContact<Real, Force>(*this).end();
        if (end) SearchCounter<Real>::found(FoundBy::slow_mode);
      }
      if (end && !(end->time < horizon)) return {};
      if (end) return WallEvent<Real>{end->time, wall(), {end->x, end->v, wall_, end->w}};
    }
    SearchCounter<Real>::found(FoundBy::contact_search);
    return search_leave(horizon, search);
  }
  // Returns the end of the contact and the change of x until then, if the short-contact map gives them.
  auto end_of_short_contact() const {
    using Result = typename Map::EndAndChange;
    const auto end = system_.short_contact && start_.y == wall_ && (start_.w != 0 || pressed_until() == 0)
                         ? system_.short_contact.template operator()<Result>(start_of_map())
                         : std::nullopt;
    if constexpr (forced)
      if (end) short_.end = end->time;
    return end;
  }
  // Returns the same end as leave(), found by Lemma L1 step by step.
  std::optional<WallEvent<Real>> search_leave(const Real& horizon, Search<Real>& search) const {
    // q''', or a later derivative, may be all that presses a mass at rest against the wall.
    Real from = pressed_until();
    if (from == 0 && start_.y == wall_ && start_.w == 0) {
      const Real third = third_of_q_at_rest();
      if (inward_ * third > 0) from = begin_by_lead<Real>(3, third, fourth_of_q(search.span), search.span);
    }
    const auto fall = isolate_fall<Real>([&](const Real& t) { return depth(t, search.span); }, from, horizon,
                                         search, resolution());
    if (!fall) return {};
    WallEvent<Real> end{*fall, wall(), at(*fall)};
    end.state.y = wall_;
    return end;
  }
  // Returns |q| at t, at the right wall with the digits that y - 1 does not have.
  Real overlap(const Real& t) const { return absolute(sum_at(t).q); }
  // x, x', q and q' at t. For a short time the parts of a small q are large and cancel, so the changes since
  // the beginning are summed instead.
  ContactState<Real> sum_at(const Real& t) const {
    return by_changes(t) ? sum_of_changes(t) : sum_of(slow_at(t), fast_at(t));
  }
  // x - (x0 + x'0 t) and x' - x'0, summed from the changes of the two parts, not as differences of x and x'.
  std::optional<ChangeOfX<Real>> change_of_x(const Real& t) const {
    const ContactModes<Real, Force>& c = system_;
    const bool is_short = is_short_time(t);
    const ContactState<Real> by_slow = change(c.slow, parts().slow, c.drive_slow, t, is_short),
                             by_fast = change(c.fast, parts().fast, c.drive_fast, t, is_short);
    return ChangeOfX<Real>{by_slow.x + by_fast.x, by_slow.v + by_fast.v};
  }
  // The two parts of x, x', q and q' at t.
  ContactState<Real> slow_at(const Real& t) const {
    return move(system_.slow, parts().slow, system_.drive_slow, t);
  }
  ContactState<Real> fast_at(const Real& t) const {
    return move(system_.fast, parts().fast, system_.drive_fast, t);
  }
  const ContactModes<Real, Force>& system() const { return system_; }

  // Encloses inward_ q, the depth of the secondary mass in the wall, which falls through zero at the
  // contact's end.
  LocalEnclosure<Real> depth(const Real& t, const Real& span) const {
    const ContactState<Real> slow = slow_at(t), fast = fast_at(t), both = sum_at(t, slow, fast);
    LocalEnclosure<Real> ahead =
        look(instant_of_q(slow, system_.slow, system_.drive_slow, t),
             instant_of_q(fast, system_.fast, system_.drive_fast, t), 0, inward_, span);
    ahead.whole.g = inward_ * both.q;
    ahead.whole.g1 = inward_ * both.w;
    return ahead;
  }
  // Proofs for [0, t] from both ends: x keeps its sign `side` (keeps_side); x' keeps its sign, or |x| does
  // not exceed `best` (keeps_course).
  bool keeps_side(const Real& side, const State<Real>& end, const Real& t) const {
    return side * start_.x > 0 && side * end.x > 0 && keeps_sign(start_.x, end.x, second_of_x(t), t);
  }
  bool keeps_course(const Real& best, const State<Real>& end, const Real& t) const {
    if (start_.v * end.v > 0 && keeps_sign(start_.v, end.v, third_of_x(t), t)) return true;
    const Real off = second_of_x(t) * t * t / 8;
    return absolute(start_.x) + off <= best && absolute(end.x) + off <= best;
  }
  // Returns a time after `from` within which x and x' have at most one zero each, once the ringing is below
  // rounding (Lemma L5); 0 if none is known. In a short contact under a force, where `from` is a turning
  // point, x'(from) = 0, the time holds for x' alone.
  Real one_turn_within(const Real& from) const {
    const ContactModes<Real, Force>& c = system_;
    if constexpr (forced) {
      if (short_.x && short_.x->turn.time == from) {
        // While x'' keeps its sign x' has at most one zero, and |x'''| <= m proves that for a time |x''|/m.
        const Real within = absolute(short_.x->turn.x2) / third_of_x(short_.x->end());
        const Real rest = short_.x->end() - from;
        return within < rest ? within : rest;
      }
    }
    if (c.forcing || !parts_) return 0;
    const auto& [slow, fast] = *parts_;
    const Real kept = c.slow.lower_bound_of_decay(from);
    const Real size = kept * (absolute(slow.x) + absolute(slow.v)) * std::numeric_limits<Real>::epsilon();
    return c.fast.bound_after(fast.x, fast.v, from) * c.fast.rate() < size ? c.slow.half_period() : Real(0);
  }
  // Whether x, zero at `from`, is proved to have no other zero until `end`, the state at time t.
  bool leaves_zero(const Real& from, const State<Real>& end, const Real& t) const {
    return t < from + one_turn_within(from) || absolute(end.v) > second_of_x(t) * (t - from);
  }
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            Search<Real>& search) const {
    if (const auto fall = fall_of_slow_x(order, sign, from)) return *fall < until ? fall : std::nullopt;
    if constexpr (forced)
      if (const auto fall = fall_in_short_contact(order, sign, from, until))
        return fall->time && *fall->time < until ? fall->time : std::nullopt;
    return isolate_fall<Real>([&](const Real& t) { return derivative_of_x(order, sign, t, search.span); },
                              from, until, search, resolution());
  }
  // Returns |x| at a turning point, x'(t) = 0. It is the height of the slow mode alone if the ringing is
  // below rounding and moves the turning point too little to change the height (docs/mathematics.md, 7.7).
  Real height(const Real& t) const {
    const ContactModes<Real, Force>& c = system_;
    if constexpr (forced)
      if (short_.x && !by_changes(t)) return absolute(short_.x->x_at(t).u);
    if (!c.forcing && parts_ && c.slow.rings()) {
      const auto& [slow, fast] = *parts_;
      const Real height = c.slow.height(slow.x, slow.v, t);
      const Real nothing = height * (std::numeric_limits<Real>::epsilon() / 8);
      const Real ringing = c.fast.bound_after(fast.x, fast.v, t), late = ringing * c.fast.rate() / c.slow.b();
      if (ringing < nothing && late * (c.slow.a() + late / height) < nothing) return height;
    }
    return absolute(at(t).x);
  }
  LocalEnclosure<Real> derivative_of_x(std::size_t order, const Real& sign, const Real& t,
                                       const Real& span) const {
    const ContactState<Real> slow = slow_at(t), fast = fast_at(t), both = sum_at(t, slow, fast);
    LocalEnclosure<Real> ahead =
        look(instant_of_x(slow, system_.slow, system_.drive_slow, t),
             instant_of_x(fast, system_.fast, system_.drive_fast, t), order, sign, span);
    // Early in a contact the two parts of a small x or x' are large and cancel.
    if (order == 0) ahead.whole.g = sign * both.x;
    if (order == 1) ahead.whole.g = sign * both.v;
    return ahead;
  }

  // x and its first three derivatives at the beginning: from the equations, not from the parts, whose
  // rounding errors would decide where a derivative is zero.
  std::array<Real, 4> leads_of_x() const {
    const ContactModes<Real, Force>& c = system_;
    const auto f = c.forcing.template derivatives<2>(phase_);
    const Real force = c.damping * start_.w + c.stiffness * (start_.y - wall_);
    const Real x2 = c.nu * force - 2 * c.zeta * start_.v - start_.x + f[0], w1 = -force - x2;
    const Real x3 = c.nu * (c.damping * w1 + c.stiffness * start_.w) - 2 * c.zeta * x2 - start_.v + f[1];
    return {start_.x, start_.v, x2, x3};
  }

  // For a mass at rest on its wall, pressed into it by a derivative of x later than x''': a time until which
  // it stays in the wall by Lemma L7. 0 for any other start, where q'' or q''' decides.
  Real pressed_until() const {
    if (start_.w != 0 || start_.y != wall_) return 0;
    const ContactModes<Real, Force>& c = system_;
    const Lead<Real> lead = lead_of_x(Real(2 * c.zeta), Real(1), c.forcing, phase_, start_.x, start_.v);
    return lead.order > 3 && inward_ * lead.value < 0 ? pressed_at_least(lead, c.zeta, c.forcing) : Real(0);
  }
  Real third_of_q_at_rest() const {
    const auto x = leads_of_x();
    return system_.damping * x[2] - x[3];
  }
  Real fourth_of_q(const Real& span) const {
    return instant_of_q(slow_at(Real(0)), system_.slow, system_.drive_slow, Real(0)).bound(4, span) +
           instant_of_q(fast_at(Real(0)), system_.fast, system_.drive_fast, Real(0)).bound(4, span);
  }

  Real panel(const Real& t) const {
    const Real slow = system_.slow.panel(t), fast = system_.fast.panel(t);
    return panel_under(system_.forcing, fast < slow ? fast : slow);
  }
  Real resolution() const { return system_.fast.rate() > 1 ? 1 / system_.fast.rate() : Real(1); }
  // A bound on |x''| for a time t from the beginning on.
  Real second_of_x(const Real& t) const { return bound_of_x(2, t, &Map::second_of_x); }

 private:
  friend class SustainedContact<Real, Force>;
  SinCos<Real> phase_at(const Real& t) const {
    if (t == 0) return phase_;
    if constexpr (!forced) {
      return system_.forcing.phase(begin_ + t);
    } else {
      if (last_.at_time(t).phase) return *last_.phase;
      return last_.phase.emplace(system_.forcing.phase(begin_ + t));
    }
  }
  // The propagator of a part over a time t, and its response to the force.
  struct Carrier {
    Propagator<Real> propagator;
    DrivenResponse<Real> driven{};
  };
  [[gnu::always_inline]] Carrier carrier(const Oscillator<Real>& oscillator, const Real& t) const {
    if constexpr (!forced) {
      return {oscillator.propagate(t)};
    } else {
      Last& last = last_.at_time(t);
      std::optional<Carrier>& known = &oscillator == &system_.slow ? last.slow : last.fast;
      if (!known) {
        known.emplace(Carrier{oscillator.propagate(t)});
        known->driven = oscillator.respond(system_.forcing, phase_, t, known->propagator);
      }
      return *known;
    }
  }
  Wall wall() const { return inward_ < 0 ? Wall::left : Wall::right; }

  // Bounds on derivatives of x for a time t from the beginning on.
  Real third_of_x(const Real& t) const { return bound_of_x(3, t, &Map::third_of_x); }
  template <class OfMap>
  [[gnu::always_inline]] Real bound_of_x(std::size_t order, const Real& t, OfMap of_map) const {
    if (system_.short_contact && start_.y == wall_ &&
        (!system_.forcing || t <= system_.short_contact.latest()))
      return (system_.short_contact.*of_map)(start_of_map());
    return instant_of_x(slow_at(Real(0)), system_.slow, system_.drive_slow, Real(0)).bound(order, t) +
           instant_of_x(fast_at(Real(0)), system_.fast, system_.drive_fast, Real(0)).bound(order, t);
  }
  using Map = ShortContactMap<Real, ContactModes<Real, Force>::columns>;
  using End = typename Map::End;
  [[gnu::always_inline]] decltype(auto) start_of_map() const {
    if constexpr (forced)
      return static_cast<const typename Map::Start&>(touch_);
    else
      return typename Map::Start{start_.x, start_.v, start_.w};
  }

  // Returns the first time from `from` on at which sign times x (order 0) or x' (order 1) falls through zero,
  // if it is F, the fall of the slow mode u, or near F. Returns nothing where that is not proved.
  //
  // The proof, (a) to (c). (a) u stays above its chord times exp(-a F) (Lemma L4), and the fast mode below a
  // bound that decreases (M3.5): so there is no zero before the time `settling` at which that bound meets the
  // chord, found in two steps. (b) If the bound is then below rounding, F is the zero. (c) Else a bound on
  // u'' proves that the sum falls from `settling` on, so that it has one zero there, which a Newton step from
  // F finds.
  std::optional<Real> fall_of_slow_x(std::size_t order, const Real& sign, const Real& from) const {
    const ContactModes<Real, Force>& c = system_;
    if (c.forcing || order > 1 || !c.slow.rings()) return {};
    const auto slow = derivatives<5>(c.slow, parts().slow.x, parts().slow.v);
    const auto fast = derivatives<5>(c.fast, parts().fast.x, parts().fast.v);
    const auto ringing = [&](std::size_t n, const Real& t) {
      return c.fast.bound_after(fast[order + n], fast[order + n + 1], t);
    };
    const Real u = sign * slow[order], u1 = sign * slow[order + 1];
    const Real fall = c.slow.fall(u, u1, from), kept = c.slow.lower_bound_of_decay(fall);
    const Real nothing =
        std::numeric_limits<Real>::epsilon() / 32 * kept * (absolute(u) + absolute(u1) / c.slow.root_b());
    if (from > 0) return ringing(0, from) < nothing ? std::optional(fall) : std::nullopt;

    Real settling{0}, rest = ringing(0, settling);  // rest: bound on the ringing from `settling` on
    for (int i = 0; i < 2; ++i) {
      if (!(rest < kept * u)) return {};
      settling = fall - fall * rest / (kept * u);
      rest = ringing(0, settling);
      if (rest < nothing) return fall;
    }
    const ContactState<Real> slow_then = slow_at(fall), fast_then = fast_at(fall);
    const auto u_then = derivatives<3>(c.slow, slow_then.x, slow_then.v);
    const auto f_then = derivatives<3>(c.fast, fast_then.x, fast_then.v);
    const Real slope = absolute(u_then[order + 1]);
    const Real second = c.slow.bound_after(slow[order + 2], slow[order + 3], Real(0));
    const Real within = fall - settling + 2 * rest / slope;
    if (!(2 * (second * within + ringing(1, settling)) < slope)) return {};
    const Real shift = -(u_then[order] + f_then[order]) / (u_then[order + 1] + f_then[order + 1]);
    const Real enough = std::numeric_limits<Real>::epsilon() / 32 * fall;
    if (!((second + ringing(2, settling)) * (shift * shift) < enough * slope)) return {};
    return fall + shift;
  }

  // Returns the first fall of sign times x (order 0) or x' (order 1), or that there is none, in a contact
  // whose end the short-contact map gave: by its series (M7.10) and Lemma L6. Returns nothing where that is
  // not decided. Neither the decision nor the time depends on `until`.
  std::optional<FirstFall<Real>> fall_in_short_contact(std::size_t order, const Real& sign, const Real& from,
                                                       const Real& until) const {
    const XInShortContactTable<Real>& table = system_.x_in_short_contact;
    if (order > 1 || !short_.end || !(*short_.end <= table.end()) || !(from < *short_.end) ||
        *short_.end < until)
      return {};
    if (!short_.x) short_.x.emplace(table, start_of_map(), *short_.end);
    XInShortContact<Real>& x = *short_.x;
    const auto slope_at = [&](const Real& t, const SeriesAt<Real>& s) {
      return order == 0 ? SlopeAt<Real>{t, sign * s.u, sign * s.u1}
                        : SlopeAt<Real>{t, sign * s.u1, sign * s.u2};
    };
    SlopeAt<Real> begin;
    if (from == 0) {
      const auto leads = leads_of_x();
      begin = {from, sign * leads[order], sign * leads[order + 1]};
    } else if (order == 1 && x.turn.time == from) {
      begin = {from, Real(0), sign * x.turn.x2};
    } else {
      SeriesAt<Real> now = x.x_at(from);
      if (by_changes(from)) {  // with more digits
        const ContactState<Real> changed = sum_at(from);
        now.u = changed.x;
        now.u1 = changed.v;
      }
      begin = slope_at(from, now);
      // A search starts where the function is positive, or at a zero that it has just left.
      if (begin.u < 0) begin.u = 0;
    }
    const SlopeAt<Real> end = slope_at(x.end(), x.x_at_end());
    const auto at = [&](const Real& t) {
      const SeriesAt<Real> s = order == 0 ? x.x_at(t) : x.v_at(t);
      return SeriesAt<Real>{sign * s.u, sign * s.u1, sign * s.u2};
    };
    const Map& map = system_.short_contact;
    const Real fourth = order == 0 ? map.fourth_of_x(start_of_map()) : map.fifth_of_x(start_of_map());
    auto fall = fall_by_ends(at, begin, end, fourth, table.rate());
    if (fall && fall->time && by_changes(*fall->time)) {
      // For a short time the changes since the touch have digits that the series does not have.
      const ContactState<Real> now = sum_at(*fall->time);
      *fall->time -= sign * (order == 0 ? now.x : now.v) / fall->slope;
      if (!(*fall->time > from)) return {};
    }
    if (order == 1 && fall && fall->time) x.turn = {*fall->time, sign * fall->slope};
    return fall;
  }

  ContactState<Real> move(const Oscillator<Real>& oscillator, const ContactState<Real>& from,
                          const ContactState<Real>& drive, const Real& t) const {
    // Under a force the x' and q' of a part include drive.x f and drive.q f, which `from` lacks at t = 0,
    // too.
    if (t == 0 && !system_.forcing) return from;
    const auto [p, driven] = carrier(oscillator, t);
    const Real s1 = -oscillator.b() * p.s;
    ContactState<Real> to{p.c * from.x + p.s * from.v, s1 * from.x + p.v * from.v,
                          p.c * from.q + p.s * from.w, s1 * from.q + p.v * from.w};
    if (system_.forcing) add_driven(to, oscillator, drive, driven, t);
    return to;
  }

  // As sum_at(t), where the two parts at t are already known.
  ContactState<Real> sum_at(const Real& t, const ContactState<Real>& slow,
                            const ContactState<Real>& fast) const {
    return by_changes(t) ? sum_of_changes(t) : sum_of(slow, fast);
  }
  static ContactState<Real> sum_of(const ContactState<Real>& slow, const ContactState<Real>& fast) {
    return {slow.x + fast.x, slow.v + fast.v, slow.q + fast.q, slow.w + fast.w};
  }
  bool by_changes(const Real& t) const { return t == 0 || is_short_time(t); }
  ContactState<Real> sum_of_changes(const Real& t) const {
    const Real q0 = start_.y - wall_;
    if (t == 0) return {start_.x, start_.v, q0, start_.w};
    const ContactModes<Real, Force>& c = system_;
    const ContactState<Real> by_slow = change(c.slow, parts().slow, c.drive_slow, t),
                             by_fast = change(c.fast, parts().fast, c.drive_fast, t);
    return {start_.x + (start_.v * t + (by_slow.x + by_fast.x)), start_.v + (by_slow.v + by_fast.v),
            q0 + (start_.w * t + (by_slow.q + by_fast.q)), start_.w + (by_slow.w + by_fast.w)};
  }

  // Whether t is so short that the changes of the parts are summed, not the parts.
  bool is_short_time(const Real& t) const {
    return t * system_.fast.rate() < Real(0.5) && t * system_.slow.rate() < Real(0.5);
  }
  // Returns the departure of a part from its straight line, in x and q, and the change of its x' and q'. For
  // a short time the terms that both parts have in common, with opposite signs, are left out.
  ContactState<Real> change(const Oscillator<Real>& oscillator, const ContactState<Real>& from,
                            const ContactState<Real>& drive, const Real& t, bool is_short = true) const {
    const auto [p, driven] = carrier(oscillator, t);
    const Real s1 = -oscillator.b() * p.s, v1 = p.c1 - 2 * oscillator.a() * p.s;
    ContactState<Real> by{p.c1 * from.x + p.s1 * from.v, s1 * from.x + v1 * from.v,
                          p.c1 * from.q + p.s1 * from.w, s1 * from.q + v1 * from.w};
    if (system_.forcing) {
      // (M5.10): the terms common to both parts, which would cancel, are left out of x and q.
      if (is_short && driven.integral) {
        add_driven(by, drive, driven, -oscillator.b() * *driven.integral, -oscillator.b() * driven.d);
      } else {
        add_driven(by, oscillator, drive, driven, t);
      }
    }
    return by;
  }
  void add_driven(ContactState<Real>& to, const Oscillator<Real>& oscillator, const ContactState<Real>& drive,
                  const DrivenResponse<Real>& driven, const Real& t) const {
    const Real f = system_.forcing.template derivatives<2>(phase_at(t))[0];
    const Real on_displacement = driven.d1 + 2 * oscillator.a() * driven.d;  // response to C instead of S
    const Real on_velocity = f - oscillator.b() * driven.d;                  // its derivative
    add_driven(to, drive, driven, on_displacement, on_velocity);
  }
  static void add_driven(ContactState<Real>& to, const ContactState<Real>& drive,
                         const DrivenResponse<Real>& driven, const Real& on_displacement,
                         const Real& on_velocity) {
    to.x += drive.v * driven.d + drive.x * on_displacement;
    to.v += drive.v * driven.d1 + drive.x * on_velocity;
    to.q += drive.w * driven.d + drive.q * on_displacement;
    to.w += drive.w * driven.d1 + drive.q * on_velocity;
  }

  // The modal split of the start, made at the first call: the short-contact map does not need it.
  const ContactParts<Real>& parts() const {
    if (!parts_) {
      parts_.emplace();
      system_.split({start_.x, start_.v, start_.y - wall_, start_.w}, parts_->slow, parts_->fast);
    }
    return *parts_;
  }

  // A displacement that is driven by `drive` and its velocity by `drive1` obeys the oscillator's equation
  // under (drive1 + 2 a drive) f + drive f'.
  using Part = Instant<Real, 6, Force>;
  static Real on_f(const Oscillator<Real>& oscillator, const Real& drive, const Real& drive1) {
    return drive1 + 2 * oscillator.a() * drive;
  }
  Part instant_of_q(const ContactState<Real>& now, const Oscillator<Real>& oscillator,
                    const ContactState<Real>& drive, const Real& t) const {
    return {oscillator, now.q,           now.w,      on_f(oscillator, drive.q, drive.w),
            drive.q,    system_.forcing, phase_at(t)};
  }
  Part instant_of_x(const ContactState<Real>& now, const Oscillator<Real>& oscillator,
                    const ContactState<Real>& drive, const Real& t) const {
    return {oscillator, now.x,           now.v,      on_f(oscillator, drive.x, drive.v),
            drive.x,    system_.forcing, phase_at(t)};
  }
  static LocalEnclosure<Real> look(const Part& slow, const Part& fast, std::size_t n, const Real& sign,
                                   const Real& span) {
    const Real slow_third = slow.bound(n + 3, span), fast_third = fast.bound(n + 3, span);
    return {{sign * (slow[n] + fast[n]), sign * (slow[n + 1] + fast[n + 1]),
             sign * (slow[n + 2] + fast[n + 2]), slow_third + fast_third},
            {sign * (slow[n] + fast.steady(n)), sign * (slow[n + 1] + fast.steady(n + 1)),
             sign * (slow[n + 2] + fast.steady(n + 2)), slow_third + fast.steady_bound(n + 3)},
            fast.transient(n)};
  }

  const ContactModes<Real, Force>& system_;
  Real begin_;
  SinCos<Real> phase_;  // of the force then
  State<Real> start_;
  Real wall_, inward_;
  mutable std::optional<ContactParts<Real>> parts_;
  // Under a force, what was computed for the latest time: a search evaluates one time several times in turn.
  static constexpr bool forced = !std::is_same_v<Force, NoForcing<Real>>;
  struct Nothing {};
  struct Last {
    Real time{-1};
    std::optional<SinCos<Real>> phase{};
    std::optional<Carrier> slow{}, fast{};
    Last& at_time(const Real& t) {
      if (t != time) *this = {t};
      return *this;
    }
  };
  [[no_unique_address]] mutable std::conditional_t<forced, Last, Nothing> last_;
  struct Unforced {};
  [[no_unique_address]] std::conditional_t<forced, typename Map::Start, Unforced> touch_;
  // Under a force: the end of a contact that the short-contact map gave, and x until then.
  struct Endless {};
  struct Short {
    std::optional<Real> end{};
    std::optional<XInShortContact<Real>> x{};
  };
  [[no_unique_address]] mutable std::conditional_t<forced, Short, Endless> short_;
};

}  // namespace impact_damper
