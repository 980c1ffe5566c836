// The tables that figures draw: blocks of columns under a commented header, as gnuplot reads them.
//
// Blocks are named; a script picks one with `index "curve-1"`. The first line of a block's data heads its
// columns, the last heading being the legend of the block: `title columnheader(N)`.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace impact_damper {

// Role of a column for each number of the first, x: a value, or an end of the interval it lies in.
enum class Ordinate { y, low, high };

struct TableColumn {
  std::string heading;
  std::string meaning;  // what it is and what it is scaled by
  std::vector<double> values = {};
  Ordinate is = Ordinate::y;
};

struct TableBlock {
  std::string name;
  std::vector<std::string> notes = {};  // comment lines
  std::vector<TableColumn> columns = {};
  std::vector<std::size_t> gaps = {};  // rows before which a drawn line is interrupted, ascending

  std::size_t rows() const { return columns.empty() ? 0 : columns[0].values.size(); }
  // Adds a number to each column.
  void add_row(std::initializer_list<double> row) {
    auto column = columns.begin();
    for (const double value : row) (column++)->values.push_back(value);
  }
};

struct Table {
  std::vector<std::string> header;  // comment lines
  std::vector<TableBlock> blocks;

  void add(TableBlock block) { blocks.push_back(std::move(block)); }
  void add_if_any(TableBlock block) {  // unless it has no rows
    if (block.rows() > 0) add(std::move(block));
  }
  bool has(std::string_view block) const {
    return std::ranges::find(blocks, block, &TableBlock::name) != blocks.end();
  }
};

// Throws std::domain_error naming block and column if a block is empty, its columns differ in length, or a
// value is not finite.
void check(const Table& table);

// Returns the file's text, with every number in its shortest form that reads back the same. Checks first.
std::string to_text(const Table& table);

// Returns the same numbers as tidy CSV (RFC 4180) under the header block,curve,x,y,low,high: one row for each
// x of each curve. A curve is a column y of a block under its heading; the block's columns `low` and `high`
// stand beside the last of them, or alone where there is none, under the heading of `high`. A cell without a
// number is empty; a row without any interrupts the line, where the block has a gap. Comment lines are left
// out. Lines end with LF: every CSV reader takes it, git and text tools keep it, and with CRLF the last cell
// of a line would end with a CR in awk.
std::string to_csv(const Table& table);

}  // namespace impact_damper
