// The force f0 sin(omega_f t), divided by K epsilon as in the paper's (2).
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <limits>

#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

// Returns the sine and cosine of the angle of `at` increased by `by`, 0 to 1/16, to double precision: the
// next terms of both Taylor series are below 2^-61 (docs/mathematics.md, chapter 4).
template <class Real>
SinCos<Real> rotated(const SinCos<Real>& at, const Real& by) {
  const Real z = by * by;
  const Real sin =
      by +
      by * (z * (Real(-1.0 / 6) + z * (Real(1.0 / 120) + z * (Real(-1.0 / 5040) + z * Real(1.0 / 362880)))));
  const Real less =
      z * (Real(-0.5) + z * (Real(1.0 / 24) + z * (Real(-1.0 / 720) + z * Real(1.0 / 40320))));  // cos - 1
  return {at.sin + (at.cos * sin + at.sin * less), at.cos + (at.cos * less - at.sin * sin)};
}

// f(t) = amplitude sin(frequency t) and its derivatives at one instant.
template <class Real>
struct Forcing {
  Real amplitude{0}, frequency{1};
  explicit operator bool() const { return amplitude != 0; }

  // Sine and cosine of the phase at a time.
  SinCos<Real> phase(const Real& time) const { return sin_cos(frequency * time); }
  // The same from the phase `before` that the force had a time `since` >= 0 before `time`: `before` is
  // rotated by the angle frequency since, if that is below 1/16; else the phase is computed from `time`. A
  // phase that was rotated must not be rotated again: the errors would add up.
  SinCos<Real> phase(const Real& time, const SinCos<Real>& before, const Real& since) const {
    if constexpr (std::numeric_limits<Real>::digits10 < 17) {
      const Real by = frequency * since;
      if (by < Real(0.0625)) return rotated(before, by);
    }
    return phase(time);
  }

  // f and its derivatives at a phase.
  template <std::size_t N>
  std::array<Real, N> derivatives(const SinCos<Real>& phase) const {
    static_assert(N >= 2);
    const auto& [sin, cos] = phase;
    std::array<Real, N> f;
    f[0] = amplitude * sin;
    f[1] = amplitude * frequency * cos;
    for (std::size_t n = 2; n < N; ++n) f[n] = -frequency * frequency * f[n - 2];
    return f;
  }
};

// No force, known at compile time, so that scenes without a force have no code for it.
template <class Real>
struct NoForcing {
  Real amplitude{0}, frequency{1};
  explicit constexpr operator bool() const { return false; }

  SinCos<Real> phase(const Real&) const { return {Real(0), Real(1)}; }
  SinCos<Real> phase(const Real&, const SinCos<Real>& before, const Real&) const { return before; }

  template <std::size_t N>
  std::array<Real, N> derivatives(const SinCos<Real>&) const {
    return {};
  }
};

// The requirements of motions on a force: whether there is one, amplitude f0, frequency omega_f > 0, the sine
// and cosine of its phase at a time of the run, and f and its derivatives at a phase.
template <class T, class Real>
concept ForceOf = requires(const T force, const Real& time, const SinCos<Real>& phase) {
  {bool(force)};
  { force.amplitude } -> std::convertible_to<Real>;
  { force.frequency } -> std::convertible_to<Real>;
  { force.phase(time) } -> std::same_as<SinCos<Real>>;
  { force.phase(time, phase, time) } -> std::same_as<SinCos<Real>>;
  { force.template derivatives<2>(phase) } -> std::same_as<std::array<Real, 2>>;
};

}  // namespace impact_damper
