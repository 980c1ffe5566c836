// The first fall of a function through zero, found by a Taylor lower bound (docs/mathematics.md, 7.3: Lemma
// L1, M7.3). None is missed, however grazing, unless it is lost in rounding errors. Each step leads to the
// first root of the bound's cubic, to six digits and from below, and no root of the function precedes it.
//
// Where g = main + rest with a bound on |rest| (a slow motion with a fast ringing on top; a straight flight
// with an oscillation on top), main - bound > 0 is a second proof, which steps over many periods of the rest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "impact_damper/events/search.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

template <class Real>
struct Jet {
  Real g{0}, g1{0}, g2{0};  // a function and its first two derivatives at a point
  Real third{0};            // bound on |g'''| for a time Search::span from there on
};

template <class Real>
struct LocalEnclosure {
  Jet<Real> whole;
  Jet<Real> main{};  // whole = main + rest
  // A bound on |rest| for the same time; infinity: no such splitting.
  Real rest = std::numeric_limits<Real>::infinity();
};

// The cubic p(s) = g + g1 s + g2 s^2/2 - third s^3/6, which bounds the function from below.
template <class Real>
struct LowerCubic {
  Real g, g1, g2, third, half, sixth, half_third;
  explicit LowerCubic(const Jet<Real>& jet)
      : g(jet.g),
        g1(jet.g1),
        g2(jet.g2),
        third(jet.third),
        half(g2 / 2),
        sixth(third / 6),
        half_third(third / 2) {}
  Real at(const Real& s) const { return g + s * (g1 + s * (half - s * sixth)); }
  Real slope(const Real& s) const { return g1 + s * (g2 - s * half_third); }
  // Beyond this s the cubic term is at least three times each positive other term, and p is not positive.
  Real negative_from() const {
    const Real by_g = 18 * g / third, by_g1 = 18 * g1 / third, by_g2 = 9 * g2 / third;
    Real far = by_g > 1 ? square_root(by_g) : Real(1);
    if (by_g1 > far * far) far = square_root(by_g1);
    if (by_g2 > far) far = by_g2;
    return far;
  }
};

// Searches p up to its inflection, where it is convex: Newton's steps from the left cannot pass a root, and
// once p rises there is none up to the inflection. done: `from` is a root of p, or a little before it; else p
// has none before the inflection.
template <class Real>
struct ConvexPart {
  Real from;
  bool done;
};
template <class Real>
ConvexPart<Real> step_through_convex_part(const LowerCubic<Real>& p, const Real& inflection) {
  Real low{0};
  if (!(p.g1 < 0 && p.g2 > 0)) return {low, false};
  for (int i = 0; i < 8; ++i) {
    const Real next = low - p.at(low) / p.slope(low);
    if (!(next < inflection)) break;
    if (next - low <= next / 1048576) return {low > 0 ? low : next, true};
    low = next;
    if (!(p.slope(low) < 0)) break;
    if (i == 7) return {low, true};
  }
  return {low, false};
}

// Returns the root of p in [low, most], or a point a little before it. p is concave there, positive at `low`
// and negative at `most`: chords come from below, Newton's steps from above.
template <class Real>
Real root_of_concave_part(const LowerCubic<Real>& p, Real low, const Real& most) {
  Real high = most;
  if (p.slope(low) < 0) {
    const Real tangent = low - p.at(low) / p.slope(low);
    if (tangent < high) high = tangent;
  } else if (p.g2 < 0) {
    const Real parabola = (p.g1 + square_root(Real(p.g1 * p.g1 - 2 * p.g2 * p.g))) / -p.g2;
    if (parabola < high) high = parabola;
  }
  // The root may be 1e300 times nearer than `high`. Quartering from zero is exact, so sixteen of the
  // quarterings below, taken at once, come to the same number.
  const Real much_nearer = Real(1) / Real(std::int64_t(1) << 32);
  while (low == 0 && p.at(high * much_nearer) < 0) high *= much_nearer;
  // Every point where p is still positive lies before the root.
  Real nearer = low + (high - low) / 4;
  while (p.at(nearer) < 0) {
    high = nearer;
    nearer = low + (high - low) / 4;
    if (!(low < nearer)) return low;
  }
  low = nearer;
  for (int i = 0; i < 8 && high - low > high / 1048576; ++i) {
    const Real below = p.at(low), above = p.at(high);
    if (!(above < 0)) return high;
    const Real chord = low + (high - low) * (below / (below - above));
    const Real newton = high - above / p.slope(high);
    if (!(chord > low) && !(newton < high)) break;
    low = chord;
    if (newton < high) high = newton;
  }
  return low;
}

// Returns a step s in [0, most] with p > 0 on (0, s): the first positive root of p, from below, most often to
// six digits, or `most` where there is none up to there. Needs p > 0 just after 0 (Lemma L1). If g = 0 and p
// is not positive just after 0, the step is 0 or proves nothing.
template <class Real>
Real step_without_root(const Jet<Real>& jet, Real most) {
  SearchCounter<Real>::step();
  const LowerCubic<Real> p(jet);
  const Real far = p.negative_from();
  if (far < most) most = far;
  const Real inflection = p.g2 > 0 ? (p.third * most > p.g2 ? Real(p.g2 / p.third) : most) : Real(0);
  const ConvexPart<Real> convex = step_through_convex_part(p, inflection);
  if (convex.done) return convex.from;
  const Real low = convex.from < inflection ? inflection : convex.from;
  if (!(low < most) || p.at(most) >= 0) return most;
  return root_of_concave_part(p, low, most);
}

