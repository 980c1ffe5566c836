#include <algorithm>
#include <iterator>
#include <utility>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/responses/response_columns.hpp"
#include "impact_damper/responses/response_file.hpp"

namespace impact_damper {
namespace {

using Words = std::vector<std::string>;
using Numbers = std::vector<std::optional<double>>;

// A table, column by column. The first column has all rows; a shorter one is repeated.
class CsvTable {
 public:
  explicit CsvTable(const std::optional<Scales>& scales) : scales_(scales) {}

  void add(const std::string& name, Words words) { columns_.push_back({name, std::move(words), {}}); }
  void add(const std::string& name, Dimension dimension, Numbers numbers) {
    for (std::optional<double>& number : numbers)
      if (number && scales_) number = *number * scales_->in_si(dimension);
    columns_.push_back({name + std::string(scales_ ? suffix_of(dimension) : ""), {}, std::move(numbers)});
  }
  template <class Row>
  void add(const RowColumns<Row>& columns, std::vector<Row> rows, const std::string& after_name = {}) {
    for (const RowColumn<Row>& each : columns) {
      Numbers numbers;
      for (Row& row : rows) numbers.push_back(number_in(each.cell_in(row)));
      add(std::string(each.name) + after_name, each.dimension, std::move(numbers));
    }
  }
  // The columns of each damper of a list.
  template <class Row>
  void add_dampers(std::size_t dampers, std::vector<Row>& rows) {
    for (std::size_t d = 0; d < dampers; ++d)
      add(damper_columns(), dampers_of(rows, d), '_' + std::to_string(d + 1));
  }
  std::string text() const {
    std::string text;
    for (const CsvColumn& each : columns_) (text += each.heading) += ',';
    for (std::size_t i = 0; i < columns_[0].size(); ++i) {
      text.back() = '\n';
      for (const CsvColumn& each : columns_) {
        if (!each.words.empty())
          text += each.words[i % each.size()];
        else if (const auto& number = each.numbers[i % each.size()])
          append_number(text, *number);
        text += ',';
      }
    }
    text.back() = '\n';
    return text;
  }

 private:
  struct CsvColumn {
    std::string heading;
    Words words;
    Numbers numbers;  // where there are no words
    std::size_t size() const { return words.empty() ? numbers.size() : words.size(); }
  };
  const std::optional<Scales>& scales_;
  std::vector<CsvColumn> columns_;
};

Numbers numbers_of(const std::vector<double>& values) { return {values.begin(), values.end()}; }

void add(CsvTable& table, const SweepResponse& response) {
  Words numbers, ways, ends;
  std::vector<SteadyState> states;
  for (std::size_t n = 0; n < response.sweeps.size(); ++n) {
    const Sweep& sweep = response.sweeps[n];
    for (const auto& [name, way] : {std::pair("up", &sweep.up), std::pair("down", &sweep.down)}) {
      for (const SteadyState& each : *way) {
        numbers.push_back(std::to_string(n));
        ways.emplace_back(name);
        ends.emplace_back(end_of(each));
        states.push_back(each);
      }
    }
  }
  const Axis& axis = response.axis;
  const std::size_t dampers = listed_dampers(response.scene);
  table.add("sweep", numbers);
  table.add("way", ways);
  table.add(name_of(axis.number), field_of(axis.number).dimension, numbers_of(axis.values()));
  table.add("end", ends);
  table.add(steady_columns(dampers), states);
  table.add_dampers(dampers, states);
  for (const Column& column : linear_columns(response.scene, axis))
    table.add(std::string(column.name), column.dimension, column.numbers);
}

void add(CsvTable& table, const BasinResponse& response) {
  const Axis &first = response.first, &second = response.second;
  const std::vector<std::int32_t>& attractor = response.basin.attractor;
  Numbers of_first, of_second;
  Words attractors;
  for (std::size_t n = 0; n < attractor.size(); ++n) {
    of_first.emplace_back(first.value(std::int64_t(n) % first.count));
    of_second.emplace_back(second.value(std::int64_t(n) / first.count));
    attractors.push_back(std::to_string(attractor[n]));
  }
  table.add(name_of(first.number), field_of(first.number).dimension, of_first);
  table.add(name_of(second.number), field_of(second.number).dimension, of_second);
  table.add("attractor", attractors);
}

void add(CsvTable& table, const OrbitsResponse& response) {
  Words numbers, events;
  Numbers values;
  std::vector<OrbitPoint> points;
  for (std::size_t n = 0; n < response.branches.size(); ++n) {
    const OrbitBranch& branch = response.branches[n];
    const auto add_row = [&](std::string_view event, const OrbitPoint& point) {
      numbers.push_back(std::to_string(n));
      events.emplace_back(event);
      values.emplace_back(point.value);
      points.push_back(point);
    };
    for (std::size_t i = 0; i <= branch.points.size(); ++i) {
      for (const OrbitEvent& event : branch.events)
        if (event.points_before == std::int64_t(i)) add_row(name_of(event.kind), event);
      if (i < branch.points.size()) add_row("", branch.points[i]);
    }
  }
  const Parameter parameter = response.range.parameter;
  const std::size_t dampers = listed_dampers(response.scene);
  table.add("branch", numbers);
  table.add("event", events);
  table.add(std::string(name_of(parameter)), field_of(member_of(parameter)).dimension, values);
  table.add(orbit_columns(dampers), points);
  table.add_dampers(dampers, points);
}

void add(CsvTable& table, const LyapunovResponse& response) {
  const LyapunovExponents& found = response.found;
  Numbers errors = numbers_of(found.standard_errors);
  errors.resize(found.exponents.size());  // there are none for less than ten periods
  table.add("exponent", Dimension::rate, numbers_of(found.exponents));
  table.add("standard_error", Dimension::rate, errors);
}

}  // namespace

std::string response_csv(const Response& response, const std::optional<Scales>& scales) {
  CsvTable table(scales);
  std::visit([&](const auto& each) { add(table, each); }, response);
  return table.text();
}

}  // namespace impact_damper
