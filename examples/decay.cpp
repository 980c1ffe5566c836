// A free decay: the amplitude of the primary mass in each half cycle, and the number of impacts in it.
#include <cstdio>

#include "impact_damper/simulate.hpp"

int main() {
  // Everything is dimensionless: lengths in units of the clearance, times in units of
  // 1/Omega_n. What is not set here keeps the default that scene.hpp gives.
  impact_damper::Scene scene;
  scene.damper().mass_ratio = 0.05;  // the secondary mass divided by the primary mass
  scene.damper().restitution = 0.5;  // of an impact
  scene.x0 = 3;                      // the primary mass is pulled aside by three times the clearance
  scene.until_time = 100;

  // The last argument is a Record; by default only half cycles are recorded (forced.cpp asks for energies).
  const impact_damper::Run run = impact_damper::simulate(scene, impact_damper::Exact{}, {});

  const impact_damper::HalfCycles& rows = *run.half_cycles;
  std::puts("half cycle  ends at  amplitude  impacts");
  for (std::size_t i = 0; i < rows.amplitude.size(); ++i) {
    std::printf("%10zu  %7.3f  %9.6f  %7d\n", i, rows.zero_crossing[i], rows.amplitude[i],
                static_cast<int>(rows.impacts[i]));
  }
}
