// The table of power.hpp as text.
#pragma once

#include <string>
#include <vector>

#include "application/reproduction/power.hpp"

namespace impact_damper::cli {

struct PowerTable {
  std::string engine;
  std::int64_t members = 0;
  std::size_t claims = 0;
  std::int64_t ensembles = 0;          // other ensembles that verdicts were compared with
  std::vector<std::string> unsettled;  // claims whose verdicts differ there, which are left out
  std::vector<PowerRow> rows;
};

std::string table_text(const PowerTable& table);     // for a terminal
std::string json_text(const PowerTable& table);      // schema "impact-damper/power/1"
std::string markdown_text(const PowerTable& table);  // with what it means

}  // namespace impact_damper::cli
