// Numbers as text and back by printf and strtod, with the very text of std::to_chars: for standard libraries
// whose <charconv> knows integers only (LLVM's up to version 13, which WebAssembly is compiled with). Right
// only in the locale "C", the only one there.
#pragma once

#include <string>
#include <string_view>
#include <system_error>

namespace impact_damper::by_c_library {

// What std::to_chars(value) writes: the shortest text that reads back as `value`.
std::string shortest_text(double value);

// What std::to_chars(value, std::chars_format::general, digits) writes.
std::string rounded_text(double value, int digits);

// What std::from_chars does with the whole of `text`, except that a number too small for a double is read as
// zero: not {} if it is no number, or one too large, or if something follows it. Then `value` is left as it
// was.
std::errc read(std::string_view text, double& value);

}  // namespace impact_damper::by_c_library
