#include "impact_damper/engines/exact.hpp"

#include "observed.hpp"

namespace impact_damper {

template <class Real>
Outcome observed(const Scene& scene, const Exact& options, TestObserver<Real>& observer) {
  return run_exact<Real>(checked(scene, options), observer);
}
template Outcome observed(const Scene&, const Exact&, TestObserver<double>&);
template Outcome observed(const Scene&, const Exact&, TestObserver<long double>&);

}  // namespace impact_damper
