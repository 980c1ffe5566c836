// Records as instruments write them: text of any layout, universal files (UFF 58) and sound files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/text.hpp"

namespace impact_damper {

enum class MeasuredQuantity { displacement, velocity, acceleration };
std::string_view unit_of(MeasuredQuantity quantity);  // "mm", "mm/s", "mm/s^2"

// A measured free decay.
struct MeasuredRecord {
  MeasuredQuantity quantity = MeasuredQuantity::displacement;
  std::vector<double> time;      // s, strictly ascending
  std::vector<double> value;     // mm, mm/s or mm/s^2
  std::int64_t empty_cells = 0;  // samples without a value, which are left out of the columns
  std::string read_as;           // which column was taken as what, and what was skipped: one line
};

// What a file does not say itself.
struct RecordOptions {
  // A column by its head or its number from 1, and its unit, both or one: "ch2", "3", "3:mm/s".
  std::optional<std::string> column, time;
  std::optional<double> rate;              // Hz, in place of a column of times
  std::optional<std::string> sensitivity;  // of a record in volts, counts or full scale (FS): "100 mV/g"
  std::optional<double> from, to;          // s, of the record's own time: only these samples
};

inline constexpr FileKind measured_kind{"measured record", std::size_t{1} << 26};
inline constexpr std::size_t least_samples = 64;

// Reads a record. A text is rows of numbers, of which one column is time and one is chosen:
//
//   # logger 7, calibrated            t_s,x_mm
//   time (s); ch1 (V); ch2 (g)        0.000,59.82
//   0,000; 0,12; -1,25                0.005,59.61
//
// Between cells stand tabs, semicolons, commas or blanks; numbers have a point or a comma; lines end with LF,
// CR or both; the text is UTF-8, UTF-16 or Latin 1. Heads, which may have a row of units below them, are the
// last lines before the numbers. A time is a number or a clock stamp. An empty cell, NaN or OVLD is a value
// that is missing. Of a universal file each data set 58 of a time response is a column, of a sound file each
// channel, in units of full scale (FS), where the program was built with libsndfile.
//
// Throws IoError if `file` cannot be read, InputError, with a line for each of the first problems, if it is
// not as above, if file and options leave open which columns are meant or what their units are, or if it has
// fewer than `least_samples` values. These lines begin with the name of the file, or `name`.
MeasuredRecord read_measured_record(const std::filesystem::path& file, const RecordOptions& options = {});
MeasuredRecord parse_measured_record(const std::string& name, std::string_view bytes,
                                     const RecordOptions& options = {});

// Throws InputError, naming `name`, if a record has fewer than `least_samples` values.
void require_samples(const std::string& name, const MeasuredRecord& record);

}  // namespace impact_damper
