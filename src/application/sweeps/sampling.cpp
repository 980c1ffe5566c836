#include "application/sweeps/sampling.hpp"

#include <algorithm>
#include <bit>

#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

// Purpose of a block of random words, the last word of its counter. Rounds of the permutation follow.
constexpr std::uint32_t for_uniform = 0;
constexpr std::uint32_t permutation_rounds = 8;

std::array<std::uint32_t, 4> block(const Draw& draw, std::uint64_t index, std::uint32_t purpose) {
  return philox({std::uint32_t(index), std::uint32_t(index >> 32), draw.variable, purpose},
                {std::uint32_t(draw.seed), std::uint32_t(draw.seed >> 32)});
}

// c[0] + c[1] r + c[2] r^2 + ...
double polynomial(const std::array<double, 8>& c, double r) {
  double sum = c[7];
  for (std::size_t i = 7; i-- > 0;) sum = sum * r + c[i];
  return sum;
}

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  constexpr int rounds = 10;
  constexpr std::uint64_t multiplier_0 = 0xD2511F53, multiplier_1 = 0xCD9E8D57;
  constexpr std::uint32_t weyl_0 = 0x9E3779B9, weyl_1 = 0xBB67AE85;
  for (int round = 0; round < rounds; ++round) {
    const std::uint64_t a = multiplier_0 * counter[0], b = multiplier_1 * counter[2];
    counter = {std::uint32_t(b >> 32) ^ counter[1] ^ key[0], std::uint32_t(b),
               std::uint32_t(a >> 32) ^ counter[3] ^ key[1], std::uint32_t(a)};
    key = {key[0] + weyl_0, key[1] + weyl_1};
  }
  return counter;
}

double uniform_draw(const Draw& draw) {
  const auto words = block(draw, std::uint64_t(draw.index), for_uniform);
  const std::uint64_t bits = (std::uint64_t(words[1]) << 32 | words[0]) >> 12;  // 52 of them
  return (double(bits) + 0.5) * 0x1p-52;
}

double stratified_draw(const Draw& draw, std::int64_t count) {
  const double drawn = (double(permuted(draw, count)) + uniform_draw(draw)) / double(count);
  return std::min(drawn, 1 - 0x1p-53);  // the sum may have been rounded up
}

std::int64_t permuted(const Draw& draw, std::int64_t count) {
  const int bits = static_cast<int>(std::bit_width(std::uint64_t(count - 1))),
            half = std::max(1, (bits + 1) / 2);
  const std::uint64_t mask = (std::uint64_t(1) << half) - 1;
  std::uint64_t at = std::uint64_t(draw.index);
  do {
    std::uint64_t left = at >> half, right = at & mask;
    for (std::uint32_t round = 1; round <= permutation_rounds; ++round) {
      const std::uint64_t mixed = left ^ (block(draw, right, round)[0] & mask);
      left = right;
      right = mixed;
    }
    at = left << half | right;
  } while (at >= std::uint64_t(count));
  return std::int64_t(at);
}

double normal_quantile(double p) {
  // M.J. Wichura's PPND16: for p near 1/2; else for r = sqrt(-ln(min(p, 1 - p))) up to 5; beyond it.
  constexpr std::array<double, 8> a{
      3.3871328727963666080e+0, 1.3314166789178437745e+2, 1.9715909503065514427e+3, 1.3731693765509461125e+4,
      4.5921953931549871457e+4, 6.7265770927008700853e+4, 3.3430575583588128105e+4, 2.5090809287301226727e+3};
  constexpr std::array<double, 8> b{
      1.0000000000000000000e+0, 4.2313330701600911252e+1, 6.8718700749205790830e+2, 5.3941960214247511077e+3,
      2.1213794301586595867e+4, 3.9307895800092710610e+4, 2.8729085735721942674e+4, 5.2264952788528545610e+3};
  constexpr std::array<double, 8> c{1.42343711074968357734e+0, 4.63033784615654529590e+0,
                                    5.76949722146069140550e+0, 3.64784832476320460504e+0,
                                    1.27045825245236838258e+0, 2.41780725177450611770e-1,
                                    2.27238449892691845833e-2, 7.74545014278341407640e-4};
  constexpr std::array<double, 8> d{1.00000000000000000000e+0, 2.05319162663775882187e+0,
                                    1.67638483018380384940e+0, 6.89767334985100004550e-1,
                                    1.48103976427480074590e-1, 1.51986665636164571966e-2,
                                    5.47593808499534494600e-4, 1.05075007164441684324e-9};
  constexpr std::array<double, 8> e{6.65790464350110377720e+0, 5.46378491116411436990e+0,
                                    1.78482653991729133580e+0, 2.96560571828504891230e-1,
                                    2.65321895265761230930e-2, 1.24266094738807843860e-3,
                                    2.71155556874348757815e-5, 2.01033439929228813265e-7};
  constexpr std::array<double, 8> f{1.00000000000000000000e+0, 5.99832206555887937690e-1,
                                    1.36929880922735805310e-1, 1.48753612908506148525e-2,
                                    7.86869131145613259100e-4, 1.84631831751005468180e-5,
                                    1.42151175831644588870e-7, 2.04426310338993978564e-15};
  constexpr double middle = 0.425, widest_tail = 5;
  const double q = p - 0.5;
  if (absolute(q) <= middle) {
    const double r = middle * middle - q * q;
    return q * polynomial(a, r) / polynomial(b, r);
  }
  const double r = square_root(-logarithm(q < 0 ? p : 1 - p));
  const double x = r <= widest_tail ? polynomial(c, r - 1.6) / polynomial(d, r - 1.6)
                                    : polynomial(e, r - widest_tail) / polynomial(f, r - widest_tail);
  return q < 0 ? -x : x;
}

}  // namespace impact_damper
