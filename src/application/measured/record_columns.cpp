#include "application/measured/record_columns.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#ifdef IMPACT_DAMPER_SNDFILE
#include <sndfile.h>

#include <memory>
#endif

#include "application/measured/record.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view blanks = " \t\r\f\v";

std::string_view trimmed(std::string_view text, std::string_view of = blanks) {
  const std::size_t first = text.find_first_not_of(of);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(of) + 1 - first);
}
void replace(std::string& text, std::string_view what, std::string_view with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
}

// --- Units ------------------------------------------------------------------------------------------------

// name: how it is printed, then other words for it.
constexpr auto units = std::to_array<RecordUnit>({
    {"s second seconds", RecordQuantity::time, 1},
    {"ms millis", RecordQuantity::time, 1e-3},
    {"us micros", RecordQuantity::time, 1e-6},
    {"ns", RecordQuantity::time, 1e-9},
    {"min", RecordQuantity::time, 60},
    {"mm", RecordQuantity::displacement, 1},
    {"cm", RecordQuantity::displacement, 10},
    {"m", RecordQuantity::displacement, 1e3},
    {"um micron", RecordQuantity::displacement, 1e-3},
    {"nm", RecordQuantity::displacement, 1e-6},
    {"in inch", RecordQuantity::displacement, 25.4},
    {"ft", RecordQuantity::displacement, 304.8},
    {"mm/s", RecordQuantity::velocity, 1},
    {"cm/s", RecordQuantity::velocity, 10},
    {"m/s", RecordQuantity::velocity, 1e3},
    {"um/s", RecordQuantity::velocity, 1e-3},
    {"in/s", RecordQuantity::velocity, 25.4},
    {"mm/s2", RecordQuantity::acceleration, 1},
    {"cm/s2 Gal", RecordQuantity::acceleration, 10},
    {"m/s2", RecordQuantity::acceleration, 1e3},
    {"in/s2", RecordQuantity::acceleration, 25.4},
    {"ft/s2", RecordQuantity::acceleration, 304.8},
    {"g", RecordQuantity::acceleration, 1e3 * standard_gravity},
    {"mg", RecordQuantity::acceleration, standard_gravity},
    {"V volt volts", RecordQuantity::volts, 1},
    {"mV", RecordQuantity::volts, 1e-3},
    {"uV", RecordQuantity::volts, 1e-6},
    {"counts count", RecordQuantity::counts, 1},
    {"FS", RecordQuantity::full_scale, 1},
});

// The unit in a head: in brackets, after a slash, an underscore or a blank, or the whole of it.
const RecordUnit* unit_in(std::string_view head) {
  if (const RecordUnit* unit = find_unit(head)) return unit;
  for (const auto& [open, close] : {std::pair{'(', ')'}, std::pair{'[', ']'}, std::pair{'{', '}'}}) {
    const std::size_t from = head.rfind(open), to = head.rfind(close);
    if (from == std::string_view::npos || to == std::string_view::npos || to < from) continue;
    if (const RecordUnit* unit = find_unit(head.substr(from + 1, to - from - 1))) return unit;
  }
  for (std::size_t at = 1; at < head.size(); ++at)
    if (std::string_view("/_ ").find(head[at]) != std::string_view::npos)
      if (const RecordUnit* unit = find_unit(head.substr(at + 1))) return unit;
  return nullptr;
}

// --- Text -------------------------------------------------------------------------------------------------

// How a text is laid out. separator ' ': any number of blanks.
struct Layout {
  char separator, decimal;
  std::size_t cells = 0;  // in a row, without empty ones at its end
  std::vector<bool> has_numbers{};
};
constexpr std::array<std::string_view, 7> layouts{"\t.", "\t,", ";.", ";,", ",.", " .", " ,"};

std::string in_words(const Layout& layout) {
  const std::string_view between = layout.separator == '\t'  ? "tabs"
                                   : layout.separator == ';' ? "semicolons"
                                   : layout.separator == ',' ? "commas"
                                                             : "blanks";
  return filled("{} between cells{}", between, layout.decimal == ',' ? ", decimal commas" : "");
}

