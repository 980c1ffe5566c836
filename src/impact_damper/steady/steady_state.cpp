#include "impact_damper/steady/steady_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/recorded.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

constexpr std::int64_t blocks = 10;

// A function that runs the engine for scenes that differ from `scene` in initial condition and stops only.
std::function<Outcome(const Scene&, Recorder&)> runner(const Scene& scene, const Exact& options) {
  const ForcedSystem system(scene);
  if (has_components(scene))
    return [system, options](const Scene& from, Recorder& recorder) {
      return run_exact_with_components(system, from, options, recorder);
    };
  if (!has_one_damper(scene)) {
    ModesOfDampers<double, Forcing<double>> modes;
    for (std::size_t n = 0; n < scene.dampers.size(); ++n)
      modes.push_back(modes_of_damper<double, Forcing<double>>(scene, n, options));
    return [system, modes, options](const Scene& from, Recorder& recorder) {
      return run_exact_dampers(system, from, options, recorder, modes);
    };
  }
  const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), options.calibration));
  return [system, walls, options](const Scene& from, Recorder& recorder) {
    return walls.coupled ? run_exact<ContactWithoutModes<double>>(walls, system, from, options, recorder)
                         : run_exact<Contact<double>>(walls, system, from, options, recorder);
  };
}
std::function<Outcome(const Scene&, Recorder&)> runner(const Scene& scene, const Restitution& options) {
  return [system = ForcedSystem(scene), options](const Scene& from, Recorder& recorder) {
    return has_components(from)   ? run_restitution_with_components(system, from, options, recorder)
           : has_one_damper(from) ? run_restitution(system, from, options, recorder)
                                  : run_restitution_dampers(system, from, options, recorder);
  };
}
std::function<Outcome(const Scene&, Recorder&)> runner(const Scene&, const Cem&) {
  return {};  // never called: problems_of() rejects cem
}

Scene without_stops(Scene scene) {
  scene.until_amplitude.reset();
  scene.until_time = 1;  // a scene needs one; each run has its own
  return scene;
}

}  // namespace

std::vector<Problem> problems_of(const SteadyRule& rule) {
  std::vector<Problem> problems;
  const auto check = [&](const char* name, double value, const NumberRange& range) {
    if (!range.allows(value))
      problems.push_back({name, range.describe("must be") + ", got " + number_text(value)});
  };
  check("tolerance", rule.tolerance, {0, 1e-2, false});
  check("longest_period", double(rule.longest_period), longest_periods);
  check("max_periods", double(rule.max_periods), most_periods);
  check("mean_periods", double(rule.mean_periods), mean_periods);
  return problems;
}

SceneState release_of(const Scene& scene) {
  SceneState state;
  state.x = scene.x0, state.v = scene.v0;
  state.dampers.clear();
  for (const SceneDamper& damper : scene.dampers) state.dampers.push_back({damper.y0, damper.w0});
  return state;
}

Scene released_from(Scene scene, const SceneState& state) {
  const auto allowed = [](double value) { return is_too_small(value) ? 0 : value; };
  scene.x0 = allowed(state.x);
  scene.v0 = allowed(state.v);
  for (std::size_t n = 0; n < scene.dampers.size(); ++n) {
    scene.dampers[n].y0 = allowed(state.dampers[n].y);
    scene.dampers[n].w0 = allowed(state.dampers[n].w);
  }
  return scene;
}

SceneState state_in(const History& history, std::size_t row) {
  SceneState state;
  state.x = history.x[row], state.v = history.v[row];
  state.dampers.clear();
  for (const History::Damper& damper : history.dampers)
    state.dampers.push_back({damper.y[row], damper.w[row]});
  return state;
}

bool has_mirror(const Scene& scene) { return scene.weight == 0; }

SceneState mirrored(const SceneState& s, const Scene& scene) {
  SceneState image = s;
  image.x = -s.x, image.v = -s.v;
  for (std::size_t n = 0; n < s.dampers.size(); ++n)
    image.dampers[n] = {scene.dampers[n].clearance - s.dampers[n].y, -s.dampers[n].w};
  return image;
}

double distance(const SceneState& a, const SceneState& b) {
  double largest = std::max(std::abs(a.x - b.x), std::abs(a.v - b.v));
  for (std::size_t n = 0; n < a.dampers.size(); ++n)
    largest = std::max(
        {largest, std::abs(a.dampers[n].y - b.dampers[n].y), std::abs(a.dampers[n].w - b.dampers[n].w)});
  return largest;
}

