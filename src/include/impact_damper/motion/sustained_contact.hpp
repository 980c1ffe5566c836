// The end of a contact that is too long for the short-contact map (docs/mathematics.md, 7.7): a sustained
// contact, which ends where its slow mode falls through zero, or under a force also one that ends while it
// still rings.
//
// The depth of the secondary mass in the wall is the sum of a main part, which does not ring, and of the
// ringing, a free motion of the fast mode. The main part is the slow mode, under a force with the steady
// state of the fast mode added.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <type_traits>

#include "impact_damper/events/exclusion.hpp"
#include "impact_damper/events/fall_by_ends.hpp"
#include "impact_damper/events/halley.hpp"
#include "impact_damper/events/impact_prediction.hpp"
#include "impact_damper/motion/contact_motion.hpp"
#include "impact_damper/motion/driven_series.hpp"

namespace impact_damper {

template <class Real, class Force>
class SustainedContact {
 public:
  using End = typename ShortContactMap<Real, ContactModes<Real, Force>::columns>::End;

  // contact: one that begins on the wall.
  explicit SustainedContact(const ContactMotion<Real, Force>& contact)
      : contact_(contact), walls_(contact.system()), inward_(contact.inward()) {}

  // Returns the end of the contact; nothing where it is not proved.
  std::optional<End> end() const {
    if constexpr (std::is_same_v<Force, NoForcing<Real>>)
      return end_without_force();
    else
      return end_under_force();
  }

 private:
  // The depth of the mass in the wall, or a part of it, and its derivative.
  struct Depth {
    Real q, w;
  };
  // The depth at a time, with a bound on its fourth derivative from then on.
  struct Moment {
    Real time;
    Depth depth;
    Real fourth;
  };
  struct Parts {
    Depth main, ringing;
  };
  struct MainPart {
    Real leaves;  // when it first falls through zero; 0: not known
    Real chord;   // until then it is at least this, times 1 - t/leaves
    Real fourth;  // a bound on its fourth derivative
    Real until;   // how long it is known
    Real late() const { return leaves * Real(0.75); }
  };

  std::optional<End> end_without_force() const {
    const Oscillator<Real>&slow = walls_.slow, &fast = walls_.fast;
    if (!(slow.half_period() < std::numeric_limits<Real>::infinity())) return {};
    const auto& [slow_part, fast_part] = contact_.parts();
    Parts now{{inward_ * slow_part.q, inward_ * slow_part.w}, {inward_ * fast_part.q, inward_ * fast_part.w}};
    if (!(now.main.q > 0)) return {};
    MainPart main{};
    main.leaves = slow.fall(now.main.q, now.main.w);
    main.chord = slow.lower_bound_of_decay(main.leaves) * now.main.q;  // Lemma L4
    main.fourth = fourth_of(slow, now.main);
    main.until = main.late();
    const auto at = [&](const Real& t) {
      const ContactState<Real> s = contact_.slow_at(t), f = contact_.fast_at(t);
      return Moment{
          t, {inward_ * (s.q + f.q), inward_ * (s.w + f.w)}, fourth_of(fast, Depth{f.q, f.w}) + main.fourth};
    };
    const auto followed = follow(main, now.ringing, at, [&](const Real&) {
      now = {moved(slow, walls_.slow_piece, now.main), moved(fast, walls_.fast_piece, now.ringing)};
      return now;
    });
    if (!followed || !followed->left) return {};
    const Real tiny = std::numeric_limits<Real>::epsilon() / 8;
    if (*followed->left * fast.rate() <= tiny * main.chord * main.leaves * slow.b()) {
      const ContactState<Real> end = contact_.slow_at(main.leaves);
      return End{main.leaves, end.x, end.v, end.w};
    }
    return corrected_end(at, at(main.late()), main.leaves);
  }

  std::optional<End> end_under_force() const {
    const Oscillator<Real>&slow = walls_.slow, &fast = walls_.fast;
    const auto now_of_q = contact_.instants_of_q(Real(0));
    const auto &slow_now = now_of_q.slow, &fast_now = now_of_q.fast;
    const auto derivative = [&](std::size_t n) { return inward_ * (slow_now[n] + fast_now.steady(n)); };
    const SeriesAt<Real> begin{derivative(0), derivative(1), derivative(2)};
    if (!(begin.u > 0)) return {};
    // The main part obeys the equation of the slow mode, under a force that its own derivatives determine.
    const Real a2 = 2 * slow.a(), &b = slow.b();
    const Real force = begin.u2 + a2 * begin.u1 + b * begin.u,
               force1 = derivative(3) + a2 * begin.u2 + b * begin.u1;
    MainPart main{};
    const DrivenSeriesMaker<Real> maker(slow, walls_.forcing.frequency);
    const ShortenedSeries<Real> parts = maker.shortened(maker.taylor(begin.u, begin.u1, force, force1));
    DrivenTerms<Real> series = parts.terms;
    for (std::size_t n = 1; n < parts.small.size(); ++n) series[n] = series[n] + parts.small[n];
    main.until = maker.reach();
    main.fourth = slow_now.bound(4, main.until) + fast_now.steady_bound(4);
    if (const auto root = root_of_series(series, begin, Real(0), main.until)) {
      main.leaves = root->time;
      main.chord = chord_below(begin.u, begin.u1, root->slope, main.leaves, main.fourth);
    }
    Depth ringing{inward_ * (fast_now[0] - fast_now.steady(0)), inward_ * (fast_now[1] - fast_now.steady(1))};
    const Depth first = ringing;
    const auto rings_at = [&](const Real& t) { return moved(fast, fast.propagate(t), first); };
    const auto by_series = [&](const Real& t) {
      const SeriesAt<Real> part = sum<Real>(series, t);
      const Depth rings = rings_at(t);
      return SeriesAt<Real>{part.u + rings.q, part.u1 + rings.w,
                            part.u2 - 2 * fast.a() * rings.w - fast.b() * rings.q};
    };
    const auto at = [&](const Real& t) {
      const SeriesAt<Real> part = sum<Real>(series, t);
      const Depth rings = rings_at(t);
      return Moment{t, {part.u + rings.q, part.u1 + rings.w}, fourth_of(fast, rings) + main.fourth};
    };
    const auto followed = follow(main, ringing, at, [&](const Real& t) {
      const SeriesAt<Real> part = sum<Real>(series, t);
      ringing = moved(fast, walls_.fast_piece, ringing);
      return Parts{{part.u, part.u1}, ringing};
    });
    if (!followed) return {};
    if (followed->left) return corrected_end(at, at(main.late()), main.leaves);
    const auto& [before, now, left] = *followed;
    if (!(now.depth.q < 0)) return {};
    const auto zero = zero_between(by_series, SlopeAt<Real>{before.time, before.depth.q, before.depth.w},
                                   SlopeAt<Real>{now.time, now.depth.q, now.depth.w}, fast.rate());
    return zero ? corrected_end(at, before, zero->time) : std::nullopt;
  }

