// The tables that figures draw: blocks of columns under a commented header, as gnuplot reads them.
//
// Blocks are named; a script picks one with `index "curve-1"`. The first line of a block's data heads its
// columns, the last heading being the legend of the block: `title columnheader(N)`.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace impact_damper {

struct TableColumn {
  std::string heading;
  std::string meaning;  // what it is and what it is scaled by
  std::vector<double> values;
};

struct TableBlock {
  std::string name;
  std::vector<std::string> notes = {};  // comment lines
  std::vector<TableColumn> columns = {};
  std::vector<std::size_t> gaps = {};  // rows before which a drawn line is interrupted, ascending
};

struct Table {
  std::vector<std::string> header;  // comment lines
  std::vector<TableBlock> blocks;
};

// Throws std::domain_error naming block and column if a block is empty, its columns differ in length, or a
// value is not finite.
void check(const Table& table);

// The file's text; every number in its shortest form that reads back the same. Checks first.
std::string to_text(const Table& table);

}  // namespace impact_damper
