#include "power_table.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "files.hpp"
#include "impact_damper/io/json_writer.hpp"

namespace impact_damper::cli {
namespace {

// Returns the first of the claims, at most `most`, and how many more there are.
std::string names_of(const std::vector<std::string>& claims, std::size_t most) {
  if (claims.size() <= most) return joined(claims, ", ");
  return filled("{} and {} more",
                joined(std::vector(claims.begin(), claims.begin() + std::ptrdiff_t(most)), ", "),
                claims.size() - most);
}

// Returns the change of a number: "7.1 %", or what is added to a number that is 0.
std::string change_text(const PowerNumber& number, const Trial& trial) {
  if (number.value == 0) return number_text(trial.value);
  if (trial.change >= 1) return "a factor of " + rounded_text(1 + trial.change, 2);
  return rounded_text(100 * trial.change, 2) + " %";
}

std::string found_text(const PowerNumber& number, const std::optional<Direction>& direction) {
  if (!direction) return "-";
  if (!direction->turn) return "none up to " + rounded_text(direction->searched_to.value, 4);
  const Trial& trial = direction->turn->trial;
  if (number.value == 0) return "to " + rounded_text(trial.value, 4);
  return change_text(number, trial) + ", to " + rounded_text(trial.value, 4);
}

std::string claims_text(const std::optional<Direction>& direction, std::size_t most) {
  return direction && direction->turn ? names_of(direction->turn->claims, most) : "";
}

bool turns_some(const PowerRow& row) { return (row.up && row.up->turn) || (row.down && row.down->turn); }

std::string summary_text(const PowerTable& table) {
  const auto some = std::ranges::count_if(table.rows, turns_some);
  return filled("{} numbers, {} claims, {}ensembles of {}: {} numbers turn a verdict, {} turn none\n",
                table.rows.size(), table.claims, table.engine.empty() ? "" : "engine " + table.engine + ", ",
                table.members, some, table.rows.size() - static_cast<std::size_t>(some));
}

using Layout = JsonWriter::Layout;

void write(JsonWriter& out, std::string_view name, const std::optional<Direction>& direction) {
  if (!direction) return;
  out.new_line();
  out.open_object(name, Layout::one_line);
  out.field("searched_to", direction->searched_to.value);
  if (const auto& turn = direction->turn)
    out.fields("change", turn->trial.change, "value", turn->trial.value, "claims", turn->claims);
  out.close();
}

// Returns the cells of a row, with at most so many claims in each.
std::vector<std::string> cells_of(const PowerRow& row, std::size_t most_claims) {
  return {row.number.of,
          row.number.name,
          rounded_text(row.number.value, 4),
          found_text(row.number, row.up),
          claims_text(row.up, most_claims),
          found_text(row.number, row.down),
          claims_text(row.down, most_claims)};
}

// Returns the rows for which `wanted` holds, as a table whose first column is the scene, if they are of
// several.
template <class Wanted>
std::string markdown_rows(const PowerTable& table, bool with_scene, Wanted wanted) {
  Rows rows{{"scene", "number", "is", "smallest increase", "turns", "smallest decrease", "turns"}};
  for (const PowerRow& row : table.rows)
    if (wanted(row.number.of)) rows.push_back(cells_of(row, 3));
  if (!with_scene)
    for (auto& row : rows) row.erase(row.begin());
  return markdown_table(rows);
}

// Returns the numbers that no claim notices, by the test that does.
std::string unnoticed_rows(const PowerTable& table) {
  std::map<std::string_view, std::string> numbers;
  for (const PowerRow& row : table.rows) {
    if (turns_some(row)) continue;
    std::string& text = numbers[row.number.noticed_by];
    if (!text.empty()) text += ", ";
    text += row.number.of + " " + row.number.name;
  }
  Rows rows{{"test", "notices"}};
  for (const auto& [test, text] : numbers) rows.push_back({std::string(test), text});
  return markdown_table(rows);
}

}  // namespace

std::string table_text(const PowerTable& table) {
  Rows rows{{"of", "number", "is", "increase", "turns", "decrease", "turns"}};
  for (const PowerRow& row : table.rows) rows.push_back(cells_of(row, 2));
  const std::string left_out =
      table.unsettled.empty()
          ? ""
          : filled("left out, as other ensembles turn them: {}\n", joined(table.unsettled, ", "));
  return aligned(rows) + "\n" + left_out + summary_text(table);
}

std::string json_text(const PowerTable& table) {
  JsonWriter out("table");
  out.open_object(Layout::one_line);
  out.field("schema", "impact-damper/power/1");
  out.new_line();
  out.fields("engine", table.engine, "members", table.members, "claims", std::int64_t(table.claims),
             "other_ensembles", table.ensembles);
  out.new_line();
  out.field("unsettled", table.unsettled);
  out.new_line();
  out.open_array("numbers", Layout::lines);
  for (const PowerRow& row : table.rows) {
    out.open_object(Layout::one_line);
    out.fields("of", row.number.of, "name", row.number.name, "value", row.number.value);
    write(out, "up", row.up);
    write(out, "down", row.down);
    out.new_line();
    out.field("noticed_by", row.number.noticed_by);
    out.close();
  }
  out.close();
  out.close();
  return out.finish() + '\n';
}

std::string markdown_text(const PowerTable& table) {
  const auto is = [](std::string_view which) {
    return [which](const std::string& of) { return of == which; };
  };
  std::string text = R"(# How little turns a verdict

Made by `impact-damper verify --power --markdown` from [data/claims.json](../data/claims.json), all digits in
[power.json](power.json). For each number of the scenes, of the analysis and of what runs record: the smallest
change, all other numbers as they are, that turns at least one verdict of [claims.md](claims.md), and the claims that it
turns.

- A number becomes larger by so many percent, or is divided by as much: 50 % is times 1.5 or divided by 1.5. One that
  is 0 becomes what is given.
- A scene's number is changed as if its file were wrong: the simulation and the analysis both get the changed one.
  What runs record is multiplied in every run that a measure looks at. Sweeps under a force are made from their first
  start only.
- Medians of chaotic decays do not depend on a number monotonically. Changes of 0.1, 0.2, 0.5, 1, 2, 5 ... percent are
  tried until a verdict turns, and bisection over changes of two digits narrows the interval before it. The change
  given turns a verdict, and the next smaller one of two digits turns none; that no smaller change does is not
  proved. Whole numbers are tried one by one; their change is a
  percentage of what they are.
- A small change means that the claims hold the number tightly, *none* that they do not know it. The paper's words
  decide that, not the program: two percent of a momentum are below any digit that it prints.
)";
  text +=
      filled("- Left out, because at least one of {} other ensembles turns them without any change: {}.\n\n",
             table.ensembles, table.unsettled.empty() ? "none" : joined(table.unsettled, ", "));
  text += summary_text(table);
  text += "\n## Scenes\n\n" + markdown_rows(table, true, [](const std::string& of) {
            return of != "analysis" && of != "columns";
          });
  text += "\n## Analysis\n\n" + markdown_rows(table, false, is("analysis"));
  text += "\n## What runs record\n\nTimes a factor of 1.\n\n" + markdown_rows(table, false, is("columns"));
  text +=
      "\n## What no claim notices\n\nSuch a number is not in the paper, or the paper says that it does not "
      "matter, or its effect is gone before anything that\nis judged. A test of the project notices a "
      "change of it:\n\n" +
      unnoticed_rows(table);
  return text;
}

}  // namespace impact_damper::cli
