#include "impact_damper/engines/exact.hpp"

#include "observed.hpp"

namespace impact_damper {

template <class Real>
Outcome observed(const Scene& scene, const Exact& options, TestObserver<Real>& observer) {
  return with_system<Real>(scene,
                           [&](const auto& system) { return run_exact(system, scene, options, observer); });
}
template Outcome observed(const Scene&, const Exact&, TestObserver<double>&);
template Outcome observed(const Scene&, const Exact&, TestObserver<long double>&);

}  // namespace impact_damper
