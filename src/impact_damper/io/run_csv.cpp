// A section of a run as CSV: one table of columns of equal length.
#include <cmath>
#include <concepts>
#include <stdexcept>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/run_columns.hpp"
#include "impact_damper/io/run_file.hpp"

namespace impact_damper {
namespace {

class CsvTable {
 public:
  CsvTable(const std::optional<Scales>& scales, bool has_list) : scales_(scales), has_list_(has_list) {}

  // Makes the table of a section, unless there is one already. Energies are no table.
  template <class Section>
  void operator()(const RunColumnInfo&, const std::optional<Section>& section) {
    if constexpr (!std::same_as<Section, EnergyBalance>)
      if (section && lines_.empty()) add(*section, "");
  }
  std::string text() const {
    std::string all;
    for (const std::string& line : lines_) all += line + '\n';
    return all;
  }

 private:
  template <class Owner>
  void add(const Owner& owner, const std::string& of_damper) {
    for_each_column(owner, has_list_, [&](const RunColumnInfo& info, const auto& value) {
      if constexpr (PartsOfDampers<std::remove_cvref_t<decltype(value)>>) {
        for (std::size_t i = 0; i < value.size(); ++i) add(value[i], '_' + std::to_string(i + 1));
      } else {
        add_column(std::string(info.name) + of_damper, info.dimension, value);
      }
    });
  }
  template <typename Element>
  void add_column(const std::string& name, Dimension dimension, const std::vector<Element>& values) {
    const bool first = lines_.empty();
    if (first) lines_.resize(1 + values.size());
    if (!first) lines_[0] += ',';
    lines_[0].append(name).append(scales_ ? suffix_of(dimension) : "");
    const double scale = scales_ ? scales_->in_si(dimension) : 1;
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (!first) lines_[row + 1] += ',';
      append(lines_[row + 1], name, in_file(values[row]), scale);
    }
  }
  static void append(std::string& line, const std::string& name, double value, double scale) {
    if (!std::isfinite(value * scale))
      throw NumericalError("a number in \"" + name +
                           "\" of the run is not finite: " + number_text(value * scale));
    append_number(line, value * scale);
  }
  static void append(std::string& line, const std::string& name, const std::optional<double>& value,
                     double scale) {
    if (value) append(line, name, *value, scale);
  }
  static void append(std::string& line, const std::string&, std::int64_t value, double) {
    append_number(line, value);
  }

  const std::optional<Scales>& scales_;
  bool has_list_;
  std::vector<std::string> lines_;
};

}  // namespace

std::string run_csv(const Run& run, const std::optional<Scales>& scales) {
  CsvTable table(scales, has_list(run));
  for_each_column(run, has_list(run), table);
  std::string text = table.text();
  if (text.empty())
    throw std::invalid_argument(
        "record: one of half_cycles, impacts, contacts and history is needed for CSV");
  return text;
}

}  // namespace impact_damper
