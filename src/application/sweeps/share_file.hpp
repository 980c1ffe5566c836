// A share of a sweep: the rows of one part of its plan, in a file that grows while they are made. Lines:
//
//   #{"schema": "impact-damper/share/1", ...}    which plan, which part of it, which program: the head
//   run,mass_ratio,impacts,end,problem           the header of the table
//   0,0.005,2176,done,                           rows
//   ...
//   # 64 9f86d081...                             so many rows so far, SHA-256 of all bytes before this line
//
// A line of the last kind proves that everything before it is complete. An interrupted share continues from
// there; complete shares are joined into the table.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "application/sweeps/plan.hpp"
#include "impact_damper/base/sha256.hpp"

namespace impact_damper {

inline constexpr std::string_view share_schema = "impact-damper/share/1";

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

// Returns the text of the description, schema "impact-damper/sweep/1".
std::string description_of_table(const ShareHead& head, std::uint64_t bytes, const std::string& digest);

}  // namespace impact_damper
