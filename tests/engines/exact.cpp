#include "impact_damper/engines/exact.hpp"

#include "impact_damper/engines/exact_components.hpp"
#include "impact_damper/engines/exact_dampers.hpp"
#include "observed.hpp"

namespace impact_damper {

template <class Real>
Outcome observed(const Scene& scene, const Exact& options, TestObserver<Real>& observer) {
  return with_system<Real>(scene,
                           [&](const auto& system) { return run_exact(system, scene, options, observer); });
}
template Outcome observed(const Scene&, const Exact&, TestObserver<double>&);
template Outcome observed(const Scene&, const Exact&, TestObserver<long double>&);

Outcome observed_list(const Scene& scene, const Exact& options, TestObserver<long double>& observer) {
  return with_system<long double>(scene, [&](const auto& system) {
    return has_components(scene) ? run_exact_with_components(system, scene, options, observer)
                                 : run_exact_dampers(system, scene, options, observer, {});
  });
}

}  // namespace impact_damper
