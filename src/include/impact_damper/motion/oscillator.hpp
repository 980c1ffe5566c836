// u'' + 2 a u' + b u = f(t), a >= 0, b > 0 (M3.1). Flight is one such oscillator, sticking another, a contact
// two of them (contact.hpp), unless it is followed without modes (contact_without_modes.hpp).
//
// The propagator is (M3.2) with C and S of (M3.3). Each formula keeps its relative accuracy at and near
// critical damping, for short times (C - 1 and S - t come without cancellation) and through resonance.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

#include "impact_damper/math/complex.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/math/power_series.hpp"
#include "impact_damper/motion/forcing.hpp"

namespace impact_damper {

template <class Real>
struct Propagator {
  Real c{1}, s{0};    // C, S
  Real c1{0}, s1{0};  // C - 1, S - t
  Real v{1};          // S' = C - 2 a S, which would cancel where overdamped
};

// Displacement d and velocity d1, from rest, of an oscillator under f; for a short time also the integral of
// d.
template <class Real>
struct DrivenResponse {
  Real d{0}, d1{0};
  std::optional<Real> integral{};
};

template <class Real>
class Oscillator {
 public:
  Oscillator() = default;
  Oscillator(const Real& a, const Real& b) : a_(a), b_(b) {
    root_b_ = square_root(b);
    // b - a^2, exact to rounding near critical damping where b is 1.
    const Real discriminant = (root_b_ - a) * (root_b_ + a);
    underdamped_ = discriminant > 0;
    omega_ = square_root(absolute(discriminant));
    over_omega_ = 1 / omega_;
    over_root_b_ = 1 / root_b_;
    rate_ = underdamped_ ? root_b_ : Real(a + omega_);
    half_period_ = underdamped_ ? Real(half_turn<Real>() / omega_) : std::numeric_limits<Real>::infinity();
    if (!underdamped_) slow_rate_ = b / rate_;
    if (underdamped_) peak_to_inflection_ = angle_of(omega_, a) / omega_;
  }

  const Real& a() const { return a_; }
  const Real& b() const { return b_; }
  const Real& root_b() const { return root_b_; }
  const Real& rate() const { return rate_; }  // modulus of the fastest eigenvalue
  // The time between zeros of a free motion, and of each of its derivatives. Infinite where overdamped: they
  // have at most one.
  const Real& half_period() const { return half_period_; }

  // The first time >= 0 at which a free motion that begins with u and u', not both zero, falls through zero
  // (M7.2); only where underdamped. It keeps its relative accuracy where it is short, and where omega
  // vanishes.
  Real first_fall(const Real& u, const Real& u1) const {
    const Real phase = angle_of(Real(omega_ * u), Real(-(u1 + a_ * u)));
    return phase < 0 ? Real(phase * over_omega_ + 2 * half_period_) : Real(phase * over_omega_);
  }
  // Returns the first such fall at or after `from`, which must be no fall itself, nor near one: whole periods
  // are added to first_fall().
  [[gnu::always_inline]] Real fall(const Real& u, const Real& u1, const Real& from = Real(0)) const {
    const Real first = first_fall(u, u1);
    if (!(first < from)) return first;
    const Real period = 2 * half_period_;
    return first + Real(whole_above(double((from - first) / period))) * period;
  }
  // The time from a zero of u' to the next zero of u'' in a free motion; only where underdamped.
  const Real& peak_to_inflection() const { return peak_to_inflection_; }
  // Returns |u| at a turning point, u' = 0, of a free motion, a time t after it began with u and u'; only
  // where underdamped.
  Real height(const Real& u, const Real& u1, const Real& t) const {
    const Real along = (u1 + a_ * u) * over_omega_, height = square_root(Real(u * u + along * along));
    return a_ == 0 ? height : Real(height * exponential(Real(-a_ * t)) * omega_ / root_b_);
  }
  // Upper bound of |u| from the time t on, of a free motion that begins with u and u' (M3.5).
  Real bound_after(const Real& u, const Real& u1, const Real& t) const {
    const Real along = absolute(u1 + a_ * u), rate = underdamped_ ? a_ : slow_rate_;
    const Real size =
        absolute(u) + (underdamped_ ? Real(along * over_omega_) : Real(along * (t + 1 / slow_rate_)));
    return t == 0 ? size : Real(exponential(Real(-rate * t)) * size);
  }
  // The size of a free motion with u and u', which never grows: a bound on |u| from then on (M3.4).
  Real bound(const Real& u, const Real& u1) const {
    const Real scaled = u1 * over_root_b_;
    return square_root(Real(u * u + scaled * scaled));
  }
  // Lower bound on exp(-a t), without an exponential where a t is small.
  Real lower_bound_of_decay(const Real& t) const {
    const Real lost = a_ * t;
    return lost < Real(0.5) ? Real(1 - lost) : exponential(-lost);
  }
  // Whether a free motion oscillates before it has decayed.
  bool rings() const { return underdamped_ && 2 * omega_ > a_; }
  // Length of a quadrature panel that begins at the time t since the motion's beginning. Gauss's 16 points
  // integrate a product of two free motions over six radians to 3e-20 of its size; where the motion decays
  // without oscillating, over as long as it has been decaying, to 1e-17 of what it began with.
  Real panel(const Real& t) const {
    const Real six_radians = 6 / rate_;
    return !rings() && t > six_radians ? t : six_radians;
  }

