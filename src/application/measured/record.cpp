#include "application/measured/record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "application/measured/record_columns.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/json_reader.hpp"

namespace impact_damper {
namespace {

constexpr double most_value = 1e15;  // s, mm, mm/s or mm/s^2: as in scenes

[[noreturn]] void reject(const std::string& name, const std::string& field, const std::string& what) {
  throw InputError(name, {{field, what}});
}

// "column 3, "ch2 (g)"", counted from 1.
std::string called(std::size_t index, const RecordColumn& column) {
  std::string text = filled("column {}", index + 1);
  if (!column.name.empty()) text += ", " + in_quotes(column.name) + ",";
  return text;
}
std::string listed_columns(const RecordColumns& columns) {
  std::vector<std::string> texts;
  for (std::size_t j = 0; j < columns.all.size(); ++j) {
    if (!columns.all[j]) continue;
    texts.push_back(std::to_string(j + 1));
    if (!columns.all[j]->name.empty()) texts.back() += ' ' + in_quotes(columns.all[j]->name);
    if (columns.all[j]->unit) texts.back() += filled(" in {}", columns.all[j]->unit->name());
  }
  return listed({texts.begin(), texts.end()}, "and");
}

struct Choice {
  std::size_t index;
  const RecordUnit* unit;  // null if neither the file nor the option says it
};
// Returns the column that an option names. Absent, with the problem added, if there is none.
std::optional<Choice> chosen(const RecordColumns& columns, const std::string& option, const std::string& text,
                             std::vector<Problem>& problems) {
  const auto find = [&](std::string_view word) -> std::optional<std::size_t> {
    if (const auto number = parse_integer(word))
      if (*number >= 1 && *number <= std::int64_t(columns.all.size()) &&
          columns.all[std::size_t(*number - 1)])
        return std::size_t(*number - 1);
    for (std::size_t j = 0; j < columns.all.size(); ++j)
      if (columns.all[j] && in_lower_case(columns.all[j]->name) == in_lower_case(word)) return j;
    return std::nullopt;
  };
  if (const auto index = find(text)) return Choice{*index, columns.all[*index]->unit};
  const std::size_t colon = std::min(text.rfind(':'), text.size());
  const auto index = find(text.substr(0, colon));
  const RecordUnit* const unit = colon < text.size() ? find_unit(text.substr(colon + 1)) : nullptr;
  if (index && unit) return Choice{*index, unit};
  problems.push_back(
      {option, index ? filled("must end in a unit such as mm, m/s^2 or ms, got {}", in_quotes(text))
                     : filled("must be one of {}, got {}", listed_columns(columns), in_quotes(text))});
  return std::nullopt;
}
// "column 2, "x", has no unit: give --column 2:mm, or ..."
Problem without_unit(std::size_t index, const RecordColumn& column, const std::string& option,
                     const std::string& units) {
  return {"", filled("{} has no unit: give {} {}:{}", called(index, column), option, index + 1, units)};
}

bool is_motion(RecordQuantity measure) {
  return measure == RecordQuantity::displacement || measure == RecordQuantity::velocity ||
         measure == RecordQuantity::acceleration;
}
bool is_time_name(std::string_view name) {
  const std::string lower = in_lower_case(name);
  constexpr auto beginnings = std::to_array<std::string_view>(
      {"time", "zeit", "temps", "tiempo", "tempo", "x_value", "date", "datum", "elapsed"});
  return lower == "t" ||
         std::ranges::any_of(beginnings, [&](std::string_view word) { return lower.starts_with(word); });
}
bool is_time(const RecordColumn& column) {
  return column.unit ? column.unit->measure == RecordQuantity::time
                     : column.has_stamps || is_time_name(column.name);
}

// The column of the motion: the one that is named, else the only one whose unit could be that.
std::optional<Choice> value_of(const RecordColumns& columns, const RecordOptions& options,
                               std::vector<Problem>& problems) {
  const std::string units = "mm, or m/s, g, V and so on";
  std::vector<Choice> values, others;
  if (options.column) {
    const auto value = chosen(columns, "--column", *options.column, problems);
    if (!value) return value;
    (value->unit ? values : others).push_back(*value);
  } else {
    for (std::size_t j = 0; j < columns.all.size(); ++j) {
      if (!columns.all[j] || is_time(*columns.all[j])) continue;
      const RecordUnit* const unit = columns.all[j]->unit;
      if (!unit) others.push_back({j, unit});
      if (unit && (options.sensitivity || is_motion(unit->measure))) values.push_back({j, unit});
    }
  }
  if (values.size() == 1) return values[0];
  if (values.empty() && others.size() == 1)
    problems.push_back(without_unit(others[0].index, *columns.all[others[0].index], "--column", units));
  else if (values.empty())
    problems.push_back(
        {"", filled("has no column with a unit of motion: give --column N:{}; its columns are {}", units,
                    listed_columns(columns))});
  else
    problems.push_back(
        {"", filled("has several columns that could be the record: give --column N; its columns are {}",
                    listed_columns(columns))});
  return std::nullopt;
}

// The column of times: the one that is named, else of those that are times the last one before the values.
// Absent as well if the file or the options give a rate instead.
std::optional<Choice> time_of(const RecordColumns& columns, const RecordOptions& options,
                              const std::optional<Choice>& value, std::vector<Problem>& problems) {
  if (options.rate) return std::nullopt;
  std::optional<Choice> time;
  if (options.time) {
    time = chosen(columns, "--time", *options.time, problems);
    if (!time) return time;
  } else {
    for (std::size_t j = 0; j < columns.all.size(); ++j) {
      if (!columns.all[j] || !is_time(*columns.all[j]) || (value && j == value->index)) continue;
      if (time && value && j > value->index) continue;
      time = Choice{j, columns.all[j]->unit};
    }
    if (!time && !columns.rate)
      problems.push_back(
          {"", "has no column with a unit of time: give --time N:s, or ms or us, or --rate in Hz"});
    if (!time) return time;
  }
  const RecordColumn& column = *columns.all[time->index];
  if (column.has_stamps || (!time->unit && column.name == "X_Value")) time->unit = find_unit("s");
  if (!time->unit) {
    problems.push_back(without_unit(time->index, column, "--time", "s, or ms or us"));
  } else if (time->unit->measure != RecordQuantity::time) {
    problems.push_back({"--time", filled("must be in a unit of time, got {}", time->unit->name())});
  }
  return time;
}

// What one unit of the column is, in mm, mm/s or mm/s^2.
struct Scale {
  RecordQuantity measure = RecordQuantity::displacement;
  double factor = 1;
};
Scale scale_of(const RecordUnit& unit, const RecordOptions& options, std::vector<Problem>& problems) {
  const std::string example = "as in \"100 mV/g\"";
  if (!options.sensitivity) {
    if (!is_motion(unit.measure))
      problems.push_back({"", filled("the record is in {}: give --sensitivity, {}", unit.name(), example)});
    return {unit.measure, unit.factor};
  }
  const std::string_view text = *options.sensitivity;
  const std::size_t end = std::min(text.find_first_not_of("+-.0123456789"), text.size()),
                    slash = std::min(text.find('/', end), text.size());
  const auto each = parse_number(text.substr(0, end));
  const RecordUnit* const signal = find_unit(text.substr(end, slash - end));
  const RecordUnit* const motion = slash < text.size() ? find_unit(text.substr(slash + 1)) : nullptr;
  if (!each || *each == 0 || !signal || is_motion(signal->measure) ||
      signal->measure == RecordQuantity::time || !motion || !is_motion(motion->measure)) {
    problems.push_back(
        {"--sensitivity",
         filled("must be V, mV, counts or FS per unit of the motion, {}, got {}", example, in_quotes(text))});
    return {};
  }
  if (signal->measure != unit.measure)
    problems.push_back(
        {"--sensitivity", filled("must be in {}, as the column is, got {}", unit.name(), signal->name())});
  return {motion->measure, unit.factor / (*each * signal->factor) * motion->factor};
}

MeasuredRecord record_of(const std::string& name, const RecordColumns& columns,
                         const RecordOptions& options) {
  std::vector<Problem> problems;
  const auto choice = value_of(columns, options, problems);
  const auto time = time_of(columns, options, choice, problems);
  const Scale scale = choice ? scale_of(*choice->unit, options, problems) : Scale{};
  if (!problems.empty()) throw InputError(name, problems);
  const Choice& value = *choice;
  const RecordColumn& of_value = *columns.all[value.index];
  MeasuredRecord record;
  record.quantity = scale.measure == RecordQuantity::displacement ? MeasuredQuantity::displacement
                    : scale.measure == RecordQuantity::velocity   ? MeasuredQuantity::velocity
                                                                  : MeasuredQuantity::acceleration;
  const double rate = options.rate ? *options.rate : columns.rate.value_or(0);

  RecordProblems wrong;
  const auto add_problem = [&](std::size_t row, const std::string& what) {
    wrong.add(
        row < columns.lines.size() ? filled("line {}", columns.lines[row]) : filled("sample {}", row + 1),
        what);
  };
  std::optional<double> last;
  for (std::size_t i = 0; i < of_value.values.size(); ++i) {
    const double given = time ? columns.all[time->index]->values[i] : double(i);
    const double at = time ? given * time->unit->factor : double(i) / rate, number = of_value.values[i];
    if (std::isnan(given)) {
      if (!std::isnan(number)) add_problem(i, "must have a time");
      continue;
    }
    if (!(std::abs(at) <= most_value)) {
      add_problem(i, filled("a time must be at most {} s either way, got {} s", most_value, at));
    } else if (last && !(at > *last)) {
      add_problem(
          i, filled("a time must be larger than in the row before, {} s, got {} s{}", *last, at,
                    at == *last ? "; of a clock that is coarser than the samples give --rate instead" : ""));
    }
    last = at;
    if ((options.from && at < *options.from) || (options.to && at > *options.to)) continue;
    if (std::isnan(number)) {
      ++record.empty_cells;
      continue;
    }
    if (!(std::abs(number * scale.factor) <= most_value))
      add_problem(i, filled("a value must be at most {} {} either way, got {}",
                            most_value / value.unit->factor, value.unit->name(), number));
    record.time.push_back(at);
    record.value.push_back(number * scale.factor);
  }
  wrong.throw_if_any(name);

  record.read_as =
      filled("{} as {} in {}", called(value.index, of_value), name_of(record.quantity), value.unit->name());
  if (options.sensitivity) record.read_as += filled(", {}", *options.sensitivity);
  if (time) {
    record.read_as += filled("; time in column {} {}", time->index + 1,
                             columns.all[time->index]->has_stamps ? std::string("as clock stamps")
                                                                  : filled("in {}", time->unit->name()));
  } else {
    record.read_as += filled("; {} samples/s", rate);
  }
  if (options.from) record.read_as += filled("; from {} s", *options.from);
  if (options.to) record.read_as += filled("; to {} s", *options.to);
  if (!columns.read_as.empty()) record.read_as += "; " + columns.read_as;
  if (record.empty_cells > 0)
    record.read_as += filled("; {} value{} missing", record.empty_cells, record.empty_cells == 1 ? "" : "s");
  require_samples(name, record);
  return record;
}

}  // namespace

std::string_view unit_of(MeasuredQuantity quantity) {
  constexpr std::array<std::string_view, 3> units{"mm", "mm/s", "mm/s^2"};
  return units[std::size_t(quantity)];
}

void require_samples(const std::string& name, const MeasuredRecord& record) {
  if (record.time.size() < least_samples)
    reject(name, "", filled("must have at least {} samples, got {}", least_samples, record.time.size()));
}

MeasuredRecord read_measured_record(const std::filesystem::path& file, const RecordOptions& options) {
  return parse_measured_record(file.string(), read_text(file, measured_kind), options);
}

MeasuredRecord parse_measured_record(const std::string& name, std::string_view bytes,
                                     const RecordOptions& options) {
  return record_of(name, columns_of(name, bytes, options.rate.has_value()), options);
}

}  // namespace impact_damper
