// The origin of this program: all but `tree` is written into every run file, so that a result can be traced
// to its source.
#pragma once

#include <string_view>

namespace impact_damper {

struct Provenance {
  std::string_view version;   // of the project
  std::string_view commit;    // ends in "-dirty" if the source was changed since; "unknown" without git
  std::string_view tree;      // git's hash of the folder of the source; empty if it was changed or is unknown
  std::string_view compiler;  // name and version
  std::string_view build_type;  // CMake's
  std::string_view flags;       // of the compiler, besides the project's own
  std::string_view system;      // operating system and processor
};

const Provenance& provenance();

}  // namespace impact_damper
