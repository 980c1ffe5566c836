// A run with its variation (variation.hpp), by either closed-form engine.
#pragma once

#include <optional>
#include <vector>

#include "impact_damper/engine.hpp"
#include "impact_damper/steady/poincare_map.hpp"
#include "impact_damper/steady/saltation.hpp"

namespace impact_damper {

// Is given the steps of a variation in their order; what they mean: Variation.
class VariationReceiver {
 public:
  // with_parameters: whether what changes of omega_f and f0 add is worked out, too.
  explicit VariationReceiver(bool with_parameters) : with_parameters_(with_parameters) {}
  virtual ~VariationReceiver() = default;

  template <class ByParameters>
  void step(const RowsOfState<double, 4>& a, ByParameters&& by_parameters) {
    take(a, with_parameters_ ? by_parameters() : RowsOfState<double, 2>{});
  }
  virtual void joined() = 0;
  virtual int pieces(double loss) = 0;

 private:
  virtual void take(const RowsOfState<double, 4>& a, const RowsOfState<double, 2>& added) = 0;

  bool with_parameters_;
};

// What else is kept of the run.
struct VariedRun {
  StopReason stop_reason = StopReason::time;
  State<double> end{};
  StateVector rates_at_end{};  // x', x'', y', y''
  // If impacts are watched.
  std::vector<OrbitImpact> impacts;
  std::vector<std::size_t> impacts_before_sticking;  // how many, each time that the secondary mass sticks
  std::optional<double> nearest_miss;  // least distance from a wall at which y turns back in flight
};
enum class Watched { end, impacts };
// The scene is valid, has a force and an until_time; the engine is exact or restitution.
VariedRun run_with_variation(const Scene& scene, const Engine& engine, VariationReceiver& receiver,
                             Watched watched);

}  // namespace impact_damper
