#include <bit>
#include <cstdint>

#include "impact_damper/math/elementary_kernels.hpp"

namespace impact_damper::elementary {
namespace {

__extension__ using Integer = __int128;
__extension__ using Unsigned = unsigned __int128;

// Numbers below 128 in units of 2^-120.
using Fixed = Integer;
constexpr int fraction_bits = 120;
constexpr Fixed one = Fixed(1) << fraction_bits;

constexpr Fixed times(Fixed a, Fixed b) {
  const bool negative = (a < 0) != (b < 0);
  const Unsigned p = Unsigned(a < 0 ? -a : a), q = Unsigned(b < 0 ? -b : b);
  const Unsigned p1 = p >> 64, p0 = std::uint64_t(p), q1 = q >> 64, q0 = std::uint64_t(q);
  const Unsigned crossed = p1 * q0 + ((p0 * q0) >> 64) + std::uint64_t(p0 * q1);
  const Unsigned high = p1 * q1 + ((p0 * q1) >> 64) + (crossed >> 64);
  const Fixed product =
      Fixed((high << (128 - fraction_bits)) + (std::uint64_t(crossed) >> (fraction_bits - 64)));
  return negative ? -product : product;
}

constexpr double power(int exponent) { return std::bit_cast<double>(std::uint64_t(1023 + exponent) << 52); }

// Returns the nearest multiple of 2^-bits; rest() returns the difference.
constexpr double head(Fixed value, int bits) {
  const int shift = fraction_bits - bits;
  return double(std::int64_t((value + (Fixed(1) << (shift - 1))) >> shift)) * power(-bits);
}
constexpr double rest(Fixed value, double head) {
  return double(value - Fixed(head * power(60)) * (Fixed(1) << (fraction_bits - 60))) * power(-fraction_bits);
}

// sum of sign^n x^(2n + 1)/(2n + 1): the arc tangent, or with the other sign its hyperbolic twin.
constexpr Fixed arc(Fixed x, int sign) {
  Fixed sum = 0, term = x;
  for (int n = 1; term != 0; n += 2) {
    sum += term / n;
    term = sign * times(term, times(x, x));
  }
  return sum;
}

constexpr auto make_circle() noexcept {
  // sin and cos of 1/16 by their series, those of the other points by rotation.
  Fixed sin = 0, cos = 0, term = one;
  for (int n = 1; term != 0; n += 2) {
    cos += term;
    term = term / (16 * Fixed(n));
    sin += term;
    term = -term / (16 * Fixed(n + 1));
  }
  std::array<Circle, 256> all{};
  Fixed s = 0, c = one;
  for (int k = 0; k < 128; ++k) {
    Circle& at = all[k];
    at.sin = head(s, 52), at.sin_rest = rest(s, at.sin);
    at.sin_short = head(s, 25), at.sin_short_rest = rest(s, at.sin_short);
    at.cos = head(c, 52), at.cos_rest = rest(c, at.cos);
    at.cos_short = head(c, 25), at.cos_short_rest = rest(c, at.cos_short);
    if (k > 0) {
      all[256 - k] = {-at.sin, -at.sin_rest, -at.sin_short, -at.sin_short_rest,
                      at.cos,  at.cos_rest,  at.cos_short,  at.cos_short_rest};
    }
    const Fixed next = times(s, cos) + times(c, sin);
    c = times(c, cos) - times(s, sin);
    s = next;
  }
  return all;
}

constexpr auto make_arc_tangent() noexcept {
  std::array<ArcTangent, 65> all{};
  Fixed angle = 0;
  for (int k = 0; k < 65; ++k) {
    // arctan c' - arctan c = arctan((c' - c)/(1 + c c')), c = k/64.
    if (k > 0) angle += arc(one / (64 * 64 + k * (k - 1)) * 64, -1);
    ArcTangent& at = all[k];
    at.a0 = head(angle, 51);
    at.a0_rest = rest(angle, at.a0);
    // a1 = 1/(1 + c^2), and by the equation of the derivative, (1 + t^2) a' = 1:
    // (1 + c^2) (n + 1) a_(n+1) + 2 c n a_n + (n - 1) a_(n-1) = 0.
    const Fixed a1 = one / (4096 + Fixed(k) * k) * 4096;
    at.a1_short = head(a1, 25);
    at.a1_rest = rest(a1, at.a1_short);
    Fixed before = 0, now = a1;
    for (int n = 1; n < 7; ++n) {
      const Fixed next = -times(a1, now * n / 32 * k + before * (n - 1)) / (n + 1);
      at.a[n - 1] = double(next) * power(-fraction_bits);
      before = now;
      now = next;
    }
  }
  return all;
}

constexpr Fixed ln_2 = 2 * arc(one / 3, 1);

constexpr auto make_power_of_two() noexcept {
  Fixed step = 0, term = one;
  for (int n = 1; term != 0; ++n) {
    step += term;
    term = times(term, ln_2 / 128) / n;
  }
  std::array<PowerOfTwo, 128> all{};
  Fixed value = one;
  for (PowerOfTwo& at : all) {
    at.value = head(value, 52);
    at.rest = rest(value, at.value) / at.value;
    value = times(value, step);
  }
  return all;
}

constexpr auto make_logarithms() noexcept {
  std::array<Logarithm, 128> all{};
  for (int i = 0; i < 128; ++i) {
    // The middle of the interval in units of 1/512: 128 steps of 1/128 from 11/8 of 1/2 on, where m >= 1;
    // half as large where m < 1.
    const int middle = i < 80 ? 2 * (176 + i) + 1 : 4 * (128 + i - 80) + 2;
    const int inverse = i == 79 || i == 80 ? 512 : (512 * 512 + middle / 2) / middle;
    all[i].inverse = inverse * power(-9);
    // ln c = -ln(inverse) = 2 artanh((1 - inverse)/(1 + inverse)).
    const Fixed log = 2 * arc(one / (512 + inverse) * (512 - inverse), 1);
    all[i].log = head(log, 42);
    all[i].log_rest = rest(log, all[i].log);
  }
  return all;
}

}  // namespace

constinit const std::array<Circle, 256> circle = make_circle();
constinit const std::array<ArcTangent, 65> arc_tangent = make_arc_tangent();
constinit const std::array<PowerOfTwo, 128> power_of_two = make_power_of_two();
constinit const std::array<Logarithm, 128> logarithms = make_logarithms();

}  // namespace impact_damper::elementary