  [[gnu::always_inline]] Propagator<Real> propagate(const Real& t) const {
    if (t == 0) return {};
    if (t * rate_ < Real(0.5)) return a_ == 0 ? propagate_shortly_undamped(t) : propagate_shortly(t);
    Propagator<Real> p;
    if (underdamped_) {
      const auto [sin, cos] = sin_cos(omega_ * t);
      p.s = sin * over_omega_;
      if (a_ == 0) {
        p.c = cos;
        p.c1 = cos > Real(0.5) ? -sin * sin / (1 + cos) : cos - 1;
        p.s1 = p.s - t;
        p.v = cos;
        return p;
      }
      const Real decay = exponential(-a_ * t);
      p.s *= decay;
      p.c = decay * cos + a_ * p.s;
      p.v = decay * cos - a_ * p.s;
    } else {
      const Real decay = exponential(-slow_rate_ * t),
                 fast_decay = exponential(Real(-(slow_rate_ + 2 * omega_) * t));
      p.s = omega_ == 0 ? Real(t * decay)
                        : Real(-decay * exponential_minus_1(Real(-2 * omega_ * t)) / (2 * omega_));
      p.v = fast_decay - slow_rate_ * p.s;
      p.c = decay + slow_rate_ * p.s;
      p.c1 = exponential_minus_1(Real(-slow_rate_ * t)) + slow_rate_ * p.s;
      p.s1 = p.s - t;
      return p;
    }
    p.c1 = p.c - 1;
    p.s1 = p.s - t;
    return p;
  }

  // Returns the response after a time t, from rest at the time when the force had `phase`. p: propagate(t).
  template <class Force>
  DrivenResponse<Real> respond(const Force& forcing, const SinCos<Real>& phase, const Real& t,
                               const Propagator<Real>& p) const {
    if (t == 0) return {};
    const auto& [sin, cos] = phase;
    const Real fastest = rate_ > forcing.frequency ? rate_ : forcing.frequency;
    if (t * fastest < Real(0.5)) return respond_shortly(forcing, sin, cos, t);
    // (M4.1): the response z to exp(i omega_f t), rotated by the phase at the beginning.
    const auto [z, z1] = response_to_rotation(forcing.frequency, t, p);
    return {forcing.amplitude * (sin * z.real() + cos * z.imag()),
            forcing.amplitude * (sin * z1.real() + cos * z1.imag())};
  }

 private:
  using Complex = impact_damper::Complex<Real>;
  struct ComplexResponse {
    Complex z, z1;
  };

  // Where undamped, C - 1 = -x/2 (1 - x/(3 4) (1 - x/(5 6) ...)) and S - t = -t x/(2 3) (1 - x/(4 5) ...),
  // x = b t^2 < 1/4.
  Propagator<Real> propagate_shortly_undamped(const Real& t) const {
    const auto& over = reciprocals<Real>;
    const Real x = b_ * t * t;
    Real c{1}, s{1};
    for (int n = last_undamped_term; n > 2; n -= 2) {
      c = 1 - x * (over[n] * over[n + 1]) * c;
      s = 1 - x * (over[n + 1] * over[n + 2]) * s;
    }
    Propagator<Real> p;
    p.c1 = -x / 2 * c;
    p.s1 = -t * x * over[6] * s;
    p.c = 1 + p.c1;
    p.s = t + p.s1;
    p.v = p.c;
    return p;
  }
  // The first n with (1/2)^n/n! below a rounding error, made odd.
  static constexpr int last_undamped_term = std::numeric_limits<Real>::digits10 < 17   ? 13
                                            : std::numeric_limits<Real>::digits10 < 20 ? 15
                                                                                       : 25;

