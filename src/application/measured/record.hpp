// A measured free decay as a CSV file (RFC 4180): a header that names two columns with their units, then a
// row for each sample, in the order of time,
//
//   t_s,x_mm
//   0.000,59.82
//   0.005,59.61
//
// Time is t_s or t_ms. The other column is the displacement of the primary mass, x_m, x_mm or x_um, or its
// acceleration, a_m_per_s2, a_mm_per_s2 or a_g. An empty second cell is a sample that is missing.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/text.hpp"

namespace impact_damper {

enum class MeasuredQuantity { displacement, acceleration };
std::string_view unit_of(MeasuredQuantity quantity);  // "mm", "mm/s^2"

struct MeasuredRecord {
  MeasuredQuantity quantity = MeasuredQuantity::displacement;
  std::vector<double> time;      // s, strictly ascending
  std::vector<double> value;     // mm or mm/s^2
  std::int64_t empty_cells = 0;  // rows without a value, which are left out of the columns
};

inline constexpr FileKind measured_kind{"measured record", std::size_t{1} << 26};
inline constexpr std::size_t least_samples = 64;

// Throws IoError if `file` cannot be read, InputError, with a line for each of the first problems, if it is
// not as above or has fewer than `least_samples` values. These lines begin with the name of the file, or
// `name`.
MeasuredRecord read_measured_record(const std::filesystem::path& file);
MeasuredRecord parse_measured_record(const std::string& name, std::string_view text);

}  // namespace impact_damper
