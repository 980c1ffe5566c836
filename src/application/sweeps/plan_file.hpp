// Plans as JSON files, schema "impact-damper/plan/1":
//
//   {"schema": "impact-damper/plan/1", "scene": {"until_amplitude": 0.03},
//    "grid": [{"number": "mass_ratio", "from": 0.005, "to": 0.08, "count": 40, "scale": "logarithmic"}],
//    "quantities": ["time_to_amplitude=0.6", "impacts"]}
//
// docs/sweeps.md says what each key means.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "application/sweeps/plan.hpp"

namespace impact_damper {

class ObjectReader;  // json_reader.hpp
class JsonWriter;    // json_writer.hpp

inline constexpr std::string_view plan_schema = "impact-damper/plan/1";
inline constexpr FileKind plan_kind{"plan", 1 << 20};

// Finds the place of a file that a plan names and that is not beside the plan.
using FindFile = std::function<std::optional<std::string>(const std::string& name)>;

// Reads a plan. Throws IoError if `file`, or the scene file that it names, cannot be read, InputError with a
// line for each of the first 50 problems in it.
Plan read_plan(const std::filesystem::path& file, const FindFile& find = {});
// Reads a plan, likewise, from a text that contains its scene.
Plan parse_plan(const std::string& name, const std::string& text);

// Reads a plan from an object that may belong to a larger document and collects the problems. A scene file
// that it names is looked for in `folder`, then by `find`.
Plan read_plan_object(ObjectReader& object, const std::filesystem::path& folder = {},
                      const FindFile& find = {});
// Writes the fields of a plan on one line. They read back as an equal plan, and equal plans give equal text.
void write_plan_fields(JsonWriter& out, const Plan& plan);

// Returns the problems of a plan as a whole, whatever its origin.
std::vector<Problem> problems_of(const Plan& plan);

}  // namespace impact_damper