// Returns the root of the parabola, if it is the function's own within 2 epsilon (time + root). Then the
// parabola falls there with at least half its slope here, the third derivative is too small to move the root
// further, and no root can lie before it: there is none up to `proven`, and from there on the function falls.
template <class Real>
std::optional<Real> root_of_parabola(const Jet<Real>& jet, const Real& proven, const Real& time) {
  const Real slope_2 = jet.g1 * jet.g1 - 2 * jet.g2 * jet.g;
  if (!(jet.g1 < 0 && 4 * slope_2 > jet.g1 * jet.g1)) return {};
  const Real root = 2 * jet.g / (square_root(slope_2) - jet.g1);
  const bool is_next = root <= proven + proven / 1024;
  const Real rounding = 2 * std::numeric_limits<Real>::epsilon() * (time + root);
  if (is_next && jet.third * root * root * root < -jet.g1 * rounding) return root;
  return {};
}

template <class Real>
struct Root {
  Real time;
  std::size_t which;  // the index among the functions
};

// Returns the first time in [from, horizon) at which one of several functions falls through zero; `from` if
// one is not positive and falls there. Returns nothing if there is none, or if the search has no steps left.
// No two functions may be near zero at once; the gaps to both walls never are.
//
// enclose(t), a std::array<LocalEnclosure<Real>, N>, encloses each function for a time search.span from t on.
// resolution: the shortest time in which a function changes; the error of a time t is at most 2 epsilon (t +
// resolution). A function that is neither positive nor falls has just left its zero, and is taken for zero.
// Until a longer step than that error is proved, steps double. They are not proved: what the function does
// meanwhile is lost in rounding errors. No step depends on the horizon: a search that ends earlier is the
// beginning of one that ends later, to the bit.
template <class Real, class Watch>
std::optional<Root<Real>> first_root(Watch&& enclose, const Real& from, const Real& horizon,
                                     Search<Real>& search, const Real& resolution) {
  SearchCounter<Real>::search();
  const Real longest_run = 1e13, most = search.span < longest_run ? search.span : longest_run;
  Real time = from, wait{0};
  while (time < horizon) {
    if (!search.take_step()) return std::nullopt;
    SearchCounter<Real>::evaluation();
    const auto functions = enclose(time);
    const Real remaining = horizon - time;
    const Real least = 2 * std::numeric_limits<Real>::epsilon() * (time + resolution);
    Real step = most;
    bool waits = false;
    std::optional<Root<Real>> near;
    for (std::size_t i = 0; i < functions.size(); ++i) {
      Jet<Real> jet = functions[i].whole;
      const bool departed = jet.g <= 0;
      if (departed && jet.g1 < 0) return Root<Real>{time, i};
      if (departed) jet.g = 0;
      Real proven = step_without_root(jet, most);
      const LocalEnclosure<Real>& function = functions[i];
      if (proven < most && function.main.g > function.rest) {
        Jet<Real> main = function.main;
        main.g -= function.rest;
        const Real proven_by_main = step_without_root(main, most);
        if (proven_by_main > proven) proven = proven_by_main;
      }
      if (departed && proven < wait) proven = wait;
      waits = waits || (departed && !(proven > least && proven > wait));
      if (!(proven < step)) continue;
      step = proven;
      near.reset();
      if (const auto root = root_of_parabola(jet, proven, time)) near = Root<Real>{time + *root, i};
    }
    if (step >= remaining) return std::nullopt;
    if (near) return near->time < horizon ? near : std::nullopt;
    if (!(step > least)) step = least;
    time += step;
    wait = waits ? 2 * step : Real(0);
  }
  return std::nullopt;
}

// Returns the first time in [from, until) at which one function falls through zero; enclosure_at(t) encloses
// it.
template <class Real, class Enclose>
std::optional<Real> isolate_fall(Enclose&& enclosure_at, const Real& from, const Real& until,
                                 Search<Real>& search, const Real& resolution) {
  const auto root = first_root<Real>([&](const Real& t) { return std::array{enclosure_at(t)}; }, from, until,
                                     search, resolution);
  return root ? std::optional(root->time) : std::nullopt;
}

// Returns the time after its beginning at which to begin the search for a fall of u, if u and its derivatives
// below the `order`-th are zero but for rounding (M7.4). Until then u has the sign of `lead`, its `order`-th
// derivative there. The time is at most `span`, for which `next`, a bound on the following derivative, holds.
template <class Real>
Real begin_by_lead(std::size_t order, const Real& lead, const Real& next, const Real& span) {
  const Real leap = Real(double(order + 1)) / 2 * absolute(lead) / next;
  return leap < span ? leap : span;
}

}  // namespace impact_damper
