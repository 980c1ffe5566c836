#include "impact_damper/engines/restitution.hpp"

#include "observed.hpp"

namespace impact_damper {

template <class Real>
Outcome observed(const Scene& scene, const Restitution& options, TestObserver<Real>& observer) {
  return run_restitution<Real>(checked(scene, options), observer);
}
template Outcome observed(const Scene&, const Restitution&, TestObserver<double>&);
template Outcome observed(const Scene&, const Restitution&, TestObserver<long double>&);

}  // namespace impact_damper
