// Where the project's own files are: catalogue, claims, scenes and manifest.
#pragma once

#include <optional>
#include <string>

namespace impact_damper::cli {

// The file or folder that has this name in the source folder ("data/claims.json"): the first that exists of
//   1. NAME in the current folder,
//   2. PREFIX/share/impact-damper/NAME, for a program installed as PREFIX/bin/impact-damper,
//   3. SOURCE/NAME, for a program built as SOURCE/build/src/impact-damper.
// NAME itself if none does, for an error message by whoever reads it. Links to the program are followed.
std::string project_file(const std::string& name);

// The same of a name that somebody gave, "data/..." or "figures/...". Absent if there is none, or if it is
// another name.
std::optional<std::string> find_named_file(const std::string& name);

}  // namespace impact_damper::cli
