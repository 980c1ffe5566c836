// The numbers that measures take (measures.hpp), by name: one name means the same in every measure.
#pragma once

#include <string_view>
#include <vector>

#include "impact_damper/base/text.hpp"

namespace impact_damper {

struct MeasureNumber {
  std::string_view name;
  NumberRange range;
  int multiple_of;  // 1: a whole number, 3 and 3.0 alike; 2: an even one; 0: any
  std::string_view meaning;

  bool allows(double value) const;
};
const std::vector<MeasureNumber>& measure_numbers();

// Throws std::logic_error if no number is called that.
const MeasureNumber& measure_number(std::string_view name);

}  // namespace impact_damper