  // Taylor series, term by term from the equation itself: S = sum s_n with s_n of order t^n, C - 1 = -b int
  // S.
  Propagator<Real> propagate_shortly(const Real& t) const {
    const auto& over = reciprocals<Real>;
    const Real at = 2 * a_ * t, bt = b_ * t * t, enough = std::numeric_limits<Real>::epsilon() / 16;
    Real before = t, now = -a_ * t * t;
    Real s1 = now, integral = t / 2 + now / 3;
    for (int n = 3; n + 2 < 64; n += 2) {
      const Real next = -(at * now * over[n] + bt * before * (over[n] * over[n - 1]));
      const Real after = -(at * next * over[n + 1] + bt * now * (over[n + 1] * over[n]));
      s1 += next + after;
      integral += next * over[n + 1] + after * over[n + 2];
      before = next;
      now = after;
      if (absolute(before) + absolute(now) <= enough * absolute(s1)) break;
    }
    Propagator<Real> p;
    p.s1 = s1;
    p.s = t + s1;
    p.c1 = -b_ * t * integral;
    p.c = 1 + p.c1;
    p.v = p.c - 2 * a_ * p.s;
    return p;
  }

  template <class Force>
  DrivenResponse<Real> respond_shortly(const Force& forcing, const Real& sin, const Real& cos,
                                       const Real& t) const {
    const Real at = 2 * a_ * t, bt = b_ * t * t, phase = forcing.frequency * t;
    // d_n, f_n: terms of order t^n of the response and of the force times t^2.
    const auto& over = reciprocals<Real>;
    Real f_now = forcing.amplitude * t * t * sin, f_next = forcing.amplitude * t * t * phase * cos;
    Real d_now = 0, d_next = 0, d = 0, d1 = 0, integral = 0;
    for (int n = 0; n + 3 < 64; ++n) {
      const Real weight = over[n + 1] * over[n + 2];
      const Real term = (f_now - bt * d_now) * weight - at * over[n + 2] * d_next;
      d += term;
      d1 += (n + 2) * term;
      integral += over[n + 3] * term;
      const Real f_after = -phase * phase * f_now * weight;
      f_now = f_next;
      f_next = f_after;
      d_now = d_next;
      d_next = term;
      // (M4.3) makes the terms to come from these four numbers. Fewer are not enough: where omega_f^2 = b,
      // two successive terms of d vanish, of order 6 and 7 if a/sqrt(b) is sqrt(3)/2, of order 8 and 9 if it
      // is sqrt(1/2), of order 10 and 11 if it is cos 18 or cos 54 degrees, and so on.
      const Real force_to_come = (absolute(f_now) + absolute(f_next)) * (over[n + 2] * over[n + 3]);
      if (absolute(d_now) + absolute(d_next) + force_to_come <=
          std::numeric_limits<Real>::epsilon() / 64 * absolute(d))
        break;
    }
    return {d, d1 / t, t * integral};
  }

  // The response z to exp(i omega_f t), from rest. Its imaginary part is the response to sin(omega_f t),
  // which is of order omega_f if the force is slow. Each form below is used where both parts keep their
  // relative accuracy (docs/mathematics.md, chapter 4).
  ComplexResponse response_to_rotation(const Real& frequency, const Real& t,
                                       const Propagator<Real>& p) const {
    const Real square = frequency * frequency;
    const bool well_overdamped = !underdamped_ && a_ < 2 * omega_, fast_has_decayed = Real(0.5) < t * rate_;
    if (well_overdamped && fast_has_decayed) return respond_by_two_decays(frequency, t);
    const bool near_resonance = 2 * a_ * a_ < b_ && b_ < 2 * square && square < 2 * b_;
    return near_resonance ? respond_by_difference(frequency, t) : respond_by_steady_state(frequency, t, p);
  }

