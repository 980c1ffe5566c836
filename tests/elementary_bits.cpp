// What the elementary functions owe to no measurement: special values, symmetries, and that every compiler
// makes the same bits of them.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "impact_damper/math/complex.hpp"
#include "impact_damper/math/elementary.hpp"

using namespace impact_damper;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double smallest = std::numeric_limits<double>::denorm_min();
constexpr double largest = std::numeric_limits<double>::max();
constexpr double pi = std::numbers::pi;

// Equal with the sign of a zero.
bool same(double a, double b) { return elementary::bits(a) == elementary::bits(b); }

// x_(n+1) = 6364136223846793005 x_n + 1442695040888963407 modulo 2^64 (Knuth's), its upper 53 bits in [0, 1).
struct Sequence {
  std::uint64_t state = 1;
  std::uint64_t next() { return state = state * 6364136223846793005u + 1442695040888963407u; }
  double unit() { return double(next() >> 11) * 0x1p-53; }
};

// Fowler, Noll and Vo's hash of results' bits.
struct Hash {
  std::uint64_t value = 14695981039346656037u;
  void add(double result) {
    for (int i = 0; i < 64; i += 8) value = (value ^ (elementary::bits(result) >> i & 0xff)) * 1099511628211u;
  }
};
template <class Of>
std::uint64_t hash(double scale, Of&& of) {
  Sequence sequence;
  Hash all;
  for (int i = 0; i < 20000; ++i) of(all, scale * (2 * sequence.unit() - 1));
  return all.value;
}

}  // namespace

TEST_CASE("Sine and cosine have their special values") {
  CHECK(same(sin_cos(0.0).sin, 0));
  CHECK(same(sin_cos(-0.0).sin, -0.0));
  CHECK(sin_cos(0.0).cos == 1);
  for (const double tiny : {smallest, 1e-310, 1e-200, 1e-9}) {
    CHECK(sin_cos(tiny).sin == tiny);
    CHECK(sin_cos(-tiny).sin == -tiny);
    CHECK(sin_cos(tiny).cos == 1);
  }
  for (const double none : {infinity, -infinity, not_a_number}) {
    CHECK(std::isnan(sin_cos(none).sin));
    CHECK(std::isnan(sin_cos(none).cos));
  }
  // What pi, in double precision, lacks of pi.
  CHECK(sin_cos(pi).sin == 0x1.1a62633145c07p-53);
  CHECK(sin_cos(pi / 2).cos == 0x1.1a62633145c07p-54);
}

TEST_CASE("The exponential has its special values") {
  CHECK(exponential(0.0) == 1);
  CHECK(exponential(-0.0) == 1);
  CHECK(exponential(smallest) == 1);
  CHECK(exponential(infinity) == infinity);
  CHECK(same(exponential(-infinity), 0));
  CHECK(std::isnan(exponential(not_a_number)));
  // The last arguments before and the first after the range: ln of the largest number, of half the smallest.
  CHECK(exponential(709.782712893384) < infinity);
  CHECK(exponential(709.7827128933841) == infinity);
  CHECK(exponential(1e300) == infinity);
  CHECK(exponential(-745.1332191019411) == smallest);
  CHECK(same(exponential(-745.1332191019412), 0));
  CHECK(same(exponential(-1e300), 0));
  CHECK(same(exponential_minus_1(0.0), 0));
  CHECK(same(exponential_minus_1(-0.0), -0.0));
  CHECK(exponential_minus_1(smallest) == smallest);
  CHECK(exponential_minus_1(-infinity) == -1);
  CHECK(exponential_minus_1(-50.0) == -1);
  CHECK(exponential_minus_1(710.0) == infinity);
  CHECK(exponential_minus_1(infinity) == infinity);
  CHECK(std::isnan(exponential_minus_1(not_a_number)));
}

TEST_CASE("The logarithm has its special values") {
  CHECK(same(logarithm(1.0), 0));
  CHECK(logarithm(0.0) == -infinity);
  CHECK(logarithm(-0.0) == -infinity);
  CHECK(logarithm(infinity) == infinity);
  CHECK(std::isnan(logarithm(-1.0)));
  CHECK(std::isnan(logarithm(-infinity)));
  CHECK(std::isnan(logarithm(not_a_number)));
  CHECK(logarithm(2.0) == std::numbers::ln2);
  CHECK(logarithm(smallest) == -744.4400719213812);
  CHECK(logarithm(largest) == 709.782712893384);
}

