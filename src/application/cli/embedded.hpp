// Files of figures/ and paper/page/ that are part of the program (embedded.cmake), so that it stands alone
// wherever it is installed or moved.
#pragma once

#include <string_view>
#include <vector>

namespace impact_damper::cli {

struct EmbeddedFile {
  std::string_view name;  // without its folder
  std::string_view text;
};
const std::vector<EmbeddedFile>& embedded_files();

}  // namespace impact_damper::cli
