#include "impact_damper/engines/exact_dampers.hpp"
#include "observed.hpp"

namespace impact_damper {

Outcome observed_list(const Scene& scene, const Exact& options, TestObserver<long double>& observer) {
  return with_system<long double>(
      scene, [&](const auto& system) { return run_exact_dampers(system, scene, options, observer, {}); });
}

}  // namespace impact_damper
