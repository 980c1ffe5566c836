// The elementary functions held against MPFR. An error is in units of the last place (ulp) of the exact
// result, for subnormal ones of the smallest number; half a unit is what rounding alone costs. The largest
// errors met in 100,000 arguments for each line: sine and cosine 0.58, next to a quarter turn's multiple
// 0.77, tiny 0.53, large 0.57; exponential 0.51, in subnormal numbers 0.75; less 1 0.502; logarithm 0.51;
// angle 0.61.
#include "impact_damper/math/elementary.hpp"

#include <doctest/doctest.h>
#include <mpfr.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>

using namespace impact_damper;

namespace {

class Exact {
 public:
  explicit Exact(double value = 0) {
    mpfr_init2(number_, 160);
    mpfr_set_d(number_, value, MPFR_RNDN);
  }
  Exact(const Exact&) = delete;
  Exact& operator=(const Exact&) = delete;
  ~Exact() { mpfr_clear(number_); }
  operator mpfr_ptr() { return number_; }

 private:
  mpfr_t number_;
};

double ulps(double got, Exact& exact) {
  const double nearest = mpfr_get_d(exact, MPFR_RNDN);
  if (std::isnan(nearest) || std::isinf(nearest) || !std::isfinite(got))
    return got == nearest || (std::isnan(got) && std::isnan(nearest)) ? 0 : HUGE_VAL;
  int exponent = -1021;
  if (std::fabs(nearest) >= std::numeric_limits<double>::min()) std::frexp(nearest, &exponent);
  Exact difference;
  mpfr_sub_d(difference, exact, got, MPFR_RNDN);
  mpfr_mul_2si(difference, difference, 53 - exponent, MPFR_RNDN);
  return std::fabs(mpfr_get_d(difference, MPFR_RNDN));
}

std::mt19937_64 source(1);
double between(double low, double high) { return low + (high - low) * (double(source() >> 11) * 0x1p-53); }
double either_sign(double x) { return source() & 1 ? x : -x; }
// Of any size from 2^low to 2^high, spread evenly in its logarithm.
double of_any_size(double low, double high) { return either_sign(std::exp2(between(low, high))); }
double any_double() { return elementary::from_bits(source()); }
// Near a multiple of pi/2 up to n of them, at a distance of any size from 2^low to 2^high.
double near_axis(double n, double low, double high) {
  return std::floor(between(-n, n)) * (std::numbers::pi / 2) + of_any_size(low, high);
}

// IMPACT_DAMPER_ARGUMENTS=100 in the environment: a hundred times as many.
const int arguments = [] {
  const char* factor = std::getenv("IMPACT_DAMPER_ARGUMENTS");
  return 20000 * (factor ? std::atoi(factor) : 1);
}();

template <class Draw, class Error>
void expect_below(double bound, Draw&& draw, Error&& error) {
  double worst = 0;
  for (int i = 0; i < arguments; ++i) worst = std::fmax(worst, error(draw()));
  INFO("over ", arguments, " arguments");
  CHECK(worst < bound);
}

using Function = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);
template <class Own, class Draw>
void expect_below(double bound, Own&& own, Function function, Draw&& draw) {
  expect_below(bound, draw, [&](double x) {
    Exact exact(x);
    function(exact, exact, MPFR_RNDN);
    return ulps(own(x), exact);
  });
}

double sine(double x) { return sin_cos(x).sin; }
double cosine(double x) { return sin_cos(x).cos; }
template <class Draw>
void expect_sine_and_cosine_below(double bound, Draw&& draw) {
  expect_below(bound, sine, mpfr_sin, draw);
  expect_below(bound, cosine, mpfr_cos, draw);
}

struct Point {
  double y, x;
};
template <class Draw>
void expect_angle_below(double bound, Draw&& draw) {
  expect_below(bound, draw, [](const Point& p) {
    Exact y(p.y), x(p.x);
    mpfr_atan2(y, y, x, MPFR_RNDN);
    return ulps(angle_of(p.y, p.x), y);
  });
}

}  // namespace

