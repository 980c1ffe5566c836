#include "application/measured/record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/io/csv.hpp"
#include "impact_damper/io/json_reader.hpp"

namespace impact_damper {
namespace {

struct Unit {
  std::string_view heading;
  double factor;  // to s, mm or mm/s^2
  MeasuredQuantity quantity = MeasuredQuantity::displacement;
};
constexpr std::array<Unit, 2> time_units{{{"t_s", 1}, {"t_ms", 1e-3}}};
constexpr double standard_gravity = 9806.65;  // mm/s^2
constexpr std::array<Unit, 6> value_units{{{"x_mm", 1},
                                           {"x_m", 1e3},
                                           {"x_um", 1e-3},
                                           {"a_m_per_s2", 1e3, MeasuredQuantity::acceleration},
                                           {"a_mm_per_s2", 1, MeasuredQuantity::acceleration},
                                           {"a_g", standard_gravity, MeasuredQuantity::acceleration}}};

constexpr double largest = 1e15;  // s, mm or mm/s^2: as in scenes
constexpr std::size_t most_problems = 10;

class Problems {
 public:
  void add(std::size_t line, const std::string& what) {
    if (++count_ <= most_problems) first_.push_back({"line " + std::to_string(line), what});
  }
  void throw_if_any(const std::string& file) {
    if (count_ == 0) return;
    if (count_ > most_problems)
      first_.push_back(
          {"", "and " + std::to_string(count_ - most_problems) + " more lines that are not valid"});
    throw InputError(file, first_);
  }

 private:
  std::vector<Problem> first_;
  std::size_t count_ = 0;
};

const Unit* unit_of(std::span<const Unit> units, const std::string& heading, Problems& problems) {
  const auto found = std::ranges::find(units, std::string_view(heading), &Unit::heading);
  if (found != units.end()) return &*found;
  std::vector<std::string_view> known(units.size());
  std::ranges::transform(units, known.begin(), &Unit::heading);
  problems.add(1, "a column must be headed " + listed(known, "or") + ", got " + in_quotes(heading) +
                      did_you_mean(heading, known));
  return nullptr;
}

}  // namespace

std::string_view unit_of(MeasuredQuantity quantity) {
  return quantity == MeasuredQuantity::displacement ? "mm" : "mm/s^2";
}

MeasuredRecord read_measured_record(const std::filesystem::path& file) {
  return parse_measured_record(file.string(), read_text(file, measured_kind));
}

MeasuredRecord parse_measured_record(const std::string& name, std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  Problems problems;
  CsvRows rows(text);
  std::vector<std::string> cells;
  MeasuredRecord record;
  if (!rows.next(cells) || cells.size() != 2) {
    problems.add(1, "must head two columns with their units, as in \"t_s,x_mm\", got " +
                        in_quotes(text.substr(0, text.find('\n'))));
    problems.throw_if_any(name);
  }
  const Unit* const time_unit = unit_of(time_units, cells[0], problems);
  const Unit* const value_unit = unit_of(value_units, cells[1], problems);
  problems.throw_if_any(name);
  record.quantity = value_unit->quantity;
  const auto limit = [&problems](std::size_t where, const Unit& unit, const std::optional<double>& number) {
    if (number && !(std::abs(*number * unit.factor) <= largest))
      problems.add(where, std::string(unit.heading) + " must be at most " +
                              number_text(largest / unit.factor) + " either way, got " +
                              number_text(*number));
  };
  std::optional<double> last;
  while (rows.next(cells)) {
    if (cells.size() == 1 && cells[0].empty()) continue;  // an empty line
    if (cells.size() != 2) {
      problems.add(rows.line(), "must have 2 cells, got " + std::to_string(cells.size()));
      continue;
    }
    const auto time = parse_number(cells[0]), value = parse_number(cells[1]);
    if (!time)
      problems.add(rows.line(),
                   std::string(time_unit->heading) + " must be a number, got " + in_quotes(cells[0]));
    if (!value && !cells[1].empty())
      problems.add(rows.line(), std::string(value_unit->heading) +
                                    " must be a number, or empty where a sample is missing, got " +
                                    in_quotes(cells[1]));
    limit(rows.line(), *time_unit, time);
    limit(rows.line(), *value_unit, value);
    if (!time) continue;
    if (last && !(*time * time_unit->factor > *last * time_unit->factor))
      problems.add(rows.line(), std::string(time_unit->heading) + " must be larger than in the row before, " +
                                    number_text(*last) + ", got " + number_text(*time));
    last = time;
    if (!value) {
      ++record.empty_cells;
      continue;
    }
    record.time.push_back(*time * time_unit->factor);
    record.value.push_back(*value * value_unit->factor);
  }
  problems.throw_if_any(name);
  if (record.time.size() < least_samples)
    throw InputError(name, {{"", "must have at least " + std::to_string(least_samples) + " samples, got " +
                                     std::to_string(record.time.size())}});
  return record;
}

}  // namespace impact_damper
