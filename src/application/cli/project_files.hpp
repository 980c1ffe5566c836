// Where the project's own files are: catalogue, claims, scenes and manifest.
#pragma once

#include <optional>
#include <string>

namespace impact_damper::cli {

// Returns the file or folder of this name in the source folder ("data/claims.json"): the first that exists of
//   1. NAME in the current folder,
//   2. PREFIX/share/impact-damper/NAME, for a program installed as PREFIX/bin/impact-damper,
//   3. SOURCE/NAME, for a program built as SOURCE/build/src/impact-damper.
// NAME itself if none does, for the error message of its reader. Links to the program are followed.
std::string project_file(const std::string& name);

// Returns the place of a name that a user gave, "data/..." or "figures/...". Absent if there is none, or for
// any other name.
std::optional<std::string> find_named_file(const std::string& name);

}  // namespace impact_damper::cli