// Splits a line into its cells, without quotes and blanks about them, and without empty ones at its end.
void split(std::string_view line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  const bool by_blanks = separator == ' ';
  for (std::size_t at = 0; at <= line.size();) {
    if (by_blanks) at = std::min(line.find_first_not_of(blanks, at), line.size());
    const std::size_t begin = at, quote = line.find_first_not_of(by_blanks ? "" : " ", at);
    const bool is_quoted = quote < line.size() && line[quote] == '"';
    const std::size_t closed = is_quoted ? std::min(line.find('"', quote + 1), line.size()) : at;
    at = std::min(by_blanks ? line.find_first_of(blanks, closed) : line.find(separator, closed), line.size());
    cells.push_back(
        trimmed(is_quoted ? line.substr(quote + 1, closed - quote - 1) : line.substr(begin, at - begin)));
    ++at;
  }
  while (!cells.empty() && cells.back().empty()) cells.pop_back();
}

struct Stamp {
  std::optional<std::int64_t> day;  // from 1970-01-01 on
  double seconds = 0;
};
// Reads 2024-05-03T10:11:12.5, 03.05.2024 10:11:12,5, 5/3/2024 10:11:12, 10:11:12.5, or a day alone.
std::optional<Stamp> stamp_of(std::string_view text) {
  Stamp stamp;
  const std::size_t colon = text.find(':');
  const std::size_t gap = colon == std::string_view::npos ? text.size() : text.find_last_of(" T", colon);
  if (gap != std::string_view::npos) {
    const std::string_view date = trimmed(text.substr(0, gap));
    const std::size_t mark = date.find_first_of("-./");
    if (mark == std::string_view::npos) return std::nullopt;
    auto parts = numbers_of(date, date[mark], parse_number);
    if (!parts || parts->size() != 3) return std::nullopt;
    if ((*parts)[0] > 31)  // the year comes first
      std::swap((*parts)[0], (*parts)[2]);
    else if (date[mark] == '/')
      std::swap((*parts)[0], (*parts)[1]);
    const auto [day, month, year] = std::array{(*parts)[0], (*parts)[1], (*parts)[2]};
    if (!(day >= 1 && day <= 31 && month >= 1 && month <= 12 && year >= 0 && year <= 9999))
      return std::nullopt;
    const std::chrono::year_month_day civil{std::chrono::year(int(year)), std::chrono::month(unsigned(month)),
                                            std::chrono::day(unsigned(day))};
    if (!civil.ok()) return std::nullopt;
    stamp.day = std::chrono::sys_days(civil).time_since_epoch().count();
    if (colon == std::string_view::npos) return stamp;
    text.remove_prefix(gap + 1);
  }
  if (text.ends_with('Z')) text.remove_suffix(1);
  std::string clock(trimmed(text));
  std::ranges::replace(clock, ',', '.');
  const auto parts = numbers_of(clock, ':', parse_number);
  if (!parts || parts->size() < 2 || parts->size() > 3 || std::ranges::min(*parts) < 0 || (*parts)[1] >= 60)
    return std::nullopt;
  stamp.seconds = 3600 * (*parts)[0] + 60 * (*parts)[1] + (parts->size() == 3 ? (*parts)[2] : 0);
  return stamp;
}

