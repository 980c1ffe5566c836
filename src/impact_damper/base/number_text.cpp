#include "impact_damper/base/number_text.hpp"

#include <charconv>
#include <cmath>
#include <system_error>

#include "impact_damper/base/number_by_c_library.hpp"

namespace impact_damper {
namespace {

template <typename Number>
std::errc read(std::string_view text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop != end ? std::errc::invalid_argument : error;
}

#ifdef __cpp_lib_to_chars  // <charconv> knows double
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
  if (read(text, value) != std::errc{}) return std::nullopt;
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

std::optional<double> parse_number(std::string_view text) {
  const std::optional<double> value = parse_whole<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view text) { return parse_whole<std::int64_t>(text); }

}  // namespace impact_damper
