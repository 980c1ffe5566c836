// Sine and cosine, exponential, logarithm and the angle of a point in double precision, with bits that
// depend on neither compiler nor processor nor C library: nothing but + - * /, each rounded to nearest, and
// integers. Adding and subtracting 1.5 times a power of two rounds to a multiple of a smaller one.
//
// An impact is one chain of operations that wait for each other, so these are made for short chains, with
// tables instead of long polynomials, sums as trees, and no branch that the usual argument takes differently
// from call to call. All go the same way: the argument is a table's point plus a remainder d; the head of the
// result, of about first order in d, is a sum of products that round nothing; all that is left, of second
// order, is added at last. So an error is half a unit of the last place (ulp) from that sum and, where |d| is
// at most 2^-5, 2^-11 times a few roundings more. tests/elementary.cpp states what is measured.
//
//   sine, cosine   x = k/16 + d:   sin x = S + C d + [C (sin d - d) + S (cos d - 1)], likewise cos x; d comes
//                  without any multiple of pi. Next to a multiple of pi/2 the head cancels, still exactly,
//                  but the error in what is left shows below 2^-10: such an x, one in a thousand, is done
//                  again with its distance from that multiple. From 7.75 on x first loses whole turns.
//   angle          of the smaller by the larger coordinate, t = k/64 + d, arctan t by Taylor's series; what
//                  the division rounded off is found exactly and counts with 1/(1 + t^2).
//   exponential    x = n ln 2/128 + d: 2^(n/128) (1 + d + ...).
//   logarithm      x = 2^e m, d = m/c - 1 exactly: e ln 2 + ln c + (d - d^2/2 + ...).
//
// SLEEF's deterministic scalar functions (3.5.1, cinz_*u10purec) have fixed bits too, but as a chain of
// dependent calls they took 3.8 (sine and cosine), 3.4 (angle), 2.6 (exponential) and 2.1 times (logarithm)
// as long as these.
#pragma once

#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <limits>

