// The error that stands beside every time: half-cycle amplitudes against the same engine in higher precision.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "impact_damper/engine.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper::bench {

// The scalar of the reference: quadruple precision where the compiler has it (113 bits), else long double.
std::string_view reference_scalar();

// Half-cycle amplitudes, by epsilon, computed in that scalar and rounded to double. Restitution: with an
// accumulation tolerance so small that the jump over the end of a bounce-down is below the rounding of a
// double by itself, so that the error of a run includes what its own tolerance costs.
std::vector<double> reference_amplitudes(const Scene& scene, const Exact& options);
std::vector<double> reference_amplitudes(const Scene& scene, const Restitution& options);
// The same in long double: how far it is from the reference tells how far rounding errors grow.
std::vector<double> long_double_amplitudes(const Scene& scene, const Exact& options);
std::vector<double> long_double_amplitudes(const Scene& scene, const Restitution& options);

// The largest difference of a half-cycle amplitude. A row more or less is a zero crossing near the end of the
// run and not compared; absent if they differ by more rows than that, if there is none to compare, or if a
// number is not finite.
std::optional<double> amplitude_error(const std::vector<double>& amplitude,
                                      const std::vector<double>& reference);

}  // namespace impact_damper::bench
