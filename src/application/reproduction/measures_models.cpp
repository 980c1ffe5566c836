// Measures that compare a run with one of another engine, release or wall; of walls and time steps, among
// these of the number that the paper's stuck regime saves; and of errors in the paper's formulas, compared
// with the model that they describe.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "application/reproduction/measures_parts.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

// Returns the time of the peak of the first half cycle below `amplitude`. NaN if there is none.
double peak_time_below(const Run& run, double amplitude) {
  const auto row = first_row_below(half_cycles_of(run), amplitude);
  return row ? run.half_cycles->peak_time[*row] : std::nan("");
}

// Returns the share of the half cycles with an amplitude in [from, to] that belong to no regular window.
double mixed_share(const Asked& asked, const Run& run) {
  const std::vector<double>& amplitude = half_cycles_of(run).amplitude;
  const std::vector<RegularWindow> windows = regular_windows(run, asked.analysis().regimes);
  double rows = 0, mixed = 0;
  for (std::size_t row = 1; row < amplitude.size(); ++row) {
    if (!asked.is_between(amplitude[row])) continue;
    ++rows;
    mixed += std::ranges::none_of(
        windows, [row](const RegularWindow& window) { return window.first <= row && row <= window.last; });
  }
  return mixed / rows;
}

// Returns a scene with both masses at rest, except for the secondary's unit velocity towards the left wall,
// half the clearance away.
Scene single_impact_scene(double mass_ratio, double restitution) {
  Scene scene;
  scene.x0 = 0;
  scene.damper().y0 = 0.5;
  scene.damper().w0 = -1;
  scene.damper().mass_ratio = mass_ratio;
  scene.damper().restitution = restitution;
  scene.until_time = 1;
  return scene;
}

// Whether the component element method, in ten thousand steps of length h, keeps the amplitude of a primary
// mass that swings by 0.01 of the clearance, its secondary mass out of reach.
bool is_stable(const Runs& runs, double h) {
  Scene scene;
  scene.x0 = 0.01;
  scene.damper().y0 = 0.5;
  scene.until_time = 10000 * h;
  Cem cem;
  cem.time_step = h;
  cem.unstable = true;
  try {
    const std::vector<double> amplitude = runs.simulated(scene, cem, Record{}).half_cycles->amplitude;
    return std::ranges::none_of(amplitude, [&](double a) { return !(a < 10 * scene.x0); });
  } catch (const NumericalError&) {
    return false;  // overflow
  }
}

// Returns the exponent of the time step in the error of the component element method, by least squares. The
// error is that of the half cycles' amplitudes against the exact engine, up to t = 30, before chaos can set
// in. The steps are spaced evenly in the logarithm. The error of a single one scatters by a factor of three,
// because it depends on where impacts happen to fall in a step; over 32 steps and a factor of 16 the exponent
// has a standard error of 0.2.
template <bool locate>
double step_order(const Asked& asked) {
  Scene scene = asked.file().scene;
  scene.until_time = 30;
  scene.until_amplitude.reset();
  const Run exact = asked.runs.simulated(scene, Exact{}, Record{});
  const auto error = [&](double step) {
    Cem cem;
    cem.time_step = step;
    cem.locate = locate;
    const Run run = asked.runs.simulated(scene, cem, Record{});
    double sum = 0;
    const std::size_t rows = std::min(run.half_cycles->amplitude.size(), exact.half_cycles->amplitude.size());
    for (std::size_t row = 0; row < rows; ++row)
      sum += std::abs(run.half_cycles->amplitude[row] - exact.half_cycles->amplitude[row]);
    return sum;
  };
  const double coarse = nominal_contact_time(scene.damper()) / asked.number("steps_per_contact");
  constexpr int steps = 32;
  Curve errors;
  for (int i = 0; i < steps; ++i) {
    const double step = coarse * exponential(-logarithm(asked.number("factor")) * i / (steps - 1));
    errors.add(step, error(step));
  }
  return log_slope(errors);
}

