// The columns of responses, one table for each kind of row, by which JSON is written and read and CSV is
// written; and JsonFields, which lets one function both write and read a record as JSON. The function names
// each field once:
//
//   void describe(JsonFields fields, SteadyRule& rule) {
//     fields.field("tolerance", rule.tolerance);
//     fields.field("max_periods", rule.max_periods, most_periods);
//   }
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/io/json_writer.hpp"
#include "impact_damper/responses/responses.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// Where a row has a number of a column; null if the number belongs to a part of the row that is absent, such
// as its period or means. An optional number may itself be absent. Integers and flags are whole numbers in a
// file.
using NumberCell = std::variant<double*, std::int64_t*, bool*, std::optional<double>*>;
std::optional<double> number_in(const NumberCell& cell);

enum class Scenes { all, of_one_damper, of_list, with_friction };
template <class Row>
struct RowColumn {
  std::string_view name;
  Dimension dimension;
  NumberRange range;  // of what a file may hold
  NumberCell (*cell_in)(Row&);
  Scenes scenes = Scenes::all;  // that have the column
};
template <class Row>
using RowColumns = std::vector<RowColumn<Row>>;
// The columns of steady states and orbits of this scene.
RowColumns<SteadyState> steady_columns(const Scene& scene);
RowColumns<OrbitPoint> orbit_columns(const Scene& scene);

// The part of a row that one damper of a list has.
struct DamperOfRow {
  ImpactCounts* impacts = nullptr;  // null where a budget ended the run
  PlaceInCavity* place = nullptr;
};
DamperOfRow damper_of(SteadyState& steady, std::size_t number);
DamperOfRow damper_of(OrbitPoint& point, std::size_t number);
template <class Row>
std::vector<DamperOfRow> dampers_of(std::vector<Row>& rows, std::size_t number) {
  std::vector<DamperOfRow> parts;
  parts.reserve(rows.size());
  for (Row& row : rows) parts.push_back(damper_of(row, number));
  return parts;
}
const RowColumns<DamperOfRow>& damper_columns();

// A column whose numbers follow from the scene and the axis.
struct Column {
  std::string_view name;
  Dimension dimension;
  std::vector<std::optional<double>> numbers;
};
// The amplitude without dampers and with their masses locked in, (M12.6), at each value of the axis. Absent
// at the resonance of an undamped oscillator, where it is infinite.
std::vector<Column> linear_columns(const Scene& scene, const Axis& axis);

// Refers to one writer or one reader, which must outlive it.
class JsonFields {
 public:
  using Layout = JsonWriter::Layout;
  using Describe = std::function<void(JsonFields)>;
  struct Object {
    std::string_view name;
    Describe describe;
    Layout layout = Layout::one_line;
  };

  explicit JsonFields(JsonWriter& out) : out_(&out) {}
  // may_be_missing: whether a key of this object that field() does not find keeps its default. Otherwise it
  // is a problem.
  explicit JsonFields(ObjectReader& in, bool may_be_missing = false)
      : in_(&in), may_be_missing_(may_be_missing) {}
  bool reads() const { return in_ != nullptr; }

  // Writes or reads a value, an enumerator by its name, or an array. `allowed` is for reading: a range or
  // enumerators, as ObjectReader::optional has them. False if the field was read and has no valid value.
  template <class Value, class... Allowed>
  bool field(std::string_view name, Value& value, const Allowed&... allowed) {
    if (in_) return (may_be_missing_ || in_->require(name)) && in_->optional(name, value, allowed...);
    out_->field(name, value);
    return true;
  }

