// Measures that compare a run with one of another engine, release or wall, and measures of walls and time
// steps.
#include <algorithm>
#include <cmath>

#include "application/reproduction/measures.hpp"
#include "application/reproduction/measures_parts.hpp"
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

// Applies `find` to each member of the two ensembles of `call`, in pairs.
template <class Find>
Spread over_pairs(Runs& runs, const MeasureCall& call, Find find) {
  return over_groups(runs, call,
                     [&](const std::vector<const Run*>& pair) { return find(*pair[0], *pair[1]); });
}

Spread time_saved(Runs& runs, const MeasureCall& call) {
  const double amplitude = number(call, "amplitude");
  std::vector<double> theirs;
  for (const Run& run : runs.ensemble(call.scenes.back())) theirs.push_back(peak_time_below(run, amplitude));
  const double reference = spread_of(theirs).median;
  return over_members(
      runs, call, [&](const Run& run) { return 100 * (1 - peak_time_below(run, amplitude) / reference); });
}

Spread time_ratio(Runs& runs, const MeasureCall& call) {
  const double amplitude = number(call, "amplitude");
  return over_pairs(runs, call, [&](const Run& ours, const Run& theirs) {
    return peak_time_below(ours, amplitude) / peak_time_below(theirs, amplitude);
  });
}

// Returns the share of the half cycles with an amplitude in [from, to] that belong to no regular window.
double mixed_share(const Run& run, const RegimeOptions& regimes, double from, double to) {
  const std::vector<double>& amplitude = half_cycles_of(run).amplitude;
  const std::vector<RegularWindow> windows = regular_windows(run, regimes);
  double rows = 0, mixed = 0;
  for (std::size_t row = 1; row < amplitude.size(); ++row) {
    if (!(amplitude[row] >= from && amplitude[row] <= to)) continue;
    ++rows;
    mixed += std::ranges::none_of(
        windows, [row](const RegularWindow& window) { return window.first <= row && row <= window.last; });
  }
  return mixed / rows;
}

Spread mixed_share_ratio(Runs& runs, const MeasureCall& call) {
  const double from = number(call, "from"), to = number(call, "to");
  const RegimeOptions& regimes = runs.analysis().regimes;
  return over_pairs(runs, call, [&](const Run& ours, const Run& theirs) {
    return mixed_share(ours, regimes, from, to) / mixed_share(theirs, regimes, from, to);
  });
}

Spread zeta_error(Runs&, const MeasureCall& call) {
  return once(zeta_m_iterative(number(call, "restitution")).velocity_error);
}
Spread zeta_steps(Runs&, const MeasureCall& call) {
  return once(zeta_m_iterative(number(call, "restitution")).steps);
}
Spread zeta_difference(Runs&, const MeasureCall& call) {
  const double e = number(call, "restitution");
  return once(std::abs(zeta_m_iterative(e).zeta_m - zeta_m_closed_form(e)));
}

// Returns a scene with both masses at rest, except for the secondary's unit velocity towards the left wall,
// half the clearance away.
Scene single_impact_scene(const MeasureCall& call) {
  Scene scene;
  scene.x0 = 0;
  scene.damper().y0 = 0.5;
  scene.damper().w0 = -1;
  scene.damper().mass_ratio = number(call, "mass_ratio");
  scene.damper().restitution = number(call, "restitution");
  scene.until_time = 1;
  return scene;
}

Spread wall_restitution(Runs& runs, const MeasureCall& call) {
  Scene scene = single_impact_scene(call);
  Record record;
  record.contacts = true;
  const Run contact = runs.simulated(scene, Exact{}, record);
  if (contact.contacts->end.empty()) return once(std::nan(""));
  const double end = contact.contacts->end.front();
  record.history = {{end, end + 1e-9, 2}};
  return once(runs.simulated(scene, Exact{}, record).history->dampers[0].w.back());
}

Spread contact_frequency(Runs& runs, const MeasureCall& call) {
  const Scene scene = single_impact_scene(call);
  Record record;
  record.contacts = true;
  const Contacts contacts = *runs.simulated(scene, Exact{}, record).contacts;
  if (contacts.end.empty()) return once(std::nan(""));
  const double duration = contacts.end.front() - contacts.begin.front();
  return once(half_turn<double>() / duration / std::sqrt(scene.damper().wall_stiffness));
}

