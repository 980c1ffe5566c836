// Complete chattering of several masses between rigid walls, and the limit in which it has ended
// (docs/mathematics.md, 17.3).
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "impact_damper/engines/secondary_masses.hpp"
#include "impact_damper/motion/forced_motion.hpp"

namespace impact_damper {

template <class Real, class Force>
class ChatteringLimit {
 public:
  // The primary mass and what sticks to it, on the walls of which the other masses chatter.
  struct Carrier {
    const Driven<Real, Force>* oscillator;  // of all these masses
    Force force;                            // on the primary mass, not divided by `mass`
    Real zeta, mass;                        // mass: 1 + sigma
    bool some_stick;
    Real now, x, v;  // the time, x and x'
    Real span;       // the time for which bounds on derivatives hold, as Search::span
    ForcedMotion<Real, Force> motion() const {
      return {*oscillator, {force.amplitude / mass, force.frequency}, now, x, v};
    }
  };
  // a_i and lambda_i of (M17.6): the acceleration with which a mass comes back to its wall, and the fraction
  // of its speed that it loses at each bounce.
  struct Settling {
    Real a, lost;
    Real per_speed() const { return 2 / (a * lost); }  // duration of all bounces
  };
  // A mass that chatters.
  struct Chattering {
    std::size_t index;
    Real speed;  // r of (M17.5), with which it comes back to its wall
    Real moves;  // its term of (M17.5), by which x moves at most
    Settling settles{};
    Real lasts{0};  // T_i of (M17.6)
  };

  // masses: must outlive this object. tolerance: Restitution::accumulation_tolerance.
  ChatteringLimit(const SecondaryMasses<Real>& masses, const Real& tolerance)
      : masses_(masses), tolerance_(tolerance) {}

  // Finds the masses that join the primary mass now: those in flight whose chattering on the walls of `side`
  // ends before any other event and moves x by less than rounding (M17.5). side: the sign of x'', 1 for left
  // and -1 for right walls. force: (1 + sigma) x''. Returns by how much x' jumps where they join, and
  // joining() then has them; nothing if none join.
  std::optional<Real> find(const Carrier& carrier, const Real& force, const Real& side) {
    carrier_ = carrier;
    const Real on_all = absolute(force), a = on_all / carrier_.mass, span = carrier_.span;
    if (!(a > 0)) return {};
    const OnSide all = find_chattering(a, side);
    if (chattering_.empty()) return {};
    Real m3{0}, m4{0};
    bool has_bounds = false;
    const Real epsilon = std::numeric_limits<Real>::epsilon();
    const auto ends_soon = [&](const Real& duration) {
      if (!has_bounds) {
        const ForcedMotion<Real, Force> motion = carrier_.motion();
        m3 = absolute(motion.beginning()[3]);
        m4 = motion.bound(4, span);
        has_bounds = true;
      }
      return duration < span &&
             (m3 + m4 * duration + 2 * carrier_.zeta * a / carrier_.mass) * duration <= tolerance_ * a;
    };
    std::erase_if(chattering_, [&](Chattering& each) {
      each.settles = settling_of(each.index, all, on_all);
      each.lasts = duration_of(each);
      return !(8 * each.moves <= epsilon * (absolute(carrier_.x) + absolute(carrier_.v) * each.lasts)) ||
             !ends_soon(each.lasts);
    });
    // Those whose chattering ends first join, as many as can. A mass that bounces longer, or meets its wall
    // meanwhile, is left out. Every number is tried: a mass left out that could join would bounce for ever.
    std::sort(chattering_.begin(), chattering_.end(), [](const Chattering& one, const Chattering& other) {
      return one.lasts < other.lasts || (one.lasts == other.lasts && one.index < other.index);
    });
    const std::optional<Joining> found = most_that_join(all, on_all, ends_soon);
    if (!found) return {};
    return Real(found->momentum / (carrier_.mass + found->mass));
  }
  // The masses that join, after find() has returned a jump; those whose chattering ends first come first.
  std::vector<Chattering>& joining() { return chattering_; }