  // Writes `word`, or returns the index in `words` of the word that is read; absent when writing and if it is
  // missing or unknown.
  std::optional<std::size_t> word(std::string_view name, std::string_view word,
                                  const std::vector<std::string_view>& words) {
    if (in_) return in_->require(name) ? in_->word(name, words) : std::nullopt;
    out_->field(name, word);
    return std::nullopt;
  }
  // Writes an array of words, or appends those that are read. False as for field(); then no other field
  // counts as unknown, for what the others are depends on the words.
  bool words(std::string_view name, std::vector<std::string_view>& given,
             const std::vector<std::string_view>& words) {
    std::vector<std::size_t> indices;
    if (!in_) {
      out_->field(name, given);
    } else if (!in_->require(name) || !in_->words(name, words, indices)) {
      in_->keys();
      return false;
    }
    for (const std::size_t index : indices) given.push_back(words[index]);
    return true;
  }

  // Writes or reads an index >= 0; null stands for an absent one.
  void index(std::string_view name, std::optional<std::int64_t>& index) {
    std::optional<double> number;
    if (index) number = double(*index);
    if (!field(name, number) || !in_ || !number) return;
    if (!(*number >= 0 && *number == std::floor(*number)))
      reject(name, "must be null or an index >= 0, got " + number_text(*number));
    if (*number >= 0 && *number < 1e15) index = std::int64_t(*number);
  }

  // Writes numbers that follow from other fields. Those that are read must be equal; they are not looked at
  // if the others are not valid.
  void derived(std::string_view name, const std::vector<std::optional<double>>& numbers, bool are_valid) {
    if (!in_) return out_->field(name, numbers);
    std::vector<std::optional<double>> given;
    if (!are_valid) in_->has(name);
    if (!are_valid || !field(name, given)) return;
    if (given.size() != numbers.size())
      return reject(name, "must hold " + std::to_string(numbers.size()) + " numbers, got " +
                              std::to_string(given.size()));
    const auto text_of = [](const std::optional<double>& number) {
      return number ? number_text(*number) : std::string("null");
    };
    const auto [wrong, wanted] = std::mismatch(given.begin(), given.end(), numbers.begin());
    if (wrong != given.end())
      in_->reject(name, std::size_t(wrong - given.begin()),
                  "must be " + text_of(*wanted) + ", got " + text_of(*wrong));
  }

  // Whether a field that may be left out is there: when reading, in the object; when writing, `is_written`.
  bool has(std::string_view name, bool is_written) { return in_ ? in_->has(name) : is_written; }

