// Measures of errors in the paper's formulas: compared with the model that they describe.
#include <algorithm>
#include <cmath>

#include "application/reproduction/measures_parts.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

// Returns the decay of a viscous oscillator: the secondary mass stays at rest, out of reach of walls that
// move by less than half the clearance.
HalfCycles viscous_decay(const Asked& asked) {
  Scene scene;
  scene.damping_ratio = asked.number("damping_ratio");
  scene.x0 = 0.4;
  scene.damper().y0 = 0.1;
  scene.until_time = 200;
  return *asked.runs.simulated(scene, Exact{}, Record{}).half_cycles;
}

double viscous_loss(const Asked& asked) {
  return spread_of(averaged_loss_factor(viscous_decay(asked), asked.analysis().loss).eta).median /
         (2 * asked.number("damping_ratio"));
}

double viscous_loss_per_cycle(const Asked& asked) {
  const std::vector<double> x = viscous_decay(asked).amplitude;
  return 2 * (x.at(3) - x.at(5)) / x.at(4) / (2 * asked.number("damping_ratio"));
}

// Returns the change of an energy, in percent, from the release to until_time. Nothing is lost before a wall
// is met; throws std::invalid_argument if one is.
template <double (*of)(const Energy&)>
double flight_energy_drift(const Asked& asked) {
  Scene scene;
  scene.x0 = asked.number("x0");
  scene.until_time = asked.number("until_time");
  Record record;
  record.energy = record.impacts = true;
  const Run run = asked.runs.simulated(scene, Exact{}, record);
  if (!run.impacts->time.empty()) throw std::invalid_argument("until_time: a wall was met before it");
  return 100 * std::abs(of(run.energy->final) / of(run.energy->initial) - 1);
}
double paper_energy(const Energy& energy) { return energy.paper; }
double total_energy(const Energy& energy) { return energy.total(); }

// Returns how much energy, in percent, is missing halfway through a lossless impact.
template <bool with_wall>
double missing_impact_energy(const Asked& asked) {
  Scene scene;
  scene.x0 = 0;
  scene.damper().y0 = 0.5;
  scene.damper().w0 = -1;
  scene.damper().mass_ratio = asked.number("mass_ratio");
  scene.damper().restitution = 1;
  scene.until_time = 0.5 + nominal_contact_time(scene.damper()) / 2;
  Record record;
  record.energy = true;
  const EnergyBalance balance = *asked.runs.simulated(scene, Exact{}, record).energy;
  const double kept = balance.final.kinetic + balance.final.spring + (with_wall ? balance.final.wall : 0);
  return 100 * (1 - kept / balance.initial.total());
}

// Simulates a forced scene with e = 0, a heavy secondary mass and compliant walls, finely sampled. The engine
// has no stuck motion: a mass that sticks is in sustained contact and obeys the equations of contact.
Run stuck_run(const Asked& asked) {
  Scene scene;
  scene.damper().mass_ratio = asked.number("mass_ratio");
  scene.damper().restitution = 0;
  scene.damper().wall_stiffness = 1e6;
  scene.x0 = 6;
  scene.force_amplitude = 2;
  scene.force_frequency = 0.4;
  scene.until_time = 20;
  Record record;
  record.contacts = true;
  record.history = {{0, 20, 20001}};
  return asked.runs.simulated(scene, Exact{}, record);
}

// Visits every sample of the contacts after the wall's own motion, which decays as exp(-sqrt(k/nu) t), has
// died away.
template <class Visit>
void for_each_stuck_sample(const Run& run, Visit visit) {
  const std::vector<double>& time = run.history->time;
  for (std::size_t i = 1; i + 1 < time.size(); ++i)
    for (std::size_t c = 0; c < run.contacts->begin.size(); ++c)
      if (time[i - 1] > run.contacts->begin[c] + 0.2 && time[i + 1] < run.contacts->end[c]) visit(i, c);
}

