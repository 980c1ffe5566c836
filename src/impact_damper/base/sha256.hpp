// SHA-256 (FIPS 180-4).
#pragma once

#include <string>
#include <string_view>

namespace impact_damper {

// The digest of the bytes of `text`: 64 hexadecimal digits in lower case.
std::string sha256(std::string_view text);

}  // namespace impact_damper
