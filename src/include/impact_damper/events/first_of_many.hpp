// The first fall through zero among many functions of one motion, several of which may be near zero at once:
// a mass that friction stops close to a wall nears both events together. Each step is that of Lemma L1
// (root_isolation.hpp); the root that a function's parabola shows counts once no other function can fall
// before.
//
// A function may begin at zero, and rounding errors then decide neither its sign nor that of its slope. It
// has a size for these errors: as long as its value does not exceed them, it falls only with a slope that
// exceeds them, too.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "impact_damper/events/root_isolation.hpp"

namespace impact_damper {

// How a function is watched. At the time t its value counts as zero to rounding up to noise t^order, and its
// slope up to slope_noise t^(order-1), or slope_noise where `order` is 0. With order > 0 that holds until the
// value has been larger once.
template <class Real>
struct Watch {
  Real begin{0};  // before this time the function is known to be positive
  int order = 0;
  Real noise{0}, slope_noise{0};
  Real wait{0};  // of the search: how far a step goes at least while the value is zero to rounding
};

// Whether L1's cubic, with all that helps it left out, is positive up to s.
template <class Real>
bool stays_positive(const Jet<Real>& jet, const Real& s) {
  const Real down = jet.g1 < 0 ? jet.g1 : Real(0), bends = jet.g2 < 0 ? jet.g2 : Real(0);
  return jet.g + s * (down + s * (bends / 2 - s * jet.third / 6)) > 0;
}

// Returns the first time in [0, horizon) at which one of the functions `watched`, which have the members of
// Watch, falls through zero, as first_root(). at(t): the motion at t; enclose(motion at t, t, function) ->
// the LocalEnclosure of that function for a time search.span from t on. No step depends on the horizon.
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
    Real step = most;  // none falls in it, but for those whose root is known
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
        if (proven < each.wait) proven = each.wait;
        if (!(proven > least && proven > each.wait)) waiting.push_back(i);
        each.wait = 0;
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