  // Steady state minus the transient it starts with: where the steady state cannot be large.
  ComplexResponse respond_by_steady_state(const Real& frequency, const Real& t,
                                          const Propagator<Real>& p) const {
    const Real sin = sin_cos(frequency * t).sin, half = sin_cos(frequency * t / 2).sin;
    const Real cos_minus_c = -2 * half * half - p.c1;
    const Complex h(b_ - frequency * frequency, 2 * a_ * frequency);
    return {Complex(cos_minus_c, sin - frequency * p.s) / h,
            Complex(b_ * p.s - frequency * sin, frequency * (cos_minus_c + 2 * a_ * p.s)) / h};
  }

  // Underdamped, eigenvalues lambda = -a +- i omega: z = (E(lambda) - E(conj lambda)) / (2 i omega) with E of
  // (M4.2), which tends to t exp(lambda t) in resonance and is evaluated so that nothing cancels on the way
  // there.
  ComplexResponse respond_by_difference(const Real& frequency, const Real& t) const {
    const auto forced = sin_cos(frequency * t);
    const Real decay = exponential(-a_ * t), loss = -exponential_minus_1(-a_ * t);
    const auto difference = [&](const Real& omega) {
      const Real detuning = frequency - omega;
      const auto [sin, cos] = sin_cos(detuning * t);
      const Real half = sin_cos(detuning * t / 2).sin;
      const Complex denominator(a_, detuning);
      if (denominator == Complex(0)) return Complex(t) * Complex(forced.cos, forced.sin);
      return Complex(forced.cos, forced.sin) *
             (Complex(loss * cos + 2 * half * half, decay * sin) / denominator);
    };
    const Complex e1 = difference(omega_), e2 = difference(-omega_);
    const Complex lambda(-a_, omega_), twice_i_omega(0, 2 * omega_);
    return {(e1 - e2) / twice_i_omega, (lambda * e1 - conjugate(lambda) * e2) / twice_i_omega};
  }

  // Well overdamped, eigenvalues -r1 (slow) and -r2: the same with two real eigenvalues. A slow force on a
  // slow decay is far below its steady state, so E comes from its series where it is short.
  ComplexResponse respond_by_two_decays(const Real& frequency, const Real& t) const {
    const SinCos<Real> force = sin_cos(frequency * t);
    const Real half = sin_cos(frequency * t / 2).sin;
    const auto e = [&](const Real& rate) {
      // E = t exp(i omega_f t) phi(-z), phi(-z) = (1 - exp(-z))/z, z = (r + i omega_f) t.
      const Complex z(rate * t, frequency * t);
      Complex phi(0);
      if (rate * t + frequency * t < Real(0.5)) {
        for (int n = last_short_term; n > 0; --n) phi = Complex(Real(1) / n) - z * phi * Complex(Real(1) / n);
      } else {
        const Real decay = exponential(Real(-rate * t)), loss = -exponential_minus_1(Real(-rate * t));
        phi = Complex(loss * force.cos + 2 * half * half, decay * force.sin) / z;
      }
      return Complex(t) * (Complex(force.cos, force.sin) * phi);
    };
    const Real fast_rate = slow_rate_ + 2 * omega_;
    const Complex slow = e(slow_rate_), fast = e(fast_rate), apart(2 * omega_);
    return {(slow - fast) / apart, (Complex(fast_rate) * fast - Complex(slow_rate_) * slow) / apart};
  }
  // 1/2^n/n! is below a rounding error.
  static constexpr int last_short_term = std::numeric_limits<Real>::digits10 < 17   ? 16
                                         : std::numeric_limits<Real>::digits10 < 20 ? 18
                                                                                    : 30;

