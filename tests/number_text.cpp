#include "impact_damper/base/number_text.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

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
  for (const char* text : {"nan", "inf", "-inf", "1e999", "", " 1", "1 ", "1x", "0x10", "1,5", "--1", "+",
                           "++1", "+-1", "-+1", "+inf", "1e400x", "1e-400x"}) {
    CAPTURE(text);
    CHECK(!parse_number(text));
  }
  CHECK(parse_number("-1e-3") == -1e-3);
  CHECK(parse_number("+1") == 1);
  CHECK(parse_number("+.5e+1") == 5);
  CHECK(parse_integer("+7") == 7);
  for (const char* text :
       {"18446744073709551616", "9223372036854775808", "1.0", "1e3", "", "+", "+-7", "++7"}) {
    CAPTURE(text);
    CHECK(!parse_integer(text));
  }
  CHECK(parse_integer("9223372036854775807") == std::numeric_limits<std::int64_t>::max());
}

TEST_CASE("a number too small for a double is zero with its sign, one too large is none") {
  const std::string zeros(400, '0');
  for (const std::string& text :
       {std::string("1e-400"), std::string("2e-324"), "0." + zeros + "1", "1" + zeros + "e-900",
        std::string("12.5E-99999999999999999999"), ".00" + zeros + "9e+10"}) {
    CAPTURE(text);
    for (const auto& [sign, is_negative] :
         {std::pair("", false), std::pair("+", false), std::pair("-", true)}) {
      const auto value = parse_number(sign + text);
      REQUIRE(value);
      CHECK(*value == 0);
      CHECK(std::signbit(*value) == is_negative);
    }
  }
  CHECK(parse_number("3e-324") == std::numeric_limits<double>::denorm_min());
  for (const std::string& text : {std::string("1e400"), "1" + zeros, "0." + zeros + "1e+900",
                                  std::string("0.001E99999999999999999999"), std::string("-2e308")}) {
    CAPTURE(text);
    CHECK(!parse_number(text));
  }
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

TEST_CASE("a rounded number is the one that its text spells") {
  CHECK(rounded_to(0.078849, 3) == 0.0788);
  CHECK(rounded_to(-1234567, 3) == -1.23e6);
  CHECK(rounded_to(0.6, 17) == 0.6);
  CHECK(std::isinf(rounded_to(std::numeric_limits<double>::infinity(), 3)));
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

TEST_CASE("strtod takes no text that from_chars does not take, except what is too small") {
  for (const std::string text :
       {"1e-400",  "4e-324", "2e-324", "1e400", "-1e400", "0e999999", ".5",    "5.",   "5.e3",
        "1e",      "1e+",    "-",      "-.",    ".",      "",         "0x10",  "1e5x", "1e-5000000000000",
        "00012",   "-0",     "1E5",    "+1",    " 1",     "1 ",       "1.5.5", "--1",  "1e5.5",
        "0.0e-400"}) {
    CAPTURE(text);
    double expected = 7, value = 7;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), expected);
    const bool is_zero = text == "1e-400" || text == "2e-324" || text == "1e-5000000000000";
    const bool whole = is_zero || (error == std::errc{} && stop == text.data() + text.size());
    if (is_zero) expected = 0;
    CHECK((by_c_library::read(text, value) == std::errc{}) == whole);
    if (whole) CHECK(value == expected);
    if (!whole) CHECK(value == 7);
  }
}
