// The largest size of each kind of file. A header of its own, so that readers of scenes and runs need no JSON
// library.
#pragma once

#include <cstddef>
#include <string_view>

namespace impact_damper {

// A kind of file, and its largest allowed size.
struct FileKind {
  std::string_view name;  // "scene"
  std::size_t most_bytes;
};

}  // namespace impact_damper