 private:
  // Sums over the masses that chatter or stick on one side, J in 17.3: nu, and nu (1 - e^2). A mass that
  // throws them off their walls loses speed to them (M17.6).
  struct OnSide {
    Real mass{0}, loses{0};
  };
  // Sets chattering_ to the masses in flight on `side` whose bounces move x by less than rounding, under the
  // acceleration a of x. Returns the sums over these and those that stick there.
  OnSide find_chattering(const Real& a, const Real& side) {
    chattering_.clear();
    OnSide all;
    const Real moves_little =
                   std::numeric_limits<Real>::epsilon() * (absolute(carrier_.x) + absolute(carrier_.v)) / 8,
               per_moves = 2 * a * carrier_.mass;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const Real& u1 = masses_.u1[i];
      const Real square =
          masses_.held[i] ? Real(0) : Real(u1 * u1 + 2 * a * (masses_.u[i] > 0 ? masses_.u[i] : Real(0)));
      // This test excludes most masses without a division. It precedes that of the side, a branch that no
      // processor predicts.
      if (!(masses_.nu[i] * square <= 2 * moves_little * per_moves) || masses_.away[i] != side) continue;
      const Real moves = masses_.nu[i] * square / per_moves;
      if (!(moves <= moves_little)) continue;
      if (!masses_.held[i] &&
          !masses_.is_settled(i, square_root(square), Real(tolerance_ * (1 - masses_.e[i]))))
        continue;
      // This one meets its wall in this instant, maybe together with others: an impact (M17.2) comes first.
      if (!masses_.held[i] && masses_.u[i] == 0 && masses_.u1[i] < 0) continue;
      all.mass += masses_.nu[i];
      all.loses += loses(i);
      if (masses_.held[i]) continue;
      chattering_.push_back({i, square_root(square), moves});
    }
    return all;
  }
  // Returns a_i and lambda_i of (M17.6). All others on the side of the i-th mass are taken to be at rest, as
  // they are most of the time: the present state may be that of a moment in which one has just been thrown
  // off its wall. force: |F|, on all of them and the primary mass.
  Settling settling_of(std::size_t i, const OnSide& all, const Real& force) const {
    const Real &nu = masses_.nu[i], &e = masses_.e[i], joined = 1 + (all.mass - nu);
    const Real lost = (1 - e) + (1 + e) * (nu / (1 + nu)) * ((all.loses - loses(i)) / joined);
    return {force / joined, lost < 1 ? lost : Real(1)};
  }
  // Returns T_i of (M17.6), how long a mass chatters.
  Real duration_of(const Chattering& one) const {
    const auto& [a, lost] = one.settles;
    const Real &u = masses_.u[one.index], &u1 = masses_.u1[one.index];
    const Real speed = square_root(Real(u1 * u1 + 2 * a * (u > 0 ? u : Real(0))));
    const Real more = 2 * (1 - lost) / lost;
    return (u1 + speed + more * speed) / a;
  }
  // Sums over the first masses of chattering_. impulse: nu (1 + e) r, the second sum of (M17.5).
  struct Joining {
    Real mass{0}, momentum{0}, impulse{0}, moves{0};
    Real given_speed{0};  // the sum in (M17.21): speed that they give to another mass
    Real duration{0};     // (M17.21)
  };
  // Shortens chattering_ to as many of its first masses as can join, and returns their sums; nothing if none
  // can.
  template <class EndsSoon>
  std::optional<Joining> most_that_join(const OnSide& everyone, const Real& on_all, EndsSoon&& ends_soon) {
    Real slowest{0};  // the largest 2/(a lambda) of (M17.21)
    for (std::size_t i = 0; carrier_.some_stick && i < masses_.size(); ++i) {
      if (!masses_.held[i]) continue;
      const Real per_speed = settling_of(i, everyone, on_all).per_speed();
      if (slowest < per_speed) slowest = per_speed;
    }
    const Real a = on_all / carrier_.mass, heavy = (1 + everyone.mass) * (1 + everyone.mass);
    const bool alone = !carrier_.some_stick && !chattering_.empty() &&
                       everyone.mass == masses_.nu[chattering_.front().index];
    joining_.assign(1, {});
    Real longest{0};
    for (const Chattering& each : chattering_) {
      const std::size_t i = each.index;
      Joining all = joining_.back();
      all.mass += masses_.nu[i];
      all.momentum += masses_.nu[i] * masses_.w(i);
      all.impulse += masses_.nu[i] * (1 + masses_.e[i]) * each.speed;
      all.moves += each.moves;
      all.given_speed +=
          masses_.nu[i] / (1 + masses_.nu[i]) * (1 + masses_.e[i]) * each.speed / each.settles.lost;
      if (longest < each.lasts) longest = each.lasts;
      const Real of_others = slowest, own = each.settles.per_speed();
      if (slowest < own) slowest = own;
      all.duration = longest + all.given_speed * (joining_.size() == 1 ? of_others : slowest) * heavy;
      joining_.push_back(all);
    }
    Real most{0};                     // a bound on |x''|
    std::optional<Real> others_meet;  // a lower bound of this time for the masses left out
    for (std::size_t count = chattering_.size(); count > 0; --count) {
      const Joining& all = joining_[count];
      if ((alone || all.duration <= tolerance_) && limit_holds(all, a, ends_soon)) {
        if (!others_meet) {
          const Real until = 2 * all.duration, most_span = carrier_.span;
          const Real span = until < most_span ? until : most_span;
          most = carrier_.motion().bound(2, span);
          others_meet = first_meeting(most, span, count);
        }
        if (*others_meet >= 2 * all.duration) {
          chattering_.resize(count);
          return all;
        }
      }
      if (!others_meet) continue;
      // From now on this one is left out, too.
      const Real time = masses_.lower_bound_of_meeting(chattering_[count - 1].index, most);
      if (time < *others_meet) others_meet = time;
    }
    return std::nullopt;
  }
  // Whether (M17.5) holds for the masses that join. Whether others meet a wall within 2 T is not checked
  // here.
  template <class EndsSoon>
  bool limit_holds(const Joining& all, const Real& a, EndsSoon&& ends_soon) const {
    const Real epsilon = std::numeric_limits<Real>::epsilon();
    const Real speed = absolute(carrier_.v + all.momentum / (carrier_.mass + all.mass));
    if (!(8 * all.moves <= epsilon * (absolute(carrier_.x) + speed * all.duration)) ||
        !ends_soon(all.duration))
      return false;
    const bool may_turn = speed <= all.impulse / carrier_.mass + a * all.duration;
    return !may_turn || 2 * all.duration <= epsilon * carrier_.now;
  }
  Real loses(std::size_t i) const { return masses_.nu[i] * (1 - masses_.e[i] * masses_.e[i]); }
  // Returns a lower bound, `span` at most, of the time at which a mass in flight meets a wall while |x''| <=
  // most. The first `first` of chattering_ are excluded.
  Real first_meeting(const Real& most, const Real& span, std::size_t first) {
    joins_.assign(masses_.size(), false);
    for (std::size_t k = 0; k < first; ++k) joins_[chattering_[k].index] = true;
    Real least = span;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      if (joins_[i] || masses_.held[i]) continue;
      const Real time = masses_.lower_bound_of_meeting(i, most);
      if (time < least) least = time;
    }
    return least;
  }

  const SecondaryMasses<Real>& masses_;
  Real tolerance_;
  Carrier carrier_{};
  std::vector<Chattering> chattering_;
  std::vector<Joining> joining_;  // of the first 0, 1, 2 ... of them
  std::vector<char> joins_;
};

}  // namespace impact_damper