  Real a_{0}, b_{1};
  bool underdamped_ = true;
  Real omega_{1}, over_omega_{1};  // sqrt|b - a^2|
  Real slow_rate_{0};              // of the slower exponential, where there are two
  Real rate_{1};
  Real root_b_{1}, over_root_b_{1}, half_period_{0}, peak_to_inflection_{0};
};

// Returns u, u' and, by the equation of an oscillator without a force, the derivatives that follow.
template <std::size_t N, class Real>
[[gnu::always_inline]] inline std::array<Real, N> derivatives(const Oscillator<Real>& oscillator,
                                                              const Real& u, const Real& u1) {
  std::array<Real, N> d{u, u1};
  if (oscillator.a() == 0) {
    for (std::size_t n = 2; n < N; ++n) d[n] = -oscillator.b() * d[n - 2];
  } else {
    for (std::size_t n = 2; n < N; ++n) d[n] = -2 * oscillator.a() * d[n - 1] - oscillator.b() * d[n - 2];
  }
  return d;
}
// Returns the same under on_f f + on_f1 f'; f: the force and its derivatives.
template <std::size_t N, class Real>
[[gnu::always_inline]] inline std::array<Real, N> derivatives(const Oscillator<Real>& oscillator,
                                                              const Real& u, const Real& u1, const Real& on_f,
                                                              const Real& on_f1,
                                                              const std::array<Real, N + 1>& f) {
  std::array<Real, N> d{u, u1};
  for (std::size_t n = 2; n < N; ++n) {
    d[n] = on_f * f[n - 2] + on_f1 * f[n - 1] - 2 * oscillator.a() * d[n - 1] - oscillator.b() * d[n - 2];
  }
  return d;
}

// An oscillator under on_f f + on_f1 f' at one instant: the derivatives u^(n), n < N, and bounds on them from
// there on.
template <class Real, std::size_t N, class Force = Forcing<Real>>
class Instant {
 public:
  Instant(const Oscillator<Real>& oscillator, const Real& u, const Real& u1, const Real& on_f,
          const Real& on_f1, const Force& forcing, const SinCos<Real>& phase)
      : oscillator_(oscillator), forcing_(forcing) {
    if (!forcing) {
      d_ = impact_damper::derivatives<N>(oscillator, u, u1);
      return;
    }
    const auto f = forcing.template derivatives<N + 1>(phase);
    d_ = impact_damper::derivatives<N>(oscillator, u, u1, on_f, on_f1, f);
    // The steady state is the imaginary part of (on_f + i omega_f on_f1) amplitude exp(i omega_f t) / H with
    // H = b - omega_f^2 + 2 a i omega_f. In undamped resonance H is zero and the steady state NaN: bound()
    // then takes the other bound.
    const Real frequency = forcing.frequency;
    const Real re = oscillator.b() - frequency * frequency, im = 2 * oscillator.a() * frequency;
    const Real h2 = re * re + im * im;
    const Real on_sin = (re * on_f + im * on_f1 * frequency) / h2;
    const Real on_cos = (re * on_f1 - im * on_f / frequency) / h2;
    for (std::size_t n = 0; n < N; ++n) steady_[n] = on_sin * f[n] + on_cos * f[n + 1];
    const Real size = square_root(Real(on_f * on_f + on_f1 * on_f1 * frequency * frequency));
    force_ = absolute(forcing.amplitude) * size;
    steady_size_ = force_ / square_root(h2);
  }

  const Real& operator[](std::size_t n) const { return d_[n]; }
  const std::array<Real, N>& derivatives() const { return d_; }

  // Upper bound of |u^(n)| for a time `span`, without a force for ever (M3.4 and what follows it): the
  // smaller of two, the energy with what the force can add, and the steady state with the energy of the rest.
  Real bound(std::size_t n, const Real& span) const {
    const Real free = oscillator_.bound(d_[n], d_[n + 1]);
    if (!forcing_) return free;
    Real power{1};
    for (std::size_t i = 0; i < n; ++i) power *= forcing_.frequency;
    const Real growing = free + force_ * power * span / oscillator_.root_b(),
               steady = steady_size_ * power + transient(n);
    return steady < growing ? steady : growing;  // growing where steady is NaN
  }
  // The n-th derivative of the steady state under the force, and an upper bound of it.
  const Real& steady(std::size_t n) const { return steady_[n]; }
  Real steady_bound(std::size_t n) const {
    Real size = steady_size_;
    for (std::size_t i = 0; i < n; ++i) size *= forcing_.frequency;
    return size;
  }
  // Upper bound of u^(n) without its steady state, from here on.
  Real transient(std::size_t n) const {
    return oscillator_.bound(d_[n] - steady_[n], d_[n + 1] - steady_[n + 1]);
  }

 private:
  const Oscillator<Real>& oscillator_;
  Force forcing_;
  std::array<Real, N> d_, steady_{};
  Real force_{0}, steady_size_{0};
};

}  // namespace impact_damper
