// The columns of a measured record, whatever the file is that they stand in.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace impact_damper {

// What a unit measures. Volts, counts and full scale become one of the others by a sensitivity.
enum class RecordQuantity { time, displacement, velocity, acceleration, volts, counts, full_scale };
struct RecordUnit {
  std::string_view name;  // as it is printed
  RecordQuantity measure;
  double factor;  // to s, mm, mm/s, mm/s^2, V, counts or full scale
};
// Returns the unit that a text spells: "m/s²", "M/S^2", "m_per_s2" and "ms-2" are one. Null if it is none.
const RecordUnit* find_unit(std::string_view text);

struct RecordColumn {
  std::string name;                  // its head; "" without one
  const RecordUnit* unit = nullptr;  // null if the file does not say it
  std::vector<double> values;        // NaN where one is missing
  bool has_stamps = false;           // they were clock stamps, and are seconds
};

struct RecordColumns {
  std::vector<std::optional<RecordColumn>> all;  // absent: a column of words, or an empty one
  std::vector<std::size_t> lines;                // of the rows in a text, from 1
  std::optional<double> rate;                    // Hz, if the file says it instead of times
  std::string read_as;                           // how a text was read and what was skipped, "" if nothing
};

// Reads the columns of a text, of a universal file and of a sound file. Throws InputError, naming `name`, or
// IoError if that file cannot be read.
RecordColumns columns_of_text(const std::string& name, std::string_view text, bool has_rate);
RecordColumns columns_of_universal_file(const std::string& name, std::string_view text);
RecordColumns columns_of_sound(const std::filesystem::path& file);
bool is_universal_file(std::string_view text);
bool is_sound(std::string_view bytes);

// Returns a text of UTF-8, UTF-16 with a byte order mark, or Latin 1 as UTF-8 without one.
std::string as_utf8(std::string_view bytes);

}  // namespace impact_damper
