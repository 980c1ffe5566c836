// Numbers as text: the only functions for reading and writing them, independent of any locale.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include "impact_damper/base/text.hpp"

namespace impact_damper {

// The shortest decimal text that reads back as exactly `value`; a negative zero is "-0.0", which a
// JSON reader does not mistake for the integer 0. `value` may be nan or inf, which JSON does not allow.
std::string number_text(double value);
void append_number(std::string& text, double value);
void append_number(std::string& text, std::int64_t value);

// Returns `value` with that many significant digits, for people: "0.0788", "1.23e+06".
std::string rounded_text(double value, int digits);
// Returns the number that this text spells.
double rounded_to(double value, int digits);

// Returns the finite number that the whole of `text` spells, rounded to nearest; 1e-400 is zero, as for any
// reader of JSON. Absent for anything else: spaces, "nan" or "inf", overflow, text after the number. A plus
// sign may precede it, as some instruments write.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);
// Reads the numbers between these characters, each by read(std::string_view); absent unless it reads all.
template <class Read>
std::optional<std::vector<double>> numbers_of(std::string_view text, char between, Read&& read) {
  std::vector<double> numbers;
  for (const std::string_view part : parts_of(text, between)) {
    const std::optional<double> number = read(part);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

// A text with a place {} for each of these values.
template <class... Values>
struct Pattern {
  std::string_view text;
  consteval Pattern(const char* literal) : text(literal) {
    std::size_t places = 0;
    for (std::size_t at = 0; (at = text.find("{}", at)) != std::string_view::npos; at += 2) ++places;
    if (places != sizeof...(Values)) throw std::invalid_argument("a place for each value");
  }
};
std::string with_values(std::string_view pattern, const std::vector<std::string>& values);
template <class Value>
std::string value_text(const Value& value) {
  if constexpr (std::is_floating_point_v<Value>)
    return number_text(value);
  else if constexpr (std::is_integral_v<Value>)
    return std::to_string(value);
  else
    return std::string(value);
}
// Returns the pattern, a literal, with the values in its places: texts, and numbers by number_text().
template <class... Values>
std::string filled(Pattern<std::type_identity_t<Values>...> pattern, const Values&... values) {
  return with_values(pattern.text, {value_text(values)...});
}

// Numbers as text and back by printf and strtod, with the text of std::to_chars, for standard libraries whose
// <charconv> supports integers only (LLVM's up to version 13, with which WebAssembly is compiled on Debian
// 12). Correct only in the locale "C", the only one there.
namespace by_c_library {

// Returns the text of std::to_chars(value): the shortest that reads back as `value`.
std::string shortest_text(double value);

// Returns the text of std::to_chars(value, std::chars_format::general, digits).
std::string rounded_text(double value, int digits);

// Reads the whole of `text` as std::from_chars does, except that a number too small for a double is read as
// zero. Returns an error, and leaves `value` as it was, if the text is no number, or one too large, or if
// something follows it.
std::errc read(std::string_view text, double& value);

}  // namespace by_c_library

}  // namespace impact_damper
