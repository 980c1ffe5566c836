#include "application/reproduction/table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

void check_block(const TableBlock& block) {
  const std::string where = "table block " + block.name;
  if (block.rows() == 0) throw std::domain_error(where + " is empty");
  for (const TableColumn& column : block.columns) {
    if (column.values.size() != block.rows()) {
      throw std::domain_error(where + ": column \"" + column.heading + "\" differs in length");
    }
    for (const double value : column.values) {
      if (!std::isfinite(value)) {
        throw std::domain_error(where + ": column \"" + column.heading + "\" holds " + number_text(value) +
                                ", must be finite");
      }
    }
  }
}

void append(std::string& text, const TableBlock& block) {
  text += "\n\n# " + block.name + "\n";
  for (const std::string& note : block.notes) text += "# " + note + "\n";
  for (std::size_t c = 0; c < block.columns.size(); ++c) {
    text += "# column " + std::to_string(c + 1) + ": " + block.columns[c].meaning + "\n";
  }
  for (std::size_t c = 0; c < block.columns.size(); ++c) {
    text += (c ? " \"" : "\"") + block.columns[c].heading + "\"";
  }
  text += '\n';
  constexpr std::size_t usual_length = 20;  // of a number and the character after it
  text.reserve(text.size() + usual_length * block.columns.size() * block.rows());
  for (std::size_t row = 0; row < block.rows(); ++row) {
    if (std::ranges::binary_search(block.gaps, row)) text += '\n';
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      if (c) text += ' ';
      append_number(text, block.columns[c].values[row]);
    }
    text += '\n';
  }
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

// Returns the last column of this role behind the first column; a null pointer if there is none.
const TableColumn* column_of(const TableBlock& block, Ordinate ordinate) {
  const TableColumn* found = nullptr;
  for (std::size_t c = 1; c < block.columns.size(); ++c)
    if (block.columns[c].is == ordinate) found = &block.columns[c];
  return found;
}

// Appends the rows of one curve; each of the columns may be absent.
void append_curve(std::string& text, const TableBlock& block, const std::string& curve, const TableColumn* y,
                  const TableColumn* low, const TableColumn* high) {
  const std::string names = csv_cell(block.name) + ',' + csv_cell(curve);
  const TableColumn& x = block.columns[0];
  for (std::size_t row = 0; row < x.values.size(); ++row) {
    if (std::ranges::binary_search(block.gaps, row)) text += names + ",,,,\n";
    text += names;
    for (const TableColumn* column : {&x, y, low, high}) {
      text += ',';
      if (column) append_number(text, column->values[row]);
    }
    text += '\n';
  }
}

}  // namespace

void check(const Table& table) {
  for (const TableBlock& block : table.blocks) check_block(block);
}

std::string to_text(const Table& table) {
  check(table);
  std::string text;
  for (const std::string& line : table.header) text += "# " + line + "\n";
  for (const TableBlock& block : table.blocks) append(text, block);
  return text;
}

std::string to_csv(const Table& table) {
  check(table);
  std::string text = "block,curve,x,y,low,high\n";
  for (const TableBlock& block : table.blocks) {
    const TableColumn *const low = column_of(block, Ordinate::low),
                             *const high = column_of(block, Ordinate::high),
                             *const last = column_of(block, Ordinate::y);
    for (std::size_t c = 1; c < block.columns.size(); ++c) {
      const TableColumn& y = block.columns[c];
      if (y.is != Ordinate::y) continue;
      const bool bounded = &y == last;
      append_curve(text, block, y.heading, &y, bounded ? low : nullptr, bounded ? high : nullptr);
    }
    if (!last && high) append_curve(text, block, high->heading, nullptr, low, high);
  }
  return text;
}

}  // namespace impact_damper
