// Numbers as text and back by printf and strtod, with the same text as std::to_chars, for standard libraries
// whose <charconv> supports integers only (LLVM's up to version 13, with which WebAssembly is compiled).
// Correct only in the locale "C", the only one there.
#pragma once

#include <string>
#include <string_view>
#include <system_error>

namespace impact_damper::by_c_library {

// Returns the text of std::to_chars(value): the shortest that reads back as `value`.
std::string shortest_text(double value);

// Returns the text of std::to_chars(value, std::chars_format::general, digits).
std::string rounded_text(double value, int digits);

// Reads the whole of `text` as std::from_chars does, except that a number too small for a double is read as
// zero. Returns an error, and leaves `value` as it was, if the text is no number, or one too large, or if
// something follows it.
std::errc read(std::string_view text, double& value);

}  // namespace impact_damper::by_c_library
