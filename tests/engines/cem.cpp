#include "impact_damper/engines/cem.hpp"

#include "observed.hpp"

namespace impact_damper {

template <class Real>
Outcome observed(const Scene& scene, const Cem& options, TestObserver<Real>& observer) {
  const Cem complete = resolved(scene, options);
  require_none(problems_of(scene, complete));
  return CemEngine<Real, TestObserver<Real>, ForOne>(scene, complete, observer).run();
}
template Outcome observed(const Scene&, const Cem&, TestObserver<double>&);
template Outcome observed(const Scene&, const Cem&, TestObserver<long double>&);

}  // namespace impact_damper
