#include "application/sweeps/sampling.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <vector>

using namespace impact_damper;

TEST_CASE("the generator gives the known answers of its authors") {
  using Block = std::array<std::uint32_t, 4>;
  constexpr std::uint32_t ones = 0xffffffff;
  // kat_vectors of Random123, philox4x32 10.
  CHECK(philox({0, 0, 0, 0}, {0, 0}) == Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  CHECK(philox({ones, ones, ones, ones}, {ones, ones}) ==
        Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
        Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("a draw is made of the first 52 bits of the block of its seed, index and variable") {
  // 0xe169c58d6627e8d5 of the first known answer.
  CHECK(uniform_draw({0, 0, 0}) == (double(0xe169c58d6627e8d5U >> 12) + 0.5) * 0x1p-52);
  // Each of the three, each half of the long ones, changes it.
  const std::set<double> all{uniform_draw({0, 0, 0}),          uniform_draw({1, 0, 0}),
                             uniform_draw({1ULL << 32, 0, 0}), uniform_draw({0, 1, 0}),
                             uniform_draw({0, 0, 1}),          uniform_draw({0, 0, 1LL << 32})};
  CHECK(all.size() == 6);
}

TEST_CASE("draws are uniform, and those of two numbers independent") {
  constexpr int count = 100'000;
  double mean = 0, square = 0, product = 0;
  for (int i = 0; i < count; ++i) {
    const double u = uniform_draw({3, 0, i}), v = uniform_draw({3, 1, i});
    REQUIRE(u > 0);
    REQUIRE(u < 1);
    mean += u / count;
    square += u * u / count;
    product += (u - 0.5) * (v - 0.5) / count;
  }
  // Five standard errors: those of u, u^2 and of the product are 0.2887, 0.2981 and 1/12, divided by the root
  // of the count.
  const double root = std::sqrt(double(count));
  CHECK(std::abs(mean - 0.5) < 5 * 0.2887 / root);
  CHECK(std::abs(square - 1.0 / 3) < 5 * 0.2981 / root);
  CHECK(std::abs(product) < 5.0 / 12 / root);
}

TEST_CASE("a permutation takes every index once, whatever their number") {
  for (const std::int64_t count : {1, 2, 3, 4, 5, 8, 17, 64, 65, 1000}) {
    std::set<std::int64_t> taken;
    for (std::int64_t i = 0; i < count; ++i) taken.insert(permuted({5, 2, i}, count));
    CHECK(std::int64_t(taken.size()) == count);
    CHECK(*taken.begin() == 0);
    CHECK(*taken.rbegin() == count - 1);
  }
  CHECK(permuted({5, 2, 999'999'999'999}, 1'000'000'000'000) < 1'000'000'000'000);
}

TEST_CASE("permutations are random: each place is as likely as another, and another seed gives another") {
  constexpr std::int64_t count = 6, seeds = 6000;
  std::vector<int> times(count * count, 0);
  for (std::int64_t seed = 0; seed < seeds; ++seed)
    for (std::int64_t i = 0; i < count; ++i)
      ++times[std::size_t(i * count + permuted({std::uint64_t(seed), 0, i}, count))];
  // Binomial with p = 1/6: five standard deviations of 28.9 about 1000.
  for (const int each : times) CHECK(std::abs(each - 1000) < 145);
}

TEST_CASE("stratified draws have one number in each interval") {
  for (const std::int64_t count : {1, 7, 1000}) {
    std::set<std::int64_t> intervals;
    for (std::int64_t i = 0; i < count; ++i) {
      const double u = stratified_draw({11, 0, i}, count);
      REQUIRE(u > 0);
      REQUIRE(u < 1);
      intervals.insert(std::int64_t(u * double(count)));
    }
    CHECK(std::int64_t(intervals.size()) == count);
  }
}

TEST_CASE("the quantiles of the normal distribution are those that were published with the algorithm") {
  // Wichura, 1988: to about one part in 1e16.
  CHECK(std::abs(normal_quantile(0.25) / -0.6744897501960817 - 1) < 4e-16);
  CHECK(std::abs(normal_quantile(0.001) / -3.090232306167814 - 1) < 4e-16);
  CHECK(std::abs(normal_quantile(1e-20) / -9.262340089798408 - 1) < 4e-16);
  CHECK(normal_quantile(0.5) == 0);
  CHECK(normal_quantile(0.75) == -normal_quantile(0.25));
}

TEST_CASE("the quantile is the inverse of the error function's distribution") {
  for (const double p : {1e-300, 1e-100, 1e-12, 1e-9, 1e-5, 0.01, 0.07, 0.0749999, 0.075, 0.2, 0.4999}) {
    const double back = std::erfc(-normal_quantile(p) / std::sqrt(2.0)) / 2;
    // The tail's relative slope is the quantile itself: rounding of it counts x^2 times.
    const double x = normal_quantile(p);
    CHECK(std::abs(back / p - 1) < 1e-15 * (2 + x * x));
    if (p > 1e-9) CHECK(std::abs(normal_quantile(1 - p) + x) < 1e-6);
  }
}
