// Where a command writes a result: to the file that an option names, or to standard output, which "-" names.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "arguments.hpp"
#include "impact_damper/base/enumeration.hpp"

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

}  // namespace impact_damper::cli
