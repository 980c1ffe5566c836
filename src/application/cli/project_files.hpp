// The project's own files: where catalogue, claims, scenes and manifest are, and those of figures/ and
// paper/page/ that are part of the program (embedded.cmake), so that it stands alone wherever it is installed
// or moved.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

// Adds a run file, and those of the other members of its ensemble that there may be.
void add_ensemble(std::vector<std::filesystem::path>& files, const std::filesystem::path& run);

struct EmbeddedFile {
  std::string_view name;  // without its folder
  std::string_view text;
};
const std::vector<EmbeddedFile>& embedded_files();
std::string_view embedded_text(std::string_view name);  // of one of them

}  // namespace impact_damper::cli
