#include "application/sweeps/sweep_table.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "application/sweeps/hdf5_table.hpp"
#include "application/sweeps/plan_file.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/sha256.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/json_reader.hpp"

namespace impact_damper {
namespace {

namespace fs = std::filesystem;

fs::path description_of(fs::path table) { return table += ".json"; }

// Rejects columns other than those of the plan, as they were written.
void check_columns(ObjectReader& root, const Plan& plan) {
  const std::vector<PlanColumn> expected = columns_of(plan);
  const std::vector<ObjectReader> columns = root.required_objects("columns", 10'000);
  if (!root.all_valid()) return;
  if (columns.size() != expected.size())
    root.reject("columns", "must be the " + std::to_string(expected.size()) + " of the plan, got " +
                               std::to_string(columns.size()));
  for (std::size_t i = 0; i < std::min(columns.size(), expected.size()); ++i) {
    ObjectReader column = columns[i];
    column.word("name", {expected[i].name});
    column.word("unit", {expected[i].unit});
    column.word("meaning", {expected[i].meaning});
  }
}

// Splits a line of CSV (RFC 4180) into cells. Those that sweep writes contain no ends of line.
void split(const std::string& line, std::vector<std::string>& cells) {
  std::size_t count = 1;
  const auto cell = [&]() -> std::string& {
    if (cells.size() < count) cells.emplace_back();
    return cells[count - 1];
  };
  cell().clear();
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        cell() += line[++i];
      else
        quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      ++count;
      cell().clear();
    } else {
      cell() += line[i];
    }
  }
  cells.resize(count);
}

}  // namespace

SweepDescription read_sweep_description(const fs::path& table) {
  if (is_hdf5(table))
    throw InputError(table.string(),
                     {{"", "must be a table as CSV: make it again, or merge its parts, with -o " +
                               fs::path(table).replace_extension(".csv").string()}});
  SealedDocument document = SealedDocument::read(description_of(table), sweep_kind);
  ObjectReader root = document.root();
  if (root.require("schema")) root.word("schema", {"impact-damper/sweep/1"});
  SweepDescription description;
  ObjectReader plan = root.required_object("plan");
  description.plan = read_plan_object(plan);
  check_columns(root, description.plan);
  ObjectReader holds = root.required_object("table");
  holds.required("rows", description.rows, within(0, double(most_runs)));
  holds.required("bytes", description.bytes, within(0, 9e15));
  holds.required("sha256", description.digest, TextRule{64, 64});
  std::string program;
  root.required("program", program);
  if (root.all_valid() && description.rows != runs_of(description.plan))
    holds.reject("rows", "must be the " + std::to_string(runs_of(description.plan)) + " of the plan, got " +
                             std::to_string(description.rows));
  document.finish(root);
  return description;
}

void read_sweep_rows(const fs::path& table, const SweepDescription& description,
                     const std::function<void(std::span<const std::string> cells)>& visit) {
  errno = 0;
  std::ifstream stream(table, std::ios::binary);
  if (!stream) throw IoError(table.string() + ": cannot be read: " + std::strerror(errno ? errno : EIO));
  Sha256 hash;
  std::string line;
  std::int64_t lines = 0, bytes = 0;
  for (; bytes <= description.bytes && std::getline(stream, line); ++lines) {
    if (!stream.eof()) line += '\n';
    hash.add(line);
    bytes += std::int64_t(line.size());
  }
  if (bytes != description.bytes || lines != description.rows + 1 || hash.digest() != description.digest)
    throw InputError(table.string(), {{"", "is not the table that " + description_of(table).string() +
                                               " describes: its length or SHA-256 is another"}});
  stream.clear();
  stream.seekg(0);
  std::getline(stream, line);
  std::vector<std::string> cells;
  while (std::getline(stream, line)) {
    split(line, cells);
    visit(cells);
  }
}

SweepTable read_sweep_table(const fs::path& table, const Plan& plan) {
  const auto text_of = [](const Plan& each) {
    JsonWriter out("plan");
    out.open_object(JsonWriter::Layout::one_line);
    write_plan_fields(out, each);
    out.close();
    return out.finish();
  };
  const SweepDescription description = read_sweep_description(table);
  if (text_of(description.plan) != text_of(plan))
    throw InputError(table.string(), {{"", "must be of the plan that is asked for, is of another"}});
  SweepTable found{table, description.plan, {}};
  read_sweep_rows(table, description, [&](std::span<const std::string> cells) {
    found.rows.emplace_back(cells.begin(), cells.end());
  });
  return found;
}

}  // namespace impact_damper
