// Contact with a compliant wall: its motion (contact_motion.hpp), its end and the zeros of x and x' in it.
#pragma once

#include <limits>
#include <optional>
#include <type_traits>

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/events/fall_by_ends.hpp"
#include "impact_damper/events/impact_prediction.hpp"
#include "impact_damper/motion/contact_motion.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/motion/motion.hpp"
#include "impact_damper/motion/sustained_contact.hpp"

namespace impact_damper {

template <class Real, class Force = Forcing<Real>>
class Contact : public ContactMotion<Real, Force>, public ProofsByBounds<Contact<Real, Force>, Real> {
  using Motion = ContactMotion<Real, Force>;
  using Proofs = ProofsByBounds<Contact<Real, Force>, Real>;
  using Motion::forced;
  using Motion::inward_, Motion::parts_, Motion::phase_, Motion::start_, Motion::system_, Motion::wall_;

 public:
  using Motion::bound_of_x, Motion::by_changes, Motion::depth, Motion::derivative_of_q,
      Motion::derivative_of_x, Motion::fast_at, Motion::high_bound_of_q, Motion::leads_of_x, Motion::parts,
      Motion::resolution, Motion::slow_at, Motion::sum_at;

  Contact(const ContactModes<Real, Force>& system, const Real& begin, const State<Real>& start, Wall wall)
      : Contact(system, begin, system.forcing.phase(begin), start, wall, Real(wall == Wall::left ? 0 : 1)) {}
  Contact(const ContactModes<Real, Force>& system, const Real& begin, const SinCos<Real>& phase,
          const State<Real>& start, Wall wall, const Real& origin)  // as those of ContactMotion
      : Motion(system, begin, phase, start, wall, origin) {
    if constexpr (forced) {
      const Real& f0 = system.forcing.amplitude;
      touch_ = {start_.x, start_.v, start_.w, f0 * phase_.sin, f0 * phase_.cos};
    }
  }

  // Returns the end of the contact, q = 0 again, with the state then; nothing if it is not before `horizon`.
  // From the wall it is taken from the short-contact map or from the slow mode, else from search_leave().
  std::optional<WallEvent<Real>> leave(const Real& horizon, Search<Real>& search) const {
    if (start_.y == wall_ && (start_.w != 0 || pressed_until() == 0)) {
      std::optional<End> end;
      if (system_.short_contact) end = system_.short_contact.end(start_of_map());
      if constexpr (forced)
        if (end) short_.end = end->time;
      if (end) SearchCounter<Real>::found(FoundBy::short_contact_map);
      if (!end) {
        end = SustainedContact<Real, Force>(*this).end();
        if (end) SearchCounter<Real>::found(FoundBy::slow_mode);
      }
      if (end && !(end->time < horizon)) return {};
      if (end) return WallEvent<Real>{end->time, Motion::wall(), {end->x, end->v, wall_, end->w}};
    }
    SearchCounter<Real>::found(FoundBy::contact_search);
    return search_leave(horizon, search);
  }
  // Returns the end of the contact and the change of x until then, if the short-contact map gives them.
  auto end_of_short_contact() const {
    using Result = typename Map::EndAndChange;
    const auto end = system_.short_contact && start_.y == wall_ && (start_.w != 0 || pressed_until() == 0)
                         ? system_.short_contact.template end<Result>(start_of_map())
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
      const Real third = Motion::third_of_q_at_rest();
      if (inward_ * third > 0)
        from = begin_by_lead<Real>(3, third, Motion::bound_of_q(4, search.span), search.span);
    }
    const auto fall = isolate_fall<Real>([&](const Real& t) { return depth(t, search.span); }, from, horizon,
                                         search, resolution());
    if (!fall) return {};
    WallEvent<Real> end{*fall, Motion::wall(), Motion::at(*fall)};
    end.state.y = wall_;
    return end;
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
  std::optional<Real> falls(std::size_t order, const Real& sign, const Real& from, const Real& until,
                            Search<Real>& search) const {
    if (const auto fall = fall_of_slow_x(order, sign, from)) return *fall < until ? fall : std::nullopt;
    if constexpr (forced)
      if (const auto fall = fall_in_short_contact(order, sign, from, until))
        return fall->time && *fall->time < until ? fall->time : std::nullopt;
    return Proofs::falls(order, sign, from, until, search);
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
    return absolute(Motion::at(t).x);
  }
  // For a mass at rest on its wall, pressed into it by a derivative of x later than x''': a time until which
  // it stays in the wall by Lemma L7. 0 for any other start, where q'' or q''' decides.
  Real pressed_until() const {
    if (start_.w != 0 || start_.y != wall_) return 0;
    const ContactModes<Real, Force>& c = system_;
    const Lead<Real> lead = lead_of_x(Real(2 * c.zeta), Real(1), c.forcing, phase_, start_.x, start_.v);
    return lead.order > 3 && inward_ * lead.value < 0 ? pressed_at_least(lead, c.zeta, c.forcing) : Real(0);
  }
  const Real& start_x() const { return start_.x; }
  const Real& start_v() const { return start_.v; }
  // Bounds on |x''| and |x'''| for a time t from the beginning on.
  Real second_of_x(const Real& t) const { return bound_of_x(2, t, &Map::second_of_x); }
  Real third_of_x(const Real& t) const { return bound_of_x(3, t, &Map::third_of_x); }

 private:
  using Map = ShortContactMap<Real, ContactModes<Real, Force>::columns>;
  using End = typename Map::End;
  template <class OfMap>
  [[gnu::always_inline]] Real bound_of_x(std::size_t order, const Real& t, OfMap of_map) const {
    if (system_.short_contact && start_.y == wall_ &&
        (!system_.forcing || t <= system_.short_contact.latest()))
      return (system_.short_contact.*of_map)(start_of_map());
    return Motion::bound_of_x(order, t);
  }
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
