// A section of a run as CSV: one table of columns of equal length.
#include <cmath>
#include <stdexcept>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/run_file.hpp"

namespace impact_damper {
namespace {

// Quantity of a column: its suffix in SI, and the unit it is multiplied by.
struct Quantity {
  std::string_view suffix;
  double SiUnits::*unit;  // null: a count or an angle, the same in SI
};
constexpr Quantity time{"_s", &SiUnits::time}, length{"_m", &SiUnits::length},
    velocity{"_m_per_s", &SiUnits::velocity}, number{"", nullptr};

class CsvTable {
 public:
  explicit CsvTable(const std::optional<SiUnits>& units) : units_(units) {}

  template <typename Element>
  void column(std::string_view name, const std::vector<Element>& values, const Quantity& quantity) {
    const bool first = lines_.empty();
    if (first) lines_.resize(1 + values.size());
    append(lines_[0], name);
    if (units_) lines_[0] += quantity.suffix;
    const double scale = units_ && quantity.unit ? *units_.*quantity.unit : 1;
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (!first) lines_[row + 1] += ',';
      append(lines_[row + 1], name, values[row], scale);
    }
  }
  std::string text() const {
    std::string all;
    for (const std::string& line : lines_) all += line + '\n';
    return all;
  }

 private:
  static void append(std::string& line, std::string_view name) {
    if (!line.empty()) line += ',';
    line += name;
  }
  static void append(std::string& line, std::string_view name, double value, double scale) {
    if (!std::isfinite(value * scale))
      throw NumericalError("the run went astray: a number in its \"" + std::string(name) + "\" is " +
                           number_text(value * scale));
    append_number(line, value * scale);
  }
  static void append(std::string& line, std::string_view name, const std::optional<double>& value,
                     double scale) {
    if (value) append(line, name, *value, scale);
  }
  static void append(std::string& line, std::string_view, std::int64_t value, double) {
    append_number(line, value);
  }
  static void append(std::string& line, std::string_view, std::int32_t damper, double) {
    const std::int64_t from_one = std::int64_t{damper} + 1;
    append_number(line, from_one);
  }
  static void append(std::string& line, std::string_view, Wall wall, double) {
    line += wall == Wall::left ? '0' : '1';
  }

  const std::optional<SiUnits>& units_;
  std::vector<std::string> lines_;
};

}  // namespace

std::string run_csv(const Run& run, const std::optional<SiUnits>& units) {
  CsvTable table(units);
  const bool several = !run.scene.dampers.empty();
  std::int64_t damper = 0;
  const auto of_next = [&](const std::string& name) { return name + std::to_string(++damper); };
  if (run.half_cycles) {
    table.column("zero_crossing", run.half_cycles->zero_crossing, time);
    table.column("peak_time", run.half_cycles->peak_time, time);
    table.column("amplitude", run.half_cycles->amplitude, length);
    table.column("impacts", run.half_cycles->impacts, number);
    for (const std::vector<std::int64_t>& impacts : run.half_cycles->impacts_by_damper)
      table.column(of_next("impacts_"), impacts, number);
  } else if (run.impacts) {
    table.column("time", run.impacts->time, time);
    table.column("wall", run.impacts->wall, number);
    table.column("relative_velocity", run.impacts->relative_velocity, velocity);
    table.column("phase_deg", run.impacts->phase_deg, number);
    table.column("amplitude", run.impacts->amplitude, length);
    table.column("displacement", run.impacts->displacement, length);
    if (several) table.column("damper", run.impacts->damper, number);
  } else if (run.contacts) {
    table.column("begin", run.contacts->begin, time);
    table.column("end", run.contacts->end, time);
    table.column("wall", run.contacts->wall, number);
    if (several) table.column("damper", run.contacts->damper, number);
  } else if (run.history) {
    table.column("time", run.history->time, time);
    table.column("x", run.history->x, length);
    table.column("v", run.history->v, velocity);
    if (!several) {
      table.column("y", run.history->y, length);
      table.column("w", run.history->w, velocity);
    }
    for (const History::Damper& its : run.history->dampers) {
      const std::string number_of_damper = of_next("_");
      table.column("y" + number_of_damper, its.y, length);
      table.column("w" + number_of_damper, its.w, velocity);
    }
  } else {
    throw std::invalid_argument(
        "record: one of half_cycles, impacts, contacts and history is needed for CSV");
  }
  return table.text();
}

}  // namespace impact_damper
