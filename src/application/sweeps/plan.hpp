// A plan: which runs a sweep consists of, and what is kept of each. Run i of a plan is a function of the plan
// and i alone, so runs may be made in any order, by any number of threads and on any number of machines.
//
// Plans are JSON files, schema "impact-damper/plan/1"; docs/sweeps.md says what each key means:
//
//   {"schema": "impact-damper/plan/1", "scene": {"until_amplitude": 0.03},
//    "grid": [{"number": "mass_ratio", "from": 0.005, "to": 0.08, "count": 40, "scale": "logarithmic"}],
//    "quantities": ["time_to_amplitude=0.6", "impacts"]}
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "application/sweeps/kept_quantities.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {

class ObjectReader;  // json_reader.hpp
class JsonWriter;    // json_writer.hpp

// A number of the scene that may take other values: one of a dimensionless scene, or one of a scene in units,
// whose name and unit are those of its file. Names of several dampers end in the damper's number, from 1:
// clearance_2. Stops are not among them.
struct Variable {
  std::string name{};
  std::string_view unit{};          // "" without one, and in a dimensionless scene
  Dimension dimension{};            // a ratio in a dimensionless scene
  NumberRange range{};              // its valid values
  SceneNumber number{};             // of a dimensionless scene
  NumberInUnits number_in_units{};  // of one in units

  // Returns its value; absent where a scene in units leaves it out.
  std::optional<double> of(const SceneFile& scene) const;
  // Sets it in scene.scene or, of a scene in units, in scene.in_units, which alone is then up to date.
  void set(SceneFile& scene, double value) const;
};
std::vector<Variable> variables_of(const SceneFile& scene);

enum class Spacing { linear, logarithmic };

// A number that takes several values.
struct GridAxis {
  Variable variable;
  // `count` >= 1 values, both ends included, equally spaced or by equal ratios (M15.4); or, if there are any,
  // `values`.
  double from = 0, to = 0;
  std::int64_t count = 0;
  Spacing spacing = Spacing::linear;
  std::vector<double> values;

  std::int64_t size() const { return values.empty() ? count : std::int64_t(values.size()); }
  double value(std::int64_t i) const;  // 0 <= i < size()
};
inline constexpr std::int64_t most_axis_values = 1'000'000, most_listed_values = 10'000;

// A number that is drawn at random.
struct SampledNumber {
  enum class Law { between, uniform, normal };
  Variable variable;
  Law law = Law::between;
  double from = 0, to = 0;            // between: the ends
  Spacing spacing = Spacing::linear;  // between: uniform in the value, or in its logarithm
  // uniform: half width, normal: standard deviation, about the value that the scene or the grid gives the
  // number; a fraction of that value if `relative`.
  double width = 0;
  bool relative = false;
};

enum class SamplingMethod { random, latin_hypercube };

// Every point of the grid is given the same `count` draws, so that its neighbours are compared on equal
// terms.
struct Samples {
  std::int64_t count = 1;
  std::int64_t seed = 1;  // >= 0
  SamplingMethod method = SamplingMethod::random;
  std::vector<SampledNumber> numbers;
};

struct Plan {
  std::string description;
  SceneFile scene;  // with what does not vary
  Engine engine;
  std::vector<GridAxis> grid;  // all combinations; the last axis varies fastest
  std::optional<Samples> samples;
  std::vector<KeptQuantity> quantities;
  ForcedRules forced;
};

// Number of runs; most_runs + 1 if there are more than most_runs, which problems_of(plan) then reports.
std::int64_t runs_of(const Plan& plan);
inline constexpr std::int64_t most_runs = 1'000'000'000'000;

// The numbers that vary, in the order of their columns: those of the grid, then those that are drawn.
// A number that is both has two columns, the second of which ends in "_sampled".
std::vector<std::string> varied_names(const Plan& plan);

struct PlannedRun {
  std::vector<double> values;     // of the numbers that vary
  std::vector<Problem> problems;  // why the scene is not valid; then there is none
  Scene scene;
  std::optional<Scales> scales;  // of a scene in units
};
// Returns run i, 0 <= i < runs_of(plan).
PlannedRun run_of(const Plan& plan, std::int64_t i);
// Returns the run with these numbers of the grid, which need not be among its values, and without draws.
PlannedRun run_of(const Plan& plan, const std::vector<double>& grid);

// Returns what is kept of a run of the plan.
KeptNumbers kept_of(const Plan& plan, const PlannedRun& run);

// One row of the table, without its end of line, and its header. RFC 4180: the run's number, the numbers that
// vary, the quantities, "end" and "problem".
std::string header_of(const Plan& plan);
std::string row_of(const Plan& plan, std::int64_t i);

// Name, unit and meaning of each column.
struct PlanColumn {
  std::string name, unit, meaning;
};
std::vector<PlanColumn> columns_of(const Plan& plan);

// Rows [begin, end) of part 1 <= part <= parts.
struct RowRange {
  std::int64_t begin = 0, end = 0;
  std::int64_t size() const { return end - begin; }
};
RowRange rows_of_part(const Plan& plan, std::int64_t part, std::int64_t parts);
inline constexpr std::int64_t most_parts = 1'000'000;

// Returns a sentence about wall forces that the plan keeps and that are those of an assumed wall stiffness; ""
// where there are none, or the stiffness is given or varies.
std::string remark_on_walls(const Plan& plan);

// Returns the problems of a plan as a whole, whatever its origin.
std::vector<Problem> problems_of(const Plan& plan);

// Finds the place of a file that a plan names and that is not beside the plan.
using FindFile = std::function<std::optional<std::string>(const std::string& name)>;

// Reads a plan. Throws IoError if `file`, or the scene file that it names, cannot be read, InputError with a
// line for each of the first 50 problems in it.
Plan read_plan(const std::filesystem::path& file, const FindFile& find = {});
// Reads a plan, likewise, from a text that contains its scene.
Plan parse_plan(const std::string& name, const std::string& text);
// Returns the text of a file. It reads back as an equal plan, and equal plans give equal texts.
std::string plan_text(const Plan& plan);

// Read and write a plan that is the field "plan" of an object, on one line; the former collects the problems.
Plan read_plan_in(ObjectReader& object);
void write_plan(JsonWriter& out, const Plan& plan);

}  // namespace impact_damper
