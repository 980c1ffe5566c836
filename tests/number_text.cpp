#include "impact_damper/base/number_text.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>

using namespace impact_damper;

TEST_CASE("a number reads back with the bits it was written with") {
  std::mt19937_64 bits(1);
  for (int i = 0; i < 100'000; ++i) {
    const double value = std::bit_cast<double>(bits());
    if (!std::isfinite(value)) continue;
    const auto back = parse_number(number_text(value));
    REQUIRE(back);
    CHECK(std::bit_cast<std::uint64_t>(*back) == std::bit_cast<std::uint64_t>(value));
  }
  CHECK(number_text(0.1) == "0.1");
  CHECK(number_text(1e4) == "10000");
  CHECK(number_text(-0.0) == "-0.0");
}

TEST_CASE("the text is the standard library's shortest one") {
  const auto same = [](double value) {
    char digits[400];
    return number_text(value) ==
           std::string(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  };
  std::mt19937_64 random(1);
  const auto check = [&](double value) {
    if (value == 0) return;
    CAPTURE(value);
    for (const double sign : {1.0, -1.0}) {
      for (const double next : {0.0, value, 1e300}) REQUIRE(same(sign * std::nextafter(value, next)));
    }
  };
  // Every exponent whose numbers are written here, and some of those left to the library; few or all bits.
  for (int exponent = -15; exponent <= 55; ++exponent) {
    check(std::ldexp(1.0, exponent));
    for (int i = 0; i < 1000; ++i)
      check(std::ldexp(1 + std::ldexp(double(random() >> 12 >> random() % 52), -52), exponent));
  }
  // Short decimals, and halves of their last digit.
  for (int i = 0; i < 100'000; ++i) check(double(random() % 1'000'000) / std::pow(10, double(random() % 12)));
  for (int i = 0; i < 100'000; ++i) check(double(random() >> 11 >> random() % 40) / 16);
}

TEST_CASE("only the whole of a finite number is allowed") {
  for (const char* text : {"nan", "inf", "-inf", "1e999", "", " 1", "1 ", "1x", "+1", "0x10", "1,5", "--1"}) {
    CAPTURE(text);
    CHECK(!parse_number(text));
  }
  CHECK(parse_number("-1e-3") == -1e-3);
  for (const char* text : {"18446744073709551616", "9223372036854775808", "1.0", "1e3", ""}) {
    CAPTURE(text);
    CHECK(!parse_integer(text));
  }
  CHECK(parse_integer("9223372036854775807") == std::numeric_limits<std::int64_t>::max());
}