double size_of(const SceneState& s) {
  double largest = std::max({1.0, std::abs(s.x), std::abs(s.v)});
  for (const PlaceInCavity& each : s.dampers)
    largest = std::max({largest, std::abs(each.y), std::abs(each.w)});
  return largest;
}

Recurrence::Recurrence(const SteadyRule& rule)
    : tolerance_(rule.tolerance),
      longest_(rule.longest_period),
      states_(static_cast<std::size_t>(differences * rule.longest_period + 1)) {}

const SceneState& Recurrence::before(std::int64_t periods) const {
  const std::int64_t index = last_ - periods;
  return states_[static_cast<std::size_t>(index < 0 ? index + std::int64_t(states_.size()) : index)];
}

std::optional<Recurrence::Repeats> Recurrence::add(const SceneState& state) {
  if (++last_ == std::int64_t(states_.size())) last_ = 0;
  states_[static_cast<std::size_t>(last_)] = state;
  ++count_;
  const double size = size_of(state), allowed = tolerance_ * size;
  // The differences no longer shrink below some rounding errors of a whole period.
  const double rounding = 64 * std::numeric_limits<double>::epsilon() * size;
  // A period does not count as long as one of its divisors may turn out to be a period, too.
  const auto may_be_shorter = [&](std::int64_t m) {
    for (std::int64_t d = 1; d < m; ++d)
      if (m % d == 0 && distance(state, before(d)) <= 100 * allowed) return true;
    return false;
  };
  for (std::int64_t m = 1; m <= longest_ && differences * m < count_; ++m) {
    const SceneState& earlier = before(m);
    if (!(std::abs(state.x - earlier.x) <= allowed)) continue;  // rejects most m cheaply
    if (!(distance(state, earlier) <= allowed) || may_be_shorter(m)) continue;
    const auto largest_of = [&](std::int64_t from, std::int64_t to) {
      double largest = 0;
      for (std::int64_t j = from; j < to; ++j)
        largest = std::max(largest, distance(before(j * m), before((j + 1) * m)));
      return largest;
    };
    // The contraction (M14.1) from the largest of four differences each, as they may rotate while they
    // shrink.
    const double last = largest_of(0, differences / 2), first = largest_of(differences / 2, differences);
    if (std::max(last, first) <= rounding) return Repeats{m, std::nullopt};
    if (!(last <= allowed && last < first)) continue;
    static_assert(differences == 8);
    const double contraction = square_root(square_root(last / first));
    if (last * contraction <= allowed * (1 - contraction)) return Repeats{m, contraction};  // (M14.2)
  }
  return std::nullopt;
}

bool amplitudes_differ(double a, double scatter_a, double b, double scatter_b) {
  constexpr double deviations = 3;
  return std::abs(a - b) > std::max(visible_difference * std::max(a, b),
                                    deviations * square_root(scatter_a * scatter_a + scatter_b * scatter_b));
}

std::optional<bool> is_balanced(const SteadyState& steady) {
  // The energy of a chaotic motion may differ between the two ends of 500 periods.
  constexpr double largest_imbalance = 0.2;
  if (!steady.means) return std::nullopt;
  const double fed = steady.means->power, lost = steady.means->viscous_power + steady.means->impact_power;
  return std::abs(fed - lost) <= largest_imbalance * std::max(fed, lost);
}

std::vector<Problem> problems_of(const Scene& scene, const Engine& engine) {
  std::vector<Problem> problems = problems_of(without_stops(scene));
  for (const Problem& each : problems_of(engine)) problems.push_back(each);
  if (std::holds_alternative<Cem>(engine)) {
    problems.push_back({"engine", "must be exact or restitution, got cem"});
  } else if (problems.empty()) {
    problems = incompatibilities_of(scene, engine);
    if (problems.empty() && has_laws(scene))
      problems.push_back({"restitution",
                          "must be one number: steady motions are looked for without one that "
                          "depends on the speed, with which the restitution engine has runs"});
  }
  if (scene.force_amplitude == 0)
    problems.push_back({"force_amplitude", "must not be 0: without a force there is no steady motion"});
  return problems;
}

ForcedScene::ForcedScene(const Scene& scene, const Engine& engine)
    : scene_(without_stops(scene)), engine_(engine), rigid_(has_rigid_walls(engine)) {
  require_arithmetic();
  require_none(problems_of(scene, engine));
  period_ = 2 * half_turn<double>() / scene_.force_frequency;
  run_ = std::visit(
      [&](auto options) {
        options.budget = budget_for(scene_, options.budget);
        options.budget.max_half_cycles =
            std::min(options.budget.max_half_cycles, most_half_cycles(scene_.dampers.size()));
        return runner(scene_, options);
      },
      engine);
}

