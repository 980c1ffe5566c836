#include "impact_damper/paper/table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "impact_damper/files/number_text.hpp"

namespace impact_damper {
namespace {

void check_block(const TableBlock& block) {
  const std::string where = "table block " + block.name;
  if (block.columns.empty() || block.columns[0].values.empty()) throw std::domain_error(where + " is empty");
  for (const TableColumn& column : block.columns) {
    if (column.values.size() != block.columns[0].values.size()) {
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
  constexpr std::size_t usual_length = 20;  // of a number and what stands behind it
  text.reserve(text.size() + usual_length * block.columns.size() * block.columns[0].values.size());
  for (std::size_t row = 0; row < block.columns[0].values.size(); ++row) {
    if (std::ranges::binary_search(block.gaps, row)) text += '\n';
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      if (c) text += ' ';
      append_number(text, block.columns[c].values[row]);
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

}  // namespace impact_damper