TEST_CASE("Sine and cosine of moderate angles err by less than 0.6 ulp") {
  expect_sine_and_cosine_below(0.6, [] { return between(-8, 8); });
  expect_sine_and_cosine_below(0.6, [] { return between(-0.1, 0.1); });
}
TEST_CASE("Sine and cosine next to multiples of a quarter turn err by less than 0.8 ulp") {
  expect_sine_and_cosine_below(0.8, [] { return near_axis(6, -12, -4); });
  expect_sine_and_cosine_below(0.8, [] { return near_axis(6, -60, -8); });
  expect_sine_and_cosine_below(0.8, [] { return near_axis(2.6e6, -40, -5); });
  expect_sine_and_cosine_below(0.8, [] { return near_axis(1e12, -40, -5); });
}
TEST_CASE("Sine and cosine of tiny angles err by less than 0.6 ulp") {
  expect_sine_and_cosine_below(0.6, [] { return of_any_size(-1074, -2); });
}
TEST_CASE("Sine and cosine of large and of huge angles err by less than 0.65 ulp") {
  expect_sine_and_cosine_below(0.65, [] { return between(8, 1e3); });
  expect_sine_and_cosine_below(0.65, [] { return between(-5e6, 5e6); });
  expect_sine_and_cosine_below(0.65, [] { return between(-1e12, 1e12); });
  expect_sine_and_cosine_below(0.65, any_double);
}
TEST_CASE("The double nearest to a multiple of a quarter turn has a right cosine") {
  // 6381956970095103 2^797, the worst of all doubles: 4.7e-19 away.
  const double x = std::ldexp(6381956970095103.0, 797);
  expect_below(0.6, cosine, mpfr_cos, [&] { return x; });
  expect_below(0.6, sine, mpfr_sin, [&] { return x; });
  CHECK(std::fabs(cosine(x)) < 5e-19);
}

double exponent(double x) { return exponential(x); }
TEST_CASE("The exponential errs by less than 0.52 ulp, by less than 0.8 where it leaves the range") {
  expect_below(0.52, exponent, mpfr_exp, [] { return between(-1, 1); });
  expect_below(0.52, exponent, mpfr_exp, [] { return between(-40, 40); });
  expect_below(0.52, exponent, mpfr_exp, [] { return between(-640, 700); });
  expect_below(0.52, exponent, mpfr_exp, [] { return of_any_size(-1074, 5); });
  expect_below(0.8, exponent, mpfr_exp, [] { return between(-746, -700); });
  expect_below(0.8, exponent, mpfr_exp, [] { return between(700, 711); });
}

double exponent_minus_1(double x) { return exponential_minus_1(x); }
TEST_CASE("The exponential minus 1 errs by less than 0.52 ulp") {
  expect_below(0.52, exponent_minus_1, mpfr_expm1, [] { return between(-1, 1); });
  expect_below(0.52, exponent_minus_1, mpfr_expm1, [] { return between(-0.02, 0.02); });
  expect_below(0.52, exponent_minus_1, mpfr_expm1, [] { return between(-50, 711); });
  expect_below(0.52, exponent_minus_1, mpfr_expm1, [] { return of_any_size(-1074, 9); });
}

double natural_logarithm(double x) { return logarithm(x); }
TEST_CASE("The logarithm errs by less than 0.53 ulp") {
  expect_below(0.53, natural_logarithm, mpfr_log, [] { return between(0, 4); });
  expect_below(0.53, natural_logarithm, mpfr_log, [] { return between(0.9, 1.1); });
  expect_below(0.53, natural_logarithm, mpfr_log, [] { return 1 + of_any_size(-52, -2); });
  expect_below(0.53, natural_logarithm, mpfr_log, [] { return std::fabs(of_any_size(-1074, 1024)); });
}

TEST_CASE("The angle of a point errs by less than 0.65 ulp") {
  expect_angle_below(0.65, [] { return Point{between(-1, 1), between(-1, 1)}; });
  expect_angle_below(0.65, [] { return Point{between(-0.1, 0.1), either_sign(1)}; });
  expect_angle_below(0.65, [] { return Point{of_any_size(-40, 0), either_sign(1)}; });
  expect_angle_below(0.65, [] { return Point{either_sign(1), of_any_size(-40, 0)}; });
}
TEST_CASE("The angle of a point next to a diagonal errs by less than 0.65 ulp") {
  expect_angle_below(0.65, [] { return Point{1 + of_any_size(-52, -4), either_sign(1)}; });
}
TEST_CASE("The angle of points of any size errs by less than 0.65 ulp") {
  expect_angle_below(0.65, [] { return Point{any_double(), any_double()}; });
  expect_angle_below(0.65, [] { return Point{of_any_size(-1074, 1024), of_any_size(-1074, 1024)}; });
  expect_angle_below(0.65, [] { return Point{of_any_size(-1074, -1000), of_any_size(-1074, -1000)}; });
  expect_angle_below(0.65, [] { return Point{of_any_size(980, 1024), of_any_size(980, 1024)}; });
  expect_angle_below(0.65, [] { return Point{of_any_size(-1074, -1000), of_any_size(-1, 1)}; });
}