enum class Kind { number, nothing, words };
struct Cell {
  Kind kind = Kind::words;
  double number = missing;
  std::optional<Stamp> stamp{};
  bool is_day_alone = false;
};
Cell cell_of(std::string_view text, char decimal) {
  if (text.empty()) return {Kind::nothing};
  if (decimal == '.') {
    if (const auto number = parse_number(text)) return {Kind::number, *number};
  } else if (text.find('.') == std::string_view::npos) {
    std::string with_point(text);
    std::ranges::replace(with_point, ',', '.');
    if (const auto number = parse_number(with_point)) return {Kind::number, *number};
  }
  if (text.size() > 40) return {};
  constexpr auto nothing =
      std::to_array<std::string_view>({"nan", "-nan", "inf", "-inf", "+inf", "-", "--", "---", "n/a", "na",
                                       "#n/a", "null", "none", "ovld", "overload", "over", "ol", "ovl"});
  if (std::ranges::find(nothing, std::string_view(in_lower_case(text))) != nothing.end())
    return {Kind::nothing};
  if (text.find_first_of(":-./") == std::string_view::npos) return {};
  if (const auto stamp = stamp_of(text))
    return {Kind::number, stamp->seconds, stamp, text.find(':') == std::string_view::npos};
  return {};
}

// Returns a text of UTF-8, UTF-16 with a byte order mark, or Latin 1 as UTF-8 without one.
std::string as_utf8(std::string_view bytes) {
  const bool little = bytes.starts_with("\xff\xfe"), big = bytes.starts_with("\xfe\xff");
  std::string text;
  const auto add = [&](std::uint32_t code) {
    if (code < 0x80) {
      text += char(code);
    } else if (code < 0x800) {
      text += {char(0xc0 | code >> 6), char(0x80 | (code & 0x3f))};
    } else {
      text += {char(0xe0 | code >> 12), char(0x80 | (code >> 6 & 0x3f)), char(0x80 | (code & 0x3f))};
    }
  };
  const auto byte = [&](std::size_t at) { return std::uint32_t(static_cast<unsigned char>(bytes[at])); };
  if (little || big) {
    for (std::size_t at = 2; at + 1 < bytes.size(); at += 2)
      add(little ? byte(at) | byte(at + 1) << 8 : byte(at) << 8 | byte(at + 1));
    return text;
  }
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  if (is_utf8(bytes)) return std::string(bytes);
  for (std::size_t at = 0; at < bytes.size(); ++at) add(byte(at));
  return text;
}
std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
  }
  return lines;
}
bool is_comment(std::string_view line, char separator) {
  line = trimmed(line, " \t\"");
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//") || line.starts_with('!') ||
         (line.starts_with(';') && separator != ';');
}

// Of all layouts the one in which most lines are rows of numbers without words. Absent if there is none.
std::optional<Layout> layout_of(const std::vector<std::string_view>& lines) {
  constexpr std::size_t most_looked_at = 2000;
  const std::size_t stride = lines.size() / most_looked_at + 1;
  std::optional<Layout> best;
  std::int64_t most = 0;
  std::vector<std::string_view> cells;
  for (const std::string_view each : layouts) {
    Layout layout{each[0], each[1]};
    struct Count {
      std::int64_t numbers = 0, words = 0, days = 0;
    };
    struct Rows {
      std::int64_t rows = 0;
      std::vector<Count> columns;
    };
    std::map<std::size_t, Rows> by_cells;
    for (std::size_t i = 0; i < lines.size(); i += stride) {
      if (is_comment(lines[i], layout.separator)) continue;
      split(lines[i], layout.separator, cells);
      std::vector<Cell> read(cells.size());
      std::ranges::transform(cells, read.begin(),
                             [&](std::string_view cell) { return cell_of(cell, layout.decimal); });
      if (std::ranges::find(read, Kind::number, &Cell::kind) == read.end()) continue;
      Rows& rows = by_cells[cells.size()];
      ++rows.rows;
      rows.columns.resize(cells.size());
      for (std::size_t j = 0; j < cells.size(); ++j) {
        rows.columns[j].numbers += read[j].kind == Kind::number;
        rows.columns[j].words += read[j].kind == Kind::words;
        rows.columns[j].days += read[j].is_day_alone;
      }
    }
    for (const auto& [count, rows] : by_cells) {
      layout.cells = count;
      layout.has_numbers.clear();
      std::int64_t good = 0;
      for (const Count& column : rows.columns) {
        layout.has_numbers.push_back(column.numbers > column.words);
        if (layout.has_numbers.back())
          good += 2 * column.days > rows.rows ? 0 : 1;  // with its time of day it is one time
        else
          good -= 2 * column.words > rows.rows;
      }
      if (good * rows.rows <= most) continue;
      most = good * rows.rows;
      best = layout;
    }
  }
  return best;
}
// A column of numbers with decimal commas looks like two of whole numbers: with a rate there is no time.
void read_as_decimals(const std::vector<std::string_view>& lines, Layout& layout) {
  if (layout.separator != ',' || layout.cells != 2) return;
  std::vector<std::string_view> cells;
  for (const std::string_view line : lines)
    if (line.find('.') != std::string_view::npos && cell_of(trimmed(line), ',').kind == Kind::words) {
      split(line, ',', cells);
      if (cells.size() == 2 && cell_of(cells[1], '.').kind == Kind::number) return;
    }
  layout = {';', ',', 1, {true}};
}

