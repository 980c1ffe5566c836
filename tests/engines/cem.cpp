#include "impact_damper/engines/cem.hpp"

#include "observed.hpp"

namespace impact_damper {

template <class Real>
Outcome observed(const Scene& scene, const Cem& options, TestObserver<Real>& observer) {
  return CemEngine<Real, TestObserver<Real>, ForOne>(scene, resolved(scene, options), observer).run();
}
template Outcome observed(const Scene&, const Cem&, TestObserver<double>&);
template Outcome observed(const Scene&, const Cem&, TestObserver<long double>&);

}  // namespace impact_damper
