// In the module for one damper this is linked in place of recorded_*_dampers.cpp, the engines of several:
// they are a quarter of the packed module, and few scenes need them. The templates are declared anew here,
// because recorded.hpp says that they are instantiated elsewhere.
#include <stdexcept>

#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/observer.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

[[noreturn]] void refuse() {
  throw std::invalid_argument(
      "scene: this module knows no lists of dampers, friction, weight and drag, and no laws of walls and "
      "springs, impact-damper-lists.wasm does");
}

}  // namespace

template <Scalar Real, DampersObserver Observer>
Outcome run_exact_dampers(const Checked& run, Observer& observer);
template <Scalar Real, DampersObserver Observer>
Outcome run_exact_with_components(const Checked& run, Observer& observer);
template <Scalar Real, DampersObserver Observer>
Outcome run_restitution_dampers(const Checked& run, Observer& observer);
template <Scalar Real, DampersObserver Observer>
Outcome run_restitution_with_components(const Checked& run, Observer& observer);
template <Scalar Real, DampersObserver Observer>
Outcome run_cem_dampers(const Checked& run, Observer& observer);

template <>
Outcome run_exact_dampers<double>(const Checked&, Recorder&) {
  refuse();
}
template <>
Outcome run_exact_with_components<double>(const Checked&, Recorder&) {
  refuse();
}
template <>
Outcome run_restitution_dampers<double>(const Checked&, Recorder&) {
  refuse();
}
template <>
Outcome run_restitution_with_components<double>(const Checked&, Recorder&) {
  refuse();
}
template <>
Outcome run_cem_dampers<double>(const Checked&, Recorder&) {
  refuse();
}

}  // namespace impact_damper