// Whether a line is a row of numbers; else, if `problem` is given, sets it to why not.
bool is_row(const Layout& layout, const std::vector<std::string_view>& cells,
            std::string* problem = nullptr) {
  const auto fails = [&](const std::string& what) {
    if (problem) *problem = what;
    return false;
  };
  if (cells.size() > layout.cells)
    return fails(filled("must have {} cells, got {}", layout.cells, cells.size()));
  bool any = false;
  for (std::size_t j = 0; j < cells.size(); ++j) {
    if (!layout.has_numbers[j]) continue;
    const Kind kind = cell_of(cells[j], layout.decimal).kind;
    if (kind == Kind::words)
      return fails(filled("column {} must have a number, or nothing where a sample is missing, got {}", j + 1,
                          in_quotes(cells[j])));
    any = any || kind == Kind::number;
  }
  return any || fails("must have a number");
}

// The heads of the columns.
struct Heads {
  std::vector<std::string> text;
  std::vector<const RecordUnit*> unit;  // of a row of units
  std::size_t first_line;
};
// Returns the heads that are in the last lines above the numbers.
Heads heads_above(const std::vector<std::string_view>& lines, std::size_t first, const Layout& layout) {
  Heads heads{std::vector<std::string>(layout.cells), std::vector<const RecordUnit*>(layout.cells), first};
  std::vector<std::string_view> cells;
  constexpr int most_lines = 4;
  int looked_at = 0;
  for (std::size_t i = first; i-- > 0 && looked_at < most_lines;) {
    std::string line(trimmed(lines[i]));
    if (is_comment(line, layout.separator)) line = trimmed(line, " \t#%/!;");
    if (line.find_first_not_of("-=+|_ \t") == std::string::npos) continue;  // empty, or a line drawn
    ++looked_at;
    if (layout.separator == ' ')
      for (const std::string_view unit : {"(", "["}) replace(line, " " + std::string(unit), unit);
    const std::array<char, 5> separators{layout.separator, ',', ';', '\t', ' '};
    const auto fits = [&](char separator) {
      split(line, separator, cells);
      return cells.size() == layout.cells;
    };
    // Some have heads for fewer columns, or for one of words.
    if (std::ranges::find_if(separators, fits) == separators.end()) {
      split(line, layout.separator, cells);
      if (cells.size() < 2 || layout.separator == ' ') continue;
      cells.resize(std::min(cells.size(), layout.cells));
    }
    const bool is_units = std::ranges::all_of(
        cells, [&](std::string_view cell) { return cell.empty() || cell == "-" || find_unit(cell); });
    for (std::size_t j = 0; j < cells.size(); ++j) {
      if (is_units) heads.unit[j] = find_unit(cells[j]);
      if (!is_units || looked_at == 1) heads.text[j] = cells[j];
    }
    heads.first_line = i;
    if (!is_units) break;
  }
  return heads;
}

