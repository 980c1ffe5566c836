// The table of a sweep: made in shares, joined as CSV or HDF5, and, as CSV, read back.
//
// A share holds the rows of one part of a plan, in a file that grows while they are made. Lines:
//
//   #{"schema": "impact-damper/share/1", ...}    which plan, which part of it, which program: the head
//   run,mass_ratio,impacts,end,problem           the header of the table
//   0,0.005,2176,done,                           rows
//   ...
//   # 64 9f86d081...                             so many rows so far, SHA-256 of all bytes before this line
//
// A line of the last kind proves that everything before it is complete. An interrupted share continues from
// there; complete shares are joined into the table. A file beside the table describes it: TABLE.json, schema
// "impact-damper/sweep/1".
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "application/sweeps/plan.hpp"
#include "impact_damper/base/sha256.hpp"

namespace impact_damper {

// --- Shares -----------------------------------------------------------------------------------------------

struct ShareHead {
  Plan plan;
  std::int64_t part = 1, parts = 1;
  std::string program;  // version, commit, and whatever else distinguishes programs
};
// Returns FOLDER/NAME.part-K-of-N for a table FOLDER/NAME.
std::filesystem::path share_file(const std::filesystem::path& table, std::int64_t part, std::int64_t parts);

// Continues the share in `file`, or begins it. Whatever follows the last correct digest is deleted and made
// anew, also a whole file that ends within the head of this share. Throws IoError if it cannot be read or
// written or is being written by another process, InputError if it is of another plan, part or program, or no
// share; then it is left unchanged.
class ShareWriter {
 public:
  ShareWriter(const std::filesystem::path& file, const ShareHead& head);

  std::int64_t rows() const { return rows_; }  // in the file
  std::int64_t kept() const { return kept_; }  // before the last digest: these survive an interruption
  void append(std::string_view row);
  void finish();  // after the last row

 private:
  void write(std::string_view text);
  void seal();  // writes a digest

  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  std::filesystem::path file_;
  std::unique_ptr<std::FILE, Close> stream_;
  Sha256 hash_;
  std::int64_t rows_ = 0, kept_ = -1;
};

// Joins the shares of one plan, in any order, into the file `table`, and writes its description beside it:
// TABLE.json. CSV by RFC 4180, or HDF5 if is_hdf5(table). Throws InputError, leaving both unchanged, unless
// every part is there once, complete, and of one plan and program; InvalidArguments without `files`. The
// bytes do not depend on the number of parts; for HDF5, with one version of its library.
void join_shares(const std::vector<std::filesystem::path>& files, const std::filesystem::path& table);

// --- HDF5 -------------------------------------------------------------------------------------------------

inline constexpr std::array<std::string_view, 3> hdf5_endings{".h5", ".hdf5", ".hdf"};
bool is_hdf5(const std::filesystem::path& table);  // by the ending of its name, in capitals or not
bool has_hdf5();                                   // whether the program was built with the library

// Writes a table as an HDF5 file: one dataset for each column, named after it, with its unit and meaning as
// attributes. `run` holds 64-bit integers, `end` and `problem` text, all others doubles, NaN where a run has
// no such number. produce(add) is called once and adds whole rows as row_of writes them, each with its end of
// line, in order. Throws IoError if `file` cannot be written.
using AddRows = std::function<void(std::string_view rows)>;
void write_hdf5_table(const std::filesystem::path& file, const Plan& plan,
                      const std::function<void(const AddRows&)>& produce);

// --- The table, read back ---------------------------------------------------------------------------------

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
