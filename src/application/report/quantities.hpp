// Numbers as a page shows them: rounded for reading, with all digits in <data value="...">, and in kilograms,
// millimetres and seconds as well where the scene was given so.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/units.hpp"

namespace impact_damper {

// Returns text for HTML, safe in attributes too.
std::string escaped(std::string_view text);

// Returns "1.23 × 10<sup>6</sup>" in <data>, with `digits` significant digits.
std::string number_html(double value, int digits = 3);
std::string count_html(std::int64_t count);
std::string percent_html(double part);  // of 1: "12.3 %"
// Returns the text that a reader sees: equal for numbers that differ in digits not shown.
std::string without_tags(const std::string& html);

class Quantities {
 public:
  explicit Quantities(const std::optional<Scales>& scales) : scales_(scales) {}

  bool in_units() const { return scales_.has_value(); }

  // Return a dimensionless number as text. In units these come first, the dimensionless number in brackets:
  std::string length(double value) const;  // "60 mm (6 ε)", or "6 ε"; below 0.1 mm "4.94 µm (0.0236 ε)"
  std::string time(double value) const;    // "12.3 s (39.2 periods)", or "39.2 periods (t = 246)"
  std::string velocity(double value) const {  // "0.05 m/s (0.25 εΩ)"
    return both(value, scale(Dimension::velocity) / 1000, "m/s", "εΩ");
  }
  std::string force(double value) const { return both(value, scale(Dimension::force), "N", "Kε"); }
  std::string energy(double value) const { return both(value, scale(Dimension::energy), "J", "Kε²"); }
  std::string frequency(double value) const {  // with four digits: resonances are narrow
    return both(value, scale(Dimension::frequency), "Hz", "Ω", 4);
  }
  std::string duration(double value) const {  // of a contact: "0.32 ms (0.0064 /Ω)"
    return both(value, 1000 * scale(Dimension::time), "ms", "/Ω");
  }

 private:
  std::string both(double value, double scale, std::string_view unit, std::string_view by,
                   int digits = 3) const;
  double scale(Dimension dimension) const { return scale_of(dimension, scales_); }
  std::optional<Scales> scales_;
};

std::string paragraph_html(const std::string& text);

// A table with a caption; the first column heads its rows. Cells are HTML.
struct HtmlTable {
  std::string caption;
  std::vector<std::string> heads;
  std::vector<std::vector<std::string>> rows = {};
};
std::string table_html(const HtmlTable& table);

}  // namespace impact_damper