// Returns the component element method with small steps only near contact, and touch and release located. Its
// own error, 1e-5 of the time of a decay, is below what the regime changes. The catalogue's further runs by
// this method have the same options.
Cem located_method(std::optional<double> stuck_speed) {
  Cem engine;
  engine.locate = true;
  engine.large_step = 0.02;
  engine.stuck_speed = stuck_speed;
  return engine;
}

// Returns the least budget of steps that a run does not exhaust.
double steps_of(const Scene& scene, Cem engine) {
  std::int64_t least = 0, most = engine.max_steps;
  while (most - least > 1) {
    engine.max_steps = least + (most - least) / 2;
    const bool enough = simulate(scene, engine, Record{}).stop_reason != StopReason::step_budget;
    (enough ? most : least) = engine.max_steps;
  }
  return static_cast<double>(most);
}

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

// Returns the change of an energy, in percent, from the release to until_time. Nothing is lost before a wall
// is met; throws std::invalid_argument if one is.
template <double (*of)(const Energy&)>
double flight_energy_drift(const Asked& asked) {
  Scene scene;
  scene.x0 = asked.number("x0");
  scene.until_time = asked.number("until_time");
  const Run run = asked.runs.simulated(scene, Exact{}, {.impacts = true, .energy = true});
  if (!run.impacts->time.empty()) throw std::invalid_argument("until_time: a wall was met before it");
  return 100 * std::abs(of(run.energy->final) / of(run.energy->initial) - 1);
}
double paper_energy(const Energy& energy) { return energy.paper; }
double total_energy(const Energy& energy) { return energy.total(); }

// Returns how much energy, in percent, is missing halfway through a lossless impact.
template <bool with_wall>
double missing_impact_energy(const Asked& asked) {
  Scene scene = single_impact_scene(asked.number("mass_ratio"), 1);
  scene.until_time = 0.5 + nominal_contact_time(scene.damper()) / 2;
  const EnergyBalance balance = *asked.runs.simulated(scene, Exact{}, {.energy = true}).energy;
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
  return asked.runs.simulated(scene, Exact{}, {.contacts = true, .history = {{0, 20, 20001}}});
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

// Returns the coefficient in x'' + restoring = coefficient driving of the stuck motion, by least squares;
// both terms are functions of a sample.
template <class Restoring, class Driving>
double stuck_coefficient(const Run& run, Restoring restoring, Driving driving) {
  const History& h = *run.history;
  double products = 0, squares = 0;
  for_each_stuck_sample(run, [&](std::size_t i, std::size_t) {
    const double acceleration = (h.v[i + 1] - h.v[i - 1]) / (h.time[i + 1] - h.time[i - 1]);
    products += driving(i) * (acceleration + restoring(i));
    squares += driving(i) * driving(i);
  });
  return products / squares;
}

}  // namespace

