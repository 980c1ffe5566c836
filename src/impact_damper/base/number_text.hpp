// Numbers as text: the one way in and the one way out, independent of any locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace impact_damper {

// The shortest decimal text that reads back as exactly `value`; a negative zero is "-0.0", which a
// JSON reader does not mistake for the integer 0. `value` may be nan or inf, which JSON does not allow.
std::string number_text(double value);
void append_number(std::string& text, double value);
void append_number(std::string& text, std::int64_t value);

// `value` to so many significant digits, for reading: "0.0788", "1.23e+06".
std::string rounded_text(double value, int digits);

// The finite number that the whole of `text` spells, rounded to nearest, which is zero for 1e-400 as for any
// reader of JSON: no spaces, no "nan" or "inf", no overflow, nothing behind it. Otherwise absent. A plus sign
// may stand before it, as some instruments write.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);

}  // namespace impact_damper
