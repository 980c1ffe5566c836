// The first fall through zero among many functions of one motion, several of which may be near zero at once:
// a mass that friction stops close to a wall is about to stop and about to meet the wall. Each step is that
// of Lemma L1 (root_isolation.hpp). The root of a function's parabola is accepted if every other function is
// proved to be positive until then. Most events need no steps: they are predicted and validated
// (predict_first).
//
// A function may be zero at time 0, so that rounding errors would decide its sign and that of its slope soon
// after. Bounds of both errors are given. While the value is not below zero by more than its bound, the
// function falls only if its slope is negative by more than its own.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "impact_damper/events/fall_by_ends.hpp"
#include "impact_damper/events/halley.hpp"
#include "impact_damper/events/root_isolation.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/math/power_series.hpp"

namespace impact_damper {

// How a function is watched. `order`, 0, 1 or 2: of its zero at time 0, which is then exact, the slope of a
// zero of order 2 too; 0 where it is not zero there. Rounding errors at the time t are at most noise t^order
// in the value, and slope_noise t^(order-1), with order 0 slope_noise, in the slope. With order > 0 the
// search sets both to zero once the value has exceeded its bound.
template <class Real>
struct Watch {
  Real begin{0};  // before this time the function is known to be positive
  int order = 0;
  Real noise{0}, slope_noise{0};
  // t^order.
  Real power_of(const Real& t) const { return order == 2 ? Real(t * t) : order == 1 ? t : Real(1); }
  // Set by the search: its least step while the value is not positive, doubled while the value stays so.
  Real wait{0};
  // Set by the prediction: the function at time 0, with its third derivative, and when it may fall.
  Jet<Real> start{};
  Real guess{0};
};

// Whether L1's cubic is positive up to s even without what is positive in its slope and second derivative: it
// then decreases, so that its value at s decides. False: not shown.
template <class Real>
bool stays_positive(const Jet<Real>& jet, const Real& s) {
  const Real down = jet.g1 < 0 ? jet.g1 : Real(0), bends = jet.g2 < 0 ? jet.g2 : Real(0);
  return jet.g + s * (down + s * (bends / 2 - s * jet.third / 6)) > 0;
}

// Returns the first time in [0, horizon) at which one of the functions `watched`, which have the members of
// Watch, falls through zero, and its index; nothing if none does, or if the search has no steps left. at(t):
// the motion at t; enclose(at(t), t, watched[i]) encloses that function for a time search.span from t on.
// resolution, steps that are not proved, and independence of the horizon: as in first_root(). `watched` is
// changed: it is for one search.
template <class Real, class Watched, class At, class Enclose>
std::optional<Root<Real>> first_of_many(std::vector<Watched>& watched, At&& at, Enclose&& enclose,
                                        const Real& horizon, Search<Real>& search, const Real& resolution) {
  SearchCounter<Real>::search();
  const Real longest_run = 1e13, most = search.span < longest_run ? search.span : longest_run;
  Real time{0};
  while (time < horizon) {
    if (!search.take_step()) return std::nullopt;
    SearchCounter<Real>::evaluation();
    auto now = at(time);
    const Real least = 2 * std::numeric_limits<Real>::epsilon() * (time + resolution);
    Real step = most;  // no function without a known root falls in it
    std::optional<Root<Real>> near;
    std::vector<std::size_t> waiting;
    for (std::size_t i = 0; i < watched.size(); ++i) {
      Watched& each = watched[i];
      if (time < each.begin) {
        if (each.begin - time < step) step = each.begin - time;
        continue;
      }
      const LocalEnclosure<Real> function = enclose(now, time, each);
      Jet<Real> jet = function.whole;
      const Real power = each.order > 1 ? time : Real(1), noise = each.noise * each.power_of(time);
      if (each.order > 0 && jet.g > noise) each.noise = each.slope_noise = 0;
      const bool departed = jet.g <= 0;
      const Real wait = each.wait;
      each.wait = 0;
      if (departed) {
        const bool falls = jet.g < -noise ? jet.g1 < 0 : jet.g1 < -each.slope_noise * power;
        if (falls) return Root<Real>{time, i};
        jet.g = 0;
        if (jet.g1 < 0) jet.g1 = 0;
      }
      const Real known = near && near->time - time < step ? Real(near->time - time) : step;
      if (!departed && stays_positive(jet, known)) continue;
      Real proven = step_without_root(jet, most);
      if (proven < known && function.main.g > function.rest) {
        Jet<Real> main = function.main;
        main.g -= function.rest;
        const Real proven_by_main = step_without_root(main, most);
        if (proven_by_main > proven) proven = proven_by_main;
      }
      if (departed) {
        if (proven < wait) proven = wait;
        if (!(proven > least && proven > wait)) waiting.push_back(i);
      }
      const auto root = departed ? std::nullopt : root_of_parabola(jet, proven, time);
      if (root && (!near || time + *root < near->time)) near = Root<Real>{time + *root, i};
      if (!root && proven < step) step = proven;
    }
    if (near && near->time - time <= step) return near->time < horizon ? near : std::nullopt;
    if (!(step > least)) step = least;
    time += step;
    for (const std::size_t i : waiting) watched[i].wait = 2 * step;
  }
  return std::nullopt;
}

// What predict_first() has proved: the first fall of all functions; or, without a root, that none falls
// before the horizon.
template <class Real>
struct ProvenFirst {
  std::optional<Root<Real>> root;
};

// The same as first_of_many(), most often with two or three evaluations: Halley's method, from the earliest
// guess, gives the time, and Lemma L2 proves that no function falls before. Returns nothing where it does
// not; the search then starts anew, and both do so whatever the horizon is. start: at(0); jet(at(t), t,
// each): a function, its first two derivatives and, at time 0, the third; guess(each): when it may fall, from
// each.start; infinity: never; fourth(each): a bound on its fourth derivative for search.span.
template <class Real, class Watched, class Start, class At, class JetOf, class Guess, class Fourth>
std::optional<ProvenFirst<Real>> predict_first(std::vector<Watched>& watched, Start& start, At&& at,
                                               JetOf&& jet, Guess&& guess, Fourth&& fourth,
                                               const Real& horizon, Search<Real>& search) {
  for (Watched& each : watched) {
    if (each.begin > 0) return {};
    each.start = jet(start, Real(0), each);
    const auto& [g, g1, g2, third] = each.start;
    const bool begins_positive = each.order == 2   ? g2 > each.noise
                                 : each.order == 1 ? g1 > each.noise
                                                   : g > each.noise || (g == 0 && g1 > 0);
    if (!begins_positive) return {};
    each.guess = guess(each);
  }
  const auto stays_positive_until = [&](const Watched& each, const SlopeAt<Real>& end) {
    const auto values = [&](const Real& time) {
      auto then = at(time);
      const Jet<Real> now = jet(then, time, each);
      return SeriesAt<Real>{now.g, now.g1, now.g2};
    };
    return openness(values, {Real(0), each.start.g, each.start.g1}, end, fourth(each), 2).open;
  };
  // Whether all functions but one are proved to be positive until a time `by` after `time`, that of `now`.
  const auto others_stay_positive = [&](auto& now, const Real& time, const Real& by, std::size_t but) {
    for (std::size_t i = 0; i < watched.size(); ++i) {
      if (i == but) continue;
      const Watched& each = watched[i];
      const Jet<Real> end = jet(now, time, each);
      if (!(end.g > each.noise * each.power_of(time)) ||
          !stays_positive_until(each,
                                {time + by, end.g + by * (end.g1 + by * end.g2 / 2), end.g1 + by * end.g2}))
        return false;
    }
    return true;
  };
  // A guess that leads nowhere makes room for the next: the mass may fly on to the other wall. After the last
  // one come the roots of cubics, once.
  const Real never = std::numeric_limits<Real>::infinity();
  bool by_cubics = false;
  while (true) {
    const auto earliest =
        std::ranges::min_element(watched, {}, [](const Watched& each) { return each.guess; });
    const auto first = std::size_t(earliest - watched.begin());
    Real t = earliest->guess;
    if (!(t < horizon) && horizon <= search.span) {
      auto end = at(horizon);
      if (others_stay_positive(end, horizon, Real(0), watched.size())) {
        search.take_step();  // each piece costs a step, so that a run without events ends
        return ProvenFirst<Real>{};
      }
    }
    if (!(t < never)) {
      if (by_cubics) return {};
      by_cubics = true;
      for (Watched& each : watched) {
        const auto& [g, g1, g2, third] = each.start;
        each.guess = third < 0 ? step_without_root(Jet<Real>{g, g1, g2, -third}, Real(1e13)) : never;
      }
      continue;
    }
    for (int i = 0; i < 5 && t > 0 && t <= search.span; ++i) {
      SearchCounter<Real>::correction();
      auto now = at(t);
      const Jet<Real> here = jet(now, t, *earliest);
      const auto [step, curvature, is_small] = halley_step(Real(-here.g), Real(1 / here.g1), here.g2);
      if (absolute(step) * two_to_the_18 < t && absolute(curvature) * two_to_the_26 < 1) {
        const Real time = t + step, slope = here.g1 + step * here.g2;
        if (!(slope < 0 && time <= search.span && stays_positive_until(*earliest, {time, Real(0), slope}) &&
              others_stay_positive(now, t, step, first)))
          return {};
        search.take_step();
        if (!(time < horizon)) return ProvenFirst<Real>{};
        return ProvenFirst<Real>{Root<Real>{time, first}};
      }
      t += step;
    }
    earliest->guess = never;
  }
}

// Returns when a function falls through zero after time 0, by the parabola through its beginning, with g >=
// 0, and a step to the root of the cubic with its third derivative; infinity if it does not, or far from
// there.
template <class Real>
Real fall_near_parabola(const Jet<Real>& jet) {
  const auto& [g, g1, g2, third] = jet;
  const Real square = g1 * g1 - 2 * g2 * g;
  if (square > 0 && (g1 < 0 || g2 < 0)) {
    const Real root = square_root(square), t = g1 > 0 ? Real((g1 + root) / -g2) : Real(2 * g / (root - g1));
    const Real slope = g1 + t * (g2 + t * third / 2), off = t * t * t * third * reciprocals<Real>[6];
    if (2 * absolute(off) < -slope * t) return t - off / slope;
  }
  return std::numeric_limits<Real>::infinity();
}

}  // namespace impact_damper
