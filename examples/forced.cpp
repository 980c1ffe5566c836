// A forced vibration, from the text of a scene file: the work of the force, and what takes it out.
#include <cstdio>
#include <numeric>

#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"

int main() try {
  // Force at the natural frequency, with a little viscous damping beside the impact damper. read_scene()
  // reads the same from a file.
  const impact_damper::Scene scene = impact_damper::parse_scene("forced", R"({
    "mass_ratio": 0.04, "damping_ratio": 0.005, "x0": 0,
    "force_amplitude": 0.05, "force_frequency": 1, "until_time": 500
  })");
  impact_damper::Record record;
  record.half_cycles = false;
  record.energy = true;
  const impact_damper::Run run = impact_damper::simulate(scene, impact_damper::Exact{}, record);

  // All in units of K epsilon^2: K is the spring's stiffness, epsilon the clearance.
  const impact_damper::EnergyBalance& energy = *run.energy;
  const double impacts = std::accumulate(energy.impact_loss.begin(), energy.impact_loss.end(), 0.0);
  std::printf("put in by the force       %9.6f\n", energy.forcing_work);
  std::printf("taken out by the dashpot  %9.6f\n", energy.viscous_work);
  std::printf("taken out by %4zu impacts %9.6f\n", energy.impact_loss.size(), impacts);
  std::printf("left in the motion        %9.6f\n", energy.final.total() - energy.initial.total());
  std::printf("the balance closes to 1e-12: %s\n",
              energy.residual < 1e-12 && energy.residual > -1e-12 ? "yes" : "no");
} catch (const impact_damper::InputError& error) {  // what is wrong in the scene, one line for each problem
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
