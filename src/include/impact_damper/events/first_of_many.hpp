// The first fall through zero among many functions of one motion, several of which may be near zero at once:
// a mass that friction stops close to a wall is about to stop and about to meet the wall. Each step is that
// of Lemma L1 (root_isolation.hpp). The root of a function's parabola is accepted if every other function is
// proved to be positive until then.
//
// A function may be zero at time 0, so that rounding errors would decide its sign and that of its slope soon
// after. Bounds of both errors are given. While the value is not below zero by more than its bound, the
// function falls only if its slope is negative by more than its own.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "impact_damper/events/root_isolation.hpp"

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
  // Set by the search: its least step while the value is not positive, doubled while the value stays so.
  Real wait{0};
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
      const Real power = each.order > 1 ? time : Real(1),
                 noise = each.noise * (each.order > 0 ? power * time : power);
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

}  // namespace impact_damper
