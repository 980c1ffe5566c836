// The values from which the kernels of sine, arc tangent, exponential and logarithm start, at evenly spaced
// points. None is typed in or fitted: elementary_tables.cpp sums the defining series in integers of 120
// fraction bits at compile time, so that every compiler puts the same bits into the program.
//
// A value comes in two parts: a head that is a multiple of some power of two, so that a product of two heads
// plus a third is exact, and the rest, to 1e-30 or better.
#pragma once

#include <array>

namespace impact_damper::elementary {

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

}  // namespace impact_damper::elementary
