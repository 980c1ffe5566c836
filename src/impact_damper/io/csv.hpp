// Rows of CSV (RFC 4180): cells with commas between, in double quotes where they hold a comma, a quote or an
// end of line.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

}  // namespace impact_damper
