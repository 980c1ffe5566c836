#include "impact_damper/engines/restitution.hpp"

#include "impact_damper/engines/restitution_components.hpp"
#include "impact_damper/engines/restitution_dampers.hpp"
#include "observed.hpp"

namespace impact_damper {

template <class Real>
Outcome observed(const Scene& scene, const Restitution& options, TestObserver<Real>& observer) {
  return with_system<Real>(
      scene, [&](const auto& system) { return run_restitution(system, scene, options, observer); });
}
template Outcome observed(const Scene&, const Restitution&, TestObserver<double>&);
template Outcome observed(const Scene&, const Restitution&, TestObserver<long double>&);

Outcome observed_list(const Scene& scene, const Restitution& options, TestObserver<long double>& observer) {
  return with_system<long double>(scene, [&](const auto& system) {
    return has_components(scene) ? run_restitution_with_components(system, scene, options, observer)
                                 : run_restitution_dampers(system, scene, options, observer);
  });
}

}  // namespace impact_damper
