#include "reference.hpp"

#ifdef HAVE_FLOAT128
#include <boost/multiprecision/float128.hpp>
#endif
#include <algorithm>
#include <cmath>
#include <utility>

#include "impact_damper/engines/exact.hpp"
#include "impact_damper/engines/exact_dampers.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/engines/restitution.hpp"
#include "impact_damper/engines/restitution_dampers.hpp"
#include "impact_damper/math/elementary.hpp"

#ifdef HAVE_FLOAT128
// Boost 1.74's own expm1 of this type does not compile.
template <>
inline boost::multiprecision::float128 impact_damper::exponential_minus_1(
    const boost::multiprecision::float128& x) {
  return boost::multiprecision::float128(expm1q(x.backend().value()));
}
#endif

namespace impact_damper::bench {
namespace {

#ifdef HAVE_FLOAT128
using Reference = boost::multiprecision::float128;
#else
using Reference = long double;
#endif

std::vector<double> amplitudes_of(Recorder& recorder) {
  Run run;
  recorder.finish(run);
  return std::move(run.half_cycles->amplitude);
}

template <class Real>
std::vector<double> amplitudes(const Scene& scene, const Exact& options) {
  Recorder recorder({.half_cycles = true}, scene.dampers.size());
  if (has_one_damper(scene)) {
    run_exact<Real>(checked(scene, options), recorder);
  } else {
    run_exact_dampers<Real>(checked(scene, options), recorder);
  }
  return amplitudes_of(recorder);
}

template <class Real>
std::vector<double> amplitudes(const Scene& scene, Restitution options) {
  options.accumulation_tolerance = 1e-12;
  Recorder recorder({.half_cycles = true}, scene.dampers.size());
  if (has_one_damper(scene)) {
    run_restitution<Real>(checked(scene, options), recorder);
  } else {
    run_restitution_dampers<Real>(checked(scene, options), recorder);
  }
  return amplitudes_of(recorder);
}

}  // namespace

std::string_view reference_scalar() {
  return std::numeric_limits<Reference>::digits == 113 ? "quadruple precision (113 bits)" : "long double";
}

std::vector<double> reference_amplitudes(const Scene& scene, const Exact& options) {
  return amplitudes<Reference>(scene, options);
}
std::vector<double> reference_amplitudes(const Scene& scene, const Restitution& options) {
  return amplitudes<Reference>(scene, options);
}
std::vector<double> long_double_amplitudes(const Scene& scene, const Exact& options) {
  return amplitudes<long double>(scene, options);
}
std::vector<double> long_double_amplitudes(const Scene& scene, const Restitution& options) {
  return amplitudes<long double>(scene, options);
}

std::optional<double> amplitude_error(const std::vector<double>& amplitude,
                                      const std::vector<double>& reference) {
  const auto [fewer, more] = std::minmax({amplitude.size(), reference.size()});
  if (fewer == 0 || more - fewer > 1) return {};
  double largest = 0;
  for (std::size_t i = 0; i < fewer; ++i) {
    const double difference = std::abs(amplitude[i] - reference[i]);
    if (!std::isfinite(difference)) return {};
    largest = std::max(largest, difference);
  }
  return largest;
}

}  // namespace impact_damper::bench
