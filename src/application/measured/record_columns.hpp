// The columns of a measured record, whatever the file is that they stand in.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"

namespace impact_damper {

// What a unit measures. Volts, counts and full scale become one of the others by a sensitivity.
enum class RecordQuantity { time, displacement, velocity, acceleration, volts, counts, full_scale };
struct RecordUnit {
  std::string_view names;  // with blanks between
  RecordQuantity measure;
  double factor;  // to s, mm, mm/s, mm/s^2, V, counts or full scale
  std::string_view name() const { return names.substr(0, names.find(' ')); }  // as it is printed
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

// Collects what is wrong with rows of a record, of which the first ten are told.
class RecordProblems {
 public:
  void add(const std::string& field, const std::string& what) {
    if (first_.size() < most_) first_.push_back({field, what});
    ++count_;
  }
  void throw_if_any(const std::string& file) {
    if (count_ == 0) return;
    if (count_ > most_)
      first_.push_back({"", filled("and {} more lines that are not valid", count_ - most_)});
    throw InputError(file, first_);
  }

 private:
  static constexpr std::size_t most_ = 10;
  std::vector<Problem> first_;
  std::size_t count_ = 0;
};

// Reads the columns of a file, text or not, whose content is `bytes`; a sound file is opened once more by its
// name. Throws InputError, naming it.
RecordColumns columns_of(const std::string& name, std::string_view bytes, bool has_rate);

}  // namespace impact_damper
