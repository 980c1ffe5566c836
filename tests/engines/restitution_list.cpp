#include "impact_damper/engines/restitution_dampers.hpp"
#include "observed.hpp"

namespace impact_damper {

Outcome observed_list(const Scene& scene, const Restitution& options, TestObserver<long double>& observer) {
  return run_restitution_dampers<long double>(checked(scene, options), observer);
}

}  // namespace impact_damper
