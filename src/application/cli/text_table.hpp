// Rows of words as lines with aligned columns; the last column is not padded.
#pragma once

#include <string>
#include <vector>

namespace impact_damper::cli {

// `rows` is not empty and all rows are of equal length; widths count bytes.
std::string aligned(const std::vector<std::vector<std::string>>& rows);

}  // namespace impact_damper::cli
