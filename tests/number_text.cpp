#include "impact_damper/base/number_text.hpp"

#include <doctest/doctest.h>

#include <bit>
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
