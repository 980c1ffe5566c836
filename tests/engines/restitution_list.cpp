#include "impact_damper/engines/restitution_dampers.hpp"
#include "observed.hpp"

namespace impact_damper {

Outcome observed_list(const Scene& scene, const Restitution& options, TestObserver<long double>& observer) {
  return with_system<long double>(
      scene, [&](const auto& system) { return run_restitution_dampers(system, scene, options, observer); });
}

}  // namespace impact_damper
