#include "impact_damper/engines/restitution.hpp"

#include "observed.hpp"

namespace impact_damper {

template <class Real>
Outcome observed(const Scene& scene, const Restitution& options, TestObserver<Real>& observer) {
  return with_system<Real>(
      scene, [&](const auto& system) { return run_restitution(system, scene, options, observer); });
}
template Outcome observed(const Scene&, const Restitution&, TestObserver<double>&);
template Outcome observed(const Scene&, const Restitution&, TestObserver<long double>&);

}  // namespace impact_damper
