#include "power_table.hpp"

#include <algorithm>
#include <optional>

#include "impact_damper/files/number_text.hpp"
#include "text_table.hpp"

namespace impact_damper::cli {
namespace {

// Of so many claims the first few, and how many more.
std::string names_of(const std::vector<std::string>& claims, std::size_t most) {
  std::string text;
  for (std::size_t i = 0; i < claims.size() && i < most; ++i) {
    if (i > 0) text += ", ";
    text += claims[i];
  }
  if (claims.size() > most) text += " and " + std::to_string(claims.size() - most) + " more";
  return text;
}

// "7.1 %" of a number that is not 0; what is added to one that is.
std::string change_text(const PowerNumber& number, const Trial& trial) {
  if (number.value == 0) return number_text(trial.value);
  if (trial.change >= 10) return "a factor of " + rounded_text(1 + trial.change, 3);
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
  return std::to_string(table.rows.size()) + " numbers, " + std::to_string(table.claims) +
         " claims, engine " + table.engine + ", ensembles of " + std::to_string(table.members) + ": " +
         std::to_string(some) + " numbers turn a verdict, " +
         std::to_string(table.rows.size() - static_cast<std::size_t>(some)) + " turn none\n";
}

std::string quoted(const std::string& text) { return '"' + text + '"'; }  // names have no other characters

std::string json_of(const Direction& direction) {
  std::string text = "{\"searched_to\": " + number_text(direction.searched_to.value);
  if (direction.turn) {
    text += ", \"change\": " + number_text(direction.turn->trial.change) +
            ", \"value\": " + number_text(direction.turn->trial.value) + ", \"claims\": [";
    const char* separator = "";
    for (const std::string& claim : direction.turn->claims) {
      text += separator + quoted(claim);
      separator = ", ";
    }
    text += "]";
  }
  return text + "}";
}

}  // namespace

std::string table_text(const PowerTable& table) {
  std::vector<std::vector<std::string>> lines{
      {"of", "number", "is", "increase", "turns", "decrease", "turns"}};
  for (const PowerRow& row : table.rows)
    lines.push_back({row.number.of, row.number.name, rounded_text(row.number.value, 4),
                     found_text(row.number, row.up), claims_text(row.up, 2), found_text(row.number, row.down),
                     claims_text(row.down, 2)});
  return aligned(lines) + "\n" + summary_text(table);
}

std::string json_text(const PowerTable& table) {
  std::string text = "{\"schema\": \"impact-damper/power/1\",\n \"engine\": " + quoted(table.engine) +
                     ", \"members\": " + std::to_string(table.members) +
                     ", \"claims\": " + std::to_string(table.claims) + ",\n \"numbers\": [";
  const char* separator = "\n";
  for (const PowerRow& row : table.rows) {
    text += separator;
    text += "  {\"of\": " + quoted(row.number.of) + ", \"name\": " + quoted(row.number.name) +
            ", \"value\": " + number_text(row.number.value);
    if (row.up) text += ",\n   \"up\": " + json_of(*row.up);
    if (row.down) text += ",\n   \"down\": " + json_of(*row.down);
    text += ",\n   \"noticed_by\": " + quoted(std::string(row.number.noticed_by)) + "}";
    separator = ",\n";
  }
  return text + "\n ]}\n";
}

std::string markdown_text(const PowerTable& table) {
  std::string text = "TODO\n\n";
  for (const PowerRow& row : table.rows)
    text += "| " + row.number.of + " | " + row.number.name + " | " + rounded_text(row.number.value, 4) +
            " | " + found_text(row.number, row.up) + " | " + claims_text(row.up, 4) + " | " +
            found_text(row.number, row.down) + " | " + claims_text(row.down, 4) + " |\n";
  return text + "\n" + summary_text(table);
}

}  // namespace impact_damper::cli
