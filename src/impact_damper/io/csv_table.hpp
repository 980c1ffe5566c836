// A table as CSV (RFC 4180, lines end with LF), made column by column.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// With `scales` numbers are in SI, as the names of their columns then show.
class CsvTable {
 public:
  // of: what the table is of, for messages.
  CsvTable(std::string_view of, const std::optional<Scales>& scales) : of_(of), scales_(scales) {}

  // Add a column. The first one has all rows; a shorter one is repeated. An absent number is an empty cell.
  // Throws NumericalError, naming the column, if a number is not finite.
  void add(const std::string& name, const std::vector<std::string>& words) {
    add_cells(name, words.size(), [&](std::string& line, std::size_t i) { line += words[i]; });
  }
  template <class Number>
  void add(const std::string& name, Dimension dimension, const std::vector<Number>& numbers) {
    const double scale = scales_ ? scales_->in_si(dimension) : 1;
    const auto append = [&](std::string& line, std::size_t i) { append_cell(line, name, numbers[i], scale); };
    add_cells(name + std::string(scales_ ? suffix_of(dimension) : ""), numbers.size(), append);
  }
  bool empty() const { return lines_.empty(); }
  std::string text() const {
    std::string all;
    for (const std::string& line : lines_) all += line + '\n';
    return all;
  }

 private:
  template <class Append>
  void add_cells(const std::string& heading, std::size_t count, const Append& append) {
    const bool first = lines_.empty();
    if (first) lines_.resize(1 + count);
    if (!first) lines_[0] += ',';
    lines_[0] += heading;
    for (std::size_t row = 1; row < lines_.size(); ++row) {
      if (!first) lines_[row] += ',';
      append(lines_[row], (row - 1) % count);
    }
  }
  void append_cell(std::string& line, const std::string& name, double number, double scale) const {
    if (!std::isfinite(number * scale))
      throw NumericalError("a number in \"" + name + "\" of the " + of_ +
                           " is not finite: " + number_text(number * scale));
    append_number(line, number * scale);
  }
  void append_cell(std::string& line, const std::string& name, const std::optional<double>& number,
                   double scale) const {
    if (number) append_cell(line, name, *number, scale);
  }
  static void append_cell(std::string& line, const std::string&, std::int64_t number, double) {
    append_number(line, number);
  }

  std::string of_;
  const std::optional<Scales>& scales_;
  std::vector<std::string> lines_;
};

}  // namespace impact_damper
