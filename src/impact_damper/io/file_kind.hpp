// How long a file of some kind may be. A header of its own, so that who reads scenes and runs needs no JSON
// library.
#pragma once

#include <cstddef>
#include <string_view>

namespace impact_damper {

// A kind of file, and how long the longest allowed is.
struct FileKind {
  std::string_view name;  // "scene"
  std::size_t most_bytes;
};

}  // namespace impact_damper
