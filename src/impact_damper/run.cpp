#include "impact_damper/run.hpp"

#include <numeric>

namespace impact_damper {

double EnergyBalance::impact_loss_total() const {
  return std::accumulate(impact_loss.begin(), impact_loss.end(), 0.0);
}

Budget budget_for(const Scene& scene, Budget budget) {
  if (!budget.max_time) {
    const bool is_fast = scene.force_amplitude != 0 && scene.force_frequency > 1;
    budget.max_time = 500'000 / (is_fast ? scene.force_frequency : 1);
  }
  return budget;
}

Outcome horizon_of(const Scene& scene, const Budget& budget) {
  const double latest = *budget_for(scene, budget).max_time;
  if (scene.until_time && *scene.until_time <= latest) return {StopReason::time, *scene.until_time};
  return {StopReason::time_budget, latest};
}

}  // namespace impact_damper