RecordColumns columns_of_text(const std::string& name, std::string_view text, bool has_rate) {
  const std::vector<std::string_view> lines = lines_of(text);
  std::optional<Layout> layout = layout_of(lines);
  if (!layout) throw InputError(name, {{"", "must have rows of numbers, got none"}});
  if (has_rate) read_as_decimals(lines, *layout);
  // The rows of numbers begin and end with several in a row: a line of numbers among words above them is
  // none.
  constexpr std::size_t several = 8;
  std::vector<std::string_view> cells;
  std::size_t first = lines.size(), end = 0, in_a_row = 0, begin = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    split(lines[i], layout->separator, cells);
    if (cells.empty() || is_comment(lines[i], layout->separator)) continue;
    if (!is_row(*layout, cells)) {
      in_a_row = 0;
      continue;
    }
    if (++in_a_row == 1) begin = i;
    if (in_a_row < several) continue;
    first = std::min(first, begin);
    end = i + 1;
  }
  if (end == 0) first = begin, end = lines.size();

  RecordColumns columns;
  columns.all.resize(layout->cells);
  const Heads heads = heads_above(lines, first, *layout);
  for (std::size_t j = 0; j < layout->cells; ++j) {
    if (!layout->has_numbers[j]) continue;
    columns.all[j] = {heads.text[j], heads.unit[j] ? heads.unit[j] : unit_in(heads.text[j]), {}};
  }
  for (std::size_t i = 0; i < first; ++i) {  // what LabVIEW writes above its numbers
    split(lines[i], layout->separator, cells);
    if (cells.size() < 2) continue;
    if (cells[0] == "Delta_X")
      if (const Cell step = cell_of(cells[1], layout->decimal); step.number > 0)
        columns.rate = 1 / step.number;
    if (cells[0] != "Y_Unit_Label") continue;
    for (std::size_t j = 1; j < std::min(cells.size(), layout->cells); ++j)
      if (columns.all[j] && !columns.all[j]->unit) columns.all[j]->unit = find_unit(cells[j]);
  }

  RecordProblems problems;
  std::size_t comments = 0;
  std::vector<std::optional<std::int64_t>> first_day(layout->cells);
  for (std::size_t i = first; i < end; ++i) {
    if (is_comment(lines[i], layout->separator)) {
      ++comments;
      continue;
    }
    split(lines[i], layout->separator, cells);
    if (cells.empty()) continue;
    std::string problem;
    if (!is_row(*layout, cells, &problem)) {
      problems.add(filled("line {}", i + 1), problem);
      continue;
    }
    columns.lines.push_back(i + 1);
    for (std::size_t j = 0; j < layout->cells; ++j) {
      if (!columns.all[j]) continue;
      Cell cell = j < cells.size() ? cell_of(cells[j], layout->decimal) : Cell{Kind::nothing};
      if (cell.stamp) {
        columns.all[j]->has_stamps = true;
        if (cell.stamp->day) {
          if (!first_day[j]) first_day[j] = cell.stamp->day;
          cell.number += 86400 * double(*cell.stamp->day - *first_day[j]);
        }
      }
      columns.all[j]->values.push_back(cell.number);
    }
  }
  problems.throw_if_any(name);
  // A day and a time of day in columns of their own are one time.
  for (std::size_t j = 0; j + 1 < layout->cells; ++j) {
    if (!first_day[j] || !columns.all[j + 1] || !columns.all[j + 1]->has_stamps || first_day[j + 1]) continue;
    for (std::size_t i = 0; i < columns.lines.size(); ++i)
      columns.all[j + 1]->values[i] += columns.all[j]->values[i];
    columns.all[j].reset();
  }
  const auto written = [&](std::size_t from, std::size_t to) {
    return std::size_t(std::count_if(lines.begin() + std::ptrdiff_t(from), lines.begin() + std::ptrdiff_t(to),
                                     [](std::string_view line) { return !trimmed(line).empty(); }));
  };
  columns.read_as = in_words(*layout);
  if (layout->cells == 1) columns.read_as = layout->decimal == ',' ? "decimal commas" : "";
  const auto skipped = [&](std::size_t count, const std::string& where) {
    if (count == 0) return;
    if (!columns.read_as.empty()) columns.read_as += ", ";
    columns.read_as += filled("{} line{} {} left out", count, count == 1 ? "" : "s", where);
  };
  skipped(written(0, heads.first_line), "above");
  skipped(comments, "between");
  skipped(written(end, lines.size()), "below");
  return columns;
}

