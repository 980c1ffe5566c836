// In the module for one damper this is linked in place of recorded_*_dampers.cpp, the engines of several:
// they are a quarter of the packed module, and few scenes need them. The templates are declared anew here,
// because recorded.hpp says that they are instantiated elsewhere.
#include <stdexcept>

#include "impact_damper/engines/observer.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/math/scalar.hpp"

namespace impact_damper {
namespace {

[[noreturn]] void refuse() {
  throw std::invalid_argument(
      "dampers: this module knows no lists of dampers, impact-damper-lists.wasm does");
}

}  // namespace

template <Scalar Real, DampersObserver Observer>
Outcome run_exact_dampers(const Scene& scene, const Exact& options, Observer& observer);
template <Scalar Real, DampersObserver Observer>
Outcome run_restitution_dampers(const Scene& scene, const Restitution& options, Observer& observer);
template <Scalar Real, DampersObserver Observer>
Outcome run_cem_dampers(const Scene& scene, const Cem& options, Observer& observer);

template <>
Outcome run_exact_dampers<double>(const Scene&, const Exact&, Recorder&) {
  refuse();
}
template <>
Outcome run_restitution_dampers<double>(const Scene&, const Restitution&, Recorder&) {
  refuse();
}
template <>
Outcome run_cem_dampers<double>(const Scene&, const Cem&, Recorder&) {
  refuse();
}

}  // namespace impact_damper
