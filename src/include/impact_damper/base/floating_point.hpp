// Checks the conditions for the promise of equal bits: double precision, every operation rounded by itself,
// to nearest, down to the smallest number.
//
// The compiler and code that runs in the same process can violate them: -ffast-math and its parts,
// contraction to fused multiply-add, arithmetic in x87 registers; a rounding mode that a library left behind;
// denormal numbers flushed to zero, as by the start-up code that g++ and clang++ link into a program built
// with -ffast-math, whatever its libraries were built with. What the preprocessor can see is rejected at
// compile time, in every source that includes an engine; the rest by require_arithmetic().
#pragma once

#include <cfloat>
#include <string>

#include "impact_damper/base/errors.hpp"

// This holds for code that only calls the library, too: inline functions of a header are compiled in many
// places, and the linker keeps any one of them.
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || \
    defined(__NO_SIGNED_ZEROS__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "impact-damper: results would not have the promised bits: compile without -ffast-math and its parts"
#endif
#if FLT_EVAL_METHOD != 0
#error \
    "impact-damper: results would not have the promised bits: FLT_EVAL_METHOD must be 0, on x86 by -mfpmath=sse"
#endif

namespace impact_damper {

// Returns one line on which promise the arithmetic breaks and what to do about it; nullptr if none. Takes
// less than 0.1 us.
//
// Inlined wherever it is called, so that it is compiled as its caller is; volatile, so that it is computed
// where and when it runs. The numbers are chosen so that a faulty operation is off by its last bit.
[[gnu::always_inline]] inline const char* broken_promise() {
  const volatile double given_one = 1, given_tiny = 0x1p-60, given_least = DBL_MIN,
                        given_denormal = 0x1p-1074;
  const volatile double given_odd = 1 + 0x1p-30, given_square = 1 + 0x1p-29, given_divisor = 49;
  const volatile double given_more_than_half = 0x1p-53 + 0x1p-64;
  const double one = given_one, tiny = given_tiny;

  const volatile double above = one + tiny, below = one - tiny;
  if (above != 1 || below != 1)
    return "the rounding mode is not to nearest: std::fesetround(FE_TONEAREST) before each run sets it";

  const volatile double half_the_least = given_least * 0.5, lifted = given_denormal * 0x1p1000;
  if (half_the_least == 0 || lifted == 0)
    return "denormal numbers are flushed to zero: link without -ffast-math, or clear the processor's FTZ and "
           "DAZ "
           "bits before each run";

  const double odd = given_odd, square = given_square;
  if (odd * odd - square != 0)  // the square is rounded: fused, its last bit would be left
    return "products are fused with sums: compile with -ffp-contract=off";

  const volatile double twice_rounded = one + given_more_than_half;
  if ((one + tiny) - one != 0 || twice_rounded != 1 + 0x1p-52)
    return "sums are reordered, or kept in more than double precision: compile without -ffast-math and its "
           "parts, "
           "on x86 with -mfpmath=sse";

  // 49 times its rounded reciprocal is not 1. There are several quotients, since no compiler uses a
  // reciprocal for one.
  const double divisor = given_divisor, twice = 2 * given_divisor, fourfold = 4 * given_divisor;
  const double first = given_divisor / divisor, second = twice / divisor, third = fourfold / divisor;
  if (first + second + third != 7)
    return "divisions are made by reciprocals: compile without -ffast-math and its parts";
  return nullptr;
}

// Throws NumericalError if broken_promise() finds one. Every engine begins with it: a process may change the
// modes of its processor between two runs.
[[gnu::always_inline]] inline void require_arithmetic() {
  if (const char* broken = broken_promise())
    throw NumericalError(std::string("results would not have the promised bits: ") + broken);
}

}  // namespace impact_damper
