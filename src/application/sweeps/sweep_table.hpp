// The table of a sweep, read back: its rows as CSV, and the file beside it that says what they are
// (share_file.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "application/sweeps/plan.hpp"
#include "impact_damper/base/text.hpp"

namespace impact_damper {

inline constexpr FileKind sweep_kind{"sweep", 1 << 24};

// Content of the file beside a table.
struct SweepDescription {
  Plan plan;
  std::int64_t rows = 0, bytes = 0;
  std::string digest;  // SHA-256 of the table
};
// Reads TABLE.json. Throws IoError if it cannot be read, InputError unless it is as sweep or merge wrote it,
// for a table as CSV.
SweepDescription read_sweep_description(const std::filesystem::path& table);

// Calls visit(cells) with the cells of each row, in their order. Before that throws IoError if the table
// cannot be read, InputError unless it is the one described: same length and SHA-256. Memory does not grow
// with the number of rows.
void read_sweep_rows(const std::filesystem::path& table, const SweepDescription& description,
                     const std::function<void(std::span<const std::string> cells)>& visit);

// A table as a whole.
struct SweepTable {
  std::filesystem::path file;  // where it was read from, for messages
  Plan plan;
  std::vector<std::vector<std::string>> rows;
};
// Reads a table as a whole. Throws like the two above, and InputError unless it is of that plan.
SweepTable read_sweep_table(const std::filesystem::path& table, const Plan& plan);

}  // namespace impact_damper
