// Linked in place of the engines of several dampers: they are a third of the code, and few scenes need them.
#include <stdexcept>

#include "impact_damper/engines/observer.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/math/scalar.hpp"

namespace impact_damper {
namespace {

[[noreturn]] Outcome refuse() {
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
  return refuse();
}
template <>
Outcome run_restitution_dampers<double>(const Scene&, const Restitution&, Recorder&) {
  return refuse();
}
template <>
Outcome run_cem_dampers<double>(const Scene&, const Cem&, Recorder&) {
  return refuse();
}

}  // namespace impact_damper