Expected<ForcedScene::Watched, StopReason> ForcedScene::pass_periods(const SceneState& state) const {
  return run_from(state, std::int64_t(periods_at_once), std::int64_t(periods_at_once), false);
}

Expected<ForcedScene::Watched, StopReason> ForcedScene::watch(const SceneState& state,
                                                              std::int64_t periods) const {
  return run_from(state, periods, 2, true);
}

Scene ForcedScene::released(const SceneState& state, double until) const {
  Scene from = released_from(scene_, state);
  if (rigid_) {
    for (SceneDamper& damper : from.dampers) damper.y0 = std::clamp(damper.y0, 0.0, damper.clearance);
  }
  from.until_time = until;
  return from;
}

RecordedRun ForcedScene::record(const SceneState& state, double until) const {
  const Scene from = released(state, until);
  RecordedRun all;
  Record record;
  record.half_cycles = false;
  record.history = {{until, until, 1}};
  Recorder recorder(std::move(record), scene_.dampers.size(), &all.chain);
  const Outcome outcome = run_(from, recorder);
  all.stop_reason = outcome.stop_reason;
  all.end_time = outcome.end_time;
  all.begin = release_of(from);
  if (all.stop_reason != StopReason::time) return all;
  Run run;
  recorder.finish(run);
  all.end = state_in(*run.history, 0);
  return all;
}

Expected<ForcedScene::Watched, StopReason> ForcedScene::run_from(const SceneState& state,
                                                                 std::int64_t periods, std::int64_t states,
                                                                 bool measures) const {
  const double end = double(periods) * period_;
  const Scene from = released(state, end);
  Record record;
  record.half_cycles = record.impacts = record.energy = measures;
  record.history = {{0, end, states + 1}};
  Recorder recorder(std::move(record), scene_.dampers.size());
  const StopReason stop_reason = run_(from, recorder).stop_reason;
  if (stop_reason != StopReason::time) return stop_reason;
  Run run;
  recorder.finish(run);

  Watched kept;
  for (std::size_t row = 1; row < run.history->time.size(); ++row)
    kept.states[row - 1] = state_in(*run.history, row);
  if (!measures) return kept;
  for (const double amplitude : run.half_cycles->amplitude)
    kept.amplitude = std::max(kept.amplitude, amplitude);
  kept.by_damper.resize(scene_.dampers.size());
  kept.by_damper_until_half_way.resize(scene_.dampers.size());
  for (std::size_t i = 0; i < run.impacts->time.size(); ++i) {
    const auto side = static_cast<std::size_t>(run.impacts->wall[i]);
    const bool until_half_way = run.impacts->time[i] < end / 2;
    ++kept.impacts[side];
    if (until_half_way) ++kept.impacts_until_half_way[side];
    const auto damper = static_cast<std::size_t>(run.impacts->damper[i]);
    ++kept.by_damper[damper][side];
    if (until_half_way) ++kept.by_damper_until_half_way[damper][side];
  }
  kept.energy = std::move(*run.energy);
  return kept;
}

SteadyState ForcedScene::settle(const SceneState& state, const SteadyRule& rule) const {
  SteadyState steady = follow(state, rule, [](const SceneState&) { return false; });
  if (steady.stop_reason == StopReason::time) measure(steady, rule);
  return steady;
}

SteadyState ForcedScene::follow(const SceneState& state, const SteadyRule& rule,
                                const std::function<bool(const SceneState&)>& enough) const {
  SteadyState steady;
  steady.state = state;
  Recurrence recurrence(rule);
  Expected<Watched, StopReason> passed{Watched{}};
  std::size_t next = periods_at_once;
  for (;; ++steady.transient_periods) {
    if (enough(steady.state)) return steady;
    if (const auto repeats = recurrence.add(steady.state)) {
      steady.period = repeats->period;
      steady.contraction = repeats->contraction;
      return steady;
    }
    if (steady.transient_periods == rule.max_periods) return steady;
    if (next == periods_at_once) {
      passed = pass_periods(steady.state);
      if (!passed) {
        steady.stop_reason = passed.failure();
        return steady;
      }
      next = 0;
    }
    steady.state = passed->states[next++];
  }
}

void ForcedScene::measure(SteadyState& steady, const SteadyRule& rule) const {
  if (steady.period) {
    measure_periodic(steady, rule);
  } else {
    measure_blocks(steady, rule);
  }
}

