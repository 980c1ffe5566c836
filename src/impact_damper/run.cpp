#include "impact_damper/run.hpp"

namespace impact_damper {

std::string_view name_of(StopReason reason) {
  switch (reason) {
    case StopReason::time:
      return "time";
    case StopReason::amplitude:
      return "amplitude";
    case StopReason::impact_budget:
      return "impact_budget";
    case StopReason::half_cycle_budget:
      return "half_cycle_budget";
    case StopReason::time_budget:
      return "time_budget";
    case StopReason::step_budget:
      return "step_budget";
  }
  return {};
}

}  // namespace impact_damper