// --- Universal files --------------------------------------------------------------------------------------

bool is_universal_file(std::string_view text) {
  const std::size_t first = text.find_first_not_of("\r\n");
  const std::size_t end = std::min(text.find_first_of("\r\n", first), text.size());
  return first != std::string_view::npos && trimmed(text.substr(first, end - first)) == "-1";
}

RecordColumns columns_of_universal_file(const std::string& name, std::string_view text) {
  const std::vector<std::string_view> lines = lines_of(text);
  RecordColumns columns;
  const auto fail = [&](std::size_t line, const std::string& what) {
    RecordProblems problems;
    problems.add(filled("line {}", line + 1), what);
    problems.throw_if_any(name);
  };
  // The field of a line from a column on, of fixed width.
  const auto field = [&](std::size_t line, std::size_t from, std::size_t width) {
    return std::string(line < lines.size() && from < lines[line].size()
                           ? trimmed(lines[line].substr(from, width))
                           : std::string_view{});
  };
  const auto number = [&](std::size_t line, std::size_t from, std::size_t width) {
    std::string cell = field(line, from, width);
    std::ranges::replace(cell, 'D', 'E');  // Fortran's exponent
    const auto value = parse_number(cell);
    if (!value)
      fail(line,
           filled("must have a number in columns {} to {}, got {}", from + 1, from + width, in_quotes(cell)));
    return *value;
  };
  bool is_si = true;
  for (std::size_t at = 0; at < lines.size(); ++at) {
    if (trimmed(lines[at]) != "-1") continue;
    const std::string set = field(at + 1, 0, 7);
    if (set == "164") is_si = number(at + 2, 0, 10) == 1;
    if (set == "58b") fail(at + 1, "must be a data set 58 in text, got a binary one");
    if (set != "58") continue;
    const std::size_t head = at + 2, form = head + 6;
    const bool is_response = number(head + 5, 0, 5) == 1;
    const double type = number(form, 0, 10), spacing = number(form, 20, 10);
    if (!is_response || (type != 2 && type != 4) || number(form + 1, 0, 10) != 17) continue;
    const bool is_even = spacing == 1, is_double = type == 4;
    const double count = number(form, 10, 10), begin = is_even ? number(form, 30, 13) : 0,
                 step = is_even ? number(form, 43, 13) : 0;
    if (!(count >= 1 && count <= double(text.size()))) fail(form, "must have a number of values");
    const auto label = [&](std::size_t line, std::size_t from) { return field(line, from, 20); };
    constexpr std::array<std::pair<double, std::string_view>, 3> measures{
        {{8, "m"}, {11, "m/s"}, {12, "m/s2"}}};
    RecordColumn value;
    value.name = label(form + 2, 25);
    value.unit = find_unit(label(form + 2, 46));
    if (value.name.empty() || value.name == "NONE") value.name = field(head, 0, 80);
    // Without a name for it the unit is SI's, unless a data set 164 says that the file has others.
    if (!value.unit && is_si)
      for (const auto& [of, unit] : measures)
        if (of == number(form + 2, 0, 10)) value.unit = find_unit(unit);
    RecordColumn time;
    time.name = "time";
    time.unit = find_unit("s");
    // Of single numbers six stand in a row, of double ones four, or two pairs with a single one.
    const std::size_t row = !is_double ? 78 : is_even ? 80 : 66;
    std::size_t line = form + 5, place = 0;
    const auto next = [&](std::size_t width) {
      if (place >= row) ++line, place = 0;
      if (line >= lines.size() || trimmed(lines[line]) == "-1")
        fail(std::min(line, lines.size() - 1), filled("must have {} values before it", count));
      const double read = number(line, place, width);
      place += width;
      return read;
    };
    for (std::int64_t i = 0; i < std::int64_t(count); ++i) {
      time.values.push_back(is_even ? begin + double(i) * step : next(13));
      value.values.push_back(next(is_double ? 20 : 13));
    }
    columns.all.emplace_back(std::move(time));
    columns.all.emplace_back(std::move(value));
    at = line;
  }
  if (columns.all.empty())
    throw InputError(name, {{"", "must have a data set 58 with a real response over time, got none"}});
  columns.read_as = "universal file, data sets 58";
  return columns;
}

