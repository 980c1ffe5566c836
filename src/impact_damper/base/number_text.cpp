#include "impact_damper/base/number_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace impact_damper {
namespace {

template <typename Number>
std::errc read(std::string_view text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error != std::errc::invalid_argument && stop != end ? std::errc::invalid_argument : error;
}

// Removes a plus sign before the number, which charconv does not accept.
std::string_view without_plus(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  return text;
}

#ifdef __cpp_lib_to_chars  // <charconv> knows double
// Whether a decimal number that is out of the range of double is too small, by the power of ten of its first
// digit that is not zero.
bool is_too_small(std::string_view text) {
  const std::size_t end = std::min(text.find_first_of("eE"), text.size());
  const auto point = static_cast<std::int64_t>(std::min(text.find('.'), end)),
             first = static_cast<std::int64_t>(text.find_first_of("123456789"));
  std::int64_t exponent = 0;
  if (end < text.size()) {
    text = without_plus(text.substr(end + 1));
    constexpr std::int64_t beyond_any_length = std::numeric_limits<std::int64_t>::max() / 2;
    if (read(text, exponent) != std::errc{})
      exponent = text.starts_with('-') ? -beyond_any_length : beyond_any_length;
  }
  return point - first + exponent < 0;
}

std::errc read(std::string_view text, double& value) {
  const std::errc error = read<double>(text, value);
  if (error != std::errc::result_out_of_range || !is_too_small(text)) return error;
  value = text.starts_with('-') ? -0.0 : 0.0;
  return {};
}
template <typename... Form>
std::string written(double value, Form... form) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value, form...).ptr};
}
#else
std::errc read(std::string_view text, double& value) { return by_c_library::read(text, value); }
std::string written(double value) { return by_c_library::shortest_text(value); }
std::string written(double value, std::chars_format, int digits) {
  return by_c_library::rounded_text(value, digits);
}
#endif

template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
  Number value{};
  if (read(without_plus(text), value) != std::errc{}) return std::nullopt;
  return value;
}

}  // namespace

void append_number(std::string& text, double value) {
  text += value == 0 && std::signbit(value) ? "-0.0" : written(value);
}

void append_number(std::string& text, std::int64_t value) {
  char digits[24];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, end);
}

std::string number_text(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

std::string rounded_text(double value, int digits) {
  return written(value, std::chars_format::general, digits);
}

double rounded_to(double value, int digits) {
  return parse_number(rounded_text(value, digits)).value_or(value);
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<double> value = parse_whole<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view text) { return parse_whole<std::int64_t>(text); }

std::string with_values(std::string_view pattern, const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) {
    const std::size_t place = pattern.find("{}");
    text.append(pattern.substr(0, place)).append(value);
    pattern.remove_prefix(place + 2);
  }
  return text.append(pattern);
}

}  // namespace impact_damper
