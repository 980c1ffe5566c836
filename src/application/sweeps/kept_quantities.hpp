// What may be kept of a run, as one table: name, unit, meaning and how it is found. Plans, the command line,
// its help and the headers of tables all go through it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/steady/steady_state.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// Frequencies of the force, equally spaced, both ends included; in the scene's unit.
struct FrequencyRange {
  double from = 0, to = 0;
  std::int64_t count = 2;
};
// How motions under a force are followed.
struct ForcedRules {
  SteadyRule steady;
  std::optional<FrequencyRange> frequencies;  // for the worst one
  std::int64_t lyapunov_periods = 5000, lyapunov_discard = 500;
};

// A run from the release to a stop of the scene; the steady motion after it; steady motions over frequencies;
// the rates at which small changes grow.
enum class Experiment { run, steady, worst, lyapunov };

// Which values of a quantity are better.
enum class Better { least, greatest };

class RunFindings;  // of one run, in kept_quantities.cpp

struct Quantity {
  std::string_view name;
  Dimension dimension;
  std::string_view meaning;
  Experiment experiment = Experiment::run;
  // Kind of the number that it is asked at, a length or a pure number, > 0. Absent: nothing.
  std::optional<Dimension> at{};
  std::optional<Better> better{};              // absent: it is neither good nor bad by itself
  bool of_impacts = false, of_energy = false;  // what the run must record beside half cycles
  // Dimensionless. Absent where there is none.
  std::optional<double> (*value)(RunFindings& findings, double at) = nullptr;
};
std::span<const Quantity> all_quantities();

struct KeptQuantity {
  const Quantity* quantity = nullptr;
  std::optional<double> at;  // in the scene's unit

  std::string text() const;    // "time_to_amplitude=0.6", as plans and the command line give it
  std::string column() const;  // "time_to_amplitude_0.6"
};
// The quantity that `text` names, or the problem with it: "must be ..., got ...".
struct QuantityReading {
  std::optional<KeptQuantity> kept;
  std::string problem;
};
QuantityReading read_quantity(std::string_view text);

// What is kept of one scene, the quantities in their order.
struct KeptNumbers {
  std::vector<std::optional<double>> numbers;  // in the scene's units
  // "done", or what ended the first of the runs that ended early: a budget of the engine (StopReason),
  // "not_steady" (neither periodic nor in balance: M12.9), "not_valid" or "failed".
  std::string_view end = "done";
  std::string problem;  // of the latter two
};
// Returns none of `count` numbers, and why, for a scene with problems.
KeptNumbers none_kept(std::size_t count, const std::vector<Problem>& problems);
KeptNumbers kept_of(const Scene& scene, const std::optional<Scales>& scales, const Engine& engine,
                    std::span<const KeptQuantity> kept, const ForcedRules& rules);

}  // namespace impact_damper
