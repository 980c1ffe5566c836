#include "application/report/findings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "impact_damper/engines/checked.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {
namespace {

constexpr double two_periods = 4 * std::numbers::pi;
constexpr std::int64_t window_samples = 1001;

// Returns the row of the first amplitude: row 1 if that is larger, as after a release on the way outwards.
std::optional<std::size_t> first_row(const HalfCycles& rows) {
  if (rows.amplitude.empty()) return std::nullopt;
  return rows.amplitude.size() > 1 && rows.amplitude[1] > rows.amplitude[0] ? 1 : 0;
}

// Returns the spread of measure(run) over all releases; absent if it is absent for one of them.
template <class Measure>
std::optional<Spread> over_all(const Findings& findings, Measure measure) {
  std::vector<double> values;
  for (std::size_t i = 0; i <= findings.others.size(); ++i) {
    const std::optional<double> value = measure(i == 0 ? findings.run : findings.others[i - 1]);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return spread_of(values);
}

void find_falls(Findings& findings) {
  for (const double part : {0.5, 0.1, 0.01}) {
    const double amplitude = part * *findings.first_amplitude;
    const auto time = time_below(findings.run, amplitude);
    if (!time) return;
    findings.falls.push_back({part, amplitude, *time, over_all(findings, [&](const Run& run) {
                                return time_below(run, amplitude);
                              })});
  }
}

std::size_t best_row(const LossFactor& loss) {
  return static_cast<std::size_t>(std::ranges::max_element(loss.eta) - loss.eta.begin());
}
bool has_loss(const LossFactor& loss) { return !loss.eta.empty() && std::ranges::max(loss.eta) > 0; }

void find_best_damping(Findings& findings) {
  const HalfCycles& rows = *findings.run.half_cycles;
  findings.loss = loss_before_failure(findings.run);
  findings.loss_after_failure = local_loss_factor(rows, failure_row(findings.run), rows.amplitude.size());
  for (const Run& other : findings.others) findings.losses_of_others.push_back(loss_before_failure(other));
  const LossFactor& loss = findings.loss;
  const Scene& scene = findings.subject.scene;
  const auto keeps_speed = [](const auto& damper) { return damper.restitution == 1; };
  const bool lossless = std::ranges::all_of(scene.dampers, keeps_speed);
  if (lossless && scene.damping_ratio == 0) return;  // no energy is lost
  if (findings.run.impacts->time.empty()) return;    // the same at every amplitude
  if (!has_loss(loss)) return;
  const std::size_t best = best_row(loss);
  const auto over_losses = [&](const std::vector<double> LossFactor::*column) -> std::optional<Spread> {
    std::vector<double> values{(loss.*column)[best]};
    for (const LossFactor& each : findings.losses_of_others) {
      if (each.eta.empty()) return std::nullopt;
      values.push_back((each.*column)[best_row(each)]);
    }
    return spread_of(values);
  };
  findings.best = {best,
                   loss.eta[best],
                   loss.amplitude[best],
                   loss.time[best],
                   over_losses(&LossFactor::eta),
                   over_losses(&LossFactor::amplitude)};
}

// Returns the loads in a run of one damper; of several, without a contact.
std::optional<Loads> loads_of(const Run& run) {
  const Impacts& impacts = *run.impacts;
  const Scene& scene = run.scene;
  const Engine& engine = run.engine;
  if (impacts.time.empty()) return std::nullopt;
  Loads loads;
  for (const double speed : impacts.relative_velocity) loads.speed = std::max(loads.speed, std::abs(speed));
  const double end = run.end_time, from = scene.force_amplitude != 0 ? 0.75 * end : 0;
  loads.impacts = static_cast<double>(impacts.time.end() - std::ranges::lower_bound(impacts.time, from));
  loads.time = end - from;
  if (has_one_damper(scene) && !has_rigid_walls(engine)) {
    if (scene.damper().wall.law != WallForm::linear) return loads;  // there is no closed form
    loads.initial_force = initial_wall_force(scene.damper(), calibration_of(engine));
    if (nominal_contact_time(scene.damper()) <= longest_short_contact)
      loads.contact = short_contact(scene.damper(), calibration_of(engine), loads.speed);
  }
  return loads;
}

DamperFindings findings_of_damper(const Run& run, std::size_t number) {
  const Run its = run_of_damper(run, number);
  const double c = run.scene.dampers[number].clearance;
  const DamperEnergy& energy = run.energy->dampers[number];
  DamperFindings found;
  found.energy = energy.impact_loss + energy.contact_loss + energy.bounce_down_loss;
  found.impacts = std::ssize(its.impacts->time);
  found.loads = loads_of(its);
  if (found.loads) {
    found.loads->speed *= c;
    found.loads->initial_force *= c;
    if (found.loads->contact) found.loads->contact->force *= c;
  }
  if (its.half_cycles->amplitude.empty()) return found;
  const auto scaled = [&](std::optional<HalfCycleRow> half_cycle) {
    if (half_cycle) half_cycle->amplitude *= c;
    return half_cycle;
  };
  found.sticking_ends = scaled(end_of_bounce_down(its));
  const ImpactFailure failure = impact_failure(its);
  found.failure = {scaled(failure.first_missed), scaled(failure.for_good)};
  return found;
}
void find_dampers(Findings& findings) {
  for (std::size_t n = 0; n < findings.subject.scene.dampers.size(); ++n)
    findings.dampers.push_back(findings_of_damper(findings.run, n));
  const auto most = std::ranges::max_element(findings.dampers, {}, &DamperFindings::energy);
  findings.shown = static_cast<std::size_t>(most - findings.dampers.begin());
}

void find_regimes(Findings& findings) {
  const Run& run = findings.run;
  findings.failure = impact_failure(run);
  for (const std::int64_t impacts : run.half_cycles->impacts)
    findings.most_impacts = std::max(findings.most_impacts, impacts);
  if (findings.several()) return;
  findings.sticking_ends = end_of_bounce_down(run);
  const Contacts stuck = stuck_contacts(run);
  for (std::size_t i = 0; i < stuck.begin.size(); ++i) findings.stuck_time += stuck.end[i] - stuck.begin[i];
  const std::vector<RegularWindow> windows = regular_windows(run);
  // Windows of many impacts are bounce-downs, in which their number has little meaning.
  constexpr std::int64_t few = 6;
  for (std::int64_t impacts = few; impacts >= 1; --impacts)
    if (const auto window = longest_window(windows, impacts)) findings.windows.push_back(*window);
}

void find_spread(Findings& findings) {
  std::size_t rows = findings.run.half_cycles->amplitude.size();
  for (const Run& other : findings.others) rows = std::min(rows, other.half_cycles->amplitude.size());
  for (std::size_t row = 0; row < rows; ++row) {
    std::vector<double> amplitudes{findings.run.half_cycles->amplitude[row]};
    for (const Run& other : findings.others) amplitudes.push_back(other.half_cycles->amplitude[row]);
    const Spread all = spread_of(amplitudes);
    findings.spread.push_back(all.median > 0 ? (all.high - all.low) / all.median : 0);
    if (!findings.lost_row && findings.spread.back() > lost_spread) findings.lost_row = row;
  }
}

FrictionFindings friction_findings(const Findings& findings, double coefficient, const Run& run) {
  FrictionFindings found;
  found.coefficient = coefficient;
  found.is_whole = !(run.end_time < findings.run.end_time);
  const HalfCycles& rows = *run.half_cycles;
  const auto first = first_row(rows);
  if (!first) return found;
  found.last_amplitude = rows.amplitude.back();
  found.last_impact = last_with_impact(rows);
  if (found.last_impact) found.last_impact_time = rows.peak_time[found.last_impact->row];
  if (findings.forced()) {
    found.steady = steady_amplitude(rows);
    return found;
  }
  if (const auto time = time_below(run, 0.1 * *findings.first_amplitude))
    found.to_tenth = *time - rows.peak_time[*first];
  if (const LossFactor loss = loss_before_failure(run); found.last_impact && has_loss(loss)) {
    found.best = loss.amplitude[best_row(loss)];
    found.best_eta = loss.eta[best_row(loss)];
  }
  return found;
}

// Simulates the scene with friction for as long as without.
void find_frictions(Findings& findings, const Threads& threads) {
  const Scene& scene = findings.subject.scene;
  const std::optional<Scales>& scales = findings.subject.scales;
  if (!scales || has_components(scene) || !findings.first_amplitude) return;
  const double gravity = findings.subject.gravity / scales->of(Dimension::acceleration);
  if (gravity == 0) return;
  std::vector<Scene> scenes(friction_coefficients.size(), scene);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    scenes[i].until_amplitude.reset();
    scenes[i].until_time = findings.run.end_time;
    for (SceneDamper& damper : scenes[i].dampers) damper.friction = friction_coefficients[i] * gravity;
  }
  if (!incompatibilities_of(scenes.front(), findings.run.engine).empty()) return;
  findings.frictions.push_back(friction_findings(findings, 0, findings.run));
  const std::vector<Run> runs = simulate_scenes(scenes, findings.run.engine, {}, threads);
  for (std::size_t i = 0; i < runs.size(); ++i)
    findings.frictions.push_back(friction_findings(findings, friction_coefficients[i], runs[i]));
}

// Returns the windows of the history that are shown: from the release on, and where the motion is of
// interest.
std::vector<HistoryWindow> windows_of(const Findings& findings) {
  const double end = findings.run.end_time;
  if (!(end > 0)) return {};
  const bool swings = !findings.run.half_cycles->amplitude.empty();
  const double length = std::min(end, swings ? two_periods : end);
  std::vector<HistoryWindow> windows{{0, length, window_samples}};
  double from = end - two_periods;
  if (!findings.forced()) {
    if (!findings.best) return windows;
    from = std::min(findings.best->time - two_periods / 2, from);
  }
  if (from >= length) windows.push_back({from, from + two_periods, window_samples});
  return windows;
}

Run simulated(const Scene& scene, const Engine& engine, const std::vector<HistoryWindow>& windows = {}) {
  return simulate(scene, engine, {.impacts = true, .contacts = true, .energy = true, .history = windows});
}

void simulate_others(Findings& findings, const EnsembleOptions& options, const Progress& progress) {
  const std::vector<Scene> scenes = ensemble_of(findings.subject.scene, options);
  const auto batch = static_cast<std::ptrdiff_t>(number_of(options.threads));
  for (auto next = scenes.begin() + 1; next < scenes.end();) {
    progress("release " + std::to_string(next - scenes.begin() + 1) + " of " + std::to_string(scenes.size()));
    const auto end = next + std::min(batch, scenes.end() - next);
    std::ranges::move(simulate_scenes({next, end}, findings.run.engine, {}, options.threads),
                      std::back_inserter(findings.others));
    next = end;
  }
}

}  // namespace

