// What the fuzz targets share.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "impact_damper/base/errors.hpp"

namespace impact_damper::fuzz {

inline void require(bool holds) {
  if (!holds) std::abort();
}

// What `parse` makes of the bytes; absent if it rejects them, which it may with InputError only, in lines of
// their own that begin with the file's name.
template <typename Parse>
auto read(Parse parse, const std::uint8_t* data, std::size_t size)
    -> std::optional<decltype(parse(std::string()))> {
  try {
    return parse(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const InputError& error) {
    require(!error.problems().empty() && error.problems().size() <= 60);
    for (const std::string& problem : error.problems()) {
      require(problem.starts_with("f: ") && problem.find_first_of("\n\r\x1b") == std::string::npos);
    }
    return std::nullopt;
  }
}

}  // namespace impact_damper::fuzz
