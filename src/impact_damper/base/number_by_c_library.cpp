#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper::by_c_library {
namespace {

template <class... Arguments>
std::string printed(const char* format, Arguments... arguments) {
  std::array<char, 400> text;  // the largest number has 309 digits
  return {text.data(), std::size_t(std::snprintf(text.data(), text.size(), format, arguments...))};
}

// 0.d1d2d3... * 10^point, without zeros at the end.
struct Decimal {
  std::string digits;
  int point;
};

Decimal decimal_of(double magnitude, int digits) {
  std::string text = printed("%.*e", digits - 1, magnitude);  // d.ddde+xx
  const std::size_t letter = text.find('e');
  const int point = 1 + int(std::strtol(text.c_str() + letter + 1, nullptr, 10));
  text.resize(letter);
  std::erase(text, '.');
  text.resize(text.find_last_not_of('0') + 1);
  return {text, point};
}

double value_of(const Decimal& decimal) {
  return std::strtod(printed("0.%se%d", decimal.digits.c_str(), decimal.point).c_str(), nullptr);
}

// Returns the neighbour with as many digits, one unit of the last digit below.
Decimal just_below(Decimal decimal) {
  std::size_t i = decimal.digits.size();
  while (i > 0 && decimal.digits[i - 1] == '0') decimal.digits[--i] = '9';
  if (i > 0) --decimal.digits[i - 1];
  return decimal;
}

Decimal just_above(Decimal decimal) {
  std::size_t i = decimal.digits.size();
  while (i > 0 && decimal.digits[i - 1] == '9') decimal.digits[--i] = '0';
  if (i > 0) {
    ++decimal.digits[i - 1];
  } else {
    decimal.digits.insert(0, 1, '1');
    ++decimal.point;
  }
  return decimal;
}

constexpr int most_digits = 17;  // enough for every double
struct Rounded {
  Decimal decimal;
  bool is_far;  // reads back as another double
};
// Returns the number with 15 or 16 digits, rounded from the 17 of `full`. printf and strtod, which are slow
// where long double has 128 bits in software, are seldom needed for this.
Rounded rounded(const Decimal& full, double magnitude, int digits) {
  std::string padded = full.digits;
  padded.resize(most_digits, '0');
  const std::size_t count = std::size_t(digits);
  const long rest = std::strtol(padded.c_str() + count, nullptr, 10),
             unit = digits == most_digits - 1 ? 10 : 100;
  // At half a unit the digits after the seventeenth decide.
  if (2 * rest == unit) return {decimal_of(magnitude, digits), false};
  Decimal decimal{padded.substr(0, count), full.point};
  if (2 * rest > unit) decimal = just_above(decimal);
  decimal.digits.resize(decimal.digits.find_last_not_of('0') + 1);
  // A decimal number that reads back as a double is no farther from it than 2^-53 of it, at most 11.2 units
  // of the seventeenth digit, and that digit is rounded by half a unit.
  return {decimal, std::min(rest, unit - rest) > 12};
}

// Returns, of the decimal numbers with the fewest digits that read back as `magnitude`, the nearest.
Decimal shortest(double magnitude) {
  // A number of up to 15 digits comes back from a normal double unchanged, so a shorter one is found with
  // zeros at the end. A subnormal number has fewer digits.
  const bool is_subnormal = magnitude < 0x1p-1022;
  int exponent = 0;
  const bool is_power_of_two = std::frexp(magnitude, &exponent) == 0.5;
  Decimal all = decimal_of(magnitude, most_digits);
  for (int digits = is_subnormal ? 1 : 15; digits < most_digits; ++digits) {
    const Rounded candidate =
        is_subnormal ? Rounded{decimal_of(magnitude, digits), false} : rounded(all, magnitude, digits);
    const Decimal& nearest = candidate.decimal;
    if (!candidate.is_far && value_of(nearest) == magnitude) return nearest;
    // Below a power of two doubles are twice as dense as above: the nearest decimal may read back as another
    // double where its neighbour, somewhat farther away, does not.
    if (!is_power_of_two) continue;
    Decimal full = nearest;
    full.digits.resize(std::size_t(digits), '0');
    for (const Decimal& neighbour : {just_below(full), just_above(full)})
      if (value_of(neighbour) == magnitude) return neighbour;
  }
  return all;
}

}  // namespace

std::string shortest_text(double value) {
  if (!std::isfinite(value) || value == 0) return printed("%.0f", value);
  const std::string sign = value < 0 ? "-" : "";
  const auto [digits, point] = shortest(std::abs(value));
  const std::size_t count = digits.size();
  const int exponent = point - 1;
  const std::string scientific = digits.substr(0, 1) + (count == 1 ? "" : "." + digits.substr(1)) +
                                 printed("e%c%02d", exponent < 0 ? '-' : '+', std::abs(exponent));
  const std::string fixed = point <= 0 ? "0." + std::string(std::size_t(-point), '0') + digits
                            : std::size_t(point) >= count ? printed("%.0f", std::abs(value))
                                                          : digits.substr(0, std::size_t(point)) + "." +
                                                                digits.substr(std::size_t(point));
  return sign + (scientific.size() < fixed.size() ? scientific : fixed);
}

std::string rounded_text(double value, int digits) { return printed("%.*g", digits, value); }

std::errc read(std::string_view text, double& value) {
  // strtod accepts more than decimal numbers: blanks, a plus sign, hexadecimal digits, "nan".
  if (text.empty() || text.starts_with('+') ||
      text.find_first_not_of("0123456789.eE+-") != std::string_view::npos)
    return std::errc::invalid_argument;
  const std::string ended(text);
  char* end = nullptr;
  const double read = std::strtod(ended.c_str(), &end);
  if (end != ended.c_str() + ended.size()) return std::errc::invalid_argument;
  if (std::isinf(read)) return std::errc::result_out_of_range;
  value = read;
  return {};
}

}  // namespace impact_damper::by_c_library