  // Writes or reads objects. All are looked for before the first is read, so that missing ones are reported
  // first.
  void objects(const std::vector<Object>& objects) {
    std::vector<ObjectReader> readers;
    for (const Object& each : objects)
      if (in_) readers.push_back(in_->required_object(each.name));
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (!in_) out_->open_object(objects[i].name, objects[i].layout);
      describe_element(readers, i, objects[i].describe);
    }
  }
  void object(std::string_view name, Layout layout, const Describe& describe) {
    objects({{name, describe, layout}});
  }

  // Writes or reads an array of records, at most `most` when reading; `layout` is that of each record.
  template <class Record, class Describes>
  void array(std::string_view name, std::vector<Record>& records, std::size_t most, Layout layout,
             const Describes& describe) {
    std::vector<ObjectReader> readers;
    if (in_) {
      readers = in_->required_objects(name, most);
      records.resize(readers.size());
    }
    elements(name, Layout::lines, layout, readers, records.size(),
             [&](JsonFields its, std::size_t i) { describe(its, records[i]); });
  }

  // Writes or reads the array "dampers" of so many dampers; for 0 there is none. False if fewer were read;
  // more are reported.
  bool dampers(std::size_t dampers, Layout layout,
               const std::function<void(JsonFields its, std::size_t number)>& describe) {
    constexpr std::string_view name = "dampers";
    if (dampers == 0) return true;
    std::vector<ObjectReader> readers;
    if (in_) readers = in_->required_objects(name, most_dampers);
    if (in_ && readers.size() != dampers)
      reject(name, "must be as many as in the scene, " + std::to_string(dampers) + ", got " +
                       std::to_string(readers.size()));
    const std::size_t count = in_ ? std::min(dampers, readers.size()) : dampers;
    elements(name, layout, layout, readers, count, describe);
    return count == dampers;
  }

  // Writes or reads arrays with a number for each row. Before it is read a row has all optional parts that it
  // will have: null is expected for those that it has not.
  template <class Row>
  void columns(const RowColumns<Row>& table, std::vector<Row>& rows) {
    for (const RowColumn<Row>& each : table) {
      std::vector<NumberCell> cells(rows.size());
      std::ranges::transform(rows, cells.begin(), each.cell_in);
      column(each.name, each.range, cells);
    }
  }
  template <class Row>
  void columns_of_dampers(std::size_t count, std::vector<Row>& rows) {
    dampers(count, Layout::lines, [&](JsonFields its, std::size_t number) {
      std::vector<DamperOfRow> parts = dampers_of(rows, number);
      its.columns(damper_columns(), parts);
    });
  }

  // Report problems of what is read. Nothing happens when writing.
  void reject(std::string_view field, const std::string& what) { reject({{std::string(field), what}}); }
  void reject(const std::vector<Problem>& problems) {
    for (const Problem& problem : problems)
      if (in_) in_->reject(problem);
  }

 private:
  // The object that is open for writing, or the i-th of the readers.
  void describe_element(std::vector<ObjectReader>& readers, std::size_t i, const Describe& describe) {
    if (in_) return describe(JsonFields(readers[i]));
    describe(*this);
    out_->close();
  }
  void elements(std::string_view name, Layout of_array, Layout of_each, std::vector<ObjectReader>& readers,
                std::size_t count, const std::function<void(JsonFields, std::size_t)>& describe) {
    if (!in_) out_->open_array(name, of_array);
    for (std::size_t i = 0; i < count; ++i) {
      if (!in_) out_->open_object(of_each);
      describe_element(readers, i, [&](JsonFields its) { describe(its, i); });
    }
    if (!in_) out_->close();
  }
  void column(std::string_view name, const NumberRange& range, const std::vector<NumberCell>& cells) {
    std::vector<std::optional<double>> numbers;
    if (!in_) std::ranges::transform(cells, std::back_inserter(numbers), number_in);
    if (!field(name, numbers, range) || !in_) return;
    if (numbers.size() != cells.size())
      return reject(name, "must be as long as the first column, " + std::to_string(cells.size()) +
                              ", got a length of " + std::to_string(numbers.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::optional<double>& number = numbers[i];
      const NumberCell& cell = cells[i];
      const bool may_be_absent = std::holds_alternative<std::optional<double>*>(cell),
                 is_wanted = number_in(cell).has_value(),
                 is_whole =
                     std::holds_alternative<std::int64_t*>(cell) || std::holds_alternative<bool*>(cell);
      if (!may_be_absent && number.has_value() != is_wanted)
        return in_->reject(name, i,
                           is_wanted ? "must be a number, got null"
                                     : "must be null, got " + number_text(*number) + ": there is none");
      if (!number) continue;
      if (is_whole && *number != std::floor(*number))
        return in_->reject(name, i, "must be a whole number, got " + number_text(*number));
      std::visit([&](auto* its) { *its = std::remove_pointer_t<decltype(its)>(*number); }, cell);
    }
  }

  JsonWriter* out_ = nullptr;  // this or the next one is null
  ObjectReader* in_ = nullptr;
  bool may_be_missing_ = false;
};

// The records that responses, the catalogue and plans share. Axis and range: false if there are problems.
void describe(JsonFields fields, SceneState& state, const Scene& scene);
bool describe(JsonFields fields, Axis& axis, const Scene& scene);
bool describe(JsonFields fields, ParameterRange& range);
void describe(JsonFields fields, SteadyRule& rule);
void describe(JsonFields fields, BasinRule& rule);
void describe(JsonFields fields, BranchRule& rule);

}  // namespace impact_damper
