#include "impact_damper/math/elementary_kernels.hpp"

namespace impact_damper::elementary {
namespace {

__extension__ using Integer = __int128;
__extension__ using Unsigned = unsigned __int128;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t exponent_unit = std::uint64_t(1) << 52;

// Returns the upper half of a product.
Unsigned upper_product(Unsigned p, Unsigned q) {
  const Unsigned p1 = p >> 64, p0 = std::uint64_t(p), q1 = q >> 64, q0 = std::uint64_t(q);
  const Unsigned crossed = p1 * q0 + ((p0 * q0) >> 64);
  return p1 * q1 + (crossed >> 64) + ((p0 * q1 + std::uint64_t(crossed)) >> 64);
}

// |x| = quarters pi/2 + angle + rest, |angle| <= pi/4, modulo 2 pi.
struct Remainder {
  unsigned quarters;
  double angle, rest;
};

// 1/(2 pi) after 64 zero bits.
constexpr std::uint64_t per_turn[] = {0,
                                      0x28be60db9391054a,
                                      0x7f09d5f47d4d3770,
                                      0x36d8a5664f10e410,
                                      0x7f9458eaf7aef158,
                                      0x6dc91b8e909374b8,
                                      0x01924bba82746487,
                                      0x3f877ac72c4a69cf,
                                      0xba208d7d4baed121,
                                      0x3a671c09ad17df90,
                                      0x4e64758e60d4ce7d,
                                      0x272117e2ef7e4a0e,
                                      0xc7fe25fff7816603,
                                      0xfbcbc462d6829b47,
                                      0xdb4d9fb3c9f2c26d,
                                      0xd3d18fd9a797fa8b,
                                      0x5d49eeb1faf97c5e,
                                      0xcf41ce7de294a4ba,
                                      0x9afed7ec47e35742,
                                      0x1580cc11bf1edaea,
                                      0xfc33ef0826bd0d87};
constexpr Unsigned two_pi = (Unsigned(0xc90fdaa22168c234) << 64) | 0xc4c6628b80dc1cd1;  // in units of 2^-125

// Payne and Hanek's method, for finite |x| > 1: of x/(2 pi) = m 2^e/(2 pi) only the bits of 1/(2 pi) matter
// that yield the fraction. It comes in 128 bits, and no double's is below 2^-66 from a multiple of 1/4, so
// that the remainder has 60 good bits even then.
Remainder remainder(double x) {
  const std::uint64_t m = (bits(x) & (exponent_unit - 1)) | exponent_unit;
  const int position = 64 + int(bits(x) >> 52 & 0x7ff) - 1075;
  const std::uint64_t* from = per_turn + position / 64;
  const int shift = position % 64;
  const auto word = [&](int i) { return from[i] << shift | from[i + 1] >> 1 >> (63 - shift); };
  const Unsigned third = Unsigned(m) * word(2), second = Unsigned(m) * word(1) + (third >> 64);
  const Unsigned fraction = ((Unsigned(m * word(0)) << 64) + second);
  const unsigned turned = unsigned((fraction + (Unsigned(1) << 125)) >> 126);
  const Unsigned left = fraction - (Unsigned(turned) << 126);
  const bool negative = left >> 127;
  const Unsigned size = upper_product(negative ? -left : left, two_pi);
  const double angle = double(size), unit = negative ? -0x1p-125 : 0x1p-125;
  return {turned, angle * unit, double(Integer(size - Unsigned(angle))) * unit};
}

// A rounded sum or product, and its rounding error.
struct Sum {
  double value, rest;
};
Sum exact_sum(double a, double b) {
  const double sum = a + b, b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}
Sum exact_product(double a, double b) {
  constexpr std::uint64_t upper_half = ~((std::uint64_t(1) << 27) - 1);
  const double a1 = from_bits(bits(a) & upper_half), a0 = a - a1;
  const double b1 = from_bits(bits(b) & upper_half), b0 = b - b1;
  const double product = a * b;
  return {product, (((a1 * b1 - product) + a1 * b0) + a0 * b1) + a0 * b0};
}

}  // namespace

SinCos<double> sin_cos_close(double x) {
  if (!(magnitude(x) < infinity)) return {not_a_number, not_a_number};
  if (x == 0) return {x, 1};
  const Remainder left = remainder(magnitude(x));
  const auto [sin, cos] = sin_cos_near(left.angle, left.rest);
  const SinCos<double> turned[] = {{sin, cos}, {cos, -sin}, {-sin, -cos}, {-cos, sin}};
  return {with_sign_of(turned[left.quarters].sin, x), turned[left.quarters].cos};
}

// Cody and Waite's method: n turns in three parts of 2 pi, n times the first two of which are exact.
SinCos<double> sin_cos_far(double x) {
  if (!(magnitude(x) < 0x1p22)) return sin_cos_close(x);
  constexpr double whole = 0x1.8p52, per_radian = 0x1.45f306dc9c883p-3;
  constexpr double turn1 = 0x1.921fb544p+2, turn2 = 0x1.0b4611a8p-32, turn3 = -0x1.d9cceba3f91f2p-64;
  const double n = (x * per_radian + whole) - whole;
  const double above = x - n * turn1, second = n * turn2, third = n * turn3;
  const double below = second + third, angle = above - below;
  const SinCos<double> found = sin_cos_near(angle, ((above - angle) - below) - ((second - below) + third));
  return is_close(found) ? sin_cos_close(x) : found;
}

double exponential_beyond(double x) {
  if (x != x) return x;
  if (x > 710) return infinity;
  if (x < -746) return 0;
  // Scaled down or up before, so that the last product alone meets the limits of the range.
  const auto [power, scale, d, d_rest] = exponential_parts(x);
  const double value = from_bits(bits(power.value) + scale + std::uint64_t(x > 0 ? -64 : 64) * exponent_unit);
  return raised(value, d, power.rest) * (x > 0 ? 0x1p64 : 0x1p-64);
}

// 2^(n/128) - 1 + 2^(n/128) d may cancel: exactly, but for the smaller terms.
double exponential_minus_1(double x) {
  if (x == 0 || x != x) return x;
  if (x > 640) return exponential(x);
  if (x < -40) return -1;
  const auto [power, scale, d, d_rest] = exponential_parts(x);
  const double value = from_bits(bits(power.value) + scale), z = d * d;
  const Sum constant = exact_sum(value, -1), linear = exact_product(value, d);
  const Sum head = exact_sum(constant.value, linear.value);
  const double second =
      z * ((1.0 / 2 + d * (1.0 / 6)) + z * ((1.0 / 24 + d * (1.0 / 120)) + z * (1.0 / 720)));
  return head.value + ((head.rest + constant.rest + linear.rest + value * (d_rest + power.rest * (1 + d))) +
                       value * second);
}

double logarithm(double x) {
  if (!(x > 0)) return x == 0 ? -infinity : not_a_number;
  if (x == infinity) return x;
  const bool subnormal = x < std::numeric_limits<double>::min();
  const std::uint64_t number = bits(subnormal ? x * 0x1p54 : x), above = number - bits(11.0 / 16);
  const double e = double(std::int64_t(above) >> 52) - 54 * subnormal;
  const double m = from_bits(number - (above & ~(exponent_unit - 1)));
  const Logarithm& at = logarithms[above >> 45 & 127];
  const double m_upper = from_bits(bits(m) & ~((std::uint64_t(1) << 21) - 1));
  const double d_upper = m_upper * at.inverse - 1, d_lower = (m - m_upper) * at.inverse;
  const double d = d_upper + d_lower, d_rest = (d_upper - d) + d_lower;

  // ln 2 in a multiple of 2^-42 and the rest.
  constexpr double ln_2 = 0x1.62e42fefa38p-1, ln_2_rest = 0x1.ef35793c76730p-45;
  const double constant = e * ln_2 + at.log;
  const double head = constant + d, head_rest = (constant - head) + d;
  // ln(1 + d) - d by Taylor's series, |d| <= 2^-7; what it leaves out is below 2^-59 d.
  const double z = d * d, z2 = z * z;
  const double second = z * (((-1.0 / 2 + d * (1.0 / 3)) + z * (-1.0 / 4 + d * (1.0 / 5))) +
                             z2 * ((-1.0 / 6 + d * (1.0 / 7)) - z * (1.0 / 8)));
  return head + ((head_rest + (d_rest + (e * ln_2_rest + at.log_rest))) + second);
}

// The coordinates are scaled into range by powers of two; where the quotient is tiny it is the angle.
double angle_of_beyond(double y, double x) {
  if (x != x || y != y) return not_a_number;
  const double height = magnitude(y), width = magnitude(x);
  const bool is_left = std::signbit(x);
  const auto whole = [&](double count) {
    return with_sign_of(count * quarter_turn + count * quarter_turn_rest, y);
  };
  if (height == 0) return is_left ? whole(2) : y;
  if (width == 0) return whole(1);
  if (height == infinity && width == infinity) return whole(is_left ? 1.5 : 0.5);
  if (height == infinity) return whole(1);
  if (width == infinity) return is_left ? whole(2) : with_sign_of(0, y);

  const double quotient = height / width;
  if (quotient > 0x1p60) return whole(1);
  if (quotient < 0x1p-60) return is_left ? whole(2) : with_sign_of(quotient, y);
  // Scaled by a power of two into the middle of the range, if the coordinates are not there.
  const double scale = height > 0x1p400 || width > 0x1p400     ? 0x1p-600
                       : height < 0x1p-400 || width < 0x1p-400 ? 0x1p600
                                                               : 1;
  const double y1 = height * scale, x1 = x * scale, width1 = width * scale;
  const double larger = y1 > width1 ? y1 : width1, smaller = y1 > width1 ? width1 : y1;
  if (smaller > larger * 0x1p-20) return with_sign_of(angle_of_upper(y1, x1), y);
  // With t = smaller/larger rounded, the arc tangent of the exact quotient is t + (quotient - t) - t^3/3.
  const Quarter& from = quarters[2 * (y1 > width1) + (x < 0)];
  const double t = smaller / larger;
  const Sum product = exact_product(t, larger);
  const double lacking = ((smaller - product.value) - product.rest) / larger - t * t * t * (1.0 / 3);
  const Sum head = exact_sum(from.head, from.sign * t);
  return with_sign_of(head.value + (head.rest + from.rest + from.sign * lacking), y);
}

}  // namespace impact_damper::elementary