// --- Sound ------------------------------------------------------------------------------------------------

bool is_sound(std::string_view bytes) {
  return (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WAVE")) || bytes.starts_with("fLaC") ||
         bytes.starts_with("RF64") || bytes.starts_with("FORM");
}

#ifdef IMPACT_DAMPER_SNDFILE
RecordColumns columns_of_sound(const std::string& file) {
  SF_INFO info{};
  const std::unique_ptr<SNDFILE, int (*)(SNDFILE*)> sound(sf_open(file.c_str(), SFM_READ, &info), sf_close);
  if (!sound) throw InputError(file, {{"", filled("is no sound file: {}", sf_strerror(nullptr))}});
  const auto channels = std::size_t(info.channels);
  std::vector<double> samples(std::size_t(info.frames) * channels);
  if (sf_readf_double(sound.get(), samples.data(), info.frames) != info.frames)
    throw InputError(file, {{"", "ends before its last sample"}});
  RecordColumns columns;
  columns.rate = double(info.samplerate);
  columns.read_as = "sound";
  for (std::size_t j = 0; j < channels; ++j) {
    RecordColumn column{filled("channel {}", j + 1), find_unit("FS"), {}};
    for (std::size_t i = j; i < samples.size(); i += channels) column.values.push_back(samples[i]);
    columns.all.emplace_back(std::move(column));
  }
  return columns;
}
#else
RecordColumns columns_of_sound(const std::string& file) {
  throw InputError(file, {{"", "is a sound file, which this program was built without: libsndfile"}});
}
#endif

}  // namespace

const RecordUnit* find_unit(std::string_view text) {
  std::string plain = in_lower_case(trimmed(text, " \t()[]{}"));
  if (plain.empty() || plain.size() > 20) return nullptr;
  if (plain.ends_with("sec")) plain.resize(plain.size() - 2);
  for (const auto& [what, with] : {std::pair<std::string_view, std::string_view>{"_per_", "/"},
                                   {"²", "2"},
                                   {"µ", "u"},
                                   {"μ", "u"},
                                   {"⁻", "-"},
                                   {"**", ""},
                                   {"^", ""},
                                   {" ", ""},
                                   {"*", ""},
                                   {"·", ""},
                                   {"/sec", "/s"},
                                   {"/s/s", "/s2"},
                                   {"s-2", "/s2"}})
    replace(plain, what, with);
  const auto* const found = std::ranges::find_if(units, [&](const RecordUnit& unit) {
    return std::ranges::any_of(parts_of(unit.names, ' '),
                               [&](std::string_view name) { return in_lower_case(name) == plain; });
  });
  return found == units.end() ? nullptr : found;
}

RecordColumns columns_of(const std::string& name, std::string_view bytes, bool has_rate) {
  if (is_sound(bytes)) return columns_of_sound(name);
  if (bytes.starts_with("TDSm"))
    throw InputError(name,
                     {{"", "is a TDMS file, which is not read: export it as text, with a head and units"}});
  const std::string text = as_utf8(bytes);
  if (text.find('\0') != std::string::npos)
    throw InputError(name, {{"", "must be text, got bytes that are none"}});
  return is_universal_file(text) ? columns_of_universal_file(name, text)
                                 : columns_of_text(name, text, has_rate);
}

}  // namespace impact_damper