namespace impact_damper {

template <class Real>
struct SinCos {
  Real sin, cos;
};

namespace elementary {

static_assert(std::numeric_limits<double>::is_iec559 && FLT_EVAL_METHOD == 0,
              "the fixed bits of these functions need IEEE's double precision");

// --- Tables -----------------------------------------------------------------------------------------------
// The values from which sine, arc tangent, exponential and logarithm start, at evenly spaced points. None is
// typed in or fitted: elementary_tables.cpp sums the defining series in integers of 120 fraction bits at
// compile time, so that every compiler puts the same bits into the program.
//
// A value comes in two parts: a head that is a multiple of some power of two, so that a product of two heads
// plus a third is exact, and the rest, to 1e-30 or better.

// Sine and cosine of k/16, |k| < 128, that of a negative k at 256 + k. The heads are multiples of 2^-52; the
// shorter heads, multiples of 2^-25, are multiplied by multiples of 2^-27. Each entry is a cache line.
struct alignas(64) Circle {
  double sin, sin_rest, sin_short, sin_short_rest;
  double cos, cos_rest, cos_short, cos_short_rest;
};
extern const std::array<Circle, 256> circle;

// Coefficients of arctan(k/64 + d) = a0 + a1 d + ..., up to k = 64: the head of a0 is a multiple of 2^-51,
// that of a1 of 2^-25.
struct ArcTangent {
  double a0, a0_rest, a1_short, a1_rest;
  std::array<double, 6> a;  // a2 to a7
};
extern const std::array<ArcTangent, 65> arc_tangent;

// 2^(j/128); `rest` is divided by the value.
struct PowerOfTwo {
  double value, rest;
};
extern const std::array<PowerOfTwo, 128> power_of_two;

// For 128 intervals of m that cover [11/16, 11/8), 1/c at nine bits for some c within, exactly 1 on either
// side of 1, and ln c, its head a multiple of 2^-42.
struct Logarithm {
  double inverse, log, log_rest;
};
extern const std::array<Logarithm, 128> logarithms;

// --- Kernels ----------------------------------------------------------------------------------------------
inline std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }
inline double from_bits(std::uint64_t x) { return std::bit_cast<double>(x); }
// Integers are not used: leaving the floating-point registers and coming back costs more than a sum.
inline double magnitude(double x) { return std::fabs(x); }
inline double with_sign_of(double x, double sign) { return x * std::copysign(1.0, sign); }

// The rarer arguments: far from zero, next to a multiple of pi/2; beyond the range of the result; zero,
// infinite, not a number, or so small or large that products would not be exact.
[[gnu::noinline]] SinCos<double> sin_cos_far(double x);
[[gnu::cold, gnu::noinline]] SinCos<double> sin_cos_close(double x);
[[gnu::cold, gnu::noinline]] double exponential_beyond(double x);
[[gnu::cold, gnu::noinline]] double angle_of_beyond(double y, double x);
double exponential_minus_1(double x);
double logarithm(double x);

// Sine and cosine of x + tail, |x| < 7.75, |tail| below its last place.
inline SinCos<double> sin_cos_near(double x, double tail) {
  constexpr double sixteenths = 0x1.8p48, fine = 0x1.8p25;  // round to multiples of 2^-4 and 2^-27
  const double shifted = x + sixteenths, point = shifted - sixteenths;
  const double d = x - point, coarse_x = (x + fine) - fine;
  const double d_head = coarse_x - point, d_rest = (x - coarse_x) + tail;
  const Circle& at = circle[bits(shifted) & 0xff];

  // (sin d - d)/d^3 and (cos d - 1)/d^2 by Taylor's series in z = d^2 <= h = 2^-10, up to z^3 or z^4.
  // Chebyshev's polynomials replace the last power by lower ones, except for h^3/32 or h^4/128: z^3 = 3/2 h
  // z^2 - 9/16 h^2 z + h^3/32, z^4 = 2 h z^3 - 5/4 h^2 z^2 + h^3 z/4.
  constexpr double h = 0x1p-10, s9 = 1.0 / 362880, c8 = 1.0 / 40320;
  constexpr double s3 = -1.0 / 6 + h * h * h / 32 * s9, s5 = 1.0 / 120 - h * h * 9 / 16 * s9,
                   s7 = -1.0 / 5040 + h * 3 / 2 * s9;
  constexpr double c2 = -1.0 / 2 + h * h * h / 4 * c8, c4 = 1.0 / 24 - h * h * 5 / 4 * c8,
                   c6 = -1.0 / 720 + h * 2 * c8;
  const double z = d * d, z2 = z * z, dz = d * z;
  const double p = (s3 + z * s5) + z2 * s7, q = (c2 + z * c4) + z2 * c6;

  const double sin_first = (at.sin_rest + at.cos * d_rest) + at.cos_short_rest * d_head;
  const double cos_first = (at.cos_rest - at.sin * d_rest) - at.sin_short_rest * d_head;
  const double sin_second = (at.cos * dz) * p + (at.sin * z) * q;
  const double cos_second = (at.cos * z) * q - (at.sin * dz) * p;
  return {(at.sin + at.cos_short * d_head) + (sin_first + sin_second),
          (at.cos - at.sin_short * d_head) + (cos_first + cos_second)};
}

// Whether a multiple of pi/2 is so near that, unless it is 0, the sum above has lost too many digits.
inline bool is_close(const SinCos<double>& found) {
  const double sin = magnitude(found.sin), cos = magnitude(found.cos);
  return (sin < cos ? sin : cos) < 0x1p-10;
}

inline SinCos<double> sin_cos(double angle) {
  if (!(magnitude(angle) < 7.75)) return sin_cos_far(angle);
  const SinCos<double> found = sin_cos_near(angle, -0.0);
  if (is_close(found) && !(magnitude(angle) < 1 && angle != 0)) return sin_cos_close(angle);
  return found;
}

// x = n ln 2/128 + d and 2^(n/128), |x| < 746; `scale` has the bits to add for the factor 2^(n div 128).
struct ExponentialParts {
  const PowerOfTwo& power;
  std::uint64_t scale;
  double d, d_rest;
};
inline ExponentialParts exponential_parts(double x) {
  constexpr double whole = 0x1.8p52, by_step = 0x1.71547652b82fep+7;  // 128/ln 2
  // ln 2/128 in two parts, n times the first of which is exact.
  constexpr double step = 0x1.62e42fef8p-8, step_rest = 0x1.1cf79abc9e3b4p-43;
  const double shifted = x * by_step + whole, n = shifted - whole;
  const std::uint64_t count = bits(shifted);  // n but for the bits of `whole`, far above
  const double above = x - n * step, below = n * step_rest, d = above - below;
  return {power_of_two[count & 127], (count & ~std::uint64_t(127)) << 45, d, (above - d) - below};
}
// Returns value exp(d + rest), with exp(d) by Taylor's series, |d| <= ln 2/256; what it leaves out is below
// 6e-19.
inline double raised(double value, double d, double rest) {
  const double z = d * d, second = value * z;
  return value + ((value * (d + rest) + second * (1.0 / 2 + d * (1.0 / 6))) +
                  second * (z * (1.0 / 24 + d * (1.0 / 120))));
}

inline double exponential(double x) {
  if (!(magnitude(x) < 640)) return exponential_beyond(x);
  const auto [power, scale, d, d_rest] = exponential_parts(x);
  return raised(from_bits(bits(power.value) + scale), d, power.rest);
}

// The multiple of pi/2 from which, and the direction in which, an angle is counted, indexed by whether |y| >
// |x| and whether x < 0: pi/2 in a multiple of 2^-51 and the rest.
struct Quarter {
  double head, rest, sign;
};
inline constexpr double quarter_turn = 0x1.921fb54442d18p0, quarter_turn_rest = 0x1.1a62633145c07p-54;
inline constexpr std::array<Quarter, 4> quarters{{{0, 0, 1},
                                                  {2 * quarter_turn, 2 * quarter_turn_rest, -1},
                                                  {quarter_turn, quarter_turn_rest, -1},
                                                  {quarter_turn, quarter_turn_rest, 1}}};

// Returns the angle from 0 to pi of (x, y), y > 0. The larger of |x| and y must be below 2^500, the smaller
// above 2^-500 and above 2^-20 of the larger.
inline double angle_of_upper(double y, double x) {
  const double width = magnitude(x);
  const double larger = y > width ? y : width, smaller = y > width ? width : y;
  const double t = smaller / larger, per = 1 / larger;
  const Quarter& from = quarters[2 * (y > width) + (x < 0)];

  constexpr double sixty_fourths = 0x1.8p46, fine = 0x1.8p26;  // round to multiples of 2^-6 and 2^-26
  const double shifted = t + sixty_fourths, point = shifted - sixty_fourths;
  const double d = t - point, coarse_t = (t + fine) - fine;
  const double d_head = coarse_t - point, d_rest = t - coarse_t;
  const ArcTangent& at = arc_tangent[bits(shifted) & 0x7f];

  // The exact quotient minus t, (smaller - t larger)/larger, from products that round nothing that counts.
  const double upper = from_bits(bits(larger) & ~((std::uint64_t(1) << 27) - 1)), lower = larger - upper;
  const double lacking =
      (((smaller - coarse_t * upper) - coarse_t * lower) - d_rest * upper - d_rest * lower) * per;

  const auto& a = at.a;
  const double z = d * d;
  const double second = (a[0] + d * a[1]) + z * ((a[2] + d * a[3]) + z * (a[4] + d * a[5]));
  const double first = (at.a0_rest + at.a1_rest * d) + at.a1_short * (d_rest + lacking);
  const double head = at.a0 + at.a1_short * d_head;
  return (from.head + from.sign * head) + ((from.rest + from.sign * first) + (from.sign * z) * second);
}

inline double angle_of(double y, double x) {
  const double height = magnitude(y), width = magnitude(x);
  const double larger = height > width ? height : width, smaller = height > width ? width : height;
  if (!(larger < 0x1p500 && smaller > 0x1p-500 && smaller > larger * 0x1p-20)) return angle_of_beyond(y, x);
  return with_sign_of(angle_of_upper(height, x), y);
}

}  // namespace elementary
}  // namespace impact_damper
