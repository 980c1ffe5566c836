// The files of a command: those of the project, where catalogue, claims, scenes and manifest are, and those
// of figures/ and paper/page/ that are part of the program (embedded.cmake), so that it stands alone wherever
// it is installed or moved; and where it writes a result, to the file that an option names, or to standard
// output, which "-" names; and how it writes tables and numbers for people.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/io/file_output.hpp"

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

// The format of a result.
enum class Format { json, csv, gnuplot, html, svg, markdown, hdf5 };
// Returns which of `offered` --format names, for `output`; the first of them if it is not given.
Format format_of(Arguments& arguments, const std::optional<std::string>& output,
                 std::initializer_list<Format> offered);

// Rejects a file whose name ends as those of other formats than `written` do. A name without an ending is
// allowed; ".05" of "run-0.05" is none, nor is what mktemp makes.
void reject_other_endings(Arguments& arguments, const std::string& option,
                          const std::optional<std::string>& output, std::initializer_list<Format> written);

// Returns the file that an option names for a result in one of these formats. Rejects another ending, and one
// of `inputs`, which would be overwritten.
std::optional<std::string> output_of(Arguments& arguments, const std::string& option,
                                     std::initializer_list<Format> written,
                                     const std::vector<std::filesystem::path>& inputs);

// Rejects the same file for the results of two options.
void reject_same_output(Arguments& arguments, const std::string& option,
                        const std::optional<std::string>& file, const std::string& other_option,
                        const std::optional<std::string>& other);

bool is_standard_output(const std::optional<std::string>& output);

// For use before a long computation: throws IoError if a file cannot be written. If the program is
// interrupted, it then reports that the file is as it was.
void prepare_output(const std::optional<std::string>& output);
// Writes `text`, to standard output if there is no file.
void write_output(const std::optional<std::string>& output, std::string_view text);

// Returns rows of words as lines with aligned columns; the last column is not padded. `rows` is not empty,
// and all rows are of equal length. Widths count characters of UTF-8.
using Rows = std::vector<std::vector<std::string>>;
std::string aligned(const Rows& rows);

// Returns rows as a table of Markdown, below the first as its heading.
std::string markdown_table(const Rows& rows);

// Returns a number in three digits for reading: "0.0532", "1980".
std::string readable(double value);
double in_three_digits(double value);

}  // namespace impact_damper::cli