std::vector<Measure> model_measures() {
  return {
      {"mixed_share_ratio",
       "share of the half cycles that belong to no regular window, divided by the second run's",
       [](const Asked& asked, const Run& ours, const Run& theirs) {
         return mixed_share(asked, ours) / mixed_share(asked, theirs);
       },
       numbers("from", "to")},
      {"time_saved_percent",
       "by how much the first run reaches an amplitude before the second, in percent of the time",
       [](const Asked& asked) {
         const double amplitude = asked.number("amplitude");
         std::vector<double> theirs, saved;
         for (const Run& run : asked.runs.ensemble(asked.call.scenes.back()))
           theirs.push_back(peak_time_below(run, amplitude));
         const double reference = spread_of(theirs).median;
         for (const Run& run : asked.ensemble())
           saved.push_back(100 * (1 - peak_time_below(run, amplitude) / reference));
         return spread_of(saved);
       },
       numbers("amplitude"), scenes(2, 2)},
      {"time_ratio", "time down to an amplitude, divided by the second run's",
       [](const Asked& asked, const Run& ours, const Run& theirs) {
         const double amplitude = asked.number("amplitude");
         return peak_time_below(ours, amplitude) / peak_time_below(theirs, amplitude);
       },
       numbers("amplitude")},
      {"zeta_error", "velocity error of the iterative zeta_m",
       [](const Asked& asked) { return zeta_m_iterative(asked.number("restitution")).velocity_error; },
       numbers("restitution")},
      {"zeta_steps", "steps of the iterative zeta_m through one impact",
       [](const Asked& asked) { return double(zeta_m_iterative(asked.number("restitution")).steps); },
       numbers("restitution")},
      {"zeta_difference", "iterative zeta_m less the closed form, absolute",
       [](const Asked& asked) {
         const double e = asked.number("restitution");
         return std::abs(zeta_m_iterative(e).zeta_m - zeta_m_closed_form(e));
       },
       numbers("restitution")},
      {"wall_restitution", "relative speed after one impact of the exact engine, divided by that before",
       [](const Asked& asked) {
         const Scene scene = single_impact_scene(asked.number("mass_ratio"), asked.number("restitution"));
         const Run contact = asked.runs.simulated(scene, Exact{}, {.contacts = true});
         if (contact.contacts->end.empty()) return std::nan("");
         const double end = contact.contacts->end.front();
         const Run again = asked.runs.simulated(scene, Exact{}, {.history = {{end, end + 1e-9, 2}}});
         return again.history->dampers[0].w.back();
       },
       numbers("mass_ratio", "restitution")},
      {"contact_frequency", "frequency of one contact of the exact engine, divided by the root of k",
       [](const Asked& asked) {
         const Scene scene = single_impact_scene(asked.number("mass_ratio"), asked.number("restitution"));
         const Contacts contacts = *asked.runs.simulated(scene, Exact{}, {.contacts = true}).contacts;
         if (contacts.end.empty()) return std::nan("");
         const double duration = contacts.end.front() - contacts.begin.front();
         return half_turn<double>() / duration / std::sqrt(scene.damper().wall_stiffness);
       },
       numbers("mass_ratio", "restitution")},
      // The run is simulated again with its own engine, the wall sampled finely through the contact that its
      // fastest impact begins.
      {"wall_overlap", "largest deformation of the wall, in units of the clearance",
       [](const Asked& asked, const Run& run) {
         const std::vector<double>& speed = impacts_of(run).relative_velocity;
         if (speed.empty()) return std::nan("");
         const auto fastest = std::ranges::max_element(speed, {}, [](double each) { return std::abs(each); });
         const double begin = run.impacts->time[static_cast<std::size_t>(fastest - speed.begin())];
         Scene scene = run.scene;
         scene.until_amplitude.reset();
         scene.until_time = begin + nominal_contact_time(scene.damper());
         const Run again =
             asked.runs.simulated(scene, run.engine, {.history = {{begin, *scene.until_time, 201}}});
         double overlap = 0;
         for (const double y : again.history->dampers[0].y) overlap = std::max({overlap, -y, y - 1});
         return overlap;
       }},
      // The highest mode is the primary mass's, of frequency 1.
      {"step_limit",
       "largest omega h at which the component element method stays bounded, undamped, by trial",
       [](const Asked& asked) {
         double low = 0.5, high = 8;
         while (high - low > 1e-6) {
           const double h = (low + high) / 2;
           (is_stable(asked.runs, h) ? low : high) = h;
         }
         return low;
       }},
      {"step_order",
       "power of the time step as which the error of the component element method falls, down to a step "
       "smaller by a factor",
       step_order<false>, numbers("steps_per_contact", "factor"), scenes(1, 1)},
      {"step_order_located", "the same with touch and release located inside the step", step_order<true>,
       numbers("steps_per_contact", "factor"), scenes(1, 1)},
      {"stuck_regime_steps_percent",
       "steps of the component element method that the paper's stuck regime saves, down to an amplitude, in "
       "percent",
       [](const Asked& asked) {
         Scene scene = asked.file().scene;
         scene.until_time.reset();
         scene.until_amplitude = asked.number("amplitude");
         return 100 * (1 - steps_of(scene, located_method(asked.number("stuck_speed"))) /
                               steps_of(scene, located_method({})));
       },
       numbers("stuck_speed", "amplitude"), scenes(1, 1)},
      {"viscous_loss", "averaged loss factor of viscous damping alone, divided by 2 zeta",
       [](const Asked& asked) {
         return spread_of(averaged_loss_factor(viscous_decay(asked), asked.analysis().loss).eta).median /
                (2 * asked.number("damping_ratio"));
       },
       numbers("damping_ratio")},
      {"viscous_loss_per_cycle", "2 dx/x over one cycle of viscous damping alone, divided by 2 zeta",
       [](const Asked& asked) {
         const std::vector<double> x = viscous_decay(asked).amplitude;
         return 2 * (x.at(3) - x.at(5)) / x.at(4) / (2 * asked.number("damping_ratio"));
       },
       numbers("damping_ratio")},
      {"paper_energy_drift_percent", "change of the paper's energy in a free flight, in percent",
       flight_energy_drift<paper_energy>, numbers("x0", "until_time")},
      {"energy_drift_percent", "change of kinetic plus spring energy with the cross term in it, in percent",
       flight_energy_drift<total_energy>, numbers("x0", "until_time")},
      {"impact_energy_without_wall_percent",
       "energy missing halfway through a lossless impact if the wall's is left out, in percent",
       missing_impact_energy<false>, numbers("mass_ratio")},
      {"impact_energy_with_wall_percent", "energy missing there with the wall's counted, in percent",
       missing_impact_energy<true>, numbers("mass_ratio")},
      {"stuck_forcing",
       "coefficient of the force in the stuck motion, x'' + x/(1 + nu) = coefficient f0 sin(omega_f t)",
       [](const Asked& asked) {
         const Run run = stuck_run(asked);
         const History& h = *run.history;
         return stuck_coefficient(
             run, [&](std::size_t i) { return h.x[i] / (1 + run.scene.damper().mass_ratio); },
             [&](std::size_t i) {
               return run.scene.force_amplitude * sin_cos(run.scene.force_frequency * h.time[i]).sin;
             });
       },
       numbers("mass_ratio")},
      // The paper's (9) (M9.6, M9.7). A mass at rest against its wall moves with it, in a sustained contact.
      {"stuck_damping", "zeta_s by zeta in the stuck motion, x'' + 2 omega_s zeta_s x' + omega_s^2 x = 0",
       [](const Asked& asked) {
         Scene scene;
         scene.damper().mass_ratio = asked.number("mass_ratio");
         scene.damping_ratio = asked.number("damping_ratio");
         scene.damper().restitution = 0;
         scene.damper().wall_stiffness = 1e6;
         scene.x0 = -6;
         scene.until_time = 1;
         const Run run = asked.runs.simulated(scene, Exact{}, {.contacts = true, .history = {{0, 1, 1001}}});
         const History& h = *run.history;
         const double omega_s = 1 / std::sqrt(1 + scene.damper().mass_ratio);
         return -stuck_coefficient(
             run, [&](std::size_t i) { return omega_s * omega_s * h.x[i]; },
             [&](std::size_t i) { return 2 * scene.damping_ratio * omega_s * h.v[i]; });
       },
       numbers("mass_ratio", "damping_ratio")},
      {"stuck_drift", "how far a stuck mass leaves its wall, divided by how far y'' = -x'' would carry it",
       [](const Asked& asked) {
         const Run run = stuck_run(asked);
         const History& h = *run.history;
         const std::vector<double>& y = h.dampers[0].y;
         double moved = 0, predicted = 0;
         std::size_t contact = run.contacts->begin.size(), begin = 0;
         for_each_stuck_sample(run, [&](std::size_t i, std::size_t c) {
           if (c != contact) contact = c, begin = i;
           moved = std::max(moved, std::abs(y[i] - y[begin]));
           predicted =
               std::max(predicted, std::abs(h.x[i] - h.x[begin] - h.v[begin] * (h.time[i] - h.time[begin])));
         });
         return moved / predicted;
       },
       numbers("mass_ratio")},
  };
}

}  // namespace impact_damper