// Simulates each run again with its own engine, the wall sampled finely through the contact that its fastest
// impact begins.
Spread wall_overlap(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    if (!run.impacts) throw std::invalid_argument("impacts: the run did not record them");
    const std::vector<double>& speed = run.impacts->relative_velocity;
    if (speed.empty()) return std::nan("");
    const auto fastest = std::ranges::max_element(
        speed, [](double one, double other) { return std::abs(one) < std::abs(other); });
    const double begin = run.impacts->time[static_cast<std::size_t>(fastest - speed.begin())];
    Scene scene = run.scene;
    scene.until_amplitude.reset();
    scene.until_time = begin + nominal_contact_time(scene.damper());
    Record record;
    record.history = {{begin, *scene.until_time, 201}};
    const Run again = runs.simulated(scene, run.engine, record);
    double overlap = 0;
    for (const double y : again.history->dampers[0].y) overlap = std::max({overlap, -y, y - 1});
    return overlap;
  });
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

// Returns the largest step that stays bounded, by bisection. The highest mode is the primary mass's, of
// frequency 1.
Spread step_limit(Runs& runs, const MeasureCall&) {
  double low = 0.5, high = 8;
  while (high - low > 1e-6) {
    const double h = (low + high) / 2;
    (is_stable(runs, h) ? low : high) = h;
  }
  return once(low);
}

// Returns the exponent of the time step in the error of the component element method, by least squares. The
// error is that of the half cycles' amplitudes against the exact engine, up to t = 30, before chaos can set
// in. The steps are spaced evenly in the logarithm. The error of a single one scatters by a factor of three,
// because it depends on where impacts happen to fall in a step; over 32 steps and a factor of 16 the exponent
// has a standard error of 0.2.
template <bool locate>
Spread step_order(Runs& runs, const MeasureCall& call) {
  Scene scene = runs.file(call.scenes.front()).scene;
  scene.until_time = 30;
  scene.until_amplitude.reset();
  const Run exact = runs.simulated(scene, Exact{}, Record{});
  const auto error = [&](double step) {
    Cem cem;
    cem.time_step = step;
    cem.locate = locate;
    const Run run = runs.simulated(scene, cem, Record{});
    double sum = 0;
    const std::size_t rows = std::min(run.half_cycles->amplitude.size(), exact.half_cycles->amplitude.size());
    for (std::size_t row = 0; row < rows; ++row)
      sum += std::abs(run.half_cycles->amplitude[row] - exact.half_cycles->amplitude[row]);
    return sum;
  };
  const double coarse = nominal_contact_time(scene.damper()) / number(call, "steps_per_contact");
  constexpr int steps = 32;
  Curve errors;
  for (int i = 0; i < steps; ++i) {
    errors.x.push_back(coarse * exponential(-logarithm(number(call, "factor")) * i / (steps - 1)));
    errors.y.push_back(error(errors.x.back()));
  }
  return once(log_slope(errors));
}

}  // namespace

std::vector<Measure> model_measures() {
  return {
      {"mixed_share_ratio", mixed_share_ratio,
       "share of the half cycles that belong to no regular window, divided by the second run's",
       numbers("from", "to"), scenes(2, 2)},
      {"time_saved_percent", time_saved,
       "by how much the first run reaches an amplitude before the second, in percent of the time",
       numbers("amplitude"), scenes(2, 2)},
      {"time_ratio", time_ratio, "time down to an amplitude, divided by the second run's",
       numbers("amplitude"), scenes(2, 2)},
      {"zeta_error", zeta_error, "velocity error of the iterative zeta_m", numbers("restitution"),
       scenes(0, 0)},
      {"zeta_steps", zeta_steps, "steps of the iterative zeta_m through one impact", numbers("restitution"),
       scenes(0, 0)},
      {"zeta_difference", zeta_difference, "iterative zeta_m less the closed form, absolute",
       numbers("restitution"), scenes(0, 0)},
      {"wall_restitution", wall_restitution,
       "relative speed after one impact of the exact engine, divided by that before",
       numbers("mass_ratio", "restitution"), scenes(0, 0)},
      {"contact_frequency", contact_frequency,
       "frequency of one contact of the exact engine, divided by the root of k",
       numbers("mass_ratio", "restitution"), scenes(0, 0)},
      {"wall_overlap", wall_overlap, "largest deformation of the wall, in units of the clearance"},
      {"step_limit", step_limit,
       "largest omega h at which the component element method stays bounded, undamped, by trial", numbers(),
       scenes(0, 0)},
      {"step_order", step_order<false>,
       "power of the time step as which the error of the component element method falls, down to a step "
       "smaller by a factor",
       numbers("steps_per_contact", "factor")},
      {"step_order_located", step_order<true>, "the same with touch and release located inside the step",
       numbers("steps_per_contact", "factor")},
  };
}

}  // namespace impact_damper
