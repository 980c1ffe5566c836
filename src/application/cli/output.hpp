// Where a command writes a result: to the file that an option names, or to standard output, which "-" names;
// and how it writes tables and numbers for people.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/io/file_output.hpp"

namespace impact_damper::cli {

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