// The power by (M14.3), and the component at the force's frequency by (M14.4).
SteadyMeans ForcedScene::means_of(const Watched& watched, const SceneState& begin,
                                  std::int64_t periods) const {
  const double duration = double(periods) * period_, omega = scene_.force_frequency,
               f0 = scene_.force_amplitude;
  const EnergyBalance& energy = watched.energy;
  SteadyMeans means;
  means.amplitude = watched.amplitude;
  const double on_cos = -energy.forcing_work / (f0 * omega),
               on_sin = (energy.reactive_work / f0 - (watched.states[1].x - begin.x)) / omega;
  const double in_phase = 2 * on_sin / duration, behind = -2 * on_cos / duration;
  const double sign = f0 < 0 ? -1 : 1;
  means.fundamental = square_root(in_phase * in_phase + behind * behind);
  means.lag_deg = angle_of(sign * behind, sign * in_phase) * (180 / half_turn<double>());
  double lost = energy.contact_loss + energy.bounce_down_loss + energy.friction_loss + energy.drag_loss;
  for (const double loss : energy.impact_loss) lost += loss;
  means.power = energy.forcing_work / duration;
  means.viscous_power = energy.viscous_work / duration;
  means.impact_power = lost / duration;
  return means;
}

void ForcedScene::measure_periodic(SteadyState& steady, const SteadyRule& rule) const {
  const std::int64_t m = *steady.period;
  steady.measured_periods = m;
  // Over two periods: a half cycle that is not complete in the first is in the second.
  const auto watched = watch(steady.state, 2 * m);
  if (!watched) {
    steady.stop_reason = watched.failure();
    return;
  }
  steady.impacts = watched->impacts_until_half_way;
  steady.impacts_by_damper = watched->by_damper_until_half_way;
  steady.means = means_of(*watched, steady.state, 2 * m);
  if (m % 2 == 1 && has_mirror(scene_)) {
    const Watched half = *watch(steady.state, m);  // does not fail: twice as many periods did not
    const double near = 100 * rule.tolerance * size_of(steady.state);
    steady.symmetric = distance(mirrored(half.states[0], scene_), steady.state) <= near;
  }
}

void ForcedScene::measure_blocks(SteadyState& steady, const SteadyRule& rule) const {
  steady.measured_periods = rule.mean_periods;
  std::vector<SteadyMeans> means;
  SteadyMeans mean;
  double on_sin = 0, on_cos = 0;
  for (std::int64_t block = 0; block < blocks; ++block) {
    // Blocks differ by one period where their number does not divide that of the periods.
    const std::int64_t periods =
        rule.mean_periods * (block + 1) / blocks - rule.mean_periods * block / blocks;
    const auto watched = watch(steady.state, periods);
    if (!watched) {
      steady.stop_reason = watched.failure();
      return;
    }
    means.push_back(means_of(*watched, steady.state, periods));
    steady.impacts_by_damper.resize(watched->by_damper.size());
    for (const std::size_t wall : {0, 1}) {
      steady.impacts[wall] += watched->impacts[wall];
      for (std::size_t n = 0; n < watched->by_damper.size(); ++n)
        steady.impacts_by_damper[n][wall] += watched->by_damper[n][wall];
    }
    steady.state = watched->states[1];
    const SteadyMeans& now = means.back();
    const double weight = double(periods) / double(rule.mean_periods);
    mean.amplitude = std::max(mean.amplitude, now.amplitude);
    const auto [sin, cos] = sin_cos(now.lag_deg * (half_turn<double>() / 180));
    on_sin += weight * now.fundamental * sin;
    on_cos += weight * now.fundamental * cos;
    mean.power += weight * now.power;
    mean.viscous_power += weight * now.viscous_power;
    mean.impact_power += weight * now.impact_power;
  }
  mean.fundamental = square_root(on_sin * on_sin + on_cos * on_cos);
  mean.lag_deg = angle_of(on_sin, on_cos) * (180 / half_turn<double>());
  steady.means = mean;
  const auto scatter = [&](double SteadyMeans::*number) {
    double sum = 0, squares = 0;
    for (const SteadyMeans& each : means) sum += each.*number / double(blocks);
    for (const SteadyMeans& each : means) squares += (each.*number - sum) * (each.*number - sum);
    return square_root(squares / double(blocks - 1));
  };
  steady.amplitude_scatter = scatter(&SteadyMeans::amplitude);
  steady.power_scatter = scatter(&SteadyMeans::power);
}

}  // namespace impact_damper