// Returns the coefficient of the force in x'' + x/(1 + nu) = coefficient f0 sin(omega_f t) by least squares.
double stuck_forcing(const Asked& asked) {
  const Run run = stuck_run(asked);
  const History& h = *run.history;
  double products = 0, squares = 0;
  for_each_stuck_sample(run, [&](std::size_t i, std::size_t) {
    const double acceleration = (h.v[i + 1] - h.v[i - 1]) / (h.time[i + 1] - h.time[i - 1]);
    const double force = run.scene.force_amplitude * sin_cos(run.scene.force_frequency * h.time[i]).sin;
    products += force * (acceleration + h.x[i] / (1 + run.scene.damper().mass_ratio));
    squares += force * force;
  });
  return products / squares;
}

// Returns zeta_s/zeta of the paper's (9) (M9.6, M9.7), the coefficient of 2 omega_s zeta x' in the stuck
// motion by least squares: a mass at rest against its wall moves with it, in a sustained contact.
double stuck_damping(const Asked& asked) {
  Scene scene;
  scene.damper().mass_ratio = asked.number("mass_ratio");
  scene.damping_ratio = asked.number("damping_ratio");
  scene.damper().restitution = 0;
  scene.damper().wall_stiffness = 1e6;
  scene.x0 = -6;
  scene.until_time = 1;
  Record record;
  record.contacts = true;
  record.history = {{0, 1, 1001}};
  const Run run = simulate(scene, Exact{}, record);
  const History& h = *run.history;
  const double omega_s = 1 / std::sqrt(1 + scene.damper().mass_ratio);
  double products = 0, squares = 0;
  for_each_stuck_sample(run, [&](std::size_t i, std::size_t) {
    const double acceleration = (h.v[i + 1] - h.v[i - 1]) / (h.time[i + 1] - h.time[i - 1]);
    const double damper = 2 * scene.damping_ratio * omega_s * h.v[i];
    products -= damper * (acceleration + omega_s * omega_s * h.x[i]);
    squares += damper * damper;
  });
  return products / squares;
}

// Returns how far the stuck mass moves from its wall, divided by how far y'' = -x'' would move it.
double stuck_drift(const Asked& asked) {
  const Run run = stuck_run(asked);
  const History& h = *run.history;
  const std::vector<double>& y = h.dampers[0].y;
  double moved = 0, predicted = 0;
  std::size_t contact = run.contacts->begin.size(), begin = 0;
  for_each_stuck_sample(run, [&](std::size_t i, std::size_t c) {
    if (c != contact) contact = c, begin = i;
    moved = std::max(moved, std::abs(y[i] - y[begin]));
    predicted = std::max(predicted, std::abs(h.x[i] - h.x[begin] - h.v[begin] * (h.time[i] - h.time[begin])));
  });
  return moved / predicted;
}

}  // namespace

std::vector<Measure> audit_measures() {
  return {
      {"viscous_loss", viscous_loss, "averaged loss factor of viscous damping alone, divided by 2 zeta",
       numbers("damping_ratio")},
      {"viscous_loss_per_cycle", viscous_loss_per_cycle,
       "2 dx/x over one cycle of viscous damping alone, divided by 2 zeta", numbers("damping_ratio")},
      {"paper_energy_drift_percent", flight_energy_drift<paper_energy>,
       "change of the paper's energy in a free flight, in percent", numbers("x0", "until_time")},
      {"energy_drift_percent", flight_energy_drift<total_energy>,
       "change of kinetic plus spring energy with the cross term in it, in percent",
       numbers("x0", "until_time")},
      {"impact_energy_without_wall_percent", missing_impact_energy<false>,
       "energy missing halfway through a lossless impact if the wall's is left out, in percent",
       numbers("mass_ratio")},
      {"impact_energy_with_wall_percent", missing_impact_energy<true>,
       "energy missing there with the wall's counted, in percent", numbers("mass_ratio")},
      {"stuck_forcing", stuck_forcing,
       "coefficient of the force in the stuck motion, x'' + x/(1 + nu) = coefficient f0 sin(omega_f t)",
       numbers("mass_ratio")},
      {"stuck_damping", stuck_damping,
       "zeta_s by zeta in the stuck motion, x'' + 2 omega_s zeta_s x' + omega_s^2 x = 0",
       numbers("mass_ratio", "damping_ratio")},
      {"stuck_drift", stuck_drift,
       "how far a stuck mass leaves its wall, divided by how far y'' = -x'' would carry it",
       numbers("mass_ratio")},
  };
}

}  // namespace impact_damper