TEST_CASE("The angle of a point has its special values, in all quarters and on all axes") {
  for (const double x : {1.0, smallest, largest, infinity}) {
    CHECK(same(angle_of(0.0, x), 0));
    CHECK(same(angle_of(-0.0, x), -0.0));
    CHECK(angle_of(0.0, -x) == pi);
    CHECK(angle_of(-0.0, -x) == -pi);
    for (const double zero : {0.0, -0.0}) {
      CHECK(angle_of(x, zero) == pi / 2);
      CHECK(angle_of(-x, zero) == -pi / 2);
    }
    CHECK(angle_of(x, x) == pi / 4);
    CHECK(angle_of(-x, x) == -pi / 4);
    CHECK(angle_of(x, -x) == 3 * pi / 4);
    CHECK(angle_of(-x, -x) == -3 * pi / 4);
  }
  CHECK(same(angle_of(0.0, 0.0), 0));
  CHECK(same(angle_of(-0.0, 0.0), -0.0));
  CHECK(angle_of(0.0, -0.0) == pi);
  CHECK(angle_of(-0.0, -0.0) == -pi);
  CHECK(same(angle_of(1.0, infinity), 0));
  CHECK(angle_of(1.0, -infinity) == pi);
  CHECK(angle_of(infinity, 1.0) == pi / 2);
  CHECK(angle_of(-infinity, -1.0) == -pi / 2);
  CHECK(std::isnan(angle_of(not_a_number, 1.0)));
  CHECK(std::isnan(angle_of(1.0, not_a_number)));
  CHECK(same(angle_of(smallest, largest), 0));
}

TEST_CASE("Sine and angle are odd, cosine is even, to the last bit") {
  Sequence sequence;
  for (const double scale : {1e-3, 1.0, 8.0, 1e3, 1e9, 1e200})
    for (int i = 0; i < 2000; ++i) {
      const double x = scale * sequence.unit(), y = sequence.unit();
      const auto [sin, cos] = sin_cos(x);
      REQUIRE(same(sin_cos(-x).sin, -sin));
      REQUIRE(same(sin_cos(-x).cos, cos));
      REQUIRE(same(angle_of(-y, x), -angle_of(y, x)));
      REQUIRE(same(angle_of(-y, -x), -angle_of(y, -x)));
    }
}

TEST_CASE("Exponential and logarithm never fall by more than an ulp from a number to the next") {
  Sequence sequence;
  for (int i = 0; i < 20000; ++i) {
    const double x = 20 * sequence.unit() - 10, next = std::nextafter(x, infinity);
    REQUIRE(exponential(next) >= std::nextafter(exponential(x), 0));
    const double y = 4 * sequence.unit() + smallest, after = std::nextafter(y, infinity);
    REQUIRE(logarithm(after) >= std::nextafter(logarithm(y), -infinity));
  }
}

TEST_CASE("A whole number above is the least, at any size") {
  for (const double x : {0.0, 0.5, 1.0, -0.5, -1.5, 3.0000001, 4503599627370495.5, 4503599627370497.0, 1e300})
    CHECK(whole_above(x) == std::ceil(x));
  CHECK(std::isnan(whole_above(not_a_number)));
}

TEST_CASE("A complex quotient times its divisor is what was divided") {
  Sequence sequence;
  for (int i = 0; i < 1000; ++i) {
    const auto draw = [&] { return 2 * sequence.unit() - 1; };
    const Complex<double> a(draw(), draw()), b(1e-200 * draw(), 1e-200 * draw()), product = a / b * b;
    CHECK(product.real() == doctest::Approx(a.real()).epsilon(1e-13));
    CHECK(product.imag() == doctest::Approx(a.imag()).epsilon(1e-13));
  }
}

// Whoever sees another number here has a compiler, a flag or a processor that rounds in another way; or has
// changed the functions, and all results with them.
TEST_CASE("The bits are what they are") {
  const auto both = [](Hash& all, double x) { all.add(sin_cos(x).sin), all.add(sin_cos(x).cos); };
  CHECK(hash(8, both) == 17475839501668335133u);
  CHECK(hash(1e3, both) == 2055772904421619301u);
  CHECK(hash(1e12, both) == 10175674693338769060u);
  CHECK(hash(1e300, both) == 6174912901697142888u);
  CHECK(hash(1, [](Hash& all, double x) { all.add(exponential(x)); }) == 3648041739220285605u);
  CHECK(hash(750, [](Hash& all, double x) { all.add(exponential(x)); }) == 5273815655397172540u);
  CHECK(hash(40, [](Hash& all, double x) { all.add(exponential_minus_1(x)); }) == 15922752171949218023u);
  CHECK(hash(4, [](Hash& all, double x) { all.add(logarithm(std::fabs(x))); }) == 5879643866079323432u);
  CHECK(hash(1, [](Hash& all, double x) { all.add(angle_of(x, 0.4)), all.add(angle_of(0.4, x)); }) ==
        17380883772503182723u);
  CHECK(hash(1e-9, [](Hash& all, double x) { all.add(angle_of(x, -0.4)), all.add(angle_of(0.4, x)); }) ==
        6674399372106661719u);
}