  // Follows the contact in pieces until the ringing can no longer reach the chord of the main part until
  // `late`. `left` then bounds the ringing from `late` on. Without `left` it is not proved that the mass
  // stays in the wall between the moments `before` and `now`. at(t): the moment t; next(t): both parts at the
  // end t of the next piece.
  struct Followed {
    Moment before, now;
    std::optional<Real> left;
  };
  template <class At, class Next>
  [[gnu::always_inline]] std::optional<Followed> follow(const MainPart& main, const Depth& ringing,
                                                        const At& at, Next&& next) const {
    const Oscillator<Real>& fast = walls_.fast;
    const bool oscillates = fast.half_period() < std::numeric_limits<Real>::infinity();
    const Real early = main.leaves / 4, late = main.late();
    Moment now{0, {0, inward_ * contact_.start().w}, fourth_of(fast, ringing) + main.fourth};
    for (int n = 1;; ++n) {
      const Moment before = now;
      const Real t = Real(n) * walls_.piece;
      if (n > 24 || !(t < main.until)) return {};
      const Parts parts = next(t);
      const Depth& rings = parts.ringing;
      now = {t, {parts.main.q + rings.q, parts.main.w + rings.w}, fourth_of(fast, rings) + main.fourth};
      if (!stays_in_wall(at, before, now, 4)) return Followed{before, now, {}};
      if (!(t < late && main.chord > 0)) continue;
      const Real left = fast.bound_after(rings.q, rings.w, Real(late - t));
      // A fast part that does not oscillate, and was negative at touch, has its one zero behind it.
      if (!oscillates && rings.q >= 0) return Followed{before, now, left};
      const Real wait = t < early ? Real(early - t) : Real(0);
      if (fast.bound_after(rings.q, rings.w, Real(0)) < main.chord * Real(0.75) &&
          fast.bound_after(rings.q, rings.w, wait) < main.chord / 4)
        return Followed{before, now, left};
    }
  }
  // Returns the end near h, corrected by (M7.7) on both modes, if Lemma L2 proves that there is none before
  // it, from `begin` on.
  template <class At>
  std::optional<End> corrected_end(const At& at, const Moment& begin, Real h) const {
    const Real first = h, most = h - begin.time;
    for (int correction = 0; correction < 4; ++correction) {
      const ContactState<Real> s = contact_.slow_at(h), f = contact_.fast_at(h);
      Derivatives<Real, 6> x, q;
      walls_.derive({s.x + f.x, s.v + f.v, s.q + f.q, s.w + f.w}, x, q,
                    walls_.forcing.template derivatives<6>(contact_.phase_at(h)));
      const auto [shift, newton, close] = time_to_level(Real(0), q, h, begin.fourth);
      h += shift;
      if (!(absolute(h - first) < most)) return {};
      if (!close) continue;
      const auto [end_x, end_v] = shifted(x[0], x[1], x, shift);
      const Real end_w = shifted(q[0], q[1], q, shift).u1;
      if (!stays_in_wall(at, begin, {h, {0, inward_ * end_w}, 0}, 4)) return {};
      return End{h, end_x, end_v, end_w};
    }
    return {};
  }

  // Whether Lemma L2 proves that the mass stays in the wall between two moments, halved `halvings` times at
  // most.
  template <class At>
  static bool stays_in_wall(const At& at, const Moment& from, const Moment& to, int halvings) {
    const Real h = to.time - from.time;
    if (stays_open(from.depth.q, from.depth.w, to.depth.q, to.depth.w, h, from.fourth)) return true;
    if (halvings == 0 || !(to.depth.q >= 0)) return false;
    const Moment halfway = at(Real(from.time + h / 2));
    return stays_in_wall(at, from, halfway, halvings - 1) && stays_in_wall(at, halfway, to, halvings - 1);
  }
  static Depth moved(const Oscillator<Real>& oscillator, const Propagator<Real>& p, const Depth& now) {
    return {p.c * now.q + p.s * now.w, p.v * now.w - oscillator.b() * p.s * now.q};
  }
  // A bound on |u''''| from here on.
  [[gnu::always_inline]] static Real fourth_of(const Oscillator<Real>& oscillator, const Depth& u) {
    const auto d = derivatives<6>(oscillator, u.q, u.w);
    return oscillator.bound(d[4], d[5]);
  }

  const ContactMotion<Real, Force>& contact_;
  const ContactModes<Real, Force>& walls_;
  Real inward_;
};

}  // namespace impact_damper
