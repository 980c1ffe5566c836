// The peers that this build has: those whose packages were there when it was configured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "contender.hpp"

namespace impact_damper::bench {

std::vector<Contender> peers();
// "SUNDIALS (libsundials-dev)" for every peer that is not built in.
std::vector<std::string> missing_peers();

// One file each.
std::vector<Contender> central_differences_peers();
std::vector<Contender> odeint_peers();
std::vector<Contender> cvode_peers();
std::vector<Contender> arkode_peers();
std::vector<Contender> siconos_peers();

// Half-cycle amplitudes by Runge-Kutta-Fehlberg 78 in the reference's own precision, at a tolerance far below
// the rounding of a double: what the reference is held against. Absent without odeint.
std::optional<std::vector<double>> independent_amplitudes(const Scene& scene, Walls walls);

}  // namespace impact_damper::bench