std::optional<HalfCycleRow> last_with_impact(const HalfCycles& half_cycles) {
  std::size_t rows = half_cycles.impacts.size();
  while (rows > 0 && half_cycles.impacts[rows - 1] == 0) --rows;
  if (rows == 0) return std::nullopt;
  return HalfCycleRow{rows - 1, half_cycles.amplitude[rows - 1]};
}

Run Findings::run_of(std::size_t damper) const { return several() ? run_of_damper(run, damper) : run; }

double Findings::energy_to_impacts() const {
  const EnergyBalance& balance = *run.energy;
  return balance.impact_loss_total() + balance.contact_loss + balance.bounce_down_loss;
}

double Findings::energy_lost() const {
  const EnergyBalance& balance = *run.energy;
  return energy_to_impacts() + balance.viscous_work + balance.friction_loss + balance.drag_loss;
}

Findings examine(const Subject& subject, const EnsembleOptions& ensemble, const Progress& progress) {
  Findings findings;
  findings.subject = subject;
  progress("simulating the scene");
  findings.run = simulated(subject.scene, subject.engine);
  simulate_others(findings, ensemble, progress);

  const HalfCycles& rows = *findings.run.half_cycles;
  if (const auto first = first_row(rows)) {
    findings.first_amplitude = rows.amplitude[*first];
    findings.first_peak = rows.peak_time[*first];
    findings.last_amplitude = rows.amplitude.back();
    findings.last_peak = rows.peak_time.back();
    if (findings.forced()) {
      findings.steady = steady_amplitude(rows);
    } else {
      find_falls(findings);
      find_best_damping(findings);
    }
    find_regimes(findings);
    find_spread(findings);
  }
  progress("simulating the scene with friction");
  find_frictions(findings, ensemble.threads);
  findings.loads = loads_of(findings.run);
  if (findings.several()) find_dampers(findings);
  if (findings.forced() && findings.first_amplitude) {
    // Central differences cannot continue from period to period: the exact engine has the same walls.
    Engine engine = subject.engine;
    if (std::holds_alternative<Cem>(engine)) {
      Exact same_walls;
      same_walls.calibration = calibration_of(engine);
      engine = same_walls;
    }
    findings.response = forced_response(subject.scene, engine, ensemble.threads, [&](std::int64_t done) {
      progress("simulating other frequencies, " + std::to_string(done) + " motions done");
    });
  }

  progress("recording the motion");
  const std::vector<HistoryWindow> windows = windows_of(findings);
  if (windows.empty()) return findings;
  findings.run = simulated(findings.run.scene, findings.run.engine, windows);
  const std::vector<double>& time = findings.run.history->time;
  const std::size_t second = std::min(time.size(), static_cast<std::size_t>(windows[0].count));
  if (second > 1) findings.begin = {0, second - 1};
  if (second + 1 < time.size()) findings.chosen = {second, time.size() - 1};
  if (findings.several() && findings.chosen) {
    std::vector<std::int64_t> strikes(findings.dampers.size());
    const Impacts& impacts = *findings.run.impacts;
    for (std::size_t i = 0; i < impacts.time.size(); ++i)
      if (impacts.time[i] >= time[second]) ++strikes[impacts.damper[i]];
    findings.shown_when_chosen =
        static_cast<std::size_t>(std::ranges::max_element(strikes) - strikes.begin());
  }
  return findings;
}

}  // namespace impact_damper
