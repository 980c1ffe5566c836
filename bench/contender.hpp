// Whoever runs the bench's scenes: an engine of ours or a peer, each behind the same two questions.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "impact_damper/scene.hpp"
#include "rows.hpp"

namespace impact_damper::bench {

enum class Walls { compliant, rigid };

struct Contender {
  std::string name;
  Walls walls = Walls::compliant;
  std::string setting;  // what its accuracy is set by, "tolerance" or "time step"; empty: by nothing
  // The settings to be tried on a scene, coarsest first; one, of no meaning, where there is nothing to set.
  std::function<std::vector<double>(const Scene&)> settings;
  // Runs a scene that ends by until_time or until_amplitude. May throw where a setting is beyond it.
  std::function<Rows(const Scene&, double setting)> run;
  std::string about = {};  // how it goes about it, and whose it is
  bool several = false;    // runs scenes with a list of dampers, too
};

// The engines of this project; the component element method once for each way of stepping.
std::vector<Contender> engines();

// The peers that this build has: those whose packages were there when it was configured.
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

// from, from * factor, ... : `count` of them.
std::vector<double> geometric(double from, double factor, int count);

}  // namespace impact_damper::bench
