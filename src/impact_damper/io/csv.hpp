// CSV (RFC 4180): rows of cells with commas between, in double quotes where they hold a comma, a quote or an
// end of line. Lines end with LF.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// Reads the rows of a text one by one. Ends of line are LF or CRLF.
class CsvRows {
 public:
  explicit CsvRows(std::string_view text) : text_(text) {}
  // Reads the cells of the next row; false at the end.
  bool next(std::vector<std::string>& cells) {
    cells.clear();
    line_ = next_line_;
    if (at_ >= text_.size()) return false;
    std::string cell;
    bool quoted = false;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      next_line_ += c == '\n';
      if (quoted) {
        if (c != '"') {
          cell += c;
        } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
          cell += text_[++at_];
        } else {
          quoted = false;
        }
      } else if (c == '"' && cell.empty()) {
        quoted = true;
      } else if (c == ',') {
        cells.push_back(std::move(cell));
        cell.clear();
      } else if (c == '\n') {
        ++at_;
        break;
      } else if (!(c == '\r' && (at_ + 1 == text_.size() || text_[at_ + 1] == '\n'))) {
        cell += c;
      }
    }
    cells.push_back(std::move(cell));
    return true;
  }
  std::size_t line() const { return line_; }  // where the row that was read begins, from 1

 private:
  std::string_view text_;
  std::size_t at_ = 0, line_ = 0, next_line_ = 1;
};

// Appends a cell to a row.
inline void append_csv_cell(std::string& row, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    row += text;
    return;
  }
  row += '"';
  for (const char c : text) row += c == '"' ? std::string("\"\"") : std::string(1, c);
  row += '"';
}

// A table that is made column by column. With `scales` numbers are in SI, as the names of their columns then
// show.
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
