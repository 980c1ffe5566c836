#include "impact_damper/base/number_text.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "impact_damper/base/number_by_c_library.hpp"

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

// Powers of two, where doubles are twice as dense below as above; powers of ten; subnormal numbers; any
// others.
std::vector<double> awkward_numbers() {
  std::vector<double> numbers{0.0, -0.0, std::numeric_limits<double>::infinity()};
  for (int exponent = -1074; exponent < 1024; ++exponent) {
    const double power = std::ldexp(1.0, exponent);
    numbers.insert(numbers.end(), {power, std::nextafter(power, 0.0), std::nextafter(power, HUGE_VAL)});
  }
  for (int exponent = -323; exponent <= 308; ++exponent)
    for (const char* digits :
         {"1", "-1", "3", "1.5", "1.23456789012345", "9.999999999999999", "9007199254740993"})
      if (const auto value = parse_number(digits + ("e" + std::to_string(exponent))))
        numbers.push_back(*value);
  std::mt19937_64 bits(2);
  for (int i = 0; i < 200'000; ++i) numbers.push_back(std::bit_cast<double>(bits()));
  std::uniform_real_distribution<double> ordinary(-1000, 1000);
  for (int i = 0; i < 200'000; ++i) numbers.push_back(ordinary(bits));
  for (int i = 0; i < 20'000; ++i)
    numbers.push_back(std::bit_cast<double>(bits() >> 12 >> (bits() % 52)));  // subnormal
  return numbers;
}

TEST_CASE("by the C library numbers have the text of to_chars, and are read as by from_chars") {
  for (const double value : awkward_numbers()) {
    if (std::isnan(value)) continue;
    char text[400];
    const std::string shortest(text, std::to_chars(text, text + sizeof text, value).ptr);
    CHECK(by_c_library::shortest_text(value) == shortest);
    for (const int digits : {1, 6, 17}) {
      const std::string rounded(
          text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits).ptr);
      CHECK(by_c_library::rounded_text(value, digits) == rounded);
    }
    if (!std::isfinite(value)) continue;
    double back = 7;
    REQUIRE(by_c_library::read(shortest, back) == std::errc{});
    CHECK(std::bit_cast<std::uint64_t>(back) == std::bit_cast<std::uint64_t>(value));
  }
}

TEST_CASE("strtod takes no text that from_chars does not take") {
  for (const std::string text :
       {"1e-400",  "4e-324", "2e-324", "1e400", "-1e400", "0e999999", ".5",    "5.",   "5.e3",
        "1e",      "1e+",    "-",      "-.",    ".",      "",         "0x10",  "1e5x", "1e-5000000000000",
        "00012",   "-0",     "1E5",    "+1",    " 1",     "1 ",       "1.5.5", "--1",  "1e5.5",
        "0.0e-400"}) {
    CAPTURE(text);
    double expected = 7, value = 7;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), expected);
    const bool whole = error == std::errc{} && stop == text.data() + text.size();
    CHECK((by_c_library::read(text, value) == std::errc{}) == whole);
    if (whole) CHECK(value == expected);
    if (!whole) CHECK(value == 7);
  }
}
