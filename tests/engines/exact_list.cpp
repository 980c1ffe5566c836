#include "impact_damper/engines/exact_dampers.hpp"
#include "observed.hpp"

namespace impact_damper {

Outcome observed_list(const Scene& scene, const Exact& options, TestObserver<long double>& observer) {
  return run_exact_dampers<long double>(checked(scene, options), observer);
}

}  // namespace impact_damper
